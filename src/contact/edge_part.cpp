#include "contact/edge_part.h"

#include "mesh/simplex_corners.h"
#include "selvage/geometry/predicates.h"

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

/// Gap by which rounding may separate the ends of two parts that meet.
constexpr double kSlack = 1e-9;

bool are_connected(const TetMesh& mesh, const ElementPart& a, const ElementPart& b) {
  return a.part.first <= b.part.last + kSlack && b.part.first <= a.part.last + kSlack &&
         share_vertex(mesh.elements()[a.element], mesh.elements()[b.element]);
}

/// Removes the last part from a list, with all parts connected to it; in the order of their elements.
std::vector<ElementPart> take_run(const TetMesh& mesh, std::vector<ElementPart>& parts, bool joins) {
  std::vector<ElementPart> run{parts.back()};
  parts.pop_back();
  for (std::size_t i = 0; i < run.size() && joins; ++i) {
    const auto taken = std::partition(parts.begin(), parts.end(),
                                      [&](const ElementPart& part) { return !are_connected(mesh, run[i], part); });
    run.insert(run.end(), taken, parts.end());
    parts.erase(taken, parts.end());
  }
  std::sort(run.begin(), run.end(), [](const auto& a, const auto& b) { return a.element < b.element; });
  return run;
}

EdgePart whole_of(std::span<const ElementPart> run) {
  EdgePart whole = run.front().part;
  for (const auto& [element, part] : run) whole = {std::min(whole.first, part.first), std::max(whole.last, part.last)};
  return whole;
}

/// Whether a segment meets a tetrahedron, decided exactly.
bool meets(const std::array<Vec3, 2>& segment, const std::array<Vec3, 4>& tetrahedron) {
  const auto& [from, to] = segment;
  if (locate_in_simplex<3>(tetrahedron, from).inside || locate_in_simplex<3>(tetrahedron, to).inside) return true;
  for (int i = 0; i < 4; ++i) {
    const Vec3 &a = tetrahedron[(i + 1) & 3], &b = tetrahedron[(i + 2) & 3], &c = tetrahedron[(i + 3) & 3];
    if (orient3d(a, b, c, from) * orient3d(a, b, c, to) > 0) continue;
    const auto [least, most] =
        std::minmax({orient3d(from, to, a, b), orient3d(from, to, b, c), orient3d(from, to, c, a)});
    if (least >= 0 || most <= 0) return true;
  }
  return false;
}

}  // namespace

std::optional<EdgePart> part_inside(const std::array<Vec3, 2>& segment, const std::array<Vec3, 4>& tetrahedron) {
  EdgePart part{0, 1};
  for (int i = 0; i < 4; ++i) {
    const Vec3 &a = tetrahedron[(i + 1) & 3], &b = tetrahedron[(i + 2) & 3], &c = tetrahedron[(i + 3) & 3];
    const Vec3 normal = (b - a).cross(c - a);
    const double inside = normal.dot(tetrahedron[i] - a) < 0 ? -1 : 1;
    const double start = inside * normal.dot(segment[0] - a), end = inside * normal.dot(segment[1] - a);
    if (start < 0 && end < 0) return {};
    if (start < 0) part.first = std::max(part.first, start / (start - end));
    if (end < 0) part.last = std::min(part.last, start / (start - end));
  }
  if (!(part.first <= part.last)) return {};
  const Vec3 point = segment[0] + part.middle() * (segment[1] - segment[0]);
  if (!point.allFinite() || !locate_in_simplex<3>(tetrahedron, point).inside) return {};
  // What is as near as rounding seems to be inside, and would no longer be kept from getting there.
  if (!meets(segment, tetrahedron)) return {};
  return part;
}

EdgePoint middle_of_parts(const TetMesh& mesh, std::span<const Vec3> positions, const std::array<Vec3, 2>& segment,
                          std::vector<ElementPart> parts, bool joins) {
  std::vector<ElementPart> best;
  const auto off_middle = [](const EdgePart& part) { return std::abs(part.middle() - 0.5); };
  const auto key = [&](std::span<const ElementPart> run) {
    return std::pair(off_middle(whole_of(run)), run.front().element);
  };
  while (!parts.empty()) {
    std::vector<ElementPart> run = take_run(mesh, parts, joins);
    if (best.empty() || key(run) < key(best)) best = std::move(run);
  }
  const double middle = whole_of(best).middle();
  const Vec3 point = segment[0] + middle * (segment[1] - segment[0]);
  for (const auto& [element, part] : best)
    if (locate_in_simplex<3>(corners_of(mesh.elements()[element], positions), point).inside) return {middle, element};
  // Rounded, it lies beside a run that is as thin as rounding: its own parts' middles do not.
  const auto closest = std::min_element(best.begin(), best.end(), [&](const ElementPart& a, const ElementPart& b) {
    return std::abs(a.part.middle() - middle) < std::abs(b.part.middle() - middle);
  });
  return {closest->part.middle(), closest->element};
}

}  // namespace selvage
