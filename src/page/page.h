#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace selvage {

/// A page under construction: what it says of itself, and named blocks of numbers.
class Page {
 public:
  /// @param kind   "run", "mesh", "discrete", "continuous", "paths" or "resolve"
  /// @param title  shown above the picture
  Page(std::string_view kind, std::string_view title);

  /// What the page knows besides its blocks, as JSON; the reader is viewer/src/head.ts.
  nlohmann::ordered_json& head() { return head_; }

  /// One line of the table beside the picture.
  void add_fact(std::string_view group, std::string_view name, std::string_view value);

  /// A line that is shown above everything else.
  void add_warning(std::string_view warning);

  /// A block of bytes, which is deflated and stored as base64.
  /// @param name  letters and digits; unique
  void add_block(std::string_view name, std::string_view bytes);

  /// The same for bytes that deflate_bytes() has been over.
  void add_deflated(std::string_view name, std::string_view deflated);

  /// Length of all blocks so far.
  std::size_t block_length() const { return blocks_.size(); }

  /// The whole page.
  std::string print() const;

 private:
  nlohmann::ordered_json head_;
  std::string blocks_;
};

/// Length of the blocks [characters] above which browsers do not open a page dependably.
inline constexpr std::size_t kMaxPageLength = 400'000'000;

}  // namespace selvage
