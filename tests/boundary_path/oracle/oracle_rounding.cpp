// What rounding the closest point can do to the validity of its path.
#include "boundary_path/oracle/oracle_segment.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace selvage::oracle {

namespace {

template <int D>
IntegerVec<D> combine(const IntegerVec<D>& a, const Integer& s, const IntegerVec<D>& b, const Integer& t) {
  IntegerVec<D> result;
  for (int k = 0; k < D; ++k) result[k] = a[k] * s + b[k] * t;
  return result;
}

bool is_parallel(const IntegerVec<2>& a, const IntegerVec<2>& b) {
  return determinant(a, b) == 0;
}
bool is_parallel(const IntegerVec<3>& a, const IntegerVec<3>& b) {
  return cross(a, b) == IntegerVec<3>{};
}

// Directions in which rounding can move the closest point s = vector / weight on the face: none at a vertex, along the
// edge on an edge, along all edges inside the face.
template <int D>
std::vector<IntegerVec<D>> slides(const std::array<IntegerVec<D>, D>& face, const IntegerVec<D>& vector,
                                  const Integer& weight) {
  std::vector<IntegerVec<D>> all;
  for (int i = 0; i < D; ++i) {
    const IntegerVec<D> from_vertex = combine<D>(vector, 1, face[i], -weight);
    if (from_vertex == IntegerVec<D>{}) return {};
    for (int j = i + 1; j < D; ++j) {
      const IntegerVec<D> edge = face[j] - face[i];
      if (is_parallel(from_vertex, edge)) return {edge};
      all.push_back(edge);
    }
  }
  return all;
}

// The power of two, as -log2, that makes a slide along a vector of this length about as long as the step.
int slide_bits(double step, double length) {
  return std::max(0, static_cast<int>(std::ceil(std::log2(length / step))));
}

}  // namespace

template <int D>
bool Oracle<D>::is_grazing(const Vec<D>& point, Index element, Index face, Workspace& workspace) const {
  const bool valid = is_valid(point, element, face, workspace);
  Segment segment = make_segment(point * std::ldexp(1.0, -scale_exponent_), face, !clean_[element]);
  make_exact(segment);
  segment.trusted = false;
  double magnitude = 0;
  std::array<IntegerVec<D>, D> corners;
  for (int i = 0; i < D; ++i) {
    const Vec<D>& x = scaled_[faces_[face].vertices[i]];
    magnitude = std::max(magnitude, x.cwiseAbs().maxCoeff());
    corners[i] = to_integer<D>(x, segment.bits) - segment.exact_point;
  }
  const double step = 4 * std::numeric_limits<double>::epsilon() * magnitude;
  for (const auto& slide : slides<D>(corners, segment.exact_direction, segment.weight)) {
    const double length = root_of_fraction(dot(slide, slide), 1, segment.bits);
    for (const int finer : {0, 3}) {
      const Integer parts = Integer(1) << (slide_bits(step, length) + finer);
      for (const int sign : {-1, 1}) {
        Segment moved = segment;
        moved.exact_direction = combine<D>(segment.exact_direction, parts, slide, segment.weight * sign);
        moved.weight = segment.weight * parts;
        if (connects(element, faces_[face].owner, moved, workspace) != valid) return true;
      }
    }
  }
  return false;
}

template <int D>
bool Oracle<D>::only_grazing_below(double distance, const Vec<D>& point, Index element,
                                   const std::array<Index, 2>& source, Workspace& workspace) const {
  for (Index f = 0; f < static_cast<Index>(faces_.size()); ++f) {
    if (orientations_[faces_[f].owner] <= 0 || is_excluded(f, source)) continue;
    const double d = face_distance(point, f);
    if (d >= distance || (source[0] == kNone && d == 0)) continue;
    if (is_valid(point, element, f, workspace) && !is_grazing(point, element, f, workspace)) return false;
  }
  return true;
}

template bool Oracle<2>::is_grazing(const Vec2&, Index, Index, Workspace&) const;
template bool Oracle<3>::is_grazing(const Vec3&, Index, Index, Workspace&) const;
template bool Oracle<2>::only_grazing_below(double, const Vec2&, Index, const std::array<Index, 2>&, Workspace&) const;
template bool Oracle<3>::only_grazing_below(double, const Vec3&, Index, const std::array<Index, 2>&, Workspace&) const;

}  // namespace selvage::oracle
