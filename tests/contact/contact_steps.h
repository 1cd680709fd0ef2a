#pragma once

#include "selvage/contact/contact_finder.h"

#include <span>
#include <vector>

namespace selvage::test {

/// Contacts of one step of a finder, from t0 to t1.
inline std::vector<Contact> contacts_of_step(ContactFinder& finder, std::span<const Vec3> t0,
                                             std::span<const Vec3> t1) {
  std::vector<Contact> contacts;
  finder.begin_step(t0);
  finder.find_contacts(t1, contacts);
  return contacts;
}

/// Default options but for the mode.
inline ContactOptions in_mode(DetectionMode mode) {
  ContactOptions options;
  options.mode = mode;
  return options;
}

}  // namespace selvage::test
