#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/printable.hpp"
#include "robomill/base/units.hpp"
#include "robomill/coupling/assembly.hpp"
#include "robomill/coupling/files/assembly_toml.hpp"
#include "robomill/coupling/files/tools_csv.hpp"
#include "robomill/io/file.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"
#include "robomill/jobs/predict.hpp"
#include "robomill/jobs/tools.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

constexpr std::size_t peaks_shown = 6;
/// Of a holder's measurement, as a share of itself: what its notes speak of too.
constexpr double measurement_error = 0.01;

void print_peaks(const modal::FrfSet& set, const modal::Frf& frf) {
  const std::string name = modal::to_string(frf.name);
  std::vector<jobs::PeakFound> peaks = jobs::find_peaks(set.frequency_hz, frf.receptance);
  if (peaks.empty()) fmt::print("{}: no peak between the first line and the last\n", name);
  peaks.resize(std::min(peaks.size(), peaks_shown));
  for (const jobs::PeakFound& peak : peaks) {
    fmt::print("{}: peak at {:.6g} Hz, {:.4g} µm/N\n", name, peak.frequency_hz, peak.magnitude / units::um);
  }
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

void print_summary(const coupling::AssemblyFile& file, const coupling::TipResult& tip) {
  const modal::Frf& x = *tip.frfs.find(modal::parse_frf_name("xx"));
  const modal::Frf& y = *tip.frfs.find(modal::parse_frf_name("yy"));
  print_peaks(tip.frfs, x);
  print_compliance(file, tip.frfs, x.name);
  if (y.receptance == x.receptance) {
    fmt::print("yy: the same as xx\n");
  } else {
    print_peaks(tip.frfs, y);
    print_compliance(file, tip.frfs, y.name);
  }
  print_lines("Suspect", tip.suspect_hz);
  print_holder(file);
  print_notes(file.notes, "Note: ");
  print_notes(tip.notes, "Note: ");
}

/// tip.json with what the summary says of lines that are not to be trusted.
std::string tip_json(const coupling::AssemblyFile& file, const coupling::TipResult& tip) {
  modal::FrfDoubts doubts{.suspect_hz = tip.suspect_hz};
  const auto note = [&](const std::vector<std::string>& notes) {
    doubts.notes.insert(doubts.notes.end(), notes.begin(), notes.end());
  };
  if (file.holder) {
    doubts.unreliable_hz = file.holder->unreliable_hz;
    note(file.holder->notes);
  }
  note(file.notes);
  note(tip.notes);
  return modal::frf_json(tip.frfs, doubts);
}

/// The holder's receptances with their uncertainty, so that whoever couples to the file sees which lines are bad.
modal::FrfSet holder_with_deviation(const coupling::AssemblyFile& file) {
  modal::FrfSet out = file.assembly.holder.receptances;
  if (!file.holder) return out;  // as it was measured
  // Where the receptance itself vanishes the amplification has no bound.
  const Eigen::ArrayXd amplification =
      file.holder->amplification.array().isFinite().select(file.holder->amplification.array(), 1e6).min(1e6);
  for (modal::Frf& frf : out.frfs) {
    frf.deviation = measurement_error * amplification * frf.receptance.array().abs();
  }
  return out;
}

/// The tip's FRFs; an error about the assembly names its file.
coupling::TipResult couple(const coupling::AssemblyFile& file, const coupling::TipOptions& options) {
  try {
    return coupling::tip_frfs(file.assembly, file.frequency_hz, options);
  } catch (const InvalidInput& error) {
    InvalidInput::Parts parts = error.parts();
    if (parts.where.empty()) parts.where = file.path.string();
    throw InvalidInput(std::move(parts));
  }
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
  const bool as_json = common.to_stdout() || io::format_of(common.output) == io::Format::json;
  if (!common.output.empty() && !as_json && io::format_of(common.output) != io::Format::csv) {
    throw InvalidInput(common.output, "a table of tools is written as .csv or .json");
  }
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
  if (common.to_stdout()) {
    fmt::print("{}", jobs::tools_json(results, assembly.holder));
  } else if (!common.output.empty()) {
    io::write_file(common.output, as_json ? jobs::tools_json(results, assembly.holder) : jobs::tools_csv(results));
  }
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
  const coupling::AssemblyFile file = coupling::read_assembly(command.input);
  const modal::FrfSet& holder = file.assembly.holder.receptances;
  if (!command.holder_out.empty() && holder.frfs.empty()) {
    throw InvalidInput("--holder-out", "needs a measured holder",
                       "A holder of segments, or a rigid wall, has nothing to keep for the next tool");
  }
  progress.check();
  const coupling::TipResult tip = couple(file, {.rotations = command.rotations});
  if (common.to_stdout()) {
    fmt::print("{}", tip_json(file, tip));
  } else if (!common.output.empty() && io::format_of(common.output) == io::Format::json) {
    io::write_file(common.output, tip_json(file, tip));
  } else if (!common.output.empty()) {
    modal::write_frfs(common.output, tip.frfs);
  }
  if (!command.holder_out.empty()) modal::write_frfs(command.holder_out, holder_with_deviation(file));
  if (common.wants_summary()) print_summary(file, tip);
  return done;
}

}  // namespace robomill::app
