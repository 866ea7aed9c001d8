#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/error.hpp"

namespace robomill::program {

/// A stretch of a program that one tool makes: from where it is mounted to where the next one is.
struct ToolPart {
  std::optional<int> number = {};  ///< none: before the first tool, or of one without a whole number
  std::string name = {};           ///< "T4"; "no tool" before the first one
  std::size_t line = 0;            ///< where it is mounted; before the first tool where it first moves
  std::size_t lines = 0;           ///< statements from there on
  bool moves = false;
};

/// The number of a tool, where it is whole.
[[nodiscard]] std::optional<int> whole_tool(double number);

/// The tools of a program as it mounts them, and which of them are read where one is chosen.
class ToolParts {
 public:
  /// @param chosen  none: all of the program is read
  explicit ToolParts(std::optional<int> chosen) : chosen_(chosen) { now_.name = "no tool"; }

  /// Another statement has come.
  void count_statement() { now_.lines += now_.line > 0 ? 1 : 0; }
  /// … which mounts a tool. The one that is mounted already begins no part.
  void mount(std::optional<int> number, std::string name, std::size_t line);
  /// The tool that is mounted moves in this line.
  void move(std::size_t line);
  /// What has come so far is one part, of no tool.
  void forget();

  /// Moves are not those to be read: another tool is chosen than the one that is mounted.
  [[nodiscard]] bool passes() const { return chosen_ && now_.number != chosen_; }
  [[nodiscard]] bool is_mounted(std::optional<int> number, const std::string& name) const {
    return now_.number == number && now_.name == name;
  }
  /// The part of another tool that has moved since the chosen one did, where that one moves again.
  [[nodiscard]] const ToolPart* between() const { return between_ && !passes() ? &*between_ : nullptr; }
  /// The part that is not over yet.
  [[nodiscard]] const ToolPart& now() const { return now_; }
  /// Some tool has moved.
  [[nodiscard]] bool moved() const { return moved_; }
  /// Those that are a tool's or move, in their order; the first of so many as count().
  [[nodiscard]] std::vector<ToolPart> parts() const;
  [[nodiscard]] std::size_t count() const;

 private:
  [[nodiscard]] bool counts(const ToolPart& part) const { return part.line > 0; }

  std::optional<int> chosen_;
  std::vector<ToolPart> over_;
  std::size_t over_count_ = 0;
  ToolPart now_;
  bool moved_ = false, chosen_moved_ = false;
  std::optional<ToolPart> between_;
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
