#pragma once

#include "picture/composing/collider_parts.h"
#include "picture/composing/composition.h"
#include "picture/legend.h"

#include <string>

namespace selvage {

/// A cut across an axis.
struct AxisCut {
  int axis = 1;         ///< 0: x, 1: y, 2: z
  double position = 0;  ///< [m]
};

struct SceneView {
  int width = 1200, height = 800;  ///< [pixels]
  int samples = 3;                 ///< per pixel in each direction
  View view{};                     ///< a camera without direction or eye looks from a corner, a little from above
  std::optional<AxisCut> cut{};    ///< bodies are cut open; the half that is nearer to the eye is left out
  bool edges = false;              ///< draw the triangles' edges
  /// Colour bodies by values; a legend stands on the right. Must outlive the pictures; null: by body.
  const ColourScale* scale = nullptr;
};

/// What a picture shows besides the positions, which change from frame to frame.
struct DrawnScene {
  std::size_t vertex_count = 0;
  std::vector<VertexTuple<3>> surface;  ///< of all bodies: closed, open, one or many
  std::vector<Index> bodies;            ///< of each vertex, from 0; its colour
  std::vector<Collider> colliders{};
  Vec3 up = Vec3::UnitZ();
  bool ground = true;           ///< shadows fall on a white floor: a collider, or below the lowest point
  std::vector<Index> marked{};  ///< triangles that are vermilion and shine through what hides them

  /// Colours by connected piece.
  void number_pieces();
};

/// Pictures of a scene, one for each frame, with the same camera, light and walls.
class ScenePictures {
 public:
  /// @param scene  must outlive the pictures
  /// @throws Error  when the scene has no triangle, or the size is not between 64 and 8192 pixels
  ScenePictures(const DrawnScene& scene, const SceneView& view);

  /// Lets the camera see a frame; all frames are added before the first is drawn.
  void add_frame(std::span<const Vec3> positions, double time);

  /// Draws a frame.
  /// @param time    [s] of the frame, at which colliders are drawn
  /// @param values  with a scale, of each vertex
  Image draw(std::span<const Vec3> positions, double time, std::span<const double> values = {});

  /// Looks from elsewhere from now on; the light stays. After add_frame().
  void look(const View& view);

  /// The view that add_frame() leads to, turned about the vertical through the middle of all frames; the eye keeps its
  /// distance, so far that all is seen from all sides.
  /// @param angle  [rad]
  View turned_view(double angle);

 private:
  std::vector<Vec3> seen_points() const;
  View base_view() const;
  void place_ground();
  void lower_ground_below_colliders();
  void add_colliders(double time, PictureContent& content) const;
  void add_bodies(std::span<const Vec3> positions, const std::optional<CutPlane>& cut, std::span<const double> values,
                  PictureContent& content) const;
  void draw_legend(Image& image) const;

  const DrawnScene& scene_;
  SceneView view_;
  Room room_;
  std::vector<Vec3> seen_;       ///< extreme points of all frames
  std::vector<double> times_;    ///< of all frames
  std::vector<Index> windings_;  ///< of each triangle: its body where that is closed, or kNone
  std::optional<Camera> camera_;
  Lamps lamps_;
  std::optional<Ground> ground_;
  Index body_count_ = 0;
};

}  // namespace selvage
