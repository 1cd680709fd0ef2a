#pragma once

#include "core/json.h"

#include <string>
#include <string_view>

namespace selvage {

/// The document at one of its scales, without the scales.
///
/// @param file    name of the document, for errors
/// @param scale   name of a scale; empty: as the document stands
/// @throws Error  when there is no such scale, or it names a place that is not in the scene
Json choose_scale(Json document, const std::string& file, std::string_view scale);

/// Sets one value of a document: `/bodies/0/mesh/length=3`, a JSON pointer and JSON, or else a text. Members of objects
/// that are not there are added; the reader of the scene refuses those that it does not know.
///
/// @throws Error  names the change, and the first part of its place that cannot be
void apply_change(Json& document, const std::string& change);

}  // namespace selvage
