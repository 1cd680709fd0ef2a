#pragma once

#include "selvage/io/mesh_file.h"
#include "selvage/mesh/triangle_mesh.h"

#include <filesystem>
#include <string>
#include <string_view>

namespace selvage::bench {

/// A surface in the poses of consecutive frames.
class CollisionSubject {
 public:
  /// Frames from near the end of a sequence of the library, where it is most entangled; or all.
  /// @param triangles  about how many; 0: the sequence's own number
  /// @param frames     at least 2
  CollisionSubject(std::string_view sequence, std::int64_t triangles, int frames);

  /// The last frames of a simulated run, with all of its surface.
  /// @throws Error  when the folder holds no run of at least two frames with a surface
  CollisionSubject(const std::filesystem::path& run, int frames);

  /// One pose over and over.
  CollisionSubject(std::string name, const IndexedMesh& file, int frames);

  const std::string& name() const { return name_; }
  const TriangleMesh& mesh() const { return mesh_; }
  int frame_count() const { return static_cast<int>(frames_.size()); }
  std::span<const Vec3> frame(int i) const { return frames_[i]; }

 private:
  std::string name_;
  TriangleMesh mesh_;
  std::vector<std::vector<Vec3>> frames_;
};

}  // namespace selvage::bench
