#pragma once

#include "boundary_path/face_view.h"
#include "boundary_path/search_faces.h"
#include "boundary_path/walk_bundle.h"

#include <bit>

namespace selvage {
inline namespace SELVAGE_ISA {

/// In the plane segments are followed one by one.
struct NoBundle {
  explicit NoBundle(const PathScene<2>&) {}
  int elements_visited(int) const { return 0; }
};

/// The searches of up to sixteen queries that lie near each other.
///
/// The first looks for its answer alone, then three that start from that one's, then the others from theirs. Each looks
/// for a first path by itself. Then all walk down the hierarchy over the boundary faces, level by level and in turns,
/// so that a node has arrived in the cache when its turn comes, and without a branch that depends on what is found
/// there. What is left are pairs of a query and a face: sixteen at a time are looked at in single precision, and the
/// few that may be answers are considered near to far.
template <int D>
class GroupSearch {
 public:
  explicit GroupSearch(const PathScene<D>& scene) : scene_(scene), bundle_(scene), nodes_(kRoom), faces_(kRoom) {}

  /// One result a task and, unless the pointer is null, one set of counters a task.
  void run(std::span<const PathTask<D>> tasks, PathResult<D>* results, PathCounters* counters);

 private:
  static constexpr int kWidth = kPointGroup;
  static constexpr std::size_t kAhead = 6, kRoom = 256;

  /// Pairs of a lane and a node or face.
  struct Pairs {
    explicit Pairs(std::size_t size) : items(size), lanes(size) {}

    KernelVector<Index> items, lanes;
    std::size_t count = 0;

    /// Makes room for all children of a node, and for what is written beyond them.
    SELVAGE_INLINE void reserve() {
      if (items.size() >= count + 2 * BvhNode::kWidth) return;
      items.resize(2 * items.size());
      lanes.resize(2 * lanes.size());
    }
    SELVAGE_INLINE void add(const Index* children, unsigned wanted, Index lane) {
      store_packed(Int8::load(children), wanted, items.data() + count);
      Int8::broadcast(lane).store(lanes.data() + count);
      count += static_cast<std::size_t>(count_lanes(wanted));
    }
  };

  /// Faces that may answer a lane's query.
  struct Waiting {
    static constexpr int kMost = 64;
    int count = 0;
    float squared_distance[kMost];  ///< at least
    Index face[kMost];
  };

  static void prefetch_ends(const PathScene<D>& scene, std::span<const PathTask<D>> tasks);
  void place(int lane);
  void start();
  void take_bound(int lane);
  void walk_down();
  void visit(Index place, Index lane);
  unsigned seen_askew(const BvhNode& node, const ConeNode& cones, Index lane) const;
  void look_at_faces(std::size_t first);
  void count_faces(std::size_t first, unsigned seen, unsigned culled);
  void decide(int lane);

  const PathScene<D>& scene_;
  KernelVector<Search<D>> searches_;
  std::conditional_t<D == 3, WalkBundle, NoBundle> bundle_;
  unsigned present_ = 0;                                   ///< lanes that look for something
  unsigned culling_ = 0;                                   ///< lanes that may pass over faces because of a neighbour
  alignas(64) float eye_[3][kWidth];                       ///< points in the frame, to the nearest float
  alignas(64) float lower_[3][kWidth], upper_[3][kWidth];  ///< boxes around them
  alignas(64) float limit_[kWidth];                        ///< what a computed squared distance may be at most
  alignas(64) float sources_[2][kWidth];                   ///< vertices whose faces prove nothing, as bits
  Pairs nodes_, faces_;
  Waiting waiting_[kWidth];

  static constexpr std::size_t kMostAnswers = 4;
  Answer<D> answers_[kMostAnswers];  ///< from which others start
  std::size_t answer_count_ = 0;
};

template <int D>
void GroupSearch<D>::run(std::span<const PathTask<D>> tasks, PathResult<D>* results, PathCounters* counters) {
  const int count = static_cast<int>(tasks.size());
  prefetch_ends(scene_, tasks);
  searches_.clear();
  searches_.reserve(kWidth);
  answer_count_ = 0;
  for (int first = 0, last = 1; first < count; first = last, last = last < 4 ? 4 : kWidth) {
    if (last > count) last = count;
    present_ = culling_ = 0;
    for (int i = first; i < last; ++i) {
      searches_.emplace_back(scene_, tasks[i], counters != nullptr ? counters + i : nullptr);
      if (!searches_[i].aim({answers_, answer_count_})) continue;
      present_ |= 1u << i;
      place(i);
    }
    start();
    walk_down();
    for (std::size_t pair = 0; pair < faces_.count; pair += kWidth) look_at_faces(pair);
    for (int i = first; i < last; ++i) {
      if ((present_ >> i & 1) != 0) decide(i);
      results[i] = searches_[i].finish();
      if (answer_count_ < kMostAnswers && results[i].status == PathStatus::kFound)
        answers_[answer_count_++] = searches_[i].answer();
    }
  }
}

template <int D>
void GroupSearch<D>::prefetch_ends(const PathScene<D>& scene, std::span<const PathTask<D>> tasks) {
  for (const PathTask<D>& task : tasks) {
    for (const Index v : scene.elements[task.query.element].vertices) prefetch(scene.positions + v);
    if (const Index hint = scene.hints[task.query.element]; hint != kNone) prefetch(scene.face_stars + hint);
  }
}

template <int D>
void GroupSearch<D>::place(int lane) {
  const PathQuery<D>& query = searches_[lane].query();
  const Box box = scene_.frame.around_point(query.point);
  for (int i = 0; i < 3; ++i) {
    eye_[i][lane] = 0;
    lower_[i][lane] = box.lower[i];
    upper_[i][lane] = box.upper[i];
  }
  for (int i = 0; i < D; ++i) eye_[i][lane] = static_cast<float>(query.point[i] - scene_.frame.origin[i]);
  const bool bars = !searches_[lane].may_cull_towards_source();
  for (int i = 0; i < 2; ++i) sources_[i][lane] = std::bit_cast<float>(bars ? query.source[i] : kNone);
}

/// Finds a first path of each lane. Lanes that have none look for nothing any more.
template <int D>
void GroupSearch<D>::start() {
  unsigned paths = 0;
  if constexpr (D == 3) {
    bundle_.clear();
    for (unsigned rest = present_; rest != 0; rest &= rest - 1) {
      const int lane = lowest_lane(rest);
      if (const Candidate<3>* target = searches_[lane].target())
        bundle_.add(lane, searches_[lane].query().element, *target);
    }
    paths = bundle_.follow(eye_);
  }
  for (unsigned rest = present_; rest != 0; rest &= rest - 1) {
    const int lane = lowest_lane(rest);
    if (searches_[lane].start((paths >> lane & 1) != 0 ? bundle_.elements_visited(lane) : 0))
      take_bound(lane);
    else
      present_ &= ~(1u << lane);
  }
}

template <int D>
void GroupSearch<D>::take_bound(int lane) {
  limit_[lane] = traversal::widen_bound(round_up(searches_[lane].squared_bound()));
  const unsigned bit = 1u << lane;
  culling_ = searches_[lane].may_cull() ? culling_ | bit : culling_ & ~bit;
}

template <int D>
void GroupSearch<D>::walk_down() {
  nodes_.count = faces_.count = 0;
  if (scene_.face_nodes.empty()) return;
  for (unsigned rest = present_; rest != 0; rest &= rest - 1) {
    nodes_.items[nodes_.count] = 0;
    nodes_.lanes[nodes_.count++] = lowest_lane(rest);
  }
  for (std::size_t next = 0; next < nodes_.count; ++next) {
    nodes_.reserve();
    faces_.reserve();
    const Index ahead = nodes_.items[next + kAhead < nodes_.count ? next + kAhead : next];
    traversal::prefetch_node(scene_.face_nodes[ahead]);
    for (std::size_t line = 0; line < sizeof(ConeNode); line += 64)
      prefetch(reinterpret_cast<const char*>(scene_.face_cones + ahead) + line);
    visit(nodes_.items[next], nodes_.lanes[next]);
  }
}

template <int D>
SELVAGE_INLINE void GroupSearch<D>::visit(Index place, Index lane) {
  const BvhNode& node = scene_.face_nodes[place];
  Float8 squared = Float8::broadcast(0);
  for (int i = 0; i < 3; ++i) {
    const Float8 below = Float8::load(node.lower[i]) - Float8::broadcast(upper_[i][lane]);
    const Float8 above = Float8::broadcast(lower_[i][lane]) - Float8::load(node.upper[i]);
    const Float8 gap = max(max(below, above), Float8::broadcast(0));
    squared = squared + gap * gap;
  }
  unsigned wanted = less_equal(squared, Float8::broadcast(limit_[lane])) & node.present();
  wanted &= ~(seen_askew(node, scene_.face_cones[place], lane) & (0u - (culling_ >> lane & 1u)));
  const unsigned nodes = negative(Int8::load(node.children));
  Index places[BvhNode::kWidth];
  (~Int8::load(node.children)).store(places);
  nodes_.add(places, wanted & nodes, lane);
  faces_.add(node.children, wanted & ~nodes, lane);
  if (PathCounters* counters = searches_[lane].counters()) ++counters->volumes_visited;
}

/// Children below which no answer lies: see ConeNode.
template <int D>
SELVAGE_INLINE unsigned GroupSearch<D>::seen_askew(const BvhNode& node, const ConeNode& cones, Index lane) const {
  const Float8 zero = Float8::broadcast(0), half = Float8::broadcast(0.5f);
  Float8 along = zero, squared_length = zero, squared_radius = zero, length_bound = zero;
  for (int i = 0; i < 3; ++i) {
    const Float8 lower = Float8::load(node.lower[i]), upper = Float8::load(node.upper[i]);
    const Float8 from_middle = Float8::broadcast(eye_[i][lane]) - (lower + upper) * half,
                 extent = (upper - lower) * half;
    along = along + from_middle * Float8::load(cones.axis[i]);
    squared_length = squared_length + from_middle * from_middle;
    squared_radius = squared_radius + extent * extent;
    length_bound = length_bound + max(from_middle, zero - from_middle);
  }
  // How far p is outside the cone of directions around the axis' opposite, opened at each point of the child's sphere.
  // Slack for the rounding of positions in the frame, which is a few units across, and for the root of a small
  // difference, which loses half its digits.
  const Float8 across = sqrt(max(squared_length - along * along, zero)) * Float8::load(cones.cosine);
  const Float8 lift = along * Float8::load(cones.sine);
  const Float8 radius = sqrt(squared_radius) * Float8::broadcast(1.001f) + length_bound * Float8::broadcast(1e-3f) +
                        Float8::broadcast(1e-6f);
  const unsigned not_below = less_equal(radius, across + lift);
  const unsigned not_above = less_equal(radius, across - lift);
  return not_below & (not_above | ~cones.two_sided);
}

/// Sixteen pairs, or what is left: then the last is repeated.
template <int D>
SELVAGE_INLINE void GroupSearch<D>::look_at_faces(std::size_t first) {
  const int count = faces_.count - first < kWidth ? static_cast<int>(faces_.count - first) : kWidth;
  alignas(64) Index lanes[kWidth], vertices[D][kWidth], apexes[D][kWidth];
  FaceView<D> view;
  view.rounding = scene_.rounding;
  for (unsigned& pairs : view.cullable) pairs = 0;
  unsigned culling = 0;
  for (int i = 0; i < kWidth; ++i) {
    const std::size_t pair = first + static_cast<std::size_t>(i < count ? i : count - 1);
    lanes[i] = faces_.lanes[pair];
    culling |= (culling_ >> lanes[i] & 1u) << i;
    const FaceStar<D>& star = scene_.face_stars[faces_.items[pair]];
    for (int k = 0; k < D; ++k) {
      vertices[k][i] = star.vertices[k];
      apexes[k][i] = star.apexes[k];
      view.cullable[k] |= static_cast<unsigned>(scene_.cullable[star.vertices[k]]) << i;
    }
    const std::size_t ahead = pair + kWidth;
    prefetch(scene_.face_stars + faces_.items[ahead < faces_.count ? ahead : pair]);
  }
  for (int i = 0; i < 3; ++i) view.p.at[i] = Float16::pick(eye_[i], lanes);
  const Float16 sources[2] = {Float16::pick(sources_[0], lanes), Float16::pick(sources_[1], lanes)};
  for (int k = 0; k < D; ++k) {
    view.corners[k] = gather(scene_.rounded, vertices[k]);
    view.apexes[k] = gather(scene_.rounded, apexes[k]);
    // A neighbour that has what p lies on is no candidate.
    const Float16 numbers = Float16::load(reinterpret_cast<const float*>(apexes[k]));
    view.has_neighbour[k] = ~(equal_bits(numbers, sources[0]) | equal_bits(numbers, sources[1]));
  }
  const FaceFindings found = look_at(view);
  const unsigned present = 0xffffu >> (kWidth - count), culled = found.culled & culling & present;
  const unsigned near = less_equal(found.squared_distance, Float16::pick(limit_, lanes), present & ~culled);
  if (searches_[lanes[0]].counters() != nullptr) count_faces(first, present & ~near, culled);
  float distances[kWidth];
  found.squared_distance.store(distances);
  for (unsigned rest = near; rest != 0; rest &= rest - 1) {
    const int i = lowest_lane(rest);
    Waiting& waiting = waiting_[lanes[i]];
    waiting.squared_distance[waiting.count] = distances[i];
    waiting.face[waiting.count++] = faces_.items[first + static_cast<std::size_t>(i)];
    if (waiting.count == Waiting::kMost) decide(lanes[i]);
  }
}

/// Pairs of which no more is seen; the others count when they are considered.
template <int D>
void GroupSearch<D>::count_faces(std::size_t first, unsigned seen, unsigned culled) {
  for (unsigned rest = seen; rest != 0; rest &= rest - 1) {
    const int i = lowest_lane(rest);
    PathCounters& counters = *searches_[faces_.lanes[first + static_cast<std::size_t>(i)]].counters();
    ++counters.faces_visited;
    counters.culled += culled >> i & 1;
  }
}

/// Considers what waits, near to far.
template <int D>
void GroupSearch<D>::decide(int lane) {
  Waiting& waiting = waiting_[lane];
  for (; waiting.count > 0; --waiting.count) {
    int nearest = 0;
    for (int k = 1; k < waiting.count; ++k)
      if (waiting.squared_distance[k] < waiting.squared_distance[nearest]) nearest = k;
    if (!(waiting.squared_distance[nearest] <= limit_[lane])) break;
    searches_[lane].consider(waiting.face[nearest]);
    take_bound(lane);
    waiting.squared_distance[nearest] = waiting.squared_distance[waiting.count - 1];
    waiting.face[nearest] = waiting.face[waiting.count - 1];
  }
  waiting.count = 0;
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
