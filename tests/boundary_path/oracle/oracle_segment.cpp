#include "boundary_path/oracle/oracle_segment.h"

#include "boundary_path/oracle/closest_double.h"

namespace selvage::oracle {

namespace {

// Keeps the best of several points, each a vector over a positive weight.
template <int D>
struct Best {
  IntegerVec<D> vector;
  Integer weight = 0;
  void offer(const IntegerVec<D>& v, const Integer& w) {
    if (weight != 0 && dot(v, v) * weight * weight >= dot(vector, vector) * w * w) return;
    vector = v;
    weight = w;
  }
  void offer_edge(const IntegerVec<D>& a, const IntegerVec<D>& b) {
    const IntegerVec<D> e = b - a;
    const Integer length = dot(e, e), s = -dot(a, e);
    if (s <= 0 || s >= length) return;
    IntegerVec<D> v;
    for (int i = 0; i < D; ++i) v[i] = a[i] * length + e[i] * s;
    offer(v, length);
  }
};

// Closest point to the origin on a face: the result is first / second.
std::pair<IntegerVec<2>, Integer> closest_exactly(const std::array<IntegerVec<2>, 2>& face) {
  Best<2> best;
  for (const auto& v : face) best.offer(v, 1);
  best.offer_edge(face[0], face[1]);
  return {best.vector, best.weight};
}

std::pair<IntegerVec<3>, Integer> closest_exactly(const std::array<IntegerVec<3>, 3>& face) {
  const auto& [a, b, c] = face;
  const IntegerVec<3> n = cross(b - a, c - a);
  const Integer area = dot(n, n);
  if (area != 0 && dot(n, cross(a, b)) > 0 && dot(n, cross(b, c)) > 0 && dot(n, cross(c, a)) > 0) {
    const Integer height = dot(n, a);
    return {{n[0] * height, n[1] * height, n[2] * height}, area};
  }
  Best<3> best;
  for (int i = 0; i < 3; ++i) {
    best.offer(face[i], 1);
    best.offer_edge(face[i], face[(i + 1) % 3]);
  }
  return {best.vector, best.weight};
}

// Volumes of the element with vertex i replaced by the origin.
template <typename T>
std::array<T, 3> volumes(const std::array<std::array<T, 2>, 3>& v) {
  return {determinant(v[1], v[2]), determinant(v[2], v[0]), determinant(v[0], v[1])};
}

template <typename T>
std::array<T, 4> volumes(const std::array<std::array<T, 3>, 4>& v) {
  return {determinant(v[1], v[2], v[3]), T(-determinant(v[0], v[2], v[3])), determinant(v[0], v[1], v[3]),
          T(-determinant(v[0], v[1], v[2]))};
}

// How these volumes change when the origin moves by d.
template <typename T>
std::array<T, 3> volume_changes(const std::array<std::array<T, 2>, 3>& v, const std::array<T, 2>& d) {
  std::array<T, 3> result;
  for (int i = 0; i < 3; ++i) result[i] = determinant(v[(i + 2) % 3] - v[(i + 1) % 3], d);
  return result;
}

template <typename T>
std::array<T, 4> volume_changes(const std::array<std::array<T, 3>, 4>& v, const std::array<T, 3>& d) {
  constexpr int kFaces[4][3] = {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}};  // inward
  std::array<T, 4> result;
  for (int i = 0; i < 4; ++i) {
    const auto& f = kFaces[i];
    result[i] = determinant(v[f[1]] - v[f[0]], v[f[2]] - v[f[0]], d);
  }
  return result;
}

// Decides from exact a_i + u c_i / weight >= 0 (all i, inside the element) which faces the range of u meets.
template <int N>
unsigned met_faces(const std::array<Integer, N>& a, const std::array<Integer, N>& c, const Integer& weight, int first,
                   int last) {
  unsigned mask = 0;
  for (int i = 0; i < N; ++i) {
    bool met = true;
    if (c[i] != 0) {
      const int sign = c[i] > 0 ? 1 : -1;
      const Integer u = -a[i] * weight * sign, one = c[i] * sign;  // the crossing is at u / one
      met = u >= first * one && u <= last * one;
      for (int j = 0; met && j < N; ++j) {
        if (j != i) met = (a[j] * c[i] - a[i] * c[j]) * sign >= 0;
      }
    } else if (a[i] == 0) {
      Rational from = first, to = last;
      for (int j = 0; met && j < N; ++j) {
        if (c[j] == 0) {
          met = a[j] >= 0;
        } else {
          const Rational u = Rational(Integer(-a[j] * weight)) / Rational(c[j]);
          if (c[j] > 0 && u > from) from = u;
          if (c[j] < 0 && u < to) to = u;
        }
      }
      met = met && from <= to;
    } else {
      met = false;
    }
    if (met) mask |= 1u << i;
  }
  return mask;
}

}  // namespace

template <int D>
typename Oracle<D>::Segment Oracle<D>::make_segment(const Vec<D>& point, Index face, bool prolonged) const {
  Segment segment;
  segment.point = point;
  segment.face = face;
  segment.first = prolonged ? -1 : 0;
  segment.last = prolonged ? 3 : 1;
  const ClosestDouble<D> closest = closest_in_doubles<D>(scaled_, faces_[face].vertices, point);
  segment.direction = closest.offset;
  segment.trusted = closest.trusted;
  return segment;
}

template <int D>
void Oracle<D>::make_exact(Segment& segment) const {
  if (segment.is_exact) return;
  segment.is_exact = true;
  segment.bits = std::max(fraction_bits_, fraction_bits<D>(segment.point));
  segment.exact_point = to_integer<D>(segment.point, segment.bits);
  std::array<IntegerVec<D>, D> face;
  for (int i = 0; i < D; ++i) {
    face[i] = to_integer<D>(scaled_[faces_[segment.face].vertices[i]], segment.bits) - segment.exact_point;
  }
  std::tie(segment.exact_direction, segment.weight) = closest_exactly(face);
}

template <int D>
double Oracle<D>::exact_length(Segment& segment) const {
  make_exact(segment);
  const auto& d = segment.exact_direction;
  return std::ldexp(root_of_fraction(dot(d, d), segment.weight * segment.weight, segment.bits), scale_exponent_);
}

template <int D>
unsigned Oracle<D>::faces_met_exactly(Index element, const Segment& segment) const {
  std::array<IntegerVec<D>, D + 1> v;
  for (int i = 0; i <= D; ++i) {
    v[i] = to_integer<D>(scaled_[elements_[element][i]], segment.bits) - segment.exact_point;
  }
  auto a = volumes(v), c = volume_changes(v, segment.exact_direction);
  if (orientations_[element] < 0) {
    for (int i = 0; i <= D; ++i) {
      a[i] = -a[i];
      c[i] = -c[i];
    }
  }
  return met_faces<D + 1>(a, c, segment.weight, segment.first, segment.last);
}

// Bits of the faces that are met; the double arithmetic decides when every sign is beyond its margin.
template <int D>
unsigned Oracle<D>::faces_met(Index element, Segment& segment) const {
  if (orientations_[element] == 0)
    return faces_of_flat_met(element, segment.point, segment.face, segment.first, segment.last);
  if (segment.trusted) {
    std::array<std::array<double, D>, D + 1> v;
    std::array<double, D> d;
    double size = 0;
    for (int k = 0; k < D; ++k) {
      d[k] = segment.direction[k];
      size = std::max(size, segment.last * std::abs(d[k]));
      for (int i = 0; i <= D; ++i) {
        v[i][k] = scaled_[elements_[element][i]][k] - segment.point[k];
        size = std::max(size, std::abs(v[i][k]));
      }
    }
    auto a = volumes(v), c = volume_changes(v, d);
    if (orientations_[element] < 0) {
      for (int i = 0; i <= D; ++i) {
        a[i] = -a[i];
        c[i] = -c[i];
      }
    }
    const int mask = met_faces_in_doubles<D + 1>(a, c, 1e-11 * std::pow(size, D), segment.first, segment.last);
    if (mask >= 0) return static_cast<unsigned>(mask);
  }
  make_exact(segment);
  return faces_met_exactly(element, segment);
}

template <int D>
bool Oracle<D>::connects(Index from, Index to, Segment& segment, Workspace& workspace) const {
  workspace.stamp.resize(elements_.size(), 0);
  const std::int64_t search = ++workspace.search;
  workspace.stack.assign(1, from);
  workspace.stamp[from] = search;
  while (!workspace.stack.empty()) {
    const Index element = workspace.stack.back();
    workspace.stack.pop_back();
    if (element == to) return true;
    const unsigned met = faces_met(element, segment);
    for (int i = 0; i <= D; ++i) {
      const Index next = neighbours_[element][i];
      if (!(met >> i & 1) || next == kNone || workspace.stamp[next] == search) continue;
      workspace.stamp[next] = search;
      workspace.stack.push_back(next);
    }
  }
  return false;
}

template Oracle<2>::Segment Oracle<2>::make_segment(const Vec2&, Index, bool) const;
template Oracle<3>::Segment Oracle<3>::make_segment(const Vec3&, Index, bool) const;
template void Oracle<2>::make_exact(Segment&) const;
template void Oracle<3>::make_exact(Segment&) const;
template double Oracle<2>::exact_length(Segment&) const;
template double Oracle<3>::exact_length(Segment&) const;
template unsigned Oracle<2>::faces_met_exactly(Index, const Segment&) const;
template unsigned Oracle<3>::faces_met_exactly(Index, const Segment&) const;
template unsigned Oracle<2>::faces_met(Index, Segment&) const;
template unsigned Oracle<3>::faces_met(Index, Segment&) const;
template bool Oracle<2>::connects(Index, Index, Segment&, Workspace&) const;
template bool Oracle<3>::connects(Index, Index, Segment&, Workspace&) const;

}  // namespace selvage::oracle
