#include "shapes/stuffing/isosurface_stuffing.h"

#include <algorithm>
#include <numeric>

#include "core/parallel.h"
#include "shapes/shape_arguments.h"
#include "shapes/stuffing/bcc_lattice.h"
#include "shapes/stuffing/stuffing_stencils.h"
#include "shapes/stuffing/surface_smoothing.h"

namespace selvage {

namespace {

constexpr Index kBlockVertices = BccLattice::kBlockVertices;

/// A vertex moves to a cut that is nearer than this fraction of a long or a short edge (the paper's optimum for
/// surfaces that are cut exactly).
constexpr double kLongWarp = 0.24999, kShortWarp = 0.41189;

/// Where the surface crosses a lattice edge. The edge runs from `owner` in `direction`: 0 to 2 to the next vertex of
/// its kind along an axis; 3 to 10 from a corner to one of the eight centres around it.
struct Cut {
  Index owner;
  std::int8_t direction;
  Index output = kNone;
  double fraction;  ///< of the edge, from the owner
};

/// A lattice vertex that moved onto the surface.
struct Warped {
  Index vertex;
  Vec3 position;
};

/// A lattice edge that leaves a vertex, seen from its owner.
struct LatticeEdge {
  Index owner;
  int direction;
  bool from_owner;
};

class Stuffing {
 public:
  Stuffing(const ImplicitSolid& solid, double cell) : solid_(solid), lattice_(solid, cell) {}

  IndexedMesh run() {
    evaluate_depths();
    find_cuts();
    warp_vertices();
    IndexedMesh mesh;
    place_vertices(mesh);
    fill_tetrahedra(mesh);
    if (!mesh.tetrahedra.empty()) smooth_surface(solid_, lattice_, first_vertices_, mesh);
    return mesh;
  }

 private:
  template <typename Body>
  void for_each_block(Body&& body) const {
    parallel_for(lattice_.block_count(), 1, [&](std::int64_t block) { body(static_cast<Index>(block)); });
  }
  int sign(Index v) const { return v == kNone || depths_[v] < 0 ? -1 : depths_[v] > 0 ? 1 : 0; }

  /// Edge to the neighbour at `step`: 0 to 5 along the axes, up and down; 6 to 13 to the other kind.
  LatticeVertex neighbour(const LatticeVertex& v, int step) const {
    return step < 6 ? v.moved(step / 2, step % 2 == 0 ? 1 : -1) : v.crossed(step - 6);
  }
  LatticeEdge edge(Index v, Index w, const LatticeVertex& at, int step) const {
    if (step < 6) return step % 2 == 0 ? LatticeEdge{v, step / 2, true} : LatticeEdge{w, step / 2, false};
    return at.centre == 0 ? LatticeEdge{v, step - 3, true} : LatticeEdge{w, step - 3, false};
  }

  void evaluate_depths();
  double crossing(std::span<const Index> parts, const Vec3& from, const Vec3& to, double depth_from,
                  double depth_to) const;
  void find_cuts();
  Cut& cut_on(const LatticeEdge& edge);
  Cut& cut_between(Index v, Index w);
  std::vector<Index> vertices_near_cuts() const;
  void warp_vertices();
  bool touches_inside(Index v) const;
  void place_vertices(IndexedMesh& mesh);
  template <typename Emit>
  void fill_block(Index block, Emit&& emit);
  void fill_tetrahedra(IndexedMesh& mesh);

  const ImplicitSolid& solid_;
  BccLattice lattice_;
  std::vector<double> depths_;                ///< of each lattice vertex; 0 once it is on the surface
  std::vector<std::vector<Cut>> cuts_;        ///< of each block, by owner and direction
  std::vector<Warped> warped_;                ///< vertices that moved, ascending
  std::vector<Index> outputs_;                ///< output number of each lattice vertex that the mesh uses
  std::vector<std::int64_t> first_vertices_;  ///< output numbers of the blocks, and of the end
};

void Stuffing::evaluate_depths() {
  depths_.resize(static_cast<std::size_t>(lattice_.block_count()) * kBlockVertices);
  const double half_block = lattice_.cell() * BccLattice::kSide / 2;
  for_each_block([&](Index block) {
    const std::span<const Index> parts = lattice_.block_parts(block);
    const Index first = block * kBlockVertices;
    const Vec3 middle = lattice_.position(lattice_.vertex(first)) + Vec3::Constant(half_block);
    const double at_middle = solid_.depth(middle, parts), reach = 1.74 * half_block + 1.001 * lattice_.cell();
    const bool uniform = std::abs(at_middle) > reach;
    for (Index v = first; v < first + kBlockVertices; ++v) {
      depths_[v] = uniform ? at_middle : solid_.depth(lattice_.position(lattice_.vertex(v)), parts);
    }
  });
}

/// Fraction of the edge where the depth is zero, by the Illinois rule: a few steps, as depths are nearly linear.
double Stuffing::crossing(std::span<const Index> parts, const Vec3& from, const Vec3& to, double depth_from,
                          double depth_to) const {
  double low = 0, high = 1, middle = 0.5;
  int last_side = 0;
  for (int step = 0; step < 16; ++step) {
    middle = low + (high - low) * depth_from / (depth_from - depth_to);
    const double depth = solid_.depth(from + middle * (to - from), parts);
    if (std::abs(depth) < 1e-10 * lattice_.cell()) break;
    const int side = (depth > 0) == (depth_from > 0) ? 1 : -1;
    if (side > 0) {
      low = middle;
      depth_from = depth;
      if (last_side == side) depth_to /= 2;
    } else {
      high = middle;
      depth_to = depth;
      if (last_side == side) depth_from /= 2;
    }
    last_side = side;
  }
  return middle;
}

void Stuffing::find_cuts() {
  cuts_.resize(lattice_.block_count());
  for_each_block([&](Index block) {
    const std::span<const Index> parts = lattice_.block_parts(block);
    for (Index v = block * kBlockVertices; v < (block + 1) * kBlockVertices; ++v) {
      const LatticeVertex at = lattice_.vertex(v);
      for (int direction = 0; direction < (at.centre ? 3 : 11); ++direction) {
        const LatticeVertex to = direction < 3 ? at.moved(direction, 1) : at.crossed(direction - 3);
        const Index w = lattice_.number(to);
        if (w == kNone || sign(v) * sign(w) >= 0) continue;
        const double fraction = crossing(parts, lattice_.position(at), lattice_.position(to), depths_[v], depths_[w]);
        cuts_[block].push_back({v, static_cast<std::int8_t>(direction), kNone, fraction});
      }
    }
  });
}

Cut& Stuffing::cut_on(const LatticeEdge& edge) {
  std::vector<Cut>& cuts = cuts_[edge.owner / kBlockVertices];
  return *std::lower_bound(cuts.begin(), cuts.end(), edge, [](const Cut& cut, const LatticeEdge& key) {
    return cut.owner != key.owner ? cut.owner < key.owner : cut.direction < key.direction;
  });
}

Cut& Stuffing::cut_between(Index v, Index w) {
  const LatticeVertex a = lattice_.vertex(v), b = lattice_.vertex(w);
  if (a.centre != b.centre) {
    const LatticeVertex &corner = a.centre ? b : a, &centre = a.centre ? a : b;
    int bits = 0;
    for (int axis = 0; axis < 3; ++axis) bits |= (corner.cube[axis] - centre.cube[axis]) << axis;
    return cut_on({a.centre ? w : v, 3 + bits, true});
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (a.cube[axis] < b.cube[axis]) return cut_on({v, axis, true});
    if (b.cube[axis] < a.cube[axis]) return cut_on({w, axis, true});
  }
  return cuts_.front().front();  // Not reached: v and w are neighbours.
}

std::vector<Index> Stuffing::vertices_near_cuts() const {
  std::vector<Index> near;
  for (const std::vector<Cut>& cuts : cuts_) {
    for (const Cut& cut : cuts) {
      const double warp = cut.direction < 3 ? kLongWarp : kShortWarp;
      const LatticeVertex owner = lattice_.vertex(cut.owner);
      if (cut.fraction < warp) near.push_back(cut.owner);
      if (cut.fraction > 1 - warp) {
        near.push_back(
            lattice_.number(cut.direction < 3 ? owner.moved(cut.direction, 1) : owner.crossed(cut.direction - 3)));
      }
    }
  }
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  return near;
}

/// One vertex after the other, as each that moves takes the cuts of its edges away from its neighbours. Those inside
/// go first: in the order of their numbers some of a thousand coarse solids had an angle below the bound, with those
/// outside first more, and so none of 40,000.
void Stuffing::warp_vertices() {
  std::vector<Index> near = vertices_near_cuts();
  std::stable_partition(near.begin(), near.end(), [&](Index v) { return sign(v) > 0; });
  for (Index v : near) {
    const LatticeVertex at = lattice_.vertex(v);
    double nearest = 1e300;
    Vec3 target = Vec3::Zero();
    for (int step = 0; step < 14; ++step) {
      const LatticeVertex to = neighbour(at, step);
      const Index w = lattice_.number(to);
      if (w == kNone || sign(v) * sign(w) >= 0) continue;
      const LatticeEdge to_neighbour = edge(v, w, at, step);
      const double owner_fraction = cut_on(to_neighbour).fraction;
      const double fraction = to_neighbour.from_owner ? owner_fraction : 1 - owner_fraction;
      if (!(fraction < (step < 6 ? kLongWarp : kShortWarp))) continue;
      const Vec3 point = lattice_.position(at) + fraction * (lattice_.position(to) - lattice_.position(at));
      const double distance = (point - lattice_.position(at)).norm();
      if (distance < nearest) {
        nearest = distance;
        target = point;
      }
    }
    if (nearest == 1e300) continue;
    depths_[v] = 0;
    warped_.push_back({v, target});
  }
  std::sort(warped_.begin(), warped_.end(), [](const Warped& a, const Warped& b) { return a.vertex < b.vertex; });
}

bool Stuffing::touches_inside(Index v) const {
  const LatticeVertex at = lattice_.vertex(v);
  for (int step = 0; step < 14; ++step) {
    if (sign(lattice_.number(neighbour(at, step))) > 0) return true;
  }
  return false;
}

void Stuffing::place_vertices(IndexedMesh& mesh) {
  outputs_.assign(depths_.size(), kNone);
  std::vector<std::int64_t>& first = first_vertices_;
  first.assign(lattice_.block_count() + 1, 0);
  const auto end_of = [&](const Cut& cut) {
    const LatticeVertex owner = lattice_.vertex(cut.owner);
    return lattice_.number(cut.direction < 3 ? owner.moved(cut.direction, 1) : owner.crossed(cut.direction - 3));
  };
  for_each_block([&](Index block) {
    Index used = 0;
    for (Index v = block * kBlockVertices; v < (block + 1) * kBlockVertices; ++v) {
      if (sign(v) > 0 || (sign(v) == 0 && touches_inside(v))) outputs_[v] = used++;
    }
    std::erase_if(cuts_[block], [&](const Cut& cut) { return sign(cut.owner) == 0 || sign(end_of(cut)) == 0; });
    for (Cut& cut : cuts_[block]) cut.output = used++;
    first[block + 1] = used;
  });
  std::partial_sum(first.begin(), first.end(), first.begin());
  check_element_count(static_cast<double>(first.back()));
  mesh.positions.resize(first.back());
  for_each_block([&](Index block) {
    const Index shift = static_cast<Index>(first[block]);
    for (Index v = block * kBlockVertices; v < (block + 1) * kBlockVertices; ++v) {
      if (outputs_[v] == kNone) continue;
      outputs_[v] += shift;
      const auto moved = std::lower_bound(warped_.begin(), warped_.end(), v,
                                          [](const Warped& warped, Index key) { return warped.vertex < key; });
      const bool has_moved = sign(v) == 0 && moved != warped_.end() && moved->vertex == v;
      mesh.positions[outputs_[v]] = has_moved ? moved->position : lattice_.position(lattice_.vertex(v));
    }
    for (Cut& cut : cuts_[block]) {
      cut.output += shift;
      const Vec3 from = lattice_.position(lattice_.vertex(cut.owner));
      const Vec3 to = lattice_.position(lattice_.vertex(end_of(cut)));
      mesh.positions[cut.output] = from + cut.fraction * (to - from);
    }
  });
}

/// The twelve tetrahedra of each cube of a block: around the edge from its centre to the next in each direction.
template <typename Emit>
void Stuffing::fill_block(Index block, Emit&& emit) {
  const std::array<Index, 3> origin = lattice_.block_origin(block);
  for (Index place = 0; place < kBlockVertices / 2; ++place) {
    const LatticeVertex centre{{origin[0] + (place >> 6), origin[1] + (place >> 3 & 7), origin[2] + (place & 7)}, 1};
    const Index low = lattice_.number(centre);
    for (int axis = 0; axis < 3; ++axis) {
      const LatticeVertex next = centre.moved(axis, 1);
      const LatticeVertex corner{next.cube, 0};
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      const std::array<LatticeVertex, 4> ring = {corner, corner.moved(u, 1), corner.moved(u, 1).moved(v, 1),
                                                 corner.moved(v, 1)};
      const Index high = lattice_.number(next);
      std::array<Index, 4> around;
      for (int i = 0; i < 4; ++i) around[i] = lattice_.number(ring[i]);
      for (int i = 0; i < 4; ++i) {
        const int j = (i + 1) % 4;
        const std::array<Index, 4> vertex = {low, around[i], around[j], high};
        LatticeTet tet{{sign(low), sign(around[i]), sign(around[j]), sign(high)}, {}};
        if (std::find(tet.sign.begin(), tet.sign.end(), 1) == tet.sign.end()) continue;
        tet.half_cells = {centre.half_cells(), ring[i].half_cells(), ring[j].half_cells(), next.half_cells()};
        trim_tetrahedron(
            tet, [&](int k) { return outputs_[vertex[k]]; },
            [&](int in, int out) { return cut_between(vertex[in], vertex[out]).output; }, emit);
      }
    }
  }
}

void Stuffing::fill_tetrahedra(IndexedMesh& mesh) {
  std::vector<std::int64_t> first(lattice_.block_count() + 1, 0);
  for_each_block([&](Index block) {
    std::int64_t count = 0;
    fill_block(block, [&](const VertexTuple<4>&) { ++count; });
    first[block + 1] = count;
  });
  std::partial_sum(first.begin(), first.end(), first.begin());
  check_element_count(static_cast<double>(first.back()));
  mesh.tetrahedra.resize(first.back());
  for_each_block([&](Index block) {
    auto next = mesh.tetrahedra.begin() + first[block];
    fill_block(block, [&](const VertexTuple<4>& tet) { *next++ = tet; });
  });
}

}  // namespace

IndexedMesh stuff_isosurface(const ImplicitSolid& solid, double cell) {
  // A cube of the lattice holds twelve tetrahedra.
  check_element_count(12 * solid.volume() / (cell * cell * cell));
  IndexedMesh mesh = Stuffing(solid, cell).run();
  if (mesh.tetrahedra.empty())
    throw Error("cell", fmt::format("no cell of {} fits inside", cell), "use a smaller cell");
  return mesh;
}

}  // namespace selvage
