#include "simulation/agreeing_contacts.h"

#include <Eigen/Eigenvalues>

#include <map>

namespace selvage {

namespace {

/// Connected sets of vertices that have contacts, each named by its smallest.
class Regions {
 public:
  Regions(const TetMesh& mesh, std::span<const Contact> contacts) : parents_(mesh.vertex_count(), kNone) {
    for (const Contact& contact : contacts)
      for (int i = 0; i < contact.count; ++i) parents_[contact.vertices[i]] = contact.vertices[i];
    for (const auto& element : mesh.elements())
      for (int a = 1; a < 4; ++a)
        for (int b = 0; b < a; ++b) join(element[a], element[b]);
  }

  Index find(Index vertex) {
    while (parents_[vertex] != vertex) vertex = parents_[vertex] = parents_[parents_[vertex]];
    return vertex;
  }

 private:
  void join(Index a, Index b) {
    if (parents_[a] < 0 || parents_[b] < 0) return;
    const auto [low, high] = std::minmax({find(a), find(b)});
    parents_[high] = low;
  }

  std::vector<Index> parents_;
};

/// The regions of a contact's point and of its surface.
std::pair<Index, Index> sides_of(const Contact& contact, Regions& regions) {
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
  Regions regions(mesh, contacts);
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
