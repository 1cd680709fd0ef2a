#include "page/mesh_page.h"

#include "page/pose_blocks.h"
#include "selvage/core/error.h"

#include <fmt/format.h>

namespace selvage {

void add_mesh(Page& page, const IndexedMesh& mesh, const std::vector<Vec3>* other_pose, const Marks& marks) {
  const auto triangles = surface_triangles(mesh);
  const ShownSurface surface(mesh.positions.size(), triangles);
  page.add_fact("mesh", "vertices", fmt::format("{}", mesh.positions.size()));
  if (!mesh.tetrahedra.empty()) page.add_fact("mesh", "tetrahedra", fmt::format("{}", mesh.tetrahedra.size()));
  page.add_fact("mesh", mesh.tetrahedra.empty() ? "triangles" : "boundary triangles",
                fmt::format("{}", triangles.size()));
  add_surface(page, surface);
  PoseBox box;
  for (const Index v : surface.vertices) {
    box.add(mesh.positions[static_cast<std::size_t>(v)]);
    if (other_pose != nullptr) box.add((*other_pose)[static_cast<std::size_t>(v)]);
  }
  const Vec3 size = box.upper - box.lower;
  page.add_fact("mesh", "size [m]", fmt::format("{:.4g} x {:.4g} x {:.4g}", size[0], size[1], size[2]));
  page.head()["marked"] = nlohmann::ordered_json::array();
  PoseBlocks poses(page, surface, box);
  poses.add(mesh.positions, 0);
  add_marks(page, surface, 0, marks);
  if (other_pose != nullptr) poses.add(*other_pose, 1);
  poses.finish();
  if (page.block_length() > kMaxPageLength)
    throw Error({}, fmt::format("the page would be larger than {} MB", kMaxPageLength / 1'000'000),
                "show a coarser mesh");
}

std::string print_mesh_page(const std::filesystem::path& path) {
  const IndexedMesh mesh = read_mesh(path);
  Page page("mesh", path.filename().string());
  add_mesh(page, mesh, nullptr, {});
  return page.print();
}

}  // namespace selvage
