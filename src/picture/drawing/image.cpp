#include "picture/drawing/image.h"

#include "core/parallel.h"
#include "selvage/core/error.h"

#include <png.h>

namespace selvage {

void write_png(const std::filesystem::path& path, const Image& image) {
  std::vector<std::array<std::uint8_t, 3>> bytes(static_cast<std::size_t>(image.width()) * image.height());
  parallel_for(image.height(), 16, [&](std::int64_t y) {
    for (int x = 0; x < image.width(); ++x) bytes[y * image.width() + x] = to_srgb(image.at(x, static_cast<int>(y)));
  });
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width());
  png.height = static_cast<png_uint_32>(image.height());
  png.format = PNG_FORMAT_RGB;
  const int written = png_image_write_to_file(&png, path.c_str(), 0, bytes.data(), 0, nullptr);
  const std::string reason = png.message;
  png_image_free(&png);
  if (!written) throw SystemError(path.string(), "cannot write the picture (" + reason + ")");
}

}  // namespace selvage
