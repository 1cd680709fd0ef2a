#include <selvage/core/error.h>
#include <selvage/core/isa.h>

#include <cstdio>

int main() {
  std::printf("kernels: %s\n", selvage::isa_name(selvage::active_isa()));
  return selvage::Error("here", "nothing").what()[0] == 'h' ? 0 : 1;
}
