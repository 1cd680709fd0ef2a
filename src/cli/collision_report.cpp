#include "cli/collision_report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace selvage::cli {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<const char*, 4> kContactNames{"near", "touching", "crossing", "coplanar overlap"};

const char* contact_name(TriangleContact contact) {
  return kContactNames[static_cast<std::size_t>(contact)];
}

/// Lists as text, one entry a line: there can be millions.
template <typename Items, typename Print>
std::string print_list(const Items& items, Print&& print) {
  fmt::memory_buffer out;
  fmt::format_to(std::back_inserter(out), "[");
  for (std::size_t i = 0; i < items.size(); ++i) {
    fmt::format_to(std::back_inserter(out), "{}\n  ", i ? "," : "");
    print(std::back_inserter(out), items[i]);
  }
  fmt::format_to(std::back_inserter(out), "{}]", items.empty() ? "" : "\n ");
  return fmt::to_string(out);
}

std::vector<std::int64_t> count_pairs(const CollisionReport& report) {
  std::vector<std::int64_t> counts(report.triangles.size(), 0);
  for (const TrianglePair& pair : report.pairs) {
    ++counts[pair.first];
    ++counts[pair.second];
  }
  return counts;
}

/// The corners of the box around all triangles that collide.
std::pair<Vec3, Vec3> place_of(const CollisionReport& report) {
  Vec3 lower = Vec3::Constant(HUGE_VAL), upper = -lower;
  for (const TrianglePair& pair : report.pairs)
    for (const Index t : {pair.first, pair.second})
      for (const Index v : report.triangles[t]) {
        lower = lower.cwiseMin(report.positions[v]);
        upper = upper.cwiseMax(report.positions[v]);
      }
  return {lower, upper};
}

std::string print_kinds(const CollisionReport& report) {
  std::string text;
  for (const TriangleContact contact :
       {TriangleContact::kCrossing, TriangleContact::kTouching, TriangleContact::kCoplanarOverlap}) {
    const auto count = std::count_if(report.pairs.begin(), report.pairs.end(),
                                     [&](const TrianglePair& pair) { return pair.contact == contact; });
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", grouped(count), contact_name(contact));
  }
  return text;
}

}  // namespace

std::string print_json(const CollisionReport& report, const Stopwatch& watch) {
  const SelfCollisionCounters& c = report.counters;
  Json head{{"schema", 1}, {"kind", "discrete"}, {"mesh", report.mesh}, {"method", report.method}};
  Json tail;
  tail["statistics"] = {{"triangles", report.triangles.size()}, {"pairs", report.pairs.size()},
                        {"node_pairs", c.node_pairs},           {"box_pairs", c.box_pairs},
                        {"adjacent_pairs", c.adjacent_pairs},   {"exact_tests", c.exact_tests}};
  for (const auto& [phase, seconds] : watch.laps()) tail["seconds"][phase] = seconds;
  tail["seconds"]["total"] = watch.total();
  std::string text = head.dump(1);
  text.resize(text.rfind('\n'));
  if (report.solid)
    text += ",\n \"triangles\": " + print_list(report.triangles, [](auto out, const VertexTuple<3>& t) {
              fmt::format_to(out, "[{},{},{}]", t[0], t[1], t[2]);
            });
  text += ",\n \"triangle_pairs\": " + print_list(report.pairs, [](auto out, const TrianglePair& pair) {
            fmt::format_to(out, "[{},{}]", pair.first, pair.second);
          });
  text += ",\n \"contacts\": " + print_list(report.pairs, [](auto out, const TrianglePair& pair) {
            fmt::format_to(out, "\"{}\"", contact_name(pair.contact));
          });
  return text + "," + tail.dump(1).substr(1) + "\n";
}

VtkGrid mark_collisions(const CollisionReport& report) {
  VtkGrid grid;
  grid.points = report.positions;
  grid.triangles = report.triangles;
  const std::vector<std::int64_t> counts = count_pairs(report);
  grid.cell_fields.push_back({"collisions", 1, {counts.begin(), counts.end()}});
  return grid;
}

void print_summary(const CollisionReport& report, const Stopwatch& watch) {
  Table table;
  table.add("mesh", fmt::format("{}, {} {}", report.mesh, grouped(std::ssize(report.triangles)),
                                report.solid ? "boundary triangles" : "triangles"));
  table.add("colliding pairs", report.pairs.empty() ? "none" : grouped(std::ssize(report.pairs)));
  if (!report.pairs.empty()) {
    const std::vector<std::int64_t> counts = count_pairs(report);
    const auto most = std::max_element(counts.begin(), counts.end());
    const auto [lower, upper] = place_of(report);
    table.add("of them", print_kinds(report));
    table.add("triangles in pairs",
              fmt::format("{}; most, {}, at triangle {}",
                          grouped(std::count_if(counts.begin(), counts.end(), [](std::int64_t n) { return n > 0; })),
                          grouped(*most), most - counts.begin()));
    table.add("where", fmt::format("from {:.6g} {:.6g} {:.6g} to {:.6g} {:.6g} {:.6g} m", lower[0], lower[1], lower[2],
                                   upper[0], upper[1], upper[2]));
  }
  std::string times;
  for (const auto& [phase, seconds] : watch.laps()) times += fmt::format("{} {}, ", phase, readable_seconds(seconds));
  table.add("time", fmt::format("{}together {}", times, readable_seconds(watch.total())));
  table.print();
}

}  // namespace selvage::cli
