#pragma once

#include "selvage/simulation/model.h"
#include "selvage/simulation/motion.h"
#include "selvage/simulation/step.h"

#include <string_view>

namespace selvage {

/// @throws Error  where an option is impossible; it names the option and its range
void check_option(bool is_good, std::string_view name, double value, std::string_view range);
void check_options(const StepOptions& options);

/// @throws Error  where positions or velocities are not one for each vertex
void check_state(const Model& model, const State& state);

/// @throws Error  where there are forces, but not one for each vertex
void check_forces(const Model& model, std::span<const Vec3> external_forces);

/// @throws Error  where a motion is impossible, a vertex does not exist or two handles hold it
void check_handles(const Model& model, std::span<const Handle> handles);

}  // namespace selvage
