// Every energy of a stencil: its derivatives are finite differences, rigid motion changes nothing, and it stays finite
// whatever its vertices do. A new energy is one more Sample here.
#include "elasticity/edge_spring.h"
#include "elasticity/neo_hookean.h"
#include "elasticity/randoms.h"
#include "elasticity/strain_damping.h"
#include "elasticity/triangles/bending.h"
#include "elasticity/triangles/membrane_neo_hookean.h"
#include "elasticity/triangles/membrane_weave.h"
#include "elasticity/volume_spring.h"
#include "test_scale.h"

#include <gtest/gtest.h>

#include <numbers>

namespace selvage {
namespace {

using test::scaled;

template <int D>
RestSimplex<D> random_rest(Randoms& random) {
  if constexpr (D == 3)
    return RestSimplex<3>::of(random.edges());
  else
    return RestSimplex<2>::of(random.flat_edges());
}

HingePositions flat_hinge() {
  HingePositions rest;
  rest << 0, 1, 0.25, 0.5, 0, 0, 0.75, -1, 0, 0, 0, 0;
  return rest;
}

template <typename Energy>
struct Sample;
template <>
struct Sample<SimplexElement<3, NeoHookean>> {
  static auto make(Randoms& r) {
    return SimplexElement<3, NeoHookean>{random_rest<3>(r), NeoHookean::of(2 + r.unit(), 0.25 + 0.2 * r.unit())};
  }
};
template <>
struct Sample<SimplexElement<3, VolumeSpring>> {
  static auto make(Randoms& r) { return SimplexElement<3, VolumeSpring>{random_rest<3>(r), {2 + r.unit()}}; }
};
template <>
struct Sample<SimplexElement<3, StrainDamping<3>>> {
  static auto make(Randoms& r) {
    const Eigen::Matrix3d start = r.stretch();
    return SimplexElement<3, StrainDamping<3>>{random_rest<3>(r),
                                               {2 + r.unit(), 1 + r.unit(), start.transpose() * start}};
  }
};
template <>
struct Sample<SimplexElement<2, MembraneNeoHookean>> {
  static auto make(Randoms& r) {
    return SimplexElement<2, MembraneNeoHookean>{random_rest<2>(r), {2 + r.unit(), 1 + r.unit()}};
  }
};
template <>
struct Sample<SimplexElement<2, MembraneWeave>> {
  static auto make(Randoms& r) {
    return SimplexElement<2, MembraneWeave>{random_rest<2>(r), {2 + r.unit(), 2 + r.unit(), 2 + r.unit()}};
  }
};
template <>
struct Sample<SimplexElement<2, StrainDamping<2>>> {
  static auto make(Randoms& r) {
    const DeformationGradient<2> start = r.columns<2>();
    return SimplexElement<2, StrainDamping<2>>{random_rest<2>(r),
                                               {2 + r.unit(), 1 + r.unit(), start.transpose() * start}};
  }
};
template <>
struct Sample<EdgeSpring> {
  static auto make(Randoms& r) { return EdgeSpring{2 + r.unit(), 1 + 0.5 * r.unit()}; }
};
template <>
struct Sample<HingeBending> {
  static auto make(Randoms& r) {
    HingeBending hinge = HingeBending::of(flat_hinge() + 0.2 * r.columns<4>(), 1 + 0.5 * r.unit());
    hinge.stiffness = 1 + 0.5 * r.unit();
    return hinge;
  }
};
template <>
struct Sample<QuadraticBending> {
  static auto make(Randoms& r) { return QuadraticBending::of(flat_hinge(), 1 + 0.5 * r.unit()); }
};

template <>
struct Sample<HingeDamping> {
  static auto make(Randoms& r) {
    HingeDamping damping = HingeDamping::of(flat_hinge(), 1 + 0.5 * r.unit());
    damping.start = 0.5 * r.unit();
    return damping;
  }
};

template <typename Energy>
class Stencils : public testing::Test {
 public:
  static constexpr int kVertices = Energy::kVertices;
  using Positions = StencilPositions<kVertices>;
  static Positions random_positions(Randoms& random) { return random.columns<kVertices>(); }
  /// Derivatives of nearly flat, nearly folded or very short stencils grow beyond differences of doubles.
  static bool is_smooth(const Positions& x) {
    for (int a = 0; a < kVertices; ++a)
      for (int b = 0; b < a; ++b)
        if ((x.col(a) - x.col(b)).norm() < 0.3) return false;
    if constexpr (kVertices == 3) return (x.col(1) - x.col(0)).cross(x.col(2) - x.col(0)).norm() > 0.3;
    if constexpr (std::is_same_v<Energy, HingeBending>)
      return (x.col(1) - x.col(0)).cross(x.col(2) - x.col(0)).norm() > 0.3 &&
             (x.col(1) - x.col(0)).cross(x.col(3) - x.col(0)).norm() > 0.3 && std::abs(hinge_angle(x)) < 1.5;
    return true;
  }
};
using Energies =
    testing::Types<SimplexElement<3, NeoHookean>, SimplexElement<3, VolumeSpring>, SimplexElement<3, StrainDamping<3>>,
                   SimplexElement<2, MembraneNeoHookean>, SimplexElement<2, MembraneWeave>,
                   SimplexElement<2, StrainDamping<2>>, EdgeSpring, HingeBending, QuadraticBending, HingeDamping>;
TYPED_TEST_SUITE(Stencils, Energies);

constexpr double kShift = 1e-6;

TYPED_TEST(Stencils, HaveDerivativesThatAreFiniteDifferences) {
  static_assert(StencilEnergy<TypeParam>);
  Randoms random;
  std::int64_t compared = 0;
  const std::int64_t wanted = scaled(200, 20);
  while (compared < wanted) {
    auto x = TestFixture::random_positions(random);
    const TypeParam energy = Sample<TypeParam>::make(random);
    if (!TestFixture::is_smooth(x)) continue;
    ++compared;
    const auto gradient = energy.gradient(x);
    const auto hessian = energy.hessian(x);
    ASSERT_LT((hessian - hessian.transpose()).norm(), 1e-12 * (1 + hessian.norm()));
    for (int i = 0; i < x.size(); ++i) {
      const double at = x(i);
      x(i) = at + kShift;
      const double above = energy.energy(x);
      const auto gradient_above = energy.gradient(x);
      x(i) = at - kShift;
      const double difference = (above - energy.energy(x)) / (2 * kShift);
      const auto column = ((gradient_above - energy.gradient(x)) / (2 * kShift)).eval();
      x(i) = at;
      ASSERT_NEAR(gradient(i), difference, 1e-7 * (1 + gradient.norm())) << x;
      ASSERT_LT((hessian.col(i) - column.reshaped()).norm(), 1e-7 * (1 + hessian.norm())) << x;
    }
  }
}

TYPED_TEST(Stencils, RotateAndShiftWithTheirVerticesWithoutForceOrMoment) {
  Randoms random;
  for (int n = 0; n < 100; ++n) {
    const auto x = TestFixture::random_positions(random);
    const TypeParam energy = Sample<TypeParam>::make(random);
    const Eigen::Matrix3d rotation = random.rotation();
    const auto turned = ((rotation * x).colwise() + Eigen::Vector3d(random.vector())).eval();
    const double scale = 1 + energy.gradient(x).norm();
    EXPECT_NEAR(energy.energy(turned), energy.energy(x), 1e-12 * scale * scale);
    EXPECT_LT((energy.gradient(turned) - rotation * energy.gradient(x)).norm(), 1e-10 * scale * scale);
    Eigen::Vector3d force = Eigen::Vector3d::Zero(), moment = force;
    for (int k = 0; k < TypeParam::kVertices; ++k) {
      const Eigen::Vector3d own = energy.gradient(x).col(k), at = x.col(k);
      force += own;
      moment += at.cross(own);
    }
    EXPECT_LT(force.norm(), 1e-12 * scale);
    EXPECT_LT(moment.norm(), 1e-12 * scale);
  }
}

TYPED_TEST(Stencils, HavePositiveHessiansThatAreNotBelowTheExactOnes) {
  Randoms random;
  int negative = 0;
  for (int n = 0; n < 300; ++n) {
    const auto x = TestFixture::random_positions(random);
    const TypeParam energy = Sample<TypeParam>::make(random);
    const auto exact = energy.hessian(x), positive = energy.positive_hessian(x);
    const double size = 1 + exact.norm();
    negative += least_eigenvalue(exact) < -1e-9 * size;
    ASSERT_GT(least_eigenvalue(positive), -1e-12 * size);
    // Gauss-Newton leaves out curvature of either sign.
    if constexpr (!std::is_same_v<TypeParam, HingeBending> && !std::is_same_v<TypeParam, HingeDamping>) {
      ASSERT_GT(least_eigenvalue((positive - exact).eval()), -1e-10 * size) << x;
    }
  }
  if constexpr (!std::is_same_v<TypeParam, QuadraticBending>) {
    EXPECT_GT(negative, 10);
  }
}

TYPED_TEST(Stencils, StayFiniteWhereTheirVerticesAreInOnePlaceOnALineOrFlat) {
  using Points = StencilPositions<TypeParam::kVertices>;
  Randoms random;
  const auto expect_finite = [&](const TypeParam& energy, const Points& x) {
    EXPECT_TRUE(std::isfinite(energy.energy(x))) << x;
    EXPECT_TRUE(energy.gradient(x).allFinite()) << x;
    EXPECT_TRUE(energy.hessian(x).allFinite()) << x;
    EXPECT_TRUE(energy.positive_hessian(x).allFinite()) << x;
    EXPECT_GE(least_eigenvalue(energy.positive_hessian(x)), -1e-12 * (1 + energy.positive_hessian(x).norm())) << x;
  };
  for (int n = 0; n < 20; ++n) {
    const TypeParam energy = Sample<TypeParam>::make(random);
    const Points x = TestFixture::random_positions(random);
    Points point = x, line = x, flat = x, mirrored = x, two = x;
    point.colwise() = Eigen::Vector3d(x.col(0));
    line.template bottomRows<2>().setZero();
    flat.row(1).setZero();
    mirrored.row(2) = -mirrored.row(2);
    two.col(1) = two.col(0);
    for (const Points& p : {Points(Points::Zero()), point, line, flat, mirrored, two}) expect_finite(energy, p);
  }
}

/// Materials whose positive Hessian is the nearest one: compared with a numeric eigensystem.
template <typename Material, int D>
void expect_nearest(const Material& material, const DeformationGradient<D>& f, double tolerance = 1e-11) {
  const DeformationHessian<D> exact = material.hessian(f), slow = without_negative_eigenvalues(exact);
  EXPECT_LT((material.positive_hessian(f) - slow).norm(), tolerance * (1 + exact.norm())) << f;
}

TEST(NeoHookean, HasTheEigensystemOfItsHessianInClosedForm) {
  Randoms random;
  const std::int64_t count = scaled(2000, 100);
  std::int64_t inverted = 0;
  for (std::int64_t n = 0; n < count; ++n) {
    const Eigen::Matrix3d f = 1.5 * random.matrix();
    inverted += f.determinant() < 0;
    expect_nearest<NeoHookean, 3>(NeoHookean::of(1, 0.4), f);
    expect_nearest<NeoHookean, 3>(NeoHookean::of(1, 0.4999), f);
    expect_nearest<VolumeSpring, 3>({2}, f);
    expect_nearest<NeoHookean, 3>(NeoHookean::of(1, 0.3), random.rotation());
  }
  EXPECT_GT(inverted, test::quota(count, 0.3));
  for (const Eigen::Vector3d& s :
       {Eigen::Vector3d(0, 0, 0), {1, 0, 0}, {1, 1, 0}, {1, 1, -1}, {2, 2, 2}, {-1, -1, -1}}) {
    const Eigen::Matrix3d f = random.rotation() * s.asDiagonal() * random.rotation();
    expect_nearest<NeoHookean, 3>(NeoHookean::of(1, 0.4), f);
    expect_nearest<VolumeSpring, 3>({2}, f);
  }
}

TEST(MembraneNeoHookean, HasTheEigensystemOfItsHessianInClosedForm) {
  Randoms random;
  for (std::int64_t n = 0; n < scaled(1000, 100); ++n) {
    const DeformationGradient<2> f = 1.5 * random.columns<2>();
    if (f.col(0).cross(f.col(1)).norm() > 0.05) expect_nearest<MembraneNeoHookean, 2>({1, 2}, f, 1e-10);
  }
}

/// Derivatives by one vertex are a block of the whole Hessian, but that they leave out a press.
void expect_block(const VertexDerivatives& own, const Eigen::Vector3d& gradient, const Eigen::Matrix3d& block,
                  bool exact) {
  const double size = 1 + block.norm();
  EXPECT_LT((own.gradient - gradient).norm(), 1e-11 * (size + gradient.norm()));
  EXPECT_GT(least_eigenvalue(own.hessian), -1e-12 * size);
  EXPECT_GT(least_eigenvalue(Eigen::Matrix3d(own.hessian - block)), -1e-11 * size);
  if (exact) {
    EXPECT_LT((own.hessian - block).norm(), 1e-11 * size);
  }
}

template <int D, typename Material>
void expect_block_of_whole(const Material& material, const RestSimplex<D>& rest, const StencilPositions<D + 1>& x,
                           bool exact) {
  const SimplexElement<D, Material> element{rest, material};
  const StencilGradient<D + 1> gradient = element.gradient(x);
  const StencilHessian<D + 1> hessian = element.hessian(x);
  for (int k = 0; k <= D; ++k) {
    VertexDerivatives own = material.by_vertex(rest.deformation(x), rest.by_vertex(k));
    own.gradient *= rest.size;
    own.hessian *= rest.size;
    expect_block(own, gradient.col(k), hessian.template block<3, 3>(3 * k, 3 * k), exact);
  }
}

TEST(VertexDerivatives, AreABlockOfTheWholeHessian) {
  Randoms random;
  for (std::int64_t n = 0; n < scaled(300, 30); ++n) {
    const RestSimplex<3> rest = RestSimplex<3>::of(random.edges());
    const StencilPositions<4> x = random.columns<4>();
    expect_block_of_whole<3>(NeoHookean::of(1, 0.4), rest, x, true);
    expect_block_of_whole<3>(VolumeSpring{2, 0.5}, rest, x, true);
    const Eigen::Matrix3d start = random.stretch();
    expect_block_of_whole<3>(StrainDamping<3>{1, 2, start.transpose() * start}, rest, x, false);
  }
}

TEST(VertexDerivatives, OfSheetsAreABlockOfTheWholeHessian) {
  Randoms random;
  std::int64_t stretched = 0;
  for (std::int64_t n = 0; n < scaled(300, 30); ++n) {
    const RestSimplex<2> rest = RestSimplex<2>::of(random.flat_edges());
    const StencilPositions<3> x = random.columns<3>();
    const DeformationGradient<2> f = rest.deformation(x);
    // Only a sheet that is pressed has a Hessian by a vertex with a negative eigenvalue.
    const MembraneNeoHookean sheet{1, 2};
    const bool is_stretched = f.col(0).cross(f.col(1)).norm() > 1 + 1.0 / 3;
    stretched += is_stretched;
    expect_block_of_whole<2>(sheet, rest, x, is_stretched);
    expect_block_of_whole<2>(MembraneWeave{3, 2, 0.5}, rest, x, false);
    const DeformationGradient<2> start = random.columns<2>();
    expect_block_of_whole<2>(StrainDamping<2>{1, 2, start.transpose() * start}, rest, x, false);
    const StencilPositions<4> hinge = random.columns<4>();
    const auto flat = QuadraticBending::of(flat_hinge(), 2);
    const auto bent = HingeBending::of(random.columns<4>(), 2);
    const HingeDamping damped = Sample<HingeDamping>::make(random);
    for (int k = 0; k < 4; ++k) {
      expect_block(damped.by_vertex(hinge, k), damped.gradient(hinge).col(k),
                   damped.hessian(hinge).block<3, 3>(3 * k, 3 * k), true);
      expect_block(flat.by_vertex(hinge, k), flat.gradient(hinge).col(k), flat.hessian(hinge).block<3, 3>(3 * k, 3 * k),
                   true);
      const VertexDerivatives own = bent.by_vertex(hinge, k);
      const Eigen::Matrix3d block = bent.positive_hessian(hinge).block<3, 3>(3 * k, 3 * k);
      EXPECT_LT((own.gradient - bent.gradient(hinge).col(k)).norm(), 1e-12 * (1 + own.gradient.norm()));
      EXPECT_LT((own.hessian - block).norm(), 1e-12 * (1 + block.norm()));
    }
  }
  EXPECT_GT(stretched, 5);
}

TEST(VertexDerivatives, OfSheetsAreFiniteWhereTheyHaveNoArea) {
  const Eigen::Vector2d b(1, -0.5);
  for (const Eigen::Vector2d& columns : {Eigen::Vector2d(0, 0), {1, 2}, {0, 1}, {1, 0}}) {
    const DeformationGradient<2> f = Eigen::Vector3d(1, 2, 3) * columns.transpose();
    const VertexDerivatives sheet = MembraneNeoHookean{1, 2}.by_vertex(f, b);
    for (const VertexDerivatives& own : {sheet, MembraneWeave{1, 2, 3}.by_vertex(f, b)}) {
      EXPECT_TRUE(own.gradient.allFinite() && own.hessian.allFinite()) << f;
      EXPECT_GT(least_eigenvalue(own.hessian), -1e-12);
    }
    EXPECT_LT((sheet.gradient - MembraneNeoHookean{1, 2}.first_piola(f) * b).norm(), 1e-12);
  }
}

TEST(EdgeSpring, HasTheNearestPositiveHessian) {
  Randoms random;
  for (int n = 0; n < 300; ++n) {
    const StencilPositions<2> x = random.columns<2>();
    const StencilHessian<2> slow = without_negative_eigenvalues(EdgeSpring{3, 1}.hessian(x));
    EXPECT_LT((EdgeSpring{3, 1}.positive_hessian(x) - slow).norm(), 1e-11 * (1 + slow.norm()));
  }
}

// In plane stress of a sheet, as a strip stretched along x while its width gives way.
TEST(MembraneNeoHookean, IsHookesLawForSmallStrains) {
  const double mu = 2, lambda = 3, strain = 1e-4;
  DeformationGradient<2> f = DeformationGradient<2>::Identity();
  EXPECT_NEAR(MembraneNeoHookean({mu, lambda}).energy_density(f), 0, 1e-15);
  EXPECT_LT(MembraneNeoHookean({mu, lambda}).first_piola(f).norm(), 1e-15);
  f(0, 0) += strain;
  EXPECT_NEAR(MembraneNeoHookean({mu, lambda}).energy_density(f) / (strain * strain), mu + lambda / 2, 1e-3);
  f = DeformationGradient<2>::Identity();
  f(0, 1) = f(1, 0) = strain;
  EXPECT_NEAR(MembraneNeoHookean({mu, lambda}).energy_density(f) / (strain * strain), 2 * mu, 1e-3);
}

TEST(MembraneWeave, StretchesWarpWeftAndShearEachByItsOwnStiffness) {
  const MembraneWeave sheet{10, 20, 30};
  DeformationGradient<2> f = DeformationGradient<2>::Identity();
  EXPECT_EQ(sheet.energy_density(f), 0);
  f(0, 0) = 1.5;
  EXPECT_DOUBLE_EQ(sheet.energy_density(f), 10 / 2.0 * 0.25);
  f(0, 0) = 1, f(1, 1) = 0.5;
  EXPECT_DOUBLE_EQ(sheet.energy_density(f), 20 / 2.0 * 0.25);
  f.col(1) = Eigen::Vector3d(std::sqrt(0.5), std::sqrt(0.5), 0);
  EXPECT_NEAR(sheet.energy_density(f), 30 / 2.0 * 0.5, 1e-14);
}

TEST(HingeBending, KnowsTheAngleAndItsSign) {
  HingePositions x = flat_hinge();
  EXPECT_NEAR(hinge_angle(x), 0, 1e-15);
  for (const double angle : {-3.0, -2.0, -0.1, 0.5, 3.1}) {
    const double height = 0.75;
    x.col(2) = Eigen::Vector3d(0.25, height * std::cos(angle), height * std::sin(angle));
    EXPECT_NEAR(hinge_angle(x), angle, 1e-14);
    EXPECT_NEAR((HingeBending{2, 0.5}.energy(x)), std::pow(std::remainder(angle - 0.5, 2 * std::numbers::pi), 2),
                1e-13);
  }
  x = flat_hinge();
  const HingeBending hinge = HingeBending::of(x, 2);
  EXPECT_DOUBLE_EQ(hinge.stiffness, 3 * 2 / 0.875);
  EXPECT_EQ(hinge.rest_angle, 0);
}

TEST(QuadraticBending, CostsSmallAnglesWhatTheHingeCosts) {
  const HingePositions flat = flat_hinge();
  HingePositions x = flat;
  const double angle = 1e-3;
  x.col(2) = Eigen::Vector3d(0.25, 0.75 * std::cos(angle), 0.75 * std::sin(angle));
  const double expected = HingeBending::of(flat, 2).energy(x);
  EXPECT_NEAR(QuadraticBending::of(flat, 2).energy(x) / expected, 1, 1e-5);
  EXPECT_LT(QuadraticBending::of(flat, 2).energy(flat), 1e-28);
}

TEST(HingeDamping, CostsNothingForRigidMotionAndResistsFoldingLikeAFold) {
  Randoms random;
  const HingePositions flat = flat_hinge();
  const auto folded = [&](double angle) {
    HingePositions x = flat;
    x.col(2) = Eigen::Vector3d(0.25, 0.75 * std::cos(angle), 0.75 * std::sin(angle));
    return x;
  };
  const HingeBending hinge = HingeBending::of(flat, 2);
  HingeDamping damping = HingeDamping::of(flat, hinge.stiffness);
  for (const double start : {-0.3, 0.0, 0.8}) {
    damping.start = damping.sine(folded(start));
    EXPECT_NEAR(damping.start, std::sin(start), 1e-15);
    const HingePositions turned = (random.rotation() * folded(start)).colwise() + Eigen::Vector3d(random.vector());
    EXPECT_NEAR(damping.energy(turned), 0, 1e-28);
    EXPECT_LT(damping.gradient(turned).norm(), 1e-13);
  }
  // From flat on, a small fold costs what it costs the hinge; at a right angle folding is not resisted.
  damping.start = 0;
  EXPECT_NEAR(damping.energy(folded(1e-3)) / hinge.energy(folded(1e-3)), 1, 1e-5);
  EXPECT_NEAR((damping.sine(folded(std::numbers::pi / 2 + 1e-4)) - damping.sine(folded(std::numbers::pi / 2))), 0,
              1e-8);
}

TEST(StrainDamping, CostsNothingForRigidMotionAndResistsStretchingLikeAStretch) {
  Randoms random;
  const RestSimplex<3> rest = RestSimplex<3>::of(random.edges());
  const Eigen::Matrix3d start = random.stretch();
  const StrainDamping<3> damping{2, 3, start.transpose() * start};
  const Eigen::Matrix3d turned = random.rotation() * start;
  EXPECT_NEAR(damping.energy_density(turned), 0, 1e-28);
  EXPECT_LT(damping.first_piola(turned).norm(), 1e-13);
  // From rest a small stretch costs what it costs by Hooke's law of the same numbers.
  const double stretch = 1e-4;
  const Eigen::Matrix3d f = Eigen::Vector3d(1 + stretch, 1, 1).asDiagonal();
  EXPECT_NEAR((StrainDamping<3>{2, 3, Eigen::Matrix3d::Identity()}.energy_density(f)) / (stretch * stretch), 3.5, 1e-3);
  EXPECT_GT(rest.size, 0);
}

}  // namespace
}  // namespace selvage
