// The codes of work frames, in programs and in what a reading gives of their offsets.
#include "robomill/program/files/gcode/work_frames.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/program/files/gcode/words.hpp"
#include "robomill/program/files/program_files.hpp"
#include "robomill/program/files/program_reader.hpp"

namespace robomill::program {
namespace {

constexpr int first_extended = 100'000;

bool is_whole(double number, double least, double most) {
  return number >= least && number <= most && number == std::round(number);
}

/// The frame that a code as in a program names, "G54.1 P3".
std::optional<int> work_frame_named(std::string_view code) {
  if (code.find_first_of("(;") != std::string_view::npos) return std::nullopt;
  GcodeWords line;
  try {
    line.scan(code, {}, 0);
  } catch (const InvalidInput&) {
    return std::nullopt;
  }
  const std::vector<GcodeWords::Word>& words = line.words();
  if (words.empty() || words.size() > 2 || words[0].letter != 'g') return std::nullopt;
  if (words.size() == 2 && words[1].letter != 'p') return std::nullopt;
  const double tenths = 10.0 * words[0].number;
  constexpr double beyond = 10'000.0;
  if (!(tenths >= 0.0 && tenths < beyond && std::abs(tenths - std::round(tenths)) < 1e-6)) return std::nullopt;
  return work_frame_number(static_cast<int>(std::round(tenths)),
                           words.size() == 2 ? std::optional(words[1].number) : std::nullopt);
}

int require_work_frame(const char* field, std::string_view code) {
  if (const std::optional<int> number = work_frame_named(code)) return *number;
  throw InvalidInput(InvalidInput::Parts{.field = field,
                                         .value = fmt::format("\"{}\"", printable(code, 40)),
                                         .rule = "must be a work frame of G-code: G54 to G59, G59.1 to G59.3, G54.1 P1 "
                                                 "to P300, G154 P1 to P300, or G110 to G129"});
}

}  // namespace

std::optional<int> work_frame_number(int tenths, std::optional<double> p) {
  constexpr int g54_1 = 541, g59 = 590, g59_3 = 593, g110 = 1100, g129 = 1290, g154 = 1540;
  constexpr double most = 300.0;
  const bool whole = tenths % 10 == 0;
  if (p) {
    const bool takes_p = tenths == first_work_frame || tenths == g54_1 || tenths == g154;
    return takes_p && is_whole(*p, 1.0, most) ? std::optional(first_extended + static_cast<int>(*p)) : std::nullopt;
  }
  if (tenths >= first_work_frame && tenths <= g59_3 && (whole || tenths > g59)) return tenths;
  if (tenths >= g110 && tenths <= g129 && whole) return first_extended + (tenths - g110) / 10 + 1;
  return std::nullopt;
}

std::optional<int> work_frame_of_table(double p) {
  constexpr int of_g59 = 6;
  constexpr double most = 9.0;
  if (!is_whole(p, 1.0, most)) return std::nullopt;
  const int frame = static_cast<int>(p);
  return frame <= of_g59 ? first_work_frame + 10 * (frame - 1) : 590 + frame - of_g59;
}

bool is_extended_frame(int number) {
  return number > first_extended;
}

int parse_work_frame(std::string_view code) {
  return require_work_frame("program.frames.code", code);
}

void WorkFrame::validate() const {
  static_cast<void>(require_work_frame("code", code));
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (std::abs(origin_m[i]) <= ProgramReader::farthest_m) continue;
    throw InvalidInput(fmt::format("origin_m[{}]", i + 1), origin_m[i], "m", "must lie within 1 km");
  }
}

}  // namespace robomill::program
