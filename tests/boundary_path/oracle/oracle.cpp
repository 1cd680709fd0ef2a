#include "boundary_path/oracle/oracle.h"

#include "boundary_path/oracle/closest_double.h"
#include "boundary_path/oracle/oracle_segment.h"

#include <algorithm>
#include <map>
#include <stdexcept>

namespace selvage::oracle {

namespace {

template <int D>
VertexTuple<D> outward_face(const VertexTuple<D + 1>& e, int face) {
  if constexpr (D == 2) {
    return {e[(face + 1) % 3], e[(face + 2) % 3]};
  } else {
    constexpr int kFaces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    return {e[kFaces[face][0]], e[kFaces[face][1]], e[kFaces[face][2]]};
  }
}

template <typename T>
T signed_volume(const std::array<std::array<T, 2>, 3>& v) {
  return determinant(v[1] - v[0], v[2] - v[0]);
}

template <typename T>
T signed_volume(const std::array<std::array<T, 3>, 4>& v) {
  return determinant(v[1] - v[0], v[2] - v[0], v[3] - v[0]);
}

template <typename T>
int sign_of(const T& x) {
  return (x > 0) - (x < 0);
}

// 1, 0 or -1 where doubles are sure of it, else 2.
template <int D>
int sign_in_doubles(const std::array<Vec<D>, D + 1>& v) {
  std::array<std::array<double, D>, D + 1> w;
  double size = 0;
  for (int i = 0; i <= D; ++i) {
    for (int k = 0; k < D; ++k) {
      w[i][k] = v[i][k] - v[0][k];
      size = std::max(size, std::abs(w[i][k]));
    }
  }
  const double volume = signed_volume(w);
  if (std::abs(volume) <= 1e-13 * std::pow(size, D)) return 2;
  return sign_of(volume);
}

template <int D>
int exact_sign(const std::array<Vec<D>, D + 1>& v) {
  const int quick = sign_in_doubles<D>(v);
  if (quick != 2) return quick;
  int bits = -4096;
  for (const auto& x : v) bits = std::max(bits, fraction_bits<D>(x));
  std::array<IntegerVec<D>, D + 1> w;
  for (int i = 0; i <= D; ++i) w[i] = to_integer<D>(v[i], bits);
  return sign_of(signed_volume(w));
}

template <int D>
std::array<Vec<D>, D + 1> corners(const std::vector<Vec<D>>& positions, const VertexTuple<D + 1>& element) {
  std::array<Vec<D>, D + 1> v;
  for (int i = 0; i <= D; ++i) v[i] = positions[element[i]];
  return v;
}

}  // namespace

template <int D>
Oracle<D>::Oracle(std::vector<Vec<D>> positions, std::vector<Element> elements)
    : positions_(std::move(positions)), elements_(std::move(elements)) {
  double largest = 0;
  for (const auto& x : positions_) largest = std::max(largest, x.cwiseAbs().maxCoeff());
  std::frexp(largest, &scale_exponent_);
  scaled_ = positions_;
  fraction_bits_ = -4096;
  for (auto& x : scaled_) {
    for (int k = 0; k < D; ++k) {
      const double given = x[k];
      x[k] = std::ldexp(given, -scale_exponent_);
      if (std::ldexp(x[k], scale_exponent_) != given) throw std::invalid_argument("coordinates too far apart");
    }
    fraction_bits_ = std::max(fraction_bits_, fraction_bits<D>(x));
  }
  build_topology();
  for (const auto& e : elements_) orientations_.push_back(exact_sign<D>(corners<D>(scaled_, e)));
  find_components();
}

template <int D>
void Oracle<D>::build_topology() {
  std::map<VertexTuple<D>, std::vector<std::pair<Index, int>>> sides;
  auto key = [&](Index e, int i) {
    auto face = outward_face<D>(elements_[e], i);
    std::sort(face.begin(), face.end());
    return face;
  };
  const Index count = static_cast<Index>(elements_.size());
  for (Index e = 0; e < count; ++e) {
    for (int i = 0; i <= D; ++i) sides[key(e, i)].push_back({e, i});
  }
  neighbours_.resize(elements_.size());
  for (Index e = 0; e < count; ++e) {
    for (int i = 0; i <= D; ++i) {
      const auto& both = sides[key(e, i)];
      neighbours_[e][i] = kNone;
      if (both.size() == 1) {
        faces_.push_back({e, outward_face<D>(elements_[e], i)});
      } else {
        neighbours_[e][i] = both[both[0].first == e ? 1 : 0].first;
      }
    }
  }
}

template <int D>
void Oracle<D>::find_components() {
  clean_.assign(elements_.size(), 2);  // not yet seen
  for (Index first = 0; first < static_cast<Index>(elements_.size()); ++first) {
    if (clean_[first] != 2) continue;
    std::vector<Index> component{first};
    clean_[first] = 1;
    bool clean = true;
    for (std::size_t i = 0; i < component.size(); ++i) {
      clean = clean && orientations_[component[i]] > 0;
      for (Index next : neighbours_[component[i]]) {
        if (next == kNone || clean_[next] != 2) continue;
        clean_[next] = 1;
        component.push_back(next);
      }
    }
    for (Index e : component) clean_[e] = clean;
  }
}

template <int D>
bool Oracle<D>::holds(Index element, const Vec<D>& point) const {
  return holds_scaled(element, point * std::ldexp(1.0, -scale_exponent_));
}

template <int D>
bool Oracle<D>::holds_scaled(Index element, const Vec<D>& point) const {
  if (orientations_[element] == 0) return false;
  const auto v = corners<D>(scaled_, elements_[element]);
  for (int k = 0; k < D; ++k) {  // exact as comparisons are
    const auto [low, high] = std::minmax_element(v.begin(), v.end(), [k](auto& a, auto& b) { return a[k] < b[k]; });
    if (point[k] < (*low)[k] || point[k] > (*high)[k]) return false;
  }
  for (int i = 0; i <= D; ++i) {
    auto w = v;
    w[i] = point;
    if (exact_sign<D>(w) * orientations_[element] < 0) return false;
  }
  return true;
}

template <int D>
std::vector<OraclePair> Oracle<D>::penetrating_vertices() const {
  std::set<Index> boundary;
  std::vector<char> owns(elements_.size(), 0);
  for (const auto& f : faces_) {
    boundary.insert(f.vertices.begin(), f.vertices.end());
    owns[f.owner] = 1;
  }
  std::vector<OraclePair> pairs;
  for (Index v : boundary) {
    for (Index e = 0; e < static_cast<Index>(elements_.size()); ++e) {
      const bool skipped = orientations_[e] < 0 && owns[e];
      if (skipped || std::count(elements_[e].begin(), elements_[e].end(), v)) continue;
      if (holds_scaled(e, scaled_[v])) pairs.push_back({v, e});
    }
  }
  return pairs;
}

template <int D>
bool Oracle<D>::is_excluded(Index face, const std::array<Index, 2>& source) const {
  const auto& f = faces_[face].vertices;
  return source[0] != kNone && std::all_of(source.begin(), source.end(),
                                           [&](Index v) { return v == kNone || std::count(f.begin(), f.end(), v); });
}

template <int D>
OracleAnswer Oracle<D>::shortest_path(const Vec<D>& point, Index element, const std::array<Index, 2>& source,
                                      Workspace& workspace) const {
  OracleAnswer answer;
  const Vec<D> p = point * std::ldexp(1.0, -scale_exponent_);
  answer.in_element = holds_scaled(element, p);
  if (!answer.in_element) return answer;
  auto& order = workspace.order;
  order.clear();
  for (Index f = 0; f < static_cast<Index>(faces_.size()); ++f) {
    if (orientations_[faces_[f].owner] <= 0 || is_excluded(f, source)) continue;
    const auto closest = closest_in_doubles<D>(scaled_, faces_[f].vertices, p);
    order.push_back({std::sqrt(closest.squared_distance) - closest.error, f});
  }
  const auto later = [](const auto& a, const auto& b) { return a > b; };
  std::make_heap(order.begin(), order.end(), later);
  // Faces come by what their distances are at least: one that comes later may still be nearer than what was found.
  double nearest = HUGE_VAL;
  for (; !order.empty() && order.front().first <= nearest; order.pop_back()) {
    std::pop_heap(order.begin(), order.end(), later);
    Segment segment = make_segment(p, order.back().second, !clean_[element]);
    if (source[0] == kNone && may_be_zero(segment) && exact_length(segment) == 0) continue;
    if (answer.found && exact_length(segment) >= answer.distance) continue;
    if (!connects(element, faces_[segment.face].owner, segment, workspace)) continue;
    answer.found = true;
    answer.face = segment.face;
    answer.distance = exact_length(segment);
    nearest = std::ldexp(answer.distance, -scale_exponent_);
  }
  return answer;
}

template <int D>
bool Oracle<D>::may_be_zero(const Segment& segment) const {
  double size = 0;
  for (Index v : faces_[segment.face].vertices)
    size = std::max(size, (scaled_[v] - segment.point).cwiseAbs().maxCoeff());
  return !segment.trusted || segment.direction.cwiseAbs().maxCoeff() <= 1e-9 * size;
}

template <int D>
bool Oracle<D>::is_valid(const Vec<D>& point, Index element, Index face, Workspace& workspace) const {
  if (orientations_[faces_[face].owner] <= 0) return false;
  Segment segment = make_segment(point * std::ldexp(1.0, -scale_exponent_), face, !clean_[element]);
  segment.trusted = false;
  return connects(element, faces_[face].owner, segment, workspace);
}

template <int D>
double Oracle<D>::face_distance(const Vec<D>& point, Index face) const {
  Segment segment = make_segment(point * std::ldexp(1.0, -scale_exponent_), face, false);
  return exact_length(segment);
}

template class Oracle<2>;
template class Oracle<3>;

}  // namespace selvage::oracle
