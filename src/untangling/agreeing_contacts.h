#pragma once

#include "selvage/contact/contact.h"
#include "selvage/mesh/simplex_mesh.h"

namespace selvage {

/// Contacts that push one way.
struct AgreeingContacts {
  std::vector<Contact> contacts;
  std::int64_t drawn_vertices = 0;  ///< of all ends that still have to be drawn through a crossing
};

/// Of the contacts of a tangled mesh, those that push the way most of their crossing do; in the order given.
///
/// Where two parts of a mesh run through one another, points before the middle are sent out at the front and those
/// behind it at the back. These cancel, and neither part moves. A crossing is a pair of regions, each a connected set
/// of vertices that have contacts; its way is the line along which its contacts push most, to the side where more of
/// them push. What a region has with itself stays: it has no sides.
///
/// Where a limb runs right through something thin, as many push it on as back, and it has far to go either way. There
/// its shorter end is drawn through: it has become shorter by the next time, so that the side stays the same.
///
/// @param positions  (n_vertices x 3) [m]
/// @param contacts   those held from before, then those of points that are inside now
/// @param first_now  the first of these
AgreeingContacts find_agreeing_contacts(const TetMesh& mesh, std::span<const Vec3> positions,
                                        std::span<const Contact> contacts, std::size_t first_now);

}  // namespace selvage
