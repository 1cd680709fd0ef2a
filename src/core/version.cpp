#include "selvage/version.h"

namespace selvage {

const char* version() {
  return SELVAGE_VERSION;
}

}  // namespace selvage
