#pragma once

#include "peer/rounds.h"

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>

namespace selvage::bench {

/// One measurement: the library's way beside the peer's.
struct Row {
  std::string measure;
  std::string mesh;
  int threads = 1;
  std::int64_t items = 0;
  std::string item;     ///< the unit that is counted: query, vertex, tet
  Duration ours, peer;  ///< medians [s]
  Duration ratio;       ///< peer / ours, median over the rounds
  std::string peer_setting;
  int rounds = 0;
};

/// Counts per query, and how far the answers agree, for one mesh and one set of queries.
struct Work {
  std::string mesh, who;
  std::int64_t queries = 0;
  double faces = 0, volumes = -1, culled = 0, traversals = 0, elements = 0,
         exact = -1;  ///< a query; negative: not known
};

struct Agreement {
  std::string mesh, what;
  std::int64_t compared = 0, missing = 0;
  struct Distances {
    std::int64_t different = 0, beyond_rounding = 0;
    double worst = 0;  ///< largest difference, relative to the size of the mesh
  };
  std::optional<Distances> distances{};  ///< of those compared; none where only their presence is
};

/// Prints each entry as it comes, and keeps it.
class Report {
 public:
  explicit Report(std::FILE* table) : table_(table) {}
  void say(const std::string& line) const;
  void print_header() const;
  void add(Row row);
  void add(Work work);
  void add(Agreement agreement);

  /// @param path  "-": standard output
  void write_json(const std::filesystem::path& path) const;

 private:
  std::FILE* table_;
  std::vector<Row> rows_;
  std::vector<Work> works_;
  std::vector<Agreement> agreements_;
};

}  // namespace selvage::bench
