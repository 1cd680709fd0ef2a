#include "cli/arguments/mesh_input.h"
#include "cli/program/command.h"
#include "cli/program/console.h"
#include "cli/program/json_text.h"
#include "cli/program/memory.h"
#include "cli/program/output.h"
#include "cli/reports/components.h"
#include "cli/reports/quality.h"
#include "core/json.h"
#include "selvage/boundary_path/boundary_path.h"
#include "selvage/geometry/predicates.h"
#include "selvage/mesh/triangle_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

namespace selvage::cli {

namespace {

struct InfoOptions {
  CommonOptions common;
  std::string mesh;
};

constexpr const char* kInfoExample =
    "  selvage make octopus -o octopus.vtu\n"
    "  selvage info octopus.vtu\n"
    "  selvage info octopus.vtu --json - | jq .volume\n"
    "\n"
    "The radius ratio of an element is 1 where it is regular and 0 where it is flat. Inverted elements have negative "
    "volume. Around an overwound ridge the elements turn more than once. For their effect on shortest paths see "
    "docs/how_it_works/boundary_path.md.";

std::int64_t count_unused(const IndexedMesh& file) {
  std::vector<char> used(file.positions.size(), 0);
  for (const auto& element : file.tetrahedra) {
    for (const Index v : element) used[v] = 1;
  }
  for (const auto& element : file.triangles) {
    for (const Index v : element) used[v] = 1;
  }
  return std::count(used.begin(), used.end(), 0);
}

/// Topology of a solid or planar mesh, and what is wrong with its pose.
template <int D>
void describe_simplices(const SimplexMesh<D>& mesh, std::span<const Vec<D>> positions, Json& info) {
  info["components"] = count_components(mesh);
  info["boundary_faces"] = mesh.boundary_face_count();
  info["boundary_ridges"] = mesh.boundary_ridges().size();
  info["boundary_vertices"] = mesh.boundary_vertices().size();
  info["boundary_components"] = count_boundary_components(mesh);
  const MeshDefects defects = BoundaryPathFinder<D>(mesh, positions).defects();
  info["inverted_elements"] = defects.inverted_elements;
  info["degenerate_elements"] = defects.degenerate_elements;
  info["overwound_interior_ridges"] = defects.overwound_interior_ridges;
  info["overwound_boundary_ridges"] = defects.overwound_boundary_ridges;
}

/// Whether the three points lie exactly on one line: then they do in each of the three projections.
bool is_degenerate(const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto flat = [&](int i, int j) { return orient2d({a[i], a[j]}, {b[i], b[j]}, {c[i], c[j]}) == 0; };
  return flat(0, 1) && flat(1, 2) && flat(2, 0);
}

void describe_surface(const IndexedMesh& file, Json& info) {
  const TriangleMesh mesh(static_cast<Index>(file.positions.size()), file.triangles);
  std::int64_t border = 0, non_manifold = 0, degenerate = 0;
  for (Index e = 0; e < mesh.edge_count(); ++e) {
    border += mesh.edge_triangles(e).size() == 1;
    non_manifold += mesh.edge_triangles(e).size() > 2;
  }
  for (const auto& [a, b, c] : file.triangles) {
    degenerate += is_degenerate(file.positions[a], file.positions[b], file.positions[c]);
  }
  info["edges"] = mesh.edge_count();
  info["border_edges"] = border;
  info["non_manifold_edges"] = non_manifold;
  info["components"] = count_components(mesh);
  info["degenerate_elements"] = degenerate;
  if (is_planar(file) && non_manifold == 0) {
    const PlanarMesh planar(static_cast<Index>(file.positions.size()), file.triangles);
    describe_simplices<2>(planar, drop_z(file.positions), info);
  }
}

void describe_shape(const IndexedMesh& file, bool solid, Json& info) {
  Vec3 lower = file.positions[0], upper = lower;
  for (const Vec3& p : file.positions) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  info["bounding_box"] = {{"lower", {lower[0], lower[1], lower[2]}}, {"upper", {upper[0], upper[1], upper[2]}}};
  const Quality quality =
      solid ? measure_quality(file.positions, file.tetrahedra) : measure_quality(file.positions, file.triangles);
  info[solid ? "volume" : "area"] = quality.measure;
  info["quality"] = {{"smallest_angle", quality.smallest_angle},
                     {"mean_smallest_angle", quality.mean_smallest_angle},
                     {"largest_angle", quality.largest_angle},
                     {"worst_radius_ratio", quality.worst_ratio},
                     {"mean_radius_ratio", quality.mean_ratio}};
}

std::string readable(const std::string& name) {
  std::string text = name;
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

void print_info(const Json& info) {
  Table table;
  for (const auto& [name, value] : info.items()) {
    if (name == "schema" || name == "seconds" || name == "kind") continue;
    if (value.is_number_integer()) {
      table.add(readable(name), grouped(value));
    } else if (value.is_number()) {
      table.add(readable(name), fmt::format("{:.6g} {}", value.get<double>(), name == "area" ? "m^2" : "m^3"));
    } else if (value.is_string()) {
      table.add(readable(name), value.get<std::string>());
    }
  }
  const auto corner = [&](const char* which) {
    const auto p = info["bounding_box"][which].get<std::array<double, 3>>();
    return fmt::format("{:.6g} {:.6g} {:.6g} m", p[0], p[1], p[2]);
  };
  const auto quality = [&](const char* which) { return info["quality"][which].get<double>(); };
  table.add("bounding box", fmt::format("from {} to {}", corner("lower"), corner("upper")));
  table.add(info.contains("tetrahedra") ? "dihedral angles" : "angles",
            fmt::format("{:.2f} to {:.2f} degrees; the smallest angle of an element is {:.2f} on average",
                        quality("smallest_angle"), quality("largest_angle"), quality("mean_smallest_angle")));
  table.add("radius ratio", fmt::format("{:.4f} at worst, {:.4f} on average", quality("worst_radius_ratio"),
                                        quality("mean_radius_ratio")));
  table.print();
}

void run_info(const InfoOptions& options) {
  Stopwatch watch;
  take_large_pages();
  OutputFiles outputs;
  outputs.expect(options.common.json, files_of_mesh(options.mesh));
  const IndexedMesh file = read_mesh(options.mesh);
  watch.lap("read");

  const bool solid = !file.tetrahedra.empty();
  Json info{{"schema", 1}, {"kind", "info"}, {"mesh", options.mesh}};
  info["vertices"] = file.positions.size();
  info["unused_vertices"] = count_unused(file);
  if (solid) info["tetrahedra"] = file.tetrahedra.size();
  if (!file.triangles.empty()) info["triangles"] = file.triangles.size();
  if (solid) {
    const TetMesh mesh(static_cast<Index>(file.positions.size()), file.tetrahedra);
    describe_simplices<3>(mesh, file.positions, info);
  } else {
    describe_surface(file, info);
  }
  describe_shape(file, solid, info);
  watch.lap("describe");
  for (const auto& [phase, seconds] : watch.laps()) info["seconds"][phase] = seconds;

  outputs.write_text(options.common.json, json_text(info) + "\n");
  outputs.commit();
  if (!options.common.quiet && !outputs.uses_standard_output()) print_info(info);
}

}  // namespace

Command add_info(CLI::App& app) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* sub =
      add_subcommand(app, "info",
                     "Prints the contents of a mesh file: counts, boundary, components, inverted and degenerate "
                     "elements, overwound ridges, bounding box, quality.",
                     kInfoExample);
  sub->add_option("mesh", options->mesh, "Mesh file")->required()->type_name("MESH");
  return {sub, &options->common, [options] {
            run_info(*options);
            return kDone;
          }};
}

}  // namespace selvage::cli
