#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/error.hpp"

namespace robomill::io {

/// Columns of numbers in a text file.
struct Table {
  std::vector<std::string> names;       ///< one a column; empty where the file has no header
  std::vector<std::string> units = {};  ///< of a row of units below the names, without brackets; empty: no such row
  std::vector<std::vector<double>> columns;  ///< all of one length, >= 1
  std::size_t begin = 0;                     ///< of the first line of numbers in the text
};

/// Reads columns parted by semicolons, tabs, commas or blanks, whichever the first line of numbers shows, in this
/// order.
///
/// Lines that are empty or begin with #, % or // are skipped. Lines before the first line of numbers are a header; the
/// names are the first of the last two of them that have as many fields as there are columns. The second holds units
/// where half of its fields are known ones, or all stand in brackets. Names and numbers may stand in double quotes;
/// numbers may have a sign +, exponents of any length, D for E, and a comma for the point where columns are parted by
/// semicolons or tabs.
/// @param where  names the file in messages
/// @param warnings  gains a sentence for each column whose largest number is unusual of its name (io/usual_ranges.hpp)
/// @throws InvalidInput with file and line if there is no line of numbers, a row of units holds one that is not known,
/// a
///     value is empty or no finite number, or a line has another number of values than those before it
[[nodiscard]] Table parse_table(std::string_view content, const std::string& where, std::vector<std::string>& warnings);

/// Rows of text under named columns.
struct TextTable {
  struct Row {
    std::size_t line = 0;             ///< in the file, from 1
    std::vector<std::string> fields;  ///< as many as there are columns; empty where the row ends before
  };
  std::string where = {};               ///< names the file in messages
  std::vector<std::string> names = {};  ///< one a column
  std::vector<Row> rows = {};

  /// Where a column stands, where there is one.
  [[nodiscard]] std::optional<std::size_t> column(std::string_view name) const;
  /// What a row has in a column; empty where there is no such column.
  [[nodiscard]] std::string_view text(const Row& row, std::string_view name) const;
  /// @throws InvalidInput on a column that is none of these, naming the nearest
  void require_known(const std::vector<std::string>& known) const;
  /// The error for a field: file:line: column = value unit; rule. hint
  [[nodiscard]] InvalidInput reject(const Row& row, std::string_view name, std::string rule,
                                    std::string hint = {}) const;
};

/// The units in the fields of a line below the names of columns, without brackets; none where it is no row of units.
/// @throws InvalidInput naming line and column, if one is not known
[[nodiscard]] std::optional<std::vector<std::string>> units_of_row(const std::vector<std::string>& fields,
                                                                   const std::vector<std::string>& names,
                                                                   const std::string& where);

/// Reads a first line of names and rows below it, parted by semicolons, tabs or commas, whichever the names are. Lines
/// that are empty or begin with #, % or // are skipped; fields may stand in double quotes.
/// @param where  names the file in messages
/// @param warnings  gains a sentence for each column that holds a number which is unusual of its name, the first one
/// @throws InvalidInput with file and line if there is no row, a name is empty or comes twice, or a row has more fields
///     than there are names
[[nodiscard]] TextTable parse_text_table(std::string_view content, const std::string& where,
                                         std::vector<std::string>& warnings);

/// A sentence for each column that holds a number which is unusual of its name: the first one, or the largest where
/// that alone counts (io/usual_ranges.hpp).
void warn_of_unusual(const TextTable& table, std::vector<std::string>& warnings);

/// Whether a line of a table is skipped: empty, or beginning with #, % or //.
[[nodiscard]] bool is_table_comment(std::string_view line);

/// What parts the columns of a line: a semicolon, a tab or a comma, whichever is there, in this order; else a blank,
/// which stands for any run of blanks and tabs.
[[nodiscard]] char separator_of(std::string_view line);

/// The fields of a line, without their quotes; separators within quotes and one at the line's end part nothing.
[[nodiscard]] std::vector<std::string> split_texts(std::string_view line, char separator);

/// The number in a field of such a table, with a point or a comma.
[[nodiscard]] std::optional<double> parse_cell(std::string_view field);

}  // namespace robomill::io
