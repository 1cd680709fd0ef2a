#pragma once

#include <functional>
#include <string>
#include <vector>

namespace selvage::bench {

/// Cost of one run: processor time of the whole process, and time on the clock [s].
struct Duration {
  double processor = 0, clock = 0;
};

/// Runs one function.
Duration measure(const std::function<void()>& run);

/// Several ways to do the same work, timed in turns, so that whatever else the machine does falls on all of them alike.
class Rounds {
 public:
  void add(std::string name, std::function<void()> run);

  /// One round unmeasured, then rounds until `seconds` are used up: at least `fewest`, at most `most`.
  void run(double seconds, int fewest = 5, int most = 51);

  int round_count() const { return static_cast<int>(contenders_.front().durations.size()); }
  bool has(const std::string& name) const;
  Duration median(const std::string& name) const;
  Duration mean(const std::string& name) const;

  /// Median over the rounds of the time of `slow` by the time of `fast` in the same round.
  Duration ratio(const std::string& slow, const std::string& fast) const;

  /// Of some contenders, the one with the smallest median processor time.
  std::string fastest(const std::vector<std::string>& names) const;

 private:
  struct Contender {
    std::string name;
    std::function<void()> run;
    std::vector<Duration> durations;
  };
  const Contender& find(const std::string& name) const;
  std::vector<Contender> contenders_;
};

}  // namespace selvage::bench
