#include "selvage/simulation/resolve.h"

#include "selvage/contact/contact_finder.h"
#include "selvage/core/error.h"
#include "selvage/self_collision/self_collision.h"
#include "simulation/agreeing_contacts.h"
#include "simulation/keep_upright.h"
#include "simulation/material_solver.h"
#include "simulation/project_contacts.h"
#include "simulation/shape_energy.h"

#include <fmt/format.h>

#include <algorithm>

namespace selvage {

namespace {

/// Passes of material and contacts in one iteration, for one detection.
constexpr int kPasses = 8;
/// Young's modulus where density, time step and mean edge length are 1: so stiff that contacts move bodies rather than
/// dent them.
constexpr double kStiffness = 100;
/// Part of the mean edge length by which a contact pushes in one iteration: points deep inside go opposite ways, and
/// all the way at once they would turn elements inside out before the material can say which side gives way.
constexpr double kPush = 0.5;
/// How far apart, in mean edge lengths, what meets is set until all is out: with less, edges that cross at a ridge lock
/// where the material pulls as much as the contacts push.
constexpr double kUntanglingClearance = 0.4;
/// By which the material takes it back once all are out, per iteration.
constexpr double kClearanceShrinkage = 0.9;
/// Iterations, at most, in which the material comes to rest once all are out.
constexpr int kSettling = 30;
/// Part of the mean edge length by which a vertex moves in one iteration: the material throws far what is inside out.
constexpr double kLongestMove = 0.5;
/// Iterations for which a contact holds after its point was last found inside: without it the material would at once
/// pull back in what has just come out.
constexpr int kHold = 20;
/// Part of an element's size by which a vertex must have moved to wake the element's other vertices.
constexpr double kWakingShare = 0.01;
/// Part by which something must have become less to be progress.
constexpr double kProgress = 0.01;
/// Keeps rounding from carrying a vertex beyond the largest displacement.
constexpr double kBelowOne = 1 - 1e-12;

void check_options(const TetMesh& mesh, const ResolveOptions& options) {
  const auto demand = [](bool good, std::string_view name, double value, std::string_view range) {
    if (!good) throw Error(name, fmt::format("is {}", value), fmt::format("give a number {}", range));
  };
  demand(options.max_displacement > 0, "largest displacement", options.max_displacement, "above 0");
  demand(options.clearance > 0 && options.clearance < 1, "clearance", options.clearance, "between 0 and 1");
  demand(options.max_iterations > 0, "iterations", options.max_iterations, "of at least 1");
  demand(options.patience > 0, "patience", options.patience, "of at least 1");
  for (const Index v : options.pinned)
    if (v < 0 || v >= mesh.vertex_count())
      throw Error("pinned vertices", fmt::format("there is no vertex {}", v),
                  fmt::format("vertices lie in [0, {})", mesh.vertex_count()));
}

/// Of the boundary, for what meets is as coarse as that.
double mean_edge_length(const TetMesh& mesh, std::span<const Vec3> positions) {
  double sum = 0;
  for (const auto& face : mesh.boundary_faces())
    for (int k = 0; k < 3; ++k) sum += (positions[face[k]] - positions[face[(k + 1) % 3]]).norm();
  return sum / (3 * static_cast<double>(mesh.boundary_faces().size()));
}

/// All in one body whose stiffness is relative to its elements' size, so that a mesh resolves alike in any unit.
Model make_relative_model(const TetMesh& mesh, const std::vector<Vec3>& rest) {
  if (std::ssize(rest) != mesh.vertex_count())
    throw Error("rest positions", fmt::format("{} for {} vertices", rest.size(), mesh.vertex_count()),
                "give one per vertex");
  const double length = mean_edge_length(mesh, rest);
  Body body{"mesh", 0, mesh.vertex_count(), 0, mesh.element_count(), {}};
  body.material.density = 1;
  body.material.youngs_modulus = kStiffness * length * length;
  return make_model(mesh, rest, {body});
}

ContactOptions contact_options() {
  ContactOptions options;
  options.mode = DetectionMode::kDcd;
  options.interior_points = true;
  return options;
}

std::pair<ContactKind, Index> point_of(const Contact& contact) {
  return {contact.kind, contact.point_feature};
}

/// A contact and for how many iterations its point has not been found inside.
struct HeldContact {
  Contact contact;
  int age = 0;
};

class Resolver {
 public:
  Resolver(const TetMesh& mesh, std::vector<Vec3>& positions, const ResolveOptions& options);
  ResolveReport run();

 private:
  ResolveIteration measure(int iteration);
  ResolveOutcome untangle(ResolveReport& report);
  void settle(ResolveReport& report);
  void report_iteration(ResolveReport& report, const ResolveIteration& now) const;
  bool has_progressed(const ResolveIteration& now);
  void hold_contacts();
  void wake(Index vertex);
  void wake_neighbours();
  void relax();
  void limit_displacements();
  void place(std::span<const Vec3> positions);
  double total_energy(std::span<const Vec3> positions) const;
  void fill_report(ResolveReport& report) const;
  std::vector<Index> find_tangled_elements() const;

  const TetMesh& mesh_;
  const ResolveOptions& options_;
  std::vector<Vec3>& positions_;
  const std::vector<Vec3> input_;
  const Model model_;
  const double length_;  ///< mean of the edges at rest [m]
  Push push_;
  ContactFinder contact_finder_;
  SelfCollisionFinder pair_finder_;
  MaterialSolver material_;
  std::vector<VertexRow> vertices_;  ///< those asleep have no inverse mass; followed by the solver's stand-ins
  std::vector<std::uint8_t> is_free_, is_awake_;
  std::vector<Contact> contacts_;  ///< of the last measurement
  std::vector<TrianglePair> pairs_;
  std::vector<Index> inverted_;  ///< elements, as the positions are; ascending
  std::vector<HeldContact> held_;
  ResolveIteration best_;
  int last_progress_ = 0;
};

Resolver::Resolver(const TetMesh& mesh, std::vector<Vec3>& positions, const ResolveOptions& options)
    : mesh_(mesh),
      options_(options),
      positions_(positions),
      input_(positions),
      model_(make_relative_model(mesh, options.rest_positions.empty() ? positions : options.rest_positions)),
      length_(mean_edge_length(mesh, model_.rest_positions)),
      push_{std::max(options.clearance, kUntanglingClearance) * length_, kPush / kPasses * length_},
      contact_finder_(model_.mesh, {}, positions, {}, contact_options()),
      pair_finder_(contact_finder_.surface(), positions),
      material_(model_, 1) {
  for (const Vec3& p : positions_) vertices_.push_back({{p[0], p[1], p[2]}, 0});
  vertices_.insert(vertices_.end(), material_.stand_ins().begin(), material_.stand_ins().end());
  is_awake_.resize(positions.size());
  for (const double inverse_mass : model_.inverse_masses) is_free_.push_back(inverse_mass > 0);
  for (const Index v : options.pinned) is_free_[v] = false;
  inverted_ = find_inverted(mesh, positions);
}

ResolveIteration Resolver::measure(int iteration) {
  contact_finder_.begin_step(positions_);
  contact_finder_.find_contacts(positions_, contacts_);
  pair_finder_.update(positions_);
  pairs_ = pair_finder_.find_pairs();
  ResolveIteration now;
  now.iteration = iteration;
  now.triangle_pairs = std::ssize(pairs_);
  now.blocked_points = contact_finder_.statistics().blocked_paths;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const double depth = std::max(0.0, -gap_of(contacts_[i], positions_));
    now.deepest = std::max(now.deepest, depth);
    now.total_depth += depth;
    if (i > 0 && point_of(contacts_[i]) == point_of(contacts_[i - 1])) continue;
    switch (contacts_[i].kind) {
      case ContactKind::kVertexPath:
        ++now.penetrating_vertices;
        break;
      case ContactKind::kEdgePath:
        ++now.penetrating_edges;
        break;
      default:
        ++now.penetrating_centroids;
    }
  }
  now.inverted_elements = std::ssize(inverted_);
  now.awake_vertices = std::count(is_awake_.begin(), is_awake_.end(), 1);
  for (std::size_t v = 0; v < positions_.size(); ++v)
    now.max_displacement = std::max(now.max_displacement, (positions_[v] - input_[v]).norm());
  return now;
}

/// Whether anything that is wrong has become less than it ever was.
bool Resolver::has_progressed(const ResolveIteration& now) {
  bool progressed = now.iteration == 0;
  const auto compare = [&](auto& best, auto value) {
    if (now.iteration > 0 && !(static_cast<double>(value) < (1 - kProgress) * static_cast<double>(best))) return;
    best = value;
    progressed = true;
  };
  compare(best_.triangle_pairs, now.triangle_pairs);
  compare(best_.penetrating_vertices, now.penetrating_vertices);
  compare(best_.total_depth, now.total_depth);
  compare(best_.inverted_elements, now.inverted_elements);
  return progressed;
}

/// Takes over the contacts that were found; of points that were not, those of the last iterations.
void Resolver::hold_contacts() {
  const auto before = [](const Contact& a, const Contact& b) { return point_of(a) < point_of(b); };
  std::erase_if(held_, [&](HeldContact& held) {
    return ++held.age > kHold || std::binary_search(contacts_.begin(), contacts_.end(), held.contact, before);
  });
  for (const Contact& contact : contacts_) held_.push_back({contact});
  for (const Contact& contact : contacts_)
    for (int i = 0; i < contact.count; ++i) wake(contact.vertices[i]);
  // The material turns those back that nothing is inside of.
  for (const Index e : inverted_)
    for (const Index v : mesh_.elements()[e]) wake(v);
}

void Resolver::wake(Index vertex) {
  if (is_awake_[vertex] || !is_free_[vertex]) return;
  is_awake_[vertex] = true;
  vertices_[vertex].inverse_mass = model_.inverse_masses[vertex];
}

/// By one ring of elements around what has moved.
void Resolver::wake_neighbours() {
  std::vector<Index> woken;
  for (Index v = 0; v < mesh_.vertex_count(); ++v) {
    if (!is_awake_[v]) continue;
    const double moved = (positions_[v] - input_[v]).norm();
    for (const Index e : mesh_.vertex_elements(v)) {
      const auto& corners = mesh_.elements()[e];
      const double size = std::cbrt(6 * element_volume(corners, model_.rest_positions));
      if (moved > kWakingShare * size) woken.insert(woken.end(), corners.begin(), corners.end());
    }
  }
  for (const Index v : woken) wake(v);
}

/// The material from where vertices are, and then out of the contacts, so that these have the last word; but none turns
/// an element inside out, which would block the ways out of others, and paths that may pass through such an element
/// take a thousand times as long to find.
void Resolver::relax() {
  std::vector<Contact> contacts;
  for (const HeldContact& held : held_) contacts.push_back(held.contact);
  contacts = find_agreeing_contacts(mesh_, contacts);
  const std::vector<Vec3> before = positions_;
  for (int pass = 0; pass < kPasses; ++pass) {
    material_.solve(vertices_, {}, 0, 1);
    push_apart(contacts, push_, vertices_);
    limit_displacements();
  }
  for (Index v = 0; v < mesh_.vertex_count(); ++v)
    if (is_awake_[v]) positions_[v] = Eigen::Map<const Eigen::Vector3d>(vertices_[v].position);
  std::vector<Vec3> upright = positions_;
  inverted_ = keep_upright(mesh_, before, inverted_, upright);
  place(upright);
}

void Resolver::place(std::span<const Vec3> positions) {
  for (Index v = 0; v < mesh_.vertex_count(); ++v) {
    if (!is_awake_[v]) continue;
    positions_[v] = positions[v];
    Eigen::Map<Eigen::Vector3d>(vertices_[v].position) = positions[v];
  }
}

void Resolver::limit_displacements() {
  const auto hold_within = [](Eigen::Map<Eigen::Vector3d> position, const Vec3& centre, double radius) {
    const Vec3 moved = position - centre;
    const double distance = moved.norm();
    if (distance > kBelowOne * radius) position = centre + kBelowOne * radius / distance * moved;
  };
  for (Index v = 0; v < mesh_.vertex_count(); ++v) {
    if (!is_awake_[v]) continue;
    const Eigen::Map<Eigen::Vector3d> position(vertices_[v].position);
    hold_within(position, positions_[v], kLongestMove * length_);
    hold_within(position, input_[v], options_.max_displacement);
  }
}

std::vector<Index> Resolver::find_tangled_elements() const {
  std::vector<Index> elements;
  const auto add_face = [&](Index face) { elements.push_back(mesh_.boundary_owners()[face].element()); };
  for (const TrianglePair& pair : pairs_) {
    add_face(pair.first);
    add_face(pair.second);
  }
  for (const Contact& contact : contacts_) {
    add_face(contact.surface_feature);
    if (contact.kind == ContactKind::kCentroidPath) elements.push_back(contact.point_feature);
  }
  elements.insert(elements.end(), inverted_.begin(), inverted_.end());
  std::sort(elements.begin(), elements.end());
  elements.erase(std::unique(elements.begin(), elements.end()), elements.end());
  return elements;
}

double Resolver::total_energy(std::span<const Vec3> positions) const {
  double energy = 0;
  for (const auto& e : mesh_.elements())
    energy += element_energy(e, model_.rest_positions, positions, model_.bodies[0].material.poisson_ratio);
  return energy;
}

void Resolver::fill_report(ResolveReport& report) const {
  double sum = 0;
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    const double distance = (positions_[v] - input_[v]).norm();
    report.moved_vertices += distance > 0;
    report.max_displacement = std::max(report.max_displacement, distance);
    sum += distance;
  }
  report.mean_displacement = sum / static_cast<double>(positions_.size());
  for (const auto& e : mesh_.elements()) {
    report.volume_before += element_volume(e, input_);
    report.volume_after += element_volume(e, positions_);
  }
  report.elastic_energy_before = total_energy(input_);
  report.elastic_energy_after = total_energy(positions_);
  if (report.outcome != ResolveOutcome::kResolved) report.tangled_elements = find_tangled_elements();
}

void Resolver::report_iteration(ResolveReport& report, const ResolveIteration& now) const {
  report.iterations.push_back(now);
  if (options_.on_iteration) options_.on_iteration(now);
}

ResolveOutcome Resolver::untangle(ResolveReport& report) {
  for (int iteration = 0;; ++iteration) {
    const ResolveIteration now = measure(iteration);
    report_iteration(report, now);
    if (now.is_clean()) return ResolveOutcome::kResolved;
    if (has_progressed(now)) last_progress_ = iteration;
    if (iteration == options_.max_iterations) return ResolveOutcome::kGaveUp;
    if (iteration - last_progress_ >= options_.patience) return ResolveOutcome::kStuck;
    hold_contacts();
    relax();
    wake_neighbours();
  }
}

/// Lets the material come to rest, ever closer to the clearance that was asked for. Where something gets inside again,
/// it is held, too, and all is tried once more.
void Resolver::settle(ResolveReport& report) {
  double energy = total_energy(positions_);
  for (int i = 0; i < kSettling; ++i) {
    const std::vector<Vec3> resolved = positions_;
    push_.clearance = std::max(kClearanceShrinkage * push_.clearance, options_.clearance * length_);
    relax();
    const ResolveIteration now = measure(report.iterations.back().iteration + 1);
    const double energy_now = total_energy(positions_);
    if (!now.is_clean()) {
      hold_contacts();
      place(resolved);
      inverted_.clear();
    } else if (energy_now < (1 - kProgress) * energy) {
      energy = energy_now;
      wake_neighbours();
      report_iteration(report, now);
    } else {
      return place(resolved);
    }
  }
}

ResolveReport Resolver::run() {
  ResolveReport report;
  report.outcome = untangle(report);
  if (report.outcome == ResolveOutcome::kResolved && report.iterations.size() > 1) settle(report);
  fill_report(report);
  return report;
}

}  // namespace

ResolveReport resolve_collisions(const TetMesh& mesh, std::vector<Vec3>& positions, const ResolveOptions& options) {
  check_options(mesh, options);
  if (std::ssize(positions) != mesh.vertex_count())
    throw Error("positions", fmt::format("{} for {} vertices", positions.size(), mesh.vertex_count()),
                "give one per vertex");
  return Resolver(mesh, positions, options).run();
}

}  // namespace selvage
