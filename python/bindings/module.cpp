#include <pybind11/pybind11.h>

#include <sstream>

#include "python/bindings/stage.hpp"
#include "python/bindings/stages.hpp"
#include "python/bindings/verbs.hpp"
#include "robomill/base/error.hpp"
#include "robomill/io/toml_source.hpp"
#include "robomill/version.hpp"

namespace robomill::python {

py::module_ module_of(const py::module_& root, const std::string& name) {
  py::module_ module = root;
  std::istringstream parts(name);
  for (std::string part; std::getline(parts, part, ':');) {
    if (part.empty()) continue;
    module =
        py::hasattr(module, part.c_str()) ? py::module_(module.attr(part.c_str())) : module.def_submodule(part.c_str());
  }
  return module;
}

namespace {

/// A ValueError with the parts of the message as attributes: where, field, number, value, unit, rule, hint.
void define_errors(py::module_& root) {
  static py::handle invalid_input;
  invalid_input = py::exception<InvalidInput>(root, "InvalidInput", PyExc_ValueError).release();
  invalid_input.attr("__doc__") = "Bad input: where, which field, its value and unit, the rule, the likely cause.";
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const InvalidInput& error) {
      const InvalidInput::Parts& parts = error.parts();
      const py::object made = invalid_input(error.what());
      made.attr("where") = parts.where;
      made.attr("field") = parts.field;
      made.attr("number") = parts.number;
      made.attr("value") = parts.value;
      made.attr("unit") = parts.unit;
      made.attr("rule") = parts.rule;
      made.attr("hint") = parts.hint;
      PyErr_SetObject(invalid_input.ptr(), made.ptr());
    } catch (const Interrupted& stopped) {
      PyErr_SetString(PyExc_KeyboardInterrupt, stopped.what());
    }
  });
}

/// A TOML document: a path alone is one.
void define_toml_source() {
  auto& type = record_of<io::TomlSource>().type();
  type.def(py::init<const std::filesystem::path&, std::optional<std::string>, std::vector<io::TomlSetting>>(),
           py::arg("path"), py::kw_only(), py::arg("text") = py::none(),
           py::arg("settings") = std::vector<io::TomlSetting>{});
  py::implicitly_convertible<py::str, io::TomlSource>();
  py::implicitly_convertible<std::filesystem::path, io::TomlSource>();
}

}  // namespace

}  // namespace robomill::python

PYBIND11_MODULE(_robomill, root) {
  using namespace robomill::python;
  py::options options;
  options.disable_function_signatures();
  root.attr("__version__") = ROBOMILL_VERSION;
  define_errors(root);
  declare_all(root);
  define_toml_source();
  fill_all();
  bind_all(root);
  bind_verbs(root);
}
