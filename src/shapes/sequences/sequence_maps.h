#pragma once

#include "selvage/core/types.h"

namespace selvage {

// Maps from material (sequence_material.h) and time, 0 to 1, to space: one a sequence.

Vec3 place_pipe(const Vec3& material, double time);
Vec3 place_karate(const Vec3& material, double time);
Vec3 place_shirt(const Vec3& material, double time);
Vec3 place_funnel(const Vec3& material, double time);
Vec3 place_flamenco(const Vec3& material, double time);
Vec3 place_waves(const Vec3& material, double time);
Vec3 place_crumple(const Vec3& material, double time);

}  // namespace selvage
