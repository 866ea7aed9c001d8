#include "robomill/decision/test_cuts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/base/units.hpp"
#include "robomill/signal/spectrum.hpp"
#include "robomill/stability/peak_classification.hpp"

namespace robomill::decision {
namespace {

/// A reading in short: "2 × tooth passing", "9 × rotation + mode 1", "mode 7 − 1 × rotation".
std::string short_reading(const stability::Explanation& e, int teeth) {
  using Kind = stability::Explanation::Kind;
  const int turns = std::abs(e.harmonic);
  if (e.kind == Kind::tooth_passing) return fmt::format("{} × tooth passing", turns / teeth);
  std::string multiple = fmt::format("{} × rotation", turns);
  if (e.kind == Kind::rotation) return multiple;
  std::string mode = to_string(e.mode);
  if (turns == 0) return mode;
  if (e.harmonic > 0) return multiple + " + " + mode;
  return e.mirrored ? multiple + " − " + mode : mode + " − " + multiple;
}

std::string peak_text(const stability::ExplainedPeak& peak, int teeth) {
  switch (peak.state) {
    case stability::ExplainedPeak::State::named:
      return short_reading(peak.best, teeth);
    case stability::ExplainedPeak::State::ambiguous: {
      std::string out;
      const double least = peak.others.front().likelihood_per_hz / stability::PeakClassificationOptions{}.clear_odds;
      for (const stability::Explanation& reading : peak.others) {
        if (reading.likelihood_per_hz >= least) out += (out.empty() ? "" : " or ") + short_reading(reading, teeth);
      }
      return out + ": ambiguous";
    }
    case stability::ExplainedPeak::State::unexplained:
      break;
  }
  return "no multiple of rotation";
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

std::string note_on(const TestCut& cut, const stability::PointResult& point, const stability::LobesProblem& problem) {
  std::string note = std::isfinite(point.spectral_radius) ? fmt::format("predicted |μ| = {:.3f}", point.spectral_radius)
                                                          : std::string("predicted by the limit");
  if (!point.stable) note += fmt::format(", {:.1f} Hz ({})", point.chatter_frequency_hz, to_string(point.mode));
  if (cut.peaks_hz.empty()) return note;
  note += "; measured ";
  bool any_chatter = false;
  bool frequency_agrees = false;
  const double tooth_passing_hz = cut.spindle_speed_rad_per_s / units::revolution * problem.milling.tool.teeth;
  std::string separator;
  for (const Peak& peak : name_peaks(cut.peaks_hz, cut.spindle_speed_rad_per_s, problem, 1.0)) {
    note += fmt::format("{}{:.1f} Hz = {}", std::exchange(separator, ", "), peak.frequency_hz, peak.text);
    if (peak.kind == stability::Explanation::Kind::chatter || peak.kind == stability::Explanation::Kind::unexplained) {
      any_chatter = true;
      frequency_agrees = frequency_agrees || is_image(peak.frequency_hz, point.chatter_frequency_hz, tooth_passing_hz);
    }
  }
  if (any_chatter && !point.stable) {
    note += frequency_agrees ? "; the chatter frequency agrees" : "; the chatter frequency does not agree";
  }
  return note;
}

/// The highest multiple of the rotation beside the highest other peak.
struct Heights {
  double multiple = 0.0, other = 0.0, other_hz = 0.0;
  [[nodiscard]] double ratio() const { return multiple > 0.0 ? other / multiple : 0.0; }
  [[nodiscard]] Verdict verdict() const {
    const bool only_other = multiple == 0.0 && other > 0.0;
    if (only_other || ratio() >= 0.5) return Verdict::chatter;
    return ratio() >= 0.25 ? Verdict::borderline : Verdict::stable;
  }
};

/// What a peak counts as in the verdict. Of a peak that may be the cut or chatter the more likely reading counts where
/// that is the cut: multiples of the rotation are in every spectrum. Else it is open.
enum class Counted { cut, chatter, open };

Counted counted(const stability::ExplainedPeak& peak) {
  const bool either = peak.best.kind == stability::Explanation::Kind::cut_or_chatter;
  const stability::Explanation::Kind kind = either ? peak.others.front().kind : peak.best.kind;
  const bool multiple =
      kind == stability::Explanation::Kind::rotation || kind == stability::Explanation::Kind::tooth_passing;
  if (multiple) return Counted::cut;
  return either ? Counted::open : Counted::chatter;
}

/// @param open_as  what open peaks count as
Heights heights_of(const std::vector<Peak>& peaks, const std::vector<Counted>& counts, Counted open_as) {
  Heights heights;
  for (std::size_t i = 0; i < peaks.size(); ++i) {
    if ((counts[i] == Counted::open ? open_as : counts[i]) == Counted::cut) {
      heights.multiple = std::max(heights.multiple, peaks[i].amplitude);
    } else if (peaks[i].amplitude > heights.other) {
      heights.other = peaks[i].amplitude;
      heights.other_hz = peaks[i].frequency_hz;
    }
  }
  return heights;
}

/// What the spectrum says, and why. No verdict where it hangs on open peaks.
void judge(Recording& recording, const std::vector<Counted>& counts) {
  const Heights as_cut = heights_of(recording.peaks, counts, Counted::cut);
  const Heights as_chatter = heights_of(recording.peaks, counts, Counted::chatter);
  if (as_cut.verdict() != as_chatter.verdict()) {
    recording.reason =
        fmt::format("{:.1f} Hz may be the cut or chatter: the recording says neither", as_chatter.other_hz);
    return;
  }
  recording.verdict = as_cut.verdict();
  if (as_cut.other == 0.0) {
    recording.reason = "every peak is a multiple of the rotation";
  } else if (as_cut.multiple == 0.0) {
    recording.reason = fmt::format("{:.1f} Hz, and no multiple of the rotation", as_cut.other_hz);
  } else {
    recording.reason = fmt::format("{:.1f} Hz is {:.2f} times as high as the highest multiple of the rotation",
                                   as_cut.other_hz, as_cut.ratio());
  }
}

std::vector<stability::ExplainedPeak> explained(const std::vector<double>& frequency_hz, double spindle_speed_rad_per_s,
                                                const stability::LobesProblem& problem, double tolerance_hz) {
  if (frequency_hz.empty()) return {};
  // explain() wants it below a quarter of the rotation.
  const double tolerance = std::min(tolerance_hz, 0.24 * spindle_speed_rad_per_s / units::revolution);
  return stability::explain({frequency_hz, spindle_speed_rad_per_s, problem.milling.tool.teeth}, problem.dynamics,
                            {.tolerance_hz = tolerance}, problem.workpiece_dynamics)
      .peaks;
}

Peak named(const stability::ExplainedPeak& peak, int teeth) {
  return {.frequency_hz = peak.frequency_hz, .kind = peak.best.kind, .text = peak_text(peak, teeth)};
}

}  // namespace

std::string_view to_string(Verdict verdict) {
  return name_in(verdict_names, verdict);
}

std::vector<Peak> name_peaks(const std::vector<double>& frequency_hz, double spindle_speed_rad_per_s,
                             const stability::LobesProblem& problem, double tolerance_hz) {
  std::vector<Peak> out;
  for (const stability::ExplainedPeak& peak : explained(frequency_hz, spindle_speed_rad_per_s, problem, tolerance_hz)) {
    out.push_back(named(peak, problem.milling.tool.teeth));
  }
  return out;
}

Agreement agreement(const std::vector<ComparedCut>& cuts) {
  Agreement counts;
  for (const ComparedCut& cut : cuts) {
    if (!cut.agrees) {
      ++counts.not_compared;
    } else if (*cut.agrees) {
      ++counts.agree;
    } else {
      ++counts.disagree;
    }
  }
  return counts;
}

std::vector<ComparedCut> compare_cuts(const std::vector<TestCut>& cuts, const stability::LobesProblem& problem,
                                      const stability::LobesOptions& options, Progress& progress) {
  std::vector<ComparedCut> out(cuts.size());
  progress.start("test cuts", cuts.size());
  parallel_for(cuts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const TestCut& cut = cuts[i];
      const stability::PointResult point = stability::evaluate_point(
          problem, options,
          {.spindle_speed_rad_per_s = cut.spindle_speed_rad_per_s, .axial_depth_m = cut.axial_depth_m});
      const stability::Limit limit = stability::limit_depths(problem, options, {cut.spindle_speed_rad_per_s}).front();
      ComparedCut& row = out[i];
      row.cut = cut;
      row.predicted = point.stable ? Verdict::stable : Verdict::chatter;
      if (limit.status == stability::Limit::Status::found) row.limit_depth_m = limit.axial_depth_m;
      if (cut.result == Verdict::borderline) {
        row.agrees = std::abs(row.limit_depth_m / cut.axial_depth_m - 1.0) <= 0.2;
      } else if (cut.result != Verdict::unknown) {
        row.agrees = cut.result == row.predicted;
      }
      row.note = note_on(cut, point, problem);
      progress.advance();
    }
  });
  return out;
}

Recording judge_recording(const TestCut& cut, const CutSignal& recorded, const stability::LobesProblem& problem) {
  const double length_s = static_cast<double>(recorded.acceleration.size()) / recorded.sample_rate_hz;
  if (length_s < 0.2) throw InvalidInput(cut.file.string(), length_s, "s", "must be at least 0.2 s of cutting");

  Recording out;
  out.file = cut.file.filename().string();
  out.notes = recorded.notes;
  out.spindle_speed_rad_per_s = cut.spindle_speed_rad_per_s;
  out.teeth = problem.milling.tool.teeth;
  out.axial_depth_m = cut.axial_depth_m;
  const signal::Spectrum spectrum = signal::amplitude_spectrum(recorded.acceleration, recorded.sample_rate_hz);
  out.frequency_hz = spectrum.frequency_hz;
  out.amplitude = spectrum.amplitude;
  signal::PeakOptions wanted;
  wanted.count = 20;
  wanted.min_frequency_hz = 0.5 * cut.spindle_speed_rad_per_s / units::revolution;
  wanted.min_separation_hz = 4.0 / length_s;
  std::vector<double> frequency_hz;
  const std::vector<signal::SpectralPeak> found = signal::find_peaks(spectrum, wanted);
  frequency_hz.reserve(found.size());
  for (const signal::SpectralPeak& peak : found) frequency_hz.push_back(peak.frequency_hz);
  std::vector<Counted> counts;
  for (const stability::ExplainedPeak& peak :
       explained(frequency_hz, cut.spindle_speed_rad_per_s, problem, 2.0 / length_s)) {
    out.peaks.push_back(named(peak, out.teeth));
    out.peaks.back().amplitude = found[counts.size()].amplitude;
    counts.push_back(counted(peak));
  }
  judge(out, counts);
  return out;
}

}  // namespace robomill::decision
