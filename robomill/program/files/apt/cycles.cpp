// Drilling cycles of an AptReader as the moves that they make.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/program/files/apt_reader.hpp"

namespace robomill::program {
namespace {

using Eigen::Vector3d;

constexpr std::size_t most_moves_of_hole = 100'000;
constexpr const char* as_straight_moves = "straight moves in place of the cycle";
constexpr const char* known_cycle_words =
    "Known are FEDTO, DEPTH, RAPTO, CLEAR, RTRCTO, RETURN, INCR, STEP, 1STPECK, SUBPECK, DWELL, TPI, MMPM, IPM, MMPR, "
    "IPR";

/// What a word behind the cycle's name does.
struct CycleVariant {
  std::string_view word;
  bool read;
};
constexpr std::array<CycleVariant, 13> cycle_variants = {{{"DEEP", true},
                                                          {"BRKCHP", true},
                                                          {"CSINK", true},
                                                          {"TEXT", true},
                                                          {"DRAG", true},
                                                          {"FLOAT", true},
                                                          {"RIGID", true},
                                                          {"NODRAG", false},
                                                          {"BACK", false},
                                                          {"MANUAL", false},
                                                          {"ORIENT", false},
                                                          {"ORIANT", false},
                                                          {"THRU", false}}};

bool is_unit_of_feed(std::string_view word) {
  return word == "MMPM" || word == "IPM" || word == "MMPR" || word == "IPR";
}

/// STEP, STEP1, …
bool is_peck(std::string_view word) {
  return word == "INCR" || word == "1STPECK" || word == "SUBPECK" || (word.starts_with("STEP") && word.size() <= 5);
}

}  // namespace

void AptReader::take_cycle() {
  const std::string name(fields_.empty() ? std::string_view() : fields_[0]);
  const bool alone = fields_.size() == 1;
  if (alone && (name == "OFF" || name == "NOMORE")) {
    end_cycle();
  } else if (alone && (name == "INIT" || name == "CLEAR")) {
    to_start_ = name == "CLEAR";  // where the tool goes between holes
  } else if (alone && name == "ON") {
    if (cycle_.line == 0) reject_text("CYCLE", shown_, "goes on with a cycle that no line has given");
    cycle_.on = true;
  } else {
    cycle_cut_line_ = moved_since_cut_line_ = 0;
    lift_m_.reset();
    cycle_ = {.name = name, .line = line_};
    if (start_ && lost_line_ == 0) {
      cycle_.initial_m = pose_.tip_m;
      cycle_.has_initial = true;
    }
    choose_cycle(name);
    const CycleWords words = read_cycle_words();
    set_cycle(words);
    set_cycle_feed(words);
    cycle_.on = true;
  }
}

void AptReader::end_cycle() {
  if (cycle_cut_line_ > 0 && moved_since_cut_line_ > 0) {
    reject("CYCLE", std::nullopt, "",
           fmt::format("OFF: the cycle of line {} was taken as ended by the FEDRAT of line {}, which is not its own, "
                       "and line {} moves",
                       cycle_.line, cycle_cut_line_, moved_since_cut_line_),
           "Write CYCLE/OFF behind the last hole, and no FEDRAT before it");
  }
  cycle_cut_line_ = moved_since_cut_line_ = 0;
  if (!cycle_.on) {
    skip_statement();
    return;
  }
  cycle_.on = false;
  const std::optional<Vector3d> lift_m = std::exchange(lift_m_, std::nullopt);
  if (!lift_m || *lift_m == pose_.tip_m) return;
  made_ = Made::moves;
  highest_m_ = std::max(highest_m_, lift_m->z());
  move(Block::Kind::rapid, {.tip_m = *lift_m, .axis = pose_.axis}, 0.0);
}

void AptReader::choose_cycle(std::string_view name) {
  if (name == "DEEP2" || name == "BRKCHP2") name.remove_suffix(1);
  static constexpr std::array<std::string_view, 8> known = {"DRILL", "DEEP", "BRKCHP", "TAP",
                                                            "BORE",  "REAM", "CSINK",  "FACE"};
  if (std::ranges::find(known, name) == known.end()) {
    reject_text("CYCLE", shown_, "is not read: it may move the tool",
                "Known are DRILL, DEEP, BRKCHP, TAP, BORE, REAM, CSINK, FACE. Let the CAM system write cycles as "
                "straight moves");
  }
  if (name == "DEEP") cycle_.how.pecks = Drilling::Pecks::out;
  if (name == "BRKCHP") cycle_.how.pecks = Drilling::Pecks::chip;
  cycle_.taps = name == "TAP";
  cycle_.how.feeds_out = name == "TAP" || name == "BORE" || name == "REAM";
  for (std::size_t i = 1; i < fields_.size(); ++i) {
    const auto* const variant = std::ranges::find(cycle_variants, fields_[i], &CycleVariant::word);
    if (variant == cycle_variants.end() || fields_[i - 1] == "RTRCTO" || (i > 1 && fields_[i - 2] == "RTRCTO"))
      continue;
    if (!variant->read) {
      reject_text("CYCLE", fields_[i], "is not read: the tool would leave the hole in another way",
                  "Let the CAM system write cycles as straight moves");
    }
    if (fields_[i] == "DEEP") cycle_.how.pecks = Drilling::Pecks::out;
    if (fields_[i] == "BRKCHP") cycle_.how.pecks = Drilling::Pecks::chip;
    if (fields_[i] == "DRAG") {
      cycle_.how.feeds_out = false;
      cycle_.how.back = Spindle::off;
    }
  }
  if (name == "BORE" && cycle_.how.feeds_out) {
    remarks_.assume({.what = "Way out of the holes of CYCLE/BORE",
                     .taken = "at feed; some machines stop the spindle and go out at rapid",
                     .key = as_straight_moves});
  }
}

AptReader::CycleWords AptReader::read_cycle_words() {
  CycleWords words;
  for (std::size_t i = 1; i < fields_.size();) {
    const bool variant = std::ranges::find(cycle_variants, fields_[i], &CycleVariant::word) != cycle_variants.end();
    if (variant) {
      ++i;
    } else if (is_word(i) || fields_[i] == "1STPECK") {
      i = take_cycle_word(i, words);
    } else {
      words.plain.push_back(number_of(fields_[i++]));
    }
  }
  return words;
}

std::size_t AptReader::take_cycle_word(std::size_t i, CycleWords& words) {
  const std::string_view word = fields_[i];
  const auto number_at = [&](std::size_t at) {
    if (at >= fields_.size()) reject_text("CYCLE", word, "has no number behind it");
    return number_of(fields_[at]);
  };
  if (is_unit_of_feed(word)) {
    if (words.feed) reject_text("CYCLE", word, "is a second feed: one for each step is not read");
    words.unit = word;
    // depth, feed, unit, clearance; else the feed stands behind its unit
    const bool before = words.plain.size() == 2;
    words.feed = before ? words.plain.back() : number_at(i + 1);
    if (before) words.plain.pop_back();
    return before ? i + 1 : i + 2;
  }
  if (word == "RTRCTO" || word == "RETURN") {
    std::size_t behind = i + 1;
    const auto says = [&](std::string_view text) { return behind < fields_.size() && fields_[behind] == text; };
    words.back_to_start = says("AUTO");
    if (says("AUTO") || says("MANUAL")) ++behind;
    if (words.back_to_start) return behind;
    words.back = number_at(behind++);
    if (word == "RETURN" && *words.back == 0.0) words.back.reset();  // Creo: the retract plane
    return says("MANUAL") || says("AUTO") ? behind + 1 : behind;
  }
  if (word == "DWELL") {
    const bool turns = i + 1 < fields_.size() && fields_[i + 1] == "REV";
    double dwell_s = number_at(turns ? i + 2 : i + 1);
    if (turns && dwell_s != 0.0) {
      if (!(spindle_speed_rad_per_s_ > 0.0)) reject_text("CYCLE", "DWELL,REV", "needs a spindle speed before it");
      dwell_s *= units::minute / (spindle_speed_rad_per_s_ / units::rpm);
    }
    check_dwell("DWELL", dwell_s);
    cycle_.how.dwell_s = dwell_s;
    return i + (turns ? 3 : 2);
  }
  const double number = number_at(i + 1);
  if (word == "FEDTO" || word == "DEPTH") {
    words.depth = number;
  } else if (word == "RAPTO") {
    words.rapto = number;
  } else if (word == "CLEAR") {
    words.clear = number;
  } else if (word == "TPI") {
    words.threads_per_inch = number;
  } else if (is_peck(word)) {
    words.steps.push_back(number);
  } else {
    reject_text("CYCLE", word, "is not read: it may move the tool", known_cycle_words);
  }
  return i + 2;
}

void AptReader::set_cycle(const CycleWords& words) {
  std::vector<double> plain = words.plain;
  std::vector<double> steps = words.steps;
  const bool pecks = cycle_.how.pecks != Drilling::Pecks::none;
  if (plain.size() == 3 && pecks && steps.empty()) {
    steps.push_back(plain.back());
    plain.pop_back();
  }
  if (plain.size() > (words.depth ? 0U : 2U) || (plain.size() == 2 && (!words.feed || words.clear))) {
    reject_text("CYCLE", shown_, "has numbers whose meaning is not known",
                "Known is depth, unit, feed, clearance, or a word before each");
  }
  if (!words.depth && plain.empty()) reject_text("CYCLE", shown_, "has no depth", "FEDTO or DEPTH gives it");
  const auto height_m = [&](const char* name, double number) {
    check_coordinate(name, number * unit_m(), number, unit_name());
    return number * unit_m();
  };
  cycle_.depth_m = std::abs(height_m("DEPTH", words.depth ? *words.depth : plain[0]));
  const std::optional<double> clear = plain.size() == 2 ? std::optional(plain[1]) : words.clear;
  if (clear || words.rapto) {
    // With a clearance RAPTO counts from there on down.
    cycle_.start_m = height_m("RAPTO", clear ? *clear - words.rapto.value_or(0.0) : *words.rapto);
    if (!(*cycle_.start_m + cycle_.depth_m > 0.0)) {
      reject("RAPTO", *cycle_.start_m / unit_m(), unit_name(), "is not above the hole's bottom");
    }
  }
  if (words.back) cycle_.return_m = height_m("RTRCTO", *words.back);
  cycle_.returns_to_start = words.back_to_start;
  for (const double step : steps) {
    if (!(step > 0.0)) reject("INCR", step, unit_name(), "must be > 0: the depth of a peck");
    cycle_.how.pecks_m.push_back(height_m("INCR", step));
  }
  if (pecks == cycle_.how.pecks_m.empty()) {
    reject_text("CYCLE", shown_, pecks ? "has no depth of a peck" : "has a depth of a peck and does not peck",
                "INCR or STEP gives it");
  }
  if (!pecks) return;
  remarks_.assume({.what = "Pecks of CYCLE/DEEP and CYCLE/BRKCHP",
                   .taken =
                       "from RAPTO's height on, back to 0.254 mm above what is drilled, as LinuxCNC's; a setting of "
                       "the machine elsewhere",
                   .key = as_straight_moves});
}

void AptReader::set_cycle_feed(const CycleWords& words) {
  if (words.threads_per_inch) {
    if (!cycle_.taps || !(*words.threads_per_inch > 0.0) || words.feed) {
      reject("TPI", *words.threads_per_inch, "", "must be > 0, in CYCLE/TAP, and without another feed");
    }
    cycle_.feed = FeedRate{.value = 1.0 / *words.threads_per_inch, .inches = true, .per_revolution = true};
    return;
  }
  if (!words.feed) return;
  check_feed("CYCLE", *words.feed);
  cycle_.feed = FeedRate{
      .value = *words.feed, .inches = words.unit.starts_with('I'), .per_revolution = words.unit.ends_with('R')};
}

void AptReader::feed_in_cycle(const FeedRate& feed) {
  if (!cycle_.on || !cycle_.feed) return;
  constexpr double tolerance = 1e-6;
  const auto rate = [](const FeedRate& of) { return of.value * (of.inches ? units::inch / units::mm : 1.0); };
  const bool same = feed.per_revolution == cycle_.feed->per_revolution &&
                    std::abs(rate(feed) - rate(*cycle_.feed)) <= tolerance * rate(*cycle_.feed);
  if (same) return;
  cycle_.on = false;
  lift_m_.reset();
  cycle_cut_line_ = line_;
  moved_since_cut_line_ = 0;
  assume_once(Once::cycle_end,
              {.what = fmt::format("End of CYCLE/{} (line {}) without CYCLE/OFF", cycle_.name, cycle_.line),
               .taken = fmt::format("the FEDRAT of line {}, which is not the cycle's", line_),
               .key = "CYCLE/OFF"});
}

DrilledHole AptReader::hole_of(const Pose& hole) {
  const bool needs_initial = !cycle_.start_m || (!cycle_.return_m && !cycle_.returns_to_start && !to_start_);
  if (needs_initial && !cycle_.has_initial) {
    reject("CYCLE", std::nullopt, "", fmt::format("{} of line {} has no heights", cycle_.name, cycle_.line),
           "RAPTO or CLEAR and RTRCTO or RETURN give them, or a position before the cycle");
  }
  const double initial_m = cycle_.has_initial ? (cycle_.initial_m - hole.tip_m).dot(hole.axis) : 0.0;
  if (needs_initial) {
    assume_once(cycle_.start_m ? Once::return_height : Once::start_height,
                {.what = fmt::format("Height that CYCLE/{} {} (line {})", cycle_.name,
                                     cycle_.start_m ? "goes back to" : "begins at", cycle_.line),
                 .taken = "where the tool was before the cycle",
                 .key = cycle_.start_m ? "RTRCTO or RETURN" : "RAPTO or CLEAR"});
  }
  DrilledHole out = {.point_m = hole.tip_m, .axis = hole.axis, .bottom_m = -cycle_.depth_m};
  out.start_m = cycle_.start_m.value_or(initial_m);
  const bool to_start = cycle_.returns_to_start || to_start_;
  out.return_m = to_start ? out.start_m : std::max(cycle_.return_m.value_or(initial_m), out.start_m);
  if (!(out.start_m > out.bottom_m)) {
    reject("CYCLE", std::nullopt, "",
           fmt::format("{} of line {} begins below this hole's bottom", cycle_.name, cycle_.line));
  }
  return out;
}

void AptReader::drill(const Pose& hole) {
  if (lost_line_ > 0) reject_start("a hole");
  const DrilledHole drilled = hole_of(hole);
  if (!start_) begin_at({.tip_m = hole.tip_m + drilled.return_m * hole.axis, .axis = hole.axis});
  if (is_second_tool()) return;
  static_cast<void>(turn_to(hole.axis));
  begin_cutting();
  made_ = Made::moves;
  Drilling how = cycle_.how;
  if (cycle_.taps) {
    how.back = spindle_ == Spindle::counterclockwise ? Spindle::clockwise : Spindle::counterclockwise;
  }
  const bool pecks = how.pecks != Drilling::Pecks::none;
  const auto most = static_cast<double>(most_moves_of_hole);
  if (pecks && !(how.count(drilled.start_m - drilled.bottom_m) < most)) {
    reject("CYCLE", std::nullopt, "", fmt::format("{} of line {} makes too many pecks", cycle_.name, cycle_.line),
           "Give deeper pecks");
  }
  steps_.clear();
  add_hole(how, drilled, pose_, spindle_, steps_);
  Vector3d from_m = pose_.tip_m;
  for (MoveStep& step : steps_) {
    if (step.kind == Block::Kind::feed) {
      step.duration_s = feed_duration_s(cycle_.feed.value_or(feed_), (step.tip_m - from_m).norm(), 0.0);
    }
    from_m = step.tip_m;
    highest_m_ = std::max(highest_m_, from_m.z());
  }
  lift_m_.reset();
  if (to_start_ && cycle_.return_m && *cycle_.return_m > drilled.start_m) {
    lift_m_ = hole.tip_m + *cycle_.return_m * hole.axis;
  }
  begin_steps();
}

}  // namespace robomill::program
