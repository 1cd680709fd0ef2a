#include "peer/paths/embree_scene.h"

#include "selvage/core/error.h"

#include <algorithm>

namespace selvage::bench {

EmbreeDevice::EmbreeDevice() : device_(rtcNewDevice(nullptr)) {
  if (!device_) throw Error("Embree", "no device");
}

void EmbreeScene::set_simplices(const Float3* positions, Index vertex_count, const Index* vertices, std::size_t stride,
                                int corners, std::size_t count) {
  positions_ = positions;
  vertex_count_ = vertex_count;
  vertices_ = vertices;
  stride_ = stride;
  corners_ = corners;
  count_ = count;
  open();
}

void EmbreeScene::set_bounds(const RTCBoundsFunctionArguments* arguments) {
  const auto& scene = *static_cast<const EmbreeScene*>(arguments->geometryUserPtr);
  const auto* first = reinterpret_cast<const char*>(scene.vertices_) + arguments->primID * scene.stride_;
  const auto* ids = reinterpret_cast<const Index*>(first);
  Float3 lower = scene.positions_[ids[0]], upper = lower;
  for (int i = 1; i < scene.corners_; ++i) {
    const Float3& x = scene.positions_[ids[i]];
    lower = {std::min(lower.x, x.x), std::min(lower.y, x.y), std::min(lower.z, x.z)};
    upper = {std::max(upper.x, x.x), std::max(upper.y, x.y), std::max(upper.z, x.z)};
  }
  RTCBounds& bounds = *arguments->bounds_o;
  bounds = {lower.x, lower.y, lower.z, 0, upper.x, upper.y, upper.z, 0};
}

void EmbreeScene::open() {
  scene_ = rtcNewScene(device_);
  const bool dynamic = tree_ == PeerTree::kRefit;
  if (dynamic) rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_DYNAMIC);
  rtcSetSceneBuildQuality(scene_, dynamic                    ? RTC_BUILD_QUALITY_LOW
                                  : tree_ == PeerTree::kHigh ? RTC_BUILD_QUALITY_HIGH
                                                             : RTC_BUILD_QUALITY_MEDIUM);
  geometry_ = rtcNewGeometry(device_, kind_ == Kind::kTriangles ? RTC_GEOMETRY_TYPE_TRIANGLE : RTC_GEOMETRY_TYPE_USER);
  if (dynamic) rtcSetGeometryBuildQuality(geometry_, RTC_BUILD_QUALITY_REFIT);
  if (kind_ == Kind::kTriangles) {
    rtcSetSharedGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, positions_, 0, sizeof(Float3),
                               vertex_count_);
    rtcSetSharedGeometryBuffer(geometry_, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, vertices_, 0, stride_, count_);
  } else {
    rtcSetGeometryUserPrimitiveCount(geometry_, static_cast<unsigned>(count_));
    rtcSetGeometryUserData(geometry_, this);
    rtcSetGeometryBoundsFunction(geometry_, &EmbreeScene::set_bounds, nullptr);
  }
  rtcAttachGeometry(scene_, geometry_);
}

void EmbreeScene::release() {
  if (geometry_) rtcReleaseGeometry(geometry_);
  if (scene_) rtcReleaseScene(scene_);
  geometry_ = nullptr;
  scene_ = nullptr;
}

void EmbreeScene::build() {
  // A dynamic scene that is built already would be refitted.
  if (tree_ == PeerTree::kRefit) {
    release();
    open();
  }
  refit();
}

void EmbreeScene::refit() {
  if (kind_ == Kind::kTriangles) rtcUpdateGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0);
  rtcCommitGeometry(geometry_);
  rtcCommitScene(scene_);
}

}  // namespace selvage::bench
