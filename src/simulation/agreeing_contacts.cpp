#include "simulation/agreeing_contacts.h"

#include "simulation/vertex_regions.h"

#include <Eigen/Eigenvalues>

#include <map>

namespace selvage {

namespace {

/// The regions of a contact's point and of its surface.
std::pair<Index, Index> sides_of(const Contact& contact, VertexRegions& regions) {
  return {regions.find(contact.vertices.front()), regions.find(contact.vertices[contact.count - 1])};
}

/// Ways in which the lower region of a crossing is pushed out of the other.
struct Crossing {
  Vec3 sum = Vec3::Zero();
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();

  void add(const Vec3& way) {
    sum += way;
    products += way * way.transpose();
  }

  Vec3 main_way() const {
    const Vec3 line = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(products).eigenvectors().col(2);
    return line.dot(sum) < 0 ? Vec3(-line) : line;
  }
};

}  // namespace

std::vector<Contact> find_agreeing_contacts(const TetMesh& mesh, std::span<const Contact> contacts) {
  std::vector<Index> vertices;
  for (const Contact& contact : contacts)
    vertices.insert(vertices.end(), contact.vertices.begin(), contact.vertices.begin() + contact.count);
  VertexRegions regions(mesh, vertices);
  std::map<std::pair<Index, Index>, Crossing> crossings;
  const auto way_of = [](const Contact& contact, bool is_lower) {
    return is_lower ? contact.normal : Vec3(-contact.normal);
  };
  for (const Contact& contact : contacts) {
    const auto [point, surface] = sides_of(contact, regions);
    if (point != surface) crossings[std::minmax(point, surface)].add(way_of(contact, point < surface));
  }
  std::map<std::pair<Index, Index>, Vec3> ways;
  for (const auto& [sides, crossing] : crossings) ways[sides] = crossing.main_way();
  std::vector<Contact> agreeing;
  for (const Contact& contact : contacts) {
    const auto [point, surface] = sides_of(contact, regions);
    if (point == surface || way_of(contact, point < surface).dot(ways[std::minmax(point, surface)]) >= 0)
      agreeing.push_back(contact);
  }
  return agreeing;
}

}  // namespace selvage
