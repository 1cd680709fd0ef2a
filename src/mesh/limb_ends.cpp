#include "mesh/limb_ends.h"

#include "mesh/vertex_regions.h"

#include <algorithm>
#include <array>

namespace selvage {

namespace {

/// Least number of vertices of an end for each vertex of the region that cuts it off. Smaller pieces reach no farther
/// than the region is wide: corners that stick out of a tangle, others in every iteration.
constexpr double kMinShare = 0.5;

/// Graph of the regions and of the connected pieces between them; edges join those that touch.
class PieceGraph {
 public:
  PieceGraph(const TetMesh& mesh, std::span<const Vec3> positions, std::span<const Index> regions) {
    number_pieces(mesh, regions);
    for (const auto& element : mesh.elements()) add_element(element, positions);
  }

  std::map<Index, LimbEnd> find_ends() const {
    std::map<Index, LimbEnd> ends;
    for (const auto& [region, piece] : region_pieces_) {
      std::vector<LimbEnd> limbs = list_limbs(piece);
      if (limbs.size() < 2) continue;
      std::stable_sort(limbs.begin(), limbs.end(),
                       [](const LimbEnd& a, const LimbEnd& b) { return a.vertices > b.vertices; });
      if (static_cast<double>(limbs[1].vertices) < kMinShare * static_cast<double>(sizes_[piece])) continue;
      ends[region] = limbs[1];
      ends[region].way.normalize();
    }
    return ends;
  }

 private:
  void number_pieces(const TetMesh& mesh, std::span<const Index> regions) {
    std::vector<Index> others;
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      if (regions[v] == kNone) others.push_back(v);
    VertexRegions between(mesh, others);
    std::map<Index, Index> between_pieces;
    for (Index v = 0; v < mesh.vertex_count(); ++v) {
      auto& numbers = regions[v] == kNone ? between_pieces : region_pieces_;
      const Index name = regions[v] == kNone ? between.find(v) : regions[v];
      const Index piece = numbers.try_emplace(name, static_cast<Index>(sizes_.size())).first->second;
      if (piece == std::ssize(sizes_)) sizes_.push_back(0);
      ++sizes_[piece];
      pieces_.push_back(piece);
    }
    neighbours_.resize(sizes_.size());
  }

  void add_element(const VertexTuple<4>& element, std::span<const Vec3> positions) {
    std::array<Index, 4> pieces;
    for (int k = 0; k < 4; ++k) pieces[k] = pieces_[element[k]];
    if (pieces[0] == pieces[1] && pieces[0] == pieces[2] && pieces[0] == pieces[3]) return;
    std::array<Index, 4> distinct = pieces;
    std::sort(distinct.begin(), distinct.end());
    const std::span others(distinct.begin(), std::unique(distinct.begin(), distinct.end()));
    for (int k = 0; k < 4; ++k) {
      const Vec3 area = area_towards(element, k, positions);
      for (const Index other : others)
        if (other != pieces[k]) neighbours_[pieces[k]].try_emplace(other, Vec3::Zero()).first->second += area;
    }
  }

  /// Of the face opposite a corner.
  static Vec3 area_towards(const VertexTuple<4>& element, int corner, std::span<const Vec3> positions) {
    const Vec3 &p = positions[element[corner]], &a = positions[element[(corner + 1) % 4]];
    const Vec3 &b = positions[element[(corner + 2) % 4]], &c = positions[element[(corner + 3) % 4]];
    const Vec3 area = (b - a).cross(c - a);
    return area.dot(p - a) < 0 ? Vec3(-area) : area;
  }

  /// Connected pieces that are left without one.
  std::vector<LimbEnd> list_limbs(Index cut) const {
    std::vector<LimbEnd> limbs;
    std::vector<std::uint8_t> is_seen(sizes_.size());
    is_seen[cut] = true;
    for (const auto& [first, _] : neighbours_[cut]) {
      if (is_seen[first]) continue;
      LimbEnd limb;
      std::vector<Index> open = {first};
      is_seen[first] = true;
      while (!open.empty()) {
        const Index piece = open.back();
        open.pop_back();
        limb.vertices += sizes_[piece];
        for (const auto& [next, way] : neighbours_[piece]) {
          if (next == cut) limb.way -= way;
          if (is_seen[next]) continue;
          is_seen[next] = true;
          open.push_back(next);
        }
      }
      limbs.push_back(limb);
    }
    return limbs;
  }

  std::vector<Index> pieces_;  ///< of each vertex
  std::vector<std::int64_t> sizes_;
  std::map<Index, Index> region_pieces_;
  /// Each neighbour with the area vector, up to a factor, of the border, towards the piece. Let one vertex be 1 and all
  /// others 0: the gradient in an element is along the normal of the opposite face. The sum over a border depends on
  /// its area alone, however edges run.
  std::vector<std::map<Index, Vec3>> neighbours_;
};

}  // namespace

std::map<Index, LimbEnd> find_limb_ends(const TetMesh& mesh, std::span<const Vec3> positions,
                                        std::span<const Index> regions) {
  return PieceGraph(mesh, positions, regions).find_ends();
}

}  // namespace selvage
