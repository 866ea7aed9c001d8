#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>

#include "robomill/base/error.hpp"
#include "robomill/base/printable.hpp"
#include "robomill/base/units.hpp"
#include "robomill/coupling/assembly.hpp"
#include "robomill/coupling/files/assembly_toml.hpp"
#include "robomill/coupling/files/tools_csv.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"
#include "robomill/jobs/predict.hpp"
#include "robomill/jobs/tools.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

void print_peaks(const jobs::TipPrediction& prediction, const modal::FrfName& frf) {
  const std::string name = modal::to_string(frf);
  bool any = false;
  for (const jobs::TipPeak& peak : prediction.peaks) {
    if (peak.name != frf) continue;
    any = true;
    fmt::print("{}: peak at {:.6g} Hz, {:.4g} µm/N\n", name, peak.frequency_hz, peak.receptance_m_per_n / units::um);
  }
  if (!any) fmt::print("{}: no peak between the first line and the last\n", name);
}

/// Of an assembly of beams far below its lines; of a measured holder, which has no such lines, at the first.
void print_compliance(const coupling::AssemblyFile& file, const modal::FrfSet& tip, const modal::FrfName& name) {
  const std::string text = modal::to_string(name);
  if (!file.assembly.holder.receptances.frfs.empty()) {
    const double compliance = std::abs(tip.find(name)->receptance(0));
    fmt::print("{}: {:.4g} µm/N at the first line, {:.6g} Hz\n", text, compliance / units::um, tip.frequency_hz(0));
    return;
  }
  const Eigen::VectorXd low = Eigen::VectorXd::Constant(1, 0.01 * tip.frequency_hz(0));
  const double compliance = coupling::tip_frfs(file.assembly, low).frfs.find(name)->receptance(0).real();
  fmt::print("{}: static compliance {:.4g} µm/N (stiffness {:.4g} N/µm)\n", text, compliance / units::um,
             units::um / compliance);
}

void print_lines(const char* what, const std::vector<double>& lines_hz) {
  if (lines_hz.empty()) return;
  fmt::print("{}: {} lines, {:.6g} to {:.6g} Hz\n", what, lines_hz.size(), lines_hz.front(), lines_hz.back());
}

/// What to know of a holder that was found from a measurement.
void print_holder(const coupling::AssemblyFile& file) {
  if (!file.holder) return;
  print_lines("Holder not reliable", file.holder->unreliable_hz);
  print_notes(file.holder->notes, "Note: ");
}

void print_summary(const jobs::TipPrediction& prediction) {
  const coupling::AssemblyFile& file = prediction.file;
  const coupling::TipResult& tip = prediction.tip;
  const modal::Frf& x = *tip.frfs.find(modal::parse_frf_name("xx"));
  const modal::Frf& y = *tip.frfs.find(modal::parse_frf_name("yy"));
  print_peaks(prediction, x.name);
  print_compliance(file, tip.frfs, x.name);
  if (y.receptance == x.receptance) {
    fmt::print("yy: the same as xx\n");
  } else {
    print_peaks(prediction, y.name);
    print_compliance(file, tip.frfs, y.name);
  }
  print_lines("Suspect", tip.suspect_hz);
  print_holder(file);
  print_notes(file.notes, "Note: ");
  print_notes(tip.notes, "Note: ");
}

void print_tools(const std::vector<jobs::ToolResult>& results) {
  fmt::print("{:<20} {:>5} {:>9} {:>9} {:>10} {:>5} {:>10} {:>9} {:>9}\n", "tool", "teeth", "overhang", "peak Hz",
             "µm/N", "modes", "lowest mm", "rpm", "depth mm");
  for (const jobs::ToolResult& tool : results) {
    fmt::print("{:<20} {:>5} {:>9.4g} ", printable(tool.name), tool.teeth, tool.overhang_m / units::mm);
    if (!tool.failure.empty()) {
      fmt::print("{}\n", printable(tool.failure));
      continue;
    }
    fmt::print("{:>9.5g} {:>9.4g} {:>5} ", tool.peak_hz, tool.peak_m_per_n / units::um, tool.modes.modes.size());
    const bool limited = tool.lowest_limit_m.has_value();
    fmt::print("{:>10} ", limited ? fmt::format("{:.4g}", *tool.lowest_limit_m / units::mm) : "-");
    if (tool.recommendation && tool.recommendation->recommended) {
      const decision::Operation& best = *tool.recommendation->recommended;
      fmt::print("{:>9.0f} {:>9.4g}\n", best.spindle_speed_rad_per_s / units::rpm, best.axial_depth_m / units::mm);
    } else if (tool.recommendation) {
      fmt::print("{}\n", tool.recommendation->reason);
    } else {
      fmt::print("{}\n", tool.no_cut.empty() ? "-" : printable(tool.no_cut));
    }
  }
}

/// A table of many tools in the assembly's holder.
Exit try_tools(const CoupleCommand& command, const Common& common, Progress& progress) {
  require_output(common, {io::Format::csv, io::Format::json}, "a table of tools is written as .csv or .json");
  const coupling::AssemblyFile assembly = coupling::read_assembly(command.input);
  const auto tools = coupling::read_tools(command.tools, assembly.assembly.tool.front());
  std::optional<jobs::LobesFile> cut;
  if (!command.lobes.empty()) {
    cut = jobs::read_lobes(command.lobes);
    // Each tool brings its own dynamics; those of a workpiece stay.
    cut->drop_dynamics();
    jobs::load_dynamics(*cut);
  }
  const std::vector<jobs::ToolResult> results = jobs::try_tools(assembly, tools, cut, common.seed, progress);
  write_output(common, [&](io::Format format) {
    return format == io::Format::csv ? jobs::tools_csv(results) : jobs::tools_json(results, assembly.holder);
  });
  if (!command.frfs.empty()) jobs::write_tips(command.frfs, results);
  if (common.wants_summary()) {
    print_tools(results);
    print_holder(assembly);
    print_notes(assembly.notes, "Note: ");
  }
  const bool all_done =
      std::all_of(results.begin(), results.end(), [](const auto& t) { return t.failure.empty() && t.no_cut.empty(); });
  if (all_done) return done;
  fmt::print(stderr, "robomill: not every tool has a result; its row says why\n");
  return not_reached;
}

}  // namespace

Exit run(const CoupleCommand& command, const Common& common, Progress& progress) {
  if (!command.tools.empty()) return try_tools(command, common, progress);
  const jobs::TipPrediction prediction =
      jobs::predict_tip(command.input, {}, {.rotations = command.rotations}, progress);
  if (!command.holder_out.empty() && prediction.holder.frfs.empty()) {
    throw InvalidInput("--holder-out", "needs a measured holder",
                       "A holder of segments, or a rigid wall, has nothing to keep for the next tool");
  }
  if (common.to_stdout() || io::format_of(common.output) == io::Format::json) {
    write_output(common, [&](io::Format) { return jobs::tip_json(prediction); });
  } else if (!common.output.empty()) {
    modal::write_frfs(common.output, prediction.tip.frfs);
  }
  if (!command.holder_out.empty()) modal::write_frfs(command.holder_out, prediction.holder);
  if (common.wants_summary()) print_summary(prediction);
  return done;
}

}  // namespace robomill::app
