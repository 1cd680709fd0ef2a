#include "page/form_blocks.h"

#include "page/encoding.h"
#include "page/page_surface.h"

#include <fmt/format.h>

namespace selvage {

FormBlocks::FormBlocks(Page& page, std::span<const Collider> colliders) {
  for (std::size_t c = 0; c < colliders.size(); ++c) {
    const auto* shape = std::get_if<KeyframedShape>(&colliders[c].shape);
    if (shape == nullptr) continue;
    PoseBox box;  // between key frames positions are linear: they stay in it
    for (const auto& positions : shape->positions)
      for (const Vec3& p : positions) box.add(p);
    const std::string name = fmt::format("collider{}", c);
    const Form& form = forms_.emplace_back(page, *shape, name, box);
    page.add_block(name + "triangles", pack_triangles(form.surface));
    auto& json = page.head()["scene"]["colliders"][c];
    for (const char* stored : {"times", "pc2", "triangles"}) json.erase(stored);
    json["vertices"] = form.surface.vertices.size();
    json["box"] = form.poses.box();
  }
}

void FormBlocks::add(double time) {
  for (Form& form : forms_) form.poses.add(form.shape.at(time).positions, time);
}

}  // namespace selvage
