#pragma once

#include "selvage/contact/contact.h"

namespace selvage {

/// offset_of(), for the inner loops of solvers.
///
/// @param position_of  `position_of(v)`: a vector, the position of vertex v
template <typename PositionOf>
Vec3 weighted_sum(const Contact& contact, PositionOf&& position_of) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < contact.count; ++i) sum += contact.weights[i] * position_of(contact.vertices[i]);
  return sum;
}

/// Adds a weight to a contact: to that of the same vertex where it is listed already.
void add_weight(Contact& contact, Index vertex, double weight);

/// Removes vertices that the point and the surface have in common with the same weight.
void remove_zero_weights(Contact& contact);

}  // namespace selvage
