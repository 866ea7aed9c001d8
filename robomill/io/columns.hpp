#pragma once
// For .cpp files inside the library, as json.hpp.
#include <string>
#include <utility>
#include <vector>

#include "robomill/io/json.hpp"
#include "robomill/io/schema.hpp"

namespace robomill::io {

/// Adds a cell of a CSV: nothing for null, text in quotes, 9 significant digits of a number that is not whole.
void append_cell(std::string& line, const Json& cell);

/// A table whose rows are objects, column by column: a CSV, or an object with a list a key. A key that is absent of
/// the first object is no column.
template <class T>
class Columns {
 public:
  explicit Columns(const Schema<T>& of) : of_(&of), info_(of.info()) {
    for (Key& key : info_.keys) {
      ++key.lists;
      key.required = false;
    }
  }
  [[nodiscard]] const TableInfo& info() const { return info_; }

  [[nodiscard]] Json write(const std::vector<T>& lines) const {
    Json out = Json::object();
    for (const Row<T>* row : columns_of(lines.empty() ? nullptr : &lines.front())) {
      Json& list = out[row->key.name] = Json::array();
      for (const T& line : lines) list.push_back(of_->value(*row, line));
    }
    return out;
  }

  [[nodiscard]] std::string csv(const std::vector<T>& lines) const {
    std::string out;
    CsvRows rows(*this);
    for (const T& line : lines) rows.add(out, line);
    rows.end(out);
    return out;
  }

  /// The CSV row by row: its lines are never held together.
  class CsvRows {
   public:
    /// @param of  outlives this
    explicit CsvRows(const Columns& of) : of_(of) {}
    /// Adds a line to a text; before the first one their names.
    void add(std::string& out, const T& line) {
      if (!begun_) begin(out, of_.columns_of(&line));
      for (const Row<T>* row : rows_) {
        if (row != rows_.front()) out += ',';
        append_cell(out, of_.of_->value(*row, line));
      }
      out += '\n';
    }
    /// The names alone where there was no line.
    void end(std::string& out) {
      if (!begun_) begin(out, of_.columns_of(nullptr));
    }

   private:
    void begin(std::string& out, std::vector<const Row<T>*> rows) {
      begun_ = true;
      rows_ = std::move(rows);
      for (const Row<T>* row : rows_) {
        if (row != rows_.front()) out += ',';
        out += row->key.name;
      }
      out += '\n';
    }
    const Columns& of_;
    std::vector<const Row<T>*> rows_;
    bool begun_ = false;
  };

 private:
  /// @param first  line; null: there is none
  [[nodiscard]] std::vector<const Row<T>*> columns_of(const T* first) const {
    std::vector<const Row<T>*> out;
    for (const Row<T>& row : of_->rows()) {
      if (first == nullptr || !of_->value(row, *first).is_discarded()) out.push_back(&row);
    }
    return out;
  }
  const Schema<T>* of_;
  TableInfo info_;
};

/// A key that holds a table by its columns.
/// @param lines  (const T&) -> std::vector<U>
template <class F, class U>
[[nodiscard]] auto columns_key(const std::string& name, F lines, const Columns<U>& columns,
                               const std::string& meaning) {
  using T = typename detail::Getter<F>::Object;
  Row<T> row{.key = {.name = name, .holds = Holds::table, .table = &columns.info(), .meaning = meaning}};
  row.write = [lines, &columns](const T& object, const Row<T>&) { return columns.write(lines(object)); };
  return row;
}

}  // namespace robomill::io
