#pragma once

#include "selvage/scene/frames.h"
#include "selvage/scene/run.h"

namespace selvage {

/// The folder that a run writes to. One process at a time.
///
/// A frame is stored in this order: pictures of it for other programs, its positions, its row of statistics, the
/// checkpoint. The checkpoint decides which frame is the last whole one.
class RunFolder {
 public:
  /// Makes the folder, and bars other processes from it.
  /// @throws Error        when another process runs there, or it holds a run that is not to be continued
  /// @throws SystemError  when it cannot be made
  RunFolder(const Scene& scene, const RunOptions& options);
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  /// Where an earlier run stopped: its state and rows; nothing of it beyond that frame is left in the folder.
  struct Stop {
    std::int64_t frame;
    State state;
    std::vector<FrameStatistics> rows;
  };
  /// @throws Error  when the run is another scene's, or a file is damaged
  std::optional<Stop> find_stop() const;

  /// Writes the files that all frames share.
  void begin() const;

  /// @param positions     of the frame; those of the state go to the checkpoint
  /// @throws SystemError  when something cannot be written; the frame is then not there
  void store_frame(const State& state, std::span<const Vec3> positions, const FrameStatistics& row) const;

  /// @param json  of the frame's check
  void store_check(std::int64_t frame, std::string_view json) const;

  void store_summary(std::string_view json) const;

 private:
  void refuse_other_run() const;
  void clear_unfinished(std::int64_t last_frame) const;
  void export_frame(std::int64_t frame, const State& state) const;
  void list_vtu_files(std::int64_t last_frame) const;
  void append_row(const FrameStatistics& row) const;
  std::filesystem::path statistics_path() const { return options_.folder / "statistics.csv"; }

  const Scene& scene_;
  const RunOptions& options_;
  int lock_ = -1;
};

}  // namespace selvage
