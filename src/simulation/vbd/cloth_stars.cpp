#include "simulation/vbd/cloth_stars.h"

#include <algorithm>

namespace selvage {

namespace {

/// The places of a hinge's vertices with each first, and whether that is an odd permutation.
struct Turn {
  int others[3];
  bool is_odd;
};
constexpr Turn kTurns[4] = {{{1, 2, 3}, false}, {{0, 2, 3}, true}, {{0, 1, 3}, false}, {{0, 1, 2}, true}};

/// The next place in the batches of a star that began at `first`.
template <typename Batch>
std::pair<std::int64_t, int> next_place(std::vector<Batch>& batches, int& used, Index vertex) {
  if (used % kStarBatch == 0) {
    Batch& batch = batches.emplace_back();
    auto& rows = batch.rows;
    if constexpr (std::is_same_v<Batch, BendingStarBatch>)
      std::fill_n(rows, kStarBatch, kStarRow * vertex);
    else
      for (auto& row : rows) std::fill_n(row, kStarBatch, kStarRow * vertex);
  }
  return {std::ssize(batches) - 1, used++ % kStarBatch};
}

Eigen::Matrix3d symmetric(const double (&sums)[6]) {
  const auto& [xx, yy, zz, xy, xz, yz] = sums;
  Eigen::Matrix3d m;
  m << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  return m;
}

}  // namespace

ClothStars::ClothStars(const ClothTerms& terms, const VertexColours& colours, const double* rows, const Index* own_rows)
    : terms_(terms), colours_(colours), rows_(rows), own_rows_(own_rows) {
  const auto triangle_count = std::ssize(terms.triangles());
  const auto end_star = [&] {
    first_triangles_.push_back(std::ssize(triangles_));
    first_bendings_.push_back(std::ssize(bendings_));
    first_hinges_.push_back(std::ssize(hinges_));
    first_others_.push_back(std::ssize(others_));
  };
  end_star();
  for (const Index v : colours.vertices) {
    Star star{v};
    for (const Index t : terms.terms_of(v)) t < triangle_count ? add_triangle(t, star) : add_hinge(t, star);
    add_bendings(star);
    bending_stiffness_.push_back(star.bending_stiffness);
    end_star();
  }
}

void ClothStars::add_triangle(Index term, Star& star) {
  const ClothTerms::Triangle& triangle = terms_.triangles()[term];
  const auto* material = std::get_if<MembraneNeoHookean>(&triangle.material);
  if (material == nullptr) return others_.push_back(term);
  const auto [number, lane] = next_place(triangles_, star.triangles, star.vertex);
  TriangleStarBatch& batch = triangles_[number];
  const RestSimplex<2>& rest = triangle.piece.rest;
  const auto& vertices = triangle.piece.vertices;
  const auto k = static_cast<int>(std::find(vertices.begin(), vertices.end(), star.vertex) - vertices.begin());
  const int q = (k + 1) % 3, r = (k + 2) % 3;
  batch.rows[0][lane] = kStarRow * vertices[q];
  batch.rows[1][lane] = kStarRow * vertices[r];
  for (int i = 0; i < 2; ++i) {
    batch.by_q[i][lane] = rest.by_vertex(q)[i];
    batch.by_r[i][lane] = rest.by_vertex(r)[i];
  }
  batch.mu[lane] = rest.size * material->mu;
  batch.bulk[lane] = rest.size * (material->lambda + material->mu);
  batch.damping_mu[lane] = rest.size * triangle.damping.mu;
  batch.damping_bulk[lane] = rest.size * triangle.damping.lambda;
  is_damped_ |= triangle.damping.mu > 0;
  triangle_places_.push_back({term, number, lane});
}

void ClothStars::add_hinge(Index term, Star& star) {
  const auto& [piece, damping] = terms_.hinges()[term - std::ssize(terms_.triangles())];
  if (!piece.is_flat) return others_.push_back(term);
  const auto k = std::find(piece.vertices.begin(), piece.vertices.end(), star.vertex) - piece.vertices.begin();
  const double pull = piece.flat.stiffness * piece.flat.weights[k];
  for (int j = 0; j < 4; ++j)
    if (j != k) star.bendings[piece.vertices[j]] += pull * piece.flat.weights[j];
  star.bending_stiffness += pull * piece.flat.weights[k];
  if (!(damping.stiffness > 0)) return;
  const auto [number, lane] = next_place(hinges_, star.hinges, star.vertex);
  HingeStarBatch& batch = hinges_[number];
  const Turn& turn = kTurns[k];
  for (int j = 0; j < 3; ++j) batch.rows[j][lane] = kStarRow * piece.vertices[turn.others[j]];
  batch.stiffness[lane] = damping.stiffness;
  batch.scale[lane] = turn.is_odd ? -damping.scale : damping.scale;
  hinge_places_.push_back({term - static_cast<Index>(terms_.triangles().size()), number, lane});
}

/// The weights of a flat hinge sum to zero: only differences to the vertex count.
void ClothStars::add_bendings(Star& star) {
  int used = 0;
  for (const auto& [vertex, weight] : star.bendings) {
    const auto [number, lane] = next_place(bendings_, used, star.vertex);
    bendings_[number].rows[lane] = kStarRow * vertex;
    bendings_[number].weights[lane] = weight;
  }
}

void ClothStars::begin() {
  for (const auto& [term, number, lane] : triangle_places_) {
    const Eigen::Matrix2d& start = terms_.triangles()[term].damping.squared_start;
    double(&numbers)[3][kStarBatch] = triangles_[number].squared_start;
    numbers[0][lane] = start(0, 0);
    numbers[1][lane] = start(0, 1);
    numbers[2][lane] = start(1, 1);
  }
  for (const auto& [hinge, number, lane] : hinge_places_)
    hinges_[number].start[lane] = terms_.hinges()[hinge].damping.start;
}

ClothStarTask ClothStars::task() const {
  return {rows_,
          own_rows_,
          triangles_.data(),
          bendings_.data(),
          hinges_.data(),
          first_triangles_.data(),
          first_bendings_.data(),
          first_hinges_.data(),
          is_damped_};
}

double ClothStars::add(std::span<const Vec3> x, Index i, VertexDerivatives& all, VertexDerivatives& quadratic) const {
  const Index v = colours_.vertices[i];
  if (is_empty(i)) return 0;
  ClothStarSums sums;
  const ClothStarTask own = task();
  SELVAGE_DISPATCH(sum_cloth_star, own, i, sums);
  const Eigen::Vector3d bending = Eigen::Map<const Eigen::Vector3d>(sums.quadratic);
  const Eigen::Matrix3d stiffness =
      symmetric(sums.quadratic_hessian) + bending_stiffness_[i] * Eigen::Matrix3d::Identity();
  for (VertexDerivatives* sum : {&all, &quadratic}) {
    sum->gradient += bending;
    sum->hessian += stiffness;
  }
  double energy = sums.energy;
  if (sums.least_area > 0) {
    all.gradient += Eigen::Map<const Eigen::Vector3d>(sums.gradient);
    all.hessian += symmetric(sums.hessian);
  } else {
    for (const Index t : terms_.terms_of(v)) {
      if (t >= std::ssize(terms_.triangles())) break;
      if (std::holds_alternative<MembraneNeoHookean>(terms_.triangles()[t].material))
        terms_.add_by_vertex(x, t, v, all);
    }
  }
  for (std::int64_t n = first_others_[i]; n < first_others_[i + 1]; ++n) {
    terms_.add_by_vertex(x, others_[n], v, all);
    energy += terms_.energy_by_vertex(x, others_[n], v, x[v]);
  }
  return energy;
}

double ClothStars::energy(std::span<const Vec3> x, Index i, const Vec3& at) const {
  if (is_empty(i)) return 0;
  double sum;
  const ClothStarTask own = task();
  SELVAGE_DISPATCH(measure_cloth_star, own, i, at.data(), sum);
  for (std::int64_t n = first_others_[i]; n < first_others_[i + 1]; ++n)
    sum += terms_.energy_by_vertex(x, others_[n], colours_.vertices[i], at);
  return sum;
}

}  // namespace selvage
