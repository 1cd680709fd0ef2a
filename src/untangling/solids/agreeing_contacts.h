#pragma once

#include "selvage/contact/contact.h"
#include "selvage/mesh/simplex_mesh.h"

namespace selvage {

/// Contacts of which those of one crossing push one way.
struct AgreeingContacts {
  std::vector<Contact> contacts;
  std::int64_t drawn_vertices = 0;  ///< of all ends that still have to be drawn through a crossing
};

/// Of the contacts of a tangled mesh, those that push the way of their crossing; in the order given.
///
/// Where two parts of a mesh run through one another, points before the middle are sent out at the front and those
/// behind it at the back. Their pushes cancel, and neither part moves. A crossing is a pair of regions, each a
/// connected set of vertices of contacts. Its way is the line along which its contacts push most, to the side of their
/// majority. All contacts of a region with itself stay: it has no sides.
///
/// Where a limb runs right through a thin part, as many contacts push it on as back, and both ways are long. Then its
/// shorter end is drawn through. In the next iteration that end is shorter still, so that the side stays the same.
///
/// @param positions  (n_vertices x 3) [m]
/// @param contacts   those held from earlier iterations, then those of points that are inside now
/// @param first_now  place of the first of points inside now
AgreeingContacts find_agreeing_contacts(const TetMesh& mesh, std::span<const Vec3> positions,
                                        std::span<const Contact> contacts, std::size_t first_now);

}  // namespace selvage
