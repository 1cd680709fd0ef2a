#pragma once

#include <filesystem>
#include <string>

namespace selvage {

/// The page of what `check`, `paths` or `resolve` wrote with --json: the mesh that it names, pairs of triangles or ways
/// out, and for `resolve` the mesh before and after.
///
/// A mesh's name is looked up from the working folder, and where there is no such file, beside the JSON.
/// @param after  mesh that `resolve` wrote; empty: the one that the result names
/// @throws Error  when the file is no such result, a mesh is missing, or does not fit what was found in it
std::string print_result_page(const std::filesystem::path& path, const std::filesystem::path& after = {});

}  // namespace selvage
