#include "picture/camera_path.h"

#include <algorithm>

namespace selvage {

View view_at(std::span<const CameraKey> keys, double frame) {
  const auto after = std::ranges::find_if(keys, [&](const CameraKey& key) { return key.frame > frame; });
  if (after == keys.begin()) return keys.front().view;
  if (after == keys.end()) return keys.back().view;
  const CameraKey &a = *(after - 1), &b = *after;
  const double share = (frame - a.frame) / (b.frame - a.frame);
  const auto blend = [&](const Vec3& p, const Vec3& q) { return Vec3(p + share * (q - p)); };
  View view = a.view;
  view.eye = blend(*a.view.eye, *b.view.eye);
  view.target = blend(*a.view.target, *b.view.target);
  view.angle += share * (b.view.angle - a.view.angle);
  return view;
}

}  // namespace selvage
