#include "peer/collisions/collision_report.h"

#include "peer/collisions/collision_tables.h"
#include "peer/json_file.h"

#include <fmt/format.h>

namespace selvage::bench {

namespace {

/// A ratio, or nothing where it was not measured.
std::string times(double ratio) {
  return ratio == 0 ? "" : fmt::format("{:.2f}", ratio);
}

nlohmann::json to_json(const PairCount& count) {
  return {{"triangles", count.triangles}, {"vertex_face", count.vertex_face}, {"edge_edge", count.edge_edge}};
}

nlohmann::json known(const Duration& ratio) {
  return ratio.clock == 0 ? nlohmann::json() : to_json(ratio);
}

}  // namespace

void CollisionReport::say(const std::string& line) const {
  fmt::print(table_, "{}\n", line);
  std::fflush(table_);
}

void CollisionReport::print_count_header() const {
  fmt::print(table_, "  {:<28}{:>9}{:>9}{:>9}{:>9}{:>10} | {:>11}{:>12}{:>10}\n", "sums over the frames", "TT", "VF",
             "EE", "missed", "invented", "node pairs", "box pairs", "exact");
}

void CollisionReport::print_time_header() const {
  fmt::print(table_, "  {:<28}{:>4} |{:>9}{:>9} |{:>9}{:>9} |{:>9}{:>9} | {}\n", "ms a frame", "thr", "cpu", "clock",
             "bvh/ cpu", "clock", "n-c/ cpu", "clock", "peer/ours cpu, clock");
}

void CollisionReport::add(CollisionCount c) {
  const bool discrete = c.kind == "discrete";
  const auto pairs = [](std::int64_t count, bool of_this_kind) {
    return of_this_kind ? fmt::format("{}", count) : "-";
  };
  fmt::print(table_, "  {:<28}{:>9}{:>9}{:>9}{:>9}{:>10} | {:>11}{:>12}{:>10}\n", c.method,
             pairs(c.pairs.triangles, discrete), pairs(c.pairs.vertex_face, !discrete),
             pairs(c.pairs.edge_edge, !discrete), c.missed.sum(), c.invented.sum(), c.work.node_pairs, c.work.box_pairs,
             c.work.exact_tests);
  std::fflush(table_);
  counts_.push_back(std::move(c));
}

void CollisionReport::add(CollisionTime t) {
  fmt::print(table_, "  {:<28}{:>4} |{:>9.2f}{:>9.2f} |{:>9}{:>9} |{:>9}{:>9} |\n", t.method, t.threads,
             1e3 * t.frame.processor, 1e3 * t.frame.clock, times(t.over_bvh.processor), times(t.over_bvh.clock),
             times(t.over_normal_cone.processor), times(t.over_normal_cone.clock));
  std::fflush(table_);
  times_.push_back(std::move(t));
}

void CollisionReport::add(PeerTime t) {
  fmt::print(table_, "  {:<28}{:>4} |{:>9.2f}{:>9.2f} |{:>18} |{:>18} | {:.2f}, {:.2f} (target {:g})\n", t.peer,
             t.threads, 1e3 * t.frame.processor, 1e3 * t.frame.clock, "", "", t.ratio.processor, t.ratio.clock,
             t.target);
  std::fflush(table_);
  peers_.push_back(std::move(t));
}

void CollisionReport::add(PeerAgreement a) {
  fmt::print(table_, "  {:<28}{:>9} pairs without a common vertex; only ours {}, only theirs {}; {} others\n", a.peer,
             a.pairs, a.only_ours, a.only_theirs, a.adjacent);
  std::fflush(table_);
  agreements_.push_back(std::move(a));
}

void CollisionReport::add(Growth g) {
  fmt::print(table_,
             "  {:<22}{:>9} triangles {:>9.0f} pairs |{:>9.2f}{:>9.2f} ms a frame | {:.2f} by n log n + pairs\n",
             g.mesh, g.triangles, g.pairs, 1e3 * g.frame.processor, 1e3 * g.frame.clock, g.relative);
  std::fflush(table_);
  growths_.push_back(std::move(g));
}

void CollisionReport::print_tables() const {
  print_collision_tables(table_, counts_, times_);
}

void CollisionReport::write_json(const std::filesystem::path& path) const {
  nlohmann::json json = {{"schema", 1}, {"benchmark", "self-collision"}};
  for (const CollisionCount& c : counts_)
    json["counts"].push_back({{"mesh", c.mesh},
                              {"kind", c.kind},
                              {"method", c.method},
                              {"triangles", c.triangles},
                              {"frames", c.frames},
                              {"pairs", to_json(c.pairs)},
                              {"missed", to_json(c.missed)},
                              {"invented", to_json(c.invented)},
                              {"node_pairs", c.work.node_pairs},
                              {"self_node_pairs", c.work.self_node_pairs},
                              {"tested_nodes", c.work.tested_nodes},
                              {"box_pairs", c.work.box_pairs},
                              {"exact_tests", c.work.exact_tests}});
  for (const CollisionTime& t : times_)
    json["methods"].push_back({{"mesh", t.mesh},
                               {"kind", t.kind},
                               {"method", t.method},
                               {"threads", t.threads},
                               {"seconds", to_json(t.frame)},
                               {"speed_up_over_bvh", known(t.over_bvh)},
                               {"speed_up_over_normal_cone", known(t.over_normal_cone)}});
  for (const PeerTime& t : peers_)
    json["peers"].push_back({{"mesh", t.mesh},
                             {"peer", t.peer},
                             {"threads", t.threads},
                             {"seconds", to_json(t.frame)},
                             {"ratio", to_json(t.ratio)},
                             {"target", t.target}});
  for (const PeerAgreement& a : agreements_)
    json["agreement"].push_back({{"mesh", a.mesh},
                                 {"peer", a.peer},
                                 {"pairs", a.pairs},
                                 {"adjacent", a.adjacent},
                                 {"only_ours", a.only_ours},
                                 {"only_theirs", a.only_theirs}});
  for (const Growth& g : growths_)
    json["growth"].push_back({{"mesh", g.mesh},
                              {"triangles", g.triangles},
                              {"pairs", g.pairs},
                              {"seconds", to_json(g.frame)},
                              {"relative", g.relative}});
  write_json_file(path, json);
}

}  // namespace selvage::bench
