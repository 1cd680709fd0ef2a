#pragma once

#include "selvage/simulation/resolve.h"
#include "simulation/material_solver.h"
#include "simulation/project_contacts.h"

namespace selvage {

/// An elastic mesh at rest, of which only those vertices move that are near something which pushes: relaxed from where
/// they are, without velocities, and pushed out of contacts.
class Relaxation {
 public:
  /// @param positions  (n_vertices x 3) where the mesh is; moved by relax() and place()
  /// @param evenings   see keep_upright()
  Relaxation(const TetMesh& mesh, std::vector<Vec3>& positions, const ResolveOptions& options, int evenings);

  const Model& model() const { return model_; }
  /// Elements that are inside out or flat now, ascending.
  std::span<const Index> inverted() const { return inverted_; }
  std::int64_t count_awake() const;
  /// Whether any vertex has ever been held back, so that elements stay upright.
  bool has_held_back() const { return has_held_back_; }

  /// Takes over contacts, sorted by point; of points that have none, those of the last iterations. Their vertices
  /// wake, and those of inverted elements.
  void hold(std::span<const Contact> contacts);

  /// Wakes one ring of elements around what has moved.
  void wake_neighbours();

  /// The material from where vertices are, and then out of the contacts that are held.
  void relax();

  /// Sets what is awake to other positions, in which no element is inverted.
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
  const std::vector<Vec3> input_;
  const Model model_;
  const double length_;  ///< mean of the boundary's edges at rest [m]
  const double clearance_, max_displacement_;
  const int evenings_;
  Push push_;
  MaterialSolver material_;
  std::vector<VertexRow> vertices_;  ///< those asleep have no inverse mass; followed by the solver's stand-ins
  std::vector<std::uint8_t> is_free_, is_awake_;
  std::vector<Index> inverted_;
  std::vector<HeldContact> held_;
  bool has_held_back_ = false;
};

}  // namespace selvage
