#include "testing/page/identified_sample.hpp"

#include <array>
#include <cmath>

#include "robomill/base/random.hpp"
#include "robomill/io/json.hpp"

namespace robomill::page {
namespace {

using io::Json;

Json coefficients(double factor) {
  return {{"tangential_n_per_mm2", 712.0 * factor}, {"tangential_edge_n_per_mm", 13.2 * factor},
          {"radial_n_per_mm2", 249.0 * factor},     {"radial_edge_n_per_mm", 15.9 * factor},
          {"axial_n_per_mm2", 82.0 * factor},       {"axial_edge_n_per_mm", 1.6 * factor}};
}

Json of_each(double tangential, double radial, double axial) {
  return {{"tangential", tangential}, {"radial", radial}, {"axial", axial}};
}

/// Four feeds a depth and speed, about lines over the feed.
Json slots() {
  Random random(11);
  Json rows = Json::array();
  int line = 2;
  for (const auto& [depth_mm, speed_rpm] :
       {std::array{1.0, 3000.0}, std::array{2.0, 3000.0}, std::array{2.0, 6000.0}}) {
    for (const double feed_mm : {0.03, 0.06, 0.09, 0.12}) {
      const double size = depth_mm * (speed_rpm > 4000.0 ? 0.93 : 1.0);
      const std::array<double, 3> fitted = {-size * (190.0 * feed_mm + 8.0), size * (520.0 * feed_mm + 10.0),
                                            size * (60.0 * feed_mm + 1.0)};
      Json force = Json::array(), residual = Json::array();
      for (const double value : fitted) {
        const double off = 0.02 * std::abs(value) * random.normal();
        force.push_back(value + off);
        residual.push_back(off);
      }
      rows.push_back({{"line", line++},
                      {"feed_per_tooth_mm", feed_mm},
                      {"axial_depth_mm", depth_mm},
                      {"spindle_speed_rpm", speed_rpm},
                      {"force_n", force},
                      {"residual_n", residual}});
    }
  }
  return rows;
}

Json tool(const std::string& name, double overhang_mm, double peak_hz, double peak_um_per_n, double limit_mm) {
  return {{"tool", name},
          {"teeth", 3},
          {"diameter_mm", 12.0},
          {"overhang_mm", overhang_mm},
          {"failure", nullptr},
          {"peak_hz", peak_hz},
          {"peak_um_per_n", peak_um_per_n},
          {"modes", Json::array({{{"frequency_hz", peak_hz}, {"damping_ratio", 0.021}},
                                 {{"frequency_hz", 2.6 * peak_hz}, {"damping_ratio", 0.014}}})},
          {"fit_relative_error", 0.012},
          {"suspect_lines", 0},
          {"lowest_limit_mm", limit_mm},
          {"recommended",
           {{"spindle_speed_rpm", 14200.0},
            {"axial_depth_mm", 1.6 * limit_mm},
            {"window_limit_mm", 2.1 * limit_mm},
            {"removal_rate_mm3_per_s", 700.0 * limit_mm},
            {"limited_by", "chatter"}}},
          {"reason", nullptr},
          {"notes", Json::array()}};
}

}  // namespace

std::string sample_coefficients(const std::string& text) {
  Json by_speed = Json::array();
  for (const double speed_rpm : {3000.0, 6000.0}) {
    by_speed.push_back({{"spindle_speed_rpm", speed_rpm},
                        {"rows", speed_rpm > 4000.0 ? 4 : 8},
                        {"coefficients", coefficients(speed_rpm > 4000.0 ? 0.95 : 1.02)},
                        {"std", coefficients(0.02)}});
  }
  const Json json = {
      {"document", "coefficients/1"},
      {"coefficients", coefficients(1.0)},
      {"identification",
       {{"status", "identified"},
        {"rows", 12},
        {"std", coefficients(0.01)},
        {"r_squared", of_each(0.9987, 0.9971, 0.963)},
        {"noise_n", of_each(1.1, 1.6, 0.9)},
        {"correlation", of_each(-0.91, -0.91, -0.91)},
        {"assumed", Json::array()},
        {"depends_on_speed", true},
        {"speed_probability", 0.0021},
        {"notes",
         Json::array(
             {text.empty() ? "The coefficients depend on the spindle speed beyond the scatter of the rows." : text})},
        {"residuals", slots()},
        {"by_speed", by_speed}}}};
  return json.dump();
}

std::string sample_stiffness(const std::string& text) {
  Random random(5);
  Json displacement = Json::array(), residual = Json::array(), line = Json::array();
  for (int k = 0; k < 14; ++k) {
    Json moved = Json::array(), off = Json::array();
    for (int axis = 0; axis < 3; ++axis) {
      moved.push_back(random.uniform(-1.4, 1.4));
      off.push_back(0.03 * random.normal());
    }
    displacement.push_back(moved);
    residual.push_back(off);
    line.push_back(k + 2);
  }
  const Json json = {
      {"document", "stiffness/1"},
      {"joint_stiffness_n_m_per_rad", {1.9e6, 2.4e6, 1.1e6, 4.1e5, 2.6e5, nullptr}},
      {"unit", {"N m/rad", "N m/rad", "N m/rad", "N m/rad", "N m/rad", "N m/rad"}},
      {"std", {6e4, 5e4, 4e4, 3e4, 5e4, nullptr}},
      {"identifiable", {true, true, true, true, true, false}},
      {"reason", {nullptr, nullptr, nullptr, nullptr, nullptr, text.empty() ? "no load turns it" : text}},
      {"joint_compliance_rad_per_n_m", {5.3e-7, 4.2e-7, 9.1e-7, 2.4e-6, 3.8e-6, nullptr}},
      {"compliance_std", {1.7e-8, 8.7e-9, 3.3e-8, 1.8e-7, 7.4e-7, nullptr}},
      {"line", line},
      {"displacement_mm", displacement},
      {"residual_mm", residual},
      {"rms_mm", 0.031},
      {"r_squared", 0.9984},
      {"condition_number", 18.0},
      {"convergence", {{"status", "converged"}, {"iterations", 4}}}};
  return json.dump();
}

std::string sample_joint(const std::string& text) {
  constexpr std::array names = {"translational_stiffness_n_per_m", "translational_damping_n_s_per_m",
                                "rotational_stiffness_n_m_per_rad", "rotational_damping_n_m_s_per_rad"};
  constexpr std::array values = {2.1e7, 41.0, 5.2e4, 0.48};
  Json joint = Json::object(), deviation = Json::object(), identifiable = Json::object(), best = Json::array();
  for (std::size_t i = 0; i < names.size(); ++i) {
    joint[names.at(i)] = values.at(i);
    deviation[names.at(i)] = i == 3 ? Json() : Json(0.03 * values.at(i));
    identifiable[names.at(i)] = i != 3;
  }
  for (int i = 0; i < 40; ++i) best.push_back(2e-8 + 6e-7 * std::exp(-0.3 * i));
  const Json json = {{"document", "joint/1"},
                     {"joint", joint},
                     {"points", 1},
                     {"objective", 2e-8},
                     {"relative_error", 0.034},
                     {"std", deviation},
                     {"identifiable", identifiable},
                     {"visible_up_to", {{names[0], 9e8}, {names[2], 4e6}}},
                     {"convergence", {{"status", "converged"}, {"iterations", 40}, {"start", 9e-7}, {"best", best}}},
                     {"suspect_hz", {701.0, 701.5}},
                     {"notes", Json::array({text.empty() ? "The rotational damping hardly changes the FRF." : text})}};
  return json.dump();
}

std::string sample_tools(const std::string& text) {
  const auto said = [&](const char* own) { return text.empty() ? std::string(own) : text; };
  Json failed = tool("too long", 90.0, 0.0, 0.0, 0.0);
  for (const char* key : {"peak_hz", "peak_um_per_n", "lowest_limit_mm", "recommended", "fit_relative_error"}) {
    failed[key] = nullptr;
  }
  failed["modes"] = Json::array();
  failed["failure"] = said("overhang_mm is above the 80 mm that the holder was measured with");
  Json json = {
      {"document", "tools/1"},
      {"tools", Json::array({tool(said("stub"), 30.0, 1310.0, 0.62, 0.91), tool("standard", 42.0, 940.0, 1.1, 0.52),
                             tool("long", 60.0, 610.0, 2.4, 0.21), failed})},
      {"holder", nullptr}};
  json["tools"][2]["notes"] = Json::array({said("Two modes are closer than their half widths.")});
  return json.dump();
}

std::vector<Assumption> sample_assumed(const std::string& text) {
  const auto said = [&](const char* own) { return text.empty() ? std::string(own) : text; };
  return {{.what = said("Loss factor of the tool"), .taken = "0.002", .key = "loss_factor", .file = "assembly.toml"},
          {.what = "Stock", .taken = said("the bounding box of the program, up to program zero"), .key = "stock"},
          {.what = "Jerk of the joints", .taken = "no limit", .key = "robot.joint_max_jerk", .file = "cell.toml"},
          {.what = "Noise of the sensor", .taken = "white", .key = {}, .file = {}}};
}

}  // namespace robomill::page
