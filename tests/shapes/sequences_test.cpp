#include "selvage/shapes/sequences.h"

#include "selvage/core/error.h"
#include "selvage/mesh/triangle_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numeric>
#include <set>

namespace selvage {
namespace {

TriangleMesh topology(const SurfaceSequence& sequence) {
  return {sequence.vertex_count(), sequence.triangles()};
}

struct Component {
  int border_loops = 0;
  int euler_characteristic = 0;
  auto operator<=>(const Component&) const = default;
};

class Sets {
 public:
  explicit Sets(Index n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
  Index find(Index i) { return parent_[i] == i ? i : parent_[i] = find(parent_[i]); }
  void join(Index a, Index b) { parent_[find(a)] = find(b); }

 private:
  std::vector<Index> parent_;
};

/// The components of a manifold surface with borders, ordered.
std::vector<Component> components_of(const TriangleMesh& mesh) {
  Sets pieces(mesh.vertex_count()), loops(mesh.vertex_count());
  std::set<Index> on_border;
  for (Index e = 0; e < mesh.edge_count(); ++e) {
    const auto [a, b] = mesh.edges()[e];
    pieces.join(a, b);
    if (mesh.edge_triangles(e).size() != 1) continue;
    loops.join(a, b);
    on_border.insert({a, b});
  }
  std::map<Index, Component> components;
  for (Index v = 0; v < mesh.vertex_count(); ++v) ++components[pieces.find(v)].euler_characteristic;
  for (const auto& edge : mesh.edges()) --components[pieces.find(edge[0])].euler_characteristic;
  for (const auto& t : mesh.triangles()) ++components[pieces.find(t[0])].euler_characteristic;
  for (const Index v : on_border) components[pieces.find(v)].border_loops += loops.find(v) == v;
  std::vector<Component> list;
  for (const auto& [root, component] : components) list.push_back(component);
  std::sort(list.begin(), list.end());
  return list;
}

double longest(const std::vector<Vec3>& vectors) {
  double length = 0;
  for (const Vec3& v : vectors) length = std::max(length, v.norm());
  return length;
}

std::vector<Vec3> movement(const SurfaceSequence& sequence, double from, double to) {
  std::vector<Vec3> moved = sequence.positions(to), before = sequence.positions(from);
  for (std::size_t i = 0; i < moved.size(); ++i) moved[i] -= before[i];
  return moved;
}

TEST(Sequences, HaveTheTrianglesThatTheTableNames) {
  const std::map<std::string_view, std::int64_t> expected{{"pipe", 78'000},   {"karate", 126'720},  {"t-shirt", 10'080},
                                                          {"funnel", 64'082}, {"flamenco", 49'200}, {"waves", 64'082},
                                                          {"crumple", 64'082}};
  ASSERT_EQ(sequence_names().size(), expected.size());
  for (const std::string_view name : sequence_names())
    EXPECT_EQ(std::ssize(SurfaceSequence(name).triangles()), expected.at(name)) << name;
}

TEST(Sequences, ComeInAnySize) {
  for (const std::string_view name : sequence_names())
    for (const double wanted : {3'000., 40'000., 300'000.})
      EXPECT_NEAR(std::ssize(SurfaceSequence(name, std::int64_t(wanted)).triangles()) / wanted, 1, 0.5) << name;
  EXPECT_NEAR(std::ssize(SurfaceSequence("crumple", 1'000'000).triangles()) / 1e6, 1, 0.01);
}

TEST(Sequences, AreOrientedManifoldsWithTheOpeningsOfTheirCut) {
  const Component sheet{1, 1}, tube{2, 0};
  const std::map<std::string_view, std::vector<Component>> expected{
      {"pipe", {tube}},    {"karate", {tube, tube, tube}},         {"t-shirt", {{4, -2}}},  // neck, hem, two cuffs
      {"funnel", {sheet}}, {"flamenco", {tube, tube, tube, tube}}, {"waves", {sheet}},     {"crumple", {sheet}}};
  for (const std::string_view name : sequence_names()) {
    const TriangleMesh mesh = topology(SurfaceSequence(name, 3'000));
    EXPECT_EQ(components_of(mesh), expected.at(name)) << name;
    std::set<std::pair<Index, Index>> directed;
    for (const auto& t : mesh.triangles())
      for (int k = 0; k < 3; ++k) EXPECT_TRUE(directed.insert({t[k], t[(k + 1) % 3]}).second) << name;
  }
}

TEST(Sequences, HaveNoDegenerateTriangle) {
  for (const std::string_view name : sequence_names()) {
    const SurfaceSequence sequence(name, 3'000);
    for (int frame = 0; frame < sequence.frame_count(); frame += 7) {
      const std::vector<Vec3> x = sequence.positions(frame);
      double smallest = 1;
      for (const auto& t : sequence.triangles())
        smallest = std::min(smallest, (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]).norm());
      EXPECT_GT(smallest, 0) << name << ' ' << frame;
    }
  }
}

TEST(Sequences, MoveSmoothly) {
  for (const std::string_view name : sequence_names()) {
    const SurfaceSequence sequence(name, 3'000);
    for (int frame = 1; frame + 1 < sequence.frame_count(); frame += 9) {
      const double whole = longest(movement(sequence, frame, frame + 1));
      EXPECT_GT(whole, 0) << name << ' ' << frame;
      EXPECT_LT(whole, 0.1) << name << ' ' << frame;
      const double small = longest(movement(sequence, frame, frame + 1e-3));
      EXPECT_LT(small, 3e-3 * whole) << name << ' ' << frame;
    }
  }
}

TEST(Sequences, GiveTheSameBitsAgain) {
  for (const std::string_view name : sequence_names())
    EXPECT_EQ(SurfaceSequence(name, 3'000).positions(17.5), SurfaceSequence(name, 3'000).positions(17.5)) << name;
}

TEST(Sequences, RefuseWhatTheyDoNotHave) {
  EXPECT_THROW(SurfaceSequence("cape"), Error);
  EXPECT_THROW(SurfaceSequence("pipe", -1), Error);
  EXPECT_THROW(SurfaceSequence("pipe", std::int64_t{1} << 40), Error);
  const SurfaceSequence pipe("pipe", 1'000);
  EXPECT_NO_THROW(pipe.positions(pipe.frame_count() - 1));
  EXPECT_THROW(pipe.positions(pipe.frame_count()), Error);
  EXPECT_THROW(pipe.positions(-1e-9), Error);
  EXPECT_THROW(pipe.positions(std::nan("")), Error);
}

}  // namespace
}  // namespace selvage
