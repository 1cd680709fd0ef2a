#pragma once

#include "picture/legend.h"
#include "scene/reading/marks.h"
#include "scene/reading/stored_run.h"
#include "scene/reading/touches.h"

#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace selvage {

/// How bodies are coloured. All but the first show values of vertices.
enum class ColourBy : std::uint8_t { kBody, kDepth, kSpeed, kStrain, kContact };

/// The names of the ways, in the order of their numbers.
std::span<const std::string_view> colour_names();

/// Values of a run's vertices, as the page has them (viewer/src/fields.ts).
///
/// Depth: length of the way out of a vertex that is inside, or 0. Speed: distance since the frame before, by its time.
/// Strain: of the triangles around a vertex the largest part by which a length has grown or shrunk, against the shape
/// at rest. Contact: what a vertex meets, as a number of names.
class VertexValues {
 public:
  /// @param by  not kBody
  /// @throws Error  when the folder has no shape at rest and strain is asked for
  VertexValues(std::shared_ptr<const StoredRun> run, ColourBy by);

  const ColourScale& scale() const { return scale_; }

  /// Of all vertices; not of two threads at a time.
  std::vector<double> at(std::int64_t frame);

 private:
  std::vector<double> depths(std::int64_t frame, std::span<const Vec3> positions);
  std::vector<double> speeds(std::int64_t frame, std::span<const Vec3> positions) const;
  std::vector<double> contacts(std::int64_t frame, std::span<const Vec3> positions);
  Marks find_marks(std::int64_t frame, std::span<const Vec3> positions);

  std::shared_ptr<const StoredRun> run_;
  ColourBy by_;
  ColourScale scale_;
  std::vector<Vec3> rest_;
  std::optional<TetMesh> mesh_;
  std::optional<MarkFinder> marks_;
  std::optional<TouchFinder> touches_;
};

/// Largest strain of the triangles around each vertex. Triangles without area at rest have none.
std::vector<double> vertex_strains(std::span<const Vec3> rest, std::span<const Vec3> positions,
                                   std::span<const VertexTuple<3>> triangles);

}  // namespace selvage
