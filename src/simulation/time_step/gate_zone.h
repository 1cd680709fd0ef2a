#pragma once

#include "selvage/simulation/model.h"
#include "selvage/simulation/motion.h"
#include "simulation/colliders/project_colliders.h"
#include "simulation/step.h"
#include "simulation/step_vertex.h"

#include <array>
#include <optional>
#include <vector>

namespace selvage {

/// What moves vertices whatever bodies do: for each vertex the motion of the handle that holds it or of the collider
/// that it touches in this step.
struct Carriers {
  std::vector<RigidTransform> motions;  ///< from the start of the step to its end; those of colliders last
  std::vector<Index> of_vertex;         ///< (n_contact_vertices) kNone: free
  std::span<const PreparedCollider> colliders;
  std::span<const double> max_corrections;       ///< (n_contact_vertices) [m]
  std::span<const ColliderContactState> states;  ///< (n_vertices x n_colliders)

  Index of_collider(Index collider) const { return static_cast<Index>(motions.size() - colliders.size()) + collider; }

  /// The collider that a carrier is, where that changes its form: null for all others.
  const PreparedCollider* keyframed(Index carrier) const {
    const Index collider = carrier - of_collider(0);
    return collider >= 0 && colliders[collider].surface_motion ? &colliders[collider] : nullptr;
  }

  /// By how far a carrier moves in the step what is at a place at its start [m].
  Vec3 way(Index carrier, const Step& step, const Vec3& place) const;
};

/// A point of a zone, a weighted mean of vertices, that touches what carries it.
struct ZoneTouch {
  int count = 0;
  std::array<Index, 3> vertices{};  ///< of the model
  std::array<double, 3> weights{};
  Index carrier = kNone;
  Vec3 point = Vec3::Zero();  ///< of the carrier, at the start of the step [m]
  Vec3 way = Vec3::Zero();    ///< of that point in the step [m]
};

/// Where a carrier touches a vertex.
ZoneTouch touch_of_vertex(Index vertex, Index carrier, const Step& step, const Carriers& carriers);

/// What is left of a zone's own motion where it is scaled down to nothing.
enum class ZoneBase : std::uint8_t {
  kRigid,   ///< the rigid displacement that keeps its momentum and angular momentum
  kDrifts,  ///< the shift that keeps its momentum
  kStands,  ///< none
};

/// Vertices that StepGate holds back together, and what carries them.
class GateZone {
 public:
  std::vector<Index> vertices;

  void add(const ZoneTouch& touch);

  /// By how far a zone that nothing touches but one collider, and that started the step inside, has to go to leave it
  /// [m]: as contacts would let out its deepest vertex in the step. Held at the place where they are, its vertices
  /// would stay inside for ever. Where ways out lead to several sides there is none.
  Vec3 way_out(const Step& step, const Carriers& carriers) const;

  /// Whether carriers move apart where the zone touches them.
  /// @param least  by more than this part of a contact's gap
  bool is_torn(const Step& step, const Carriers& carriers, double least) const;

  /// By how far the vertices go where their own motion is scaled down to nothing [m]: with the first carrier, or where
  /// nothing carries the zone by `base`.
  ///
  /// @param targets  (n_contact_vertices) end of the step as the solver left it [m]
  /// @param base     but for kRigid, each vertex follows the place of a key-framed collider that is nearest to it, in
  ///                 place of the rigid motion nearest to that of all
  std::vector<Vec3> base_ways(const Model& model, const Step& step, const Carriers& carriers,
                              std::span<const Vec3> targets, ZoneBase base) const;

  /// The same for a zone that carriers tear, bent so that what touches each of them goes with it.
  std::vector<Vec3> bent_ways(const Model& model, const Step& step, const Carriers& carriers) const;

 private:
  struct Leader {
    Vec3 point, way;
    double weight;
  };

  std::optional<std::vector<Vec3>> affine_ways(const Step& step, const Carriers& carriers) const;
  std::vector<Leader> leaders() const;
  std::vector<Vec3> led_ways(const Step& step, const Carriers& carriers) const;

  Index carrier_ = kNone;  ///< the least
  std::vector<ZoneTouch> touches_;
};

}  // namespace selvage
