#pragma once

#include "boundary_path/packets/packet_search.h"

/// How a PacketSearch finds the faces that may be answers: down the hierarchy, then in single precision.
namespace selvage {
inline namespace SELVAGE_ISA {

/// Spheres around the boxes of a node's children, a little wider.
struct ChildSpheres {
  alignas(32) float middle[3][BvhNode::kWidth], radius[BvhNode::kWidth];

  SELVAGE_INLINE explicit ChildSpheres(const BvhNode& node) {
    const Float8 half = Float8::broadcast(0.5f);
    Float8 squared_radius = Float8::broadcast(0);
    for (int i = 0; i < 3; ++i) {
      const Float8 lower = Float8::load(node.lower[i]), upper = Float8::load(node.upper[i]),
                   extent = (upper - lower) * half;
      ((lower + upper) * half).store(middle[i]);
      squared_radius = squared_radius + extent * extent;
    }
    (sqrt(squared_radius) * Float8::broadcast(1.001f) + Float8::broadcast(1e-6f)).store(radius);
  }
};

/// Squared distances between boxes, one of which is a point but for its rounding.
template <typename Lanes>
SELVAGE_INLINE Lanes squared_gap(const LaneVec3<Lanes>& lower, const LaneVec3<Lanes>& upper,
                                 const LaneVec3<Lanes>& other_lower, const LaneVec3<Lanes>& other_upper) {
  LaneVec3<Lanes> gap;
  for (int i = 0; i < 3; ++i)
    gap[i] = max(max(lower[i] - other_upper[i], other_lower[i] - upper[i]), Lanes::broadcast(0));
  return dot(gap, gap);
}

/// A child of a node as its ConeNode knows it.
template <typename Lanes>
struct ChildCone {
  LaneVec3<Lanes> middle, axis;
  Lanes radius, cosine, sine;

  /// Lanes that find no answer below the child: see ConeNode.
  ///
  /// How far p is outside the cone of directions around the axis' opposite, opened at each point of the child's sphere.
  /// Slack for the rounding of positions from the box origin, which is a few units across, and for the root of a small
  /// difference, which loses half its digits.
  SELVAGE_INLINE unsigned is_culled_by_cone(const LaneVec3<Lanes>& query_point, unsigned one_sided) const {
    const LaneVec3<Lanes> from_middle = query_point - middle;
    const Lanes along = dot(from_middle, axis), squared_length = dot(from_middle, from_middle);
    const Lanes across = sqrt(max(squared_length - along * along, Lanes::broadcast(0))) * cosine, lift = along * sine;
    const Lanes reach = radius + abs_sum(from_middle) * Lanes::broadcast(1e-3f);
    return less_equal(reach, across + lift) & (less_equal(reach, across - lift) | one_sided);
  }
};

/// Lists for each lane the faces that may be its answer.
template <int D>
void PacketSearch<D>::collect_faces() {
  descend();
  if (faces_.count == 0) return;
  repeat_last_face();
  if constexpr (D == 3) {
    leave_out_far_faces();
    if (faces_.count == 0) return;
    repeat_last_face();
  }
  for (std::size_t pair = 0; pair < faces_.count; pair += kWidth) look_at_faces(pair);
}

/// So that sixteen pairs can be looked at where fewer are left.
template <int D>
void PacketSearch<D>::repeat_last_face() {
  faces_.reserve(kWidth);
  const std::size_t last = faces_.count - 1;
  for (std::size_t i = 1; i <= kWidth; ++i) {
    faces_.items[last + i] = faces_.items[last];
    faces_.lanes[last + i] = faces_.lanes[last];
  }
}

/// Mostly distances alone leave few faces, of which more is to be asked.
template <int D>
void PacketSearch<D>::leave_out_far_faces() {
  std::size_t kept = 0, pair = 0;
  for (; pair < faces_.count && 2 * kept <= pair; pair += kWidth) {
    const std::size_t left = faces_.count - pair, ahead = left > 2 * kWidth ? pair + kWidth : pair;
    const Index *const faces = faces_.items.data() + pair, *const lanes = faces_.lanes.data() + pair;
    for (int i = 0; i < kWidth; ++i) prefetch(input_.face_stars + faces_.items[ahead + i]);
    const FaceStar<D>* stars[kWidth];
    FaceView<D> view;
    view.rounding = input_.rounding;
    for (int i = 0; i < kWidth; ++i) stars[i] = input_.face_stars + faces[i];
    for (int i = 0; i < 3; ++i) view.p[i] = Float16::pick(query_point_[i], lanes);
    for (int k = 0; k < D; ++k)
      view.corners[k] = gather(input_.rounded, [&](int lane) { return stars[lane]->vertices[k]; });
    const unsigned present = left < kWidth ? 0xffffu >> (kWidth - left) : 0xffffu;
    const unsigned near = less_equal(distances_from_below(view), Float16::pick(limit_, lanes), present);
    if (searches_[lanes[0]].counters() != nullptr) count_faces(pair, present & ~near, 0);
    const Int8 both_faces[2] = {Int8::load(faces), Int8::load(faces + 8)};
    const Int8 both_lanes[2] = {Int8::load(lanes), Int8::load(lanes + 8)};
    for (int half = 0; half < 2; ++half) {
      const unsigned some = near >> 8 * half & 0xffu;
      store_packed(both_faces[half], some, faces_.items.data() + kept);
      store_packed(both_lanes[half], some, faces_.lanes.data() + kept);
      kept += static_cast<std::size_t>(count_lanes(some));
    }
  }
  for (; pair < faces_.count; ++pair, ++kept) {
    faces_.items[kept] = faces_.items[pair];
    faces_.lanes[kept] = faces_.lanes[pair];
  }
  faces_.count = kept;
}

/// Nodes that most of the group comes to are visited once for all, others for each lane alone.
template <int D>
void PacketSearch<D>::descend() {
  nodes_.count = faces_.count = 0;
  if (input_.face_nodes.empty() || present_ == 0) return;
  const traversal::WideBox reach(box_of_reach(limit_));
  nodes_.items[0] = 0;
  nodes_.lanes[nodes_.count++] = static_cast<Index>(present_);
  compare_cones();
  for (std::size_t next = 0; next < nodes_.count; ++next) {
    nodes_.reserve(kSmallGroup * BvhNode::kWidth);
    faces_.reserve(kWidth * BvhNode::kWidth);
    const Index ahead = nodes_.items[next + kAhead < nodes_.count ? next + kAhead : next];
    traversal::prefetch_node(input_.face_nodes[ahead]);
    for (std::size_t line = 0; line < sizeof(ConeNode); line += 64)
      prefetch(reinterpret_cast<const char*>(input_.face_cones + ahead) + line);
    const Index place = nodes_.items[next];
    const unsigned lanes = static_cast<unsigned>(nodes_.lanes[next]);
    if (!compares_cones_ && faces_.count >= compare_again_at_) compare_cones();
    if (count_bits(lanes) > kSmallGroup)
      visit_together(place, lanes, reach);
    else
      for (unsigned rest = lanes; rest != 0; rest &= rest - 1) visit(place, lowest_lane(rest));
    if (searches_[0].counters() != nullptr)
      for (unsigned rest = lanes; rest != 0; rest &= rest - 1)
        ++searches_[lowest_lane(rest)].counters()->volumes_visited;
  }
}

/// A box around all that lies within some reach of each point.
template <int D>
Box PacketSearch<D>::box_of_reach(const float (&squared_reach)[kWidth]) const {
  Box box = Box::empty();
  for (unsigned rest = present_; rest != 0; rest &= rest - 1) {
    const int lane = lowest_lane(rest);
    const float radius = std::sqrt(squared_reach[lane]) * (1 + 0x1p-20f);
    for (int i = 0; i < 3; ++i) {
      // The sum is rounded, too.
      const float lower = lower_[i][lane] - radius, upper = upper_[i][lane] + radius;
      box.lower[i] = std::min(box.lower[i], lower - 0x1p-22f * std::abs(lower));
      box.upper[i] = std::max(box.upper[i], upper + 0x1p-22f * std::abs(upper));
    }
  }
  return box;
}

/// To compare a face with its cone costs more than with its box. Where some faces of a group are hardly ever left out
/// for it, the next ones are not compared with theirs, until some are compared again.
template <int D>
void PacketSearch<D>::compare_cones() {
  compares_cones_ = true;
  left_to_compare_ = 48;
}

template <int D>
SELVAGE_INLINE void PacketSearch<D>::count_faces_culled_by_cone(unsigned near, unsigned culled) {
  constexpr int kWorthwhile = 12;
  constexpr std::size_t kFacesBetween = 192;
  if (left_to_compare_ <= 0) return;
  near_faces_ += count_lanes(near);
  faces_culled_by_cone_ += count_lanes(near & culled);
  left_to_compare_ -= count_lanes(near);
  if (left_to_compare_ > 0) return;
  compares_cones_ = faces_culled_by_cone_ * kWorthwhile >= near_faces_;
  compare_again_at_ = faces_.count + kFacesBetween;
}

template <int D>
SELVAGE_INLINE void PacketSearch<D>::visit_together(Index place, unsigned lanes, const traversal::WideBox& reach) {
  constexpr Index kLanes[kWidth] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
  const BvhNode& node = input_.face_nodes[place];
  const ConeNode& cones = input_.face_cones[place];
  const ChildSpheres spheres(node);
  const Float16 limit = Float16::load(limit_);
  for (unsigned rest = traversal::overlapping_children(node, reach); rest != 0; rest &= rest - 1) {
    const int k = lowest_lane(rest);
    const Float16 squared = squared_gap(broadcast_axes<Float16>(node.lower, k), broadcast_axes<Float16>(node.upper, k),
                                        load_axes<Float16>(lower_), load_axes<Float16>(upper_));
    const Index child = node.children[k];
    unsigned wanted = less_equal(squared, limit, lanes);
    if (child < 0 || compares_cones_) {
      const ChildCone<Float16> cone = {broadcast_axes<Float16>(spheres.middle, k),
                                       broadcast_axes<Float16>(cones.axis, k), Float16::broadcast(spheres.radius[k]),
                                       Float16::broadcast(cones.cosine[k]), Float16::broadcast(cones.sine[k])};
      const unsigned culled =
          cone.is_culled_by_cone(load_axes<Float16>(query_point_), 0u - (~cones.two_sided >> k & 1u)) & culling_;
      if (child >= 0) count_faces_culled_by_cone(wanted, culled);
      wanted &= ~culled;
    }
    if (child < 0) {
      nodes_.items[nodes_.count] = ~child;
      nodes_.lanes[nodes_.count] = static_cast<Index>(wanted);
      nodes_.count += wanted != 0;
    } else {
      const unsigned candidates = most_sources_ > 0 ? wanted & ~excluded_from(input_.face_leaves[place], k) : wanted;
      for (const int half : {0, 8}) {
        const unsigned some = candidates >> half & 0xffu;
        store_packed(Int8::load(kLanes + half), some, faces_.lanes.data() + faces_.count);
        Int8::broadcast(child).store(faces_.items.data() + faces_.count);
        faces_.count += static_cast<std::size_t>(count_lanes(some));
      }
    }
  }
}

template <int D>
SELVAGE_INLINE void PacketSearch<D>::visit(Index place, Index lane) {
  const BvhNode& node = input_.face_nodes[place];
  const ConeNode& cones = input_.face_cones[place];
  const auto of_lane = [&](const float(&rows)[3][kWidth]) { return broadcast_axes<Float8>(rows, lane); };
  const Float8 squared =
      squared_gap(load_axes<Float8>(node.lower), load_axes<Float8>(node.upper), of_lane(lower_), of_lane(upper_));
  unsigned wanted = less_equal(squared, Float8::broadcast(limit_[lane])) & node.present();
  const unsigned nodes = negative(Int8::load(node.children));
  if (nodes != 0 || compares_cones_) {
    const ChildSpheres spheres(node);
    const ChildCone<Float8> cone = {load_axes<Float8>(spheres.middle), load_axes<Float8>(cones.axis),
                                    Float8::load(spheres.radius), Float8::load(cones.cosine), Float8::load(cones.sine)};
    const unsigned culled =
        cone.is_culled_by_cone(of_lane(query_point_), ~cones.two_sided) & (0u - (culling_ >> lane & 1u));
    count_faces_culled_by_cone(wanted & ~nodes, culled);
    wanted &= ~culled;
  }
  Index places[BvhNode::kWidth];
  (~Int8::load(node.children)).store(places);
  nodes_.add(places, wanted & nodes, 1 << lane);
  wanted &= ~nodes;
  if (most_sources_ > 0) wanted &= ~excluded_faces(input_.face_leaves[place], lane);
  faces_.add(node.children, wanted, lane);
}

/// Lanes for which the face in a leaf has all the vertices on which p lies, and is no candidate.
template <int D>
SELVAGE_INLINE unsigned PacketSearch<D>::excluded_from(const LeafNode<D>& leaf, int child) const {
  unsigned excluded = ~0u;
  for (int i = 0; i < most_sources_; ++i) {
    unsigned with_source = 0;
    for (int k = 0; k < D; ++k)
      with_source |=
          equal_bits(Float16::load(sources_[i]), Float16::broadcast(std::bit_cast<float>(leaf.vertices[k][child])));
    excluded &= with_source;
  }
  return excluded;
}

/// The same for all faces in a leaf, and one lane.
template <int D>
SELVAGE_INLINE unsigned PacketSearch<D>::excluded_faces(const LeafNode<D>& leaf, Index lane) const {
  unsigned excluded = ~0u;
  for (int i = 0; i < most_sources_; ++i) {
    unsigned with_source = 0;
    for (int k = 0; k < D; ++k)
      with_source |= equal_bits(Float8::load(reinterpret_cast<const float*>(leaf.vertices[k])),
                                Float8::broadcast(sources_[i][lane]));
    excluded &= with_source;
  }
  return excluded;
}

/// Sixteen pairs of a lane and a face, ready to be looked at.
template <int D>
SELVAGE_INLINE FaceView<D> PacketSearch<D>::view(const Index* faces, const Index* lanes) const {
  const FaceStar<D>* stars[kWidth];
  FaceView<D> view;
  view.rounding = input_.rounding;
  for (int i = 0; i < kWidth; ++i) stars[i] = input_.face_stars + faces[i];
  for (int i = 0; i < 3; ++i) view.p[i] = Float16::pick(query_point_[i], lanes);
  Float16 apexes[D];
  for (int k = 0; k < D; ++k) {
    const Vertices16 corner = gather_vertices(input_.rounded, [&](int lane) { return stars[lane]->vertices[k]; });
    const Vertices16 apex = gather_vertices(input_.rounded, [&](int lane) { return stars[lane]->apexes[k]; });
    view.corners[k] = corner.x;
    view.cullable[k] = corner.cullable();
    view.apexes[k] = apex.x;
    view.has_neighbour[k] = ~0u;
    apexes[k] = apex.numbers();
  }
  if (!any_barring_) return view;
  // A neighbour that has what p lies on is no candidate.
  for (int i = 0; i < 2; ++i) {
    const Float16 barring = Float16::pick(barring_sources_[i], lanes);
    for (int k = 0; k < D; ++k) view.has_neighbour[k] &= ~equal_bits(apexes[k], barring);
  }
  return view;
}

/// Sixteen pairs, or what is left.
template <int D>
SELVAGE_INLINE void PacketSearch<D>::look_at_faces(std::size_t first) {
  const std::size_t left = faces_.count - first, ahead = left > 2 * kWidth ? first + kWidth : first;
  const Index *const faces = faces_.items.data() + first, *const lanes = faces_.lanes.data() + first;
  for (int i = 0; i < kWidth; ++i) prefetch(input_.face_stars + faces_.items[ahead + i]);
  const FaceFindings<D> found = look_at(view(faces, lanes));
  const unsigned present = left < kWidth ? 0xffffu >> (kWidth - left) : 0xffffu;
  const unsigned culling = sign_bits(Float16::pick(culling_signs_, lanes));
  const unsigned culled = found.culled() & culling & present;
  const unsigned near = less_equal(found.squared_distance, Float16::pick(limit_, lanes), present & ~culled);
  if (searches_[lanes[0]].counters() != nullptr) count_faces(first, present & ~near, culled);
  float distances[kWidth];
  found.squared_distance.store(distances);
  for (unsigned rest = near; rest != 0; rest &= rest - 1) {
    const int i = lowest_lane(rest);
    Waiting& waiting = waiting_[lanes[i]];
    waiting.squared_distance[waiting.count] = distances[i];
    waiting.feature[waiting.count] = 0;
    for (int k = 0; k < D; ++k)
      waiting.feature[waiting.count] |= static_cast<std::uint8_t>((found.spans[k] >> i & 1) << k);
    waiting.face[waiting.count++] = faces[i];
    if (waiting.count == Waiting::kMax) decide(lanes[i]);
  }
}

/// Pairs of which no more is seen; the others count when they are considered.
template <int D>
void PacketSearch<D>::count_faces(std::size_t first, unsigned seen, unsigned culled) {
  for (unsigned rest = seen; rest != 0; rest &= rest - 1) {
    const int i = lowest_lane(rest);
    PathCounters& counters = *searches_[faces_.lanes[first + static_cast<std::size_t>(i)]].counters();
    ++counters.faces_visited;
    counters.culled += culled >> i & 1;
  }
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
