#pragma once

#include "peer/paths/float3.h"
#include "selvage/core/types.h"

#include <algorithm>
#include <unordered_set>

namespace selvage::bench {

/// One tetrahedron in 32 bytes: its vertices, and what lies across the face opposite to each of them
/// (4 * tet + face, or negative at the boundary).
struct PeerTet {
  std::array<Index, 4> vertices;
  std::array<Index, 4> across;
};

struct WalkMesh {
  const Float3* positions;
  const PeerTet* tets;
  bool has_inverted;     ///< then the ray may run backwards, and stops at twice the distance only
  float face_tolerance;  ///< epsilon_i of the paper, a double area [m^2]
  float rounding;        ///< of the ends of the ray [m]
};

/// A vertex in the frame of the ray: x and y across it, z along it.
struct Corner {
  Index vertex;
  float x, y, z;
};

/// A face through which the ray enters the element `code >> 2`; its number there is `code & 3`.
struct Entry {
  Index code;
  std::array<Corner, 3> corners;
};

/// The stacks of the paper's static version: fixed arrays, the newest 16 elements for the detection of loops.
class FixedStorage {
 public:
  bool has_visited(Index tet) const {
    bool found = false;
    for (Index visited : visited_) found |= visited == tet;
    return found;
  }
  bool add(Index tet) {
    visited_[count_++ % kVisited] = tet;
    return count_ <= kMaxSteps;
  }
  bool push(const Entry& entry) {
    if (depth_ == kDepth) return false;
    stack_[depth_++] = entry;
    return true;
  }
  bool pop(Entry& entry) {
    if (depth_ == 0) return false;
    entry = stack_[--depth_];
    return true;
  }
  int steps() const { return count_; }

 private:
  static constexpr int kVisited = 16, kDepth = 16, kMaxSteps = 8192;
  alignas(64) std::array<Index, kVisited> visited_{-1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1};
  int count_ = 0, depth_ = 0;
  std::array<Entry, kDepth> stack_;
};

/// The fail-safe: everything grows, every element is remembered, so that the walk must end.
class GrowingStorage {
 public:
  bool has_visited(Index tet) const { return visited_.contains(tet); }
  bool add(Index tet) {
    ++count_;
    visited_.insert(tet);
    return true;
  }
  bool push(const Entry& entry) {
    stack_.push_back(entry);
    return true;
  }
  bool pop(Entry& entry) {
    if (stack_.empty()) return false;
    entry = stack_.back();
    stack_.pop_back();
    return true;
  }
  int steps() const { return count_; }

 private:
  std::unordered_set<Index> visited_;
  std::vector<Entry> stack_;
  int count_ = 0;
};

enum class WalkEnd { kOnItsWay, kReached, kLeftMesh, kBlocked, kOutOfStorage };

/// The ray from the boundary point s to the point p (SPB supplement, algorithm 1).
class TetTraversal {
 public:
  TetTraversal(const WalkMesh& mesh, const Float3& s, const Float3& p) : mesh_(mesh), origin_(s) {
    const Float3 r = p - s;
    const float length = std::sqrt(dot(r, r));
    along_ = (1 / length) * r;
    set_basis();
    const float slack = kSlack * length + mesh.rounding;
    farthest_ = mesh.has_inverted ? 2 * length : length + slack;
    nearest_ = mesh.has_inverted ? -HUGE_VALF : -slack;
  }

  Corner project(Index vertex) const {
    const Float3 v = mesh_.positions[vertex] - origin_;
    return {vertex, dot(v, u_), dot(v, v_), dot(v, along_)};
  }

  /// Follows the ray from element to element until it enters the target.
  template <typename Storage>
  WalkEnd follow(Entry entry, Index target, Storage& storage) const {
    do {
      for (;;) {
        const Index t = entry.code >> 2;
        if (storage.has_visited(t)) break;
        if (!storage.add(t)) return WalkEnd::kOutOfStorage;
        const WalkEnd end = step(t, entry, target, storage);
        if (end == WalkEnd::kBlocked) break;
        if (end != WalkEnd::kOnItsWay) return end;
      }
    } while (storage.pop(entry));
    return WalkEnd::kBlocked;
  }

 private:
  static constexpr float kSlack = 1e-5f;

  /// Duff et al. 2017: an orthonormal basis without a branch.
  void set_basis() {
    const Float3& n = along_;
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1 / (sign + n.z), b = n.x * n.y * a;
    u_ = {1 + sign * n.x * n.x * a, sign * b, -sign * n.x};
    v_ = {b, sign + n.y * n.y * a, -n.y};
  }

  static float det(const Corner& a, const Corner& b) { return a.x * b.y - a.y * b.x; }

  /// Goes on through the last face by which the ray may leave; the others, if any, wait on the stack (algorithm 2).
  template <typename Storage>
  WalkEnd step(Index t, Entry& entry, Index target, Storage& storage) const {
    const PeerTet& tet = mesh_.tets[t];
    const Corner d = project(tet.vertices[entry.code & 3]);
    const auto& [a, b, c] = entry.corners;
    const float area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    const float sign = area < 0 ? -1.0f : 1.0f, e = mesh_.face_tolerance;
    const float to_a = sign * det(d, a), to_b = sign * det(d, b), to_c = sign * det(d, c);
    const bool exits[3] = {to_b >= -e && to_c <= e, to_c >= -e && to_a <= e, to_a >= -e && to_b <= e};
    int through = -1;
    Index code = 0;
    for (int i = 0; i < 3; ++i) {
      if (!exits[i]) continue;
      const Index gone = entry.corners[i].vertex;
      const int opposite = (tet.vertices[1] == gone) + 2 * (tet.vertices[2] == gone) + 3 * (tet.vertices[3] == gone);
      const Index across = tet.across[opposite];
      if (across < 0) return WalkEnd::kLeftMesh;
      if (!is_in_reach(entry.corners[(i + 1) % 3], entry.corners[(i + 2) % 3], d)) continue;
      if (across >> 2 == target) return WalkEnd::kReached;
      if (through >= 0 && !storage.push(passed_on(entry, through, d, code))) return WalkEnd::kOutOfStorage;
      through = i;
      code = across;
    }
    if (through < 0) return WalkEnd::kBlocked;
    entry.code = code;
    entry.corners[through] = d;
    return WalkEnd::kOnItsWay;
  }

  static Entry passed_on(const Entry& entry, int through, const Corner& d, Index code) {
    Entry next = entry;
    next.code = code;
    next.corners[through] = d;
    return next;
  }

  /// Whether the ray meets the face between its ends; the place is computed only where the corners do not tell.
  bool is_in_reach(const Corner& a, const Corner& b, const Corner& c) const {
    const float least = std::min({a.z, b.z, c.z}), most = std::max({a.z, b.z, c.z});
    if (least >= nearest_ && most <= farthest_) return true;
    if (most < nearest_ || least > farthest_) return false;
    const float wa = det(b, c), wb = det(c, a), wc = det(a, b), sum = wa + wb + wc;
    if (sum == 0) return true;
    const float z = (wa * a.z + wb * b.z + wc * c.z) / sum;
    return z >= nearest_ && z <= farthest_;
  }

  const WalkMesh& mesh_;
  Float3 origin_, along_, u_, v_;
  float farthest_, nearest_;
};

}  // namespace selvage::bench
