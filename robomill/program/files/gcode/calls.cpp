#include "robomill/program/files/gcode/calls.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/program/files/gcode/reader.hpp"
#include "robomill/program/files/gcode/words.hpp"

namespace robomill::program {
namespace {

/// The digits behind a letter, without leading zeros; empty where there are none.
std::string digits_behind(std::string_view compact, std::size_t at) {
  std::size_t end = at;
  while (end < compact.size() && is_digit(compact[end])) ++end;
  while (at + 1 < end && compact[at] == '0') ++at;
  return std::string(compact.substr(at, end - at));
}

/// The begin of a line in lower case, without blanks: as far as O and N words reach.
std::string head_of(std::string_view line) {
  constexpr std::size_t longest = 80;
  std::string out;
  for (const char c : line) {
    if (c == ' ' || c == '\t') continue;
    if (c == '(' || c == ';' || out.size() == longest) break;
    out += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return out;
}

std::string name_of(const GcodeCall& call) {
  switch (call.kind) {
    case GcodeCall::Kind::line:
      return "N" + call.label;
    case GcodeCall::Kind::program:
      return "O" + call.label;
    case GcodeCall::Kind::label:
      break;
  }
  return fmt::format("o{} sub", call.label);
}

[[noreturn]] void reject(const std::string& file, std::size_t line, std::string rule, const char* hint) {
  throw InvalidInput(
      InvalidInput::Parts{.where = fmt::format("{}:{}", file, line), .rule = std::move(rule), .hint = hint});
}

constexpr const char* write_out = "Let the CAM system write the program without subprograms";

}  // namespace

std::string_view GcodeCalls::text_of(std::size_t line) const {
  return std::string_view(text_).substr(begins_[line], begins_[line + 1] - begins_[line]);
}

void GcodeCalls::load() {
  if (!begins_.empty()) return;
  ProgramLines lines = open_();
  begins_.push_back(0);
  std::string_view line;
  while (lines.next(line)) {
    if (text_.size() + line.size() > most_bytes) {
      reject(file_, lines.number(),
             fmt::format("lies beyond the first {} MB of a program that calls subprograms", most_bytes >> 20U),
             write_out);
    }
    text_ += line;
    begins_.push_back(text_.size());
    index(begins_.size() - 2);
  }
  handed_out_.resize(begins_.size(), false);
}

void GcodeCalls::index(std::size_t line) {
  const std::string head = head_of(text_of(line));
  if (head.size() < 2) return;
  if (const std::optional<OWord> control = o_word(head)) {
    if (control->keyword == "sub") labels_.emplace(control->label, line);
    return;
  }
  if (head.front() == 'n' && is_digit(head[1])) numbers_.emplace(digits_behind(head, 1), line);
  if ((head.front() != 'o' && head.front() != ':') || !is_digit(head[1])) return;
  programs_.emplace(digits_behind(head, 1), line);
  program_begins_.push_back(line);
}

// The line of that number in the program of the line that calls.
std::size_t GcodeCalls::line_of(const GcodeCall& call) const {
  const std::size_t caller = call.line - 1;
  const auto behind = std::ranges::upper_bound(program_begins_, caller);
  const std::size_t first = behind == program_begins_.begin() ? 0 : *(behind - 1);
  const std::size_t last = behind == program_begins_.end() ? begins_.size() : *behind;
  const auto [begin, end] = numbers_.equal_range(call.label);
  const auto found =
      std::find_if(begin, end, [&](const auto& entry) { return entry.second >= first && entry.second < last; });
  if (found != end) return found->second;
  reject(file_, call.line, fmt::format("calls N{}, which this program does not contain", call.label), write_out);
}

std::size_t GcodeCalls::place_of(GcodeCall& call) const {
  if (call.kind == GcodeCall::Kind::line) return line_of(call);
  const auto& known = call.kind == GcodeCall::Kind::program ? programs_ : labels_;
  if (const auto found = known.find(call.label); found != known.end()) return found->second + 1;
  // M98 P30070: three times O0070.
  constexpr std::size_t digits = 4;
  if (call.kind == GcodeCall::Kind::program && call.label.size() > digits) {
    const std::size_t split = call.label.size() - digits;
    const auto found = programs_.find(digits_behind(call.label, split));
    if (found != programs_.end()) {
      call.repeats *= std::stoul(call.label.substr(0, split));
      call.label = found->first;
      return found->second + 1;
    }
  }
  reject(file_, call.line, fmt::format("calls {}, which this file does not contain", name_of(call)),
         "Append the subprogram to the file, or let the CAM system write the program without subprograms");
}

void GcodeCalls::call(const GcodeCall& wanted) {
  load();
  if (stack_.size() >= deepest) {
    reject(file_, wanted.line, fmt::format("calls {} more than {} calls deep", name_of(wanted), deepest),
           "Does a subprogram call itself?");
  }
  GcodeCall call = wanted;
  const std::size_t first = place_of(call);
  stack_.push_back({.call = call, .first = first, .at = first, .left = call.repeats - 1});
  ++passes_;
}

void GcodeCalls::give_back() {
  Running& running = stack_.back();
  if (running.left > 0) {
    --running.left;
    ++passes_;
    running.at = running.first;
  } else {
    stack_.pop_back();
  }
}

bool GcodeCalls::follow(GcodeReader& reader, std::size_t behind) {
  const std::size_t depth = stack_.size();
  const bool returns = reader.take_return();
  const std::optional<GcodeCall> wanted = reader.take_call();
  if (!returns && !wanted) return false;
  if (returns && depth > 0) give_back();
  if (wanted) call(*wanted);
  reader.set_depth(stack_.size());
  if (stack_.empty()) reader.go_on_at(behind);
  return true;
}

GcodeCalls::Line GcodeCalls::next() {
  Running& running = stack_.back();
  const std::size_t line = running.at;
  if (line + 1 >= begins_.size()) {
    reject(file_, running.call.line, fmt::format("calls {}, which does not end", name_of(running.call)),
           running.call.kind == GcodeCall::Kind::label ? "Is its endsub missing?" : "Is its M99 missing?");
  }
  if (++carried_out_ > most_lines) {
    reject(file_, running.call.line, fmt::format("makes more than {} lines by its calls", most_lines), write_out);
  }
  ++running.at;
  Line out = {.text = text_of(line), .number = line + 1, .again = handed_out_[line]};
  handed_out_[line] = true;
  if (line + 2 < begins_.size()) {
    const std::string_view behind = text_of(line + 1);
    const std::size_t at = behind.find_first_not_of(" \t");
    if (at != std::string_view::npos) out.ahead = behind[at];
  }
  return out;
}

void GcodeCalls::rewind() {
  stack_.clear();
  carried_out_ = passes_ = 0;
}

void GcodeReader::call_program(const Line& line) {
  const double code = line.call->number;
  const auto whole = [&](const std::optional<GcodeWords::Word>& word, double otherwise, double most,
                         const char* field) {
    const double number = word ? word->number : otherwise;
    if (number >= 1.0 && number <= most && number == std::round(number)) return static_cast<std::size_t>(number);
    reject(field, word ? std::optional(number) : std::nullopt, "",
           fmt::format("must be a whole number from 1 to {:.0f} with M{:g}", most, code));
  };
  if (line.dwells || line.has('h') || line.q) {
    reject("M", code, "", "stands with G4, H or Q, which call in a way that is not read", write_out);
  }
  constexpr double most_number = 99'999'999.0;
  constexpr double most_repeats = 9999.0;
  call_ = GcodeCall{.kind = code == 97.0 ? GcodeCall::Kind::line : GcodeCall::Kind::program,
                    .label = std::to_string(whole(line.p, 0.0, most_number, "P")),
                    .repeats = whole(line.l, 1.0, most_repeats, "L"),
                    .line = line_};
}

void GcodeReader::control(const OWord& word) {
  const std::string said = fmt::format("o{} {}", word.label, word.keyword);
  begun_ = true;
  if (word.keyword == "sub" && word.rest.empty()) {
    leaves_out_sub_ = word.label;
    sub_line_ = line_;
  } else if (word.keyword == "endsub" && word.rest.empty() && depth_ > 0) {
    returns_ = true;
  } else if (word.keyword == "call" && word.rest.empty() && calls_allowed_) {
    call_ = GcodeCall{.kind = GcodeCall::Kind::label, .label = std::string(word.label), .line = line_};
  } else {
    reject(fmt::format("\"{}\"", printable(said, 40)), std::nullopt, "",
           word.keyword == "call" ? "is a subroutine or its control, which are not read here: it passes arguments"
                                  : "is a subroutine or its control, which are not read here",
           "Let the CAM system write the program out");
  }
}

}  // namespace robomill::program
