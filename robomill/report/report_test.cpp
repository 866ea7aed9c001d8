#include "robomill/report/report.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "robomill/base/random.hpp"
#include "robomill/report/json.hpp"
#include "robomill/report/monitor_sample.hpp"
#include "robomill/report/page.hpp"
#include "robomill/report/plan_sample.hpp"
#include "robomill/report/report_sample.hpp"
#include "robomill/report/structure_sample.hpp"
#include "robomill/report/thin.hpp"
#include "testing/support.hpp"

namespace robomill::report {
namespace {

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
  for (const double value : {missing, infinity, -infinity}) EXPECT_TRUE(number(value).is_null());
  EXPECT_EQ(number(2e-3, 1e-3).get<double>(), 2.0);
}

// A list too long for a page keeps its ends and the extremes of every column.
TEST(ReportJson, ThinsLongListsOfRows) {
  Random random(9);
  json rows = json::array();
  for (int i = 0; i < 30000; ++i) rows.push_back({{"at", i}, {"depth", random.uniform()}, {"kind", "hopf"}});
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
    low = std::min(low, row["depth"].get<double>());
    high = std::max(high, row["depth"].get<double>());
  }
  EXPECT_EQ(low, -3.5);
  EXPECT_EQ(high, 7.5);
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
  report.forces->facts = {{evil, evil}};
  report.forces->warnings = {evil};
  report.forces->notes = {evil};
  report.forces->revolution->verdict = evil;
  report.forces->path->troubles = {evil};
  report.smooth->facts = {{evil, evil}};
  report.smooth->warnings = report.smooth->notes = report.smooth->skipped = {evil};
  report.smooth->methods.front().name = evil;
  report.smooth->methods.front().uses.front().what = evil;
  report.monitor->facts = {{evil, evil}};
  report.monitor->warnings = report.monitor->notes = {evil};
  report.monitor->unit = report.monitor->detector = evil;
  report.monitor->channels.front().name = evil;
  report.monitor->events = sample_monitor(evil).events;
  report.calibration = sample_calibration(evil);
  const std::string html = report_html(report);
  EXPECT_EQ(count(html, "<script"), scripts);
  EXPECT_EQ(html.find("<img"), std::string::npos);
  EXPECT_EQ(html.find("\"'&\""), std::string::npos);
  EXPECT_EQ(json::parse(embedded(html))["title"], evil);
}

// Curves over one axis keep the same lines, whatever they hang in; other lists and short ones stay.
TEST(ReportJson, ThinsCurvesOverOneAxisTogether) {
  Random random(4);
  json axis = json::array(), re = json::array(), im = json::array();
  for (int i = 0; i < 20000; ++i) {
    axis.push_back(0.5 * i);
    re.push_back(random.normal());
    im.push_back(random.normal());
  }
  re[777] = 40.0;
  im[15000] = nullptr;
  im[15001] = -40.0;
  Report report;
  report.frf =
      json{{"frequency_hz", axis}, {"receptance_m_per_n", {{"xx", {{"re", re}, {"im", im}}}}}, {"lines", {1, 2}}}
          .dump();
  const json kept = json::parse(report_json(report))["frf"];
  const json& curve = kept["receptance_m_per_n"]["xx"];
  ASSERT_LT(kept["frequency_hz"].size(), 6010U);
  ASSERT_EQ(curve["re"].size(), kept["frequency_hz"].size());
  ASSERT_EQ(curve["im"].size(), kept["frequency_hz"].size());
  EXPECT_EQ(kept["lines"].size(), 2U);
  const auto at = [&](double frequency_hz) {
    return static_cast<std::size_t>(std::ranges::find(kept["frequency_hz"], json(frequency_hz)) -
                                    kept["frequency_hz"].begin());
  };
  EXPECT_EQ(curve["re"][at(388.5)], 40.0);
  EXPECT_EQ(curve["im"][at(7500.5)], -40.0);
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

template <class Change>
std::string rejected(Change&& change) {
  Report report = sample_report();
  change(report);
  return test::field_of([&] { report.validate(); });
}

TEST(ReportValidate, NamesTheMember) {
  EXPECT_EQ(rejected([](Report&) {}), "accepted");
  EXPECT_EQ(rejected([](Report& r) { r.forces->path->cuts.pop_back(); }), "forces.path.cuts");
  EXPECT_EQ(rejected([](Report& r) { r.smooth->methods.clear(); }), "smooth.methods");
}

// Property: increasing indices, within the bound, and the extremes of the whole curve are among them.
TEST(Thin, KeepsPeaksAndDips) {
  Random random(21);
  for (int round = 0; round < 50; ++round) {
    const auto n = static_cast<Eigen::Index>(1 + random.index(5000));
    const auto most = static_cast<Eigen::Index>(10 + random.index(500));
    Eigen::VectorXd values(n);
    for (double& value : values) value = random.uniform() < 0.02 ? missing : random.normal();
    const std::vector<Eigen::Index> keep = thin(values, most);
    ASSERT_LE(static_cast<Eigen::Index>(keep.size()), std::max(most + 2, Eigen::Index{1}));
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (std::size_t i = 0; i < keep.size(); ++i) {
      if (i > 0) {
        ASSERT_LT(keep[i - 1], keep[i]);
      }
      if (!std::isnan(values[keep[i]])) {
        low = std::min(low, values[keep[i]]);
        high = std::max(high, values[keep[i]]);
      }
    }
    double lowest = std::numeric_limits<double>::infinity();
    double highest = -lowest;
    for (const double value : values) {
      if (std::isnan(value)) continue;
      lowest = std::min(lowest, value);
      highest = std::max(highest, value);
    }
    EXPECT_EQ(low, lowest);
    EXPECT_EQ(high, highest);
  }
}

}  // namespace
}  // namespace robomill::report
