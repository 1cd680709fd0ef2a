#include "selvage/contact/friction.h"

namespace selvage {

Vec3 friction_correction(const Vec3& displacement, const Vec3& normal, double normal_correction, double static_friction,
                         double dynamic_friction) {
  const Vec3 tangential = displacement - normal.dot(displacement) * normal;
  const double length = tangential.norm();
  if (!(length > 0)) return Vec3::Zero();
  if (length <= static_friction * normal_correction) return -tangential;
  const double slip = dynamic_friction * normal_correction;
  return slip < length ? Vec3(-slip / length * tangential) : Vec3(-tangential);
}

}  // namespace selvage
