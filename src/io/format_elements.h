#pragma once

#include "io/format_cursor.h"

#include <utility>
#include <vector>

namespace selvage::format {

/// From the numbers that a file gives its vertices to their places in the file's order.
class VertexNumbers {
 public:
  VertexNumbers() = default;

  /// Numbers first, first + 1, ... of `count` vertices.
  VertexNumbers(std::int64_t first, std::int64_t count) : first_(first), count_(count) {}

  /// The next vertex has this number.
  void add(std::int64_t number) {
    if (count_ == 0) first_ = number;
    // Unsigned, so that numbers at the ends of the range may wrap around.
    const bool follows =
        static_cast<std::uint64_t>(number) - static_cast<std::uint64_t>(first_) == static_cast<std::uint64_t>(count_);
    if (sorted_.empty() && follows) {
      ++count_;
    } else {
      add_out_of_order(number);
    }
  }

  /// Call once after the last add(). Returns a number that was added twice, if any: {true, number}.
  std::pair<bool, std::int64_t> finish();

  /// Place of the vertex with this number, kNone when there is none.
  Index find(std::int64_t number) const {
    if (!sorted_.empty()) return find_out_of_order(number);
    const std::uint64_t place = static_cast<std::uint64_t>(number) - static_cast<std::uint64_t>(first_);
    return place < static_cast<std::uint64_t>(count_) ? static_cast<Index>(place) : kNone;
  }

  std::int64_t count() const { return count_; }

  /// A name for the numbers, for an error message.
  std::string describe() const;

 private:
  void add_out_of_order(std::int64_t number);
  Index find_out_of_order(std::int64_t number) const;

  std::int64_t first_ = 0;
  std::int64_t count_ = 0;
  std::vector<std::pair<std::int64_t, Index>> sorted_;  // (number, place), unless numbers follow each other
  std::vector<Index> table_;                            // place by number - first_, where that is small
};

/// Takes a mesh's elements as they are read and checks each; errors are raised at the cursor's last reading.
class ElementCollector {
 public:
  ElementCollector(const Cursor& cursor, IndexedMesh& mesh, const VertexNumbers& numbers)
      : cursor_(cursor), mesh_(mesh), numbers_(numbers) {}

  /// Place of the vertex that the file calls `number`.
  Index vertex(std::int64_t number) const {
    const Index place = numbers_.find(number);
    if (place == kNone) fail_unknown(number);
    return place;
  }

  void add_triangle(Index a, Index b, Index c) {
    add_part(a, b, c);
    if (!mesh_.faces.empty()) end_face(1);
  }

  void add_tetrahedron(Index a, Index b, Index c, Index d) {
    if (a == b || a == c || a == d) fail_repeated("tetrahedron", a);
    if (b == c || b == d || c == d) fail_repeated("tetrahedron", b == c ? b : d);
    mesh_.tetrahedra.push_back({a, b, c, d});
  }

  /// Splits a polygon into a fan around its first vertex.
  void add_polygon(std::span<const Index> polygon);

  /// Triangles of three consecutive vertices each, every second one with its orientation reversed; they count as one
  /// face.
  void add_strip(std::span<const Index> strip);

  const Cursor& cursor() const { return cursor_; }

 private:
  void add_part(Index a, Index b, Index c) {
    if (a == b || b == c || c == a) fail_repeated("triangle", a == b ? a : c);
    mesh_.triangles.push_back({a, b, c});
  }
  /// The last triangles are the parts of one face.
  void end_face(std::size_t parts);
  [[noreturn]] void fail_unknown(std::int64_t number) const;
  [[noreturn]] void fail_repeated(std::string_view element, Index vertex) const;

  const Cursor& cursor_;
  IndexedMesh& mesh_;
  const VertexNumbers& numbers_;
};

/// Adds a VTK cell; points and lines are passed over. `vertices` are places in the mesh.
void add_vtk_cell(ElementCollector& collector, int type, std::span<const Index> vertices);

/// Error for an element that is neither triangle, polygon nor tetrahedron.
[[noreturn]] void fail_unsupported(const Cursor& cursor, std::string_view element, int type);

}  // namespace selvage::format
