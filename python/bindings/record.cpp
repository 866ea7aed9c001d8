#include "python/bindings/record.hpp"

#include <algorithm>

namespace robomill::python {
namespace {

/// "LobesOptions(output=<Output.boundary: 0>, …)".
std::string short_text(const py::object& self, const py::tuple& names) {
  constexpr std::size_t most = 120;
  std::string text = py::str(py::type::of(self).attr("__name__"));
  text += '(';
  for (const py::handle name : names) {
    const py::object value = self.attr(name);
    std::string shown;
    if (py::hasattr(value, "shape") && py::len(value.attr("shape")) > 0) {
      shown = "array" + std::string(py::str(value.attr("shape")));
    } else if (py::hasattr(value, "_fields")) {
      shown = std::string(py::str(py::type::of(value).attr("__name__"))) + "(…)";
    } else if (py::isinstance<py::list>(value) && py::len(value) > 3) {
      shown = "[" + std::to_string(py::len(value)) + " items]";
    } else {
      shown = py::repr(value);
    }
    if (text.back() != '(') text += ", ";
    const std::string one = std::string(py::str(name)) + "=" + shown;
    if (text.size() + one.size() > most) return text + "…)";
    text += one;
  }
  return text + ")";
}

/// For inspect.signature, which editors complete keywords from.
py::object signature_of(const py::object& type) {
  if (!py::hasattr(type, "replace")) return py::none();  // the library makes them
  const py::module_ inspect = py::module_::import("inspect");
  const py::object parameter = inspect.attr("Parameter");
  py::list parameters;
  for (const py::handle name : type.attr("_fields")) {
    parameters.append(parameter(name, parameter.attr("KEYWORD_ONLY"),
                                py::arg("default") = py::reinterpret_borrow<py::object>(Py_Ellipsis)));
  }
  return inspect.attr("Signature")(parameters);
}

[[noreturn]] void no_such_member(const py::handle& name, const std::vector<Access>& all, const std::string& of) {
  py::list known;
  for (const Access& one : all) known.append(one.name);
  const py::list near = py::module_::import("difflib").attr("get_close_matches")(name, known, 1);
  const std::string hint = near.empty() ? "" : "; did you mean " + std::string(py::str(near[0])) + "?";
  throw py::type_error(of + " has no member " + std::string(py::str(name)) + hint);
}

/// An object of the struct that Python's object is.
void* object_of(const py::handle& self, const std::type_info& type) {
  py::detail::type_caster_generic caster(type);
  if (!caster.load(self, false)) throw py::type_error("not an object of this class");
  return caster.value;
}

}  // namespace

void Members::add(py::object type, Access access, const char* doc) {
  const std::size_t offset = access.offset;
  const auto get = access.get;
  const py::cpp_function read(
      [get, offset, of = &type_](const py::object& self) {
        return get(static_cast<const std::byte*>(object_of(self, *of)) + offset, self);
      },
      py::is_method(type));
  type.attr(access.name.c_str()) = py::module_::import("builtins").attr("property")(read, py::none(), py::none(), doc);
  all_.push_back(std::move(access));
}

void Members::take(void* object, const py::dict& given) const {
  for (const auto& [name, value] : given) {
    const auto found = std::ranges::find_if(all_, [text = py::cast<std::string>(name)](const Access& one) {
      return one.name == text && one.set != nullptr;
    });
    const std::string of = py::str(py::detail::get_type_handle(type_, true).attr("__name__"));
    if (found == all_.end()) no_such_member(name, all_, of);
    try {
      found->set(static_cast<std::byte*>(object) + found->offset, value);
    } catch (const py::cast_error&) {
      const std::string kind = py::str(py::type::of(value).attr("__name__"));
      throw py::type_error(of + "." + found->name + " cannot be made of a " + kind);
    }
  }
}

py::dict Members::state(const py::object& self) const {
  py::dict out;
  for (const Access& one : all_) {
    if (one.set != nullptr) out[one.name.c_str()] = self.attr(one.name.c_str());
  }
  return out;
}

void Members::define_text(const py::object& type) const {
  py::tuple names(all_.size());
  for (std::size_t i = 0; i < all_.size(); ++i) names[i] = all_[i].name;
  type.attr("_fields") = names;
  // Of the class, made when somebody asks.
  const py::handle of_class(reinterpret_cast<PyObject*>(py::detail::get_internals().static_property_type));
  type.attr("__signature__") = of_class(py::cpp_function(signature_of), py::none(), py::none(), "");
  type.attr("__repr__") =
      py::cpp_function([names](const py::object& self) { return short_text(self, names); }, py::is_method(type));
}

}  // namespace robomill::python
