#include <fmt/format.h>

#include "robomill/report/drawing.hpp"
#include "robomill/report/html.hpp"
#include "robomill/report/sections.hpp"

namespace robomill::report {
namespace {

std::string segment_remark(const Json& segment) {
  std::string out = text_of(segment["beam"]);
  if (segment["flutes"].get<int>() > 0) {
    out += fmt::format("; {} flutes, counted as a solid round of {} mm", segment["flutes"].get<int>(),
                       significant(segment["equivalent_diameter_mm"]));
  }
  return out;
}

std::string segments_table(const Json& assembly) {
  Table table("Segments from the tip", {"Segment", "#Length (mm)", "#Diameter (mm)", "#Bore (mm)", "#E (GPa)",
                                        "#Density (kg/m³) or mass", "#Loss factor", "Beam"});
  const auto rows = [&](const Json& segments) {
    for (const Json& s : segments) {
      const std::string weight =
          s["mass_kg"].is_number() ? significant(s["mass_kg"]) + " kg" : significant(s["density_kg_per_m3"]);
      table.row({fmt::format("{} {}", escape(text_of(s["part"])), s["count"].get<int>()),
                 fmt::format("{:.6g}", s["length_mm"].get<double>()),
                 fmt::format("{:.6g}", s["diameter_mm"].get<double>()), significant(s["inner_diameter_mm"]),
                 significant(s["youngs_modulus_gpa"]), weight, significant(s["loss_factor"]), segment_remark(s)});
    }
  };
  rows(assembly["tool"]);
  if (assembly["joint"].is_object()) rows(assembly["joint"]["shank"]);
  rows(assembly["holder"]["segments"]);
  return table.html();
}

std::string joint_part(const Json& joint) {
  if (!joint.is_object()) return "<p>The joint between tool and holder is rigid.</p>\n";
  Table table("Joint between tool and holder", {"Direction", "#Stiffness", "Unit", "#Damping", "Unit"});
  table.row({"shift", with_power(joint["translational_stiffness_n_per_m"]), "N/m",
             with_power(joint["translational_damping_n_s_per_m"]), "N·s/m"});
  table.row({"rotation", with_power(joint["rotational_stiffness_n_m_per_rad"]), "N·m/rad",
             with_power(joint["rotational_damping_n_m_s_per_rad"]), "N·m·s/rad"});
  if (joint["cross_stiffness_n_per_rad"].is_number() && joint["cross_stiffness_n_per_rad"].get<double>() != 0.0) {
    table.row({"shift by rotation", with_power(joint["cross_stiffness_n_per_rad"]), "N/rad", "–", ""});
  }
  std::string out = table.html();
  if (joint["points"].get<int>() > 1) {
    out += fmt::format("<p>Spread over {} points along {} mm of the shank, an equal share at each.</p>\n",
                       joint["points"].get<int>(), significant(joint["insertion_length_mm"]));
  }
  return out;
}

std::string peaks_table(const Json& peaks) {
  if (peaks.empty()) return {};
  bool measured = false;
  for (const Json& peak : peaks) measured = measured || peak["measured_frequency_hz"].is_number();
  std::vector<std::string> headings = {"FRF", "#Frequency (Hz)", "#Magnitude (µm/N)"};
  if (measured) headings.insert(headings.end(), {"#Measured (Hz)", "#Predicted too high by"});
  Table table("First peaks of the predicted FRFs", headings);
  for (const Json& peak : peaks) {
    std::vector<std::string> cells = {escape(text_of(peak["name"])), fixed(peak["frequency_hz"], 1),
                                      significant(peak["receptance_um_per_n"])};
    if (measured) {
      const Json& found = peak["measured_frequency_hz"];
      cells.push_back(fixed(found, 1));
      cells.push_back(
          found.is_number() ? percent(Json(peak["frequency_hz"].get<double>() / found.get<double>() - 1.0), 1) : "–");
    }
    table.row(cells);
  }
  return table.html();
}

std::string marked_lines(const Json& assembly) {
  std::string out;
  const auto suspect = assembly["suspect_lines"].get<std::size_t>();
  const auto unreliable = assembly["unreliable_lines"].get<std::size_t>();
  if (suspect > 0) {
    out += fmt::format(
        "<p><strong>At {} line{} the measured holder would create energy</strong>: the prediction is "
        "suspect there, and the plot below is shaded.</p>\n",
        suspect, suspect == 1 ? "" : "s");
  }
  if (unreliable > 0) {
    out += fmt::format(
        "<p><strong>At {} line{} the holder's receptances are unreliable</strong>: a small error of the "
        "measurement became a large one; between dotted lines in the plot below.</p>\n",
        unreliable, unreliable == 1 ? "" : "s");
  }
  return out;
}

}  // namespace

std::string assembly_section(const Json& report) {
  const Json& assembly = report["assembly"];
  if (assembly.is_null()) return {};
  std::string body = assembly_drawing(assembly);
  if (!text_of(assembly["holder"]["file"]).empty()) {
    body += "<p>The holder was measured: <code>" + escape(text_of(assembly["holder"]["file"])) + "</code>.</p>\n";
  }
  body += marked_lines(assembly) + peaks_table(assembly["peaks"]) + joint_part(assembly["joint"]) +
          details("Segments one by one", segments_table(assembly)) + bullet_list(assembly["notes"]);
  return section("assembly", "Tool and holder",
                 "What the prediction was made of: the tool from its tip, the joint, and what holds it.", body);
}

}  // namespace robomill::report
