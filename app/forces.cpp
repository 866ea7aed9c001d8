#include "robomill/jobs/forces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/file.hpp"
#include "robomill/report/report.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

void print_vector(const char* label, const Eigen::Vector3d& v) {
  fmt::print("{:<12} {:>10.4g} {:>10.4g} {:>10.4g} N\n", label, v.x(), v.y(), v.z());
}

void print_vibration(const simulation::Simulation& vibration) {
  const char* const verdict = vibration.verdict == simulation::Verdict::stable    ? "stable"
                              : vibration.verdict == simulation::Verdict::chatter ? "chatter"
                                                                                  : "undecided";
  fmt::print("vibration    {}", verdict);
  if (vibration.chatter_frequency_hz > 0.0) {
    fmt::print(" at {:.1f} Hz, {:.3g} µm", vibration.chatter_frequency_hz, vibration.chatter_amplitude_m / units::um);
  }
  if (vibration.small.status == simulation::SmallVibration::Status::found) {
    fmt::print(", |μ| = {:.4f}", vibration.small.spectral_radius);
  }
  fmt::print("\n");
}

void print_revolution(const jobs::RevolutionForces& revolution, bool on_workpiece) {
  const double sign = on_workpiece ? -1.0 : 1.0;
  const cutting::CuttingForce& force = revolution.settled.force;
  fmt::print("{:<12} {:>10} {:>10} {:>10}   on the {}, feed frame\n", "", "x", "y", "z",
             on_workpiece ? "workpiece" : "tool");
  print_vector("mean", sign * force.mean_n);
  print_vector("peak", sign * force.peak_n);
  print_vector("rms", force.rms_n);
  fmt::print("torque       mean {:.4g}, peak {:.4g} N·m\n", force.mean_torque_n_m, force.peak_torque_n_m);
  fmt::print("power        mean {:.4g} W; removal {:.4g} mm³/s\n", force.power_w,
             force.removal_rate_m3_per_s / units::mm3);
  if (revolution.posture) {
    const Eigen::Vector3d q = revolution.settled.deflection_m / units::um;
    fmt::print("deflection   {:.4g}, {:.4g}, {:.4g} µm under the mean force; depth left {:.6g} mm\n", q.x(), q.y(),
               q.z(), revolution.settled.cut.axial_depth_m / units::mm);
  }
  if (revolution.spindle_rotation && revolution.spindle_rotation->status == robot::Redundancy::Status::found) {
    fmt::print("best γ       {:.1f}°: {:.4g} µm\n", revolution.spindle_rotation->best.gamma_rad / units::deg,
               revolution.spindle_rotation->best.error_m.norm() / units::um);
  }
  if (revolution.vibration) print_vibration(*revolution.vibration);
}

/// One block with its largest values.
void print_row(const jobs::ProgramForces& program, const char* label, const jobs::BlockResult& row) {
  const bool bends = row.joints.size() > 0;
  fmt::print("{:<12} {:>6} {:>10.4g} {:>10.3g} {:>10.4g} {:>10.4g} {:>10} {:>10.3g}\n", label,
             program.program.blocks[row.force.block].line, row.force.peak_force_n, row.force.revolution_torque_n_m,
             row.force.peak_power_w, row.force.sustained_power_w,
             bends ? fmt::format("{:.4g}", row.peak_deflection_m.norm() / units::um) : "–",
             row.force.axial_depth_m / units::mm);
}

void print_program(const jobs::ProgramForces& program, double power_time_s) {
  const auto highest = [&](auto value) {
    return *std::ranges::max_element(program.blocks, {}, [&](const jobs::BlockResult& row) { return value(row); });
  };
  fmt::print("{} blocks, {} of them cut; {:.4g} mm³ removed; {:.2f} s\n", program.blocks.size(),
             program.cutting_blocks(), program.removed_volume_m3 / units::mm3, program.seconds);
  if (program.stock) fmt::print("stock        {}\n", jobs::stock_text(program));
  fmt::print("{:<12} {:>6} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10}\n", "the block of", "line", "force N", "torque Nm",
             "power W", "power W", "bends µm", "depth mm");
  fmt::print("{:<12} {:>6} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10}\n", "", "", "peak", "1 turn", "1 turn",
             fmt::format("{:.4g} s", power_time_s), "1 turn", "");
  print_row(program, "most force", highest([](const jobs::BlockResult& r) { return r.force.peak_force_n; }));
  print_row(program, "most torque", highest([](const jobs::BlockResult& r) { return r.force.revolution_torque_n_m; }));
  print_row(program, "most power", highest([](const jobs::BlockResult& r) { return r.force.sustained_power_w; }));
  if (program.blocks.front().joints.size() == 0) return;
  print_row(program, "most bend", highest([](const jobs::BlockResult& r) { return r.peak_deflection_m.norm(); }));
}

void write_report(const std::filesystem::path& path, const jobs::ForcesResult& result) {
  report::Report page;
  page.title = "Cutting forces";
  page.forces = jobs::forces_report(result);
  const bool html = path.extension() == ".html";
  io::write_file(path, html ? report::report_html(page) : report::report_json(page));
}

bool reached(const jobs::ForcesResult& result) {
  if (!result.revolution) return true;
  const jobs::RevolutionForces& revolution = *result.revolution;
  if (revolution.settled.status != cutting::SettledCut::Status::found) return false;
  return !revolution.vibration || revolution.vibration->verdict != simulation::Verdict::undecided;
}

}  // namespace

Exit run(const ForcesCommand& command, const Common& common, Progress& progress) {
  if (!common.output.empty() && !common.to_stdout()) {
    const io::Format format = io::format_of(common.output);
    if (format != io::Format::csv && format != io::Format::json) {
      throw InvalidInput(common.output, "forces are written as .csv or .json");
    }
  }
  if (!command.report.empty() && command.report.extension() != ".html" && command.report.extension() != ".json") {
    throw InvalidInput(command.report.string(), "a report is written as .html or .json");
  }
  const jobs::ForcesResult result = jobs::run_forces(command.input, command.program, command.cell, progress);
  if (common.to_stdout()) {
    fmt::print("{}", jobs::forces_json(result));
  } else if (!common.output.empty()) {
    const bool csv = io::format_of(common.output) == io::Format::csv;
    io::write_file(common.output, csv ? jobs::forces_csv(result) : jobs::forces_json(result));
  }
  if (!command.report.empty()) write_report(command.report, result);
  if (common.wants_summary()) {
    if (result.revolution) print_revolution(*result.revolution, result.file.on_workpiece);
    if (result.program) print_program(*result.program, result.file.power_time_s);
    print_notes(result.warnings, "warning      ");
    print_notes(result.notes, "note         ");
  }
  return reached(result) ? done : not_reached;
}

}  // namespace robomill::app
