#include "robomill/program/files/tool_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace robomill::program {
namespace {

constexpr std::size_t most_parts = 100;  ///< that are kept

InvalidInput::Parts with_tools(InvalidInput::Parts parts, const std::vector<ToolPart>& tools, std::size_t count) {
  std::vector<std::string> listed;
  for (const ToolPart& part : tools) {
    if (listed.size() == most_named_tools) break;
    listed.push_back(
        fmt::format("{} (line {}, {} line{})", part.name, part.line, part.lines, part.lines == 1 ? "" : "s"));
  }
  parts.rule += "; the program has " + list_text(listed, count - listed.size());
  return parts;
}

}  // namespace

std::vector<NumberedPart> numbered_parts(const std::vector<ToolPart>& parts) {
  std::vector<NumberedPart> out;
  std::optional<std::size_t> moved_last;
  for (const ToolPart& part : parts) {
    const auto same = [&](const NumberedPart& other) {
      return other.part.number == part.number && other.part.name == part.name;
    };
    const auto last = std::find_if(out.rbegin(), out.rend(), same);
    std::size_t at = static_cast<std::size_t>(std::distance(last, out.rend())) - 1;
    const bool apart = last != out.rend() && part.moves && last->part.moves && moved_last != at;
    if (last == out.rend() || apart) {
      at = out.size();
      out.push_back({.part = part, .number = apart ? last->number + 1 : 1});
    } else {
      last->part.lines += part.lines;
      last->part.moves = last->part.moves || part.moves;
    }
    if (part.moves) moved_last = at;
  }
  for (NumberedPart& one : out) {
    one.count = static_cast<int>(std::ranges::count_if(out, [&](const NumberedPart& other) {
      return other.part.number == one.part.number && other.part.name == one.part.name;
    }));
  }
  return out;
}

ToolChoice choice_of(const NumberedPart& part) {
  ToolChoice out = {.number = part.part.number};
  if (!out.number) out.name = part.part.name;
  if (part.count > 1) out.part = part.number;
  return out;
}

std::string text_of(const ToolChoice& choice) {
  const std::string tool = choice.number ? fmt::format("T{}", *choice.number) : choice.name;
  return choice.part ? fmt::format("part {} of {}", *choice.part, tool) : tool;
}

std::optional<int> whole_tool(double number) {
  constexpr double most = 99'999'999.0;
  if (!(number >= 0.0 && number <= most && number == std::round(number))) return std::nullopt;
  return static_cast<int>(number);
}

bool ToolParts::passes() const {
  if (!chosen_.given()) return false;
  if (!chosen_.is(now_.number, now_.name)) return true;
  const int at = moved_parts_ + (moved_parts_ == 0 || between_ ? 1 : 0);
  return chosen_.part && at != *chosen_.part;
}

void ToolParts::mount(std::optional<int> number, std::string name, std::size_t line) {
  if (now_.lines > 0) --now_.lines;  // the statement that mounts is the new tool's
  // One without a number that has moved nothing is named again: TOOL PATH by LOAD.
  if (counts(now_) && (now_.moves || now_.number)) {
    ++over_count_;
    if (over_.size() < most_parts) over_.push_back(std::move(now_));
  }
  now_ = {.number = number, .name = std::move(name), .line = line, .lines = 1};
}

void ToolParts::move(std::size_t line) {
  if (now_.line == 0) {
    now_.line = line;
    now_.lines = 1;
  }
  now_.moves = moved_ = true;
  if (!chosen_.given()) return;
  if (!chosen_.is(now_.number, now_.name)) {
    if (moved_parts_ > 0 && !between_) between_ = now_;
  } else if (moved_parts_ == 0 || between_) {
    ++moved_parts_;
    if (chosen_.part) between_.reset();
  }
}

void ToolParts::forget() {
  ToolPart all = {.name = before_tools};
  for (const ToolPart& part : parts()) {
    if (part.moves && all.line == 0) all.line = part.line;
    all.moves = all.line > 0;
    all.lines += all.moves ? part.lines : 0;
  }
  *this = ToolParts(chosen_);
  now_ = std::move(all);
  moved_ = now_.moves;
}

std::vector<ToolPart> ToolParts::parts() const {
  std::vector<ToolPart> out = over_;
  if (counts(now_)) out.push_back(now_);
  return out;
}

std::size_t ToolParts::count() const {
  return over_count_ + (counts(now_) ? 1 : 0);
}

std::string list_text(const std::vector<std::string>& listed, std::size_t more) {
  std::string out;
  for (std::size_t i = 0; i < listed.size(); ++i) {
    const bool last = i + 1 == listed.size() && more == 0;
    out += fmt::format("{}{}", i == 0 ? "" : last ? " and " : ", ", listed[i]);
  }
  if (more > 0) out += fmt::format(" and {} more", more);
  return out;
}

SeveralTools::SeveralTools(Parts bare, std::vector<ToolPart> tools, std::size_t count)
    : InvalidInput(with_tools(bare, tools, count)), bare_(std::move(bare)), tools_(std::move(tools)), count_(count) {}

}  // namespace robomill::program
