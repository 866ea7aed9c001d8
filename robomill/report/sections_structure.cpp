#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robomill/report/html.hpp"
#include "robomill/report/sections.hpp"

namespace robomill::report {
namespace {

std::string joined(const Json& texts) {
  std::string out;
  for (const Json& line : texts) out += (out.empty() ? "" : "; ") + escape(text_of(line));
  return out;
}

double size_of(const Json& complex) {
  return std::hypot(complex[0].get<double>(), complex[1].get<double>());
}

/// "x 93 %, y 7 %": how a mode's vibration splits over its degrees of freedom.
std::string directions(const Json& vector) {
  double total = 0.0;
  for (const auto& [dof, value] : vector.items()) total += size_of(value) * size_of(value);
  std::string out;
  if (total <= 0.0) return out;
  for (const auto& [dof, value] : vector.items()) {
    const double share = size_of(value) * size_of(value) / total;
    out += (out.empty() ? "" : ", ") + fmt::format("{} {}", escape(dof), percent(share, 0));
  }
  return out;
}

std::string share_bar(const Json& share) {
  if (!share.is_number()) return "–";
  return fmt::format("<span class=\"bar\" aria-hidden=\"true\"><span style=\"width:{:.1f}%\"></span></span>{}",
                     100.0 * share.get<double>(), percent(share, 0));
}

std::string complex_text(const Json& value) {
  const double imaginary = 1e4 * value[1].get<double>();
  return fmt::format("{:.2f} {} {:.2f}i", 1e4 * value[0].get<double>(), imaginary < 0.0 ? "−" : "+",
                     std::abs(imaginary));
}

/// "3", "3 (workpiece)".
std::string mode_cell(const Json& mode) {
  const std::string number = std::to_string(mode["mode"].get<int>());
  return text_of(mode["mode_of"]) == "tool" ? number : number + " (workpiece)";
}

/// Of one structure: another's vectors may have other directions.
std::string vectors_table(const Json& modes, const char* owner) {
  const auto first =
      std::find_if(modes.begin(), modes.end(), [&](const Json& mode) { return text_of(mode["mode_of"]) == owner; });
  if (first == modes.end()) return {};
  std::vector<std::string> headings = {"#Mode"};
  for (const auto& [dof, value] : (*first)["left"].items()) headings.push_back("#Left " + escape(dof));
  for (const auto& [dof, value] : (*first)["right"].items()) headings.push_back("#Right " + escape(dof));
  const std::string heading = fmt::format("Mode vectors of the {}", owner);
  Table table(heading + " (10⁻⁴ √(s/kg))", headings);
  for (const Json& mode : modes) {
    if (text_of(mode["mode_of"]) != owner) continue;
    std::vector<std::string> cells = {mode_cell(mode)};
    for (const auto& [dof, value] : mode["left"].items()) cells.push_back(complex_text(value));
    for (const auto& [dof, value] : mode["right"].items()) cells.push_back(complex_text(value));
    table.row(cells);
  }
  return details(heading, table.html());
}

std::string fit_sentence(const Json& fit) {
  std::string out = "<p>";
  if (!text_of(fit["method"]).empty())
    out += fmt::format("Fitted by the {} method", escape(text_of(fit["method"])));
  else
    out += "Fitted";
  if (fit["band_from_hz"].is_number() && fit["band_to_hz"].is_number()) {
    out += fmt::format(" from {} to {} Hz", significant(fit["band_from_hz"]), significant(fit["band_to_hz"]));
  }
  if (fit["relative_error"].is_number()) {
    out += fmt::format("; the fit differs from the FRFs by {}", percent(fit["relative_error"], 2));
    if (fit["mean_relative_error"].is_number()) {
      out += fmt::format(" (mean over lines {})", percent(fit["mean_relative_error"], 2));
    }
  }
  out += ".";
  if (!fit["converged"].get<bool>()) out += " <strong>The fit did not converge.</strong>";
  return out + "</p>\n";
}

/// Of predicted FRFs: how far the modes are from them, and they from a measurement.
std::string prediction_table(const Json& frfs) {
  bool measured = false;
  for (const Json& frf : frfs) measured = measured || frf["prediction_error"].is_number();
  std::vector<std::string> headings = {"FRF", "#Fit from prediction"};
  if (measured) headings.emplace_back("#Prediction from measurement");
  Table table("How far the curves are apart", headings);
  for (const Json& frf : frfs) {
    std::vector<std::string> cells = {escape(text_of(frf["name"])), percent(frf["relative_error"], 2)};
    if (measured) cells.push_back(percent(frf["prediction_error"], 1));
    table.row(cells);
  }
  return table.html();
}

std::string quality_table(const Json& frfs) {
  Table table("Quality before the fit", {"FRF", "Grade", "What was found", "What to do", "#Fit error"});
  for (const Json& frf : frfs) {
    const std::string grade = frf["grade"].is_string() ? text_of(frf["grade"]) : "unknown";
    table.row({escape(text_of(frf["name"])),
               fmt::format("<span class=\"grade {0}\">{1}</span>", grade, grade == "unknown" ? "not graded" : grade),
               joined(frf["findings"]), joined(frf["remedies"]), percent(frf["relative_error"], 2)});
  }
  return table.html();
}

}  // namespace

std::string frf_section(const Json& report, bool plots) {
  const Json& frfs = report["frfs"];
  if (frfs.empty()) return {};
  std::string body;
  const bool predicted = !report["assembly"].is_null();
  if (plots && predicted) {
    body +=
        plot("frf", "Frequency response functions, predicted, measured where known, and fitted: magnitude and phase",
             "A peak is a frequency at which the tool tip is compliant.");
  } else if (plots) {
    body += plot("frf", "Frequency response functions, measured and fitted: magnitude, phase and coherence",
                 "A peak is a frequency at which the tool tip is compliant; coherence near 1 means the hits agree.");
  }
  const char* lead =
      predicted
          ? "How far the tool tip moves for a force of one newton, as predicted from tool, joint and holder; xx is x "
            "due to a force in x."
          : "How far the tool tip moves for a force of one newton, at each frequency: xy is x due to a force in y.";
  return section("frf", "Frequency response", lead, body + (predicted ? prediction_table(frfs) : quality_table(frfs)));
}

std::string modes_section(const Json& report, bool plots) {
  const Json& modes = report["modes"];
  const Json& fit = report["fit"];
  if (modes.empty() && fit.is_null()) return {};
  std::string body;
  if (!fit.is_null()) body += fit_sentence(fit);
  if (!modes.empty()) {
    Table table("~Modes",
                {"#Mode", "#Frequency (Hz)", "#Damping (%)", "Force that drives it", "Motion", "Share in the limit"});
    for (const Json& mode : modes) {
      table.row({mode_cell(mode), with_deviation(mode["frequency_hz"], mode["std"]["frequency_hz"], 1.0, 2),
                 with_deviation(mode["damping_ratio"], mode["std"]["damping_ratio"], 100.0, 2),
                 directions(mode["left"]), directions(mode["right"]), share_bar(mode["limit_share"])});
    }
    body += table.html() + vectors_table(modes, "tool") + vectors_table(modes, "workpiece");
  }
  if (plots && !fit.is_null() && !fit["convergence"].empty()) {
    body += details("Convergence of the fit", plot("convergence", "Best objective over iterations",
                                                   "The fit is done when the curve no longer falls."));
  }
  if (plots && !fit.is_null() && !fit["stabilisation"].is_null()) {
    body += details(
        "Stabilisation diagram",
        plot("stabilisation", "Poles by model order over frequency",
             "A pole that stands still while the order grows is a mode of the structure; the others are noise."));
  }
  return section("modes", "Modes", "The vibrations the structure has of its own; ± is one standard deviation.", body);
}

std::string hits_section(const Json& report) {
  const Json& hits = report["hits"];
  if (hits.empty()) return {};
  Table table("~Hammer hits", {"File", "Force", "Used", "Remarks"});
  int used = 0;
  for (const Json& hit : hits) {
    const bool accepted = hit["accepted"].get<bool>();
    used += accepted ? 1 : 0;
    table.row({escape(text_of(hit["file"])), escape(text_of(hit["direction"])),
               accepted ? "yes" : "<strong>no</strong>", joined(hit["reasons"])},
              accepted ? "" : "rejected");
  }
  const bool all = used == static_cast<int>(hits.size());
  const std::string body = fmt::format("<p>{} of {} hits were used.</p>\n", used, hits.size()) +
                           (all ? details("All hits", table.html()) : table.html());
  return section("hits", "Hammer hits", "A hit that is overloaded or double is left out of the average.", body);
}

std::string notes_section(const Json& report) {
  std::string body = bullet_list(report["notes"]);
  if (!report["files"].empty()) {
    Table table("Files beside this report", {"Stage", "File", "What it holds"});
    for (const Json& file : report["files"]) {
      table.row({escape(text_of(file["stage"])), "<code>" + escape(text_of(file["file"])) + "</code>",
                 escape(text_of(file["description"]))});
    }
    body += table.html();
  }
  return section("notes", "Notes and files", "What else is worth knowing, and where the numbers are.", body);
}

}  // namespace robomill::report
