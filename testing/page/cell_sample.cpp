#include "testing/page/cell_sample.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

namespace robomill::page {
namespace {

using Json = nlohmann::ordered_json;

Json joints_json() {
  const double low[] = {-185, -140, -120, -350, -125, -350}, high[] = {185, -5, 155, 350, 125, 350};
  const double velocity[] = {123, 115, 112, 179, 172, 219};
  Json out = Json::array();
  for (int i = 0; i < 6; ++i) {
    out.push_back({{"joint", i + 1},
                   {"unit", "deg"},
                   {"min_position", low[i]},
                   {"max_position", high[i]},
                   {"max_velocity_per_s", velocity[i]},
                   {"max_acceleration_per_s2", 2.0 * velocity[i]},
                   {"max_jerk_per_s3", nullptr},
                   {"assumed", {"max_acceleration_per_s2"}}});
  }
  return out;
}

Json posture(const std::string& name, Json joints, Json to_limit, int nearest) {
  return {{"name", name},
          {"joints", std::move(joints)},
          {"tip_mm", {1589.98, 0.0, 642.96}},
          {"axis", {0.0, 0.0, 1.0}},
          {"program_tip_mm", {-1810.02, 0.0, -57.04}},
          {"program_axis", {0.0, 0.0, 1.0}},
          {"gamma_deg", 0.0},
          {"flange",
           {{"origin_mm", {1589.98, 0.0, 992.96}},
            {"abc_deg", {0.0, 0.0, 180.0}},
            {"quaternion", {0.0, 1.0, 0.0, 0.0}},
            {"rotation_vector_rad", {std::numbers::pi, 0.0, 0.0}}}},
          {"to_limit", std::move(to_limit)},
          {"nearest_joint", nearest},
          {"condition_number", 7.31}};
}

Json placement(const std::string& text) {
  const auto said = [&](const char* own) { return text.empty() ? std::string(own) : text; };
  return {
      {"origin_mm", {3400.0, 0.0, 700.0}},
      {"rotation_deg", {0.0, 0.0, 0.0}},
      {"works", false},
      {"program", said("part.ngc")},
      {"whole", true},
      {"poses", 6},
      {"complete", true},
      {"missed", 2},
      {"misses",
       Json::array({{{"block", 2},
                     {"line", 4},
                     {"tip_mm", {100.0, 0.0, 0.0}},
                     {"axis", {0.0, 0.0, 1.0}},
                     {"base_tip_mm", {3500.0, 0.0, 700.0}},
                     {"state", "out of reach"},
                     {"joints", Json::array()},
                     {"out_of_reach_mm", 417.2},
                     {"out_of_reach_deg", nullptr},
                     {"condition_number", nullptr},
                     {"text", said("out of reach by 417.2 mm")}},
                    {{"block", 5},
                     {"line", 7},
                     {"tip_mm", {0.0, 0.0, 0.0}},
                     {"axis", {0.0, 0.0, 1.0}},
                     {"base_tip_mm", {3400.0, 0.0, 700.0}},
                     {"state", "outside limits"},
                     {"joints", Json::array({{{"joint", 5}, {"position", 131.2}, {"limit", 125.0}, {"beyond", 6.2}}})},
                     {"out_of_reach_mm", nullptr},
                     {"out_of_reach_deg", nullptr},
                     {"condition_number", nullptr},
                     {"text", said("joint 5 is 6.2° above its upper limit of 125°")}}})},
      {"no_way", nullptr}};
}

Json start_posture() {
  Json joints = Json::array();
  for (const double position : {10.0, -60.0, 80.0, 0.0, 70.0, 20.0})
    joints.push_back({{"unit", "deg"}, {"position", position}});
  return {{"joints", std::move(joints)}, {"shoulder_as_at_home", true}, {"elbow_as_at_home", true},
          {"wrist_as_at_home", nullptr}, {"whole_turns_from_home", 0},  {"margin", 0.021},
          {"margin_block", 3},           {"margin_joint", 5},           {"near_singularity", nullptr}};
}

Json proposal(double x_mm, double y_mm, double turn_deg) {
  return {{"origin_mm", {x_mm, y_mm, 700.0}},
          {"rotation_deg", {0.0, 0.0, turn_deg}},
          {"shift_mm", {x_mm - 3400.0, y_mm, 0.0}},
          {"turn_deg", turn_deg},
          {"margin", 0.021},
          {"posture", start_posture()},
          {"margin_joint", 5},
          {"gamma_deg", {30.0, 30.0}}};
}

/// A ring sector of the wrist's reach.
Json ring(double low_mm, double high_mm, double from, double to, double centre_y_mm) {
  Json out = Json::array();
  for (int k = 0; k <= 120; ++k) {
    const bool outer = k <= 60;
    const double share = outer ? k / 60.0 : (120.0 - k) / 60.0, angle = from + (to - from) * share;
    const double radius = outer ? high_mm : low_mm;
    out.push_back({350.0 + radius * std::cos(angle), centre_y_mm + radius * std::sin(angle)});
  }
  return out;
}

Json drawing() {
  const Json home = {
      {"name", "home"},
      {"links_mm", Json::array({Json::array({{0, 0, 0},
                                             {0, 0, 675},
                                             {350, 0, 675},
                                             {549.7, 0, 1807.5},
                                             {530.4, 0, 1843.7},
                                             {1589.98, 0, 1280.3},
                                             {1589.98, 0, 992.96}})})},
      {"joints_mm",
       {{0, 0, 0}, {350, 0, 675}, {549.7, 0, 1807.5}, {530.4, 0, 1843.7}, {1589.98, 0, 1208}, {1589.98, 0, 1208}}},
      {"flange_mm", {1589.98, 0, 992.96}},
      {"tip_mm", {1589.98, 0, 642.96}}};
  return {{"figures", Json::array({home})},
          {"reach_side_mm", Json::array({ring(700.0, 2350.0, -1.0, 3.0, 675.0)})},
          {"reach_top_mm", Json::array({ring(900.0, 2700.0, -3.1, 3.1, 0.0)})},
          {"program_mm",
           {{3400, 0, 750}, {3400, 0, 700}, {3500, 0, 700}, {3500, 100, 700}, {3400, 100, 700}, {3400, 0, 700}}}};
}

}  // namespace

std::string sample_cell(const std::string& text) {
  const auto said = [&](const char* own) { return text.empty() ? std::string(own) : text; };
  const Json to_limit = {185, 60, 47, 350, 63, 350};
  const Json cell = {{"document", "check/1"},
                     {"cell", said("cell.toml")},
                     {"robot",
                      {{"kind", "serial"},
                       {"model", said("kuka-kr210-r2700")},
                       {"description", said("KUKA KR 210 R2700 extra: 210 kg, 2.7 m")},
                       {"source", said("a URDF")}}},
                     {"joints", joints_json()},
                     {"postures", Json::array({posture(said("home"), {0, -80, 108, 0, 62, 0}, to_limit, 3)})},
                     {"at_limits", Json::array({posture(said("joint 2 at its upper limit"), {0, -5, 108, 0, 62, 0},
                                                        {185, 0, 47, 350, 63, 350}, 2)})},
                     {"placement", placement(text)},
                     {"proposals", Json::array({proposal(2950.0, 0.0, 0.0), proposal(3000.0, 200.0, -20.0)})},
                     {"drawing", drawing()},
                     {"assumed", Json::array({{{"what", said("Accelerations of the joints")},
                                               {"taken", said("the rated speed within 0.5 s")},
                                               {"key", "robot.joint_max_acceleration"},
                                               {"file", "cell.toml"}}})},
                     {"notes", Json::array({said("The arm is kuka-kr210-r2700.")})}};
  return cell.dump();
}

}  // namespace robomill::page
