#pragma once

#include "io/format.h"
#include "selvage/core/error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <random>

namespace selvage {

/// What every small sample file holds.
inline IndexedMesh one_triangle() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0.5}}, {}, {{0, 1, 2}}};
}
inline IndexedMesh one_tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}, {}};
}

/// Random elements on vertices whose coordinates use all bits of a double: any sign, mantissa and exponent.
inline IndexedMesh random_mesh(unsigned seed, int vertices, int triangles, int tetrahedra) {
  std::mt19937_64 random(seed);
  IndexedMesh mesh;
  const auto coordinate = [&] {
    while (true) {
      const double x = std::bit_cast<double>(static_cast<std::uint64_t>(random()));
      if (std::isfinite(x)) return x;
    }
  };
  const auto element = [&](auto tuple) {
    for (auto it = tuple.begin(); it != tuple.end(); ++it) {
      do {
        *it = static_cast<Index>(random() % static_cast<unsigned>(vertices));
      } while (std::find(tuple.begin(), it, *it) != it);
    }
    return tuple;
  };
  for (int i = 0; i < vertices; ++i) {
    const double x = coordinate(), y = coordinate(), z = coordinate();
    mesh.positions.push_back({x, y, z});
  }
  for (int i = 0; i < triangles; ++i) mesh.triangles.push_back(element(VertexTuple<3>{}));
  for (int i = 0; i < tetrahedra; ++i) mesh.tetrahedra.push_back(element(VertexTuple<4>{}));
  return mesh;
}

/// The same bits in every coordinate (zero keeps its sign) and the same elements.
inline void expect_same_mesh(const IndexedMesh& found, const IndexedMesh& expected, const std::string& what) {
  ASSERT_EQ(found.positions.size(), expected.positions.size()) << what;
  for (std::size_t i = 0; i < found.positions.size(); ++i) {
    EXPECT_EQ(std::memcmp(found.positions[i].data(), expected.positions[i].data(), 3 * sizeof(double)), 0)
        << what << ": vertex " << i << " is " << found.positions[i].transpose();
  }
  EXPECT_EQ(found.triangles, expected.triangles) << what;
  EXPECT_EQ(found.tetrahedra, expected.tetrahedra) << what;
}

inline IndexedMesh parse(std::string_view extension, std::string_view bytes, std::string_view twin = {}) {
  return format::parse_mesh(extension, {bytes, "sample"}, {twin, "twin"});
}

/// The message of the error that reading raises, empty when it succeeds.
inline std::string error_of(std::string_view extension, std::string_view bytes, std::string_view twin = {}) {
  try {
    parse(extension, bytes, twin);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

/// Binary numbers of one type in the given byte order, one after the other.
template <typename T>
std::string packed(std::initializer_list<T> values, std::endian order = std::endian::little) {
  std::string bytes;
  for (const T value : values) {
    char one[sizeof(T)];
    std::memcpy(one, &value, sizeof(T));
    if (order != std::endian::native) std::reverse(one, one + sizeof(T));
    bytes.append(one, sizeof(T));
  }
  return bytes;
}

}  // namespace selvage
