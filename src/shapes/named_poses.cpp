#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>

#include "selvage/core/error.h"
#include "selvage/geometry/predicates.h"
#include "selvage/shapes/poses.h"
#include "selvage/shapes/shapes.h"

namespace selvage {

namespace {

Vec3 size_of(const IndexedMesh& mesh) {
  if (mesh.positions.empty()) throw Error("", "there are no vertices to pose", "give a mesh with vertices");
  Vec3 low = mesh.positions[0], high = low;
  for (const Vec3& p : mesh.positions) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return high - low;
}

int longest_axis(const IndexedMesh& mesh) {
  int axis = 0;
  size_of(mesh).maxCoeff(&axis);
  return axis;
}

/// Options of a pose, and which of them it has taken: what is left over at the end was not meant for it.
class OptionReader {
 public:
  OptionReader(const IndexedMesh& mesh, const PoseOptions& options) : mesh_(mesh), left_(options) {}

  int axis() { return left_.axis ? take(left_.axis, 0) : longest_axis(mesh_); }
  double turns(double preset) { return take(left_.turns, preset); }
  double angle(double preset) { return take(left_.angle, preset); }
  int crossings(int preset) { return take(left_.crossings, preset); }
  double core(double preset) { return take(left_.core, preset); }
  /// By default oblique, so that no plane of one object falls into a plane of the other.
  Vec3 offset() {
    return left_.offset ? take(left_.offset, Vec3()) : size_of(mesh_).cwiseProduct(Vec3(0.31, 0.29, 0.27));
  }

  /// @throws Error  when an option is left over
  void finish(std::string_view pose) const {
    const auto check = [&](bool left, std::string_view option) {
      if (left) throw Error(option, fmt::format("'{}' has no {}", pose, option), "leave it out");
    };
    check(left_.axis.has_value(), "axis");
    check(left_.turns.has_value(), "turns");
    check(left_.angle.has_value(), "angle");
    check(left_.crossings.has_value(), "crossings");
    check(left_.core.has_value(), "core");
    check(left_.offset.has_value(), "offset");
  }

 private:
  template <typename T>
  static T take(std::optional<T>& option, const T& preset) {
    T value = option.value_or(preset);
    option.reset();
    return value;
  }

  const IndexedMesh& mesh_;
  PoseOptions left_;
};

constexpr std::array<std::string_view, 6> kPoseNames = {"twist", "bend", "fold", "swirl", "self-crossing", "overlap"};

void overlap_with_copy(IndexedMesh& mesh, const Vec3& offset) {
  const Index first = static_cast<Index>(mesh.positions.size());
  const std::array<IndexedMesh, 2> twice = {mesh, mesh};
  IndexedMesh both = concatenate(twice);
  pose_overlap(both.positions, first, offset);
  mesh = std::move(both);
}

}  // namespace

std::span<const std::string_view> pose_names() {
  return kPoseNames;
}

namespace {

void move_by_name(IndexedMesh& mesh, std::string_view name, const PoseOptions& options) {
  OptionReader option(mesh, options);
  if (name == "twist") {
    const int axis = option.axis();
    const double turns = option.turns(1);
    const int crossings = option.crossings(1);
    option.finish(name);
    std::vector<Vec3> moved = mesh.positions;  // either of the two may refuse
    pose_twist(moved, axis, turns);
    if (crossings != 0) pose_self_crossing(moved, axis, crossings);
    mesh.positions = std::move(moved);
  } else if (name == "bend") {
    const int axis = option.axis();
    const double turns = option.turns(1.25);
    option.finish(name);
    pose_bend(mesh.positions, axis, turns);
  } else if (name == "fold") {
    const int axis = option.axis();
    const double angle = option.angle(4.2);
    option.finish(name);
    pose_fold(mesh.positions, axis, angle);
  } else if (name == "swirl") {
    const double core = option.core(0.5), turns = option.turns(0.15);
    option.finish(name);
    pose_swirl(mesh, core, turns);
  } else if (name == "self-crossing") {
    const int axis = option.axis(), crossings = option.crossings(2);
    option.finish(name);
    pose_self_crossing(mesh.positions, axis, crossings);
  } else if (name == "overlap") {
    const Vec3 offset = option.offset();
    option.finish(name);
    overlap_with_copy(mesh, offset);
  } else {
    throw Error("pose", fmt::format("there is no pose '{}'", name),
                fmt::format("use one of {}", fmt::join(kPoseNames, ", ")));
  }
}

/// Elements that are positive with the vertices `before`, and with `after` no more: how many, and the first.
struct InvertedElements {
  Index count = 0, first = kNone;
};

InvertedElements find_inverted_vertices(std::span<const VertexTuple<4>> elements, std::span<const Vec3> before,
                                        std::span<const Vec3> after) {
  InvertedElements inverted;
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const auto is_positive = [&](std::span<const Vec3> p) {
      const VertexTuple<4>& v = elements[e];
      return orient3d(p[v[0]], p[v[1]], p[v[2]], p[v[3]]) > 0;
    };
    if (is_positive(after) || !is_positive(before)) continue;
    if (inverted.count++ == 0) inverted.first = static_cast<Index>(e);
  }
  return inverted;
}

}  // namespace

void apply_pose(IndexedMesh& mesh, std::string_view name, const PoseOptions& options) {
  std::vector<Vec3> before = mesh.positions;
  const std::size_t element_count = mesh.tetrahedra.size();
  move_by_name(mesh, name, options);
  // The maps keep the orientation of space; an element that is large against a bend can still turn over.
  const InvertedElements inverted =
      find_inverted_vertices(std::span(mesh.tetrahedra).first(element_count), before, mesh.positions);
  if (inverted.count == 0) return;
  mesh.positions = std::move(before);
  throw Error("pose",
              fmt::format("'{}' would turn {} of {} elements inside out, the first of them element {}", name,
                          inverted.count, element_count, inverted.first),
              "turn or bend the mesh less, or give it smaller elements");
}

std::span<const TangledExample> tangled_examples() {
  static constexpr std::array<TangledExample, 31> kExamples = {{
      {"box", "overlap"},
      {"beam", "twist"},
      {"beam", "bend"},
      {"beam", "fold"},
      {"beam", "self-crossing"},
      {"beam", "overlap"},
      {"rod", "twist"},
      {"rod", "bend"},
      {"rod", "fold"},
      {"rod", "self-crossing"},
      {"rod", "overlap"},
      {"trefoil", "overlap"},
      {"nested-knot", "swirl"},
      {"nested-knot", "overlap"},
      {"noodle", "twist"},
      {"noodle", "bend"},
      {"noodle", "self-crossing"},
      {"noodle", "fold"},
      {"noodle", "overlap"},
      {"ball", "overlap"},
      {"torus", "bend"},
      {"torus", "overlap"},
      {"tube", "twist"},
      {"tube", "bend"},
      {"tube", "fold"},
      {"tube", "overlap"},
      {"squishy-ball", "swirl"},
      {"squishy-ball", "overlap"},
      {"octopus", "swirl"},
      {"octopus", "overlap"},
      {"cloth", "fold"},
  }};
  return kExamples;
}

}  // namespace selvage
