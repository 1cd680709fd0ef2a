// The fast oracle agrees with the rational one, and the families are what their names say.
#include "boundary_path/families/families.h"
#include "boundary_path/oracle/oracle.h"
#include "boundary_path/queries.h"
#include "core/parallel.h"
#include "test_scale.h"

#include <gtest/gtest.h>

#include <atomic>
#include <map>
#include <mutex>
#include <set>

namespace selvage {
namespace {

template <typename T>
class OracleRandom : public testing::Test {};

using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(OracleRandom, Dimensions);

// Faces times queries for each family: what rational arithmetic can do in a few seconds.
constexpr std::int64_t kFaceBudget = 800;

TYPED_TEST(OracleRandom, DoublesWithMarginsAgreeWithRationals) {
  constexpr int D = TypeParam::value;
  std::atomic<std::int64_t> found = 0, compared = 0;
  for (const auto& family : families::all_families<D>()) {
    const oracle::Oracle<D> oracle(family.mesh.positions, family.mesh.elements);
    const auto faces = static_cast<std::int64_t>(oracle.faces().size());
    const auto queries =
        families::QueryMaker<D>(oracle).make_many(test::scaled(kFaceBudget / faces + 3), test::seed(77));
    std::mutex mutex;
    parallel_for(static_cast<std::int64_t>(queries.size()), 1, [&](std::int64_t i) {
      oracle::Workspace workspace;
      const auto& q = queries[i];
      const auto fast = oracle.shortest_path(q.point, q.element, q.source, workspace);
      const auto slow = oracle.shortest_path_rational(q.point, q.element, q.source);
      compared += 1;
      found += slow.found;
      std::scoped_lock lock(mutex);
      EXPECT_EQ(fast.in_element, slow.in_element) << family.name << " query " << i;
      EXPECT_EQ(fast.found, slow.found) << family.name << " query " << i;
      EXPECT_NEAR(fast.distance, slow.distance, 1e-14 * slow.distance) << family.name << " query " << i;
    });
  }
  EXPECT_GT(compared, test::scaled(160));
  EXPECT_GT(found, compared / 2);
}

TYPED_TEST(OracleRandom, FamiliesAreLegalAndWhatTheirNamesSay) {
  constexpr int D = TypeParam::value;
  std::set<std::string> names;
  for (const auto& family : families::all_families<D>()) {
    EXPECT_TRUE(names.insert(family.name).second) << family.name;
    std::map<VertexTuple<D>, int> sides;
    for (const auto& e : family.mesh.elements) {
      for (int skip = 0; skip <= D; ++skip) {
        VertexTuple<D> face;
        for (int j = 0, k = 0; j <= D; ++j) {
          if (j != skip) face[k++] = e[j];
        }
        std::sort(face.begin(), face.end());
        EXPECT_LE(++sides[face], 2) << family.name;
      }
    }
    const oracle::Oracle<D> oracle(family.mesh.positions, family.mesh.elements);
    bool positive = true;
    for (int sign : oracle.orientations()) positive = positive && sign > 0;
    const bool says_not = family.name.find("inverted") != std::string::npos || family.name.find("flat_") == 0 ||
                          family.name == "mirrored";
    EXPECT_EQ(positive, !says_not) << family.name;
    EXPECT_LE(family.mesh.elements.size(), 2000u) << family.name;
  }
}

}  // namespace
}  // namespace selvage
