#include "boundary_path/families/families.h"

#include <cmath>

namespace selvage::families {

namespace {

// A beam along x bent around the z axis; its height in y is its thickness.
Pieces<3> wound(const Pieces<3>& beam, double radians_per_unit, double radius, double pitch, double rise = 0) {
  return moved<3>(beam, [=](const Vec3& x) {
    const double angle = x[0] * radians_per_unit, r = radius + pitch * angle - x[1];
    return Vec3(r * std::cos(angle), r * std::sin(angle), x[2] + rise * angle);
  });
}

Pieces<3> twisted(const Pieces<3>& beam, double radians_per_unit, double y, double z) {
  return moved<3>(beam, [=](const Vec3& x) {
    const double c = std::cos(x[0] * radians_per_unit), s = std::sin(x[0] * radians_per_unit);
    return Vec3(x[0], y + c * (x[1] - y) - s * (x[2] - z), z + s * (x[1] - y) + c * (x[2] - z));
  });
}

Pieces<3> scaled(Pieces<3> mesh, double factor) {
  return moved<3>(std::move(mesh), [=](const Vec3& x) { return Vec3(x * factor); });
}

Pieces<3> translated(Pieces<3> mesh, const Vec3& offset) {
  return moved<3>(std::move(mesh), [=](const Vec3& x) { return Vec3(x + offset); });
}

Pieces<3> with_vertex(Pieces<3> mesh, const Vec3& from, const Vec3& to) {
  for (auto& x : mesh.positions) {
    if (x == from) x = to;
  }
  return mesh;
}

void add_plain(std::vector<Family<3>>& list) {
  list.push_back({"single", {{{0, 0, 0}, {4, 1, 0}, {1, 3, 0}, {1, 1, 5}}, {{0, 1, 2, 3}}}, true});
  list.push_back(
      {"two", {{{0, 0, 0}, {4, 0, 0}, {1, 3, 0}, {1, 1, 4}, {4, 4, 4}}, {{0, 1, 2, 3}, {1, 4, 2, 3}}}, true});
  list.push_back({"cube", grid(1, 1, 1), true});
  list.push_back({"grid", grid(4, 4, 4), true});
  list.push_back({"jittered", jittered<3>(grid(6, 5, 5), 0.16, 1)});
  list.push_back({"comb", extrude(squares({"######", "#.#.##", "#.#.#."}), 2, 1), true});
  list.push_back({"comb_jittered", jittered<3>(extrude(squares({"######", "#.#.##", "#.#.#."}), 3, 1), 0.12, 2)});
  list.push_back({"edges_only", extrude(squares({"#.#", ".#.", "#.#"}), 2, 1), true});
  list.push_back({"vertices_only", cubes({{0, 0, 0}, {1, 1, 1}, {2, 0, 0}, {0, 2, 2}, {2, 2, 0}, {2, 2, 2}}), true});
  list.push_back({"vertices_only_jittered",
                  jittered<3>(cubes({{0, 0, 0}, {1, 1, 1}, {2, 0, 0}, {0, 2, 2}, {2, 2, 0}, {1, 2, 0}}), 0.15, 3)});
}

void add_tangled(std::vector<Family<3>>& list) {
  list.push_back({"bent_beam", wound(grid(36, 2, 2), 0.25, 5, 0)});
  list.push_back({"spiral", wound(grid(44, 3, 1), 0.25, 5, 0.2)});
  list.push_back({"spiral_jittered", jittered<3>(wound(grid(40, 2, 2), 0.25, 5, 0.1, 0.05), 0.06, 4)});
  list.push_back({"twisted_bent_beam", wound(twisted(grid(36, 2, 2), 0.2, 1, 1), 0.22, 6, 0.05)});
  list.push_back({"twisted", twisted(grid(12, 3, 3), 0.4, 1.5, 1.5)});
  list.push_back({"walk_ring", cube_walk("EEENNNWWWSSSEEENNN"), true});
  list.push_back({"walk_around_edge", cube_walk("ENWSENWSEN"), true});
  list.push_back({"walk_rising", cube_walk("EENNUWWSSDEENUNWW"), true});
  for (int seed = 0; seed < 4; ++seed) {
    const auto mesh = cube_walk(random_steps(16 + 14 * seed, true, 30 + seed));
    list.push_back({"walk_random_" + std::to_string(seed), mesh, true});
    list.push_back({"walk_random_jittered_" + std::to_string(seed), jittered<3>(mesh, 0.14, 40 + seed)});
  }
  list.push_back({"overlap", together(grid(3, 3, 3), translated(grid(3, 2, 2), {1.5, 0.5, 1})), true});
  list.push_back({"overlap_same_place", together(grid(2, 2, 2), grid(2, 2, 2)), true});
  list.push_back({"overlap_jittered", together(jittered<3>(grid(4, 4, 3), 0.12, 6),
                                               jittered<3>(wound(grid(24, 2, 2), 0.3, 4, 0), 0.05, 7))});
}

void add_overwound(std::vector<Family<3>>& list) {
  list.push_back({"interior_4pi", extrude(fan(9, 2, true), 1, 2)});
  list.push_back({"interior_4pi_rings", extrude(fan(11, 2, true, 3), 2, 1.5)});
  list.push_back({"interior_4pi_jittered", jittered<3>(extrude(fan(10, 2, true, 3), 3, 1.2), 0.08, 8)});
  list.push_back({"boundary_over_2pi", extrude(fan(12, 1.6, false), 2, 1)});
  list.push_back({"boundary_over_2pi_rings", extrude(fan(12, 1.7, false, 3), 2, 1)});
  list.push_back({"boundary_over_4pi_jittered", jittered<3>(extrude(fan(17, 2.4, false, 2), 3, 1.1), 0.06, 9)});
}

void add_grown(std::vector<Family<3>>& list) {
  for (int seed = 0; seed < 4; ++seed) {
    list.push_back({"grown_" + std::to_string(seed), grown<3>(100, 50 + seed, false)});
    list.push_back({"grown_folded_" + std::to_string(seed), grown<3>(100, 60 + seed, true)});
  }
}

void add_magnitudes(std::vector<Family<3>>& list) {
  list.push_back({"slivers", moved<3>(jittered<3>(grid(4, 4, 3), 0.12, 10),
                                      [](const Vec3& x) { return Vec3(x[0], x[1], x[2] * 1e-7); })});
  list.push_back({"needles", moved<3>(jittered<3>(grid(3, 3, 3), 0.12, 11),
                                      [](const Vec3& x) { return Vec3(x[0] * 1e-6, x[1] * 1e-6, x[2]); })});
  list.push_back({"nearly_flat", moved<3>(grid(3, 3, 3), [](const Vec3& x) {
                    return Vec3(x[0] + 0.25 * x[2], x[1] - 0.5 * x[2], x[2] * 0x1p-50);
                  })});
  for (int k : {-400, -60, 60, 400}) {
    const std::string power = (k < 0 ? "minus_" : "plus_") + std::to_string(std::abs(k));
    list.push_back({"scaled_" + power, scaled(jittered<3>(cube_walk("EENNWWSSEENN"), 0.14, 12), std::ldexp(1, k))});
    list.push_back({"scaled_grid_" + power, scaled(cube_walk("ENWSENWS"), std::ldexp(1, k)), true});
  }
  list.push_back(
      {"far_away", translated(jittered<3>(wound(grid(36, 2, 1), 0.25, 5, 0.1), 0.04, 13), {1e6, -1e6, 1e6})});
  list.push_back({"far_away_grid", translated(cube_walk("EENNWWSSEENN"), {1e6, -1e6, 1e6}), true});
}

void add_inverted(std::vector<Family<3>>& list) {
  list.push_back({"inverted_inside", with_vertex(grid(4, 4, 4), {2, 2, 2}, {3.3, 2.4, 2.2})});
  list.push_back({"inverted_inside_exact", with_vertex(grid(3, 3, 3), {1, 1, 1}, {3, 1, 1}), true});
  list.push_back({"inverted_out_of_surface", with_vertex(grid(3, 3, 3), {1, 1, 1}, {4.3, 1.2, 1.4})});
  list.push_back({"inverted_boundary", with_vertex(grid(3, 3, 3), {1, 1, 0}, {1.2, 1.1, 1.7})});
  list.push_back({"flat_inside", with_vertex(grid(4, 4, 4), {2, 2, 2}, {3, 2, 2}), true});
  list.push_back({"flat_boundary", with_vertex(grid(3, 3, 2), {1, 1, 0}, {1, 1, 1}), true});
  list.push_back({"many_inverted", jittered<3>(grid(5, 4, 4), 0.5, 14)});
  list.push_back({"many_inverted_exact",
                  [] {
                    Random random(15);
                    return moved<3>(grid(4, 3, 3), [&](const Vec3& x) {
                      return Vec3(x + Vec3{random.below(3) - 1.0, random.below(3) - 1.0, random.below(3) - 1.0});
                    });
                  }(),
                  true});
  // Elements around the core are drawn right through it, so that lines meet many.
  const auto turn_core = [](const Vec3& x) {
    const Vec3 from_middle = x - Vec3::Constant(3);
    return from_middle.cwiseAbs().maxCoeff() <= 1.2 ? Vec3(Vec3::Constant(3) - from_middle) : x;
  };
  list.push_back({"inverted_core", moved<3>(jittered<3>(grid(6, 6, 6), 0.12, 17), turn_core)});
  list.push_back({"inverted_bent_beam", jittered<3>(wound(grid(32, 2, 2), 0.25, 4.5, 0), 0.3, 16)});
  list.push_back({"mirrored", moved<3>(grid(2, 2, 2), [](const Vec3& x) { return Vec3(-x[0], x[1], x[2]); }), true});
}

}  // namespace

const std::vector<Family<3>>& solid_families() {
  static const std::vector<Family<3>> families = [] {
    std::vector<Family<3>> list;
    add_plain(list);
    add_tangled(list);
    add_overwound(list);
    add_grown(list);
    add_magnitudes(list);
    add_inverted(list);
    return list;
  }();
  return families;
}

}  // namespace selvage::families
