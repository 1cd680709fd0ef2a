#pragma once

#include "selvage/core/types.h"

#include <vector>

namespace selvage::oracle {

/// A boundary face as the oracle numbers them: by owner element, then by the face's number in it.
template <int D>
struct OracleFace {
  Index owner = kNone;
  VertexTuple<D> vertices{};
};

/// What the oracle says of a query.
struct OracleAnswer {
  bool in_element = false;  ///< the point lies in its element, which is not flat
  bool found = false;
  Index face = kNone;   ///< one of the faces at the smallest distance
  double distance = 0;  ///< correctly rounded up to a few units in the last place
};

/// A pair that vertex-element DCD must report.
struct OraclePair {
  Index vertex, element;
  friend auto operator<=>(const OraclePair&, const OraclePair&) = default;
};

/// Room that a thread reuses from query to query.
struct Workspace {
  std::vector<std::int64_t> stamp;  ///< per element: the last search that saw it
  std::int64_t search = 0;
  std::vector<Index> stack;
  std::vector<std::pair<double, Index>> order;
};

/// Shortest paths to the boundary by brute force, written apart from the library, on plain arrays.
///
/// Candidates are the closest points of all boundary faces; one is valid when the elements that the segment meets join
/// the query's element to the face's owner, two neighbours being joined when the segment meets their common closed
/// face. In a component with inverted or flat elements the segment is prolonged: it runs on the infinite line through s
/// and p, up to twice the distance from s on both sides, and faces of inverted and flat elements are no candidates.
///
/// Candidates: with `source` vertices all faces but those that have all of them; without, all faces but those that
/// hold the point exactly.
template <int D>
class Oracle {
 public:
  using Element = VertexTuple<D + 1>;

  Oracle(std::vector<Vec<D>> positions, std::vector<Element> elements);

  /// Decided in doubles with wide margins, in exact integers where a margin does not decide.
  OracleAnswer shortest_path(const Vec<D>& point, Index element, const std::array<Index, 2>& source,
                             Workspace& workspace) const;

  /// The same in rational arithmetic throughout, by another route; slow.
  OracleAnswer shortest_path_rational(const Vec<D>& point, Index element, const std::array<Index, 2>& source) const;

  /// Whether the path from the point to its closest point on boundary face `face` is valid; exact.
  bool is_valid(const Vec<D>& point, Index element, Index face, Workspace& workspace) const;

  /// Whether the validity of this path depends on how the closest point is rounded: it grazes something.
  bool is_grazing(const Vec<D>& point, Index element, Index face, Workspace& workspace) const;

  /// Whether all valid paths shorter than `distance` are grazing: an answer at that distance may then be due to the
  /// rounding of closest points, which the library is allowed.
  bool only_grazing_below(double distance, const Vec<D>& point, Index element, const std::array<Index, 2>& source,
                          Workspace& workspace) const;

  /// Distance of the point to boundary face `face`.
  double face_distance(const Vec<D>& point, Index face) const;

  /// Whether the point lies in the closed element; a flat one holds nothing. Exact.
  bool holds(Index element, const Vec<D>& point) const;

  /// Sign of each element's volume; exact.
  const std::vector<int>& orientations() const { return orientations_; }

  /// Boundary vertices in elements they do not belong to, ascending; not in inverted elements that own a boundary face.
  std::vector<OraclePair> penetrating_vertices() const;

  const std::vector<OracleFace<D>>& faces() const { return faces_; }
  const std::vector<Vec<D>>& positions() const { return positions_; }
  const std::vector<Element>& elements() const { return elements_; }
  Index neighbour(Index element, int face) const { return neighbours_[element][face]; }

  /// Whether the component of the element has neither inverted nor flat elements.
  bool is_clean(Index element) const { return clean_[element]; }

 private:
  struct Segment;
  void build_topology();
  void find_components();
  bool is_excluded(Index face, const std::array<Index, 2>& source) const;
  Segment make_segment(const Vec<D>& point, Index face, bool prolonged) const;
  void make_exact(Segment& segment) const;
  unsigned faces_met(Index element, Segment& segment) const;
  unsigned faces_met_exactly(Index element, const Segment& segment) const;
  unsigned faces_of_flat_met(Index element, const Vec<D>& point, Index face, int first, int last) const;
  double exact_length(Segment& segment) const;
  bool connects(Index from, Index to, Segment& segment, Workspace& workspace) const;
  bool connects_in_rationals(const Vec<D>& point, Index from, Index face) const;
  bool may_be_zero(const Segment& segment) const;
  bool holds_scaled(Index element, const Vec<D>& point) const;

  std::vector<Vec<D>> positions_;  // as given
  std::vector<Vec<D>> scaled_;     // divided by a power of two, so that doubles neither overflow nor underflow
  int scale_exponent_ = 0;
  int fraction_bits_ = 0;  // scaled coordinates are integers times 2^-fraction_bits_
  std::vector<Element> elements_;
  std::vector<std::array<Index, D + 1>> neighbours_;
  std::vector<OracleFace<D>> faces_;
  std::vector<int> orientations_;
  std::vector<char> clean_;
};

extern template class Oracle<2>;
extern template class Oracle<3>;

}  // namespace selvage::oracle
