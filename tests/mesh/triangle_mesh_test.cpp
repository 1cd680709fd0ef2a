#include "selvage/mesh/triangle_mesh.h"

#include "selvage/core/error.h"
#include "test_scale.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <map>
#include <random>

namespace selvage {
namespace {

using Triangles = std::vector<TriangleMesh::Triangle>;

Triangles tetrahedron_surface() {
  return {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
}

Triangles grid(Index columns, Index rows) {
  Triangles triangles;
  for (Index j = 0; j < rows; ++j) {
    for (Index i = 0; i < columns; ++i) {
      const Index a = j * (columns + 1) + i, b = a + 1, c = a + columns + 1, d = c + 1;
      triangles.push_back({a, b, d});
      triangles.push_back({a, d, c});
    }
  }
  return triangles;
}

/// Pages of a book: triangles that share one edge.
Triangles book(Index pages) {
  Triangles triangles;
  for (Index i = 0; i < pages; ++i) triangles.push_back({1, 0, 2 + i});
  return triangles;
}

Triangles soup(Index vertex_count, Index count, unsigned seed) {
  std::mt19937 random(seed);
  Triangles triangles;
  while (std::ssize(triangles) < count) {
    const auto pick = [&] { return static_cast<Index>(random() % static_cast<unsigned>(vertex_count)); };
    const TriangleMesh::Triangle t{pick(), pick(), pick()};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) triangles.push_back(t);
  }
  return triangles;
}

template <typename Span>
std::vector<Index> listed(Span span) {
  return {span.begin(), span.end()};
}

/// Compares what lies across edges with the triangles of each edge.
void expect_neighbours(const TriangleMesh& mesh, const std::map<TriangleMesh::Edge, std::vector<Index>>& edges) {
  bool agree = true;
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const auto& triangle = mesh.triangles()[t];
      const Index from = triangle[(i + 1) % 3], to = triangle[(i + 2) % 3];
      const auto& incident = edges.at({std::min(from, to), std::max(from, to)});
      const HalfFace across = mesh.neighbours()[t][i];
      ASSERT_EQ(across.exists(), incident.size() == 2);
      if (!across.exists()) continue;
      ASSERT_EQ(across.element(), incident[incident[0] == t ? 1 : 0]);
      const auto& other = mesh.triangles()[across.element()];
      const Index other_from = other[(across.face() + 1) % 3], other_to = other[(across.face() + 2) % 3];
      ASSERT_EQ(std::minmax(from, to), std::minmax(other_from, other_to));
      agree = agree && from == other_to;
    }
  }
  ASSERT_EQ(mesh.is_oriented(), agree);
}

/// Compares everything that a mesh tells with what sets and maps say.
void expect_equals_twin(Index vertex_count, const Triangles& triangles) {
  const TriangleMesh mesh(vertex_count, triangles);
  std::map<TriangleMesh::Edge, std::vector<Index>> edges;
  std::map<Index, std::vector<Index>> stars;
  for (Index t = 0; t < std::ssize(triangles); ++t) {
    const auto& [a, b, c] = triangles[t];
    for (const auto& [u, v] : {std::minmax(a, b), std::minmax(b, c), std::minmax(c, a)}) edges[{u, v}].push_back(t);
    for (Index v : triangles[t]) stars[v].push_back(t);
  }
  ASSERT_EQ(mesh.vertex_count(), vertex_count);
  ASSERT_EQ(mesh.triangle_count(), std::ssize(triangles));
  ASSERT_TRUE(std::ranges::equal(mesh.triangles(), triangles));
  ASSERT_EQ(mesh.edge_count(), std::ssize(edges));
  Index e = 0;
  for (const auto& [edge, incident] : edges) {
    ASSERT_EQ(mesh.edges()[e], edge);
    ASSERT_EQ(listed(mesh.edge_triangles(e)), incident);
    ++e;
  }
  for (Index v = 0; v < vertex_count; ++v) ASSERT_EQ(listed(mesh.vertex_triangles(v)), stars[v]);
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const auto [u, v] = std::minmax(triangles[t][(i + 1) % 3], triangles[t][(i + 2) % 3]);
      ASSERT_EQ(mesh.edges()[mesh.triangle_edges()[t][i]], (TriangleMesh::Edge{u, v}));
    }
  }
  expect_neighbours(mesh, edges);
}

TEST(TriangleMesh, ClosedSurfaceHasTwoTrianglesOnEveryEdge) {
  const TriangleMesh mesh(4, tetrahedron_surface());
  ASSERT_EQ(mesh.edge_count(), 6);
  for (Index e = 0; e < 6; ++e) EXPECT_EQ(mesh.edge_triangles(e).size(), 2u);
  EXPECT_EQ(mesh.edges()[0], (TriangleMesh::Edge{0, 1}));
  EXPECT_EQ(listed(mesh.edge_triangles(0)), (std::vector<Index>{2, 3}));
  EXPECT_EQ(mesh.triangle_edges()[3], (std::array<Index, 3>{3, 0, 1}));
  EXPECT_EQ(listed(mesh.vertex_triangles(0)), (std::vector<Index>{1, 2, 3}));
}

TEST(TriangleMesh, OpenSurfaceHasABorder) {
  const TriangleMesh mesh(12, grid(3, 2));
  std::array<int, 3> edges_with{};
  for (Index e = 0; e < mesh.edge_count(); ++e) ++edges_with[mesh.edge_triangles(e).size()];
  EXPECT_EQ(edges_with, (std::array<int, 3>{0, 10, 13}));
  EXPECT_EQ(mesh.vertex_count() - mesh.edge_count() + mesh.triangle_count(), 1);
}

TEST(TriangleMesh, OneTurnedTriangleSpoilsTheOrientation) {
  Triangles triangles = grid(40, 30);
  EXPECT_TRUE(TriangleMesh(41 * 31, triangles).is_oriented());
  std::swap(triangles[1234][0], triangles[1234][1]);
  EXPECT_FALSE(TriangleMesh(41 * 31, triangles).is_oriented());
  expect_equals_twin(41 * 31, triangles);
}

TEST(TriangleMesh, NonManifoldEdgeListsAllItsTriangles) {
  const TriangleMesh mesh(7, book(5));
  EXPECT_EQ(mesh.edges()[0], (TriangleMesh::Edge{0, 1}));
  EXPECT_EQ(listed(mesh.edge_triangles(0)), (std::vector<Index>{0, 1, 2, 3, 4}));
  EXPECT_EQ(mesh.edge_count(), 11);
}

TEST(TriangleMesh, EqualsTwinOnEveryFamily) {
  expect_equals_twin(4, tetrahedron_surface());
  expect_equals_twin(3, {{2, 0, 1}});
  expect_equals_twin(9, {{6, 8, 7}});  // vertices that no triangle uses
  expect_equals_twin(41 * 61, grid(40, 60));
  expect_equals_twin(371 * 371, grid(370, 370));  // so many that stars are listed in parallel
  expect_equals_twin(502, book(500));
  expect_equals_twin(3, {{0, 1, 2}, {0, 1, 2}, {2, 1, 0}});  // the same triangle again, and turned
  Triangles two = tetrahedron_surface();                     // two components
  for (const auto& [a, b, c] : tetrahedron_surface()) two.push_back({a + 4, b + 4, c + 4});
  expect_equals_twin(8, two);
}

TEST(TriangleMesh, EqualsTwinOnSoup) {
  const std::int64_t rounds = test::scaled(40);
  for (unsigned seed = 0; seed < rounds; ++seed) {
    const Index vertex_count = static_cast<Index>(3 + seed * 29 % 300);
    expect_equals_twin(vertex_count, soup(vertex_count, 500, seed));
  }
  expect_equals_twin(9000, soup(9000, 20000, 7));
}

TEST(TriangleMesh, IsTheSameForAnyNumberOfThreads) {
  const Triangles triangles = soup(20000, 270000, 3);
  const auto build = [&](int threads) {
    tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return TriangleMesh(20000, triangles);
  };
  const TriangleMesh one = build(1);
  for (const int threads : {2, 4}) {
    const TriangleMesh many = build(threads);
    ASSERT_TRUE(std::ranges::equal(one.edges(), many.edges()));
    ASSERT_TRUE(std::ranges::equal(one.triangle_edges(), many.triangle_edges()));
    for (Index e = 0; e < one.edge_count(); ++e)
      ASSERT_TRUE(std::ranges::equal(one.edge_triangles(e), many.edge_triangles(e)));
    for (Index v = 0; v < one.vertex_count(); ++v)
      ASSERT_TRUE(std::ranges::equal(one.vertex_triangles(v), many.vertex_triangles(v)));
  }
}

TEST(BoundarySurface, IsTheBoundaryOfTheMesh) {
  const IndexedMesh ball = make_ball(1, 0.4);
  const TetMesh mesh(static_cast<Index>(ball.positions.size()), ball.tetrahedra);
  const TriangleMesh surface = boundary_surface(mesh);
  EXPECT_EQ(surface.vertex_count(), mesh.vertex_count());
  EXPECT_TRUE(std::ranges::equal(surface.triangles(), mesh.boundary_faces()));
  EXPECT_TRUE(surface.is_oriented());
  for (Index e = 0; e < surface.edge_count(); ++e) EXPECT_EQ(surface.edge_triangles(e).size(), 2u);
  EXPECT_THROW(boundary_surface(TetMesh()), Error);
}

std::string error_of(Index vertex_count, Triangles triangles) {
  try {
    const TriangleMesh mesh(vertex_count, std::move(triangles));
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(TriangleMesh, ErrorsNameTheFirstTriangle) {
  EXPECT_EQ(error_of(3, {}), "mesh: there is no triangle; give at least one");
  EXPECT_EQ(error_of(3, {{0, 1, 2}, {0, 1, 3}}),
            "triangle 1: a vertex index is out of range; indices must lie in [0, 3)");
  EXPECT_EQ(error_of(3, {{0, -1, 2}}), "triangle 0: a vertex index is out of range; indices must lie in [0, 3)");
  EXPECT_EQ(error_of(3, {{0, 1, 2}, {2, 1, 2}, {0, 0, 1}}),
            "triangle 1: repeats a vertex; remove it, or give it distinct vertices");
  Triangles many = soup(100, 30000, 1);
  many[20000] = {5, 5, 6};
  many[29999] = {7, 7, 6};
  EXPECT_EQ(error_of(100, many).substr(0, 15), "triangle 20000:");
}

}  // namespace
}  // namespace selvage
