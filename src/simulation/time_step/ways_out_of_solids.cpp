#include "simulation/time_step/ways_out_of_solids.h"

#include "contact/ways_out/straight_way.h"
#include "mesh/simplex_corners.h"
#include "simulation/colliders/passage.h"

#include <algorithm>
#include <compare>
#include <map>
#include <set>

namespace selvage {

namespace {

/// Cosine between ways out of a solid below which they lead to two sides of its middle.
constexpr double kTwoSides = -0.3;
/// Times its length at rest above which an edge is torn, and below which it is pressed flat.
constexpr double kTorn = 1.5, kSquashed = 0.5;
/// Part of the largest correction up to which a way is left to contacts.
constexpr double kLeastWay = 0.3;
/// Cosine of ways out above which they are tried as one.
constexpr double kSameWay = 0.98;
/// Ways out that are tried; how many points inside, and vertices of a piece, are asked how far it is; and of all these.
constexpr std::size_t kMostWays = 64, kMostAsked = 256, kFewAsked = 16;
constexpr std::int64_t kAskedGrain = 32;

/// Mean of normals above which they lead to one side.
constexpr double kOneSided = 0.5;

/// Corners of an element's edges.
constexpr int kElementEdges[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
constexpr std::uint8_t kPressedBit = 1 << 6;

/// Points of a piece that are in solids, and ways out of these there.
struct Deep {
  Index vertex = kNone;  ///< one of the piece
  std::vector<Vec3> points, normals;
  std::vector<Index> solids;
  bool is_across = false, is_pressed = false;
  double max_correction = 0;  ///< the largest where it is across [m]

  void add(const Deep& other) {
    vertex = other.vertex;
    max_correction = std::max(max_correction, other.max_correction);
    points.insert(points.end(), other.points.begin(), other.points.end());
    normals.insert(normals.end(), other.normals.begin(), other.normals.end());
    solids.insert(solids.end(), other.solids.begin(), other.solids.end());
  }
};

/// How far from a point a shape reaches.
double reach(const SphereShape& sphere, const Vec3& p) {
  return (p - sphere.centre).norm() + sphere.radius;
}
double reach(const CylinderShape& cylinder, const Vec3& p) {
  return (p - cylinder.centre).norm() + std::hypot(cylinder.radius, cylinder.length / 2);
}
double reach(const MeshCollider& mesh, const Vec3& p) {
  return (p - mesh.bounds().center()).norm() + mesh.bounds().diagonal().norm() / 2;
}

/// A solid collider at the start of a step.
class Solid {
 public:
  Solid(const PreparedCollider& collider, const Step& step)
      : collider_(collider), place_(collider.motion.at(step.start_time)) {}

  /// The way out of a point that is inside.
  std::optional<Hit> hit(const Vec3& point) const {
    std::optional<Hit> found =
        std::visit([&](const auto& shape) { return find_hit(shape, place_.invert(point)); }, collider_.shape);
    if (found) found->normal = place_.rotation * found->normal;
    return found;
  }

  /// The passage of a straight way from a point outside.
  std::optional<Passage> passage(const Vec3& from, const Vec3& to) const {
    std::optional<Passage> found =
        visit_solid([&](const auto& shape) { return find_passage(shape, place_.invert(from), place_.invert(to)); });
    if (found)
      *found = {place_(found->entry), place_.rotation * found->entry_normal, place_.rotation * found->exit_normal};
    return found;
  }

  /// Whether certainly no point of a simplex is inside.
  bool is_clear_of(std::span<const Vec3> corners) const {
    Eigen::AlignedBox3d box;
    for (const Vec3& p : corners) box.extend(place_.invert(p));
    return std::visit([&](const auto& shape) { return is_clear(shape, box); }, collider_.shape);
  }

  /// How far a point has to go in a direction until the solid is behind it.
  double way_past(const Vec3& point, const Vec3& direction) const {
    const Vec3 p = place_.invert(point), d = place_.rotation.transpose() * direction;
    const std::optional<Passage> passage =
        visit_solid([&](const auto& shape) { return find_passage(shape, p + 1.01 * reach(shape, p) * d, p); });
    return passage ? std::max((passage->entry - p).dot(d), 0.0) : 0;
  }

 private:
  template <typename Find>
  std::optional<Passage> visit_solid(Find&& find) const {
    return std::visit(
        [&](const auto& shape) -> std::optional<Passage> {
          if constexpr (kHasFarSide<std::decay_t<decltype(shape)>>) return find(shape);
          return {};
        },
        collider_.shape);
  }

  const PreparedCollider& collider_;
  RigidTransform place_;
};

/// Whether a solid reaches as far as a length on all ways along its surface, so that elements cannot go around it.
/// @param entry, normal  of the surface
bool is_wide(const Solid& solid, const Vec3& entry, const Vec3& normal, double length) {
  const auto [u, w] = across(normal);
  const Vec3 inside = entry - 1e-6 * length * normal;
  for (const Vec3& way : {u, w, Vec3((u + w).normalized()), Vec3((u - w).normalized())})
    if (!(solid.way_past(inside, way) + solid.way_past(inside, -way) > length)) return false;
  return true;
}

/// Where an end of an edge is in a solid.
struct End {
  Vec3 position;
  std::optional<Hit> hit;  ///< none outside
  bool is_deep;

  /// Where it comes out by itself.
  Vec3 way_out() const { return hit ? Vec3(position + hit->depth * hit->normal) : position; }
};

/// Whether the ends of an edge come out of a solid on two sides of its middle, or too far from one another.
/// @param length  at rest [m]
bool is_edge_across(const Solid& solid, const End& a, const End& b, double length) {
  const bool is_deep = a.is_deep || b.is_deep;
  Vec3 entry = a.way_out(), normal = Vec3::Zero(), other = Vec3::Zero();
  if (a.hit && b.hit) {
    normal = a.hit->normal;
    other = b.hit->normal;
    if (is_deep && (a.way_out() - b.way_out()).norm() > kTorn * length) return true;
  } else {
    const End &from = a.hit ? b : a, &to = a.hit ? a : b;
    const std::optional<Passage> passage = solid.passage(from.position, to.position);
    if (!passage) return false;
    entry = passage->entry;
    normal = passage->entry_normal;
    other = to.hit ? to.hit->normal : passage->exit_normal;
  }
  const double cosine = normal.dot(other);
  return is_deep ? cosine < kTwoSides : cosine < kMaxThroughCosine && is_wide(solid, entry, normal, length);
}

/// Whether an edge is pressed flat where its ends come out.
bool is_edge_pressed(const End& a, const End& b, double length) {
  return (a.is_deep || b.is_deep) && (a.way_out() - b.way_out()).norm() < kSquashed * length;
}

/// Of each piece of elements that has any in a solid.
std::map<Index, Deep> find_deep(const Model& model, const Pieces& pieces, const Solid& solid, Index number,
                                const Step& step, std::span<const double> max_corrections) {
  const std::span<const VertexTuple<4>> elements = model.mesh.elements();
  std::vector<std::optional<Hit>> hits(model.mesh.vertex_count());
  parallel_for(std::ssize(hits), kGrain, [&](std::int64_t v) {
    if (!model.mesh.vertex_elements(static_cast<Index>(v)).empty()) hits[v] = solid.hit(step.positions[v]);
  });
  const auto end = [&](Index v) {
    return End{step.positions[v], hits[v], hits[v] && hits[v]->depth > max_corrections[v]};
  };
  std::vector<std::uint8_t> across(elements.size(), 0);  ///< a bit for each edge, and for edges that are pressed
  parallel_for(std::ssize(elements), kGrain, [&](std::int64_t e) {
    if (solid.is_clear_of(corners_of(elements[e], step.positions))) return;
    for (std::size_t k = 0; k < std::size(kElementEdges); ++k) {
      const Index a = elements[e][kElementEdges[k][0]], b = elements[e][kElementEdges[k][1]];
      const double length = (model.rest_positions[a] - model.rest_positions[b]).norm();
      if (is_edge_across(solid, end(a), end(b), length)) across[e] |= 1 << k;
      if (is_edge_pressed(end(a), end(b), length)) across[e] |= kPressedBit;
    }
  });
  std::map<Index, Deep> of_pieces;
  for (Index v = 0; v < std::ssize(hits); ++v) {
    if (!hits[v]) continue;
    Deep& deep = of_pieces[pieces.of_vertex(v)];
    deep.points.push_back(step.positions[v]);
    deep.normals.push_back(hits[v]->normal);
  }
  for (std::size_t e = 0; e < elements.size(); ++e) {
    if (across[e] == 0) continue;
    Deep& deep = of_pieces[pieces.of_vertex(elements[e][0])];
    deep.vertex = elements[e][0];
    deep.solids = {number};
    (across[e] == kPressedBit ? deep.is_pressed : deep.is_across) = true;
    for (const Index v : elements[e]) deep.max_correction = std::max(deep.max_correction, max_corrections[v]);
    for (std::size_t k = 0; k < std::size(kElementEdges); ++k) {
      const Index a = elements[e][kElementEdges[k][0]], b = elements[e][kElementEdges[k][1]];
      if ((across[e] >> k & 1) == 0 || hits[a] || hits[b]) continue;
      const std::optional<Passage> there = solid.passage(step.positions[a], step.positions[b]),
                                   back = solid.passage(step.positions[b], step.positions[a]);
      if (!there || !back) continue;
      deep.points.push_back((there->entry + back->entry) / 2);
      deep.normals.insert(deep.normals.end(), {there->entry_normal, back->entry_normal});
    }
  }
  for (auto& [piece, deep] : of_pieces) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& normal : deep.normals) sum += normal;
    deep.is_across |= deep.is_pressed && sum.norm() > kOneSided * static_cast<double>(deep.normals.size());
  }
  return of_pieces;
}

/// Unit vectors: ways out that differ, and others all around.
std::vector<Vec3> ways_to_try(const Deep& deep) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Vec3& p : deep.points) mean += p / static_cast<double>(deep.points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vec3& p : deep.points) spread += (p - mean) * (p - mean).transpose();
  std::vector<Vec3> ways = directions_to_try(spread);
  const std::size_t most = ways.size() + kMostWays;
  for (const Vec3& normal : deep.normals)
    if (ways.size() < most &&
        std::none_of(ways.begin(), ways.end(), [&](const Vec3& way) { return way.dot(normal) > kSameWay; }))
      ways.push_back(normal);
  return ways;
}

/// Some of many points. The stride is odd: vertices are numbered by layers.
void add_some(std::span<const Vec3> points, std::size_t most, std::vector<Vec3>& some) {
  for (std::size_t i = 0; i < points.size(); i += (points.size() / most) | 1) some.push_back(points[i]);
}

/// How far points have to go in a direction until solids are behind all of them.
double way_past(std::span<const Solid> solids, std::span<const Vec3> points, const Vec3& direction) {
  struct Longest {
    double way = 0;
    void add(const Longest& other) { way = std::max(way, other.way); }
  };
  return parallel_reduce<Longest>(std::ssize(points), kAskedGrain,
                                  [&](std::int64_t first, std::int64_t last, Longest& longest) {
                                    for (const Solid& solid : solids)
                                      for (std::int64_t i = first; i < last; ++i)
                                        longest.add({solid.way_past(points[i], direction)});
                                  })
      .way;
}

/// A way that is tried. The first of some in order is the shortest if it is known.
struct Trial {
  double way;  ///< [m]; at least, where it is not known
  bool is_known;
  Index number;
  auto operator<=>(const Trial&) const = default;
};

/// The shortest way of a piece out of solids that is not blocked. Few points tell how far a way is at least: of most
/// ways no more is asked.
std::optional<PieceWayOff> way_out(const Pieces& pieces, Index piece, const Deep& deep, std::span<const Solid> solids,
                                   const Step& step, const std::function<bool(const Vec3&)>& is_blocked) {
  std::vector<Vec3> of_piece, asked, few;
  for (Index v = 0; v < std::ssize(step.positions); ++v)
    if (pieces.of_vertex(v) == piece) of_piece.push_back(step.positions[v]);
  add_some(of_piece, kMostAsked, asked);
  add_some(deep.points, kMostAsked, asked);
  add_some(asked, kFewAsked, few);
  const std::vector<Vec3> directions = ways_to_try(deep);
  std::vector<double> at_least(directions.size());
  parallel_for(std::ssize(directions), 1, [&](std::int64_t i) { at_least[i] = way_past(solids, few, directions[i]); });
  std::set<Trial> trials;
  for (std::size_t i = 0; i < directions.size(); ++i) trials.insert({at_least[i], false, static_cast<Index>(i)});
  while (!trials.empty()) {
    const Trial trial = trials.extract(trials.begin()).value();
    const Vec3& direction = directions[trial.number];
    if (!trial.is_known)
      trials.insert({way_past(solids, asked, direction), true, trial.number});
    else if (!is_blocked(trial.way * direction))
      return PieceWayOff{deep.vertex, direction, trial.way};
  }
  return {};
}

}  // namespace

std::vector<WayOutOfSolids> ways_out_of_solids(
    const Model& model, const Pieces& pieces, std::span<const PreparedCollider> colliders, const Step& step,
    std::span<const double> max_corrections,
    const std::function<bool(Index, const Vec3&, std::span<const Index>)>& is_blocked) {
  std::map<Index, Deep> across;
  for (Index c = 0; c < std::ssize(colliders); ++c) {
    const PreparedCollider& collider = colliders[c];
    if (!std::visit([](const auto& s) { return kHasFarSide<std::decay_t<decltype(s)>>; }, collider.shape)) continue;
    for (const auto& [piece, deep] : find_deep(model, pieces, Solid(collider, step), c, step, max_corrections))
      if (deep.is_across) across[piece].add(deep);
  }
  std::vector<WayOutOfSolids> found;
  for (const auto& entry : across) {
    const Deep& deep = entry.second;
    std::vector<Solid> solids;
    for (const Index c : deep.solids) solids.emplace_back(colliders[c], step);
    const std::optional<PieceWayOff> off = way_out(pieces, entry.first, deep, solids, step, [&](const Vec3& way) {
      return is_blocked(entry.first, way, deep.solids);
    });
    // Contacts do the rest.
    if (off && off->way > kLeastWay * deep.max_correction) found.push_back({*off, deep.solids});
  }
  return found;
}

}  // namespace selvage
