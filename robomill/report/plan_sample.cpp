#include "robomill/report/plan_sample.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/report/json.hpp"

namespace robomill::report {
namespace {

using Json = nlohmann::ordered_json;
constexpr int teeth = 3;

double limit_at(const Lobes& lobes, double speed_rad_per_s) {
  Eigen::Index nearest = 0;
  (lobes.spindle_speed_rad_per_s.array() - speed_rad_per_s).abs().minCoeff(&nearest);
  return lobes.limit_depth_m[nearest];
}

Json cuts_json(const Lobes& lobes) {
  const std::vector<std::tuple<double, double, const char*, const char*>> made = {
      {5000, 0.5, nullptr, ""},
      {5000, 0.9, nullptr, ""},
      {6500, 0.4, "stable", ""},
      {6500, 0.6, "borderline", "667.5, 1967.5, 2076 Hz"},
      {6500, 0.8, "chatter", "325.0, 667.0, 992.0 Hz"},
      {8000, 1.0, "stable", ""},
      {8000, 1.2, "stable", ""},
      {8000, 1.5, "chatter", "817.5, 2017.5 Hz"},
      {9500, 0.9, nullptr, ""},
      {11000, 0.8, nullptr, ""},
      {15000, 1.1, "stable", ""},
      {15000, 1.3, "borderline", ""}};
  Json cuts = Json::array();
  for (const auto& [rpm, depth_mm, result, note] : made) {
    const double limit_mm = limit_at(lobes, rpm * units::rpm) / units::mm;
    const Json predicted = depth_mm > limit_mm ? "chatter" : "stable";
    const Json seen = result == nullptr ? Json() : Json(result);
    const bool compared = seen == "stable" || seen == "chatter";
    cuts.push_back({{"spindle_speed_rpm", rpm},
                    {"axial_depth_mm", depth_mm},
                    {"result", seen},
                    {"predicted", predicted},
                    {"limit_depth_mm", number(limit_mm)},
                    {"agrees", compared ? Json(seen == predicted) : Json()},
                    {"note", note}});
  }
  return cuts;
}

/// The depth 20 % below the limit at every speed, the fastest first.
std::vector<Json> recommendations(const Lobes& lobes) {
  std::vector<Json> found;
  for (Eigen::Index i = 5; i + 5 < lobes.limit_depth_m.size(); ++i) {
    double limit = lobes.searched_depth_m;
    for (Eigen::Index j = i - 5; j <= i + 5; ++j) limit = std::fmin(limit, lobes.limit_depth_m[j]);
    limit = std::min(limit, (3.4 - 1.6 * static_cast<double>(i) / 240.0) * units::mm / 0.8);
    const double rpm = lobes.spindle_speed_rad_per_s[i] / units::rpm;
    const double depth_mm = 0.8 * limit / units::mm;
    const double feed_mm_per_min = 0.01 * teeth * rpm;
    found.push_back({{"spindle_speed_rpm", rpm},
                     {"axial_depth_mm", depth_mm},
                     {"feed_per_tooth_mm", 0.01},
                     {"margin", 0.2},
                     {"cutting_speed_m_per_min", 0.012 * std::numbers::pi * rpm},
                     {"feed_mm_per_min", feed_mm_per_min},
                     {"removal_rate_mm3_per_s", depth_mm * 1.8 * feed_mm_per_min / 60.0},
                     {"limited_by", "mode 8, chatter"},
                     {"limit_depth_mm", depth_mm / 0.8},
                     {"chatter_frequency_hz", 566.4},
                     {"torque_n_m", 0.08},
                     {"power_w", 0.08 * rpm * units::rpm},
                     {"surface_error_um", 12.5},
                     {"peak_deflection_um", 31.0},
                     {"mode", 8},
                     {"mode_of", "tool"}});
  }
  std::ranges::sort(found, std::greater<>(), [](const Json& cut) { return cut["removal_rate_mm3_per_s"].get<double>(); });
  return found;
}

Json feed_directions_json() {
  Json rows = Json::array();
  for (int i = 0; i < 72; ++i) {
    const double turn = std::cos(2.0 * (5.0 * i * units::deg - 0.6));
    const double at_speed_mm = 1.9 + 1.3 * turn;
    rows.push_back({{"feed_direction_deg", 5 * i},
                    {"lowest_limit_mm", 0.42 + 0.13 * turn},
                    {"limit_at_speed_mm", at_speed_mm > 3.0 ? Json() : Json(at_speed_mm)}});
  }
  return rows;
}

Json fact(const char* label, const std::string& value) {
  return {{"label", label}, {"value", value}};
}

}  // namespace

std::string sample_plan(const Lobes& lobes, const std::string& text) {
  const auto said = [&](const char* own) { return text.empty() ? std::string(own) : text; };
  const std::vector<Json> found = recommendations(lobes);
  Json recommended = found.front();
  recommended["limited_by"] = said("mode 8, chatter");
  Json alternatives = Json::array();
  for (const Json& cut : found) {
    const auto near = [&](const Json& other) {
      const double ratio = other["spindle_speed_rpm"].get<double>() / cut["spindle_speed_rpm"].get<double>();
      return std::abs(ratio - 1.0) < 0.06;
    };
    if (alternatives.size() < 3 && !near(recommended) && std::ranges::none_of(alternatives, near)) {
      alternatives.push_back(cut);
    }
  }
  Json torque_mm = Json::array();
  Json torque_rpm = Json::array();
  for (int i = 0; i <= 24; ++i) {
    torque_rpm.push_back(4000 + 500 * i);
    torque_mm.push_back(3.4 - 1.6 * i / 24.0);
  }
  Json cuts = cuts_json(lobes);
  cuts.front()["note"] = said("");
  const auto count = [&](const Json& agrees) {
    return std::ranges::count_if(cuts, [&](const Json& cut) { return cut["agrees"] == agrees; });
  };
  const Json plan = {
      {"facts", Json::array({fact("Cutter", said("3 teeth, 12 mm, flat end")), fact("Cut", "up-milling, 1.8 mm radial depth"),
                             fact("Feed", "0.01 mm per tooth, towards 0°"), fact("Material", "Kt 712 N/mm², Kr 287 N/mm²"),
                             fact("Speeds", "4 000 to 16 000 rpm")})},
      {"agreement", {{"agree", count(true)}, {"disagree", count(false)}, {"not_compared", count(nullptr)}}},
      {"recommended", std::move(recommended)},
      {"alternatives", std::move(alternatives)},
      {"finishing", {{"max_surface_error_um", nullptr}, {"max_deflection_um", nullptr}}},
      {"other_limits",
       Json::array({{{"label", said("spindle torque")},
                     {"spindle_speed_rpm", std::move(torque_rpm)},
                     {"axial_depth_mm", std::move(torque_mm)}}})},
      {"cuts", std::move(cuts)},
      {"feed_direction_deg", 0},
      {"feed_directions", feed_directions_json()},
      {"warnings", Json::array({said("The measured model is not passive: Im H_yy > 0 on 46 % of lines.")})},
      {"notes", Json::array({said("The lobes on this page come from a formula for the feed direction alone; they serve to "
                                  "look at the page.")})}};
  return plan.dump();
}

std::string sample_recordings(const std::string& text) {
  const auto said = [&](const char* own) { return text.empty() ? std::string(own) : text; };
  Random random(11);
  const double rotation_hz = 6500.0 / 60.0;
  std::vector<std::pair<double, double>> lines = {{667.0, 5.1}, {991.98, 3.4}, {342.1, 1.6}, {1966.95, 1.9}};
  for (int k = 1; k < 23; ++k) lines.emplace_back(k * rotation_hz, k % teeth == 0 ? 3.2 / std::sqrt(k) : 0.5);
  Json frequency = Json::array();
  Json amplitude = Json::array();
  for (int i = 0; i < 5001; ++i) {
    const double f = 0.5 * i;
    double sum = 0.03 * std::hypot(random.normal(), random.normal());
    for (const auto& [centre, height] : lines) sum += height * std::exp(-std::pow((f - centre) / 0.8, 2));
    frequency.push_back(f);
    amplitude.push_back(sum);
  }
  const auto peak = [](double at_hz, double height, const char* kind, const std::string& what) -> Json {
    return {{"frequency_hz", at_hz}, {"amplitude", height}, {"kind", kind}, {"text", what}};
  };
  const Json recordings = Json::array(
      {{{"file", said("cut_6500_08.csv")},
        {"spindle_speed_rpm", 6500},
        {"teeth", teeth},
        {"rotation_hz", rotation_hz},
        {"tooth_passing_hz", teeth * rotation_hz},
        {"axial_depth_mm", 0.8},
        {"amplitude_unit", "m/s²"},
        {"frequency_hz", std::move(frequency)},
        {"amplitude", std::move(amplitude)},
        {"peaks", Json::array({peak(325.0, 1.85, "tooth passing", said("3 × rotation: tooth passing")),
                               peak(667.0, 5.1, "chatter", "chatter, mode 1: 6 × rotation + 17.0 Hz"),
                               peak(991.98, 3.4, "chatter", "chatter, mode 1: 9 × rotation + 17.0 Hz"),
                               peak(108.33, 0.5, "rotation", "rotation")})},
        {"verdict", "chatter"},
        {"reason", said("Two peaks above the tooth-passing line stand between the harmonics")}}});
  return recordings.dump();
}

}  // namespace robomill::report
