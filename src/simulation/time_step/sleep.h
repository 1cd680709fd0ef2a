#pragma once

#include "selvage/simulation/model.h"
#include "simulation/colliders/prepared_collider.h"
#include "simulation/rigid_motion.h"

namespace selvage {

/// State::rest_times from which on a body sleeps [s].
inline constexpr double kSleepTime = 0.5;

/// Bodies that stand still until something reaches them. Contacts that are solved step by step leave a heap trembling;
/// so what has come to rest is held.
///
/// A body is slow where all but 2% of its mass moves slower than a part of the speed of a fall through its own size,
/// and none of its vertices penetrates. Bodies whose boxes overlap are near one another. Those that are near, and those
/// near these, are a group. A group that is slow for half a second sleeps: its vertices keep their places, as if
/// pinned, and have no velocity. It wakes as a whole where one that is not slow comes near. A body wakes where a
/// collider that moves comes near it, a handle of it moves or is released, or it is given a velocity. Before it sleeps,
/// a group of several bodies settles: while it is nearly slow, it is damped but for the velocity that all have in
/// common, so that what slides or falls together does so as before; that is damped too, less, where the bodies on
/// colliders do not move along; and what only trembles in its place, at that pace and for some seconds, sleeps too. A
/// body alone on a collider loses its spin likewise: nothing else resists rolling.
///
/// All that lasts from step to step is State::rest_times. The same bits for any number of threads.
/// Source for groups, times and thresholds: Catto, Box2D (islands of contacts; here of boxes, which need no memory).
class Sleep {
 public:
  /// @param model    must outlive this
  /// @param part     StepOptions::sleep_speed, above 0
  /// @param gravity  [m/s^2]; without it nothing ever sleeps, since what drifts is not at rest
  Sleep(const Model& model, double part, const Vec3& gravity);

  /// Decides which bodies sleep in a step. O(bodies), and O(n) for each collider that moves.
  /// @param is_disturbed  (n_bodies) not 0: awake whatever it did before
  /// @param colliders     those that move in the step wake what they are near to
  void begin(const State& state, double start_time, double end_time, std::vector<std::uint8_t> is_disturbed,
             std::span<const PreparedCollider> colliders);

  /// No body sleeps in the step, nor comes closer to it.
  void begin_awake();

  bool is_asleep(Index body) const { return is_asleep_[body] != 0; }
  bool are_all_asleep() const { return asleep_count_ > 0 && asleep_count_ == std::ssize(is_asleep_); }
  std::int64_t asleep_count() const { return asleep_count_; }

  /// Takes over into State::rest_times what the step has shown, and stops what falls asleep. O(n).
  /// @param step         its length [s]
  /// @param penetrating  vertices, in any order, also more than once
  /// @param carried      those that colliders have pushed, likewise
  /// @param state        at the end of the step
  void finish(double step, std::span<const Index> penetrating, std::span<const Index> carried, State& state) const;

 private:
  enum class Pace : std::uint8_t { kFast, kSettling, kTrembling, kSleepy };
  struct Group;

  Eigen::AlignedBox3d box_of(const Body& body, std::span<const Vec3> positions) const;
  MomentumSums momentum_of(const Body& body, const State& state) const;
  void damp_spin(const Body& body, double kept, State& state) const;
  void disturb_near(std::span<const PreparedCollider> colliders, const State& state, double start_time,
                    double end_time);
  Pace pace_of(Index body, const State& state) const;
  std::vector<Pace> paces_of(std::span<const Index> penetrating, const State& state) const;
  double rest_time_of(Index body, Pace pace, bool is_alone, double step, const State& state) const;
  std::vector<Index> groups_of(const State& state, double step) const;
  void add_up(std::span<const std::uint8_t> is_carried, std::span<const Index> of_body, const State& state,
              std::span<Group> groups) const;

  const Model& model_;
  bool has_gravity_;
  std::vector<double> speeds_;                          ///< (n_bodies) below which a vertex is slow [m/s]
  std::vector<double> masses_;                          ///< (n_bodies) of what is not pinned [kg]
  std::vector<double> gaps_;                            ///< (n_bodies) by which a box is larger than the body [m]
  std::vector<std::uint8_t> is_disturbed_, is_asleep_;  ///< (n_bodies) in this step
  std::vector<Index> body_of_;                          ///< (n_vertices), kNone: of none
  std::int64_t asleep_count_ = 0;
};

}  // namespace selvage
