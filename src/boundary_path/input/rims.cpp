#include "boundary_path/input/rims.h"

namespace selvage {

namespace {

struct Rim {
  int length = 0;
  std::array<Index, Rims::kMaxLength> vertices;
};

/// The rim of a vertex; of length 0 where its boundary faces are not one fan in which each is listed as the others are,
/// or are too many.
Rim rim_of(const SimplexMesh<3>& mesh, Index v) {
  const auto star = mesh.vertex_boundary_faces(v);
  if (star.size() > Rims::kMaxLength) return {};
  Rim rim;
  Index face = star.front(), from = kNone;
  do {
    const auto& f = mesh.boundary_faces()[face];
    const int k = f[0] == v ? 0 : f[1] == v ? 1 : 2;
    if (from != kNone && f[(k + 1) % 3] != from) return {};
    rim.vertices[rim.length++] = f[(k + 1) % 3];
    from = f[(k + 2) % 3];
    face = mesh.boundary_neighbours()[face][(k + 1) % 3];
  } while (face != star.front() && rim.length < std::ssize(star));
  const bool is_closed = face == star.front() && rim.length == std::ssize(star) && from == rim.vertices[0];
  return is_closed ? rim : Rim{};
}

}  // namespace

Rims::Rims(const SimplexMesh<3>& mesh) {
  struct Open {
    std::array<Index, RimBatch::kWidth> centres;
    std::array<Rim, RimBatch::kWidth> rims;
    int count = 0;
  };
  std::array<Open, kMaxLength + 1> open;
  const auto close = [&](Open& batch) {
    if (batch.count == 0) return;
    const int length = batch.rims[0].length;
    batches.push_back({std::ssize(vertices), length, batch.count});
    const auto lane = [&](int i) { return i < batch.count ? i : 0; };
    for (int i = 0; i < RimBatch::kWidth; ++i) vertices.push_back(batch.centres[lane(i)]);
    for (int k = 0; k < length; ++k)
      for (int i = 0; i < RimBatch::kWidth; ++i) vertices.push_back(batch.rims[lane(i)].vertices[k]);
    batch.count = 0;
  };
  for (Index v : mesh.boundary_vertices()) {
    const Rim rim = rim_of(mesh, v);
    if (rim.length == 0) {
      others.push_back(v);
      continue;
    }
    Open& batch = open[rim.length];
    batch.centres[batch.count] = v;
    batch.rims[batch.count++] = rim;
    if (batch.count == RimBatch::kWidth) close(batch);
  }
  for (Open& batch : open) close(batch);
}

Rims::Rims(const SimplexMesh<2>& mesh) : others(mesh.boundary_vertices().begin(), mesh.boundary_vertices().end()) {}

}  // namespace selvage
