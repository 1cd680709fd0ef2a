#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "geometry/contact_oracle.h"
#include "geometry/continuous_pairs.h"
#include "geometry/exact_oracle.h"

/// Random motions of the four points of a vertex and a face, or of two edges; many of them degenerate.
namespace selvage::test {

/// Eight points: four at time 0, then four at time 1.
using LatticeMotion = std::array<ExactVec<std::int64_t>, 8>;

inline MovingPoints to_points(const LatticeMotion& lattice, double scale = 1) {
  MovingPoints points;
  for (int i = 0; i < 4; ++i) {
    points.t0[i] = to_point<3>(lattice[i], scale);
    points.t1[i] = to_point<3>(lattice[4 + i], scale);
  }
  return points;
}

/// Kinds of lattice motion, from the plain to the most degenerate.
enum class MotionKind { kFree, kSlow, kTogether, kStill, kInOnePlane, kOnOneLine, kDegenerate, kAppointment, kCount };

/// Where the sets meet or nearly do: the first point of a set on a feature of the other.
inline void arrange_contact(RandomSource& random, ContinuousPair pair, ExactVec<std::int64_t>* p) {
  if (random.integer(0, 3) == 0) return;
  const std::int64_t i = random.integer(0, 4), j = pair == kVertexFace ? random.integer(0, 4) : 0;
  for (int k = 0; k < 3; ++k) {
    if (pair == kVertexFace)
      p[0][k] = p[1][k] + i * (p[2][k] - p[1][k]) / 4 + j * (p[3][k] - p[1][k]) / 4;
    else
      p[0][k] = p[2][k] + i * (p[3][k] - p[2][k]) / 4;
  }
}

inline LatticeMotion random_motion(RandomSource& random, ContinuousPair pair, MotionKind kind) {
  const std::int64_t range = random.integer(1, 6);
  LatticeMotion x;
  for (auto& point : x)
    for (auto& c : point) c = 4 * random.integer(-range, range);
  const auto point_at = [&](int i, int k, std::int64_t n) { return x[i][k] + n; };
  switch (kind) {
    case MotionKind::kSlow:
      for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 3; ++k) x[4 + i][k] = point_at(i, k, random.integer(-2, 2));
      break;
    case MotionKind::kTogether: {
      arrange_contact(random, pair, x.data());
      const auto velocity = random.lattice_point<3>(range);
      for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 3; ++k) x[4 + i][k] = point_at(i, k, velocity[k]);
      if (random.integer(0, 1) == 0) x[random.integer(0, 7)][random.integer(0, 2)] += random.integer(-1, 1);
      break;
    }
    case MotionKind::kStill:
      arrange_contact(random, pair, x.data());
      for (int i = 0; i < 4; ++i) x[4 + i] = x[i];
      break;
    case MotionKind::kInOnePlane: {
      const std::int64_t a = random.integer(-1, 1), b = random.integer(-1, 1);
      for (auto& point : x) point[2] = a * point[0] + b * point[1];
      break;
    }
    case MotionKind::kOnOneLine: {
      const std::int64_t a = random.integer(-1, 1), b = random.integer(-1, 1);
      for (auto& point : x) {
        point[1] = a * point[0];
        point[2] = b * point[0];
      }
      break;
    }
    case MotionKind::kDegenerate: {
      const auto i = random.integer(0, 3), j = random.integer(0, 3);
      x[i] = x[j];
      if (random.integer(0, 2) != 0) x[4 + i] = x[4 + j];
      if (random.integer(0, 3) == 0) x[4 + random.integer(0, 3)] = x[4 + random.integer(0, 3)];
      break;
    }
    case MotionKind::kAppointment: {  // in contact at some fraction of the time
      arrange_contact(random, pair, x.data());
      const std::int64_t before = random.integer(0, 3), after = random.integer(0, 3);
      for (int i = 0; i < 4; ++i) {
        const auto velocity = random.lattice_point<3>(3);
        for (int k = 0; k < 3; ++k) {
          x[4 + i][k] = x[i][k] + after * velocity[k];
          x[i][k] -= before * velocity[k];
        }
      }
      if (random.integer(0, 2) == 0) x[random.integer(0, 7)][random.integer(0, 2)] += random.integer(-1, 1);
      break;
    }
    default:
      break;
  }
  return x;
}

inline MotionKind kind_of(std::int64_t n) {
  return static_cast<MotionKind>(n % static_cast<int>(MotionKind::kCount));
}

/// Doubles: in contact at some time up to rounding, or anywhere.
inline MovingPoints random_doubles(RandomSource& random, ContinuousPair pair, double scale) {
  std::array<Vec3, 4> meeting;
  for (Vec3& p : meeting) p = random.point<3>();
  const double s = random.integer(0, 2) == 0 ? 0 : random.uniform(),
               t = random.integer(0, 3) == 0 ? 0 : random.uniform();
  if (pair == kVertexFace)
    meeting[0] = meeting[1] + s * (meeting[2] - meeting[1]) + t * (meeting[3] - meeting[1]);
  else
    meeting[0] = meeting[2] + s * (meeting[3] - meeting[2]) + 0.01 * t * (meeting[1] - meeting[2]);
  const double when = random.integer(0, 5) == 0 ? 0 : 0.5 + 0.5 * random.uniform();
  const double speed = std::ldexp(1.0, static_cast<int>(random.integer(-8, 1)));
  MovingPoints points;
  for (int i = 0; i < 4; ++i) {
    const Vec3 velocity = speed * random.point<3>();
    points.t0[i] = scale * (meeting[i] - when * velocity);
    points.t1[i] = scale * (meeting[i] + (1 - when) * velocity);
  }
  if (random.integer(0, 7) == 0)
    for (int i = 0; i < 4; ++i) points.t0[i][2] = points.t1[i][2] = points.t0[0][2];
  if (random.integer(0, 7) == 0) points.t1 = points.t0;
  return points;
}

/// Points on a lattice, up to rounding: points of one lattice that have come to rest on each other, so that they
/// meet, or nearly do, at the beginning of a small motion.
inline MovingPoints random_resting(RandomSource& random, ContinuousPair pair) {
  const double cell = 0.05, speed = std::ldexp(1.0, static_cast<int>(random.integer(-24, -6)));
  const bool is_tilted = random.integer(0, 3) == 0;
  const double z = random.integer(0, 1) == 0 ? 0 : random.uniform();
  MovingPoints points;
  const Vec3 velocities[2] = {speed * random.point<3>(), speed * random.point<3>()};
  for (int i = 0; i < 4; ++i) {
    const Vec3 place = to_point<3>({random.integer(0, 2), random.integer(0, 2), 0}, cell);
    points.t0[i] = {place[0], place[1], z + (is_tilted ? 0.1 * place[0] + 0.3 * place[1] : 0)};
    for (int k = 0; k < 3; ++k) points.t0[i][k] += 0x1p-56 * static_cast<double>(random.integer(-2, 2));
    const bool is_first = i < (pair == kVertexFace ? 1 : 2);
    points.t1[i] = points.t0[i] + velocities[is_first];
    if (random.integer(0, 1) == 0) points.t1[i] += 0x1p-10 * speed * random.point<3>();
  }
  return points;
}

/// Some coordinates are far smaller than the others, so that together they have many digits.
inline MovingPoints random_mixed(RandomSource& random, ContinuousPair pair) {
  MovingPoints points = random_doubles(random, pair, 1);
  const auto range = static_cast<int>(random.integer(0, 80));
  for (auto changes = random.integer(1, 8); changes > 0; --changes) {
    auto& positions = random.integer(0, 1) == 0 ? points.t0 : points.t1;
    positions[random.integer(0, 3)][random.integer(0, 2)] = random.with_exponent(-range, 0);
  }
  return points;
}

/// Doubles of all these kinds in turn.
inline MovingPoints hostile_doubles(RandomSource& random, ContinuousPair pair, std::int64_t n) {
  constexpr double kScales[] = {1, 1e150, 1e-150, 0x1p-1060};
  switch (n % 3) {
    case 0:
      return random_resting(random, pair);
    case 1:
      return random_mixed(random, pair);
    default:
      return random_doubles(random, pair, kScales[n % 4]);
  }
}

}  // namespace selvage::test
