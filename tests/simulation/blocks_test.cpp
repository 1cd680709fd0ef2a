#include "elasticity/deformation_gradient.h"
#include "simulation/bodies.h"
#include "simulation/xpbd/material_blocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

namespace selvage {
namespace {

using namespace bodies;

/// A box with one element more, as long as all of it: so few slices touch only the next.
IndexedMesh make_strapped_box() {
  IndexedMesh box = make_box({2, 1, 1}, 0.1);
  const Vec3 ends[] = {box.positions.front(), box.positions.back()};
  const auto last = static_cast<Index>(box.positions.size() - 1);
  box.positions.push_back(ends[0] + Vec3(1, 0, -1));
  box.positions.push_back(ends[0] + Vec3(1, 1, -1));
  box.tetrahedra.push_back({0, last, last + 1, last + 2});
  if (element_volume(box.tetrahedra.back(), box.positions) < 0)
    std::swap(box.tetrahedra.back()[0], box.tetrahedra.back()[1]);
  return box;
}

std::vector<Model> models() {
  std::vector<Model> models;
  models.push_back(make(make_box({1, 1, 1}, 0.08), neo_hookean(1e5)));
  models.push_back(make(make_ball(0.5, 0.1), springs()));
  models.push_back(make(make_strapped_box(), neo_hookean(1e5)));
  const IndexedMesh octopus = make_octopus(1, 0.065, 1);
  models.push_back(make(std::vector<IndexedMesh>{octopus, make_box({1, 0.1, 0.1}, 0.1), octopus}, springs()));
  return models;
}

/// The vertices of a constraint; none where a place of a batch is empty.
template <typename Batch>
std::vector<Index> vertices_at(const MaterialBlocks& blocks, const MaterialBlock& block, const Batch& batch, int lane) {
  std::vector<Index> vertices;
  const Index count = block.last_vertex - block.first_vertex;
  for (const auto& offsets : batch.offsets) {
    const Index place = offsets[lane] / kCopyLength;
    EXPECT_EQ(offsets[lane] % kCopyLength, 0);
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

TEST(Blocks, OfOtherSubdomainsOfTheirColourShareNoVertex) {
  for (const Model& model : models()) {
    const MaterialBlocks blocks = make_material_blocks(model);
    EXPECT_EQ(blocks.subdomain_first.back(), std::ssize(blocks.blocks));
    EXPECT_EQ(blocks.colour_first.back() + 1, std::ssize(blocks.subdomain_first));
    for (Index colour = 0; colour < blocks.colour_count(); ++colour) {
      std::map<Index, Index> subdomain_of;
      for (Index subdomain = blocks.colour_first[colour]; subdomain < blocks.colour_first[colour + 1]; ++subdomain)
        for (Index b = blocks.subdomain_first[subdomain]; b < blocks.subdomain_first[subdomain + 1]; ++b)
          for (Index i = blocks.blocks[b].first_vertex; i < blocks.blocks[b].last_vertex; ++i)
            ASSERT_EQ(subdomain_of.emplace(blocks.vertices[i], subdomain).first->second, subdomain);
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

// Two in a hundred are a regression mark.
TEST(Blocks, HaveAtMostTwoInAHundredBatchesMoreThanTheyNeed) {
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

TEST(Blocks, HaveColoursOfEqualNumbersOfParts) {
  IndexedMesh bent = make_box({1, 1, 1}, 0.04);
  for (Vec3& p : bent.positions) p[1] += p[0] * p[0];
  for (const IndexedMesh& mesh :
       {make_box({1, 1, 1}, 0.08), bent, make_box({3, 0.1, 0.1}, 0.02), make_octopus(1, 0.05, 1)}) {
    const MaterialBlocks blocks = make_material_blocks(make(mesh, neo_hookean(1e5)));
    const Index per_colour = blocks.colour_first[1];
    EXPECT_EQ(per_colour % 2, 0);
    EXPECT_TRUE(blocks.colour_count() == 2 || blocks.colour_count() == 4);
    const auto blocks_of = [&](Index colour) {
      return blocks.subdomain_first[blocks.colour_first[colour + 1]] -
             blocks.subdomain_first[blocks.colour_first[colour]];
    };
    for (Index colour = 0; colour < blocks.colour_count(); ++colour) {
      EXPECT_EQ(blocks.colour_first[colour + 1] - blocks.colour_first[colour], per_colour);
      EXPECT_NEAR(blocks_of(colour), blocks_of(0), per_colour);
    }
  }
}

TEST(Blocks, OfASmallBodyAreASingleOne) {
  const MaterialBlocks blocks = make_material_blocks(make(make_box({1, 1, 1}, 0.25), neo_hookean(1e5)));
  EXPECT_EQ(blocks.blocks.size(), 1);
  EXPECT_EQ(blocks.subdomain_first.size(), 2);
}

TEST(ElementRanges, KnowWhichSliceAPlaceIsIn) {
  for (const Index size : {1, 7, 64, 1000})
    for (const Index count : {1, 2, 3, 7}) {
      Index end = 5;
      for (Index slice = 0; slice < count; ++slice) {
        const ElementRange run = ElementRange{5, 5 + size}.slice(slice, count);
        EXPECT_EQ(run.first, end);
        for (Index i = run.first; i < run.last; ++i)
          EXPECT_EQ((ElementRange{5, 5 + size}.slice_of(i - 5, count)), slice);
        end = run.last;
      }
      EXPECT_EQ(end, 5 + size);
    }
}

}  // namespace
}  // namespace selvage
