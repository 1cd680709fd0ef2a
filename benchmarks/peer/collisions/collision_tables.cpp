#include "peer/collisions/collision_tables.h"

#include <fmt/format.h>

#include <algorithm>

namespace selvage::bench {

namespace {

constexpr const char *kDiscrete = "discrete", *kContinuous = "continuous", *kPublished = "enhanced-dual-cone-published";

class CollisionTables {
 public:
  CollisionTables(std::FILE* table, std::span<const CollisionCount> counts, std::span<const CollisionTime> times)
      : table_(table), counts_(counts), times_(times) {
    for (const CollisionCount& c : counts)
      if (std::find(meshes_.begin(), meshes_.end(), c.mesh) == meshes_.end()) meshes_.push_back(c.mesh);
  }

  void print_pairs() const;
  void print_speed_ups() const;
  void print_dual_cone_times() const;
  void print_saved_tests() const;

 private:
  /// The measured value, or nothing.
  const CollisionCount* count(const std::string& mesh, const char* kind, const std::string& method) const;
  const CollisionTime* time(const std::string& mesh, const char* kind, const std::string& method) const;

  std::string speed_up(const std::string& mesh, const char* kind, const char* method, const char* slow) const;
  std::string milliseconds(const std::string& mesh, const char* kind, const char* method) const;

  template <typename... Cells>
  void print_row(const std::string& name, const Cells&... cells) const {
    std::string row = fmt::format("  {:<28}", name);
    ((row += fmt::format("{:>12}", cells)), ...);
    fmt::print(table_, "{}\n", row);
  }

  std::FILE* table_;
  std::span<const CollisionCount> counts_;
  std::span<const CollisionTime> times_;
  std::vector<std::string> meshes_;
};

const CollisionCount* CollisionTables::count(const std::string& mesh, const char* kind,
                                             const std::string& method) const {
  const auto found = std::find_if(counts_.begin(), counts_.end(), [&](const CollisionCount& c) {
    return c.mesh == mesh && c.kind == kind && c.method == method;
  });
  return found == counts_.end() ? nullptr : &*found;
}

const CollisionTime* CollisionTables::time(const std::string& mesh, const char* kind, const std::string& method) const {
  const auto found = std::find_if(times_.begin(), times_.end(), [&](const CollisionTime& t) {
    return t.mesh == mesh && t.kind == kind && t.method == method && t.threads == 1;
  });
  return found == times_.end() ? nullptr : &*found;
}

std::string CollisionTables::speed_up(const std::string& mesh, const char* kind, const char* method,
                                      const char* slow) const {
  const CollisionTime *const fast_time = time(mesh, kind, method), *const slow_time = time(mesh, kind, slow);
  if (fast_time == nullptr || slow_time == nullptr) return "-";
  return fmt::format("{:.2f}", slow_time->frame.processor / fast_time->frame.processor);
}

std::string CollisionTables::milliseconds(const std::string& mesh, const char* kind, const char* method) const {
  const CollisionTime* const t = time(mesh, kind, method);
  return t == nullptr ? "-" : fmt::format("{:.2f}", 1e3 * t->frame.processor);
}

void CollisionTables::print_pairs() const {
  fmt::print(table_, "\ncolliding pairs, and false negatives among them (EDC, Fig. 10)\n");
  for (const std::string& mesh : meshes_) {
    print_row(mesh, "TT", "missed", "VF", "missed", "EE", "missed");
    for (const CollisionCount& c : counts_) {
      if (c.mesh != mesh || c.kind != kDiscrete) continue;
      const CollisionCount* const moving = count(mesh, kContinuous, c.method);
      if (moving == nullptr)
        print_row("  " + c.method, c.pairs.triangles, c.missed.triangles, "-", "-", "-", "-");
      else
        print_row("  " + c.method, c.pairs.triangles, c.missed.triangles, moving->pairs.vertex_face,
                  moving->missed.vertex_face, moving->pairs.edge_edge, moving->missed.edge_edge);
    }
  }
}

void CollisionTables::print_speed_ups() const {
  fmt::print(table_, "\nspeed-up over normal cones (n-c) and the hierarchy alone (bvh), one thread (EDC, Fig. 11)\n");
  for (const char* const method : {"enhanced-dual-cone", "auto"}) {
    print_row(method, "now: n-c", "bvh", "step: n-c", "bvh");
    for (const std::string& mesh : meshes_)
      print_row("  " + mesh, speed_up(mesh, kDiscrete, method, "normal-cone"), speed_up(mesh, kDiscrete, method, "bvh"),
                speed_up(mesh, kContinuous, method, "normal-cone"), speed_up(mesh, kContinuous, method, "bvh"));
  }
}

void CollisionTables::print_dual_cone_times() const {
  fmt::print(table_, "\nmilliseconds a query of the dual-cone methods, one thread (EDC, Fig. 12)\n");
  print_row("now, step", "dual-cone", "", "internal", "", "enhanced", "", "published", "");
  for (const std::string& mesh : meshes_) {
    const auto now = [&](const char* method) { return milliseconds(mesh, kDiscrete, method); };
    const auto step = [&](const char* method) { return milliseconds(mesh, kContinuous, method); };
    print_row("  " + mesh, now("dual-cone"), step("dual-cone"), now("dual-cone-internal"), step("dual-cone-internal"),
              now("enhanced-dual-cone"), step("enhanced-dual-cone"), now(kPublished), step(kPublished));
  }
}

void CollisionTables::print_saved_tests() const {
  fmt::print(table_,
             "\ntests a frame that a simple traversal makes besides (EDC, Fig. 13): of nodes with themselves, "
             "of two nodes; speed-up\n");
  print_row("now, step", "self", "inter", "speed-up", "self", "inter", "speed-up");
  for (const std::string& mesh : meshes_) {
    std::vector<std::string> cells;
    for (const char* const kind : {kDiscrete, kContinuous}) {
      const CollisionCount *const simple = count(mesh, kind, kSimpleTraversal), *const full =
                                                                                    count(mesh, kind, kPublished);
      if (simple == nullptr || full == nullptr) continue;
      const auto between = [](const CollisionCount& c) { return c.work.node_pairs - c.work.self_node_pairs; };
      const std::int64_t self = simple->work.tested_nodes - full->work.tested_nodes;
      const std::int64_t inter = between(*simple) - between(*full);
      cells.push_back(fmt::format("{}", self / full->frames));
      cells.push_back(fmt::format("{}", inter / full->frames));
      cells.push_back(speed_up(mesh, kind, kPublished, kSimpleTraversal));
    }
    cells.resize(6, "-");
    print_row("  " + mesh, cells[0], cells[1], cells[2], cells[3], cells[4], cells[5]);
  }
}

}  // namespace

void print_collision_tables(std::FILE* table, std::span<const CollisionCount> counts,
                            std::span<const CollisionTime> times) {
  const CollisionTables tables(table, counts, times);
  tables.print_pairs();
  tables.print_speed_ups();
  tables.print_dual_cone_times();
  tables.print_saved_tests();
  std::fflush(table);
}

}  // namespace selvage::bench
