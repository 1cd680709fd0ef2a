// Reads materials: of solids, and of cloth.
#include "scene/description/scene_description.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

namespace selvage {

namespace {

/// Lame's constants from compliances, as Young's modulus and Poisson's ratio.
void set_by_compliance(double hydrostatic, double deviatoric, Material& material) {
  const double lambda = 1 / hydrostatic, mu = 1 / deviatoric;
  material.youngs_modulus = mu * (3 * lambda + 2 * mu) / (lambda + mu);
  material.poisson_ratio = lambda / (2 * (lambda + mu));
}

void read_neo_hookean(JsonObject& object, Material& material) {
  const auto modulus = object.find("youngs_modulus"), ratio = object.find("poisson_ratio");
  const auto hydrostatic = object.find("hydrostatic_compliance"), deviatoric = object.find("deviatoric_compliance");
  if ((modulus || ratio) && (hydrostatic || deviatoric))
    object.value().fail("gives both moduli and compliances", "give one pair");
  if (hydrostatic.has_value() != deviatoric.has_value())
    object.value().fail("gives one compliance of two", "give hydrostatic_compliance and deviatoric_compliance");
  if (modulus) material.youngs_modulus = modulus->number(kPositive);
  if (ratio) material.poisson_ratio = ratio->number({0, 0.499});
  if (!hydrostatic) return;
  set_by_compliance(hydrostatic->number(kPositive), deviatoric->number(kPositive), material);
  if (!std::isfinite(material.youngs_modulus) || !(material.youngs_modulus > 0) || !(material.poisson_ratio < 0.5))
    object.value().fail("has compliances that are too small or too different",
                        "give such that Young's modulus is finite and Poisson's ratio below 0.5");
}

void read_cloth(JsonObject& object, ClothMaterial& cloth) {
  const auto warp = object.find("warp"), weft = object.find("weft"), shear = object.find("shear");
  const auto stiffness = object.find("stiffness"), ratio = object.find("poisson_ratio");
  const auto direction = object.find("warp_direction");
  const bool is_woven = warp || weft || shear || direction;
  if (is_woven && (stiffness || ratio))
    object.value().fail("gives both a stiffness and those of warp, weft and shear", "give one of both");
  if (is_woven && !(warp && weft && shear))
    object.value().fail("does not give all of warp, weft and shear", "give all three, or stiffness");
  if (is_woven) {
    cloth.kind = ClothKind::kWoven;
    cloth.warp = warp->number(kPositive);
    cloth.weft = weft->number(kPositive);
    cloth.shear = shear->number(kPositive);
  }
  if (direction) cloth.warp_direction = direction->direction();
  if (stiffness) cloth.stiffness = stiffness->number(kPositive);
  if (ratio) cloth.poisson_ratio = ratio->number({0, 0.5});
  if (const auto v = object.find("density")) cloth.density = v->number(kPositive);
  if (const auto v = object.find("bending")) cloth.bending = v->number(kNotNegative);
  if (const auto v = object.find("thickness")) cloth.thickness = v->number(kNotNegative);
  if (const auto v = object.find("damping")) cloth.damping = v->number(kNotNegative);
  if (const auto v = object.find("bending_damping")) cloth.bending_damping = v->number(kNotNegative);
}

}  // namespace

BodyMaterial read_material(const JsonValue& value) {
  JsonObject object(value);
  BodyMaterial read(BodyMaterial::Kind::kSolid);
  Material& material = read.solid;
  constexpr std::array<std::string_view, 3> kKinds{"neo-hookean", "mass-spring", "cloth"};
  std::size_t kind = 0;
  if (const auto v = object.find("kind")) kind = v->choice(kKinds);
  if (kind == 2) {
    read.kind = BodyMaterial::Kind::kCloth;
    read_cloth(object, read.cloth);
    object.refuse_others();
    return read;
  }
  material.kind = kind == 0 ? MaterialKind::kNeoHookean : MaterialKind::kMassSpring;
  if (const auto v = object.find("density")) material.density = v->number(kPositive);
  if (const auto v = object.find("damping")) material.damping = v->number(kNotNegative);
  if (material.kind == MaterialKind::kNeoHookean) {
    read_neo_hookean(object, material);
  } else {
    if (const auto v = object.find("edge_compliance")) material.edge_compliance = v->number(kNotNegative);
    if (const auto v = object.find("volume_compliance")) material.volume_compliance = v->number(kNotNegative);
  }
  object.refuse_others();
  return read;
}

BodyMaterial find_material(const JsonValue& value, const std::map<std::string, BodyMaterial>& named) {
  if (!value.json().is_string()) return read_material(value);
  const auto found = named.find(value.text());
  if (found != named.end()) return found->second;
  std::vector<std::string> names;
  names.reserve(named.size());
  for (const auto& [name, ignored] : named)
    names.push_back(Json(name).dump(-1, ' ', true, Json::error_handler_t::replace));
  value.fail("there is no material of that name",
             names.empty() ? "list it in 'materials'" : fmt::format("use one of {}", fmt::join(names, ", ")));
}

}  // namespace selvage
