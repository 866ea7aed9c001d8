// Drilling cycles of a GcodeReader as the moves that they make.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robomill/base/units.hpp"
#include "robomill/program/files/gcode/reader.hpp"

namespace robomill::program {
namespace {

using Eigen::Vector3d;

constexpr std::size_t most_steps = 100'000;

bool stops_spindle(int code) {
  return code == 860 || code == 880;
}

bool taps(int code) {
  return code == 740 || code == 840;
}

bool pecks(int code) {
  return code == 730 || code == 830;
}

}  // namespace

void GcodeReader::choose_cycle(int code, const GcodeWords::Word& word, Line& line) {
  if (motion_ != Motion::cycle) {
    const bool to_r = cycle_.to_r;
    cycle_ = {};
    cycle_.to_r = to_r;
    cycle_.initial_m = (pending_ ? *pending_ : pose_).tip_m.z();
  }
  motion_ = Motion::cycle;
  cycle_.code = code;
  line.cycle = word;
}

// R, Z, Q and P hold for the holes that follow.
void GcodeReader::update_cycle(const Line& line) {
  const std::optional<Vector3d> origin = origin_m();
  const double zero_m = origin ? origin->z() : 0.0;
  if (origin) {
    // Heights that were said before count in the frame that holds now.
    const double moved_m = incremental_ ? 0.0 : zero_m - cycle_.zero_m;
    if (cycle_.r) *cycle_.r += moved_m;
    if (cycle_.z) *cycle_.z += moved_m;
    cycle_.zero_m = zero_m;
  }
  if (line.radius) {
    cycle_.r = *line.radius * unit_m() + (incremental_ ? cycle_.initial_m : zero_m);
    check_coordinate("R", *cycle_.r, *line.radius, unit_name());
  }
  if (line.position[2]) {
    cycle_.z = *line.position[2] * unit_m() + (incremental_ ? cycle_.r.value_or(cycle_.initial_m) : zero_m);
    check_coordinate("Z", *cycle_.z, *line.position[2], unit_name());
  }
  if (line.q) cycle_.q = std::abs(line.q->number) * unit_m();
  constexpr double least_ms = 10.0;
  if (line.p && !line.call) {
    cycle_.dwell_s = seconds_of(*line.p, least_ms);
    check_dwell("P", cycle_.dwell_s);
  }
}

std::size_t GcodeReader::repeats_of(const Line& line) const {
  constexpr double most = 9999.0;
  const std::optional<double> said = line.l && !line.call ? std::optional(line.l->number) : line.vector[2];
  const double repeats = said.value_or(1.0);
  if (!(repeats >= 0.0 && repeats <= most && repeats == std::round(repeats))) {
    reject(line.l ? "L" : "K", repeats, "", "must be a whole number of holes from 0 to 9999");
  }
  return static_cast<std::size_t>(repeats);
}

void GcodeReader::drill(const Line& line) {
  const std::string name = fmt::format("G{:g}", 0.1 * cycle_.code);
  const auto needs = [&](bool well, const char* field, const char* rule, const char* hint = "") {
    if (!well) reject(field, std::nullopt, "", fmt::format("{} {}", name, rule), hint);
  };
  special_ = true;
  needs(plane_.normal == 2, "G17", "is read in the plane G17 alone");
  needs(feed_mode_ == FeedMode::per_minute, "G94", "needs a feed per minute (G94)");
  const bool turns = line.rotary[0] || line.rotary[1] || line.rotary[2];
  needs(!tilted_ || tilted_->axes.col(2) == Vector3d::UnitZ(), "G69", "is not read in a tilted plane",
        "Let the CAM system write cycles as straight moves");
  needs(!turns && pose_.axis == Vector3d::UnitZ(), "A, B, C", "is read with the tool along Z alone",
        "Let the CAM system write cycles as straight moves");
  needs(!line.vector[0] && !line.vector[1], "I, J", "is not read with I or J, which another control would drill by",
        "Let the CAM system write cycles as straight moves");
  const std::size_t repeats = repeats_of(line);
  if (repeats == 0) return;
  needs(cycle_.r.has_value(), "R", "needs R: the height that it drills from");
  needs(cycle_.z.has_value(), "Z", "needs Z: the bottom of the hole");
  needs(*cycle_.z <= *cycle_.r, "Z", "needs a bottom Z that is not above R");
  needs(!pecks(cycle_.code) || cycle_.q.value_or(0.0) > 0.0, "Q", "needs Q > 0: the depth of a peck");
  if (!known_[2]) reject_unknown("Z");
  Line across = line;
  across.position[2].reset();
  Vector3d at_m = position_after(across);
  if (const char* const axis = unknown_axis()) reject_unknown(axis);
  if (pending_) reject_unknown("X, Y");
  if (!start_) begin_at({.tip_m = at_m, .axis = pose_.axis});
  begin_cutting();
  steps_.clear();
  const Vector3d stride_m = at_m - pose_.tip_m;
  for (std::size_t i = 0; i < repeats; ++i) {
    if (i > 0 && incremental_) at_m += stride_m;
    check_coordinate("X", at_m.x(), at_m.x() / unit_m(), unit_name());
    check_coordinate("Y", at_m.y(), at_m.y() / unit_m(), unit_name());
    drill_hole(at_m, line);
  }
  if ((stops_spindle(cycle_.code) || taps(cycle_.code)) && !spindle_after_) spindle_after_ = spindle_;
  begin_steps();
}

void GcodeReader::drill_hole(const Vector3d& hole_m, const Line& line) {
  const int code = cycle_.code;
  Drilling drilling = {.waits = code == 880, .feeds_out = code == 850 || code == 890 || taps(code)};
  if (code != 810) drilling.dwell_s = cycle_.dwell_s;
  if (stops_spindle(code)) drilling.back = Spindle::off;
  if (taps(code)) drilling.back = code == 840 ? Spindle::counterclockwise : Spindle::clockwise;
  if (pecks(code)) {
    remarks_.assume({.what = "Clearance of pecks (G73, G83)",
                     .taken = "0.254 mm, as LinuxCNC's; a setting of the machine on Fanuc and Haas",
                     .key = "straight moves in place of the cycle"});
    drilling.pecks = code == 830 ? Drilling::Pecks::out : Drilling::Pecks::chip;
    drilling.pecks_m = {*cycle_.q};
    if (!(drilling.count(*cycle_.r - *cycle_.z) < most_steps)) {
      reject("Q", *cycle_.q / unit_m(), unit_name(), "would make too many pecks");
    }
  }
  const DrilledHole hole = {.point_m = {hole_m.x(), hole_m.y(), 0.0},
                            .start_m = *cycle_.r,
                            .bottom_m = *cycle_.z,
                            .return_m = cycle_.to_r ? *cycle_.r : std::max(cycle_.initial_m, *cycle_.r)};
  const std::size_t first = steps_.size();
  const Pose from = {.tip_m = steps_.empty() ? pose_.tip_m : steps_.back().tip_m, .axis = pose_.axis};
  add_hole(drilling, hole, from, spindle_, steps_);
  if (steps_.size() > most_steps) {
    reject("Q", std::nullopt, "", fmt::format("would make more than {} moves of one line", most_steps),
           "Give deeper pecks or fewer holes");
  }
  for (std::size_t i = first; i < steps_.size(); ++i) {
    const Vector3d& begin_m = i == 0 ? pose_.tip_m : steps_[i - 1].tip_m;
    if (steps_[i].kind != Block::Kind::feed) continue;
    steps_[i].duration_s = feed_duration_s(line, (steps_[i].tip_m - begin_m).norm(), 0.0);
  }
}

}  // namespace robomill::program
