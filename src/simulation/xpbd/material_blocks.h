#pragma once

#include "selvage/simulation/model.h"
#include "simulation/step_vertex.h"

namespace selvage {

/// Numbers in the copy of a vertex in a block: a StepVertex, and the same at the start of the step.
inline constexpr int kCopyLength = 8;

/// Number of constraints of one kind that are solved together, whatever the width of registers; no two of a batch share
/// a vertex. Twice the widest register: each element is a long chain of operations, and while one waits another
/// proceeds.
inline constexpr int kBatch = 16;

/// Elements. A place without one holds an element of vertices that never move.
struct alignas(64) ElementBatch {
  std::uint16_t offsets[4][kBatch];  ///< of the block's vertices, see MaterialBlock
  double gram[6][kBatch];            ///< B B^T by 00 11 22 01 02 12, with B the inverse of the rest edges (columns)
  double inverse_volume[kBatch];     ///< 1 / (6 rest volume)
  double multipliers[2][kBatch];     ///< deviatoric, hydrostatic
};

/// Springs.
struct alignas(64) EdgeBatch {
  std::uint16_t offsets[2][kBatch];
  double length[kBatch];
  double multiplier[kBatch];
};

/// Elements of one body that lie near one another, solved batch by batch by one thread.
///
/// While a block is solved, copies of its vertices lie one after the other, followed by four for places without an
/// element. A batch holds the offset of each copy's first number; each copy has kCopyLength numbers.
struct MaterialBlock {
  Index body;
  Index first_vertex, last_vertex;  ///< into `vertices`
  Index first_element_batch, last_element_batch;
  Index first_edge_batch, last_edge_batch;
};

/// All constraints of a model's material, in the order in which Gauss-Seidel solves them: colour by colour,
/// subdomain by subdomain, block by block, batch by batch. Subdomains of one colour share no vertex, so that threads
/// can solve them at the same time.
///
/// Why subdomains: a plain colouring of the elements has forty colours, and each would stream through all vertices. A
/// colouring of blocks has ten colours, each with two blocks of a small body. Subdomains need two or four colours,
/// so that threads have enough work before they wait for one another.
struct MaterialBlocks {
  std::vector<Index> vertices;  ///< block by block, ascending in each
  std::vector<ElementBatch> elements;
  std::vector<EdgeBatch> edges;
  std::vector<MaterialBlock> blocks;   ///< subdomain by subdomain
  std::vector<Index> subdomain_first;  ///< (n_subdomains + 1) into `blocks`; by colour
  std::vector<Index> colour_first;     ///< (n_colours + 1) into `subdomain_first`
  std::int64_t constraint_count = 0;   ///< two a Neo-Hookean element, one a mass-spring element, one a spring

  Index colour_count() const { return static_cast<Index>(colour_first.size()) - 1; }
};

/// Deterministic.
MaterialBlocks make_material_blocks(const Model& model);

/// Mean number of elements of a block. Fewer would not fill their batches: an inner vertex has 24 elements, each in
/// another batch.
inline constexpr Index kBlockElements = 512;
/// Largest number of vertices of a block, those for places without an element included.
inline constexpr std::int64_t kMaxBlockVertices = 4 * (kBlockElements + kBlockElements / 2) + 4;

/// Consecutive elements of an order, or consecutive blocks, by their places.
struct ElementRange {
  Index first, last;

  Index size() const { return last - first; }
  /// One of `count` slices of equal length.
  ElementRange slice(Index number, Index count) const {
    const auto begin = [&](std::int64_t n) { return first + static_cast<Index>(n * size() / count); };
    return {begin(number), begin(number + 1)};
  }
  /// The slice that holds a place, which is counted from the first.
  Index slice_of(std::int64_t place, Index count) const {
    return static_cast<Index>(((place + 1) * count - 1) / size());
  }
};

/// Elements of a body that one thread solves. No two subdomains of one colour share a vertex.
struct Subdomain {
  Index first, last;  ///< in an order of all elements
  Index colour;
};

/// Orders the elements of a body from `ordered[body.first_element]` on and cuts them into subdomains: slabs across its
/// longest side, and where those are few, columns across the second. Each is ordered along a Morton curve. All in the
/// rest pose.
std::vector<Subdomain> cut_body(const Model& model, const Body& body, std::vector<Index>& ordered);

/// Fills batches with tuples of vertices so that no two in a batch share one; kNone marks empty places.
///
/// @param tuples  K vertices each, numbered from 0 to vertex_count
/// @return numbers of tuples, kBatch for each batch
template <std::size_t K>
std::vector<Index> pack_batches(std::span<const std::array<Index, K>> tuples, Index vertex_count);

extern template std::vector<Index> pack_batches<2>(std::span<const std::array<Index, 2>>, Index);
extern template std::vector<Index> pack_batches<4>(std::span<const std::array<Index, 4>>, Index);

}  // namespace selvage
