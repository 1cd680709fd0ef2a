#include "simulation/xpbd/material_blocks.h"

#include "core/parallel.h"

#include <limits>

namespace selvage {

namespace {

/// The elements of a block.
struct Piece {
  Index body, first, last;  ///< `ordered`
};

/// Constraints of one piece: their numbers, kBatch a batch.
struct PackedPiece {
  std::vector<Index> vertices;  ///< ascending
  std::vector<Index> elements;
  std::vector<Index> edges;  ///< numbers of `edge_vertices`
  std::vector<VertexTuple<2>> edge_vertices;

  Index place_of(Index vertex) const {
    return static_cast<Index>(std::lower_bound(vertices.begin(), vertices.end(), vertex) - vertices.begin());
  }
  Index vertex_count() const { return static_cast<Index>(vertices.size()); }
};

/// Where the copy of a vertex begins, by its number.
std::uint16_t offset_at(Index number) {
  return static_cast<std::uint16_t>(kCopyLength * number);
}
static_assert(kCopyLength * kMaxBlockVertices <= std::numeric_limits<std::uint16_t>::max());

class BlockMaker {
 public:
  explicit BlockMaker(const Model& model) : model_(model), ordered_(model.mesh.element_count()) {
    for (Index b = 0; b < std::ssize(model.bodies); ++b)
      for (const Subdomain& subdomain : cut_body(model, model.bodies[b], ordered_)) cut_subdomain(b, subdomain);
    piece_of_.resize(ordered_.size());
    parallel_for(std::ssize(pieces_), 16, [&](std::int64_t p) {
      for (Index i = pieces_[p].first; i < pieces_[p].last; ++i) piece_of_[ordered_[i]] = static_cast<Index>(p);
    });
  }

  MaterialBlocks make() {
    packed_.resize(pieces_.size());
    parallel_for(std::ssize(pieces_), 4, [&](std::int64_t p) { packed_[p] = pack(static_cast<Index>(p)); });
    lay_out();
    parallel_for(std::ssize(order_), 4, [&](std::int64_t block) { fill(static_cast<Index>(block)); });
    return std::move(result_);
  }

 private:
  void cut_subdomain(Index body, const Subdomain& subdomain) {
    const ElementRange run = {subdomain.first, subdomain.last};
    const Index count = std::max((run.size() + kBlockElements / 2) / kBlockElements, 1);
    const auto before = static_cast<Index>(pieces_.size());
    for (Index i = 0; i < count; ++i) pieces_.push_back({body, run.slice(i, count).first, run.slice(i, count).last});
    if (subdomain.colour >= std::ssize(subdomains_)) subdomains_.resize(subdomain.colour + 1);
    subdomains_[subdomain.colour].push_back({before, static_cast<Index>(pieces_.size())});
  }

  const VertexTuple<4>& element(Index place) const { return model_.mesh.elements()[ordered_[place]]; }

  /// Ascending.
  std::vector<Index> list_vertices(const Piece& piece) const {
    std::vector<Index> vertices;
    for (Index i = piece.first; i < piece.last; ++i)
      vertices.insert(vertices.end(), element(i).begin(), element(i).end());
    return sorted(std::move(vertices));
  }

  template <typename Item>
  static std::vector<Item> sorted(std::vector<Item> items) {
    std::sort(items.begin(), items.end());
    items.erase(std::unique(items.begin(), items.end()), items.end());
    return items;
  }

  PackedPiece pack(Index own) const {
    const Piece& piece = pieces_[own];
    PackedPiece packed;
    packed.vertices = list_vertices(piece);
    std::vector<VertexTuple<4>> tuples;
    for (Index i = piece.first; i < piece.last; ++i) {
      const auto& [a, b, c, d] = element(i);
      tuples.push_back({packed.place_of(a), packed.place_of(b), packed.place_of(c), packed.place_of(d)});
    }
    packed.elements = pack_batches<4>(tuples, packed.vertex_count());
    for (Index& number : packed.elements)
      if (number != kNone) number = ordered_[piece.first + number];
    if (model_.bodies[piece.body].material.kind != MaterialKind::kMassSpring) return packed;
    packed.edge_vertices = list_edges(own);
    std::vector<VertexTuple<2>> edges;
    for (const auto& [a, b] : packed.edge_vertices) edges.push_back({packed.place_of(a), packed.place_of(b)});
    packed.edges = pack_batches<2>(edges, packed.vertex_count());
    return packed;
  }

  /// Edges of the piece that are of no piece before.
  std::vector<VertexTuple<2>> list_edges(Index own) const {
    std::vector<VertexTuple<2>> edges;
    for (Index i = pieces_[own].first; i < pieces_[own].last; ++i)
      for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b)
          if (element(i)[a] < element(i)[b]) edges.push_back({element(i)[a], element(i)[b]});
    edges = sorted(std::move(edges));
    std::erase_if(edges, [&](const VertexTuple<2>& edge) {
      for (const Index e : model_.mesh.vertex_elements(edge[0])) {
        const auto& other = model_.mesh.elements()[e];
        if (piece_of_[e] < own && std::find(other.begin(), other.end(), edge[1]) != other.end()) return true;
      }
      return false;
    });
    return edges;
  }

  /// Decides where each block's batches go.
  void lay_out() {
    for (const std::vector<ElementRange>& colour : subdomains_) {
      result_.colour_first.push_back(static_cast<Index>(result_.subdomain_first.size()));
      for (const ElementRange& subdomain : colour) {
        result_.subdomain_first.push_back(static_cast<Index>(order_.size()));
        for (Index piece = subdomain.first; piece < subdomain.last; ++piece) order_.push_back(piece);
      }
    }
    result_.colour_first.push_back(static_cast<Index>(result_.subdomain_first.size()));
    result_.subdomain_first.push_back(static_cast<Index>(order_.size()));
    Index vertices = 0, elements = 0, edges = 0;
    for (const Index piece : order_) {
      const PackedPiece& packed = packed_[piece];
      const auto element_batches = static_cast<Index>(packed.elements.size() / kBatch);
      const auto edge_batches = static_cast<Index>(packed.edges.size() / kBatch);
      result_.blocks.push_back({.body = pieces_[piece].body,
                                .first_vertex = vertices,
                                .last_vertex = vertices + packed.vertex_count(),
                                .first_element_batch = elements,
                                .last_element_batch = elements + element_batches,
                                .first_edge_batch = edges,
                                .last_edge_batch = edges + edge_batches});
      vertices += packed.vertex_count();
      elements += element_batches;
      edges += edge_batches;
      const bool springs = model_.bodies[pieces_[piece].body].material.kind == MaterialKind::kMassSpring;
      result_.constraint_count += std::int64_t{springs ? 1 : 2} * (pieces_[piece].last - pieces_[piece].first) +
                                  std::ssize(packed.edge_vertices);
    }
    result_.vertices.resize(vertices);
    result_.elements.resize(elements);
    result_.edges.resize(edges);
  }

  void fill(Index block) {
    const MaterialBlock& place = result_.blocks[block];
    const PackedPiece& packed = packed_[order_[block]];
    std::copy(packed.vertices.begin(), packed.vertices.end(), result_.vertices.begin() + place.first_vertex);
    for (std::size_t i = 0; i < packed.elements.size(); ++i)
      fill_element(result_.elements[place.first_element_batch + i / kBatch], static_cast<int>(i % kBatch),
                   packed.elements[i], packed);
    for (std::size_t i = 0; i < packed.edges.size(); ++i)
      fill_edge(result_.edges[place.first_edge_batch + i / kBatch], static_cast<int>(i % kBatch), packed.edges[i],
                packed);
  }

  void fill_element(ElementBatch& batch, int lane, Index number, const PackedPiece& packed) const {
    Eigen::Matrix3d edges = Eigen::Matrix3d::Identity();
    for (int k = 0; k < 4; ++k) batch.offsets[k][lane] = offset_at(packed.vertex_count() + k);
    if (number != kNone) {
      const auto& corners = model_.mesh.elements()[number];
      for (int k = 0; k < 4; ++k) batch.offsets[k][lane] = offset_at(packed.place_of(corners[k]));
      for (int k = 0; k < 3; ++k) edges.col(k) = rest(corners[k + 1]) - rest(corners[0]);
    }
    const Eigen::Matrix3d inverse = edges.inverse(), gram = inverse * inverse.transpose();
    const double entries[6] = {gram(0, 0), gram(1, 1), gram(2, 2), gram(0, 1), gram(0, 2), gram(1, 2)};
    for (int i = 0; i < 6; ++i) batch.gram[i][lane] = entries[i];
    batch.inverse_volume[lane] = 1 / edges.determinant();
    batch.multipliers[0][lane] = batch.multipliers[1][lane] = 0;
  }

  void fill_edge(EdgeBatch& batch, int lane, Index number, const PackedPiece& packed) const {
    for (int k = 0; k < 2; ++k) batch.offsets[k][lane] = offset_at(packed.vertex_count() + k);
    batch.length[lane] = 1;
    batch.multiplier[lane] = 0;
    if (number == kNone) return;
    const auto& [a, b] = packed.edge_vertices[number];
    batch.offsets[0][lane] = offset_at(packed.place_of(a));
    batch.offsets[1][lane] = offset_at(packed.place_of(b));
    batch.length[lane] = (rest(b) - rest(a)).norm();
  }

  const Vec3& rest(Index v) const { return model_.rest_positions[v]; }

  const Model& model_;
  std::vector<Index> ordered_;                         ///< elements
  std::vector<Piece> pieces_;                          ///< ranges of them
  std::vector<std::vector<ElementRange>> subdomains_;  ///< by colour: ranges of pieces
  std::vector<Index> piece_of_;                        ///< (n_elements)
  std::vector<PackedPiece> packed_;
  std::vector<Index> order_;  ///< the piece of each block
  MaterialBlocks result_;
};

}  // namespace

MaterialBlocks make_material_blocks(const Model& model) {
  return BlockMaker(model).make();
}

}  // namespace selvage
