#include "self_collision/continuous/star_separation.h"

#include "core/parallel.h"
#include "selvage/geometry/closest_point.h"
#include "selvage/geometry/distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace selvage {

namespace {

/// A star takes some hundred nanoseconds, or microseconds where it is measured.
constexpr std::int64_t kStarGrain = 256;
/// Vertices with more triangles make too many pairs to be measured.
constexpr std::size_t kMaxTriangles = 24;
/// No star is measured that has a triangle with a smaller sine of an angle: distances would be too inexact.
constexpr double kMinSine = 1e-3;
/// Sizes of a star in metres between which squares, and products of two of them, keep their digits.
constexpr double kMinSize = 1e-60, kMaxSize = 1e60;
/// Axes that are less orthonormal than this would change distances by more than the slack below.
constexpr double kOrthonormal = 1e-8;
/// Part of a star's size that a distance may be wrong by, and more: it is computed in doubles, where sines are at least
/// kMinSine and edges may be nearly parallel.
constexpr double kSlack = 1e-6;
/// A star that changes its shape is measured ever less often, at last in every 2^kMaxPatience-th step.
constexpr int kMaxPatience = 6;
/// Sampled stars, and the number of steps like the present one in which a nearly rigid star uses up its reach.
constexpr std::int64_t kSampledStars = 64;
constexpr double kRigidSteps = 8;

using Axes = Eigen::Matrix3d;

/// Axes that turn with a triangle, given by its corners, in columns; orthonormal, and nothing where the triangle is so
/// thin that they would not be. Which ones does not matter. Where squares keep their digits the first two have length
/// one, and if these are at right angles, all are.
std::optional<Axes> axes_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 along = b - a, across = along.cross(c - a);
  const double length = along.norm(), area = across.norm();
  if (!(length > kMinSize && length < kMaxSize)) return std::nullopt;
  if (!(area > kMinSize * kMinSize && area < kMaxSize * kMaxSize)) return std::nullopt;
  const Vec3 first = 1 / length * along, second = 1 / area * across;
  if (!(std::abs(first.dot(second)) < kOrthonormal)) return std::nullopt;
  Axes axes;
  axes << first, second, first.cross(second);
  return axes;
}

bool contains(const VertexTuple<3>& triangle, Index vertex) {
  return std::find(triangle.begin(), triangle.end(), vertex) != triangle.end();
}

/// The edge of a triangle that is opposite to a vertex.
std::array<Index, 2> opposite(const VertexTuple<3>& triangle, Index vertex) {
  const int k = triangle[0] == vertex ? 0 : triangle[1] == vertex ? 1 : 2;
  return {triangle[(k + 1) % 3], triangle[(k + 2) % 3]};
}

bool is_well_shaped(const VertexTuple<3>& triangle, std::span<const Vec3> positions) {
  for (int k = 0; k < 3; ++k) {
    const Vec3 a = positions[triangle[(k + 1) % 3]] - positions[triangle[k]];
    const Vec3 b = positions[triangle[(k + 2) % 3]] - positions[triangle[k]];
    if (!(a.cross(b).squaredNorm() > kMinSine * kMinSine * a.squaredNorm() * b.squaredNorm())) return false;
  }
  return true;
}

}  // namespace

StarSeparation::StarSeparation(const TriangleMesh& mesh)
    : mesh_(mesh),
      first_(mesh.vertex_count() + 1, 0),
      stars_(mesh.vertex_count()),
      is_open_(mesh.vertex_count(), 0),
      is_listed_(mesh.vertex_count(), 0) {
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const auto begin = static_cast<std::ptrdiff_t>(around_.size());
    for (const Index t : mesh.vertex_triangles(v))
      for (const Index w : mesh.triangles()[t])
        if (w != v) around_.push_back(w);
    std::sort(around_.begin() + begin, around_.end());
    around_.erase(std::unique(around_.begin() + begin, around_.end()), around_.end());
    // Those of a triangle first, for the axes.
    if (const auto triangles = mesh.vertex_triangles(v); !triangles.empty())
      std::stable_partition(around_.begin() + begin, around_.end(),
                            [&](Index w) { return contains(mesh.triangles()[triangles.front()], w); });
    first_[v + 1] = static_cast<Index>(around_.size());
    if (mesh.vertex_triangles(v).size() > 1) middles_.push_back(v);
  }
  shape_.resize(around_.size());
  turned_.resize(around_.size());
}

/// The smallest distance between features that share no vertex, less a bound of its error; 0 where that is not known.
double StarSeparation::separation(Index vertex, std::span<const Vec3> positions) const {
  const auto triangles = mesh_.vertex_triangles(vertex);
  const auto others = around(vertex);
  if (triangles.size() > kMaxTriangles) return 0;
  // As seen from the middle: differences of doubles that are near each other lose nothing, wherever the star lies.
  const auto place = [&](Index w) -> Vec3 { return positions[w] - positions[vertex]; };
  double size = 0, smallest = std::numeric_limits<double>::infinity();
  for (const Index w : others) size = std::max(size, place(w).norm());
  if (!(size > kMinSize && size < kMaxSize)) return 0;
  for (const Index t : triangles)
    if (!is_well_shaped(mesh_.triangles()[t], positions)) return 0;
  for (const Index t : triangles) {
    const auto& rim = opposite(mesh_.triangles()[t], vertex);
    const std::array<Vec3, 2> edge = {place(rim[0]), place(rim[1])};
    for (const Index w : others) {
      if (w == rim[0] || w == rim[1]) continue;
      const Vec3 apex = place(w), nearest = closest_point_on_triangle(apex, Vec3::Zero(), edge[0], edge[1]).point;
      smallest = std::min(smallest, (nearest - apex).squaredNorm());
      smallest = std::min(smallest, squared_distance(edge, std::array<Vec3, 2>{Vec3::Zero(), apex}));
    }
    for (const Index u : triangles) {
      const auto& other = opposite(mesh_.triangles()[u], vertex);
      if (u <= t || rim[0] == other[0] || rim[0] == other[1] || rim[1] == other[0] || rim[1] == other[1]) continue;
      smallest = std::min(smallest, squared_distance(edge, std::array<Vec3, 2>{place(other[0]), place(other[1])}));
    }
  }
  return std::max(0.0, std::sqrt(smallest) - kSlack * size);
}

void StarSeparation::measure(Index vertex, std::span<const Vec3> positions) {
  const auto axes =
      axes_of(positions[vertex], positions[around_[first_[vertex]]], positions[around_[first_[vertex] + 1]]);
  stars_[vertex].reach = 0;
  if (!axes) return;
  stars_[vertex].reach = 0.5 * separation(vertex, positions);
  for (Index i = first_[vertex]; i < first_[vertex + 1]; ++i) {
    turned_[i] = positions[around_[i]] - positions[vertex];
    shape_[i] = axes->transpose() * turned_[i];
  }
}

/// Seen from the middle each vertex moves on a straight line, so that it is farthest from where it was at one of the
/// ends; two points of triangles around the middle come nearer by at most twice what their vertices moved.
bool StarSeparation::stays_near_turned(Index vertex, std::span<const Vec3> positions_t0,
                                       std::span<const Vec3> positions_t1) const {
  double farthest = 0;
  for (Index i = first_[vertex]; i < first_[vertex + 1]; ++i) {
    const Vec3 moved_t0 = positions_t0[around_[i]] - positions_t0[vertex] - turned_[i];
    const Vec3 moved_t1 = positions_t1[around_[i]] - positions_t1[vertex] - turned_[i];
    farthest = std::max({farthest, moved_t0.squaredNorm(), moved_t1.squaredNorm()});
  }
  const double reach = stars_[vertex].reach - slack_;
  return reach > 0 && farthest < reach * reach;
}

/// Any way to turn the star will do: mostly that of the step before.
bool StarSeparation::is_within_reach(Index vertex, std::span<const Vec3> positions_t0,
                                     std::span<const Vec3> positions_t1) {
  if (!(stars_[vertex].reach > 0)) return false;
  if (stays_near_turned(vertex, positions_t0, positions_t1)) return true;
  const auto axes =
      axes_of(positions_t0[vertex], positions_t0[around_[first_[vertex]]], positions_t0[around_[first_[vertex] + 1]]);
  if (!axes) return false;
  for (Index i = first_[vertex]; i < first_[vertex + 1]; ++i) turned_[i] = *axes * shape_[i];
  return stays_near_turned(vertex, positions_t0, positions_t1);
}

/// Returns whether the star has been measured.
bool StarSeparation::update(Index vertex, std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1) {
  Star& star = stars_[vertex];
  is_open_[vertex] = 0;
  if (is_within_reach(vertex, positions_t0, positions_t1)) return false;
  is_open_[vertex] = 1;
  if (star.waiting > 0) {
    --star.waiting;
    return false;
  }
  measure(vertex, positions_t0);
  if (is_within_reach(vertex, positions_t0, positions_t1)) {
    is_open_[vertex] = 0;
    star.patience = 0;
  } else {
    star.patience = static_cast<std::uint8_t>(std::min(star.patience + 1, kMaxPatience));
    star.waiting = static_cast<std::uint8_t>((1 << star.patience) - 1);
  }
  return true;
}

/// The middles of stars that have a vertex of some, each once.
std::vector<Index> StarSeparation::stars_with(std::span<const Index> vertices) {
  std::vector<Index> middles;
  const auto add = [&](Index v) {
    if (mesh_.vertex_triangles(v).size() > 1 && std::exchange(is_listed_[v], 1) == 0) middles.push_back(v);
  };
  for (const Index v : vertices) {
    add(v);
    for (const Index w : around(v)) add(w);
  }
  for (const Index v : middles) is_listed_[v] = 0;
  return middles;
}

void StarSeparation::place(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1, double margin,
                           std::span<const Index> strayed) {
  slack_ = 3.4642 * margin;  // of the vertex and of the middle, by the root of 3 each
  struct Count {
    std::int64_t value = 0;
    void add(const Count& other) { value += other.value; }
  };
  std::vector<Index> some;
  if (!strayed.empty()) some = stars_with(strayed);
  const std::vector<Index>& placed = strayed.empty() ? middles_ : some;
  measured_count_ = parallel_reduce<Count>(std::ssize(placed), kStarGrain,
                                           [&](std::int64_t first, std::int64_t last, Count& measured) {
                                             for (std::int64_t i = first; i < last; ++i)
                                               measured.value += update(placed[i], positions_t0, positions_t1);
                                           })
                        .value;
  open_.clear();
  for (const Index v : middles_)
    if (is_open_[v] != 0) open_.push_back(v);
}

bool StarSeparation::is_nearly_rigid(Index vertex, std::span<const Vec3> positions_t0,
                                     std::span<const Vec3> positions_t1) const {
  const double reach = 0.5 * separation(vertex, positions_t0) / kRigidSteps;
  const auto others = around(vertex);
  return std::all_of(others.begin(), others.end(), [&](Index w) {
    const Vec3 change = (positions_t1[w] - positions_t1[vertex]) - (positions_t0[w] - positions_t0[vertex]);
    return change.squaredNorm() < reach * reach;
  });
}

bool StarSeparation::are_nearly_rigid(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1) const {
  const std::int64_t asked = std::min(kSampledStars, count());
  std::int64_t rigid = 0;
  for (std::int64_t i = 0; i < asked; ++i)
    rigid += is_nearly_rigid(middles_[i * count() / asked], positions_t0, positions_t1);
  return 4 * rigid >= 3 * asked;
}

void StarSeparation::append_pairs(Index vertex, std::vector<IndexPair>& pairs) const {
  const auto triangles = mesh_.vertex_triangles(vertex);
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (std::size_t k = i + 1; k < triangles.size(); ++k) {
      const auto& a = mesh_.triangles()[triangles[i]];
      const auto& b = mesh_.triangles()[triangles[k]];
      const bool is_elsewhere = std::any_of(a.begin(), a.end(), [&](Index v) {
        return v != vertex && contains(b, v) && (is_open_[v] == 0 || v < vertex);
      });
      if (!is_elsewhere) pairs.emplace_back(triangles[i], triangles[k]);
    }
}

}  // namespace selvage
