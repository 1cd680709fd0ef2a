#pragma once

#include "boundary_path/families/families.h"
#include "boundary_path/oracle/oracle.h"

namespace selvage::families {

/// A query as the tests make it: the library's PathQuery without the library.
template <int D>
struct Query {
  Vec<D> point;
  Index element = 0;
  std::array<Index, 2> source{kNone, kNone};
};

/// Makes queries of every kind for one mesh: anywhere in elements and close to their corners; exactly on vertices,
/// edges, faces, centroids and the points of a fine lattice in an element (up to rounding where the mesh is not exact);
/// boundary vertices and midpoints of boundary edges in the elements that they penetrate.
template <int D>
class QueryMaker {
 public:
  explicit QueryMaker(const oracle::Oracle<D>& oracle);

  Query<D> make(Random& random) const;
  std::vector<Query<D>> make_many(std::int64_t count, std::uint64_t seed) const;

 private:
  Query<D> inside(Random& random, Index element) const;
  Query<D> lattice(Random& random, Index element) const;

  const oracle::Oracle<D>& oracle_;
  std::vector<Query<D>> penetrating_;
};

extern template class QueryMaker<2>;
extern template class QueryMaker<3>;

}  // namespace selvage::families
