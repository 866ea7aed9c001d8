#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace robomill::program {

/// In every locale.
[[nodiscard]] inline bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// A line of LinuxCNC's O words: "o100 sub", "o<hole> call [3]".
struct OWord {
  std::string_view label;    ///< "100", "<hole>"
  std::string_view keyword;  ///< one of LinuxCNC's
  std::string_view rest;     ///< arguments
};
/// @param compact  a line in lower case, without blanks and comments
/// None for a program's number, "o100".
[[nodiscard]] std::optional<OWord> o_word(std::string_view compact);

/// One line of G-code taken apart into words; keeps its memory from line to line.
class GcodeWords {
 public:
  struct Word {
    char letter = 0;        ///< lower case; a comma of the corners ",r5" and ",c5"
    double number = 0.0;    ///< finite
    std::string_view text;  ///< letter and number, without blanks; until the next scan
  };

  /// Blanks within words, comments in parentheses or behind a semicolon, and any case are allowed.
  /// @param file    its name, for errors
  /// @param number  of the line, for errors
  /// Lines of O words, deleted ones and those that begin with % or $ have no words.
  /// @throws InvalidInput if a word cannot be read
  void scan(std::string_view line, const std::string& file, std::size_t number);
  /// Its letters alone, in lower case, without blanks and comments; good until the next call of either.
  std::string_view compact_line(std::string_view line, const std::string& file, std::size_t number);

  [[nodiscard]] const std::vector<Word>& words() const { return words_; }
  [[nodiscard]] std::string_view compact() const { return compact_; }
  /// Where each letter of `compact` stands in the line that was scanned.
  static void find_letters(std::string_view line, std::vector<std::size_t>& places);

 private:
  std::string compact_;
  std::vector<Word> words_;
};

}  // namespace robomill::program
