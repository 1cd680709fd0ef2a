#include "page/pose_blocks.h"

#include "page/encoding.h"

#include <fmt/format.h>

#include <cmath>

namespace selvage {

namespace {

constexpr double kSteps = 65535;

std::vector<double> list_of(const Vec3& v) {
  return {v[0], v[1], v[2]};
}

}  // namespace

PoseBlocks::PoseBlocks(Page& page, const ShownSurface& surface, const PoseBox& box, std::string prefix)
    : page_(page), surface_(surface), box_(box), step_((box.upper - box.lower) / kSteps), prefix_(std::move(prefix)) {}

void PoseBlocks::add(std::span<const Vec3> positions, double time) {
  const std::size_t count = surface_.vertices.size();
  std::vector<std::uint16_t> places(3 * count);  // all x, then all y, then all z
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 offset = positions[static_cast<std::size_t>(surface_.vertices[i])] - box_.lower;
    for (int axis = 0; axis < 3; ++axis) {
      const double place = step_[axis] > 0 ? std::round(offset[axis] / step_[axis]) : 0;
      places[static_cast<std::size_t>(axis) * count + i] = static_cast<std::uint16_t>(std::clamp(place, 0.0, kSteps));
    }
  }
  if (times_.size() % kKeyInterval == 0) {
    before_.assign(3 * count, 0);
    for (std::size_t i = 1; i < 3 * count; ++i)
      if (i % count != 0) before_[i] = places[i - 1];
  }
  page_.add_block(fmt::format("{}pose{}", prefix_, times_.size()), pack_differences(places, before_));
  before_ = std::move(places);
  times_.push_back(time);
}

void PoseBlocks::finish() {
  page_.head()["box"] = box();
  page_.head()["times"] = times_;
  page_.head()["key_interval"] = kKeyInterval;
}

nlohmann::ordered_json PoseBlocks::box() const {
  return {{"lower", list_of(box_.lower)}, {"step", list_of(step_)}};
}

}  // namespace selvage
