#pragma once

#include "picture/drawing/camera.h"

#include <Eigen/Core>

#include <limits>

namespace selvage {

/// A vertex on the picture, ready to be drawn.
struct ScreenVertex {
  float x, y;              ///< [pixels]
  float distance;          ///< from the eye, along the line of sight [m]
  Eigen::Vector3f normal;  ///< in the axes of the camera
  float value;             ///< the value that the colour shows
  float weight;            ///< how much of the vertex belongs to the layer, 0 to 1
};

/// A surface ready to be drawn.
struct ScreenSurface {
  std::vector<ScreenVertex> vertices;
  std::vector<VertexTuple<3>> triangles;
  std::vector<Index> parts{};     ///< of each triangle: whose colour it has; empty: all are part 0
  std::vector<Index> windings{};  ///< of each triangle: the closed body it belongs to, or kNone; empty: nothing is cut

  Index part(std::size_t t) const { return parts.empty() ? 0 : parts[t]; }
};

/// Rows [first, last).
struct Rows {
  int first, last;
};

/// How often closed bodies wind around the place where a sample's ray enters what is left of a cut scene. Sums of whole
/// numbers, so that the order of triangles has no part in them.
struct Winding {
  std::int32_t times = 0;     ///< of all bodies
  std::int32_t numbered = 0;  ///< of each body times its number from 1: where `times` is 1, the body
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
  std::vector<Index> part;
  std::vector<Winding> winding;  ///< empty where the surface has no windings

  SurfaceLayer(int layer_width, const Rows& layer_rows, int samples_per_pixel = 1);
  bool holds(int x, int y) const { return x >= 0 && x < width && y >= rows.first && y < rows.last; }
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y - rows.first) * width + x; }
  bool covers(std::size_t i) const { return distance[i] < std::numeric_limits<float>::infinity(); }
  bool covers(int x, int y) const { return holds(x, y) && covers(index(x, y)); }

  /// Makes a plane the nearest surface of the samples for which test(i, distance of the plane) holds.
  ///
  /// @param point,normal  of the plane [m]
  /// @param part_of       part at sample i
  template <typename Test, typename PartOf>
  void add_plane(const Camera& camera, const Vec3& point, const Vec3& plane_normal, const Test& test,
                 const PartOf& part_of) {
    const double height = plane_normal.dot(point - camera.eye());
    const Eigen::Vector3f turned =
        camera.rotate(height > 0 ? Vec3(-plane_normal) : plane_normal).template cast<float>();
    for (int y = rows.first; y < rows.last; ++y) {
      const double row = (y + 0.5) / samples;
      const double left = plane_normal.dot(camera.ray(0, row)), step = plane_normal.dot(camera.ray(1, row)) - left;
      for (int x = 0; x < width; ++x) {
        const auto far = static_cast<float>(height / (left + step * (x + 0.5) / samples));
        const std::size_t i = index(x, y);
        if (!(far > 0) || !test(i, far)) continue;
        part[i] = part_of(i);
        distance[i] = far;
        normal[i] = turned;
        value[i] = 0;
        edge[i] = std::numeric_limits<float>::infinity();
      }
    }
  }
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

  /// Adds to `count` of the layer's samples how many of the band's triangles are nearer than what the layer shows.
  void count_in_front(std::size_t band, const SurfaceLayer& layer, std::vector<std::uint8_t>& count) const;

  std::size_t count() const { return bins_.size(); }
  bool is_empty(std::size_t band) const { return bins_[band].empty(); }
  /// The rows of a band, without its margin [pixels].
  Rows rows(std::size_t band) const;

 private:
  Rows drawn_rows(std::size_t band, const SurfaceLayer& layer) const;

  const ScreenSurface& surface_;
  int height_, band_rows_, margin_;
  std::vector<std::vector<Index>> bins_;  ///< triangles whose rows reach each band or its margin, ascending
};

/// Draws all of a surface into a layer that holds all rows, in parallel.
void draw_surface(const ScreenSurface& surface, SurfaceLayer& layer);

}  // namespace selvage
