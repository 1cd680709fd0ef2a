#include "selvage/simulation/resolve.h"

#include "selvage/core/error.h"
#include "simulation/relaxation.h"
#include "simulation/shape_energy.h"
#include "simulation/tangle_finder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

namespace selvage {

namespace {

/// Iterations, at most, in which the material comes to rest once all are out.
constexpr int kSettling = 30;
/// How often the ways of vertices that would turn elements inside out are evened with those of their neighbours, one
/// attempt after the other: what locks with one number comes free with another.
constexpr std::array kEvenings = {0, 8, 16, 32};
/// Part by which something must have become less to be progress.
constexpr double kProgress = 0.01;

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

class Resolver {
 public:
  Resolver(const TetMesh& mesh, std::vector<Vec3>& positions, const ResolveOptions& options)
      : mesh_(mesh),
        options_(options),
        positions_(positions),
        input_(positions),
        body_(std::in_place, mesh, positions, options, kEvenings.front()),
        tangle_(mesh, positions) {}
  ResolveReport run();

 private:
  ResolveIteration measure(int iteration);
  ResolveOutcome untangle(ResolveReport& report);
  ResolveOutcome untangle_from(int first_iteration, ResolveReport& report);
  void settle(ResolveReport& report);
  void report_iteration(ResolveReport& report, const ResolveIteration& now) const;
  bool has_progressed(const ResolveIteration& now);
  double total_energy(std::span<const Vec3> positions) const;
  void fill_report(ResolveReport& report) const;
  std::vector<Index> find_tangled_elements() const;

  const TetMesh& mesh_;
  const ResolveOptions& options_;
  std::vector<Vec3>& positions_;
  const std::vector<Vec3> input_;
  std::optional<Relaxation> body_;
  TangleFinder tangle_;
  std::optional<ResolveIteration> best_;  ///< the least of each number in this attempt
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

/// Whether anything that is wrong has become less than it ever was.
bool Resolver::has_progressed(const ResolveIteration& now) {
  if (!best_) {
    best_ = now;
    return true;
  }
  bool progressed = false;
  const auto compare = [&](auto& best, auto value) {
    if (!(static_cast<double>(value) < (1 - kProgress) * static_cast<double>(best))) return;
    best = value;
    progressed = true;
  };
  compare(best_->triangle_pairs, now.triangle_pairs);
  compare(best_->penetrating_vertices, now.penetrating_vertices);
  compare(best_->total_depth, now.total_depth);
  compare(best_->inverted_elements, now.inverted_elements);
  return progressed;
}

std::vector<Index> Resolver::find_tangled_elements() const {
  std::vector<Index> elements = tangle_.find_elements();
  elements.insert(elements.end(), body_->inverted().begin(), body_->inverted().end());
  std::sort(elements.begin(), elements.end());
  elements.erase(std::unique(elements.begin(), elements.end()), elements.end());
  return elements;
}

double Resolver::total_energy(std::span<const Vec3> positions) const {
  double energy = 0;
  for (const auto& e : mesh_.elements())
    energy +=
        element_energy(e, body_->model().rest_positions, positions, body_->model().bodies[0].material.poisson_ratio);
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

/// One attempt after the other, each from the input; only one where nothing was held back, for others would be the
/// same.
ResolveOutcome Resolver::untangle(ResolveReport& report) {
  ResolveOutcome outcome = untangle_from(0, report);
  for (std::size_t attempt = 1; attempt < kEvenings.size(); ++attempt) {
    if (outcome != ResolveOutcome::kStuck || !body_->has_held_back()) break;
    positions_ = input_;
    best_.reset();
    body_.emplace(mesh_, positions_, options_, kEvenings[attempt]);
    outcome = untangle_from(report.iterations.back().iteration + 1, report);
  }
  return outcome;
}

ResolveOutcome Resolver::untangle_from(int first_iteration, ResolveReport& report) {
  int last_progress = first_iteration;
  for (int iteration = first_iteration;; ++iteration) {
    const ResolveIteration now = measure(iteration);
    report_iteration(report, now);
    if (now.is_clean()) return ResolveOutcome::kResolved;
    if (has_progressed(now)) last_progress = iteration;
    if (iteration >= options_.max_iterations) return ResolveOutcome::kGaveUp;
    if (iteration - last_progress >= options_.patience) return ResolveOutcome::kStuck;
    body_->hold(tangle_.contacts());
    body_->relax();
    body_->wake_neighbours();
  }
}

/// Lets the material come to rest, ever closer to the clearance that was asked for. Where something gets inside again,
/// it is held, too, and all is tried once more.
void Resolver::settle(ResolveReport& report) {
  double energy = total_energy(positions_);
  for (int i = 0; i < kSettling; ++i) {
    const std::vector<Vec3> resolved = positions_;
    body_->shrink_clearance();
    body_->relax();
    const ResolveIteration now = measure(report.iterations.back().iteration + 1);
    const double energy_now = total_energy(positions_);
    if (!now.is_clean()) {
      body_->hold(tangle_.contacts());
      body_->place(resolved);
    } else if (energy_now < (1 - kProgress) * energy) {
      energy = energy_now;
      body_->wake_neighbours();
      report_iteration(report, now);
    } else {
      return body_->place(resolved);
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
