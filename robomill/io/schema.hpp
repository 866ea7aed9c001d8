#pragma once
// For .cpp files inside the library, as json.hpp.
#include <Eigen/Core>
#include <array>
#include <complex>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "robomill/base/names.hpp"
#include "robomill/io/json.hpp"
#include "robomill/io/key_unit.hpp"
#include "robomill/io/toml_file.hpp"

namespace robomill::io {

/// What a key holds.
enum class Holds { number, integer, boolean, text, path, word, complex, table };

/// What a table is for.
enum class Use {
  read,    ///< by people, or by both: keys have defaults
  written  ///< by this program alone
};

/// What a value must keep, in the unit of its key.
struct Rule {
  double lowest = -std::numeric_limits<double>::infinity(), highest = std::numeric_limits<double>::infinity();
  bool above = false, below = false;  ///< the bound itself is excluded
  std::size_t entries = 0;            ///< of a list; 0: any number
  std::string hint = {};              ///< the likely cause of a value that does not
  [[nodiscard]] bool keeps(double value) const;
  /// "must be > 0", "must lie between 0 and 1".
  [[nodiscard]] std::string text() const;
};

struct TableInfo;

/// A key of a table, as schemas, forms and docs show it.
struct Key {
  std::string name = {};
  Holds holds = Holds::text;
  int lists = 0;           ///< 1: a list of them, 2: a list of lists
  bool named = false;      ///< an object of them, by names that differ from document to document
  bool or_one = false;     ///< in place of a list one value, for all of its entries
  bool required = false;   ///< a reader rejects a table without it; a writer always writes it
  bool nullable = false;   ///< null: not known, none; of a list its entries
  bool null_list = false;  ///< the list itself may be null
  Rule rule = {};
  std::vector<std::string> words = {};  ///< of Holds::word
  const TableInfo* table = nullptr;     ///< of Holds::table
  std::string meaning = {};             ///< a phrase
  std::string hint = {};                ///< what a reader says where it is missing
  Json default_value = nullptr;         ///< null: none
  [[nodiscard]] std::string unit() const { return key_unit(name).text; }
};

/// A table: a document, or a part of one.
struct TableInfo {
  std::string name = {};     ///< "lobes", "tool"
  std::string meaning = {};  ///< a phrase
  std::vector<Key> keys = {};
  Use use = Use::read;
  int version = 0;  ///< of a document: how often its keys have changed their meaning, from 1; 0: no document of its own
  /// "lobes/1", as a document names itself in its key `document`.
  [[nodiscard]] std::string document() const { return name + "/" + std::to_string(version); }
};

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

  Row& required(std::string hint = {}) {
    key.required = true;
    key.hint = std::move(hint);
    return *this;
  }
  Row& above(double low) {
    key.rule.lowest = low;
    key.rule.above = true;
    return *this;
  }
  Row& at_least(double low) {
    key.rule.lowest = low;
    return *this;
  }
  Row& at_most(double high, std::string hint = {}) {
    key.rule.highest = high;
    key.rule.hint = std::move(hint);
    return *this;
  }
  Row& below(double high) {
    key.rule.highest = high;
    key.rule.below = true;
    return *this;
  }
  Row& entries(std::size_t count) {
    key.rule.entries = count;
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

namespace detail {

template <class M>
struct Holding;  // what a member of type M is in a file
template <>
struct Holding<double> {
  static constexpr Holds holds = Holds::number;
  static constexpr int lists = 0;
};
template <class M>
requires std::is_integral_v<M>
struct Holding<M> {
  static constexpr Holds holds = std::is_same_v<M, bool> ? Holds::boolean : Holds::integer;
  static constexpr int lists = 0;
};
template <>
struct Holding<std::string> {
  static constexpr Holds holds = Holds::text;
  static constexpr int lists = 0;
};
template <>
struct Holding<std::string_view> : Holding<std::string> {};
template <>
struct Holding<const char*> : Holding<std::string> {};
template <>
struct Holding<std::filesystem::path> {
  static constexpr Holds holds = Holds::path;
  static constexpr int lists = 0;
};
template <>
struct Holding<std::complex<double>> {
  static constexpr Holds holds = Holds::complex;
  static constexpr int lists = 0;
};
template <class M>
struct Holding<std::optional<M>> : Holding<M> {};
template <class M>
struct Holding<std::vector<M>> {
  static constexpr Holds holds = Holding<M>::holds;
  static constexpr int lists = Holding<M>::lists + 1;
};
template <class M>
struct Holding<std::vector<std::pair<std::string, M>>> : Holding<M> {};
template <class M, std::size_t n>
struct Holding<std::array<M, n>> : Holding<std::vector<M>> {};
template <int n>
struct Holding<Eigen::Matrix<double, n, 1>> : Holding<std::vector<double>> {};
template <>
struct Holding<Eigen::MatrixXd> : Holding<std::vector<std::vector<double>>> {};

/// Whether values stand by names that differ from document to document.
template <class M>
inline constexpr bool is_named = false;
template <class M>
inline constexpr bool is_named<std::vector<std::pair<std::string, M>>> = true;

/// What a function of an object takes and gives.
template <class F>
struct Getter : Getter<decltype(&F::operator())> {};
template <class F, class R, class T>
struct Getter<R (F::*)(T) const> {
  using Object = std::remove_cvref_t<T>;
  using Value = std::remove_cvref_t<R>;
};

/// Of each kind of member how it is read and written.
/// @throws InvalidInput by TomlFile::reject where a value breaks the rule
bool read_value(TomlFile& file, const std::string& path, const std::string& member, double factor, const Key& key,
                double& out);
bool read_value(TomlFile& file, const std::string& path, const std::string& member, double factor, const Key& key,
                int& out);
bool read_value(TomlFile& file, const std::string& path, const std::string& member, double factor, const Key& key,
                bool& out);
bool read_value(TomlFile& file, const std::string& path, const std::string& member, double factor, const Key& key,
                std::string& out);
bool read_value(TomlFile& file, const std::string& path, const std::string& member, double factor, const Key& key,
                std::filesystem::path& out);
bool read_value(TomlFile& file, const std::string& path, const std::string& member, double factor, const Key& key,
                std::vector<double>& out);
bool read_value(TomlFile& file, const std::string& path, const std::string& member, double factor, const Key& key,
                std::vector<int>& out);
bool read_value(TomlFile& file, const std::string& path, const std::string& member, double factor, const Key& key,
                std::vector<std::string>& out);
template <class M>
bool read_value(TomlFile& file, const std::string& path, const std::string& member, double factor, const Key& key,
                std::optional<M>& out) {
  M value{};
  if (!read_value(file, path, member, factor, key, value)) return false;
  out = std::move(value);
  return true;
}
template <class M, std::size_t n>
bool read_value(TomlFile& file, const std::string& path, const std::string& member, double factor, const Key& key,
                std::array<M, n>& out) {
  std::vector<M> values;
  if (!read_value(file, path, member, factor, key, values)) return false;
  if (values.size() != n) throw file.reject(path, "must hold " + std::to_string(n) + " numbers");
  std::copy(values.begin(), values.end(), out.begin());
  return true;
}

/// How numbers are shown.
struct Shown {
  double factor = 1.0;
  bool exact = false;
};
Json write_value(double value, const Shown& shown);
Json write_value(const std::complex<double>& value, const Shown& shown);
Json write_value(const std::filesystem::path& value, const Shown& shown);
/// A row of the matrix a list.
Json write_value(const Eigen::MatrixXd& values, const Shown& shown);
template <class M>
requires std::is_integral_v<M> Json write_value(M value, const Shown& /*shown*/) {
  return value;
}
inline Json write_value(const std::string& value, const Shown& /*shown*/) {
  return value;
}
inline Json write_value(std::string_view value, const Shown& /*shown*/) {
  return value;
}
inline Json write_value(const char* value, const Shown& /*shown*/) {
  return value;
}
template <class M>
Json write_value(const std::optional<M>& value, const Shown& shown) {
  return value ? write_value(*value, shown) : Json();
}
/// An object of values by their names.
template <class M>
Json write_value(const std::vector<std::pair<std::string, M>>& named, const Shown& shown) {
  Json out = Json::object();
  for (const auto& [name, value] : named) out[name] = write_value(value, shown);
  return out;
}
template <class List>
requires requires(const List& list) {
  list.begin();
} &&(!std::is_convertible_v<List, std::string_view>)Json write_value(const List& list, const Shown& shown) {
  Json out = Json::array();
  for (const auto& value : list) out.push_back(write_value(value, shown));
  return out;
}

}  // namespace detail

/// A key that a member holds. Its unit is that of the key's name (key_unit), which gives the factor and the member's
/// name in errors; it is readable where the member's type is one that TOML has.
template <class T, class M>
[[nodiscard]] Row<T> key(std::string name, M T::*member, std::string meaning) {
  const KeyUnit unit = key_unit(name);
  Row<T> row{.key = {.name = std::move(name),
                     .holds = detail::Holding<M>::holds,
                     .lists = detail::Holding<M>::lists,
                     .meaning = std::move(meaning)},
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
[[nodiscard]] Row<T> key(std::string name, E T::*member, const Name<E> (&names)[n], std::string meaning) {
  Row<T> row{.key = {.name = std::move(name), .holds = Holds::word, .meaning = std::move(meaning)}};
  for (const auto& [word, value] : names) row.key.words.emplace_back(word);
  row.read = [member, &names](TomlFile& file, const std::string& path, const Row<T>&, T& out) {
    file.choice(path, names, out.*member);
  };
  row.write = [member, &names](const T& object, const Row<T>&) { return text_or_null(name_in(names, object.*member)); };
  return row;
}

/// A key that is written from the whole object.
/// @param value  (const T&) -> number, text, list, …, in SI
template <class F>
requires requires {
  &F::operator();
}
[[nodiscard]] auto key(std::string name, F value, std::string meaning) {
  using T = typename detail::Getter<F>::Object;
  using M = typename detail::Getter<F>::Value;
  const double factor = key_unit(name).factor;
  Row<T> row{.key = {.name = std::move(name),
                     .holds = detail::Holding<M>::holds,
                     .lists = detail::Holding<M>::lists,
                     .named = detail::is_named<M>,
                     .meaning = std::move(meaning)},
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
[[nodiscard]] auto key(std::string name, F value, const Name<E> (&names)[n], std::string meaning) {
  using T = typename detail::Getter<F>::Object;
  Row<T> row{.key = {.name = std::move(name), .holds = Holds::word, .meaning = std::move(meaning)}};
  for (const auto& [word, known] : names) row.key.words.emplace_back(word);
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
             .drops_null = row.drops_null};
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
      } else if (row.read && !row.key.required) {
        row.key.default_value = row.write(fresh, row);
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
  std::vector<Row<T>> rows_;
  TableInfo info_;
};

/// A key that holds another table.
template <class T, class U>
[[nodiscard]] Row<T> key(std::string name, U T::*member, const Schema<U>& table, std::string meaning) {
  Row<T> row{
      .key = {.name = std::move(name), .holds = Holds::table, .table = &table.info(), .meaning = std::move(meaning)}};
  row.read = [member, &table](TomlFile& file, const std::string& path, const Row<T>&, T& out) {
    table.read(file, path, out.*member);
  };
  row.write = [member, &table](const T& object, const Row<T>&) { return table.write(object.*member); };
  return row;
}

/// A key that holds a list of tables.
template <class T, class U>
[[nodiscard]] Row<T> key(std::string name, std::vector<U> T::*member, const Schema<U>& table, std::string meaning) {
  Row<T> row{.key = {.name = std::move(name),
                     .holds = Holds::table,
                     .lists = 1,
                     .table = &table.info(),
                     .meaning = std::move(meaning)}};
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
[[nodiscard]] Row<T> key(std::string name, std::optional<U> T::*member, const Schema<U>& table, std::string meaning) {
  Row<T> row{
      .key = {.name = std::move(name), .holds = Holds::table, .table = &table.info(), .meaning = std::move(meaning)}};
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
[[nodiscard]] auto key(std::string name, F value, const Schema<U>& table, std::string meaning) {
  using T = typename detail::Getter<F>::Object;
  Row<T> row{.key = {.name = std::move(name),
                     .holds = Holds::table,
                     .lists = detail::table_lists<typename detail::Getter<F>::Value>,
                     .named = detail::is_named<typename detail::Getter<F>::Value>,
                     .table = &table.info(),
                     .meaning = std::move(meaning)}};
  row.write = [value, &table](const T& object, const Row<T>&) { return detail::write_table(table, value(object)); };
  return row;
}

/// A table that a pointer of the object leads to; null where there is none. Written only.
template <class T, class U>
[[nodiscard]] Row<T> key(std::string name, const U* T::*member, const Schema<U>& table, std::string meaning) {
  return key(
      std::move(name), [member](const T& object) { return object.*member; }, table, std::move(meaning));
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

/// The JSON Schema (draft 2020-12) of a document; of a table that is none, without its `document` key.
[[nodiscard]] Json json_schema(const TableInfo& document);

/// The table of docs/formats.md: "| `key` | unit, values | default | meaning |", nested tables by their paths.
[[nodiscard]] std::string markdown_table(const TableInfo& table);

}  // namespace robomill::io
