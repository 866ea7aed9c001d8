#include "examples/papers/robot-milling-chatter/readings.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/decision/files/limits_schema.hpp"
#include "robomill/io/toml/file.hpp"
#include "testing/stability/problems.hpp"

namespace robomill::examples {
namespace {

stability::LobesOptions searched() {
  stability::LobesOptions options;
  options.axial_depth_m = {0.0, deepest_m};
  options.grid = {2, 100};
  options.tolerance = 1e-4;
  return options;
}

double depth_mm(const stability::Limit& limit) {
  return limit.status == stability::Limit::Status::found ? 1e3 * limit.axial_depth_m : no_limit;
}

/// Ranks from 1; equal values share the mean of theirs.
std::array<double, 8> ranks(const std::array<double, 8>& values) {
  std::array<double, 8> out = {};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto below = std::ranges::count_if(values, [&](double other) { return other < values[i]; });
    const auto equal = std::ranges::count(values, values[i]);
    out[i] = static_cast<double>(below) + 0.5 * static_cast<double>(equal + 1);
  }
  return out;
}

double rank_correlation(const std::array<double, 8>& a, const std::array<double, 8>& b) {
  const std::array<double, 8> x = ranks(a), y = ranks(b);
  const double mean = 0.5 * static_cast<double>(a.size() + 1);
  double xy = 0.0, xx = 0.0, yy = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    xy += (x[i] - mean) * (y[i] - mean);
    xx += (x[i] - mean) * (x[i] - mean);
    yy += (y[i] - mean) * (y[i] - mean);
  }
  return xx > 0.0 && yy > 0.0 ? xy / std::sqrt(xx * yy) : 0.0;
}

/// Rows by speed, four depths at each.
CutTable read_cut_table() {
  io::TomlFile file(std::filesystem::path(ROBOMILL_SOURCE_DIR "/data/robot-cuts.toml"));
  CutTable out;
  const std::size_t depths = out.depths_mm[0].size();
  if (file.tables("cuts") != depths * out.speeds_rpm.size()) throw file.reject("cuts", "must hold 32 cuts");
  for (std::size_t i = 0; i < depths * out.speeds_rpm.size(); ++i) {
    const std::string path = "cuts[" + std::to_string(i) + "]";
    decision::TestCut cut;
    decision::test_cut_table().read(file, path, cut);
    const std::size_t speed = i / depths;
    // What was typed, without the rounding of its unit.
    const double rpm = std::round(cut.spindle_speed_rad_per_s / units::rpm);
    const double depth_mm = std::round(1e6 * cut.axial_depth_m) / 1e3;
    if (i % depths == 0) out.speeds_rpm[speed] = rpm;
    if (rpm != out.speeds_rpm[speed]) throw file.reject(path + ".spindle_speed_rpm", "must be that of four cuts");
    out.depths_mm[speed][i % depths] = depth_mm;
    if (cut.result != decision::Verdict::unknown) {
      out.stated.push_back({.speed = speed, .depth_mm = depth_mm, .result = cut.result});
    }
  }
  return out;
}

}  // namespace

const std::array<DoubleReading, 5>& double_readings() {
  static const std::array<DoubleReading, 5> all{{{"mode_1_damping_ratio", 0, true, {0.0107, 0.0127}},
                                                 {"mode_2_hz", 1, false, {19.57, 19.37}},
                                                 {"mode_2_damping_ratio", 1, true, {0.0222, 0.0223}},
                                                 {"mode_4_hz", 3, false, {62.61, 53.51}},
                                                 {"mode_8_hz", 7, false, {542.67, 543.67}}}};
  return all;
}

std::vector<CutReading> cut_readings() {
  std::vector<CutReading> out;
  for (const int teeth : {2, 3, 4}) {
    for (const double direction : {0.0, 0.5 * std::numbers::pi}) {
      for (const bool right : {false, true}) {
        out.push_back({.teeth = teeth, .feed_direction_rad = direction, .y_to_the_right = right});
      }
    }
  }
  return out;
}

std::vector<ModeTable> mode_tables() {
  std::vector<ModeTable> out;
  out.reserve(32);
  for (int k = 0; k < 32; ++k) out.push_back({k >> 4 & 1, k >> 3 & 1, k >> 2 & 1, k >> 1 & 1, k & 1});
  return out;
}

stability::LobesProblem problem_of(const Reading& reading) {
  stability::LobesProblem problem = stability::testing::robot();
  problem.milling.tool.teeth = reading.cut.teeth;
  problem.feed_direction_rad = reading.cut.feed_direction_rad;
  for (std::size_t k = 0; k < double_readings().size(); ++k) {
    const DoubleReading& twice = double_readings()[k];
    modal::Mode& mode = problem.dynamics.modes[twice.mode];
    (twice.damping ? mode.damping_ratio : mode.frequency_hz) = twice.values[static_cast<std::size_t>(reading.table[k])];
  }
  if (reading.cut.y_to_the_right) {
    for (modal::Mode& mode : problem.dynamics.modes) {
      mode.left(1) = -mode.left(1);
      mode.right(1) = -mode.right(1);
    }
  }
  return problem;
}

const CutTable& cut_table() {
  static const CutTable table = read_cut_table();
  return table;
}

bool agrees(const StatedCut& cut, double limit_mm, BorderlineOf of) {
  using decision::Verdict;
  switch (cut.result) {
    case Verdict::stable:
      return limit_mm > cut.depth_mm;
    case Verdict::chatter:
      return limit_mm < cut.depth_mm;
    case Verdict::borderline:
      return std::isfinite(limit_mm) &&
             std::abs(limit_mm - cut.depth_mm) <= 0.2 * (of == BorderlineOf::depth ? cut.depth_mm : limit_mm);
    case Verdict::unknown:
      break;
  }
  return false;
}

Evidence evidence_of(const Reading& reading, BorderlineOf of) {
  const CutTable& table = cut_table();
  std::vector<double> speeds;
  for (const double speed : table.speeds_rpm) speeds.push_back(speed * units::rpm);
  const std::vector<stability::Limit> limits = limit_depths(problem_of(reading), searched(), speeds);
  Evidence out;
  for (std::size_t k = 0; k < limits.size(); ++k) out.limit_mm[k] = depth_mm(limits[k]);
  for (const StatedCut& cut : table.stated) out.agreed += agrees(cut, out.limit_mm[cut.speed], of) ? 1 : 0;
  std::array<double, 8> middle_mm = {};
  for (std::size_t k = 0; k < middle_mm.size(); ++k) {
    middle_mm[k] = 0.5 * (table.depths_mm[k].front() + table.depths_mm[k].back());
  }
  out.correlation = rank_correlation(out.limit_mm, middle_mm);
  // At 6,500 rpm the named peaks are, or lie 17 Hz above, these multiples of rotation; then those at 8,000 rpm.
  for (const int multiple : {3, 6, 9, 18, 19, 6, 15, 29}) out.peaks += multiple % reading.cut.teeth == 0 ? 1 : 0;
  return out;
}

std::size_t chosen(const std::vector<Score>& scores) {
  if (scores.empty()) throw InvalidInput("scores", "is empty", "There is no reading to choose");
  const double most = std::ranges::max(scores, {}, &Score::agreed).agreed;
  std::size_t best = scores.size();
  for (std::size_t k = 0; k < scores.size(); ++k) {
    if (scores[k].agreed < most - 0.5) continue;
    if (best == scores.size() || scores[k].correlation > scores[best].correlation) best = k;
  }
  return best;
}

std::vector<double> chart_speeds_rpm() {
  std::vector<double> out;
  for (double speed = 4000.0; speed <= 16000.0; speed += 60.0) out.push_back(speed);
  return out;
}

std::vector<double> chart_mm(const Reading& reading, const std::vector<int>& keep_modes) {
  stability::LobesProblem problem = problem_of(reading);
  problem.keep_modes = keep_modes;
  std::vector<double> speeds = chart_speeds_rpm(), out;
  for (double& speed : speeds) speed *= units::rpm;
  for (const stability::Limit& limit : limit_depths(problem, searched(), speeds)) out.push_back(depth_mm(limit));
  return out;
}

PairLimit pair_limit(const Reading& reading, int first_mode) {
  const std::vector<double> speeds_rpm = chart_speeds_rpm();
  const std::vector<double> limits_mm = chart_mm(reading, {first_mode, first_mode + 1});
  const auto lowest = std::ranges::min_element(limits_mm);
  if (*lowest == no_limit) return {};
  return {.lowest_mm = *lowest, .at_rpm = speeds_rpm[static_cast<std::size_t>(lowest - limits_mm.begin())]};
}

bool differs_in(const ModeTable& table, int first_mode) {
  for (std::size_t k = 0; k < table.size(); ++k) {
    const auto mode = static_cast<int>(double_readings()[k].mode) + 1;
    if (table[k] != 0 && mode != first_mode && mode != first_mode + 1) return false;
  }
  return true;
}

}  // namespace robomill::examples
