#include "robomill/plan/test_cuts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/formats/records.hpp"
#include "robomill/signal/spectrum.hpp"

namespace robomill::plan {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;

/// Real spindles stray from their set speed by less than this.
constexpr double speed_error = 2e-4;

struct Offset {
  int mode = 0;  ///< 0: none near enough
  double multiple = 0.0;
  bool above = true;
  double error_hz = 0.0;
};

/// The mode k and multiple n with |n f_rotation ± f_k| nearest to the peak; multiples of tooth passing win ties within
/// the tolerance, then the smallest error.
Offset nearest_mode(double frequency_hz, double rotation_hz, int teeth, const std::vector<double>& modes_hz,
                    double tolerance_hz) {
  Offset best;
  bool best_is_tooth = false;
  for (std::size_t k = 0; k < modes_hz.size(); ++k) {
    for (const bool above : {true, false}) {
      const double shift = above ? modes_hz[k] : -modes_hz[k];
      const double multiple = std::round((frequency_hz - shift) / rotation_hz);
      const double error = std::abs(multiple * rotation_hz + shift - frequency_hz);
      if (multiple < 0.0 || error > tolerance_hz) continue;
      const bool is_tooth = std::fmod(multiple, teeth) == 0.0;
      if (best.mode == 0 || (is_tooth && !best_is_tooth) || (is_tooth == best_is_tooth && error < best.error_hz)) {
        best = {.mode = static_cast<int>(k) + 1, .multiple = multiple, .above = above, .error_hz = error};
        best_is_tooth = is_tooth;
      }
    }
  }
  return best;
}

report::Verdict verdict_of(formats::TestCut::Result result) {
  switch (result) {
    case formats::TestCut::Result::stable:
      return report::Verdict::stable;
    case formats::TestCut::Result::borderline:
      return report::Verdict::borderline;
    case formats::TestCut::Result::chatter:
      return report::Verdict::chatter;
    case formats::TestCut::Result::unknown:
      break;
  }
  return report::Verdict::unknown;
}

std::vector<double> frequencies_of(const modal::ModalModel& model) {
  std::vector<double> out;
  for (const modal::Mode& mode : model.modes) out.push_back(mode.frequency_hz);
  return out;
}

/// Whether a measured peak is the predicted chatter frequency or its image about a multiple of tooth passing.
bool is_image(double peak_hz, double chatter_hz, double tooth_passing_hz) {
  const double tolerance_hz = 0.005 * peak_hz;
  for (const double shift : {chatter_hz, -chatter_hz}) {
    const double turns = (peak_hz - shift) / tooth_passing_hz;
    if (std::abs(turns - std::round(turns)) * tooth_passing_hz <= tolerance_hz) return true;
  }
  return false;
}

std::string note_on(const formats::TestCut& cut, const stability::PointResult& point, int teeth,
                    const std::vector<double>& modes_hz) {
  std::string note = std::isfinite(point.spectral_radius) ? fmt::format("predicted |μ| = {:.3f}", point.spectral_radius)
                                                          : std::string("predicted by the limit");
  if (!point.stable) note += fmt::format(", {:.1f} Hz (mode {})", point.chatter_frequency_hz, point.mode);
  if (cut.peaks_hz.empty()) return note;
  note += "; measured";
  bool any_chatter = false;
  bool frequency_agrees = false;
  const double tooth_passing_hz = cut.spindle_speed_rad_per_s / two_pi * teeth;
  for (std::size_t i = 0; i < cut.peaks_hz.size(); ++i) {
    const report::Peak peak = explain_peak(cut.peaks_hz[i], 0.0, cut.spindle_speed_rad_per_s, teeth, modes_hz, 1.0);
    note += fmt::format("{} {:.1f} Hz = {}", i == 0 ? "" : ",", peak.frequency_hz, peak.text);
    if (peak.kind == report::PeakKind::chatter || peak.kind == report::PeakKind::other) {
      any_chatter = true;
      frequency_agrees = frequency_agrees || is_image(peak.frequency_hz, point.chatter_frequency_hz, tooth_passing_hz);
    }
  }
  if (any_chatter && !point.stable) {
    note += frequency_agrees ? "; the chatter frequency agrees" : "; the chatter frequency does not agree";
  }
  return note;
}

}  // namespace

report::Peak explain_peak(double frequency_hz, double amplitude, double spindle_speed_rad_per_s, int teeth,
                          const std::vector<double>& modes_hz, double tolerance_hz) {
  report::Peak peak{.frequency_hz = frequency_hz,
                    .amplitude = amplitude,
                    .kind = report::PeakKind::other,
                    .text = "no multiple of rotation"};
  const double rotation_hz = spindle_speed_rad_per_s / two_pi;
  const double multiple = std::round(frequency_hz / rotation_hz);
  const double tolerance = std::max(tolerance_hz, speed_error * frequency_hz);
  if (multiple >= 1.0 && std::abs(frequency_hz - multiple * rotation_hz) <= tolerance) {
    const bool tooth_passing = std::fmod(multiple, teeth) == 0.0;
    peak.kind = tooth_passing ? report::PeakKind::tooth_passing : report::PeakKind::rotation;
    peak.text = tooth_passing ? fmt::format("{:.0f} × tooth passing", multiple / teeth)
                              : fmt::format("{:.0f} × rotation", multiple);
    return peak;
  }
  const Offset offset = nearest_mode(frequency_hz, rotation_hz, teeth, modes_hz, tolerance);
  if (offset.mode > 0) {
    peak.kind = report::PeakKind::chatter;
    peak.text = offset.multiple == 0.0 ? fmt::format("mode {}", offset.mode)
                                       : fmt::format("{:.0f} × rotation {} mode {}", offset.multiple,
                                                     offset.above ? "+" : "−", offset.mode);
  }
  return peak;
}

std::vector<report::TestCut> compare_cuts(const std::vector<formats::TestCut>& cuts,
                                          const stability::LobesProblem& problem,
                                          const stability::LobesOptions& options, Progress& progress) {
  const std::vector<double> modes_hz = frequencies_of(problem.dynamics);
  const int teeth = problem.milling.tool.teeth;
  std::vector<report::TestCut> out(cuts.size());
  progress.start("test cuts", cuts.size());
  parallel_for(cuts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const formats::TestCut& cut = cuts[i];
      const stability::PointResult point = stability::evaluate_point(
          problem, options,
          {.spindle_speed_rad_per_s = cut.spindle_speed_rad_per_s, .axial_depth_m = cut.axial_depth_m});
      const stability::Limit limit = stability::limit_depths(problem, options, {cut.spindle_speed_rad_per_s}).front();
      report::TestCut& row = out[i];
      row.spindle_speed_rad_per_s = cut.spindle_speed_rad_per_s;
      row.axial_depth_m = cut.axial_depth_m;
      row.result = verdict_of(cut.result);
      row.predicted = point.stable ? report::Verdict::stable : report::Verdict::chatter;
      if (limit.status == stability::Limit::Status::found) row.limit_depth_m = limit.axial_depth_m;
      if (row.result == report::Verdict::borderline) {
        row.agrees = std::abs(row.limit_depth_m / cut.axial_depth_m - 1.0) <= 0.2;
      } else if (row.result != report::Verdict::unknown) {
        row.agrees = row.result == row.predicted;
      }
      row.note = note_on(cut, point, teeth, modes_hz);
      progress.advance();
    }
  });
  return out;
}

report::Recording read_recording(const formats::TestCut& cut, int teeth, const std::vector<double>& modes_hz) {
  const formats::Record record = formats::read_record(cut.file, {.scale = cut.scale});
  const Eigen::VectorXd signal = record.column(cut.column);
  const double rate_hz = record.sample_rate_hz > 0.0 ? record.sample_rate_hz : cut.sample_rate_hz;
  if (!(rate_hz > 0.0)) {
    throw InvalidInput(cut.file.string(), "has no time column", "Give sample_rate_hz beside the file in [[cuts]]");
  }
  const double length_s = static_cast<double>(signal.size()) / rate_hz;
  if (length_s < 0.2) throw InvalidInput(cut.file.string(), length_s, "s", "must be at least 0.2 s of cutting");

  report::Recording out;
  out.file = cut.file.filename().string();
  out.spindle_speed_rad_per_s = cut.spindle_speed_rad_per_s;
  out.teeth = teeth;
  out.axial_depth_m = cut.axial_depth_m;
  const signal::Spectrum spectrum = signal::amplitude_spectrum(signal, rate_hz);
  out.frequency_hz = spectrum.frequency_hz;
  out.amplitude = spectrum.amplitude;
  signal::PeakOptions wanted;
  wanted.count = 20;
  wanted.min_frequency_hz = 0.5 * cut.spindle_speed_rad_per_s / two_pi;
  wanted.min_separation_hz = 4.0 / length_s;
  double highest_multiple = 0.0;
  double highest_other = 0.0;
  double chatter_hz = 0.0;
  for (const signal::SpectralPeak& found : signal::find_peaks(spectrum, wanted)) {
    out.peaks.push_back(explain_peak(found.frequency_hz, found.amplitude, cut.spindle_speed_rad_per_s, teeth, modes_hz,
                                     2.0 / length_s));
    const report::Peak& peak = out.peaks.back();
    const bool multiple = peak.kind == report::PeakKind::rotation || peak.kind == report::PeakKind::tooth_passing;
    double& highest = multiple ? highest_multiple : highest_other;
    if (!multiple && peak.amplitude > highest) chatter_hz = peak.frequency_hz;
    highest = std::max(highest, peak.amplitude);
  }
  const double ratio = highest_multiple > 0.0 ? highest_other / highest_multiple : 0.0;
  const bool only_other = highest_multiple == 0.0 && highest_other > 0.0;
  out.verdict = only_other || ratio >= 0.5 ? report::Verdict::chatter
                : ratio >= 0.25            ? report::Verdict::borderline
                                           : report::Verdict::stable;
  out.reason = highest_other == 0.0 ? "every peak is a multiple of the rotation"
               : only_other         ? fmt::format("{:.1f} Hz, and no multiple of the rotation", chatter_hz)
                            : fmt::format("{:.1f} Hz is {:.2f} times as high as the highest multiple of the rotation",
                                          chatter_hz, ratio);
  return out;
}

}  // namespace robomill::plan
