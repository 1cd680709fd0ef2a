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

  const std::string& kind() const { return kind_; }  ///< "discrete", "continuous", "paths" or "resolve"
  const Json& json() const { return json_; }
  bool has(const char* key) const { return json_.contains(key); }
  std::string text(const char* key) const;
  /// A list that the result must have.
  const Json& list(const char* key) const;
  /// Item i of a list of whole numbers from 0 to below `end`.
  Index number(const Json& items, std::size_t i, std::size_t end) const;

  /// Pairs of triangles, or ways out; of `resolve` those of the mesh before, which are searched for.
  /// @throws Error  where they do not fit the mesh
  Marks find_marks() const;

  [[noreturn]] void refuse(const std::string& what) const;

  IndexedMesh mesh;
  std::vector<VertexTuple<3>> triangles;      ///< the surface, in the order in which `check` numbers it
  std::optional<std::vector<Vec3>> end_pose;  ///< of `check --to` the end of the step, of `resolve` the mesh after

 private:
  std::filesystem::path find(const std::filesystem::path& name) const;
  std::vector<Vec3> read_pose(const std::filesystem::path& name) const;

  std::filesystem::path path_;
  Json json_;
  std::string kind_;
};

}  // namespace selvage
