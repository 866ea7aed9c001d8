#include "robomill/process/files/decision_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "robomill/base/units.hpp"
#include "robomill/io/json.hpp"
#include "robomill/process/blocks/named_block.hpp"

namespace robomill::process {
namespace {

using decision::ProgramLimit;
using io::Json;
using io::number;

/// How a limit is written: its name, its unit, and what that is in SI.
struct LimitWords {
  ProgramLimit limit;
  const char* name;
  const char* unit;
  double factor;
  bool at_least;
};
constexpr LimitWords limit_words[] = {
    {ProgramLimit::stability, "stability margin", "", 1.0, true},
    {ProgramLimit::force, "peak force", "N", 1.0, false},
    {ProgramLimit::torque, "torque, mean of a revolution,", "N·m", 1.0, false},
    {ProgramLimit::power, "sustained power", "kW", units::kw, false},
    {ProgramLimit::deflection, "deflection", "µm", units::um, false},
    {ProgramLimit::surface_error, "surface error", "µm", units::um, false},
    {ProgramLimit::greatest_chip, "chip thickness", "mm", units::mm, false},
    {ProgramLimit::least_chip, "chip thickness", "mm", units::mm, true},
    {ProgramLimit::cutting_speed, "cutting speed", "m/min", 1.0 / units::minute, false},
    {ProgramLimit::spindle_range, "spindle speed", "rpm", units::rpm, false},
    {ProgramLimit::tip_speed, "feed", "mm/min", units::mm / units::minute, false},
    {ProgramLimit::joint_speed, "speed of a joint", "°/s", units::deg, false},
    {ProgramLimit::joint_torque, "torque of a joint", "of its drive's", 1.0, false},
    {ProgramLimit::forced_vibration, "forced vibration", "µm", units::um, false},
    {ProgramLimit::reversal, "reversal of a joint's load", "", 1.0, false},
};

/// None of `none` and `posture`.
const LimitWords* words_of(ProgramLimit limit) {
  const auto* words = std::ranges::find(limit_words, limit, &LimitWords::limit);
  return words == std::end(limit_words) ? nullptr : words;
}

double feed_of(double feed_m_per_s) {
  return feed_m_per_s / units::mm * units::minute;
}

std::size_t line_of(const ForcesResult& forces, std::size_t block) {
  return forces.program->program.blocks[block].line;
}

Json outcome_json(const Outcome& outcome, const ForcesResult& forces) {
  Json violations = Json::array();
  for (const Violation& v : outcome.violations) {
    const LimitWords* words = words_of(v.limit);
    const double factor = words != nullptr ? words->factor : 1.0;
    violations.push_back({{"limit", decision::to_string(v.limit)},
                          {"block", v.block + 1},
                          {"line", line_of(forces, v.block)},
                          {"value", number(v.value / factor)},
                          {"allowed", number(v.allowed / factor)},
                          {"unit", words != nullptr ? words->unit : ""}});
  }
  return {
      {"cutting_time_s", number(outcome.cutting_time_s)},
      {"robot_time_s", number(outcome.robot_time_s)},
      {"total_time_s", number(outcome.total_time_s)},
      {"lowest_spindle_speed_rpm", number(outcome.lowest_spindle_speed_rad_per_s / units::rpm)},
      {"highest_spindle_speed_rpm", number(outcome.highest_spindle_speed_rad_per_s / units::rpm)},
      {"unstable_blocks", outcome.unstable_blocks},
      {"uncertain_blocks", outcome.uncertain_blocks},
      {"least_stability_margin", number(outcome.least_stability_margin)},
      {"peak_force_n", number(outcome.peak_force_n)},
      {"revolution_torque_n_m", number(outcome.revolution_torque_n_m)},
      {"sustained_power_w", number(outcome.sustained_power_w)},
      {"peak_deflection_um", number(outcome.peak_deflection_m / units::um)},
      {"worst_surface_error_um", number(outcome.worst_surface_error_m / units::um)},
      {"peak_vibration_um", number(outcome.peak_vibration_m / units::um)},
      {"greatest_torque_share", outcome.greatest_torque_share > 0.0 ? number(outcome.greatest_torque_share) : Json()},
      {"reversals", outcome.reversals},
      {"violations", std::move(violations)}};
}

Json alternatives_json(const Decision& result, const ForcesResult& forces) {
  Json rows = Json::array();
  for (const RejectedAlternative& one : result.alternatives) {
    const bool slower = one.speed.stopped_by.limit == ProgramLimit::none;
    std::string stopped = limit_text(one.speed.stopped_by);
    if (!slower) stopped += " in " + named_block(forces, one.block);
    rows.push_back({{"spindle_speed_rpm", number(one.speed.spindle_speed_rad_per_s / units::rpm)},
                    {"stretch", one.speed.stretch + 1},
                    {"cutting_time_s", number(one.speed.cutting_time_s)},
                    {"stopped_by", std::move(stopped)},
                    {"limit", slower ? Json() : Json(decision::to_string(one.speed.stopped_by.limit))},
                    {"block", slower ? Json() : Json(one.block + 1)},
                    {"line", slower ? Json() : Json(line_of(forces, one.block))}});
  }
  return rows;
}

/// "chip thickness of 0.05 mm": the limit that a feed goes up to.
std::string reached_text(const decision::LimitUse& use) {
  const LimitWords* words = words_of(use.limit);
  if (words == nullptr) return "its programmed feed";
  const std::string unit = *words->unit == '\0' ? "" : std::string(" ") + words->unit;
  return fmt::format("{} of {:.3g}{}", words->name, use.allowed / words->factor, unit);
}

Json stretches_json(const Decision& result, const ForcesResult& forces) {
  Json rows = Json::array();
  for (const DecidedLines& lines : result.stretches) {
    rows.push_back(
        {{"first_block", lines.first_block + 1},
         {"last_block", lines.last_block + 1},
         {"first_line", line_of(forces, lines.first_block)},
         {"last_line", line_of(forces, lines.last_block)},
         {"spindle_speed_rpm", number(lines.spindle_speed_rad_per_s / units::rpm)},
         {"lead_deg", number(lines.lead_rad / units::deg)},
         {"tilt_deg", number(lines.tilt_rad / units::deg)},
         {"lowest_feed_mm_per_min", number(feed_of(lines.lowest_feed_m_per_s))},
         {"highest_feed_mm_per_min", number(feed_of(lines.highest_feed_m_per_s))},
         {"cutting_time_s", number(lines.cutting_time_s)},
         {"limited_by", reached_text(lines.limited_by) + " in " + named_block(forces, lines.limiting_block)}});
  }
  return rows;
}

Json gamma_map_json(const GammaMap& map) {
  Json out = {{"block", Json::array()},  {"path_mm", Json::array()},    {"gamma_deg", Json::array()},
              {"margin", Json::array()}, {"chosen_deg", Json::array()}, {"programmed_deg", Json::array()}};
  for (const std::size_t block : map.block) out["block"].push_back(block + 1);
  for (const double way : map.path_m) out["path_mm"].push_back(number(way / units::mm));
  for (const double gamma : map.gamma_rad) out["gamma_deg"].push_back(number(gamma / units::deg));
  for (Eigen::Index g = 0; g < map.margin.rows(); ++g) {
    Json row = Json::array();
    for (Eigen::Index i = 0; i < map.margin.cols(); ++i) row.push_back(number(map.margin(g, i)));
    out["margin"].push_back(std::move(row));
  }
  for (const double gamma : map.chosen_rad) {
    out["chosen_deg"].push_back(number(gamma / units::deg));
    out["programmed_deg"].push_back(0.0);
  }
  out["least_margin"] = number(map.least_margin);
  return out;
}

Json compensation_json(const Compensation& compensation) {
  std::size_t moved = 0;
  for (const CompensatedBlock& block : compensation.blocks) {
    const bool along =
        block.state == CompensatedBlock::State::compensated || block.state == CompensatedBlock::State::bounded;
    if (along) ++moved;
  }
  return {{"settled", compensation.status == Compensation::Status::settled},
          {"blocks", moved},
          {"passes", compensation.passes},
          {"rms_before_um", number(compensation.rms_before_m / units::um)},
          {"rms_after_um", number(compensation.rms_after_m / units::um)},
          {"largest_offset_um", number(compensation.largest_offset_m / units::um)}};
}

}  // namespace

std::string limit_text(const decision::LimitUse& use) {
  const LimitWords* words = words_of(use.limit);
  if (words == nullptr) return use.limit == ProgramLimit::posture ? "the robot cannot stand so" : "slower";
  const std::string unit = *words->unit == '\0' ? "" : std::string(" ") + words->unit;
  const bool both_sides = use.limit == ProgramLimit::cutting_speed || use.limit == ProgramLimit::spindle_range;
  const bool at_least = words->at_least || (both_sides && use.value < use.allowed);
  if (!both_sides && (at_least ? use.value >= use.allowed : use.value <= use.allowed)) {
    // What is predicted keeps the limit, but not with what is kept in reserve for the run through the material.
    return fmt::format("{} {:.3g}{}; {} {:.3g}{} and a reserve", words->name, use.value / words->factor, unit,
                       at_least ? "at least" : "at most", use.allowed / words->factor, unit);
  }
  return fmt::format("{} {:.3g}{}; {} {:.3g}{}", words->name, use.value / words->factor, unit,
                     at_least ? "at least" : "at most", use.allowed / words->factor, unit);
}

Json decision_object(const Decision& result, const ForcesResult& forces, const DecideOptions& options,
                     const DecisionOutput& output) {
  Json free = Json::array();
  for (const Free what : options.free) free.push_back(name_in(free_names, what));
  Json out = {{"status", result.status == Decision::Status::found ? "found" : "infeasible"},
              {"reason", result.reason},
              {"goal", name_in(goal_names, options.goal)},
              {"free", std::move(free)},
              {"collisions_checked", output.collisions_checked},
              {"evaluations", result.evaluations},
              {"exact_runs", result.exact_runs},
              {"seconds", number(result.seconds)},
              {"as_programmed", outcome_json(result.as_programmed, forces)},
              {"decided", result.decided ? outcome_json(*result.decided, forces) : Json()},
              {"alternatives", alternatives_json(result, forces)},
              {"stretches", stretches_json(result, forces)},
              {"notes", result.notes},
              {"compensation", result.compensation ? compensation_json(*result.compensation) : Json()},
              {"gamma_map", result.gamma_map ? gamma_map_json(*result.gamma_map) : Json()}};
  out["changes"] = {{"lines", output.changed_lines ? Json(*output.changed_lines) : Json()},
                    {"speeds", result.speeds_changed},
                    {"feeds", result.feeds_changed}};
  return out;
}

}  // namespace robomill::process
