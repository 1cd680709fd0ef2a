#include "selvage/scene/scene.h"

#include "io/whole_file.h"
#include "scene/default_substeps.h"
#include "scene/description/scene_description.h"
#include "scene/fingerprint.h"
#include "scene/keyframed_collider.h"
#include "selvage/core/error.h"
#include "selvage/geometry/predicates.h"
#include "selvage/io/mesh_file.h"
#include "selvage/shapes/sequences.h"
#include "simulation/colliders/prepared_collider.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace selvage {

namespace {

/// Calls `make`, and lets its errors begin with the place in the scene.
template <typename Make>
auto at_place(const std::string& where, Make&& make) {
  try {
    return make();
  } catch (const Error& error) {
    throw Error(where, error.what());
  }
}

IndexedMesh make_first_frame(const MeshSource& source) {
  const SurfaceSequence sequence(source.sequence, source.options.elements.value_or(0));
  IndexedMesh mesh;
  mesh.positions = sequence.positions(0);
  mesh.triangles = sequence.triangles();
  return mesh;
}

IndexedMesh load_mesh(const MeshSource& source) {
  return at_place(source.where, [&] {
    IndexedMesh mesh = !source.sequence.empty() ? make_first_frame(source)
                       : source.file.empty()    ? make_shape(source.shape, source.options)
                                                : read_mesh(source.file);
    if (source.centre) centre_at_origin(mesh.positions);
    return mesh;
  });
}

/// The mesh of a body; of cloth without elements, of a solid without triangles.
IndexedMesh load_body(const BodyDescription& body, const MeshSource& source) {
  IndexedMesh mesh = load_mesh(source);
  const bool is_solid = !mesh.tetrahedra.empty();
  if (!body.is_cloth() && !is_solid)
    throw Error(source.where, "is a surface",
                R"(give its body a material of the kind "cloth", or a mesh of tetrahedra)");
  if (body.is_cloth() && is_solid)
    throw Error(source.where, "is a mesh of tetrahedra, and its body's material is cloth",
                "give a surface of triangles, or another material");
  if (is_solid) mesh.triangles.clear();
  return mesh;
}

void check_same_elements(const IndexedMesh& a, const IndexedMesh& b, const std::string& where) {
  if (a.positions.size() == b.positions.size() && a.tetrahedra == b.tetrahedra && a.triangles == b.triangles) return;
  throw Error(where, "has not the elements of the mesh", "give the same mesh in two poses");
}

/// A body's mesh in its own coordinates: at rest, and as the run begins.
struct TwoShapes {
  IndexedMesh rest;
  std::vector<Vec3> start;
};

void apply_named_pose(const NamedPose& pose, IndexedMesh& mesh) {
  if (!pose.matrix) return apply_pose(mesh, pose.name, pose.options);
  for (Vec3& p : mesh.positions) p = *pose.matrix * p;
}

TwoShapes load_shapes(const BodyDescription& body) {
  TwoShapes shapes{load_body(body, body.mesh), {}};
  IndexedMesh posed = shapes.rest;
  for (const NamedPose& pose : body.poses) {
    at_place(pose.where, [&] { apply_named_pose(pose, posed); });
    if (posed.positions.size() != shapes.rest.positions.size())
      throw Error(pose.where, "adds an object", "use another pose, or list two bodies");
  }
  shapes.start = std::move(posed.positions);
  if (body.rest) {
    IndexedMesh rest = load_body(body, *body.rest);
    check_same_elements(rest, shapes.rest, body.rest->where);
    shapes.rest.positions = std::move(rest.positions);
  }
  return shapes;
}

std::string box_text(std::span<const Vec3> positions) {
  Vec3 least = positions[0], most = positions[0];
  for (const Vec3& p : positions) least = least.cwiseMin(p), most = most.cwiseMax(p);
  return fmt::format("the mesh reaches from [{:.4g}, {:.4g}, {:.4g}] to [{:.4g}, {:.4g}, {:.4g}]", least[0], least[1],
                     least[2], most[0], most[1], most[2]);
}

/// Thickness of cloth where the scene gives none: a millimetre, or less where triangles are small [m].
double usual_thickness(std::span<const VertexTuple<3>> triangles, std::span<const Vec3> rest) {
  constexpr double kUsual = 1e-3, kPartOfEdge = 0.1;
  double shortest = std::numeric_limits<double>::infinity();
  for (const auto& [a, b, c] : triangles)
    shortest = std::min({shortest, (rest[a] - rest[b]).norm(), (rest[b] - rest[c]).norm(), (rest[c] - rest[a]).norm()});
  return std::min(kUsual, kPartOfEdge * shortest);
}

/// All bodies of a scene, as they are put together.
struct Assembly {
  std::vector<VertexTuple<4>> elements;
  std::vector<VertexTuple<3>> triangles;  ///< of cloth
  std::vector<Vec3> rest, start;
  std::vector<Body> bodies;
  std::vector<Handle> handles;
  std::vector<Index> holder;  ///< of each vertex: the handle that holds it

  void add_copy(const BodyDescription& body, const TwoShapes& shapes, const Placement& copy, const std::string& name);
  void add_handles(const BodyDescription& body, const TwoShapes& shapes, Index first);
};

void Assembly::add_copy(const BodyDescription& body, const TwoShapes& shapes, const Placement& copy,
                        const std::string& name) {
  const std::size_t vertices = rest.size() + shapes.start.size(),
                    count = std::max(elements.size() + shapes.rest.tetrahedra.size(),
                                     triangles.size() + shapes.rest.triangles.size());
  if (vertices > std::size_t{1} << 30 || count > std::size_t{1} << 29)
    throw Error(body.where, "makes the scene too large", "use fewer copies or coarser meshes");
  const auto first = static_cast<Index>(rest.size());
  bodies.push_back({name, first, static_cast<Index>(shapes.start.size()), static_cast<Index>(elements.size()),
                    static_cast<Index>(shapes.rest.tetrahedra.size()), body.material.solid, body.velocity,
                    static_cast<Index>(triangles.size()), static_cast<Index>(shapes.rest.triangles.size()),
                    body.material.cloth});
  for (const Vec3& p : shapes.rest.positions) rest.push_back(body.place.apply(copy.apply(p)));
  for (const Vec3& p : shapes.start) start.push_back(body.place.apply(copy.apply(p)));
  for (std::size_t e = 0; e < shapes.rest.tetrahedra.size(); ++e) {
    const auto& [a, b, c, d] = shapes.rest.tetrahedra[e];
    elements.push_back({first + a, first + b, first + c, first + d});
    if (orientation({rest[first + a], rest[first + b], rest[first + c], rest[first + d]}) <= 0)
      throw Error(body.where, fmt::format("element {} of its mesh is flat or inverted at rest", e),
                  "name a mesh under 'rest' in which none is");
  }
  for (const auto& [a, b, c] : shapes.rest.triangles) triangles.push_back({first + a, first + b, first + c});
  if (body.is_cloth()) {
    ClothMaterial& cloth = bodies.back().cloth;
    cloth.warp_direction = body.place.turn * (copy.turn * cloth.warp_direction);
    if (cloth.thickness == kNotGiven)
      cloth.thickness = usual_thickness(std::span(triangles).subspan(bodies.back().first_triangle), rest);
  }
  holder.resize(rest.size(), kNone);
  add_handles(body, shapes, first);
}

void Assembly::add_handles(const BodyDescription& body, const TwoShapes& shapes, Index first) {
  for (const HandleDescription& description : body.handles) {
    Handle handle{{}, description.motion, description.release_time};
    for (std::size_t i = 0; i < shapes.rest.positions.size(); ++i) {
      if (!description.region.holds(shapes.rest.positions[i])) continue;
      const Index v = first + static_cast<Index>(i);
      if (holder[v] != kNone)
        throw Error(description.region.where, "holds vertices that another handle holds", "let regions not overlap");
      holder[v] = static_cast<Index>(handles.size());
      handle.vertices.push_back(v);
    }
    if (handle.vertices.empty())
      throw Error(description.region.where, "holds no vertex", box_text(shapes.rest.positions));
    handles.push_back(std::move(handle));
  }
}

Collider build_collider(const ColliderDescription& description, double frames_per_second) {
  Collider collider = description.collider;
  if (description.keyframes)
    collider.shape = read_keyframed_shape(*description.keyframes, description.place, frames_per_second);
  if (!description.mesh) return collider;
  IndexedMesh mesh = load_mesh(*description.mesh);
  MeshShape shape;
  shape.triangles = mesh.triangles;
  if (!mesh.tetrahedra.empty()) {
    const TetMesh solid(static_cast<Index>(mesh.positions.size()), mesh.tetrahedra);
    shape.triangles.assign(solid.boundary_faces().begin(), solid.boundary_faces().end());
  }
  for (const Vec3& p : mesh.positions) shape.positions.push_back(description.place.apply(p));
  at_place(description.mesh->where,
           [&] { return MeshCollider("surface", shape); });  // refuses a surface that is not closed
  collider.shape = std::move(shape);
  return collider;
}

Assembly assemble(const SceneDescription& description) {
  Assembly all;
  for (const BodyDescription& body : description.bodies) {
    const TwoShapes shapes = load_shapes(body);
    const bool single = body.instances.size() == 1;
    for (std::size_t i = 0; i < body.instances.size(); ++i)
      all.add_copy(body, shapes, body.instances[i], single ? body.name : fmt::format("{}[{}]", body.name, i));
  }
  return all;
}

std::uint64_t fingerprint_of(const SceneDescription& description, const Scene& scene) {
  Fingerprint print;
  print.add(description.canonical);
  print.add(scene.model.mesh.elements());
  print.add(std::span<const VertexTuple<3>>(scene.model.triangles));
  print.add(std::span<const Vec3>(scene.model.rest_positions));
  print.add(std::span<const Vec3>(scene.initial_state.positions));
  for (const Collider& collider : scene.colliders) {
    if (const auto* keyframed = std::get_if<KeyframedShape>(&collider.shape)) {
      print.add(std::span<const VertexTuple<3>>(keyframed->triangles));
      print.add(std::span<const double>(keyframed->times));
      for (const auto& positions : keyframed->positions) print.add(std::span<const Vec3>(positions));
    }
    const auto* mesh = std::get_if<MeshShape>(&collider.shape);
    if (mesh == nullptr) continue;
    print.add(std::span<const Vec3>(mesh->positions));
    print.add(std::span<const VertexTuple<3>>(mesh->triangles));
  }
  return print.value();
}

}  // namespace

Scene parse_scene(std::string_view text, const std::filesystem::path& path, std::string_view scale,
                  std::span<const std::string> changes) {
  const SceneDescription description = describe_scene(text, path, scale, changes);
  Assembly all = assemble(description);
  Scene scene;
  scene.name = path.stem().string();
  scene.scale = scale;
  scene.model = at_place(path.string() + ": bodies", [&] {
    const auto vertices = static_cast<Index>(all.rest.size());
    TetMesh mesh =
        all.elements.empty() ? TetMesh::without_elements(vertices) : TetMesh(vertices, std::move(all.elements));
    return make_model(std::move(mesh), std::move(all.rest), std::move(all.bodies), std::move(all.triangles));
  });
  scene.initial_state =
      at_place(path.string() + ": bodies", [&] { return make_state(scene.model, std::move(all.start)); });
  // Initial velocities are limited as those of each step are.
  for (Vec3& v : scene.initial_state.velocities)
    if (v.norm() > description.options.max_speed) v *= description.options.max_speed / v.norm();
  scene.handles = std::move(all.handles);
  for (const ColliderDescription& collider : description.colliders)
    scene.colliders.push_back(build_collider(collider, description.frames_per_second));
  scene.solver = description.solver;
  scene.options = description.options;
  scene.newton = description.newton;
  scene.vbd_residual = description.vbd_residual;
  scene.frames = description.frames;
  scene.frames_per_second = description.frames_per_second;
  scene.substeps = description.substeps.value_or(
      default_substeps(scene.model, scene.solver, 1.0 / description.frames_per_second, description.options));
  scene.may_halve_steps = !description.substeps && scene.solver == SolverKind::kXpbd;
  scene.options.time_step = 1.0 / (static_cast<double>(scene.frames_per_second) * scene.substeps);
  scene.resolves_tangled_start = description.resolves_tangled_start;
  scene.contact_from_frame = description.contact_from_frame;
  scene.fingerprint = fingerprint_of(description, scene);
  if (!description.allow_start_outside) check_start(scene, path.string());
  check_guarantee(scene, path.string());
  return scene;
}

Scene read_scene(const std::filesystem::path& path, std::string_view scale, std::span<const std::string> changes) {
  return parse_scene(read_whole_file(path), path, scale, changes);
}

}  // namespace selvage
