#include "boundary_path/injectivity/star_proof.h"

#include <algorithm>
#include <cstdint>

namespace selvage {

namespace {

constexpr int kMaxElements = 64;
constexpr int kMaxVertices = 64;

/// A set of the star's outer vertices, by their numbers.
using VertexSet = std::uint64_t;

VertexSet set_of(int number) {
  return VertexSet{1} << number;
}

/// Numbers of the other vertices of an element with a vertex: in such an order that they are positive, seen from it.
constexpr int kOthers[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

/// The elements around a vertex, as cones from there.
class Star {
 public:
  Star(const TetMesh& mesh, std::span<const Vec3> positions, Index vertex)
      : centre_(positions[vertex]), elements_(mesh.vertex_elements(vertex)) {
    if (std::ssize(elements_) > kMaxElements) return;
    fits_ = std::all_of(elements_.begin(), elements_.end(),
                        [&](Index element) { return add(mesh.elements()[element], vertex, positions); });
  }

  bool is_proven_apart() {
    if (!fits_) return false;
    // The bound of a determinant of differences, by far, and of what underflows.
    const double bound = 0x1p-46 * reach_ * reach_ * reach_ + 0x1p-1000;
    for (int e = 0; e < count_; ++e)
      if (!find_beyond(cones_[e], bound)) return false;
    for (int a = 0; a < count_; ++a)
      for (int b = 0; b < a; ++b)
        if (!is_beyond(cones_[a], cones_[b]) && !is_beyond(cones_[b], cones_[a]) &&
            !have_plane_between(cones_[a], cones_[b], bound))
          return false;
    return true;
  }

 private:
  struct Cone {
    int corners[3];
    VertexSet all;
    VertexSet beyond[3];  ///< the vertices strictly beyond each face, and the face's own vertices
  };

  bool add(const VertexTuple<4>& element, Index vertex, std::span<const Vec3> positions) {
    const auto place = std::find(element.begin(), element.end(), vertex) - element.begin();
    Cone& cone = cones_[count_++];
    cone.all = 0;
    for (int i = 0; i < 3; ++i) {
      const int number = number_of(element[kOthers[place][i]], positions);
      if (number == kMaxVertices) return false;
      cone.corners[i] = number;
      cone.all |= set_of(number);
    }
    return true;
  }

  int number_of(Index vertex, std::span<const Vec3> positions) {
    for (int i = 0; i < outer_count_; ++i)
      if (outer_[i] == vertex) return i;
    if (outer_count_ == kMaxVertices) return kMaxVertices;
    outer_[outer_count_] = vertex;
    rays_[outer_count_] = positions[vertex] - centre_;
    reach_ = std::max(reach_, rays_[outer_count_].cwiseAbs().maxCoeff());
    return outer_count_++;
  }

  /// False where the element is not certainly positive.
  bool find_beyond(Cone& cone, double bound) const {
    const auto& [p, q, r] = cone.corners;
    if (!(rays_[p].cross(rays_[q]).dot(rays_[r]) > bound)) return false;
    for (int i = 0; i < 3; ++i) {
      const int a = cone.corners[(i + 1) % 3], b = cone.corners[(i + 2) % 3];
      const Vec3 inward = rays_[a].cross(rays_[b]);
      VertexSet beyond = 0;
      for (int k = 0; k < outer_count_; ++k) beyond |= inward.dot(rays_[k]) < -bound ? set_of(k) : 0;
      cone.beyond[i] = beyond | set_of(a) | set_of(b);
    }
    return true;
  }

  static bool is_beyond(const Cone& cone, const Cone& other) {
    return std::any_of(std::begin(cone.beyond), std::end(cone.beyond),
                       [&](VertexSet beyond) { return (other.all & ~beyond) == 0; });
  }

  /// Whether a plane through an edge of each has both strictly on their sides, but for those edges.
  bool have_plane_between(const Cone& cone, const Cone& other, double bound) const {
    for (const int a : cone.corners)
      for (const int b : other.corners) {
        const Vec3 normal = rays_[a].cross(rays_[b]);
        const auto side = [&](const Cone& of, int edge) {
          int sum = 0;
          for (const int k : of.corners) {
            const double height = k == edge ? 0 : normal.dot(rays_[k]);
            sum += (height > bound) - (height < -bound);
          }
          return sum;
        };
        if (side(cone, a) * side(other, b) == -4) return true;
      }
    return false;
  }

  Vec3 centre_;
  std::span<const Index> elements_;
  bool fits_ = false;
  double reach_ = 0;
  int count_ = 0, outer_count_ = 0;
  Cone cones_[kMaxElements];
  Index outer_[kMaxVertices];
  Vec3 rays_[kMaxVertices];
};

}  // namespace

bool is_star_proven_apart(const TetMesh& mesh, std::span<const Vec3> positions, Index vertex) {
  return Star(mesh, positions, vertex).is_proven_apart();
}

}  // namespace selvage
