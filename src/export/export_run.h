#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace selvage {

/// A file to be written.
struct ExportedFile {
  std::filesystem::path path;
  std::string bytes;
};

/// The boundary of a run in all its frames, in the format of the extension:
///
///   .pc2   positions, for the mesh of a .obj beside it of the same name (Blender's and 3ds Max' mesh cache)
///   .glb   glTF 2.0: a mesh with one morph target a frame after the first, and the animation of their weights
///   .usda  USD: a mesh with time samples of its points
///
/// Vertices are those of the boundary in ascending order, bodies one after the other in one mesh. Lengths are metres, z
/// points up; in glTF, in which y does, a rotation of the node says so.
///
/// @param run    its folder
/// @param path   of the file
/// @param every  leave out frames whose number is no multiple of it, but for the last
/// @throws Error  when the extension is another one, or as StoredRun
std::vector<ExportedFile> export_run(const std::filesystem::path& run, const std::filesystem::path& path,
                                     std::int64_t every);

/// Files that export_run() gives, without reading the run.
/// @throws Error  when the extension is none of these
std::vector<std::filesystem::path> files_of_export(const std::filesystem::path& path);

}  // namespace selvage
