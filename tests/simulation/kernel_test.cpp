#include "elasticity/neo_hookean.h"
#include "simulation/bodies.h"
#include "simulation/xpbd/material_kernel.h"
#include "simulation/xpbd/material_solver.h"
#include "test_scale.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <random>

namespace selvage {

namespace scalar {
void solve_blocks(const MaterialTask&, Index first, Index last);
}

namespace {

using namespace bodies;
using Matrix3 = Eigen::Matrix3d;
using Solve = void (*)(const MaterialTask&, Index, Index);

struct Variant {
  const char* name;
  Isa needs;
  Solve solve;
};

std::vector<Variant> variants() {
  std::vector<Variant> variants = {{"scalar", Isa::baseline, &scalar::solve_blocks},
                                   {"baseline", Isa::baseline, &baseline::solve_blocks},
                                   {"avx2", Isa::avx2, &avx2::solve_blocks},
                                   {"avx512", Isa::avx512, &avx512::solve_blocks}};
  std::erase_if(variants, [](const Variant& variant) { return variant.needs > active_isa(); });
  return variants;
}

/// A constraint as the papers write it down: its value for given positions, and its compliance over the squared step.
struct Constraint {
  std::vector<Index> vertices;
  std::function<double(const std::vector<Vec3>&)> value;
  std::function<std::vector<Vec3>(const std::vector<Vec3>&)> gradients;
  double compliance;
  double rest_weight;  ///< of its gradients, for the bound of what it moves; 0: unbounded
  bool is_volume = false;
};

Matrix3 edges_of(const std::vector<Vec3>& x) {
  Matrix3 edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = x[k + 1] - x[0];
  return edges;
}

Matrix3 cofactor(const Matrix3& f) {
  Matrix3 c;
  for (int k = 0; k < 3; ++k) c.col(k) = f.col((k + 1) % 3).cross(f.col((k + 2) % 3));
  return c;
}

/// Gradients at the four vertices of what has the derivative `stress` by the deformation gradient.
std::vector<Vec3> at_vertices(const Matrix3& stress, const Matrix3& rest_inverse) {
  const Matrix3 columns = stress * rest_inverse.transpose();
  return {-columns.rowwise().sum(), columns.col(0), columns.col(1), columns.col(2)};
}

struct Element {
  Matrix3 inverse;
  double volume;
};

Constraint deviatoric(const Element& element, double compliance) {
  const auto value = [element](const std::vector<Vec3>& x) {
    const Matrix3 f = edges_of(x) * element.inverse;
    const double j = f.determinant();
    return std::sqrt(std::max(0.0, f.squaredNorm() + j * j - 4 * j));
  };
  const auto gradients = [element, value](const std::vector<Vec3>& x) {
    const Matrix3 f = edges_of(x) * element.inverse;
    return at_vertices((f + (f.determinant() - 2) * cofactor(f)) / value(x), element.inverse);
  };
  return {{}, value, gradients, compliance / element.volume, 0};
}

Constraint hydrostatic(const Element& element, double compliance) {
  const auto value = [element](const std::vector<Vec3>& x) {
    return (edges_of(x) * element.inverse).determinant() - 1;
  };
  const auto gradients = [element](const std::vector<Vec3>& x) {
    return at_vertices(cofactor(edges_of(x) * element.inverse), element.inverse);
  };
  return {{}, value, gradients, compliance / element.volume, 0, true};
}

Constraint spring(double length, double compliance) {
  const auto value = [length](const std::vector<Vec3>& x) { return (x[1] - x[0]).norm() - length; };
  const auto gradients = [](const std::vector<Vec3>& x) {
    const Vec3 direction = (x[1] - x[0]).normalized();
    return std::vector<Vec3>{-direction, direction};
  };
  return {{}, value, gradients, compliance, 0};
}

TEST(Gradients, AreFiniteDifferences) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto random_points = [&](int count) {
    std::vector<Vec3> points(count);
    for (Vec3& p : points) p = Vec3(uniform(engine), uniform(engine), uniform(engine));
    return points;
  };
  for (std::int64_t n = 0; n < test::scaled(200); ++n) {
    const Matrix3 rest = edges_of(random_points(4));
    if (std::abs(rest.determinant()) < 0.1) continue;
    const Element element{rest.inverse(), std::abs(rest.determinant()) / 6};
    for (const Constraint& c : {deviatoric(element, 1), hydrostatic(element, 1), spring(0.5, 1)}) {
      std::vector<Vec3> x = random_points(4);
      const std::vector<Vec3> gradients = c.gradients(x);
      for (std::size_t i = 0; i < gradients.size(); ++i)
        for (int axis = 0; axis < 3; ++axis) {
          const double at = x[i][axis], step = 1e-6;
          x[i][axis] = at + step;
          const double above = c.value(x);
          x[i][axis] = at - step;
          const double difference = (above - c.value(x)) / (2 * step);
          x[i][axis] = at;
          ASSERT_NEAR(difference, gradients[i][axis], 1e-5 * (1 + std::abs(difference) + gradients[i].norm()));
        }
    }
  }
}

TEST(Constraints, OfTheNeoHookeanMaterialHaveItsEnergy) {
  std::mt19937 engine(2);
  std::uniform_real_distribution<double> uniform(-2, 2);
  const NeoHookean material{.mu = 3, .lambda = 7};
  for (int n = 0; n < 100; ++n) {
    std::vector<Vec3> x(4);
    for (Vec3& p : x) p = Vec3(uniform(engine), uniform(engine), uniform(engine));
    const Matrix3 f = edges_of(x);
    const double deviation = deviatoric({Matrix3::Identity(), 1}, 1).value(x);
    const double dilation = hydrostatic({Matrix3::Identity(), 1}, 1).value(x);
    const double energy = material.mu / 2 * deviation * deviation + material.lambda / 2 * dilation * dilation;
    ASSERT_NEAR(energy, material.energy_density(f), 1e-9 * (1 + energy));
  }
}

/// The slow twin: one constraint after the other as XPBD's equations 17, 18 and 26 have it.
class Twin {
 public:
  Twin(const Model& model, const MaterialBlocks& blocks, double time_step, bool turns_back)
      : model_(model), step_(time_step), turns_back_(turns_back) {
    for (const MaterialBlock& block : blocks.blocks) {
      const Material& material = model.bodies[block.body].material;
      const auto vertex = [&](int offset) {
        const Index place = block.first_vertex + offset / kCopyLength;
        return place < block.last_vertex ? blocks.vertices[place] : kNone;
      };
      for (Index n = block.first_edge_batch; n < block.last_edge_batch; ++n)
        for (int lane = 0; lane < kBatch; ++lane)
          add(spring(blocks.edges[n].length[lane], material.edge_compliance / (step_ * step_)),
              {vertex(blocks.edges[n].offsets[0][lane]), vertex(blocks.edges[n].offsets[1][lane])}, material);
      for (Index n = block.first_element_batch; n < block.last_element_batch; ++n)
        for (int lane = 0; lane < kBatch; ++lane) {
          const auto& of = blocks.elements[n].offsets;
          add_element({vertex(of[0][lane]), vertex(of[1][lane]), vertex(of[2][lane]), vertex(of[3][lane])}, material);
        }
    }
  }

  void solve(std::vector<StepVertex>& vertices, const std::vector<StepVertex>& start, int iterations) {
    std::vector<double> multipliers(constraints_.size(), 0);
    for (int iteration = 0; iteration < iterations; ++iteration)
      for (std::size_t n = 0; n < constraints_.size(); ++n)
        solve_one(constraints_[n], damping_[n], multipliers[n], vertices, start);
  }

 private:
  void add(Constraint constraint, std::vector<Index> vertices, const Material& material) {
    for (const Index v : vertices)
      if (v == kNone) return;
    constraint.vertices = std::move(vertices);
    constraints_.push_back(std::move(constraint));
    damping_.push_back(std::min(material.damping / step_, 3.0));  // see material_solver.cpp
  }

  void add_element(const std::vector<Index>& vertices, const Material& material) {
    std::vector<Vec3> rest;
    for (const Index v : vertices) {
      if (v == kNone) return;
      rest.push_back(model_.rest_positions[v]);
    }
    const Element element{edges_of(rest).inverse(), edges_of(rest).determinant() / 6};
    double weight = 0;
    const std::vector<Vec3> shape = at_vertices(Matrix3::Identity(), element.inverse);
    for (int k = 0; k < 4; ++k) weight += model_.inverse_masses[vertices[k]] * shape[k].squaredNorm();
    const double shear = material.youngs_modulus / (2 * (1 + material.poisson_ratio));
    const double bulk = 2 * shear * material.poisson_ratio / (1 - 2 * material.poisson_ratio);
    Constraint first = deviatoric(element, 1 / (shear * step_ * step_));
    Constraint second = hydrostatic(element, 1 / (bulk * step_ * step_));
    if (material.kind == MaterialKind::kMassSpring)
      second.compliance = material.volume_compliance / (element.volume * element.volume * step_ * step_);
    first.rest_weight = second.rest_weight = weight;
    if (material.kind == MaterialKind::kNeoHookean) add(first, vertices, material);
    add(second, vertices, material);
  }

  static std::vector<Vec3> gather(const std::vector<StepVertex>& all, const std::vector<Index>& vertices) {
    std::vector<Vec3> x;
    for (const Index v : vertices) x.push_back(Eigen::Map<const Eigen::Vector3d>(all[v].position));
    return x;
  }

  void solve_one(const Constraint& c, double damping, double& multiplier, std::vector<StepVertex>& vertices,
                 const std::vector<StepVertex>& start) const {
    const std::vector<Vec3> x = gather(vertices, c.vertices), gradients = c.gradients(x);
    const double compliance = turns_back_ && c.is_volume && c.value(x) < -1 ? 0.001 * c.compliance : c.compliance;
    double residual = c.value(x) + compliance * multiplier, weight = 0;
    const std::vector<Vec3> from = gather(start, c.vertices);
    for (std::size_t i = 0; i < x.size(); ++i) {
      residual += damping * gradients[i].dot(x[i] - from[i]);
      weight += vertices[c.vertices[i]].inverse_mass * gradients[i].squaredNorm();
    }
    // The squares of deviatoric constraints are solved: see element_solver.h.
    const double scale = c.is_volume ? 1 : std::max(c.value(x), 1e-15);
    const bool is_far = std::abs(scale * c.value(x)) >= 8;
    const double held = is_far ? 8 / scale : residual;
    const double bound = held * held / 4 * c.rest_weight;
    const double change = -residual / ((1 + damping) * weight + compliance + bound);
    multiplier += change;
    for (std::size_t i = 0; i < x.size(); ++i) {
      StepVertex& vertex = vertices[c.vertices[i]];
      for (int axis = 0; axis < 3; ++axis) vertex.position[axis] += vertex.inverse_mass * change * gradients[i][axis];
    }
  }

  const Model& model_;
  double step_;
  bool turns_back_;
  std::vector<Constraint> constraints_;
  std::vector<double> damping_;
};

/// Vertices off their rest by up to so much, a few of them pinned.
std::vector<StepVertex> shaken(const Model& model, double reach, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(-reach, reach);
  std::vector<StepVertex> vertices;
  for (Index v = 0; v < model.mesh.vertex_count(); ++v) {
    const Vec3& p = model.rest_positions[v];
    const double x = p[0] + uniform(engine), y = p[1] + uniform(engine), z = p[2] + uniform(engine);
    vertices.push_back({{x, y, z}, v % 17 == 0 ? 0 : model.inverse_masses[v]});
  }
  return vertices;
}

class Kernel : public testing::TestWithParam<Material> {};
INSTANTIATE_TEST_SUITE_P(Materials, Kernel,
                         testing::Values(neo_hookean(1e4), neo_hookean(1e6, 0.3), springs(), springs(1e-4, 1e-9)));

/// Two iterations from several starts, by the twin and by every kernel.
/// @param turns_back  inverted elements, of which there are some where vertices are far off
void compare_with_twin(const Model& model, bool turns_back) {
  const double time_step = 1.0 / 300;
  const MaterialBlocks blocks = make_material_blocks(model);
  for (const double reach : {0.001, 0.01, 0.1}) {
    const auto start = shaken(model, 0.001, 1);
    std::vector<StepVertex> before = shaken(model, reach, 2), expected = before;
    const int iterations = 2;
    Model pinned = model;  // the twin bounds its moves by the masses that the kernel is given
    for (Index v = 0; v < model.mesh.vertex_count(); ++v) pinned.inverse_masses[v] = before[v].inverse_mass;
    Twin(pinned, blocks, time_step, turns_back).solve(expected, start, iterations);
    std::vector<StepVertex> first;
    for (const Variant& variant : variants()) {
      MaterialSolver solver(model, time_step);
      if (!turns_back) solver.turn_back({});
      std::vector<StepVertex> vertices = before;
      solver.solve(vertices, start, 0, iterations, variant.solve);
      double worst = 0;
      for (std::size_t v = 0; v < vertices.size(); ++v)
        for (int axis = 0; axis < 3; ++axis)
          worst = std::max(worst, std::abs(vertices[v].position[axis] - expected[v].position[axis]));
      EXPECT_LT(worst, 1e-9) << variant.name << ", reach " << reach;
      if (first.empty()) first = vertices;
      EXPECT_EQ(std::memcmp(vertices.data(), first.data(), sizeof(StepVertex) * vertices.size()), 0) << variant.name;
    }
  }
}

// In the small box most batches are less than half full: every element at an inner vertex needs another one.
TEST_P(Kernel, EqualsTheTwinAndGivesTheSameBitsOnEveryInstructionSet) {
  for (const Vec3& size : {Vec3(0.4, 0.3, 0.2), Vec3(0.1, 0.1, 0.1)})
    for (const double damping : {0.0, 0.002})
      for (const bool turns_back : {false, true}) {
        SCOPED_TRACE(testing::Message() << "a box of " << size[0] << " m, damping " << damping << ", " << turns_back);
        Material material = GetParam();
        material.damping = damping;
        compare_with_twin(make(make_box(size, 0.05), material), turns_back);
      }
}

/// An iteration of three boxes in which the same elements are inverted.
std::vector<StepVertex> iteration_of_three(const Model& model, std::optional<std::vector<Index>> unguarded) {
  std::vector<StepVertex> vertices = shaken(model, 0, 1);
  for (StepVertex& vertex : vertices) vertex.position[2] *= -1;
  MaterialSolver solver(model, 1.0 / 300);
  if (unguarded) solver.turn_back(*unguarded);
  solver.solve(vertices, vertices, 0, 1);
  return vertices;
}

TEST(MaterialSolver, TurnsBackBodiesThatHaveAVertexOfThoseGiven) {
  const Model model = make(std::vector(3, make_box({0.2, 0.2, 0.2}, 0.1)), neo_hookean(1e5));
  const std::size_t body = model.bodies[0].vertex_count;
  const auto all = iteration_of_three(model, std::nullopt), none = iteration_of_three(model, std::vector<Index>());
  const auto equal = [&](std::size_t b, std::span<const StepVertex> x, std::span<const StepVertex> y) {
    return std::memcmp(&x[b * body], &y[b * body], body * sizeof(StepVertex)) == 0;
  };
  EXPECT_FALSE(equal(0, all, none));
  for (const std::vector<Index>& given : {std::vector<Index>{0},
                                          {model.bodies[1].first_vertex},
                                          {model.bodies[2].first_vertex - 1},
                                          {model.bodies[0].vertex_count - 1, model.bodies[2].first_vertex},
                                          {model.mesh.vertex_count() - 1}}) {
    const auto some = iteration_of_three(model, given);
    for (std::size_t b = 0; b < 3; ++b) {
      const bool has_any = std::any_of(given.begin(), given.end(), [&](Index v) { return v / body == b; });
      EXPECT_TRUE(equal(b, some, has_any ? all : none)) << "body " << b << ", given " << given.front();
    }
  }
}

TEST(MaterialSolver, BringsBackAVertexThatIsManyEdgesAway) {
  const double edge = 0.1;
  const Model model = make(make_box({0.2, 0.2, 0.2}, edge), neo_hookean(1e8));
  std::vector<StepVertex> vertices = shaken(model, 0, 1);
  const auto at_rest = vertices;
  vertices[1].position[2] -= 100 * edge;
  MaterialSolver solver(model, 1.0 / 300);
  solver.solve(vertices, at_rest, 0, 10);
  double farthest = 0;
  for (std::size_t v = 0; v < vertices.size(); ++v)
    farthest = std::max(farthest, std::abs(vertices[v].position[2] - at_rest[v].position[2]));
  EXPECT_LT(farthest, 60 * edge);  // a regression mark
}

TEST(Kernel, LeavesPinnedAndCollapsedElementsFinite) {
  for (const Material& material : {neo_hookean(1e5), springs()}) {
    const Model model = make(make_box({0.2, 0.2, 0.2}, 0.1), material);
    MaterialSolver solver(model, 1.0 / 300);
    for (const bool pinned : {false, true}) {
      std::vector<StepVertex> vertices(model.mesh.vertex_count(), {{0.5, 0.5, 0.5}, pinned ? 0.0 : 1.0});
      solver.solve(vertices, vertices, 0, 3);
      for (const StepVertex& vertex : vertices)
        for (const double x : vertex.position) ASSERT_TRUE(std::isfinite(x));
    }
  }
}

}  // namespace
}  // namespace selvage
