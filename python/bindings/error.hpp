#pragma once
#include <pybind11/pybind11.h>

#include <optional>
#include <utility>

#include "robomill/base/error.hpp"

// The library's error about bad input is an exception of Python's, also where it is a value.

namespace robomill::python {

namespace py = pybind11;

/// Defines InvalidInput, and what becomes of the errors that the library throws.
void define_errors(py::module_& root);
/// A ValueError with the parts of the message as attributes.
[[nodiscard]] py::object python_error(const InvalidInput& error);
/// Of one that was made in Python the text is the rule. Nothing where it is another exception.
[[nodiscard]] std::optional<InvalidInput> library_error(py::handle error);

}  // namespace robomill::python

template <>
struct pybind11::detail::type_caster<robomill::InvalidInput> {
  static constexpr auto name = const_name("InvalidInput");
  template <class>
  using cast_op_type = robomill::InvalidInput&;
  // NOLINTNEXTLINE(google-explicit-constructor): pybind11 converts so
  operator robomill::InvalidInput&() { return *value_; }

  bool load(handle from, bool /*convert*/) {
    value_ = robomill::python::library_error(from);
    return value_.has_value();
  }
  static handle cast(const robomill::InvalidInput& error, return_value_policy /*policy*/, handle /*parent*/) {
    return robomill::python::python_error(error).release();
  }

 private:
  std::optional<robomill::InvalidInput> value_;
};
