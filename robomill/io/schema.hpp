#pragma once
// For .cpp files inside the library, as json.hpp.
#include <algorithm>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "robomill/base/names.hpp"
#include "robomill/io/json.hpp"
#include "robomill/io/key_unit.hpp"
#include "robomill/io/schema_values.hpp"
#include "robomill/io/table_info.hpp"
#include "robomill/io/toml/file.hpp"

namespace robomill::io {

template <class T>
class Schema;

/// A key of the table of T, with the member that it fills or is written from.
template <class T>
struct Row {
  Key key = {};
  std::string member = {};   ///< in errors about SI members
  double factor = 1.0;       ///< SI value = factor * value
  bool every_digit = false;  ///< of numbers that are written; else 15 significant ones
  std::function<void(TomlFile&, const std::string& path, const Row&, T&)> read = {};  ///< empty: written only
  std::function<Json(const T&, const Row&)> write = {};
  bool always = true;       ///< the key is written of every object
  bool drops_null = false;  ///< … but where its value is null or an empty list
  bool usual = true;        ///< the member's initial value is a default

  Row& required(std::string hint = {}) {
    key.required = true;
    key.hint = std::move(hint);
    return *this;
  }
  Row& above(double low, std::string hint = {}) {
    key.rule.above = true;
    return at_least(low, std::move(hint));
  }
  Row& at_least(double low, std::string hint = {}) {
    key.rule.lowest = low;
    if (!hint.empty()) key.rule.hint = std::move(hint);
    return *this;
  }
  Row& at_most(double high, std::string hint = {}) {
    key.rule.highest = high;
    if (!hint.empty()) key.rule.hint = std::move(hint);
    return *this;
  }
  Row& below(double high, std::string hint = {}) {
    key.rule.below = true;
    return at_most(high, std::move(hint));
  }
  /// @param hint  what they are
  Row& entries(std::size_t count, std::string hint = {}) {
    key.rule.entries = count;
    if (!hint.empty()) key.rule.hint = std::move(hint);
    return *this;
  }
  /// One value in place of a list.
  Row& or_one() {
    key.or_one = true;
    return *this;
  }
  Row& or_also(Holds other) {
    key.also.push_back(other);
    return *this;
  }
  /// @param code  (TomlFile&, path of the key, T&), in place of the member's reading; called also where the key is
  /// absent
  template <class F>
  Row& read_by(F code) {
    read = [code](TomlFile& file, const std::string& path, const Row&, T& out) { code(file, path, out); };
    return *this;
  }
  /// Without a default: what a missing key means depends on others.
  Row& no_default() {
    usual = false;
    return *this;
  }
  /// Null where the value is not known; a text where it is empty.
  Row& nullable() {
    key.nullable = true;
    return *this;
  }
  /// Null in place of a whole list.
  Row& null_list() {
    key.null_list = true;
    return *this;
  }
  /// Left out where the value is not known, or empty.
  Row& optional() {
    always = false;
    drops_null = true;
    return *this;
  }
  /// One of a few words.
  Row& words(std::vector<std::string> known) {
    key.holds = Holds::word;
    key.words = std::move(known);
    return *this;
  }
  /// The range of a form's slider, in the key's unit.
  Row& slider(double lowest, double highest, double step) {
    key.slider = Slider{.lowest = lowest, .highest = highest, .step = step};
    return *this;
  }
  /// The same, those of an enumeration.
  template <class E, std::size_t n>
  Row& words(const Name<E> (&names)[n]) {
    key.holds = Holds::word;
    for (const auto& [word, value] : names) key.words.emplace_back(word);
    return *this;
  }
  /// The function gives numbers in the key's unit.
  Row& in_unit() {
    factor = 1.0;
    return *this;
  }
  /// Numbers are written as they are, not rounded to 15 significant digits.
  Row& exact() {
    every_digit = true;
    return *this;
  }
  /// The member's name where it is not the key's.
  Row& as(std::string name) {
    member = std::move(name);
    return *this;
  }
};

/// A key that a member holds. Its unit is that of the key's name (key_unit), which gives the factor and the member's
/// name in errors; it is readable where the member's type is one that TOML has.
template <class T, class M>
[[nodiscard]] Row<T> key(const std::string& name, M T::*member, const std::string& meaning) {
  const KeyUnit unit = key_unit(name);
  Row<T> row{
      .key = {.name = name, .holds = detail::Holding<M>::holds, .lists = detail::Holding<M>::lists, .meaning = meaning},
      .member = unit.member,
      .factor = unit.factor};
  if constexpr (requires(TomlFile & file, M & out) {
                  detail::read_value(file, std::string(), std::string(), 1.0, Key(), out);
                }) {
    row.read = [member](TomlFile& file, const std::string& path, const Row<T>& self, T& out) {
      static_cast<void>(detail::read_value(file, path, self.member, self.factor, self.key, out.*member));
    };
  }
  row.write = [member](const T& object, const Row<T>& self) {
    return detail::write_value(object.*member, {self.factor, self.every_digit});
  };
  return row;
}

/// A key that holds one word of a list.
template <class T, class E, std::size_t n>
[[nodiscard]] Row<T> key(const std::string& name, E T::*member, const Name<E> (&names)[n], const std::string& meaning) {
  Row<T> row{.key = {.name = name, .meaning = meaning}};
  row.words(names);
  row.read = [member, &names](TomlFile& file, const std::string& path, const Row<T>&, T& out) {
    file.choice(path, names, out.*member);
  };
  row.write = [member, &names](const T& object, const Row<T>&) { return text_or_null(name_in(names, object.*member)); };
  return row;
}

/// The same; none where the key is absent.
template <class T, class E, std::size_t n>
[[nodiscard]] Row<T> key(const std::string& name, std::optional<E> T::*member, const Name<E> (&names)[n],
                         const std::string& meaning) {
  Row<T> row{.key = {.name = name, .holds = Holds::word, .meaning = meaning}};
  for (const auto& [word, value] : names) row.key.words.emplace_back(word);
  row.read = [member, &names](TomlFile& file, const std::string& path, const Row<T>&, T& out) {
    E value{};
    if (file.choice(path, names, value)) out.*member = value;
  };
  row.write = [member, &names](const T& object, const Row<T>&) {
    return object.*member ? text_or_null(name_in(names, *(object.*member))) : Json();
  };
  return row;
}

/// A key that is written from the whole object.
/// @param value  (const T&) -> number, text, list, …, in SI
template <class F>
requires requires {
  &F::operator();
}
[[nodiscard]] auto key(const std::string& name, F value, const std::string& meaning) {
  using T = typename detail::Getter<F>::Object;
  using M = typename detail::Getter<F>::Value;
  const double factor = key_unit(name).factor;
  Row<T> row{.key = {.name = name,
                     .holds = detail::Holding<M>::holds,
                     .lists = detail::Holding<M>::lists,
                     .named = detail::is_named<M>,
                     .meaning = meaning},
             .factor = factor};
  row.write = [value](const T& object, const Row<T>& self) {
    return detail::write_value(value(object), {self.factor, self.every_digit});
  };
  return row;
}

/// The same, one word of a list.
/// @param value  (const T&) -> E
template <class F, class E, std::size_t n>
requires requires {
  &F::operator();
}
[[nodiscard]] auto key(const std::string& name, F value, const Name<E> (&names)[n], const std::string& meaning) {
  using T = typename detail::Getter<F>::Object;
  Row<T> row{.key = {.name = name, .meaning = meaning}};
  row.words(names);
  row.write = [value, &names](const T& object, const Row<T>&) { return text_or_null(name_in(names, value(object))); };
  return row;
}

/// A key of the table that a member is, as one of the object's own.
template <class T, class U>
[[nodiscard]] Row<T> of(U T::*part, Row<U> row) {
  Row<T> out{.key = row.key,
             .member = row.member,
             .factor = row.factor,
             .every_digit = row.every_digit,
             .always = row.always,
             .drops_null = row.drops_null,
             .usual = row.usual};
  if (row.read) {
    out.read = [part, row](TomlFile& file, const std::string& path, const Row<T>& self, T& object) {
      Row<U> named = row;
      named.member = self.member;
      row.read(file, path, named, object.*part);
    };
  }
  out.write = [part, row](const T& object, const Row<T>&) { return row.write(object.*part, row); };
  return out;
}

/// A key that code reads, and no member's row: its value depends on other keys.
/// @param lists  1: a list of them
template <class T>
[[nodiscard]] Row<T> declared(const std::string& name, Holds holds, const std::string& meaning, int lists = 0) {
  const double factor = key_unit(name).factor;
  Row<T> row{.key = {.name = name, .holds = holds, .lists = lists, .meaning = meaning}, .factor = factor};
  row.write = [](const T&, const Row<T>&) { return Json(Json::value_t::discarded); };
  row.always = false;
  return row;
}

/// None where it is not > 0: unknown, none.
[[nodiscard]] inline std::optional<double> if_positive(double value) {
  return value > 0.0 ? std::optional(value) : std::nullopt;
}

/// What a row writes to leave its key out.
[[nodiscard]] inline Json absent() {
  return Json(Json::value_t::discarded);
}

/// The same key, left out of objects of which it says nothing.
template <class T, class Condition>
[[nodiscard]] Row<T> where(Condition condition, Row<T> row) {
  row.read = {};
  row.always = false;
  row.write = [condition = std::move(condition), write = std::move(row.write)](const T& object, const Row<T>& self) {
    return condition(object) ? write(object, self) : absent();
  };
  return row;
}

/// The description of a struct as a table of a document: its keys, in their order.
template <class T>
class Schema {
 public:
  /// @param use      Use::written: no default counts, and a key is required that is written of every object
  /// @param version  of a document
  Schema(std::string name, std::string meaning, std::vector<Row<T>> rows, Use use = Use::read, int version = 0)
      : rows_(std::move(rows)) {
    info_.name = std::move(name);
    info_.meaning = std::move(meaning);
    info_.use = use;
    info_.version = version;
    info_.keys.reserve(rows_.size());
    const T fresh{};
    for (Row<T>& row : rows_) {
      if (use == Use::written) {
        row.key.required = row.always;
      } else if (row.read && row.usual && !row.key.required) {
        row.key.default_value = default_of(row.write(fresh, row), row.key.rule);
      }
      info_.keys.push_back(row.key);
    }
  }
  [[nodiscard]] const TableInfo& info() const { return info_; }
  [[nodiscard]] const std::vector<Row<T>>& rows() const { return rows_; }

  /// Fills the members whose keys stand there.
  /// @param path    of the table: "tool", "tool[0]"; empty: the document
  /// @param member  before each member's name in errors: "tool[1]."
  /// @throws InvalidInput with file, line, key, value and rule
  void read(TomlFile& file, const std::string& path, T& out, const std::string& member = {}) const {
    for (const Row<T>& row : rows_) {
      if (!row.read) continue;
      const std::string key = path.empty() ? row.key.name : path + "." + row.key.name;
      if (row.key.required) file.require(key, row.key.hint);
      Row<T> named = row;
      named.member = member + row.member;
      row.read(file, key, named, out);
    }
  }

  /// Of one key; discarded: it says nothing of this object.
  [[nodiscard]] Json value(const Row<T>& row, const T& object) const {
    Json out = row.write(object, row);
    const bool none = row.key.nullable && out.is_string() && out.template get_ref<const std::string&>().empty();
    return none ? Json() : out;
  }

  /// The keys in their order; before them what the document is.
  [[nodiscard]] Json write(const T& object) const {
    Json out = Json::object();
    if (info_.version > 0) out["document"] = info_.document();
    for (const Row<T>& row : rows_) {
      Json value = this->value(row, object);
      if (value.is_discarded()) continue;
      if (row.drops_null && (value.is_null() || (value.is_structured() && value.empty()))) continue;
      out[row.key.name] = std::move(value);
    }
    return out;
  }

 private:
  /// None where it is not known. A number that the rule rejects stands for none too, as does an empty text or list.
  [[nodiscard]] static Json default_of(Json value, const Rule& rule) {
    const bool blank = value.is_string() && value.template get_ref<const std::string&>().empty();
    const auto rejected = [&](const Json& one) { return one.is_number() && !rule.keeps(one.template get<double>()); };
    if (value.is_discarded() || value.empty() || blank || rejected(value)) return nullptr;
    return value.is_array() && std::ranges::any_of(value, rejected) ? Json() : value;
  }

  std::vector<Row<T>> rows_;
  TableInfo info_;
};

/// A key that holds another table.
template <class T, class U>
[[nodiscard]] Row<T> key(const std::string& name, U T::*member, const Schema<U>& table, const std::string& meaning) {
  Row<T> row{.key = {.name = name, .holds = Holds::table, .table = &table.info(), .meaning = meaning}};
  row.read = [member, &table](TomlFile& file, const std::string& path, const Row<T>&, T& out) {
    table.read(file, path, out.*member);
  };
  row.write = [member, &table](const T& object, const Row<T>&) { return table.write(object.*member); };
  return row;
}

/// A key that holds a list of tables.
template <class T, class U>
[[nodiscard]] Row<T> key(const std::string& name, std::vector<U> T::*member, const Schema<U>& table,
                         const std::string& meaning) {
  Row<T> row{.key = {.name = name, .holds = Holds::table, .lists = 1, .table = &table.info(), .meaning = meaning}};
  row.read = [member, &table](TomlFile& file, const std::string& path, const Row<T>& self, T& out) {
    for (std::size_t i = 0; i < file.tables(path); ++i) {
      table.read(file, path + "[" + std::to_string(i) + "]", (out.*member).emplace_back(),
                 self.member + "[" + std::to_string(i + 1) + "].");
    }
  };
  row.write = [member, &table](const T& object, const Row<T>&) {
    Json out = Json::array();
    for (const U& one : object.*member) out.push_back(table.write(one));
    return out;
  };
  return row;
}

/// A table that may be absent.
template <class T, class U>
[[nodiscard]] Row<T> key(const std::string& name, std::optional<U> T::*member, const Schema<U>& table,
                         const std::string& meaning) {
  Row<T> row{.key = {.name = name, .holds = Holds::table, .table = &table.info(), .meaning = meaning}};
  row.read = [member, &table](TomlFile& file, const std::string& path, const Row<T>&, T& out) {
    if (file.has(path)) table.read(file, path, (out.*member).emplace());
  };
  row.write = [member, &table](const T& object, const Row<T>&) {
    return object.*member ? table.write(*(object.*member)) : Json();
  };
  return row;
}

namespace detail {

template <class U>
Json write_table(const Schema<U>& table, const U& object) {
  return table.write(object);
}
template <class U>
Json write_table(const Schema<U>& table, const U* object) {
  return object != nullptr ? table.write(*object) : Json();
}
template <class U>
Json write_table(const Schema<U>& table, const std::optional<U>& object) {
  return object ? table.write(*object) : Json();
}
template <class U>
Json write_table(const Schema<U>& table, const std::vector<U>& objects) {
  Json out = Json::array();
  for (const U& one : objects) out.push_back(table.write(one));
  return out;
}
template <class U>
Json write_table(const Schema<U>& table, const std::vector<std::pair<std::string, U>>& named) {
  Json out = Json::object();
  for (const auto& [name, one] : named) out[name] = table.write(one);
  return out;
}
template <class M>
inline constexpr int table_lists = 0;
template <class U>
inline constexpr int table_lists<std::vector<U>> = 1;
template <class U>
inline constexpr int table_lists<std::vector<std::pair<std::string, U>>> = 0;

}  // namespace detail

/// A key that holds a table, or a list of them, written from the whole object.
/// @param value  (const T&) -> U, a vector of U or of names with U, const U* or std::optional<U>: null where there is
///     none
template <class F, class U>
requires requires {
  &F::operator();
}
[[nodiscard]] auto key(const std::string& name, F value, const Schema<U>& table, const std::string& meaning) {
  using T = typename detail::Getter<F>::Object;
  Row<T> row{.key = {.name = name,
                     .holds = Holds::table,
                     .lists = detail::table_lists<typename detail::Getter<F>::Value>,
                     .named = detail::is_named<typename detail::Getter<F>::Value>,
                     .table = &table.info(),
                     .meaning = meaning}};
  row.write = [value, &table](const T& object, const Row<T>&) { return detail::write_table(table, value(object)); };
  return row;
}

/// A table that a pointer of the object leads to; null where there is none. Written only.
template <class T, class U>
[[nodiscard]] Row<T> key(const std::string& name, const U* T::*member, const Schema<U>& table,
                         const std::string& meaning) {
  return key(
      name, [member](const T& object) { return object.*member; }, table, meaning);
}

/// Rows after others.
template <class T>
void add_rows(std::vector<Row<T>>& rows, std::vector<Row<T>> more) {
  for (Row<T>& row : more) rows.push_back(std::move(row));
}

/// The keys of another table, written from a part of the object.
/// @param part  (const T&) -> the part of an object
template <class T, class U, class Part>
[[nodiscard]] std::vector<Row<T>> keys_of(const std::vector<Row<U>>& rows, Part part) {
  std::vector<Row<T>> out;
  out.reserve(rows.size());
  for (const Row<U>& row : rows) {
    Row<T> lifted{.key = row.key,
                  .member = row.member,
                  .factor = row.factor,
                  .every_digit = row.every_digit,
                  .always = row.always,
                  .drops_null = row.drops_null};
    lifted.write = [row, part](const T& object, const Row<T>&) { return row.write(part(object), row); };
    out.push_back(std::move(lifted));
  }
  return out;
}

/// A table of what was assumed: `assumed` of every document.
[[nodiscard]] const Schema<Assumption>& assumption_table();

}  // namespace robomill::io
