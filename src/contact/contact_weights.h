#pragma once

#include "selvage/contact/contact.h"

namespace selvage {

/// Adds a weight to a contact: to that of the same vertex where it is listed already.
void add_weight(Contact& contact, Index vertex, double weight);

/// Removes vertices that the point and the surface have in common with the same weight.
void remove_zero_weights(Contact& contact);

}  // namespace selvage
