#pragma once

#include "core/json.h"
#include "selvage/core/types.h"

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace selvage {

/// Bounds of a number that a document may hold.
struct NumberRange {
  double least, most;
  bool open_below = false;  ///< `least` itself is excluded
};

inline constexpr NumberRange kPositive{0, std::numeric_limits<double>::infinity(), true};
inline constexpr NumberRange kNotNegative{0, std::numeric_limits<double>::infinity()};

/// A value of a JSON document with its place in it, so that every complaint names the file, the path (as in
/// `bodies[2].material.poisson_ratio`), what is wrong and what is allowed.
class JsonValue {
 public:
  JsonValue(const Json& json, std::string file, std::string path = {})
      : json_(&json), file_(std::move(file)), path_(std::move(path)) {}

  const Json& json() const { return *json_; }
  const std::string& file() const { return file_; }
  const std::string& path() const { return path_; }

  /// @throws Error  all of these, when the value is of another kind or out of range
  double number(const NumberRange& range) const;
  double any_number() const;
  std::int64_t integer(std::int64_t least, std::int64_t most) const;
  bool boolean() const;
  const std::string& text() const;
  /// Number of the one of `names` that the text is.
  std::size_t choice(std::span<const std::string_view> names) const;
  Vec3 vector() const;
  /// A vector of any length but 0, scaled to length 1.
  Vec3 direction() const;
  /// The items of an array.
  std::vector<JsonValue> items() const;

  JsonValue member(const std::string& key) const { return {json_->at(key), file_, path_of(key)}; }

  [[noreturn]] void fail(std::string_view what, std::string_view allowed) const;

 private:
  std::string path_of(const std::string& key) const;
  std::string shown() const;

  const Json* json_;
  std::string file_, path_;
};

/// The members of an object; those that were asked for are the ones that are allowed.
class JsonObject {
 public:
  /// @throws Error  when the value is no object
  explicit JsonObject(const JsonValue& value);

  /// The member of that name, if it is there.
  std::optional<JsonValue> find(std::string_view key);
  /// @throws Error  when it is missing
  JsonValue get(std::string_view key);
  /// The one member of which exactly one must be there: its number among `keys`, and the value.
  /// @throws Error  when none or several are there
  std::pair<std::size_t, JsonValue> get_one_of(std::span<const std::string_view> keys);

  /// @throws Error  when the object has a member that was never asked for; it names the nearest allowed one
  void refuse_others() const;

  const JsonValue& value() const { return value_; }

 private:
  JsonValue value_;
  std::vector<std::string_view> known_;
};

/// Parses a JSON document.
/// @throws Error  one line with the file, line and column; also for a key that an object has twice
Json parse_json(std::string_view text, const std::string& file);

/// The one of `names` that takes the fewest changes of letters to become `word`.
std::string_view nearest_name(std::string_view word, std::span<const std::string_view> names);

}  // namespace selvage
