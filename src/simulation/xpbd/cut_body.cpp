#include "core/parallel.h"
#include "simulation/xpbd/material_blocks.h"

#include <array>
#include <utility>

namespace selvage {

namespace {

/// The 21 lowest bits of x, each three places from the next.
std::uint64_t spread_bits(std::uint64_t x) {
  x = (x | x << 32) & 0x001f00000000ffff;
  x = (x | x << 16) & 0x001f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  x = (x | x << 2) & 0x1249249249249249;
  return x;
}

/// Largest number of slabs of a body; number from which on slabs are not cut into columns.
constexpr Index kMaxSlabs = 64, kMinUncutSlabs = 32;

/// Orders the elements of one body.
class BodyCutter {
 public:
  BodyCutter(const Model& model, const Body& body)
      : model_(model), body_(body), places_(body.element_count), extents_(body.vertex_count) {
    Vec3 lower = model.rest_positions[body.first_vertex], upper = lower;
    for (Index v = body.first_vertex; v < body.first_vertex + body.vertex_count; ++v) {
      lower = lower.cwiseMin(model.rest_positions[v]);
      upper = upper.cwiseMax(model.rest_positions[v]);
    }
    const Vec3 size = upper - lower;
    std::stable_sort(axes_.begin(), axes_.end(), [&](int a, int b) { return size[a] > size[b]; });
    const double scale = 0x1fffff / size.maxCoeff();
    parallel_for(body.element_count, kGrain, [&](std::int64_t i) {
      const Index element = body.first_element + static_cast<Index>(i);
      Vec3 centre = Vec3::Zero();
      for (const Index v : model.mesh.elements()[element]) centre += 0.25 * (model.rest_positions[v] - lower);
      std::uint64_t key = 0;
      for (int axis = 0; axis < 3; ++axis)
        key |= spread_bits(static_cast<std::uint64_t>(std::max(0.0, scale * centre[axis]))) << axis;
      places_[i] = {centre, key, element};
    });
  }

  std::vector<Subdomain> cut(std::vector<Index>& ordered) {
    const ElementRange all = {0, body_.element_count};
    sort(all, axes_[0]);
    const Index slabs = count_slices(all, kMaxSlabs), columns = slabs < kMinUncutSlabs ? cut_columns(all, slabs) : 1;
    std::vector<Subdomain> subdomains;
    for (Index slab = 0; slab < slabs; ++slab)
      for (Index column = 0; column < columns; ++column) {
        const ElementRange run = all.slice(slab, slabs).slice(column, columns);
        subdomains.push_back({body_.first_element + run.first, body_.first_element + run.last,
                              columns == 1 ? slab % 2 : 2 * (slab % 2) + column % 2});
      }
    parallel_for(std::ssize(subdomains), 1, [&](std::int64_t i) {
      std::sort(places_.begin() + subdomains[i].first - body_.first_element,
                places_.begin() + subdomains[i].last - body_.first_element,
                [](const Place& a, const Place& b) { return a.key != b.key ? a.key < b.key : a.element < b.element; });
    });
    for (Index i = 0; i < body_.element_count; ++i) ordered[body_.first_element + i] = places_[i].element;
    return subdomains;
  }

 private:
  struct Place {
    Vec3 centre;
    std::uint64_t key;  ///< on a Morton curve
    Index element;
  };

  /// First and last element at a vertex, by their places in a run.
  struct Extent {
    Index first = kNone, last = kNone;
  };

  void sort(const ElementRange& run, int axis) {
    parallel_sort(places_.begin() + run.first, places_.begin() + run.last, [axis](const Place& a, const Place& b) {
      return a.centre[axis] != b.centre[axis] ? a.centre[axis] < b.centre[axis] : a.element < b.element;
    });
  }

  /// Sorts each slab across the second side.
  /// @return number of columns into which all of them can be cut
  Index cut_columns(const ElementRange& all, Index slabs) {
    Index columns = kMaxSlabs;
    for (Index slab = 0; slab < slabs; ++slab) {
      sort(all.slice(slab, slabs), axes_[1]);
      columns = std::min(columns, count_slices(all.slice(slab, slabs), columns));
    }
    return columns;
  }

  /// Largest number of slices of a run that each hold a block and touch their neighbours alone: two or a multiple of
  /// four, so that threads share the subdomains of each colour evenly.
  Index count_slices(const ElementRange& run, Index max_count) {
    visit_extents(run, [](Extent& extent, Index place) {
      if (extent.first == kNone) extent.first = place;
      extent.last = place;
    });
    std::vector<Extent> extents;
    visit_extents(run, [&](Extent& extent, Index) {
      if (extent.first != kNone) extents.push_back(std::exchange(extent, {}));
    });
    for (Index count = std::min(run.size() / kBlockElements, max_count); count > 1; --count)
      if ((count == 2 || count % 4 == 0) && std::all_of(extents.begin(), extents.end(), [&](const Extent& extent) {
            return run.slice_of(extent.last, count) - run.slice_of(extent.first, count) <= 1;
          }))
        return count;
    return 1;
  }

  template <typename Visit>
  void visit_extents(const ElementRange& run, Visit&& visit) {
    for (Index i = run.first; i < run.last; ++i)
      for (const Index v : model_.mesh.elements()[places_[i].element])
        visit(extents_[v - body_.first_vertex], i - run.first);
  }

  const Model& model_;
  const Body& body_;
  std::array<int, 3> axes_ = {0, 1, 2};  ///< longest first
  std::vector<Place> places_;
  std::vector<Extent> extents_;  ///< (n_vertices)
};

}  // namespace

std::vector<Subdomain> cut_body(const Model& model, const Body& body, std::vector<Index>& ordered) {
  if (body.element_count == 0) return {};
  return BodyCutter(model, body).cut(ordered);
}

}  // namespace selvage
