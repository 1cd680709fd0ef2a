#pragma once

#include "selvage/contact/contact.h"
#include "selvage/mesh/simplex_mesh.h"

namespace selvage {

/// Of the contacts of a tangled mesh, those that push the way most of their crossing do; in the order given.
///
/// Where two parts of a mesh run through one another, points before the middle are sent out at the front and those
/// behind it at the back. These cancel, and neither part moves. A crossing is a pair of regions, each a connected set
/// of vertices that have contacts; its way is the line along which its contacts push most, to the side where more of
/// them push. What a region has with itself stays: it has no sides.
std::vector<Contact> find_agreeing_contacts(const TetMesh& mesh, std::span<const Contact> contacts);

}  // namespace selvage
