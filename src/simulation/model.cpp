#include "selvage/simulation/model.h"

#include "selvage/core/error.h"
#include "selvage/geometry/predicates.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace selvage {

bool is_in_range(const Vec3& position) {
  return (position.array().abs() <= std::numeric_limits<float>::max()).all();
}

namespace {

void check_size(std::string_view what, std::size_t size, Index vertex_count) {
  if (size != static_cast<std::size_t>(vertex_count))
    throw Error(what, fmt::format("{} entries for {} vertices", size, vertex_count), "give one per vertex");
}

void check_finite(std::span<const Vec3> positions) {
  for (std::size_t v = 0; v < positions.size(); ++v)
    if (!is_in_range(positions[v]))
      throw Error(fmt::format("vertex {}", v), "its position is not finite, or not in single precision",
                  "keep coordinates below 3e38");
}

/// Part of a triangle's longest edge, squared, up to which its area is none.
constexpr double kNoArea = 1e-10;

/// Cuts bodies out of a list of elements or triangles, one after the other.
class Cover {
 public:
  Cover(std::string_view kind, Index count) : kind_(kind), count_(count) {}

  void take(const Body& body, Index first, Index count) {
    if (count == 0) return;
    if (first != next_ || count < 0 || count > count_ - next_)
      throw Error(fmt::format("body '{}'", body.name),
                  fmt::format("its {}s do not start at {}, or there are too many", kind_, next_),
                  fmt::format("let each body have the {}s after those of the body before", kind_));
    next_ += count;
  }
  void end() const {
    if (next_ != count_)
      throw Error(fmt::format("{} {}", kind_, next_), "is of no body", fmt::format("let bodies cover all {}s", kind_));
  }

 private:
  std::string_view kind_;
  Index count_, next_ = 0;
};

template <std::size_t N>
void check_vertices(const Model& model, const Body& body, std::string_view kind,
                    std::span<const std::array<Index, N>> all, Index first, Index count) {
  for (Index i = first; i < first + count; ++i)
    for (const Index v : all[i])
      if (v < body.first_vertex || v - body.first_vertex >= body.vertex_count || v >= model.mesh.vertex_count())
        throw Error(fmt::format("{} {}", kind, i), fmt::format("vertex {} is not of its body '{}'", v, body.name));
}

void check_bodies(const Model& model) {
  Cover elements("element", model.mesh.element_count());
  Cover triangles("triangle", static_cast<Index>(model.triangles.size()));
  for (const Body& body : model.bodies) {
    const std::string where = fmt::format("body '{}'", body.name);
    if ((body.element_count > 0) == (body.triangle_count > 0))
      throw Error(where, "has elements and triangles, or neither", "give it one of both");
    elements.take(body, body.first_element, body.element_count);
    triangles.take(body, body.first_triangle, body.triangle_count);
    check_vertices<4>(model, body, "element", model.mesh.elements(), body.first_element, body.element_count);
    check_vertices<3>(model, body, "triangle", model.triangles, body.first_triangle, body.triangle_count);
    if (body.is_cloth()) {
      check_material(where, body.cloth);
    } else {
      check_material(where, body.material);
    }
  }
  elements.end();
  triangles.end();
}

void add_element_masses(const Model& model, const Body& body, std::vector<double>& masses) {
  for (Index e = body.first_element; e < body.first_element + body.element_count; ++e) {
    std::array<Vec3, 4> corners;
    for (int k = 0; k < 4; ++k) corners[k] = model.rest_positions[model.mesh.elements()[e][k]];
    if (orientation(corners) <= 0)
      throw Error(fmt::format("element {}", e), "is flat or inverted at rest", "give a rest pose that is neither");
    const double volume = (corners[1] - corners[0]).dot((corners[2] - corners[0]).cross(corners[3] - corners[0])) / 6;
    for (const Index v : model.mesh.elements()[e]) masses[v] += body.material.density * volume / 4;
  }
}

void add_triangle_masses(const Model& model, const Body& body, std::vector<double>& masses) {
  double shortest = std::numeric_limits<double>::infinity();
  for (Index t = body.first_triangle; t < body.first_triangle + body.triangle_count; ++t) {
    std::array<Vec3, 3> edges;
    const auto& triangle = model.triangles[t];
    for (int k = 0; k < 3; ++k)
      edges[k] = model.rest_positions[triangle[(k + 1) % 3]] - model.rest_positions[triangle[k]];
    const double area = edges[0].cross(edges[1]).norm() / 2;
    double longest = 0;
    for (const Vec3& edge : edges) {
      longest = std::max(longest, edge.squaredNorm());
      shortest = std::min(shortest, edge.norm());
    }
    if (!(area > kNoArea * longest))
      throw Error(fmt::format("triangle {} of body '{}'", t - body.first_triangle, body.name), "has no area at rest",
                  "remove it from the mesh");
    for (const Index v : triangle) masses[v] += body.cloth.density * area / 3;
  }
  if (!(2 * body.cloth.thickness <= shortest))
    throw Error(fmt::format("body '{}'", body.name),
                fmt::format("its thickness is {} m, more than half of its shortest edge at rest, {:.4g} m",
                            body.cloth.thickness, shortest),
                "give a smaller thickness or a coarser mesh");
}

}  // namespace

Model make_model(TetMesh mesh, std::vector<Vec3> rest_positions, std::vector<Body> bodies,
                 std::vector<VertexTuple<3>> triangles) {
  Model model{.mesh = std::move(mesh),
              .rest_positions = std::move(rest_positions),
              .bodies = std::move(bodies),
              .inverse_masses = {},
              .triangles = std::move(triangles)};
  check_size("rest positions", model.rest_positions.size(), model.mesh.vertex_count());
  check_finite(model.rest_positions);
  check_bodies(model);
  std::vector<double> masses(model.mesh.vertex_count(), 0.0);
  for (const Body& body : model.bodies) {
    add_element_masses(model, body, masses);
    add_triangle_masses(model, body, masses);
  }
  model.inverse_masses.resize(masses.size());
  for (std::size_t v = 0; v < masses.size(); ++v) model.inverse_masses[v] = masses[v] > 0 ? 1 / masses[v] : 0;
  return model;
}

std::vector<VertexTuple<3>> surface_triangles(const Model& model) {
  std::vector<VertexTuple<3>> triangles(model.mesh.boundary_faces().begin(), model.mesh.boundary_faces().end());
  triangles.insert(triangles.end(), model.triangles.begin(), model.triangles.end());
  return triangles;
}

TriangleMesh surface_of(const Model& model) {
  return {model.mesh.vertex_count(), surface_triangles(model)};
}

std::vector<Index> bodies_of_vertices(const Model& model) {
  std::vector<Index> bodies(model.mesh.vertex_count(), kNone);
  for (Index b = 0; b < std::ssize(model.bodies); ++b)
    std::fill_n(bodies.begin() + model.bodies[b].first_vertex, model.bodies[b].vertex_count, b);
  return bodies;
}

double mean_edge_of(const Model& model, const Body& body) {
  const auto& x = model.rest_positions;
  double sum = 0;
  const auto add = [&](std::span<const Index> vertices) {
    for (std::size_t i = 0; i < vertices.size(); ++i)
      for (std::size_t k = 0; k < i; ++k) sum += (x[vertices[i]] - x[vertices[k]]).norm();
  };
  for (const auto& element : model.mesh.elements().subspan(body.first_element, body.element_count)) add(element);
  for (const auto& triangle : std::span(model.triangles).subspan(body.first_triangle, body.triangle_count))
    add(triangle);
  return sum / std::max(6.0 * body.element_count + 3.0 * body.triangle_count, 1.0);
}

State make_state(const Model& model, std::vector<Vec3> positions) {
  check_size("positions", positions.size(), model.mesh.vertex_count());
  check_finite(positions);
  State state{std::move(positions), std::vector<Vec3>(model.mesh.vertex_count(), Vec3::Zero())};
  for (const Body& body : model.bodies)
    for (Index v = body.first_vertex; v < body.first_vertex + body.vertex_count; ++v)
      state.velocities[v] = body.initial_velocity;
  return state;
}

}  // namespace selvage
