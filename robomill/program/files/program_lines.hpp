#pragma once
#include <cstddef>
#include <filesystem>
#include <istream>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace robomill::program {

/// UTF-8's: before the first line of some texts.
inline constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

/// How a text's first line ends: with LF, CR LF, or CR alone.
struct LineEnd {
  std::size_t at = 0;     ///< where its end begins: behind the text where there is none
  std::size_t bytes = 0;  ///< of the end
};
[[nodiscard]] LineEnd line_end(std::string_view text);

/// The lines of a text one after another; of a file in memory that does not grow with it.
class ProgramLines {
 public:
  static constexpr std::size_t longest = std::size_t{1} << 15;  ///< bytes of a line

  /// @throws InvalidInput if the file cannot be read, is empty, or is no plain text
  explicit ProgramLines(const std::filesystem::path& path);
  /// A text in memory. @param name  of it, for errors
  ProgramLines(std::string name, std::string text);

  /// The next line without its ending, good until the next call; false at the end.
  /// @throws InvalidInput with file and line if it is too long
  bool next(std::string_view& line);
  /// The first letter of the line that comes next, blanks aside; '\n' where there is none.
  [[nodiscard]] char ahead() const;
  /// Of the line that came last, from 1.
  [[nodiscard]] std::size_t number() const { return line_; }
  /// What of the text that comes next is in memory.
  [[nodiscard]] std::string_view head() const { return {buffer_.data() + begin_, end_ - begin_}; }
  /// Begins anew. @throws InvalidInput if the file is a pipe
  void rewind();

 private:
  ProgramLines(std::string name, std::unique_ptr<std::istream> in);
  void fill();

  std::string name_;
  std::unique_ptr<std::istream> in_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0, end_ = 0;  ///< of what the buffer holds
  std::size_t line_ = 0;
  bool whole_ = false;  ///< the file's end is in the buffer
};

}  // namespace robomill::program
