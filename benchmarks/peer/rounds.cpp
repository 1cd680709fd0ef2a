#include "peer/rounds.h"

#include <algorithm>
#include <ctime>
#include <random>

namespace selvage::bench {

namespace {

double seconds_of(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + values.size() / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Medians of both kinds of time of what `get(i)` says for each round i.
template <typename Get>
Duration medians(std::size_t count, Get get) {
  std::vector<double> processor, clock;
  for (std::size_t i = 0; i < count; ++i) {
    const Duration d = get(i);
    processor.push_back(d.processor);
    clock.push_back(d.clock);
  }
  return {median_of(std::move(processor)), median_of(std::move(clock))};
}

}  // namespace

Duration measure(const std::function<void()>& run) {
  // The processor's time costs a system call, half a microsecond: outside of what the clock measures.
  const double processor = seconds_of(CLOCK_PROCESS_CPUTIME_ID), clock = seconds_of(CLOCK_MONOTONIC);
  run();
  const double clock_after = seconds_of(CLOCK_MONOTONIC);
  return {seconds_of(CLOCK_PROCESS_CPUTIME_ID) - processor, clock_after - clock};
}

void Rounds::add(std::string name, std::function<void()> run) {
  contenders_.push_back({std::move(name), std::move(run), {}});
}

void Rounds::run(double seconds, int fewest, int most) {
  for (const Contender& c : contenders_) c.run();
  const double end = seconds_of(CLOCK_MONOTONIC) + seconds;
  // In an order of its own each round: who comes after another finds in the caches what both read.
  std::vector<Contender*> order;
  for (Contender& c : contenders_) order.push_back(&c);
  std::mt19937 random;
  for (int i = 0; i < most && (i < fewest || seconds_of(CLOCK_MONOTONIC) < end); ++i) {
    std::shuffle(order.begin(), order.end(), random);
    for (Contender* c : order) c->durations.push_back(measure(c->run));
  }
}

const Rounds::Contender& Rounds::find(const std::string& name) const {
  return *std::find_if(contenders_.begin(), contenders_.end(), [&](const Contender& c) { return c.name == name; });
}

bool Rounds::has(const std::string& name) const {
  return std::any_of(contenders_.begin(), contenders_.end(), [&](const Contender& c) { return c.name == name; });
}

Duration Rounds::median(const std::string& name) const {
  const auto& durations = find(name).durations;
  return medians(durations.size(), [&](std::size_t i) { return durations[i]; });
}

Duration Rounds::mean(const std::string& name) const {
  const auto& durations = find(name).durations;
  Duration mean;
  for (const Duration& d : durations) {
    mean.processor += d.processor / static_cast<double>(durations.size());
    mean.clock += d.clock / static_cast<double>(durations.size());
  }
  return mean;
}

Duration Rounds::ratio(const std::string& slow, const std::string& fast) const {
  const auto &a = find(slow).durations, &b = find(fast).durations;
  return medians(a.size(), [&](std::size_t i) {
    return Duration{a[i].processor / b[i].processor, a[i].clock / b[i].clock};
  });
}

std::string Rounds::fastest(const std::vector<std::string>& names) const {
  return *std::min_element(names.begin(), names.end(), [&](const std::string& a, const std::string& b) {
    return median(a).processor < median(b).processor;
  });
}

}  // namespace selvage::bench
