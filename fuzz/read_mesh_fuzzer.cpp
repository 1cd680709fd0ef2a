// libFuzzer target of each mesh file format, named fuzz_read_<format>: whatever the bytes, reading gives a mesh that
// keeps every promise of read_mesh, or an Error of one line.
#include "io/format.h"
#include "selvage/core/error.h"

#include <algorithm>
#include <cstdlib>

namespace {

using namespace selvage;

template <std::size_t N>
bool are_valid(const std::vector<VertexTuple<N>>& elements, std::size_t vertices) {
  return std::all_of(elements.begin(), elements.end(), [&](VertexTuple<N> element) {
    std::sort(element.begin(), element.end());
    return element.front() >= 0 && static_cast<std::size_t>(element.back()) < vertices &&
           std::adjacent_find(element.begin(), element.end()) == element.end();
  });
}

bool is_valid(const IndexedMesh& mesh) {
  const bool finite =
      std::all_of(mesh.positions.begin(), mesh.positions.end(), [](const Vec3& p) { return p.allFinite(); });
  return finite && !(mesh.triangles.empty() && mesh.tetrahedra.empty()) &&
         are_valid(mesh.triangles, mesh.positions.size()) && are_valid(mesh.tetrahedra, mesh.positions.size());
}

std::string extension;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** argv) {
  const std::string_view program = **argv;
  extension = "." + std::string(program.substr(program.rfind('_') + 1));
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* bytes, std::size_t size) {
  // A pair of files is one input, split at the first zero byte.
  const std::string_view input(reinterpret_cast<const char*>(bytes), size);
  const bool paired = extension == ".node";
  const std::size_t split = paired ? std::min(input.find('\0'), size) : size;
  const std::string_view twin = split < size ? input.substr(split + 1) : std::string_view();
  try {
    if (!is_valid(format::parse_mesh(extension, {input.substr(0, split), "input"}, {twin, "twin"}))) std::abort();
  } catch (const Error& error) {
    if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
  }
  return 0;
}
