#include "robomill/program/files/rewrite.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/program/files/rewriter.hpp"

namespace robomill::program {
namespace {

[[noreturn]] void reject_wanted(const std::string& file, std::size_t line, const std::string& field, const char* rule) {
  throw InvalidInput(
      InvalidInput::Parts{.where = fmt::format("{}:{}", file, line), .field = "wanted." + field, .rule = rule});
}

/// Wanted blocks differ from those read only in what can be rewritten.
void check_wanted(const std::string& file, const Program& as_read, const Program& wanted) {
  if (wanted.blocks.size() != as_read.blocks.size()) {
    throw InvalidInput(file, fmt::format("wanted has {} blocks where the program has {}", wanted.blocks.size(),
                                         as_read.blocks.size()));
  }
  const auto others = [](const Block& block, const Block& read) {
    return block.kind != read.kind || block.line != read.line || block.spindle != read.spindle ||
           block.coolant != read.coolant || block.operator_stop != read.operator_stop ||
           block.end.axis != read.end.axis;
  };
  if (!wanted.start.tip_m.allFinite()) reject_wanted(file, 1, "start.tip_m", "must be finite");
  for (std::size_t i = 0; i < wanted.blocks.size(); ++i) {
    const Block& block = wanted.blocks[i];
    const Block& read = as_read.blocks[i];
    const auto reject = [&](const char* member, const char* rule) {
      reject_wanted(file, read.line, fmt::format("blocks[{}]{}", i, member), rule);
    };
    if (others(block, read)) reject("", "may differ from what was read in speed, time and tip alone");
    if (!block.end.tip_m.allFinite()) reject(".end.tip_m", "must be finite");
    if (!(block.spindle_speed_rad_per_s >= 0.0 && std::isfinite(block.spindle_speed_rad_per_s))) {
      reject(".spindle_speed_rad_per_s", "must be finite and >= 0");
    }
    if (block.kind != Block::Kind::feed) {
      if (block.duration_s != read.duration_s) reject(".duration_s", "may differ for moves at feed alone");
    } else if (!(block.duration_s > 0.0 && std::isfinite(block.duration_s))) {
      reject(".duration_s", "must be finite and > 0 for a move at feed");
    }
    if (block.kind == Block::Kind::dwell && (block.end.tip_m - wanted.begin_of(i).tip_m).norm() > 1e-10) {
      reject(".end.tip_m", "must be where the block before it ends: a dwell stands still");
    }
  }
}

/// The new text as its reader reads it is what was wanted.
void verify(const RewriteJob& job, const std::filesystem::path& name, const Rewriter::Result& result) {
  const auto fail = [&](std::size_t line, const std::string& why) {
    throw InvalidInput(InvalidInput::Parts{.where = fmt::format("{}:{}", job.file, line),
                                           .rule = "could not be rewritten: read again, " + why});
  };
  Program again;
  try {
    again = read_program_text(result.rewritten.text, name, job.reading);
  } catch (const InvalidInput& error) {
    InvalidInput::Parts parts = error.parts();
    parts.rule = "could not be rewritten: read again, it " + parts.rule;
    throw InvalidInput(std::move(parts));
  }
  const auto origin = [&](std::size_t line) { return line <= result.origins.size() ? result.origins[line - 1] : 0; };
  for (std::size_t i = 0; i < job.wanted.blocks.size(); ++i) {
    const Block& wanted = job.wanted.blocks[i];
    if (i == again.blocks.size()) fail(wanted.line, "the program ends before this line");
    const Block& got = again.blocks[i];
    if (origin(got.line) != wanted.line) fail(wanted.line, "another line makes its block");
    const std::string problem = block_difference(wanted, job.wanted.begin_of(i), got, again.begin_of(i));
    if (!problem.empty()) fail(wanted.line, problem);
  }
  if (again.blocks.size() != job.wanted.blocks.size()) {
    fail(origin(again.blocks[job.wanted.blocks.size()].line), "the program has more moves");
  }
  if (again.skipped.size() != job.as_read.skipped.size()) fail(1, "other words are left out");
  for (std::size_t i = 0; i < again.skipped.size(); ++i) {
    const Skipped& read = job.as_read.skipped[i];
    if (again.skipped[i].what != read.what) fail(read.line, "other words are left out");
  }
}

}  // namespace

Rewritten rewrite_program_text(const std::string& text, const std::filesystem::path& name,
                               const ProgramReading& reading, const Program& as_read, const Program& wanted,
                               const std::vector<std::string>& header) {
  reading.validate();
  const RewriteJob job = {
      .file = name.string(), .text = text, .reading = reading, .as_read = as_read, .wanted = wanted};
  check_wanted(job.file, as_read, wanted);
  std::unique_ptr<Rewriter> rewriter;
  switch (reading.format.value_or(program_format_of(name))) {
    case ProgramFormat::gcode:
      rewriter = make_gcode_rewriter(job);
      break;
    case ProgramFormat::apt:
      rewriter = make_apt_rewriter(job);
      break;
    case ProgramFormat::csv:
      rewriter = make_csv_rewriter(job);
      break;
  }
  Rewriter::Result result = rewriter->rewrite(header);
  verify(job, name, result);
  return std::move(result.rewritten);
}

Rewritten rewrite_program(const std::filesystem::path& path, const ProgramReading& reading, const Program& as_read,
                          const Program& wanted, const std::vector<std::string>& header) {
  return rewrite_program_text(io::read_file(path), path, reading, as_read, wanted, header);
}

}  // namespace robomill::program
