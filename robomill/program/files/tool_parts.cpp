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

std::optional<int> whole_tool(double number) {
  constexpr double most = 99'999'999.0;
  if (!(number >= 0.0 && number <= most && number == std::round(number))) return std::nullopt;
  return static_cast<int>(number);
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
  if (!chosen_) return;
  if (!passes()) {
    chosen_moved_ = true;
  } else if (chosen_moved_ && !between_) {
    between_ = now_;
  }
}

void ToolParts::forget() {
  ToolPart all = {.name = "no tool"};
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
