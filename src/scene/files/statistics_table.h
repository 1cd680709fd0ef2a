#pragma once

#include "selvage/scene/run.h"

namespace selvage {

/// First line of statistics.csv: names of the columns.
std::string statistics_header();

/// One line, numbers in the shortest form that is read back to the same bits.
std::string statistics_row(const FrameStatistics& row);

/// Rows of a table up to `last_frame`; a line that was cut off, and all that follows, is left out.
/// @throws Error  when the header is another one, or a row up to `last_frame` is missing or damaged
std::vector<FrameStatistics> parse_statistics(std::string_view text, const std::string& name, std::int64_t last_frame);

}  // namespace selvage
