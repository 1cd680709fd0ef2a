#include "shapes/stuffing/surface_smoothing.h"

#include "core/parallel.h"
#include "selvage/mesh/simplex_mesh.h"

#include <cmath>
#include <numbers>

namespace selvage {

namespace {

constexpr int kRounds = 3;
/// Dihedral angles that a move may lead to [degrees].
constexpr double kMinAngle = 25, kMaxAngle = 135;
/// Of the lattice's cell: a vertex stays where the parts of its block are all that reach it.
constexpr double kFarthest = 0.4;
/// Of the cell: a shorter move is not worth its cost.
constexpr double kStill = 0.03;

double cosine(double degrees) {
  return std::cos(degrees * std::numbers::pi / 180);
}

class Smoothing {
 public:
  Smoothing(const ImplicitSolid& solid, const BccLattice& lattice, std::span<const std::int64_t> first_vertices,
            IndexedMesh& mesh)
      : solid_(solid),
        lattice_(lattice),
        first_(first_vertices),
        positions_(mesh.positions),
        start_(mesh.positions),
        mesh_(static_cast<Index>(mesh.positions.size()), mesh.tetrahedra),
        at_boundary_(mesh.positions.size(), 0) {
    for (const Index v : mesh_.boundary_vertices()) at_boundary_[static_cast<std::size_t>(v)] = 1;
  }

  void run() {
    // Blocks of one colour have no edge in common: an edge is far shorter than a block.
    std::array<std::vector<Index>, 8> colours;
    for (Index block = 0; block < lattice_.block_count(); ++block) {
      const auto origin = lattice_.block_origin(block);
      int colour = 0;
      for (int axis = 0; axis < 3; ++axis) colour |= (origin[axis] / BccLattice::kSide & 1) << axis;
      colours[static_cast<std::size_t>(colour)].push_back(block);
    }
    for (int round = 0; round < kRounds; ++round)
      for (const std::vector<Index>& blocks : colours)
        parallel_for(std::ssize(blocks), 1, [&](std::int64_t i) { smooth_block(blocks[i]); });
  }

 private:
  void smooth_block(Index block) {
    const std::span<const Index> parts = lattice_.block_parts(block);
    for (auto v = static_cast<Index>(first_[block]); v < first_[block + 1]; ++v)
      if (at_boundary_[static_cast<std::size_t>(v)]) smooth_vertex(v, parts);
  }

  void smooth_vertex(Index v, std::span<const Index> parts) {
    const Vec3 from = positions_[v];
    const Vec3 to = on_surface(on_surface(middle_around(v), parts), parts);
    if ((to - from).norm() < kStill * lattice_.cell()) return;
    const double allowed = std::max(1.0, badness(v));
    for (const Vec3& target : {to, on_surface(0.5 * (from + to), parts)}) {
      if ((target - start_[v]).norm() > kFarthest * lattice_.cell()) continue;
      positions_[v] = target;
      if (badness(v) <= allowed) return;
    }
    positions_[v] = from;
  }

  /// Of the boundary faces around a vertex, by their areas.
  Vec3 middle_around(Index v) const {
    Vec3 sum = Vec3::Zero();
    double areas = 0;
    for (const Index face : mesh_.vertex_boundary_faces(v)) {
      const auto& [a, b, c] = mesh_.boundary_faces()[face];
      const double area = (positions_[b] - positions_[a]).cross(positions_[c] - positions_[a]).norm();
      sum += area / 3 * (positions_[a] + positions_[b] + positions_[c]);
      areas += area;
    }
    return areas > 0 ? Vec3(sum / areas) : positions_[v];
  }

  /// A step of Newton's method along the gradient.
  Vec3 on_surface(const Vec3& p, std::span<const Index> parts) const {
    const double depth = solid_.depth(p, parts), step = 1e-6 * lattice_.cell();
    Vec3 gradient;
    for (int axis = 0; axis < 3; ++axis)
      gradient[axis] = (solid_.depth(p + step * Vec3::Unit(axis), parts) - depth) / step;
    const double squared = gradient.squaredNorm();
    return squared > 1e-3 ? Vec3(p - depth / squared * gradient) : p;
  }

  /// The worst dihedral angle of a vertex's elements: 1 at the bounds of a move, more beyond; infinite where one is
  /// inverted.
  double badness(Index v) const {
    static const double sharpest = cosine(kMinAngle), bluntest = cosine(kMaxAngle);
    double worst = 0;
    for (const Index element : mesh_.vertex_elements(v)) {
      std::array<Vec3, 4> p, normals;
      for (int i = 0; i < 4; ++i) p[i] = positions_[mesh_.elements()[element][i]];
      if (!((p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]) > 0)) return HUGE_VAL;
      normals[0] = (p[2] - p[1]).cross(p[3] - p[1]).normalized();
      normals[1] = (p[3] - p[0]).cross(p[2] - p[0]).normalized();
      normals[2] = (p[1] - p[0]).cross(p[3] - p[0]).normalized();
      normals[3] = (p[2] - p[0]).cross(p[1] - p[0]).normalized();
      for (int a = 0; a < 4; ++a)
        for (int b = 0; b < a; ++b) {
          const double angle = -normals[a].dot(normals[b]);  // cosine
          worst = std::max(worst, angle > 0 ? (1 - sharpest) / (1 - std::min(angle, 1.0 - 1e-12))
                                            : (1 + bluntest) / (1 + std::max(angle, -1.0 + 1e-12)));
        }
    }
    return worst;
  }

  const ImplicitSolid& solid_;
  const BccLattice& lattice_;
  std::span<const std::int64_t> first_;
  std::vector<Vec3>& positions_;
  const std::vector<Vec3> start_;
  TetMesh mesh_;
  std::vector<std::uint8_t> at_boundary_;
};

}  // namespace

void smooth_surface(const ImplicitSolid& solid, const BccLattice& lattice, std::span<const std::int64_t> first_vertices,
                    IndexedMesh& mesh) {
  Smoothing(solid, lattice, first_vertices, mesh).run();
}

}  // namespace selvage
