#include "simulation/time_step/tangle_energy.h"

#include "core/union_find.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace selvage {

namespace {

bool is_way_out(const Contact& contact) {
  return contact.kind == ContactKind::kVertexPath || contact.kind == ContactKind::kEdgePath ||
         contact.kind == ContactKind::kCentroidPath;
}

/// Of the free vertices of bodies that are linked.
struct Tangle {
  double mass = 0, before = 0, after = 0;  ///< [kg], twice the kinetic energy [J]
  Vec3 momentum = Vec3::Zero();            ///< after [kg m/s]
};

}  // namespace

void limit_tangle_energy(const Model& model, std::span<const Contact> contacts, std::span<const StepVertex> vertices,
                         std::span<const Index> body_of, std::span<const Vec3> before, double speed,
                         std::span<Vec3> velocities) {
  UnionFind linked(model.bodies.size());
  std::vector<std::uint8_t> is_tangled(model.bodies.size(), 0);
  for (const Contact& contact : contacts) {
    if (!is_way_out(contact)) continue;
    const auto at = std::span(contact.vertices).first(contact.count);
    const auto is_of_body = [&](Index v) { return v < std::ssize(body_of) && body_of[v] != kNone; };
    if (!std::ranges::all_of(at, is_of_body)) continue;
    for (const Index v : at) {
      linked.join(body_of[at[0]], body_of[v]);
      is_tangled[body_of[v]] = 1;
    }
  }
  std::vector<Tangle> tangles(model.bodies.size());
  const auto visit = [&](auto&& act) {
    for (Index b = 0; b < std::ssize(model.bodies); ++b) {
      if (is_tangled[b] == 0) continue;
      const Body& body = model.bodies[b];
      Tangle& tangle = tangles[linked.lowest(b)];
      for (Index v = body.first_vertex; v < body.first_vertex + body.vertex_count; ++v)
        if (vertices[v].inverse_mass > 0) act(tangle, v);
    }
  };
  visit([&](Tangle& tangle, Index v) {
    const double mass = 1 / vertices[v].inverse_mass;
    tangle.mass += mass;
    tangle.before += mass * before[v].squaredNorm();
    tangle.after += mass * velocities[v].squaredNorm();
    tangle.momentum += mass * velocities[v];
  });
  visit([&](const Tangle& tangle, Index v) {
    const Vec3 common = tangle.momentum / tangle.mass;
    const double of_common = tangle.mass * common.squaredNorm();
    const double most = std::max(tangle.before - of_common, tangle.mass * speed * speed);
    const double relative = tangle.after - of_common;
    if (relative > most) velocities[v] = common + std::sqrt(most / relative) * (velocities[v] - common);
  });
}

}  // namespace selvage
