#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/program/files/program_files.hpp"

namespace robomill::program {

/// Names of what has none.
inline constexpr const char* before_tools = "no tool";
inline constexpr const char* nameless_tool = "one without a number";

/// A stretch of a program that one tool makes: from where it is mounted to where the next one is.
struct ToolPart {
  std::optional<int> number = {};  ///< none: before the first tool, or of one without a whole number
  std::string name = {};           ///< "T4"; "no tool" before the first one
  std::size_t line = 0;            ///< where it is mounted; before the first tool where it first moves
  std::size_t lines = 0;           ///< statements from there on
  bool moves = false;
  [[nodiscard]] bool can_be_chosen() const { return number || (name != before_tools && name != nameless_tool); }
};

/// The number of a tool, where it is whole.
[[nodiscard]] std::optional<int> whole_tool(double number);

/// One of the parts of a tool: its moves between those of other tools.
struct NumberedPart {
  ToolPart part = {};
  int number = 1;  ///< of the tool's parts, from 1 on
  int count = 1;   ///< of the tool's parts
};

/// Mounted parts by tool: those of one tool are one part while no other tool moves between them. In the order in
/// which they begin.
[[nodiscard]] std::vector<NumberedPart> numbered_parts(const std::vector<ToolPart>& parts);

/// What reads that part alone.
[[nodiscard]] ToolChoice choice_of(const NumberedPart& part);
/// "T4", "part 2 of T4".
[[nodiscard]] std::string text_of(const ToolChoice& choice);

/// The tools of a program as it mounts them, and which of them are read where one is chosen.
class ToolParts {
 public:
  explicit ToolParts(ToolChoice chosen) : chosen_(std::move(chosen)) { now_.name = before_tools; }

  /// Another statement has come.
  void count_statement() { now_.lines += now_.line > 0 ? 1 : 0; }
  /// … which mounts a tool. The one that is mounted already begins no part.
  void mount(std::optional<int> number, std::string name, std::size_t line);
  /// The tool that is mounted moves in this line.
  void move(std::size_t line);
  /// What has come so far is one part, of no tool.
  void forget();

  /// Moves are not those to be read: another tool is chosen than the one that is mounted.
  [[nodiscard]] bool passes() const;
  [[nodiscard]] bool is_mounted(std::optional<int> number, const std::string& name) const {
    return now_.number == number && now_.name == name;
  }
  /// The part of another tool that has moved since the chosen one did, where that one moves again and its part is not
  /// chosen.
  [[nodiscard]] const ToolPart* between() const {
    return between_ && !chosen_.part && !passes() ? &*between_ : nullptr;
  }
  /// Parts of the chosen tool that have moved.
  [[nodiscard]] int moved_parts() const { return moved_parts_; }
  /// The part that is not over yet.
  [[nodiscard]] const ToolPart& now() const { return now_; }
  /// Some tool has moved.
  [[nodiscard]] bool moved() const { return moved_; }
  /// Those that are a tool's or move, in their order; the first of so many as count().
  [[nodiscard]] std::vector<ToolPart> parts() const;
  [[nodiscard]] std::size_t count() const;

 private:
  [[nodiscard]] bool counts(const ToolPart& part) const { return part.line > 0; }

  ToolChoice chosen_;
  std::vector<ToolPart> over_;
  std::size_t over_count_ = 0;
  ToolPart now_;
  bool moved_ = false;
  int moved_parts_ = 0;
  std::optional<ToolPart> between_;  ///< of another tool, moved since the chosen one did
};

/// Tools that a message lists.
inline constexpr std::size_t most_named_tools = 12;
/// "a, b and c", and how many more there are.
[[nodiscard]] std::string list_text(const std::vector<std::string>& listed, std::size_t more);

/// A program cuts with several tools, and none is chosen.
class SeveralTools final : public InvalidInput {
 public:
  /// @param bare   without the tools
  /// @param count  of the parts, of which a reader may keep the first ones alone
  SeveralTools(Parts bare, std::vector<ToolPart> tools, std::size_t count);
  [[nodiscard]] const Parts& bare() const { return bare_; }
  [[nodiscard]] const std::vector<ToolPart>& tools() const { return tools_; }
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  Parts bare_;
  std::vector<ToolPart> tools_;
  std::size_t count_;
};

}  // namespace robomill::program
