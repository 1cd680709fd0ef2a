// Heaps with default settings, step by step, against exact detection of all pairs of boundary triangles.
#include "selvage/scene/scene.h"
#include "selvage/self_collision/self_collision.h"
#include "test_scale.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace selvage {
namespace {

std::int64_t inverted_elements(const Model& model, const State& state) {
  std::int64_t count = 0;
  for (const auto& e : model.mesh.elements()) {
    const auto edge = [&](int k) { return Vec3(state.positions[e[k]] - state.positions[e[0]]); };
    count += edge(1).cross(edge(2)).dot(edge(3)) <= 0;
  }
  return count;
}

struct Heap {
  std::int64_t crossings = 0, inverted = 0, held_back = 0, contacts = 0, impacts_left = 0;
};

/// Runs a scene and looks at the end of every step.
Heap run_heap(const std::string& text, int frames) {
  const Scene scene = parse_scene(text, "heap.json");
  State state = scene.initial_state;
  XpbdSolver solver(scene.model, state, scene.handles, scene.colliders, scene.options);
  const TriangleMesh surface = boundary_surface(scene.model.mesh);
  SelfCollisionFinder finder(surface, state.positions);
  EXPECT_TRUE(finder.find_pairs().empty()) << "must start free";
  Heap heap;
  for (int i = 0; i < frames * scene.substeps; ++i) {
    solver.step(state);
    finder.update(state.positions);
    heap.crossings += std::ssize(finder.find_pairs());
    heap.inverted += inverted_elements(scene.model, state);
    heap.held_back += solver.statistics().held_back_vertices;
    heap.impacts_left += solver.statistics().impacts_left;
    heap.contacts += std::ssize(solver.contacts());
  }
  return heap;
}

void expect_free(const Heap& heap) {
  EXPECT_EQ(heap.crossings, 0);
  EXPECT_EQ(heap.inverted, 0);
  EXPECT_EQ(heap.impacts_left, 0);
  EXPECT_GT(heap.contacts, 1000);
  EXPECT_GT(heap.held_back, 0);
}

TEST(Heaps, OfHeavyBodiesOnLightOnesStayFreeInEveryStep) {
  expect_free(run_heap(R"({"selvage_scene": 1, "bodies": [
    {"mesh": {"shape": "torus", "radius": 0.4, "inner_radius": 0.12, "elements": 800}, "velocity": [0, 0, -3],
     "instances": {"list": [{"translate": [0, 0, 0.3]}, {"translate": [0.3, 0.1, 0.65]}]},
     "material": {"youngs_modulus": 1e5, "poisson_ratio": 0.4, "density": 200}},
    {"mesh": {"shape": "box", "size": [0.5, 0.5, 0.5], "cell": 0.17}, "velocity": [0, 0, -3],
     "instances": {"list": [{"translate": [-0.4, -0.3, 0.95]}, {"translate": [0.15, -0.1, 1]}],
                   "jitter": {"degrees": 20, "seed": 2}},
     "material": {"youngs_modulus": 5e5, "poisson_ratio": 0.4, "density": 1000}}],
    "colliders": [{"box": {"min": [-0.9, -0.9, 0], "max": [0.9, 0.9, 5]}}]})",
                       static_cast<int>(test::scaled(40, 40))));
}

TEST(Heaps, OfSoftCubesThatFallOnOneAnotherStayFreeInEveryStep) {
  expect_free(run_heap(R"({"selvage_scene": 1, "substeps": 10, "bodies": [
    {"mesh": {"shape": "box", "size": [1, 1, 1], "cell": 0.2}, "velocity": [0, 0, -2],
     "instances": {"list": [{"translate": [0, 0, 0.2]}, {"translate": [0.31, 0.17, 1.4]},
                            {"translate": [0.62, 0.34, 2.6]}, {"translate": [0.93, 0.51, 3.8]}]},
     "material": {"youngs_modulus": 1e5, "poisson_ratio": 0.4, "density": 1000}}],
    "colliders": [{"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}]})",
                       static_cast<int>(test::scaled(60, 60))));
}

/// Three cubes of 4 cm, one a twentieth beside the other: the lower ones of 1,000 kg/m3.
std::string tower(double top_density, const std::string& more) {
  return fmt::format(R"({{"selvage_scene": 1, "materials": {{
      "light": {{"youngs_modulus": 1e6, "poisson_ratio": 0.4, "density": 1000}},
      "top": {{"youngs_modulus": 1e6, "poisson_ratio": 0.4, "density": {}}}}},
    "bodies": [
      {{"mesh": {{"shape": "box", "size": [0.04, 0.04, 0.04], "cell": 0.01}}, "translate": [0, 0, 0.0001],
       "material": "light"}},
      {{"mesh": {{"shape": "box", "size": [0.04, 0.04, 0.04], "cell": 0.01}}, "translate": [0.002, 0, 0.0402],
       "material": "light"}},
      {{"mesh": {{"shape": "box", "size": [0.04, 0.04, 0.04], "cell": 0.01}}, "translate": [0, 0.002, 0.0803],
       "material": "top"}}],
    "colliders": [{{"plane": {{"point": [0, 0, 0], "normal": [0, 0, 1]}}}}]{}}})",
                     top_density, more);
}

/// A plate of 324 kg on four legs of 64 g.
std::string table(const std::string& more) {
  return R"({"selvage_scene": 1, "materials": {
      "foam": {"youngs_modulus": 1e6, "poisson_ratio": 0.4, "density": 4},
      "stone": {"youngs_modulus": 1e6, "poisson_ratio": 0.4, "density": 2000}},
    "bodies": [
      {"mesh": {"shape": "box", "size": [0.2, 0.2, 0.4], "cell": 0.1}, "material": "foam",
       "instances": {"list": [{"translate": [-0.4, -0.4, 0.001]}, {"translate": [0.2, -0.4, 0.001]},
                              {"translate": [-0.4, 0.2, 0.001]}, {"translate": [0.2, 0.2, 0.001]}]}},
      {"mesh": {"shape": "box", "size": [0.9, 0.9, 0.2], "cell": 0.1}, "translate": [-0.45, -0.45, 0.403],
       "material": "stone"}],
    "colliders": [{"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}])" +
         more + "}";
}

/// Height of the uppermost vertex after so many frames, 60 a second.
double height_of(const std::string& text, int frames = 120) {
  const Scene scene = parse_scene(text, "tower.json");
  State state = scene.initial_state;
  XpbdSolver solver(scene.model, state, scene.handles, scene.colliders, scene.options);
  for (int i = 0; i < frames * scene.substeps; ++i) solver.step(state);
  double height = 0;
  for (const Vec3& p : state.positions) height = std::max(height, p[2]);
  return height;
}

TEST(Heaps, TowersStandWithDefaultSettings) {
  EXPECT_GT(height_of(tower(1000, "")), 0.118);
  EXPECT_GT(height_of(tower(5000, "")), 0.115);
  // As soft as these steps make it, one falls.
  EXPECT_LT(height_of(tower(1000, R"(, "substeps": 5)")), 0.08);
}

TEST(Heaps, AHeavyPlateStandsOnLightLegsWithDefaultSettings) {
  EXPECT_GT(height_of(table(""), 30), 0.58);
  EXPECT_LT(height_of(table(R"(, "substeps": 25)"), 30), 0.5);
}

}  // namespace
}  // namespace selvage
