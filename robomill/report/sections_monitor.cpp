#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "robomill/report/html.hpp"
#include "robomill/report/sections.hpp"

namespace robomill::report {
namespace {

/// "Chatter from 3.70 s to 5.05 s at 683.6 ± 0.3 Hz, mode 8." for each alarm.
std::string verdict(const Json& run) {
  std::string out;
  for (const Json& stay : run["stays"]) {
    if (text_of(stay["state"]) != "chatter") continue;
    const double from = stay["from_s"].get<double>(), to = stay["to_s"].get<double>();
    out += fmt::format("<p class=\"why\"><strong>Chatter</strong> from {} s to {} s", fixed(stay["from_s"], 2),
                       fixed(stay["to_s"], 2));
    const Json* told = nullptr;  // the surest: the frequency settles, and is lost when chatter ends
    const auto deviation = [](const Json& event) {
      const Json& std_hz = event["chatter_frequency_std_hz"];
      return std_hz.is_number() ? std_hz.get<double>() : std::numeric_limits<double>::infinity();
    };
    for (const Json& event : run["events"]) {
      const double at = event["time_s"].get<double>();
      const bool chatters = text_of(event["state"]) == "chatter" && event["chatter_frequency_hz"].is_number();
      if (!chatters || at < from || at > to) continue;
      if (told == nullptr || deviation(event) < deviation(*told)) told = &event;
    }
    if (told != nullptr) {
      const Json& event = *told;
      out += fmt::format(" at {} Hz",
                         with_deviation(event["chatter_frequency_hz"], event["chatter_frequency_std_hz"], 1.0, 1));
      if (event["mode"].is_number()) out += ", " + mode_name(event);
      if (event["suggested_spindle_speed_rpm"].is_number()) {
        out += fmt::format("; quiet near {} rpm", fixed(event["suggested_spindle_speed_rpm"], 0));
      }
    }
    out += ".</p>\n";
  }
  return out.empty() ? "<p class=\"why\"><strong>No chatter</strong> was detected.</p>\n" : out;
}

std::string events_table(const Json& events) {
  if (events.empty()) return {};
  Table table("What the monitor said",
              {"#At (s)", "State", "#Score", "#Threshold", "#Frequency (Hz)", "Mode", "#Quiet speed (rpm)", "Note"});
  for (const Json& event : events) {
    const std::string& state = text_of(event["state"]);
    table.row({fixed(event["time_s"], 3), escape(state), significant(event["score"]), significant(event["threshold"]),
               with_deviation(event["chatter_frequency_hz"], event["chatter_frequency_std_hz"], 1.0, 1),
               mode_name(event), fixed(event["suggested_spindle_speed_rpm"], 0), escape(text_of(event["note"]))},
              state == "chatter" ? "chatter" : "");
  }
  return table.html();
}

std::string plots_of(const Json& run) {
  std::string body = plot("monitor-wave", "The samples over time, chatter shaded",
                          "What was recorded; shaded where chatter was reported.");
  if (!run["spectrogram"].is_null()) {
    body += plot("monitor-spectrogram", "Synchrosqueezed spectrogram of the recording over time",
                 "Synchrosqueezed spectrogram; the marks are what the monitor took for chatter.");
  }
  return body + plot("monitor-score", "Score against its threshold, energy entropy and spindle speed over time",
                     "The score against its threshold, and what else was followed.");
}

std::string rows_table(const Json& rows) {
  Table table("~Recordings and what became of them",
              {"Recording", "Label", "Used to", "Alarm", "#After chatter's begin (ms)", "#Before it is visible (ms)"});
  for (const Json& row : rows) {
    const bool chatter = row["chatter"].get<bool>(), alarmed = row["alarmed"].get<bool>();
    table.row(
        {escape(text_of(row["name"])), chatter ? "chatter" : "stable", row["verifies"].get<bool>() ? "verify" : "set",
         alarmed == chatter ? (alarmed ? "yes" : "no")
                            : (alarmed ? "<strong>false</strong>" : "<strong>missed</strong>"),
         fixed(row["delay_ms"], 0), fixed(row["lead_ms"], 0)},
        alarmed == chatter ? "" : "chatter");
  }
  return table.html();
}

}  // namespace

std::string monitor_section(const Json& report, bool plots) {
  const Json& run = report["monitor"];
  if (run.is_null()) return {};
  std::string body = facts_list(run["facts"]) + warning_box("Before you trust it", run["warnings"]) + verdict(run);
  if (plots && !run["decisions"]["time_s"].empty()) body += plots_of(run);
  body += events_table(run["events"]);
  if (run["compute_mean_us"].is_number()) {
    body += fmt::format("<p>{} decisions, each in {} µs on average and {} µs at most.</p>\n",
                        run["decision_count"].get<std::size_t>(), significant(run["compute_mean_us"]),
                        significant(run["compute_max_us"]));
  }
  return section("monitor", "Chatter monitor", "What the monitor detected in the recording, and when.",
                 body + bullet_list(run["notes"]));
}

std::string calibration_section(const Json& report, bool plots) {
  const Json& run = report["calibration"];
  if (run.is_null()) return {};
  std::string body = facts_list(run["facts"]) + warning_box("Before you trust it", run["warnings"]);
  if (plots) {
    body += plot("calibration-roc", "Share of chatter found against share of false alarms",
                 "Share of chatter found against share of false alarms, threshold by threshold; the mark is the chosen "
                 "one, on the recordings that verify it.");
  }
  const Json& rows = run["rows"];
  const auto wrong = std::ranges::count_if(
      rows, [](const Json& row) { return row["chatter"].get<bool>() != row["alarmed"].get<bool>(); });
  body += details(fmt::format("{} recordings, {} classified wrongly", rows.size(), wrong), rows_table(rows));
  return section("calibration", "Calibration", "How the threshold was set, and how it did on the other half.",
                 body + bullet_list(run["notes"]));
}

}  // namespace robomill::report
