#pragma once

#include "peer/paths/embree_peer.h"
#include "peer/paths/float3.h"

#include <embree3/rtcore.h>

namespace selvage::bench {

/// An Embree device, released with its owner.
class EmbreeDevice {
 public:
  EmbreeDevice();
  ~EmbreeDevice() { rtcReleaseDevice(device_); }
  EmbreeDevice(const EmbreeDevice&) = delete;
  EmbreeDevice& operator=(const EmbreeDevice&) = delete;
  RTCDevice get() const { return device_; }

 private:
  RTCDevice device_;
};

/// One geometry in one scene, over arrays that belong to the caller and stay in place.
class EmbreeScene {
 public:
  enum class Kind { kTriangles, kBoxes };

  EmbreeScene(const EmbreeDevice& device, PeerTree tree, Kind kind) : device_(device.get()), tree_(tree), kind_(kind) {}
  ~EmbreeScene() { release(); }
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  /// @param vertices  of the first simplex; the next one's follow after `stride` bytes
  /// @param corners   vertices a simplex: 3 or 4; 3 for Kind::kTriangles
  void set_simplices(const Float3* positions, Index vertex_count, const Index* vertices, std::size_t stride,
                     int corners, std::size_t count);

  /// Builds the hierarchy anew from the positions as they are now.
  void build();

  /// Takes the positions as they are now; only with PeerTree::kRefit.
  void refit();

  /// Calls `visit` for every simplex whose leaf is within the radius, which it may shrink.
  void visit_near(const Float3& p, float radius, RTCPointQueryFunction visit, void* user) const {
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    RTCPointQuery query{p.x, p.y, p.z, 0, radius};
    rtcPointQuery(scene_, &query, &context, visit, user);
  }

 private:
  void open();
  void release();
  static void set_bounds(const RTCBoundsFunctionArguments* arguments);

  RTCDevice device_;
  PeerTree tree_;
  Kind kind_;
  const Float3* positions_ = nullptr;
  const Index* vertices_ = nullptr;
  Index vertex_count_ = 0;
  std::size_t stride_ = 0, count_ = 0;
  int corners_ = 0;
  RTCScene scene_ = nullptr;
  RTCGeometry geometry_ = nullptr;
};

}  // namespace selvage::bench
