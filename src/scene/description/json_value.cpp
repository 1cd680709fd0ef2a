#include "scene/description/json_value.h"

#include "selvage/core/error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

namespace selvage {

namespace {

constexpr std::size_t kMaxShown = 60;  // bytes of a wrong value that an error repeats

std::string allowed_numbers(const NumberRange& range) {
  if (std::isinf(range.most))
    return fmt::format("use a number {} {}", range.open_below ? "above" : "from", range.least);
  return fmt::format("use a number {} {} to {}", range.open_below ? "above" : "from", range.least, range.most);
}

/// Letters to insert, remove or replace between two words.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row[b.size()];
}

/// Text in quotes, without bytes that would break a line.
std::string quoted_text(const std::string& text) {
  return Json(text.substr(0, kMaxShown)).dump(-1, ' ', true, Json::error_handler_t::replace);
}

/// The parser's message, without its name and the number of the error.
std::string plain_message(const std::exception& error) {
  const std::string text = error.what();
  const std::size_t end = text.find("] ");
  return end == std::string::npos ? text : text.substr(end + 2);
}

std::string joined_path(const std::string& path, const std::string& key) {
  const bool plain = !key.empty() && std::all_of(key.begin(), key.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-';
  });
  if (!plain) return fmt::format("{}[{}]", path, quoted_text(key));
  return path.empty() ? key : path + "." + key;
}

/// Where a parser is, and the first key that an object has twice.
class PlaceInText {
 public:
  void note(Json::parse_event_t event, const Json& value) {
    using Event = Json::parse_event_t;
    if (event == Event::key) return enter_member(value.get_ref<const std::string&>());
    if (event == Event::object_end || event == Event::array_end) levels_.pop_back();
    const bool begins = event == Event::object_start || event == Event::array_start;
    if (begins) levels_.push_back({event == Event::array_start, 0, {}, {}});
    // An item has ended; an object or array that begins has not.
    if (!begins && !levels_.empty()) ++levels_.back().item;
  }

  std::string path() const {
    std::string path;
    for (const Level& level : levels_) {
      if (level.is_list) path += fmt::format("[{}]", level.item);
      if (!level.is_list) path = joined_path(path, level.key);
    }
    return path;
  }
  const std::string& twice() const { return twice_; }

 private:
  struct Level {
    bool is_list;
    std::size_t item;
    std::string key;
    std::set<std::string> keys;
  };
  void enter_member(const std::string& key) {
    levels_.back().key = key;
    if (!levels_.back().keys.insert(key).second && twice_.empty()) twice_ = path();
  }

  std::vector<Level> levels_;
  std::string twice_;
};

}  // namespace

void JsonValue::fail(std::string_view what, std::string_view allowed) const {
  throw Error(path_.empty() ? file_ : fmt::format("{}: {}", file_, path_), what, allowed);
}

std::string JsonValue::path_of(const std::string& key) const {
  return joined_path(path_, key);
}

std::string JsonValue::shown() const {
  std::string text = json_->dump(-1, ' ', true, Json::error_handler_t::replace);
  if (text.size() > kMaxShown) text = text.substr(0, kMaxShown) + "...";
  return text;
}

double JsonValue::any_number() const {
  const double infinity = std::numeric_limits<double>::infinity();
  if (!json_->is_number()) fail(fmt::format("{} is no number", shown()), "use a number");
  const double value = json_->get<double>();
  if (!(std::abs(value) < infinity)) fail("is no finite number", "use a number");
  return value;
}

double JsonValue::number(const NumberRange& range) const {
  if (!json_->is_number()) fail(fmt::format("{} is no number", shown()), allowed_numbers(range));
  const double value = any_number();
  const bool enough = range.open_below ? value > range.least : value >= range.least;
  if (!enough || value > range.most) fail(fmt::format("{} is out of range", shown()), allowed_numbers(range));
  return value;
}

std::int64_t JsonValue::integer(std::int64_t least, std::int64_t most) const {
  const std::string allowed = fmt::format("use a whole number from {} to {}", least, most);
  if (!json_->is_number_integer()) fail(fmt::format("{} is no whole number", shown()), allowed);
  const bool huge = json_->is_number_unsigned() && json_->get<std::uint64_t>() > std::uint64_t{1} << 62;
  if (huge || json_->get<std::int64_t>() < least || json_->get<std::int64_t>() > most)
    fail(fmt::format("{} is out of range", shown()), allowed);
  return json_->get<std::int64_t>();
}

bool JsonValue::boolean() const {
  if (!json_->is_boolean()) fail(fmt::format("{} is neither true nor false", shown()), "use true or false");
  return json_->get<bool>();
}

const std::string& JsonValue::text() const {
  if (!json_->is_string()) fail(fmt::format("{} is no text", shown()), "use text in quotes");
  return json_->get_ref<const std::string&>();
}

std::size_t JsonValue::choice(std::span<const std::string_view> names) const {
  const std::string allowed = fmt::format("use one of {}", fmt::join(names, ", "));
  if (!json_->is_string()) fail(fmt::format("{} is no name", shown()), allowed);
  const auto found = std::find(names.begin(), names.end(), json_->get_ref<const std::string&>());
  if (found == names.end()) fail(fmt::format("there is no {}", shown()), allowed);
  return static_cast<std::size_t>(found - names.begin());
}

Vec3 JsonValue::vector() const {
  if (!json_->is_array() || json_->size() != 3) fail(fmt::format("{} is no vector", shown()), "use [x, y, z]");
  Vec3 result;
  for (int axis = 0; axis < 3; ++axis)
    result[axis] = JsonValue((*json_)[axis], file_, fmt::format("{}[{}]", path_, axis)).any_number();
  return result;
}

Vec3 JsonValue::direction() const {
  const Vec3 given = vector();
  const double largest = given.cwiseAbs().maxCoeff();
  if (largest == 0) fail("is no direction", "use three numbers, not all 0");
  return (given / largest).normalized();
}

std::vector<JsonValue> JsonValue::items() const {
  if (!json_->is_array()) fail(fmt::format("{} is no list", shown()), "use [...]");
  std::vector<JsonValue> result;
  for (std::size_t i = 0; i < json_->size(); ++i)
    result.emplace_back((*json_)[i], file_, fmt::format("{}[{}]", path_, i));
  return result;
}

JsonObject::JsonObject(const JsonValue& value) : value_(value) {
  if (!value.json().is_object()) value.fail("is no object", "use {...}");
}

std::optional<JsonValue> JsonObject::find(std::string_view key) {
  known_.push_back(key);
  const std::string name(key);
  if (!value_.json().contains(name)) return std::nullopt;
  return value_.member(name);
}

JsonValue JsonObject::get(std::string_view key) {
  auto found = find(key);
  if (!found) value_.fail(fmt::format("has no '{}'", key), "add it");
  return *found;
}

std::pair<std::size_t, JsonValue> JsonObject::get_one_of(std::span<const std::string_view> keys) {
  std::optional<std::pair<std::size_t, JsonValue>> chosen;
  const std::string allowed = fmt::format("give one of {}", fmt::join(keys, ", "));
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const auto found = find(keys[i]);
    if (!found) continue;
    if (chosen) value_.fail(fmt::format("has both '{}' and '{}'", keys[chosen->first], keys[i]), allowed);
    chosen.emplace(i, *found);
  }
  if (!chosen) {
    refuse_others();
    value_.fail("says too little", allowed);
  }
  return *chosen;
}

void JsonObject::refuse_others() const {
  for (const auto& [key, ignored] : value_.json().items()) {
    if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
    const std::string_view nearest = nearest_name(key, known_);
    const bool is_near = 5 * edit_distance(key, nearest) <= 2 * key.size();
    value_.member(key).fail("is not known here",
                            fmt::format("{}llowed are {}", is_near ? fmt::format("did you mean '{}'? A", nearest) : "a",
                                        fmt::join(known_, ", ")));
  }
}

Json parse_json(std::string_view text, const std::string& file) {
  PlaceInText place;
  const auto watch = [&](int, Json::parse_event_t event, Json& value) {
    place.note(event, value);
    return true;
  };
  Json json;
  try {
    json = Json::parse(text, watch);
  } catch (const Json::out_of_range&) {
    throw Error(fmt::format("{}: {}", file, place.path()), "is a number too large", "use a finite number");
  } catch (const nlohmann::json::exception& error) {
    std::string message = plain_message(error);
    std::replace(message.begin(), message.end(), '\n', ' ');
    throw Error(file, message, "give a scene in JSON, as docs/guides/scene_files.md explains");
  }
  if (!place.twice().empty())
    throw Error(fmt::format("{}: {}", file, place.twice()), "is there twice", "keep one of them");
  return json;
}

std::string_view nearest_name(std::string_view word, std::span<const std::string_view> names) {
  return *std::min_element(names.begin(), names.end(), [&](std::string_view a, std::string_view b) {
    return edit_distance(word, a) < edit_distance(word, b);
  });
}

}  // namespace selvage
