#pragma once

#include "scene/description/json_value.h"
#include "selvage/scene/scene.h"
#include "selvage/shapes/poses.h"
#include "selvage/shapes/shapes.h"
#include "selvage/simulation/model.h"

#include <filesystem>
#include <map>

namespace selvage {

/// Where a mesh comes from: a file, a shape by name, or the first frame of a surface in motion (SurfaceSequence).
struct MeshSource {
  std::filesystem::path file;  ///< empty: a shape or a sequence
  std::string sequence;        ///< empty: a shape
  std::string shape;
  ShapeOptions options;
  bool centre = false;  ///< move its middle to the origin
  std::string where;    ///< place in the scene, for errors
};

/// Scaling, then turning, then shifting.
struct Placement {
  Vec3 scale = Vec3::Ones();
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  Vec3 shift = Vec3::Zero();

  Vec3 apply(const Vec3& p) const { return turn * p.cwiseProduct(scale) + shift; }
};

/// A part of space that chooses vertices: a box, or a half space on the side that the normal points to.
struct Region {
  bool is_plane = false;
  Vec3 a, b;  ///< least and largest corner; point and normal
  std::string where;

  bool holds(const Vec3& p) const {
    if (is_plane) return (p - a).dot(b) >= 0;
    return (p.array() >= a.array()).all() && (p.array() <= b.array()).all();
  }
};

/// A pose of selvage/shapes/poses.h, or a linear map.
struct NamedPose {
  std::string name;
  PoseOptions options;
  std::optional<Eigen::Matrix3d> matrix;
  std::string where;
};

/// Vertices of a body that follow a motion; without keyframes they stay where they are.
struct HandleDescription {
  Region region;
  Motion motion;
  double release_time;
};

/// In place of a number that the scene does not give, until all is known that it follows from.
inline constexpr double kNotGiven = -1;

/// Material of a body: of solids, or of cloth.
struct BodyMaterial {
  enum class Kind : std::uint8_t { kAny, kSolid, kCloth } kind = Kind::kAny;  ///< kAny: not given
  Material solid;
  ClothMaterial cloth;

  BodyMaterial(Kind k = Kind::kAny) : kind(k) { solid.damping = cloth.damping = cloth.thickness = kNotGiven; }
};

/// Bodies of one mesh and one material: one, or many copies.
struct BodyDescription {
  std::string name;
  MeshSource mesh;
  std::optional<MeshSource> rest;
  std::vector<NamedPose> poses;
  Placement place;
  std::vector<Placement> instances;  ///< at least one; each is applied before `place`
  BodyMaterial material;

  bool is_cloth() const {
    return material.kind == BodyMaterial::Kind::kCloth ||
           (material.kind == BodyMaterial::Kind::kAny &&
            (mesh.shape == "cloth" || mesh.shape == "sleeve" || !mesh.sequence.empty()));
  }
  Vec3 velocity = Vec3::Zero();
  std::vector<HandleDescription> handles;
  std::string where;
};

/// Where the key frames of a surface come from: a mesh with a point cache, or a mesh for each.
struct KeyframeSource {
  std::filesystem::path mesh, cache;  ///< empty: `files`
  std::vector<std::filesystem::path>
      files;                     ///< of each key frame; one whose name has a star stands for all that fit it
  double frames_per_second = 0;  ///< 0: those of the scene
  double start = 0;              ///< time of the key frame 0 [s]
  std::vector<double> times;     ///< [s] of each key frame, in place of these two; empty: these
  std::string where;             ///< place in the scene, for errors
};

/// A collider; of a mesh or of key frames the shape is filled in when the scene is built.
struct ColliderDescription {
  Collider collider;
  std::optional<MeshSource> mesh;
  std::optional<KeyframeSource> keyframes;
  Placement place;  ///< of the mesh or the key frames
};

/// The contents of a scene file, checked: kinds of values, ranges, names. No mesh has been read or made.
struct SceneDescription {
  int frames = 60, frames_per_second = 60;
  std::optional<int> substeps;  ///< without: default_substeps()
  std::int64_t contact_from_frame = 0;
  SolverKind solver = SolverKind::kXpbd;
  XpbdOptions options;  ///< but for the time step, which parse_scene() sets
  NewtonOptions newton;
  double vbd_residual = 0;
  std::vector<BodyDescription> bodies;
  std::vector<ColliderDescription> colliders;
  bool allow_start_outside = false;    ///< see check_start()
  bool resolves_tangled_start = true;  ///< see Scene
  std::string canonical;               ///< all that decides a run, as text in one form
};

/// Reads the description of a scene at one of its scales.
///
/// @param text    the document
/// @param file    its name, for errors; meshes are found relative to its folder
/// @param scale   name of a scale that the scene has; empty: as it stands
/// @param changes values in place of those in the document, see apply_change()
/// @throws Error  one line with the file, the path within, what is wrong and what is allowed
SceneDescription describe_scene(std::string_view text, const std::filesystem::path& file, std::string_view scale,
                                std::span<const std::string> changes = {});

// The parts of describe_scene, each for one kind of object.
MeshSource read_mesh_source(const JsonValue& value, const std::filesystem::path& folder);
std::vector<NamedPose> read_poses(const JsonValue& value);
Placement read_placement(JsonObject& object);
std::vector<Placement> read_instances(const JsonValue& value);
BodyMaterial read_material(const JsonValue& value);
/// A material, written out or by the name that the scene gives it.
BodyMaterial find_material(const JsonValue& value, const std::map<std::string, BodyMaterial>& named);
Region read_region(const JsonValue& value);
Motion read_motion(const JsonValue& value);
ColliderDescription read_collider(const JsonValue& value, const std::filesystem::path& folder);
void read_contact(const JsonValue& value, SceneDescription& scene);

/// Refuses a scene in which a body starts outside a container or inside any other collider, by more than rounding of
/// its place. Vertices that a handle holds may: pins stand in floors.
///
/// @param file    name of the scene's file, for errors
/// @throws Error  one line with the file, the first such body, the collider, and what to do
void check_start(const Scene& scene, const std::string& file);

/// Refuses a scene that asks for a guarantee which it can never have: handles hold bodies in one another for ever.
///
/// @param file    name of the scene's file, for errors
/// @throws Error  one line with the file, two such bodies, the place, and what to do
void check_guarantee(const Scene& scene, const std::string& file);

}  // namespace selvage
