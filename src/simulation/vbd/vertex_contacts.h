#pragma once

#include "simulation/implicit/incremental_potential.h"
#include "simulation/vbd/vertex_colours.h"

namespace selvage {

/// Springs and contacts of each of some vertices, for steps in which all of a colour move: a term that has several
/// vertices of one colour counts as much stiffer as makes all their steps together lower it,
/// (sum w_i d_i)^2 <= sum |w_i| (sum |w_j|) d_i^2.
class VertexContacts {
 public:
  /// @param colours  must outlive this
  explicit VertexContacts(const VertexColours& colours) : colours_(colours) {}

  /// Takes over the terms of a potential, which must outlive their use. O(n + terms).
  void renew(const IncrementalPotential& potential);

  /// A term of a vertex, at some pose.
  struct Placed {
    const OffsetTerm* term;
    Vec3 offset;
    double gap;    ///< of a contact, to where it is to be; what it misses is negative [m]
    double scale;  ///< the offset changes by so much of the vertex's move
    double share;  ///< of the energy that counts
  };
  bool is_empty(Index i) const { return first_[i] == first_[i + 1]; }
  /// Adds the derivatives by the vertex at a place of the order of colours, and gives its terms where they are.
  void add(std::span<const Vec3> x, Index i, VertexDerivatives& sum, std::vector<Placed>& placed) const;

  /// Energies with the vertex moved on. Of a term that has several vertices of one colour the share of the vertex: as
  /// energies of contacts are convex, what these say of all their moves one by one is at least what the term has after
  /// all of them.
  static double energy(std::span<const Placed> placed, const Vec3& move);

 private:
  struct Item {
    Index term;
    double weight, share;
  };

  const VertexColours& colours_;
  std::span<const OffsetTerm> terms_;
  std::vector<std::int64_t> first_;
  std::vector<Item> items_;
};

}  // namespace selvage
