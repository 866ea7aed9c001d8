#pragma once
// For .cpp files inside the library, as json.hpp.
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "robomill/io/json.hpp"
#include "robomill/io/key_unit.hpp"

namespace robomill::io {

/// What a key holds.
enum class Holds {
  number,
  integer,
  boolean,
  text,
  path,
  word,
  complex,
  table,
  list  ///< of numbers, texts and booleans, or of such lists, to any depth
};

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
  /// "> 0", "between 0 and 1"; empty: any number.
  [[nodiscard]] std::string range() const;
  /// "must be > 0", "must lie between 0 and 1".
  [[nodiscard]] std::string text() const;
};

struct TableInfo;

/// Of a form's slider, in the unit of its key.
struct Slider {
  double lowest = 0.0, highest = 0.0, step = 0.0;
};

/// A key of a table, as schemas, forms and docs show it.
struct Key {
  std::string name = {};
  Holds holds = Holds::text;
  int lists = 0;                 ///< 1: a list of them, 2: a list of lists
  bool named = false;            ///< an object of them, by names that differ from document to document
  bool or_one = false;           ///< in place of a list one value, for all of its entries
  std::vector<Holds> also = {};  ///< what a value may be instead: a column's number in place of its name
  bool required = false;         ///< a reader rejects a table without it; a writer always writes it
  bool nullable = false;         ///< null: not known, none; of a list its entries
  bool null_list = false;        ///< the list itself may be null
  Rule rule = {};
  std::vector<std::string> words = {};  ///< of Holds::word
  const TableInfo* table = nullptr;     ///< of Holds::table
  std::string meaning = {};             ///< a phrase
  std::string hint = {};                ///< what a reader says where it is missing
  Json default_value = nullptr;         ///< null: none
  std::optional<Slider> slider = {};    ///< where a form moves it
  [[nodiscard]] std::string unit() const { return key_unit(name).text; }
};

/// A table: a document, or a part of one.
struct TableInfo {
  std::string name = {};     ///< "lobes", "tool"
  std::string meaning = {};  ///< a phrase
  std::vector<Key> keys = {};
  Use use = Use::read;
  int version = 0;  ///< of a document: how often its keys have changed their meaning, from 1; 0: no document of its own
  bool several_files = false;  ///< a document whose tables other files may complete: none of their keys is required
  /// "lobes/1", as a document names itself in its key `document`.
  [[nodiscard]] std::string document() const { return name + "/" + std::to_string(version); }
};

/// The JSON Schema (draft 2020-12) of a document; of a table that is none, without its `document` key.
[[nodiscard]] Json json_schema(const TableInfo& document);

/// The table of docs/formats.md: "| `key` | unit, values | default | meaning |", nested tables by their paths.
[[nodiscard]] std::string markdown_table(const TableInfo& table);

}  // namespace robomill::io
