#pragma once

#include "selvage/core/types.h"

#include <nanobind/nanobind.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace selvage::python {

namespace nb = nanobind;

/// What an argument shall be: one of the four number types that the library takes, in rows of so many columns.
struct ArrayKind {
  const char* dtype;    ///< as NumPy names it
  const char* formats;  ///< of the buffer protocol, each one letter, that are this type on this machine
  int item_size;        ///< [bytes]
  int columns;          ///< 0: one-dimensional
};

/// The array behind an argument, as the library reads it: itself where it has the right type and order, else a copy.
/// Made, moved and destroyed while the interpreter is held.
class ArrayView {
 public:
  ArrayView() = default;

  /// @param name   of the argument, for messages
  /// @throws Error  when it is no array of numbers that the kind can hold, or has another shape; it says what was
  ///                expected
  ArrayView(nb::handle value, const ArrayKind& kind, const char* name);
  ~ArrayView();
  ArrayView(ArrayView&& other) noexcept;
  ArrayView& operator=(ArrayView&& other) noexcept;

  const void* data() const { return buffer_.buf; }
  std::int64_t rows() const { return rows_; }
  /// A NumPy array of these very numbers.
  nb::object array() const;

 private:
  bool take(nb::handle value, const ArrayKind& kind);
  void release();

  nb::object owner_;
  Py_buffer buffer_{};
  std::int64_t rows_ = 0;
  bool is_held_ = false;
};

template <typename Row>
struct RowKind;
template <int D>
struct RowKind<Vec<D>> {
  static constexpr ArrayKind kind{"float64", "d", 8, D};
};
template <std::size_t N>
struct RowKind<std::array<Index, N>> {
  static constexpr ArrayKind kind{"int32", "il", 4, N};
};
template <>
struct RowKind<IndexPair> {
  static constexpr ArrayKind kind{"int32", "il", 4, 2};
};
template <>
struct RowKind<double> {
  static constexpr ArrayKind kind{"float64", "d", 8, 0};
};
template <>
struct RowKind<Index> {
  static constexpr ArrayKind kind{"int32", "il", 4, 0};
};
template <>
struct RowKind<std::uint32_t> {
  static constexpr ArrayKind kind{"uint32", "IL", 4, 0};
};
template <>
struct RowKind<std::uint8_t> {
  static constexpr ArrayKind kind{"uint8", "B?", 1, 0};
};

/// An argument as a span of rows.
template <typename Row>
class Rows {
  static_assert(sizeof(Row) == RowKind<Row>::kind.item_size * std::max(RowKind<Row>::kind.columns, 1));

 public:
  Rows() = default;
  Rows(nb::handle value, const char* name) : view_(value, RowKind<Row>::kind, name) {}

  std::span<const Row> span() const {
    return {static_cast<const Row*>(view_.data()), static_cast<std::size_t>(view_.rows())};
  }
  std::vector<Row> copy() const { return {span().begin(), span().end()}; }
  nb::object array() const { return view_.array(); }

 private:
  ArrayView view_;
};

/// The rows of an argument that may be None: then there are none.
template <typename Row>
Rows<Row> rows_or_none(nb::handle value, const char* name) {
  return value.is_none() ? Rows<Row>() : Rows<Row>(value, name);
}

/// A new NumPy array that owns its memory, not yet filled, and where that is. The interpreter must be held.
/// @param width  numbers a row; 0: the array is one-dimensional
std::pair<nb::object, void*> empty_array(const char* dtype, std::size_t rows, std::size_t width);

template <typename T>
constexpr const char* dtype_name() {
  if constexpr (std::is_same_v<T, double>) return "float64";
  if constexpr (std::is_same_v<T, std::int32_t>) return "int32";
  if constexpr (std::is_same_v<T, std::int64_t>) return "int64";
  if constexpr (std::is_same_v<T, std::uint32_t>) return "uint32";
  if constexpr (std::is_same_v<T, std::uint8_t>) return "uint8";
}

/// A new NumPy array to be filled, while the interpreter is free, too.
template <typename T>
class Column {
 public:
  /// The interpreter must be held.
  explicit Column(std::size_t rows, std::size_t width = 0) : width_(std::max<std::size_t>(width, 1)) {
    auto [array, data] = empty_array(dtype_name<T>(), rows, width);
    array_ = std::move(array);
    data_ = static_cast<T*>(data);
  }

  T* row(std::size_t i) { return data_ + i * width_; }
  T& operator[](std::size_t i) { return data_[i]; }

  nb::object array() && { return std::move(array_); }

 private:
  nb::object array_;
  T* data_;
  std::size_t width_;
};

/// A copy of rows of N numbers each as a new array. The interpreter must be held.
template <typename Row>
nb::object array_of(std::span<const Row> rows) {
  constexpr ArrayKind kind = RowKind<Row>::kind;
  using T =
      std::conditional_t<kind.item_size == 8, double,
                         std::conditional_t<kind.item_size == 1, std::uint8_t,
                                            std::conditional_t<kind.dtype[0] == 'u', std::uint32_t, std::int32_t>>>;
  Column<T> column(rows.size(), kind.columns);
  if (!rows.empty()) std::memcpy(column.row(0), rows.data(), rows.size_bytes());
  return std::move(column).array();
}

template <typename Row>
nb::object array_of(const std::vector<Row>& rows) {
  return array_of(std::span<const Row>(rows));
}

/// Three numbers of an argument, such as a direction.
Vec3 vector_of(nb::handle value, const char* name);

/// Before all others, when the module is imported.
void prepare_arrays();

/// The class of that name among the package's results.
nb::object result_class(const char* name);

}  // namespace selvage::python
