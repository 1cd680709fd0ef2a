#include "simulation/xpbd/cloth_solver.h"

#include "core/parallel.h"

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

/// Constraints that one thread solves at a time.
constexpr std::int64_t kAtOnce = 256;
/// See MaterialSolver.
constexpr double kLongestDamping = 3;
/// Squared strain below which a triangle counts as at rest: rounding.
constexpr double kMinSquaredStrain = 1e-30;

/// Vertices of a constraint, its change by each, and what is known of it.
template <int N>
struct Constraint {
  StencilPositions<N> x;
  Eigen::Matrix<double, 3, N> moved;  ///< since the start of the step; zero where nothing is damped
  Eigen::Matrix<double, N, 1> inverse_masses;

  Constraint(const std::array<Index, N>& of, std::span<const StepVertex> vertices, std::span<const StepVertex> start,
             bool is_damped) {
    for (int k = 0; k < N; ++k) {
      x.col(k) = position(vertices[of[k]]);
      inverse_masses[k] = vertices[of[k]].inverse_mass;
      if (is_damped)
        moved.col(k) = x.col(k) - position(start[of[k]]);
      else
        moved.col(k).setZero();
    }
  }

  bool can_move() const { return inverse_masses.maxCoeff() > 0; }

  void store(const std::array<Index, N>& of, std::span<StepVertex> vertices) const {
    for (int k = 0; k < N; ++k)
      if (inverse_masses[k] > 0) position(vertices[of[k]]) = x.col(k);
  }
};

/// What a scalar constraint C needs besides its gradient: all is multiplied by `factor`, so that nothing need be
/// divided by a C near 0 where the gradient of C^2 / 2 is known.
struct Scalar {
  double value;       ///< factor * C
  double factor = 1;  ///< 1, or C
  double compliance, damping;
  double weight_at_rest;  ///< of the gradients; see ElementSolver
};

template <int N>
void solve_scalar(const Scalar& of, const Eigen::Matrix<double, 3, N>& gradient, Constraint<N>& constraint,
                  double& multiplier) {
  const double weight = gradient.colwise().squaredNorm().dot(constraint.inverse_masses);
  const double residual =
      of.value + of.factor * of.compliance * multiplier + of.damping * gradient.cwiseProduct(constraint.moved).sum();
  const double denominator = (1 + of.damping) * weight + of.factor * of.factor * of.compliance +
                             0.25 * residual * residual * of.weight_at_rest;
  if (!(denominator > 0)) return;
  const double scale = residual / denominator;
  multiplier -= scale * of.factor;
  for (int k = 0; k < N; ++k) {
    const Vec3 move = -scale * constraint.inverse_masses[k] * gradient.col(k);
    constraint.x.col(k) += move;
    if (of.damping > 0) constraint.moved.col(k) += move;
  }
}

/// By vertices, of a derivative by F.
Eigen::Matrix<double, 3, 3> by_vertices(const RestSimplex<2>& rest, const DeformationGradient<2>& by_f) {
  Eigen::Matrix3d gradient;
  gradient.rightCols<2>() = by_f * rest.inverse_edges.transpose();
  gradient.col(0) = -gradient.col(1) - gradient.col(2);
  return gradient;
}

/// The area of the columns, and its derivative: zero where there is none.
double area_of(const DeformationGradient<2>& f, DeformationGradient<2>& by_f) {
  const Eigen::Vector3d across = f.col(0).cross(f.col(1));
  const double area = across.norm();
  by_f.setZero();
  if (!(area > 0)) return 0;
  const Eigen::Vector3d normal = across / area;
  by_f << f.col(1).cross(normal), normal.cross(f.col(0));
  return area;
}

double stretch_of(const DeformationGradient<2>& f, int column, DeformationGradient<2>& by_f) {
  by_f.setZero();
  const double length = f.col(column).norm();
  if (length > 0) by_f.col(column) = f.col(column) / length;
  return length;
}

/// Colours such that no two pieces of one have a vertex in common: each piece the first that is free, in their order.
template <typename Piece>
std::vector<int> colours_of(std::span<const Piece> pieces, Index vertex_count) {
  std::vector<std::vector<bool>> is_used;  // by colour and vertex
  std::vector<int> colours;
  for (const Piece& piece : pieces) {
    const auto is_free = [&](const std::vector<bool>& used) {
      return std::none_of(piece.vertices.begin(), piece.vertices.end(), [&](Index v) { return used[v]; });
    };
    const auto free = std::find_if(is_used.begin(), is_used.end(), is_free);
    const auto colour = static_cast<std::size_t>(free - is_used.begin());
    if (colour == is_used.size()) is_used.emplace_back(vertex_count, false);
    for (const Index v : piece.vertices) is_used[colour][v] = true;
    colours.push_back(static_cast<int>(colour));
  }
  return colours;
}

}  // namespace

template <typename Item>
template <typename Piece>
ClothSolver::Coloured<Item> ClothSolver::Coloured<Item>::of(std::span<const Piece> pieces, Index vertex_count) {
  const std::vector<int> colours = colours_of(pieces, vertex_count);
  Coloured coloured;
  const int count = colours.empty() ? 0 : *std::max_element(colours.begin(), colours.end()) + 1;
  for (int colour = 0; colour < count; ++colour) {
    coloured.first.push_back(static_cast<Index>(coloured.items.size()));
    for (std::size_t i = 0; i < pieces.size(); ++i)
      if (colours[i] == colour) coloured.items.push_back({pieces[i]});
  }
  coloured.first.push_back(static_cast<Index>(coloured.items.size()));
  return coloured;
}

ClothSolver::ClothSolver(const Model& model, double time_step) : squared_step_(time_step * time_step) {
  for (const Body& body : model.bodies) {
    const ClothMaterial& m = body.cloth;
    Sheet sheet{m.kind,
                {},
                std::min(m.damping / time_step, kLongestDamping),
                std::min(m.bending_damping.value_or(m.damping) / time_step, kLongestDamping)};
    if (m.kind == ClothKind::kIsotropic) {
      const double mu = m.stiffness / (2 * (1 + m.poisson_ratio));
      const double lambda = m.stiffness * m.poisson_ratio / (1 - m.poisson_ratio * m.poisson_ratio);
      sheet.compliances = {1 / (mu * squared_step_), 1 / ((lambda + mu) * squared_step_), 0};
    } else {
      sheet.compliances = {1 / (m.warp * squared_step_), 1 / (m.weft * squared_step_), 1 / (m.shear * squared_step_)};
    }
    sheets_.push_back(sheet);
    constraint_count_ += std::int64_t{m.kind == ClothKind::kIsotropic ? 2 : 3} * body.triangle_count;
  }
  const std::vector<ClothTriangle> triangles = list_cloth_triangles(model);
  const std::vector<ClothHinge> hinges = list_cloth_hinges(model);
  triangles_ = Coloured<Triangle>::of(std::span(triangles), model.mesh.vertex_count());
  hinges_ = Coloured<Hinge>::of(std::span(hinges), model.mesh.vertex_count());
  constraint_count_ += std::ssize(hinges);
}

bool ClothSolver::needs_start() const {
  return !triangles_.items.empty() && std::any_of(sheets_.begin(), sheets_.end(), [](const Sheet& sheet) {
    return sheet.damping > 0 || sheet.bending_damping > 0;
  });
}

void ClothSolver::solve_triangle(Triangle& triangle, std::span<StepVertex> vertices,
                                 std::span<const StepVertex> start) const {
  const Sheet& sheet = sheets_[triangle.piece.body];
  const RestSimplex<2>& rest = triangle.piece.rest;
  Constraint<3> constraint(triangle.piece.vertices, vertices, start, sheet.damping > 0);
  if (!constraint.can_move()) return;
  double weight_at_rest = 0;
  for (int k = 0; k < 3; ++k) weight_at_rest += constraint.inverse_masses[k] * rest.by_vertex(k).squaredNorm();
  DeformationGradient<2> by_f;
  const auto solve = [&](int number, double value, double factor) {
    const Scalar scalar{value, factor, sheet.compliances[number] / rest.size, sheet.damping, weight_at_rest};
    solve_scalar<3>(scalar, by_vertices(rest, by_f), constraint, triangle.multipliers[number]);
  };
  if (sheet.kind == ClothKind::kIsotropic) {
    DeformationGradient<2> f = rest.deformation(constraint.x);
    const double area = area_of(f, by_f);
    const double squared = std::max(f.squaredNorm() - 2 * area, kMinSquaredStrain);
    by_f = f - by_f;
    solve(0, squared, std::sqrt(squared));
    f = rest.deformation(constraint.x);
    const double growth = area_of(f, by_f) - 1;
    solve(1, growth, 1);
  } else {
    for (int column = 0; column < 2; ++column) {
      const double change = stretch_of(rest.deformation(constraint.x), column, by_f) - 1;
      solve(column, change, 1);
    }
    const DeformationGradient<2> f = rest.deformation(constraint.x);
    by_f << f.col(1), f.col(0);
    solve(2, f.col(0).dot(f.col(1)), 1);
  }
  constraint.store(triangle.piece.vertices, vertices);
}

void ClothSolver::solve_hinge(Hinge& hinge, std::span<StepVertex> vertices, std::span<const StepVertex> start) const {
  const double damping = sheets_[hinge.piece.body].bending_damping;
  Constraint<4> constraint(hinge.piece.vertices, vertices, start, damping > 0);
  if (!constraint.can_move()) return;
  if (hinge.piece.is_flat) {
    const Eigen::Vector4d& weights = hinge.piece.flat.weights;
    const double compliance = 1 / (hinge.piece.flat.stiffness * squared_step_);
    const double weight = weights.cwiseAbs2().dot(constraint.inverse_masses);
    const Eigen::Vector3d residual =
        constraint.x * weights + compliance * hinge.multiplier + damping * (constraint.moved * weights);
    const Eigen::Vector3d change = residual / ((1 + damping) * weight + compliance);
    hinge.multiplier -= change;
    for (int k = 0; k < 4; ++k) constraint.x.col(k) -= constraint.inverse_masses[k] * weights[k] * change;
  } else {
    const double bent = std::remainder(hinge_angle(constraint.x) - hinge.piece.bent.rest_angle, 2 * EIGEN_PI);
    const Scalar scalar{bent, 1, 1 / (hinge.piece.bent.stiffness * squared_step_), damping, 0};
    solve_scalar<4>(scalar, hinge_angle_gradient(constraint.x), constraint, hinge.multiplier[0]);
  }
  constraint.store(hinge.piece.vertices, vertices);
}

void ClothSolver::solve(std::span<StepVertex> vertices, std::span<const StepVertex> start, int iteration) {
  const auto solve_all = [&](auto& coloured, auto&& solve_one) {
    for (std::size_t colour = 0; colour + 1 < coloured.first.size(); ++colour) {
      const Index first = coloured.first[colour];
      parallel_for(coloured.first[colour + 1] - first, kAtOnce,
                   [&](std::int64_t i) { solve_one(coloured.items[first + i]); });
    }
  };
  solve_all(triangles_, [&](Triangle& triangle) {
    if (iteration == 0) triangle.multipliers = {};
    solve_triangle(triangle, vertices, start);
  });
  solve_all(hinges_, [&](Hinge& hinge) {
    if (iteration == 0) hinge.multiplier.setZero();
    solve_hinge(hinge, vertices, start);
  });
}

}  // namespace selvage
