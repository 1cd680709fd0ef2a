#include "boundary_path/families/figures.h"

namespace selvage::families {

namespace {

// The element among [first, last) that has the point strictly inside.
Index element_at(const Pieces<2>& mesh, const Vec2& p, Index first, Index last) {
  for (Index e = first; e < last; ++e) {
    int positive = 0, negative = 0;
    for (int i = 0; i < 3; ++i) {
      const Vec2 a = mesh.positions[mesh.elements[e][i]] - p, b = mesh.positions[mesh.elements[e][(i + 1) % 3]] - p;
      const double area = a[0] * b[1] - a[1] * b[0];
      positive += area > 0;
      negative += area < 0;
    }
    if (positive == 3 || negative == 3) return e;
  }
  return kNone;
}

Figure figure(const std::string& name, const Pieces<2>& mesh, const Vec2& p, Index first, Index last, double distance,
              const Vec2& closest, Index source = kNone) {
  return {name, mesh, {p, element_at(mesh, p, first, last), {source, kNone}}, distance, closest};
}

Index count(const Pieces<2>& mesh) {
  return static_cast<Index>(mesh.elements.size());
}

}  // namespace

Pieces<2> hook(double tip) {
  auto mesh = walk("EEEENNNNWWWSSSS");
  const auto n = mesh.positions.size();
  for (std::size_t v = n - 2; v < n; ++v) mesh.positions[v] = {mesh.positions[v][0] == 1 ? 1.25 : 1.75, tip};
  return mesh;
}

Pieces<2> layers(const std::vector<double>& heights) {
  auto mesh = grid(1, static_cast<int>(heights.size()) - 1);
  for (auto& x : mesh.positions) x = {10 * x[0], heights[static_cast<std::size_t>(x[1])]};
  return mesh;
}

std::vector<Figure> paper_figures() {
  std::vector<Figure> list;
  // Figure 2: a boundary point of the tip coincides with an interior point of the bar.
  for (const double tip : {0.375, 0.75}) {
    auto mesh = hook(tip);
    const auto n = static_cast<Index>(mesh.positions.size());
    const Index left = mesh.positions[n - 1][0] == 1.25 ? n - 1 : n - 2;
    const double depth = std::min(tip, 1 - tip);
    list.push_back(
        figure("2 tip " + std::to_string(tip), mesh, {1.25, tip}, 0, 10, depth, {1.25, tip < 0.5 ? 0.0 : 1.0}, left));
  }
  // Figure 3: one place, two material points, two answers; and a closer boundary point that is not to be reached.
  const auto mesh = hook(0.375);
  const Index n = count(mesh);
  list.push_back(figure("3c as the bar", mesh, {1.5, 0.703125}, 0, 10, 0.296875, {1.5, 1}));
  list.push_back(figure("3e as the tip", mesh, {1.5, 0.703125}, n - 2, n, 0.328125, {1.5, 0.375}));
  // Figure 4: a path through many triangles, and a candidate whose segment leaves the mesh.
  list.push_back(figure("4a", grid(9, 9), {4.75, 4.375}, 0, 162, 4.25, {9, 4.375}));
  list.push_back(figure("4b", mesh, {1.5625, 0.4375}, 0, 10, 0.4375, {1.5625, 0}));
  // Figure 5: another object's vertex in the bar, close to the tip's boundary.
  const auto both = together(mesh, {{{1.5625, 0.4375}, {1.625, -2}, {1.875, -2}}, {{0, 1, 2}}});
  list.push_back(
      figure("5", both, {1.5625, 0.4375}, 0, 10, 0.4375, {1.5625, 0}, static_cast<Index>(mesh.positions.size())));
  // Figure 6b: the path turns back in an inverted layer, before the point and beyond it; 6c: also behind its start.
  const auto folded = layers({0, 3, 2, 9}), behind = layers({0, 3, -1, 5});
  list.push_back(figure("6b overlapping itself", folded, {5.5, 3.5}, 4, 6, 3.5, {5.5, 0}));
  list.push_back(figure("6b past the point and back", folded, {5.5, 2.5}, 4, 6, 2.5, {5.5, 0}));
  list.push_back(figure("6b in the inverted layer", folded, {5.5, 2.625}, 2, 4, 2.625, {5.5, 0}));
  list.push_back(figure("6c behind the start", behind, {5.5, 1.625}, 4, 6, 1.625, {5.5, 0}));
  list.push_back(figure("6c given up beyond twice the distance", behind, {5.5, 1}, 4, 6, 4, {5.5, 5}));
  // Figure 7: a boundary triangle folded inward; its own boundary edge is no candidate.
  auto dent = grid(5, 5);
  dent.positions[2] = {2.25, 2.25};
  const Index there = element_at(dent, {2.125, 2.5}, 0, 50);
  list.push_back({"7", dent, {{2.125, 2.5}, there}, 2.125, {0, 2.5}});
  return list;
}

}  // namespace selvage::families
