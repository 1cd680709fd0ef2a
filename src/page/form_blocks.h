#pragma once

#include "page/pose_blocks.h"
#include "selvage/simulation/collider.h"

#include <list>

namespace selvage {

/// Writes colliders that change their form: the surface of each as block `collider<c>triangles`, and its positions in
/// every pose of the page, as PoseBlocks. In the scene of the page the collider holds their count and box.
class FormBlocks {
 public:
  /// @param colliders  of the scene that the page has; those that keep their form are left as they are
  FormBlocks(Page& page, std::span<const Collider> colliders);

  /// Appends blocks `collider<c>pose<number>`: positions before the collider's own motion.
  /// @param time  of the pose [s]
  void add(double time);

 private:
  struct Form {
    const KeyframedShape& shape;
    ShownSurface surface;
    PoseBlocks poses;
    Form(Page& page, const KeyframedShape& keyframed, const std::string& name, const PoseBox& box)
        : shape(keyframed),
          surface(keyframed.positions.front().size(), keyframed.triangles),
          poses(page, surface, box, name) {}
  };
  std::list<Form> forms_;  // a list: poses refer to the surface
};

}  // namespace selvage
