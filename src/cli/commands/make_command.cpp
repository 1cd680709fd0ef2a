#include "cli/arguments/pose_argument.h"
#include "cli/program/command.h"
#include "cli/program/console.h"
#include "cli/program/json_text.h"
#include "cli/program/output.h"
#include "selvage/core/error.h"
#include "selvage/io/mesh_file.h"
#include "selvage/mesh/triangle_mesh.h"
#include "selvage/shapes/shapes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <memory>

namespace selvage::cli {

namespace {

struct MakeOptions {
  CommonOptions common;
  std::string shape, curve, output;
  std::vector<double> size;
  ShapeOptions measures;
  std::vector<std::string> poses;
  bool centre = false, ascii = false, binary = false;
};

constexpr const char* kMakeExample =
    "  selvage make octopus --elements 30000 --pose swirl -o octopus.vtu\n"
    "  selvage make rod --length 8 --pose self-crossing,crossings=1 -o noodle.t\n"
    "  selvage make octopus.vtu --pose overlap --centre -o two.vtu\n"
    "\n"
    "Shapes, with their options and defaults:\n"
    "  box              --size 1 1 1\n"
    "  beam             --size 6 0.5 0.5\n"
    "  rod              --length 6 --radius 0.25\n"
    "  trefoil          --length 20 --radius 0.25\n"
    "  nested-knot      --length 60 --radius 0.25\n"
    "  noodle           --length 60 --radius 0.1\n"
    "  overhand         --length 30 --radius 0.25\n"
    "  nested-overhand  --length 120 --radius 0.25\n"
    "  ball             --radius 1\n"
    "  torus            --radius 1 --inner-radius 0.3\n"
    "  tube             --length 4 --radius 0.3 --inner-radius 0.2\n"
    "  squishy-ball     --radius 1 --tentacles 200 --seed 1 --slenderness 1\n"
    "  octopus          --radius 1 --seed 1 --slenderness 1\n"
    "  gear             --length 0.3 --radius 1 --inner-radius 0.3 --teeth 12\n"
    "  cloth            --size 2 2\n"
    "  sleeve           --length 0.6 --radius 0.1\n"
    "\n"
    "Where they lie; --centre moves the middle of any of them to the origin:\n"
    "  box, beam        a corner at the origin, along x, y and z\n"
    "  cloth            a corner at the origin, in the plane z = 0\n"
    "  rod              from the origin along x\n"
    "  overhand, nested-overhand\n"
    "                   along x, the middle of the rope at x = 0\n"
    "  tube, gear, sleeve\n"
    "                   from the plane z = 0 upwards, around the z axis\n"
    "  noodle           a coil around the z axis, its middle line from z = 0 upwards\n"
    "  trefoil, nested-knot, torus\n"
    "                   around the origin, flat along z\n"
    "  ball, octopus    around the origin, as far as --radius\n"
    "  squishy-ball     around the origin, twice as far as --radius\n"
    "\n"
    "Poses, with their defaults; without an axis, the longest one of the mesh:\n"
    "  twist,turns=1   bend,turns=1.25   fold,angle=4.2   self-crossing,crossings=2\n"
    "  swirl,turns=0.15,core=0.5   overlap: a copy, a third of its size away\n"
    "  twist also throws a loop through the mesh, which must be long and thin for it;\n"
    "  twist,crossings=0 only turns it";

/// The name under which the library knows the shape: a bent rod has the name of its curve.
std::string shape_name(const MakeOptions& options) {
  if (options.curve.empty()) return options.shape;
  if (options.shape != "rod") throw Error("--curve", "only a rod has a curve", "leave it out");
  return std::string(shape_along_curve(options.curve));
}

/// Whether a mesh file is named where a shape could be: shapes have no extension.
bool is_file(const MakeOptions& options) {
  return std::filesystem::path(options.shape).has_extension();
}

/// A mesh of the user's own, for which there is nothing to measure.
IndexedMesh read_own_mesh(const MakeOptions& options) {
  const ShapeOptions& m = options.measures;
  const std::pair<bool, const char*> given[] = {{m.elements.has_value(), "--elements"},
                                                {m.cell.has_value(), "--cell"},
                                                {!options.size.empty(), "--size"},
                                                {m.length.has_value(), "--length"},
                                                {m.radius.has_value(), "--radius"},
                                                {m.inner_radius.has_value(), "--inner-radius"},
                                                {!options.curve.empty(), "--curve"},
                                                {m.tentacles.has_value(), "--tentacles"},
                                                {m.teeth.has_value(), "--teeth"},
                                                {m.seed.has_value(), "--seed"},
                                                {m.slenderness.has_value(), "--slenderness"}};
  for (const auto& [is_given, option] : given)
    if (is_given) throw Error(option, "is for shapes, not for a mesh of your own", "leave it out");
  return read_mesh(options.shape);
}

void set_size(MakeOptions& options) {
  if (options.size.empty()) return;
  const std::size_t lengths = options.shape == "cloth" ? 2 : 3;
  if (options.size.size() != lengths)
    throw Error("--size", fmt::format("{} lengths for the shape '{}'", options.size.size(), options.shape),
                fmt::format("give {}", lengths));
  Vec3 size = Vec3::Zero();
  for (std::size_t i = 0; i < options.size.size(); ++i) size[static_cast<int>(i)] = options.size[i];
  options.measures.size = size;
}

FileEncoding encoding_of(const MakeOptions& options) {
  if (options.ascii) return FileEncoding::kAscii;
  return options.binary ? FileEncoding::kBinary : FileEncoding::kUsual;
}

void run_make(MakeOptions& options) {
  Stopwatch watch;
  std::vector<PoseArgument> poses;
  for (const std::string& text : options.poses) poses.push_back(parse_pose(text));
  OutputFiles outputs;
  if (options.output == "-") throw Error("-o", "a mesh cannot be written to standard output", "name a file");
  const bool is_own = is_file(options);
  std::vector<std::filesystem::path> inputs;
  if (is_own) inputs = files_of_mesh(options.shape);
  for (const auto& file : files_of_mesh(options.output)) outputs.expect(file.string(), inputs);
  outputs.expect(options.common.json, inputs);

  if (!is_own) set_size(options);
  const std::string name = is_own ? options.shape : shape_name(options);
  IndexedMesh mesh = is_own ? read_own_mesh(options) : make_shape(name, options.measures);
  watch.lap(is_own ? "read" : "make");
  const bool as_surface = !mesh.tetrahedra.empty() && !holds_tetrahedra(options.output);
  if (is_own && !as_surface) check_format_holds(options.output, mesh);
  for (const PoseArgument& pose : poses) apply_pose(mesh, pose.name, pose.options);
  if (options.centre) centre_at_origin(mesh.positions);
  if (as_surface)
    mesh =
        boundary_mesh(TetMesh(static_cast<Index>(mesh.positions.size()), std::move(mesh.tetrahedra)), mesh.positions);
  watch.lap("pose");

  nlohmann::ordered_json result{{"schema", 1},
                                {"kind", "make"},
                                {"shape", name},
                                {"poses", options.poses},
                                {"mesh", options.output},
                                {"vertices", mesh.positions.size()},
                                {"tetrahedra", mesh.tetrahedra.size()},
                                {"triangles", mesh.triangles.size()}};
  outputs.write_mesh(options.output, mesh, encoding_of(options));
  watch.lap("write");
  for (const auto& [phase, seconds] : watch.laps()) result["seconds"][phase] = seconds;
  outputs.write_text(options.common.json, json_text(result) + "\n");
  outputs.commit();
  if (options.common.quiet || outputs.uses_standard_output()) return;
  const bool solid = !mesh.tetrahedra.empty();
  fmt::print("{}: {} vertices, {} {} in {}\n", options.output,
             grouped(static_cast<std::int64_t>(mesh.positions.size())),
             grouped(static_cast<std::int64_t>(solid ? mesh.tetrahedra.size() : mesh.triangles.size())),
             solid ? "tetrahedra" : "triangles", readable_seconds(watch.total()));
}

void add_measures(CLI::App& app, MakeOptions& options) {
  ShapeOptions& m = options.measures;
  app.add_option("--elements", m.elements, "Approximate number of elements")->type_name("N");
  app.add_option("--cell", m.cell, "Approximate edge length [m]")
      ->excludes(app.get_option("--elements"))
      ->type_name("D");
  app.add_option("--size", options.size, "Box, beam: three lengths; cloth: two [m]")
      ->expected(2, 3)
      ->type_name("X Y [Z]");
  app.add_option("--length", m.length, "Rods, tube, gear, sleeve [m]")->type_name("D");
  app.add_option("--radius", m.radius,
                 "Rods, balls, sleeve, tube (outer), torus (major), gear (tips), octopus (reach) [m]")
      ->type_name("D");
  app.add_option("--inner-radius", m.inner_radius, "Tube (inner), torus (minor), gear (hole) [m]")->type_name("D");
  app.add_option("--curve", options.curve, "Rod: the curve it follows: straight, coil, or a knot of the list below")
      ->check(CLI::IsMember(std::vector<std::string>(curve_names().begin(), curve_names().end())))
      ->type_name("NAME");
  app.add_option("--tentacles", m.tentacles, "Squishy ball: number of tentacles")->type_name("N");
  app.add_option("--teeth", m.teeth, "Gear: number of teeth")->type_name("N");
  app.add_option("--seed", m.seed, "Octopus, squishy ball: seed of the random shape")->type_name("N");
  app.add_option("--slenderness", m.slenderness,
                 "Octopus, squishy ball: 1 or more; the larger, the thinner and longer the arms")
      ->type_name("S");
}

}  // namespace

Command add_make(CLI::App& app) {
  auto options = std::make_shared<MakeOptions>();
  CLI::App* sub = add_subcommand(
      app, "make", "Makes a mesh of a named shape, or takes one of yours. Poses bend, twist or tangle it.",
      kMakeExample);
  sub->add_option("shape", options->shape,
                  fmt::format("One of {}; or a mesh file of your own", fmt::join(shape_names(), ", ")))
      ->required()
      ->type_name("SHAPE");
  sub->add_option("-o,--output", options->output,
                  "Mesh file to write; its extension tells the format: of the boundary, where it holds surfaces only")
      ->required()
      ->type_name("MESH");
  add_measures(*sub, *options);
  sub->add_option(
         "--pose", options->poses,
         fmt::format("Pose of the mesh: NAME[,KEY=VALUE]..., NAME one of {}, with axis=x|y|z, turns=, angle= [rad], "
                     "crossings=, core=, dx= dy= dz= [m] where the pose has them; several poses are applied in turn",
                     fmt::join(pose_names(), ", ")))
      ->take_all()
      ->expected(1)
      ->type_name("POSE");
  sub->add_flag("--centre", options->centre, "Move the middle of the posed mesh to the origin");
  auto* ascii = sub->add_flag("--ascii", options->ascii, "Write text where the format has text and binary");
  sub->add_flag("--binary", options->binary, "Write binary where the format has both; the default, except for .off")
      ->excludes(ascii);
  return {sub, &options->common, [options] {
            run_make(*options);
            return kDone;
          }};
}

}  // namespace selvage::cli
