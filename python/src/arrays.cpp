#include "arrays.h"

#include "selvage/core/error.h"

#include <cstring>
#include <unordered_map>

namespace selvage::python {

namespace {

/// Python objects that are asked for in every call, kept for as long as the program runs.
struct Lasting {
  nb::handle empty;  ///< numpy.empty
  std::unordered_map<std::string_view, nb::handle> dtypes, results;
};

Lasting& lasting() {
  static Lasting objects;
  return objects;
}

std::string expected_of(const ArrayKind& kind) {
  const std::string numbers = kind.dtype[0] == 'f' ? "numbers" : "whole numbers";
  if (kind.columns == 0) return "expected a one-dimensional array of " + numbers + " (" + kind.dtype + ")";
  return "expected " + numbers + " of shape (n, " + std::to_string(kind.columns) + "), best as " + kind.dtype;
}

std::string shape_of(nb::handle array) {
  return nb::cast<std::string>(nb::str(nb::handle(array.attr("shape")))) + " of " +
         nb::cast<std::string>(nb::str(nb::handle(array.attr("dtype"))));
}

[[noreturn]] void refuse(const char* name, const std::string& what, const ArrayKind& kind) {
  throw Error(name, what, expected_of(kind));
}

/// The argument as a NumPy array, of whatever type.
nb::object numpy_array(nb::handle value, const ArrayKind& kind, const char* name) {
  try {
    return nb::module_::import_("numpy").attr("asarray")(value);
  } catch (nb::python_error& error) {
    if (!error.matches(PyExc_ValueError) && !error.matches(PyExc_TypeError)) throw;
    refuse(name, std::string("a ") + Py_TYPE(value.ptr())->tp_name + " that is no array of numbers was given", kind);
  }
}

/// A C-contiguous, aligned array of the kind's type, with the same values.
nb::object converted(nb::handle value, const ArrayKind& kind, const char* name) {
  const nb::object array = numpy_array(value, kind, name);
  const char type = nb::cast<std::string>(array.attr("dtype").attr("kind"))[0];
  const auto size = nb::cast<std::int64_t>(array.attr("size"));
  const bool is_flag = kind.item_size == 1 && type == 'b';
  const bool is_whole = type == 'i' || type == 'u' || is_flag;
  if (size == 0 && (type == 'f' || is_whole)) {
    // [] has no columns, and its type says nothing.
  } else if (kind.dtype[0] == 'f' ? !(is_whole || type == 'f') : !is_whole) {
    refuse(name, "an array " + shape_of(array) + " was given", kind);
  }
  const auto dimensions = nb::cast<int>(array.attr("ndim"));
  const bool is_empty_list = dimensions == 1 && size == 0 && kind.columns > 0;
  const bool fits = kind.columns == 0
                        ? dimensions == 1
                        : dimensions == 2 && nb::cast<int>(array.attr("shape")[nb::int_(1)]) == kind.columns;
  if (!fits && !is_empty_list) refuse(name, "an array " + shape_of(array) + " was given", kind);
  const nb::module_ numpy = nb::module_::import_("numpy");
  if (is_empty_list) return numpy.attr("empty")(nb::make_tuple(0, kind.columns), nb::str(kind.dtype));
  if (kind.dtype[0] != 'f' && size > 0 && !is_flag) {
    const nb::object limits = numpy.attr("iinfo")(nb::str(kind.dtype));
    for (const char* end : {"min", "max"})
      if (array.attr(end)() < limits.attr("min") || array.attr(end)() > limits.attr("max"))
        refuse(name, nb::cast<std::string>(nb::str(array.attr(end)())) + " does not fit in " + kind.dtype, kind);
  }
  nb::dict options;
  options["dtype"] = nb::str(kind.dtype);
  options["requirements"] = nb::str("CA");
  return numpy.attr("require")(array, **options);
}

}  // namespace

ArrayView::ArrayView(nb::handle value, const ArrayKind& kind, const char* name) {
  if (take(value, kind)) return;
  owner_ = converted(value, kind, name);
  if (!take(owner_, kind)) refuse(name, "an array " + shape_of(owner_) + " was given", kind);
}

bool ArrayView::take(nb::handle value, const ArrayKind& kind) {
  if (!PyObject_CheckBuffer(value.ptr())) return false;
  if (PyObject_GetBuffer(value.ptr(), &buffer_, PyBUF_FORMAT | PyBUF_STRIDES) != 0) {
    PyErr_Clear();
    return false;
  }
  is_held_ = true;
  const char* format = buffer_.format;
  if (format != nullptr && (*format == '@' || *format == '<' || *format == '=')) ++format;
  const int dimensions = kind.columns == 0 ? 1 : 2;
  bool fits = format != nullptr && std::strlen(format) == 1 && std::strchr(kind.formats, *format) != nullptr &&
              buffer_.itemsize == kind.item_size && buffer_.ndim == dimensions &&
              reinterpret_cast<std::uintptr_t>(buffer_.buf) % static_cast<std::uintptr_t>(kind.item_size) == 0;
  if (fits && dimensions == 2)
    fits = buffer_.shape[1] == kind.columns && (buffer_.shape[1] == 1 || buffer_.strides[1] == kind.item_size);
  if (fits && buffer_.shape[0] > 1) fits = buffer_.strides[0] == Py_ssize_t{kind.item_size} * std::max(kind.columns, 1);
  if (!fits) {
    release();
    return false;
  }
  rows_ = buffer_.shape[0];
  owner_ = nb::borrow(value);
  return true;
}

nb::object ArrayView::array() const {
  if (!owner_) return nb::none();
  return nb::module_::import_("numpy").attr("asarray")(owner_);
}

void ArrayView::release() {
  if (is_held_) PyBuffer_Release(&buffer_);
  is_held_ = false;
  buffer_ = {};
  rows_ = 0;
}

ArrayView::~ArrayView() {
  release();
}

ArrayView::ArrayView(ArrayView&& other) noexcept {
  *this = std::move(other);
}

ArrayView& ArrayView::operator=(ArrayView&& other) noexcept {
  if (this == &other) return *this;
  release();
  // A view's shape may point into itself, but only rows and the address are read from here on.
  buffer_ = other.buffer_;
  rows_ = other.rows_;
  is_held_ = std::exchange(other.is_held_, false);
  other.buffer_ = {};
  owner_ = std::move(other.owner_);
  return *this;
}

Vec3 vector_of(nb::handle value, const char* name) {
  const Rows<double> numbers(value, name);
  if (numbers.span().size() != 3)
    throw Error(name, std::to_string(numbers.span().size()) + " numbers were given", "give three");
  return Vec3(numbers.span()[0], numbers.span()[1], numbers.span()[2]);
}

std::pair<nb::object, void*> empty_array(const char* dtype, std::size_t rows, std::size_t width) {
  const nb::handle type = lasting().dtypes.at(dtype);
  nb::object array = width == 0 ? lasting().empty(rows, type) : lasting().empty(nb::make_tuple(rows, width), type);
  Py_buffer view;
  if (PyObject_GetBuffer(array.ptr(), &view, PyBUF_WRITABLE) != 0) throw nb::python_error();
  void* const data = view.buf;
  PyBuffer_Release(&view);  // the array never moves its memory
  return {std::move(array), data};
}

void prepare_arrays() {
  const nb::module_ numpy = nb::module_::import_("numpy");
  lasting().empty = nb::object(numpy.attr("empty")).release();
  for (const char* dtype : {"float64", "int32", "int64", "uint32", "uint8"})
    lasting().dtypes.emplace(dtype, numpy.attr("dtype")(nb::str(dtype)).release());
}

nb::object result_class(const char* name) {
  auto& results = lasting().results;
  auto found = results.find(name);
  if (found == results.end())
    found = results.emplace(name, nb::object(nb::module_::import_("selvage._results").attr(name)).release()).first;
  return nb::borrow(found->second);
}

}  // namespace selvage::python
