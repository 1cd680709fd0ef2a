#pragma once

#include "selvage/simulation/collider.h"
#include "selvage/simulation/motion.h"
#include "selvage/simulation/step.h"
#include "simulation/colliders/collider_surface.h"
#include "simulation/colliders/project_colliders.h"
#include "simulation/step.h"
#include "simulation/time_step/draw_off.h"
#include "simulation/time_step/free_momentum.h"
#include "simulation/time_step/parting.h"
#include "simulation/time_step/sleep.h"
#include "simulation/time_step/step_gate.h"

#include <optional>

namespace selvage {

/// The part of a time step that is the same for every solver of the material. In the order of a step:
///
///     skip_asleep(state, forces)  takes the whole step where all bodies sleep
///     begin(state, forces)  predicts where vertices go by inertia and forces, and places what handles hold
///     find_contacts()       detects contacts on the way from the start of the step to the vertices' present positions
///     project_colliders()   sets vertices that are inside colliders on their surface; as often as the solver iterates
///     find_missed_contacts()  adds contacts that the solver's last moves have made; again after each projection
///     finish(state)         holds back what still meets or inverts an element, and takes positions and velocities over
///     into the state
///
/// In between the solver moves vertices() for the material and for contacts(). The same bits for any number of threads.
class TimeStep {
 public:
  /// @param model    must outlive this
  /// @param initial  where handles start
  /// @throws Error   when a size, an index, a handle, a collider or an option is impossible; it names which
  TimeStep(const Model& model, const State& initial, std::vector<Handle> handles, std::span<const Collider> colliders,
           const StepOptions& options);

  /// Decides which bodies sleep in the step, and takes it where all do: nothing moves but time. Then true, and the step
  /// is over; else it is to begin(). Without it none sleeps.
  /// @param is_pushed  by something that the step does not know of: all are awake
  bool skip_asleep(State& state, std::span<const Vec3> external_forces, bool is_pushed = false);

  /// @param state            must stay as it is until finish()
  /// @param external_forces  (n_vertices) [N] besides gravity, or empty
  void begin(const State& state, std::span<const Vec3> external_forces);

  /// @throws Error  naming the first vertex that is not finite, or that the solver throws a thousand times as far as
  ///                all bodies are large; so does finish()
  void find_contacts();

  /// Adds to contacts() what still meets on the way to the vertices' present positions. False: nothing does, or
  /// ContactOptions::hold_back is off.
  bool find_missed_contacts();

  /// Friction included. Adds to statistics().collider_contacts.
  void project_colliders();

  /// Something that the step does not know of acts on a vertex: its group does not keep its momentum in this step.
  void hold(Index v) { free_momentum_.hold(v); }

  /// Leaves the state as it was where it throws.
  /// @throws PinchError  see StepOptions
  void finish(State& state);

  /// (n_vertices) where vertices are in this step; those that handles hold have no inverse mass.
  std::span<StepVertex> vertices() { return std::span(vertices_).first(vertex_count()); }
  /// (n_contact_vertices) the same, then those of colliders' edges and corners: contacts() name both. These are where
  /// colliders are at the end of the step, and have no inverse mass.
  std::span<StepVertex> contact_vertices() { return vertices_; }
  /// Of the last find_contacts().
  std::span<const Contact> contacts() const { return contacts_; }
  /// ContactFinder::unguarded_vertices() of the step.
  std::vector<Index> unguarded_vertices() const { return contact_finder_->unguarded_vertices(); }
  /// Of two bodies, or of a body with a collider.
  const Friction& friction_of(const Contact& contact) const;
  /// Begun last. Its positions and velocities are those of contact_vertices().
  const Step& step() const { return step_; }
  std::span<const PreparedCollider> colliders() const { return colliders_; }
  /// By the pushes of project_colliders() in this step.
  ColliderSupports supports() {
    if (collider_contacts_.pushed.empty()) return {};
    return {collider_states_, colliders_.size(), step_.number};
  }
  /// (n_vertices) by which colliders hold cloth off [m]; empty where none is thick.
  std::span<const double> half_thickness() const { return half_thickness_; }
  /// (n_contact_vertices) see max_corrections_of(); infinite for colliders.
  std::span<const double> max_corrections() const { return max_corrections_; }
  /// (n_contact_vertices) sum of the corrections by which contacts sent vertices out of bodies in this step [m]. The
  /// solver adds to those of the vertices of contacts(); friction with colliders does not count them as sliding.
  std::span<Vec3> ejected() { return ejected_; }
  /// Of the step begun last; the solver adds its own.
  StepStatistics& statistics() { return statistics_; }
  const StepStatistics& statistics() const { return statistics_; }

 private:
  Index vertex_count() const { return model_.mesh.vertex_count(); }
  Vec3 position(Index v) const { return Eigen::Map<const Eigen::Vector3d>(vertices_[v].position); }
  void place(Index v, const Vec3& position, double inverse_mass) {
    vertices_[v] = {{position[0], position[1], position[2]}, inverse_mass};
  }
  double kept_velocity() const { return 1 / (1 + options_.time_step * options_.velocity_damping); }
  void predict(const State& state, std::span<const Vec3> external_forces);
  void restore_free_momentum(State& state);
  void place_handles();
  std::vector<std::uint8_t> bodies_with_handles_that_act() const;
  void set_step(const State& state);
  void place_collider_surface(const State& state);
  bool is_held(const Handle& handle) const;
  bool is_released(const Handle& handle) const;
  Vec3 depenetration_of(Index v, const Vec3& moved) const;
  bool is_thrown(Index v) const;
  /// Whether much of the bodies starts the step in colliders or in one another: what runs into each other is looked for
  /// once all else holds, for most of it meets in each round.
  bool is_crushed() const {
    return gate_->is_crushed(collider_contacts_.started_inside) || contact_finder_->statistics().off_turn > 0;
  }
  void check_positions() const;
  Carriers carriers() const;
  void hold_back();
  std::string name_of(Index vertex) const;
  void refuse_pinch(const GateStatistics& held) const;

  const Model& model_;
  StepOptions options_;
  std::vector<Handle> handles_;
  std::vector<std::vector<Vec3>> handle_positions_;  ///< of the vertices of each at time 0
  double element_size_;                              ///< see element_size_of() [m]
  double max_throw_;                                 ///< see is_thrown() [m]
  std::vector<Index> body_of_;                       ///< (n_vertices)
  FreeMomentum free_momentum_;
  Parting parting_;
  std::vector<double> half_thickness_;  ///< (n_vertices) of cloth [m]; empty where none is thick
  std::vector<PreparedCollider> colliders_;
  ColliderSurface collider_surface_;             ///< of the colliders; none where the mode is kOff
  std::optional<ContactFinder> contact_finder_;  ///< none where the mode is kOff
  std::optional<Sleep> sleep_;                   ///< none where nothing sleeps
  std::optional<StepGate> gate_;                 ///< none where nothing is held back
  DrawOff draw_off_;
  double depth_share_ = 1;  ///< see project_colliders()

  bool no_impacts_ = false;  ///< on the way to where vertices are now
  std::vector<double> max_corrections_;

  Step step_{};
  std::int64_t steps_begun_ = 0;
  double longest_inertial_way_ = 0;                       ///< of any vertex in the step [m]
  std::int64_t state_steps_ = 0;                          ///< State::steps at the start of the step
  std::vector<StepVertex> vertices_;                      ///< (n_contact_vertices)
  std::vector<Vec3> start_positions_, start_velocities_;  ///< (n_contact_vertices) where there are colliders
  std::vector<Vec3> damped_velocities_;       ///< (n_vertices) at the start of the step, where deformations are damped
  std::vector<MomentumSums> start_momentum_;  ///< (n_pieces) with what outer forces add
  std::vector<Vec3> candidate_;               ///< (n_contact_vertices) end of the step as find_contacts() takes it
  std::vector<Contact> contacts_;
  std::vector<Vec3> ejected_;
  std::vector<ColliderContactState> collider_states_;  ///< (n_vertices x n_colliders)
  ColliderContacts collider_contacts_;                 ///< of the step
  StepStatistics statistics_;
};

}  // namespace selvage
