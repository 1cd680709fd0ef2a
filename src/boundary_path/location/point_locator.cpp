#include "selvage/boundary_path/point_locator.h"

#include "boundary_path/location/locator_impl.h"
#include "selvage/core/error.h"

#include <fmt/format.h>

#include <algorithm>

namespace selvage {

namespace {

template <int D>
const SimplexMesh<D>& with_elements(const SimplexMesh<D>& mesh) {
  if (mesh.element_count() == 0 && mesh.vertex_count() == 0)
    throw Error("mesh", "there is no element", "give at least one");
  return mesh;
}

}  // namespace

template <int D>
LocatorImpl<D>::LocatorImpl(const SimplexMesh<D>& m, std::span<const Vec<D>> positions)
    : mesh(with_elements(m)), topology(m), pose(m, topology), containment(m, pose, pose.elements()) {
  rebuild(positions);
}

template <int D>
void LocatorImpl<D>::update(std::span<const Vec<D>> positions) {
  if (pose.update_elements(positions)) containment.rebuild();
  take_scale();
}

template <int D>
void LocatorImpl<D>::rebuild(std::span<const Vec<D>> positions) {
  pose.rebuild_elements(positions);
  containment.rebuild();
  take_scale();
}

template <int D>
void LocatorImpl<D>::take_scale() {
  to_internal = Scaling(-pose.exponent());
  from_internal = Scaling(pose.exponent());
}

template <int D>
bool LocatorImpl<D>::is_skipped(Index element) const {
  if (pose.defects().inverted_elements == 0) return false;
  const auto& across = mesh.neighbours()[element];
  return std::any_of(across.begin(), across.end(), [](HalfFace n) { return !n.exists(); }) &&
         pose.orientation_of(element) < 0;
}

template struct LocatorImpl<2>;
template struct LocatorImpl<3>;

template <int D>
PointLocator<D>::PointLocator(const SimplexMesh<D>& mesh, std::span<const Vec<D>> positions)
    : impl_(std::make_shared<LocatorImpl<D>>(mesh, positions)) {}

template <int D>
PointLocator<D>::PointLocator(std::shared_ptr<LocatorImpl<D>> impl) : impl_(std::move(impl)) {}

template <int D>
PointLocator<D>::~PointLocator() = default;
template <int D>
PointLocator<D>::PointLocator(PointLocator&&) noexcept = default;
template <int D>
PointLocator<D>& PointLocator<D>::operator=(PointLocator&&) noexcept = default;

template <int D>
void PointLocator<D>::update(std::span<const Vec<D>> positions) {
  impl_->update(positions);
}

template <int D>
void PointLocator<D>::rebuild(std::span<const Vec<D>> positions) {
  impl_->rebuild(positions);
}

template <int D>
LocatedPoints<D> PointLocator<D>::locate(std::span<const Vec<D>> points) const {
  std::vector<Vec<D>> scaled(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite())
      throw Error(fmt::format("point {}", i), "a coordinate is not finite", "remove NaN and infinity");
    scaled[i] = impl_->to_internal(points[i]);
  }
  LocatedPoints<D> located;
  located.first.assign(points.size() + 1, 0);
  for (const auto& [point, element] : impl_->containment.find_points(scaled)) {
    located.queries.push_back(PathQuery<D>::at(points[point], element));
    ++located.first[point + 1];
  }
  std::partial_sum(located.first.begin(), located.first.end(), located.first.begin());
  return located;
}

template <int D>
std::vector<PathQuery<D>> PointLocator<D>::locate_vertices(std::span<const Index> vertices) const {
  for (const Index v : vertices)
    if (v < 0 || v >= impl_->mesh.vertex_count())
      throw Error(fmt::format("vertex {}", v), "there is no such vertex",
                  fmt::format("vertices lie in [0, {})", impl_->mesh.vertex_count()));
  std::vector<PathQuery<D>> queries;
  for (const PointInElement pair : impl_->containment.find_vertices(vertices)) queries.push_back(impl_->query_of(pair));
  return queries;
}

template <int D>
std::vector<PathQuery<D>> PointLocator<D>::find_penetrating_vertices() const {
  std::vector<PathQuery<D>> queries;
  for (const PointInElement pair : impl_->containment.find_boundary_vertices())
    if (!impl_->is_skipped(pair.element)) queries.push_back(impl_->query_of(pair));
  return queries;
}

template <int D>
NearbyItems PointLocator<D>::find_elements_near(std::span<const std::array<Vec<D>, 2>> boxes) const {
  return find_near(impl_->pose.elements(), std::ssize(boxes),
                   [&](std::int64_t i) { return impl_->box_around(boxes[i]); });
}

template <int D>
const MeshDefects& PointLocator<D>::defects() const {
  return impl_->pose.defects();
}

template <int D>
std::span<const Index> PointLocator<D>::defective_elements() const {
  return impl_->pose.defective_elements();
}

template <int D>
std::span<const std::uint8_t> PointLocator<D>::locally_injective_vertices() const {
  return impl_->pose.locally_injective();
}

template class PointLocator<2>;
template class PointLocator<3>;

}  // namespace selvage
