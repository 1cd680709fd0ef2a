#pragma once

#include "picture/drawing/colour.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace selvage {

/// A picture of width x height colours in linear light, row by row from the top left.
class Image {
 public:
  Image(int width, int height, const Rgb& colour = Rgb::Zero())
      : width_(width), height_(height), pixels_(static_cast<std::size_t>(width) * height, colour) {}

  int width() const { return width_; }
  int height() const { return height_; }
  Rgb& at(int x, int y) { return pixels_[static_cast<std::size_t>(y) * width_ + x]; }
  const Rgb& at(int x, int y) const { return pixels_[static_cast<std::size_t>(y) * width_ + x]; }

 private:
  int width_, height_;
  std::vector<Rgb> pixels_;
};

/// The picture as 8-bit sRGB, row by row.
std::vector<std::array<std::uint8_t, 3>> srgb_bytes(const Image& image);

/// Pictures of one height side by side.
Image join_images(std::span<const Image> images);

/// Writes the picture as an 8-bit sRGB PNG file. The same image gives the same bytes.
/// @throws SystemError  when the file cannot be written
void write_png(const std::filesystem::path& path, const Image& image);

}  // namespace selvage
