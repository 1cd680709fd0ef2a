#pragma once

#include "peer/rounds.h"

#include <cstdint>
#include <cstdio>
#include <filesystem>

namespace selvage::bench {

/// What a method found in the frames of one surface, and what it did for that; sums over the frames.
struct CollisionCount {
  std::string mesh, kind, method;
  std::int64_t triangles = 0, frames = 0;
  std::int64_t triangle_pairs = 0, vertex_face = 0, edge_edge = 0;  ///< as the kind has them
  std::int64_t missed = 0;                                          ///< of the pairs that the hierarchy alone finds
  std::int64_t invented = 0;                                        ///< pairs that it does not find
  std::int64_t node_pairs = 0, box_pairs = 0, exact_tests = 0;
};

/// What a method takes for one frame: refit and all pairs.
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

/// Prints each entry as it comes, and keeps it.
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
