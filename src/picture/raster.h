#pragma once

#include "selvage/core/types.h"

#include <Eigen/Core>

#include <limits>

namespace selvage {

/// A vertex on the picture, ready to be drawn.
struct ScreenVertex {
  float x, y;              ///< [samples]
  float distance;          ///< from the eye [m]
  Eigen::Vector3f normal;  ///< in the axes of the camera
  float value;             ///< what the colour shows
  float weight;            ///< how much of the vertex belongs to the layer, 0 to 1
};

/// The nearest surface seen through each sample of the picture.
struct SurfaceLayer {
  int width = 0, height = 0;
  std::vector<float> distance;          ///< from the eye; infinite where nothing is
  std::vector<Eigen::Vector3f> normal;  ///< interpolated, not normalised, turned towards the eye
  std::vector<float> value;
  std::vector<float> edge;          ///< distance to the nearest triangle edge [samples]
  std::vector<std::uint8_t> count;  ///< triangles one behind the other, at most 255

  SurfaceLayer(int layer_width, int layer_height);
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y) * width + x; }
  bool covers(std::size_t i) const { return distance[i] < std::numeric_limits<float>::infinity(); }
};

/// Draws triangles into a layer: each sample keeps the nearest one (of equals the one with the smaller index) and drops
/// places where the interpolated weight is below one half. Parallel over bands of rows; the same bits for any number of
/// threads.
void draw_triangles(std::span<const ScreenVertex> vertices, std::span<const VertexTuple<3>> triangles,
                    SurfaceLayer& layer);

}  // namespace selvage
