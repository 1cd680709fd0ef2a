#pragma once

#include "random.h"
#include "selvage/self_collision/continuous_collision.h"
#include "simulation/bodies.h"

namespace selvage::bodies {

inline ClothMaterial cloth(double thickness = 0) {
  ClothMaterial material;
  material.thickness = thickness;
  return material;
}

inline ClothMaterial woven(double thickness = 0) {
  ClothMaterial material = cloth(thickness);
  material.kind = ClothKind::kWoven;
  return material;
}

/// A model of one body a sheet; before them one of elements.
inline Model make_with_block(const IndexedMesh& block, const std::vector<IndexedMesh>& sheets, const Material& solid,
                             const ClothMaterial& material) {
  std::vector<Body> made;
  std::vector<Vec3> positions = block.positions;
  std::vector<VertexTuple<3>> triangles;
  const auto vertices = static_cast<Index>(block.positions.size());
  if (vertices > 0) made.push_back({"block", 0, vertices, 0, static_cast<Index>(block.tetrahedra.size()), solid});
  for (const IndexedMesh& sheet : sheets) {
    const auto first = static_cast<Index>(positions.size());
    Body body;
    body.name = "sheet" + std::to_string(made.size() - (vertices > 0 ? 1 : 0));
    body.first_vertex = first;
    body.vertex_count = static_cast<Index>(sheet.positions.size());
    body.first_element = static_cast<Index>(block.tetrahedra.size());
    body.first_triangle = static_cast<Index>(triangles.size());
    body.triangle_count = static_cast<Index>(sheet.triangles.size());
    body.cloth = material;
    made.push_back(body);
    positions.insert(positions.end(), sheet.positions.begin(), sheet.positions.end());
    for (const auto& [a, b, c] : sheet.triangles) triangles.push_back({first + a, first + b, first + c});
  }
  const auto all = static_cast<Index>(positions.size());
  return make_model(vertices > 0 ? TetMesh(all, block.tetrahedra) : TetMesh::without_elements(all), positions, made,
                    triangles);
}

inline Model make_sheets(const std::vector<IndexedMesh>& sheets, const ClothMaterial& material) {
  return make_with_block({}, sheets, {}, material);
}

struct FlyingSheets {
  Model model;
  State state;
};

/// Strips and squares that fly at one another, turned, some with sharp or nearly degenerate triangles.
inline FlyingSheets make_flying_sheets(test::Random& random, int count) {
  std::vector<IndexedMesh> meshes;
  for (int i = 0; i < count; ++i) {
    IndexedMesh sheet = random.below(2) == 0 ? make_cloth(0.4, 0.4, 0.1) : make_cloth(0.8, 0.05, 0.05);
    if (random.below(3) == 0)
      for (Vec3& p : sheet.positions) p += random.vector(0.02);
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(random.within(0, 3), random.vector(1).normalized()).toRotationMatrix();
    for (Vec3& p : sheet.positions) p = turn * p;
    meshes.push_back(moved(sheet, Vec3(0.9 * (i & 1), 0.9 * (i >> 1 & 1), 0.9 * (i >> 2))));
  }
  const double thickness = random.below(2) == 0 ? 0 : 0.004;
  Model model = make_sheets(meshes, random.below(2) == 0 ? cloth(thickness) : woven(thickness));
  State state = make_state(model, model.rest_positions);
  const double speed = random.within(5, 40);
  for (const Body& body : model.bodies) {
    const Vec3 to = Vec3(0.6, 0.6, 0.2) - state.positions[body.first_vertex];
    for (Index v = body.first_vertex; v < body.first_vertex + body.vertex_count; ++v)
      state.velocities[v] = speed * to + random.vector(0.5);
  }
  return {std::move(model), std::move(state)};
}

/// Exact detection over steps, of all pairs of a model's surface.
class ClothJudge {
 public:
  explicit ClothJudge(const Model& model) : surface_(surface_of(model)) { options_.method = CullingMethod::kBvh; }

  bool is_free(const State& state) const {
    return SelfCollisionFinder(surface_, state.positions, options_).find_pairs().empty();
  }

  std::int64_t pairs(const State& from, const State& to) const {
    const auto found = ContinuousCollisionFinder(surface_, from.positions, to.positions, options_).find_pairs();
    return std::ssize(found.vertex_face) + std::ssize(found.edge_edge);
  }

 private:
  TriangleMesh surface_;
  SelfCollisionOptions options_;
};

}  // namespace selvage::bodies
