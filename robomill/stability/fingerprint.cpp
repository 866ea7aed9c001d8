#include "robomill/stability/fingerprint.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <tuple>

#include "robomill/base/error.hpp"

namespace robomill::stability {
namespace {

using std::numbers::pi;
using Named = Explanation::Kind;

std::vector<Explanation> explanations(double peak_hz, double rotation_hz, int teeth, const modal::ModalModel& modes,
                                      double tolerance_hz) {
  std::vector<Explanation> found;
  const auto consider = [&](Explanation e) {
    e.difference_hz = peak_hz - e.expected_hz;
    e.of_tooth_passing = e.harmonic % teeth == 0;
    if (std::abs(e.difference_hz) <= e.tolerance_hz) found.push_back(e);
  };
  const int nearest = static_cast<int>(std::lround(peak_hz / rotation_hz));
  if (nearest >= 1) {
    consider({.kind = nearest % teeth == 0 ? Named::tooth_passing : Named::rotation,
              .harmonic = nearest,
              .expected_hz = nearest * rotation_hz,
              .tolerance_hz = tolerance_hz});
  }
  for (std::size_t k = 0; k < modes.modes.size(); ++k) {
    const double mode_hz = modes.modes[k].frequency_hz;
    const double allowed_hz = std::max(tolerance_hz, modes.modes[k].damping_ratio * mode_hz);
    for (const double sign : {1.0, -1.0}) {
      // f = |f_k + n f_rotation| from above (f_k + n f) or from below (-n f - f_k).
      const double turns = (sign * peak_hz - mode_hz) / rotation_hz;
      const double reach = allowed_hz / rotation_hz;
      for (double n = std::ceil(turns - reach); n <= turns + reach; ++n) {
        const double signed_hz = mode_hz + n * rotation_hz;
        if (signed_hz * sign < 0.0) continue;
        consider({.kind = Named::chatter,
                  .harmonic = static_cast<int>(n),
                  .mirrored = sign < 0.0,
                  .mode = static_cast<int>(k) + 1,
                  .expected_hz = std::abs(signed_hz),
                  .tolerance_hz = allowed_hz});
      }
    }
  }
  const auto rank = [](const Explanation& e) {
    return std::tuple(e.kind, !e.of_tooth_passing, std::abs(e.difference_hz) / e.tolerance_hz);
  };
  std::ranges::stable_sort(found, [&](const Explanation& a, const Explanation& b) { return rank(a) < rank(b); });
  return found;
}

/// What a rotation frequency makes of the peaks.
struct Reading {
  double rotation_hz = 0.0;
  int explained = 0, multiples = 0;      ///< as anything; as multiples of rotation
  double products = 0.0, squares = 0.0;  ///< sums over the multiples of n f and n²
};

Reading read(const MeasuredPeaks& peaks, double rotation_hz, const modal::ModalModel& modes, double tolerance_hz) {
  Reading reading{.rotation_hz = rotation_hz};
  for (const double f : peaks.frequency_hz) {
    const std::vector<Explanation> found = explanations(f, rotation_hz, peaks.teeth, modes, tolerance_hz);
    if (found.empty()) continue;
    ++reading.explained;
    if (found.front().kind == Named::chatter) continue;
    const double n = found.front().harmonic;
    ++reading.multiples;
    reading.products += n * f;
    reading.squares += n * n;
  }
  return reading;
}

double rotation_of(const MeasuredPeaks& peaks, const modal::ModalModel& modes, const FingerprintOptions& options,
                   bool& from_peaks) {
  const double commanded_hz = peaks.spindle_speed_rad_per_s / (2.0 * pi);
  Reading best = read(peaks, commanded_hz, modes, options.tolerance_hz);
  const auto away = [&](const Reading& r) { return std::abs(r.rotation_hz - commanded_hz); };
  for (const double f : peaks.frequency_hz) {
    const double low = std::max(1.0, std::ceil(f / (commanded_hz * (1.0 + options.speed_tolerance))));
    const double high = std::floor(f / (commanded_hz * (1.0 - options.speed_tolerance)));
    for (double n = low; n <= high && n < low + 100.0; ++n) {
      const Reading other = read(peaks, f / n, modes, options.tolerance_hz);
      // Far multiples fit many speeds: another speed must explain more peaks than the commanded one, whatever they are.
      if (other.multiples < 2 || other.explained < best.explained) continue;
      if (other.explained == best.explained && away(other) >= away(best)) continue;
      best = other;
    }
  }
  from_peaks = best.multiples > 0;
  if (!from_peaks) return commanded_hz;
  const double most_hz = options.speed_tolerance * commanded_hz;
  return std::clamp(best.products / best.squares, commanded_hz - most_hz, commanded_hz + most_hz);
}

/// The mode that explains most chatter peaks; of equals the one whose peaks fit better.
void name_mode(Fingerprint& out) {
  struct Share {
    int peaks = 0;
    double misfit = 0.0, frequency_hz = 0.0;
  };
  std::map<int, Share> shares;
  for (const ExplainedPeak& peak : out.peaks) {
    if (peak.best.kind != Named::chatter) continue;
    Share& share = shares[peak.best.mode];
    ++share.peaks;
    share.misfit += std::abs(peak.best.difference_hz) / peak.best.tolerance_hz;
    const double moved_hz = peak.best.harmonic * out.spindle_speed_rad_per_s / (2.0 * pi);
    share.frequency_hz += (peak.best.mirrored ? -peak.frequency_hz : peak.frequency_hz) - moved_hz;
  }
  for (const auto& [mode, share] : shares) {
    const Share best = out.mode == 0 ? Share{} : shares[out.mode];
    if (share.peaks < best.peaks || (share.peaks == best.peaks && share.misfit >= best.misfit)) continue;
    out.mode = mode;
    out.chatter_frequency_hz = share.frequency_hz / share.peaks;
  }
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
    if (f > 1e6) throw InvalidInput("frequency_hz", f, "Hz", "must be at most 1 MHz", "Are the units mixed up?");
  }
  require_positive("spindle_speed_rad_per_s", spindle_speed_rad_per_s, "rad/s");
  if (teeth < 1) throw InvalidInput("teeth", teeth, "", "must be at least 1");
  if (teeth > 100) throw InvalidInput("teeth", teeth, "", "must be at most 100");
}

std::string_view to_string(Explanation::Kind kind) {
  switch (kind) {
    case Named::tooth_passing:
      return "tooth passing";
    case Named::rotation:
      return "rotation";
    case Named::chatter:
      return "chatter";
    default:
      return "unexplained";
  }
}

Fingerprint explain(const MeasuredPeaks& peaks, const modal::ModalModel& modes, const FingerprintOptions& options) {
  peaks.validate();
  modes.validate();
  require_positive("tolerance_hz", options.tolerance_hz, "Hz");
  if (!(options.speed_tolerance >= 0.0 && options.speed_tolerance <= 0.05)) {
    throw InvalidInput("speed_tolerance", options.speed_tolerance, "", "must lie between 0 and 0.05");
  }
  const double commanded_hz = peaks.spindle_speed_rad_per_s / (2.0 * pi);
  if (!(options.tolerance_hz < 0.25 * commanded_hz)) {
    throw InvalidInput("tolerance_hz", options.tolerance_hz, "Hz",
                       "must be below a quarter of the rotation frequency, or every peak is a multiple of it",
                       "Is the spindle speed in rpm?");
  }
  Fingerprint out;
  const double rotation_hz = rotation_of(peaks, modes, options, out.speed_from_peaks);
  out.spindle_speed_rad_per_s = 2.0 * pi * rotation_hz;
  for (const double f : peaks.frequency_hz) {
    ExplainedPeak peak{.frequency_hz = f, .best = {}};
    peak.others = explanations(f, rotation_hz, peaks.teeth, modes, options.tolerance_hz);
    if (!peak.others.empty()) {
      peak.best = peak.others.front();
      peak.others.erase(peak.others.begin());
    }
    out.peaks.push_back(std::move(peak));
  }
  name_mode(out);
  return out;
}

}  // namespace robomill::stability
