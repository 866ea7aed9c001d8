#pragma once
#include <pybind11/complex.h>
#include <pybind11/eigen.h>
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <Eigen/Geometry>
#include <array>
#include <complex>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <typeinfo>
#include <utility>
#include <vector>

#include "python/bindings/call.hpp"
#include "python/bindings/error.hpp"

// How structs of the library are Python's: frozen, made of keywords, their arrays NumPy's without a copy.

/// A pose is a 4 × 4 matrix.
template <>
struct pybind11::detail::type_caster<Eigen::Isometry3d> {
  PYBIND11_TYPE_CASTER(Eigen::Isometry3d, const_name("numpy.ndarray"));
  bool load(handle from, bool convert) {
    make_caster<Eigen::Matrix4d> matrix;
    if (!matrix.load(from, convert)) return false;
    value.matrix() = cast_op<const Eigen::Matrix4d&>(matrix);
    return true;
  }
  static handle cast(const Eigen::Isometry3d& pose, return_value_policy /*policy*/, handle /*parent*/) {
    return pybind11::cast(Eigen::Matrix4d(pose.matrix())).release();
  }
};

namespace robomill::python {

namespace py = pybind11;

template <class T>
inline constexpr bool is_number = (std::is_arithmetic_v<T> && !std::is_same_v<T, bool> && !std::is_same_v<T, char>) ||
                                  std::is_same_v<T, std::complex<double>> || std::is_same_v<T, std::complex<float>>;
template <class T>
struct NumbersOf : std::false_type {};
template <class T>
struct NumbersOf<std::vector<T>> : std::bool_constant<is_number<T>> {};
template <class T, std::size_t n>
struct NumbersOf<std::array<T, n>> : std::bool_constant<is_number<T>> {};
template <class T>
struct Shared : std::false_type {};
template <class T>
struct Shared<std::shared_ptr<const T>> : std::true_type {
  using Value = T;
};
/// What the library alone makes: it is read through the object that holds it.
template <class T>
struct Held : std::false_type {};
template <class T>
struct Held<std::unique_ptr<T>> : std::true_type {};
template <class T>
struct Held<std::shared_ptr<T>> : std::bool_constant<!std::is_const_v<T>> {};

/// An array of an object's memory, which it keeps alive, and which nobody can write to.
template <class T>
py::object view_of(const T* data, std::size_t size, py::handle owner) {
  py::array_t<T> array({static_cast<py::ssize_t>(size)}, {static_cast<py::ssize_t>(sizeof(T))}, data, owner);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return std::move(array);
}

/// A member of an object as Python sees it.
template <class T>
py::object member_of(const T& value, py::handle owner) {
  if constexpr (NumbersOf<T>::value) {
    return view_of(value.data(), value.size(), owner);
  } else if constexpr (std::is_same_v<T, Eigen::Isometry3d>) {
    return py::cast(value.matrix(), py::return_value_policy::reference_internal, owner);
  } else if constexpr (Shared<T>::value || Held<T>::value) {
    return value ? py::cast(*value, py::return_value_policy::reference_internal, owner) : py::none();
  } else {
    return py::cast(value, py::return_value_policy::reference_internal, owner);
  }
}

template <class T>
struct Span : std::false_type {};
template <class T>
struct Span<std::span<const T>> : std::true_type {
  using Copies = std::vector<T>;
};

/// What a function returned: numbers as arrays, which take over the memory; of what it only points to, copies.
template <class T>
py::object result_of(T&& value) {
  using Value = std::remove_cvref_t<T>;
  if constexpr (NumbersOf<Value>::value) {
    auto kept = std::make_unique<Value>(std::forward<T>(value));
    const Value& numbers = *kept;
    const py::capsule owner(kept.release(), [](void* given) { delete static_cast<Value*>(given); });
    return view_of(numbers.data(), numbers.size(), owner);
  } else if constexpr (Span<Value>::value) {
    return py::cast(typename Span<Value>::Copies(value.begin(), value.end()));
  } else {
    return py::cast(std::forward<T>(value));
  }
}

/// How a member is read and set. It depends on the member's type alone, so that a thousand members take little code.
struct Access {
  std::string name;
  std::size_t offset = 0;  ///< of the member in its struct
  py::object (*get)(const void* member, py::handle owner) = nullptr;
  void (*set)(void* member, py::handle value) = nullptr;  ///< null: only the library sets it
};
template <class Member>
py::object get_member(const void* member, py::handle owner) {
  return member_of(*static_cast<const Member*>(member), owner);
}
template <class Member>
void set_member(void* member, py::handle value) {
  if constexpr (Shared<Member>::value) {
    using Value = typename Shared<Member>::Value;
    if constexpr (std::is_copy_constructible_v<Value>) {
      *static_cast<Member*>(member) =
          value.is_none() ? nullptr : std::make_shared<const Value>(value.cast<const Value&>());
    } else {
      throw py::cast_error();
    }
  } else {
    *static_cast<Member*>(member) = value.cast<Member>();
  }
}

/// What records of all structs share: members by name.
class Members {
 public:
  explicit Members(const std::type_info& type) : type_(type) {}
  /// Defines the member's property in the class.
  void add(py::object type, Access access, const char* doc);
  /// Sets members of an object by keywords. @throws TypeError naming one that is not there or cannot be made of its
  /// value
  void take(void* object, const py::dict& given) const;
  /// All that can be set.
  [[nodiscard]] py::dict state(const py::object& self) const;
  void define_text(const py::object& type) const;

 private:
  const std::type_info& type_;
  std::vector<Access> all_;
};

/// A struct: read-only members, a constructor that takes them as keywords, replace(), copies, pickles.
template <class T, class... Bases>
class Record {
 public:
  Record(py::handle scope, const char* name, const char* doc) : class_(scope, name, doc) {}

  template <class Owner, class Member>
  Record& field(const char* name, Member Owner::*member, const char* doc) {
    alignas(T) static std::byte place[sizeof(T)];
    const T* const object = reinterpret_cast<const T*>(place);  // its address alone is used
    Access access{.name = name,
                  .offset = static_cast<std::size_t>(reinterpret_cast<const std::byte*>(&(object->*member)) - place),
                  .get = get_member<Member>};
    // A pointer or a view would outlive the text that it is made of.
    constexpr bool refers = std::is_pointer_v<Member> || std::is_same_v<Member, std::string_view>;
    if constexpr (!refers && !Held<Member>::value && std::is_copy_assignable_v<Member> &&
                  std::is_move_constructible_v<Member>) {
      access.set = set_member<Member>;
    }
    members_->add(class_, std::move(access), doc);
    return *this;
  }
  /// The rest, once all fields are known.
  void done() {
    members_->define_text(class_);
    if constexpr (std::is_default_constructible_v<T> && std::is_copy_constructible_v<T>) {
      const Members* const members = members_;
      class_.def(py::init([members](const py::kwargs& given) {
        auto made = std::make_unique<T>();
        members->take(made.get(), given);
        return made;
      }));
      class_.def(
          "replace",
          [members](const T& self, const py::kwargs& given) {
            auto made = std::make_unique<T>(self);
            members->take(made.get(), given);
            return made;
          },
          "A copy with other values for some members.");
      class_.def(py::pickle([members](const py::object& self) { return members->state(self); },
                            [members](const py::dict& state) {
                              auto made = std::make_unique<T>();
                              members->take(made.get(), state);
                              return made;
                            }));
    }
  }
  [[nodiscard]] py::class_<T, Bases...>& type() { return class_; }

 private:
  Members* members_ = new Members(typeid(T));  ///< for as long as Python has the class
  py::class_<T, Bases...> class_;
};

}  // namespace robomill::python
