#include "robomill/program/files/rewrite.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/file.hpp"
#include "robomill/program/files/rewrite/calls.hpp"
#include "robomill/program/files/rewrite/rewriter.hpp"

namespace robomill::program {
namespace {

constexpr const char* unit_rule = "must be a vector of length 1, within 1e-9";
constexpr double largest_wanted_turn_rad = 179.9 * units::deg;

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
           block.coolant != read.coolant || block.operator_stop != read.operator_stop;
  };
  const auto is_unit = [](const Eigen::Vector3d& axis) { return std::abs(axis.norm() - 1.0) <= 1e-9; };
  if (!wanted.start.tip_m.allFinite()) reject_wanted(file, 1, "start.tip_m", "must be finite");
  if (!is_unit(wanted.start.axis)) reject_wanted(file, 1, "start.axis", unit_rule);
  for (std::size_t i = 0; i < wanted.blocks.size(); ++i) {
    const Block& block = wanted.blocks[i];
    const Block& read = as_read.blocks[i];
    const auto reject = [&](const char* member, const char* rule) {
      reject_wanted(file, read.line, fmt::format("blocks[{}]{}", i, member), rule);
    };
    if (others(block, read)) reject("", "may differ from what was read in speed, time, tip and axis alone");
    if (!block.end.tip_m.allFinite()) reject(".end.tip_m", "must be finite");
    if (!is_unit(block.end.axis)) reject(".end.axis", unit_rule);
    if (!(block.spindle_speed_rad_per_s >= 0.0 && std::isfinite(block.spindle_speed_rad_per_s))) {
      reject(".spindle_speed_rad_per_s", "must be finite and >= 0");
    }
    if (block.kind != Block::Kind::feed) {
      if (block.duration_s != read.duration_s) reject(".duration_s", "may differ for moves at feed alone");
    } else if (!(block.duration_s > 0.0 && std::isfinite(block.duration_s))) {
      reject(".duration_s", "must be finite and > 0 for a move at feed");
    }
    const Pose& begin = wanted.begin_of(i);
    if (block.kind == Block::Kind::dwell) {
      constexpr const char* rule = "must be where the block before it ends: a dwell stands still";
      if ((block.end.tip_m - begin.tip_m).norm() > 1e-10) reject(".end.tip_m", rule);
      if (!same_axis(block.end.axis, begin.axis)) reject(".end.axis", rule);
    } else if (block.kind == Block::Kind::feed && angle_between(begin.axis, block.end.axis) > largest_wanted_turn_rad) {
      reject(".end.axis", "must be less than half a circle from where the block begins, whose way would be any");
    }
  }
}

/// The parts that were not read are what they were.
void verify_others(const RewriteJob& job, const std::filesystem::path& name, const Rewriter::Result& result) {
  for (const ToolChoice& part : result.others) {
    ProgramReading reading = job.reading;
    reading.tool = part;
    Program before;
    try {
      before = read_program_text(std::string(job.text), name, reading);
    } catch (const InvalidInput&) {
      continue;  // its lines are as they were
    }
    const auto fail = [&](std::size_t line, const std::string& why) {
      throw InvalidInput(InvalidInput::Parts{
          .where = fmt::format("{}:{}", job.file, line),
          .rule = fmt::format("could not be rewritten: in {}, which must stay, {}", text_of(part), why)});
    };
    Program after;
    try {
      after = read_program_text(result.rewritten.text, name, reading);
    } catch (const InvalidInput& error) {
      fail(1, error.parts().rule);
    }
    if (after.blocks.size() != before.blocks.size()) fail(1, "the moves are not as many");
    if (std::string problem = pose_difference(before.start, after.start); !problem.empty()) fail(1, problem);
    for (std::size_t i = 0; i < before.blocks.size(); ++i) {
      const std::string problem =
          block_difference(before.blocks[i], before.begin_of(i), after.blocks[i], after.begin_of(i));
      if (!problem.empty()) fail(before.blocks[i].line, problem);
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
    throw at_origin(InvalidInput(std::move(parts)), job.file, result.origins);
  }
  const auto origin = [&](std::size_t line) { return line <= result.origins.size() ? result.origins[line - 1] : 0; };
  const std::span<const Block> wanted = job.wanted.blocks;
  const std::span<const Block> got = again.blocks;
  if (!pose_difference(job.wanted.start, again.start).empty()) fail(1, "the program starts elsewhere");
  std::size_t at = 0;
  for (std::size_t i = 0; i < wanted.size();) {
    const std::size_t line = wanted[i].line;
    std::size_t end = i;
    while (end < wanted.size() && wanted[end].line == line) ++end;
    std::size_t got_end = at;
    while (got_end < got.size() && origin(got[got_end].line) == line) ++got_end;
    if (at == got.size()) fail(line, "the program ends before this line");
    if (at == got_end) fail(line, "another line makes its block");
    const std::string problem =
        blocks_difference(wanted.subspan(i, end - i), job.wanted.begin_of(i), got.subspan(at, got_end - at),
                          again.begin_of(at), job.reading.axis_tolerance_rad);
    if (!problem.empty()) fail(line, problem);
    i = end;
    at = got_end;
  }
  if (at != got.size()) fail(origin(got[at].line), "the program has more moves");
  if (again.skipped.size() != job.as_read.skipped.size()) fail(1, "other words are left out");
  for (std::size_t i = 0; i < again.skipped.size(); ++i) {
    const Skipped& read = job.as_read.skipped[i];
    if (again.skipped[i].what != read.what) fail(read.line, "other words are left out");
  }
}

/// The job's text as it stands.
Rewritten rewrite_lines(const RewriteJob& job, const std::filesystem::path& name, ProgramFormat format,
                        const std::vector<std::string>& header) {
  std::unique_ptr<Rewriter> rewriter;
  switch (format) {
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
  verify_others(job, name, result);
  return std::move(result.rewritten);
}

/// @param read  the expanded text's
void check_expanded(const ExpandedCalls& expanded, const std::string& file, const Program& read,
                    const Program& as_read) {
  const auto same = [&](const Block& a, const Block& b) {
    return a.kind == b.kind && expanded.origins[a.line - 1] == b.line && a.end.tip_m == b.end.tip_m &&
           a.end.axis == b.end.axis && a.duration_s == b.duration_s &&
           a.spindle_speed_rad_per_s == b.spindle_speed_rad_per_s && a.spindle == b.spindle && a.coolant == b.coolant &&
           a.operator_stop == b.operator_stop;
  };
  const auto fail = [&](std::size_t line) {
    throw InvalidInput(InvalidInput::Parts{
        .where = fmt::format("{}:{}", file, line),
        .field = "as_read",
        .rule = "is not what this file gives with its calls of subprograms expanded",
        .hint = "Read the program again, or let the CAM system write the program without subprograms"});
  };
  const std::size_t count = std::min(read.blocks.size(), as_read.blocks.size());
  for (std::size_t i = 0; i < count; ++i) {
    if (!same(read.blocks[i], as_read.blocks[i])) fail(read.blocks[i].line);
  }
  const bool starts = read.start.tip_m == as_read.start.tip_m && read.start.axis == as_read.start.axis;
  if (read.blocks.size() != as_read.blocks.size() || !starts) fail(1);
}

/// Every pass of a subprogram has lines of its own, so that each can have its own feeds and speeds.
Rewritten rewrite_expanded(const ExpandedCalls& expanded, const std::filesystem::path& name,
                           const ProgramReading& reading, const Program& as_read, Program wanted,
                           std::vector<std::string> header) {
  const std::string file = name.string();
  try {
    const Program read = read_program_text(expanded.text, name, reading);
    check_expanded(expanded, file, read, as_read);
    for (std::size_t i = 0; i < wanted.blocks.size(); ++i) wanted.blocks[i].line = read.blocks[i].line;
    header.push_back(fmt::format("{} call{} of subprograms {} expanded in place", expanded.passes,
                                 expanded.passes == 1 ? "" : "s", expanded.passes == 1 ? "is" : "are"));
    const RewriteJob job = {.file = file, .text = expanded.text, .reading = reading, .as_read = read, .wanted = wanted};
    Rewritten out = rewrite_lines(job, name, ProgramFormat::gcode, header);
    const std::size_t first = out.first_changed == 0 ? expanded.first : std::min(out.first_changed, expanded.first);
    out.first_changed = expanded.origins[first - 1];
    out.expanded_calls = expanded.passes;
    return out;
  } catch (const InvalidInput& error) {
    throw at_origin(error, file, expanded.origins);
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
  const ProgramFormat format = reading.format.value_or(program_format_of(name));
  if (format == ProgramFormat::gcode && may_call(text, job.file)) {
    const ExpandedCalls expanded = expand_calls(text, job.file, reading);
    if (expanded.passes > 0) return rewrite_expanded(expanded, name, reading, as_read, wanted, header);
  }
  return rewrite_lines(job, name, format, header);
}

Rewritten rewrite_program(const std::filesystem::path& path, const ProgramReading& reading, const Program& as_read,
                          const Program& wanted, const std::vector<std::string>& header) {
  return rewrite_program_text(io::read_file(path), path, reading, as_read, wanted, header);
}

}  // namespace robomill::program
