// Reads the sources of a scene's meshes, and their placement.
#include "scene/description/scene_description.h"

#include "selvage/shapes/sequences.h"

#include <fmt/format.h>

#include <numbers>
#include <random>

namespace selvage {

namespace {

constexpr std::int64_t kMaxInstances = 100'000;

double radians(double degrees) {
  return degrees * std::numbers::pi / 180;
}

std::string where_of(const JsonValue& value) {
  return value.file() + ": " + value.path();
}

/// Three, or two of cloth.
Vec3 read_lengths(const JsonValue& value, bool is_cloth) {
  if (!is_cloth || !value.json().is_array() || value.json().size() != 2) return value.vector();
  const std::vector<JsonValue> lengths = value.items();
  return {lengths[0].number(kPositive), lengths[1].number(kPositive), 0};
}

ShapeOptions read_shape_options(JsonObject& object, std::string_view shape) {
  ShapeOptions options;
  if (const auto v = object.find("cell")) options.cell = v->number(kPositive);
  if (const auto v = object.find("elements")) options.elements = v->integer(1, std::int64_t{1} << 29);
  if (const auto v = object.find("size")) options.size = read_lengths(*v, shape == "cloth");
  if (const auto v = object.find("length")) options.length = v->number(kPositive);
  if (const auto v = object.find("radius")) options.radius = v->number(kPositive);
  if (const auto v = object.find("inner_radius")) options.inner_radius = v->number(kPositive);
  if (const auto v = object.find("tentacles")) options.tentacles = static_cast<int>(v->integer(1, 100'000));
  if (const auto v = object.find("teeth")) options.teeth = static_cast<int>(v->integer(5, 1000));
  if (const auto v = object.find("seed")) options.seed = static_cast<unsigned>(v->integer(0, 1'000'000'000));
  if (const auto v = object.find("slenderness")) options.slenderness = v->number({1, 10});
  return options;
}

Eigen::Matrix3d read_matrix(const JsonValue& value) {
  const std::vector<JsonValue> rows = value.items();
  if (rows.size() != 3) value.fail("is no matrix", "use [[a, b, c], [d, e, f], [g, h, i]]");
  Eigen::Matrix3d matrix;
  for (int row = 0; row < 3; ++row) matrix.row(row) = rows[static_cast<std::size_t>(row)].vector();
  if (!(matrix.determinant() > 0)) value.fail("inverts the mesh", "use a matrix of positive determinant");
  return matrix;
}

NamedPose read_pose(const JsonValue& value) {
  JsonObject object(value);
  NamedPose pose;
  pose.where = where_of(value);
  if (const auto v = object.find("matrix")) {
    pose.matrix = read_matrix(*v);
    object.refuse_others();
    return pose;
  }
  const auto names = pose_names();
  pose.name = names[object.get("pose").choice(names)];
  constexpr std::array<std::string_view, 3> kAxes{"x", "y", "z"};
  if (const auto v = object.find("axis")) pose.options.axis = static_cast<int>(v->choice(kAxes));
  if (const auto v = object.find("turns")) pose.options.turns = v->any_number();
  if (const auto v = object.find("degrees")) pose.options.angle = radians(v->any_number());
  if (const auto v = object.find("crossings")) pose.options.crossings = static_cast<int>(v->integer(0, 1'000'000));
  if (const auto v = object.find("core")) pose.options.core = v->any_number();
  object.refuse_others();
  return pose;
}

Eigen::Matrix3d read_turn(const JsonValue& value) {
  JsonObject object(value);
  const Vec3 axis = object.get("axis").direction();
  const double angle = radians(object.get("degrees").any_number());
  object.refuse_others();
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

std::vector<Placement> read_grid(const JsonValue& value) {
  JsonObject object(value);
  const JsonValue counts = object.get("counts");
  const Vec3 spacing = object.get("spacing").vector();
  object.refuse_others();
  const std::vector<JsonValue> numbers = counts.items();
  if (numbers.size() != 3) counts.fail("is no grid", "use [columns, rows, layers]");
  std::array<std::int64_t, 3> count;
  for (std::size_t axis = 0; axis < 3; ++axis) count[axis] = numbers[axis].integer(1, kMaxInstances);
  if (count[0] * count[1] > kMaxInstances || count[0] * count[1] * count[2] > kMaxInstances)
    counts.fail("are too many copies", fmt::format("use at most {}", kMaxInstances));
  std::vector<Placement> places;
  for (std::int64_t z = 0; z < count[2]; ++z)
    for (std::int64_t y = 0; y < count[1]; ++y)
      for (std::int64_t x = 0; x < count[0]; ++x) {
        const Vec3 cell(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
        places.emplace_back().shift = cell.cwiseProduct(spacing);
      }
  return places;
}

std::vector<Placement> read_list(const JsonValue& value) {
  std::vector<Placement> places;
  for (const JsonValue& item : value.items()) {
    JsonObject object(item);
    places.push_back(read_placement(object));
    object.refuse_others();
  }
  if (places.empty()) value.fail("is empty", "list at least one copy");
  return places;
}

/// Shifts and turns each copy at random: the same seed gives the same bits on every machine.
void jitter(const JsonValue& value, std::vector<Placement>& places) {
  JsonObject object(value);
  double shift = 0, turn = 0;
  std::int64_t seed = 1;
  if (const auto v = object.find("translate")) shift = v->number(kNotNegative);
  if (const auto v = object.find("degrees")) turn = radians(v->number({0, 180}));
  if (const auto v = object.find("seed")) seed = v->integer(0, 1'000'000'000);
  object.refuse_others();
  std::mt19937_64 engine(static_cast<std::uint64_t>(seed));
  const auto next = [&] { return static_cast<double>(engine() >> 11) * 0x1p-52 - 1; };  // in [-1, 1)
  for (Placement& place : places) {
    Vec3 offset, axis;
    for (int i = 0; i < 3; ++i) offset[i] = shift * next();
    do {
      for (int i = 0; i < 3; ++i) axis[i] = next();
    } while (axis.squaredNorm() > 1 || axis.squaredNorm() < 1e-4);
    place.turn = Eigen::AngleAxisd(turn * next(), axis.normalized()).toRotationMatrix() * place.turn;
    place.shift += offset;
  }
}

}  // namespace

MeshSource read_mesh_source(const JsonValue& value, const std::filesystem::path& folder) {
  JsonObject object(value);
  MeshSource source;
  source.where = where_of(value);
  constexpr std::array<std::string_view, 3> kKinds{"file", "shape", "sequence"};
  const auto [kind, chosen] = object.get_one_of(kKinds);
  if (kind == 0) {
    if (chosen.text().empty() || chosen.text().find('\0') != std::string::npos)
      chosen.fail("is no file name", "name a mesh file");
    source.file = folder / chosen.text();
  } else if (kind == 2) {
    const auto names = sequence_names();
    source.sequence = names[chosen.choice(names)];
    if (const auto v = object.find("elements")) source.options.elements = v->integer(1, std::int64_t{1} << 29);
  } else {
    const auto names = shape_names();
    source.shape = names[chosen.choice(names)];
    if (const auto v = object.find("curve")) {
      if (source.shape != "rod") v->fail("is for rods only", "leave it out, or use the shape rod");
      const auto curves = curve_names();
      source.shape = shape_along_curve(curves[v->choice(curves)]);
    }
    source.options = read_shape_options(object, source.shape);
  }
  if (const auto v = object.find("centre")) source.centre = v->boolean();
  object.refuse_others();
  return source;
}

std::vector<NamedPose> read_poses(const JsonValue& value) {
  std::vector<NamedPose> poses;
  for (const JsonValue& item : value.items()) poses.push_back(read_pose(item));
  return poses;
}

Placement read_placement(JsonObject& object) {
  Placement place;
  if (const auto v = object.find("scale")) {
    place.scale = v->json().is_number() ? Vec3(Vec3::Constant(v->number(kPositive))) : v->vector();
    if (!(place.scale.minCoeff() > 0)) v->fail("inverts the mesh", "use a positive number or three");
  }
  if (const auto v = object.find("rotate")) place.turn = read_turn(*v);
  if (const auto v = object.find("translate")) place.shift = v->vector();
  return place;
}

std::vector<Placement> read_instances(const JsonValue& value) {
  JsonObject object(value);
  constexpr std::array<std::string_view, 2> kKinds{"grid", "list"};
  const auto [kind, chosen] = object.get_one_of(kKinds);
  std::vector<Placement> places = kind == 0 ? read_grid(chosen) : read_list(chosen);
  if (const auto v = object.find("jitter")) jitter(*v, places);
  object.refuse_others();
  return places;
}

Region read_region(const JsonValue& value) {
  JsonObject object(value);
  constexpr std::array<std::string_view, 2> kKinds{"box", "plane"};
  const auto [kind, chosen] = object.get_one_of(kKinds);
  object.refuse_others();
  JsonObject region(chosen);
  Region result;
  result.where = where_of(value);
  result.is_plane = kind == 1;
  if (result.is_plane) {
    result.a = region.get("point").vector();
    result.b = region.get("normal").direction();
  } else {
    result.a = region.get("min").vector();
    result.b = region.get("max").vector();
    if (!(result.a.array() <= result.b.array()).all()) chosen.fail("has a min above its max", "swap them");
  }
  region.refuse_others();
  return result;
}

}  // namespace selvage
