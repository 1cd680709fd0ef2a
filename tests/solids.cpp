#include "solids.h"

#include "selvage/shapes/poses.h"
#include "selvage/shapes/shapes.h"

namespace selvage::solids {

Solid of(const IndexedMesh& file) {
  return {file.positions, file.tetrahedra};
}

Solid together(const std::vector<Solid>& parts) {
  Solid all;
  for (const Solid& part : parts) {
    const auto first = static_cast<Index>(all.positions.size());
    all.positions.insert(all.positions.end(), part.positions.begin(), part.positions.end());
    for (VertexTuple<4> element : part.elements) {
      for (Index& v : element) v += first;
      all.elements.push_back(element);
    }
  }
  return all;
}

Solid box(const Vec3& lower, const Vec3& upper, double cell) {
  Solid solid = of(make_box(upper - lower, cell));
  for (Vec3& x : solid.positions) x += lower;
  return solid;
}

Solid tetrahedron(const std::array<Vec3, 4>& corners) {
  return {{corners.begin(), corners.end()}, {{0, 1, 2, 3}}};
}

namespace {

Solid jittered(Solid solid, double amount, Random& random) {
  for (Vec3& x : solid.positions) x += random.vector(amount);
  return solid;
}

Solid posed(IndexedMesh file, std::string_view pose, const PoseOptions& options = {}) {
  apply_pose(file, pose, options);
  return of(file);
}

Solid soup(Random& random) {
  std::vector<Solid> parts;
  for (int i = 0; i < 20; ++i) {
    std::array<Vec3, 4> corners;
    const Vec3 centre = random.vector(1);
    for (Vec3& x : corners) x = centre + random.vector(0.7);
    parts.push_back(tetrahedron(corners));
  }
  return together(parts);
}

Solid boxes(const Vec3& offset, double cell = 0.5) {
  return together({box({0, 0, 0}, {1, 1, 1}, cell), box(offset, offset + Vec3(1, 1, 1), cell)});
}

}  // namespace

const std::vector<Family>& families() {
  static const std::vector<Family> all{
      {"soup", soup},
      {"boxes_apart",
       [](Random&) {
         return boxes({1.3, 0.1, 0.2});
       }},
      {"boxes_overlapping",
       [](Random&) {
         return boxes({0.7, 0.3, 0.2});
       }},
      {"boxes_touching_on_a_grid",
       [](Random&) {
         return boxes({1, 0.5, 0});
       }},
      {"boxes_in_one_place",
       [](Random&) {
         return boxes({0, 0, 0});
       }},
      {"boxes_far_from_the_origin",
       [](Random&) {
         Solid solid = boxes({0.7, 0.3, 0.2});
         for (Vec3& x : solid.positions) x += Vec3(1e6, -3e5, 7e5);
         return solid;
       }},
      {"planks_crossing",
       [](Random&) {
         return together({box({-2, 0, 0}, {2, 0.4, 0.4}, 0.4), box({-0.2, -2, 0.1}, {0.2, 2, 0.5}, 0.4)});
       }},
      {"jittered_boxes",
       [](Random& random) {
         return jittered(boxes({0.8, 0.1, 0.1}), 0.1, random);
       }},
      {"crumpled_box",
       [](Random& random) {
         return jittered(box({0, 0, 0}, {1, 1, 1}, 0.34), 0.5, random);
       }},
      {"bent_beam",
       [](Random&) {
         PoseOptions options;
         options.turns = 1.2;
         return posed(make_box({4, 0.4, 0.4}, 0.4), "bend", options);
       }},
      {"flat_elements",
       [](Random& random) {
         Solid solid = boxes({0.6, 0.2, 0.1});
         for (Vec3& x : solid.positions)
           if (random.unit() < 0.2) x[2] = 0.5;
         return solid;
       }},
  };
  return all;
}

namespace {

Vec3 turned(const Vec3& x, const Vec3& centre, double angle) {
  return centre + Eigen::AngleAxisd(angle, Vec3(1, 2, 3).normalized()) * Vec3(x - centre);
}

}  // namespace

const std::vector<Motion>& motions() {
  using Positions = std::vector<Vec3>;
  static const std::vector<Motion> all{
      {"rest", [](Positions&, Random&) {}},
      {"tremble",
       [](Positions& positions, Random& random) {
         for (Vec3& x : positions) x += random.vector(0.01);
       }},
      {"flight",
       [](Positions& positions, Random& random) {
         const Vec3 way = random.vector(5);
         for (Vec3& x : positions) x += way + random.vector(0.001);
       }},
      {"turn",
       [](Positions& positions, Random&) {
         const Vec3 centre = positions.front();
         for (Vec3& x : positions) x = turned(x, centre, 0.05);
       }},
      {"halves_against_each_other",
       [](Positions& positions, Random& random) {
         const Vec3 way = random.vector(0.05);
         for (std::size_t i = positions.size() / 2; i < positions.size(); ++i) positions[i] += way;
       }},
      {"one_vertex_jumps",
       [](Positions& positions, Random& random) {
         positions[random.below(static_cast<Index>(positions.size()))] += random.vector(1);
       }},
      {"all_jump",
       [](Positions& positions, Random& random) {
         for (Vec3& x : positions) x += random.vector(0.5);
       }},
      {"onto_a_grid",
       [](Positions& positions, Random& random) {
         const Vec3 way = random.vector(0.2);
         for (Vec3& x : positions) x = ((x + way) * 8).array().round() / 8;
       }},
      {"flattened",
       [](Positions& positions, Random&) {
         for (Vec3& x : positions) x[2] = 0.01 * x[2] + 0.3 * x[0];
       }},
      {"blown_up",
       [](Positions& positions, Random& random) {
         for (Vec3& x : positions)
           if (random.unit() < 0.1) x *= x.cwiseAbs().maxCoeff() < 1e50 ? 1e130 : 1e-150;
       }},
      {"mirror",
       [](Positions& positions, Random&) {
         for (Vec3& x : positions) x[0] = -x[0];
       }},
  };
  return all;
}

}  // namespace selvage::solids
