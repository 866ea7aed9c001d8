#include "robomill/stability/peak_classification.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <string>
#include <tuple>

#include "robomill/base/error.hpp"
#include "robomill/cutting/cut_limits.hpp"

namespace robomill::stability {
namespace {

using std::numbers::pi;
using Named = Explanation::Kind;

struct NaturalMode {
  modal::ModeId id;
  double frequency_hz = 0.0;
  double half_width_hz = 0.0;
};

void add_modes(const modal::ModalModel& model, modal::ModeOwner owner, std::vector<NaturalMode>& out) {
  int number = 0;
  for (const modal::Mode& mode : model.modes) {
    ++number;
    if (mode.weak) continue;  // it moves too little to be heard
    out.push_back({{number, owner}, mode.frequency_hz, mode.damping_ratio * mode.frequency_hz});
  }
}

/// All readings of a peak, the most likely first.
std::vector<Explanation> explanations(double peak_hz, double rotation_hz, int teeth,
                                      const std::vector<NaturalMode>& modes, const PeakClassificationOptions& options) {
  std::vector<Explanation> found;
  const auto consider = [&](Explanation e) {
    e.difference_hz = peak_hz - e.expected_hz;
    e.of_tooth_passing = e.harmonic % teeth == 0;
    const double misfit = std::abs(e.difference_hz) / e.tolerance_hz;
    e.likelihood_per_hz = std::exp(-2.0 * misfit * misfit) / e.tolerance_hz;
    if (misfit <= 1.0) found.push_back(e);
  };
  const int nearest = static_cast<int>(std::lround(peak_hz / rotation_hz));
  if (nearest >= 1 && !options.multiples_removed) {
    consider({.kind = nearest % teeth == 0 ? Named::tooth_passing : Named::rotation,
              .harmonic = nearest,
              .expected_hz = nearest * rotation_hz,
              .tolerance_hz = options.tolerance_hz});
  }
  for (const NaturalMode& mode : modes) {
    const double mode_hz = mode.frequency_hz;
    const double allowed_hz = std::max(options.tolerance_hz, mode.half_width_hz);
    for (const double sign : {1.0, -1.0}) {
      // f = |f_k + n f_rotation| from above (f_k + n f) or from below (-n f - f_k).
      const double turns = (sign * peak_hz - mode_hz) / rotation_hz;
      const double reach = allowed_hz / rotation_hz;
      for (double n = std::ceil(turns - reach); n <= turns + reach; ++n) {
        if (std::abs(n) > options.most_rotations) continue;
        const double signed_hz = mode_hz + n * rotation_hz;
        if (signed_hz * sign < 0.0) continue;
        consider({.kind = Named::chatter,
                  .harmonic = static_cast<int>(n),
                  .mirrored = sign < 0.0,
                  .mode = mode.id,
                  .mode_frequency_hz = mode_hz,
                  .expected_hz = std::abs(signed_hz),
                  .tolerance_hz = allowed_hz});
      }
    }
  }
  // Likelihoods that differ by rounding alone are equal.
  const auto rank = [](const Explanation& e) {
    return std::tuple(std::llround(-1e6 * std::log(e.likelihood_per_hz)), !e.of_tooth_passing, e.kind);
  };
  std::ranges::stable_sort(found, [&](const Explanation& a, const Explanation& b) { return rank(a) < rank(b); });
  return found;
}

/// What a rotation frequency makes of the peaks.
struct Reading {
  double rotation_hz = 0.0;
  int explained = 0, multiples = 0;  ///< as anything; as multiples of rotation
};

bool is_chatter(const Explanation& e) {
  return e.kind == Named::chatter;
}

Reading read(const MeasuredPeaks& peaks, double rotation_hz, const std::vector<NaturalMode>& modes,
             const PeakClassificationOptions& options) {
  Reading reading{.rotation_hz = rotation_hz};
  for (const double f : peaks.frequency_hz) {
    const std::vector<Explanation> found = explanations(f, rotation_hz, peaks.teeth, modes, options);
    if (found.empty()) continue;
    ++reading.explained;
    if (!std::ranges::all_of(found, is_chatter)) ++reading.multiples;
  }
  return reading;
}

/// The frequency of the vibration that a reading supposes.
double own_frequency(double peak_hz, const Explanation& e, double rotation_hz) {
  return (e.mirrored ? -peak_hz : peak_hz) - e.harmonic * rotation_hz;
}

/// What the readings, the most likely first, come to.
ExplainedPeak judged(double peak_hz, std::vector<Explanation> readings, double rotation_hz,
                     const PeakClassificationOptions& options) {
  ExplainedPeak peak{.frequency_hz = peak_hz, .best = {}};
  if (readings.empty()) return peak;
  const double least = readings.front().likelihood_per_hz / options.clear_odds;
  const auto end = std::ranges::find_if(readings, [&](const Explanation& e) { return e.likelihood_per_hz < least; });
  const std::vector<Explanation> likely(readings.begin(), end);
  // Readings of one mode mean the same, and so do those of the cut, whose mode is unknown.
  const bool clear = std::ranges::all_of(likely, [&](const Explanation& e) { return e.mode == readings.front().mode; });
  if (clear && is_chatter(readings.front())) {
    peak.chatter_frequency_hz = own_frequency(peak_hz, readings.front(), rotation_hz);
  } else if (std::ranges::all_of(likely, is_chatter)) {
    double low_hz = std::numeric_limits<double>::infinity(), high_hz = 0.0;
    for (const Explanation& e : likely) {
      low_hz = std::min(low_hz, own_frequency(peak_hz, e, rotation_hz));
      high_hz = std::max(high_hz, own_frequency(peak_hz, e, rotation_hz));
    }
    if (high_hz - low_hz <= options.tolerance_hz) {
      peak.chatter_frequency_hz = own_frequency(peak_hz, readings.front(), rotation_hz);
    }
  }
  if (clear) {
    peak.state = ExplainedPeak::State::named;
    peak.best = readings.front();
    readings.erase(readings.begin());
  } else {
    peak.state = ExplainedPeak::State::ambiguous;
    peak.best.kind = std::ranges::all_of(likely, is_chatter) ? Named::chatter : Named::cut_or_chatter;
  }
  peak.others = std::move(readings);
  return peak;
}

double rotation_of(const MeasuredPeaks& peaks, const std::vector<NaturalMode>& modes,
                   const PeakClassificationOptions& options, bool& from_peaks) {
  const double commanded_hz = peaks.spindle_speed_rad_per_s / (2.0 * pi);
  Reading best = read(peaks, commanded_hz, modes, options);
  const auto away = [&](const Reading& r) { return std::abs(r.rotation_hz - commanded_hz); };
  for (const double f : peaks.frequency_hz) {
    const double low = std::max(1.0, std::ceil(f / (commanded_hz * (1.0 + options.speed_tolerance))));
    const double high = std::floor(f / (commanded_hz * (1.0 - options.speed_tolerance)));
    for (double n = low; n <= high && n < low + 100.0; ++n) {
      const Reading other = read(peaks, f / n, modes, options);
      // Far multiples fit many speeds: another speed must explain more peaks than the commanded one, whatever they are.
      if (other.multiples < 2 || other.explained < best.explained) continue;
      if (other.explained == best.explained && away(other) >= away(best)) continue;
      best = other;
    }
  }
  double products = 0.0, squares = 0.0;  // a peak that may be chatter says nothing of the speed
  for (const double f : peaks.frequency_hz) {
    const ExplainedPeak peak =
        judged(f, explanations(f, best.rotation_hz, peaks.teeth, modes, options), best.rotation_hz, options);
    if (peak.state != ExplainedPeak::State::named || is_chatter(peak.best)) continue;
    products += peak.best.harmonic * f;
    squares += static_cast<double>(peak.best.harmonic) * peak.best.harmonic;
  }
  from_peaks = squares > 0.0 || best.rotation_hz != commanded_hz;
  if (squares == 0.0) return best.rotation_hz;
  const double most_hz = options.speed_tolerance * commanded_hz;
  return std::clamp(products / squares, commanded_hz - most_hz, commanded_hz + most_hz);
}

/// The mode that most peaks name.
void name_mode(PeakClassification& out) {
  std::map<modal::ModeId, int> named;
  int most = 0;
  for (const ExplainedPeak& peak : out.peaks) {
    if (peak.state == ExplainedPeak::State::ambiguous) out.state = PeakClassification::State::ambiguous;
    if (peak.best.mode.known()) most = std::max(most, ++named[peak.best.mode]);
  }
  if (most == 0) return;
  const auto has_most = [&](const auto& entry) { return entry.second == most; };
  out.state = PeakClassification::State::ambiguous;
  if (std::ranges::count_if(named, has_most) > 1) return;
  out.state = PeakClassification::State::named;
  out.mode = std::ranges::find_if(named, has_most)->first;
  double sum_hz = 0.0;
  for (const ExplainedPeak& peak : out.peaks) {
    if (peak.best.mode != out.mode) continue;
    sum_hz += own_frequency(peak.frequency_hz, peak.best, out.spindle_speed_rad_per_s / (2.0 * pi));
  }
  out.chatter_frequency_hz = sum_hz / most;
}

}  // namespace

void MeasuredPeaks::validate() const {
  if (frequency_hz.empty()) throw InvalidInput("frequency_hz", "must hold at least one peak");
  if (frequency_hz.size() > 500) {
    throw InvalidInput("frequency_hz", static_cast<double>(frequency_hz.size()), "peaks", "must be at most 500",
                       "Give the peaks of the spectrum, not its lines");
  }
  for (const double f : frequency_hz) {
    require_positive("frequency_hz", f, "Hz");
    if (f > highest_hz) throw InvalidInput("frequency_hz", f, "Hz", "must be at most 1 MHz", "Are the units mixed up?");
  }
  cutting::require_spindle_speed("spindle_speed_rad_per_s", spindle_speed_rad_per_s);
  if (teeth < 1) throw InvalidInput("teeth", teeth, "", "must be at least 1");
  if (teeth > 100) throw InvalidInput("teeth", teeth, "", "must be at most 100");
}

void PeakClassificationOptions::validate() const {
  require_positive("tolerance_hz", tolerance_hz, "Hz");
  if (!(speed_tolerance >= 0.0 && speed_tolerance <= 0.05)) {
    throw InvalidInput("speed_tolerance", speed_tolerance, "", "must lie between 0 and 0.05");
  }
  if (!(clear_odds >= 1.0 && clear_odds <= 1e6)) {
    throw InvalidInput("clear_odds", clear_odds, "", "must lie between 1 and 1e6", "3: three times as likely");
  }
  if (most_rotations < 0) throw InvalidInput("most_rotations", most_rotations, "", "must be at least 0");
}

std::string_view to_string(Explanation::Kind kind) {
  return name_in(explanation_names, kind);
}

std::string_view to_string(ExplainedPeak::State state) {
  return name_in(peak_state_names, state);
}

std::string_view to_string(PeakClassification::State state) {
  return name_in(classification_names, state);
}

PeakClassification explain(const MeasuredPeaks& peaks, const modal::ModalModel& tool,
                           const PeakClassificationOptions& options, const modal::ModalModel& workpiece) {
  peaks.validate();
  tool.validate();
  if (!workpiece.modes.empty()) workpiece.validate();
  options.validate();
  const double commanded_hz = peaks.spindle_speed_rad_per_s / (2.0 * pi);
  if (!(options.tolerance_hz < 0.25 * commanded_hz)) {
    throw InvalidInput("tolerance_hz", options.tolerance_hz, "Hz",
                       "must be below a quarter of the rotation frequency, or every peak is a multiple of it",
                       "Is the spindle speed in rpm?");
  }
  std::vector<NaturalMode> modes;
  add_modes(tool, modal::ModeOwner::tool, modes);
  add_modes(workpiece, modal::ModeOwner::workpiece, modes);
  PeakClassification out;
  const double rotation_hz = rotation_of(peaks, modes, options, out.speed_from_peaks);
  out.spindle_speed_rad_per_s = 2.0 * pi * rotation_hz;
  for (const double f : peaks.frequency_hz) {
    out.peaks.push_back(judged(f, explanations(f, rotation_hz, peaks.teeth, modes, options), rotation_hz, options));
  }
  name_mode(out);
  return out;
}

}  // namespace robomill::stability
