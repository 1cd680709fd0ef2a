#pragma once

#include <string_view>

namespace selvage {

/// The page without its data: viewer/dist/index.html, as it was when the program was built.
std::string_view page_template();

}  // namespace selvage
