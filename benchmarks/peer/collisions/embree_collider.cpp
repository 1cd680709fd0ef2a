#include "peer/collisions/embree_collider.h"

#include "bvh/box.h"
#include "core/parallel.h"
#include "selvage/core/error.h"
#include "selvage/geometry/triangle_triangle.h"

#include <embree3/rtcore.h>
#include <tbb/enumerable_thread_specific.h>

namespace selvage::bench {

struct EmbreeCollider::State {
  const TriangleMesh& mesh;
  ColliderTree tree;
  std::vector<Vec3> positions;
  RTCDevice device = rtcNewDevice(nullptr);
  RTCScene scene = nullptr;
  RTCGeometry geometry = nullptr;
  mutable tbb::enumerable_thread_specific<std::vector<IndexPair>> found;

  State(const TriangleMesh& m, ColliderTree t) : mesh(m), tree(t) {
    if (!device) throw Error("Embree", "no device");
    scene = rtcNewScene(device);
    geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    if (tree == ColliderTree::kRefitted) {
      rtcSetSceneFlags(scene, RTC_SCENE_FLAG_DYNAMIC);
      rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_LOW);
      rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_REFIT);
    }
    if (tree == ColliderTree::kMorton) rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_LOW);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(mesh.triangle_count()));
    rtcSetGeometryUserData(geometry, this);
    rtcSetGeometryBoundsFunction(geometry, &State::set_bounds, nullptr);
    rtcAttachGeometry(scene, geometry);
  }
  ~State() {
    rtcReleaseGeometry(geometry);
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  std::array<Vec3, 3> corners(const VertexTuple<3>& t) const {
    return {positions[t[0]], positions[t[1]], positions[t[2]]};
  }

  /// Rounded outward, so that no pair is lost in single precision.
  static void set_bounds(const RTCBoundsFunctionArguments* arguments) {
    const State& state = *static_cast<const State*>(arguments->geometryUserPtr);
    const std::array<Vec3, 3> corners = state.corners(state.mesh.triangles()[arguments->primID]);
    const Box box = bounding_box<3>(std::span<const Vec3>(corners));
    *arguments->bounds_o = {box.lower[0], box.lower[1], box.lower[2], 0, box.upper[0], box.upper[1], box.upper[2], 0};
  }

  static void test_pairs(void* user, RTCCollision* collisions, unsigned count) {
    const State& state = *static_cast<const State*>(user);
    std::vector<IndexPair>& pairs = state.found.local();
    for (unsigned i = 0; i < count; ++i) {
      const Index a = static_cast<Index>(collisions[i].primID0), b = static_cast<Index>(collisions[i].primID1);
      if (a < b) state.test_pair(a, b, pairs);
    }
  }

  void test_pair(Index a, Index b, std::vector<IndexPair>& pairs) const {
    const VertexTuple<3>&s = mesh.triangles()[a], &t = mesh.triangles()[b];
    for (const Index v : s)
      if (v == t[0] || v == t[1] || v == t[2]) return;
    if (triangles_meet(corners(s), corners(t))) pairs.emplace_back(a, b);
  }
};

EmbreeCollider::EmbreeCollider(const TriangleMesh& mesh, std::span<const Vec3> positions, ColliderTree tree)
    : state_(std::make_unique<State>(mesh, tree)) {
  update(positions);
}

EmbreeCollider::~EmbreeCollider() = default;

void EmbreeCollider::update(std::span<const Vec3> positions) {
  state_->positions.assign(positions.begin(), positions.end());
  rtcCommitGeometry(state_->geometry);
  rtcCommitScene(state_->scene);
}

std::vector<IndexPair> EmbreeCollider::find_pairs() const {
  rtcCollide(state_->scene, state_->scene, &State::test_pairs, state_.get());
  std::vector<IndexPair> pairs;
  for (auto& some : state_->found) {
    pairs.insert(pairs.end(), some.begin(), some.end());
    some.clear();
  }
  return pairs;
}

}  // namespace selvage::bench
