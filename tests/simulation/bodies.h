#pragma once

#include "selvage/core/error.h"
#include "selvage/shapes/shapes.h"
#include "selvage/simulation/xpbd.h"

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <random>

namespace selvage::bodies {

/// A model of one body a mesh, all of one material.
inline Model make(std::span<const IndexedMesh> meshes, const Material& material) {
  std::vector<Body> made;
  Index vertices = 0, elements = 0;
  for (const IndexedMesh& mesh : meshes) {
    Body body{"body" + std::to_string(made.size()), vertices, 0, elements, 0, material};
    body.vertex_count = static_cast<Index>(mesh.positions.size());
    body.element_count = static_cast<Index>(mesh.tetrahedra.size());
    vertices += body.vertex_count;
    elements += body.element_count;
    made.push_back(body);
  }
  const IndexedMesh all = concatenate(meshes);
  return make_model(TetMesh(vertices, all.tetrahedra), all.positions, made);
}

inline Model make(const IndexedMesh& mesh, const Material& material) {
  return make(std::span(&mesh, 1), material);
}

inline Material neo_hookean(double youngs_modulus, double poisson_ratio = 0.45) {
  Material material;
  material.youngs_modulus = youngs_modulus;
  material.poisson_ratio = poisson_ratio;
  return material;
}

inline Material springs(double edge_compliance = 0, double volume_compliance = 0) {
  Material material;
  material.kind = MaterialKind::kMassSpring;
  material.edge_compliance = edge_compliance;
  material.volume_compliance = volume_compliance;
  return material;
}

inline Material damped(Material material, double damping) {
  material.damping = damping;
  return material;
}

inline IndexedMesh moved(IndexedMesh mesh, const Vec3& offset) {
  for (Vec3& p : mesh.positions) p += offset;
  return mesh;
}

inline XpbdOptions without_contact() {
  XpbdOptions options;
  options.contact.mode = DetectionMode::kOff;
  return options;
}

inline double mass(const Model& model, Index v) {
  return model.inverse_masses[v] > 0 ? 1 / model.inverse_masses[v] : 0;
}

inline Vec3 momentum(const Model& model, const State& state) {
  Vec3 sum = Vec3::Zero();
  for (Index v = 0; v < model.mesh.vertex_count(); ++v) sum += mass(model, v) * state.velocities[v];
  return sum;
}

inline Vec3 angular_momentum(const Model& model, const State& state) {
  Vec3 sum = Vec3::Zero();
  for (Index v = 0; v < model.mesh.vertex_count(); ++v)
    sum += mass(model, v) * state.positions[v].cross(state.velocities[v]);
  return sum;
}

inline double kinetic_energy(const Model& model, const State& state) {
  double sum = 0;
  for (Index v = 0; v < model.mesh.vertex_count(); ++v) sum += 0.5 * mass(model, v) * state.velocities[v].squaredNorm();
  return sum;
}

inline Vec3 centre(const Model& model, const State& state) {
  Vec3 sum = Vec3::Zero();
  double all = 0;
  for (Index v = 0; v < model.mesh.vertex_count(); ++v) {
    sum += mass(model, v) * state.positions[v];
    all += mass(model, v);
  }
  return sum / all;
}

inline std::int64_t inverted_elements(const Model& model, const State& state) {
  std::int64_t count = 0;
  for (const auto& e : model.mesh.elements()) {
    const auto edge = [&](int k) { return Vec3(state.positions[e[k]] - state.positions[e[0]]); };
    count += edge(1).dot(edge(2).cross(edge(3))) <= 0;
  }
  return count;
}

/// Largest change of an edge's length, relative to rest.
inline double worst_stretch(const Model& model, const State& state) {
  double worst = 0;
  for (const auto& e : model.mesh.elements())
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < a; ++b) {
        const double now = (state.positions[e[a]] - state.positions[e[b]]).norm();
        const double rest = (model.rest_positions[e[a]] - model.rest_positions[e[b]]).norm();
        worst = std::max(worst, std::abs(now / rest - 1));
      }
  return worst;
}

/// Positions moved at random, each coordinate by at most `size`.
inline std::vector<Vec3> jittered(std::span<const Vec3> positions, double size, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> unit(-size, size);
  std::vector<Vec3> moved(positions.begin(), positions.end());
  for (Vec3& p : moved)
    for (int axis = 0; axis < 3; ++axis) p[axis] += unit(engine);
  return moved;
}

/// The vertices that a rule chooses, held where they are.
inline Handle hold(const Model& model, const std::function<bool(const Vec3&)>& where) {
  Handle handle;
  for (Index v = 0; v < model.mesh.vertex_count(); ++v)
    if (where(model.rest_positions[v])) handle.vertices.push_back(v);
  return handle;
}

inline bool same_bits(const State& a, const State& b) {
  const auto same = [](const std::vector<Vec3>& x, const std::vector<Vec3>& y) {
    return x.size() == y.size() && std::memcmp(x.data(), y.data(), sizeof(Vec3) * x.size()) == 0;
  };
  return same(a.positions, b.positions) && same(a.velocities, b.velocities) && a.time == b.time && a.steps == b.steps;
}

/// Three bodies that fall on one another and on a floor.
inline Model pile(const Material& material) {
  const IndexedMesh ball = make_ball(0.1, 0.04);
  return make(
      std::vector<IndexedMesh>{moved(ball, {0, 0, 0.12}), moved(make_box({0.3, 0.3, 0.05}, 0.05), {-0.15, -0.15, 0.24}),
                               moved(ball, {0.02, 0, 0.42})},
      material);
}

/// A body 10,000 times as dense comes down on a light one: nothing is inverted, left inside or thrown.
template <typename Solver, typename Options>
void expect_heavy_to_stand_on_light(Options options, double least_height, double most_energy) {
  const IndexedMesh lower = moved(make_box({0.2, 0.2, 0.1}, 0.05), {0, 0, 0.001});
  const IndexedMesh upper = moved(make_box({0.1, 0.1, 0.05}, 0.05), {0.05, 0.05, 0.102});
  Model model = make(std::vector<IndexedMesh>{lower, upper}, neo_hookean(1e5, 0.4));
  model.bodies[0].material.density = 1;
  model.bodies[1].material.density = 1e4;
  model = make_model(
      TetMesh(model.mesh.vertex_count(), std::vector(model.mesh.elements().begin(), model.mesh.elements().end())),
      model.rest_positions, model.bodies);
  State state = make_state(model, model.rest_positions);
  options.velocity_damping = 1;
  Solver solver(model, state, {}, {{PlaneShape{}}}, options);
  for (int i = 0; i < 200; ++i) solver.step(state);
  EXPECT_EQ(inverted_elements(model, state), 0);
  const BoundaryPathFinder<3> finder(model.mesh, state.positions);
  EXPECT_TRUE(finder.find_penetrating_vertices().empty());
  EXPECT_GT(centre(model, state)[2], least_height);
  EXPECT_LT(kinetic_energy(model, state), most_energy);
}

/// Throws with what() that starts with `where`.
template <typename Action>
void expect_error(const std::string& where, Action&& action) {
  try {
    action();
    ADD_FAILURE() << where;
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).substr(0, where.size()), where) << error.what();
  }
}

}  // namespace selvage::bodies
