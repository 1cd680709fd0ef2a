#include "self_collision/surfaces.h"

#include <cmath>
#include <map>

namespace selvage::surfaces {

namespace {

Surface mapped(Surface surface, const std::function<Vec3(const Vec3&)>& map) {
  for (Vec3& x : surface.positions) x = map(x);
  return surface;
}

Surface random_sheet(Random& random) {
  return sheet(1 + random.below(5), 1 + random.below(5), random);
}

/// Turned by a random rotation, so that nothing lines up with the axes.
Surface turned(Surface surface, Random& random) {
  Eigen::Quaterniond q(random.within(-1, 1), random.within(-1, 1), random.within(-1, 1), random.within(-1, 1));
  q.normalize();
  return mapped(std::move(surface), [&](const Vec3& x) { return Vec3(q * Eigen::Vector3d(x)); });
}

Surface rolled(Random& random) {
  const double shrink = random.within(0.8, 1.02);
  return mapped(sheet(6 + random.below(8), 1 + random.below(3), random), [&](const Vec3& x) {
    const double radius = 1.2 * std::pow(shrink, x[0]);
    return Vec3(radius * std::cos(x[0]), radius * std::sin(x[0]), x[1]);
  });
}

/// Folded about lines x = k exactly onto itself, some more than once.
Surface folded_flat(Random& random) {
  const double at = 1 + random.below(3), slope = random.below(2);
  return mapped(sheet(2 + random.below(5), 1 + random.below(4), random),
                [&](const Vec3& x) { return Vec3(std::abs(x[0] - at), x[1] + slope * x[0], slope * x[1]); });
}

Surface folded(Random& random) {
  const double angle = random.within(2, 4), crease = random.within(1, 3);
  return mapped(sheet(5, 3, random), [&](const Vec3& x) {
    if (x[0] <= crease) return x;
    const double d = x[0] - crease;
    return Vec3(crease + d * std::cos(angle), x[1] + 0.2 * d, d * std::sin(angle));
  });
}

/// Triangles cut away at random, and vertices split from their neighbours.
Surface torn(Random& random) {
  Surface surface = jittered(sheet(5, 5, random), 0.7, random);
  std::vector<VertexTuple<3>> kept;
  for (VertexTuple<3> t : surface.triangles) {
    if (random.below(4) == 0) continue;
    if (random.below(4) == 0) {
      const Index corner = random.below(3);
      surface.positions.push_back(surface.positions[t[corner]]);
      t[corner] = static_cast<Index>(surface.positions.size()) - 1;
    }
    kept.push_back(t);
  }
  if (kept.empty()) kept.push_back(surface.triangles[0]);
  surface.triangles = kept;
  return surface;
}

/// Any three vertices of a few: edges with many triangles, triangles in several places.
Surface soup(Index vertices, Index triangles, Random& random) {
  Surface surface;
  for (Index v = 0; v < vertices; ++v)
    surface.positions.emplace_back(random.within(-1, 1), random.within(-1, 1), random.within(-1, 1));
  while (static_cast<Index>(surface.triangles.size()) < triangles) {
    const VertexTuple<3> t{random.below(vertices), random.below(vertices), random.below(vertices)};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) surface.triangles.push_back(t);
  }
  return surface;
}

/// An octahedron, each face cut in four `times` times, on the unit ball.
Surface ball(int times) {
  Surface surface;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {1.0, -1.0}) surface.positions.push_back(side * Vec3::Unit(axis));
  for (const Index x : {0, 1})
    for (const Index y : {2, 3})
      for (const Index z : {4, 5})
        surface.triangles.push_back((x + y + z) % 2 == 0 ? VertexTuple<3>{x, y, z} : VertexTuple<3>{y, x, z});
  for (int n = 0; n < times; ++n) {
    std::map<std::pair<Index, Index>, Index> middles;
    const auto middle = [&](Index a, Index b) {
      const auto [place, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<Index>(surface.positions.size()));
      if (is_new) surface.positions.push_back(Vec3((surface.positions[a] + surface.positions[b]).normalized()));
      return place->second;
    };
    std::vector<VertexTuple<3>> finer;
    for (const auto& [a, b, c] : surface.triangles) {
      const Index ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    surface.triangles = finer;
  }
  return surface;
}

/// Sheets whose vertices lie on a lattice of a few points: most triangles are coplanar, touch, or are degenerate.
Surface on_lattice(Index points, Random& random) {
  Surface surface = random_sheet(random);
  for (Vec3& x : surface.positions) x = Vec3(random.below(points), random.below(points), random.below(points));
  return surface;
}

Surface flat_lattice(Random& random) {
  Surface surface = together(random_sheet(random), random_sheet(random));
  for (Vec3& x : surface.positions) x += Vec3(random.below(2), random.below(2), 0);
  const Vec3 u(1, 2, random.below(3)), v(random.below(3), 1, 1);
  return mapped(std::move(surface), [&](const Vec3& x) { return Vec3(x[0] * u + x[1] * v); });
}

Surface through_each_other(Random& random) {
  const Surface a = sheet(4, 4, random);
  const double lean = random.within(-1, 1);
  const Surface b =
      mapped(sheet(4, 4, random), [&](const Vec3& x) { return Vec3(x[0], 2 + lean * (x[1] - 2), x[1] - 2); });
  return turned(together(a, b), random);
}

Surface duplicated(Random& random) {
  Surface surface = jittered(random_sheet(random), 0.5, random);
  const auto count = static_cast<Index>(surface.triangles.size());
  for (Index k = 0; k < count; k += 1 + random.below(4)) {
    VertexTuple<3> t = surface.triangles[k];
    if (random.below(2) == 0)
      for (Index& v : t) {
        surface.positions.push_back(surface.positions[v]);
        v = static_cast<Index>(surface.positions.size()) - 1;
      }
    std::swap(t[0], t[random.below(3)]);
    surface.triangles.push_back(t);
  }
  return surface;
}

/// Some vertices in one place, some triangles with collinear vertices.
Surface degenerate(Random& random) {
  Surface surface = jittered(random_sheet(random), 0.8, random);
  for (const auto& [a, b, c] : surface.triangles) {
    const Index what = random.below(6);
    if (what == 0) surface.positions[a] = surface.positions[b];
    if (what == 1) surface.positions[c] = 2 * surface.positions[b] - surface.positions[a];
  }
  return surface;
}

Surface several(Random& random) {
  Surface surface = turned(sheet(3, 3, random), random);
  surface = together(surface, mapped(ball(1), [&](const Vec3& x) { return Vec3(2 * x); }));
  return together(surface, mapped(turned(sheet(3, 2, random), random), [](const Vec3& x) { return Vec3(x / 2); }));
}

}  // namespace

Surface sheet(Index n, Index m, Random& random) {
  Surface surface;
  for (Index j = 0; j <= m; ++j)
    for (Index i = 0; i <= n; ++i) surface.positions.emplace_back(i, j, 0);
  for (Index j = 0; j < m; ++j)
    for (Index i = 0; i < n; ++i) {
      const Index a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      if (random.below(2) == 0)
        surface.triangles.insert(surface.triangles.end(), {{a, b, d}, {a, d, c}});
      else
        surface.triangles.insert(surface.triangles.end(), {{a, b, c}, {b, d, c}});
    }
  return surface;
}

Surface jittered(Surface surface, double amount, Random& random) {
  for (Vec3& x : surface.positions)
    for (int k = 0; k < 3; ++k) x[k] += random.within(-amount, amount);
  return surface;
}

Surface together(Surface a, const Surface& b) {
  const auto first = static_cast<Index>(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  for (const auto& [i, j, k] : b.triangles) a.triangles.push_back({i + first, j + first, k + first});
  return a;
}

Surface snapped(Surface surface, int bits) {
  for (Vec3& x : surface.positions)
    for (int k = 0; k < 3; ++k) x[k] = std::ldexp(std::nearbyint(std::ldexp(x[k], bits)), -bits);
  return surface;
}

const std::vector<Family>& families() {
  static const std::vector<Family> all{
      {"flat", [](Random& r) { return random_sheet(r); }},
      {"waved", [](Random& r) { return turned(jittered(sheet(6, 6, r), 0.2, r), r); }},
      {"crumpled", [](Random& r) { return jittered(sheet(5, 5, r), r.within(0.5, 3), r); }},
      {"folded", folded},
      {"folded_flat", folded_flat},
      {"rolled", rolled},
      {"torn", torn},
      {"several", several},
      {"non_manifold", [](Random& r) { return soup(5 + r.below(8), 10 + r.below(30), r); }},
      {"loose", [](Random& r) { return soup(120, 40, r); }},
      {"closed", [](Random& r) { return jittered(ball(1 + static_cast<int>(r.below(2))), r.within(0, 0.6), r); }},
      {"lattice_2", [](Random& r) { return on_lattice(2, r); }},
      {"lattice_4", [](Random& r) { return on_lattice(4, r); }},
      {"flat_lattice", flat_lattice},
      {"through_each_other", through_each_other},
      {"duplicated", duplicated},
      {"degenerate", degenerate},
      {"one_triangle", [](Random& r) { return soup(3, 1, r); }},
  };
  return all;
}

}  // namespace selvage::surfaces
