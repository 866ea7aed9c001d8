#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/program/files/program_lines.hpp"

namespace robomill::program {

class GcodeReader;

/// A call of a subprogram, as a line says it.
struct GcodeCall {
  enum class Kind : std::uint8_t {
    program,  ///< M98 P: from the line O of that number on
    line,     ///< M97 P: from the line N of that number on
    label     ///< o… call: from the line o… sub on
  };
  Kind kind = Kind::program;
  std::string label = {};  ///< "70", "<hole>"
  std::size_t repeats = 1;
  std::size_t line = 0;  ///< that calls
};

/// Subprograms of a file: keeps the file's text once one is called, and hands out lines in the order of the calls.
class GcodeCalls {
 public:
  static constexpr std::size_t deepest = 10;
  static constexpr std::size_t most_bytes = std::size_t{1} << 26;  ///< of a file that calls
  static constexpr std::size_t most_lines = 10'000'000;            ///< carried out within calls

  /// @param file   its name, for errors
  /// @param lines  opens the file's lines anew
  GcodeCalls(std::string file, std::function<ProgramLines()> lines) : file_(std::move(file)), open_(std::move(lines)) {}

  /// @throws InvalidInput if the file does not contain it, calls go too deep, or the file is too long to be kept
  void call(const GcodeCall& call);
  /// The subprogram has ended: it begins again, or its caller goes on.
  void give_back();
  [[nodiscard]] std::size_t depth() const { return stack_.size(); }
  /// Carries out what the line that the reader has taken last calls or ends.
  /// @param behind  the line where the main program goes on
  /// @return whether it did either. @throws InvalidInput as call
  bool follow(GcodeReader& reader, std::size_t behind);
  /// How often subprograms have begun so far.
  [[nodiscard]] std::size_t passes() const { return passes_; }

  struct Line {
    std::string_view text;
    std::size_t number = 0;  ///< in the file
    char ahead = '\n';       ///< first letter of the line behind it
    bool again = false;      ///< has been handed out before
  };
  /// The next line of the subprogram that runs. @throws InvalidInput if it does not end, or lines are too many
  [[nodiscard]] Line next();
  /// The program begins anew.
  void rewind();

 private:
  struct Running {
    GcodeCall call;
    std::size_t first = 0, at = 0;  ///< lines, from 0
    std::size_t left = 0;           ///< times that it runs again
  };
  void load();
  void index(std::size_t line);
  [[nodiscard]] std::string_view text_of(std::size_t line) const;
  [[nodiscard]] std::size_t place_of(GcodeCall& call) const;
  [[nodiscard]] std::size_t line_of(const GcodeCall& call) const;

  std::string file_;
  std::function<ProgramLines()> open_;
  std::string text_;
  std::vector<std::size_t> begins_;  ///< of lines in text_, and the end
  std::vector<bool> handed_out_;
  std::map<std::string, std::size_t, std::less<>> programs_, labels_;
  std::multimap<std::string, std::size_t, std::less<>> numbers_;  ///< N words
  std::vector<std::size_t> program_begins_;
  std::vector<Running> stack_;
  std::size_t carried_out_ = 0, passes_ = 0;
};

}  // namespace robomill::program
