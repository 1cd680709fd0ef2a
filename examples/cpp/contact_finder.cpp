// Contacts of a step: a box falls onto another one, and the step would end with a part of it inside.
#include <selvage/contact/contact_finder.h>
#include <selvage/shapes/shapes.h>

#include <algorithm>
#include <array>
#include <cstdio>

using namespace selvage;

int main() {
  IndexedMesh upper = make_box({1, 1, 1}, 0.5);
  for (Vec3& p : upper.positions) p += Vec3(0.2, 0.3, 1.05);
  const std::array boxes{make_box({1, 1, 1}, 0.5), upper};
  const IndexedMesh all = concatenate(boxes);
  const TetMesh mesh(static_cast<Index>(all.positions.size()), all.tetrahedra);

  // One step: the upper box moves down by 0.1 m.
  std::vector<Vec3> after = all.positions;
  for (std::size_t v = boxes[0].positions.size(); v < after.size(); ++v) after[v] -= Vec3(0, 0, 0.1);

  ContactFinder finder(mesh, {}, all.positions);
  std::vector<Contact> contacts;
  finder.begin_step(all.positions);
  finder.find_contacts(after, contacts);

  // A contact is an inequality: its gap must not be negative.
  double deepest = 0;
  for (const Contact& contact : contacts) deepest = std::min(deepest, gap_of(contact, after));
  std::printf("contacts found: %s, deepest gap %.3f m\n", contacts.empty() ? "no" : "yes", deepest);

  // A solver moves the vertices of each contact along its normal, in proportion to their weights.
  for (const Contact& contact : contacts) {
    const double gap = gap_of(contact, after);
    if (gap >= 0) continue;
    double sum = 0;
    for (int i = 0; i < contact.count; ++i) sum += contact.weights[i] * contact.weights[i];
    for (int i = 0; i < contact.count; ++i)
      after[contact.vertices[i]] -= gap / sum * contact.weights[i] * contact.normal;
  }
  double left = 0;
  for (const Contact& contact : contacts) left = std::min(left, gap_of(contact, after));
  std::printf("shallower after one pass: %s\n", left > 0.9 * deepest ? "yes" : "no");
}

// Prints:
// contacts found: yes, deepest gap -0.050 m
// shallower after one pass: yes
