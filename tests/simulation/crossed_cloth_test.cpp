// Cloth that starts through other cloth: it gets out, and from then on nothing meets.
#include "selvage/simulation/newton.h"
#include "selvage/simulation/vbd.h"
#include "selvage/simulation/xpbd.h"
#include "simulation/cloth_bodies.h"

namespace selvage {
namespace {

using namespace bodies;

/// A flat sheet, and a strip that stands through it near its border.
Model sheet_and_strip(double depth) {
  IndexedMesh strip = make_cloth(0.4, 0.6, 0.1);
  for (Vec3& p : strip.positions)
    p = Vec3(0.31 + p[0], 0.03 + 0.2 * p[1] + 0.07 * p[0] + (depth - 0.1), 0.45 * p[1] - 0.13);
  return make_sheets({make_cloth(1, 1, 0.1), strip}, cloth(0.004));
}

template <typename Solver, typename Options>
void expect_to_get_out(const Model& model, Options options, int steps) {
  State state = make_state(model, model.rest_positions);
  options.gravity.setZero();
  options.time_step = 1.0 / 240;
  options.contact.guarantee = true;
  const ClothJudge judge(model);
  ASSERT_FALSE(judge.is_free(state));
  Solver solver(model, state, {}, {}, options);
  int freed = -1;  // the first step that starts free
  for (int i = 0; i < (freed < 0 ? steps : freed + 30); ++i) {
    const State before = state;
    solver.step(state);
    const bool was_free = solver.statistics().unguarded_vertices == 0;
    if (was_free && freed < 0) freed = i;
    if (freed < 0) continue;
    ASSERT_TRUE(was_free) << "again at step " << i;
    ASSERT_EQ(judge.pairs(before, state), 0) << i;
  }
  EXPECT_GE(freed, 1);
  EXPECT_TRUE(judge.is_free(state));
}

TEST(CrossedCloth, GetsOutAndIsGuardedThen) {
  const Model model = sheet_and_strip(0.1);
  expect_to_get_out<XpbdSolver>(model, XpbdOptions(), 800);
  expect_to_get_out<VbdSolver>(model, VbdOptions(), 400);
  expect_to_get_out<NewtonSolver>(model, NewtonOptions(), 400);
}

TEST(CrossedCloth, IsGuardedAgainstAllElseMeanwhile) {
  // A third sheet falls on both: nothing of it ever crosses.
  IndexedMesh strip = make_cloth(0.4, 0.6, 0.1);
  for (Vec3& p : strip.positions) p = Vec3(0.31 + p[0], 0.03 + 0.2 * p[1] + 0.07 * p[0], 0.45 * p[1] - 0.13);
  const Model model =
      make_sheets({make_cloth(1, 1, 0.1), strip, moved(make_cloth(1, 1, 0.1), {0.02, 0.01, 0.3})}, cloth(0.004));
  State state = make_state(model, model.rest_positions);
  for (Index v = model.bodies[2].first_vertex; v < model.mesh.vertex_count(); ++v) state.velocities[v] = Vec3(0, 0, -4);
  XpbdOptions options;
  options.gravity.setZero();
  options.time_step = 1.0 / 240;
  options.contact.guarantee = true;
  XpbdSolver solver(model, state, {}, {}, options);
  const TriangleMesh surface = surface_of(model);
  for (int i = 0; i < 60; ++i) {
    solver.step(state);
    for (const TrianglePair& pair : SelfCollisionFinder(surface, state.positions).find_pairs())
      ASSERT_LT(surface.triangles()[pair.second][0], model.bodies[2].first_vertex) << i;
  }
}

}  // namespace
}  // namespace selvage
