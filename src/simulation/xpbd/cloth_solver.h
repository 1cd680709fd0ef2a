#pragma once

#include "simulation/cloth_pieces.h"
#include "simulation/step_vertex.h"

namespace selvage {

/// The cloth of a model under XPBD: Gauss-Seidel over its triangles, then over its hinges, colour by colour.
///
/// The energies are those of `elasticity/triangles`. An isotropic sheet has two constraints a triangle, as a
/// Neo-Hookean element has: C_D = sqrt(|F|^2 - 2 J) of compliance 1 / (mu A), and C_H = J - 1 of compliance
/// 1 / ((lambda + mu) A), both satisfied at rest. A woven one has three: |w_u| - 1, |w_v| - 1 and w_u . w_v. A hinge
/// that is flat at rest has the weighed sum of its vertices, which is linear; another its angle.
///
/// Sources: Macklin, Mueller, Chentanez 2016 (XPBD); Macklin and Mueller 2021, of which this is the sheet.
class ClothSolver {
 public:
  ClothSolver(const Model& model, double time_step);

  /// Whether solve() needs the vertices at the start of the step.
  bool needs_start() const;

  /// Constraints solved in one iteration.
  std::int64_t constraint_count() const { return constraint_count_; }

  /// One iteration; number 0 forgets the step before. The same bits for any number of threads.
  void solve(std::span<StepVertex> vertices, std::span<const StepVertex> start, int iteration);

 private:
  /// A body's material, scaled for a time step.
  struct Sheet {
    ClothKind kind;
    std::array<double, 3> compliances;  ///< of the constraints of a triangle, times its area
    double damping, bending_damping;    ///< over the time step
  };
  struct Triangle {
    ClothTriangle piece;
    std::array<double, 3> multipliers{};
  };
  struct Hinge {
    ClothHinge piece;
    Vec3 multiplier = Vec3::Zero();  ///< of one that is not flat the first number alone
  };
  template <typename Item>
  struct Coloured {
    std::vector<Item> items;   ///< by colours
    std::vector<Index> first;  ///< (n_colours + 1)

    template <typename Piece>
    static Coloured of(std::span<const Piece> pieces, Index vertex_count);
  };

  void solve_triangle(Triangle& triangle, std::span<StepVertex> vertices, std::span<const StepVertex> start) const;
  void solve_hinge(Hinge& hinge, std::span<StepVertex> vertices, std::span<const StepVertex> start) const;

  double squared_step_;
  std::vector<Sheet> sheets_;  ///< of all bodies
  Coloured<Triangle> triangles_;
  Coloured<Hinge> hinges_;
  std::int64_t constraint_count_ = 0;
};

}  // namespace selvage
