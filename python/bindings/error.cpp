#include "python/bindings/error.hpp"

#include <pybind11/stl.h>

#include <string>

#include "robomill/base/progress.hpp"

namespace robomill::python {
namespace {

constexpr const char* invalid_input_doc =
    R"(Bad input: where, which field, its value and unit, the rule, the likely cause.

Attributes
----------
where : str
    "lobes.toml:14", a JSON path; empty: not known
field : str
    "axial_depth_m", or the key of a file
number : float or None
    the value, where it is a number, in `unit`
value : str
    the value as text, where it is none
unit : str
    "m"
rule : str
    "must be > 0"
hint : str
    the likely cause: "did you pass N/m^2?")";

py::handle invalid_input;  // for as long as the module lives

}  // namespace

void define_errors(py::module_& root) {
  invalid_input = py::exception<InvalidInput>(root, "InvalidInput", PyExc_ValueError).release();
  invalid_input.attr("__doc__") = invalid_input_doc;
  for (const char* part : {"where", "field", "value", "unit", "rule", "hint"}) invalid_input.attr(part) = "";
  invalid_input.attr("number") = py::none();
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const InvalidInput& error) {
      PyErr_SetObject(invalid_input.ptr(), python_error(error).ptr());
    } catch (const Interrupted& stopped) {
      PyErr_SetString(PyExc_KeyboardInterrupt, stopped.what());
    }
  });
}

py::object python_error(const InvalidInput& error) {
  const InvalidInput::Parts& parts = error.parts();
  py::object made = invalid_input(error.what());
  made.attr("where") = parts.where;
  made.attr("field") = parts.field;
  made.attr("number") = parts.number;
  made.attr("value") = parts.value;
  made.attr("unit") = parts.unit;
  made.attr("rule") = parts.rule;
  made.attr("hint") = parts.hint;
  return made;
}

std::optional<InvalidInput> library_error(py::handle error) {
  if (!py::isinstance(error, invalid_input)) return {};
  const auto text = [&](const char* name) { return error.attr(name).cast<std::string>(); };
  if (text("rule").empty()) return InvalidInput(InvalidInput::Parts{.rule = py::str(error)});
  return InvalidInput(InvalidInput::Parts{.where = text("where"),
                                          .field = text("field"),
                                          .number = error.attr("number").cast<std::optional<double>>(),
                                          .value = text("value"),
                                          .unit = text("unit"),
                                          .rule = text("rule"),
                                          .hint = text("hint")});
}

}  // namespace robomill::python
