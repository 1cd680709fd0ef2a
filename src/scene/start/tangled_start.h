#pragma once

#include "selvage/scene/run.h"

namespace selvage {

/// Brings bodies out of themselves; to be called before the first step, where Scene::resolves_tangled_start.
///
/// A body wound into itself may have no ways out that contacts can follow step by step: they lead through most of its
/// elements, or through inverted ones, for which they wait. It stays wound then, and its frames take hundreds of times
/// as long as when it is free. So where more than a tenth of the boundary's vertices of a body are inside elements of
/// that body, it is moved by resolve_collisions(), as if it were without stress where it starts (or, with inverted
/// elements, towards its rest); pinned vertices and those that a handle holds stay where they are. What is less tangled
/// comes free by contacts within a few frames.
///
/// Velocities stay as they are. A body that cannot be resolved stays where it is. Deterministic.
///
/// @param crossings     of the state
/// @param on_iteration  called before each iteration; may be empty
/// @return how many bodies have been moved
Index resolve_tangled_start(const Scene& scene, const BodyCrossings& crossings, State& state,
                            const std::function<void(const StartProgress&)>& on_iteration);

}  // namespace selvage
