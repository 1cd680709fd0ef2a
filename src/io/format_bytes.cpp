#include "io/format_bytes.h"

#include "io/format_cursor.h"

#include <fmt/format.h>
#include <zlib.h>

#include <optional>

namespace selvage::format {

namespace {

constexpr int kPadding = 64, kSpace = 65, kInvalid = 66;

constexpr std::array<std::uint8_t, 256> make_base64_table() {
  std::array<std::uint8_t, 256> table{};
  for (auto& entry : table) entry = kInvalid;
  constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t i = 0; i < kAlphabet.size(); ++i)
    table[static_cast<unsigned char>(kAlphabet[i])] = static_cast<std::uint8_t>(i);
  table['='] = kPadding;
  for (const unsigned char c : {' ', '\t', '\r', '\n'}) table[c] = kSpace;
  return table;
}

constexpr std::array<std::uint8_t, 256> kBase64 = make_base64_table();

/// zlib turns one byte into at most 1032.
constexpr std::uint64_t kMaxInflation = 1032;

std::optional<std::uint64_t> read_header_number(ByteStream& stream, const BlockLayout& layout) {
  std::string bytes;
  if (!stream.read(layout.header_bytes, bytes)) return std::nullopt;
  if (layout.header_bytes == 8) {
    std::uint64_t value;
    std::memcpy(&value, bytes.data(), 8);
    return layout.swap ? swap_bytes(value) : value;
  }
  std::uint32_t value;
  std::memcpy(&value, bytes.data(), 4);
  return layout.swap ? swap_bytes(value) : value;
}

bool inflate_block(std::string_view block, std::uint64_t size, std::string& out) {
  const std::size_t start = out.size();
  out.resize(start + size);
  uLongf inflated = size;
  const int status = uncompress(reinterpret_cast<Bytef*>(out.data() + start), &inflated,
                                reinterpret_cast<const Bytef*>(block.data()), block.size());
  return status == Z_OK && inflated == size;
}

bool read_compressed(ByteStream& stream, const BlockLayout& layout, std::string& out, std::string& problem) {
  problem = "its header is cut short";
  const auto blocks = read_header_number(stream, layout);
  if (!blocks) return false;
  if (*blocks == 0) return true;
  const auto block_size = read_header_number(stream, layout);
  const auto last_size = read_header_number(stream, layout);
  if (!block_size || !last_size || *blocks > stream.remaining() / layout.header_bytes) return false;
  std::vector<std::uint64_t> sizes;
  sizes.reserve(*blocks);
  for (std::uint64_t b = 0; b < *blocks; ++b) {
    const auto size = read_header_number(stream, layout);
    if (!size) return false;
    sizes.push_back(*size);
  }
  std::string block;
  for (std::uint64_t b = 0; b < *blocks; ++b) {
    const std::uint64_t inflated = b + 1 == *blocks && *last_size != 0 ? *last_size : *block_size;
    block.clear();
    if (!stream.read(sizes[b], block)) {
      problem = fmt::format("block {} is cut short", b);
      return false;
    }
    if (inflated / kMaxInflation > sizes[b] || !inflate_block(block, inflated, out)) {
      problem = fmt::format("block {} cannot be decompressed to {} bytes", b, inflated);
      return false;
    }
  }
  return true;
}

}  // namespace

bool ByteStream::decode_quad() {
  int digits[4];
  int found = 0;
  while (found < 4 && !text_.empty()) {
    const int code = kBase64[static_cast<unsigned char>(text_.front())];
    text_.remove_prefix(1);
    if (code == kInvalid) return false;
    if (code != kSpace) digits[found++] = code;
  }
  if (found < 4 || digits[0] == kPadding || digits[1] == kPadding) return false;
  const int bits = digits[0] << 18 | digits[1] << 12 | (digits[2] & 63) << 6 | (digits[3] & 63);
  pending_count_ = digits[2] == kPadding ? 1 : digits[3] == kPadding ? 2 : 3;
  for (std::size_t i = 0; i < pending_count_; ++i) {
    pending_[pending_.size() - pending_count_ + i] = static_cast<char>(bits >> (16 - 8 * i));
  }
  return true;
}

bool ByteStream::read(std::size_t size, std::string& out) {
  if (size > remaining()) return false;
  if (!base64_) {
    out.append(text_.substr(0, size));
    text_.remove_prefix(size);
    return true;
  }
  out.reserve(out.size() + size);
  while (size > 0) {
    if (pending_count_ == 0 && !decode_quad()) return false;
    const std::size_t taken = std::min(size, pending_count_);
    out.append(pending_.data() + pending_.size() - pending_count_, taken);
    pending_count_ -= taken;
    size -= taken;
  }
  return true;
}

bool read_blocks(ByteStream& stream, const BlockLayout& layout, std::string& out, std::string& problem) {
  if (layout.compressed) return read_compressed(stream, layout, out, problem);
  const auto size = read_header_number(stream, layout);
  if (!size) {
    problem = "its header is cut short";
    return false;
  }
  if (!stream.read(*size, out)) {
    problem = fmt::format("{} bytes are announced, but at most {} follow", *size, stream.remaining());
    return false;
  }
  return true;
}

}  // namespace selvage::format
