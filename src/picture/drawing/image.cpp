#include "picture/drawing/image.h"

#include "core/parallel.h"
#include "selvage/core/error.h"

#include <png.h>

namespace selvage {

std::vector<std::array<std::uint8_t, 3>> srgb_bytes(const Image& image) {
  std::vector<std::array<std::uint8_t, 3>> bytes(static_cast<std::size_t>(image.width()) * image.height());
  parallel_for(image.height(), 16, [&](std::int64_t y) {
    for (int x = 0; x < image.width(); ++x) bytes[y * image.width() + x] = to_srgb(image.at(x, static_cast<int>(y)));
  });
  return bytes;
}

Image join_images(std::span<const Image> images) {
  int width = 0, height = 0;
  for (const Image& image : images) {
    width += image.width();
    height = std::max(height, image.height());
  }
  Image joined(width, height, Rgb::Ones());
  int left = 0;
  for (const Image& image : images) {
    for (int y = 0; y < image.height(); ++y)
      for (int x = 0; x < image.width(); ++x) joined.at(left + x, y) = image.at(x, y);
    left += image.width();
  }
  return joined;
}

void write_png(const std::filesystem::path& path, const Image& image) {
  const auto bytes = srgb_bytes(image);
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
