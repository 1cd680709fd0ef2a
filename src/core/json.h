#pragma once

#include <nlohmann/json.hpp>

namespace selvage {

/// A JSON document whose members keep their order.
using Json = nlohmann::ordered_json;

}  // namespace selvage
