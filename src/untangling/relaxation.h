#pragma once

#include "selvage/untangling/resolve.h"
#include "simulation/xpbd/material_solver.h"
#include "simulation/xpbd/project_contacts.h"

namespace selvage {

/// An elastic mesh at rest, of which only those vertices move that are near something which pushes: relaxed from where
/// they are, without velocities, and pushed out of contacts.
class Relaxation {
 public:
  /// @param positions  (n_vertices x 3) where the mesh is; moved by relax() and place()
  /// @param rest       its shape without stress
  /// @param origin     where no vertex may go too far from; must outlive this
  Relaxation(const TetMesh& mesh, std::vector<Vec3>& positions, std::span<const Vec3> rest,
             std::span<const Vec3> origin, const ResolveOptions& options);

  const Model& model() const { return model_; }
  /// Elements that are inside out or flat now, ascending.
  std::span<const Index> inverted() const { return inverted_; }
  std::int64_t count_awake() const;
  /// Of ends that had to be drawn through a crossing when last relaxed: see find_agreeing_contacts().
  std::int64_t drawn_vertices() const { return drawn_vertices_; }

  /// Takes over contacts, sorted by point; of points that have none, those of the last iterations. Their vertices
  /// wake, and those of inverted elements.
  void hold(std::span<const Contact> contacts);

  /// Wakes what is not where its origin is.
  void wake_displaced();

  /// Wakes one ring of elements around what has moved.
  void wake_neighbours();

  /// The material from where vertices are, and then out of the contacts that are held; what this turns inside out is
  /// turned upright again as far as that goes.
  void relax();

  /// Sets what is awake to other positions.
  void place(std::span<const Vec3> positions);

  /// Lets what meets come closer again, down to the clearance that was asked for.
  void shrink_clearance();

 private:
  /// A contact and for how many iterations its point has not been found inside.
  struct HeldContact {
    Contact contact;
    int age = 0;
  };

  void wake(Index vertex);
  void limit_displacements();
  void set_positions(std::span<const Vec3> positions);

  const TetMesh& mesh_;
  std::vector<Vec3>& positions_;
  const std::vector<Vec3> start_;
  const std::span<const Vec3> origin_;
  const Model model_;
  const double length_;  ///< mean of the boundary's edges at rest [m]
  const double clearance_, max_displacement_;
  std::vector<double> element_sizes_;  ///< at rest [m]
  Push push_;
  MaterialSolver material_;
  std::vector<VertexRow> vertices_;  ///< those asleep have no inverse mass
  std::vector<std::uint8_t> is_free_, is_awake_;
  std::vector<Index> inverted_;
  std::vector<HeldContact> held_;  ///< oldest first
  std::int64_t drawn_vertices_ = 0;
};

}  // namespace selvage
