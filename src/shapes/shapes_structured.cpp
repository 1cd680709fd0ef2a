#include <numbers>

#include "selvage/shapes/shapes.h"
#include "shapes/cell_splits.h"
#include "shapes/shape_counts.h"

namespace selvage {

namespace {

/// A grid of cells with `count` cells in each direction; in a periodic direction the last cell meets the first.
struct CellGrid {
  std::array<Index, 3> count;
  std::array<bool, 3> periodic = {false, false, false};

  Index vertices_along(int axis) const { return count[axis] + (periodic[axis] ? 0 : 1); }
  Index wrap(Index i, int axis) const { return periodic[axis] && i == count[axis] ? 0 : i; }
  Index vertex(Index i, Index j, Index k) const {
    return (wrap(i, 0) * vertices_along(1) + wrap(j, 1)) * vertices_along(2) + wrap(k, 2);
  }
};

/// Calls `body(i, j, k)` on all triples below `count`, in lexicographic order.
template <typename Body>
void for_each_triple(std::array<Index, 3> count, Body&& body) {
  for (Index i = 0; i < count[0]; ++i) {
    for (Index j = 0; j < count[1]; ++j) {
      for (Index k = 0; k < count[2]; ++k) body(i, j, k);
    }
  }
}

/// The grid's cells cut into tetrahedra, with its vertices at `place(i, j, k)`.
template <typename Place>
IndexedMesh mesh_grid(const CellGrid& grid, Place&& place) {
  IndexedMesh mesh;
  const std::array<Index, 3> lines = {grid.vertices_along(0), grid.vertices_along(1), grid.vertices_along(2)};
  mesh.positions.reserve(static_cast<std::size_t>(lines[0]) * lines[1] * lines[2]);
  mesh.tetrahedra.reserve(static_cast<std::size_t>(grid.count[0]) * grid.count[1] * grid.count[2] * 6);
  for_each_triple(lines, [&](Index i, Index j, Index k) { mesh.positions.push_back(place(i, j, k)); });
  for_each_triple(grid.count, [&](Index i, Index j, Index k) {
    std::array<Index, 8> corner;
    for (int c = 0; c < 8; ++c) corner[c] = grid.vertex(i + (c >> 2), j + ((c >> 1) & 1), k + (c & 1));
    split_hexahedron(corner, [&](const VertexTuple<4>& tet) { mesh.tetrahedra.push_back(tet); });
  });
  return mesh;
}

/// @param cells  layers through the wall, cells around, cells along
IndexedMesh make_structured_tube(double outer_radius, double inner_radius, double length, const ShapeCells& cells) {
  check_element_count(cells.elements);
  const double thickness = outer_radius - inner_radius;
  const CellGrid grid{{static_cast<Index>(cells.u), static_cast<Index>(cells.v), static_cast<Index>(cells.w)},
                      {false, true, false}};
  return mesh_grid(grid, [&](Index i, Index j, Index k) {
    const double radius = inner_radius + thickness * i / grid.count[0];
    const double angle = 2 * std::numbers::pi * j / grid.count[1];
    return Vec3(radius * std::cos(angle), radius * std::sin(angle), length * k / grid.count[2]);
  });
}

}  // namespace

IndexedMesh make_box(const Vec3& size, double cell) {
  check_positive("cell", cell);
  for (int axis = 0; axis < 3; ++axis) check_positive("box size", size[axis]);
  const ShapeCells cells = box_cells(size, cell);
  check_element_count(cells.elements);
  const CellGrid grid{{static_cast<Index>(cells.u), static_cast<Index>(cells.v), static_cast<Index>(cells.w)}};
  return mesh_grid(grid, [&](Index i, Index j, Index k) {
    return Vec3(i == grid.count[0] ? size[0] : size[0] * i / grid.count[0],
                j == grid.count[1] ? size[1] : size[1] * j / grid.count[1],
                k == grid.count[2] ? size[2] : size[2] * k / grid.count[2]);
  });
}

IndexedMesh make_tube(double outer_radius, double inner_radius, double length, double cell) {
  check_positive("cell", cell);
  check_positive("outer radius", outer_radius);
  check_positive("inner radius", inner_radius);
  check_positive("length", length);
  return make_structured_tube(outer_radius, inner_radius, length, tube_cells(outer_radius, inner_radius, length, cell));
}

IndexedMesh make_gear(double radius, double hole_radius, double length, int teeth, double cell) {
  IndexedMesh mesh =
      make_structured_tube(radius, hole_radius, length, gear_cells(radius, hole_radius, length, teeth, cell));
  const double root = gear_root(radius, teeth);
  for (Vec3& p : mesh.positions) {
    const double distance = p.head<2>().norm();
    // Teeth a little narrower than the gaps, so that two gears turn freely.
    const double wave = std::cos(teeth * std::atan2(p[1], p[0])), profile = wave - 0.15 * (1 - wave * wave);
    const double rim = 0.5 * (radius + root) + 0.5 * (radius - root) * profile;
    const double share = (distance - hole_radius) / (radius - hole_radius);
    p.head<2>() *= (hole_radius + share * (rim - hole_radius)) / distance;
  }
  return mesh;
}

IndexedMesh make_cloth(double width, double height, double cell) {
  check_positive("cell", cell);
  check_positive("width", width);
  check_positive("height", height);
  const ShapeCells cells = cloth_cells(width, height, cell);
  check_element_count(cells.elements);
  const Index nx = static_cast<Index>(cells.u), ny = static_cast<Index>(cells.v);
  IndexedMesh mesh;
  mesh.positions.reserve((nx + std::size_t{1}) * (ny + std::size_t{1}));
  mesh.triangles.reserve(2 * static_cast<std::size_t>(nx) * ny);
  for (Index i = 0; i <= nx; ++i) {
    for (Index j = 0; j <= ny; ++j) mesh.positions.emplace_back(width * i / nx, height * j / ny, 0.0);
  }
  for (Index i = 0; i < nx; ++i) {
    for (Index j = 0; j < ny; ++j) {
      const Index a = i * (ny + 1) + j, b = a + ny + 1, c = b + 1, d = a + 1;
      // Alternating diagonals: a cloth that bends no more easily in one diagonal direction than in the other.
      if ((i + j) % 2 == 0) {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
      } else {
        mesh.triangles.push_back({a, b, d});
        mesh.triangles.push_back({b, c, d});
      }
    }
  }
  return mesh;
}

IndexedMesh make_sleeve(double radius, double length, double cell) {
  check_positive("cell", cell);
  check_positive("radius", radius);
  check_positive("length", length);
  const ShapeCells cells = sleeve_cells(radius, length, cell);
  check_element_count(cells.elements);
  const Index around = static_cast<Index>(cells.u), along = static_cast<Index>(cells.v);
  IndexedMesh mesh;
  for (Index j = 0; j <= along; ++j)
    for (Index i = 0; i < around; ++i) {
      // Each ring is half a cell further: triangles have sides of about one length.
      const double angle = 2 * std::numbers::pi * (i + 0.5 * (j % 2)) / around;
      mesh.positions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), length * j / along);
    }
  for (Index j = 0; j < along; ++j)
    for (Index i = 0; i < around; ++i) {
      const Index next = (i + 1) % around, a = j * around + i, b = j * around + next, c = (j + 1) * around + next,
                  d = (j + 1) * around + i;
      if (j % 2 == 0) {
        mesh.triangles.push_back({a, b, d});
        mesh.triangles.push_back({b, c, d});
      } else {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
      }
    }
  return mesh;
}

IndexedMesh concatenate(std::span<const IndexedMesh> meshes) {
  double vertices = 0, tetrahedra = 0, triangles = 0;
  for (const IndexedMesh& mesh : meshes) {
    vertices += static_cast<double>(mesh.positions.size());
    tetrahedra += static_cast<double>(mesh.tetrahedra.size());
    triangles += static_cast<double>(mesh.triangles.size());
  }
  check_element_count(std::max({vertices / 2, tetrahedra, triangles}));
  IndexedMesh all;
  all.positions.reserve(static_cast<std::size_t>(vertices));
  all.tetrahedra.reserve(static_cast<std::size_t>(tetrahedra));
  all.triangles.reserve(static_cast<std::size_t>(triangles));
  for (const IndexedMesh& mesh : meshes) {
    const Index first = static_cast<Index>(all.positions.size());
    all.positions.insert(all.positions.end(), mesh.positions.begin(), mesh.positions.end());
    for (VertexTuple<4> tet : mesh.tetrahedra) {
      for (Index& v : tet) v += first;
      all.tetrahedra.push_back(tet);
    }
    for (VertexTuple<3> triangle : mesh.triangles) {
      for (Index& v : triangle) v += first;
      all.triangles.push_back(triangle);
    }
  }
  return all;
}

}  // namespace selvage
