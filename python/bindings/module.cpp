#include <pybind11/pybind11.h>

#include <sstream>

#include "python/bindings/error.hpp"
#include "python/bindings/stage.hpp"
#include "python/bindings/stages.hpp"
#include "python/bindings/verbs.hpp"
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
