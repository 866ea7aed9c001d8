#include "testing/page/plan_sample.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/json.hpp"
#include "testing/page/decision_sample.hpp"
#include "testing/page/structure_sample.hpp"

namespace robomill::page {
namespace {

using io::Json;
using io::number;
using io::numbers;
using std::complex;
constexpr int teeth = 3;
constexpr double missing = std::numeric_limits<double>::quiet_NaN();
constexpr double searched_mm = 3.0;

/// Limit depth over 241 spindle speeds, in rpm and mm; NaN: none up to searched_mm.
struct LimitCurve {
  Eigen::VectorXd rpm = Eigen::VectorXd::LinSpaced(241, 4000.0, 16000.0);
  Eigen::VectorXd limit_mm = Eigen::VectorXd::Constant(241, missing);
  std::vector<double> chatter_hz = std::vector<double>(241, missing);
};

int mode_at(double chatter_hz) {
  return chatter_hz > 541.5 ? 8 : chatter_hz > 300.0 ? 7 : chatter_hz > 40.0 ? 4 : 1;
}

/// Of the feed direction alone: b = -1 / (2 Ks Re G N*) at each chatter frequency, its speeds from the phase.
/// @param keep  modes from 1; empty: all
LimitCurve limit_curve(const std::vector<int>& keep) {
  const double specific_force_n_per_m2 = 712e6;
  const double teeth_in_cut = 0.09;
  const modal::ModalModel model = sample_model();
  LimitCurve out;
  for (double f = 8.0; f < 900.0; f += 0.02) {
    const complex<double> g = sample_receptance(model, 0, 0, f, keep) + sample_receptance(model, 1, 1, f, keep);
    if (g.real() >= 0.0) continue;
    const double depth_mm = -1.0 / (2.0 * specific_force_n_per_m2 * teeth_in_cut * g.real()) / units::mm;
    if (depth_mm > searched_mm) continue;
    const double waves = 0.5 + std::atan2(g.imag(), g.real()) / std::numbers::pi;
    for (int lobe = 0; lobe < 40; ++lobe) {
      const double at = (60.0 * f / (teeth * (lobe + waves - std::floor(waves))) - 4000.0) / 50.0;
      if (!(at >= 0.0 && at <= 240.0)) continue;
      const auto index = std::lround(at);
      if (out.limit_mm[index] <= depth_mm) continue;
      out.limit_mm[index] = depth_mm;
      out.chatter_hz[static_cast<std::size_t>(index)] = f;
    }
  }
  return out;
}

Json cuts_json(const LimitCurve& lobes) {
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
    const double limit_mm = lobes.limit_mm[std::lround((rpm - 4000.0) / 50.0)];
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
std::vector<Json> recommendations(const LimitCurve& lobes) {
  std::vector<Json> found;
  for (Eigen::Index i = 5; i + 5 < lobes.limit_mm.size(); ++i) {
    double limit_mm = searched_mm;
    for (Eigen::Index j = i - 5; j <= i + 5; ++j) limit_mm = std::fmin(limit_mm, lobes.limit_mm[j]);
    limit_mm = std::min(limit_mm, (3.4 - 1.6 * static_cast<double>(i) / 240.0) / 0.8);
    const double rpm = lobes.rpm[i];
    const double depth_mm = 0.8 * limit_mm;
    const double feed_mm_per_min = 0.01 * teeth * rpm;
    found.push_back({{"spindle_speed_rpm", rpm},
                     {"axial_depth_mm", depth_mm},
                     {"feed_per_tooth_mm", 0.01},
                     {"margin", 0.2},
                     {"cutting_speed_m_per_min", 0.012 * std::numbers::pi * rpm},
                     {"feed_mm_per_min", feed_mm_per_min},
                     {"removal_rate_mm3_per_s", depth_mm * 1.8 * feed_mm_per_min / 60.0},
                     {"limited_by", "mode 8, chatter"},
                     {"window_limit_mm", depth_mm / 0.8},
                     {"window_chatter_frequency_hz", 566.4},
                     {"torque_n_m", 0.08},
                     {"power_w", 0.08 * rpm * units::rpm},
                     {"surface_error_um", 12.5},
                     {"peak_deflection_um", 31.0},
                     {"forced_vibration",
                      {{"amplitude_um", 9.4},
                       {"harmonic", 1},
                       {"of", "tooth passing"},
                       {"frequency_hz", teeth * rpm / 60.0},
                       {"harmonic_um", 9.1},
                       {"mode", 8},
                       {"mode_of", "tool"}}},
                     {"mode", 8},
                     {"mode_of", "tool"}});
  }
  std::ranges::sort(found, std::greater<>(),
                    [](const Json& cut) { return cut["removal_rate_mm3_per_s"].get<double>(); });
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

/// The lobes of two modes each.
Json pairs_json(const std::string& text) {
  Json list = Json::array();
  for (int k = 1; k < 8; k += 2) {
    const LimitCurve part = limit_curve({k, k + 1});
    const std::string label = "modes " + std::to_string(k) + "–" + std::to_string(k + 1);
    list.push_back({{"label", text.empty() ? label : text},
                    {"modes", {k, k + 1}},
                    {"spindle_speed_rpm", numbers(part.rpm)},
                    {"limit_depth_mm", numbers(part.limit_mm)}});
  }
  return list;
}

}  // namespace

std::string sample_lobes() {
  const LimitCurve all = limit_curve({});
  Json limit = Json::array();
  Json boundary = Json::array();
  for (Eigen::Index i = 0; i < all.rpm.size(); ++i) {
    const double chatter_hz = all.chatter_hz[static_cast<std::size_t>(i)];
    Json row = {{"spindle_speed_rpm", all.rpm[i]}, {"axial_depth_mm", number(all.limit_mm[i])}};
    if (std::isfinite(chatter_hz)) {
      row["chatter_frequency_hz"] = chatter_hz;
      row["kind"] = i % 40 == 0 ? "flip" : "hopf";
      row["mode"] = mode_at(chatter_hz);
      row["mode_of"] = "tool";
      row["error_estimate"] = 1e-6;
      boundary.push_back(row);
      boundary.back()["curve"] = 0;
    }
    limit.push_back(std::move(row));
  }
  Json map = Json::array();
  Eigen::VectorXd map_mm = Eigen::VectorXd::LinSpaced(31, 0.0, searched_mm);
  for (const double depth_mm : map_mm) {
    Json row = Json::array();
    for (Eigen::Index i = 0; i < all.rpm.size(); ++i) {
      const double limit_mm = std::isfinite(all.limit_mm[i]) ? all.limit_mm[i] : 3.2;
      row.push_back(std::sqrt(0.4 + 0.6 * depth_mm / limit_mm));
    }
    map.push_back(std::move(row));
  }
  const auto size = [](const Eigen::VectorXd& values) { return static_cast<std::size_t>(values.size()); };
  const Json share(size(map_mm), Json(size(all.rpm), 0.5));
  const Json lobes = {{"document", "lobes/1"},
                      {"spindle_speed_rpm", numbers(all.rpm)},
                      {"axial_depth_mm", numbers(map_mm)},
                      {"spectral_radius", std::move(map)},
                      {"boundary", std::move(boundary)},
                      {"limit", std::move(limit)},
                      {"points", Json::array()},
                      {"method", "collocation"},
                      {"period", "tooth"},
                      {"evaluations", 0},
                      {"unsettled", 0},
                      {"uncertain", 0},
                      {"seconds", 0.0},
                      {"uncertainty",
                       {{"samples", 200},
                        {"spindle_speed_rpm", numbers(all.rpm)},
                        {"axial_depth_mm", numbers(map_mm)},
                        {"limit_5_percent_mm", numbers(0.9 * all.limit_mm)},
                        {"limit_50_percent_mm", numbers(all.limit_mm)},
                        {"limit_95_percent_mm", numbers(1.15 * all.limit_mm)},
                        {"chatter_probability", share},
                        {"seconds", 0.0}}}};
  return lobes.dump();
}

std::string sample_plan(const std::string& text) {
  const auto said = [&](const char* own) { return text.empty() ? std::string(own) : text; };
  const LimitCurve lobes = limit_curve({});
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
      {"document", "plan/1"},
      {"facts",
       Json::array({fact("Cutter", said("3 teeth, 12 mm, flat end")), fact("Cut", "up-milling, 1.8 mm radial depth"),
                    fact("Feed", "0.01 mm per tooth, towards 0°"), fact("Material", "Kt 712 N/mm², Kr 287 N/mm²"),
                    fact("Speeds", "4 000 to 16 000 rpm")})},
      {"agreement", {{"agree", count(true)}, {"disagree", count(false)}, {"not_compared", count(nullptr)}}},
      {"recommended", std::move(recommended)},
      {"alternatives", std::move(alternatives)},
      {"finishing", {{"max_surface_error_um", nullptr}, {"max_deflection_um", nullptr}}},
      {"other_limits", Json::array({{{"label", said("spindle torque")},
                                     {"spindle_speed_rpm", std::move(torque_rpm)},
                                     {"axial_depth_mm", std::move(torque_mm)}}})},
      {"pairs", pairs_json(text)},
      {"limit_share", {{"tool", {0.03, 0.02, 0.01, 0.02, 0.02, 0.01, 0.31, 0.58}}, {"workpiece", Json::array()}}},
      {"cuts", std::move(cuts)},
      {"hit_directions", {"x", "x", "x", "x", "x", "y", "y", "y", "y", "y"}},
      {"feed_direction_deg", 0},
      {"feed_directions", feed_directions_json()},
      {"decision", Json::parse(sample_decision(text))},
      {"warnings", Json::array({said("The measured model is not passive: Im H_yy > 0 on 46 % of lines.")})},
      {"notes",
       Json::array({said("The lobes on this page come from a formula for the feed direction alone; they serve to "
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
  const Json recordings =
      Json::array({{{"file", said("cut_6500_08.csv")},
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
  return Json{{"document", "recordings/1"}, {"recordings", recordings}}.dump();
}

}  // namespace robomill::page
