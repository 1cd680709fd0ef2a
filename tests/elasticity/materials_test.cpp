// Every energy density of tetrahedra: its derivatives are finite differences, and rotations cost nothing.
#include "elasticity/foldover.h"
#include "elasticity/neo_hookean.h"
#include "elasticity/randoms.h"
#include "selvage/elasticity/material.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <cmath>

namespace selvage {
namespace {

using Matrix3 = Eigen::Matrix3d;

/// A material, and how far its energy at rest is from 0.
template <typename Material>
struct Sample;
template <>
struct Sample<NeoHookean> {
  static NeoHookean make() { return NeoHookean::of(2, 0.4); }
  static constexpr double kAtRest = 0;
};
template <>
struct Sample<FoldoverEnergy> {
  static FoldoverEnergy make() { return {.squared_epsilon = 0}; }
  static constexpr double kAtRest = 5;  // |F|^2 = 3, and (1 + 1) / 1
};

template <typename Material>
class TetrahedralMaterials : public testing::Test {};
using Materials = testing::Types<NeoHookean, FoldoverEnergy>;
TYPED_TEST_SUITE(TetrahedralMaterials, Materials);

constexpr double kStep = 1e-6;

TYPED_TEST(TetrahedralMaterials, HaveTheStressThatIsTheDerivativeOfTheEnergy) {
  const TypeParam material = Sample<TypeParam>::make();
  Randoms random;
  for (int n = 0; n < 200; ++n) {
    Matrix3 f = random.stretch();
    const Matrix3 stress = material.first_piola(f);
    for (int i = 0; i < 9; ++i) {
      const double at = f(i);
      f(i) = at + kStep;
      const double above = material.energy_density(f);
      f(i) = at - kStep;
      const double difference = (above - material.energy_density(f)) / (2 * kStep);
      f(i) = at;
      ASSERT_NEAR(stress(i), difference, 1e-7 * (1 + stress.norm())) << f;
    }
  }
}

TYPED_TEST(TetrahedralMaterials, HaveNoStressAtRestAndRotateWithTheElement) {
  const TypeParam material = Sample<TypeParam>::make();
  Randoms random;
  for (int n = 0; n < 100; ++n) {
    const Matrix3 rotation = random.rotation(), f = random.stretch();
    EXPECT_NEAR(material.energy_density(rotation), Sample<TypeParam>::kAtRest, 1e-13);
    EXPECT_LT(material.first_piola(rotation).norm(), 1e-13);
    EXPECT_GT(material.energy_density(f), Sample<TypeParam>::kAtRest);
    EXPECT_NEAR(material.energy_density(rotation * f), material.energy_density(f), 1e-12);
    EXPECT_LT((material.first_piola(rotation * f) - rotation * material.first_piola(f)).norm(), 1e-12);
  }
}

// Small strains are Hooke's law: stretched along x by s with the sides held, the density is (lambda + 2 mu) s^2 / 2.
TEST(NeoHookean, IsHookesLawForSmallStrains) {
  const VertexTuple<4> element{0, 1, 2, 3};
  const std::vector<Vec3> rest{{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {0.5, 0.25, 1}};
  std::vector<Vec3> stretched = rest;
  for (Vec3& p : stretched) p[0] *= 1 + 1e-4;
  const double nu = 0.3;
  const auto [mu, lambda] = lame_parameters(1, nu);
  const SimplexElement<3, NeoHookean> solid{rest_tetrahedron(element, rest), NeoHookean::of(1, nu)};
  EXPECT_NEAR(solid.energy(gather(element, stretched)) / ((lambda + 2 * mu) / 2 * 1e-8), 1, 1e-3);
  EXPECT_NEAR(solid.energy(gather(element, rest)), 0, 1e-15);
  EXPECT_DOUBLE_EQ(element_volume(element, rest), 1);
}

TEST(FoldoverEnergy, HasDerivativesByAVertexThatAreThoseOfTheStressAlsoWhereTheElementIsInverted) {
  const FoldoverEnergy material{.squared_epsilon = 0.1};
  Randoms random;
  int inverted = 0;
  for (int n = 0; n < 500; ++n) {
    const Matrix3 f = random.matrix();
    const Vec3 b = random.vector();
    inverted += f.determinant() < 0;
    const auto found = material.by_vertex(f, b);
    EXPECT_EQ(found.energy, material.energy_density(f));
    EXPECT_LT((found.gradient - material.first_piola(f) * b).norm(), 1e-12 * (1 + found.gradient.norm()));
    const Eigen::SelfAdjointEigenSolver<Matrix3> eigen(found.hessian);
    EXPECT_GT(eigen.eigenvalues()[0], 0);
    Matrix3 moved = f;
    for (int axis = 0; axis < 3; ++axis) {
      moved.row(axis) = f.row(axis) + kStep * b.transpose();
      const double above = material.energy_density(moved);
      moved.row(axis) = f.row(axis) - kStep * b.transpose();
      const double difference = (above - material.energy_density(moved)) / (2 * kStep);
      moved.row(axis) = f.row(axis);
      ASSERT_NEAR(found.gradient[axis], difference, 1e-5 * (1 + found.gradient.norm())) << f;
    }
  }
  EXPECT_GT(inverted, 150);
}

TEST(FoldoverEnergy, GrowsWhereAnElementIsInvertedAsEpsilonShrinks) {
  const Matrix3 mirrored = Vec3(1, 1, -1).asDiagonal();
  double last = 0;
  for (const double epsilon : {1.0, 0.1, 0.01, 0.001}) {
    const double energy = FoldoverEnergy{.squared_epsilon = epsilon * epsilon}.energy_density(mirrored);
    EXPECT_GT(energy, 5 * last);
    last = energy;
  }
}

}  // namespace
}  // namespace selvage
