#pragma once

#include "bvh/bvh.h"

#include <cmath>
#include <functional>
#include <string>

#include "random.h"

namespace selvage::test {

using Boxes = std::vector<Box>;

inline Box make_box(double x, double y, double z, double dx, double dy, double dz) {
  return enclosing_box<3>(Vec3(x, y, z), Vec3(x + dx, y + dy, z + dz));
}

/// A family of box sets: every property is tested on all of them.
struct BoxFamily {
  std::string name;
  std::function<Boxes(Index count, Random& random)> make;
};

inline Boxes make_boxes(Index count, const std::function<Box(Index)>& make) {
  Boxes boxes;
  for (Index i = 0; i < count; ++i) boxes.push_back(make(i));
  return boxes;
}

inline Boxes scaled_boxes(Index count, Random& r, double scale, double origin) {
  return make_boxes(count, [&](Index) {
    return make_box(origin + scale * r.unit(), origin + scale * r.unit(), origin + scale * r.unit(),
                    0.1 * scale * r.unit(), 0.1 * scale * r.unit(), 0.1 * scale * r.unit());
  });
}

inline Boxes clustered_boxes(Index count, Random& r) {
  return make_boxes(count, [&](Index i) {
    const double centre = 100.0 * (i % 5), spread = std::pow(10.0, -(i % 5));
    return make_box(centre + spread * r.unit(), spread * r.unit(), spread * r.unit(), 0.1 * spread, 0.2 * spread,
                    0.1 * spread * r.unit());
  });
}

/// Ordinary boxes among some that are unbounded or empty.
inline Boxes boxes_with_infinite(Index count, Random& r) {
  Boxes boxes = scaled_boxes(count, r, 1, 0);
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (Index i = 0; i < count; i += 7) {
    boxes[i].upper[i % 3] = kInfinity;
    if (i % 2 == 0) boxes[i].lower[i % 3] = -kInfinity;
    if (i % 5 == 0) boxes[i] = Box::empty();
  }
  return boxes;
}

inline const std::vector<BoxFamily>& box_families() {
  static const std::vector<BoxFamily> families = {
      {"random", [](Index n, Random& r) { return scaled_boxes(n, r, 1, 0); }},
      {"far_from_origin", [](Index n, Random& r) { return scaled_boxes(n, r, 1, 1e5); }},
      {"tiny", [](Index n, Random& r) { return scaled_boxes(n, r, 1e-22, 0); }},
      {"denormal", [](Index n, Random& r) { return scaled_boxes(n, r, 1e-43, 0); }},
      {"huge", [](Index n, Random& r) { return scaled_boxes(n, r, 1e25, -5e24); }},
      {"beyond_float", [](Index n, Random& r) { return scaled_boxes(n, r, 1e39, -5e38); }},
      {"clustered", clustered_boxes},
      {"points",
       [](Index n, Random& r) {
         return make_boxes(n, [&](Index) { return make_box(r.unit(), r.unit(), r.unit(), 0, 0, 0); });
       }},
      {"same", [](Index n, Random&) { return Boxes(n, make_box(1, 2, 3, 0.5, 0.5, 0.5)); }},
      {"same_point", [](Index n, Random&) { return Boxes(n, make_box(0, 0, 0, 0, 0, 0)); }},
      {"concentric",
       [](Index n, Random&) {
         return make_boxes(n, [](Index i) { return make_box(-i, -i, -i, 2 * i, 2 * i, 2 * i); });
       }},
      {"collinear",
       [](Index n, Random& r) {
         return make_boxes(n, [&](Index) { return make_box(r.unit(), 0, 0, 0.01 * r.unit(), 0, 0); });
       }},
      {"flat",
       [](Index n, Random& r) {
         return make_boxes(n, [&](Index) { return make_box(r.unit(), r.unit(), 0, 0.03 * r.unit(), 0.03, 0); });
       }},
      {"geometric",
       [](Index n, Random&) {
         return make_boxes(n, [](Index i) { return make_box(std::pow(0.9, i), 0, 0, 0.05 * std::pow(0.9, i), 0, 1); });
       }},
      {"unbounded", boxes_with_infinite},
  };
  return families;
}

/// A box moved and stretched at random, by about its own family's size.
inline Boxes moved_boxes(const Boxes& boxes, Random& r) {
  Boxes moved = boxes;
  for (Box& box : moved)
    for (int axis = 0; axis < 3; ++axis) {
      const float size = std::abs(box.upper[axis]) * static_cast<float>(r.within(-1, 1));
      if (!(std::abs(size) < 1e37f)) continue;
      box.lower[axis] += size;
      box.upper[axis] += size;
      box.upper[axis] = std::max(box.upper[axis], box.lower[axis]);
    }
  return moved;
}

inline bool overlap(const Box& a, const Box& b) {
  for (int axis = 0; axis < 3; ++axis)
    if (!(a.lower[axis] <= b.upper[axis] && b.lower[axis] <= a.upper[axis])) return false;
  return true;
}

inline bool is_empty(const Box& box) {
  return !overlap(box, box);
}

/// The squared distance between two boxes, in long double: exact but for its last bits.
inline long double squared_distance(const Box& a, const Box& b) {
  long double sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const long double below = static_cast<long double>(a.lower[axis]) - b.upper[axis];
    const long double above = static_cast<long double>(b.lower[axis]) - a.upper[axis];
    const long double gap = std::max({0.0L, below, above});  // 0 where both ends are the same infinity
    sum += gap * gap;
  }
  return sum;
}

}  // namespace selvage::test
