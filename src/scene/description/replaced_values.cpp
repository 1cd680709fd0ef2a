#include "scene/description/replaced_values.h"

#include "scene/description/json_value.h"
#include "selvage/core/error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>

namespace selvage {

namespace {

/// Replaces the values that a scale names by their places (JSON pointers).
void apply_scale(Json& scene, const JsonValue& replacements) {
  if (!replacements.json().is_object()) replacements.fail("is no object", "use {\"/place/in/the/scene\": value, ...}");
  for (const auto& [key, value] : replacements.json().items()) {
    const JsonValue item = replacements.member(key);
    try {
      const Json::json_pointer place(key);
      const bool inside = !place.empty() && place.back() != "-" && scene.contains(place.parent_pointer());
      const bool added = inside && scene.at(place.parent_pointer()).is_object();
      if (!added && !(inside && scene.contains(place)))
        item.fail("is no place in the scene", "name one, as /bodies/0/mesh/cell");
      scene[place] = value;
    } catch (const nlohmann::json::exception&) {
      item.fail("is no place in the scene", "name one, as /bodies/0/mesh/cell");
    }
  }
}

/// The names in a JSON pointer.
std::vector<std::string> names_of(const std::string& pointer, const std::string& change) {
  Json::json_pointer place;
  try {
    place = Json::json_pointer(pointer);
  } catch (const nlohmann::json::exception&) {
    throw Error(change, fmt::format("'{}' is no place in a scene", pointer), "write /bodies/0/mesh/length=3");
  }
  std::vector<std::string> names;
  for (; !place.empty(); place.pop_back()) names.push_back(place.back());
  std::reverse(names.begin(), names.end());
  return names;
}

/// The item of a list that a name in a pointer means.
Json& item_of(Json& list, const std::string& name, const std::string& place, const std::string& change) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  if (error == std::errc() && end == name.data() + name.size() && number < list.size()) return list[number];
  throw Error(change, fmt::format("{} has no item '{}'", place, name),
              list.empty() ? "it is empty" : fmt::format("use 0 to {}", list.size() - 1));
}

}  // namespace

/// The document at the scale, without the scales.
Json choose_scale(Json document, const std::string& file, std::string_view scale) {
  const JsonValue root(document, file);
  std::vector<std::string> names;
  Json chosen = Json::object();
  std::string path;
  if (root.json().is_object() && root.json().contains("scales")) {
    const JsonValue scales = root.member("scales");
    if (!scales.json().is_object()) scales.fail("is no object", "use {\"name\": {...}, ...}");
    for (const auto& [name, value] : scales.json().items()) {
      names.push_back(name);
      if (name != scale) continue;
      path = scales.member(name).path();
      chosen = value;
    }
  }
  if (!scale.empty() && std::find(names.begin(), names.end(), scale) == names.end())
    throw Error(file, fmt::format("has no scale '{}'", scale),
                names.empty() ? "it has none" : fmt::format("use one of {}", fmt::join(names, ", ")));
  if (document.is_object()) document.erase("scales");
  apply_scale(document, JsonValue(chosen, file, path));
  return document;
}

void apply_change(Json& document, const std::string& change) {
  const std::size_t equals = change.find('=');
  const std::string pointer = change.substr(0, equals);
  if (equals == std::string::npos || pointer.empty() || pointer[0] != '/')
    throw Error(change, "does not say what to set", "write a place and a value, as /bodies/0/mesh/length=3");
  const std::string text = change.substr(equals + 1);
  const std::vector<std::string> names = names_of(pointer, change);
  if (names.front() == "scales") throw Error(change, "scales are chosen, not set", "name one with --scale");
  Json* value = &document;
  std::string place;
  for (const std::string& name : names) {
    if (value->is_array()) {
      value = &item_of(*value, name, place, change);
    } else if (value->is_object() || value->is_null()) {
      value = &(*value)[name];  // where it is new, the reader of the scene says whether it may be there
    } else {
      throw Error(change, fmt::format("{} is {}, which has no '{}'", place, value->dump(), name),
                  "name a member of an object or an item of a list");
    }
    place += '/' + name;
  }
  *value = Json::parse(text, nullptr, false);
  if (value->is_discarded()) *value = text;
}

}  // namespace selvage
