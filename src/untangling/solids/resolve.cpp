#include "selvage/untangling/resolve.h"

#include "elasticity/neo_hookean.h"
#include "elasticity/simplex_element.h"
#include "selvage/core/error.h"
#include "untangling/solids/held_elements.h"
#include "untangling/solids/posed_rest.h"
#include "untangling/solids/relaxation.h"
#include "untangling/solids/tangle_finder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace selvage {

namespace {

/// Iterations in which the material relaxes once no point is inside: in all, and without progress.
constexpr int kMaxRelaxations = 60, kRelaxationPatience = 10;
/// Iterations without progress after which the material yields.
constexpr int kYield = 10;
/// Iterations in which a mesh that keeps its pose must come free before it is let out of it.
constexpr int kPosedIterations = 60;
/// Part by which a number must have become less to count as progress.
constexpr double kProgress = 0.01;

/// Rounds in which moves that cause new collisions are halved.
constexpr int kMaxRetreats = 12;
/// Halvings of a move in one round, and those from which on the move is undone.
constexpr int kHalvingsPerRetreat = 2, kUndoneMove = 4;

void make_set(std::vector<Index>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

/// Raises halvings until those of neighbours differ by one at most.
void grade(const TetMesh& mesh, std::span<int> halvings) {
  for (int level = kUndoneMove; level > 1; --level)
    for (const auto& element : mesh.elements())
      if (std::any_of(element.begin(), element.end(), [&](Index v) { return halvings[v] == level; }))
        for (const Index v : element) halvings[v] = std::max(halvings[v], level - 1);
}

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

/// Shapes that the mesh is at rest in while it is untangled, in the order in which they are tried.
enum class Attempt {
  kPose,   ///< the pose, with the given rest near the tangle
  kRest,   ///< the given rest: some tangles open only where the mesh stands up; then it is bent back
  kInput,  ///< the input: a given rest may drive the tangle ever deeper, as one that is much larger does
};

Attempt first_attempt(const ResolveOptions& options) {
  if (options.rest_positions.empty()) return Attempt::kInput;
  return options.keep_pose ? Attempt::kPose : Attempt::kRest;
}

/// The shape that is without stress.
std::vector<Vec3> rest_of(const TetMesh& mesh, std::span<const Vec3> positions, const ResolveOptions& options) {
  if (options.rest_positions.empty()) return {positions.begin(), positions.end()};
  if (options.keep_pose) return find_posed_rest(mesh, options.rest_positions, positions, options);
  return options.rest_positions;
}

class Resolver {
 public:
  Resolver(const TetMesh& mesh, std::vector<Vec3>& positions, const ResolveOptions& options)
      : mesh_(mesh),
        options_(options),
        positions_(positions),
        input_(positions),
        rest_(rest_of(mesh, positions, options)),
        body_(std::in_place, mesh, positions, rest_, input_, options),
        tangle_(mesh, positions),
        attempt_(first_attempt(options)) {}
  ResolveReport run();

 private:
  ResolveIteration measure(int iteration);
  ResolveOutcome untangle(ResolveReport& report);
  void yield();
  bool must_start_anew(const ResolveIteration& now, const ResolveIteration& first, int without_gain) const;
  void start_anew();
  void relax_to_rest(ResolveReport& report);
  void report_iteration(ResolveReport& report, const ResolveIteration& now) const;
  bool has_improved(const ResolveIteration& now);
  bool has_spread(const ResolveIteration& now);
  double total_energy(std::span<const Vec3> positions) const;
  void fill_report(ResolveReport& report) const;
  void fill_tangle(ResolveReport& report) const;
  std::vector<Index> vertices_of(std::span<const Index> elements) const;
  std::vector<Index> find_tangled_elements() const;
  std::vector<Index> find_tangled_vertices() const;
  ResolveIteration retreat(std::span<const Vec3> clean, int iteration);

  /// The least of each number so far, and the largest number of awake vertices.
  struct Best {
    double triangle_pairs = HUGE_VAL, penetrating_vertices = HUGE_VAL, total_depth = HUGE_VAL;
    double inverted_elements = HUGE_VAL, drawn_vertices = HUGE_VAL;
    double awake_vertices = 0;
  };

  const TetMesh& mesh_;
  const ResolveOptions& options_;
  std::vector<Vec3>& positions_;
  const std::vector<Vec3> input_, rest_;
  std::optional<Relaxation> body_;
  TangleFinder tangle_;
  std::vector<Index> held_;
  bool has_yielded_ = false;
  Attempt attempt_;
  Best best_;
};

ResolveIteration Resolver::measure(int iteration) {
  ResolveIteration now = tangle_.measure(positions_);
  now.iteration = iteration;
  now.inverted_elements = std::ssize(body_->inverted());
  now.awake_vertices = body_->count_awake();
  for (std::size_t v = 0; v < positions_.size(); ++v)
    now.max_displacement = std::max(now.max_displacement, (positions_[v] - input_[v]).norm());
  return now;
}

/// Whether any number has become less than it ever was. While points wait, those of penetrations are incomplete.
bool Resolver::has_improved(const ResolveIteration& now) {
  bool improved = false;
  const auto compare = [&](double& best, auto value) {
    if (!(static_cast<double>(value) < (1 - kProgress) * best)) return;
    best = static_cast<double>(value);
    improved = true;
  };
  compare(best_.triangle_pairs, now.triangle_pairs);
  compare(best_.inverted_elements, now.inverted_elements);
  // While an end is drawn through a crossing, the other numbers may stay the same.
  if (body_->drawn_vertices() > 0) compare(best_.drawn_vertices, body_->drawn_vertices());
  if (now.waiting_points > 0) return improved;
  compare(best_.penetrating_vertices, now.penetrating_vertices);
  compare(best_.total_depth, now.total_depth);
  return improved;
}

/// Whether more vertices are awake than ever.
bool Resolver::has_spread(const ResolveIteration& now) {
  const auto awake = static_cast<double>(now.awake_vertices);
  if (!((1 - kProgress) * awake > best_.awake_vertices)) return false;
  best_.awake_vertices = awake;
  return true;
}

std::vector<Index> Resolver::find_tangled_vertices() const {
  std::vector<Index> vertices = vertices_of(find_tangled_elements());
  for (const Contact& contact : tangle_.contacts())
    vertices.insert(vertices.end(), contact.vertices.begin(), contact.vertices.begin() + contact.count);
  make_set(vertices);
  return vertices;
}

std::vector<Index> Resolver::vertices_of(std::span<const Index> elements) const {
  std::vector<Index> vertices;
  for (const Index e : elements)
    vertices.insert(vertices.end(), mesh_.elements()[e].begin(), mesh_.elements()[e].end());
  make_set(vertices);
  return vertices;
}

std::vector<Index> Resolver::find_tangled_elements() const {
  std::vector<Index> elements = tangle_.find_elements();
  elements.insert(elements.end(), body_->inverted().begin(), body_->inverted().end());
  make_set(elements);
  return elements;
}

double Resolver::total_energy(std::span<const Vec3> positions) const {
  double energy = 0;
  const NeoHookean material = NeoHookean::of(1, body_->model().bodies[0].material.poisson_ratio);
  for (const auto& e : mesh_.elements())
    energy += SimplexElement<3, NeoHookean>{rest_tetrahedron(e, rest_), material}.energy(gather(e, positions));
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
    report.volume_at_rest += element_volume(e, options_.rest_positions.empty() ? input_ : options_.rest_positions);
  }
  report.elastic_energy_before = total_energy(input_);
  report.elastic_energy_after = total_energy(positions_);
}

/// The elements that collide, and their pinned vertices.
void Resolver::fill_tangle(ResolveReport& report) const {
  std::vector<Index> vertices;
  if (report.outcome == ResolveOutcome::kHeld) {
    report.tangled_elements = held_;
    vertices = vertices_of(held_);
  } else {
    report.tangled_elements = find_tangled_elements();
    vertices = find_tangled_vertices();
  }
  std::vector<Index> pinned = options_.pinned;
  make_set(pinned);
  std::set_intersection(vertices.begin(), vertices.end(), pinned.begin(), pinned.end(),
                        std::back_inserter(report.holding_vertices));
}

void Resolver::report_iteration(ResolveReport& report, const ResolveIteration& now) const {
  report.iterations.push_back(now);
  if (options_.on_iteration) options_.on_iteration(now);
}

/// Takes the present shape as the rest shape. Creases that overlap at rest would pull back in for ever, and where
/// contacts and material pull against each other neither yields. After that, only vertices of contacts are awake.
void Resolver::yield() {
  if (!body_->inverted().empty()) return;
  body_.emplace(mesh_, positions_, positions_, input_, options_);
  has_yielded_ = true;
}

/// Whether the next attempt begins: this one gains nothing, or to keep the pose takes too long or leads deeper than the
/// input was. How deep that was is known where nothing is inverted.
bool Resolver::must_start_anew(const ResolveIteration& now, const ResolveIteration& first, int without_gain) const {
  if (attempt_ == Attempt::kInput) return false;
  const bool is_upright = first.inverted_elements == 0;
  if (attempt_ == Attempt::kRest) return is_upright && without_gain >= kYield;
  return without_gain >= kYield || now.iteration >= kPosedIterations ||
         (is_upright && now.iteration >= kYield && now.penetrating_vertices > first.penetrating_vertices);
}

/// Begins again from the input with the shape of the next attempt at rest. The first is what the material comes to in
/// the end.
void Resolver::start_anew() {
  attempt_ = attempt_ == Attempt::kPose ? Attempt::kRest : Attempt::kInput;
  positions_ = input_;
  best_ = {};
  body_.emplace(mesh_, positions_, attempt_ == Attempt::kRest ? options_.rest_positions : input_, input_, options_);
  has_yielded_ = true;
}

ResolveOutcome Resolver::untangle(ResolveReport& report) {
  int last_better = 0, last_progress = 0;
  for (int iteration = 0;; ++iteration) {
    const ResolveIteration now = measure(iteration);
    report_iteration(report, now);
    if (now.is_clean()) return ResolveOutcome::kResolved;
    if (iteration == 0) held_ = find_held_elements(mesh_, positions_, options_.pinned);
    if (!held_.empty()) return ResolveOutcome::kHeld;
    if (has_improved(now)) last_better = last_progress = iteration;
    if (has_spread(now)) last_progress = iteration;
    if (iteration >= options_.max_iterations) return ResolveOutcome::kGaveUp;
    const int waited = iteration - last_progress;
    if (waited >= options_.patience) return ResolveOutcome::kStuck;
    if (must_start_anew(now, report.iterations.front(), iteration - last_better)) {
      start_anew();
      last_better = last_progress = iteration;
      continue;
    }
    if (waited > 0 && waited % kYield == 0) yield();
    body_->hold(tangle_.contacts());
    body_->relax();
    body_->wake_neighbours();
  }
}

/// Moves vertices that collide again back towards positions without collision, their neighbours by less, and leaves all
/// others: else a few tight places would stop the whole mesh.
ResolveIteration Resolver::retreat(std::span<const Vec3> clean, int iteration) {
  ResolveIteration now = measure(iteration);
  if (now.is_clean()) return now;
  body_->hold(tangle_.contacts());
  const std::vector<Vec3> goal = positions_;
  std::vector<int> halvings(goal.size(), 0);
  for (int round = 0; round < kMaxRetreats && !now.is_clean(); ++round) {
    for (const Index v : find_tangled_vertices())
      halvings[v] = std::min(halvings[v] + kHalvingsPerRetreat, kUndoneMove);
    grade(mesh_, halvings);
    std::vector<Vec3> between = goal;
    for (std::size_t v = 0; v < goal.size(); ++v) {
      if (halvings[v] == 0) continue;
      const double part = halvings[v] < kUndoneMove ? std::ldexp(1, -halvings[v]) : 0;
      between[v] = clean[v] + part * (goal[v] - clean[v]);
      // It may by rounding.
      if ((between[v] - input_[v]).norm() > options_.max_displacement) between[v] = clean[v];
    }
    body_->place(between);
    now = measure(iteration);
  }
  if (!now.is_clean()) body_->place(clean);
  return now;
}

/// Relaxes the material while the distance of surfaces that met shrinks to the clearance that was asked for. Points
/// that get inside again have contacts from then on. The state of least energy without collision is kept.
void Resolver::relax_to_rest(ResolveReport& report) {
  std::vector<Vec3> clean = positions_, best = positions_;
  double least = total_energy(positions_);
  if (has_yielded_) {
    body_.emplace(mesh_, positions_, rest_, input_, options_);
    body_->wake_displaced();
  }
  for (int i = 0, waited = 0; i < kMaxRelaxations && waited < kRelaxationPatience; ++i, ++waited) {
    body_->shrink_clearance();
    body_->relax();
    const ResolveIteration now = retreat(clean, report.iterations.back().iteration + 1);
    clean = positions_;
    const double energy = total_energy(positions_);
    if (now.is_clean() && energy < (1 - kProgress) * least) {
      report_iteration(report, now);
      best = positions_;
      least = energy;
      waited = 0;
    }
    body_->wake_neighbours();
  }
  body_->place(best);
}

ResolveReport Resolver::run() {
  ResolveReport report;
  report.outcome = untangle(report);
  if (report.outcome == ResolveOutcome::kResolved && report.iterations.size() > 1) relax_to_rest(report);
  fill_report(report);
  if (report.outcome != ResolveOutcome::kResolved) fill_tangle(report);
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
