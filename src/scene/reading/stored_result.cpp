#include "scene/reading/stored_result.h"

#include "core/json.h"
#include "io/whole_file.h"
#include "scene/reading/shown_surface.h"
#include "selvage/core/error.h"
#include "selvage/mesh/weld.h"

#include <fmt/format.h>

#include <unordered_map>

namespace selvage {

namespace {

namespace fs = std::filesystem;
MarkKind kind_of(const std::string& contact) {
  if (contact == "crossing") return MarkKind::kCrossing;
  if (contact == "coplanar overlap") return MarkKind::kCoplanar;
  return contact == "touching" ? MarkKind::kTouching : MarkKind::kNear;
}

Marks discrete_marks(const StoredResult& result) {
  Marks marks;
  const Json &pairs = result.list("triangle_pairs"), &contacts = result.list("contacts");
  if (contacts.size() != pairs.size()) result.refuse("has other numbers of pairs and contacts");
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!contacts[i].is_string()) result.refuse("has a contact without a name");
    const Index second = result.triangle(pairs[i], 1, result.has_second());
    marks.pairs.push_back({{result.triangle(pairs[i], 0), second}, kind_of(contacts[i])});
  }
  return marks;
}

/// A triangle of each edge and of each vertex.
class TriangleFinder {
 public:
  explicit TriangleFinder(const StoredResult& result)
      : result_(result), of_vertex_(result.mesh.positions.size(), kNone) {
    for (std::size_t t = 0; t < result.triangles.size(); ++t)
      for (std::size_t i = 0; i < 3; ++i) {
        const Index a = result.triangles[t][i], b = result.triangles[t][(i + 1) % 3];
        of_vertex_[static_cast<std::size_t>(a)] = static_cast<Index>(t);
        of_edge_[key(a, b)] = static_cast<Index>(t);
      }
  }

  Index of_vertex(Index v) const { return checked(of_vertex_[static_cast<std::size_t>(v)]); }
  Index of_edge(Index a, Index b) const {
    const auto found = of_edge_.find(key(a, b));
    return checked(found == of_edge_.end() ? kNone : found->second);
  }

 private:
  static std::uint64_t key(Index a, Index b) {
    return static_cast<std::uint64_t>(std::min(a, b)) << 32 | static_cast<std::uint64_t>(std::max(a, b));
  }
  Index checked(Index triangle) const {
    if (triangle == kNone) result_.refuse("names a vertex or an edge that no triangle has");
    return triangle;
  }

  const StoredResult& result_;
  std::vector<Index> of_vertex_;
  std::unordered_map<std::uint64_t, Index> of_edge_;
};

/// Adds pairs of a vertex and a face, and of two edges.
void add_feature_marks(const StoredResult& result, Marks& marks) {
  const TriangleFinder triangles(result);
  const bool two = result.has_second();
  const auto add = [&](Index v, Index f) {
    marks.pairs.push_back({{triangles.of_vertex(v), f}, MarkKind::kVertexFace, {v, f, kNone, kNone}});
  };
  for (const Json& pair : result.list("vertex_face")) add(result.vertex(pair, 0), result.triangle(pair, 1, two));
  if (two)
    for (const Json& pair : result.list("face_vertex")) add(result.vertex(pair, 1, true), result.triangle(pair, 0));
  for (const Json& pair : result.list("edge_edge")) {
    std::array<Index, 4> e{};
    for (std::size_t i = 0; i < 4; ++i) e[i] = result.vertex(pair, i, two && i > 1);
    marks.pairs.push_back({{triangles.of_edge(e[0], e[1]), triangles.of_edge(e[2], e[3])}, MarkKind::kEdgeEdge, e});
  }
}

Marks path_marks(const StoredResult& result) {
  Marks marks;
  const auto vertices = static_cast<std::int64_t>(result.mesh.positions.size());
  for (const Json& row : result.list("paths")) {
    const auto coordinate = [&](const char* key) {
      if (!row.is_object() || !row.contains(key) || !row[key].is_number()) result.refuse("has a path without a place");
      return row[key].get<double>();
    };
    MarkedPath path{kNone, {coordinate("x"), coordinate("y"), coordinate("z")}, {}, -1};
    path.to = path.from;
    if (row.value("found", 0) == 1) {
      path.to = {coordinate("sx"), coordinate("sy"), coordinate("sz")};
      path.depth = coordinate("distance");
    }
    // Queries are vertices only where no points were asked about: then they stand in their vertex's place.
    const auto query = row.value("query", std::int64_t{-1});
    if (query >= 0 && query < vertices && result.mesh.positions[static_cast<std::size_t>(query)] == path.from)
      path.vertex = static_cast<Index>(query);
    marks.paths.push_back(path);
  }
  return marks;
}

}  // namespace

StoredResult::StoredResult(const fs::path& path, const fs::path& after) : path_(path) {
  json_ = Json::parse(read_whole_file(path), nullptr, false);
  if (json_.is_discarded()) throw Error(path.string(), "is no JSON", "give a file that --json wrote");
  if (!json_.is_object() || !json_.contains("kind") || !json_["kind"].is_string())
    throw Error(path.string(), "is no result of selvage", "give what check, paths or resolve wrote with --json");
  kind_ = json_["kind"];
  if (json_.value("schema", 0) != 1) refuse("has another schema than 1");
  mesh = read_mesh(find(text("mesh")));
  triangles = surface_triangles(mesh);
  first_vertices_ = mesh.positions.size();
  first_triangles_ = triangles.size();
  if (kind_ == "continuous") {
    end_pose = read_pose(text("to"));
  } else if (kind_ == "resolve") {
    if (after.empty() && !has("output")) refuse("names no mesh that was written, since the mesh was not resolved");
    end_pose = read_pose(after.empty() ? fs::path(text("output")) : after);
  } else if (kind_ != "discrete" && kind_ != "near" && kind_ != "paths") {
    refuse(fmt::format("is of the kind '{}', which cannot be shown", kind_));
  }
  if (has_second()) add_second_mesh();
  if (!has("weld")) return;
  const std::vector<Index> first =
      find_first_in_place(mesh.positions, end_pose ? std::span<const Vec3>(*end_pose) : std::span<const Vec3>());
  for (auto& triangle : triangles)
    for (Index& v : triangle) v = first[static_cast<std::size_t>(v)];
}

void StoredResult::add_second_mesh() {
  const IndexedMesh second = read_mesh(find(text("against")));
  const auto shift = static_cast<Index>(first_vertices_);
  for (const auto& [a, b, c] : surface_triangles(second)) triangles.push_back({a + shift, b + shift, c + shift});
  for (std::vector<Vec3>* pose : {&mesh.positions, end_pose ? &*end_pose : nullptr})
    if (pose != nullptr) pose->insert(pose->end(), second.positions.begin(), second.positions.end());
}

std::string StoredResult::text(const char* key) const {
  if (!has(key) || !json_[key].is_string()) refuse(fmt::format("names no {}", key));
  return json_[key];
}

/// The file of that name, from here or from the folder of the result.
fs::path StoredResult::find(const fs::path& name) const {
  const fs::path beside = path_.parent_path() / name;
  return !fs::exists(name) && fs::exists(beside) ? beside : name;
}

/// Positions of the same mesh in another file.
std::vector<Vec3> StoredResult::read_pose(const fs::path& name) const {
  IndexedMesh other = read_mesh(find(name));
  if (other.tetrahedra.empty() && !mesh.tetrahedra.empty()) return place_boundary(other, name);
  if (other.positions.size() != mesh.positions.size() || surface_triangles(other) != triangles)
    throw Error(name.string(), fmt::format("has other vertices or elements than {}", text("mesh")),
                "give the same mesh in another pose");
  return std::move(other.positions);
}

/// The mesh with its boundary where a surface has it, as `resolve` writes one; what is inside is not shown.
std::vector<Vec3> StoredResult::place_boundary(const IndexedMesh& surface, const fs::path& name) const {
  const ShownSurface boundary(mesh.positions.size(), triangles);
  if (boundary.vertices.size() != surface.positions.size() || boundary.triangles != surface.triangles)
    throw Error(name.string(), fmt::format("is not the boundary of {}", text("mesh")),
                "give the mesh that resolve wrote, as .obj, .ply or .off");
  std::vector<Vec3> positions = mesh.positions;
  for (std::size_t i = 0; i < boundary.vertices.size(); ++i)
    positions[static_cast<std::size_t>(boundary.vertices[i])] = surface.positions[i];
  return positions;
}

const Json& StoredResult::list(const char* key) const {
  if (!has(key) || !json_[key].is_array()) refuse(fmt::format("has no {}", key));
  return json_[key];
}

Index StoredResult::number(const Json& items, std::size_t i, std::size_t end) const {
  if (!items.is_array() || i >= items.size() || !items[i].is_number_integer() || items[i] < 0 || items[i] >= end)
    refuse(fmt::format("does not fit the mesh {}", text("mesh")));
  return items[i];
}

Index StoredResult::vertex(const Json& items, std::size_t i, bool of_second) const {
  if (!of_second) return number(items, i, first_vertices_);
  return static_cast<Index>(first_vertices_) + number(items, i, mesh.positions.size() - first_vertices_);
}

Index StoredResult::triangle(const Json& items, std::size_t i, bool of_second) const {
  if (!of_second) return number(items, i, first_triangles_);
  return static_cast<Index>(first_triangles_) + number(items, i, triangles.size() - first_triangles_);
}

void StoredResult::refuse(const std::string& what) const {
  throw Error(path_.string(), what, "write it anew with --json, of the mesh as it is");
}

Marks StoredResult::find_marks() const {
  if (kind_ == "discrete" || kind_ == "near" || kind_ == "continuous") {
    Marks marks;
    if (kind_ != "continuous") marks = discrete_marks(*this);
    if (kind_ != "discrete") add_feature_marks(*this, marks);
    return marks;
  }
  if (kind_ == "paths") return path_marks(*this);
  if (mesh.tetrahedra.empty()) return {};
  const TetMesh solid(static_cast<Index>(mesh.positions.size()), mesh.tetrahedra);
  return MarkFinder(solid, mesh.positions).find(mesh.positions);
}

}  // namespace selvage
