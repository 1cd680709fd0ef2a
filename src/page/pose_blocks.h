#pragma once

#include "page/page.h"
#include "page/page_surface.h"

#include <array>

namespace selvage {

/// The box of all poses of a page.
struct PoseBox {
  Vec3 lower = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 upper = Vec3::Constant(-std::numeric_limits<double>::infinity());

  void add(const Vec3& p) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
};

/// Writes poses in 16 bits a coordinate: its place in the box, of 65535 steps a side. A pose is stored as the
/// difference to the one before, and every sixteenth by itself, as the difference to the vertex before, so that a
/// reader can begin there. Coordinates are off by at most half a step.
class PoseBlocks {
 public:
  /// @param prefix  of the names of blocks
  PoseBlocks(Page& page, const ShownSurface& surface, const PoseBox& box, std::string prefix = {});

  /// Appends a pose as block `<prefix>pose<number>`.
  /// @param positions  of all vertices of the mesh, in the box
  /// @param time       [s], or what stands for it
  void add(std::span<const Vec3> positions, double time);

  /// Says in the page how many there are; after the last.
  void finish();

  /// The box, as the page has it.
  nlohmann::ordered_json box() const;

  static constexpr std::size_t kKeyInterval = 16;

 private:
  Page& page_;
  const ShownSurface& surface_;
  PoseBox box_;
  Vec3 step_;
  std::string prefix_;
  std::vector<std::uint16_t> before_;
  std::vector<double> times_;
};

}  // namespace selvage
