// glTF 2.0, binary: a mesh with a morph target for each frame after the first. In frame i target i has weight 1 and all
// others 0; between two frames weights are linear, and so are positions.
#include "core/json.h"
#include "export/poses.h"

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

constexpr int kFloat = 5126, kUnsignedInt = 5125, kVertices = 34962, kTriangles = 34963;

/// The buffer of a file, and what lies in it.
struct Gltf {
  std::string buffer;
  Json views = Json::array(), accessors = Json::array();

  /// Appends numbers, and gives the number of their accessor.
  template <typename T>
  std::size_t add(const std::vector<T>& items, int component, const char* type, int target) {
    Json view{{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", items.size() * sizeof(T)}};
    if (target != 0) view["target"] = target;
    buffer.append(reinterpret_cast<const char*>(items.data()), items.size() * sizeof(T));
    accessors.push_back(
        {{"bufferView", views.size()}, {"componentType", component}, {"count", items.size()}, {"type", type}});
    views.push_back(std::move(view));
    return accessors.size() - 1;
  }

  std::size_t add_vectors(const std::vector<Float3>& vectors) {
    const std::size_t accessor = add(vectors, kFloat, "VEC3", kVertices);
    Float3 lower = vectors.front(), upper = vectors.front();
    for (const Float3& v : vectors)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        lower[axis] = std::min(lower[axis], v[axis]);
        upper[axis] = std::max(upper[axis], v[axis]);
      }
    accessors[accessor]["min"] = lower;
    accessors[accessor]["max"] = upper;
    return accessor;
  }
};

void append_word(std::string& bytes, std::size_t word) {
  const auto value = static_cast<std::uint32_t>(word);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void append_chunk(std::string& bytes, const char* kind, std::string chunk, char padding) {
  chunk.append((4 - chunk.size() % 4) % 4, padding);
  append_word(bytes, chunk.size());
  bytes.append(kind, 4);
  bytes += chunk;
}

/// Times of the frames, and in each frame the weights of all targets.
void add_animation(Gltf& gltf, Json& json, const ExportedPoses& poses) {
  const std::size_t targets = poses.frames.size() - 1;
  std::vector<float> times, weights(poses.frames.size() * targets, 0.f);
  for (std::size_t i = 0; i < poses.frames.size(); ++i) {
    times.push_back(static_cast<float>(static_cast<double>(poses.frames[i]) / poses.frames_per_second));
    if (i > 0) weights[i * targets + i - 1] = 1;
  }
  const std::size_t input = gltf.add(times, kFloat, "SCALAR", 0), output = gltf.add(weights, kFloat, "SCALAR", 0);
  gltf.accessors[input]["min"] = {times.front()};
  gltf.accessors[input]["max"] = {times.back()};
  json["animations"] = {{{"name", poses.name},
                         {"samplers", {{{"input", input}, {"output", output}, {"interpolation", "LINEAR"}}}},
                         {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}}};
}

}  // namespace

std::string print_glb(const ExportedPoses& poses) {
  Gltf gltf;
  const std::vector<Float3> first = poses.pose(0);
  std::vector<std::uint32_t> corners;
  for (const auto& t : poses.surface.triangles)
    for (const Index v : t) corners.push_back(static_cast<std::uint32_t>(v));
  const std::size_t positions = gltf.add_vectors(first),
                    indices = gltf.add(corners, kUnsignedInt, "SCALAR", kTriangles);
  Json primitive{{"attributes", {{"POSITION", positions}}}, {"indices", indices}};
  for (std::size_t i = 1; i < poses.frames.size(); ++i) {
    std::vector<Float3> moves = poses.pose(i);
    for (std::size_t v = 0; v < moves.size(); ++v)
      for (std::size_t axis = 0; axis < 3; ++axis) moves[v][axis] -= first[v][axis];
    primitive["targets"].push_back({{"POSITION", gltf.add_vectors(moves)}});
  }
  Json json{{"asset", {{"version", "2.0"}, {"generator", "selvage"}}}, {"scene", 0}, {"scenes", {{{"nodes", {0}}}}}};
  const double half = std::sqrt(0.5);
  json["nodes"] = {{{"name", poses.name}, {"mesh", 0}, {"rotation", {-half, 0, 0, half}}}};  // z upwards to y upwards
  json["meshes"] = {{{"name", poses.name}, {"primitives", Json::array({std::move(primitive)})}}};
  if (poses.frames.size() > 1) {
    json["meshes"][0]["weights"] = std::vector<int>(poses.frames.size() - 1, 0);
    add_animation(gltf, json, poses);
  }
  json["buffers"] = {{{"byteLength", gltf.buffer.size()}}};
  json["bufferViews"] = std::move(gltf.views);
  json["accessors"] = std::move(gltf.accessors);

  std::string chunks, bytes("glTF");
  append_chunk(chunks, "JSON", json.dump(-1, ' ', false, Json::error_handler_t::replace), ' ');
  append_chunk(chunks, std::string("BIN\0", 4).c_str(), std::move(gltf.buffer), '\0');
  append_word(bytes, 2);
  append_word(bytes, 12 + chunks.size());
  return bytes + chunks;
}

}  // namespace selvage
