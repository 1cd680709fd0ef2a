#include "selvage/mesh/shapes.h"
#include "selvage/simulation/xpbd.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

Model make_beam(const Material& material) {
  const MeshFile box = make_box({1, 0.5, 0.5}, 0.1);
  const auto vertices = static_cast<Index>(box.positions.size());
  const auto elements = static_cast<Index>(box.tetrahedra.size());
  return make_model(TetMesh(vertices, box.tetrahedra), box.positions, {{"beam", 0, vertices, 0, elements, material}});
}

TEST(FreeBody, FallsWithoutDeforming) {
  for (const MaterialKind kind : {MaterialKind::kNeoHookean, MaterialKind::kMassSpring}) {
    Material material;
    material.kind = kind;
    const Model model = make_beam(material);
    State state = make_state(model, model.rest_positions);
    XpbdOptions options;
    XpbdSolver solver(model, state, {}, {}, options);
    const int steps = 300;
    for (int i = 0; i < steps; ++i) solver.step(state);
    // Symplectic Euler: the fall of n steps is g h^2 n (n + 1) / 2.
    const Vec3 fall = options.gravity * (options.time_step * options.time_step * steps * (steps + 1) / 2);
    for (Index v = 0; v < model.mesh.vertex_count(); ++v)
      ASSERT_LT((state.positions[v] - model.rest_positions[v] - fall).norm(), 1e-9) << v;
  }
}

}  // namespace
}  // namespace selvage
