#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "robomill/base/printable.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/note_lines.hpp"
#include "robomill/io/system/append.hpp"
#include "robomill/jobs/coefficients.hpp"
#include "robomill/jobs/explain.hpp"
#include "robomill/jobs/files/assumed.hpp"
#include "robomill/jobs/lobes.hpp"
#include "robomill/jobs/outputs.hpp"
#include "robomill/jobs/postures.hpp"
#include "robomill/jobs/simulate.hpp"

// A cut: its stability, its vibration, its coefficients.

namespace robomill::jobs {
namespace {

void add_points(std::string& out, const std::vector<stability::PointResult>& points) {
  for (const stability::PointResult& point : points) {
    io::append(out, "{:.6g} rpm, {:.4g} mm: ", point.spindle_speed_rad_per_s / units::rpm,
               point.axial_depth_m / units::mm);
    if (std::isfinite(point.spectral_radius)) {
      io::append(out, "|μ| = {:.6g} ± {:.1g}, ", point.spectral_radius, point.error_estimate);
    }
    io::append(out, "{}", point.stable ? "stable" : "chatter");
    if (!std::isnan(point.gain_margin)) io::append(out, ", gain margin {:.4g}", point.gain_margin);
    if (!point.stable) {
      io::append(out, " at {:.1f} Hz ({}, {})", point.chatter_frequency_hz, to_string(point.mode),
                 to_string(point.kind));
    }
    io::append(out, "\n");
  }
}

void add_lowest_limit(std::string& out, const stability::LobesResult& result) {
  const stability::Limit* lowest = nullptr;
  for (const stability::Limit& limit : result.limit) {
    if (limit.status != stability::Limit::Status::found) continue;
    if (lowest == nullptr || limit.axial_depth_m < lowest->axial_depth_m) lowest = &limit;
  }
  if (lowest == nullptr) {
    io::append(out, "No chatter in the whole range.\n");
    return;
  }
  io::append(out, "Stable at every speed up to {:.4g} mm; above that chatter at {:.6g} rpm and {:.1f} Hz ({}).\n",
             lowest->axial_depth_m / units::mm, lowest->spindle_speed_rad_per_s / units::rpm,
             lowest->chatter_frequency_hz, to_string(lowest->mode));
}

void add_surface(std::string& out, const stability::SurfaceMap& surface) {
  double least = std::numeric_limits<double>::infinity();
  double most = -least;
  for (const double error : surface.surface_location_error_m.reshaped()) {
    if (!std::isfinite(error)) continue;
    least = std::min(least, error);
    most = std::max(most, error);
  }
  if (most < least) return;
  io::append(out, "Surface error of the stable cuts from {:.3g} to {:.3g} µm (positive: material left).\n",
             least / units::um, most / units::um);
}

void add_chart(std::string& out, const stability::LobesResult& result, const stability::SurfaceMap& surface) {
  add_points(out, result.points);
  add_lowest_limit(out, result);
  io::append(out, "{} points of the chart in {:.2f} s, {}.\n", result.evaluations, result.seconds,
             to_string(result.method));
  add_surface(out, surface);
  if (result.uncertain > 0) {
    io::append(out, "{} points are less accurate than the tolerance; their error_estimate says how much.\n",
               result.uncertain);
  }
}

void add_sweep(std::string& out, const stability::SweepResult& sweep) {
  const bool angle = stability::is_angle(sweep.parameter);
  const double unit = angle ? units::deg : units::mm;
  const char* const name = angle ? "degrees" : "mm";
  const std::string_view what = name_in(stability::swept_names, sweep.parameter);
  for (const stability::PointResult& point : sweep.points) {
    io::append(out, "{:.6g} rpm, {} {:.4g} {}: |μ| = {:.6g} ± {:.1g}, {}, gain margin {:.4g}\n",
               point.spindle_speed_rad_per_s / units::rpm, what, point.axial_depth_m / unit, name,
               point.spectral_radius, point.error_estimate, point.stable ? "stable" : "chatter", point.gain_margin);
  }
  for (std::size_t s = 0; s < sweep.stable.size(); ++s) {
    io::append(out, "{:.6g} rpm: ", sweep.spindle_speed_rad_per_s(static_cast<Eigen::Index>(s)) / units::rpm);
    if (sweep.stable[s].empty()) io::append(out, "stable at no {}", what);
    for (std::size_t i = 0; i < sweep.stable[s].size(); ++i) {
      const stability::StableInterval& interval = sweep.stable[s][i];
      io::append(out, "{}{:.4g} to {:.4g}", i == 0 ? "stable from " : ", ", interval.from / unit, interval.to / unit);
    }
    io::append(out, "{}\n", sweep.stable[s].empty() ? "" : std::string(" ") + name);
  }
  io::append(out, "{} points of the chart in {:.2f} s.\n", sweep.evaluations, sweep.seconds);
  if (sweep.uncertain > 0) io::append(out, "{} points are less accurate than the tolerance.\n", sweep.uncertain);
}

std::string percent_of(double share) {
  return std::isfinite(share) ? fmt::format("{:.2g} %", 100.0 * share) : "-";
}

/// Every method beside the first: a row each.
void add_comparison(std::string& out, const stability::MethodComparison& comparison) {
  io::append(out, "{:<34}{:>14}{:>14}{:>14}{:>8}{:>10}\n", "method", "lowest limit", "median error", "worst error",
             "differ", "seconds");
  for (const stability::MethodRow& row : comparison.rows) {
    if (!row.rejection.empty()) {
      io::append(out, "{:<34}{}\n", to_string(row.method), row.rejection);
      continue;
    }
    std::string lowest = "none";
    double least_m = std::numeric_limits<double>::infinity();
    for (const stability::Limit& limit : row.limits) {
      if (limit.status == stability::Limit::Status::found) least_m = std::min(least_m, limit.axial_depth_m);
    }
    if (std::isfinite(least_m)) lowest = fmt::format("{:.4g} mm", least_m / units::mm);
    io::append(out, "{:<34}{:>14}{:>14}{:>14}{:>8}{:>10.3f}\n", to_string(row.method), lowest,
               percent_of(row.median_error), percent_of(row.worst_error), row.differ, row.seconds);
  }
  io::append(
      out,
      "Limits at {} speeds; errors are against the first row, differ counts speeds at which only one has a limit.\n",
      comparison.spindle_speed_rad_per_s.size());
}

using Reading = stability::Explanation::Kind;

/// A reading with frequencies, difference and tolerance; the short one of a report is Peak::text.
std::string full_reading(const stability::Explanation& e, int teeth) {
  switch (e.kind) {
    case Reading::tooth_passing:
      return fmt::format("tooth passing x {} ({:+.2f} Hz)", e.harmonic / teeth, e.difference_hz);
    case Reading::rotation:
      return fmt::format("rotation x {} ({:+.2f} Hz)", e.harmonic, e.difference_hz);
    case Reading::chatter: {
      const std::string name = fmt::format("{} at {:.2f} Hz", to_string(e.mode), e.mode_frequency_hz);
      const std::string turns = e.of_tooth_passing ? fmt::format("tooth passing x {}", std::abs(e.harmonic) / teeth)
                                                   : fmt::format("rotation x {}", std::abs(e.harmonic));
      const std::string tail = fmt::format(" ({:+.2f} Hz, within {:.2f})", e.difference_hz, e.tolerance_hz);
      if (e.harmonic == 0) return fmt::format("chatter: {}{}", name, tail);
      if (e.harmonic > 0) return fmt::format("chatter: {} + {}{}", name, turns, tail);
      return fmt::format("chatter: {}{}",
                         e.mirrored ? fmt::format("{} - {}", turns, name) : fmt::format("{} - {}", name, turns), tail);
    }
    case Reading::cut_or_chatter:
    case Reading::unexplained:
      break;
  }
  return "unexplained";
}

/// What is known of a peak whose best readings are about as good as each other.
const char* undecided(Reading kind) {
  return kind == Reading::chatter ? "chatter of an unidentified mode" : "ambiguous: the cut, or chatter";
}

void add_peak(std::string& out, const stability::ExplainedPeak& peak, int teeth) {
  const bool named = peak.state != stability::ExplainedPeak::State::ambiguous;
  io::append(out, "{:>10.2f} Hz  {}\n", peak.frequency_hz,
             named ? full_reading(peak.best, teeth) : undecided(peak.best.kind));
  for (const stability::Explanation& other : peak.others) {
    const double odds = other.likelihood_per_hz / (named ? peak.best : peak.others.front()).likelihood_per_hz;
    io::append(out, "               or {}, relative likelihood {:.2g}\n", full_reading(other, teeth), odds);
  }
}

void add_fit(std::string& out, const std::filesystem::path& frf, const std::optional<modal::FitResult>& fit) {
  if (!fit) return;
  io::append(out, "{}: {} modes fitted, {:.2g} % of the FRFs left over.\n", printable(frf.filename().string()),
             fit->model.modes.size(), 100.0 * fit->relative_error);
}

void add_small(std::string& out, const simulation::SmallVibration& small) {
  using Status = simulation::SmallVibration::Status;
  switch (small.status) {
    case Status::found:
      io::append(out, "Small vibration {} by |μ| = {:.5f} ± {:.0e} in each period of {:.4g} ms.\n",
                 small.spectral_radius < 1.0 ? "dies out" : "grows", small.spectral_radius, small.error_estimate,
                 small.period_s / units::ms);
      return;
    case Status::not_converged:
      io::append(out, "The multiplier of small vibration did not converge.\n");
      return;
    case Status::not_periodic:
      io::append(out, "The swing of the speed repeats in no 50 revolutions: no multiplier.\n");
      return;
    case Status::rigid:
      io::append(out, "Nothing can vibrate.\n");
  }
}

void add_motion(std::string& out, const simulation::Simulation& s) {
  if (s.force_n.rows() > 0) {
    io::append(
        out,
        "Forces up to {:.4g}, {:.4g}, {:.4g} N in x, y, z; edges between entry and exit touch nothing in {:.1f} % of "
        "the time.\n",
        s.force_n.col(0).cwiseAbs().maxCoeff(), s.force_n.col(1).cwiseAbs().maxCoeff(),
        s.force_n.col(2).cwiseAbs().maxCoeff(), 100.0 * s.missed_share);
  }
  for (const simulation::Wall& wall : s.walls) {
    io::append(
        out,
        "Wall where teeth {}: {:.3g} µm too {} (from {:.3g} to {:.3g} over the height), Ra {:.3g}, Rz {:.3g} µm.\n",
        wall.angle_rad < 1.0 ? "enter" : "leave", std::abs(wall.location_error_m) / units::um,
        wall.location_error_m > 0.0 ? "shallow" : "deep", wall.least_location_error_m / units::um,
        wall.greatest_location_error_m / units::um, wall.ra_m / units::um, wall.rz_m / units::um);
  }
  if (s.diverged) {
    io::append(out, "Without loss of contact the motion grew beyond a metre; the columns end there.\n");
  }
  io::append(out, "{} samples, {} steps a revolution, {} slice{}, estimated error {:.1g}{}, in {:.2f} s.\n",
             s.force_n.rows(), s.steps_per_revolution, s.slices, s.slices == 1 ? "" : "s", s.error_estimate,
             s.resolved ? "" : " (above tolerance)", s.seconds);
}

std::string with_spread(double value, double deviation) {
  return std::isfinite(deviation) ? fmt::format("{:.6g} ± {:.2g}", value, deviation) : fmt::format("{:.6g}", value);
}

void add_pair(std::string& out, const char* name, const cutting::CoefficientPair& pair, bool edge_known) {
  const std::string cutting =
      with_spread(pair.cutting_n_per_m2 / units::n_per_mm2, pair.cutting_deviation_n_per_m2 / units::n_per_mm2);
  const std::string edge =
      edge_known ? with_spread(pair.edge_n_per_m / units::n_per_mm, pair.edge_deviation_n_per_m / units::n_per_mm)
                 : "not stated";
  io::append(out, "{:<12} {:>22} {:>22}", name, cutting, edge);
  if (std::isfinite(pair.r_squared)) io::append(out, "   R² {:.6f}", pair.r_squared);
  io::append(out, "\n");
}

/// "1234 ± 5 κ, 12 ± 1": a polynomial in κ, highest power first.
std::string polynomial_text(const std::vector<double>& values, const std::vector<double>& deviations, double unit) {
  std::string out;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t power = values.size() - 1 - i;
    out += (i == 0 ? "" : ", ") + with_spread(values[i] / unit, deviations[i] / unit);
    if (power > 0) out += power == 1 ? " κ" : fmt::format(" κ^{}", power);
  }
  return out;
}

}  // namespace

std::string summary(const LobesJobResult& result) {
  std::string out;
  if (result.sweep) {
    add_sweep(out, *result.sweep);
  } else if (result.comparison) {
    add_comparison(out, *result.comparison);
  } else {
    add_chart(out, result.lobes, result.surface);
  }
  io::add_notes(out, result.cut.notes, "Note: ");
  const bool surface = result.surface.axial_depth_m.size() > 0;
  return out + assumed_text(assumed_of(result.cut, surface ? CutUse::motion : CutUse::stability));
}

std::string summary(const PosturesResult& result) {
  std::string out;
  io::append(out, "{:<8}{:>28}{:>10}{:>16}{:>12}\n", "posture", "tip x, y, z (mm)", "γ (°)", "lowest limit", "at");
  for (const PostureLimits& row : result.postures) {
    const stability::Limit* least = nullptr;
    for (const stability::Limit& limit : row.limits) {
      if (limit.status != stability::Limit::Status::found) continue;
      if (least == nullptr || limit.axial_depth_m < least->axial_depth_m) least = &limit;
    }
    const Eigen::Vector3d tip_mm = row.pose.tip_m / units::mm;
    const std::string tip = fmt::format("{:.0f}, {:.0f}, {:.0f}", tip_mm.x(), tip_mm.y(), tip_mm.z());
    io::append(out, "{:<8}{:>28}{:>10.1f}", row.number, tip, row.pose.gamma_rad / units::deg);
    if (least == nullptr) {
      io::append(out, "{:>16}\n", "none");
    } else {
      io::append(out, "{:>13.4g} mm{:>8.0f} rpm\n", least->axial_depth_m / units::mm,
                 least->spindle_speed_rad_per_s / units::rpm);
    }
  }
  for (const PostureDirection& direction : result.directions) {
    io::append(out, "Along {}: postures {}, ", direction.name, fmt::join(direction.postures, ", "));
    if (direction.speeds == 0) {
      io::append(out, "which have a limit in common at no speed.\n");
    } else {
      io::append(out, "limits {} apart (mean over {} of {} speeds).\n", percent_of(direction.spread), direction.speeds,
                 result.spindle_speed_rad_per_s.size());
    }
  }
  if (result.directions.empty()) io::append(out, "No two postures differ in one direction alone.\n");
  io::add_notes(out, result.cut.notes, "Note: ");
  return out + assumed_text(assumed_of(result.cut, CutUse::stability));
}

std::string summary(const ExplainResult& result) {
  const stability::PeakClassification& found = result.peaks;
  std::string out;
  io::append(out, "spindle {:.1f} rpm{}\n", found.spindle_speed_rad_per_s / units::rpm,
             found.speed_from_peaks ? ", from the peaks that are multiples of rotation" : ", as given");
  for (const stability::ExplainedPeak& peak : found.peaks) add_peak(out, peak, result.teeth);
  switch (found.state) {
    case stability::PeakClassification::State::named:
      io::append(out, "Chatter of {} at {:.2f} Hz.\n", to_string(found.mode), found.chatter_frequency_hz);
      break;
    case stability::PeakClassification::State::ambiguous:
      io::append(out, "These peaks do not determine which mode chatters, if any.\n");
      break;
    case stability::PeakClassification::State::no_chatter:
      io::append(out, "No peak is chatter of a known mode.\n");
      break;
  }
  io::add_notes(out, result.notes, "Note: ");
  if (!result.mechanism) {
    io::append(out, "Whether it is regenerative depends on the cut: give --lobes and --at.\n");
    return out;
  }
  io::append(out, "The cut: {} (|μ| = {:.5g}, without the delay {:.5g}).\n", to_string(result.mechanism->kind),
             result.mechanism->spectral_radius, result.mechanism->without_delay);
  io::add_notes(out, result.cut->notes, "Note: ");
  return out + assumed_text(assumed_of(*result.cut, CutUse::stability));
}

std::string summary(const SimulateResult& result) {
  const simulation::Simulation& s = result.simulation;
  std::string out;
  io::add_notes(out, result.cut.notes, "Note: ");
  add_fit(out, result.cut.frf, result.fit);
  add_fit(out, result.cut.workpiece_frf, result.workpiece_fit);
  io::append(out, "{:.6g} rpm, {:.4g} mm: {}{}", result.point.spindle_speed_rad_per_s / units::rpm,
             result.point.axial_depth_m / units::mm, to_string(s.verdict),
             s.verdict == simulation::Verdict::undecided ? ": simulate for longer" : "");
  if (s.chatter_frequency_hz > 0.0) {
    io::append(out, " at {:.1f} Hz, {:.3g} µm", s.chatter_frequency_hz, s.chatter_amplitude_m / units::um);
  }
  io::append(out, ".\n");
  add_small(out, s.small);
  add_motion(out, s);
  return out + assumed_text(assumed_of(result.cut, CutUse::motion));
}

std::string summary(const CoefficientsResult& result) {
  const cutting::SlotFit& fit = result.fit;
  const bool edge_known = fit.status == cutting::SlotFit::Status::identified;
  std::string out;
  io::append(out, "{:<12} {:>22} {:>22}\n", fmt::format("{} slots", result.file.slots.size()), "cutting, N/mm²",
             "edge, N/mm");
  add_pair(out, "tangential", fit.tangential, edge_known);
  add_pair(out, "radial", fit.radial, edge_known);
  add_pair(out, "axial", fit.axial, edge_known);
  Eigen::Index worst = 0;
  const double residual_n = fit.residual_n.colwise().norm().maxCoeff(&worst);
  io::append(out, "largest residual {:.3g} N, line {}\n", residual_n,
             result.file.lines[static_cast<std::size_t>(worst)]);
  if (fit.depends_on_speed) {
    for (const cutting::SpeedGroup& group : fit.by_speed) {
      io::append(out, "{:.6g} rpm, {} slots: tangential {}, radial {} N/mm²\n",
                 group.spindle_speed_rad_per_s / units::rpm, group.rows,
                 with_spread(group.tangential.cutting_n_per_m2 / units::n_per_mm2,
                             group.tangential.cutting_deviation_n_per_m2 / units::n_per_mm2),
                 with_spread(group.radial.cutting_n_per_m2 / units::n_per_mm2,
                             group.radial.cutting_deviation_n_per_m2 / units::n_per_mm2));
    }
  }
  io::add_notes(out, result.file.notes, "Note: ");
  io::add_notes(out, fit.notes, "");
  return out + assumed_text(result.assumed);
}

std::string summary(const SignalCoefficientsResult& result) {
  const cutting::SignalFit& fit = result.fit;
  const cutting::MillingCoefficients &found = fit.coefficients, &std = fit.deviations;
  std::string out;
  const auto add = [&out](const char* name, const std::vector<double>& values, const std::vector<double>& deviations,
                          double unit, const char* text) {
    io::append(out, "{:<17} {} {}\n", name, polynomial_text(values, deviations, unit), text);
  };
  add("tangential", found.tangential_n_per_m2, std.tangential_n_per_m2, units::n_per_mm2, "N/mm²");
  add("radial", found.radial_n_per_m2, std.radial_n_per_m2, units::n_per_mm2, "N/mm²");
  add("axial", found.axial_n_per_m2, std.axial_n_per_m2, units::n_per_mm2, "N/mm²");
  add("tangential, edge", found.tangential_edge_n_per_m, std.tangential_edge_n_per_m, units::n_per_mm, "N/mm");
  add("radial, edge", found.radial_edge_n_per_m, std.radial_edge_n_per_m, units::n_per_mm, "N/mm");
  add("axial, edge", found.axial_edge_n_per_m, std.axial_edge_n_per_m, units::n_per_mm, "N/mm");
  io::append(out, "R² {:.4f}, {:.4f}, {:.4f} in x, y, z; {:.3g} N are left about the fit\n", fit.r_squared.x(),
             fit.r_squared.y(), fit.r_squared.z(), fit.noise_n);
  io::add_notes(out, fit.notes, "");
  if (result.forces.revolution) {
    out += process::summary(result.forces);
  } else {
    io::add_notes(out, result.forces.warnings, "warning      ");
    io::add_notes(out, result.forces.notes, "note         ");
  }
  return out + assumed_text(result.assumed);
}

}  // namespace robomill::jobs
