#include <fmt/format.h>

#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include "robomill/base/printable.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cell/dynamics.hpp"
#include "robomill/io/note_lines.hpp"
#include "robomill/io/system/append.hpp"
#include "robomill/jobs/files/assumed.hpp"
#include "robomill/jobs/frf.hpp"
#include "robomill/jobs/joint.hpp"
#include "robomill/jobs/modes.hpp"
#include "robomill/jobs/outputs.hpp"
#include "robomill/jobs/predict.hpp"
#include "robomill/jobs/stiffness.hpp"
#include "robomill/jobs/tools.hpp"
#include "robomill/modal/weak_modes.hpp"

// Measurements, modes, and the tool in its holder.

namespace robomill::jobs {
namespace {

void add_highest_peaks(std::string& out, const std::vector<modal::FrfGrade>& grades) {
  io::append(out, "\nHighest peaks in the band that can be trusted (µm/N)\n");
  for (const modal::FrfGrade& grade : grades) {
    std::string peaks;
    for (const modal::FrfPeak& peak : grade.peaks) {
      peaks += fmt::format("{}{:.4g} Hz {:.3g}", peaks.empty() ? "" : ", ", peak.frequency_hz,
                           peak.receptance_m_per_n / units::um);
    }
    io::append(out, "{:<6} {}\n", to_string(grade.name), peaks.empty() ? "none stands out" : peaks);
  }
}

/// @param bounds_of  what a mode of this number ended at, in words
template <class Bounds>
void add_modes(std::string& out, const modal::ModalModel& model, Bounds bounds_of) {
  io::append(out, "mode  {:<18}  {:<16}  {:>14}  {:>8}\n", "frequency Hz", "damping %", "stiffness N/µm", "mass kg");
  const auto known = [](double value, double std) {
    return std::isfinite(std) ? fmt::format("{:.6g} ± {:.2g}", value, std) : fmt::format("{:.6g}", value);
  };
  const auto number = [](double value) { return std::isfinite(value) ? fmt::format("{:.4g}", value) : "-"; };
  for (std::size_t k = 0; k < model.modes.size(); ++k) {
    const modal::Mode& mode = model.modes[k];
    const modal::ModalStiffness spring = modal::modal_stiffness(model, k);
    io::append(
        out, "{:>4}  {:<18}  {:<16}  {:>14}  {:>8}{}{}\n", k + 1, known(mode.frequency_hz, mode.frequency_std_hz),
        known(100.0 * mode.damping_ratio, 100.0 * mode.damping_ratio_std), number(spring.stiffness_n_per_m * units::um),
        number(spring.mass_kg), mode.weak ? "  weak" : "", bounds_of(static_cast<int>(k) + 1));
  }
}

void add_tip_peaks(std::string& out, const TipPrediction& prediction, const modal::FrfName& frf) {
  const std::string name = modal::to_string(frf);
  bool any = false;
  for (const coupling::TipPeak& peak : prediction.peaks) {
    if (peak.name != frf) continue;
    any = true;
    io::append(out, "{}: peak at {:.6g} Hz, {:.4g} µm/N\n", name, peak.frequency_hz,
               peak.receptance_m_per_n / units::um);
  }
  if (!any) io::append(out, "{}: no peak between the first line and the last\n", name);
}

/// Of an assembly of beams far below its lines; of a measured holder, which has no such lines, at the first.
void add_compliance(std::string& out, const coupling::AssemblyFile& file, const modal::FrfSet& tip,
                    const modal::FrfName& name) {
  const std::string text = modal::to_string(name);
  if (!file.assembly.holder.receptances.frfs.empty()) {
    const double compliance = std::abs(tip.find(name)->receptance(0));
    io::append(out, "{}: {:.4g} µm/N at the first line, {:.6g} Hz\n", text, compliance / units::um,
               tip.frequency_hz(0));
    return;
  }
  const Eigen::VectorXd low = Eigen::VectorXd::Constant(1, 0.01 * tip.frequency_hz(0));
  const double compliance = coupling::tip_frfs(file.assembly, low).frfs.find(name)->receptance(0).real();
  if (file.assembly.holder.free) {
    const double omega = 2.0 * std::numbers::pi * low(0);
    io::append(out, "{}: hangs free, far below its first mode with an effective mass of {:.4g} kg at the tip\n", text,
               -1.0 / (omega * omega * compliance));
    return;
  }
  io::append(out, "{}: static compliance {:.4g} µm/N (stiffness {:.4g} N/µm)\n", text, compliance / units::um,
             units::um / compliance);
}

void add_lines(std::string& out, const char* what, const std::vector<double>& lines_hz) {
  if (lines_hz.empty()) return;
  io::append(out, "{}: {} lines, {:.6g} to {:.6g} Hz\n", what, lines_hz.size(), lines_hz.front(), lines_hz.back());
}

/// What to know of a holder that was found from a measurement.
void add_holder(std::string& out, const coupling::AssemblyFile& file) {
  if (!file.holder) return;
  add_lines(out, "Holder not reliable", file.holder->unreliable_hz);
  io::add_notes(out, file.holder->notes, "Note: ");
}

/// What becomes of a tool in the cut.
std::string cut_text(const decision::ToolResult& tool) {
  if (!tool.recommendation) return tool.no_cut.empty() ? "-" : printable(tool.no_cut);
  if (!tool.recommendation->recommended) return tool.recommendation->reason;
  const decision::Operation& best = *tool.recommendation->recommended;
  return fmt::format("{:>9.0f} {:>9.4g}", best.spindle_speed_rad_per_s / units::rpm, best.axial_depth_m / units::mm);
}

/// An unknown of the joint, its member and its unit.
struct JointRow {
  coupling::JointUnknown unknown;
  double coupling::Joint::*value;
  const char* unit;
};
constexpr std::array<JointRow, coupling::joint_unknowns> joint_rows = {{
    {coupling::JointUnknown::translational_stiffness, &coupling::Joint::translational_stiffness_n_per_m, "N/m"},
    {coupling::JointUnknown::translational_damping, &coupling::Joint::translational_damping_n_s_per_m, "N s/m"},
    {coupling::JointUnknown::rotational_stiffness, &coupling::Joint::rotational_stiffness_n_m_per_rad, "N m/rad"},
    {coupling::JointUnknown::rotational_damping, &coupling::Joint::rotational_damping_n_m_s_per_rad, "N m s/rad"},
}};

}  // namespace

std::string summary(const FrfJobResult& result) {
  std::string out;
  for (const modal::HitVerdict& hit : result.frfs.hits) {
    std::string reasons;
    for (const std::string& reason : hit.reasons) reasons += (reasons.empty() ? "" : "; ") + reason;
    io::append(out, "{:<10} {} {}\n", hit.accepted ? "accepted" : "rejected", printable(hit.file), reasons);
  }
  io::append(out, "\nFRF    grade   coherence  excited band\n");
  for (const modal::FrfGrade& grade : result.frfs.grades) {
    const std::string coherence = grade.mean_coherence >= 0.0 ? fmt::format("{:.3f}", grade.mean_coherence) : "-";
    io::append(out, "{:<6} {:<7} {:>9}  {:.0f} to {:.0f} Hz\n", to_string(grade.name), to_string(grade.grade),
               coherence, grade.excited_low_hz, grade.excited_high_hz);
    for (std::size_t i = 0; i < grade.faults.size(); ++i) {
      io::append(out, "       {}: {}\n", grade.faults[i], i < grade.remedies.size() ? grade.remedies[i] : "");
    }
  }
  add_highest_peaks(out, result.frfs.grades);
  const auto [low_hz, high_hz] = result.frfs.band_hz();
  io::append(out, "\nTrustworthy from {:.4g} Hz.", low_hz);
  if (std::isfinite(high_hz)) io::append(out, " Modes: robomill modes FILE --band {:.0f},{:.0f}", low_hz, high_hz);
  out += "\n";
  io::add_notes(out, result.file.notes, "");
  io::add_notes(out, result.frfs.notes, "");
  return out + assumed_text(result.file.assumed);
}

std::string summary(const ModesResult& result) {
  const modal::FitResult& fit = result.fit;
  std::string out;
  io::add_notes(out, result.measured.notes, "Note: ");
  add_modes(out, fit.model, [&](int mode) {
    std::string bounds;
    for (const modal::FitBound bound : fit.bounds_of(mode)) bounds += fmt::format("  at {}", to_string(bound));
    return bounds;
  });
  io::append(out, "\n{:.4g} to {:.4g} Hz: relative error {:.4g}, mean relative error {:.4g}\n", fit.band_low_hz,
             fit.band_high_hz, fit.relative_error, fit.mean_relative_error);
  io::add_notes(out, fit.warnings, "Warning: ");
  return out + assumed_text(result.measured.assumed);
}

std::string summary(const cell::ModesOfPosture& result) {
  std::string out;
  add_modes(out, result.prediction.modes, [](int) { return std::string(); });
  io::add_notes(out, cell::posture_warnings(result), "Warning: ");
  io::add_notes(out, result.notes, "Note: ");
  return out + assumed_text(result.assumed);
}

std::string summary(const TipPrediction& result) {
  const coupling::AssemblyFile& file = result.file;
  const coupling::TipResult& tip = result.tip;
  const modal::Frf& x = *tip.frfs.find(modal::parse_frf_name("xx"));
  const modal::Frf& y = *tip.frfs.find(modal::parse_frf_name("yy"));
  std::string out;
  add_tip_peaks(out, result, x.name);
  add_compliance(out, file, tip.frfs, x.name);
  if (y.receptance == x.receptance) {
    io::append(out, "yy: the same as xx\n");
  } else {
    add_tip_peaks(out, result, y.name);
    add_compliance(out, file, tip.frfs, y.name);
  }
  add_lines(out, "Suspect", tip.suspect_hz);
  add_holder(out, file);
  io::add_notes(out, file.notes, "Note: ");
  io::add_notes(out, tip.notes, "Note: ");
  return out + assumed_text(file.assumed);
}

std::string summary(const ToolsResult& result) {
  std::string out;
  io::append(out, "{:<20} {:>5} {:>9} {:>9} {:>10} {:>5} {:>10} {:>9} {:>9}\n", "tool", "teeth", "overhang", "peak Hz",
             "µm/N", "modes", "lowest mm", "rpm", "depth mm");
  for (const decision::ToolResult& tool : result.tools) {
    io::append(out, "{:<20} {:>5} {:>9.4g} ", printable(tool.name), tool.teeth, tool.overhang_m / units::mm);
    if (!tool.failure.empty()) {
      io::append(out, "{}\n", printable(tool.failure));
      continue;
    }
    io::append(out, "{:>9.5g} {:>9.4g} {:>5} ", tool.peak_hz, tool.peak_m_per_n / units::um, tool.modes.modes.size());
    const std::string lowest =
        tool.lowest_limit_m ? fmt::format("{:.4g}", *tool.lowest_limit_m / units::mm) : std::string("-");
    io::append(out, "{:>10} {}\n", lowest, cut_text(tool));
  }
  add_holder(out, result.assembly);
  io::add_notes(out, result.assembly.notes, "Note: ");
  std::vector<Assumption> assumed = result.assembly.assumed;
  if (result.cut) add_assumed(assumed, assumed_of(*result.cut, CutUse::stability));
  return out + assumed_text(assumed);
}

std::string summary(const JointResult& result) {
  const coupling::JointFitResult& fit = result.fit;
  std::string out;
  for (std::size_t i = 0; i < joint_rows.size(); ++i) {
    const coupling::JointKnowledge& knowledge = fit.knowledge[i];
    const std::string spread =
        std::isfinite(knowledge.deviation) ? fmt::format(" ± {:.2g}", knowledge.deviation) : std::string();
    io::append(out, "{:<24} {:.6g}{} {}{}\n", to_string(joint_rows[i].unknown), fit.joint.*joint_rows[i].value, spread,
               joint_rows[i].unit, knowledge.identifiable ? "" : "  not identifiable");
  }
  io::append(out, "\n‖|H| - |H model|‖ = {:.6g} m/N, relative error {:.4g}, {} iterations: {}\n", fit.objective_m_per_n,
             fit.relative_error, fit.iterations, name_in(coupling::joint_status_names, fit.status));
  for (const coupling::JointKnowledge& knowledge : fit.knowledge) {
    if (!knowledge.note.empty()) io::append(out, "{}\n", knowledge.note);
  }
  io::add_notes(out, fit.notes, "");
  io::add_notes(out, result.notes, "Note: ");
  return out + assumed_text(result.assumed);
}

std::string summary(const StiffnessResult& result) {
  const robot::IdentifiedStiffness& found = result.found;
  std::string out;
  for (std::size_t i = 0; i < found.joints.size(); ++i) {
    const robot::IdentifiedJoint& joint = found.joints[i];
    const char* unit = result.cell.robot.arm.joints[i].prismatic ? "N/m" : "N m/rad";
    if (joint.identifiable) {
      io::append(out, "joint {}  {:.6g} ± {:.2g} {}\n", i + 1, joint.stiffness, joint.deviation, unit);
    } else {
      io::append(out, "joint {}  not identifiable: {}\n", i + 1, joint.reason);
    }
  }
  io::append(out, "\n{} loads, residual {:.3g} mm (root mean square), R² = {:.6f}, {} iterations\n",
             found.residual_m.cols(), found.rms_m / units::mm, found.r_squared, found.iterations);
  io::add_notes(out, result.cell.notes, "Note: ");
  return out + assumed_text(result.assumed);
}

}  // namespace robomill::jobs
