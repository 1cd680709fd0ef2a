#include "bodies.h"
#include "simulation/material_blocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

namespace selvage {
namespace {

using namespace bodies;

std::vector<Model> models() {
  std::vector<Model> models;
  models.push_back(make(make_box({1, 1, 1}, 0.08), neo_hookean(1e5)));
  models.push_back(make(make_ball(0.5, 0.1), springs()));
  const MeshFile octopus = make_octopus(1, 0.065, 1);
  models.push_back(make(std::vector<MeshFile>{octopus, make_box({1, 0.1, 0.1}, 0.1), octopus}, springs()));
  return models;
}

/// The vertices of a constraint; none where a place of a batch is empty.
template <typename Batch>
std::vector<Index> vertices_at(const MaterialBlocks& blocks, const MaterialBlock& block, const Batch& batch, int lane) {
  std::vector<Index> vertices;
  const Index count = block.last_vertex - block.first_vertex;
  for (const auto& rows : batch.rows) {
    const Index place = rows[lane] / 4;
    EXPECT_EQ(rows[lane] % 4, 0);
    EXPECT_LT(place, count + 4);
    if (place < count) vertices.push_back(blocks.vertices[block.first_vertex + place]);
  }
  return vertices;
}

/// Calls `visit(block, batch, lane, vertices)` for all constraints of a kind.
template <typename Batches, typename Visit>
void for_each(const MaterialBlocks& blocks, const Batches& batches, Index MaterialBlock::*first,
              Index MaterialBlock::*last, Visit&& visit) {
  for (const MaterialBlock& block : blocks.blocks)
    for (Index n = block.*first; n < block.*last; ++n)
      for (int lane = 0; lane < kBatch; ++lane) {
        const std::vector<Index> vertices = vertices_at(blocks, block, batches[n], lane);
        if (!vertices.empty()) visit(batches[n], lane, vertices);
      }
}

template <typename Visit>
void for_each_element(const MaterialBlocks& blocks, Visit&& visit) {
  for_each(blocks, blocks.elements, &MaterialBlock::first_element_batch, &MaterialBlock::last_element_batch, visit);
}
template <typename Visit>
void for_each_edge(const MaterialBlocks& blocks, Visit&& visit) {
  for_each(blocks, blocks.edges, &MaterialBlock::first_edge_batch, &MaterialBlock::last_edge_batch, visit);
}

TEST(Blocks, HoldEveryElementAndEdgeOnce) {
  for (const Model& model : models()) {
    const MaterialBlocks blocks = make_material_blocks(model);
    std::map<VertexTuple<4>, int> elements;
    for_each_element(blocks, [&](const ElementBatch&, int, const std::vector<Index>& v) {
      ASSERT_EQ(v.size(), 4);
      ++elements[{v[0], v[1], v[2], v[3]}];
    });
    std::set<VertexTuple<2>> expected_edges;
    for (const auto& e : model.mesh.elements()) {
      ASSERT_EQ(elements[e], 1);
      for (const Index a : e)
        for (const Index b : e)
          if (a < b) expected_edges.insert({a, b});
    }
    EXPECT_EQ(std::ssize(elements), model.mesh.element_count());
    std::vector<VertexTuple<2>> edges;
    for_each_edge(blocks, [&](const EdgeBatch& batch, int lane, const std::vector<Index>& v) {
      ASSERT_EQ(v.size(), 2);
      edges.push_back({v[0], v[1]});
      ASSERT_EQ(batch.length[lane], (model.rest_positions[v[0]] - model.rest_positions[v[1]]).norm());
    });
    std::sort(edges.begin(), edges.end());
    const bool springs = model.bodies[0].material.kind == MaterialKind::kMassSpring;
    EXPECT_EQ(edges, springs ? std::vector(expected_edges.begin(), expected_edges.end()) : decltype(edges)());
    EXPECT_EQ(blocks.constraint_count,
              springs ? std::ssize(expected_edges) + model.mesh.element_count() : 2 * model.mesh.element_count());
  }
}

TEST(Blocks, OfOneColourShareNoVertex) {
  for (const Model& model : models()) {
    const MaterialBlocks blocks = make_material_blocks(model);
    EXPECT_EQ(blocks.colour_first.back(), std::ssize(blocks.blocks));
    for (Index colour = 0; colour < blocks.colour_count(); ++colour) {
      std::set<Index> of_colour;
      for (Index b = blocks.colour_first[colour]; b < blocks.colour_first[colour + 1]; ++b)
        for (Index i = blocks.blocks[b].first_vertex; i < blocks.blocks[b].last_vertex; ++i)
          ASSERT_TRUE(of_colour.insert(blocks.vertices[i]).second);
    }
  }
}

TEST(Blocks, HaveBatchesWithoutACommonVertex) {
  for (const Model& model : models()) {
    const MaterialBlocks blocks = make_material_blocks(model);
    std::map<const void*, std::set<Index>> of_batch;
    const auto check = [&](const auto& batch, int, const std::vector<Index>& vertices) {
      for (const Index v : vertices) ASSERT_TRUE(of_batch[&batch].insert(v).second);
    };
    for_each_element(blocks, check);
    for_each_edge(blocks, check);
  }
}

/// Batches that some constraints need at least: the vertex that most of them share needs one for each.
std::int64_t least_batches(const MaterialBlocks& blocks, const MaterialBlock& block) {
  std::map<Index, std::int64_t> loads;
  std::int64_t count = 0, most = 0;
  for (Index n = block.first_element_batch; n < block.last_element_batch; ++n)
    for (int lane = 0; lane < kBatch; ++lane) {
      const std::vector<Index> vertices = vertices_at(blocks, block, blocks.elements[n], lane);
      count += !vertices.empty();
      for (const Index v : vertices) most = std::max(most, ++loads[v]);
    }
  return std::max(most, (count + kBatch - 1) / kBatch);
}

TEST(Blocks, HaveHardlyMoreBatchesThanTheyNeed) {
  for (const Model& model : models()) {
    const MaterialBlocks blocks = make_material_blocks(model);
    std::int64_t least = 0;
    for (const MaterialBlock& block : blocks.blocks) least += least_batches(blocks, block);
    EXPECT_LE(std::ssize(blocks.elements), least + least / 50);
  }
}

TEST(Blocks, PackAStarIntoOneBatchEach) {
  std::vector<std::array<Index, 2>> star;
  for (Index i = 1; i <= 5; ++i) star.push_back({0, i});
  const std::vector<Index> packed = pack_batches<2>(star, 6);
  ASSERT_EQ(std::ssize(packed), 5 * kBatch);
  std::set<Index> seen;
  for (std::size_t i = 0; i < packed.size(); ++i) {
    EXPECT_EQ(packed[i] == kNone, i % kBatch != 0);
    if (packed[i] != kNone) seen.insert(packed[i]);
  }
  EXPECT_EQ(seen.size(), 5);
  EXPECT_TRUE(pack_batches<2>({}, 6).empty());
}

TEST(Blocks, HaveColoursOfLikeSize) {
  const Model model = make(make_box({1, 1, 1}, 0.025), neo_hookean(1e5));
  const MaterialBlocks blocks = make_material_blocks(model);
  const double mean = static_cast<double>(blocks.blocks.size()) / blocks.colour_count();
  EXPECT_LT(blocks.colour_count(), 30);
  for (Index colour = 0; colour < blocks.colour_count(); ++colour) {
    const double size = blocks.colour_first[colour + 1] - blocks.colour_first[colour];
    EXPECT_GT(size, 0.5 * mean);
    EXPECT_LT(size, 1.5 * mean);
  }
}

TEST(Blocks, GiveStarsAndChainsTheirColours) {
  // A star: its middle has one colour, all others share another but for balance; a chain needs two.
  std::vector<std::vector<Index>> star(9), chain(9);
  for (Index i = 1; i < 9; ++i) {
    star[0].push_back(i);
    star[i].push_back(0);
    chain[i - 1].push_back(i);
    chain[i].push_back(i - 1);
  }
  for (const auto& graph : {star, chain}) {
    const std::vector<Index> colours = colour_blocks(graph);
    EXPECT_EQ(*std::max_element(colours.begin(), colours.end()), 1);
    for (std::size_t i = 0; i < graph.size(); ++i)
      for (const Index other : graph[i]) EXPECT_NE(colours[i], colours[other]);
  }
}

}  // namespace
}  // namespace selvage
