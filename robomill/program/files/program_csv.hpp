#pragma once
#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

#include "robomill/program/files/program_reader.hpp"

namespace robomill::program {

/// Reads programs of columns; program_files.hpp says which.
class CsvReader final : public ProgramReader {
 public:
  using ProgramReader::ProgramReader;

  /// Of each column of the file, which of x, y, z, i, j, k, feed it is; none before the header.
  [[nodiscard]] const std::vector<std::size_t>& columns() const { return column_; }
  [[nodiscard]] char separator() const { return separator_; }

  [[nodiscard]] Part part_of(std::string_view line, char, bool) const override { return {.text = line}; }

 private:
  static constexpr std::size_t known_columns = 7;

  void read(std::string_view statement) override;

  void take_header(std::string_view line);
  /// The row's numbers, by known column. A feed that is empty on the first row is 0.
  void take_numbers(std::string_view line);
  bool take_plain_numbers(std::string_view line);

  char separator_ = 0;                          ///< 0: no header yet
  std::vector<std::size_t> column_;             ///< of each column of the file, which known one it is
  std::array<double, known_columns> row_ = {};  ///< x, y, z, i, j, k, feed as written
};

}  // namespace robomill::program
