#include "selvage/mesh/simplex_mesh.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "selvage/core/error.h"
#include "selvage/shapes/shapes.h"

namespace selvage {
namespace {

template <int N>
VertexTuple<N> sorted(VertexTuple<N> tuple) {
  std::sort(tuple.begin(), tuple.end());
  return tuple;
}

/// Triangles of an n x n grid of squares in the plane, some squares left out.
std::pair<Index, std::vector<VertexTuple<3>>> punched_grid(int n, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<VertexTuple<3>> triangles;
  const auto at = [n](int i, int j) { return static_cast<Index>(i * (n + 1) + j); };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      if (random() % 5 == 0) continue;
      triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return {static_cast<Index>((n + 1) * (n + 1)), triangles};
}

/// A box of tetrahedra with a random part of them removed: holes, several components, non-manifold edges and vertices.
std::pair<Index, std::vector<VertexTuple<4>>> crumbled_box(unsigned seed) {
  std::mt19937 random(seed);
  const IndexedMesh box = make_box(Vec3(1, 1, 1), 0.26);
  std::vector<VertexTuple<4>> tets;
  for (const auto& tet : box.tetrahedra)
    if (random() % 3 != 0) tets.push_back(tet);
  return {static_cast<Index>(box.positions.size()), tets};
}

/// Everything again, from maps.
template <int D>
void compare_with_maps(const SimplexMesh<D>& mesh) {
  std::map<VertexTuple<D>, std::vector<HalfFace>> sides;
  for (Index e = 0; e < mesh.element_count(); ++e)
    for (int i = 0; i <= D; ++i)
      sides[sorted<D>(SimplexMesh<D>::face_of(mesh.elements()[e], i))].push_back(HalfFace::of(e, i));
  std::size_t boundary = 0;
  std::vector<std::set<Index>> elements_of(mesh.vertex_count()), faces_of(mesh.vertex_count());
  for (const auto& [face, halves] : sides) {
    ASSERT_LE(halves.size(), 2u);
    for (std::size_t k = 0; k < halves.size(); ++k) {
      const HalfFace self = halves[k];
      const HalfFace across = mesh.neighbours()[self.element()][self.face()];
      if (halves.size() == 2) {
        EXPECT_EQ(across, halves[1 - k]);
        continue;
      }
      ASSERT_FALSE(across.exists());
      ++boundary;
      EXPECT_EQ(mesh.boundary_owners()[across.boundary_face()], self);
      EXPECT_EQ(mesh.boundary_faces()[across.boundary_face()],
                SimplexMesh<D>::face_of(mesh.elements()[self.element()], self.face()));
      for (Index v : face) faces_of[v].insert(across.boundary_face());
    }
  }
  EXPECT_EQ(mesh.boundary_face_count(), static_cast<Index>(boundary));
  EXPECT_TRUE(std::is_sorted(mesh.boundary_owners().begin(), mesh.boundary_owners().end(),
                             [](HalfFace a, HalfFace b) { return a.code < b.code; }));
  std::vector<Index> boundary_vertices;
  for (Index e = 0; e < mesh.element_count(); ++e)
    for (Index v : mesh.elements()[e]) elements_of[v].insert(e);
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const auto star = mesh.vertex_elements(v), faces = mesh.vertex_boundary_faces(v);
    EXPECT_TRUE(std::equal(star.begin(), star.end(), elements_of[v].begin(), elements_of[v].end()));
    EXPECT_TRUE(std::equal(faces.begin(), faces.end(), faces_of[v].begin(), faces_of[v].end()));
    if (!faces_of[v].empty()) boundary_vertices.push_back(v);
  }
  EXPECT_TRUE(std::ranges::equal(mesh.boundary_vertices(), boundary_vertices));
  std::set<VertexTuple<2>> edges;
  for (const auto& element : mesh.elements())
    for (const Index a : element)
      for (const Index b : element)
        if (a < b) edges.insert({a, b});
  EXPECT_TRUE(std::ranges::equal(mesh.edges(), edges));
}

/// Boundary neighbours share the ridge and are each other's neighbour across it; elements around it connect them.
template <int D>
void check_boundary_links(const SimplexMesh<D>& mesh) {
  std::size_t sides = 0;
  for (Index b = 0; b < mesh.boundary_face_count(); ++b) {
    for (int k = 0; k < D; ++k) {
      VertexTuple<D> ridge = mesh.boundary_faces()[b];
      const Index left_out = ridge[k];
      const Index other = mesh.boundary_neighbours()[b][k];
      ASSERT_GE(other, 0);
      ASSERT_LT(other, mesh.boundary_face_count());
      const auto& theirs = mesh.boundary_faces()[other];
      bool back = false;
      for (int m = 0; m < D; ++m) back |= mesh.boundary_neighbours()[other][m] == b;
      EXPECT_TRUE(back);
      for (Index v : ridge) {
        if (v != left_out) {
          EXPECT_NE(std::find(theirs.begin(), theirs.end(), v), theirs.end());
        }
      }
      ++sides;
    }
  }
  const auto ridges = mesh.boundary_ridges();
  EXPECT_EQ(2 * ridges.size(), sides);
  for (const auto& ridge : ridges) {
    EXPECT_LT(ridge.faces[0], ridge.faces[1]);
    for (Index face : ridge.faces)
      for (Index v : ridge.vertices) {
        const auto& f = mesh.boundary_faces()[face];
        EXPECT_NE(std::find(f.begin(), f.end(), v), f.end());
      }
  }
}

TEST(SimplexMesh, EqualsMapsOnPunchedGrids) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const auto [vertices, triangles] = punched_grid(3 + static_cast<int>(seed), seed);
    const PlanarMesh mesh(vertices, triangles);
    compare_with_maps(mesh);
    check_boundary_links(mesh);
  }
}

TEST(SimplexMesh, EqualsMapsOnCrumbledBoxes) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const auto [vertices, tets] = crumbled_box(seed);
    const TetMesh mesh(vertices, tets);
    compare_with_maps(mesh);
    check_boundary_links(mesh);
  }
}

TEST(SimplexMesh, EdgesOfManyVerticesAreListedInOrder) {
  const IndexedMesh box = make_box(Vec3(1, 1, 1), 0.08);
  const TetMesh mesh(static_cast<Index>(box.positions.size()), box.tetrahedra);
  ASSERT_GT(mesh.vertex_count(), 1500);  // more than one piece of the loop that lists them
  compare_with_maps(mesh);
  EXPECT_TRUE(TetMesh().edges().empty());
}

TEST(SimplexMesh, BoundaryIsOutwardAndClosed) {
  const IndexedMesh ball = make_ball(1, 0.3);
  const TetMesh mesh(static_cast<Index>(ball.positions.size()), ball.tetrahedra);
  double volume = 0, enclosed = 0;
  for (const auto& t : ball.tetrahedra) {
    const Vec3 o = ball.positions[t[0]];
    volume += (ball.positions[t[1]] - o).cross(ball.positions[t[2]] - o).dot(ball.positions[t[3]] - o);
  }
  for (const auto& f : mesh.boundary_faces())
    enclosed += ball.positions[f[0]].cross(ball.positions[f[1]]).dot(ball.positions[f[2]]);
  EXPECT_GT(volume, 0);
  EXPECT_NEAR(enclosed, volume, 1e-10 * volume);
}

TEST(SimplexMesh, ComponentsAreNumberedByTheirFirstElement) {
  const IndexedMesh ball = make_ball(1, 0.5);
  const std::vector<IndexedMesh> parts{ball, ball, ball};
  const IndexedMesh three = concatenate(parts);
  const TetMesh mesh(static_cast<Index>(three.positions.size()), three.tetrahedra);
  const auto component = mesh.element_components();
  for (std::size_t e = 0; e < component.size(); ++e)
    EXPECT_EQ(component[e], static_cast<Index>(e / ball.tetrahedra.size()));
}

TEST(SimplexMesh, IsTheSameForAnyNumberOfThreads) {
  const auto [vertices, tets] = crumbled_box(7);
  const TetMesh reference(vertices, tets);
  for (std::size_t threads : {1, 2, 4}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const TetMesh mesh(vertices, tets);
    EXPECT_TRUE(std::ranges::equal(mesh.neighbours(), reference.neighbours()));
    EXPECT_TRUE(std::ranges::equal(mesh.boundary_faces(), reference.boundary_faces()));
    EXPECT_TRUE(std::ranges::equal(mesh.boundary_neighbours(), reference.boundary_neighbours()));
    EXPECT_EQ(mesh.edges(), reference.edges());
  }
}

TEST(SimplexMesh, NamesTheElementThatIsWrong) {
  const auto message = [](Index vertices, std::vector<VertexTuple<4>> elements) -> std::string {
    try {
      const TetMesh mesh(vertices, std::move(elements));
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(message(4, {}).find("no element"), std::string::npos);
  EXPECT_NE(message(4, {{0, 1, 2, 3}, {0, 1, 2, 4}}).find("element 1"), std::string::npos);
  EXPECT_NE(message(5, {{0, 1, 2, -1}}).find("element 0"), std::string::npos);
  EXPECT_NE(message(5, {{0, 1, 2, 3}, {0, 1, 1, 4}}).find("element 1"), std::string::npos);
  EXPECT_NE(message(6, {{0, 1, 2, 3}, {0, 2, 1, 4}, {0, 1, 2, 5}}).find("element 0"), std::string::npos);
  EXPECT_EQ(message(9, {{0, 1, 2, 3}, {0, 2, 1, 4}, {5, 6, 7, 8}}), "");
}

}  // namespace
}  // namespace selvage
