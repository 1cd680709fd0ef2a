#include "simulation/implicit/implicit_step.h"

#include "core/timed.h"
#include "simulation/implicit/contact_terms.h"
#include "simulation/xpbd/project_contacts.h"

#include <algorithm>

namespace selvage {

namespace {

/// Times that the minimum is sought, with contacts added in between.
constexpr int kSolveRounds = 3;
/// Rounds in which contacts that the projection of others makes are projected too, before vertices are held back.
constexpr int kProjectionRounds = 3;

/// Of elements and triangles.
double mean_edge_of(const Model& model) {
  double sum = 0, count = 0;
  const auto add = [&](std::span<const Index> vertices) {
    for (std::size_t a = 0; a < vertices.size(); ++a)
      for (std::size_t b = 0; b < a; ++b) {
        sum += (model.rest_positions[vertices[a]] - model.rest_positions[vertices[b]]).norm();
        ++count;
      }
  };
  for (const auto& element : model.mesh.elements()) add(element);
  for (const auto& triangle : model.triangles) add(triangle);
  return sum / std::max(1.0, count);
}

}  // namespace

ImplicitStep::ImplicitStep(const Model& model, const State& initial, std::vector<Handle> handles,
                           std::span<const Collider> colliders, const StepOptions& options)
    : model_(model),
      time_step_(model, initial, std::move(handles), colliders, options),
      potential_(model, options.time_step),
      mean_edge_(mean_edge_of(model)),
      x_(model.mesh.vertex_count()),
      has_collider_term_(model.mesh.vertex_count()) {}

/// Where inertia leads, or where the step starts: what costs less without contacts. Those would always prefer the
/// start, where nothing slides, and from where friction lets go but slowly.
void ImplicitStep::guess(const State& state) {
  for (std::size_t v = 0; v < x_.size(); ++v)
    x_[v] = Eigen::Map<const Eigen::Vector3d>(time_step_.vertices()[v].position);
  std::vector<Vec3> start = x_;
  for (std::size_t v = 0; v < x_.size(); ++v)
    if (potential_.is_free(static_cast<Index>(v))) start[v] = state.positions[v];
  if (potential_.energy(start) < potential_.energy(x_)) x_ = std::move(start);
}

/// Takes over all contacts, and colliders that vertices have run into. False: none is new, and all stay as they are.
bool ImplicitStep::renew_terms() {
  std::vector<OffsetTerm> found;
  append_collider_terms(time_step_, x_, potential_, found);
  std::erase_if(found, [&](const OffsetTerm& term) { return has_collider_term_[term.vertices[0]] != 0; });
  for (const OffsetTerm& term : found) {
    has_collider_term_[term.vertices[0]] = 1;
    time_step_.hold(term.vertices[0]);
  }
  collider_terms_.insert(collider_terms_.end(), found.begin(), found.end());
  std::vector<OffsetTerm> terms;
  append_contact_terms(time_step_, potential_, terms);
  terms.insert(terms.end(), collider_terms_.begin(), collider_terms_.end());
  // What penalties hold gives way a little, and is found to meet again.
  const bool is_new = terms.size() > potential_.contact_count();
  if (is_new || terms.empty()) potential_.set_contacts(std::move(terms));
  return is_new;
}

void ImplicitStep::place() {
  for (std::size_t v = 0; v < x_.size(); ++v)
    if (potential_.is_free(static_cast<Index>(v)))
      Eigen::Map<Eigen::Vector3d>(time_step_.vertices()[v].position) = x_[v];
}

/// Ways out are left as the minimiser has them: it sends points out by their largest correction.
void ImplicitStep::project() {
  impacts_.clear();
  for (const Contact& contact : time_step_.contacts())
    if (contact.kind == ContactKind::kVertexFace || contact.kind == ContactKind::kEdgeEdge) impacts_.push_back(contact);
  std::vector<ContactFriction> without_friction(impacts_.size());
  timed(statistics().seconds_projection, [&] {
    project_contacts(impacts_, time_step_.step(), time_step_.max_corrections(), time_step_.supports(), without_friction,
                     time_step_.ejected(), time_step_.contact_vertices());
    time_step_.project_colliders();
  });
}

void ImplicitStep::step(State& state, std::span<const Vec3> external_forces, const Minimizer& minimize) {
  has_stepped_ = !time_step_.skip_asleep(state, external_forces);
  if (!has_stepped_) return;
  time_step_.begin(state, external_forces);
  time_step_.find_contacts();
  collider_terms_.clear();
  std::fill(has_collider_term_.begin(), has_collider_term_.end(), 0);
  timed(statistics().seconds_material, [&] {
    potential_.begin(time_step_.step(), time_step_.vertices());
    guess(state);
    renew_terms();
  });
  for (int round = 0; round < kSolveRounds; ++round) {
    timed(statistics().seconds_material, [&] { minimize(potential_, round == 0, x_); });
    place();
    if (round + 1 == kSolveRounds) break;
    time_step_.find_missed_contacts();
    bool is_new = false;
    timed(statistics().seconds_material, [&] { is_new = renew_terms(); });
    if (!is_new) break;
  }
  project();
  for (int round = 0; round < kProjectionRounds && time_step_.find_missed_contacts(); ++round) project();
  time_step_.finish(state);
}

}  // namespace selvage
