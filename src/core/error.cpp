#include "selvage/core/error.h"

#include <fmt/format.h>

namespace selvage {

namespace {

std::string one_line(std::string_view where, std::string_view what, std::string_view remedy) {
  return fmt::format("{}{}{}{}{}", where, where.empty() ? "" : ": ", what, remedy.empty() ? "" : "; ", remedy);
}

}  // namespace

Error::Error(std::string_view where, std::string_view what, std::string_view remedy)
    : std::runtime_error(one_line(where, what, remedy)) {}

}  // namespace selvage
