#include "testing/page/study_sample.hpp"

#include <array>
#include <cmath>

#include "robomill/io/json.hpp"

namespace robomill::page {
namespace {

using io::Json;

constexpr const char* keys[] = {"cut.radial_depth_mm", "coefficients.tangential_n_per_mm2",
                                "dynamics.x[0].damping_ratio"};

Json estimate(double value, double spread) {
  return {{"value", value}, {"low", value - spread}, {"high", value + spread}};
}

Json probability_row(const std::string& value, const std::string& teeth, int holding) {
  return {{"at", {{"tool.teeth", teeth}, {"cut.radial_depth_mm", "6"}}},
          {"value", value},
          {"probability", estimate(holding / 64.0, 0.1)},
          {"points", 64},
          {"holding", holding},
          {"infinite", 0},
          {"left_out", holding == 24 ? 2 : 0},
          {"worst", 2.0 + holding / 32.0}};
}

Json probability(const std::string& text) {
  const std::string other = text.empty() ? "4" : '"' + text + '"';
  Json rows = Json::array();
  for (const std::string& teeth : {std::string("2"), std::string("3"), other}) {
    for (const char* value : {"limit@8000", "limit@10000", "limit@12000"}) {
      const bool low = teeth == other && value == std::string("limit@12000");
      rows.push_back(probability_row(value, teeth, low ? 24 : teeth == "3" ? 48 : 64));
    }
  }
  return {{"at_least", 3.0}, {"at_most", nullptr}, {"worst_share", 0.05},
          {"rows", rows},    {"optimum", rows[1]}, {"equal", 4}};
}

Json sensitivity_row(const std::string& value, const std::array<double, 3>& first) {
  Json indices = Json::array();
  for (const double share : first)
    indices.push_back({{"first", estimate(share, 0.1)}, {"total", estimate(1.1 * share + 0.02, 0.08)}});
  return {{"at", Json::object()}, {"value", value},  {"status", "found"}, {"samples", 126},    {"left_out", 2},
          {"mean", 3.1},          {"variance", 0.4}, {"keys", keys},      {"indices", indices}};
}

Json constant_row(const std::string& value) {
  return {{"at", {{"tool.teeth", "3"}}},
          {"value", value},
          {"status", "constant"},
          {"samples", 128},
          {"left_out", 0},
          {"mean", 3.0},
          {"variance", 0.0},
          {"keys", keys},
          {"indices", Json::array()}};
}

Json column(const std::string& name, const std::string& unit) {
  return {{"name", name}, {"unit", unit}, {"numbers", Json::array()}, {"texts", Json::array()}, {"infinite", 0}};
}

}  // namespace

std::string sample_statistics(const std::string& text) {
  const Json boundary = {{"value", "abs_mu@10000,2"},
                         {"level", 1.0},
                         {"steps", {{keys[0], 0.25}, {keys[1], 25.0}, {keys[2], 0.00125}}},
                         {"points", 6200},
                         {"evaluations", 2371},
                         {"interpolated", 1822},
                         {"compared", 940},
                         {"beyond_error", 3},
                         {"grid_points", 35937.0},
                         {"unknown", 4},
                         {"lost_cubes", 1},
                         {"middle_points", 0},
                         {"complete", true}};
  const Json sensitivity = {sensitivity_row("limit@8000", {0.25, 0.2, 0.6}),
                            sensitivity_row("limit@10000", {0.6, 0.006, 0.43}),
                            constant_row(text.empty() ? "limit@12000" : text)};
  return Json{{"document", "statistics/1"},
              {"boundary", boundary},
              {"sensitivity", sensitivity},
              {"probability", probability(text)}}
      .dump();
}

std::string sample_study_points(const std::string& text) {
  Json depth = column(keys[0], "mm"), direction = column("cut.direction", "");
  Json limit = column(text.empty() ? "limit@8000" : text, "mm"), frequency = column("chatter_frequency@8000", "Hz");
  for (int i = 0; i < 60; ++i) {
    const double radial_mm = 1.0 + 0.1 * i;
    depth["numbers"].push_back(radial_mm);
    direction["texts"].push_back(i % 2 == 0 ? "down" : text.empty() ? "up" : text);
    limit["numbers"].push_back(i < 5 ? Json() : Json(8.0 / radial_mm + 0.3 * std::sin(i)));
    frequency["numbers"].push_back(i < 5 ? Json() : Json(620.0 + i));
  }
  limit["infinite"] = 5;
  Json boundary = Json::array();
  for (const char* key : keys) boundary.push_back(column(key, ""));
  for (int i = 0; i < 400; ++i) {
    const double a = (i % 20) / 19.0, b = static_cast<double>(i / 20) / 19.0;
    boundary[0]["numbers"].push_back(1.0 + 8.0 * a);
    boundary[1]["numbers"].push_back(400.0 + 800.0 * b);
    boundary[2]["numbers"].push_back(0.01 + 0.02 * a + 0.02 * b);
  }
  return Json{{"document", "study_points/1"},
              {"points", 20000},
              {"rejected", 3},
              {"keys", {depth, direction}},
              {"values", {limit, frequency}},
              {"boundary_points", 6200},
              {"boundary_keys", boundary}}
      .dump();
}

}  // namespace robomill::page
