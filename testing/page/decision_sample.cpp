#include "testing/page/decision_sample.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "robomill/io/json.hpp"
#include "testing/page/blocks_sample.hpp"

namespace robomill::page {
namespace {

using io::Json;

constexpr double programmed_speed_rpm = 12000.0;
constexpr double least_margin = 0.1;
constexpr double allowed_surface_error_um = 40.0;

/// The values of a column of blocks.json that are known.
std::vector<double> known(const Json& blocks, const char* column) {
  std::vector<double> values;
  for (const Json& value : blocks.at(column)) {
    if (value.is_number()) values.push_back(value.get<double>());
  }
  return values;
}

double highest(const Json& blocks, const char* column) {
  return std::ranges::max(known(blocks, column));
}

/// The block whose value in a column is the highest, where it is more than is allowed.
Json worst(const Json& blocks, const char* column, const std::string& limit, double allowed, const char* unit) {
  std::size_t at = 0;
  double most = allowed;
  for (std::size_t i = 0; i < blocks.at(column).size(); ++i) {
    const Json& value = blocks.at(column)[i];
    if (!value.is_number() || value.get<double>() <= most) continue;
    most = value.get<double>();
    at = i;
  }
  return {{"limit", limit},
          {"block", blocks.at("block")[at]},
          {"line", blocks.at("line")[at]},
          {"value", most},
          {"allowed", allowed},
          {"unit", unit}};
}

Json as_programmed(const Json& blocks, const std::string& text) {
  const auto unstable = std::ranges::count_if(known(blocks, "spectral_radius"), [](double at) { return at >= 1.0; });
  return {{"cutting_time_s", 52.4},
          {"robot_time_s", nullptr},
          {"total_time_s", 61.9},
          {"lowest_spindle_speed_rpm", programmed_speed_rpm},
          {"highest_spindle_speed_rpm", programmed_speed_rpm},
          {"unstable_blocks", unstable},
          {"uncertain_blocks", 0},
          {"least_stability_margin", std::ranges::min(known(blocks, "stability_margin"))},
          {"peak_force_n", highest(blocks, "peak_f_n")},
          {"revolution_torque_n_m", highest(blocks, "torque_n_m")},
          {"sustained_power_w", highest(blocks, "power_w")},
          {"peak_deflection_um", highest(blocks, "deflection_um")},
          {"worst_surface_error_um", highest(blocks, "surface_error_um")},
          {"peak_vibration_um", nullptr},
          {"greatest_torque_share", nullptr},
          {"reversals", 0},
          {"violations",
           Json::array({worst(blocks, "spectral_radius", text.empty() ? "stability" : text, 1.0, ""),
                        worst(blocks, "surface_error_um", "surface_error", allowed_surface_error_um, "µm")})}};
}

Json as_decided() {
  return {{"cutting_time_s", 43.1},
          {"robot_time_s", nullptr},
          {"total_time_s", 52.6},
          {"lowest_spindle_speed_rpm", 14200},
          {"highest_spindle_speed_rpm", 15600},
          {"unstable_blocks", 0},
          {"uncertain_blocks", 0},
          {"least_stability_margin", 0.112},
          {"peak_force_n", 84.0},
          {"revolution_torque_n_m", 0.176},
          {"sustained_power_w", 288.0},
          {"peak_deflection_um", nullptr},
          {"worst_surface_error_um", 33.6},
          {"peak_vibration_um", nullptr},
          {"greatest_torque_share", nullptr},
          {"reversals", 0},
          {"violations", Json::array()}};
}

Json alternatives_json(const std::function<std::string(const char*)>& said) {
  const auto row = [](double rpm, int stretch, Json time_s, const std::string& stopped_by, Json limit,
                      Json block) -> Json {
    const Json line = block.is_null() ? Json() : Json(block.get<int>() + 13);
    return {{"spindle_speed_rpm", rpm},
            {"stretch", stretch},
            {"cutting_time_s", std::move(time_s)},
            {"stopped_by", stopped_by},
            {"limit", std::move(limit)},
            {"block", std::move(block)},
            {"line", line}};
  };
  return Json::array(
      {row(14200, 2, 14.8, said("slower"), nullptr, nullptr),
       row(16400, 3, 12.0, said("power 0.42 kW; at most 0.4 kW in block 512 (line 525)"), "power", 512),
       row(15600, 1, nullptr, said("stability margin 0.03; at least 0.1 in block 130 (line 143)"), "stability", 130)});
}

Json stretches_json(const std::function<std::string(const char*)>& said) {
  const auto row = [](int first, int last, double rpm, double low, double high, double time_s,
                      const std::string& limited_by) -> Json {
    return {{"first_block", first},
            {"last_block", last},
            {"first_line", first + 13},
            {"last_line", last + 13},
            {"spindle_speed_rpm", rpm},
            {"lead_deg", 0.0},
            {"tilt_deg", 0.0},
            {"lowest_feed_mm_per_min", low},
            {"highest_feed_mm_per_min", high},
            {"cutting_time_s", time_s},
            {"limited_by", limited_by}};
  };
  return Json::array(
      {row(1, 252, 14200, 1440, 1820, 16.9, said("stability margin 0.11; at least 0.1 in block 130 (line 143)")),
       row(253, 462, 15600, 1440, 1990, 13.0, said("chip thickness 0.04 mm; at most 0.04 mm in block 300 (line 313)")),
       row(463, 672, 14200, 1250, 1820, 13.2, said("surface error 39.8 µm; at most 40 µm in block 512 (line 525)"))});
}

/// Margin over the place along the path and γ: a bank of stable postures that winds along the path, no reach at one
/// end.
Json gamma_map_json(const Json& blocks) {
  Json block = Json::array(), path_mm = Json::array(), chosen = Json::array(), programmed = Json::array();
  Json gamma = Json::array(), margin = Json::array();
  for (int turn = -90; turn <= 90; turn += 5) {
    gamma.push_back(turn);
    margin.push_back(Json::array());
  }
  const std::size_t count = blocks.at("block").size();
  for (std::size_t i = 1; i < count; i += 4) {
    if (!blocks.at("axial_depth_mm")[i].is_number()) continue;
    const double share = static_cast<double>(i) / static_cast<double>(count);
    const double best_deg = 35.0 * std::sin(5.0 * share) - 10.0;
    block.push_back(blocks.at("block")[i]);
    path_mm.push_back(2.05 * static_cast<double>(i));
    chosen.push_back(best_deg);
    programmed.push_back(20.0);
    for (std::size_t k = 0; k < gamma.size(); ++k) {
      const double turn_deg = gamma[k].get<double>();
      const double away = (turn_deg - best_deg) / 60.0;
      const bool reached = turn_deg < 70.0 - 45.0 * share;
      const double at = 0.24 - 0.8 * away * away + 0.1 * std::sin(0.05 * static_cast<double>(i));
      margin[k].push_back(reached ? Json(at) : Json());
    }
  }
  return {{"block", block},       {"path_mm", path_mm},           {"gamma_deg", gamma},          {"margin", margin},
          {"chosen_deg", chosen}, {"programmed_deg", programmed}, {"least_margin", least_margin}};
}

}  // namespace

std::string sample_decision(const std::string& text) {
  const auto said = [&](const char* own) { return text.empty() ? std::string(own) : text; };
  const Json blocks = Json::parse(sample_blocks()).at("blocks");
  const Json decision = {
      {"status", "found"},
      {"reason", said("")},
      {"goal", "time"},
      {"free", {"spindle_speed", "feed", "gamma"}},
      {"collisions_checked", false},
      {"evaluations", 1234},
      {"exact_runs", 2},
      {"seconds", 7.1},
      {"as_programmed", as_programmed(blocks, text)},
      {"decided", as_decided()},
      {"alternatives", alternatives_json(said)},
      {"stretches", stretches_json(said)},
      {"changes", {{"lines", 641}, {"speeds", 3}, {"feeds", 38}}},
      {"notes", Json::array({said("The robot's stiffness is not known: deflection was not looked at as decided.")})},
      {"compensation", nullptr},
      {"gamma_map", gamma_map_json(blocks)}};
  return decision.dump();
}

}  // namespace robomill::page
