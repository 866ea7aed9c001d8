#include "robomill/io/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/key_unit.hpp"
#include "robomill/io/si.hpp"
#include "robomill/io/text.hpp"
#include "robomill/io/usual_ranges.hpp"

namespace robomill::io {
namespace {

constexpr char blanks = ' ';  ///< separator: any run of blanks and tabs

bool is_quoted(std::string_view field) {
  return field.size() >= 2 && field.front() == '"' && field.back() == '"';
}

std::string_view unquoted(std::string_view field) {
  return is_quoted(field) ? trimmed(field.substr(1, field.size() - 2)) : field;
}

/// As a text: within quotes, two of them are one.
std::string text_of(std::string_view field) {
  std::string out(unquoted(field));
  if (!is_quoted(field)) return out;
  for (std::size_t at = 0; (at = out.find("\"\"", at)) != std::string::npos; ++at) out.erase(at, 1);
  return out;
}

/// The fields of a line, with their quotes; separators within these part nothing. A separator at the line's end parts
/// nothing either.
std::vector<std::string_view> split_quoted(std::string_view line, char separator) {
  std::vector<std::string_view> fields;
  if (separator != '\t') line = trimmed(line);  // a first field may be empty
  while (!line.empty()) {
    std::size_t end = 0;
    for (bool quoted = false; end < line.size(); ++end) {
      if (line[end] == '"') quoted = !quoted;
      const bool parts = separator == blanks ? line[end] == ' ' || line[end] == '\t' : line[end] == separator;
      if (parts && !quoted) break;
    }
    fields.push_back(trimmed(line.substr(0, end)));
    line.remove_prefix(std::min(end + 1, line.size()));
    if (separator == blanks) line = trimmed(line);
  }
  return fields;
}

std::vector<std::string_view> split(std::string_view line, char separator) {
  std::vector<std::string_view> fields = split_quoted(line, separator);
  for (std::string_view& field : fields) field = unquoted(field);
  return fields;
}

std::optional<double> parse_field(std::string_view field, char separator) {
  if (std::optional<double> number = parse_number(field)) return number;
  if (separator == ',' || std::count(field.begin(), field.end(), ',') != 1) return std::nullopt;
  std::string with_point(field);
  with_point[with_point.find(',')] = '.';
  return parse_number(with_point);
}

/// Takes the byte order mark off.
void check_encoding(std::string_view& content, const std::string& where) {
  if (content.starts_with("\xEF\xBB\xBF")) content.remove_prefix(3);
  if (content.substr(0, 4096).find('\0') == std::string_view::npos) return;
  const bool utf16 = content.starts_with("\xFF\xFE") || content.starts_with("\xFE\xFF");
  throw InvalidInput(where, "is no plain text", utf16 ? "It is UTF-16: save it as UTF-8" : "Is it a binary file?");
}

/// The next line, taken off the front with its ending.
std::string_view take_line(std::string_view& rest) {
  const std::size_t end = rest.find_first_of("\r\n");
  const std::string_view line = rest.substr(0, end);
  rest.remove_prefix(std::min(line.size(), rest.size()));
  if (rest.starts_with("\r\n")) {
    rest.remove_prefix(2);
  } else if (!rest.empty()) {
    rest.remove_prefix(1);
  }
  return line;
}

class TableReader {
 public:
  TableReader(std::string_view content, const std::string& where) : content_(content), rest_(content), where_(where) {}

  Table read() {
    check_encoding(rest_, where_);
    read_header();
    while (!rest_.empty()) {
      const std::string_view line = next_line();
      if (!read_quickly(line) && !is_table_comment(line)) read_carefully(line);
    }
    return std::move(table_);
  }

 private:
  [[nodiscard]] InvalidInput error(std::string rule, std::string field = {}, std::string_view value = {},
                                   std::string hint = {}) const {
    return InvalidInput(InvalidInput::Parts{.where = fmt::format("{}:{}", where_, line_number_),
                                            .field = std::move(field),
                                            .value = value.empty() ? "" : fmt::format("\"{}\"", value.substr(0, 40)),
                                            .rule = std::move(rule),
                                            .hint = std::move(hint)});
  }

  std::string_view next_line() {
    ++line_number_;
    return take_line(rest_);
  }

  /// On to the first line of numbers, which determines the separator and the number of columns.
  void read_header() {
    std::vector<std::pair<std::size_t, std::string_view>> header;
    while (!rest_.empty()) {
      const std::string_view before = rest_;
      const std::string_view line = next_line();
      if (is_table_comment(line)) continue;
      // Columns lined up with tabs may have several between them.
      separator_ = separator_of(line) == '\t' ? blanks : separator_of(line);
      const std::vector<std::string_view> fields = split(line, separator_);
      const auto is_number = [this](std::string_view field) { return parse_field(field, separator_).has_value(); };
      if (std::all_of(fields.begin(), fields.end(), is_number)) {
        rest_ = before;
        table_.begin = static_cast<std::size_t>(before.data() - content_.data());
        --line_number_;
        take_names(header, fields.size());
        return;
      }
      if (is_number(fields.front()) && fields.size() > 1) {
        const auto wrong = std::find_if_not(fields.begin(), fields.end(), is_number);
        throw error(wrong->empty() ? "is empty" : "is no number",
                    column_name(static_cast<std::size_t>(wrong - fields.begin())), *wrong);
      }
      if (header.size() == max_header_lines) throw error("is no number", {}, trimmed(line));
      header.emplace_back(line_number_, line);
    }
    throw InvalidInput(where_, "holds no line of numbers");
  }

  void take_names(const std::vector<std::pair<std::size_t, std::string_view>>& header, std::size_t count) {
    table_.columns.resize(count);
    std::vector<std::string_view> names, below;
    for (std::size_t back = 1; back <= std::min<std::size_t>(header.size(), 2); ++back) {
      const std::string_view line = header[header.size() - back].second;
      // The names may be parted otherwise than the numbers, but words of prose are no names.
      const char separator = separator_of(line) == blanks ? separator_ : separator_of(line);
      std::vector<std::string_view> fields = split(line, separator);
      if (fields.size() != count && separator == '\t') fields = split(line, blanks);
      if (fields.size() != count) break;
      // Above the names a number says something of the record: "sample rate, 25600".
      const auto is_number = [this](std::string_view field) { return parse_field(field, separator_).has_value(); };
      if (back == 2 && std::any_of(fields.begin(), fields.end(), is_number)) break;
      below = std::exchange(names, std::move(fields));
    }
    table_.names.assign(names.begin(), names.end());
    if (below.empty()) return;
    const std::string line = fmt::format("{}:{}", where_, header.back().first);
    table_.units = units_of_row({below.begin(), below.end()}, table_.names, line).value_or(std::vector<std::string>());
  }

  [[nodiscard]] std::string column_name(std::size_t column) const {
    const bool named = column < table_.names.size() && !table_.names[column].empty();
    return named ? table_.names[column] : fmt::format("column {}", column + 1);
  }

  /// Plain numbers between separators; anything else is left to read_carefully.
  bool read_quickly(std::string_view line) {
    const char* at = line.data();
    const char* const end = at + line.size();
    const std::size_t count = table_.columns.size();
    std::size_t column = 0;
    for (; column < count; ++column) {
      while (at != end && (*at == ' ' || *at == '\t')) ++at;
      double value = 0.0;
      const std::from_chars_result read = std::from_chars(at, end, value);
      if (read.ec != std::errc() || !std::isfinite(value)) break;
      at = read.ptr;
      const char* const after = at;
      while (at != end && (*at == ' ' || *at == '\t')) ++at;
      const bool last = column + 1 == count;
      if (last != (at == end)) break;
      if (!last && separator_ != blanks) {
        if (*at++ != separator_) break;
      } else if (!last && at == after) {
        break;
      }
      table_.columns[column].push_back(value);
    }
    if (column == count) return true;
    for (std::size_t i = 0; i < column; ++i) table_.columns[i].pop_back();
    return false;
  }

  void read_carefully(std::string_view line) {
    const std::vector<std::string_view> fields = split(line, separator_);
    if (fields.size() != table_.columns.size()) {
      throw error(fmt::format("has {} values where the lines before it have {}", fields.size(), table_.columns.size()));
    }
    for (std::size_t column = 0; column < fields.size(); ++column) {
      const std::optional<double> number = parse_field(fields[column], separator_);
      if (!number)
        throw error(fields[column].empty() ? "is empty" : "is no number", column_name(column), fields[column]);
      if (!std::isfinite(*number)) throw error("must be a finite number", column_name(column), fields[column]);
      table_.columns[column].push_back(*number);
    }
  }

  std::string_view content_, rest_;
  const std::string& where_;
  std::size_t line_number_ = 0;
  char separator_ = blanks;
  Table table_;
};

}  // namespace

bool is_table_comment(std::string_view line) {
  line = trimmed(line);
  return line.empty() || line.front() == '#' || line.front() == '%' || line.starts_with("//");
}

char separator_of(std::string_view line) {
  for (const char separator : {';', '\t', ','}) {
    if (trimmed(line).find(separator) != std::string_view::npos) return separator;
  }
  return blanks;
}

std::vector<std::string> split_texts(std::string_view line, char separator) {
  std::vector<std::string> out;
  for (const std::string_view field : split_quoted(line, separator)) out.push_back(text_of(field));
  return out;
}

std::optional<std::vector<std::string>> units_of_row(const std::vector<std::string>& fields,
                                                     const std::vector<std::string>& names, const std::string& where) {
  std::vector<std::string> units;
  std::size_t filled = 0, bracketed = 0, known = 0;
  for (const std::string& field : fields) {
    std::string_view text = trimmed(field);
    const bool in_brackets = text.size() >= 2 && ((text.front() == '(' && text.back() == ')') ||
                                                  (text.front() == '[' && text.back() == ']'));
    if (in_brackets) text = trimmed(text.substr(1, text.size() - 2));
    units.emplace_back(text);
    filled += field.empty() ? 0 : 1;
    bracketed += in_brackets ? 1 : 0;
    known += !text.empty() && is_unit(text) ? 1 : 0;
  }
  if (filled == 0 || (2 * known < filled && bracketed < filled)) return std::nullopt;
  for (std::size_t i = 0; i < units.size(); ++i) {
    if (units[i].empty() || is_unit(units[i])) continue;
    const bool named = i < names.size() && !names[i].empty();
    throw InvalidInput(InvalidInput::Parts{.where = where,
                                           .field = named ? names[i] : fmt::format("column {}", i + 1),
                                           .value = fmt::format("\"{}\"", units[i].substr(0, 40)),
                                           .rule = "is no unit known here, in a row of units",
                                           .hint = "Known are N, kN, m/s^2, g, mm, um, V, mV, s, ms and the like"});
  }
  return units;
}

Table parse_table(std::string_view content, const std::string& where, std::vector<std::string>& warnings) {
  Table table = TableReader(content, where).read();
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    const auto by_size = [](double value) { return std::abs(value); };
    const double largest = *std::ranges::max_element(table.columns[i], {}, by_size);
    if (auto warning = unusual_warning(where, table.names[i], std::span(&largest, 1)))
      warnings.push_back(std::move(*warning));
  }
  return table;
}

std::optional<double> parse_cell(std::string_view field) {
  return parse_field(field, ';');
}

std::optional<std::size_t> TextTable::column(std::string_view name) const {
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) return std::nullopt;
  return static_cast<std::size_t>(found - names.begin());
}

std::string_view TextTable::text(const Row& row, std::string_view name) const {
  const std::optional<std::size_t> place = column(name);
  return place ? std::string_view(row.fields[*place]) : std::string_view();
}

void TextTable::require_known(const std::vector<std::string>& known) const {
  for (const std::string& name : names) {
    if (std::ranges::find(known, name) != known.end()) continue;
    const std::string near = nearest_word(name, known);
    throw InvalidInput(where, fmt::format("has a column {} that is not known here", name),
                       near.empty() ? "" : fmt::format("Did you mean {}?", near));
  }
}

InvalidInput TextTable::reject(const Row& row, std::string_view name, std::string rule, std::string hint) const {
  InvalidInput::Parts parts{.where = fmt::format("{}:{}", where, row.line),
                            .field = std::string(name),
                            .rule = std::move(rule),
                            .hint = std::move(hint)};
  const std::string_view field = text(row, name);
  parts.number = field.empty() ? std::nullopt : parse_cell(field);
  if (parts.number) {
    parts.unit = unit_of_key(name);
  } else if (!field.empty()) {
    parts.value = fmt::format("\"{}\"", field);
  }
  return InvalidInput(std::move(parts));
}

void warn_of_unusual(const TextTable& table, std::vector<std::string>& warnings) {
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    const UsualRange* row_of_key = usual_range(table.names[i]);
    if (row_of_key == nullptr) continue;
    const bool each = row_of_key->compared == Compared::each;
    std::vector<double> values;
    std::size_t line = 0;  // of the largest
    double largest = 0.0;
    std::optional<std::string> warning;
    for (const TextTable::Row& row : table.rows) {
      const std::optional<double> value = parse_cell(row.fields[i]);
      if (!value) continue;
      if (each) warning = unusual_warning(fmt::format("{}:{}", table.where, row.line), table.names[i], {&*value, 1});
      if (warning) break;
      values.push_back(*value);
      if (line == 0 || std::abs(*value) > largest) line = row.line;
      largest = std::max(largest, std::abs(*value));
    }
    if (!each) warning = unusual_warning(fmt::format("{}:{}", table.where, line), table.names[i], values);
    if (warning) warnings.push_back(std::move(*warning));
  }
}

TextTable parse_text_table(std::string_view content, const std::string& where, std::vector<std::string>& warnings) {
  check_encoding(content, where);
  TextTable out{.where = where};
  char separator = ',';
  for (std::size_t line_number = 1; !content.empty(); ++line_number) {
    const std::string_view line = take_line(content);
    if (is_table_comment(line)) continue;
    const auto reject = [&](std::string rule, std::string hint = {}) {
      return InvalidInput(InvalidInput::Parts{
          .where = fmt::format("{}:{}", where, line_number), .rule = std::move(rule), .hint = std::move(hint)});
    };
    if (out.names.empty()) {
      if (separator_of(line) != blanks) separator = separator_of(line);
      for (std::string& name : split_texts(line, separator)) {
        if (name.empty()) throw reject("has a column without a name");
        if (std::find(out.names.begin(), out.names.end(), name) != out.names.end()) {
          throw reject(fmt::format("names the column {} twice", name));
        }
        out.names.push_back(std::move(name));
      }
      continue;
    }
    std::vector<std::string> fields = split_texts(line, separator);
    if (fields.size() > out.names.size()) {
      throw reject(fmt::format("has {} fields where there are {} columns", fields.size(), out.names.size()),
                   separator == ',' ? "Decimal commas need semicolons between the columns" : "");
    }
    TextTable::Row row{.line = line_number, .fields = std::move(fields)};
    row.fields.resize(out.names.size());
    out.rows.push_back(std::move(row));
  }
  if (out.rows.empty()) throw InvalidInput(where, "holds no row below a line of names");
  warn_of_unusual(out, warnings);
  return out;
}

}  // namespace robomill::io
