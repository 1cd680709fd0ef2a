// Soft bodies in time, with an XpbdSolver. One box hangs from another by a rope, which is a constraint of the user's,
// in wind, which is an external force.
#include <selvage/shapes/shapes.h>
#include <selvage/simulation/xpbd.h>

#include <array>
#include <cstdio>

using namespace selvage;

int main() {
  const IndexedMesh box = make_box({0.2, 0.2, 0.2}, 0.1);
  IndexedMesh lower = box;
  for (Vec3& p : lower.positions) p -= Vec3(0, 0, 0.6);
  const IndexedMesh both = concatenate(std::array{box, lower});
  const auto vertices = static_cast<Index>(box.positions.size());
  const auto elements = static_cast<Index>(box.tetrahedra.size());

  Material rubber;
  rubber.youngs_modulus = 1e5;
  rubber.poisson_ratio = 0.4;
  const Body upper{.name = "upper",
                   .first_vertex = 0,
                   .vertex_count = vertices,
                   .first_element = 0,
                   .element_count = elements,
                   .material = rubber};
  Body hanging = upper;
  hanging.name = "hanging";
  hanging.first_vertex = vertices;
  hanging.first_element = elements;
  const Model model = make_model(TetMesh(2 * vertices, both.tetrahedra), both.positions, {upper, hanging});
  State state = make_state(model, both.positions);

  // The top of the upper box is pinned. The rope joins the middle of its bottom with that of the other's top.
  Handle pins;
  Index from = kNone, to = kNone;
  for (Index v = 0; v < 2 * vertices; ++v) {
    const Vec3& p = both.positions[v];
    if (p[2] > 0.199) pins.vertices.push_back(v);
    if ((p - Vec3(0.1, 0.1, 0)).norm() < 1e-9) from = v;
    if ((p - Vec3(0.1, 0.1, -0.4)).norm() < 1e-9) to = v;
  }

  XpbdOptions options;
  options.iterations = 8;
  options.velocity_damping = 2;
  XpbdSolver solver(model, state, {pins}, {}, options);
  solver.set_constraint([from, to](const StepVertices& moving, int) {
    const Vec3 rope = moving.position(to) - moving.position(from);
    const double excess = rope.norm() - 0.4, mobility = moving.inverse_mass(from) + moving.inverse_mass(to);
    if (excess <= 0) return;  // slack
    moving.position(from) += moving.inverse_mass(from) * excess / mobility * rope.normalized();
    moving.position(to) -= moving.inverse_mass(to) * excess / mobility * rope.normalized();
  });

  // Wind for a second, then none for three: forces are those of one step.
  std::vector<Vec3> wind(both.positions.size(), Vec3::Zero());
  for (Index v = vertices; v < 2 * vertices; ++v) wind[v] = Vec3(0.8, 0, 0) / model.inverse_masses[v];
  for (int step = 0; step < 300; ++step) solver.step(state, wind);
  std::printf("in the wind:    %.2f m aside\n", state.positions[to][0] - 0.1);
  for (int step = 0; step < 900; ++step) solver.step(state);
  std::printf("after the wind: %.2f m aside\n", state.positions[to][0] - 0.1);
  std::printf("rope: %.4f m\n", (state.positions[to] - state.positions[from]).norm());
  std::printf("contacts in the last step: %zu\n", solver.contacts().size());
}

// Prints:
// in the wind:    0.04 m aside
// after the wind: 0.00 m aside
// rope: 0.4000 m
// contacts in the last step: 0
