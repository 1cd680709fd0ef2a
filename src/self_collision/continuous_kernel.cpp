#include "self_collision/continuous_kernel.h"

#include "self_collision/motion_filter.h"
#include "selvage/bvh/traverse_pairs.h"

namespace selvage {
inline namespace SELVAGE_ISA {

namespace {

/// Pairs whose boxes meet, waiting to be looked at eight at once; what single precision cannot tell apart is decided
/// exactly. A pair of a vertex and a face (kCount = 1), or of two edges (kCount = 2).
template <int kCount>
class MotionBatch {
 public:
  MotionBatch(const ContinuousScene& scene, ContinuousResult& result) : scene_(scene), result_(result) {}

  SELVAGE_INLINE void add(Index first, Index second) {
    first_[count_] = first;
    second_[count_] = second;
    if (++count_ == kSize) flush();
  }

  void flush() {
    if (count_ == 0) return;
    Index vertices[4][kSize];
    for (int i = 0; i < kSize; ++i) {
      const int k = i < count_ ? i : 0;
      if constexpr (kCount == 1) {
        vertices[0][i] = first_[k];
        for (int corner = 0; corner < 3; ++corner)
          vertices[1 + corner][i] = scene_.triangles[second_[k]].vertices[corner];
      } else {
        for (int end = 0; end < 2; ++end) {
          vertices[end][i] = scene_.edges[first_[k]][end];
          vertices[2 + end][i] = scene_.edges[second_[k]][end];
        }
      }
    }
    const unsigned apart = MotionFilter<kCount>(scene_.rounded_t0, scene_.rounded_t1, vertices).apart();
    for (unsigned rest = ~apart & ((1u << count_) - 1); rest != 0; rest &= rest - 1) {
      const int i = lowest_lane(rest);
      if constexpr (kCount == 1)
        decide_vertex_face(scene_, first_[i], second_[i], result_);
      else
        decide_edge_edge(scene_, first_[i], second_[i], result_);
    }
    count_ = 0;
  }

 private:
  static constexpr int kSize = 8;
  const ContinuousScene& scene_;
  ContinuousResult& result_;
  Index first_[kSize];
  Index second_[kSize];
  int count_ = 0;
};

/// A box over the step in registers.
struct StepBox {
  Float4 lower, upper;

  SELVAGE_INLINE explicit StepBox(const SweptBox& box)
      : lower(Float4::load(box.lower)), upper(Float4::load(box.upper)) {}
  SELVAGE_INLINE StepBox(const SweptBox& a, const SweptBox& b)
      : lower(min(Float4::load(a.lower), Float4::load(b.lower))),
        upper(max(Float4::load(a.upper), Float4::load(b.upper))) {}

  SELVAGE_INLINE bool meets(const StepBox& other) const {
    return (less_equal(lower, other.upper) & less_equal(other.lower, upper)) == 0xf;
  }
};

/// One piece of a search: the hierarchy decides which triangles are looked at.
class Search {
 public:
  Search(const ContinuousScene& scene, ContinuousResult& result)
      : scene_(scene), result_(result), vertex_face_(scene, result), edge_edge_(scene, result) {}

  void run(NodePair start) {
    traversal::visit_rows<true>(
        scene_.nodes, scene_.nodes, start, [&](NodePair pair) { return enter(pair); },
        [&](const PrimitiveRow& row) {
          const BvhNode& node = scene_.nodes[row.node];
          for (unsigned rest = row.lanes; rest != 0; rest &= rest - 1)
            take_pair(row.primitive, node.children[lowest_lane(rest)]);
        });
    finish();
  }

  /// A pair of triangles whose boxes meet: of what they own, each with what the other has.
  void take_pair(Index first, Index second) {
    ++result_.counters.box_pairs;
    const MovingTriangle &a = scene_.triangles[first], &b = scene_.triangles[second];
    if ((a.owned_vertices | a.owned_edges) == 0 && (b.owned_vertices | b.owned_edges) == 0) return;
    take_vertices(a, b, second);
    take_vertices(b, a, first);
    take_edges(a, b);
  }

  void finish() {
    vertex_face_.flush();
    edge_edge_.flush();
  }

 private:
  SELVAGE_INLINE bool enter(NodePair) {
    if (result_.stop != nullptr && result_.stop->load(std::memory_order_relaxed)) return false;
    ++result_.counters.node_pairs;
    return true;
  }

  SELVAGE_INLINE void take_vertices(const MovingTriangle& owner, const MovingTriangle& face, Index face_number) {
    if (owner.owned_vertices == 0) return;
    const StepBox box(scene_.triangle_boxes[face_number]);
    for (unsigned rest = owner.owned_vertices; rest != 0; rest &= rest - 1) {
      const Index v = owner.vertices[lowest_lane(rest)];
      if (v == face.vertices[0] || v == face.vertices[1] || v == face.vertices[2]) continue;
      if (!box.meets(StepBox(scene_.vertex_boxes[v]))) continue;
      ++result_.counters.vertex_face_boxes;
      vertex_face_.add(v, face_number);
    }
  }

  SELVAGE_INLINE StepBox edge_box(const VertexTuple<2>& edge) const {
    return StepBox(scene_.vertex_boxes[edge[0]], scene_.vertex_boxes[edge[1]]);
  }

  SELVAGE_INLINE void take_edges(const MovingTriangle& a, const MovingTriangle& b) {
    if (a.owned_edges == 0) return;
    for (unsigned others = b.owned_edges; others != 0; others &= others - 1) {
      const Index e = b.edges[lowest_lane(others)];
      const VertexTuple<2>& edge = scene_.edges[e];
      const StepBox box = edge_box(edge);
      for (unsigned rest = a.owned_edges; rest != 0; rest &= rest - 1) {
        const Index f = a.edges[lowest_lane(rest)];
        const VertexTuple<2>& other = scene_.edges[f];
        if (edge[0] == other[0] || edge[0] == other[1] || edge[1] == other[0] || edge[1] == other[1]) continue;
        if (!box.meets(edge_box(other))) continue;
        ++result_.counters.edge_edge_boxes;
        e < f ? edge_edge_.add(e, f) : edge_edge_.add(f, e);
      }
    }
  }

  const ContinuousScene& scene_;
  ContinuousResult& result_;
  MotionBatch<1> vertex_face_;
  MotionBatch<2> edge_edge_;
};

}  // namespace

void find_continuous_collisions(const ContinuousScene& scene, NodePair start, ContinuousResult& result) {
  Search(scene, result).run(start);
}

void test_listed_pairs(const ContinuousScene& scene, std::span<const IndexPair> pairs, ContinuousResult& result) {
  Search search(scene, result);
  for (const IndexPair& pair : pairs) search.take_pair(pair.first, pair.second);
  search.finish();
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
