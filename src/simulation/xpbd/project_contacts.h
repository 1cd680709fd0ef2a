#pragma once

#include "selvage/contact/contact.h"
#include "selvage/contact/friction.h"
#include "simulation/colliders/prepared_collider.h"
#include "simulation/xpbd/material_blocks.h"

#include <algorithm>

namespace selvage {

/// Part of a reach by which what meets a surface is kept in front of it.
inline constexpr double kContactGap = 0.01;

/// A step, and where vertices were at its start, and how fast.
struct Step {
  std::int64_t number;                          ///< this step's alone, from 0
  double from, to;                              ///< [s]
  std::span<const Vec3> positions, velocities;  ///< (n_vertices) [m], [m/s]

  double length() const { return to - from; }
};

/// Moves vertices out of every contact, one after the other in the order given, and holds back what slides.
///
/// What meets a surface stays in front of it, by as much as it was and kContactGap at most, which gives it no speed:
/// set on the surface itself, rounding and other contacts would leave half of it inside, for the next step to look for
/// its way out.
///
/// What is sent out of a body goes at most so far at a time as the least reach of the vertices concerned: where
/// elements are inside out, the way that is found for a point can be a long detour, and all the way at once would turn
/// its own elements inside out, and theirs in turn others.
///
/// @param reaches  (n_vertices) [m]
/// @param grips    (n_contacts) of this step; updated
/// @param sent     (n_vertices) how far contacts have sent vertices out of bodies in this step [m]; updated
void project_contacts(std::span<const Contact> contacts, const Step& step, std::span<const double> reaches,
                      const Friction& friction, std::span<FrictionState> grips, std::span<Vec3> sent,
                      std::span<VertexRow> vertices);

/// For each vertex a part of its shortest edge [m]; 0 without an element.
std::vector<double> reaches_of(const Model& model);

/// How far points are pushed out of surfaces.
struct Push {
  double clearance;  ///< to be in front of the surface [m]
  double at_most;    ///< in one projection [m]
};

/// Moves vertices out of every contact, one after the other in the order given, without friction.
void push_apart(std::span<const Contact> contacts, const Push& push, std::span<VertexRow> vertices);

/// What a collider has done to a vertex in the step in which it last did something. Hardly any vertex meets any, so
/// that nothing goes through all of these to clear them.
struct ColliderGrip {
  FrictionState grip;
  Vec3 way_out = Vec3::Zero();  ///< unit normal there, where the vertex started the step inside
  double buried = 0;            ///< how deep it did [m]
  std::int64_t step = -1;       ///< see project_colliders()

  /// The part of what it was pushed that only undoes where it started.
  Vec3 lift() const { return std::min(buried, grip.normal_sum) * way_out; }
};

/// What colliders did, by vertices and colliders.
struct ColliderContacts {
  std::int64_t count = 0;   ///< vertices pushed out
  std::int64_t buried = 0;  ///< of these, first pushed in this step, and inside at its start: see lift()

  void add(const ColliderContacts& other) {
    count += other.count;
    buried += other.buried;
  }
};

/// Moves vertices out of colliders, which move during the step, to the side that they come from: see
/// find_hit_on_way(). Friction holds none inside another collider, nor inside a body. Parallel.
///
/// @param reaches  (n_vertices) [m]: what starts the step inside by less than kContactGap of them lies on the surface;
///                 empty where what starts inside is no matter
/// @param sent     (n_vertices) what project_contacts() says
/// @param grips    (n_vertices x n_colliders); updated
ColliderContacts project_colliders(std::span<const PreparedCollider> colliders, const Step& step,
                                   std::span<const double> reaches, std::span<const Vec3> sent,
                                   std::span<ColliderGrip> grips, std::span<VertexRow> vertices);

}  // namespace selvage
