#include "testing/page/cut_sample.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "robomill/io/json.hpp"

namespace robomill::page {
namespace {

using io::Json;
using std::numbers::pi;

constexpr double speed_rpm = 9200.0;
constexpr double rotation_hz = speed_rpm / 60.0;
constexpr int teeth = 3;
constexpr double chatter_hz = 566.4;

/// Of an invented chart that is stable around whole fractions of a speed.
double radius(double at_rpm, double radial_depth_mm) {
  return 0.55 + 0.16 * radial_depth_mm * (1.3 - std::cos(2.0 * pi * 32000.0 / at_rpm));
}

Json point(double at_rpm, double radial_depth_mm) {
  const double spectral_radius = radius(at_rpm, radial_depth_mm);
  const bool stable = spectral_radius < 1.0;
  return {{"spindle_speed_rpm", at_rpm},
          {"radial_depth_mm", radial_depth_mm},
          {"spectral_radius", spectral_radius},
          {"stable", stable},
          {"error_estimate", 1e-6},
          {"multiplier", {spectral_radius, 0.0}},
          {"dominant_frequency_hz", stable ? Json() : Json(chatter_hz)},
          {"kind", "hopf"},
          {"mode", stable ? Json() : Json(8)},
          {"mode_of", stable ? Json() : Json("tool")}};
}

/// Where the cut begins to be unstable.
Json border(double at_rpm, double radial_depth_mm) {
  return {{"spindle_speed_rpm", at_rpm},
          {"radial_depth_mm", radial_depth_mm},
          {"chatter_frequency_hz", chatter_hz},
          {"kind", "hopf"},
          {"mode", 8},
          {"mode_of", "tool"},
          {"curve", 1},
          {"error_estimate", 1e-6}};
}

/// A reading as chatter of mode 8, n rotations off.
Json chatter_reading(double frequency_hz, int rotations) {
  const double expected_hz = chatter_hz + rotations * rotation_hz;
  return {{"kind", "chatter"},
          {"rotations", rotations},
          {"mirrored", false},
          {"of_tooth_passing", rotations % teeth == 0},
          {"mode", 8},
          {"mode_of", "tool"},
          {"mode_frequency_hz", chatter_hz},
          {"expected_hz", expected_hz},
          {"difference_hz", frequency_hz - expected_hz},
          {"tolerance_hz", 11.4},
          {"likelihood_per_hz", 0.08}};
}

Json cut_reading(double frequency_hz, int rotations) {
  const double expected_hz = rotations * rotation_hz;
  return {{"kind", rotations % teeth == 0 ? "tooth passing" : "rotation"},
          {"rotations", rotations},
          {"mirrored", false},
          {"of_tooth_passing", rotations % teeth == 0},
          {"mode", nullptr},
          {"mode_of", nullptr},
          {"expected_hz", expected_hz},
          {"difference_hz", frequency_hz - expected_hz},
          {"tolerance_hz", 1.0},
          {"likelihood_per_hz", 0.9}};
}

Json peak(double frequency_hz, const char* state, const Json& reading, const Json& own_hz, const Json& others) {
  Json json = {{"frequency_hz", frequency_hz}, {"state", state}};
  json.update(reading);
  json["chatter_frequency_hz"] = own_hz;
  json["others"] = others;
  return json;
}

Json kind_alone(const char* kind) {
  return {{"kind", kind}, {"mode", nullptr}, {"mode_of", nullptr}};
}

/// Displacement or force that grows until the teeth leave the cut, as bands of many runs.
Json bands(double size, double growth) {
  Json low = Json::array(), high = Json::array();
  for (int run = 0; run < 400; ++run) {
    const double amplitude = size * (0.2 + 0.8 / (1.0 + std::exp(-growth * (run - 160.0) / 40.0)));
    low.push_back(-amplitude);
    high.push_back(0.9 * amplitude);
  }
  return {{"low", std::move(low)}, {"high", std::move(high)}};
}

}  // namespace

std::string sample_sweep() {
  Json json = {{"document", "sweep/1"},
               {"sweep", "radial_depth"},
               {"spindle_speed_rpm", Json::array()},
               {"radial_depth_mm", Json::array()}};
  json["spectral_radius"] = Json::array();
  json["boundary"] = Json::array();
  json["stable"] = Json::array();
  for (int j = 0; j <= 80; ++j) json["radial_depth_mm"].push_back(0.05 * j);
  for (int i = 0; i <= 120; ++i) {
    const double at_rpm = 4000.0 + 100.0 * i;
    json["spindle_speed_rpm"].push_back(at_rpm);
    const double limit_mm = 0.45 / (radius(at_rpm, 1.0) - 0.55);
    const bool found = limit_mm < 4.0;
    Json intervals = Json::array();
    intervals.push_back({0.0, found ? limit_mm : 4.0});
    json["stable"].push_back({{"spindle_speed_rpm", at_rpm}, {"intervals", intervals}});
    if (!found) continue;
    json["boundary"].push_back(border(at_rpm, limit_mm));
  }
  for (const Json& depth_mm : json["radial_depth_mm"]) {
    Json row = Json::array();
    for (const Json& at_rpm : json["spindle_speed_rpm"]) {
      row.push_back(radius(at_rpm.get<double>(), depth_mm.get<double>()));
    }
    json["spectral_radius"].push_back(row);
  }
  json["points"] = Json::array({point(8000.0, 1.0), point(9200.0, 3.0)});
  json["method"] = "collocation";
  json["period"] = "tooth";
  for (const char* count : {"evaluations", "unsettled", "uncertain", "seconds"}) json[count] = 0;
  return json.dump();
}

std::string sample_comparison(const std::string& text) {
  Json json = {{"document", "comparison/1"}, {"spindle_speed_rpm", Json::array()}, {"methods", Json::array()}};
  struct Row {
    const char* method;
    double factor, seconds;
  };
  constexpr std::array<Row, 3> rows = {
      {{"collocation", 1.0, 2.31}, {"semi-discretization", 1.004, 0.84}, {"zeroth-order", 1.06, 0.01}}};
  for (int i = 0; i <= 60; ++i) json["spindle_speed_rpm"].push_back(4000.0 + 200.0 * i);
  for (const Row& row : rows) {
    Json limits = Json::array();
    for (const Json& at_rpm : json["spindle_speed_rpm"]) {
      const double limit_mm = row.factor * 0.3 / (radius(at_rpm.get<double>(), 1.0) - 0.55);
      limits.push_back(limit_mm < 3.0 ? Json(limit_mm) : Json());
    }
    json["methods"].push_back({{"method", row.method},
                               {"limit_mm", limits},
                               {"median_error", row.factor - 1.0},
                               {"worst_error", 2.0 * (row.factor - 1.0)},
                               {"differ", row.factor > 1.05 ? 2 : 0},
                               {"rejection", ""},
                               {"seconds", row.seconds}});
  }
  json["methods"].push_back({{"method", "multi-frequency"},
                             {"limit_mm", Json::array()},
                             {"median_error", nullptr},
                             {"worst_error", nullptr},
                             {"differ", 0},
                             {"rejection", text.empty() ? "takes no helix" : text},
                             {"seconds", 0.0}});
  return json.dump();
}

std::string sample_postures() {
  Json json = {{"document", "postures/1"}, {"spindle_speed_rpm", Json::array()}, {"postures", Json::array()}};
  for (int i = 0; i <= 60; ++i) json["spindle_speed_rpm"].push_back(4000.0 + 200.0 * i);
  constexpr std::array<double, 4> x_mm = {1270.0, 1670.0, 2070.0, 1270.0};
  for (std::size_t p = 0; p < x_mm.size(); ++p) {
    Json limits = Json::array();
    for (const Json& at_rpm : json["spindle_speed_rpm"]) {
      const double limit_mm = (1.0 - 0.12 * static_cast<double>(p)) * 0.3 / (radius(at_rpm.get<double>(), 1.0) - 0.55);
      limits.push_back(limit_mm < 3.0 ? Json(limit_mm) : Json());
    }
    json["postures"].push_back({{"number", p + 1},
                                {"joints_deg", {-11.1, -11.5, 21.6, 0.0, 79.9, 101.1}},
                                {"tip_mm", {x_mm.at(p), -250.0, 776.0}},
                                {"axis", {0.0, 0.0, 1.0}},
                                {"gamma_deg", p < 3 ? 90.0 : 150.0},
                                {"limit_mm", limits}});
  }
  json["directions"] = {{{"direction", "x"}, {"postures", {1, 2, 3}}, {"spread", 0.27}, {"speeds", 52}},
                        {{"direction", "gamma"}, {"postures", {1, 4}}, {"spread", nullptr}, {"speeds", 0}}};
  return json.dump();
}

std::string sample_explanation() {
  Json json = {{"document", "explain/1"},
               {"spindle_speed_rpm", speed_rpm},
               {"speed_from_peaks", true},
               {"peaks", Json::array()}};
  Json& peaks = json["peaks"];
  const auto at_rotation = [&peaks](int rotations) {
    const double at_hz = rotations * rotation_hz + 0.02;
    peaks.push_back(peak(at_hz, "named", cut_reading(at_hz, rotations), nullptr, Json::array()));
  };
  const auto at_chatter = [&peaks](int rotations) {
    const double at_hz = chatter_hz + rotations * rotation_hz + 1.7;
    peaks.push_back(peak(at_hz, "named", chatter_reading(at_hz, rotations), chatter_hz + 1.7, Json::array()));
  };
  at_rotation(1);
  at_rotation(3);
  at_chatter(0);
  peaks.push_back(peak(612.6, "ambiguous", kind_alone("cut or chatter"), nullptr,
                       Json::array({cut_reading(612.6, 4), chatter_reading(612.6, 0)})));
  at_rotation(6);
  at_chatter(3);
  peaks.push_back(peak(1234.5, "unexplained", kind_alone("unexplained"), nullptr, Json::array()));
  json.update({{"state", "named"}, {"mode", 8}, {"mode_of", "tool"}, {"chatter_frequency_hz", chatter_hz + 1.7}});
  json["chatter"] = {{"kind", "regenerative"},
                     {"spectral_radius", 1.183},
                     {"spectral_radius_without_delay", 0.871},
                     {"chatter_frequency_hz", chatter_hz},
                     {"mode", 8},
                     {"mode_of", "tool"}};
  return json.dump();
}

std::string sample_simulation() {
  const Json wall = {{"angle_deg", 180.0},
                     {"location_error_um", 12.4},
                     {"least_location_error_um", 9.8},
                     {"greatest_location_error_um", 15.1},
                     {"ra_um", 2.3},
                     {"rz_um", 9.6}};
  const Json json = {
      {"document", "simulation/1"},
      {"spindle_speed_rpm", speed_rpm},
      {"axial_depth_mm", 1.2},
      {"verdict", "chatter"},
      {"chatter_frequency_hz", chatter_hz},
      {"chatter_amplitude_um", 23.1},
      {"growth_per_period", 1.0},
      {"period_s", 1.0 / rotation_hz},
      {"small_vibration",
       {{"spectral_radius", 1.183}, {"error_estimate", 1e-4}, {"multiplier", {0.9, 0.768}}, {"period_s", 0.0022}}},
      {"missed_share", 0.31},
      {"walls", Json::array({wall})},
      {"vibrating_peak_n", {211.0, 168.0, 41.0}},
      {"vibrating_peak_force_n", 259.0},
      {"mean_force_n", {31.0, -12.0, 6.0}},
      {"samples", 40000},
      {"sample_rate_hz", 100000.0},
      {"steps_per_revolution", 652},
      {"slices", 12},
      {"error_estimate", 2e-4},
      {"resolved", true},
      {"diverged", false},
      {"seconds", 1.4}};
  return json.dump();
}

std::string sample_vibration() {
  Json frequency = Json::array(), x = Json::array(), y = Json::array();
  for (int i = 0; i <= 2000; ++i) {
    const double f = 2.5 * i;
    const auto line = [f](double at_hz, double size) { return size / (1.0 + std::pow((f - at_hz) / 3.0, 2)); };
    const double forced = line(teeth * rotation_hz, 6.0) + line(2.0 * teeth * rotation_hz, 1.2);
    frequency.push_back(f);
    x.push_back(1e-4 + forced + line(chatter_hz, 21.0) + line(chatter_hz + teeth * rotation_hz, 3.0));
    y.push_back(1e-4 + 0.5 * forced + line(chatter_hz, 9.0));
  }
  const Json json = {{"document", "vibration/1"},
                     {"displacement_um", {{"x", bands(30.0, 1.0)}, {"y", bands(14.0, 1.0)}}},
                     {"force_n", {{"x", bands(210.0, 0.8)}, {"y", bands(160.0, 0.8)}, {"z", bands(40.0, 0.8)}}},
                     {"run_s", 0.001},
                     {"spectrum", {{"from_s", 0.2}, {"frequency_hz", frequency}, {"x_um", x}, {"y_um", y}}}};
  return json.dump();
}

}  // namespace robomill::page
