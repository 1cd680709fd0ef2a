#include "boundary_path/queries.h"

namespace selvage::families {

namespace {

constexpr std::size_t kEdgesTried = 60;

template <int D>
Vec<D> weighted(const oracle::Oracle<D>& oracle, Index element, const std::array<double, D + 1>& weights) {
  Vec<D> sum = Vec<D>::Zero();
  double total = 0;
  for (int i = 0; i <= D; ++i) {
    if (weights[i] == 0) continue;
    sum += weights[i] * oracle.positions()[oracle.elements()[element][i]];
    total += weights[i];
  }
  return sum / total;
}

}  // namespace

template <int D>
QueryMaker<D>::QueryMaker(const oracle::Oracle<D>& oracle) : oracle_(oracle) {
  for (const auto& pair : oracle.penetrating_vertices()) {
    penetrating_.push_back({oracle.positions()[pair.vertex], pair.element, {pair.vertex, kNone}});
  }
  if constexpr (D == 3) {
    const auto& faces = oracle.faces();
    const std::size_t stride = faces.size() / kEdgesTried + 1;
    for (std::size_t f = 0; f < faces.size(); f += stride) {
      const Index a = faces[f].vertices[0], b = faces[f].vertices[1];
      const Vec<D> middle = oracle.positions()[a] * 0.5 + oracle.positions()[b] * 0.5;
      for (Index e = 0; e < static_cast<Index>(oracle.elements().size()); ++e) {
        const auto& v = oracle.elements()[e];
        const bool has_both = std::count(v.begin(), v.end(), a) && std::count(v.begin(), v.end(), b);
        if (!has_both && oracle.holds(e, middle)) penetrating_.push_back({middle, e, {a, b}});
      }
    }
  }
}

template <int D>
Query<D> QueryMaker<D>::inside(Random& random, Index element) const {
  std::array<double, D + 1> weights;
  const int kind = random.below(3);
  for (auto& w : weights) {
    w = random.unit() + 1e-3;
    if (kind == 1) w = w * w * w * w;                   // close to corners
    if (kind == 2) w = random.below(2) ? w : 1e-9 * w;  // close to faces, edges and vertices
  }
  return {weighted<D>(oracle_, element, weights), element};
}

template <int D>
Query<D> QueryMaker<D>::lattice(Random& random, Index element) const {
  std::array<double, D + 1> weights{};
  const int kind = random.below(4);
  if (kind == 0) {  // a vertex
    weights[random.below(D + 1)] = 1;
  } else if (kind == 1) {  // the centroid of an edge, a face or the element
    do {
      for (auto& w : weights) w = random.below(2);
    } while (*std::max_element(weights.begin(), weights.end()) == 0);
  } else {  // quarters or eighths, often zero
    const int parts = kind == 2 ? 4 : 8;
    for (int i = 0; i < parts; ++i) weights[random.below(D + 1)] += 1;
  }
  return {weighted<D>(oracle_, element, weights), element};
}

template <int D>
Query<D> QueryMaker<D>::make(Random& random) const {
  const Index kind = random.below(10);
  if (kind < 2 && !penetrating_.empty()) return penetrating_[random.below(penetrating_.size())];
  const Index element = random.below(oracle_.elements().size());
  return kind < 6 ? inside(random, element) : lattice(random, element);
}

template <int D>
std::vector<Query<D>> QueryMaker<D>::make_many(std::int64_t count, std::uint64_t seed) const {
  Random random(seed);
  std::vector<Query<D>> queries;
  for (std::int64_t i = 0; i < count; ++i) queries.push_back(make(random));
  return queries;
}

template class QueryMaker<2>;
template class QueryMaker<3>;

}  // namespace selvage::families
