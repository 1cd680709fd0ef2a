#include "selvage/contact/contact_finder.h"

#include "contact/contact_finder_impl.h"
#include "contact/input/collider_triangles.h"
#include "core/parallel.h"
#include "core/timed.h"
#include "mesh/position_extent.h"
#include "selvage/core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace selvage {

namespace {

/// Edges of tangles rest in the last kEdgesRestFor of kEdgesRestEvery steps.
constexpr std::int64_t kEdgesRestEvery = 64, kEdgesRestFor = 8;
/// Steps in which each deep vertex has one turn. With 2 a step of two bodies in one place takes a quarter longer, with
/// 1 twice as long.
constexpr std::int64_t kTurns = 3;

}  // namespace

ContactFinder::Impl::Impl(const TetMesh& m, std::span<const Vec3> rest_positions, std::span<const Vec3> positions,
                          std::span<const Index> vertex_objects, ContactOptions o,
                          std::span<const VertexTuple<3>> colliders, ContactCloth cloth)
    : mesh(m),
      options(o),
      surface(surface_with_colliders(m, colliders, positions.size(), cloth.triangles)),
      body_faces(m.boundary_face_count() + static_cast<Index>(cloth.triangles.size())),
      impacts(surface, body_faces),
      met_faces(surface, body_faces),
      tangled(surface, m.boundary_face_count(), body_faces, o.guarantee) {
  check_positions<3>(positions, vertex_count());
  if (!vertex_objects.empty() && std::ssize(vertex_objects) != mesh.vertex_count())
    throw Error("vertex_objects", fmt::format("{} for {} vertices", vertex_objects.size(), mesh.vertex_count()),
                "give one per vertex, or none at all");
  const bool uses_rest = options.rule == ClosestPointRule::kRestPose;
  if (uses_rest || !rest_positions.empty()) check_positions<3>(rest_positions, mesh.vertex_count(), "rest_positions");
  if (uses_rest) rest_pose.emplace(mesh, rest_positions);
  if (options.rule == ClosestPointRule::kEuclidean) euclidean.emplace(mesh, vertex_objects);
  if (uses_dcd())
    search.emplace(mesh, surface, body_faces, options.detect_edges, positions,
                   PathOptions{options.cull_infeasible_regions, true}, !options.interior_points);
  positions_t0.assign(positions.begin(), positions.end());
  if (search) is_inside.resize(search->feature_count());
  if (options.splits() && options.rule == ClosestPointRule::kShortestPath) {
    common.emplace(mesh);
    if (!colliders.empty() && !rest_positions.empty()) off.emplace(mesh, rest_positions, surface, body_faces);
  }
  if (is_dcd_alone() || (options.splits() && options.wait_for_inverted)) pieces = mesh.element_components();
  if (std::any_of(cloth.thickness.begin(), cloth.thickness.end(), [](double t) { return t > 0; }) && uses_ccd()) {
    check_positions<3>(rest_positions, mesh.vertex_count(), "rest_positions");
    std::vector<double> thickness(cloth.thickness.begin(), cloth.thickness.end());
    thickness.resize(vertex_count(), 0.0);
    near.emplace(step_to(positions_t0), separated_at_rest(rest_positions, vertex_objects, vertex_count()),
                 std::move(thickness));
  }
}

void ContactFinder::Impl::begin_step(std::span<const Vec3> positions, std::int64_t step) {
  check_positions<3>(positions, vertex_count());
  statistics = {};
  has_begun = true;
  own_edges_rest = is_dcd_alone() && step % kEdgesRestEvery >= kEdgesRestEvery - kEdgesRestFor;
  folded_vertices.clear();
  if (off) off->begin_step();
  positions_t0.assign(positions.begin(), positions.end());
  impacts.begin_step();
  if (options.splits()) split_features(step);
  if (!options.wait_for_inverted) return;
  inverted = options.splits() ? InvertedVertices(mesh, of_mesh(positions_t0), search->locator().defective_elements())
                              : InvertedVertices(mesh, of_mesh(positions_t0));
}

void ContactFinder::Impl::split_features(std::int64_t step) {
  place(positions_t0);
  timed(statistics.seconds_split, [&] {
    std::fill(is_inside.begin(), is_inside.end(), 0);
    inside.clear();
    inside_vertices.clear();
    inside_edges.clear();
    const auto candidates = met_faces.take_candidates(positions_t0, search->crossings());
    for (const Penetration& p : search->find_all(statistics.penetrations, candidates, options.take_turns)) {
      if (std::exchange(is_inside[p.feature], 1) != 0) continue;
      if (p.element != kNone) inside.push_back(p.feature);
      if (search->is_edge(p.feature)) {
        inside_edges.push_back(search->edge_of(p.feature));
      } else {
        inside_vertices.push_back(search->vertex_of(p.feature));
      }
    }
    if (options.take_turns && search->is_crowded()) take_turns(step);
  });
  tangled.mark(inside_vertices, inside_edges, search->crossings());
  contours = {};
  if (body_faces > mesh.boundary_face_count())
    contours = find_contours(surface, positions_t0, search->crossings(), mesh.boundary_face_count(), body_faces);
  statistics.unguarded_vertices = tangled.count();
  statistics.penetrating_vertices = std::ssize(inside_vertices);
  statistics.penetrating_edges = std::ssize(inside_edges);
}

/// Removes the bodies' vertices among others that are inside, but for one in kTurns.
void ContactFinder::Impl::take_turns(std::int64_t step) {
  const auto is_vertex_inside = [&](Index v) { return is_inside[search->feature_of(v)] != 0; };
  std::erase_if(inside, [&](Index feature) {
    if (search->is_edge(feature)) return false;
    const Index v = search->vertex_of(feature);
    if (is_of_collider(v) || v % kTurns == step % kTurns) return false;
    const auto around = surface.vertex_triangles(v);
    return std::all_of(around.begin(), around.end(), [&](Index face) {
      const auto& corners = surface.triangles()[face];
      return std::all_of(corners.begin(), corners.end(), is_vertex_inside);
    });
  });
  statistics.off_turn = std::ssize(inside_vertices) + std::ssize(inside_edges) - std::ssize(inside);
}

/// Removes what has to run into each other where pieces get off colliders.
void ContactFinder::Impl::leave_out_let_in(ContinuousPairs& pairs) const {
  const auto is_let_in = [&](Index one, Index other) {
    return is_of_collider(one) != is_of_collider(other) && off->lets_in(std::min(one, other), std::max(one, other));
  };
  std::erase_if(pairs.vertex_face,
                [&](const VertexFacePair& p) { return is_let_in(p.vertex, surface.triangles()[p.face][0]); });
  std::erase_if(pairs.edge_edge, [&](const EdgeEdgePair& p) {
    return is_let_in(surface.edges()[p.first][0], surface.edges()[p.second][0]);
  });
}

/// All that meet on the way.
ContinuousPairs ContactFinder::Impl::find_pairs(std::span<const Vec3> positions) {
  ContinuousPairs pairs = impacts.find_pairs(positions_t0, positions, statistics.continuous);
  if (options.splits()) met_faces.note(positions, pairs);
  if (!options.detect_edges) pairs.edge_edge.clear();
  if (off && !off->empty() && !options.guarantee) leave_out_let_in(pairs);
  return pairs;
}

/// Those that are to be contacts.
StepImpacts ContactFinder::Impl::find_impacts(std::span<const Vec3> positions) {
  ContinuousPairs pairs = find_pairs(positions);
  std::erase_if(pairs.vertex_face, [&](const VertexFacePair& p) { return p.face >= body_faces; });
  if (options.splits()) {
    const auto inside_of = [](std::span<const Index> all, Index i) {
      return std::binary_search(all.begin(), all.end(), i);
    };
    std::erase_if(pairs.vertex_face, [&](const VertexFacePair& p) { return inside_of(inside_vertices, p.vertex); });
    std::erase_if(pairs.edge_edge, [&](const EdgeEdgePair& p) {
      return inside_of(inside_edges, p.first) || inside_of(inside_edges, p.second);
    });
  }
  std::erase_if(pairs.vertex_face, [&](const VertexFacePair& p) {
    return tangled.is_of_cloth({&p.vertex, 1}, surface.triangles()[p.face]);
  });
  std::erase_if(pairs.edge_edge, [&](const EdgeEdgePair& p) {
    return tangled.is_of_cloth(surface.edges()[p.first], surface.edges()[p.second]);
  });
  return impacts.with_times(std::move(pairs));
}

/// Those that are to be held back: at no vertex where bodies penetrate; of two features of cloth, not where both have
/// one. Without the guarantee of no inverted element
/// either, and no vertices of the mesh that run into colliders, which are kept out by the shapes.
StepImpacts ContactFinder::Impl::find_untangled_impacts(std::span<const Vec3> positions) {
  ContinuousPairs pairs = find_pairs(positions);
  const auto is_left_out = [&](std::span<const Index> one, std::span<const Index> other) {
    return tangled.leaves_out(one, other) || (!options.guarantee && (inverted.has_any(one) || inverted.has_any(other)));
  };
  std::erase_if(pairs.vertex_face, [&](const VertexFacePair& p) {
    return (!options.guarantee && p.face >= body_faces) || is_left_out({&p.vertex, 1}, surface.triangles()[p.face]);
  });
  std::erase_if(pairs.edge_edge, [&](const EdgeEdgePair& p) {
    return is_left_out(surface.edges()[p.first], surface.edges()[p.second]);
  });
  return impacts.with_times(std::move(pairs));
}

void ContactFinder::Impl::append_contacts(const StepImpacts& found, std::span<const Vec3> positions,
                                          std::vector<Contact>& contacts) const {
  const std::size_t first = contacts.size();
  append_impact_contacts(step_to(positions), found, contacts);
  const auto waits = [&](const Contact& c) {
    return inverted.has_any(std::span(c.vertices).first(c.count), c.weights);
  };
  contacts.erase(std::remove_if(contacts.begin() + first, contacts.end(), waits), contacts.end());
}

/// But for what is tangled: the normal may point the wrong way there.
void ContactFinder::Impl::append_near(std::vector<Contact>& contacts) {
  const std::size_t first = contacts.size();
  near->append_contacts(positions_t0, contacts);
  const auto is_tangled = [&](const Contact& c) { return tangled.has_any(std::span(c.vertices).first(c.count)); };
  contacts.erase(std::remove_if(contacts.begin() + first, contacts.end(), is_tangled), contacts.end());
}

void ContactFinder::Impl::find_contacts(std::span<const Vec3> positions, std::vector<Contact>& contacts) {
  if (!has_begun) throw Error("step", "has not begun", "call begin_step() first");
  check_positions<3>(positions, vertex_count());
  contacts.clear();
  if (uses_dcd()) append_paths(positions, contacts);
  if (uses_ccd()) timed(statistics.seconds_ccd, [&] { append_contacts(find_impacts(positions), positions, contacts); });
  if (near) timed(statistics.seconds_ccd, [&] { append_near(contacts); });
  append_contour_contacts(surface, positions_t0, contours, contacts);
  for (const Contact& contact : contacts) ++statistics.contacts[static_cast<int>(contact.kind)];
}

ContactFinder::ContactFinder(const TetMesh& mesh, std::span<const Vec3> rest_positions, std::span<const Vec3> positions,
                             std::span<const Index> vertex_objects, ContactOptions options,
                             std::span<const VertexTuple<3>> colliders, ContactCloth cloth)
    : impl_(std::make_unique<Impl>(mesh, rest_positions, positions, vertex_objects, options, colliders, cloth)) {}
ContactFinder::~ContactFinder() = default;
ContactFinder::ContactFinder(ContactFinder&&) noexcept = default;
ContactFinder& ContactFinder::operator=(ContactFinder&&) noexcept = default;

void ContactFinder::begin_step(std::span<const Vec3> positions_t0, std::int64_t step) {
  impl_->begin_step(positions_t0, step);
}

std::vector<PieceWayOff> ContactFinder::choose_ways_off(const std::function<bool(Index, const Vec3&)>& is_blocked) {
  if (!impl_->has_begun) throw Error("step", "has not begun", "call begin_step() first");
  return impl_->choose_ways_off(is_blocked);
}

void ContactFinder::let_in(Index of_piece, std::span<const Index> of_colliders) {
  if (!impl_->has_begun) throw Error("step", "has not begun", "call begin_step() first");
  if (of_piece < 0 || of_piece >= impl_->mesh.vertex_count())
    throw Error("of_piece", fmt::format("vertex {} is not of the mesh", of_piece));
  for (const Index v : of_colliders)
    if (v < impl_->mesh.vertex_count() || v >= impl_->vertex_count())
      throw Error("of_colliders", fmt::format("vertex {} is not of a collider", v));
  if (impl_->off) impl_->off->let_in(of_piece, of_colliders);
}

void ContactFinder::find_contacts(std::span<const Vec3> positions_t1, std::vector<Contact>& contacts) {
  impl_->find_contacts(positions_t1, contacts);
}

StepImpacts ContactFinder::find_impacts(std::span<const Vec3> positions_t1) {
  if (!impl_->has_begun) throw Error("step", "has not begun", "call begin_step() first");
  check_positions<3>(positions_t1, impl_->vertex_count());
  StepImpacts found;
  if (impl_->uses_ccd())
    timed(impl_->statistics.seconds_ccd, [&] { found = impl_->find_untangled_impacts(positions_t1); });
  return found;
}

void ContactFinder::append_contacts(const StepImpacts& impacts, std::span<const Vec3> positions_t1,
                                    std::vector<Contact>& contacts) {
  const std::size_t first = contacts.size();
  impl_->append_contacts(impacts, positions_t1, contacts);
  for (std::size_t i = first; i < contacts.size(); ++i)
    ++impl_->statistics.contacts[static_cast<int>(contacts[i].kind)];
}

const ContactStatistics& ContactFinder::statistics() const {
  return impl_->statistics;
}

const TriangleMesh& ContactFinder::surface() const {
  return impl_->surface;
}

std::span<const Index> ContactFinder::penetrating_vertices() const {
  return impl_->inside_vertices;
}

std::span<const Index> ContactFinder::penetrating_edges() const {
  return impl_->inside_edges;
}

std::vector<Index> ContactFinder::unguarded_vertices() const {
  const auto tangled = impl_->tangled.vertices(), inverted = impl_->inverted.vertices();
  std::vector<Index> vertices(tangled.begin(), tangled.end());
  vertices.insert(vertices.end(), inverted.begin(), inverted.end());
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

std::span<const Index> ContactFinder::folded_vertices() const {
  return impl_->folded_vertices;
}

}  // namespace selvage
