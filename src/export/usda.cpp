// USD as text: a mesh whose points have a sample for each frame.
#include "export/poses.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace selvage {

namespace {

using Buffer = fmt::memory_buffer;

void put_points(Buffer& out, const std::vector<Float3>& points) {
  for (std::size_t i = 0; i < points.size(); ++i)
    fmt::format_to(std::back_inserter(out), "{}({}, {}, {})", i ? ", " : "", points[i][0], points[i][1], points[i][2]);
}

/// Smallest and largest coordinates of a pose, as USD wants them for an extent.
void put_extent(Buffer& out, const std::vector<Float3>& points) {
  Float3 lower = points.front(), upper = points.front();
  for (const Float3& p : points)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lower[axis] = std::min(lower[axis], p[axis]);
      upper[axis] = std::max(upper[axis], p[axis]);
    }
  put_points(out, {lower, upper});
}

}  // namespace

std::string print_usda(const ExportedPoses& poses) {
  Buffer out;
  const auto to = std::back_inserter(out);
  fmt::format_to(to,
                 "#usda 1.0\n(\n    defaultPrim = \"run\"\n    startTimeCode = {}\n    endTimeCode = {}\n"
                 "    timeCodesPerSecond = {}\n    metersPerUnit = 1\n    upAxis = \"Z\"\n)\n\n"
                 "def Xform \"run\"\n{{\n    def Mesh \"bodies\"\n    {{\n"
                 "        uniform token subdivisionScheme = \"none\"\n",
                 poses.frames.front(), poses.frames.back(), poses.frames_per_second);
  fmt::format_to(to, "        int[] faceVertexCounts = [");
  for (std::size_t i = 0; i < poses.surface.triangles.size(); ++i) fmt::format_to(to, "{}3", i ? ", " : "");
  fmt::format_to(to, "]\n        int[] faceVertexIndices = [");
  for (std::size_t i = 0; i < poses.surface.triangles.size(); ++i) {
    const auto& t = poses.surface.triangles[i];
    fmt::format_to(to, "{}{}, {}, {}", i ? ", " : "", t[0], t[1], t[2]);
  }
  Buffer extents;
  fmt::format_to(to, "]\n        point3f[] points.timeSamples = {{\n");
  for (std::size_t i = 0; i < poses.frames.size(); ++i) {
    const std::vector<Float3> pose = poses.pose(i);
    fmt::format_to(to, "            {}: [", poses.frames[i]);
    put_points(out, pose);
    fmt::format_to(to, "],\n");
    fmt::format_to(std::back_inserter(extents), "            {}: [", poses.frames[i]);
    put_extent(extents, pose);
    fmt::format_to(std::back_inserter(extents), "],\n");
  }
  fmt::format_to(to, "        }}\n        float3[] extent.timeSamples = {{\n{}        }}\n    }}\n}}\n",
                 fmt::to_string(extents));
  return fmt::to_string(out);
}

}  // namespace selvage
