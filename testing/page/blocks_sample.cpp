#include "testing/page/blocks_sample.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

namespace robomill::page {
namespace {

using Json = nlohmann::ordered_json;

constexpr int cuts_per_pass = 40;
constexpr double width_mm = 80.0;
constexpr double radius_mm = 70.0;
constexpr double retract_mm = 12.0;
constexpr double spindle_speed_rpm = 12000.0;
constexpr int line_of_first_block = 14;

double dome_mm(double x_mm, double y_mm) {
  return std::sqrt(radius_mm * radius_mm - x_mm * x_mm - y_mm * y_mm) - radius_mm;
}

struct Where {
  double x_mm, y_mm, z_mm;
};

/// Every column by its name; of a block in air those of its place alone.
class Columns {
 public:
  explicit Columns(std::string text) : text_(std::move(text)) {}
  void add(const Where& at, bool cuts) {
    Json row = {{"block", rows_ + 1},
                {"line", rows_ + line_of_first_block},
                {"x_mm", at.x_mm},
                {"y_mm", at.y_mm},
                {"z_mm", at.z_mm}};
    if (cuts) add_cut(row, at);
    for (const auto& [column, value] : row.items()) {
      if (!json_.contains(column)) json_[column] = Json(rows_, Json());
      json_[column].push_back(value);
    }
    ++rows_;
    for (Json& column : json_) {
      if (column.size() < rows_) column.push_back(nullptr);
    }
    cutting_ += cuts ? 1 : 0;
  }
  [[nodiscard]] Json document() const {
    const std::string note =
        text_.empty() ? "Process damping is not known: limits at low speeds are lower bounds." : text_;
    Json summary = {{"engagement_lost", 0},     {"blocks", rows_}, {"cutting", cutting_}, {"unstable", unstable_},
                    {"evaluations", rows_ / 9}, {"seconds", 3.2},  {"worst", nullptr},    {"notes", {note}}};
    return {{"document", "blocks/1"}, {"blocks", json_}, {"summary", std::move(summary)}};
  }

 private:
  void add_cut(Json& row, const Where& at) {
    const double limit_mm = 1.15 + 0.45 * std::sin(0.09 * at.x_mm) + 0.35 * std::cos(0.06 * at.y_mm + 0.4);
    const double depth_mm = 0.7 + 0.25 * std::cos(0.05 * at.x_mm + 0.03 * at.y_mm);
    const bool found = limit_mm < 1.85;
    const double spread = 0.06 + 0.0025 * std::abs(at.x_mm);
    const double lowest_mm = (1.0 - 1.645 * spread) * limit_mm;
    const bool coupled = at.x_mm < -0.25 * width_mm;
    const bool slow = !coupled && at.y_mm > 0.3 * width_mm;
    const double force_n = 90.0 * depth_mm * (1.0 + 0.2 * std::sin(0.2 * at.y_mm));
    const double torque_n_m = 0.0021 * force_n;
    row["axial_depth_mm"] = depth_mm;
    row["radial_depth_mm"] = 1.5;
    row["spindle_speed_rpm"] = spindle_speed_rpm;
    row["feed_mm_per_min"] = 1440.0;
    row["spectral_radius"] = std::pow(depth_mm / limit_mm, 0.4);
    row["stability_margin"] = 1.0 - depth_mm / (found ? lowest_mm : 2.5);
    row["gain_margin"] = found ? Json(std::pow(limit_mm / depth_mm, 1.2)) : Json();
    if (found) {
      row["limit_depth_mm"] = limit_mm;
      row["limit_5_percent_mm"] = lowest_mm;
      row["limit_95_percent_mm"] = (1.0 + 1.645 * spread) * limit_mm;
      row["chatter_frequency_hz"] = coupled ? 18.4 : slow ? 31.0 : 862.0 + 0.4 * at.x_mm;
      row["mode"] = text_.empty() ? std::string(coupled || slow ? "mode 1" : "mode 4") : text_;
    }
    row["regime"] = !found ? "none" : coupled ? "mode-coupling" : slow ? "low-frequency" : "regenerative";
    row["lower_bound"] = coupled || slow;
    row["peak_f_n"] = force_n;
    row["torque_n_m"] = torque_n_m;
    row["power_w"] = 0.10472 * spindle_speed_rpm * torque_n_m;
    row["deflection_um"] = 1.1 * force_n * (1.0 + 0.004 * at.x_mm);
    row["surface_error_um"] = 0.4 * force_n;
    if (at.y_mm > 0.0) row["surface_left_um"] = 0.3 * force_n;
    row["condition_number"] = 6.0 + 0.03 * at.y_mm;
    row["measured_nearby"] = at.x_mm < 0.4 * width_mm;
    if (!text_.empty()) row["note"] = text_;
    unstable_ += row["spectral_radius"] >= 1.0 ? 1 : 0;
  }
  std::string text_;
  Json json_ = Json::object();
  std::size_t rows_ = 0;
  int cutting_ = 0, unstable_ = 0;
};

/// The limit over one coordinate of the pose, around one block; none at its far end.
Json scan(const char* parameter, double centre, double reach, double slope) {
  Json value = Json::array(), limit = Json::array();
  constexpr int half = 4;
  for (int i = -half; i <= half; ++i) {
    const double share = static_cast<double>(i) / half;
    value.push_back(centre + reach * share);
    limit.push_back(i == half && slope > 0.3 ? Json() : Json(1.2 + slope * share - 0.2 * share * share));
  }
  return {{"parameter", parameter}, {"value", value}, {"limit_depth_mm", limit}, {"at_block", 360}, {"at_line", 373}};
}

}  // namespace

std::string sample_blocks(const std::string& text, int passes) {
  Columns out(text);
  for (int pass = 0; pass < passes; ++pass) {
    const double y_mm = width_mm * (static_cast<double>(pass) / std::max(1, passes - 1) - 0.5);
    const double side = pass % 2 == 0 ? 1.0 : -1.0;
    out.add({-0.5 * side * width_mm, y_mm, retract_mm}, false);
    for (int i = 0; i < cuts_per_pass; ++i) {
      const double x_mm = side * width_mm * (static_cast<double>(i) / (cuts_per_pass - 1) - 0.5);
      out.add({x_mm, y_mm, dome_mm(x_mm, y_mm)}, i > 0);
    }
    out.add({0.5 * side * width_mm, y_mm, retract_mm}, false);
  }
  Json json = out.document();
  json["limit_over"] = {scan("x_mm", 1270.0, 200.0, 0.02), scan("y_mm", 0.0, 250.0, -0.04),
                        scan("z_mm", 776.0, 200.0, 0.06), scan("gamma_deg", 0.0, 90.0, 0.5)};
  return json.dump();
}

}  // namespace robomill::page
