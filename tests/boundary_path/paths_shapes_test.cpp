// The library against the oracle on the shapes and poses that the program makes: the meshes of demos and benchmarks.
#include "boundary_path/compare.h"
#include "selvage/core/error.h"
#include "selvage/shapes/poses.h"
#include "selvage/shapes/shapes.h"
#include "test_scale.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

// Together about 40,000 queries.
constexpr std::int64_t kShapeQueries = 40000;

bool is_positive(const IndexedMesh& file) {
  const oracle::Oracle<3> judge(file.positions, file.tetrahedra);
  return std::count(judge.orientations().begin(), judge.orientations().end(), 1) ==
         static_cast<std::ptrdiff_t>(file.tetrahedra.size());
}

// The example with as few elements as the shape can have and the pose can bend without inverting one.
IndexedMesh coarse_example(const TangledExample& example) {
  for (std::int64_t elements = 1200;; elements *= 2) {
    try {
      ShapeOptions options;
      options.elements = elements;
      if (example.shape == "squishy-ball") options.tentacles = 6;
      IndexedMesh file = make_shape(example.shape, options);
      apply_pose(file, example.pose);
      if (file.tetrahedra.empty() || is_positive(file)) return file;
      if (elements > 50000) throw Error(example.shape, "inverted at any size tried");
    } catch (const Error&) {
      if (elements > 50000) throw;
    }
  }
}

class TangledShapePaths : public testing::TestWithParam<std::size_t> {};

TEST_P(TangledShapePaths, AreThoseOfTheOracle) {
  const auto examples = tangled_examples();
  const auto& example = examples[GetParam()];
  const IndexedMesh file = coarse_example(example);
  if (file.tetrahedra.empty()) GTEST_SKIP() << "a surface";
  const families::Family<3> family{std::string(example.shape) + " " + std::string(example.pose),
                                   {file.positions, file.tetrahedra}};
  const families::Subject<3> subject(family);
  const BoundaryPathFinder<3> finder(subject.mesh, subject.judge.positions());

  const auto right = subject.judge.penetrating_vertices();
  const auto found = finder.find_penetrating_vertices();
  ASSERT_EQ(found.size(), right.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    ASSERT_EQ(found[i].source[0], right[i].vertex);
    ASSERT_EQ(found[i].element, right[i].element);
  }

  const auto count = test::scaled(kShapeQueries / static_cast<std::int64_t>(examples.size()) + 1);
  const auto queries = subject.maker.make_many(count, 500 + GetParam());
  EXPECT_GT(families::expect_right_paths<3>(subject, queries, finder.find_paths(families::to_library<3>(queries))), 0);
}

std::string example_name(const testing::TestParamInfo<std::size_t>& info) {
  std::string name =
      std::string(tangled_examples()[info.param].shape) + "_" + std::string(tangled_examples()[info.param].pose);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Examples, TangledShapePaths, testing::Range<std::size_t>(0, tangled_examples().size()),
                         example_name);

}  // namespace
}  // namespace selvage
