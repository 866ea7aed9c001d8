#pragma once
#include <hdf5.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/io/file.hpp"
#include "robomill/io/records/hdf5_id.hpp"

namespace robomill::io {

/// Columns of one length in a new HDF5 file: each a compressed data set of its name, with its unit. The same rows make
/// the same bytes. The file appears whole or not at all. Every member throws InvalidInput where the place cannot be
/// written.
class Hdf5Table {
 public:
  explicit Hdf5Table(const std::filesystem::path& path);
  /// Begins anew: no columns, no attributes.
  void restart();

  // Attributes of the file.
  void attribute(const char* name, const std::string& value) { attribute_of(file_.get(), name, value); }
  void attribute(const char* name, double value) { attribute_of(file_.get(), name, value); }

  /// What a column holds.
  enum class Kind {
    real,   ///< 64 bit
    whole,  ///< 64 bit, signed
    text    ///< UTF-8 of a bounded length
  };
  /// A column, before the first row. @param longest  bytes of a text
  /// @return its place
  std::size_t column(const std::string& name, const std::string& unit, Kind kind = Kind::real, std::size_t longest = 0);
  /// An attribute of a column.
  void column_attribute(std::size_t place, const char* name, double value) {
    attribute_of(columns_[place].set.get(), name, value);
  }

  // The next values of a row, in the order of the columns.
  void put(double value) {
    Column& column = columns_[next_++];
    column.waiting.push_back(value);
    if (column.waiting.size() == column.chunk_rows) flush(column);
  }
  void put(std::string_view text);
  /// Ends the row.
  void end_row() { next_ = 0; }

  /// The whole file under its temporary name, durable; commit() moves it to its place. Nothing is put afterwards.
  [[nodiscard]] PendingFile& finish();

 private:
  struct Column {
    Hdf5Id type = {}, set = {};
    std::size_t longest = 0;           ///< of a text; 0: numbers
    std::size_t chunk_rows = 0;        ///< that are written together
    hsize_t rows = 0;                  ///< that are written
    std::vector<double> waiting = {};  ///< numbers that are not yet written …
    std::string waiting_text = {};     ///< … or texts, filled up to their length
  };
  void attribute_of(hid_t owner, const char* name, const std::string& value);
  void attribute_of(hid_t owner, const char* name, double value);
  void require(bool good);
  void close();
  void flush(Column& column);

  std::filesystem::path path_;
  PendingFile pending_;
  Hdf5Id file_ = {};
  std::vector<Column> columns_ = {};
  std::size_t next_ = 0;
};

}  // namespace robomill::io
