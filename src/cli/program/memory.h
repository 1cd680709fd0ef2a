#pragma once

namespace selvage::cli {

/// Takes the memory of a short command in few and large pages, where the system has them, and keeps what is freed for
/// what comes next: otherwise the first touch of every 4 KiB costs about as much as filling them. For commands that
/// read, compute once and end. A hint: nothing depends on it.
void take_large_pages();

}  // namespace selvage::cli
