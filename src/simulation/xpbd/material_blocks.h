#pragma once

#include "selvage/simulation/model.h"
#include "simulation/vertex_row.h"

namespace selvage {

/// Numbers of a vertex in a block: a VertexRow, and the same at the start of the step.
inline constexpr int kRowLength = 8;

/// Constraints of one kind are solved sixteen at a time, whatever the registers hold: no two of a batch share a vertex.
/// Twice as many as the widest register: elements are long chains of operations, and others have to be at hand while
/// they wait.
inline constexpr int kBatch = 16;

/// Elements. Places without one hold one of rows that nothing moves.
struct alignas(64) ElementBatch {
  std::uint16_t rows[4][kBatch];  ///< of the block's vertices, see MaterialBlock
  double gram[6][kBatch];         ///< B B^T by 00 11 22 01 02 12, with B the inverse of the rest edges (columns)
  double inverse_volume[kBatch];  ///< 1 / (6 rest volume)
  double multipliers[2][kBatch];  ///< deviatoric, hydrostatic
};

/// Springs.
struct alignas(64) EdgeBatch {
  std::uint16_t rows[2][kBatch];
  double length[kBatch];
  double multiplier[kBatch];
};

/// Elements of one body that lie near one another, solved one after the other by one thread: batches in ranges.
///
/// While a block is solved its vertices are in rows of their own, one after the other, followed by four that stand in
/// for missing ones. Batches name a row by where it begins, counted in numbers, of which each has kRowLength.
struct MaterialBlock {
  Index body;
  Index first_vertex, last_vertex;  ///< into `vertices`
  Index first_element_batch, last_element_batch;
  Index first_edge_batch, last_edge_batch;
};

/// All constraints of a model's material, in the order in which Gauss-Seidel solves them: colour by colour, part by
/// part, block by block, batch by batch. Parts of one colour share no vertex, so that threads can solve them at the
/// same time.
///
/// A plain colouring of the elements has forty colours, each of which would stream through all vertices, and one of
/// blocks has ten, each of which has two of a small body; parts need two or four: threads have enough to do before they
/// wait for one another.
struct MaterialBlocks {
  std::vector<Index> vertices;  ///< block by block, ascending in each
  std::vector<ElementBatch> elements;
  std::vector<EdgeBatch> edges;
  std::vector<MaterialBlock> blocks;  ///< part by part
  std::vector<Index> part_first;      ///< (n_parts + 1) into `blocks`; parts by colour
  std::vector<Index> colour_first;    ///< (n_colours + 1) into `part_first`
  std::int64_t constraint_count = 0;  ///< two a Neo-Hookean element, one a mass-spring element, one a spring

  Index colour_count() const { return static_cast<Index>(colour_first.size()) - 1; }
};

/// Deterministic.
MaterialBlocks make_material_blocks(const Model& model);

/// Elements of a block, about. Fewer would not fill their batches: an inner vertex has 24 elements, all in different
/// ones.
inline constexpr Index kBlockElements = 512;
/// Rows of a block at most, those that stand in for missing vertices too.
inline constexpr std::int64_t kBlockRows = 4 * (kBlockElements + kBlockElements / 2) + 4;

/// Elements that lie side by side in an order, by their places; or blocks likewise.
struct ElementRange {
  Index first, last;

  Index size() const { return last - first; }
  /// One of so many parts as long as each other.
  ElementRange part(Index number, Index count) const {
    const auto begin = [&](std::int64_t n) { return first + static_cast<Index>(n * size() / count); };
    return {begin(number), begin(number + 1)};
  }
  /// The number of the part that a place, counted from the first, is in.
  Index part_of(std::int64_t place, Index count) const {
    return static_cast<Index>(((place + 1) * count - 1) / size());
  }
};

/// Elements of a body that one thread solves; no two parts of one colour share a vertex.
struct BodyPart {
  Index first, last;  ///< in an order of all elements
  Index colour;
};

/// Orders the elements of a body from `ordered[body.first_element]` on and cuts them into parts: slabs across its
/// longest side, and where those are few, columns across the second. Each is ordered along a Morton curve. All in the
/// rest pose.
std::vector<BodyPart> cut_body(const Model& model, const Body& body, std::vector<Index>& ordered);

/// Fills batches with tuples of vertices so that no two in a batch share one; kNone marks empty places.
///
/// @param tuples  K vertices each, numbered from 0 to vertex_count
/// @return numbers of tuples, kBatch for each batch
template <std::size_t K>
std::vector<Index> pack_batches(std::span<const std::array<Index, K>> tuples, Index vertex_count);

extern template std::vector<Index> pack_batches<2>(std::span<const std::array<Index, 2>>, Index);
extern template std::vector<Index> pack_batches<4>(std::span<const std::array<Index, 4>>, Index);

}  // namespace selvage
