#include "contact/contours/cloth_contours.h"

#include "contact/input/contact_weights.h"
#include "selvage/geometry/predicates.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>

namespace selvage {

namespace {

/// Least cosine between an edge and the normal of a face that it goes through: beyond it, a direction says nothing.
constexpr double kLeastSlope = 0.02;
/// Part of the sum of lengths that a sum of directions has where they agree.
constexpr double kContourAgreement = 1e-3;
/// Part of its length by which an edge is pulled in a step.
constexpr double kPull = 0.05;

bool shares_vertex(std::span<const Index> a, std::span<const Index> b) {
  return std::any_of(a.begin(), a.end(), [&](Index v) { return std::find(b.begin(), b.end(), v) != b.end(); });
}

/// Sign of a volume, where flat is taken as above.
bool is_above(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return orient3d(a, b, c, d) >= 0;
}

bool passes_through(const std::array<Vec3, 2>& edge, const std::array<Vec3, 3>& face) {
  const auto& [p, q] = edge;
  const auto& [a, b, c] = face;
  if (is_above(a, b, c, p) == is_above(a, b, c, q)) return false;
  const bool first = is_above(p, q, a, b);
  return first == is_above(p, q, b, c) && first == is_above(p, q, c, a);
}

/// Union-find whose members are on one of two sides of their set.
class TwoSided {
 public:
  explicit TwoSided(std::size_t count) : parents_(count), sides_(count, 0), is_split_(count, 1) {
    for (std::size_t i = 0; i < count; ++i) parents_[i] = i;
  }
  std::pair<std::size_t, int> find(std::size_t i) const {
    int side = 0;
    for (; parents_[i] != i; i = parents_[i]) side ^= sides_[i];
    return {i, side};
  }
  bool is_split(std::size_t root) const { return is_split_[root] != 0; }
  /// @param differ  whether the two are on different sides
  void join(std::size_t i, std::size_t j, int differ) {
    auto [a, side_a] = find(i);
    auto [b, side_b] = find(j);
    const int turn = side_a ^ side_b ^ differ;
    if (a == b) {
      if (turn != 0) is_split_[a] = 0;
      return;
    }
    if (a > b) std::swap(a, b);
    parents_[b] = a;
    sides_[b] = turn;
    is_split_[a] = is_split_[a] & is_split_[b];
  }

 private:
  std::vector<std::size_t> parents_;
  std::vector<int> sides_;  ///< against the parent
  std::vector<std::uint8_t> is_split_;
};

template <std::size_t N>
std::array<Vec3, N> gather_points(const std::array<Index, N>& vertices, std::span<const Vec3> positions) {
  std::array<Vec3, N> points;
  for (std::size_t i = 0; i < N; ++i) points[i] = positions[vertices[i]];
  return points;
}

Vec3 normal_of(const std::array<Vec3, 3>& face) {
  return (face[1] - face[0]).cross(face[2] - face[0]).normalized();
}

/// Of a hit whose edge passes through its face.
void measure(const TriangleMesh& surface, std::span<const Vec3> positions, ContourHit& hit) {
  const auto& edge = surface.edges()[hit.edge];
  const auto [p, q] = gather_points(edge, positions);
  const std::array<Vec3, 3> face = gather_points(surface.triangles()[hit.face], positions);
  const Vec3 along = (q - p).normalized(), normal = normal_of(face);
  const double before = normal.dot(p - face[0]), after = normal.dot(q - face[0]);
  hit.place = std::clamp(before / (before - after), 0.0, 1.0);
  if (!std::isfinite(hit.place)) hit.place = 0.5;
  const Vec3 at = p + hit.place * (q - p);
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec3 across = (face[(i + 2) % 3] - face[(i + 1) % 3]).cross(at - face[(i + 1) % 3]);
    sum += hit.barycentric[i] = std::max(normal.dot(across), 0.0);
  }
  for (double& b : hit.barycentric) b = sum > 0 ? b / sum : 1.0 / 3;
  double slope = along.dot(normal);
  if (std::abs(slope) < kLeastSlope) slope = std::copysign(kLeastSlope, slope);
  for (const Index t : surface.edge_triangles(hit.edge)) {
    const auto& triangle = surface.triangles()[t];
    const std::array<Vec3, 3> own = gather_points(triangle, positions);
    Vec3 curve = normal.cross(normal_of(own)).normalized();
    const Index across =
        *std::find_if(triangle.begin(), triangle.end(), [&](Index v) { return v != edge[0] && v != edge[1]; });
    const Vec3 inward = positions[across] - p;
    if (curve.dot(inward - along.dot(inward) * along) < 0) curve = -curve;
    if (curve.allFinite()) hit.shortening += curve - 2 * along.dot(curve) / slope * normal;
  }
  if (!hit.shortening.allFinite()) hit.shortening.setZero();
}

}  // namespace

Contours find_contours(const TriangleMesh& surface, std::span<const Vec3> positions,
                       std::span<const TrianglePair> crossings, Index first_face, Index last_face) {
  Contours contours;
  std::vector<TrianglePair> pairs;
  std::map<TrianglePair, std::size_t> place_of;
  for (const TrianglePair& pair : crossings) {
    const auto counts = [&](Index t) { return t >= first_face && t < last_face; };
    if (counts(pair.first) && counts(pair.second) && place_of.emplace(pair, pairs.size()).second) pairs.push_back(pair);
  }
  // A hit joins all pairs of a triangle at its edge with its face.
  std::map<std::pair<Index, Index>, std::vector<std::pair<std::size_t, int>>> pairs_of_hit;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    for (const int side : {0, 1}) {
      const Index of_edge = side == 0 ? pairs[i].first : pairs[i].second,
                  face = side == 0 ? pairs[i].second : pairs[i].first;
      for (const Index e : surface.triangle_edges()[of_edge]) {
        const auto& edge = surface.edges()[e];
        const auto& corners = surface.triangles()[face];
        if (shares_vertex(edge, corners)) continue;
        if (passes_through(gather_points(edge, positions), gather_points(corners, positions)))
          pairs_of_hit[{e, face}].push_back({i, side});
      }
    }
  TwoSided sets(pairs.size());
  for (const auto& [hit, of] : pairs_of_hit)
    for (const auto& [pair, side] : of) sets.join(of.front().first, pair, of.front().second ^ side);
  std::map<std::size_t, Index> contour_of;
  for (const auto& [features, of] : pairs_of_hit) {
    ContourHit& hit = contours.hits.emplace_back();
    std::tie(hit.edge, hit.face) = features;
    const auto [root, turned] = sets.find(of.front().first);
    hit.contour = contour_of.emplace(root, static_cast<Index>(contour_of.size())).first->second;
    hit.side = sets.is_split(root) ? turned ^ of.front().second : -1;
    measure(surface, positions, hit);
  }
  contours.count = static_cast<Index>(contour_of.size());
  return contours;
}

void append_contour_contacts(const TriangleMesh& surface, std::span<const Vec3> positions, const Contours& contours,
                             std::vector<Contact>& contacts) {
  std::vector<Vec3> sums(contours.count, Vec3::Zero());
  std::vector<double> lengths(contours.count, 0.0);
  const auto sign_of = [](const ContourHit& hit) { return hit.side == 1 ? -1.0 : 1.0; };
  for (const ContourHit& hit : contours.hits) {
    if (hit.side >= 0) sums[hit.contour] += sign_of(hit) * hit.shortening;
    lengths[hit.contour] += hit.shortening.norm();
  }
  for (const ContourHit& hit : contours.hits) {
    const bool agree = sums[hit.contour].norm() > kContourAgreement * lengths[hit.contour];
    const Vec3 direction = agree ? Vec3(sign_of(hit) * sums[hit.contour]) : hit.shortening;
    if (!(direction.norm() > 0)) continue;
    Contact contact;
    contact.kind = ContactKind::kContour;
    contact.normal = direction.normalized();
    contact.distance =
        kPull * (positions[surface.edges()[hit.edge][1]] - positions[surface.edges()[hit.edge][0]]).norm();
    contact.point_feature = hit.edge;
    contact.surface_feature = hit.face;
    const auto& edge = surface.edges()[hit.edge];
    const auto& face = surface.triangles()[hit.face];
    for (int i = 0; i < 2; ++i) add_weight(contact, edge[i], i == 0 ? 1 - hit.place : hit.place);
    for (int i = 0; i < 3; ++i) add_weight(contact, face[i], -hit.barycentric[i]);
    remove_zero_weights(contact);
    contacts.push_back(contact);
  }
}

}  // namespace selvage
