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

/// Calls `visit(lane)` for the places of a batch that hold a constraint.
template <typename Batch, typename Visit>
void for_each_lane(const Model& model, const Batch& batch, Visit&& visit) {
  for (int lane = 0; lane < kBatch; ++lane)
    if (batch.vertices[0][lane] < model.mesh.vertex_count()) visit(lane);
}

TEST(Blocks, HoldEveryElementAndEdgeOnce) {
  for (const Model& model : models()) {
    const MaterialBlocks blocks = make_material_blocks(model);
    std::map<VertexTuple<4>, int> elements;
    for (const ElementBatch& batch : blocks.elements)
      for_each_lane(model, batch, [&](int lane) {
        ++elements[{batch.vertices[0][lane], batch.vertices[1][lane], batch.vertices[2][lane],
                    batch.vertices[3][lane]}];
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
    for (const EdgeBatch& batch : blocks.edges)
      for_each_lane(model, batch, [&](int lane) {
        edges.push_back({batch.vertices[0][lane], batch.vertices[1][lane]});
        const double length = (model.rest_positions[edges.back()[0]] - model.rest_positions[edges.back()[1]]).norm();
        ASSERT_EQ(batch.length[lane], length);
      });
    std::sort(edges.begin(), edges.end());
    const bool springs = model.bodies[0].material.kind == MaterialKind::kMassSpring;
    EXPECT_EQ(edges, springs ? std::vector(expected_edges.begin(), expected_edges.end()) : decltype(edges)());
    EXPECT_EQ(blocks.constraint_count,
              springs ? std::ssize(expected_edges) + model.mesh.element_count() : 2 * model.mesh.element_count());
  }
}

/// Vertices of a block, stand-ins too.
std::set<Index> vertices_of(const MaterialBlocks& blocks, const MaterialBlock& block) {
  std::set<Index> vertices;
  for (Index n = block.first_element_batch; n < block.last_element_batch; ++n)
    for (const auto& lanes : blocks.elements[n].vertices) vertices.insert(lanes, lanes + kBatch);
  for (Index n = block.first_edge_batch; n < block.last_edge_batch; ++n)
    for (const auto& lanes : blocks.edges[n].vertices) vertices.insert(lanes, lanes + kBatch);
  return vertices;
}

TEST(Blocks, OfOneColourShareNoVertex) {
  for (const Model& model : models()) {
    const MaterialBlocks blocks = make_material_blocks(model);
    EXPECT_EQ(blocks.colour_first.back(), std::ssize(blocks.blocks));
    for (Index colour = 0; colour < blocks.colour_count(); ++colour) {
      std::set<Index> of_colour;
      for (Index b = blocks.colour_first[colour]; b < blocks.colour_first[colour + 1]; ++b)
        for (const Index v : vertices_of(blocks, blocks.blocks[b])) ASSERT_TRUE(of_colour.insert(v).second) << v;
    }
  }
}

TEST(Blocks, HaveBatchesWithoutACommonVertex) {
  for (const Model& model : models()) {
    const MaterialBlocks blocks = make_material_blocks(model);
    std::int64_t filled = 0;
    for (const ElementBatch& batch : blocks.elements) {
      std::set<Index> vertices;
      for_each_lane(model, batch, [&](int lane) {
        ++filled;
        for (const auto& corner : batch.vertices) ASSERT_TRUE(vertices.insert(corner[lane]).second);
      });
    }
    EXPECT_GT(filled, 0.8 * kBatch * static_cast<double>(blocks.elements.size()));
    for (const EdgeBatch& batch : blocks.edges) {
      std::set<Index> vertices;
      for_each_lane(model, batch, [&](int lane) {
        for (const auto& end : batch.vertices) ASSERT_TRUE(vertices.insert(end[lane]).second);
      });
    }
  }
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
