#include "boundary_path/families/families.h"

#include <cmath>

namespace selvage::families {

namespace {

// A strip along x wound around the origin: `pitch` of the radius a radian, the strip's width is its height.
Pieces<2> wound(const Pieces<2>& strip, double radians_per_unit, double radius, double pitch) {
  return moved<2>(strip, [=](const Vec2& x) {
    const double angle = x[0] * radians_per_unit, r = radius + pitch * angle - x[1];
    return Vec2(r * std::cos(angle), r * std::sin(angle));
  });
}

// A strip along x laid along a figure of eight.
Pieces<2> figure_eight(const Pieces<2>& strip, double length) {
  return moved<2>(strip, [=](const Vec2& x) {
    const double t = 0.15 + 6.0 * x[0] / length;
    const Vec2 centre(9 * std::sin(t), 5 * std::sin(2 * t));
    const Vec2 along(9 * std::cos(t), 10 * std::cos(2 * t));
    return Vec2(centre + Vec2(-along[1], along[0]) * (x[1] - 1) / along.norm());
  });
}

Pieces<2> scaled(Pieces<2> mesh, double factor) {
  return moved<2>(std::move(mesh), [=](const Vec2& x) { return Vec2(x * factor); });
}

Pieces<2> translated(Pieces<2> mesh, double x, double y) {
  return moved<2>(std::move(mesh), [=](const Vec2& v) { return Vec2(v + Vec2(x, y)); });
}

Pieces<2> with_vertex(Pieces<2> mesh, Index vertex, double x, double y) {
  mesh.positions[vertex] = {x, y};
  return mesh;
}

void add_plain(std::vector<Family<2>>& list) {
  list.push_back({"single", {{{0, 0}, {4, 1}, {1, 3}}, {{0, 1, 2}}}, true});
  list.push_back({"two", {{{0, 0}, {4, 0}, {1, 3}, {5, 4}}, {{0, 1, 2}, {1, 3, 2}}}, true});
  list.push_back({"grid", grid(8, 8), true});
  list.push_back({"grid_diamonds", grid(9, 7, true), true});
  list.push_back({"jittered", jittered<2>(grid(14, 12), 0.24, 1)});
  list.push_back({"comb", squares({"##########", "#.#.#.#.#.", "#.#.#.#.#.", "###.#.#.##"}), true});
  list.push_back(
      {"comb_jittered", jittered<2>(squares({"##########", "#.#.#.#.#.", "#.#.#.#.#.", "###.#.#.##"}), 0.24, 2)});
  list.push_back({"checkerboard", squares({"#.#.#", ".#.#.", "#.#.#", ".#.#."}), true});
  list.push_back({"checkerboard_jittered", jittered<2>(squares({"#.#.#", ".#.#.", "#.#.#", ".#.#."}), 0.2, 3)});
}

void add_tangled(std::vector<Family<2>>& list) {
  list.push_back({"spiral", wound(grid(60, 3), 0.25, 5, 0.2)});
  list.push_back({"spiral_jittered", jittered<2>(wound(grid(70, 4), 0.22, 7, 0.1), 0.1, 4)});
  list.push_back({"ring_over_itself", wound(grid(48, 2), 0.2, 6, 0)});
  list.push_back({"figure_eight", figure_eight(grid(80, 2), 80)});
  list.push_back({"figure_eight_jittered", jittered<2>(figure_eight(grid(90, 2, true), 90), 0.08, 5)});
  list.push_back({"walk_ring", walk("EEENNNWWWSSSEEENNNWWWSSSEE"), true});
  list.push_back({"walk_around_corner", walk("ENWSENWSEN"), true});
  list.push_back({"walk_stairs", walk("EENEENWWSWWSEENENWN"), true});
  for (int seed = 0; seed < 4; ++seed) {
    const auto mesh = walk(random_steps(30 + 20 * seed, false, 10 + seed));
    list.push_back({"walk_random_" + std::to_string(seed), mesh, true});
    list.push_back({"walk_random_jittered_" + std::to_string(seed), jittered<2>(mesh, 0.2, 20 + seed)});
  }
  list.push_back({"overlap", together(grid(6, 6), translated(grid(5, 4), 1.5, 2.5)), true});
  list.push_back({"overlap_same_place", together(grid(4, 4), grid(4, 4)), true});
  list.push_back({"overlap_jittered", together(jittered<2>(grid(7, 6), 0.2, 6), wound(grid(40, 2), 0.2, 4, 0.1))});
}

void add_overwound(std::vector<Family<2>>& list) {
  list.push_back({"interior_4pi", fan(9, 2, true)});
  list.push_back({"interior_4pi_rings", fan(11, 2, true, 4)});
  list.push_back({"interior_6pi_rings", fan(17, 3, true, 3)});
  list.push_back({"boundary_over_2pi", fan(12, 1.6, false)});
  list.push_back({"boundary_over_2pi_rings", fan(14, 1.7, false, 4)});
  list.push_back({"boundary_over_4pi_rings", fan(19, 2.4, false, 3)});
}

void add_grown(std::vector<Family<2>>& list) {
  for (int seed = 0; seed < 4; ++seed) {
    list.push_back({"grown_" + std::to_string(seed), grown<2>(80, 50 + seed, false)});
    list.push_back({"grown_folded_" + std::to_string(seed), grown<2>(30, 60 + seed, true)});
  }
}

void add_magnitudes(std::vector<Family<2>>& list) {
  list.push_back(
      {"slivers",
       scaled(moved<2>(jittered<2>(grid(8, 8), 0.2, 7), [](const Vec2& x) { return Vec2(x[0], x[1] * 1e-7); }), 1)});
  list.push_back({"sheared_slivers", moved<2>(jittered<2>(grid(8, 6), 0.2, 8),
                                              [](const Vec2& x) { return Vec2(x[0] + 1e4 * x[1], x[1]); })});
  list.push_back({"nearly_flat", [] {
                    auto mesh =
                        moved<2>(grid(6, 5), [](const Vec2& x) { return Vec2(x[0] + 0.25 * x[1], x[1] * 0x1p-50); });
                    return mesh;
                  }()});
  for (int k : {-400, -60, 60, 400}) {
    const std::string power = (k < 0 ? "minus_" : "plus_") + std::to_string(std::abs(k));
    list.push_back({"scaled_" + power, scaled(jittered<2>(walk("EEENNWWSSEENNN"), 0.2, 9), std::ldexp(1, k))});
    list.push_back({"scaled_grid_" + power, scaled(walk("ENWSENWSEEN"), std::ldexp(1, k)), true});
  }
  list.push_back({"far_away", translated(jittered<2>(wound(grid(50, 2), 0.22, 5, 0.1), 0.05, 10), 1e6, -1e6)});
  list.push_back({"far_away_grid", translated(walk("EENNWWSSEENN"), 1e6, -1e6), true});
}

void add_inverted(std::vector<Family<2>>& list) {
  list.push_back({"inverted_inside", with_vertex(grid(7, 7), 3 * 8 + 3, 4.4, 3.3)});
  list.push_back({"inverted_inside_exact", with_vertex(grid(7, 7), 3 * 8 + 3, 5, 3), true});
  list.push_back({"inverted_out_of_surface", with_vertex(grid(4, 4), 2 * 5 + 2, 6.3, 2.2)});
  list.push_back({"inverted_boundary", with_vertex(grid(5, 5), 2, 2.2, 1.7)});
  list.push_back({"flat_inside", with_vertex(grid(6, 6), 3 * 7 + 3, 4, 3), true});
  list.push_back({"flat_boundary", with_vertex(grid(5, 4), 2, 2, 1), true});
  list.push_back({"many_inverted", jittered<2>(grid(9, 9), 0.75, 11)});
  list.push_back({"many_inverted_exact",
                  [] {
                    Random random(12);
                    return moved<2>(grid(7, 7), [&](const Vec2& x) {
                      return Vec2(x + Vec2{random.below(3) - 1.0, random.below(3) - 1.0});
                    });
                  }(),
                  true});
  list.push_back({"inverted_spiral", with_vertex(wound(grid(60, 4), 0.22, 6, 0.1), 130, 2, 3)});
  list.push_back({"mirrored", moved<2>(grid(4, 4), [](const Vec2& x) { return Vec2(-x[0], x[1]); }), true});
}

}  // namespace

const std::vector<Family<2>>& planar_families() {
  static const std::vector<Family<2>> families = [] {
    std::vector<Family<2>> list;
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
