#include "self_collision/culling/planar_embedding.h"

#include "core/parallel.h"
#include "core/simd/simd.h"

#include <cmath>

namespace selvage {

namespace {

constexpr Index kGroup = kAreaGroup;
constexpr std::int64_t kGroupsAtOnce = 64;

/// How far the float form of an area vector may be off, times a vector of components up to 1: a relative error of a few
/// units in the last place of float, and what doubles lost while computing it.
constexpr double kFloatError = 0x1p-18;
constexpr double kDoubleError = 0x1p-49;

/// A cross product and the sum of the absolute values of its terms.
struct CrossProduct {
  double value[3];
  double terms;
};

CrossProduct cross_product(const Vec3& v, const Vec3& w) {
  const double yz = v[1] * w[2], zy = v[2] * w[1];
  const double zx = v[2] * w[0], xz = v[0] * w[2];
  const double xy = v[0] * w[1], yx = v[1] * w[0];
  return {{yz - zy, zx - xz, xy - yx},
          std::abs(yz) + std::abs(zy) + std::abs(zx) + std::abs(xz) + std::abs(xy) + std::abs(yx)};
}

CrossProduct average(const CrossProduct& a, const CrossProduct& b) {
  CrossProduct middle;
  for (int k = 0; k < 3; ++k) middle.value[k] = 0.5 * (a.value[k] + b.value[k]);
  middle.terms = a.terms + b.terms;
  return middle;
}

void store_area(std::array<UnsetVector<float>, 4>& rows, std::size_t place, const CrossProduct& area) {
  double length = 0;
  for (int k = 0; k < 3; ++k) {
    rows[k][place] = static_cast<float>(area.value[k]);
    length += std::abs(area.value[k]);
  }
  rows[3][place] = static_cast<float>(kFloatError * length + kDoubleError * area.terms);
}

/// Sense and box of a simple loop.
struct LoopShape {
  bool may_turn_left;  ///< not certainly clockwise
  float lower[2];
  float upper[2];
};

bool are_apart(const LoopShape& a, const LoopShape& b) {
  constexpr double kMargin = 0x1p-20;  // of coordinates below 1, rounded to float
  const auto is_below = [](double x, double y) { return x + kMargin < y; };
  return is_below(a.upper[0], b.lower[0]) || is_below(b.upper[0], a.lower[0]) || is_below(a.upper[1], b.lower[1]) ||
         is_below(b.upper[1], a.lower[1]);
}

/// The shape of one loop, given by its blocks.
template <int kSteps>
LoopShape shape_of(const PlanarLoops<kSteps>& loops, std::span<const EdgeBlock> blocks) {
  const float* const x = loops.coordinates[0][0];
  const float* const y = loops.coordinates[0][1];
  double area = 0, length = 0;
  LoopShape shape{true, {2, 2}, {-2, -2}};
  for (const EdgeBlock& block : blocks) {
    for (Index i = block.first; i < block.first + block.count; ++i) {
      area += double{x[i]} * y[i + 1] - double{x[i + 1]} * y[i];
      length += std::abs(x[i + 1] - x[i]) + std::abs(y[i + 1] - y[i]);
    }
    for (int axis = 0; axis < 2; ++axis) {
      shape.lower[axis] = std::min(shape.lower[axis], block.lower[axis]);
      shape.upper[axis] = std::max(shape.upper[axis], block.upper[axis]);
    }
  }
  // Vertices are off by 2^-25 in each coordinate, so twice the area by less than this.
  shape.may_turn_left = !(area < -0x1p-20 * length);
  return shape;
}

/// Whether simple loops that do not meet certainly wind around no point twice: no two of them that turn left are
/// nested.
template <int kSteps>
bool is_covered_once(const PlanarLoops<kSteps>& loops, std::size_t loop_count) {
  constexpr int kMaxLeftTurning = 8;  // more are too many pairs
  if (loop_count == 1) return true;
  std::array<LoopShape, kMaxLeftTurning> left;
  int count = 0;
  const std::span<const EdgeBlock> blocks = loops.blocks;
  for (std::size_t first = 0, last = 0; first < blocks.size(); first = last) {
    while (blocks[last++].continues) {
    }
    const LoopShape shape = shape_of(loops, blocks.subspan(first, last - first));
    if (!shape.may_turn_left) continue;
    if (count == kMaxLeftTurning) return false;
    for (int k = 0; k < count; ++k)
      if (!are_apart(left[k], shape)) return false;
    left[count++] = shape;
  }
  return true;
}

}  // namespace

ProjectionPlane plane_across(const Vec3& direction) {
  const double length = direction.stableNorm();
  if (!(length > 0) || !std::isfinite(length)) return {};
  const Vec3 normal = direction / length;
  int smallest = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(normal[k]) < std::abs(normal[smallest])) smallest = k;
  const Vec3 u = Vec3::Unit(smallest).cross(normal).normalized(), v = normal.cross(u);
  ProjectionPlane plane;
  Vec3 rounded_u, rounded_v;
  for (int k = 0; k < 3; ++k) {
    rounded_u[k] = plane.u_axis[k] = static_cast<float>(u[k]);
    rounded_v[k] = plane.v_axis[k] = static_cast<float>(v[k]);
  }
  const Vec3 across = rounded_u.cross(rounded_v);
  for (int k = 0; k < 3; ++k) plane.normal[k] = static_cast<float>(across[k]);
  return plane;
}

template <int kSteps>
void PlanarEmbeddingTest<kSteps>::take(SurfacePieces& pieces, const Poses& poses, Rounded rounded) {
  pieces_ = &pieces;
  poses_ = poses;
  rounded_ = rounded;
  const std::size_t count = pieces.triangles().size();
  for (auto& coefficient : areas_)
    for (auto& row : coefficient) row.resize(count + EdgeBlock::kWidth);  // whole blocks are read
  group_areas_.resize((count + kGroup - 1) / kGroup);
}

template <int kSteps>
void PlanarEmbeddingTest<kSteps>::measure(SurfacePieces::Range places) {
  const Index first_group = places.first / kGroup, last_group = (places.last + kGroup - 1) / kGroup;
  const auto count = static_cast<Index>(pieces_->triangles().size());
  parallel_ranges(last_group - first_group, kGroupsAtOnce, [&](std::int64_t first, std::int64_t last) {
    const auto begin_of = [&](std::int64_t i) {
      const std::int64_t begin = (first_group + i) * kGroup;
      return begin < count ? static_cast<Index>(begin) : count;
    };
    if (!rounded_.empty()) return compute_areas_in_frame(begin_of(first), begin_of(last));
    for (std::int64_t i = first; i < last; ++i) compute_areas(begin_of(i), begin_of(i + 1));
  });
}

/// Computes the area vectors of one group.
template <int kSteps>
void PlanarEmbeddingTest<kSteps>::compute_areas(Index first, Index last) {
  Vec3 sum = Vec3::Zero();
  for (Index place = first; place < last; ++place) {
    const auto& t = pieces_->triangles()[place];
    std::array<Vec3, kSteps> e, f;
    for (int s = 0; s < kSteps; ++s) {
      const Vec3& origin = poses_[s][t[0]];
      e[s] = poses_[s][t[1]] - origin;
      f[s] = poses_[s][t[2]] - origin;
      const CrossProduct area = cross_product(e[s], f[s]);
      store_area(areas_[2 * s], place, area);
      for (int k = 0; k < 3; ++k) sum[k] += area.value[k];
    }
    if constexpr (kSteps == 2)
      store_area(areas_[1], place, average(cross_product(e[0], f[1]), cross_product(e[1], f[0])));
  }
  group_areas_[first / kGroup] = sum;
}

/// Computes the area vectors of whole groups, eight triangles at once, from floats.
template <int kSteps>
void PlanarEmbeddingTest<kSteps>::compute_areas_in_frame(Index first, Index last) {
  if constexpr (kSteps == 2) {
    MovingAreaRows areas{{}, areas_[0][3].data(), group_areas_.data()};
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < 3; ++k) areas.rows[c][k] = areas_[c][k].data();
    SELVAGE_DISPATCH(measure_moving_areas, rounded_.data(), pieces_->triangles().data(), first, last, areas);
  }
}

template <int kSteps>
ProjectionPlane PlanarEmbeddingTest<kSteps>::plane_of(Index node) const {
  const auto range = pieces_->ranges()[node];
  Vec3 sum = Vec3::Zero();
  const auto add_places = [&](Index first, Index last) {
    for (Index place = first; place < last; ++place)
      for (int s = 0; s < kSteps; ++s)
        for (int k = 0; k < 3; ++k) sum[k] += areas_[2 * s][k][place];
  };
  const Index first_group = (range.first + kGroup - 1) / kGroup, last_group = range.last / kGroup;
  if (first_group >= last_group) {
    add_places(range.first, range.last);
  } else {
    add_places(range.first, first_group * kGroup);
    for (Index group = first_group; group < last_group; ++group) sum += group_areas_[group];
    add_places(last_group * kGroup, range.last);
  }
  return plane_across(sum);
}

template <int kSteps>
bool PlanarEmbeddingTest<kSteps>::do_triangles_face(Index node, const ProjectionPlane& plane) const {
  const auto range = pieces_->ranges()[node];
  for (const auto& rows : areas_) {
    const auto& errors = rounded_.empty() ? rows[3] : areas_[0][3];
    const AreaVectors areas{{rows[0].data(), rows[1].data(), rows[2].data(), errors.data()}};
    if (!SELVAGE_DISPATCH(do_all_face, areas, range.first, range.last, plane)) return false;
  }
  return true;
}

/// Projects the contours, scales them into [-1, 1] and cuts them into blocks. No blocks where that overflows.
template <int kSteps>
PlanarLoops<kSteps> PlanarEmbeddingTest<kSteps>::project_contours(const SurfacePieces::Contours& contours,
                                                                  const ProjectionPlane& plane,
                                                                  Workspace& workspace) const {
  constexpr Index kWidth = EdgeBlock::kWidth;
  // Room for each loop's first vertex again, as often as a block may read past the last one.
  const std::size_t room = contours.edges.size() + contours.loops.size() * kWidth;
  workspace.vertices.resize(room);
  workspace.exact.resize(2 * kSteps * room);
  workspace.coordinates.resize(2 * kSteps * room);
  workspace.blocks.clear();
  PlanarLoops<kSteps> loops;
  loops.vertices = workspace.vertices.data();
  std::array<double*, 2 * kSteps> rows;
  for (int k = 0; k < 2 * kSteps; ++k) {
    rows[k] = workspace.exact.data() + k * room;
    loops.coordinates[k / 2][k % 2] = workspace.coordinates.data() + k * room;
  }

  for (const Index edge : contours.edges)
    for (int s = 0; s < kSteps; ++s) prefetch(&poses_[s][pieces_->tail(edge)]);
  double largest = 0, sum = 0;  // a coordinate that is not finite shows in the sum
  // An origin that moves along takes out what the piece moves as a whole.
  std::array<Vec3, kSteps> origin;
  for (int s = 0; s < kSteps; ++s) origin[s] = poses_[s][pieces_->tail(contours.edges[0])];
  std::size_t place = 0, first_edge = 0;
  for (const Index end : contours.loops) {
    const std::size_t first = place;
    for (std::size_t edge = first_edge; edge < static_cast<std::size_t>(end); ++edge, ++place) {
      const Index v = workspace.vertices[place] = pieces_->tail(contours.edges[edge]);
      for (int s = 0; s < kSteps; ++s) {
        const Vec3 p = poses_[s][v] - origin[s];
        const double x = p[0] * plane.u_axis[0] + p[1] * plane.u_axis[1] + p[2] * plane.u_axis[2];
        const double y = p[0] * plane.v_axis[0] + p[1] * plane.v_axis[1] + p[2] * plane.v_axis[2];
        rows[2 * s][place] = x;
        rows[2 * s + 1][place] = y;
        const double size = std::max(std::abs(x), std::abs(y));
        largest = std::max(largest, size);
        sum += std::abs(x) + std::abs(y);
      }
    }
    for (std::size_t i = first; i < place; i += kWidth)
      workspace.blocks.push_back({static_cast<Index>(i),
                                  static_cast<Index>(std::min<std::size_t>(kWidth, place - i)),
                                  i + kWidth < place,
                                  {},
                                  {}});
    for (Index i = 0; i < kWidth; ++i, ++place) {
      workspace.vertices[place] = workspace.vertices[first];
      for (double* const row : rows) row[place] = row[first];
    }
    first_edge = end;
  }
  const double scale = 0.99 / largest;
  if (!std::isfinite(sum) || !std::isfinite(scale)) workspace.blocks.clear();
  for (std::size_t i = 0; i < workspace.exact.size(); ++i)
    workspace.coordinates[i] = static_cast<float>(workspace.exact[i] * scale);
  loops.blocks = workspace.blocks;
  return loops;
}

template <int kSteps>
bool PlanarEmbeddingTest<kSteps>::is_contour_embedded(Index node, const ProjectionPlane& plane, Workspace& workspace,
                                                      ContourTest test) const {
  const SurfacePieces::Contours& contours = pieces_->contours(node, workspace.waiting);
  if (contours.edges.empty()) return false;
  const PlanarLoops<kSteps> loops = project_contours(contours, plane, workspace);
  if (loops.blocks.empty()) return false;
  SELVAGE_DISPATCH(fit_blocks, loops);
  return is_covered_once(loops, contours.loops.size()) && SELVAGE_DISPATCH(is_contour_simple, loops, test);
}

template <int kSteps>
bool PlanarEmbeddingTest<kSteps>::is_embedded(Index node, Workspace& workspace) const {
  const ProjectionPlane plane = plane_of(node);
  return do_triangles_face(node, plane) && is_contour_embedded(node, plane, workspace);
}

namespace {

/// Testing smaller pieces costs about as much as comparing their triangles.
constexpr Index kMinTriangles = 32;

/// Whether enough of the smallest pieces, which pass most often, pass the test to pay for testing all. Decided by a
/// sample of them.
template <int kSteps>
bool is_worth_testing(const SurfacePieces& pieces, PlanarEmbeddingTest<kSteps>& test, bool knows_neighbours) {
  constexpr std::size_t kOneOf = 16, kMinSampled = 16, kMaxSampled = 32;
  // The share of triangles that must be culled. A culled triangle saves more where it would be compared with its
  // neighbours over a step.
  const double worthwhile_share = kSteps == 1 || knows_neighbours ? 0.75 : 1.0 / 16;
  std::vector<Index> small;
  for (std::size_t n = 0; n < pieces.ranges().size(); ++n)
    if (const Index size = pieces.ranges()[n].size(); size >= kMinTriangles && size < 4 * kMinTriangles)
      small.push_back(static_cast<Index>(n));
  if (small.size() < kMinSampled) return true;
  const std::size_t step = std::max(std::min(kOneOf, small.size() / kMinSampled), small.size() / kMaxSampled);
  std::int64_t may_fail = 0;
  for (std::size_t i = 0; i < small.size(); i += step) may_fail += pieces.ranges()[small[i]].size();
  may_fail = static_cast<std::int64_t>((1 - worthwhile_share) * static_cast<double>(may_fail));
  typename PlanarEmbeddingTest<kSteps>::Workspace workspace;
  for (std::size_t i = 0; i < small.size() && may_fail >= 0; i += step) {
    const SurfacePieces::Range range = pieces.ranges()[small[i]];
    test.measure(range);
    if (!test.is_embedded(small[i], workspace)) may_fail -= range.size();
  }
  return may_fail >= 0;
}

}  // namespace

template <int kSteps>
CulledPairs cull_by_planar_embedding(const Bvh& bvh, SurfacePieces& pieces,
                                     const typename PlanarEmbeddingTest<kSteps>::Poses& poses,
                                     std::span<const MovingVertex> rounded, bool knows_neighbours,
                                     PlanarEmbeddingTest<kSteps>& test) {
  using Workspace = typename PlanarEmbeddingTest<kSteps>::Workspace;
  CulledPairs culled;
  test.take(pieces, poses, rounded);
  if (!is_worth_testing(pieces, test, knows_neighbours)) return culled;
  test.measure({0, static_cast<Index>(pieces.triangles().size())});
  cull_from_root<Workspace>(bvh, pieces, kMinTriangles, culled,
                            [&](Index node, Workspace& workspace) { return test.is_embedded(node, workspace); });
  return culled;
}

template class PlanarEmbeddingTest<1>;
template class PlanarEmbeddingTest<2>;
template CulledPairs cull_by_planar_embedding<1>(const Bvh&, SurfacePieces&, const PlanarEmbeddingTest<1>::Poses&,
                                                 std::span<const MovingVertex>, bool, PlanarEmbeddingTest<1>&);
template CulledPairs cull_by_planar_embedding<2>(const Bvh&, SurfacePieces&, const PlanarEmbeddingTest<2>::Poses&,
                                                 std::span<const MovingVertex>, bool, PlanarEmbeddingTest<2>&);

}  // namespace selvage
