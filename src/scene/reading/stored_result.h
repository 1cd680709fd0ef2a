#pragma once

#include "core/json.h"
#include "scene/reading/marks.h"
#include "selvage/io/mesh_file.h"

#include <filesystem>
#include <optional>
#include <string>

namespace selvage {

/// The JSON that `check`, `paths` or `resolve` wrote with --json, and the meshes that it names.
///
/// A mesh's name is looked up from the working folder, and where there is no such file, beside the JSON.
class StoredResult {
 public:
  /// @param after  mesh that `resolve` wrote; empty: the one that the result names
  /// @throws Error  when the file is no such result, a mesh is missing, or two meshes differ in more than positions
  explicit StoredResult(const std::filesystem::path& path, const std::filesystem::path& after = {});

  const std::string& kind() const { return kind_; }  ///< "discrete", "near", "continuous", "paths" or "resolve"
  const Json& json() const { return json_; }
  bool has(const char* key) const { return json_.contains(key); }
  std::string text(const char* key) const;
  /// A list that the result must have.
  const Json& list(const char* key) const;
  /// Item i of a list of whole numbers from 0 to below `end`.
  Index number(const Json& items, std::size_t i, std::size_t end) const;

  /// The number of a vertex or a triangle in `mesh`, from an item that is of the first mesh or the second.
  Index vertex(const Json& items, std::size_t i, bool of_second = false) const;
  Index triangle(const Json& items, std::size_t i, bool of_second = false) const;
  bool has_second() const { return has("against"); }

  /// Pairs of triangles, or ways out; of `resolve` those of the mesh before, which are searched for.
  /// @throws Error  where they do not fit the mesh
  Marks find_marks() const;

  [[noreturn]] void refuse(const std::string& what) const;

  IndexedMesh mesh;                           ///< of `check --against` the second behind the first
  std::vector<VertexTuple<3>> triangles;      ///< the surface, in the order in which `check` numbers it
  std::optional<std::vector<Vec3>> end_pose;  ///< of `check --to` the end of the step, of `resolve` the mesh after

 private:
  void add_second_mesh();
  std::filesystem::path find(const std::filesystem::path& name) const;
  std::vector<Vec3> read_pose(const std::filesystem::path& name) const;
  std::vector<Vec3> place_boundary(const IndexedMesh& surface, const std::filesystem::path& name) const;

  std::filesystem::path path_;
  Json json_;
  std::string kind_;
  std::size_t first_vertices_ = 0, first_triangles_ = 0;  ///< of the first mesh
};

}  // namespace selvage
