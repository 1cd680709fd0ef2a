#pragma once

#include "selvage/core/types.h"

namespace selvage {

/// How far elements turn around a ridge whose link (see PathTopology::Fans) turns by less than half a turn a step. All
/// are exact.

/// Whether a link does not come around to the direction of its first vertex. With positive elements its second vertex
/// is in the first half turn.
bool turns_once(std::span<const Vec2> positions, const VertexTuple<1>& ridge, std::span<const Index> link);
bool turns_once(std::span<const Vec3> positions, const VertexTuple<2>& ridge, std::span<const Index> link);

/// Whether it goes beyond that direction. To come around to exactly where it began is no more than a slit.
bool turns_beyond(std::span<const Vec2> positions, const VertexTuple<1>& ridge, std::span<const Index> link);
bool turns_beyond(std::span<const Vec3> positions, const VertexTuple<2>& ridge, std::span<const Index> link);

}  // namespace selvage
