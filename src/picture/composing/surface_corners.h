#pragma once

#include "picture/composing/composition.h"
#include "picture/drawing/raster.h"

namespace selvage {

/// A surface in space, to be put on the picture.
struct PlacedSurface {
  std::span<const Vec3> positions;  ///< [m]
  std::span<const VertexTuple<3>> triangles;
  std::span<const double> vertex_value{};  ///< empty: 0; of one below 0 value and weight are 0
  std::span<const Index> parts{};          ///< of each triangle; empty: all are part 0
  std::span<const Index> windings{};       ///< with a cut: the closed body of each triangle, or kNone
  const CutPlane* cut = nullptr;           ///< what lies on the eye's side of it is left out
  bool one_sided = false;                  ///< leave out triangles that turn their back to the eye
};

/// The corners of a surface's triangles on the picture: three vertices a triangle, so that sharp edges stay sharp.
/// Normals are averaged over the neighbours around a vertex that face nearly the same way.
std::vector<ScreenVertex> place_corners(const PlacedSurface& surface, const Camera& camera);

/// Adds a surface to those of a picture: placed corners, with what is behind the eye, or in the half that is cut away,
/// clipped off. Triangles that share an edge still share it after that, bit for bit.
/// @param frame  of the picture; triangles that reach far out of it are clipped too
void add_surface(const PlacedSurface& surface, const Camera& camera, const Frame& frame, ScreenSurface& screen);

/// The part of a segment that is before the eye, as a line of the picture; nothing where there is none.
std::optional<ScreenLine> place_line(const Vec3& from, const Vec3& to, float radius, const Camera& camera);

/// The occluders that a surface is made of, without the half that is cut away.
void add_occluders(const PlacedSurface& surface, std::vector<Occluder>& occluders);

}  // namespace selvage
