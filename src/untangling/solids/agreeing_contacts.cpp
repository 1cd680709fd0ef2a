#include "untangling/solids/agreeing_contacts.h"

#include "mesh/limb_ends.h"
#include "mesh/vertex_regions.h"

#include <Eigen/Eigenvalues>

#include <cmath>
#include <map>

namespace selvage {

namespace {

/// Majority that decides the side of a crossing: the part of its contacts by which more push to one side.
constexpr double kMajority = 0.5;
/// Cosine of the angle up to which an end's way is along the line on which its crossing pushes.
constexpr double kAlong = 0.5;

/// Ways in which the lower region of a crossing is pushed out of the other.
struct Crossing {
  Vec3 sum = Vec3::Zero();
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  std::int64_t count = 0;

  void add(const Vec3& way) {
    sum += way;
    products += way * way.transpose();
    ++count;
  }

  Vec3 main_way() const {
    const Vec3 line = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(products).eigenvectors().col(2);
    return line.dot(sum) < 0 ? Vec3(-line) : line;
  }

  bool is_undecided(const Vec3& way) const { return way.dot(sum) < kMajority * static_cast<double>(count); }
};

class ContactSorter {
 public:
  ContactSorter(const TetMesh& mesh, std::span<const Contact> contacts)
      : mesh_(mesh), contacts_(contacts), regions_(mesh, vertices_of(contacts)) {}

  AgreeingContacts sort(std::span<const Vec3> positions, std::size_t first_now) {
    for (const Contact& contact : contacts_) {
      const auto [point, surface] = sides_of(contact);
      if (point != surface) crossings_[std::minmax(point, surface)].add(way_of(contact));
    }
    std::vector<Sides> undecided;
    for (const auto& [sides, crossing] : crossings_) {
      const Vec3 way = ways_[sides] = crossing.main_way();
      if (crossing.is_undecided(way)) undecided.push_back(sides);
    }
    AgreeingContacts agreeing;
    if (!undecided.empty()) {
      const std::map<Index, LimbEnd> ends = find_limb_ends(mesh_, positions, list_regions(first_now));
      for (const Sides& sides : undecided) agreeing.drawn_vertices += draw_shorter_end(sides, ends);
    }
    for (const Contact& contact : contacts_) {
      const auto [point, surface] = sides_of(contact);
      if (point == surface || way_of(contact).dot(ways_[std::minmax(point, surface)]) >= 0)
        agreeing.contacts.push_back(contact);
    }
    return agreeing;
  }

 private:
  using Sides = std::pair<Index, Index>;

  static std::vector<Index> vertices_of(std::span<const Contact> contacts) {
    std::vector<Index> vertices;
    for (const Contact& contact : contacts)
      vertices.insert(vertices.end(), contact.vertices.begin(), contact.vertices.begin() + contact.count);
    return vertices;
  }

  /// The regions of a contact's point and of its surface.
  Sides sides_of(const Contact& contact) {
    return {regions_.find(contact.vertices.front()), regions_.find(contact.vertices[contact.count - 1])};
  }

  /// Of the lower region.
  Vec3 way_of(const Contact& contact) {
    const auto [point, surface] = sides_of(contact);
    return point < surface ? contact.normal : Vec3(-contact.normal);
  }

  /// Regions of points that are inside now. With points that have come out they would grow over the ends.
  std::vector<Index> list_regions(std::size_t first_now) {
    std::vector<Index> regions(mesh_.vertex_count(), kNone);
    for (const Index v : vertices_of(contacts_.subspan(first_now))) regions[v] = regions_.find(v);
    return regions;
  }

  /// @return the number of its vertices; 0 where no end is along that way
  std::int64_t draw_shorter_end(const Sides& sides, const std::map<Index, LimbEnd>& ends) {
    Vec3& way = ways_[sides];
    LimbEnd shorter;
    for (const Index region : {sides.first, sides.second}) {
      const auto found = ends.find(region);
      if (found == ends.end()) continue;
      LimbEnd end = found->second;
      if (region == sides.second) end.way = -end.way;
      if (!(std::abs(end.way.dot(way)) > kAlong)) continue;
      if (shorter.vertices == 0 || end.vertices < shorter.vertices) shorter = end;
    }
    if (shorter.way.dot(way) < 0) way = -way;
    return shorter.vertices;
  }

  const TetMesh& mesh_;
  const std::span<const Contact> contacts_;
  VertexRegions regions_;
  std::map<Sides, Crossing> crossings_;
  std::map<Sides, Vec3> ways_;
};

}  // namespace

AgreeingContacts find_agreeing_contacts(const TetMesh& mesh, std::span<const Vec3> positions,
                                        std::span<const Contact> contacts, std::size_t first_now) {
  return ContactSorter(mesh, contacts).sort(positions, first_now);
}

}  // namespace selvage
