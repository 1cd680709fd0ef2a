#pragma once

#include "io/format_samples.h"

#include <zlib.h>

namespace selvage {

/// How VTK XML stores an array's bytes.
struct ArrayCode {
  std::size_t header_bytes;
  std::endian order;
  bool base64;
};

inline std::string encode_base64(std::string_view bytes) {
  constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : kAlphabet[bits >> (18 - 6 * k) & 63];
  }
  return text;
}

inline std::string encode_header(const std::vector<std::uint64_t>& numbers, const ArrayCode& code) {
  std::string bytes;
  for (const std::uint64_t number : numbers) {
    bytes += code.header_bytes == 8 ? packed<std::uint64_t>({number}, code.order)
                                    : packed<std::uint32_t>({static_cast<std::uint32_t>(number)}, code.order);
  }
  return bytes;
}

/// The number of bytes, then the bytes; in base64 both are one run.
inline std::string encode_plain(const std::string& bytes, const ArrayCode& code) {
  const std::string stored = encode_header({bytes.size()}, code) + bytes;
  return code.base64 ? encode_base64(stored) : stored;
}

/// Number of blocks, size of a block, size of the last where it is smaller, compressed sizes; then the blocks. In
/// base64 the header is a run of its own.
inline std::string encode_compressed(const std::string& bytes, const ArrayCode& code, std::size_t block_size) {
  std::vector<std::uint64_t> header = {(bytes.size() + block_size - 1) / block_size, block_size,
                                       bytes.size() % block_size};
  std::string blocks;
  for (std::size_t first = 0; first < bytes.size(); first += block_size) {
    const std::string_view block = std::string_view(bytes).substr(first, block_size);
    uLongf size = compressBound(block.size());
    std::string packed_block(size, '\0');
    EXPECT_EQ(compress(reinterpret_cast<Bytef*>(packed_block.data()), &size,
                       reinterpret_cast<const Bytef*>(block.data()), block.size()),
              Z_OK);
    blocks.append(packed_block, 0, size);
    header.push_back(size);
  }
  const std::string head = encode_header(header, code);
  return code.base64 ? encode_base64(head) + encode_base64(blocks) : head + blocks;
}

}  // namespace selvage
