// libFuzzer target: whatever the bytes, a scene is understood at each of its scales, or refused by an Error of one
// line.
#include "scene/description/scene_description.h"
#include "selvage/core/error.h"

#include <cstdlib>

namespace {

using namespace selvage;

void check_promises(const SceneDescription& scene) {
  if (scene.bodies.empty() || !(scene.options.time_step > 0) || scene.frames < 0) std::abort();
  for (const BodyDescription& body : scene.bodies)
    if (body.instances.empty() || !body.velocity.allFinite() || !(body.material.solid.density > 0) ||
        !(body.material.cloth.density > 0))
      std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* bytes, std::size_t size) {
  for (const std::string_view scale : {"", "paper"}) {
    try {
      check_promises(describe_scene({reinterpret_cast<const char*>(bytes), size}, "scene.json", scale));
    } catch (const Error& error) {
      if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
    }
  }
  return 0;
}
