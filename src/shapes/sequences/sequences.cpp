#include "selvage/shapes/sequences.h"

#include "core/parallel.h"
#include "selvage/core/error.h"
#include "shapes/sequences/sequence_maps.h"
#include "shapes/sequences/sequence_material.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

struct NamedSequence {
  std::string_view name;
  Index triangle_count;
  Index frame_count;
  Material (*cut)(double refinement);  ///< cells as many times along each side
  Vec3 (*place)(const Vec3& material, double time);
};

Index times(double refinement, Index cells) {
  return std::max<Index>(3, static_cast<Index>(std::lround(refinement * cells)));
}

Material cut_pipe(double refinement) {
  Material pipe;
  add_piece(pipe, times(refinement, 100), times(refinement, 390), true);
  return pipe;
}

/// A jacket, then the leg that stands, then the one that kicks.
Material cut_karate(double refinement) {
  Material suit;
  add_piece(suit, times(refinement, 300), times(refinement, 96), true);
  for (int leg = 0; leg < 2; ++leg) add_piece(suit, times(refinement, 160), times(refinement, 108), true);
  return suit;
}

Material cut_shirt(double refinement) {
  return make_shirt(std::max<Index>(1, static_cast<Index>(std::lround(3 * refinement))));
}

Material cut_sheet(double refinement) {
  Material sheet;
  add_piece(sheet, times(refinement, 179), times(refinement, 179), false);
  return sheet;
}

/// Bodice and skirt, then the ruffles from the uppermost to the lowest.
Material cut_flamenco(double refinement) {
  Material dress;
  add_piece(dress, times(refinement, 200), times(refinement, 60), true);
  for (int ruffle = 0; ruffle < 3; ++ruffle) add_piece(dress, times(refinement, 420), times(refinement, 10), true);
  return dress;
}

constexpr std::array<NamedSequence, 7> kSequences = {{
    {"pipe", 78'000, 120, cut_pipe, place_pipe},
    {"karate", 126'720, 120, cut_karate, place_karate},
    {"t-shirt", 10'080, 120, cut_shirt, place_shirt},
    {"funnel", 64'082, 120, cut_sheet, place_funnel},
    {"flamenco", 49'200, 120, cut_flamenco, place_flamenco},
    {"waves", 64'082, 120, cut_sheet, place_waves},
    {"crumple", 64'082, 120, cut_sheet, place_crumple},
}};

constexpr std::array kSequenceNames = [] {
  std::array<std::string_view, kSequences.size()> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = kSequences[i].name;
  return names;
}();

constexpr std::int64_t kMaxTriangles = std::int64_t{1} << 29;

}  // namespace

std::span<const std::string_view> sequence_names() {
  return kSequenceNames;
}

SurfaceSequence::SurfaceSequence(std::string_view name, std::int64_t triangle_count) {
  const auto found = std::find_if(kSequences.begin(), kSequences.end(), [&](const auto& s) { return s.name == name; });
  if (found == kSequences.end())
    throw Error("sequence", fmt::format("there is no sequence '{}'", name),
                fmt::format("use one of {}", fmt::join(kSequenceNames, ", ")));
  if (triangle_count < 0 || triangle_count > kMaxTriangles)
    throw Error("triangles", fmt::format("{} is out of range", triangle_count), "use a number from 0 to 2^29");
  if (triangle_count == 0) triangle_count = found->triangle_count;
  Material material =
      found->cut(std::sqrt(static_cast<double>(triangle_count) / static_cast<double>(found->triangle_count)));
  name_ = found->name;
  frame_count_ = found->frame_count;
  place_ = found->place;
  material_ = std::move(material.places);
  triangles_ = std::move(material.triangles);
}

std::vector<Vec3> SurfaceSequence::positions(double frame) const {
  if (!(frame >= 0 && frame <= frame_count_ - 1))
    throw Error("frame", fmt::format("{} is out of range", frame),
                fmt::format("frames lie in [0, {}]", frame_count_ - 1));
  std::vector<Vec3> positions(material_.size());
  parallel_for(std::ssize(positions), kGrain,
               [&](std::int64_t v) { positions[v] = place_(material_[v], frame / (frame_count_ - 1)); });
  return positions;
}

}  // namespace selvage
