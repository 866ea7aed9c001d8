#pragma once
#include <string>
#include <string_view>

#include "python/bindings/record.hpp"
#include "robomill/base/names.hpp"

// What the generated sources are written with.

namespace robomill::python {

/// A submodule of the module, "stability"; the module itself where the name is empty.
[[nodiscard]] py::module_ module_of(const py::module_& root, const std::string& name);

template <class T, class... Bases>
std::unique_ptr<py::class_<T, Bases...>>& kept_class() {
  static auto* const kept = new std::unique_ptr<py::class_<T, Bases...>>();
  return *kept;
}
template <class T, class... Bases>
void declare(py::handle scope, const char* name, const char* doc) {
  kept_class<T, Bases...>() = std::make_unique<py::class_<T, Bases...>>(scope, name, doc);
}
template <class T, class... Bases>
py::class_<T, Bases...>& class_of() {
  return *kept_class<T, Bases...>();
}

template <class T, class... Bases>
std::unique_ptr<Record<T, Bases...>>& kept_record() {
  static auto* const kept = new std::unique_ptr<Record<T, Bases...>>();
  return *kept;
}
template <class T, class... Bases>
void declare_record(py::handle scope, const char* name, const char* doc) {
  kept_record<T, Bases...>() = std::make_unique<Record<T, Bases...>>(scope, name, doc);
}
template <class T, class... Bases>
Record<T, Bases...>& record_of() {
  return *kept_record<T, Bases...>();
}

/// Python's type of a struct that was declared.
template <class T>
py::handle type_of() {
  return py::type::of<T>();
}

template <class E, std::size_t n>
std::vector<std::pair<std::string, E>> words_of(const Name<E> (&names)[n]) {
  std::vector<std::pair<std::string, E>> out;
  for (const auto& [word, value] : names) out.emplace_back(word, value);
  return out;
}
/// A text is a value where an enum is wanted: its word in the documents, or its name.
template <class E>
void take_words(py::enum_<E>& type, const std::vector<std::pair<std::string, E>>& words) {
  type.def(py::init([type, words](const std::string& text) {
    for (const auto& [word, value] : words) {
      if (word == text) return value;
    }
    const py::dict members = type.attr("__members__");
    if (members.contains(text)) return members[text.c_str()].template cast<E>();
    std::string rule = std::string(py::str(type.attr("__name__"))) + " is one of ";
    for (const auto& [name, value] : members) rule += std::string(py::str(name)) + ", ";
    throw py::value_error(rule.substr(0, rule.size() - 2) + "; not " + text);
  }));
  py::implicitly_convertible<py::str, E>();
}

/// Numbers that a function takes: an array of that type as it is, anything else as a copy.
template <class T>
using Numbers = py::array_t<T, py::array::c_style | py::array::forcecast>;
/// Numbers that a function writes.
template <class T>
using Written = py::array_t<T, py::array::c_style>;

template <class T>
std::span<T> span_of(const Numbers<std::remove_const_t<T>>& array) requires std::is_const_v<T> {
  return {array.data(), static_cast<std::size_t>(array.size())};
}
template <class T>
std::span<T> span_of(Written<T>& array) {
  return {array.mutable_data(), static_cast<std::size_t>(array.size())};
}
template <class T>
std::span<T> span_of(const std::vector<std::remove_const_t<T>>& list) requires std::is_const_v<T> {
  return {list.data(), list.size()};
}

}  // namespace robomill::python
