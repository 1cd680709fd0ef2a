#pragma once

#include <gtest/gtest.h>
#include <zlib.h>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace selvage::test {

/// Text between two others, which come once; empty where they do not.
inline std::string between(const std::string& text, const std::string& before, const std::string& after) {
  const std::size_t at = text.find(before);
  if (at == std::string::npos) return {};
  const std::size_t begin = at + before.size();
  return text.substr(begin, text.find(after, begin) - begin);
}

inline nlohmann::json head_of(const std::string& page) {
  return nlohmann::json::parse(between(page, "<script type=\"application/json\" id=\"head\">", "</script>"));
}

inline std::string decode_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bits, bytes;
  for (const char c : text)
    for (int bit = 5; c != '=' && bit >= 0; --bit) bits += digits.find(c) >> bit & 1 ? '1' : '0';
  for (std::size_t i = 0; i + 8 <= bits.size(); i += 8)
    bytes += static_cast<char>(std::stoi(bits.substr(i, 8), nullptr, 2));
  return bytes;
}

inline std::string inflate_bytes(const std::string& bytes) {
  std::string out(1, '\0');
  for (;;) {
    uLongf size = out.size();
    const int status = uncompress(reinterpret_cast<Bytef*>(out.data()), &size,
                                  reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
    if (status == Z_OK) {
      out.resize(size);
      return out;
    }
    if (status != Z_BUF_ERROR || out.size() > (std::size_t{1} << 28)) return {};
    out.resize(2 * out.size());
  }
}

inline bool has_block(const std::string& page, const std::string& name) {
  return page.find("id=\"block-" + name + "\"") != std::string::npos;
}

/// Bytes of a block.
inline std::string block_of(const std::string& page, const std::string& name) {
  return inflate_bytes(decode_base64(between(page, "id=\"block-" + name + "\">", "</script>")));
}

/// Slow twin of what viewer/src/decode.ts does, in 64 bits.
inline std::vector<std::int64_t> unpack(const std::string& bytes, std::size_t bytes_each, std::size_t stride) {
  const std::size_t count = bytes.size() / bytes_each;
  const std::int64_t range = std::int64_t{1} << (8 * bytes_each);
  std::vector<std::int64_t> values;
  for (std::size_t i = 0; i < count; ++i) {
    std::int64_t folded = 0;
    for (std::size_t b = 0; b < bytes_each; ++b)
      folded += std::int64_t{static_cast<std::uint8_t>(bytes[b * count + i])} << (8 * b);
    const std::int64_t difference = folded % 2 == 0 ? folded / 2 : -(folded + 1) / 2;
    std::int64_t value = (i < stride ? 0 : values[i - stride]) + difference;
    while (value >= range / 2) value -= range;
    while (value < -range / 2) value += range;
    values.push_back(value);
  }
  return values;
}

}  // namespace selvage::test
