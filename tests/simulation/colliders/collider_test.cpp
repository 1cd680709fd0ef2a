#include "selvage/boundary_path/boundary_path.h"
#include "selvage/core/error.h"
#include "simulation/bodies.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

using namespace bodies;

MeshShape cube(double size) {
  const IndexedMesh box = make_box({size, size, size}, size);
  const TetMesh mesh(static_cast<Index>(box.positions.size()), box.tetrahedra);
  return {box.positions, {mesh.boundary_faces().begin(), mesh.boundary_faces().end()}};
}

struct Case {
  const char* name;
  Collider collider;
  Vec3 start;  ///< of the body's lower corner
  bool (*is_inside)(const Vec3&, double tolerance);
};

std::vector<Case> cases() {
  const auto with = [](auto shape) { return Collider{shape, {}, {0.8, 0.8}}; };
  const auto below = [](const Vec3& p, double t) { return p[2] < -t; };
  std::vector<Case> cases;
  cases.push_back({"plane", with(PlaneShape{}), {0, 0, 0.1}, below});
  cases.push_back(
      {"container", with(BoxContainer{{-0.1, -0.1, 0}, {0.4, 0.4, 1}}), {0, 0, 0.1}, [](const Vec3& p, double t) {
         return p[2] < -t || p.head<2>().minCoeff() < -0.1 - t || p.head<2>().maxCoeff() > 0.4 + t;
       }});
  cases.push_back({"bowl", with(Bowl{{0, 0, 1}, {0, 0, 2}, 1}), {0.3, 0.1, 0.5}, [](const Vec3& p, double t) {
                     return p[2] < 1 && (p - Vec3(0, 0, 1)).norm() > 1 + t;
                   }});
  cases.push_back({"sphere", with(SphereShape{{0.1, 0.1, -1}, 1}), {0, 0, 0.1}, [](const Vec3& p, double t) {
                     return (p - Vec3(0.1, 0.1, -1)).norm() < 1 - t;
                   }});
  cases.push_back({"cylinder", with(CylinderShape{{0.1, 0.1, -0.5}, {0, 0, 1}, 0.5, 1}), {0, 0, 0.1}, below});
  MeshShape block = cube(1);
  for (Vec3& p : block.positions) p -= Vec3(0.4, 0.4, 1);
  cases.push_back({"mesh", with(block), {0, 0, 0.1}, below});
  return cases;
}

TEST(Colliders, CarryBodiesThatFallOnThem) {
  for (const Case& c : cases()) {
    const Model model = make(moved(make_box({0.2, 0.2, 0.2}, 0.05), c.start), neo_hookean(2e5));
    State state = make_state(model, model.rest_positions);
    XpbdOptions options = without_contact();
    options.iterations = 5;
    options.velocity_damping = 1;
    XpbdSolver solver(model, state, {}, {c.collider}, options);
    std::int64_t touching = 0;
    for (int i = 0; i < 900; ++i) {
      solver.step(state);
      for (const Vec3& p : state.positions) ASSERT_FALSE(c.is_inside(p, 1e-9)) << c.name << " step " << i;
      touching = solver.statistics().collider_contacts;
    }
    EXPECT_GT(touching, 0) << c.name;
    EXPECT_LT(kinetic_energy(model, state), 0.01 * 8 * 9.81 * 0.1) << c.name;
    EXPECT_EQ(inverted_elements(model, state), 0) << c.name;
    EXPECT_LT(worst_stretch(model, state), 0.2) << c.name;
  }
}

/// What one wall presses hard and holds by friction, it would hold inside another wall.
TEST(Colliders, HoldNoVertexInsideOneAnotherByFriction) {
  for (const double friction : {0.0, 0.3, 1.0}) {
    const Model model = make(moved(make_box({0.2, 0.2, 0.2}, 0.1), {-0.1, -0.1, -0.1}), neo_hookean(1e5));
    State state = make_state(model, model.rest_positions);
    std::vector<Collider> walls;
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {-1.0, 1.0}) {
        const Vec3 inward = -side * Vec3::Unit(axis);
        const Motion motion{{{0, Vec3::Zero()}, {0.2, 0.03 * inward}}};
        walls.push_back({PlaneShape{-0.1 * inward, inward}, motion, {friction, friction}});
      }
    XpbdSolver solver(model, state, {}, walls, without_contact());
    for (int i = 0; i < 90; ++i) {
      solver.step(state);
      const double wall = 0.1 - 0.03 * std::min(state.time / 0.2, 1.0);
      for (const Vec3& p : state.positions)
        ASSERT_LE(p.lpNorm<Eigen::Infinity>(), wall + 1e-9) << friction << " step " << i;
    }
    EXPECT_GT(solver.statistics().collider_contacts, 0);
  }
}

/// Two blocks that start in one another, pressed between plates that would hold them by friction: they come apart.
TEST(Colliders, HoldNoVertexInsideABodyByFriction) {
  const IndexedMesh block = make_box({0.2, 0.2, 0.2}, 0.05);
  const std::array meshes{block, moved(block, {0.12, 0.013, 0})};
  const Model model = make(meshes, neo_hookean(1e5, 0.4));
  State state = make_state(model, model.rest_positions);
  const Motion motion{{{0, Vec3::Zero()}, {0.1, Vec3(0, 0, -0.06)}}};
  XpbdOptions options;
  options.friction = {0.3, 0.3};
  XpbdSolver solver(model, state, {},
                    {{PlaneShape{}, {}, {0.3, 0.3}}, {PlaneShape{{0, 0, 0.2}, -Vec3::UnitZ()}, motion, {0.3, 0.3}}},
                    options);
  BoundaryPathFinder<3> finder(model.mesh, state.positions);
  EXPECT_GT(finder.find_penetrating_vertices().size(), 50u);
  for (int i = 0; i < 150; ++i) solver.step(state);
  finder.update(state.positions);
  EXPECT_TRUE(finder.find_penetrating_vertices().empty());
  EXPECT_LT(kinetic_energy(model, state), 1e-3);
}

TEST(Colliders, TakeAlongTheBodiesOnThem) {
  const Model model = make(make_box({0.2, 0.2, 0.1}, 0.05), neo_hookean(1e5));
  State state = make_state(model, model.rest_positions);
  // A floor that moves sideways at 0.5 m/s and then stops: no sliding at 1 m/s^2 below the limit of friction.
  const Motion motion{{{0, Vec3(0, 0, 0)}, {1, Vec3(0.5, 0, 0)}}};
  XpbdSolver solver(model, state, {}, {{PlaneShape{}, motion, {0.9, 0.9}}}, without_contact());
  for (int i = 0; i < 240; ++i) solver.step(state);
  EXPECT_NEAR(momentum(model, state)[0] / 4, 0.5, 0.02);
  for (int i = 0; i < 300; ++i) solver.step(state);
  EXPECT_NEAR(momentum(model, state)[0] / 4, 0, 0.02);
}

/// Thinner than what moves in a step: from the side that it came from nothing gets to the other.
TEST(Colliders, LetNoVertexPassThroughThem) {
  MeshShape plate = cube(1);
  for (Vec3& p : plate.positions) p = (p - Vec3(0.5, 0.5, 0.5)).cwiseProduct(Vec3(4, 4, 0.02));
  const std::vector<std::pair<const char*, decltype(Collider::shape)>> shapes{
      {"mesh", plate}, {"cylinder", CylinderShape{Vec3::Zero(), Vec3::UnitZ(), 3, 0.02}}};
  for (const double speed : {2.0, 10.0, 60.0})
    for (const bool moves : {false, true})
      for (const auto& [name, shape] : shapes) {
        const Model model = make(moved(make_box({0.2, 0.2, 0.2}, 0.1), {0, 0, 0.1}), neo_hookean(1e5));
        State state = make_state(model, model.rest_positions);
        XpbdOptions options = without_contact();
        options.gravity.setZero();
        // Either the body comes, or the plate.
        Motion motion;
        if (moves) motion.keyframes = {{0, Vec3::Zero()}, {1, speed * Vec3::UnitZ()}};
        if (!moves) std::fill(state.velocities.begin(), state.velocities.end(), -speed * Vec3::UnitZ());
        XpbdSolver solver(model, state, {}, {{shape, motion}, {SphereShape{{0, 0, -9}, 1}}}, options);
        std::int64_t touching = 0;
        for (int i = 0; i < 60; ++i) {
          solver.step(state);
          const double top = motion.at(state.time).translation[2] + 0.01;
          for (const Vec3& p : state.positions) ASSERT_GE(p[2], top - 1e-9) << name << speed << moves << " step " << i;
          touching += solver.statistics().collider_contacts;
        }
        EXPECT_GT(touching, 0) << name << speed << moves;
      }
}

/// Nor where others press it so that their friction holds it, while the plate comes; whichever is listed first.
TEST(Colliders, LetFrictionPullNoVertexThroughThem) {
  MeshShape plate = cube(1);
  for (Vec3& p : plate.positions) p = (p - Vec3(0.5, 0.5, 0.5)).cwiseProduct(Vec3(0.002, 2, 2));
  const Motion press{{{0, Vec3::Zero()}, {0.1, Vec3(0, 0, -0.06)}}};
  const Vec3 start(-0.05, 0.1, 0.1);
  for (const double speed : {0.3, 2.0})
    for (const bool plate_first : {false, true}) {
      const Model model = make(make_box({0.2, 0.2, 0.2}, 0.05), neo_hookean(1e5, 0.3));
      State state = make_state(model, model.rest_positions);
      const Motion sweep{{{0, start}, {0.1, start}, {1.1, start + speed * Vec3::UnitX()}}};
      std::vector<Collider> colliders{{PlaneShape{}, {}, {1, 1}},
                                      {PlaneShape{{0, 0, 0.2}, -Vec3::UnitZ()}, press, {1, 1}}};
      colliders.insert(plate_first ? colliders.begin() : colliders.end(), {plate, sweep, {1, 1}});
      XpbdSolver solver(model, state, {}, colliders, without_contact());
      for (int i = 0; i < 100; ++i) {
        solver.step(state);
        const double front = sweep.at(state.time).translation[0] + 0.001;
        for (const Vec3& p : state.positions) ASSERT_GE(p[0], front - 1e-9) << speed << plate_first << " step " << i;
      }
      EXPECT_GT(sweep.at(state.time).translation[0], 0);
    }
}

/// A body that starts in the floor is pushed out, and not shot off by its depth a step.
TEST(Colliders, GiveNoSpeedToBodiesThatStartInside) {
  const Model model = make(moved(make_box({0.2, 0.2, 0.2}, 0.05), {0, 0, -0.06}), neo_hookean(1e5));
  State state = make_state(model, model.rest_positions);
  XpbdOptions options = without_contact();
  options.gravity.setZero();
  options.iterations = 1;
  const double quarter = 0.05 / 4, ejection_speed = quarter / options.time_step;
  XpbdSolver solver(model, state, {}, {{PlaneShape{}}}, options);
  solver.step(state);
  for (const Vec3& p : state.positions) EXPECT_GE(p[2], -0.06 + quarter - 1e-12);
  for (const Vec3& v : state.velocities) EXPECT_LT(v.norm(), 1e-9 * ejection_speed);
  for (int i = 0; i < 100; ++i) {
    solver.step(state);
    for (const Vec3& v : state.velocities) ASSERT_LT(v.norm(), 1.5 * ejection_speed);
  }
  for (const Vec3& p : state.positions) EXPECT_GE(p[2], 0);
}

TEST(Colliders, PushBodiesThatTheyRunInto) {
  const Model model = make(moved(make_box({0.2, 0.2, 0.2}, 0.1), {0.3, -0.1, 0.1}), neo_hookean(1e5));
  State state = make_state(model, model.rest_positions);
  MeshShape block = cube(0.4);
  for (Vec3& p : block.positions) p = Vec3(p[0] - 0.2, p[1] - 0.2, 3 * p[2] - 0.6);
  // It turns by a right angle on the way.
  const Motion motion{{{0, Vec3(0, 0, 0), 0}, {1, Vec3(1, 0, 0), M_PI / 2}}};
  XpbdSolver solver(model, state, {}, {{PlaneShape{}}, {block, motion, {0, 0}}}, without_contact());
  for (int i = 0; i < 300; ++i) solver.step(state);
  for (const Vec3& p : state.positions) EXPECT_GT((p - Vec3(1, 0, 0)).head<2>().lpNorm<Eigen::Infinity>(), 0.2 - 1e-6);
}

/// Each triangle with three vertices of its own, as in STL.
MeshShape torn(const MeshShape& shape) {
  MeshShape soup;
  for (const auto& triangle : shape.triangles) {
    const auto first = static_cast<Index>(soup.positions.size());
    for (const Index v : triangle) soup.positions.push_back(shape.positions[v]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  return soup;
}

MeshShape joined(MeshShape a, const MeshShape& b) {
  const auto first = static_cast<Index>(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  for (const auto& [i, j, k] : b.triangles) a.triangles.push_back({first + i, first + j, first + k});
  return a;
}

MeshShape moved_by(MeshShape shape, double size, const Vec3& offset) {
  for (Vec3& p : shape.positions) p = size * p + offset;
  return shape;
}

MeshShape facing_inwards(MeshShape shape) {
  for (auto& triangle : shape.triangles) std::swap(triangle[0], triangle[1]);
  return shape;
}

/// Where no triangles share a vertex the solid is that of the same triangles on shared ones, to the last bit.
TEST(Colliders, TakeTrianglesWithVerticesOfTheirOwn) {
  const Model model = make(moved(make_box({0.2, 0.2, 0.2}, 0.1), {0.3, 0.3, 1.01}), neo_hookean(1e5));
  std::array<State, 2> states{make_state(model, model.rest_positions), make_state(model, model.rest_positions)};
  const std::array<MeshShape, 2> shapes{cube(1), torn(cube(1))};
  for (int k = 0; k < 2; ++k) {
    XpbdSolver solver(model, states[k], {}, {{shapes[k]}}, without_contact());
    std::int64_t touching = 0;
    for (int i = 0; i < 60; ++i) {
      solver.step(states[k]);
      touching += solver.statistics().collider_contacts;
    }
    EXPECT_GT(touching, 0) << k;
  }
  EXPECT_EQ(states[0].positions, states[1].positions);
}

/// A surface that faces inwards would hold nothing back; the wall of a hollow has to.
TEST(Colliders, MustFaceOutwardsButForHollows) {
  const Model model = make(make_box({0.2, 0.2, 0.2}, 0.2), neo_hookean(1e5));
  const State state = make_state(model, model.rest_positions);
  const MeshShape hollow = facing_inwards(moved_by(cube(1), 0.5, Vec3::Constant(0.25)));
  const MeshShape far = moved_by(cube(1), 0.5, Vec3::Constant(7));
  MeshShape half = cube(1);
  std::swap(half.triangles[0][0], half.triangles[0][1]);
  const auto accepts = [&](const MeshShape& shape) {
    try {
      XpbdSolver(model, state, {}, {{shape}}, without_contact());
      return true;
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).substr(0, 10), "collider 0") << error.what();
      return false;
    }
  };
  EXPECT_TRUE(accepts(joined(cube(1), hollow)));
  EXPECT_TRUE(accepts(joined(hollow, cube(1))));
  EXPECT_TRUE(accepts(joined(cube(1), far)));
  EXPECT_TRUE(accepts(moved_by(cube(1), 1e-9, Vec3::Constant(7))));
  EXPECT_FALSE(accepts(facing_inwards(cube(1))));
  EXPECT_FALSE(accepts(torn(facing_inwards(cube(1)))));
  EXPECT_FALSE(accepts(joined(cube(1), facing_inwards(far))));
  EXPECT_FALSE(accepts(half));
}

TEST(Colliders, AreRefusedWhenImpossible) {
  const Model model = make(make_box({0.2, 0.2, 0.2}, 0.2), neo_hookean(1e5));
  const State state = make_state(model, model.rest_positions);
  MeshShape open = cube(1);
  open.triangles.pop_back();
  std::vector<Collider> wrong = {{SphereShape{Vec3::Zero(), 0}},
                                 {PlaneShape{Vec3::Zero(), Vec3::Zero()}},
                                 {BoxContainer{Vec3::Ones(), Vec3::Zero()}},
                                 {CylinderShape{Vec3::Zero(), Vec3::UnitX(), 1, -1}},
                                 {Bowl{Vec3::Zero(), Vec3::UnitZ(), NAN}},
                                 {open},
                                 {MeshShape{}},
                                 {PlaneShape{}, {}, {-1, 0}},
                                 {PlaneShape{}, {{{1}, {0}}}}};
  for (const Collider& collider : wrong) {
    try {
      XpbdSolver(model, state, {}, {{PlaneShape{}}, collider}, without_contact());
      ADD_FAILURE() << "shape " << collider.shape.index();
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).substr(0, 10), "collider 1") << error.what();
    }
  }
}

}  // namespace
}  // namespace selvage
