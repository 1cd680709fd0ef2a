#include "boundary_path/families/families.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace selvage::families {

namespace {

// Vertices of the lattice, made when first asked for.
template <int D>
struct LatticeVertices {
  std::map<std::array<int, D>, Index> made;
  Index get(Pieces<D>& mesh, const std::array<int, D>& at) {
    const auto [place, is_new] = made.try_emplace(at, static_cast<Index>(mesh.positions.size()));
    if (is_new) {
      Vec<D> x;
      for (int k = 0; k < D; ++k) x[k] = at[k];
      mesh.positions.push_back(x);
    }
    return place->second;
  }
};

// The cell with lowest corner `at`, as D! simplices: one for each order in which its diagonal's coordinates grow.
// `mirror` reflects the first coordinate, so that the diagonal runs the other way.
template <int D>
void add_cell(Pieces<D>& mesh, LatticeVertices<D>& vertices, const std::array<int, D>& at, bool mirror = false) {
  std::array<int, D> order;
  for (int k = 0; k < D; ++k) order[k] = k;
  do {
    auto corner = at;
    if (mirror) ++corner[0];
    VertexTuple<D + 1> element{};
    element[0] = vertices.get(mesh, corner);
    int inversions = 0;
    for (int k = 0; k < D; ++k) {
      corner[order[k]] += (mirror && order[k] == 0) ? -1 : 1;
      element[k + 1] = vertices.get(mesh, corner);
      for (int j = 0; j < k; ++j) inversions += order[j] > order[k];
    }
    if ((inversions + mirror) % 2 == 1) std::swap(element[D - 1], element[D]);
    mesh.elements.push_back(element);
  } while (std::next_permutation(order.begin(), order.end()));
}

// Elements put one after the other on the faces that are still open.
template <int D>
class Growth {
 public:
  Growth(std::uint64_t seed, bool with_folds) : random_(seed), with_folds_(with_folds) {
    mesh_.positions.push_back(Vec<D>::Zero());
    VertexTuple<D + 1> first{};
    for (int k = 0; k < D; ++k) {
      mesh_.positions.push_back(Vec<D>::Unit(k));
      first[k + 1] = k + 1;
    }
    take(first);
  }

  Pieces<D> grow(std::size_t count) {
    while (mesh_.elements.size() < count) add();
    return mesh_;
  }

 private:
  using Element = VertexTuple<D + 1>;

  double volume(const Element& e) const {
    Eigen::Matrix<double, D, D> edges;
    for (int k = 0; k < D; ++k) edges.col(k) = mesh_.positions[e[k + 1]] - mesh_.positions[e[0]];
    return edges.determinant();
  }

  static VertexTuple<D> face_of(const Element& e, int skip) {
    VertexTuple<D> face{};
    for (int i = 0, k = 0; i <= D; ++i)
      if (i != skip) face[k++] = e[i];
    std::sort(face.begin(), face.end());
    return face;
  }

  void take(const Element& element) {
    for (int i = 0; i <= D; ++i) sides_[face_of(element, i)].push_back(element[i]);
    mesh_.elements.push_back(element);
  }

  // Tries a random vertex, a new one or one that is there, over a random face.
  void add() {
    Element element = mesh_.elements[random_.below(mesh_.elements.size())];
    const bool is_new = random_.below(2) == 0;
    if (is_new) {
      mesh_.positions.emplace_back();
      for (int k = 0; k < D; ++k) mesh_.positions.back()[k] = random_.within(-2, 2);
    }
    const auto apex = static_cast<Index>(is_new ? mesh_.positions.size() - 1 : random_.below(mesh_.positions.size()));
    const bool known = std::find(element.begin(), element.end(), apex) != element.end();
    element[random_.below(D + 1)] = apex;
    if (!known && fits(element)) {
      std::swap(element[0], element[1]);
      take(element);
    } else if (is_new) {
      mesh_.positions.pop_back();
    }
  }

  // Whether the element, listed the wrong way round, is none too flat, has a neighbour at most across each face, and
  // that on the other side.
  bool fits(const Element& element) const {
    if (volume(element) > -0.02) return false;
    for (int i = 0; i <= D; ++i) {
      const auto found = sides_.find(face_of(element, i));
      if (found == sides_.end()) continue;
      if (found->second.size() > 1 || found->second[0] == element[i]) return false;
      Element other = element;
      other[i] = found->second[0];
      if (!with_folds_ && volume(other) < 0) return false;
    }
    return true;
  }

  Random random_;
  bool with_folds_;
  Pieces<D> mesh_;
  std::map<VertexTuple<D>, std::vector<Index>> sides_;  // the vertices opposite to each face
};

template <int D>
std::array<int, D> step_of(char c) {
  std::array<int, D> step{};
  if (c == 'E') step[0] = 1;
  if (c == 'W') step[0] = -1;
  if (c == 'N') step[1] = 1;
  if (c == 'S') step[1] = -1;
  if constexpr (D == 3) {
    if (c == 'U') step[2] = 1;
    if (c == 'D') step[2] = -1;
  }
  return step;
}

template <int D>
Pieces<D> walk_cells(const std::string& steps) {
  Pieces<D> mesh;
  LatticeVertices<D> vertices;
  std::array<int, D> at{};
  add_cell<D>(mesh, vertices, at);
  for (char c : steps) {
    const auto step = step_of<D>(c);
    for (int k = 0; k < D; ++k) at[k] += step[k];
    // Only the vertices of the side that leads into the new cell are shared with what is there already.
    LatticeVertices<D> side;
    for (const auto& [place, index] : vertices.made) {
      bool kept = true;
      for (int k = 0; k < D; ++k) {
        const int low = step[k] < 0 ? at[k] + 1 : at[k], high = step[k] > 0 ? at[k] : at[k] + 1;
        kept = kept && place[k] >= low && place[k] <= high;
      }
      if (kept) side.made.insert({place, index});
    }
    vertices = side;
    add_cell<D>(mesh, vertices, at);
  }
  return mesh;
}

}  // namespace

Pieces<2> grid(int nx, int ny, bool alternating) {
  Pieces<2> mesh;
  LatticeVertices<2> vertices;
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) add_cell<2>(mesh, vertices, {i, j}, alternating && (i + j) % 2 == 1);
  }
  return mesh;
}

Pieces<3> grid(int nx, int ny, int nz) {
  Pieces<3> mesh;
  LatticeVertices<3> vertices;
  for (int k = 0; k < nz; ++k) {
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) add_cell<3>(mesh, vertices, {i, j, k});
    }
  }
  return mesh;
}

Pieces<2> walk(const std::string& steps) {
  return walk_cells<2>(steps);
}
Pieces<3> cube_walk(const std::string& steps) {
  return walk_cells<3>(steps);
}

Pieces<2> squares(const std::vector<std::string>& rows) {
  Pieces<2> mesh;
  LatticeVertices<2> vertices;
  for (int r = 0; r < static_cast<int>(rows.size()); ++r) {
    for (int c = 0; c < static_cast<int>(rows[r].size()); ++c) {
      if (rows[r][c] == '#') add_cell<2>(mesh, vertices, {c, r});
    }
  }
  return mesh;
}

Pieces<3> cubes(const std::vector<std::array<int, 3>>& corners) {
  Pieces<3> mesh;
  LatticeVertices<3> vertices;
  for (const auto& at : corners) add_cell<3>(mesh, vertices, at);
  return mesh;
}

Pieces<2> fan(int count, double turns, bool closed, int rings) {
  Pieces<2> mesh;
  mesh.positions.push_back({0, 0});
  const int rim = closed ? count : count + 1;
  for (int ring = 1; ring <= rings; ++ring) {
    for (int i = 0; i < rim; ++i) {
      const double angle = 2 * std::numbers::pi * turns * i / count;
      const double radius = 2 * ring + 0.4 * std::sin(3.7 * i + ring);
      mesh.positions.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    }
  }
  for (int i = 0; i < count; ++i) {
    const int next = (i + 1) % rim;
    mesh.elements.push_back({0, 1 + i, 1 + next});
    for (int ring = 1; ring < rings; ++ring) {
      const Index inner = 1 + (ring - 1) * rim, outer = inner + rim;
      mesh.elements.push_back({inner + i, outer + i, outer + next});
      mesh.elements.push_back({inner + i, outer + next, inner + next});
    }
  }
  return mesh;
}

std::string random_steps(int count, bool in_space, std::uint64_t seed) {
  const std::string steps = in_space ? "EWNSUD" : "EWNS", back = in_space ? "WESNDU" : "WESN";
  Random random(seed);
  std::string result;
  while (static_cast<int>(result.size()) < count) {
    const char c = steps[random.below(steps.size())];
    if (result.empty() || result.back() != back[steps.find(c)]) result += c;
  }
  return result;
}

template <int D>
Pieces<D> grown(int count, std::uint64_t seed, bool with_folds) {
  return Growth<D>(seed, with_folds).grow(static_cast<std::size_t>(count));
}

template Pieces<2> grown<2>(int, std::uint64_t, bool);
template Pieces<3> grown<3>(int, std::uint64_t, bool);

Pieces<3> extrude(const Pieces<2>& mesh, int layers, double height) {
  Pieces<3> solid;
  const auto n = static_cast<Index>(mesh.positions.size());
  for (int layer = 0; layer <= layers; ++layer) {
    for (const auto& x : mesh.positions) solid.positions.push_back({x[0], x[1], layer * height});
  }
  for (int layer = 0; layer < layers; ++layer) {
    for (auto e : mesh.elements) {
      int swaps = 0;
      for (const auto& [i, j] : {std::pair{0, 1}, {1, 2}, {0, 1}}) {
        if (e[i] > e[j]) {
          std::swap(e[i], e[j]);
          ++swaps;
        }
      }
      const Index low = layer * n, high = low + n;
      std::array<VertexTuple<4>, 3> tets{{{low + e[0], low + e[1], low + e[2], high + e[2]},
                                          {low + e[0], low + e[1], high + e[2], high + e[1]},
                                          {low + e[0], high + e[0], high + e[1], high + e[2]}}};
      for (auto& t : tets) {
        if (swaps % 2 == 1) std::swap(t[2], t[3]);
        solid.elements.push_back(t);
      }
    }
  }
  return solid;
}

}  // namespace selvage::families
