#include "cli/arguments/checked_surface.h"

#include "cli/arguments/numbers.h"
#include "core/parallel.h"
#include "selvage/core/error.h"
#include "selvage/mesh/weld.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <fstream>
#include <utility>

namespace selvage::cli {

namespace {

/// Reads the mesh, and beside it the positions at the end of the step: of a mesh that is the same but for them.
std::pair<IndexedMesh, std::vector<Vec3>> read_poses(const std::string& start_file, const std::string& end_file) {
  IndexedMesh start, end;
  if (end_file.empty()) return {read_mesh(start_file), {}};
  std::exception_ptr wrong_with_end;  // said only where nothing is wrong with the start
  parallel_invoke([&] { start = read_mesh(start_file); },
                  [&] {
                    try {
                      end = read_mesh(end_file);
                    } catch (...) {
                      wrong_with_end = std::current_exception();
                    }
                  });
  if (wrong_with_end) std::rethrow_exception(wrong_with_end);
  if (end.positions.size() != start.positions.size())
    throw Error(end_file,
                fmt::format("has {} vertices, and {} has {}", end.positions.size(), start_file, start.positions.size()),
                "give two poses of one mesh");
  if (end.triangles != start.triangles || end.tetrahedra != start.tetrahedra)
    throw Error(end_file, fmt::format("has other elements than {}", start_file), "give two poses of one mesh");
  return {std::move(start), std::move(end.positions)};
}

/// Whether each triangle has vertices of its own, and most of these are in one place with others, as in an STL.
bool shares_nothing(const IndexedMesh& mesh) {
  std::vector<char> used(mesh.positions.size(), 0);
  for (const auto& triangle : mesh.triangles)
    for (const Index v : triangle)
      if (std::exchange(used[v], 1)) return false;
  const std::vector<Index> first = find_first_in_place(mesh.positions);
  std::int64_t joined = 0;
  for (std::size_t v = 0; v < first.size(); ++v) joined += used[v] && first[v] != static_cast<Index>(v);
  return 2 * joined >= std::count(used.begin(), used.end(), 1);
}

std::vector<Index> read_group_file(const std::string& path, const CheckedSurface& surface) {
  std::ifstream file(path);
  if (!file) throw Error(path, "cannot be read", "check the name, or give pieces or names");
  std::vector<Index> groups;
  std::string text;
  for (int line = 1; std::getline(file, text); ++line) {
    const std::string_view content = trim(std::string_view(text).substr(0, text.find('#')));
    if (content.empty()) continue;
    const auto group = read_number<Index>(content);
    if (!group || *group < kNone)
      throw Error(fmt::format("{}:{}", path, line), fmt::format("'{}' is not the number of a group", content),
                  "write one from 0 on each line, or -1");
    groups.push_back(*group);
  }
  std::vector<Index> of_triangles;
  Index faces = 0;
  for (Index t = 0; t < surface.surface.triangle_count(); ++t) {
    const Index face = surface.face_of(t);
    faces = std::max(faces, face + 1);
    of_triangles.push_back(face < std::ssize(groups) ? groups[face] : kNone);
  }
  // Faces without area at the end of a file may have gone with a weld.
  if (std::ssize(groups) < faces || (std::ssize(groups) > faces && surface.numbers.empty()))
    throw Error(path, fmt::format("has {} lines, and {} has {} faces", groups.size(), surface.file, faces),
                "write one line for each face");
  return of_triangles;
}

}  // namespace

CheckedSurface read_checked_surface(const std::string& file, const std::string& end, bool weld, Stopwatch& watch) {
  auto [mesh, end_positions] = read_poses(file, end);
  watch.lap("read");
  CheckedSurface surface{.file = file, .is_solid = !mesh.tetrahedra.empty(), .positions = {}};
  const auto vertex_count = static_cast<Index>(mesh.positions.size());
  if (surface.is_solid) {
    if (weld) throw Error(file, "is a mesh of tetrahedra, whose vertices are joined", "leave out --weld");
    surface.surface = boundary_surface(TetMesh(vertex_count, std::move(mesh.tetrahedra)));
  } else {
    if (weld) {
      surface.numbers = weld_triangles(mesh, find_first_in_place(mesh.positions, end_positions));
      surface.is_welded = true;
      if (mesh.triangles.empty()) throw Error(file, "has no triangle with three corners apart", "check the mesh");
    } else {
      surface.shares_nothing = shares_nothing(mesh);
    }
    surface.faces = std::move(mesh.faces);
    surface.groups = std::move(mesh.groups);
    surface.surface = {vertex_count, std::move(mesh.triangles)};
  }
  surface.positions = std::move(mesh.positions);
  surface.end_positions = std::move(end_positions);
  watch.lap("topology");
  return surface;
}

std::vector<Index> read_groups(const std::string& how, const CheckedSurface& surface) {
  if (how == "pieces") return connected_pieces(surface.surface);
  if (how != "names") return read_group_file(how, surface);
  if (surface.groups.empty())
    throw Error(surface.file, "names no groups", "use an .obj file with 'o' or 'g' lines, or --groups pieces");
  return surface.groups;
}

}  // namespace selvage::cli
