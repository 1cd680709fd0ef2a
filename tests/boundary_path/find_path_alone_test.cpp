// The packets against the algorithm as it is printed, query by query and bit for bit, for every instruction set.
#include "boundary_path/search/find_path_alone.h"

#include "boundary_path/compare.h"
#include "boundary_path/injectivity/deformed_mesh.h"
#include "boundary_path/location/group_order.h"
#include "boundary_path/packets/path_kernel.h"
#include "core/isa.h"
#include "selvage/core/error.h"
#include "selvage/shapes/poses.h"
#include "selvage/shapes/shapes.h"
#include "test_scale.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

namespace selvage {
namespace {

template <int D>
using PathKernel = void (*)(const PathInput<D>&, PathBatches<D>&);

template <int D>
struct PathKernels {
  Isa isa;
  PathKernel<D> packets, alone;
};

// Of those that this machine runs.
template <int D>
std::vector<PathKernels<D>> path_kernels() {
  std::vector<PathKernels<D>> all = {{Isa::baseline, &baseline::search_paths, &baseline::search_paths_alone},
                                     {Isa::avx2, &avx2::search_paths, &avx2::search_paths_alone},
                                     {Isa::avx512, &avx512::search_paths, &avx512::search_paths_alone}};
  std::erase_if(all, [](const PathKernels<D>& k) { return k.isa > active_isa(); });
  return all;
}

// Tasks in batches of several packets, the last of which is not full.
template <int D>
class Batches final : public PathBatches<D> {
 public:
  Batches(std::span<const PathTask<D>> tasks, PathResult<D>* results) : tasks_(tasks), results_(results) {}
  PathBatch<D> next() override {
    constexpr std::size_t kBatch = 3 * kPacketSize;
    const PathBatch<D> batch{tasks_.subspan(0, std::min(kBatch, tasks_.size())), results_, nullptr};
    tasks_ = tasks_.subspan(batch.tasks.size());
    results_ += batch.tasks.size();
    return batch;
  }

 private:
  std::span<const PathTask<D>> tasks_;
  PathResult<D>* results_;
};

template <int D>
std::vector<PathResult<D>> run(PathKernel<D> kernel, const PathInput<D>& input, std::span<const PathTask<D>> tasks) {
  std::vector<PathResult<D>> results(tasks.size());
  Batches<D> batches(tasks, results.data());
  kernel(input, batches);
  return results;
}

template <int D>
bool equal_bits(const PathResult<D>& a, const PathResult<D>& b) {
  const auto same = [](const auto& x, const auto& y) {
    for (int i = 0; i < D; ++i)
      if (std::bit_cast<std::uint64_t>(x[i]) != std::bit_cast<std::uint64_t>(y[i])) return false;
    return true;
  };
  if (a.status != b.status) return false;
  return a.status != PathStatus::kFound ||
         (a.face == b.face && a.target_count == b.target_count && a.target_vertices == b.target_vertices &&
          same(a.offset, b.offset) && same(a.barycentric, b.barycentric) && a.has_normal == b.has_normal &&
          (!a.has_normal || same(a.normal, b.normal)));
}

// What the tests of one dimension have found, against tests that compare nothing.
struct Tally {
  std::int64_t compared = 0, found = 0;
};

template <int D>
void expect_equal(const PathInput<D>& input, std::span<const PathTask<D>> tasks, const std::string& name,
                  Tally& tally) {
  std::vector<PathResult<D>> first;
  for (const auto& [isa, packets, alone] : path_kernels<D>()) {
    const auto right = run<D>(alone, input, tasks), got = run<D>(packets, input, tasks);
    if (first.empty()) first = right;
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      const PathQuery<D>& q = tasks[i].query;
      ASSERT_TRUE(equal_bits(got[i], right[i]))
          << name << ", " << isa_name(isa) << ", query " << i << ": element " << q.element << ", point "
          << q.point.transpose() << ", source " << q.source[0] << " " << q.source[1] << ": face " << got[i].face
          << " at " << got[i].offset.norm() << " instead of " << right[i].face << " at " << right[i].offset.norm();
      ASSERT_TRUE(equal_bits(first[i], right[i])) << name << ", " << isa_name(isa) << ", query " << i;
      ++tally.compared;
      tally.found += right[i].status == PathStatus::kFound;
    }
  }
}

// A mesh in its positions, and all that a search reads of it.
template <int D>
class SearchedMesh {
 public:
  SearchedMesh(const std::vector<Vec<D>>& positions, const std::vector<VertexTuple<D + 1>>& elements)
      : mesh_(static_cast<Index>(positions.size()), elements), topology_(mesh_), deformed_(mesh_, topology_) {
    deformed_.rebuild(positions);
  }

  const SimplexMesh<D>& mesh() const { return mesh_; }
  PathInput<D> input(PathOptions options = {}) const { return deformed_.path_input(options); }
  PathTask<D> task(PathQuery<D> query, Index warm_start = kNone) const {
    for (double& x : query.point) x = std::ldexp(x, -deformed_.exponent());
    return {query, warm_start};
  }

 private:
  SimplexMesh<D> mesh_;
  PathTopology<D> topology_;
  DeformedMesh<D> deformed_;
};

// Every kind of query, first as they come, then each from a face taken at random, then without hints and culling.
template <int D>
void compare(const SearchedMesh<D>& material, std::span<const PathQuery<D>> queries, const std::string& name,
             Tally& tally) {
  test::Random random(11);
  std::vector<PathTask<D>> tasks, warm;
  for (const PathQuery<D>& query : queries) {
    tasks.push_back(material.task(query));
    warm.push_back(material.task(query, random.below(material.mesh().boundary_face_count())));
  }
  expect_equal<D>(material.input(), tasks, name, tally);
  expect_equal<D>(material.input(), warm, name + ", warm", tally);
  expect_equal<D>(material.input({.cull_infeasible_regions = false, .use_hints = false}), tasks, name + ", plain",
                  tally);
}

template <int D>
void compare_family(std::size_t number) {
  const families::Subject<D> subject(families::all_families<D>()[number]);
  const SearchedMesh<D> material(subject.judge.positions(), subject.family.mesh.elements);
  const auto queries = families::to_library<D>(subject.maker.make_many(test::scaled(150) + 20, test::seed(number)));
  Tally tally;
  compare<D>(material, queries, subject.family.name, tally);
  const auto& signs = subject.judge.orientations();
  if (std::count(signs.begin(), signs.end(), 1) > 0) {
    EXPECT_GT(tally.found, tally.compared / 20);
  }
}

// Boundary vertices in the elements that they penetrate: vertex-element DCD.
void compare_penetrating(const std::vector<Vec3>& positions, const std::vector<VertexTuple<4>>& elements,
                         const std::string& name, Tally& tally) {
  const SearchedMesh<3> material(positions, elements);
  const BoundaryPathFinder<3> finder(material.mesh(), positions);
  const std::vector<PathQuery<3>> queries = finder.find_penetrating_vertices();
  compare<3>(material, queries, name, tally);
}

class PlanarPackets : public testing::TestWithParam<std::size_t> {};
class SolidPackets : public testing::TestWithParam<std::size_t> {};
class TangledPackets : public testing::TestWithParam<std::size_t> {};

TEST_P(PlanarPackets, FindThePathsThatTheAlgorithmFindsAlone) {
  compare_family<2>(GetParam());
}
TEST_P(SolidPackets, FindThePathsThatTheAlgorithmFindsAlone) {
  compare_family<3>(GetParam());
}

TEST_P(TangledPackets, FindThePathsOfPenetratingVerticesThatTheAlgorithmFindsAlone) {
  const TangledExample& example = tangled_examples()[GetParam()];
  IndexedMesh mesh;
  for (std::int64_t elements = 3000; mesh.positions.empty(); elements *= 3) {
    try {
      ShapeOptions options;
      options.elements = elements;
      if (example.shape == "squishy-ball") options.tentacles = 4;
      mesh = make_shape(example.shape, options);
      apply_pose(mesh, example.pose);
    } catch (const Error&) {
      mesh = {};
      if (elements > 50000) throw;
    }
  }
  if (mesh.tetrahedra.empty()) GTEST_SKIP() << "a surface";
  Tally tally;
  compare_penetrating(mesh.positions, mesh.tetrahedra, std::string(example.shape), tally);
}

// Hundreds of candidates are nearer than the answer, and blocked.
TEST(PathsNearManyInvertedElements, AreThoseThatTheAlgorithmFindsAlone) {
  IndexedMesh ball = make_ball(1, 0.16);
  for (Vec3& x : ball.positions)
    if (x.norm() < 0.5) x = -x;
  const SearchedMesh<3> material(ball.positions, ball.tetrahedra);
  std::vector<PathQuery<3>> queries;
  for (Index e = 0; e < material.mesh().element_count(); e += 61) {
    Vec3 middle = Vec3::Zero();
    for (const Index v : ball.tetrahedra[e]) middle += 0.25 * ball.positions[v];
    queries.push_back({middle, e});
  }
  Tally tally;
  compare<3>(material, queries, "turned core", tally);
  EXPECT_GT(tally.found, tally.compared / 2);
}

INSTANTIATE_TEST_SUITE_P(Families, PlanarPackets, testing::Range<std::size_t>(0, families::planar_families().size()),
                         families::family_name<2>);
INSTANTIATE_TEST_SUITE_P(Families, SolidPackets, testing::Range<std::size_t>(0, families::solid_families().size()),
                         families::family_name<3>);
INSTANTIATE_TEST_SUITE_P(Examples, TangledPackets, testing::Range<std::size_t>(0, tangled_examples().size()));

}  // namespace
}  // namespace selvage
