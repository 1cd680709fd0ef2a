#pragma once

#include "selvage/untangling/resolve.h"
#include "simulation/xpbd/material_solver.h"
#include "simulation/xpbd/project_contacts.h"

namespace selvage {

/// An elastic mesh that relaxes from where it is, without velocities, while contacts push it apart. Only awake vertices
/// move: those of contacts and of inverted elements, and their neighbours once they have moved.
class Relaxation {
 public:
  /// @param positions  (n_vertices x 3) where the mesh is; moved by relax() and place() [m]
  /// @param rest       (n_vertices x 3) its shape without stress [m]
  /// @param origin     (n_vertices x 3) from where ResolveOptions::max_displacement counts; must outlive this [m]
  Relaxation(const TetMesh& mesh, std::vector<Vec3>& positions, std::span<const Vec3> rest,
             std::span<const Vec3> origin, const ResolveOptions& options);

  const Model& model() const { return model_; }
  /// Elements that are inverted or flat now, ascending.
  std::span<const Index> inverted() const { return inverted_; }
  std::int64_t count_awake() const;
  /// Vertices of ends that had to be drawn through a crossing in the last relax(): see find_agreeing_contacts().
  std::int64_t drawn_vertices() const { return drawn_vertices_; }

  /// Takes over contacts, sorted by point. Points without one keep those of the last iterations. Vertices of contacts
  /// and of inverted elements wake.
  void hold(std::span<const Contact> contacts);

  /// Wakes all vertices that are not pinned.
  void wake_all();

  /// Wakes vertices that are not at their origin.
  void wake_displaced();

  /// Wakes the vertices of elements with a vertex that has moved.
  void wake_neighbours();

  /// Solves the material from where vertices are, alternating with the contacts that are held. Elements that this
  /// inverts are restored where possible.
  void relax();

  /// Sets awake vertices to other positions.
  void place(std::span<const Vec3> positions);

  /// Lets surfaces that met come closer again, down to ResolveOptions::clearance.
  void shrink_clearance();

 private:
  /// A contact, and the number of iterations since its point was last inside.
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
  std::vector<StepVertex> vertices_;  ///< those asleep have no inverse mass
  std::vector<std::uint8_t> is_free_, is_awake_;
  std::vector<Index> inverted_;
  std::vector<HeldContact> held_;  ///< oldest first
  std::int64_t drawn_vertices_ = 0;
};

}  // namespace selvage
