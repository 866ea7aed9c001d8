#pragma once
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/names.hpp"
#include "robomill/io/toml_source.hpp"

namespace robomill::io {

/// A number of a document: its key, the SI member that it fills and the factor between them.
template <class T>
struct Field {
  const char* key;
  const char* member;
  double factor;
  double T::*value;
};

/// A file of a document, and its content.
struct TomlText {
  std::filesystem::path path;
  std::string content;
};

/// One TOML document while it is read: a file with those that it includes. Every reading call is one row of the file's
/// table: its key, the SI member that it fills and the factor between them; the rows it has seen serve to report errors
/// in the file's own words and to reject unknown keys.
///
/// Keys are full paths: "tool.teeth", "hits[0].file" (tables of an array count from 0 here, from 1 in messages). The
/// bool readers leave `out` alone and return false where the key is absent; a value of the wrong type throws
/// InvalidInput with file, line, key and value.
class TomlFile {
 public:
  /// A key that the source sets has no line in errors.
  /// @throws InvalidInput if the file is missing, empty or no TOML (with line), or if a key cannot be set
  explicit TomlFile(const TomlSource& source);
  ~TomlFile();
  TomlFile(const TomlFile&) = delete;
  TomlFile& operator=(const TomlFile&) = delete;

  /// out = value * factor
  bool number(std::string_view key, std::string_view member, double factor, double& out);
  /// The numbers of a table. @param table  before each key: "tool[0]."; @param member  before each member: "tool[1]."
  template <class T, std::size_t n>
  void fields(const std::string& table, const Field<T> (&rows)[n], T& out, const std::string& member = {}) {
    for (const Field<T>& row : rows) number(table + row.key, member + row.member, row.factor, out.*row.value);
  }
  /// A list of numbers; a single number is a list of one.
  bool numbers(std::string_view key, std::string_view member, double factor, std::vector<double>& out);
  bool integer(std::string_view key, std::string_view member, int& out);
  bool integers(std::string_view key, std::string_view member, std::vector<int>& out);
  bool boolean(std::string_view key, bool& out);
  bool text(std::string_view key, std::string& out);
  /// A list of texts; a single text is a list of one.
  bool texts(std::string_view key, std::vector<std::string>& out);
  /// A path, made relative to the folder of the file that gives it.
  bool path(std::string_view key, std::filesystem::path& out);
  bool paths(std::string_view key, std::vector<std::filesystem::path>& out);
  /// Values as TOML writes them in one line: "3", "\"up\"", "[[1, 2], [3, 4]]". Each entry of a list is one: a number,
  /// a text, true or false, or a list of them to any depth. A single value is a list of one.
  bool literals(std::string_view key, std::vector<std::string>& out);
  /// One of the named values.
  template <class Enum, std::size_t n>
  bool choice(std::string_view key, const Name<Enum> (&names)[n], Enum& out) {
    std::string name;
    if (!text(key, name)) return false;
    const std::optional<Enum> value = value_in(names, name);
    if (!value) throw reject(key, one_of(names));
    out = *value;
    return true;
  }

  /// The file that gives a key, or the innermost table around it: the document, or one that it includes.
  [[nodiscard]] std::filesystem::path file_of(std::string_view key) const;
  /// The file of a part of a job: the one that a key names ("job.lobes"), else the one that gives a table ("lobes").
  [[nodiscard]] std::filesystem::path file_of_part(std::string_view key, std::string_view table) const;
  /// The files that were read, the document first.
  [[nodiscard]] const std::vector<TomlText>& texts() const;
  /// Whether a value of the files was asked for, or its table, and the source did not set it.
  [[nodiscard]] bool took(std::string_view key) const;

  /// Accepts a key or a whole table unread: it is for another reader of the same file.
  void skip(std::string_view key);
  [[nodiscard]] bool has(std::string_view key) const;
  /// Whether the key is there and holds a number.
  [[nodiscard]] bool is_number(std::string_view key) const;
  /// Number of tables in an array of tables; 0 where it is absent.
  [[nodiscard]] std::size_t tables(std::string_view key) const;
  /// Names of the keys in a table, in the order of the file.
  [[nodiscard]] std::vector<std::string> keys(std::string_view table) const;
  /// @throws InvalidInput "file:line: key is missing; hint", the line that of the table it belongs in
  void require(std::string_view key, std::string_view hint = {}) const;

  /// The error for a key of this file: file:line: key = value unit; rule. hint
  [[nodiscard]] InvalidInput reject(std::string_view key, std::string rule, std::string hint = {}) const;
  /// An error about an SI member, or a table as a whole, reported in the words of this file (key, value in the file's
  /// unit, line; of a key that is missing the line of its table); unchanged where the member did not come from here.
  [[nodiscard]] InvalidInput located(const InvalidInput& error) const;
  /// Calls f; an InvalidInput that it throws comes out located.
  template <class F>
  auto locate(F&& f) const {
    try {
      return f();
    } catch (const InvalidInput& error) {
      throw located(error);
    }
  }
  /// Ends the reading. What is unusual() comes back, so that no reader can leave it out of its notes.
  /// @throws InvalidInput on a key that no call has read, naming the nearest known one. A table that readers of other
  ///     documents know (toml_tables.hpp) may stand there, as may their keys in a table that is read here.
  [[nodiscard]] std::vector<std::string> done() const;
  /// A sentence for each number of the file outside its usual range (io/usual_ranges.hpp), in the order of the file's
  /// keys: "Warning: file:line: key = value unit; is unusual: … is usual. hint".
  [[nodiscard]] std::vector<std::string> unusual() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace robomill::io
