#include "page/encoding.h"

#include <zlib.h>

#include <new>

namespace selvage {

std::string pack_integers(std::span<const std::int32_t> values, std::size_t stride) {
  const std::size_t count = values.size();
  std::string bytes(4 * count, '\0');
  for (std::size_t i = 0; i < count; ++i) {
    const auto before = i < stride ? 0u : static_cast<std::uint32_t>(values[i - stride]);
    const std::uint32_t difference = static_cast<std::uint32_t>(values[i]) - before;
    const std::uint32_t folded = (difference << 1) ^ (0u - (difference >> 31));
    for (std::size_t byte = 0; byte < 4; ++byte)
      bytes[byte * count + i] = static_cast<char>((folded >> (8 * byte)) & 0xff);
  }
  return bytes;
}

std::string pack_differences(std::span<const std::uint16_t> values, std::span<const std::uint16_t> before) {
  const std::size_t count = values.size();
  std::string bytes(2 * count, '\0');
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t difference = (std::uint32_t{values[i]} - before[i]) & 0xffff;
    const std::uint32_t folded = ((difference << 1) ^ (0u - (difference >> 15))) & 0xffff;
    bytes[i] = static_cast<char>(folded & 0xff);
    bytes[count + i] = static_cast<char>(folded >> 8);
  }
  return bytes;
}

std::string deflate_bytes(std::string_view bytes) {
  uLongf size = compressBound(bytes.size());
  std::string out(size, '\0');
  constexpr int kLevel = 6;
  // The buffer holds every outcome: only memory can be short.
  if (compress2(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(),
                kLevel) != Z_OK)
    throw std::bad_alloc();
  out.resize(size);
  return out;
}

std::string print_base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : kDigits[(group >> (18 - 6 * k)) & 63];
  }
  return text;
}

}  // namespace selvage
