#include "untangling/solids/relaxation.h"

#include "core/parallel.h"
#include "elasticity/deformation_gradient.h"
#include "mesh/find_inverted.h"
#include "selvage/core/error.h"
#include "untangling/solids/agreeing_contacts.h"
#include "untangling/solids/tangle_finder.h"
#include "untangling/solids/uninvert_elements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

/// Passes of material and contacts in one iteration, after one detection.
constexpr int kPasses = 8;
/// Iterations of the material in each pass: with one, long thin elements crumple before they pull their neighbours
/// along.
constexpr int kMaterialPasses = 4;
/// Young's modulus where density, time step and mean edge length are 1: so stiff that contacts move bodies rather than
/// dent them.
constexpr double kStiffness = 100;
/// Part of the mean edge length by which a contact pushes in one iteration. Points deep inside go opposite ways: all
/// the way at once, they would invert elements before the material can decide which side yields.
constexpr double kPush = 0.5;
/// Distance, in mean edge lengths, at which surfaces that met are kept until no point is inside. With less, edges that
/// cross at a ridge lock where the material pulls as much as the contacts push.
constexpr double kUntanglingClearance = 0.4;
/// Factor by which that distance shrinks per iteration afterwards.
constexpr double kClearanceShrinkage = 0.9;
/// Largest move of a vertex in one iteration, as a part of the mean edge length: the material throws inverted elements
/// far.
constexpr double kMaxMove = 0.5;
/// Iterations for which a contact holds after its point was last inside. Without it the material would at once pull the
/// point back in.
constexpr int kHold = 20;
/// Part of an element's size by which a vertex must have moved to wake the element's other vertices.
constexpr double kWakingShare = 0.01;
/// Keeps rounding from carrying a vertex beyond the largest displacement.
constexpr double kBelowOne = 1 - 1e-12;

/// Of the boundary's edges [m].
double mean_edge_length(const TetMesh& mesh, std::span<const Vec3> positions) {
  double sum = 0;
  for (const auto& face : mesh.boundary_faces())
    for (int k = 0; k < 3; ++k) sum += (positions[face[k]] - positions[face[(k + 1) % 3]]).norm();
  return sum / (3 * static_cast<double>(mesh.boundary_faces().size()));
}

/// The mesh as one body, its stiffness relative to its elements' size: a mesh resolves alike in any unit.
Model make_relative_model(const TetMesh& mesh, std::span<const Vec3> rest) {
  if (std::ssize(rest) != mesh.vertex_count())
    throw Error("rest positions", fmt::format("{} for {} vertices", rest.size(), mesh.vertex_count()),
                "give one per vertex");
  const double length = mean_edge_length(mesh, rest);
  Body body{.name = "mesh",
            .first_vertex = 0,
            .vertex_count = mesh.vertex_count(),
            .first_element = 0,
            .element_count = mesh.element_count(),
            .material = {}};
  body.material.density = 1;
  body.material.youngs_modulus = kStiffness * length * length;
  return make_model(mesh, {rest.begin(), rest.end()}, {body});
}

}  // namespace

Relaxation::Relaxation(const TetMesh& mesh, std::vector<Vec3>& positions, std::span<const Vec3> rest,
                       std::span<const Vec3> origin, const ResolveOptions& options)
    : mesh_(mesh),
      positions_(positions),
      start_(positions),
      origin_(origin),
      model_(make_relative_model(mesh, rest)),
      length_(mean_edge_length(mesh, model_.rest_positions)),
      clearance_(options.clearance),
      max_displacement_(options.max_displacement),
      push_{.clearance = std::max(clearance_, kUntanglingClearance) * length_,
            .max_correction = kPush / kPasses * length_},
      material_(model_, 1) {
  element_sizes_.resize(mesh.element_count());
  parallel_for(mesh.element_count(), kGrain, [&](std::int64_t e) {
    element_sizes_[e] = std::cbrt(6 * element_volume(mesh.elements()[e], model_.rest_positions));
  });
  for (const Vec3& p : positions_) vertices_.push_back({{p[0], p[1], p[2]}, 0});
  is_awake_.resize(positions.size());
  for (const double inverse_mass : model_.inverse_masses) is_free_.push_back(inverse_mass > 0);
  for (const Index v : options.pinned) is_free_[v] = false;
  inverted_ = find_inverted(mesh, positions);
}

std::int64_t Relaxation::count_awake() const {
  return std::count(is_awake_.begin(), is_awake_.end(), 1);
}

void Relaxation::hold(std::span<const Contact> contacts) {
  const auto before = [](const Contact& a, const Contact& b) { return point_of(a) < point_of(b); };
  std::erase_if(held_, [&](HeldContact& held) {
    return ++held.age > kHold || std::binary_search(contacts.begin(), contacts.end(), held.contact, before);
  });
  for (const Contact& contact : contacts) held_.push_back({contact});
  for (const Contact& contact : contacts)
    for (int i = 0; i < contact.count; ++i) wake(contact.vertices[i]);
  // The material restores those that no point is inside of.
  for (const Index e : inverted_)
    for (const Index v : mesh_.elements()[e]) wake(v);
}

void Relaxation::wake(Index vertex) {
  if (is_awake_[vertex] || !is_free_[vertex]) return;
  is_awake_[vertex] = true;
  vertices_[vertex].inverse_mass = model_.inverse_masses[vertex];
}

void Relaxation::wake_all() {
  for (Index v = 0; v < mesh_.vertex_count(); ++v) wake(v);
}

void Relaxation::wake_displaced() {
  for (Index v = 0; v < mesh_.vertex_count(); ++v)
    if (positions_[v] != origin_[v]) wake(v);
}

void Relaxation::wake_neighbours() {
  std::vector<double> moved(mesh_.vertex_count(), -HUGE_VAL);  // of those awake
  for (Index v = 0; v < mesh_.vertex_count(); ++v)
    if (is_awake_[v]) moved[v] = (positions_[v] - start_[v]).norm();
  for (Index e = 0; e < mesh_.element_count(); ++e) {
    const auto& corners = mesh_.elements()[e];
    const double limit = kWakingShare * element_sizes_[e];
    if (std::any_of(corners.begin(), corners.end(), [&](Index v) { return moved[v] > limit; }))
      for (const Index v : corners) wake(v);
  }
}

/// In each pass contacts come after the material, so that they hold at its end.
void Relaxation::relax() {
  std::vector<Contact> held;
  for (const HeldContact& h : held_) held.push_back(h.contact);
  const auto first_now = std::find_if(held_.begin(), held_.end(), [](const HeldContact& h) { return h.age == 0; });
  const AgreeingContacts agreeing = find_agreeing_contacts(mesh_, positions_, held, first_now - held_.begin());
  drawn_vertices_ = agreeing.drawn_vertices;
  for (int pass = 0; pass < kPasses; ++pass) {
    for (int i = 0; i < kMaterialPasses; ++i) material_.solve(vertices_, {}, 0, 1);
    push_apart(agreeing.contacts, push_, vertices_);
    limit_displacements();
  }
  std::vector<Vec3> moved = positions_;
  for (Index v = 0; v < mesh_.vertex_count(); ++v)
    if (is_awake_[v]) moved[v] = Eigen::Map<const Eigen::Vector3d>(vertices_[v].position);
  const Freedom freedom{.is_free = is_awake_, .origin = origin_, .max_displacement = max_displacement_};
  inverted_ = uninvert_elements(mesh_, model_.rest_positions, find_inverted(mesh_, moved), freedom, moved);
  set_positions(moved);
}

void Relaxation::set_positions(std::span<const Vec3> positions) {
  for (Index v = 0; v < mesh_.vertex_count(); ++v) {
    if (!is_awake_[v]) continue;
    positions_[v] = positions[v];
    Eigen::Map<Eigen::Vector3d>(vertices_[v].position) = positions[v];
  }
}

void Relaxation::place(std::span<const Vec3> positions) {
  set_positions(positions);
  inverted_ = find_inverted(mesh_, positions_);
}

void Relaxation::limit_displacements() {
  const auto hold_within = [](Eigen::Map<Eigen::Vector3d> position, const Vec3& centre, double radius) {
    const Vec3 moved = position - centre;
    const double distance = moved.norm();
    if (distance > kBelowOne * radius) position = centre + kBelowOne * radius / distance * moved;
  };
  parallel_for(mesh_.vertex_count(), kGrain, [&](std::int64_t v) {
    if (!is_awake_[v]) return;
    const Eigen::Map<Eigen::Vector3d> position(vertices_[v].position);
    hold_within(position, positions_[v], kMaxMove * length_);
    hold_within(position, origin_[v], max_displacement_);
  });
}

void Relaxation::shrink_clearance() {
  push_.clearance = std::max(kClearanceShrinkage * push_.clearance, clearance_ * length_);
}

}  // namespace selvage
