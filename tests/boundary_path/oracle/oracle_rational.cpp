// The second route: everything in rational numbers, the faces met by intersecting each face with the line.
#include "boundary_path/oracle/exact_integers.h"
#include "boundary_path/oracle/oracle.h"

#include <algorithm>

namespace selvage::oracle {

namespace {

template <int D>
std::array<RationalVec<D>, D> seen_from(const RationalVec<D>& point, const std::vector<Vec<D>>& positions,
                                        const VertexTuple<D>& face) {
  std::array<RationalVec<D>, D> result;
  for (int i = 0; i < D; ++i) result[i] = to_rational<D>(positions[face[i]]) - point;
  return result;
}

// The face of an element opposite to its vertex i, in any order.
template <int D>
VertexTuple<D> opposite(const VertexTuple<D + 1>& element, int i) {
  VertexTuple<D> face;
  int k = 0;
  for (int j = 0; j <= D; ++j) {
    if (j != i) face[k++] = element[j];
  }
  return face;
}

template <int D>
bool is_met(const std::array<RationalVec<D>, D>& face, const RationalVec<D>& direction, int first, int last) {
  if (dot(direction, direction) == 0) {
    const auto closest = closest_to_origin<D>(face);
    return dot(closest, closest) == 0;
  }
  const auto range = meet_line<D>(face, direction);
  return range && range->first <= last && range->second >= first;
}

template <int D>
std::array<Rational, D + 1> barycentric_signs(const std::array<RationalVec<D>, D + 1>& v) {
  // Volumes with vertex i replaced by the origin, all times the sign of the whole.
  std::array<Rational, D + 1> result;
  Rational total = 0;
  for (int i = 0; i <= D; ++i) {
    auto w = v;
    w[i] = {};
    if constexpr (D == 2) {
      result[i] = determinant(w[1] - w[0], w[2] - w[0]);
    } else {
      result[i] = determinant(w[1] - w[0], w[2] - w[0], w[3] - w[0]);
    }
    total += result[i];
  }
  for (auto& x : result) x = total == 0 ? Rational(-1) : total < 0 ? Rational(-x) : x;
  return result;
}

struct Candidate {
  Rational squared;
  Index face;
};

}  // namespace

template <int D>
unsigned Oracle<D>::faces_of_flat_met(Index element, const Vec<D>& point, Index face, int first, int last) const {
  const auto p = to_rational<D>(point);
  const auto direction = closest_to_origin<D>(seen_from<D>(p, scaled_, faces_[face].vertices));
  unsigned mask = 0;
  for (int i = 0; i <= D; ++i) {
    if (is_met<D>(seen_from<D>(p, scaled_, opposite<D>(elements_[element], i)), direction, first, last))
      mask |= 1u << i;
  }
  return mask;
}

template <int D>
OracleAnswer Oracle<D>::shortest_path_rational(const Vec<D>& point, Index element,
                                               const std::array<Index, 2>& source) const {
  OracleAnswer answer;
  const auto p = to_rational<D>(point);
  std::array<RationalVec<D>, D + 1> corners;
  for (int i = 0; i <= D; ++i) corners[i] = to_rational<D>(positions_[elements_[element][i]]) - p;
  const auto signs = barycentric_signs<D>(corners);
  answer.in_element = std::all_of(signs.begin(), signs.end(), [](const Rational& x) { return x >= 0; });
  if (!answer.in_element) return answer;

  std::vector<Candidate> order;
  for (Index f = 0; f < static_cast<Index>(faces_.size()); ++f) {
    if (is_excluded(f, source) || orientations_[faces_[f].owner] <= 0) continue;
    const auto s = closest_to_origin<D>(seen_from<D>(p, positions_, faces_[f].vertices));
    const Rational squared = dot(s, s);
    if (source[0] != kNone || squared != 0) order.push_back({squared, f});
  }
  std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.squared < b.squared; });
  for (const auto& candidate : order) {
    if (!connects_in_rationals(point, element, candidate.face)) continue;
    answer.found = true;
    answer.face = candidate.face;
    answer.distance = root_of_fraction(numerator(candidate.squared), denominator(candidate.squared), 0);
    break;
  }
  return answer;
}

template <int D>
bool Oracle<D>::connects_in_rationals(const Vec<D>& point, Index from, Index face) const {
  const auto p = to_rational<D>(point);
  const auto direction = closest_to_origin<D>(seen_from<D>(p, positions_, faces_[face].vertices));
  const int first = clean_[from] ? 0 : -1, last = clean_[from] ? 1 : 3;
  std::set<Index> seen{from};
  std::vector<Index> stack{from};
  while (!stack.empty()) {
    const Index e = stack.back();
    stack.pop_back();
    for (int i = 0; i <= D; ++i) {
      const Index next = neighbours_[e][i];
      if (next == kNone || seen.count(next)) continue;
      if (!is_met<D>(seen_from<D>(p, positions_, opposite<D>(elements_[e], i)), direction, first, last)) continue;
      seen.insert(next);
      stack.push_back(next);
    }
  }
  return seen.count(faces_[face].owner) > 0;
}

template unsigned Oracle<2>::faces_of_flat_met(Index, const Vec2&, Index, int, int) const;
template unsigned Oracle<3>::faces_of_flat_met(Index, const Vec3&, Index, int, int) const;
template OracleAnswer Oracle<2>::shortest_path_rational(const Vec2&, Index, const std::array<Index, 2>&) const;
template OracleAnswer Oracle<3>::shortest_path_rational(const Vec3&, Index, const std::array<Index, 2>&) const;
template bool Oracle<2>::connects_in_rationals(const Vec2&, Index, Index) const;
template bool Oracle<3>::connects_in_rationals(const Vec3&, Index, Index) const;

}  // namespace selvage::oracle
