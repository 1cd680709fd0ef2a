#pragma once

#include "selvage/core/types.h"

#include <cstdint>
#include <string_view>

namespace selvage {

/// A surface in motion that runs into itself, by formula: a smooth map takes each vertex's place in the material, and
/// the time, to space. For tests and benchmarks of self-collision; nothing is simulated, so that layers pass through
/// each other where cloth would give way. The same arguments give the same bits. Lengths in metres.
///
/// | name | what | triangles |
/// | --- | --- | --- |
/// | `pipe` | an open pipe on the ground bends until one end runs into the other | 78,000 |
/// | `karate` | a jacket and two trouser legs around a body that kicks | 126,720 |
/// | `t-shirt` | front and back, sewn together, stuffed into a box | 10,080 |
/// | `funnel` | a cloth slips into a funnel and falls into pleats | 64,082 |
/// | `flamenco` | a dress with three ruffles turns on its axis | 49,200 |
/// | `waves` | a cloth in gentle waves; it never meets itself | 64,082 |
/// | `crumple` | a crumpled sheet | 64,082 |
class SurfaceSequence {
 public:
  /// @param name            one of sequence_names()
  /// @param triangle_count  about how many triangles; 0: as many as in the table
  /// @throws Error          for an unknown name, or a count that is negative or too large
  explicit SurfaceSequence(std::string_view name, std::int64_t triangle_count = 0);

  std::string_view name() const { return name_; }
  Index frame_count() const { return frame_count_; }
  Index vertex_count() const { return static_cast<Index>(material_.size()); }

  /// (n_triangles) vertices of each triangle.
  const std::vector<VertexTuple<3>>& triangles() const { return triangles_; }

  /// (n_vertices x 3) where the vertices are. Parallel.
  /// @param frame   from 0 to frame_count() - 1; between two frames, too
  /// @throws Error  when the frame is out of range
  std::vector<Vec3> positions(double frame) const;

 private:
  std::string_view name_;
  Index frame_count_;
  Vec3 (*place_)(const Vec3& material, double time);
  std::vector<Vec3> material_;
  std::vector<VertexTuple<3>> triangles_;
};

/// Names of the sequences, in the order of the table.
std::span<const std::string_view> sequence_names();

}  // namespace selvage
