#include <fmt/ranges.h>

#include <algorithm>
#include <limits>

#include "selvage/shapes/shapes.h"
#include "shapes/rod_curves.h"
#include "shapes/shape_counts.h"
#include "shapes/shapes_implicit.h"

namespace selvage {

namespace {

/// A shape's measures, given or its own.
struct Measures {
  Vec3 size = Vec3::Ones();
  double length = 0, radius = 0, inner_radius = 0;
  int tentacles = 0;
  unsigned seed = 1;
  double slenderness = 1;
  int teeth = 0;
};

/// Which of the options a shape has.
enum Uses : unsigned {
  kSize = 1,
  kLength = 2,
  kRadius = 4,
  kInnerRadius = 8,
  kTentacles = 16,
  kSeed = 32,
  kSlenderness = 64,
  kTeeth = 128
};

struct NamedShape {
  std::string_view name;
  unsigned uses;
  Measures measures;  ///< by default
  double (*default_cell)(const Measures&);
  double (*coarsest)(const Measures&);            ///< largest cell that the maker takes
  double (*count)(const Measures&, double cell);  ///< elements; null where only making tells
  IndexedMesh (*make)(const Measures&, double cell);
};

double unlimited(const Measures&) {
  return std::numeric_limits<double>::infinity();
}
double count_box(const Measures& m, double cell) {
  return box_cells(m.size, cell).elements;
}
/// Eight cells across; fewer, down to one, where that made a thin plate of millions.
double box_cell(const Measures& m) {
  constexpr double kMaxElements = 50'000, kInCell = 6;
  const double thin = m.size.minCoeff();
  const double cell = std::cbrt(kInCell * m.size.prod() / kMaxElements);
  return std::max(thin / 8, cell < thin ? cell : std::sqrt(kInCell * m.size.prod() / thin / kMaxElements));
}
IndexedMesh make_box_of(const Measures& m, double cell) {
  return make_box(m.size, cell);
}
double rod_cell(const Measures& m) {
  return m.radius / 2;
}
template <RodCurve kCurve>
double count_rod(const Measures& m, double cell) {
  return swept_cells(m.length, m.radius, cell, fewest_layers(kCurve)).elements;
}
template <RodCurve kCurve>
IndexedMesh make_rod_of(const Measures& m, double cell) {
  return make_rod(kCurve, m.length, m.radius, cell);
}

constexpr unsigned kRod = kLength | kRadius;

const std::array<NamedShape, 16> kShapes = {{
    {"box", kSize, {.size = {1, 1, 1}}, box_cell, unlimited, count_box, make_box_of},
    {"beam",
     kSize,
     {.size = {6, 0.5, 0.5}},
     [](const Measures& m) { return m.size.minCoeff() / 4; },
     unlimited,
     count_box,
     make_box_of},
    {"rod",
     kRod,
     {.length = 6, .radius = 0.25},
     rod_cell,
     unlimited,
     count_rod<RodCurve::kStraight>,
     make_rod_of<RodCurve::kStraight>},
    {"trefoil",
     kRod,
     {.length = 20, .radius = 0.25},
     rod_cell,
     unlimited,
     count_rod<RodCurve::kTrefoil>,
     make_rod_of<RodCurve::kTrefoil>},
    {"nested-knot",
     kRod,
     {.length = 60, .radius = 0.25},
     rod_cell,
     unlimited,
     count_rod<RodCurve::kNestedKnot>,
     make_rod_of<RodCurve::kNestedKnot>},
    {"noodle",
     kRod,
     {.length = 60, .radius = 0.1},
     rod_cell,
     unlimited,
     count_rod<RodCurve::kCoil>,
     make_rod_of<RodCurve::kCoil>},
    {"overhand",
     kRod,
     {.length = 30, .radius = 0.25},
     rod_cell,
     unlimited,
     count_rod<RodCurve::kOverhand>,
     make_rod_of<RodCurve::kOverhand>},
    {"nested-overhand",
     kRod,
     {.length = 120, .radius = 0.25},
     rod_cell,
     unlimited,
     count_rod<RodCurve::kNestedOverhand>,
     make_rod_of<RodCurve::kNestedOverhand>},
    {"ball",
     kRadius,
     {.radius = 1},
     [](const Measures& m) { return m.radius / 6; },
     unlimited,
     nullptr,
     [](const Measures& m, double cell) { return make_ball(m.radius, cell); }},
    {"torus",
     kRadius | kInnerRadius,
     {.radius = 1, .inner_radius = 0.3},
     [](const Measures& m) { return m.inner_radius / 3; },
     unlimited,
     [](const Measures& m, double cell) {
       return swept_cells(2 * std::numbers::pi * m.radius, m.inner_radius, cell, kMinTorusLayers).elements;
     },
     [](const Measures& m, double cell) { return make_torus(m.radius, m.inner_radius, cell); }},
    {"tube",
     kRod | kInnerRadius,
     {.length = 4, .radius = 0.3, .inner_radius = 0.2},
     [](const Measures& m) { return m.radius / 4; },
     unlimited,
     [](const Measures& m, double cell) { return tube_cells(m.radius, m.inner_radius, m.length, cell).elements; },
     [](const Measures& m, double cell) { return make_tube(m.radius, m.inner_radius, m.length, cell); }},
    {"squishy-ball",
     kRadius | kTentacles | kSeed | kSlenderness,
     {.radius = 1, .tentacles = 200},
     [](const Measures& m) { return 0.9 * coarsest_cell(squishy_tip_radius(m.radius, m.tentacles)); },
     [](const Measures& m) { return coarsest_cell(squishy_tip_radius(m.radius, m.tentacles)); },
     nullptr,
     [](const Measures& m, double cell) {
       return make_squishy_ball(m.radius, m.tentacles, cell, m.seed, m.slenderness);
     }},
    {"octopus",
     kRadius | kSeed | kSlenderness,
     {.radius = 1},
     [](const Measures& m) { return 0.9 * coarsest_cell(octopus_tip_radius(m.radius, m.slenderness)); },
     [](const Measures& m) { return coarsest_cell(octopus_tip_radius(m.radius, m.slenderness)); },
     nullptr,
     [](const Measures& m, double cell) { return make_octopus(m.radius, cell, m.seed, m.slenderness); }},
    {"gear",
     kRod | kInnerRadius | kTeeth,
     {.length = 0.3, .radius = 1, .inner_radius = 0.3, .teeth = 12},
     [](const Measures& m) { return (m.radius - m.inner_radius) / 6; },
     unlimited,
     [](const Measures& m, double cell) {
       return gear_cells(m.radius, m.inner_radius, m.length, m.teeth, cell).elements;
     },
     [](const Measures& m, double cell) { return make_gear(m.radius, m.inner_radius, m.length, m.teeth, cell); }},
    {"cloth",
     kSize,
     {.size = {2, 2, 0}},
     [](const Measures& m) { return m.size.head<2>().minCoeff() / 20; },
     unlimited,
     [](const Measures& m, double cell) { return cloth_cells(m.size[0], m.size[1], cell).elements; },
     [](const Measures& m, double cell) { return make_cloth(m.size[0], m.size[1], cell); }},
    {"sleeve",
     kRod,
     {.length = 0.6, .radius = 0.1},
     [](const Measures& m) { return m.radius / 4; },
     unlimited,
     [](const Measures& m, double cell) { return sleeve_cells(m.radius, m.length, cell).elements; },
     [](const Measures& m, double cell) { return make_sleeve(m.radius, m.length, cell); }},
}};

const NamedShape& find_shape(std::string_view name) {
  if (name == "sphere") name = "ball";
  const auto found = std::find_if(kShapes.begin(), kShapes.end(), [&](const NamedShape& s) { return s.name == name; });
  if (found == kShapes.end()) {
    throw Error("shape", fmt::format("there is no shape '{}'", name),
                fmt::format("use one of {}", fmt::join(shape_names(), ", ")));
  }
  return *found;
}

/// The value given, or the shape's own where none is.
template <typename T>
void take(const NamedShape& shape, unsigned use, std::string_view option, const std::optional<T>& given, T& value) {
  if (!given) return;
  if ((shape.uses & use) == 0) throw Error(option, fmt::format("'{}' has no {}", shape.name, option), "leave it out");
  value = *given;
}

/// @throws Error  unless every measure that the shape has is one
Measures measures_of(const NamedShape& shape, const ShapeOptions& options) {
  Measures m = shape.measures;
  take(shape, kSize, "size", options.size, m.size);
  take(shape, kLength, "length", options.length, m.length);
  take(shape, kRadius, "radius", options.radius, m.radius);
  take(shape, kInnerRadius, "inner radius", options.inner_radius, m.inner_radius);
  take(shape, kTentacles, "tentacles", options.tentacles, m.tentacles);
  take(shape, kTeeth, "teeth", options.teeth, m.teeth);
  take(shape, kSeed, "seed", options.seed, m.seed);
  take(shape, kSlenderness, "slenderness", options.slenderness, m.slenderness);
  if (shape.uses & kSize) {
    for (int axis = 0; axis < (shape.name == "cloth" ? 2 : 3); ++axis) check_positive("size", m.size[axis]);
  }
  if (shape.uses & kLength) check_positive("length", m.length);
  if (shape.uses & kRadius) check_positive("radius", m.radius);
  if (shape.uses & kInnerRadius) check_positive("inner radius", m.inner_radius);
  if ((shape.uses & kTentacles) && m.tentacles < 1) {
    throw Error("tentacles", fmt::format("{} is out of range", m.tentacles), "use a number from 1 to 100000");
  }
  if (!(m.slenderness >= 1)) {
    throw Error("slenderness", fmt::format("{} is out of range", m.slenderness), "use 1 or more");
  }
  return m;
}

/// Number of elements by cell: exact where a formula tells, else a / cell^3 + b / cell^2 (volume and surface) through
/// two coarse meshes.
class ElementCount {
 public:
  ElementCount(const NamedShape& shape, const Measures& measures) : shape_(shape), measures_(measures) {
    if (shape.count != nullptr) return;
    const double c = shape.default_cell(measures), d = 0.7 * c;
    const double at_c = static_cast<double>(shape.make(measures, c).tetrahedra.size());
    const double at_d = static_cast<double>(shape.make(measures, d).tetrahedra.size());
    surface_ = (at_c * c * c * c - at_d * d * d * d) / (c - d);
    volume_ = at_c * c * c * c - surface_ * c;
  }
  double operator()(double cell) const {
    if (shape_.count != nullptr) return shape_.count(measures_, cell);
    return (volume_ + surface_ * cell) / (cell * cell * cell);
  }

 private:
  const NamedShape& shape_;
  Measures measures_;
  double volume_ = 0, surface_ = 0;
};

}  // namespace

std::span<const std::string_view> shape_names() {
  static constexpr std::array<std::string_view, 16> kNames = {
      "box",  "beam",  "rod",  "trefoil",      "nested-knot", "noodle", "overhand", "nested-overhand",
      "ball", "torus", "tube", "squishy-ball", "octopus",     "gear",   "cloth",    "sleeve"};
  return kNames;
}

std::span<const std::string_view> curve_names() {
  static constexpr std::array<std::string_view, 6> kNames = {"straight", "trefoil",  "nested-knot",
                                                             "coil",     "overhand", "nested-overhand"};
  return kNames;
}

std::string_view shape_along_curve(std::string_view curve) {
  const auto names = curve_names();
  const auto found = std::find(names.begin(), names.end(), curve);
  if (found == names.end())
    throw Error("curve", fmt::format("there is no curve '{}'", curve),
                fmt::format("use one of {}", fmt::join(names, ", ")));
  if (*found == "straight") return "rod";
  return *found == "coil" ? "noodle" : *found;
}

void centre_at_origin(std::span<Vec3> positions) {
  if (positions.empty()) return;
  Vec3 lower = positions[0], upper = positions[0];
  for (const Vec3& p : positions) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  const Vec3 middle = lower + (upper - lower) / 2;
  for (Vec3& p : positions) p -= middle;
}

double cell_for_element_count(std::string_view name, const ShapeOptions& options, std::int64_t target) {
  const NamedShape& shape = find_shape(name);
  if (target < 1) throw Error("elements", fmt::format("{} is not a number of elements", target), "use at least 1");
  check_element_count(static_cast<double>(target));
  const Measures measures = measures_of(shape, options);
  const ElementCount count(shape, measures);
  const double wanted = static_cast<double>(target), start = shape.default_cell(measures);
  double coarse = std::min(shape.coarsest(measures), start * 1e6), fine = start;
  if (count(coarse) > 1.5 * wanted) {
    throw Error("elements", fmt::format("{} are too few for the shape '{}'", target, shape.name),
                fmt::format("use at least {:.0f}", std::ceil(count(coarse))));
  }
  fine = std::min(fine, coarse);
  while (count(fine) < wanted) fine /= 2;
  for (int step = 0; step < 100; ++step) {
    const double middle = std::sqrt(fine * coarse);
    (count(middle) < wanted ? coarse : fine) = middle;
  }
  // The count jumps between the two: the nearer, as a ratio.
  return count(fine) / wanted <= wanted / count(coarse) ? fine : coarse;
}

IndexedMesh make_shape(std::string_view name, const ShapeOptions& options) {
  const NamedShape& shape = find_shape(name);
  if (options.cell && options.elements) {
    throw Error("cell", "both a cell and a number of elements are given", "give one of them");
  }
  const Measures measures = measures_of(shape, options);
  const double cell = options.cell       ? *options.cell
                      : options.elements ? cell_for_element_count(name, options, *options.elements)
                                         : shape.default_cell(measures);
  return shape.make(measures, cell);
}

}  // namespace selvage
