#pragma once

#include "selvage/scene/run.h"

#include <span>

namespace selvage {

/// Steps a frame where the scene gives none: 5; with XPBD 10 where there is cloth, which is stiff for its weight, up to
/// 50 where cloth has more to carry than these can, densities differ or a body is thrown faster, and up to 200 where
/// compact bodies may have to carry one another.
///
/// XPBD carries what lies on a body by as much as the material moves the body's surface back in a step: for a load, as
/// much as the step's length squared over the mass of that surface. Where densities differ more than fivefold, steps
/// are shorter by the root. What carries much, is small or has small elements gives way like a softer body, and a tower
/// of such falls: steps are so many that one stands of each compact body under the densest other. A contact moves the
/// heavier of two by little, so that a sheet that hangs is stretched until what it moves back in a step is enough. A
/// ball of 600 times the mass for its size of the sheet that catches it takes 19 steps, one of 3,600 times 47: by 10
/// the sheet is stretched by hundreds of times the energy of the fall.
///
/// A body that flies past more than one of its edges in a step and hits something is held back before its elements can
/// be pressed, and stops dead where it should spring back: by its velocity at the start no body flies past more than
/// half of one.
///
/// @param frame_length  [s]
int default_substeps(const Model& model, SolverKind solver, double frame_length, const StepOptions& options);

/// How often steps of the next frame are halved where the program chooses them (Scene::may_halve_steps).
///
/// A body may need shorter steps while it is pressed than it takes at rest. Three iterations do not carry the pressure
/// through its elements then: they end the step inverted, are held back, and so in the next one, for good. So where
/// vertices have been held back in each frame of the last quarter of a second, and more than one in a thousand elements
/// of a body that is awake, and at least four, have less than a tenth of their volume, steps are halved; and again
/// after another second like that, if a frame has no more than 30 then. But not where bodies were in one another or in
/// colliders at the end of the last frame: steps cost most there, and shorter ones make no room.
///
/// Steps are whole again a second after nothing is thin, and that once in a run: a heap that needs halves at rest, too,
/// would be shaken by each change, and never sleep. And where a body has less than half of its volume.
///
/// Source of these numbers: docs/notes/simulation.md. O(n + rows).
///
/// @param rows  of all frames so far, the last that of `state`
int default_halvings(const Scene& scene, const State& state, std::span<const FrameStatistics> rows);

}  // namespace selvage
