#include "robomill/program/files/program_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <sstream>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"

namespace robomill::program {
namespace {

constexpr std::size_t buffer_bytes = std::size_t{1} << 18;
/// So much lies in the buffer before a line is taken: that line, and what follows it.
constexpr std::size_t least_bytes = 2 * (ProgramLines::longest + 2);

}  // namespace

LineEnd line_end(std::string_view text) {
  std::size_t at = text.find('\n');
  const bool feeds = at != std::string_view::npos;
  if (!feeds) at = text.size();
  // Some controllers end lines by a carriage return alone.
  const std::size_t returns = text.substr(0, at).find('\r');
  if (returns == std::string_view::npos) return {.at = at, .bytes = feeds ? std::size_t{1} : 0};
  return {.at = returns, .bytes = feeds && returns + 1 == at ? std::size_t{2} : 1};
}

ProgramLines::ProgramLines(const std::filesystem::path& path)
    : ProgramLines(path.string(), std::make_unique<std::ifstream>(io::open_file(path))) {}

ProgramLines::ProgramLines(std::string name, std::string text)
    : ProgramLines(std::move(name), std::make_unique<std::istringstream>(std::move(text))) {}

ProgramLines::ProgramLines(std::string name, std::unique_ptr<std::istream> in)
    : name_(std::move(name)), in_(std::move(in)), buffer_(buffer_bytes) {
  fill();
  if (end_ == 0) throw InvalidInput(name_, "is empty");
  const std::string_view head(buffer_.data(), std::min<std::size_t>(end_, 4096));
  if (head.find('\0') == std::string_view::npos) return;
  const bool utf16 = head.starts_with("\xFF\xFE") || head.starts_with("\xFE\xFF");
  throw InvalidInput(name_, "is no plain text", utf16 ? "It is UTF-16: save it as UTF-8" : "Is it a binary file?");
}

void ProgramLines::fill() {
  const bool first = line_ == 0;
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  in_->read(buffer_.data() + end_, static_cast<std::streamsize>(buffer_.size() - end_));
  end_ += static_cast<std::size_t>(in_->gcount());
  if (in_->bad()) throw InvalidInput(InvalidInput::Parts{.where = name_, .rule = "cannot be read to its end"});
  whole_ = !*in_;
  if (first && std::string_view(buffer_.data(), end_).starts_with(byte_order_mark)) begin_ = byte_order_mark.size();
}

bool ProgramLines::next(std::string_view& line) {
  if (!whole_ && end_ - begin_ < least_bytes) fill();
  if (begin_ == end_) return false;
  ++line_;
  const char* const first = buffer_.data() + begin_;
  const std::size_t count = end_ - begin_;
  const LineEnd ending = line_end({first, std::min(count, longest + 2)});
  const std::size_t length = ending.bytes > 0 ? ending.at : count;
  begin_ += length + ending.bytes;
  if (length > longest) {
    throw InvalidInput(InvalidInput::Parts{.where = fmt::format("{}:{}", name_, line_),
                                           .rule = fmt::format("is a line of more than {} bytes", longest),
                                           .hint = "Is it a text file with line ends?"});
  }
  line = {first, length};
  return true;
}

char ProgramLines::ahead() const {
  for (std::size_t at = begin_; at < end_; ++at) {
    if (buffer_[at] != ' ' && buffer_[at] != '\t') return buffer_[at];
  }
  return '\n';
}

void ProgramLines::rewind() {
  in_->clear();
  if (!in_->seekg(0)) {
    throw InvalidInput(InvalidInput::Parts{
        .where = name_, .rule = "cannot be read a second time", .hint = "It is read twice; is it a pipe? Give a file"});
  }
  begin_ = end_ = line_ = 0;
  whole_ = false;
  fill();
}

}  // namespace robomill::program
