#include "self_collision/culling_surfaces.h"

#include <array>
#include <cmath>
#include <map>
#include <numbers>

namespace selvage::surfaces {

namespace {

/// Adds the two triangles of a cell, counter-clockwise.
void add_cell(Surface& surface, Index a, Index b, Index c, Index d) {
  surface.triangles.push_back({a, b, c});
  surface.triangles.push_back({a, c, d});
}

Surface rectangle(double width, double height, int columns, int rows) {
  Surface surface;
  for (int r = 0; r <= rows; ++r)
    for (int c = 0; c <= columns; ++c)
      surface.positions.emplace_back(width * (double(c) / columns - 0.5), height * (double(r) / rows - 0.5), 0);
  const auto at = [&](int r, int c) { return static_cast<Index>(r * (columns + 1) + c); };
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) add_cell(surface, at(r, c), at(r, c + 1), at(r + 1, c + 1), at(r + 1, c));
  return surface;
}

}  // namespace

Surface waved_sheet(Random& random) {
  Surface surface = sheet(8 + random.below(17), 8 + random.below(17), random);
  const double strength = std::pow(random.unit(), 2) * 4;
  std::array<Vec3, 4> directions, waves;
  std::array<double, 4> phases;
  for (int k = 0; k < 4; ++k) {
    directions[k] = Vec3(random.within(-1, 1), random.within(-1, 1), random.within(-1, 1));
    waves[k] = Vec3(random.within(-1, 1), random.within(-1, 1), 0);
    phases[k] = random.within(0, 6);
  }
  for (Vec3& x : surface.positions) {
    const Vec3 at = x;
    for (int k = 0; k < 4; ++k) x += strength * std::sin(waves[k].dot(at) + phases[k]) * directions[k];
  }
  return surface;
}

Surface crossed_rectangles() {
  Surface along = rectangle(6, 2, 30, 10), across = rectangle(2, 6, 10, 30);
  for (Vec3& x : along.positions) x[2] = 0.07 * (x[0] + 0.013);
  for (Vec3& x : across.positions) x[2] = -0.07 * (x[0] + 0.013);
  return together(along, across);
}

Surface comb(double lean) {
  constexpr Index kColumns = 33, kRows = 20, kSpine = 4, kTooth = 2;  // teeth two cells wide, two apart
  Surface surface;
  for (Index row = 0; row <= kRows; ++row)
    for (Index column = 0; column < kColumns; ++column) {
      const bool leans = column / (2 * kTooth) % 2 == 0;
      const double height = std::max<Index>(0, row - kSpine), part = height / (kRows - kSpine);
      const double x = column + (leans ? 2 * kTooth * lean * part : 0);
      surface.positions.emplace_back(x, row, leans ? 0.05 * (height - 0.7 * (kRows - kSpine)) * part : 0);
    }
  for (Index row = 0; row < kRows; ++row)
    for (Index column = 0; column + 1 < kColumns; ++column) {
      if (row >= kSpine && column % (2 * kTooth) >= kTooth) continue;
      const Index a = row * kColumns + column, b = a + 1, c = a + kColumns, d = c + 1;
      surface.triangles.push_back({a, b, d});
      surface.triangles.push_back({a, d, c});
    }
  return surface;
}

Surface overwound_sector(double turn) {
  constexpr int kSteps = 61, kRings = 8;
  Surface surface;
  surface.positions.push_back(Vec3::Zero());
  for (int i = 0; i <= kSteps; ++i) {
    const double degrees = -45 + 450.0 * i / kSteps, radius = 1 + 0.2 * i / kSteps;
    const double slope = 0.1 * std::clamp(degrees < 180 ? degrees / 45 : (360 - degrees) / 45, -1.0, 1.0);
    const double angle = (degrees + turn) * std::numbers::pi / 180;
    for (int ring = 1; ring <= kRings; ++ring) {
      const double r = radius * ring / kRings;
      surface.positions.emplace_back(r * std::cos(angle), r * std::sin(angle), r * slope);
    }
  }
  const auto at = [&](int i, int ring) { return ring == 0 ? Index{0} : static_cast<Index>(1 + i * kRings + ring - 1); };
  for (int i = 0; i < kSteps; ++i) {
    surface.triangles.push_back({0, at(i, 1), at(i + 1, 1)});
    for (int ring = 1; ring < kRings; ++ring)
      add_cell(surface, at(i, ring), at(i, ring + 1), at(i + 1, ring + 1), at(i + 1, ring));
  }
  return surface;
}

Surface crosswise_squares() {
  constexpr int kSlit = 2;  // from (-2, 0) to (2, 0)
  Surface surface;
  // A vertex is known by its sheet, its place, and within the slit by the side of the sheet 0 that it belongs to.
  std::map<std::array<int, 4>, Index> numbers;
  const auto vertex = [&](int sheet, int x, int y, bool above) {
    std::array<int, 4> key{sheet, x, y, 0};
    if (y == 0 && std::abs(x) <= kSlit) key = {0, x, y, std::abs(x) == kSlit ? 0 : 1 + int((sheet == 0) == above)};
    const auto [found, is_new] = numbers.emplace(key, static_cast<Index>(surface.positions.size()));
    if (is_new) {
      const double tilt = 0.05 * (y + 0.3),
                   height = key[3] == 0 ? (sheet == 0 ? tilt : -tilt) : 0.05 * (key[3] == 2 ? 1 : -1);
      surface.positions.emplace_back(x, y, y == 0 && std::abs(x) == kSlit ? 0 : height);
    }
    return found->second;
  };
  for (const int sheet : {0, 1}) {
    const int half = sheet == 0 ? 9 : 7;
    for (int y = -half; y < half; ++y)
      for (int x = -half; x < half; ++x)
        add_cell(surface, vertex(sheet, x, y, y >= 0), vertex(sheet, x + 1, y, y >= 0),
                 vertex(sheet, x + 1, y + 1, y >= 0), vertex(sheet, x, y + 1, y >= 0));
  }
  return surface;
}

Surface pushed_through(Random& random) {
  constexpr int kCells = 20;
  Surface top = rectangle(4, 4, kCells, kCells), bottom = top;
  for (VertexTuple<3>& t : bottom.triangles) std::swap(t[1], t[2]);
  const double depth = random.within(0.9, 1.4), x0 = random.within(-0.5, 0.5), y0 = random.within(-0.5, 0.5);
  for (Vec3& x : top.positions) {
    const bool is_rim = std::abs(x[0]) > 1.99 || std::abs(x[1]) > 1.99;
    x[2] = is_rim ? 0 : 0.5 - depth * std::exp(-std::pow(x[0] - x0, 2) - std::pow(x[1] - y0, 2));
  }
  // The bottom takes the top's rim as its own.
  const auto count = static_cast<Index>(top.positions.size());
  std::vector<Index> number(bottom.positions.size());
  for (Index v = 0; v < count; ++v) {
    const Vec3& x = bottom.positions[v];
    const bool is_rim = std::abs(x[0]) > 1.99 || std::abs(x[1]) > 1.99;
    number[v] = is_rim ? v : static_cast<Index>(top.positions.size());
    if (!is_rim) top.positions.emplace_back(x[0] + 0.013, x[1] + 0.017, -0.1);
  }
  for (const VertexTuple<3>& t : bottom.triangles) top.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
  return top;
}

}  // namespace selvage::surfaces
