#pragma once

#include "selvage/core/types.h"

#include <filesystem>

namespace selvage::cli {

/// Reads a list of vertices: one number a line, from 0. Empty lines and lines that begin with '#' are passed over.
///
/// @param vertex_count  vertices must lie in [0, vertex_count)
/// @throws Error        names file and line: no number, or out of range
std::vector<Index> read_vertices(const std::filesystem::path& path, Index vertex_count);

}  // namespace selvage::cli
