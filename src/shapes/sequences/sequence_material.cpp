#include "shapes/sequences/sequence_material.h"

#include <cstdlib>

namespace selvage {

namespace {

/// A cell a, b, c, d (around it) in two, alternately along either diagonal.
void add_cell(std::vector<VertexTuple<3>>& triangles, bool even, Index a, Index b, Index c, Index d) {
  if (even) {
    triangles.push_back({a, b, c});
    triangles.push_back({a, c, d});
  } else {
    triangles.push_back({a, b, d});
    triangles.push_back({b, c, d});
  }
}

/// The pattern of a shirt in cells, x from -12k to 12k, y from 0 to 17k.
struct ShirtPattern {
  Index k;

  Index reach() const { return 12 * k; }
  Index height() const { return 17 * k; }

  /// Whether the cell with its lower left corner there belongs to the shirt.
  bool has_cell(Index x, Index y) const {
    if (y < 0 || y >= height() || x < -reach() || x >= reach()) return false;
    const bool on_body = x >= -7 * k && x < 7 * k, on_sleeves = y >= 12 * k;
    const bool in_neck = x >= -2 * k && x < 2 * k && y >= 15 * k;
    return (on_body || on_sleeves) && !in_neck;
  }
  int cells_around(Index x, Index y) const {
    return has_cell(x, y) + has_cell(x - 1, y) + has_cell(x, y - 1) + has_cell(x - 1, y - 1);
  }
  /// Whether front and back have one vertex there: on the outline, unless an opening goes on to both sides of it.
  bool is_sewn(Index x, Index y) const {
    if (cells_around(x, y) == 4) return false;
    const bool in_hem = y == 0 && std::abs(x) < 7 * k;
    const bool in_cuff = std::abs(x) == reach() && y > 12 * k && y < height();
    const bool in_neck = std::abs(x) <= 2 * k && y >= 15 * k && !(std::abs(x) == 2 * k && y == height());
    return !in_hem && !in_cuff && !in_neck;
  }
};

}  // namespace

void add_piece(Material& material, Index columns, Index rows, bool is_tube) {
  const Index first = static_cast<Index>(material.places.size()), wide = is_tube ? columns : columns + 1;
  const double piece = first == 0 ? 0 : material.places.back()[2] + 1;
  for (Index j = 0; j <= rows; ++j)
    for (Index i = 0; i < wide; ++i) material.places.emplace_back(double(i) / columns, double(j) / rows, piece);
  const auto vertex = [&](Index i, Index j) { return first + j * wide + i % wide; };
  for (Index j = 0; j < rows; ++j)
    for (Index i = 0; i < columns; ++i)
      add_cell(material.triangles, (i + j) % 2 == 0, vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1),
               vertex(i, j + 1));
}

Material make_shirt(Index k) {
  const ShirtPattern pattern{k};
  const Index wide = 2 * pattern.reach() + 1, high = pattern.height() + 1;
  Material shirt;
  std::vector<std::array<Index, 2>> vertices(static_cast<std::size_t>(wide) * high, {kNone, kNone});
  const auto slot = [&](Index x, Index y) -> std::array<Index, 2>& {
    return vertices[static_cast<std::size_t>(y) * wide + x + pattern.reach()];
  };
  const auto add_vertex = [&](Index x, Index y, int side) {
    shirt.places.emplace_back(double(x) / k, double(y) / k, side);
    return static_cast<Index>(shirt.places.size()) - 1;
  };
  for (Index y = 0; y < high; ++y)
    for (Index x = -pattern.reach(); x <= pattern.reach(); ++x) {
      if (pattern.cells_around(x, y) == 0) continue;
      const bool sewn = pattern.is_sewn(x, y);
      const Index front = add_vertex(x, y, sewn ? 0 : 1);
      slot(x, y) = {front, sewn ? front : add_vertex(x, y, -1)};
    }
  for (const int side : {0, 1})
    for (Index y = 0; y + 1 < high; ++y)
      for (Index x = -pattern.reach(); x < pattern.reach(); ++x) {
        if (!pattern.has_cell(x, y)) continue;
        const Index a = slot(x, y)[side], b = slot(x + 1, y)[side], c = slot(x + 1, y + 1)[side],
                    d = slot(x, y + 1)[side];
        const bool even = (x + y + 2 * pattern.reach()) % 2 == 0;
        if (side == 0)
          add_cell(shirt.triangles, even, a, b, c, d);
        else
          add_cell(shirt.triangles, even, b, a, d, c);
      }
  return shirt;
}

}  // namespace selvage
