#pragma once
// What the tests of program readers share.
#include <cstddef>
#include <limits>
#include <string_view>
#include <utility>

#include "robomill/program/files/program_reader.hpp"

namespace robomill::test_support {

/// A program in memory, read without a file.
template <class Reader>
program::Program read_text(std::string_view text, const program::ProgramReading& reading = {}) {
  program::ProgramRemarks remarks(std::numeric_limits<std::size_t>::max());
  Reader reader("part", reading, remarks);
  program::Program out;
  program::Block block;
  const auto take_blocks = [&] {
    while (reader.pop(block)) out.blocks.push_back(block);
  };
  while (!text.empty() && !reader.ended()) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    const std::size_t ahead = text.find_first_not_of(" \t");
    reader.take(line, ahead == std::string_view::npos ? '\n' : text[ahead]);
    take_blocks();
  }
  reader.finish();
  take_blocks();
  if (reader.start()) out.start = *reader.start();
  out.skipped = std::move(remarks.skipped());
  out.notes = remarks.notes();
  out.assumed = remarks.assumed();
  return out;
}

}  // namespace robomill::test_support
