#pragma once

/// Version of the headers, as numbers and as text: what an application is compiled with.
#define SELVAGE_VERSION_MAJOR 0
#define SELVAGE_VERSION_MINOR 1
#define SELVAGE_VERSION_PATCH 0
#define SELVAGE_VERSION "0.1.0"

namespace selvage {

/// Version of the library that is linked, "major.minor.patch"; equal to SELVAGE_VERSION where headers and library
/// belong together.
const char* version();

}  // namespace selvage
