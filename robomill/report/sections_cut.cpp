#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robomill/report/html.hpp"
#include "robomill/report/sections.hpp"

namespace robomill::report {
namespace {

std::string verdict_badge(const Json& verdict) {
  if (!verdict.is_string()) return "<span class=\"verdict unknown\">not stated</span>";
  return fmt::format("<span class=\"verdict {0}\">{0}</span>", text_of(verdict));
}

std::string figure_of_merit(const char* label, const std::string& value, const char* unit) {
  return fmt::format("<div><dt>{}</dt><dd>{} <small>{}</small></dd></div>", label, value, unit);
}

std::string limited_by(const Json& r) {
  std::string why = escape(text_of(r["limited_by"]));
  if (why.empty() && r["mode"].is_number()) why = mode_name(r);
  return why;
}

std::string alternatives_table(const Json& report) {
  if (report["alternatives"].empty()) return {};
  Table table("Alternatives", {"", "#Spindle speed (rpm)", "#Axial depth (mm)", "#Feed (mm/min)",
                               "#Removal rate (mm³/s)", "#Surface error (µm)", "#Margin", "Limited by"});
  int count = 0;
  for (const Json& r : report["alternatives"]) {
    table.row({fmt::format("<span class=\"tag\">{}</span>", ++count), fixed(r["spindle_speed_rpm"], 0),
               fixed(r["axial_depth_mm"], 2), significant(r["feed_mm_per_min"]),
               significant(r["removal_rate_mm3_per_s"]), significant(r["surface_error_um"]), percent(r["margin"], 0),
               limited_by(r)});
  }
  return table.html();
}

std::string agreement_sentence(const Json& counts) {
  const auto agree = counts["agree"].get<int>();
  const auto compared = agree + counts["disagree"].get<int>();
  const auto rest = counts["not_compared"].get<int>();
  std::string out = "<p class=\"agreement\">";
  out += compared == 0
             ? std::string("No test cut carries a result to compare with the prediction.")
             : fmt::format("<strong>{} of {}</strong> test cuts with a result came out as predicted.", agree, compared);
  if (rest > 0 && compared > 0) out += fmt::format(" {} more could not be compared.", rest);
  return out + "</p>\n";
}

std::string cuts_table(const Json& cuts) {
  Table table("~Test cuts", {"#Spindle speed (rpm)", "#Axial depth (mm)", "Result", "Predicted",
                             "#Limit at this speed (mm)", "Agrees", "Note"});
  for (const Json& cut : cuts) {
    const Json& agrees = cut["agrees"];
    const char* verdict = agrees.is_boolean() ? (agrees.get<bool>() ? "yes" : "<strong>no</strong>") : "–";
    table.row({fixed(cut["spindle_speed_rpm"], 0), significant(cut["axial_depth_mm"]), verdict_badge(cut["result"]),
               verdict_badge(cut["predicted"]), fixed(cut["limit_mm"], 3), verdict, escape(text_of(cut["note"]))});
  }
  return table.html();
}

/// The cuts that were made say that the model is wrong: nothing below is worth more than that.
std::string disagreement(const Json& counts) {
  const auto disagree = counts["disagree"].get<int>();
  if (disagree == 0) return {};
  return fmt::format(
      "<p class=\"why none\"><strong>{} of {} test cuts disagree</strong> with the prediction. Find out why before you "
      "use these numbers: measure again, or check cutter, cut and coefficients.</p>\n",
      disagree, disagree + counts["agree"].get<int>());
}

std::string figures(const Json& r) {
  std::string out = "<dl class=\"figures\">" +
                    figure_of_merit("Spindle speed", fixed(r["spindle_speed_rpm"], 0), "rpm") +
                    figure_of_merit("Axial depth", fixed(r["axial_depth_mm"], 2), "mm") +
                    figure_of_merit("Feed", significant(r["feed_mm_per_min"]), "mm/min") +
                    figure_of_merit("Feed per tooth", significant(r["feed_per_tooth_mm"]), "mm") +
                    figure_of_merit("Cutting speed", significant(r["cutting_speed_m_per_min"]), "m/min") +
                    figure_of_merit("Removal rate", significant(r["removal_rate_mm3_per_s"]), "mm³/s") +
                    figure_of_merit("Mean torque", significant(r["torque_n_m"]), "N·m") +
                    figure_of_merit("Mean power", significant(r["power_w"]), "W") +
                    figure_of_merit("Surface error", significant(r["surface_error_um"]), "µm") +
                    figure_of_merit("Peak deflection", significant(r["peak_deflection_um"]), "µm");
  return out + "</dl>\n";
}

/// What forced vibration leaves, and whether anything limits it.
std::string surface_sentence(const Json& r, const Json& finishing) {
  const Json& error = r["surface_error_um"];
  const Json& deflection = r["peak_deflection_um"];
  if (!deflection.is_number()) return "The surface that forced vibration leaves is not known. ";
  std::string out;
  if (error.is_number()) {
    out = fmt::format("Forced vibration leaves {} µm of {} at the wall", significant(std::abs(error.get<double>())),
                      error.get<double>() < 0.0 ? "overcut" : "material");
  } else {
    out = "No tooth finishes a wall";
  }
  out += fmt::format("; the tip moves by up to {} µm. ", significant(deflection));
  const bool limited = finishing["max_surface_error_um"].is_number() || finishing["max_deflection_um"].is_number();
  if (!limited) return out + "Neither is limited: this is a roughing cut. ";
  out += "Permitted:";
  if (finishing["max_surface_error_um"].is_number()) {
    out += fmt::format(" surface error {} µm", significant(finishing["max_surface_error_um"]));
  }
  if (finishing["max_deflection_um"].is_number()) {
    out += fmt::format("{} deflection {} µm", finishing["max_surface_error_um"].is_number() ? "," : "",
                       significant(finishing["max_deflection_um"]));
  }
  return out + ". ";
}

/// The limit at some 24 of its speeds, for who has no plots or cannot see them.
std::string limit_table(const Json& lobes) {
  const Json& speed = lobes["spindle_speed_rpm"];
  const Json& limit = lobes["limit_mm"];
  if (speed.empty()) return {};
  const std::size_t step = std::max<std::size_t>(1, speed.size() / 24);
  Table table("Limit depth at some of the computed speeds", {"#Spindle speed (rpm)", "#Limit depth (mm)"});
  for (std::size_t i = 0; i < speed.size(); i += step) {
    const bool none = !limit[i].is_number();
    table.row({fixed(speed[i], 0), none ? "above " + significant(lobes["searched_depth_mm"]) : fixed(limit[i], 3)});
  }
  return details("The limit as a table", table.html());
}

}  // namespace

std::string recommendation_section(const Json& report) {
  const Json& r = report["recommendation"];
  std::string body = disagreement(report["agreement"]);
  if (r.is_null()) {
    const std::string& why = text_of(report["no_recommendation"]);
    if (why.empty() && report["alternatives"].empty()) {
      return body.empty()
                 ? body
                 : "<section id=\"recommendation\" class=\"hero\"><h2>Test cuts</h2>\n" + body + "</section>\n";
    }
    const char* const none = report["lobes"].empty() ? "No answer." : "No safe depth.";
    body += fmt::format("<p class=\"why none\"><strong>{}</strong> {}</p>\n", none, escape(why));
  } else {
    body += figures(r) + "<p class=\"why\">";
    const std::string why = limited_by(r);
    if (!why.empty()) body += "Limited by <strong>" + why + "</strong>. ";
    if (r["chatter_frequency_hz"].is_number() && why.find(" Hz") == std::string::npos) {
      body += fmt::format("Chatter would sound at {} Hz. ", fixed(r["chatter_frequency_hz"], 0));
    }
    if (r["margin"].is_number()) {
      const char* sentence =
          r["mode"].is_number() || r["chatter_frequency_hz"].is_number()
              ? "The depth stays {} below the chatter limit near this speed."
              : "No chatter limit was found near this speed: the depth stays {} below the deepest cut "
                "that was looked at.";
      body += fmt::format(fmt::runtime(sentence), percent(r["margin"], 0));
    }
    body += "</p>\n<p class=\"why\">" + surface_sentence(r, report["finishing"]) + "</p>\n";
  }
  body += alternatives_table(report);
  return "<section id=\"recommendation\" class=\"hero\"><h2>Recommended cut</h2>\n" + body + "</section>\n";
}

std::string lobes_section(const Json& report, bool plots) {
  const Json& lobes = report["lobes"];
  const Json& cuts = report["cuts"];
  if (lobes.empty() && cuts.empty()) return {};
  std::string body;
  if (!cuts.empty()) body += agreement_sentence(report["agreement"]);
  if (!lobes.empty()) {
    if (plots) {
      body +=
          plot("lobes", "Stability lobes: limit depth over spindle speed, with the recommended point and the test cuts",
               "Below the line a cut is stable, above it the tool chatters; the lower plot says at which frequency.");
      if (!lobes[0]["map"].is_null()) {
        body += details("Spectral radius",
                        plot("map", "Spectral radius over spindle speed and axial depth",
                             "Where the spectral radius is above 1, a vibration grows from tooth to tooth."));
      }
    }
    body += limit_table(lobes[0]);
  }
  if (!cuts.empty()) body += details("Test cuts one by one", cuts_table(cuts));
  return section("lobes", "Stability lobes", "How deep the cutter may go at each spindle speed before chatter starts.",
                 body);
}

std::string feed_section(const Json& report, bool plots) {
  const Json& feed = report["feed_directions"];
  if (feed.is_null() || feed["direction_deg"].empty()) return {};
  std::string body;
  if (plots) {
    body += plot("feed", "Limit depth over the direction of the feed, as a polar plot",
                 "The further out the line, the deeper the cut may be when the feed runs in that direction.");
  }
  const bool at_speed = feed["limit_at_speed_mm"].is_array();
  std::vector<std::string> headings = {"#Feed direction (°)", "#Lowest limit (mm)"};
  if (at_speed) headings.push_back(fmt::format("#Limit at {} rpm (mm)", fixed(feed["spindle_speed_rpm"], 0)));
  Table table("~Limit over feed direction", headings);
  const auto depth = [&](const Json& value) {
    return value.is_number() ? fixed(value, 3) : "above " + significant(feed["searched_depth_mm"]);
  };
  const Json& direction = feed["direction_deg"];
  const std::size_t step = std::max<std::size_t>(1, direction.size() / 24);
  for (std::size_t i = 0; i < direction.size(); i += step) {
    std::vector<std::string> cells = {fixed(direction[i], 0), depth(feed["lowest_limit_mm"][i])};
    if (at_speed) cells.push_back(depth(feed["limit_at_speed_mm"][i]));
    table.row(cells);
  }
  body += details("The limit over direction as a table", table.html());
  return section("feed", "Feed direction",
                 "A robot is not the same in every direction: where the feed runs changes the limit.", body);
}

std::string pairs_section(const Json& report, bool plots) {
  const Json& lobes = report["lobes"];
  if (lobes.size() < 2) return {};
  std::string body;
  if (plots) {
    body += plot("pairs", "Stability lobes of some modes alone beside those of all modes",
                 "Each panel keeps only the named modes; the grey line is the limit with all of them.");
  }
  Table table("Lowest limit by modes kept", {"Modes", "#Lowest limit (mm)", "#At spindle speed (rpm)"});
  for (const Json& part : lobes) {
    Json lowest = nullptr;
    Json at = nullptr;
    for (std::size_t i = 0; i < part["limit_mm"].size(); ++i) {
      const Json& limit = part["limit_mm"][i];
      if (limit.is_number() && (lowest.is_null() || limit.get<double>() < lowest.get<double>())) {
        lowest = limit;
        at = part["spindle_speed_rpm"][i];
      }
    }
    const std::string none = "above " + significant(part["searched_depth_mm"]);
    table.row({escape(text_of(part["label"])), lowest.is_null() ? none : fixed(lowest, 3), fixed(at, 0)});
  }
  return section("pairs", "Which modes matter", "The lobes of some modes alone show which of them set the limit.",
                 body + table.html());
}

std::string recordings_section(const Json& report, bool plots) {
  std::string body;
  int index = 0;
  for (const Json& recording : report["recordings"]) {
    body += fmt::format("<article class=\"recording\"><h3>{} {}</h3>\n<p>{} rpm, {} teeth",
                        escape(text_of(recording["file"])), verdict_badge(recording["verdict"]),
                        fixed(recording["spindle_speed_rpm"], 0), recording["teeth"].get<int>());
    if (recording["axial_depth_mm"].is_number()) body += ", " + significant(recording["axial_depth_mm"]) + " mm deep";
    const std::string& reason = text_of(recording["reason"]);
    body += (reason.empty() ? std::string() : ". " + escape(reason)) + "</p>\n";
    if (plots && !recording["frequency_hz"].empty()) {
      body += plot(
          fmt::format("recording:{}", index).c_str(), "Spectrum of " + text_of(recording["file"]),
          "Peaks on the rotation and tooth-passing lines are the cut itself; strong peaks between them are chatter.");
    }
    if (!recording["peaks"].empty()) {
      Table table("Peaks", {"#Frequency (Hz)", "#Amplitude (" + escape(text_of(recording["amplitude_unit"])) + ")",
                            "What it is"});
      for (const Json& peak : recording["peaks"]) {
        const bool chatter = peak["kind"] == "chatter";
        table.row({fixed(peak["frequency_hz"], 2), significant(peak["amplitude"]), escape(text_of(peak["text"]))},
                  chatter ? "chatter" : "");
      }
      body += table.html();
    }
    body += "</article>\n";
    ++index;
  }
  return section("recordings", "Recorded cuts", "The spectrum of a recorded vibration says whether that cut chattered.",
                 body);
}

}  // namespace robomill::report
