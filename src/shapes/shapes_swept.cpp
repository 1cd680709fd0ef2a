#include <numbers>

#include "selvage/shapes/shapes.h"
#include "shapes/cell_splits.h"
#include "shapes/rod_curves.h"
#include "shapes/shape_counts.h"

namespace selvage {

namespace {

/// The unit disc as rings of 6, 12, 18... vertices around its centre, triangles counter-clockwise.
struct DiscMesh {
  std::vector<Vec2> points;
  std::vector<VertexTuple<3>> triangles;
};

DiscMesh make_disc(Index rings) {
  DiscMesh disc;
  disc.points.emplace_back(0, 0);
  const auto vertex = [](Index ring, Index i) { return ring == 0 ? 0 : 1 + 3 * ring * (ring - 1) + i % (6 * ring); };
  for (Index ring = 1; ring <= rings; ++ring) {
    for (Index i = 0; i < 6 * ring; ++i) {
      const double angle = 2 * std::numbers::pi * i / (6 * ring);
      disc.points.push_back(Vec2(std::cos(angle), std::sin(angle)) * ring / rings);
    }
    for (Index sector = 0; sector < 6; ++sector) {
      for (Index j = 0; j < ring; ++j) {
        const Index outer = sector * ring + j, inner = sector * (ring - 1) + j;
        disc.triangles.push_back({vertex(ring, outer), vertex(ring, outer + 1), vertex(ring - 1, inner)});
        if (j + 1 < ring) {
          disc.triangles.push_back({vertex(ring, outer + 1), vertex(ring - 1, inner + 1), vertex(ring - 1, inner)});
        }
      }
    }
  }
  return disc;
}

/// A disc swept through the sections; a closed sweep runs from the last section to the first.
IndexedMesh sweep_disc(const std::vector<RodSection>& sections, double radius, Index rings, bool closed) {
  const DiscMesh disc = make_disc(rings);
  const Index section_count = static_cast<Index>(sections.size()), per_section = static_cast<Index>(disc.points.size());
  const Index layers = closed ? section_count : section_count - 1;
  IndexedMesh mesh;
  mesh.positions.reserve(static_cast<std::size_t>(section_count) * per_section);
  mesh.tetrahedra.reserve(static_cast<std::size_t>(layers) * disc.triangles.size() * 3);
  for (const RodSection& section : sections) {
    for (const Vec2& p : disc.points) {
      mesh.positions.push_back(section.point + radius * (p[0] * section.normal + p[1] * section.binormal));
    }
  }
  for (Index layer = 0; layer < layers; ++layer) {
    const Index low = layer * per_section, high = (layer + 1) % section_count * per_section;
    for (const VertexTuple<3>& t : disc.triangles) {
      split_prism<Index>({low + t[0], low + t[1], low + t[2]}, {high + t[0], high + t[1], high + t[2]}, t,
                         [&](const VertexTuple<4>& tet) { mesh.tetrahedra.push_back(tet); });
    }
  }
  return mesh;
}

}  // namespace

IndexedMesh make_rod(RodCurve curve, double length, double radius, double cell) {
  check_positive("cell", cell);
  check_positive("length", length);
  check_positive("radius", radius);
  const double largest_radius = largest_rod_radius(curve, length);
  if (!(radius < largest_radius)) {
    throw Error("radius", fmt::format("a rod of radius {} and length {} would touch itself", radius, length),
                fmt::format("use a radius below {:.3g}", largest_radius));
  }
  const bool closed = is_closed(curve);
  const ShapeCells cells = swept_cells(length, radius, cell, fewest_layers(curve));
  check_element_count(cells.elements);
  const Index sections = static_cast<Index>(cells.v) + (closed ? 0 : 1);
  return sweep_disc(rod_sections(curve, length, radius, sections), radius, static_cast<Index>(cells.u), closed);
}

IndexedMesh make_torus(double major_radius, double minor_radius, double cell) {
  check_positive("cell", cell);
  check_positive("major radius", major_radius);
  check_positive("minor radius", minor_radius);
  if (!(minor_radius < major_radius)) {
    throw Error("minor radius", fmt::format("{} is not smaller than the major radius {}", minor_radius, major_radius),
                "use a smaller minor radius");
  }
  const ShapeCells cells = swept_cells(2 * std::numbers::pi * major_radius, minor_radius, cell, kMinTorusLayers);
  check_element_count(cells.elements);
  return sweep_disc(circle_sections(major_radius, static_cast<Index>(cells.v)), minor_radius,
                    static_cast<Index>(cells.u), true);
}

}  // namespace selvage
