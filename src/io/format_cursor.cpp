#include "io/format_cursor.h"

#include "selvage/core/error.h"

#include <fmt/format.h>

#include <algorithm>

namespace selvage::format {

namespace {

constexpr std::string_view kCutShort = "the file is cut short; export it again";
constexpr std::string_view kMend = "mend the file or export it again";

}  // namespace

std::string quote(std::string_view token) {
  constexpr std::size_t kMaxShown = 24;
  std::string shown(token.substr(0, kMaxShown));
  for (char& c : shown) {
    if (c < ' ' || c > '~') c = '?';
  }
  return fmt::format("'{}{}'", shown, token.size() > kMaxShown ? "..." : "");
}

void Cursor::skip_blanks() {
  while (at_ != end_) {
    if (is_blank(*at_) || (!line_bound_ && *at_ == '\n')) {
      ++at_;
    } else if (comment_ && *at_ == comment_) {
      at_ = std::find(at_, end_, '\n');
    } else if (joins_lines_ && *at_ == '\\' && end_ - at_ > 1 && at_[1] == '\n') {
      at_ += 2;
    } else if (joins_lines_ && *at_ == '\\' && end_ - at_ > 2 && at_[1] == '\r' && at_[2] == '\n') {
      at_ += 3;
    } else {
      break;
    }
  }
  last_ = at_;
}

std::string_view Cursor::token() {
  const std::string_view found = peek();
  at_ += found.size();
  return found;
}

std::string_view Cursor::peek() {
  skip_blanks();
  const char* stop = at_;
  while (!is_separator(stop)) ++stop;
  return {at_, static_cast<std::size_t>(stop - at_)};
}

void Cursor::next_line() {
  const void* found = at_ == end_ ? nullptr : std::memchr(at_, '\n', remaining());
  at_ = found ? static_cast<const char*>(found) + 1 : end_;
}

bool Cursor::next_filled_line() {
  while (at_ != end_) {
    skip_blanks();
    if (at_ == end_) return false;
    if (*at_ != '\n') return true;
    ++at_;
  }
  return false;
}

std::string_view Cursor::line() {
  last_ = at_;
  next_line();
  std::string_view text(last_, static_cast<std::size_t>(at_ - last_));
  while (!text.empty() && (text.back() == '\n' || is_blank(text.back()))) text.remove_suffix(1);
  return text;
}

std::int64_t Cursor::integer(std::string_view what) {
  skip_blanks();
  const char* first = at_;
  if (first != end_ && *first == '+') ++first;
  std::int64_t value = 0;
  const auto [stop, status] = std::from_chars(first, end_, value);
  if (status != std::errc() || !is_separator(stop)) fail_expected(what);
  at_ = stop;
  return value;
}

std::int64_t Cursor::integer(Scalar type, std::string_view what) {
  if (!binary_) return integer(what);
  switch (type) {
    case Scalar::kInt8:
      return binary<std::int8_t>(what);
    case Scalar::kUint8:
      return binary<std::uint8_t>(what);
    case Scalar::kInt16:
      return binary<std::int16_t>(what);
    case Scalar::kUint16:
      return binary<std::uint16_t>(what);
    case Scalar::kInt32:
      return binary<std::int32_t>(what);
    case Scalar::kUint32:
      return binary<std::uint32_t>(what);
    case Scalar::kInt64:
    case Scalar::kUint64:  // beyond 2^63 it comes out negative, which no reader takes
      return binary<std::int64_t>(what);
    default:
      fail("whole numbers are stored as floats", "export the file again with whole numbers as integers");
  }
}

double Cursor::real(Scalar type, std::string_view what) {
  if (!binary_) return real(what);
  if (type == Scalar::kFloat) return static_cast<double>(binary<float>(what));
  if (type == Scalar::kDouble) return binary<double>(what);
  return static_cast<double>(integer(type, what));
}

double Cursor::real(std::string_view what) {
  skip_blanks();
  const char* first = at_;
  if (first != end_ && *first == '+') ++first;
  double value = 0;
  auto [stop, status] = std::from_chars(first, end_, value);
  if (status == std::errc::result_out_of_range) {
    // Too small for a double reads as zero, too large as infinity; a long double tells which.
    long double wide = 0;
    std::tie(stop, status) = [&] {
      const auto result = std::from_chars(first, end_, wide);
      return std::tuple(result.ptr, result.ec);
    }();
    value = static_cast<double>(wide);
  }
  if (status != std::errc() || !is_separator(stop)) fail_expected(what);
  at_ = stop;
  return value;
}

std::int64_t Cursor::count(std::string_view what, std::size_t bytes_each) {
  const std::int64_t value = integer(fmt::format("the number of {}", what));
  check_count(value, what, bytes_each);
  return value;
}

void Cursor::check_count(std::int64_t value, std::string_view what, std::size_t bytes_each) const {
  if (value < 0) fail(fmt::format("the number of {} is negative: {}", what, value), kMend);
  const std::size_t wanted = static_cast<std::size_t>(value);
  // In text the last thing of all needs no separator behind it.
  const std::size_t unfinished = binary_ ? 0 : 1;
  if (bytes_each > 0 && wanted > remaining() / bytes_each + unfinished) {
    fail(fmt::format("{} {} are announced, but only {} bytes follow", value, what, remaining()), kCutShort);
  }
  if (value > std::numeric_limits<Index>::max()) {
    fail(fmt::format("{} {} are too many: at most {} can be numbered", value, what, std::numeric_limits<Index>::max()),
         "split the mesh into several files");
  }
}

std::string Cursor::where() const {
  if (binary_) return fmt::format("{}: byte {}", name_, last_position());
  return fmt::format("{}:{}", name_, 1 + std::count(begin_, last_, '\n'));
}

void Cursor::fail(std::string_view what, std::string_view remedy) const {
  throw Error(where(), what, remedy);
}

void Cursor::fail_expected(std::string_view what) {
  const std::string_view found = peek();
  if (at_ == end_) fail(fmt::format("expected {}, found the end of the file", what), kCutShort);
  if (found.empty()) fail(fmt::format("expected {}, found the end of the line", what), kMend);
  fail(fmt::format("expected {}, found {}", what, quote(found)), kMend);
}

void Cursor::fail_not_finite() const {
  fail("a coordinate is not finite (NaN, infinite or beyond double)", "give every vertex three finite coordinates");
}

void Cursor::fail_cut_short(std::string_view what, std::size_t size) const {
  fail(fmt::format("expected {} ({} bytes), but only {} bytes follow", what, size, remaining()), kCutShort);
}

}  // namespace selvage::format
