#pragma once

#include "selvage/core/types.h"

#include <optional>
#include <string_view>

namespace selvage {

enum class ClothKind : std::uint8_t {
  kIsotropic,  ///< the same in all directions: a Neo-Hookean sheet
  kWoven,      ///< warp, weft and shear each of their own (Baraff and Witkin 1998)
};

/// The material of a body of triangles.
///
/// All stiffnesses are of the sheet, not of what it is made of: a Young's modulus times a thickness. Folds cost what
/// the bending stiffness says, however thick the sheet is.
struct ClothMaterial {
  ClothKind kind = ClothKind::kIsotropic;
  double density = 0.2;                          ///< [kg/m^2], positive
  double stiffness = 1000;                       ///< isotropic: against stretching [N/m], positive
  double poisson_ratio = 0.3;                    ///< isotropic, in [0, 0.5]
  double warp = 1000, weft = 1000, shear = 300;  ///< woven [N/m], positive
  Vec3 warp_direction = Vec3::UnitX();           ///< woven: at rest, laid into each triangle; of any length but 0
  double bending = 1e-5;                         ///< [J], 0: as limp as can be
  double thickness = 0;  ///< contacts hold sheets so far apart, and all else half as far from them [m]
  double damping = 0;    ///< as Material::damping [s]
  std::optional<double> bending_damping{};  ///< of bends; none: as damping [s]
};

/// @throws Error  when a number of the material is out of its range or not finite; it names `where` and the number
void check_material(std::string_view where, const ClothMaterial& material);

}  // namespace selvage
