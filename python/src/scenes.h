#pragma once

#include "selvage/scene/scene.h"

#include <memory>

namespace selvage::python {

/// A scene of the package: solvers that run it share it.
struct SceneHandle {
  std::shared_ptr<const Scene> scene;
};

}  // namespace selvage::python
