#pragma once

#include "peer/collisions/collision_query.h"
#include "peer/rounds.h"

#include <cstdint>
#include <cstdio>
#include <filesystem>

namespace selvage::bench {

/// Pairs that a method found in the frames of one surface, and its work for that; sums over the frames.
struct CollisionCount {
  std::string mesh, kind, method;
  std::int64_t triangles = 0, frames = 0;
  PairCount pairs{};     ///< as the kind has them
  PairCount missed{};    ///< of the pairs that the hierarchy alone finds
  PairCount invented{};  ///< pairs that it does not find
  CollisionWork work{};
};

/// Time of a method for one frame: refit and all pairs.
struct CollisionTime {
  std::string mesh, kind, method;
  int threads = 1;
  Duration frame;                       ///< mean over the frames [s]
  Duration over_bvh, over_normal_cone;  ///< their time over this one's, median over the frames; 0: not measured
};

/// The same for a peer.
struct PeerTime {
  std::string mesh, peer;
  int threads = 1;
  Duration frame;
  Duration ratio;     ///< peer / ours, median over the frames
  double target = 0;  ///< for the ratio
};

/// How far the pairs of a peer are ours, over all frames.
struct PeerAgreement {
  std::string mesh, peer;
  std::int64_t pairs = 0;     ///< that share no vertex
  std::int64_t adjacent = 0;  ///< others, left out of the comparison
  std::int64_t only_ours = 0, only_theirs = 0;
};

/// Time against size.
struct Growth {
  std::string mesh;
  std::int64_t triangles = 0;
  double pairs = 0;  ///< a frame
  Duration frame;
  double relative = 0;  ///< processor time by n log n + pairs, over that of the smallest surface
};

/// Prints each entry as it comes, and keeps it for EDC's tables and the JSON.
class CollisionReport {
 public:
  explicit CollisionReport(std::FILE* table) : table_(table) {}
  void say(const std::string& line) const;
  void print_count_header() const;
  void print_time_header() const;
  void add(CollisionCount count);
  void add(CollisionTime time);
  void add(PeerTime time);
  void add(PeerAgreement agreement);
  void add(Growth growth);

  /// Prints the tables of EDC of all that came.
  void print_tables() const;

  /// @param path  "-": standard output
  void write_json(const std::filesystem::path& path) const;

 private:
  std::FILE* table_;
  std::vector<CollisionCount> counts_;
  std::vector<CollisionTime> times_;
  std::vector<PeerTime> peers_;
  std::vector<PeerAgreement> agreements_;
  std::vector<Growth> growths_;
};

}  // namespace selvage::bench
