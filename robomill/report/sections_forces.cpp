#include <fmt/format.h>

#include <algorithm>

#include "robomill/report/html.hpp"
#include "robomill/report/sections.hpp"

namespace robomill::report {
namespace {

/// A box of its own, so that it is not read past.
/// "12.1, −3, 40": three numbers in one cell.
std::string coordinates(const Json& triple) {
  return fmt::format("{}, {}, {}", significant(triple[0]), significant(triple[1]), significant(triple[2]));
}

std::string components_table(const Json& turn) {
  Table table(fmt::format("Force on the {}: x along the feed, y to its left, z to the spindle", text_of(turn["on"])),
              {"", "#x", "#y", "#z"});
  const auto row = [&](const char* name, const Json& values) {
    table.row({name, significant(values[0]), significant(values[1]), significant(values[2])});
  };
  row("Mean (N)", turn["mean_n"]);
  row("Peak (N)", turn["peak_n"]);
  row("Root mean square (N)", turn["rms_n"]);
  const Json& deflection = turn["deflection_um"];
  const bool bends = std::ranges::any_of(deflection, [](const Json& value) { return value.is_number(); });
  if (bends) row("Deflection by the mean force (µm)", deflection);
  return table.html();
}

std::string totals_table(const Json& turn) {
  Table table("Over one revolution", {"", "#Value", "Unit"});
  const auto row = [&](const char* name, const Json& value, const char* unit) {
    if (value.is_number()) table.row({name, significant(value), unit});
  };
  row("Torque, mean", turn["mean_torque_n_m"], "N·m");
  row("Torque, peak", turn["peak_torque_n_m"], "N·m");
  row("Power, mean", turn["power_w"], "W");
  row("Removal rate", turn["removal_rate_mm3_per_s"], "mm³/s");
  row("Chip area across the feed", turn["chip_area_mm2"], "mm²");
  row("Deflection, peak", turn["peak_deflection_um"], "µm");
  return table.html();
}

std::string verdict_sentence(const Json& turn) {
  std::string out;
  if (!text_of(turn["verdict"]).empty()) out += "<strong>" + escape(text_of(turn["verdict"])) + "</strong> ";
  if (turn["chatter_frequency_hz"].is_number() && text_of(turn["verdict"]).find(" Hz") == std::string::npos) {
    out += fmt::format("Chatter at {} Hz. ", fixed(turn["chatter_frequency_hz"], 0));
  }
  if (turn["vibrating"].get<bool>()) out += "Simulated in the time domain: the vibration is in the forces.";
  return out.empty() ? out : "<p class=\"why\">" + out + "</p>\n";
}

/// At some 24 of its angles, for who has no plots or cannot see them.
std::string turn_table(const Json& turn) {
  const Json& rotation = turn["rotation_deg"];
  const std::size_t step = std::max<std::size_t>(1, rotation.size() / 24);
  Table table("~Force and torque over rotation", {"#Rotation (°)", "#Fx (N)", "#Fy (N)", "#Fz (N)", "#Torque (N·m)"});
  for (std::size_t i = 0; i < rotation.size(); i += step) {
    table.row({fixed(rotation[i], 0), significant(turn["fx_n"][i]), significant(turn["fy_n"][i]),
               significant(turn["fz_n"][i]), significant(turn["torque_n_m"][i])});
  }
  return details("Force and torque over rotation as a table", table.html());
}

std::string engagement_table(const Json& rings) {
  const std::size_t step = std::max<std::size_t>(1, rings.size() / 24);
  Table table("~Engagement", {"#Height (mm)", "#Position angle κ (°)", "In the material from – to (°)"});
  for (std::size_t i = 0; i < rings.size(); i += step) {
    std::string arcs;
    for (const Json& arc : rings[i]["arcs"]) {
      arcs += fmt::format("{}{} – {}", arcs.empty() ? "" : "; ", fixed(arc["entry_deg"], 1), fixed(arc["exit_deg"], 1));
    }
    table.row({significant(rings[i]["height_mm"]), fixed(rings[i]["position_deg"], 1), arcs.empty() ? "–" : arcs});
  }
  return details("Engagement as a table", table.html());
}

std::string revolution_part(const Json& turn, bool plots) {
  if (turn.is_null()) return {};
  std::string body =
      "<h3>Over a revolution</h3>\n" + verdict_sentence(turn) + components_table(turn) + totals_table(turn);
  if (!turn["rotation_deg"].empty()) {
    if (plots) {
      body += plot("revolution", "Forces in x, y and z and torque over the cutter's rotation",
                   "Rotation counts clockwise from +y, seen from the spindle: at 90° the first tooth points along "
                   "the feed.");
    }
    body += turn_table(turn);
  }
  const Json& rings = turn["engagement"];
  if (rings.empty()) return body;
  if (std::ranges::all_of(rings, [](const Json& ring) { return ring["arcs"].empty(); })) {
    return body + "<p>No tooth is in the material here.</p>\n";
  }
  if (plots) {
    body +=
        plot("engagement", "Engagement map: where around the axis and how high above the tip teeth are in the material",
             "Between the ends of a bar a tooth at that height is in the material.");
  }
  return body + engagement_table(rings);
}

/// The highest values of a program, beside what the spindle can give.
std::string highest_table(const Json& program) {
  Table table("Highest values", {"", "#Value", "Unit", "#Block", "#Line", "#Spindle's limit", "Verdict"});
  const Json& highest = program["highest"];
  const auto row = [&](const std::string& name, const Json& entry, const char* unit, const Json& limit) {
    if (entry.is_null()) return;
    const bool limited = limit.is_number();
    const bool above = limited && entry["value"].get<double>() > limit.get<double>();
    const char* verdict = above ? "<strong>above the limit</strong>" : limited ? "within the limit" : "–";
    table.row({name, significant(entry["value"]), unit, fixed(entry["block"], 0), fixed(entry["line"], 0),
               significant(limit), verdict},
              above ? "chatter" : "");
  };
  row("Force, peak", highest["peak_force_n"], "N", nullptr);
  row("Torque over a revolution", highest["torque_n_m"], "N·m", program["torque_limit_n_m"]);
  row("Torque, peak", highest["peak_torque_n_m"], "N·m", nullptr);
  const std::string power = fmt::format("Power over {} s", significant(program["power_time_s"]));
  row(power, highest["power_w"], "W", program["power_limit_w"]);
  row("Deflection over a revolution", highest["deflection_um"], "µm", nullptr);
  return table.html();
}

std::string worst_table(const Json& program) {
  if (program["worst"].empty()) return {};
  const bool bends = program["highest"]["deflection_um"].is_object();
  std::vector<std::string> headings = {"#Block",
                                       "#Line",
                                       "#Tip at x, y, z (mm)",
                                       "#Axial depth (mm)",
                                       "#Radial depth (mm)",
                                       "#Peak force (N)",
                                       "#Mean force while cutting x, y, z (N)",
                                       "#Torque over a revolution (N·m)",
                                       fmt::format("#Power over {} s (W)", significant(program["power_time_s"]))};
  if (bends) headings.emplace_back("#Deflection (µm)");
  Table table("The blocks with the highest peak force", headings);
  for (const Json& row : program["worst"]) {
    std::vector<std::string> cells = {fixed(row["block"], 0),
                                      fixed(row["line"], 0),
                                      coordinates(row["tip_mm"]),
                                      significant(row["axial_depth_mm"]),
                                      significant(row["radial_depth_mm"]),
                                      significant(row["peak_force_n"]),
                                      coordinates(row["mean_force_n"]),
                                      significant(row["torque_n_m"]),
                                      significant(row["power_w"])};
    if (bends) cells.push_back(significant(row["deflection_um"]));
    table.row(cells);
  }
  return table.html();
}

std::string program_part(const Json& program, bool plots) {
  if (program.is_null()) return {};
  std::string body = "<h3>Along the program</h3>\n";
  body += fmt::format("<p>{} of {} blocks cut; {} mm", program["cutting_blocks"].get<int>(),
                      program["blocks"].get<int>(), fixed(program["length_mm"], 0));
  if (program["time_s"].is_number()) body += fmt::format(" in {} s", fixed(program["time_s"], 1));
  body += ".</p>\n" + warning_box("Trouble along the program", program["troubles"]) + highest_table(program);
  if (plots) {
    body += plot("program", "Peak force, torque, power and deflection over the length of the path",
                 "Each step is a block of the program.");
    body += plot("track", "The tool's path seen from above and from the side, coloured by peak force",
                 "Coloured by the peak force of each block; grey where nothing is cut.");
  }
  return body + worst_table(program);
}

std::string rotation_part(const Json& sweep, bool plots) {
  if (sweep.is_null()) return {};
  std::string body = "<h3>Rotation about the spindle's axis</h3>\n";
  if (sweep["best_deg"].is_number()) {
    body += fmt::format("<p class=\"why\">Stiffest at <strong>γ = {}°</strong>", significant(sweep["best_deg"]));
    if (sweep["best_um"].is_number()) body += fmt::format(" with {} µm", significant(sweep["best_um"]));
    if (sweep["used_deg"].is_number()) {
      body += fmt::format("; this job uses {}°", significant(sweep["used_deg"]));
      if (sweep["used_um"].is_number()) body += fmt::format(" with {} µm", significant(sweep["used_um"]));
    }
    body += ".</p>\n";
  }
  if (plots) {
    body += plot("gamma", "Deflection over the redundant rotation about the spindle's axis",
                 "The tool does the same in every rotation γ; the robot stands differently, and bends differently.");
  }
  const Json& rotation = sweep["rotation_deg"];
  const Json& condition = sweep["condition_number"];
  const std::size_t step = std::max<std::size_t>(1, rotation.size() / 24);
  std::vector<std::string> headings = {"#Rotation γ (°)", "#Deflection (µm)"};
  if (condition.is_array()) headings.emplace_back("#Condition number");
  Table table("~Deflection over rotation", headings);
  for (std::size_t i = 0; i < rotation.size(); i += step) {
    const Json& deflection = sweep["deflection_um"][i];
    std::vector<std::string> cells = {fixed(rotation[i], 0),
                                      deflection.is_number() ? significant(deflection) : "out of reach"};
    if (condition.is_array()) cells.push_back(significant(condition[i]));
    table.row(cells);
  }
  return body + details("Deflection over rotation as a table", table.html());
}

}  // namespace

std::string forces_section(const Json& report, bool plots) {
  const Json& forces = report["forces"];
  if (forces.is_null()) return {};
  std::string body = facts_list(forces["facts"]) + warning_box("Before you use these forces", forces["warnings"]) +
                     revolution_part(forces["revolution"], plots) + program_part(forces["program"], plots) +
                     rotation_part(forces["spindle_rotation"], plots) + bullet_list(forces["notes"]);
  return section("forces", "Forces", "What the cut asks of cutter, spindle and robot.", body);
}

}  // namespace robomill::report
