#include "robomill/page/report.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/page/embedded.hpp"
#include "robomill/page/json.hpp"
#include "testing/page/blocks_sample.hpp"
#include "testing/page/cut_sample.hpp"
#include "testing/page/forces_sample.hpp"
#include "testing/page/identified_sample.hpp"
#include "testing/page/monitor_sample.hpp"
#include "testing/page/plan_sample.hpp"
#include "testing/page/report_sample.hpp"
#include "testing/page/smooth_sample.hpp"
#include "testing/page/structure_sample.hpp"
#include "testing/page/study_sample.hpp"
#include "testing/support.hpp"

namespace robomill::page {
namespace report_test {

using nlohmann::json;

/// The content of the element that carries the data.
std::string embedded(const std::string& html) {
  const std::string open = "<script type=\"application/json\" id=\"report-data\">";
  const std::size_t begin = html.find(open);
  if (begin == std::string::npos) return {};
  const std::size_t end = html.find("</script>", begin);
  return html.substr(begin + open.size(), end - begin - open.size());
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

// What other writers give is rounded too; counts and texts stay.
TEST(ReportJson, RoundsDocumentsToSixDigits) {
  Report report;
  report.plan = R"({"cuts": [{"spindle_speed_rpm": 1234.56789123, "teeth": 12345678, "note": "1.23456789"}]})";
  const json cut = json::parse(report_json(report))["plan"]["cuts"][0];
  EXPECT_EQ(cut["spindle_speed_rpm"].get<double>(), 1234.57);
  EXPECT_EQ(cut["teeth"], 12345678);
  report.monitor = R"({"wave_run_s": 0.0123456789, "events": [{"time_s": 12345.675}], "time_s": [98765.4321]})";
  const json monitor = json::parse(report_json(report))["monitor"];
  EXPECT_EQ(monitor["wave_run_s"].get<double>(), 0.0123456789);
  EXPECT_EQ(monitor["events"][0]["time_s"].get<double>(), 12345.675);
  EXPECT_EQ(monitor["time_s"][0].get<double>(), 98765.4321);
  EXPECT_EQ(cut["note"], "1.23456789");
  EXPECT_TRUE(json::parse(report_json({}))["plan"].is_null());
}

// A rounded number is within half a unit of the sixth digit, whatever its size.
TEST(ReportJson, RoundsWithinHalfAUnitOfTheSixthDigit) {
  Random random(5);
  for (int i = 0; i < 500; ++i) {
    const double exact = std::pow(10.0, random.uniform(-300.0, 300.0));
    EXPECT_NEAR(number(exact).get<double>(), exact, 0.5001e-5 * exact);
  }
}

TEST(ReportJson, NonFiniteIsNull) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double value : {std::nan(""), infinity, -infinity}) EXPECT_TRUE(number(value).is_null());
}

// A list too long for a page keeps its ends and the extremes of every column.
TEST(ReportJson, ThinsLongListsOfRows) {
  Random random(9);
  json rows = json::array();
  for (int i = 0; i < 30000; ++i) rows.push_back({{"at", i}, {"depth", random.uniform()}, {"kind", "hopf"}});
  rows[0]["depth"] = nullptr;  // a limit beyond the range
  rows[1].erase("depth");
  rows[12345]["depth"] = 7.5;
  rows[23456]["depth"] = -3.5;
  Report report;
  report.lobes = json{{"boundary", rows}}.dump();
  const json kept = json::parse(report_json(report))["lobes"]["boundary"];
  EXPECT_LT(kept.size(), 6010U);
  EXPECT_EQ(kept.front()["at"], 0);
  EXPECT_EQ(kept.back()["at"], 29999);
  double low = 0.0, high = 0.0;
  for (const json& row : kept) {
    if (!row.contains("depth") || row["depth"].is_null()) continue;
    low = std::min(low, row["depth"].get<double>());
    high = std::max(high, row["depth"].get<double>());
  }
  EXPECT_EQ(low, -3.5);
  EXPECT_EQ(high, 7.5);
}

// Property: of a long program the highest of every curve is drawn, moves in air keep their ends, and what is drawn
// stays small.
TEST(ReportJson, LongProgramsKeepTheirPeaks) {
  Random random(11);
  constexpr int n = 60000;
  const std::vector<std::string> curves = {
      "x_mm", "peak_f_n", "revolution_torque_n_m", "peak_torque_n_m", "sustained_power_w", "peak_deflection_um"};
  std::map<std::string, double> highest;
  json blocks = json::array();
  for (int i = 0; i < n; ++i) {
    json block = {{"block", i + 1}, {"path_mm", 0.01 * i}, {"cuts", i % 1500 < 1200}, {"mean_fx_n", 1.0}};
    for (const std::string& curve : curves) {
      block[curve] = random.uniform();
      highest[curve] = std::max(highest[curve], block[curve].get<double>());
    }
    blocks.push_back(std::move(block));
  }
  Report report;
  report.forces = json{{"force_on", "tool"}, {"blocks", blocks}, {"skipped", {"M8"}}}.dump();
  const json forces = json::parse(report_json(report))["forces"];
  const json& kept = forces["blocks"];
  EXPECT_GT(kept.size(), 5000U);
  EXPECT_LT(kept.size(), 6020U);
  EXPECT_EQ(kept.front()["block"], 1);
  EXPECT_EQ(kept.back()["block"], n);
  EXPECT_FALSE(forces.contains("skipped"));
  EXPECT_FALSE(kept.front().contains("mean_fx_n")) << "no page draws it";
  std::map<std::string, double> shown;
  std::set<int> numbers;
  for (const json& block : kept) {
    numbers.insert(block["block"].get<int>());
    for (const std::string& curve : curves) shown[curve] = std::max(shown[curve], block[curve].get<double>());
  }
  for (const std::string& curve : curves) EXPECT_NEAR(shown[curve], highest[curve], 1e-5) << curve;
  for (int i = 1200; i < n; i += 1500) {
    for (const int number : {i, i + 1, i + 300}) EXPECT_TRUE(numbers.contains(number)) << number;
  }
}

// A path keeps every block up to 40,000, of more the lowest margin and the highest force; columns stay one length, and
// what no page shows is left out.
TEST(ReportJson, LongPathsKeepTheirWorstBlocks) {
  Random random(13);
  constexpr std::size_t n = 50000;
  json columns = {{"note", std::vector<json>(n)},
                  {"q1", std::vector<double>(n, 0.5)},
                  {"evaluation", std::vector<int>(n, 1)},
                  {"surface_left_um", std::vector<double>(n, 3.0)}};
  for (std::size_t i = 0; i < n; ++i) {
    columns["block"].push_back(i + 1);
    columns["stability_margin"].push_back(i == 34567 ? -7.5 : random.uniform());
    columns["peak_f_n"].push_back(i % 9 == 0 ? json() : json(i == 23455 ? 750.0 : random.uniform()));
    columns["regime"].push_back(i % 9 == 0 ? json() : json("regenerative"));
  }
  Report report;
  report.blocks = json{{"blocks", columns}, {"limit_over", json::array()}}.dump();
  const json kept = json::parse(report_json(report))["blocks"]["blocks"];
  const std::size_t count = kept["block"].size();
  EXPECT_GT(count, 20000U);
  EXPECT_LE(count, 40002U);
  EXPECT_EQ(kept["block"].back(), n);
  for (const auto& [name, column] : kept.items()) EXPECT_EQ(column.size(), count) << name;
  EXPECT_FALSE(kept.contains("note")) << "no block has one";
  EXPECT_TRUE(kept.contains("surface_left_um"));
  for (const char* column : {"q1", "evaluation"}) EXPECT_FALSE(kept.contains(column)) << "no page shows " << column;
  const auto holds = [&](const char* name, std::size_t block, double value) {
    const auto at = std::ranges::find(kept["block"], json(block)) - kept["block"].begin();
    ASSERT_LT(static_cast<std::size_t>(at), count);
    EXPECT_EQ(kept[name][static_cast<std::size_t>(at)], value);
  };
  holds("stability_margin", 34568, -7.5);
  holds("peak_f_n", 23456, 750.0);
  report.blocks = sample_blocks({}, 900);
  EXPECT_EQ(json::parse(report_json(report))["blocks"]["blocks"]["block"].size(), 900U * 42U);
}

// Force and torque of a revolution in 50,000 steps keep the same ones, with the peak of each.
TEST(ReportJson, ThinsALongRevolution) {
  constexpr int n = 50000;
  json forces = {{"force_on", "tool"}, {"notes", json::array()}};
  for (const char* name : {"rotation_deg", "fx_n", "torque_by_rotation_n_m"}) forces[name] = json::array();
  for (int i = 0; i < n; ++i) {
    forces["rotation_deg"].push_back(360.0 * i / n);
    forces["fx_n"].push_back(i == 31234 ? 7.5 : std::sin(1e-3 * i));
    forces["torque_by_rotation_n_m"].push_back(i == 4321 ? json() : json(std::cos(1e-3 * i)));
  }
  Report report;
  report.forces = forces.dump();
  const json kept = json::parse(report_json(report))["forces"];
  const auto fx = kept["fx_n"].get<std::vector<double>>();
  EXPECT_LT(fx.size(), 6010U);
  EXPECT_EQ(kept["rotation_deg"].size(), fx.size());
  EXPECT_EQ(kept["torque_by_rotation_n_m"].size(), fx.size());
  EXPECT_EQ(kept["rotation_deg"][static_cast<std::size_t>(std::ranges::max_element(fx) - fx.begin())].get<double>(),
            224.885);
}

// … and so do the lines of a recording's spectrum.
TEST(ReportJson, ThinsALongSpectrum) {
  constexpr int n = 50000;
  json recording = {{"file", "cut.wav"}, {"frequency_hz", json::array()}, {"amplitude", json::array()}};
  for (int i = 0; i < n; ++i) {
    recording["frequency_hz"].push_back(0.5 * i);
    recording["amplitude"].push_back(i == 31234 ? 7.5 : 1.0 + std::sin(1e-1 * i));
  }
  json short_one = recording;
  for (const char* list : {"frequency_hz", "amplitude"})
    short_one[list].erase(short_one[list].begin() + 100, short_one[list].end());
  Report report;
  report.recordings = json{{"recordings", {recording, short_one}}}.dump();
  const json kept = json::parse(report_json(report))["recordings"]["recordings"];
  const json& amplitude = kept[0]["amplitude"];
  EXPECT_GT(amplitude.size(), 5000U);
  EXPECT_LE(amplitude.size(), 6002U);
  ASSERT_EQ(kept[0]["frequency_hz"].size(), amplitude.size());
  EXPECT_EQ(kept[0]["frequency_hz"][static_cast<std::size_t>(std::ranges::max_element(amplitude) - amplitude.begin())],
            15617.0);
  EXPECT_EQ(kept[1]["amplitude"].size(), 100U);
}

TEST(ReportJson, ThinsTheSpectrumOfASimulation) {
  json frequency = json::array(), x = json::array(), low = json::array();
  for (int i = 0; i < 20000; ++i) {
    frequency.push_back(0.25 * i);
    x.push_back(i == 7777 ? 9.0 : 1e-3 * (i % 7));
  }
  for (int run = 0; run < 2000; ++run) low.push_back(run);
  Report report;
  report.vibration = json{{"run_s", 0.01},
                          {"displacement_um", {{"x", {{"low", low}, {"high", low}}}}},
                          {"force_n", json::object()},
                          {"spectrum", {{"from_s", 1.0}, {"frequency_hz", frequency}, {"x_um", x}}}}
                         .dump();
  const json kept = json::parse(report_json(report))["vibration"];
  EXPECT_LT(kept["spectrum"]["frequency_hz"].size(), 6010U);
  ASSERT_EQ(kept["spectrum"]["frequency_hz"].size(), kept["spectrum"]["x_um"].size());
  EXPECT_EQ(*std::ranges::max_element(kept["spectrum"]["x_um"]), 9.0);
  EXPECT_EQ(kept["displacement_um"]["x"]["low"].size(), 2000U);
  report.vibration = R"({"displacement_um": {}, "force_n": {}, "run_s": 1, "spectrum": null})";
  EXPECT_TRUE(json::parse(report_json(report))["vibration"]["spectrum"].is_null());
}

TEST(ReportJson, ListsWhatWasAssumedAndSaid) {
  Report report;
  report.assumed = {{.what = "Stock", .taken = "a box", .key = "stock.kind", .file = "forces.toml"},
                    {.what = "Noise\xff", .taken = "white"}};
  report.warnings = {"a warning"};
  report.notes = {"a note"};
  const json page = json::parse(report_json(report));
  EXPECT_EQ(page["assumed"][0],
            (json{{"what", "Stock"}, {"taken", "a box"}, {"key", "stock.kind"}, {"file", "forces.toml"}}));
  EXPECT_EQ(page["assumed"][1]["what"], "Noise\xef\xbf\xbd");
  EXPECT_TRUE(page["assumed"][1]["key"].is_null());
  EXPECT_EQ(page["warnings"], json::array({"a warning"}));
  EXPECT_EQ(page["notes"], json::array({"a note"}));
  EXPECT_EQ(json::parse(report_json({}))["assumed"], json::array());
}

TEST(ReportJson, StrayBytesBecomeValidText) {
  Report report;
  report.title = "Fr\xe4ser";
  EXPECT_EQ(json::parse(report_json(report))["title"], "Fr\xef\xbf\xbdser");
  EXPECT_NE(report_html(report).find("Fr\xef\xbf\xbdser"), std::string::npos);
}

TEST(ReportHtml, TextsCannotBreakOut) {
  const std::string evil = "</script><script>alert(1)</script><!--<img src=x onerror=alert(1)>\"'&";
  Report report = sample_report();
  const std::size_t scripts = count(report_html(report), "<script");
  report.title = evil;
  report.created = evil;
  report.summary = evil;
  report.plan = sample_plan(evil);
  report.recordings = sample_recordings(evil);
  report.frf = sample_frf(evil);
  report.assembly = sample_assembly(evil);
  report.files = {{evil, evil, evil}};
  report.forces = sample_forces(evil);
  report.blocks = sample_blocks(evil);
  report.smooth = sample_smooth(evil);
  report.monitor = sample_monitor(evil);
  report.calibration = sample_calibration(evil);
  report.joint = sample_joint(evil);
  report.tools = sample_tools(evil);
  report.comparison = sample_comparison(evil);
  report.statistics = sample_statistics(evil);
  report.study_points = sample_study_points(evil);
  report.coefficients = sample_coefficients(evil);
  report.stiffness = sample_stiffness(evil);
  report.assumed = sample_assumed(evil);
  report.warnings = report.notes = {evil};
  const std::string html = report_html(report);
  EXPECT_EQ(count(html, "<script"), scripts);
  EXPECT_EQ(html.find("<img"), std::string::npos);
  EXPECT_EQ(html.find("\"'&\""), std::string::npos);
  EXPECT_EQ(json::parse(embedded(html))["title"], evil);
}

// FRFs over one axis keep the same lines, five hertz a run here: what is left of |H| is true at the edges of any
// stretch to 5 %, at its peaks exactly; other lists stay.
TEST(ReportJson, ThinsTheFrfsOfOneAxisTogether) {
  json axis = json::array(), coherence = json::array(), frfs = json::object();
  for (const char* name : {"xx", "yy"}) frfs[name] = {{"re", json::array()}, {"im", json::array()}};
  const auto receptance = [](double f, double natural_hz) {
    const double r = f / natural_hz;
    return 1e-6 / std::complex<double>(1.0 - r * r, 0.02 * r);
  };
  constexpr int lines = 30000;
  for (int i = 0; i < lines; ++i) {
    const double f = 1.0 + 0.5 * i;
    axis.push_back(f);
    coherence.push_back(0.9);
    for (const auto& [name, natural_hz] : {std::pair{"xx", 700.25}, {"yy", 9000.25}}) {
      frfs[name]["re"].push_back(receptance(f, natural_hz).real());
      frfs[name]["im"].push_back(i == 99 ? json() : json(receptance(f, natural_hz).imag()));
    }
  }
  Report report;
  report.frf = json{
      {"frequency_hz", axis},
      {"receptance_m_per_n", frfs},
      {"coherence", {{"xx", coherence}}},
      {"deviation_m_per_n", {{"xx", coherence}}},
      {"notes",
       {"a", "b"}}}.dump();
  const json kept = json::parse(report_json(report))["frf"];
  const std::size_t count = kept["frequency_hz"].size();
  EXPECT_GT(count, 5000U);
  EXPECT_LT(count, 12010U);
  EXPECT_EQ(kept["coherence"]["xx"].size(), count);
  EXPECT_FALSE(kept.contains("deviation_m_per_n"));
  EXPECT_EQ(kept["notes"].size(), 2U);
  for (const auto& [name, natural_hz] : {std::pair{"xx", 700.25}, {"yy", 9000.25}}) {
    const json& frf = kept["receptance_m_per_n"][name];
    ASSERT_EQ(frf["im"].size(), count);
    double peak = 0.0, shown_peak = 0.0;
    for (int i = 0; i < lines; ++i)
      peak = std::max(peak, i == 99 ? 0.0 : std::abs(receptance(1.0 + 0.5 * i, natural_hz)));
    for (std::size_t i = 0; i < count; ++i) {
      if (frf["im"][i].is_null()) continue;
      shown_peak = std::max(shown_peak, std::hypot(frf["re"][i].get<double>(), frf["im"][i].get<double>()));
    }
    EXPECT_NEAR(shown_peak, peak, 2e-5 * peak) << name;
    for (const auto& [from, to] :
         {std::pair{5.0, 30.0}, {30.0, 600.0}, {600.0, 800.0}, {800.0, 8000.0}, {8000.0, 15000.0}}) {
      double high = 0.0, low = 1.0, shown_high = 0.0, shown_low = 1.0;
      for (int i = 0; i < lines; ++i) {
        const double f = 1.0 + 0.5 * i;
        if (f < from || f > to || i == 99) continue;
        high = std::max(high, std::abs(receptance(f, natural_hz)));
        low = std::min(low, std::abs(receptance(f, natural_hz)));
      }
      for (std::size_t i = 0; i < count; ++i) {
        const double f = kept["frequency_hz"][i];
        if (f < from || f > to || frf["im"][i].is_null()) continue;
        const double size = std::hypot(frf["re"][i].get<double>(), frf["im"][i].get<double>());
        shown_high = std::max(shown_high, size);
        shown_low = std::min(shown_low, size);
      }
      EXPECT_NEAR(shown_high, high, 0.05 * high) << name << " from " << from;
      EXPECT_NEAR(shown_low, low, 0.05 * low) << name << " from " << from;
    }
  }
}

// The page's script makes tables and plots of the report's own data; the summary is for where no script runs.
TEST(ReportHtml, CarriesTheDataAndTheSummary) {
  Report report = sample_report();
  report.summary = "recommended  15 000 rpm\nlimited by mode 8 & more";
  const std::string html = report_html(report);
  EXPECT_TRUE(html.starts_with("<!doctype html>"));
  EXPECT_EQ(count(html, "<pre>recommended  15 000 rpm\nlimited by mode 8 &amp; more</pre>"), 1U);
  EXPECT_EQ(count(html, "<h1>" + report.title + "</h1>"), 1U);
  EXPECT_EQ(json::parse(embedded(html)), json::parse(report_json(report)));
  const bool plain = page_script().empty();
  EXPECT_EQ(html.find("left out of this build") != std::string::npos, plain);
  EXPECT_EQ(count(html, "<noscript>"), plain ? 0U : 1U);
}

// The script that draws a path stands where there is one.
TEST(ReportHtml, CarriesThePathScriptWithAPathAlone) {
  Report report = sample_report();
  const std::size_t with = report_html(report).size();
  report.blocks.clear();
  const std::string without = report_html(report);
  const std::string_view script = page_path_script();
  EXPECT_GE(with - without.size(), script.size());
  EXPECT_EQ(count(without, "<script"), page_script().empty() ? 1U : 2U);
  EXPECT_EQ(!script.empty() && without.find(script.substr(0, 200)) != std::string::npos, false);
}

TEST(ReportJson, NamesTheMemberThatIsNoJson) {
  Report report;
  report.lobes = "{";
  EXPECT_EQ(test::field_of([&] { static_cast<void>(report_json(report)); }), "lobes");
  report.lobes.clear();
  const json axis = std::vector<double>(13000, 1.0);
  report.measured = json{{"frequency_hz", axis}, {"receptance_m_per_n", {{"xx", {{"re", json::array()}}}}}}.dump();
  EXPECT_EQ(test::field_of([&] { static_cast<void>(report_json(report)); }), "measured");
  report.measured.clear();
  report.blocks = R"({"limit_over": [], "blocks": {"block": [1, 2], "x_mm": [0.0]}})";
  EXPECT_EQ(test::field_of([&] { static_cast<void>(report_json(report)); }), "blocks");
  report.blocks = R"({"limit_over": [], "blocks": [1, 2]})";
  EXPECT_EQ(test::field_of([&] { static_cast<void>(report_json(report)); }), "blocks");
  report.blocks.clear();
  report.measured = std::string(400, '[') + std::string(400, ']');
  EXPECT_EQ(test::field_of([&] { static_cast<void>(report_json(report)); }), "measured");
}

}  // namespace report_test
}  // namespace robomill::page
