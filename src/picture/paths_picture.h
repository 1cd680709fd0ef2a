#pragma once

#include "picture/drawing/image.h"
#include "selvage/core/types.h"

#include <optional>
#include <string>

namespace selvage {

/// A path to draw: from an interior point to the boundary.
struct DrawnPath {
  Vec3 from, to;
  double depth;  ///< its length [m]
};

/// The contents of a picture of shortest paths.
struct PathsDrawing {
  std::span<const Vec3> positions;          ///< of all vertices [m]
  std::span<const VertexTuple<3>> surface;  ///< boundary triangles; of a planar mesh its elements
  std::span<const VertexTuple<2>> outline;  ///< boundary edges of a planar mesh; empty in space
  std::span<const double> vertex_depth;     ///< one per vertex: how deep it has penetrated, below 0 where it has not
  std::span<const DrawnPath> paths;
  std::string caption;  ///< one line below the picture
};

struct PictureOptions {
  int width = 1600, height = 1000;  ///< [pixels]
  int samples = 3;                  ///< per pixel in each direction
  std::optional<Vec3> towards;      ///< direction from the mesh to the eye; without it a good one is chosen
};

/// Draws the surface in plain shading; what has penetrated shines through it, coloured by depth, with the paths.
///
/// A scale beside the picture tells depths. The same scene gives the same picture for any number of threads.
/// @throws Error  when the scene has no vertex or the picture's size is not between 64 and 8192 pixels
Image draw_paths(const PathsDrawing& scene, const PictureOptions& options = {});

}  // namespace selvage
