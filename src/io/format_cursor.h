#pragma once

#include "io/format.h"
#include "selvage/core/types.h"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>

namespace selvage::format {

/// A value with its bytes in reverse order: big endian to little endian and back.
template <typename T>
T swap_bytes(T value) {
  std::array<std::byte, sizeof(T)> bytes;
  std::memcpy(bytes.data(), &value, sizeof(T));
  for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(bytes[i], bytes[sizeof(T) - 1 - i]);
  std::memcpy(&value, bytes.data(), sizeof(T));
  return value;
}

/// Type of a number in a binary file.
enum class Scalar { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kInt64, kUint64, kFloat, kDouble };

constexpr std::size_t size_of(Scalar type) {
  constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return kSizes[static_cast<int>(type)];
}

/// Reads a mesh file in memory from its start, text or binary, and never past its end. Every error names the file, and
/// the line (text) or the byte offset (binary) of what was read last.
///
/// Text: white space separates tokens; from the comment character to the end of the line nothing is read. While the
/// cursor is bound to lines, tokens and numbers end with the line, and next_line() goes on.
class Cursor {
 public:
  explicit Cursor(const Source& source, char comment = '\0')
      : begin_(source.bytes.data()),
        at_(begin_),
        last_(begin_),
        end_(begin_ + source.bytes.size()),
        name_(source.name),
        comment_(comment) {}

  void bind_to_lines(bool bound) { line_bound_ = bound; }

  /// A backslash before the end of a line joins the next line to it (OBJ).
  void join_lines_at_backslash() { joins_lines_ = true; }

  /// From here on errors name byte offsets, and numbers are read with this byte order.
  void enter_binary(std::endian order) {
    binary_ = true;
    swap_ = order != std::endian::native;
  }
  bool is_binary() const { return binary_; }
  /// Whether binary numbers are those of this machine.
  bool is_native() const { return binary_ && !swap_; }

  std::size_t position() const { return static_cast<std::size_t>(at_ - begin_); }
  std::size_t last_position() const { return static_cast<std::size_t>(last_ - begin_); }
  std::size_t remaining() const { return static_cast<std::size_t>(end_ - at_); }
  void move_to(std::size_t position) {
    at_ = last_ = begin_ + std::min(position, static_cast<std::size_t>(end_ - begin_));
  }

  /// The next token, empty at the end of the file (of the line, when bound to lines).
  std::string_view token();

  /// The next token without consuming it.
  std::string_view peek();

  /// Goes behind the end of the current line.
  void next_line();

  /// Goes to the first token of the current or a later line; false at the end of the file.
  bool next_filled_line();

  /// The rest of the line without its end, consumed with it.
  std::string_view line();

  /// Whole number; `what` completes "expected ...".
  std::int64_t integer(std::string_view what);

  /// Number, not necessarily finite.
  double real(std::string_view what);

  /// The same, of the given type where the file is binary.
  std::int64_t integer(Scalar type, std::string_view what);
  double real(Scalar type, std::string_view what);

  /// Finite number.
  double coordinate() {
    const double value = real("3 coordinates");
    if (!std::isfinite(value)) fail_not_finite();
    return value;
  }

  Vec3 point() {
    const double x = coordinate();
    const double y = coordinate();
    return {x, y, coordinate()};
  }

  /// Number of things that follow, each of at least `bytes_each` bytes; fails when the file cannot hold them.
  std::int64_t count(std::string_view what, std::size_t bytes_each);
  void check_count(std::int64_t value, std::string_view what, std::size_t bytes_each) const;

  /// `size` bytes as they are.
  std::string_view bytes(std::size_t size, std::string_view what) {
    last_ = at_;
    if (size > remaining()) fail_cut_short(what, size);
    at_ += size;
    return {last_, size};
  }

  /// All that follows, not consumed.
  std::string_view rest() const { return {at_, remaining()}; }

  /// One binary number.
  template <typename T>
  T binary(std::string_view what) {
    T value;
    std::memcpy(&value, bytes(sizeof(T), what).data(), sizeof(T));
    return swap_ ? swap_bytes(value) : value;
  }

  /// Three binary numbers, finite.
  template <typename T>
  Vec3 binary_point() {
    const std::size_t start = position();
    Vec3 p;
    for (int d = 0; d < 3; ++d) p[d] = static_cast<double>(binary<T>("3 coordinates"));
    last_ = begin_ + start;
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2])) fail_not_finite();
    return p;
  }

  /// Error at what was read last.
  [[noreturn]] void fail(std::string_view what, std::string_view remedy = {}) const;

  /// Error at what comes next: "expected ..., found ...".
  [[noreturn]] void fail_expected(std::string_view what);

  [[noreturn]] void fail_not_finite() const;

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f' || c == '\0'; }
  bool is_separator(const char* p) const {
    return p == end_ || is_blank(*p) || *p == '\n' || (comment_ && *p == comment_);
  }
  void skip_blanks();
  [[noreturn]] void fail_cut_short(std::string_view what, std::size_t size) const;
  std::string where() const;

  const char* begin_;
  const char* at_;
  const char* last_;
  const char* end_;
  std::string_view name_;
  char comment_;
  bool line_bound_ = false;
  bool joins_lines_ = false;
  bool binary_ = false;
  bool swap_ = false;
};

/// A token shortened and cleaned for an error message, in quotes.
std::string quote(std::string_view token);

}  // namespace selvage::format
