#pragma once

#include "geometry/exact/exact_integer.h"
#include "selvage/io/mesh_file.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

/// Checks of whole meshes, written apart from the library.
namespace selvage::test {

/// -1, 0 or 1: the exact sign of det(b-a, c-a, d-a).
inline int exact_orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  long double e[3][3];
  for (int k = 0; k < 3; ++k) {
    e[0][k] = static_cast<long double>(b[k]) - a[k];
    e[1][k] = static_cast<long double>(c[k]) - a[k];
    e[2][k] = static_cast<long double>(d[k]) - a[k];
  }
  long double sum = 0, magnitude = 0;
  for (int k = 0; k < 3; ++k) {
    const int l = (k + 1) % 3, m = (k + 2) % 3;
    sum += e[0][k] * (e[1][l] * e[2][m] - e[1][m] * e[2][l]);
    magnitude += std::abs(e[0][k]) * (std::abs(e[1][l] * e[2][m]) + std::abs(e[1][m] * e[2][l]));
  }
  if (std::abs(sum) > 1e-17L * magnitude && magnitude > 1e-300L) return sum > 0 ? 1 : -1;
  std::array<ExactInt, 12> x;
  to_common_integers<12>({a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2], d[0], d[1], d[2]}, x);
  ExactInt exact = 0;
  for (int k = 0; k < 3; ++k) {
    const int l = (k + 1) % 3, m = (k + 2) % 3;
    exact += (x[3 + k] - x[k]) * ((x[6 + l] - x[l]) * (x[9 + m] - x[m]) - (x[6 + m] - x[m]) * (x[9 + l] - x[l]));
  }
  return sign_of(exact);
}

inline int exact_orientation(const IndexedMesh& mesh, const VertexTuple<4>& t) {
  return exact_orientation(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]], mesh.positions[t[3]]);
}

/// Tetrahedra whose exact determinant is not positive.
inline std::int64_t count_not_positive(const IndexedMesh& mesh) {
  return std::count_if(mesh.tetrahedra.begin(), mesh.tetrahedra.end(),
                       [&](const VertexTuple<4>& t) { return exact_orientation(mesh, t) <= 0; });
}

/// Vertices that no element uses.
inline std::int64_t count_orphans(const IndexedMesh& mesh) {
  std::vector<char> used(mesh.positions.size(), 0);
  for (const auto& t : mesh.tetrahedra) {
    for (Index v : t) used.at(v) = 1;
  }
  for (const auto& t : mesh.triangles) {
    for (Index v : t) used.at(v) = 1;
  }
  return std::count(used.begin(), used.end(), 0);
}

/// Faces (N = 3) or edges (N = 2) by sorted vertices: how often each is used, and the sum of the signs of its uses.
template <int N>
struct FacetUses {
  std::vector<std::pair<VertexTuple<N>, int>> uses;

  void add(VertexTuple<N> facet) {
    int sign = 1;
    for (int i = 0; i < N; ++i) {
      for (int j = 0; j + 1 < N; ++j) {
        if (facet[j] > facet[j + 1]) {
          std::swap(facet[j], facet[j + 1]);
          sign = -sign;
        }
      }
    }
    uses.emplace_back(facet, sign);
  }
  /// Calls `body(facet, count, sum_of_signs)` on each facet.
  template <typename Body>
  void for_each(Body&& body) {
    std::sort(uses.begin(), uses.end());
    for (std::size_t i = 0, next = 0; i < uses.size(); i = next) {
      int sum = 0;
      for (next = i; next < uses.size() && uses[next].first == uses[i].first; ++next) sum += uses[next].second;
      body(uses[i].first, static_cast<int>(next - i), sum);
    }
  }
};

struct SurfaceCount {
  std::int64_t bad_facets = 0;       ///< used more than twice, or twice with the same orientation
  std::int64_t boundary_facets = 0;  ///< used once
  std::int64_t boundary_vertices = 0;
  std::int64_t boundary_edges = 0;      ///< of the boundary triangles of a tetrahedral mesh
  std::int64_t bad_boundary_edges = 0;  ///< not used twice in opposite directions

  /// Euler characteristic of the boundary surface.
  std::int64_t euler() const { return boundary_vertices - boundary_edges + boundary_facets; }
};

inline SurfaceCount count_surface(const IndexedMesh& mesh) {
  FacetUses<3> faces;
  for (const auto& [a, b, c, d] : mesh.tetrahedra) {
    faces.add({b, c, d});
    faces.add({a, d, c});
    faces.add({a, b, d});
    faces.add({a, c, b});
  }
  SurfaceCount count;
  FacetUses<2> edges;
  std::vector<char> on_boundary(mesh.positions.size(), 0);
  faces.for_each([&](const VertexTuple<3>& f, int uses, int sum) {
    count.bad_facets += uses > 2 || (uses == 2 && sum != 0);
    if (uses != 1) return;
    ++count.boundary_facets;
    const VertexTuple<3> outward = sum > 0 ? f : VertexTuple<3>{f[0], f[2], f[1]};
    for (int i = 0; i < 3; ++i) edges.add({outward[i], outward[(i + 1) % 3]});
    for (Index v : f) on_boundary[v] = 1;
  });
  edges.for_each([&](const VertexTuple<2>&, int uses, int sum) {
    ++count.boundary_edges;
    count.bad_boundary_edges += uses != 2 || sum != 0;
  });
  count.boundary_vertices = std::count(on_boundary.begin(), on_boundary.end(), 1);
  return count;
}

/// Connected components of the vertices, across elements.
inline int count_components(const IndexedMesh& mesh) {
  std::vector<Index> parent(mesh.positions.size());
  for (std::size_t v = 0; v < parent.size(); ++v) parent[v] = static_cast<Index>(v);
  const auto root = [&](Index v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  int components = static_cast<int>(parent.size());
  const auto join = [&](Index a, Index b) {
    a = root(a);
    b = root(b);
    if (a != b) --components;
    parent[a] = b;
  };
  for (const auto& t : mesh.tetrahedra) {
    for (int i = 1; i < 4; ++i) join(t[0], t[i]);
  }
  for (const auto& t : mesh.triangles) {
    for (int i = 1; i < 3; ++i) join(t[0], t[i]);
  }
  return components;
}

struct AngleRange {
  double smallest = 180, largest = 0;  ///< [degrees]
};

/// Dihedral angles of all tetrahedra.
inline AngleRange dihedral_angles(const IndexedMesh& mesh) {
  AngleRange range;
  for (const auto& t : mesh.tetrahedra) {
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < i; ++j) {
        std::array<int, 2> rest{};
        for (int k = 0, n = 0; k < 4; ++k) {
          if (k != i && k != j) rest[n++] = k;
        }
        const Vec3 edge = (mesh.positions[t[j]] - mesh.positions[t[i]]).normalized();
        const auto off_edge = [&](int k) {
          const Vec3 side = mesh.positions[t[rest[k]]] - mesh.positions[t[i]];
          return Vec3(side - edge.dot(side) * edge);
        };
        const Vec3 a = off_edge(0), b = off_edge(1);
        const double angle = std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / std::numbers::pi;
        range.smallest = std::min(range.smallest, angle);
        range.largest = std::max(range.largest, angle);
      }
    }
  }
  return range;
}

inline double total_volume(const IndexedMesh& mesh) {
  double volume = 0;
  for (const auto& t : mesh.tetrahedra) {
    const Vec3& a = mesh.positions[t[0]];
    volume += (mesh.positions[t[1]] - a).cross(mesh.positions[t[2]] - a).dot(mesh.positions[t[3]] - a) / 6;
  }
  return volume;
}

/// Vertices in a (closed) tetrahedron that they do not belong to, which a conforming mesh has only where it overlaps:
/// brute force over a sort along x, at most `enough` of them.
inline std::int64_t count_buried_vertices(const IndexedMesh& mesh, std::int64_t enough = 1LL << 60) {
  std::vector<Index> by_x(mesh.positions.size());
  for (std::size_t v = 0; v < by_x.size(); ++v) by_x[v] = static_cast<Index>(v);
  const auto x_of = [&](Index v) { return mesh.positions[v][0]; };
  std::sort(by_x.begin(), by_x.end(), [&](Index a, Index b) { return x_of(a) < x_of(b); });
  std::vector<char> buried(mesh.positions.size(), 0);
  std::int64_t count = 0;
  for (const auto& t : mesh.tetrahedra) {
    Vec3 low = mesh.positions[t[0]], high = low;
    for (Index v : t) {
      low = low.cwiseMin(mesh.positions[v]);
      high = high.cwiseMax(mesh.positions[v]);
    }
    auto it = std::lower_bound(by_x.begin(), by_x.end(), low[0], [&](Index v, double x) { return x_of(v) < x; });
    for (; it != by_x.end() && x_of(*it) <= high[0] && count < enough; ++it) {
      const Vec3& p = mesh.positions[*it];
      if (buried[*it] || (p.array() < low.array()).any() || (p.array() > high.array()).any()) continue;
      if (std::find(t.begin(), t.end(), *it) != t.end()) continue;
      bool inside = true;
      for (int i = 0; i < 4 && inside; ++i) {
        std::array<Vec3, 4> corner;
        for (int k = 0; k < 4; ++k) corner[k] = k == i ? p : mesh.positions[t[k]];
        inside = exact_orientation(corner[0], corner[1], corner[2], corner[3]) >= 0;
      }
      count += inside;
      buried[*it] |= inside;
    }
  }
  return count;
}

/// Pairs (edge of one triangle, other triangle) that cross properly, over pairs without a common vertex.
inline std::int64_t count_triangle_crossings(const IndexedMesh& mesh, std::int64_t enough = 1LL << 60) {
  std::int64_t count = 0;
  const auto at = [&](Index v) -> const Vec3& { return mesh.positions[v]; };
  const auto crosses = [&](const Vec3& p, const Vec3& q, const VertexTuple<3>& t) {
    if (exact_orientation(at(t[0]), at(t[1]), at(t[2]), p) * exact_orientation(at(t[0]), at(t[1]), at(t[2]), q) >= 0) {
      return false;
    }
    const int side = exact_orientation(p, q, at(t[0]), at(t[1]));
    return side != 0 && side == exact_orientation(p, q, at(t[1]), at(t[2])) &&
           side == exact_orientation(p, q, at(t[2]), at(t[0]));
  };
  for (const auto& t : mesh.triangles) {
    const Vec3 low = at(t[0]).cwiseMin(at(t[1])).cwiseMin(at(t[2]));
    const Vec3 high = at(t[0]).cwiseMax(at(t[1])).cwiseMax(at(t[2]));
    for (const auto& s : mesh.triangles) {
      if (count >= enough) return count;
      if (std::find_first_of(t.begin(), t.end(), s.begin(), s.end()) != t.end()) continue;
      for (int i = 0; i < 3; ++i) {
        const Vec3 &p = at(s[i]), &q = at(s[(i + 1) % 3]);
        if ((p.cwiseMin(q).array() > high.array()).any() || (p.cwiseMax(q).array() < low.array()).any()) continue;
        count += crosses(p, q, t);
      }
    }
  }
  return count;
}

}  // namespace selvage::test
