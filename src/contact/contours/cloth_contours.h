#pragma once

#include "selvage/contact/contact.h"
#include "selvage/mesh/triangle_mesh.h"
#include "selvage/self_collision/self_collision.h"

namespace selvage {

/// An edge through a face with which it shares no vertex.
struct ContourHit {
  Index edge = kNone, face = kNone;
  double place = 0;                     ///< along the edge, from its first vertex
  std::array<double, 3> barycentric{};  ///< in the face
  Index contour = kNone;                ///< that it is on
  int side = 0;                    ///< of the contour on which the edge is: 0 or 1; -1: the contour has no two sides
  Vec3 shortening = Vec3::Zero();  ///< moving the edge by this, and the face against it, shortens the contour [1]
};

/// Curves along which faces cross one another: hits that triangles have in common are on one. A hit is where the
/// contour passes from a triangle of the edge to the next.
struct Contours {
  std::vector<ContourHit> hits;
  Index count = 0;
};

/// @param crossings  pairs of triangles that meet, each once
/// @param first_face, last_face  of those triangles that count; pairs with another are left out
///
/// What meets without crossing (touching, in one plane) has no hit. Directions are those of Volino and
/// Magnenat-Thalmann: half the derivative of the contour's length, taken the other way. Hits are in the order of
/// (edge, face). O(n log n) of the crossings.
/// Source: Volino and Magnenat-Thalmann 2006, Resolving surface collisions through intersection contour minimization.
Contours find_contours(const TriangleMesh& surface, std::span<const Vec3> positions,
                       std::span<const TrianglePair> crossings, Index first_face, Index last_face);

/// One contact a hit, of kind kContour, which pulls the two sides of a contour past one another, all of a contour the
/// same way: by the sum over its hits. A contour without two sides, or one whose sum is next to nothing though its
/// hits' directions are not, is pulled hit by hit. A twentieth of the edge in a step.
void append_contour_contacts(const TriangleMesh& surface, std::span<const Vec3> positions, const Contours& contours,
                             std::vector<Contact>& contacts);

}  // namespace selvage
