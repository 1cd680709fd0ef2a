#pragma once

#include "selvage/core/types.h"

#include <Eigen/Core>

#include <limits>

namespace selvage {

/// A vertex on the picture, ready to be drawn.
struct ScreenVertex {
  float x, y;              ///< [pixels]
  float distance;          ///< from the eye [m]
  Eigen::Vector3f normal;  ///< in the axes of the camera
  float value;             ///< the value that the colour shows
  float weight;            ///< how much of the vertex belongs to the layer, 0 to 1
};

/// A surface ready to be drawn.
struct ScreenSurface {
  std::vector<ScreenVertex> vertices;
  std::vector<VertexTuple<3>> triangles;
};

/// Rows [first, last).
struct Rows {
  int first, last;
};

/// The nearest surface seen through each sample of some rows of samples of the picture.
struct SurfaceLayer {
  int width;                            ///< [samples]
  Rows rows;                            ///< [samples], from the top of the picture
  int samples;                          ///< per pixel in each direction
  std::vector<float> distance;          ///< from the eye; infinite where nothing is
  std::vector<Eigen::Vector3f> normal;  ///< interpolated, not normalised, turned towards the eye
  std::vector<float> value;
  std::vector<float> edge;          ///< distance to the nearest triangle edge [samples]
  std::vector<std::uint8_t> count;  ///< triangles one behind the other, at most 255

  SurfaceLayer(int layer_width, const Rows& layer_rows, int samples_per_pixel = 1);
  bool holds(int x, int y) const { return x >= 0 && x < width && y >= rows.first && y < rows.last; }
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y - rows.first) * width + x; }
  bool covers(std::size_t i) const { return distance[i] < std::numeric_limits<float>::infinity(); }
  bool covers(int x, int y) const { return holds(x, y) && covers(index(x, y)); }
};

/// A surface by bands of rows of the picture, each drawn by itself.
class SurfaceBands {
 public:
  /// @param surface    is kept by reference
  /// @param height     of the picture [pixels]
  /// @param band_rows  of a band [pixels]
  /// @param margin     rows above and below that are drawn with a band [pixels]
  SurfaceBands(const ScreenSurface& surface, int height, int band_rows, int margin = 0);

  /// Draws a band's triangles into its rows and margin, or those of them that the layer has: each sample keeps the
  /// nearest triangle (of equals the one with the smaller index) and drops places where the interpolated weight is
  /// below one half.
  void draw(std::size_t band, SurfaceLayer& layer) const;

  std::size_t count() const { return bins_.size(); }
  bool is_empty(std::size_t band) const { return bins_[band].empty(); }
  /// The rows of a band, without its margin [pixels].
  Rows rows(std::size_t band) const;

 private:
  const ScreenSurface& surface_;
  int height_, band_rows_, margin_;
  std::vector<std::vector<Index>> bins_;  ///< triangles whose rows reach each band or its margin, ascending
};

/// Draws all of a surface into a layer that holds all rows, in parallel.
void draw_surface(const ScreenSurface& surface, SurfaceLayer& layer);

}  // namespace selvage
