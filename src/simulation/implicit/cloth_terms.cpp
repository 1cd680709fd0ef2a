#include "simulation/implicit/cloth_terms.h"

#include <algorithm>

namespace selvage {

ClothTerms::ClothTerms(const Model& model, double time_step) {
  for (const ClothTriangle& piece : list_cloth_triangles(model)) {
    const ClothMaterial& m = model.bodies[piece.body].cloth;
    const double damping = m.damping / time_step;
    if (m.kind == ClothKind::kIsotropic) {
      const double mu = m.stiffness / (2 * (1 + m.poisson_ratio));
      const double lambda = m.stiffness * m.poisson_ratio / (1 - m.poisson_ratio * m.poisson_ratio);
      triangles_.push_back(
          {piece, MembraneNeoHookean{mu, lambda}, {damping * mu, damping * lambda, Eigen::Matrix2d::Identity()}});
    } else {
      // Sheared by an angle, the strain is half of it, on both sides of the diagonal: mu of it costs what shear does.
      triangles_.push_back(
          {piece, MembraneWeave{m.warp, m.weft, m.shear}, {damping * m.shear, 0, Eigen::Matrix2d::Identity()}});
    }
  }
  for (const ClothHinge& piece : list_cloth_hinges(model)) {
    const ClothMaterial& cloth = model.bodies[piece.body].cloth;
    const double damping = cloth.bending_damping.value_or(cloth.damping) / time_step * piece.bent.stiffness;
    hinges_.push_back({piece, HingeDamping::of(gather(piece.vertices, model.rest_positions), damping)});
  }
  term_first_.assign(model.mesh.vertex_count() + 1, 0);
  for (Index t = 0; t < count(); ++t)
    for (const Index v : vertices_of(t)) ++term_first_[v + 1];
  for (std::size_t v = 1; v < term_first_.size(); ++v) term_first_[v] += term_first_[v - 1];
  term_of_vertex_.resize(term_first_.back());
  std::vector<Index> next(term_first_.begin(), term_first_.end() - 1);
  for (Index t = 0; t < count(); ++t)
    for (const Index v : vertices_of(t)) term_of_vertex_[next[v]++] = t;
}

std::span<const Index> ClothTerms::vertices_of(Index term) const {
  const auto triangles = static_cast<Index>(triangles_.size());
  if (term < triangles) return triangles_[term].piece.vertices;
  return hinges_[term - triangles].piece.vertices;
}

void ClothTerms::begin(std::span<const Vec3> positions) {
  for (Triangle& triangle : triangles_) {
    const DeformationGradient<2> f = triangle.piece.rest.deformation(gather(triangle.piece.vertices, positions));
    triangle.damping.squared_start = f.transpose() * f;
  }
  for (Hinge& hinge : hinges_) hinge.damping.start = hinge.damping.sine(gather(hinge.piece.vertices, positions));
}

/// Calls visit with each energy of a term, and its vertices' positions.
template <typename Visit>
void ClothTerms::visit(Index term, std::span<const Vec3> x, const Visit& visit) const {
  const auto triangles = static_cast<Index>(triangles_.size());
  if (term >= triangles) {
    const auto& [hinge, damping] = hinges_[term - triangles];
    const HingePositions own = gather(hinge.vertices, x);
    hinge.is_flat ? visit(hinge.flat, own) : visit(hinge.bent, own);
    if (damping.stiffness > 0) visit(damping, own);
    return;
  }
  const Triangle& triangle = triangles_[term];
  const StencilPositions<3> own = gather(triangle.piece.vertices, x);
  const RestSimplex<2>& rest = triangle.piece.rest;
  std::visit(
      [&](const auto& m) {
        visit(SimplexElement<2, std::decay_t<decltype(m)>>{rest, m}, own);
      },
      triangle.material);
  if (triangle.damping.mu > 0) visit(SimplexElement<2, StrainDamping<2>>{rest, triangle.damping}, own);
}

double ClothTerms::energy(Index term, std::span<const Vec3> x) const {
  double sum = 0;
  visit(term, x, [&](const auto& energy, const auto& own) { sum += energy.energy(own); });
  return sum;
}

StencilGradient<4> ClothTerms::gradient(Index term, std::span<const Vec3> x) const {
  StencilGradient<4> sum = StencilGradient<4>::Zero();
  visit(term, x, [&](const auto& energy, const auto& own) {
    sum.template leftCols<std::decay_t<decltype(energy)>::kVertices>() += energy.gradient(own);
  });
  return sum;
}

ClothTerms::Derivatives ClothTerms::derivatives(Index term, std::span<const Vec3> x, bool exact) const {
  Derivatives sum;
  visit(term, x, [&](const auto& energy, const auto& own) {
    constexpr int kVertices = std::decay_t<decltype(energy)>::kVertices;
    sum.gradient.template leftCols<kVertices>() += energy.gradient(own);
    sum.hessian.template topLeftCorner<3 * kVertices, 3 * kVertices>() +=
        exact ? energy.hessian(own) : energy.positive_hessian(own);
  });
  return sum;
}

int ClothTerms::place_of(Index term, Index vertex) const {
  const auto vertices = vertices_of(term);
  return static_cast<int>(std::find(vertices.begin(), vertices.end(), vertex) - vertices.begin());
}

void ClothTerms::add_by_vertex(std::span<const Vec3> x, Index term, Index v, VertexDerivatives& sum) const {
  const int place = place_of(term, v);
  visit(term, x, [&](const auto& energy, const auto& own) {
    if constexpr (requires { energy.rest; }) {
      const VertexDerivatives by =
          energy.material.by_vertex(energy.rest.deformation(own), energy.rest.by_vertex(place));
      sum.gradient += energy.rest.size * by.gradient;
      sum.hessian += energy.rest.size * by.hessian;
    } else {
      const VertexDerivatives by = energy.by_vertex(own, place);
      sum.gradient += by.gradient;
      sum.hessian += by.hessian;
    }
  });
}

double ClothTerms::energy_by_vertex(std::span<const Vec3> x, Index term, Index v, const Vec3& at) const {
  const int place = place_of(term, v);
  double sum = 0;
  visit(term, x, [&](const auto& energy, auto own) {
    own.col(place) = at;
    sum += energy.energy(own);
  });
  return sum;
}

}  // namespace selvage
