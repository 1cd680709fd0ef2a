#include "simulation/time_step/time_step.h"

#include "core/parallel.h"
#include "core/timed.h"
#include "mesh/position_extent.h"
#include "selvage/core/error.h"
#include "simulation/cloth_pieces.h"
#include "simulation/time_step/check_input.h"
#include "simulation/time_step/deformation_damping.h"

#include <fmt/format.h>

#include <algorithm>

namespace selvage {

namespace {

/// Part of a step by which rounding may shift a time.
constexpr double kTimeSlack = 1e-6;
/// Times the size of all bodies by which a solver may move a vertex in a step besides what inertia does. More is no
/// answer but a solver that diverges, as where colliders leave a body no volume, and contacts on such ways would take
/// minutes to find.
constexpr double kMaxThrow = 1000;

}  // namespace

TimeStep::TimeStep(const Model& model, const State& initial, std::vector<Handle> handles,
                   std::span<const Collider> colliders, const StepOptions& options)
    : model_(model),
      options_(options),
      handles_(std::move(handles)),
      element_size_(element_size_of(model)),
      max_throw_(kMaxThrow * extent_of<3>(model.rest_positions).diagonal()),
      body_of_(bodies_of_vertices(model)),
      free_momentum_(model),
      parting_(model, body_of_, options.time_step, options.gravity),
      half_thickness_(half_thickness_of(model)) {
  check_options(options);
  check_state(model, initial);
  check_handles(model, handles_);
  colliders_ = bury_faces(element_size_, prepare_colliders(colliders));
  for (const Handle& handle : handles_) {
    std::vector<Vec3>& positions = handle_positions_.emplace_back();
    for (const Index v : handle.vertices) positions.push_back(initial.positions[v]);
  }
  collider_states_.resize(vertex_count() * colliders_.size());
  max_corrections_ = max_corrections_of(model);
  if (options.sleep_speed > 0) sleep_.emplace(model, options.sleep_speed, options.gravity);
  if (options.contact.mode != DetectionMode::kOff) collider_surface_ = make_collider_surface(colliders_, element_size_);
  const std::size_t all = vertex_count() + collider_surface_.positions.size();
  vertices_.resize(all);
  ejected_.resize(all, Vec3::Zero());
  max_corrections_.resize(all, std::numeric_limits<double>::infinity());
  if (options.contact.mode == DetectionMode::kOff) return;
  ContactOptions contact = options.contact;
  // CCD alone never finds again what it leaves out once.
  contact.wait_for_inverted = contact.mode != DetectionMode::kCcd;
  contact.take_turns = !contact.guarantee;
  std::vector<Vec3> positions = initial.positions;
  for (std::size_t i = 0; i < collider_surface_.positions.size(); ++i)
    positions.push_back(
        colliders_[collider_surface_.collider_of_vertices[i]].motion.at(0)(collider_surface_.positions[i]));
  contact_finder_.emplace(model.mesh, model.rest_positions, positions, body_of_, contact,
                          collider_surface_.triangles_after(model.mesh.vertex_count()),
                          ContactCloth{model.triangles, half_thickness_});
  candidate_.resize(all);
  if (contact.hold_back && contact.splits()) gate_.emplace(model, static_cast<Index>(all), contact.guarantee);
}

void TimeStep::set_step(const State& state) {
  step_ = {.number = steps_begun_ + 1,
           .start_time = static_cast<double>(state.steps) * options_.time_step,
           .end_time = static_cast<double>(state.steps + 1) * options_.time_step,
           .positions = state.positions,
           .velocities = state.velocities};
  for (PreparedCollider& collider : colliders_) collider.set_step(step_.start_time, step_.end_time);
}

std::vector<std::uint8_t> TimeStep::bodies_with_handles_that_act() const {
  std::vector<std::uint8_t> disturbed(model_.bodies.size(), 0);
  for (const Handle& handle : handles_)
    if (is_released(handle) || (is_held(handle) && handle.motion.differs(step_.start_time, step_.end_time)))
      for (const Index v : handle.vertices)
        if (body_of_[v] != kNone) disturbed[body_of_[v]] = 1;
  return disturbed;
}

bool TimeStep::skip_asleep(State& state, std::span<const Vec3> external_forces, bool is_pushed) {
  if (!sleep_) return false;
  check_state(model_, state);
  if (is_pushed || !external_forces.empty()) {
    sleep_->begin_awake();
    return false;
  }
  set_step(state);
  sleep_->begin(state, step_.start_time, step_.end_time, bodies_with_handles_that_act(), colliders_);
  if (!sleep_->are_all_asleep()) return false;
  statistics_ = {};
  statistics_.sleeping_bodies = sleep_->asleep_count();
  contacts_.clear();
  state.time = step_.end_time;
  ++state.steps;
  ++steps_begun_;
  return true;
}

void TimeStep::begin(const State& state, std::span<const Vec3> external_forces) {
  check_state(model_, state);
  check_forces(model_, external_forces);
  statistics_ = {};
  if (sleep_) statistics_.sleeping_bodies = sleep_->asleep_count();
  collider_contacts_ = {};
  free_momentum_.begin();
  for (Index p = 0; sleep_ && p < free_momentum_.pieces().count(); ++p) {
    const Index v = free_momentum_.pieces().first_vertex(p);
    if (v != kNone && body_of_[v] != kNone && sleep_->is_asleep(body_of_[v])) free_momentum_.hold(v);
  }
  state_steps_ = state.steps;
  set_step(state);
  ++steps_begun_;
  if (!collider_surface_.positions.empty()) place_collider_surface(state);
  if (contact_finder_) contact_finder_->begin_step(step_.positions, state.steps);
  if (gate_) statistics_.unguarded_vertices = contact_finder_->statistics().unguarded_vertices;
  predict(state, external_forces);
  place_handles();
  if (!gate_) return;
  const DrawOff::Input input{*contact_finder_, model_, free_momentum_.pieces(), colliders_, step_, max_corrections_};
  draw_off_.begin();
  depth_share_ = parting_.depth_share(state);
  if (parting_.is_any(state)) draw_off_.leave_solids(input, collider_surface_, collider_states_, vertices());
  draw_off_.leave_edges(input, vertices());
  for (const Index v : draw_off_.vertices()) free_momentum_.hold(v);
}

/// Colliders' edges and corners, after the bodies' vertices.
void TimeStep::place_collider_surface(const State& state) {
  start_positions_.assign(state.positions.begin(), state.positions.end());
  start_velocities_.assign(state.velocities.begin(), state.velocities.end());
  start_positions_.resize(vertices_.size());
  start_velocities_.resize(vertices_.size());
  selvage::place_keyframed(colliders_, element_size_, collider_surface_);
  const auto& starts =
      collider_surface_.start_positions.empty() ? collider_surface_.positions : collider_surface_.start_positions;
  std::vector<std::array<RigidTransform, 2>> ends;
  for (const PreparedCollider& collider : colliders_)
    ends.push_back({collider.motion.at(step_.start_time), collider.motion.at(step_.end_time)});
  parallel_for(std::ssize(collider_surface_.positions), kGrain, [&](std::int64_t i) {
    const auto v = static_cast<Index>(vertex_count() + i);
    const auto& [from, to] = ends[collider_surface_.collider_of_vertices[i]];
    start_positions_[v] = from(starts[i]);
    const Vec3 end = to(collider_surface_.positions[i]);
    start_velocities_[v] = (end - start_positions_[v]) / step_.length();
    place(v, end, 0);
  });
  step_.positions = start_positions_;
  step_.velocities = start_velocities_;
}

const Friction& TimeStep::friction_of(const Contact& contact) const {
  const Index last = std::max(contact.vertices[0], contact.vertices[contact.count - 1]);
  if (last < vertex_count()) return options_.friction;
  return colliders_[collider_surface_.collider_of_vertices[last - vertex_count()]].friction;
}

/// Whether a handle holds its vertices in this step.
bool TimeStep::is_held(const Handle& handle) const {
  return step_.start_time + kTimeSlack * options_.time_step < handle.release_time;
}

/// Whether this step is the first in which a handle no longer holds its vertices.
bool TimeStep::is_released(const Handle& handle) const {
  const double since = step_.start_time + kTimeSlack * options_.time_step - handle.release_time;
  return since >= 0 && since < options_.time_step;
}

void TimeStep::predict(const State& state, std::span<const Vec3> external_forces) {
  const double step = options_.time_step, kept = kept_velocity();
  const Pieces& pieces = free_momentum_.pieces();
  std::span<const Vec3> velocities = state.velocities;
  start_momentum_ = pieces.momentum(state.positions, [&](Index v) { return state.velocities[v]; });
  if (options_.deformation_damping > 0) {
    damped_velocities_.assign(velocities.begin(), velocities.end());
    damp_deformation(pieces, start_momentum_, 1 / (1 + step * options_.deformation_damping), state.positions,
                     damped_velocities_);
    velocities = damped_velocities_;
  }
  if (!external_forces.empty())
    start_momentum_ = pieces.momentum(state.positions, [&](Index v) {
      return Vec3(velocities[v] + step * model_.inverse_masses[v] * external_forces[v]);
    });
  struct Longest {
    double way = 0;
    void add(const Longest& other) { way = std::max(way, other.way); }
  };
  const auto predict_vertex = [&](Index v) {
    const bool is_asleep = sleep_ && body_of_[v] != kNone && sleep_->is_asleep(body_of_[v]);
    const double inverse_mass = is_asleep ? 0 : model_.inverse_masses[v];
    Vec3 velocity = Vec3::Zero();
    if (inverse_mass > 0) {
      Vec3 acceleration = options_.gravity;
      if (!external_forces.empty()) acceleration += inverse_mass * external_forces[v];
      velocity = kept * (velocities[v] + step * acceleration);
    }
    place(v, state.positions[v] + step * velocity, inverse_mass);
    return step * velocity.norm();
  };
  longest_inertial_way_ =
      parallel_reduce<Longest>(vertex_count(), kGrain, [&](std::int64_t begin, std::int64_t end, Longest& longest) {
        for (std::int64_t v = begin; v < end; ++v) longest.add({predict_vertex(static_cast<Index>(v))});
      }).way;
}

void TimeStep::place_handles() {
  for (std::size_t h = 0; h < handles_.size(); ++h) {
    if (!is_held(handles_[h])) continue;
    const RigidTransform transform = handles_[h].motion.at(step_.end_time);
    for (std::size_t i = 0; i < handles_[h].vertices.size(); ++i) {
      place(handles_[h].vertices[i], transform(handle_positions_[h][i]), 0);
      free_momentum_.hold(handles_[h].vertices[i]);
    }
  }
}

void TimeStep::find_contacts() {
  check_positions();
  for (const Contact& contact : contacts_)
    for (int i = 0; i < contact.count; ++i) ejected_[contact.vertices[i]].setZero();
  if (!contact_finder_) return;
  parallel_for(std::ssize(candidate_), kGrain,
               [&](std::int64_t v) { candidate_[v] = position(static_cast<Index>(v)); });
  contact_finder_->find_contacts(candidate_, contacts_);
  statistics_.contact = contact_finder_->statistics();
}

bool TimeStep::find_missed_contacts() {
  if (!gate_ || is_crushed()) return false;
  check_positions();
  parallel_for(std::ssize(candidate_), kGrain,
               [&](std::int64_t v) { candidate_[v] = position(static_cast<Index>(v)); });
  const StepImpacts impacts = contact_finder_->find_impacts(candidate_);
  no_impacts_ = impacts.pairs.empty();
  if (no_impacts_) return false;
  contact_finder_->append_contacts(impacts, candidate_, contacts_);
  ++statistics_.missed_rounds;
  return true;
}

/// Pinned vertices, those of bodies that sleep, those that handles hold, and those that colliders have pushed in this
/// step.
Carriers TimeStep::carriers() const {
  Carriers carriers{.motions = {RigidTransform()},
                    .of_vertex = std::vector<Index>(vertices_.size(), kNone),
                    .colliders = colliders_,
                    .max_corrections = max_corrections_,
                    .states = collider_states_};
  const auto add = [&](const Motion& motion) {
    const RigidTransform from = motion.at(step_.start_time), to = motion.at(step_.end_time);
    const Eigen::Matrix3d rotation = to.rotation * from.rotation.transpose();
    carriers.motions.push_back({rotation, to.translation - rotation * from.translation});
    return static_cast<Index>(carriers.motions.size()) - 1;
  };
  for (Index v = 0; v < vertex_count(); ++v)
    if (!(vertices_[v].inverse_mass > 0)) carriers.of_vertex[v] = 0;
  for (const Handle& handle : handles_) {
    if (!is_held(handle)) continue;
    const Index carrier = add(handle.motion);
    for (const Index v : handle.vertices) carriers.of_vertex[v] = carrier;
  }
  for (std::size_t c = 0; c < colliders_.size(); ++c) {
    const Index carrier = add(colliders_[c].motion);
    for (Index v = 0; v < vertex_count(); ++v)
      if (collider_states_[v * colliders_.size() + c].acts(step_) && carriers.of_vertex[v] == kNone)
        carriers.of_vertex[v] = carrier;
    for (std::size_t i = 0; i < collider_surface_.positions.size(); ++i)
      if (collider_surface_.collider_of_vertices[i] == static_cast<Index>(c))
        carriers.of_vertex[vertex_count() + i] = carrier;
  }
  return carriers;
}

std::string TimeStep::name_of(Index vertex) const {
  for (const Body& body : model_.bodies)
    if (vertex >= body.first_vertex && vertex < body.first_vertex + body.vertex_count)
      return fmt::format("body '{}'", body.name);
  if (vertex < vertex_count()) return fmt::format("vertex {}", vertex);
  return fmt::format("collider {}", collider_surface_.collider_of_vertices[vertex - vertex_count()]);
}

void TimeStep::refuse_pinch(const GateStatistics& held) const {
  const Vec3& place = step_.positions[held.left[0]];
  const std::string first = name_of(held.left[0]), second = held.left[3] == kNone ? "" : name_of(held.left[3]);
  throw PinchError(
      fmt::format("step {}, near [{:.4g}, {:.4g}, {:.4g}]", state_steps_ + 1, place[0], place[1], place[2]),
      held.left[3] == kNone ? fmt::format("{} has no room left between colliders or handles", first)
                            : fmt::format("{} and {} are led into one another by handles or colliders", first, second),
      "give them room, or take smaller steps");
}

void TimeStep::hold_back() {
  if (!gate_) return;
  timed(statistics_.seconds_hold_back, [&] {
    if (!gate_->is_violated(*contact_finder_, step_, vertices_, no_impacts_)) return;
    const GateStatistics held = gate_->hold_back(*contact_finder_, step_, carriers(), is_crushed(), vertices_);
    statistics_.hold_back_rounds = held.rounds;
    statistics_.held_back_vertices = held.held_back_vertices;
    statistics_.impacts_met = held.impacts_met;
    statistics_.impacts_left = held.impacts_left;
    if (options_.contact.guarantee && held.impacts_left + held.entries_left > 0) refuse_pinch(held);
  });
  statistics_.contact = contact_finder_->statistics();
}

void TimeStep::project_colliders() {
  no_impacts_ = false;
  collider_contacts_.add(selvage::project_colliders(colliders_, step_, max_corrections_, depth_share_, half_thickness_,
                                                    ejected_, draw_off_.ways_off_edges(), collider_states_,
                                                    vertices()));
  statistics_.collider_contacts = std::ssize(collider_contacts_.pushed);
}

bool TimeStep::is_thrown(Index v) const {
  return vertices_[v].inverse_mass > 0 &&
         (position(v) - step_.positions[v]).norm() > max_throw_ + longest_inertial_way_;
}

void TimeStep::check_positions() const {
  struct First {
    Index vertex = std::numeric_limits<Index>::max();
    void add(const First& other) { vertex = std::min(vertex, other.vertex); }
  };
  const First first =
      parallel_reduce<First>(vertex_count(), kGrain, [&](std::int64_t begin, std::int64_t end, First& result) {
        for (std::int64_t v = begin; v < end; ++v)
          if (!is_in_range(position(static_cast<Index>(v))) || is_thrown(static_cast<Index>(v)))
            result.add({static_cast<Index>(v)});
      });
  if (first.vertex == std::numeric_limits<Index>::max()) return;
  const double way = (position(first.vertex) - step_.positions[first.vertex]).norm();
  throw Error(fmt::format("vertex {}", first.vertex),
              is_in_range(position(first.vertex))
                  ? fmt::format("the solver throws it by {:.2g} m in step {}", way, state_steps_ + 1)
                  : fmt::format("its position stops being finite in step {}", state_steps_ + 1),
              "take a smaller time step, softer materials or slower handles, and leave bodies room");
}

/// By how far colliders have moved a vertex only because it started the step inside them. It gives no speed: a body
/// that starts half in the floor would fly off with its depth a step.
Vec3 TimeStep::depenetration_of(Index v, const Vec3& moved) const {
  Vec3 depenetration = Vec3::Zero();
  if (collider_contacts_.started_inside == 0) return depenetration;
  for (std::size_t c = 0; c < colliders_.size(); ++c) {
    const ColliderContactState& contact = collider_states_[v * colliders_.size() + c];
    if (contact.step == step_.number) depenetration += contact.depenetration(moved);
  }
  return depenetration;
}

void TimeStep::restore_free_momentum(State& state) {
  for (const Index v : collider_contacts_.pushed) free_momentum_.hold(v);
  free_momentum_.join(contacts_);
  if (gate_) free_momentum_.join(gate_->links());
  free_momentum_.restore(start_momentum_, options_.time_step * options_.gravity, kept_velocity(), state.positions,
                         state.velocities);
}

void TimeStep::finish(State& state) {
  check_positions();
  hold_back();
  parallel_for(vertex_count(), kGrain, [&](std::int64_t i) {
    const auto v = static_cast<Index>(i);
    const Vec3 moved = position(v) - state.positions[v];
    const Vec3 drawn = draw_off_.way_of(v);
    const Vec3 led = gate_ ? gate_->way_out_of(v) : Vec3::Zero();
    state.velocities[v] = (moved - drawn - (led.isZero(0) ? depenetration_of(v, moved) : led)) / options_.time_step;
    state.positions[v] = position(v);
  });
  restore_free_momentum(state);
  if (options_.max_speed < std::numeric_limits<double>::infinity())
    parallel_for(vertex_count(), kGrain, [&](std::int64_t v) {
      const double speed = state.velocities[v].norm();
      if (speed > options_.max_speed) state.velocities[v] *= options_.max_speed / speed;
    });
  state.time = step_.end_time;
  ++state.steps;
  std::vector<Index> deep = find_deep_vertices(collider_contacts_, collider_states_, colliders_, step_);
  deep.insert(deep.end(), draw_off_.across().begin(), draw_off_.across().end());
  if (gate_) parting_.finish(free_momentum_.pieces(), start_momentum_, contacts_, deep, state);
  if (!sleep_) return;
  const std::span<const Index> drawn = draw_off_.vertices();
  std::vector<Index> penetrating(drawn.begin(), drawn.end());
  if (contact_finder_) {
    const std::span<const Index> inside = contact_finder_->penetrating_vertices();
    penetrating.insert(penetrating.end(), inside.begin(), inside.end());
  }
  std::erase_if(penetrating, [&](Index v) { return v >= vertex_count(); });
  sleep_->finish(step_.length(), penetrating, collider_contacts_.pushed, state);
}

}  // namespace selvage
