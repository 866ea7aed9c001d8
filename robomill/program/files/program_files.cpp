#include "robomill/program/files/program_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <iterator>
#include <limits>
#include <string>
#include <utility>

#include "robomill/base/cost.hpp"
#include "robomill/base/error.hpp"
#include "robomill/base/names.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/text.hpp"
#include "robomill/program/files/apt_reader.hpp"
#include "robomill/program/files/gcode/calls.hpp"
#include "robomill/program/files/gcode/reader.hpp"
#include "robomill/program/files/program_csv.hpp"
#include "robomill/program/files/program_lines.hpp"
#include "robomill/program/files/program_reader.hpp"
#include "robomill/program/files/unread_dialect.hpp"

namespace robomill::program {
namespace {

constexpr std::size_t kept_remarks = 500;
constexpr std::size_t most_listed_parts = 30;
constexpr std::size_t most_read_parts = 12;  ///< of these, each a pass over the file

constexpr Name<Machine> machine_names[] = {{"xyzac-trt", Machine::xyzac_trt},
                                           {"xyzbc-trt", Machine::xyzbc_trt},
                                           {"xyzac-head", Machine::xyzac_head},
                                           {"xyzbc-head", Machine::xyzbc_head}};

std::unique_ptr<ProgramReader> make_reader(ProgramFormat format, const std::string& file, const ProgramReading& reading,
                                           ProgramRemarks& remarks) {
  switch (format) {
    case ProgramFormat::apt:
      return std::make_unique<AptReader>(file, reading, remarks);
    case ProgramFormat::csv:
      return std::make_unique<CsvReader>(file, reading, remarks);
    case ProgramFormat::gcode:
      break;
  }
  return std::make_unique<GcodeReader>(file, reading, remarks);
}

/// What would be misread, or rejected for a word of it.
void require_known_dialect(const std::filesystem::path& path, std::string_view head) {
  const std::optional<UnreadDialect> other = unread_dialect(io::lowered(path.extension().string()), head);
  if (!other) return;
  throw InvalidInput(InvalidInput::Parts{.where = fmt::format("{}:{}", path.string(), other->line),
                                         .field = fmt::format("\"{}\"", printable(other->shown, 40)),
                                         .rule = std::string(other->rule),
                                         .hint = std::string(other->hint)});
}

/// Work frames are of G-code alone.
void require_frames_of_gcode(const std::string& file, const ProgramReading& reading, ProgramFormat format) {
  if (reading.frames.empty() || format == ProgramFormat::gcode) return;
  throw InvalidInput(
      InvalidInput::Parts{.where = file,
                          .field = "program.frames",
                          .rule = fmt::format("are work frames of G-code, and this program is {}",
                                              format == ProgramFormat::apt ? "APT/CL" : "a CSV of poses"),
                          .hint = "Take them out of the cell"});
}

/// A file and what reads it.
class Walk {
 public:
  Walk(const std::filesystem::path& path, const ProgramReading& reading, std::size_t kept)
      : Walk([path] { return ProgramLines(path); }, path, reading, kept, std::filesystem::is_regular_file(path)) {}
  /// @param lines  opens the program's lines anew
  /// @param again  more than once
  Walk(const std::function<ProgramLines()>& lines, const std::filesystem::path& path, const ProgramReading& reading,
       std::size_t kept, bool again)
      : open_(lines),
        lines_((reading.validate(), lines())),
        path_(path),
        file_(path.string()),
        again_(again),
        reading_(reading),
        format_(reading.format.value_or(program_format_of(path))),
        remarks_(kept),
        calls_(file_, lines) {
    if (format_ == ProgramFormat::gcode) require_known_dialect(path, lines_.head());
    require_frames_of_gcode(file_, reading_, format_);
    by_t_ = format_ == ProgramFormat::gcode && reading_.tool.given() && again_ &&
            GcodeReader::changes_tool_by_t(lines(), file_);
    begin();
    if (!reader_->start()) {
      throw InvalidInput(file_, "holds no complete position",
                         format_ == ProgramFormat::gcode ? "A program gives X, Y and Z by G0 before it cuts" : "");
    }
    start_ = *reader_->start();
  }
  ~Walk() = default;
  Walk(const Walk&) = delete;
  Walk& operator=(const Walk&) = delete;
  Walk(Walk&&) = delete;
  Walk& operator=(Walk&&) = delete;

  [[nodiscard]] const Pose& start() const { return start_; }

  bool next(Block& out) {
    while (!reader_->pop(out)) {
      if (!take_line()) return false;
    }
    return true;
  }

  void rewind() {
    lines_.rewind();
    calls_.rewind();
    begin();
  }

  [[nodiscard]] ProgramRemarks& remarks() { return remarks_; }

 private:
  /// On to the first position.
  void begin() {
    finished_ = false;
    reader_ = make_reader(format_, file_, reading_, remarks_);
    gcode_ = format_ == ProgramFormat::gcode ? static_cast<GcodeReader*>(reader_.get()) : nullptr;
    if (gcode_ != nullptr) gcode_->allow_calls();
    if (by_t_) gcode_->set_changes_tool_by_t();
    while (!reader_->start() && take_line()) {
    }
  }

  bool take_line() {
    if (finished_) return false;
    std::string_view line;
    if (!reader_->ended() && calls_.depth() > 0) {
      const GcodeCalls::Line called = calls_.next();
      remarks_.repeat(called.again);
      reader_->go_on_at(called.number);
      reader_->take(called.text, called.ahead);
      calls_.follow(*gcode_, lines_.number() + 1);
    } else if (!reader_->ended() && lines_.next(line)) {
      remarks_.repeat(lines_.number() <= farthest_);
      farthest_ = std::max(farthest_, lines_.number());
      reader_->take(line, lines_.ahead());
      if (gcode_ != nullptr) calls_.follow(*gcode_, lines_.number() + 1);
    } else {
      finish();
      finished_ = true;
    }
    return true;
  }

  void finish() {
    try {
      reader_->finish();
    } catch (const SeveralTools& error) {
      if (reading_.tool.given()) throw;
      throw InvalidInput(with_contents(error));
    }
  }

  /// What a choice of the tool would read: "3 moves, 4.8 s at feed".
  [[nodiscard]] std::string contents_of(const ToolChoice& tool) const {
    ProgramReading reading = reading_;
    reading.tool = tool;
    std::size_t moves = 0;
    std::size_t line = 0;
    double time_s = 0.0;
    try {
      Walk walk(open_, path_, reading, 0, true);
      Block block;
      while (walk.next(block)) {
        moves += block.kind != Block::Kind::dwell && block.line != line ? 1 : 0;
        line = block.line;
        time_s += block.duration_s;
      }
    } catch (const InvalidInput& error) {
      const std::string& where = error.parts().where;
      const std::string at = where.size() > file_.size() + 1 ? "line " + where.substr(file_.size() + 1) + ": " : "";
      return fmt::format("cannot be read alone: {}{} {}", at, error.parts().field, error.parts().rule);
    }
    constexpr double long_s = 120.0;
    const std::string time =
        time_s < long_s ? fmt::format("{:.3g} s", time_s) : fmt::format("{:.3g} min", time_s / units::minute);
    return fmt::format("{} move{}, {} at feed", moves, moves == 1 ? "" : "s", time);
  }

  /// The parts of the tools. A reader that has found a second tool lists the others and no moves: one that reads a
  /// single part follows them all.
  [[nodiscard]] std::vector<NumberedPart> parts_of(const SeveralTools& error) const {
    std::vector<NumberedPart> listed = numbered_parts(error.tools());
    if (!again_) return listed;
    for (const NumberedPart& one : listed) {
      if (!one.part.can_be_chosen()) continue;
      ProgramReading reading = reading_;
      reading.tool = choice_of(one);
      reading.tool.part = 1;
      try {
        Walk walk(open_, path_, reading, 0, true);
        Block block;
        while (walk.next(block)) {
        }
        return numbered_parts(walk.reader_->tools().parts());
      } catch (const InvalidInput&) {
        continue;  // the next one may be read
      }
    }
    return listed;
  }

  /// The error with the choice that reads a part, and below each other each part's lines, moves and time.
  [[nodiscard]] InvalidInput::Parts with_contents(const SeveralTools& error) const {
    const std::vector<NumberedPart> tools = parts_of(error);
    std::string listed;
    std::optional<ToolChoice> first;
    bool first_reads = false;
    for (std::size_t i = 0; i < tools.size(); ++i) {
      if (i == most_listed_parts) {
        const bool all_kept = error.count() == error.tools().size();
        listed += fmt::format("\n  and {}{} more", all_kept ? "" : "at least ", tools.size() - i);
        break;
      }
      const NumberedPart& one = tools[i];
      const ToolPart& part = one.part;
      const ToolChoice choice = choice_of(one);
      const bool can_choose = part.can_be_chosen();
      const std::string contents = can_choose && again_ && i < most_read_parts ? ", " + contents_of(choice) : "";
      const bool reads = !contents.starts_with(", cannot");
      if (can_choose && (!first || (reads && !first_reads))) first = choice;
      first_reads = first_reads || (can_choose && reads);
      listed += fmt::format("\n  {}: line {}, {} line{}{}", one.count > 1 ? text_of(choice) : part.name, part.line,
                            part.lines, part.lines == 1 ? "" : "s", contents);
    }
    InvalidInput::Parts parts = error.bare();
    if (first) {
      const std::string tool = first->number ? fmt::format("program.tool = {}", *first->number)
                                             : fmt::format("program.tool_name = \"{}\"", first->name);
      parts.hint = first->part ? fmt::format("{} and program.tool_part = {} in the cell read that part alone", tool,
                                             *first->part)
                               : fmt::format("{} in the cell reads that tool's part alone", tool);
    }
    parts.hint += ". The program has:" + listed;
    return parts;
  }

  std::function<ProgramLines()> open_;
  ProgramLines lines_;
  std::filesystem::path path_;
  std::string file_;
  bool again_ = false, by_t_ = false;
  ProgramReading reading_;
  ProgramFormat format_;
  ProgramRemarks remarks_;
  GcodeCalls calls_;
  std::unique_ptr<ProgramReader> reader_;
  GcodeReader* gcode_ = nullptr;  ///< the reader, where it is one
  std::size_t farthest_ = 0;      ///< line of the file that has been taken, in any pass
  bool finished_ = false;
  Pose start_;
};

}  // namespace

ProgramFormat program_format_of(const std::filesystem::path& path) {
  const std::string ending = io::lowered(path.extension().string());
  static constexpr std::string_view apt[] = {".apt", ".cls", ".cl", ".ncl", ".aptsource"};
  if (std::ranges::find(apt, ending) != std::end(apt)) return ProgramFormat::apt;
  return ending == ".csv" ? ProgramFormat::csv : ProgramFormat::gcode;
}

Machine parse_machine(std::string_view name) {
  if (const std::optional<Machine> machine = value_in(machine_names, name)) return *machine;
  throw InvalidInput(InvalidInput::Parts{
      .field = "program.machine", .value = fmt::format("\"{}\"", name), .rule = one_of(machine_names)});
}

Rotary parse_rotary(std::string_view name) {
  if (name == "machine") return Rotary::machine;
  if (name == "great-circle") return Rotary::great_circle;
  throw InvalidInput(InvalidInput::Parts{.field = "program.rotary",
                                         .value = "\"" + std::string(name) + "\"",
                                         .rule = "must be one of \"machine\", \"great-circle\""});
}

void ToolChoice::validate() const {
  if (number && !name.empty()) {
    throw InvalidInput("number", fmt::format("is given beside the tool's name, \"{}\": give one of the two", name));
  }
  if (number && *number < 0) throw InvalidInput("number", *number, "", "must be >= 0");
  if (!part) return;
  if (!given()) throw InvalidInput("part", *part, "", "is one of a tool's, and no tool is chosen");
  if (*part < 1) throw InvalidInput("part", *part, "", "must be >= 1");
}

void ProgramReading::validate() const {
  constexpr double least_m = 1e-9;
  if (!(chord_tolerance_m >= least_m && chord_tolerance_m < 1.0)) {
    throw InvalidInput("chord_tolerance_m", chord_tolerance_m, "m", "must be >= 1e-9 and < 1");
  }
  constexpr double least_rad = 1e-9;
  if (!(axis_tolerance_rad >= least_rad && axis_tolerance_rad < 1.0)) {
    throw InvalidInput("axis_tolerance_rad", axis_tolerance_rad, "rad", "must be >= 1e-9 and < 1");
  }
  try {
    tool.validate();
  } catch (const InvalidInput& error) {
    throw within("tool.", error);
  }
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const std::string member = fmt::format("frames[{}].", i + 1);
    try {
      frames[i].validate();
    } catch (const InvalidInput& error) {
      throw within(member, error);
    }
    const int number = parse_work_frame(frames[i].code);
    const auto before = frames.begin() + static_cast<std::ptrdiff_t>(i);
    const auto same = std::find_if(frames.begin(), before,
                                   [&](const WorkFrame& frame) { return parse_work_frame(frame.code) == number; });
    if (same == before) continue;
    throw InvalidInput(InvalidInput::Parts{
        .field = member + "code",
        .value = fmt::format("\"{}\"", frames[i].code),
        .rule = fmt::format("is the work frame that frames[{}] gives, \"{}\"", same - frames.begin() + 1, same->code)});
  }
}

struct ProgramFile::State {
  Walk walk;
};

ProgramFile::ProgramFile(const std::filesystem::path& path, const ProgramReading& reading)
    : state_(new State{Walk(path, reading, kept_remarks)}) {}
ProgramFile::~ProgramFile() = default;

const Pose& ProgramFile::start() const {
  return state_->walk.start();
}

bool ProgramFile::next(Block& out) {
  return state_->walk.next(out);
}

void ProgramFile::rewind() {
  state_->walk.rewind();
}

Remarks ProgramFile::remarks() const {
  ProgramRemarks& remarks = state_->walk.remarks();
  return {.skipped = remarks.skipped(),
          .skipped_count = remarks.skipped_count(),
          .notes = remarks.notes(),
          .assumed = remarks.assumed()};
}

std::unique_ptr<ProgramFile> open_program(const std::filesystem::path& path, const ProgramReading& reading) {
  return std::make_unique<ProgramFile>(path, reading);
}

namespace {

/// Of blocks in memory, while they are moved to where there is room for more: arcs make many of one line.
void require_affordable_program(std::size_t blocks) {
  const auto all = static_cast<double>(blocks);
  require_affordable({.bytes = 2.0 * all * sizeof(Block),
                      .dominant = {.field = "the program", .value = all, .unit = "blocks and more"}});
}

Program whole(Walk& walk) {
  Program out;
  out.start = walk.start();
  Block block;
  while (walk.next(block)) {
    constexpr std::size_t between_looks = 65'536;
    if (out.blocks.size() % between_looks == between_looks - 1) require_affordable_program(out.blocks.size());
    out.blocks.push_back(block);
  }
  out.skipped = std::move(walk.remarks().skipped());
  out.notes = walk.remarks().notes();
  out.assumed = walk.remarks().assumed();
  return out;
}

}  // namespace

Program read_program(const std::filesystem::path& path, const ProgramReading& reading) {
  Walk walk(path, reading, std::numeric_limits<std::size_t>::max());
  return whole(walk);
}

Program read_program_text(const std::string& text, const std::filesystem::path& name, const ProgramReading& reading) {
  const std::function<ProgramLines()> lines = [&] { return ProgramLines(name.string(), text); };
  Walk walk(lines, name, reading, std::numeric_limits<std::size_t>::max(), true);
  return whole(walk);
}

}  // namespace robomill::program
