#pragma once

#include "selvage/simulation/collider.h"

#include <nlohmann/json.hpp>

namespace selvage {

/// The colliders of a run's scene.json, as print_scene() wrote them; none where the scene is null.
/// @param file  named in errors
/// @throws Error  when one of them is damaged
std::vector<Collider> read_stored_colliders(const nlohmann::ordered_json& scene, const std::string& file);

/// The gravity of the same file [m/s^2]; null where the scene is.
/// @throws Error  when it is damaged
Vec3 read_stored_gravity(const nlohmann::ordered_json& scene, const std::string& file);

}  // namespace selvage
