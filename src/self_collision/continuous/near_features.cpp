#include "self_collision/continuous/near_features.h"

#include "core/parallel.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace selvage {

namespace {

/// Of the mean length of an edge. More lasts for more steps, but leaves more pairs to be tested in each.
constexpr double kMarginPart = 0.03;
constexpr Index kSampledEdges = 256;
/// Where more than half of these stray, or more than one vertex in so many, all pairs are found again.
constexpr Index kSampledVertices = 64;
constexpr std::int64_t kMaxStrayedShare = 4;
/// Where more than one in so many have strayed in all, one after the other: finding the pairs of one again takes about
/// three to five times as long as listing those of all takes a vertex.
constexpr std::int64_t kMaxStrayedSumShare = 5;
constexpr int kMaxSteps = 16, kMaxFailures = 6;
/// What rests takes more steps than that to move by the margin.
constexpr double kRestingSteps = 16;
/// What trembles does not move on: of its way, by how much that of a vertex may differ from the one before.
constexpr double kMaxTurn = 0.5;
/// Of the mean length of an edge: how far most vertices may move within a motion.
constexpr double kMaxWayPart = 0.5;

/// Calls with vertices of a sample.
template <typename Use>
Index sample_vertices(Index count, Use&& use) {
  const Index asked = std::min(count, kSampledVertices);
  for (Index i = 0; i < asked; ++i) use(static_cast<Index>(static_cast<std::int64_t>(i) * count / asked));
  return asked;
}

double median(std::vector<double>& values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double largest(const Vec3& x) {
  return x.cwiseAbs().maxCoeff();
}

/// NaN is not near anything.
bool is_near(const Vec3& a, const Vec3& b, double margin) {
  return ((a - b).array().abs() <= margin).all();
}

}  // namespace

void move_on(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1, int steps,
             std::vector<Vec3>& positions) {
  positions.resize(positions_t0.size());
  parallel_for(std::ssize(positions_t0), kGrain, [&](std::int64_t v) {
    positions[v] = steps == 1 ? positions_t1[v] : Vec3(positions_t0[v] + steps * (positions_t1[v] - positions_t0[v]));
  });
}

NearFeatures::NearFeatures(const TriangleMesh& mesh, const ListPays& pays) : mesh_(mesh), pays_(pays), taken_(mesh) {}

double NearFeatures::margin_at(std::span<const Vec3> positions) const {
  const Index count = mesh_.edge_count(), asked = std::min(count, kSampledEdges);
  double sum = 0;
  for (Index i = 0; i < asked; ++i) {
    const auto& [a, b] = mesh_.edges()[static_cast<std::int64_t>(i) * count / asked];
    sum += (positions[b] - positions[a]).norm();
  }
  return asked > 0 ? kMarginPart * sum / asked : 0;
}

int NearFeatures::choose_steps(double margin, std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1,
                               std::span<const Vec3> last_t0, std::span<const Vec3> last_t1) const {
  std::vector<double> ways, turns;
  const Index asked = sample_vertices(mesh_.vertex_count(), [&](Index v) {
    const Vec3 way = positions_t1[v] - positions_t0[v];
    ways.push_back(largest(way));
    turns.push_back(largest(way - (last_t1[v] - last_t0[v])));
  });
  if (asked == 0) return 0;
  const double way = median(ways), turn = median(turns);
  const double longest = kMaxWayPart / kMarginPart * margin / way;
  const int steps = turn > kMaxTurn * way ? 1 : longest < steps_wanted_ ? static_cast<int>(longest) : steps_wanted_;
  return steps > 1 ? steps : way < 0.5 * margin ? 1 : 0;
}

bool NearFeatures::nearly_rests(double margin, std::span<const Vec3> positions_t0,
                                std::span<const Vec3> positions_t1) const {
  std::vector<double> ways;
  sample_vertices(mesh_.vertex_count(), [&](Index v) { ways.push_back(largest(positions_t1[v] - positions_t0[v])); });
  return !ways.empty() && kRestingSteps * median(ways) < margin;
}

void NearFeatures::clear() {
  if (is_set_) steps_wanted_ = step_ + 1 >= steps_ ? std::min(2 * steps_, kMaxSteps) : std::max(2, step_ + 1);
  is_set_ = false;
}

void NearFeatures::end() {
  if (is_set_) {
    if (has_paid())
      failures_ = steps_without_ = 0;
    else
      count_failure();
  }
  clear();
}

void NearFeatures::count_failure() {
  failures_ = std::min(failures_ + 1, kMaxFailures);
  steps_without_ = pays_.first_wait << failures_;
}

bool NearFeatures::is_due() {
  if (steps_without_ == 0) return true;
  --steps_without_;
  return false;
}

void NearFeatures::set_motion(double margin, int steps, const SweptSurface& motion) {
  is_set_ = true;
  margin_ = margin;
  steps_ = steps;
  step_ = 0;
  strayed_sum_ = uses_ = 0;
  motion_ = motion;
  vertex_face_.clear();
  edge_edge_.clear();
  strayed_.clear();
  taken_.clear();
  is_listed_.assign(mesh_.vertex_count(), 0);
}

Vec3 NearFeatures::place_of(Index vertex, int step) const {
  const Vec3 &start = motion_.positions_t0()[vertex], &end = motion_.positions_t1()[vertex];
  if (step == 0) return start;
  if (step == steps_) return end;
  return start + step / static_cast<double>(steps_) * (end - start);
}

/// NaN strays.
bool NearFeatures::strays(Index vertex, const Vec3& position_t0, const Vec3& position_t1) const {
  const Vec3 &start = motion_.positions_t0()[vertex], &end = motion_.positions_t1()[vertex];
  const double margin = margin_ - 0x1p-50 * (largest(start) + largest(end));  // for rounding
  return !is_near(position_t0, place_of(vertex, step_), margin) ||
         !is_near(position_t1, place_of(vertex, step_ + 1), margin);
}

/// Goes on to the step of the motion that these positions are in: the one with the least sum of differences. Whichever
/// it is, no pair is missed.
void NearFeatures::find_step(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1) {
  const int last = std::min(step_ + 2, steps_ - 1);
  if (step_ == last) return;
  double least = std::numeric_limits<double>::infinity();
  int nearest = step_;
  for (int step = step_; step <= last; ++step) {
    double sum = 0;
    sample_vertices(mesh_.vertex_count(), [&](Index v) {
      sum += largest(positions_t0[v] - place_of(v, step)) + largest(positions_t1[v] - place_of(v, step + 1));
    });
    if (!(sum < least)) continue;
    least = sum;
    nearest = step;
  }
  step_ = nearest;
}

bool NearFeatures::find_strayed(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1) {
  find_step(positions_t0, positions_t1);
  const Index count = mesh_.vertex_count();
  const auto does_stray = [&](Index v) { return strays(v, positions_t0[v], positions_t1[v]); };
  Index sampled = 0;
  const Index asked = sample_vertices(count, [&](Index v) { sampled += does_stray(v); });
  if (2 * sampled > asked) return false;
  struct Strayed {
    std::vector<Index> vertices;
    void add(const Strayed& other) { vertices.insert(vertices.end(), other.vertices.begin(), other.vertices.end()); }
  };
  strayed_ = parallel_reduce<Strayed>(count, kGrain, [&](std::int64_t first, std::int64_t last, Strayed& strayed) {
               for (auto v = static_cast<Index>(first); v < last; ++v)
                 if (does_stray(v)) strayed.vertices.push_back(v);
             }).vertices;
  if (kMaxStrayedShare * std::ssize(strayed_) > count) return false;
  strayed_sum_ += std::ssize(strayed_);
  return true;
}

bool NearFeatures::is_worn() const {
  return kMaxStrayedSumShare * strayed_sum_ > mesh_.vertex_count();
}

/// Whether the list has cost less than the searches that it served would have.
bool NearFeatures::has_paid() const {
  return uses_ >= pays_.min_searches && pays_.max_strayed_rate * strayed_sum_ <= uses_ * mesh_.vertex_count();
}

bool NearFeatures::take_strayed(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1) {
  strayed_ends_.clear();
  for (const Index v : strayed_) {
    taken_.mark(v);
    const Vec3 way = positions_t1[v] - positions_t0[v];
    strayed_ends_.push_back({step_ == 0 ? positions_t0[v] : Vec3(positions_t0[v] - step_ * way),
                             step_ + 1 == steps_ ? positions_t1[v] : Vec3(positions_t0[v] + (steps_ - step_) * way)});
  }
  is_set_ = motion_.replace(mesh_, strayed_, strayed_ends_, taken_.triangles());
  return is_set_;
}

void NearFeatures::set_pairs(std::span<const ContinuousResult> results) {
  const auto has_strayed = [&](const FeaturePair& pair) { return taken_.has_any(pair.vertices); };
  std::erase_if(vertex_face_, has_strayed);
  std::erase_if(edge_edge_, has_strayed);
  for (const ContinuousResult& result : results) {
    vertex_face_.insert(vertex_face_.end(), result.near_vertex_face.begin(), result.near_vertex_face.end());
    edge_edge_.insert(edge_edge_.end(), result.near_edge_edge.begin(), result.near_edge_edge.end());
  }
  vertices_.clear();
  for (const auto* pairs : {&vertex_face_, &edge_edge_})
    for (const FeaturePair& pair : *pairs)
      for (const Index v : pair.vertices)
        if (std::exchange(is_listed_[v], 1) == 0) vertices_.push_back(v);
  for (const Index v : vertices_) is_listed_[v] = 0;
  strayed_.clear();
  taken_.clear();
}

}  // namespace selvage
