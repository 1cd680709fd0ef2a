#include "peer/report.h"

#include "peer/json_file.h"

#include <fmt/format.h>

namespace selvage::bench {

namespace {

double micro_per_item(double seconds, const Row& row) {
  return 1e6 * seconds / static_cast<double>(std::max<std::int64_t>(row.items, 1));
}

}  // namespace

void Report::say(const std::string& line) const {
  fmt::print(table_, "{}\n", line);
  std::fflush(table_);
}

void Report::print_header() const {
  fmt::print(table_, "{:<26}{:>4}{:>9} {:<7}| {:>9}{:>9} | {:>9}{:>9} | {:>7}{:>7} | {}\n", "microseconds an item",
             "thr", "items", "", "ours cpu", "clock", "peer cpu", "clock", "p/o cpu", "clock",
             "peer's setting (rounds)");
}

void Report::add(Row row) {
  fmt::print(table_, "{:<26}{:>4}{:>9} {:<7}| {:>9.4g}{:>9.4g} | {:>9.4g}{:>9.4g} | {:>7.2f}{:>7.2f} | {} ({})\n",
             row.measure, row.threads, row.items, row.item, micro_per_item(row.ours.processor, row),
             micro_per_item(row.ours.clock, row), micro_per_item(row.peer.processor, row),
             micro_per_item(row.peer.clock, row), row.ratio.processor, row.ratio.clock, row.peer_setting, row.rounds);
  std::fflush(table_);
  rows_.push_back(std::move(row));
}

void Report::add(Work w) {
  const auto known = [](double x) { return x < 0 ? "?" : fmt::format("{:.1f}", x); };
  fmt::print(
      table_,
      "  a query, {:<30} volumes {:>6}  faces {:>6.1f}  culled {:>6.1f}  traversals {:>6.2f}  elements {:>7.1f}  "
      "exact {:>6}\n",
      w.who, known(w.volumes), w.faces, w.culled, w.traversals, w.elements, known(w.exact));
  works_.push_back(std::move(w));
}

void Report::add(Agreement a) {
  fmt::print(table_, "  {:<39} compared {}, one-sided {}", a.what, a.compared, a.missing);
  if (a.distances)
    fmt::print(table_, ", different {}, of these beyond single precision {}, worst {:.2g} of the size",
               a.distances->different, a.distances->beyond_rounding, a.distances->worst);
  fmt::print(table_, "\n");
  std::fflush(table_);
  agreements_.push_back(std::move(a));
}

void Report::write_json(const std::filesystem::path& path) const {
  nlohmann::json json = {{"schema", 1}, {"benchmark", "boundary-path"}};
  for (const Row& r : rows_)
    json["rows"].push_back({{"mesh", r.mesh},
                            {"measure", r.measure},
                            {"threads", r.threads},
                            {"items", r.items},
                            {"item", r.item},
                            {"seconds_ours", to_json(r.ours)},
                            {"seconds_peer", to_json(r.peer)},
                            {"ratio", to_json(r.ratio)},
                            {"peer_setting", r.peer_setting},
                            {"rounds", r.rounds}});
  for (const Work& w : works_)
    json["work"].push_back({{"mesh", w.mesh},
                            {"who", w.who},
                            {"queries", w.queries},
                            {"volumes", w.volumes < 0 ? nlohmann::json() : nlohmann::json(w.volumes)},
                            {"faces", w.faces},
                            {"culled", w.culled},
                            {"traversals", w.traversals},
                            {"elements", w.elements},
                            {"exact_decisions", w.exact < 0 ? nlohmann::json() : nlohmann::json(w.exact)}});
  for (const Agreement& a : agreements_) {
    nlohmann::json& entry = json["agreement"].emplace_back();
    entry = {{"mesh", a.mesh}, {"what", a.what}, {"compared", a.compared}, {"one_sided", a.missing}};
    if (!a.distances) continue;
    entry["different"] = a.distances->different;
    entry["beyond_rounding"] = a.distances->beyond_rounding;
    entry["worst"] = a.distances->worst;
  }
  write_json_file(path, json);
}

}  // namespace selvage::bench
