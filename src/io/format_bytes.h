#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

namespace selvage::format {

/// Bytes written as they are or as base64 text (several padded runs may follow each other).
class ByteStream {
 public:
  ByteStream(std::string_view text, bool base64) : text_(text), base64_(base64) {}

  /// At most this many bytes follow.
  std::size_t remaining() const { return base64_ ? (text_.size() / 4 + 1) * 3 + pending_count_ : text_.size(); }

  /// Appends `size` bytes to `out`; false when fewer follow.
  bool read(std::size_t size, std::string& out);

 private:
  bool decode_quad();

  std::string_view text_;
  bool base64_;
  std::array<char, 3> pending_{};  // decoded, not yet asked for: the last pending_count_ of them
  std::size_t pending_count_ = 0;
};

/// How VTK XML stores an array: a header of one or more unsigned numbers, then the data, whole or in zlib blocks.
struct BlockLayout {
  std::size_t header_bytes;  // of each header number: 4 or 8
  bool swap;
  bool compressed;
};

/// Reads one array's bytes; false with a `problem` when they are cut short or damaged.
bool read_blocks(ByteStream& stream, const BlockLayout& layout, std::string& out, std::string& problem);

}  // namespace selvage::format
