#include "peer/paths/embree_peer.h"

#include "core/parallel.h"
#include "peer/paths/embree_scene.h"
#include "peer/paths/tet_walk.h"

#include <limits>

namespace selvage::bench {

namespace {

/// How far p must lie in the infeasible region of a candidate, beside rounding (epsilon_r of the paper): as a sine.
constexpr float kRegionAngle = 1e-3f;

struct PeerFace {
  std::array<Index, 3> vertices;
  Index owner;  ///< 4 * tet + face
};

Float3 to_float(const Vec3& x) {
  return {static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2])};
}

/// Whether p, away from s by `out`, lies clearly on the side of a neighbouring face or edge that leaves s by `along`.
bool leans_towards(const Float3& out, const Float3& along, float rounding) {
  const float d = dot(out, along);
  const float least = std::max(kRegionAngle * kRegionAngle * dot(out, out), rounding * rounding);
  return d > 0 && d * d > least * dot(along, along);
}

/// Closed tetrahedron of either orientation, seen from the point.
bool surrounds_origin(const Float3& a, const Float3& b, const Float3& c, const Float3& d) {
  const Float3 ab = cross(a, b), cd = cross(c, d);
  const float wd = dot(ab, c), wc = -dot(ab, d);
  if ((wd > 0 && wc < 0) || (wd < 0 && wc > 0)) return false;
  const float wa = -dot(cd, b), wb = dot(cd, a);
  return (wa >= 0 && wb >= 0 && wc >= 0 && wd >= 0) || (wa <= 0 && wb <= 0 && wc <= 0 && wd <= 0);
}

}  // namespace

struct EmbreePeer::State {
  struct Containment;
  template <bool Counting>
  struct Search;

  const TetMesh& mesh;
  std::vector<Float3> positions;
  std::vector<PeerTet> tets;
  std::vector<PeerFace> faces;
  std::vector<Index> ring, ring_first;  ///< boundary vertices joined by a boundary edge to each vertex
  std::vector<std::uint8_t> skipped;    ///< inverted elements on the boundary; filled only where some are inverted
  bool has_inverted = false;
  float face_tolerance = 0;  ///< epsilon_i of the paper, a double area [m^2]
  float rounding = 0;        ///< of a point computed in single precision [m]
  EmbreeDevice device;
  EmbreeScene face_scene, tet_scene;

  State(const TetMesh& m, PeerSettings settings);
  void list_rings();
  void take_pose(std::span<const Vec3> x);
  template <bool Counting>
  PeerPath find_path(const PathQuery<3>& query, bool cull, PeerCounters& counters) const;
  WalkMesh walk_mesh() const { return {positions.data(), tets.data(), has_inverted, face_tolerance, rounding}; }
};

EmbreePeer::State::State(const TetMesh& m, PeerSettings settings)
    : mesh(m),
      positions(m.vertex_count() + 1),
      tets(m.element_count()),
      faces(m.boundary_face_count()),
      face_scene(device, settings.tree, settings.triangles ? EmbreeScene::Kind::kTriangles : EmbreeScene::Kind::kBoxes),
      tet_scene(device, settings.tree, EmbreeScene::Kind::kBoxes) {
  for (Index t = 0; t < m.element_count(); ++t) {
    tets[t].vertices = m.elements()[t];
    for (int i = 0; i < 4; ++i) tets[t].across[i] = m.neighbours()[t][i].code;
  }
  for (Index f = 0; f < m.boundary_face_count(); ++f) faces[f] = {m.boundary_faces()[f], m.boundary_owners()[f].code};
  list_rings();
  face_scene.set_simplices(positions.data(), m.vertex_count(), faces.data()->vertices.data(), sizeof(PeerFace), 3,
                           faces.size());
  tet_scene.set_simplices(positions.data(), m.vertex_count(), tets.data()->vertices.data(), sizeof(PeerTet), 4,
                          tets.size());
}

void EmbreePeer::State::list_rings() {
  const auto ridges = mesh.boundary_ridges();
  ring_first.assign(mesh.vertex_count() + 1, 0);
  for (const auto& ridge : ridges)
    for (Index v : ridge.vertices) ++ring_first[v + 1];
  for (Index v = 0; v < mesh.vertex_count(); ++v) ring_first[v + 1] += ring_first[v];
  ring.resize(ring_first.back());
  std::vector<Index> next(ring_first.begin(), ring_first.end() - 1);
  for (const auto& ridge : ridges) {
    ring[next[ridge.vertices[0]]++] = ridge.vertices[1];
    ring[next[ridge.vertices[1]]++] = ridge.vertices[0];
  }
}

void EmbreePeer::State::take_pose(std::span<const Vec3> x) {
  parallel_for(std::ssize(x), 4096, [&](std::int64_t v) { positions[v] = to_float(x[v]); });
  std::atomic<bool> inverted = false;
  const auto is_inverted = [&](const std::array<Index, 4>& t) {
    const Float3& a = positions[t[0]];
    return dot(cross(positions[t[1]] - a, positions[t[2]] - a), positions[t[3]] - a) < 0;
  };
  parallel_ranges(std::ssize(tets), 4096, [&](std::int64_t first, std::int64_t last) {
    bool any = false;
    for (std::int64_t t = first; t < last; ++t) any |= is_inverted(tets[t].vertices);
    if (any) inverted = true;
  });
  has_inverted = inverted;
  skipped.clear();
  if (has_inverted) {
    skipped.assign(tets.size(), 0);
    for (const PeerFace& f : faces) skipped[f.owner >> 2] = is_inverted(tets[f.owner >> 2].vertices);
  }
  float squared_edge = 0, largest = 0;
  for (const PeerFace& f : faces) {
    const Float3 a = positions[f.vertices[0]], e = positions[f.vertices[1]] - a;
    squared_edge += dot(e, e) / static_cast<float>(faces.size());
    largest = std::max({largest, std::abs(a.x), std::abs(a.y), std::abs(a.z)});
  }
  rounding = 4 * std::numeric_limits<float>::epsilon() * largest;
  face_tolerance = std::sqrt(squared_edge) * rounding;
}

EmbreePeer::EmbreePeer(const TetMesh& mesh, std::span<const Vec3> positions, PeerSettings settings)
    : state_(std::make_unique<State>(mesh, settings)) {
  rebuild(positions);
}

EmbreePeer::~EmbreePeer() = default;

void EmbreePeer::rebuild(std::span<const Vec3> positions) {
  state_->take_pose(positions);
  state_->face_scene.build();
  state_->tet_scene.build();
}

void EmbreePeer::refit(std::span<const Vec3> positions) {
  state_->take_pose(positions);
  state_->face_scene.refit();
  state_->tet_scene.refit();
}

/// The elements that hold one vertex.
struct EmbreePeer::State::Containment {
  const State& state;
  Index vertex;
  std::vector<PathQuery<3>>& found;

  static bool visit(RTCPointQueryFunctionArguments* arguments) {
    static_cast<const Containment*>(arguments->userPtr)->test(static_cast<Index>(arguments->primID));
    return false;
  }

  void test(Index t) const {
    const auto& v = state.tets[t].vertices;
    if (v[0] == vertex || v[1] == vertex || v[2] == vertex || v[3] == vertex) return;
    const Float3* x = state.positions.data();
    const Float3 p = x[vertex];
    if (!surrounds_origin(x[v[0]] - p, x[v[1]] - p, x[v[2]] - p, x[v[3]] - p)) return;
    if (!state.skipped.empty() && state.skipped[t]) return;
    found.push_back({Vec3(p.x, p.y, p.z), t, {vertex, kNone}});
  }
};

std::vector<PathQuery<3>> EmbreePeer::find_penetrating_vertices() const {
  constexpr std::int64_t kVerticesAtOnce = 256;
  const auto vertices = state_->mesh.boundary_vertices();
  std::vector<std::vector<PathQuery<3>>> pieces((std::ssize(vertices) + kVerticesAtOnce - 1) / kVerticesAtOnce);
  parallel_for(std::ssize(pieces), 1, [&](std::int64_t k) {
    const auto share = vertices.subspan(k * kVerticesAtOnce);
    for (Index v : share.first(std::min<std::size_t>(share.size(), kVerticesAtOnce))) {
      State::Containment containment{*state_, v, pieces[k]};
      state_->tet_scene.visit_near(state_->positions[v], 0, &State::Containment::visit, &containment);
    }
  });
  std::vector<PathQuery<3>> all;
  for (const auto& piece : pieces) all.insert(all.end(), piece.begin(), piece.end());
  return all;
}

/// One query (SPB supplement, algorithms 3 and 4); its radius shrinks with every path found.
template <bool Counting>
struct EmbreePeer::State::Search {
  const State& state;
  Float3 p;
  Index target;
  std::array<Index, 2> source;
  bool cull;
  WalkMesh mesh;
  float best_squared = std::numeric_limits<float>::infinity();
  Index best_face = kNone;
  Float3 best_point{};
  PeerCounters counters{};

  static bool visit(RTCPointQueryFunctionArguments* arguments) {
    auto& search = *static_cast<Search*>(arguments->userPtr);
    if (!search.test(static_cast<Index>(arguments->primID))) return false;
    arguments->query->radius = std::sqrt(search.best_squared);
    return true;
  }

  bool test(Index f) {
    if constexpr (Counting) ++counters.faces_visited;
    const PeerFace& face = state.faces[f];
    const auto& v = face.vertices;
    if (is_source(v)) return false;
    const Float3* x = mesh.positions;
    const TrianglePoint s = closest_point(p, x[v[0]], x[v[1]], x[v[2]]);
    const Float3 out = p - s.point;
    const float squared = dot(out, out);
    if (!(squared < best_squared)) return false;
    if (cull && is_infeasible(f, v, s, out)) {
      if constexpr (Counting) ++counters.culled;
      return false;
    }
    if (!is_path(face, s.point, squared)) return false;
    best_squared = squared;
    best_face = f;
    best_point = s.point;
    return true;
  }

  bool is_source(const std::array<Index, 3>& v) const {
    const auto has = [&](Index s) { return v[0] == s || v[1] == s || v[2] == s; };
    return source[0] != kNone && has(source[0]) && (source[1] == kNone || has(source[1]));
  }

  /// Section 3.6. Inequalities 2 to 4 and that of the face itself hold because s is its closest point; in the plane
  /// across the edge, (p - s) times the way to the neighbour's third vertex has the sign of inequality 5.
  bool is_infeasible(Index f, const std::array<Index, 3>& v, const TrianglePoint& s, const Float3& out) const {
    if (s.mask == 0b111) return false;
    const Float3* x = mesh.positions;
    if (s.mask == 0b110 || s.mask == 0b101 || s.mask == 0b011) {
      const int opposite = s.mask == 0b110 ? 0 : s.mask == 0b101 ? 1 : 2;
      const Index a = v[(opposite + 1) % 3], b = v[(opposite + 2) % 3];
      const auto& n = state.faces[state.mesh.boundary_neighbours()[f][opposite]].vertices;
      const Index third = n[0] != a && n[0] != b ? n[0] : n[1] != a && n[1] != b ? n[1] : n[2];
      return leans_towards(out, x[third] - s.point, state.rounding);
    }
    const Index corner = v[s.mask >> 1];
    for (Index i = state.ring_first[corner]; i < state.ring_first[corner + 1]; ++i)
      if (leans_towards(out, x[state.ring[i]] - s.point, state.rounding)) return true;
    return false;
  }

  bool is_path(const PeerFace& face, const Float3& s, float squared) {
    if constexpr (Counting) ++counters.traversals, ++counters.elements_visited;
    if (face.owner >> 2 == target) return true;
    if (squared == 0) return false;
    const TetTraversal walk(mesh, s, p);
    const auto& v = face.vertices;
    const Entry entry{face.owner, {walk.project(v[0]), walk.project(v[1]), walk.project(v[2])}};
    FixedStorage fixed;
    WalkEnd end = walk.follow(entry, target, fixed);
    if constexpr (Counting) counters.elements_visited += fixed.steps() - (end != WalkEnd::kReached);
    if (end == WalkEnd::kOutOfStorage) {
      GrowingStorage growing;
      end = walk.follow(entry, target, growing);
      if constexpr (Counting) ++counters.growing_walks, counters.elements_visited += growing.steps();
    }
    return end == WalkEnd::kReached;
  }
};

template <bool Counting>
PeerPath EmbreePeer::State::find_path(const PathQuery<3>& query, bool cull, PeerCounters& counters) const {
  Search<Counting> search{*this, to_float(query.point), query.element, query.source, cull, walk_mesh()};
  face_scene.visit_near(search.p, std::numeric_limits<float>::infinity(), &Search<Counting>::visit, &search);
  if constexpr (Counting) counters = search.counters;
  if (search.best_face == kNone) return {};
  return {search.best_face,
          std::sqrt(search.best_squared),
          {search.best_point.x, search.best_point.y, search.best_point.z}};
}

std::vector<PeerPath> EmbreePeer::find_paths(std::span<const PathQuery<3>> queries, bool cull,
                                             PeerCounters* counters) const {
  std::vector<PeerPath> paths(queries.size());
  std::vector<PeerCounters> counts(counters ? queries.size() : 1);
  parallel_for(std::ssize(queries), 64, [&](std::int64_t i) {
    paths[i] = counters ? state_->find_path<true>(queries[i], cull, counts[i])
                        : state_->find_path<false>(queries[i], cull, counts[0]);
  });
  if (counters)
    for (const PeerCounters& c : counts) *counters += c;
  return paths;
}

PeerCounters& PeerCounters::operator+=(const PeerCounters& other) {
  faces_visited += other.faces_visited;
  culled += other.culled;
  traversals += other.traversals;
  elements_visited += other.elements_visited;
  growing_walks += other.growing_walks;
  return *this;
}

}  // namespace selvage::bench
