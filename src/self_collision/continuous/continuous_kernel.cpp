#include "self_collision/continuous/continuous_kernel.h"

#include "bvh/traverse_pairs.h"
#include "self_collision/continuous/feature_batch.h"

namespace selvage {
inline namespace SELVAGE_ISA {

namespace {

/// An integer in all lanes.
SELVAGE_INLINE Float8 wide_bits(std::int32_t x) {
  return Float8::broadcast(std::bit_cast<float>(x));
}

SELVAGE_INLINE Float4 row_of(const MovingTriangle& triangle) {
  return Float4::load(reinterpret_cast<const float*>(&triangle));
}

SELVAGE_INLINE bool do_share_vertex(const MovingTriangle& a, const MovingTriangle& b) {
  const auto has = [&](Index v) { return equal_lanes(row_of(a), Float4::broadcast(std::bit_cast<float>(v))); };
  return (sign_bits(or_bits(or_bits(has(b.vertices[0]), has(b.vertices[1])), has(b.vertices[2]))) & 7u) != 0;
}

/// Eight pairs of triangles, feature by feature.
struct TriangleFeatures {
  alignas(32) Index vertices[6][EightPairs::kSize];  ///< corners of the first ones, then of the second ones
  Float8 represented[2];                             ///< see MovingTriangle

  SELVAGE_INLINE TriangleFeatures(const ContinuousInput& input, const EightPairs& pairs) {
    for (const int side : {0, 1}) {
      const Index* const triangles = side == 0 ? pairs.first : pairs.second;
      Float8 rows[4];
      for (int i = 0; i < 4; ++i)
        rows[i] = Float8::join(row_of(input.triangles[triangles[i]]), row_of(input.triangles[triangles[i + 4]]));
      transpose(rows[0], rows[1], rows[2], rows[3]);
      for (int k = 0; k < 3; ++k) rows[k].store(reinterpret_cast<float*>(vertices[3 * side + k]));
      represented[side] = rows[3];
    }
  }
  SELVAGE_INLINE unsigned represented_vertex(int side, int k) const { return lanes_with(represented[side], 1 << k); }
  SELVAGE_INLINE unsigned represented_edge(int side, int k) const { return lanes_with(represented[side], 8 << k); }

  /// Lanes in which corner i of the first and corner j of the second are one vertex.
  SELVAGE_INLINE unsigned same_corner(int i, int j) const {
    return equal_bits(Float8::load(reinterpret_cast<const float*>(vertices[i])),
                      Float8::load(reinterpret_cast<const float*>(vertices[3 + j])));
  }

 private:
  SELVAGE_INLINE static unsigned lanes_with(Float8 bits, std::int32_t bit) {
    return equal_bits(and_bits(bits, wide_bits(bit)), wide_bits(bit));
  }
};

/// Pairs of triangles whose boxes meet, tested eight at once: first both triangles as a whole, unless they have a
/// vertex in common; then the pairs of features whose representative triangles they are.
class TriangleBatch {
 public:
  TriangleBatch(const ContinuousInput& input, ContinuousResult& result)
      : input_(input), result_(result), vertex_face_(input, result), edge_edge_(input, result) {}

  SELVAGE_INLINE void add(Index first, Index second) {
    if (do_share_vertex(input_.triangles[first], input_.triangles[second])) {
      if (near_.add(first, second)) test_features();
    } else if (pairs_.add(first, second)) {
      test_triangles();
    }
  }

  void flush() {
    if (pairs_.count > 0) test_triangles();
    if (near_.count > 0) test_features();
    vertex_face_.flush();
    edge_edge_.flush();
  }

 private:
  void test_triangles() {
    const unsigned lanes = pairs_.fill();
    const TriangleFeatures features(input_, pairs_);
    const unsigned apart = MovingSets<3, 3>(input_, features.vertices).apart();
    for (unsigned rest = lanes & ~apart; rest != 0; rest &= rest - 1) {
      const int i = lowest_lane(rest);
      if (near_.add(pairs_.first[i], pairs_.second[i])) test_features();
    }
    pairs_.count = 0;
  }

  void test_features() {
    const unsigned lanes = near_.fill();
    const TriangleFeatures features(input_, near_);
    const MovingSets<3, 3> sets(input_, features.vertices);
    unsigned same[3][3];  // corners that are one vertex
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) same[i][j] = features.same_corner(i, j);
    unsigned vertex_face[2][3], edge_edge[3][3];
    for (int i = 0; i < 3; ++i) {
      vertex_face[0][i] = lanes & features.represented_vertex(0, i) & ~(same[i][0] | same[i][1] | same[i][2]);
      vertex_face[1][i] = lanes & features.represented_vertex(1, i) & ~(same[0][i] | same[1][i] | same[2][i]);
      for (int j = 0; j < 3; ++j) {
        edge_edge[i][j] = lanes & features.represented_edge(0, i) & features.represented_edge(1, j);
        for (int k = 1; k < 3; ++k)
          for (int l = 1; l < 3; ++l) edge_edge[i][j] &= ~same[(i + k) % 3][(j + l) % 3];
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      MovingExtent corners[2][3], edges[2][3], faces[2];
      for (int side = 0; side < 2; ++side) {
        for (int k = 0; k < 3; ++k) corners[side][k] = sets.extent(3 * side + k, axis);
        for (int k = 0; k < 3; ++k) edges[side][k] = corners[side][(k + 1) % 3].joined(corners[side][(k + 2) % 3]);
        faces[side] = edges[side][0].joined(corners[side][0]);
      }
      for (int i = 0; i < 3; ++i) {
        for (int side = 0; side < 2; ++side)
          vertex_face[side][i] &= ~corners[side][i].apart_from(faces[1 - side], sets.gap());
        for (int j = 0; j < 3; ++j) edge_edge[i][j] &= ~edges[0][i].apart_from(edges[1][j], sets.gap());
      }
    }
    for (int i = 0; i < 3; ++i) {
      for (int side = 0; side < 2; ++side) add_vertex_faces(features, side, i, vertex_face[side][i]);
      for (int j = 0; j < 3; ++j) add_edges(features, i, j, edge_edge[i][j]);
    }
    near_.count = 0;
  }

  void add_vertex_faces(const TriangleFeatures& features, int side, int corner, unsigned lanes) {
    const Index(*const face)[EightPairs::kSize] = features.vertices + 3 * (1 - side);
    for (; lanes != 0; lanes &= lanes - 1) {
      const int lane = lowest_lane(lanes);
      const Index vertex = features.vertices[3 * side + corner][lane];
      ++result_.counters.vertex_face_boxes;
      vertex_face_.add({vertex,
                        (side == 0 ? near_.second : near_.first)[lane],
                        {vertex, face[0][lane], face[1][lane], face[2][lane]}});
    }
  }

  /// Edges opposite to two corners.
  void add_edges(const TriangleFeatures& features, int i, int j, unsigned lanes) {
    const auto& v = features.vertices;
    for (; lanes != 0; lanes &= lanes - 1) {
      const int lane = lowest_lane(lanes);
      const Index e = input_.triangle_edges[near_.first[lane]][i];
      const Index f = input_.triangle_edges[near_.second[lane]][j];
      ++result_.counters.edge_edge_boxes;
      edge_edge_.add(
          {e < f ? e : f,
           e < f ? f : e,
           {v[(i + 1) % 3][lane], v[(i + 2) % 3][lane], v[3 + (j + 1) % 3][lane], v[3 + (j + 2) % 3][lane]}});
    }
  }

  const ContinuousInput& input_;
  ContinuousResult& result_;
  EightPairs pairs_, near_;
  FeatureBatch<1> vertex_face_;
  FeatureBatch<2> edge_edge_;
};

/// One piece of a search: the hierarchy decides which triangles are tested.
class Search {
 public:
  Search(const ContinuousInput& input, ContinuousResult& result)
      : input_(input), result_(result), triangles_(input, result) {}

  void run(NodePair start) {
    traversal::visit_meeting<true>(
        input_.nodes, input_.nodes, start, [&](NodePair pair) { return enter(pair); },
        [&](const PrimitivePairs& pairs) { take(pairs); });
    triangles_.flush();
  }

  /// Triangles that share no vertex.
  void run(const SelfPiece& piece) {
    if (piece.is_listed())
      search_listed(piece.first, piece.last);
    else
      search_nonadjacent(piece.pair, piece.may_share);
  }

  void flush() { triangles_.flush(); }

  void run(std::span<const IndexPair> pairs) {
    result_.counters.box_pairs += std::ssize(pairs);
    for (const IndexPair& pair : pairs) triangles_.add(pair.first, pair.second);
    triangles_.flush();
  }

 private:
  void search_nonadjacent(NodePair start, bool may_share) {
    traversal::visit_meeting<true>(
        input_.nodes, input_.nodes, start, [&](NodePair pair) { return enter(pair); },
        [&](const PrimitivePairs& pairs) {
          take({pairs.first, pairs.second,
                may_share && pairs.bits != 0
                    ? pairs.bits & ~sharing_pairs(input_.leaves[pairs.first], input_.leaves[pairs.second])
                    : pairs.bits});
        });
  }

  /// Listed neighbours one after the other, and all pairs that are met below them.
  void search_listed(Index first, Index last) {
    for (Index place = first; place < last; ++place) {
      const NeighbourPair& listed = input_.neighbours[place];
      if (listed.neighbours == NeighbourPair::kUnlisted)
        search_nonadjacent(listed.pair, true);
      else if (enter(listed.pair))
        compare_listed(listed);
      else
        place = listed.end - 1;
    }
  }

  SELVAGE_INLINE void compare_listed(const NeighbourPair& listed) {
    const NodePair pair = listed.pair;
    const BvhNode &a = input_.nodes[pair.a], &b = input_.nodes[pair.b];
    std::uint64_t nonadjacent = traversal::meeting_children(a, b) & ~listed.neighbours;
    if (pair.a == pair.b) nonadjacent &= traversal::kAboveDiagonal;
    nonadjacent = input_.culled.strayed_among(pair.a, pair.b, nonadjacent);
    if (nonadjacent == 0) return;
    traversal::hand_on_children(
        a, b, pair, nonadjacent, [&](NodePair next) { search_nonadjacent(next, false); },
        [&](const PrimitivePairs& pairs) { take(pairs); });
  }

  SELVAGE_INLINE void take(PrimitivePairs pairs) {
    pairs.bits = input_.culled.strayed_among(pairs.first, pairs.second, pairs.bits);
    result_.counters.box_pairs += count_bits(pairs.bits);
    traversal::visit_each(input_.nodes, input_.nodes, pairs,
                          [&](Index first, Index second) { triangles_.add(first, second); });
  }

  /// Culling: the one place where a pair of nodes is left out although their boxes meet.
  SELVAGE_INLINE bool enter(NodePair pair) {
    if (result_.stop != nullptr && result_.stop->load(std::memory_order_relaxed)) return false;
    if (input_.culled.holds(input_.nodes.data(), pair)) return false;
    ++result_.counters.node_pairs;
    result_.counters.self_node_pairs += pair.a == pair.b;
    return true;
  }

  const ContinuousInput& input_;
  ContinuousResult& result_;
  TriangleBatch triangles_;
};

}  // namespace

void find_continuous_collisions(const ContinuousInput& input, NodePair start, ContinuousResult& result) {
  Search(input, result).run(start);
}

void find_nonadjacent_collisions(const ContinuousInput& input, std::span<const SelfPiece> pieces,
                                 ContinuousResult& result) {
  Search search(input, result);
  for (const SelfPiece& piece : pieces) search.run(piece);
  search.flush();
}

void test_listed_pairs(const ContinuousInput& input, std::span<const IndexPair> pairs, ContinuousResult& result) {
  Search(input, result).run(pairs);
}

void test_listed_features(const ContinuousInput& input, std::span<const FeaturePair> vertex_face,
                          std::span<const FeaturePair> edge_edge, ContinuousResult& result) {
  FeatureBatch<1> vertex_face_batch(input, result);
  for (const FeaturePair& pair : vertex_face) vertex_face_batch.add(pair);
  vertex_face_batch.flush();
  FeatureBatch<2> edge_edge_batch(input, result);
  for (const FeaturePair& pair : edge_edge) edge_edge_batch.add(pair);
  edge_edge_batch.flush();
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
