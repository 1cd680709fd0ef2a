#include "contact/input/contact_weights.h"

#include <algorithm>

namespace selvage {

Vec3 offset_of(const Contact& contact, std::span<const Vec3> positions) {
  return weighted_sum(contact, [&](Index v) { return positions[static_cast<std::size_t>(v)]; });
}

double gap_of(const Contact& contact, std::span<const Vec3> positions) {
  return contact.normal.dot(offset_of(contact, positions));
}

void add_weight(Contact& contact, Index vertex, double weight) {
  if (weight == 0) return;
  const auto end = contact.vertices.begin() + contact.count;
  const auto place = std::find(contact.vertices.begin(), end, vertex);
  const auto i = place - contact.vertices.begin();
  if (place == end) contact.vertices[contact.count++] = vertex;
  contact.weights[i] += weight;
}

void remove_zero_weights(Contact& contact) {
  int kept = 0;
  for (int i = 0; i < contact.count; ++i) {
    if (contact.weights[i] == 0) continue;
    contact.vertices[kept] = contact.vertices[i];
    contact.weights[kept] = contact.weights[i];
    ++kept;
  }
  contact.count = static_cast<std::uint8_t>(kept);
}

}  // namespace selvage
