#include "robomill/cutting/milling.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cutting/chip.hpp"
#include "robomill/cutting/cut_limits.hpp"

namespace robomill::cutting {
namespace {

using std::numbers::pi;

/// κ(φ) = constant + cosine cos 2φ + sine sin 2φ.
struct PairHarmonics {
  Eigen::Matrix2d constant, cosine, sine;
};

PairHarmonics pair_harmonics(const ForceCoefficients& c) {
  const double kt = 0.5 * c.tangential_n_per_m2;
  const double kr = 0.5 * c.radial_n_per_m2;
  PairHarmonics h;
  h.constant << -kr, -kt, kt, -kr;
  h.cosine << kr, -kt, -kt, -kr;
  h.sine << -kt, -kr, -kr, kt;
  return h;
}

/// ∫ g κ over [low, high], inside which angles may pass several revolutions. Written with lengths and midpoints, so
/// that nothing cancels where the range is short.
Eigen::Matrix2d integral(const PairHarmonics& h, const Immersion& immersion, double low, double high) {
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  for (double start = units::revolution * std::floor(low / units::revolution); start < high;
       start += units::revolution) {
    const double from = std::max(low - start, immersion.entry_rad);
    const double to = std::min(high - start, immersion.exit_rad);
    if (to <= from) continue;
    const double sum_of_ends = from + to;
    const double chord = std::sin(to - from);
    sum += h.constant * (to - from) + h.cosine * (std::cos(sum_of_ends) * chord) +
           h.sine * (std::sin(sum_of_ends) * chord);
  }
  return sum;
}

/// ∫ C(s) ds over [low, high] with C(s) = ∫ g κ over [start of s's first revolution, s], by the same rule; `first` is
/// the start of the revolution that C counts from.
Eigen::Matrix2d double_integral(const PairHarmonics& h, const Immersion& immersion, double first, double low,
                                double high) {
  const double entry = immersion.entry_rad;
  const double exit = immersion.exit_rad;
  const Eigen::Matrix2d whole = integral(h, immersion, entry, exit);
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  for (double start = units::revolution * std::floor(low / units::revolution); start < high;
       start += units::revolution) {
    const double a = std::max(low - start, 0.0);
    const double b = std::min(high - start, units::revolution);
    if (b <= a) continue;
    sum += whole * (std::round((start - first) / units::revolution) * (b - a));
    const double from = std::max(a, entry);
    const double to = std::min(b, exit);
    if (to > from) {
      const double length = to - from;
      const double chord = std::sin(length);
      sum += h.constant * (length * (0.5 * (from + to) - entry)) +
             h.cosine * (0.5 * (std::sin(from + to) * chord - length * std::sin(2.0 * entry))) +
             h.sine * (0.5 * (length * std::cos(2.0 * entry) - std::cos(from + to) * chord));
    }
    const double after = b - std::max(a, exit);
    if (after > 0.0) sum += whole * after;
  }
  return sum;
}

/// ∫ g κ dz between two heights.
Eigen::Matrix2d stiffness_between(const Milling& milling, const ForceCoefficients& coefficients, int tooth,
                                  double rotation_rad, double low_m, double high_m) {
  const double lag = milling.tool.lag_rad_per_m(tooth);
  const double standing = rotation_rad + milling.tool.standing_angle(tooth);
  const double tip = standing - lag * low_m;
  const double top = standing - lag * high_m;
  if (top == tip) {
    const double angle = tip - units::revolution * std::floor(tip / units::revolution);
    const bool cuts = angle >= milling.immersion.entry_rad && angle <= milling.immersion.exit_rad;
    if (!cuts) return Eigen::Matrix2d::Zero();
    return directional_coefficients(coefficients, angle) * (high_m - low_m);
  }
  const double low = std::min(tip, top);
  const double high = std::max(tip, top);
  return integral(pair_harmonics(coefficients), milling.immersion, low, high) * ((high_m - low_m) / (high - low));
}

/// Of the engaged edges, the share that cuts nothing because of runout.
double missed_share(const Milling& milling, double axial_depth_m, double feed_per_tooth_m) {
  const FlatEndMill& tool = milling.tool;
  if (tool.runout_m == 0.0) return 0.0;
  const Arc arc = {.entry_rad = milling.immersion.entry_rad, .exit_rad = milling.immersion.exit_rad};
  const detail::Forwards forwards = {.mean = 0.0, .amplitude = 1.0, .middle_rad = 0.5 * pi};
  constexpr int heights = 24;
  detail::ChipShare chips;
  double missed_rad = 0.0;
  for (int h = 0; h < heights; ++h) {
    const double height_m = axial_depth_m * (h + 0.5) / heights;
    for (int tooth = 0; tooth < tool.teeth; ++tooth) {
      chips.set(tool, tooth, height_m, 1.0, feed_per_tooth_m * tool.teeth);
      (void)chips.pieces(arc, forwards, missed_rad);
    }
  }
  return missed_rad / (heights * tool.teeth * (arc.exit_rad - arc.entry_rad));
}

void require_material(const char* field, double value, const char* hint) {
  constexpr double least = 1e6;
  constexpr double most = 1e12;
  if (std::abs(value) < least) throw InvalidInput(field, value, "N/m^2", "is too small for any material", hint);
  if (std::abs(value) > most) throw InvalidInput(field, value, "N/m^2", "is too large for any material", hint);
}

}  // namespace

double FlatEndMill::pitch(int tooth) const {
  return pitch_rad.empty() ? units::revolution / teeth : pitch_rad[static_cast<std::size_t>(tooth)];
}

bool FlatEndMill::has_equal_pitch() const {
  return std::ranges::all_of(pitch_rad, [&](double p) { return std::abs(p - units::revolution / teeth) <= 1e-9; });
}

double FlatEndMill::standing_angle(int tooth) const {
  double angle = 0.0;
  for (int j = 0; j < tooth; ++j) angle += pitch(j);
  return angle;
}

bool FlatEndMill::has_equal_helix() const {
  return std::ranges::all_of(tooth_helix_rad, [&](double helix) { return helix == tooth_helix_rad.front(); });
}

bool FlatEndMill::has_equal_teeth() const {
  return has_equal_pitch() && has_equal_helix() && runout_m == 0.0;
}

double FlatEndMill::lag_rad_per_m(int tooth) const {
  const double helix = tooth_helix_rad.empty() ? helix_rad : tooth_helix_rad[static_cast<std::size_t>(tooth)];
  return 2.0 * std::tan(helix) / diameter_m;
}

double FlatEndMill::radius_deviation_m(int tooth, double height_m) const {
  if (runout_m == 0.0) return 0.0;
  return runout_m * std::cos(standing_angle(tooth) - lag_rad_per_m(tooth) * height_m - runout_angle_rad);
}

void FlatEndMill::validate() const {
  if (teeth < 1) throw InvalidInput("teeth", teeth, "", "must be at least 1");
  if (teeth > 100) throw InvalidInput("teeth", teeth, "", "must be at most 100");
  require_positive("diameter_m", diameter_m, "m");
  if (diameter_m < 1e-5) {
    throw InvalidInput("diameter_m", diameter_m, "m", "is too small for a milling cutter", "Are the units mixed up?");
  }
  if (diameter_m > 1.0) {
    throw InvalidInput("diameter_m", diameter_m, "m", "is too large for a milling cutter", "Are the units mixed up?");
  }
  const auto check_helix = [](const char* field, double helix) {
    if (!(std::abs(helix) < 0.48 * pi)) {
      throw InvalidInput(field, helix, "rad", "must lie between -86 and 86 degrees");
    }
  };
  check_helix("helix_rad", helix_rad);
  for (std::size_t j = 0; j < tooth_helix_rad.size(); ++j) {
    check_helix(("tooth_helix_rad[" + std::to_string(j + 1) + "]").c_str(), tooth_helix_rad[j]);
  }
  if (!tooth_helix_rad.empty() && tooth_helix_rad.size() != static_cast<std::size_t>(teeth)) {
    throw InvalidInput("tooth_helix_rad", static_cast<double>(tooth_helix_rad.size()), "entries",
                       "must have one entry for each tooth (" + std::to_string(teeth) + ")");
  }
  require_non_negative("runout_m", runout_m, "m");
  if (runout_m > 0.1 * diameter_m) {
    throw InvalidInput("runout_m", runout_m, "m", "is too large for this cutter", "Are the units mixed up?");
  }
  require_finite("runout_angle_rad", runout_angle_rad, "rad");
  if (pitch_rad.empty()) return;
  if (pitch_rad.size() != static_cast<std::size_t>(teeth)) {
    throw InvalidInput("pitch_rad", static_cast<double>(pitch_rad.size()), "entries",
                       "must have one entry for each tooth (" + std::to_string(teeth) + ")");
  }
  double sum = 0.0;
  for (std::size_t j = 0; j < pitch_rad.size(); ++j) {
    require_positive(("pitch_rad[" + std::to_string(j + 1) + "]").c_str(), pitch_rad[j], "rad");
    sum += pitch_rad[j];
  }
  if (!(std::abs(sum - units::revolution) <= 1e-6 * units::revolution)) {
    throw InvalidInput("pitch_rad", "must sum to one revolution, 360 degrees");
  }
}

void Immersion::validate() const {
  if (!(entry_rad >= 0.0 && entry_rad < pi)) {
    throw InvalidInput("entry_rad", entry_rad, "rad", "must be at least 0 and less than 180 degrees",
                       "Angles run clockwise from +y, x being the feed; the chip has no thickness beyond 180 degrees");
  }
  if (!(exit_rad > entry_rad)) {
    throw InvalidInput("exit_rad", exit_rad, "rad", "must be greater than the entry angle");
  }
  if (!(exit_rad <= pi * (1.0 + 1e-12))) {
    throw InvalidInput("exit_rad", exit_rad, "rad", "must be at most 180 degrees",
                       "Angles run clockwise from +y, x being the feed; the chip has no thickness beyond 180 degrees");
  }
}

void ForceCoefficients::validate() const {
  constexpr const char* hint = "Aluminium is near 700 N/mm^2 = 7e8 N/m^2; are the units mixed up?";
  require_positive("tangential_n_per_m2", tangential_n_per_m2, "N/m^2", hint);
  require_finite("radial_n_per_m2", radial_n_per_m2, "N/m^2", hint);
  require_material("tangential_n_per_m2", tangential_n_per_m2, hint);
  if (radial_n_per_m2 != 0.0) require_material("radial_n_per_m2", radial_n_per_m2, hint);
  require_non_negative("tangential_edge_n_per_m", tangential_edge_n_per_m, "N/m");
  require_non_negative("radial_edge_n_per_m", radial_edge_n_per_m, "N/m");
}

void Drill::validate() const {
  if (lips < 1 || lips > 20) throw InvalidInput("lips", lips, "", "must lie between 1 and 20", "Drills have two");
  require_positive("diameter_m", diameter_m, "m");
  if (diameter_m > 1.0) throw InvalidInput("diameter_m", diameter_m, "m", "is too large for a drill");
  if (!(point_angle_rad > 0.1 && point_angle_rad <= std::numbers::pi * (1.0 + 1e-12))) {
    throw InvalidInput("point_angle_rad", point_angle_rad, "rad", "must lie between 6 and 180 degrees",
                       "118 degrees is usual");
  }
  coefficients.validate();
}

void ProcessDamping::validate() const {
  constexpr const char* hint = "Steel is near 40,000 N/mm^3 = 4e13 N/m^3";
  require_non_negative("indentation_n_per_m3", indentation_n_per_m3, "N/m^3", hint);
  if (indentation_n_per_m3 > 1e16) {
    throw InvalidInput("indentation_n_per_m3", indentation_n_per_m3, "N/m^3", "is too large for any material", hint);
  }
  require_non_negative("wear_land_m", wear_land_m, "m");
  if (wear_land_m > 1e-3) {
    throw InvalidInput("wear_land_m", wear_land_m, "m", "is longer than any usable edge's", "0.05 to 0.1 mm is usual");
  }
  require_non_negative("friction", friction, "");
}

void SpeedVariation::validate() const {
  if (!(amplitude_ratio >= 0.0 && amplitude_ratio <= 0.9)) {
    throw InvalidInput("amplitude_ratio", amplitude_ratio, "", "must lie between 0 and 0.9",
                       "It is a share of the mean speed");
  }
  if (!active()) return;
  require_positive("frequency_ratio", frequency_ratio, "", "It is the swing's frequency over that of rotation");
}

void Milling::validate() const {
  tool.validate();
  immersion.validate();
  coefficients.validate();
  process_damping.validate();
  speed_variation.validate();
  require_feed_per_tooth("feed_per_tooth_m", feed_per_tooth_m);
  if (tool.runout_m > 0.0 && !(feed_per_tooth_m > 0.0)) {
    throw InvalidInput("feed_per_tooth_m", feed_per_tooth_m, "m", "must be > 0 where there is runout",
                       "It decides which teeth miss the cut");
  }
}

Immersion immersion(MillingDirection direction, double radial_depth_m, double diameter_m) {
  require_positive("diameter_m", diameter_m, "m");
  if (direction == MillingDirection::slot) return {.entry_rad = 0.0, .exit_rad = pi};
  require_positive("radial_depth_m", radial_depth_m, "m");
  if (radial_depth_m > diameter_m * (1.0 + 1e-12)) {
    throw InvalidInput("radial_depth_m", radial_depth_m, "m", "must be at most the cutter's diameter");
  }
  const double ratio = std::min(2.0 * radial_depth_m / diameter_m, 2.0);
  if (direction == MillingDirection::up) return {.entry_rad = 0.0, .exit_rad = std::acos(1.0 - ratio)};
  return {.entry_rad = std::acos(ratio - 1.0), .exit_rad = pi};
}

double radial_depth(const Immersion& immersion, double diameter_m) {
  return 0.5 * diameter_m * (std::cos(immersion.entry_rad) - std::cos(immersion.exit_rad));
}

Eigen::Matrix2d directional_coefficients(const ForceCoefficients& coefficients, double angle_rad) {
  const double s = std::sin(angle_rad);
  const double c = std::cos(angle_rad);
  const double kt = coefficients.tangential_n_per_m2;
  const double kr = coefficients.radial_n_per_m2;
  Eigen::Matrix2d kappa;
  kappa << -s * (kt * c + kr * s), -c * (kt * c + kr * s), s * (kt * s - kr * c), c * (kt * s - kr * c);
  return kappa;
}

Eigen::Matrix2d cutting_stiffness(const Milling& milling, int tooth, double rotation_rad, double axial_depth_m) {
  return cutting_stiffness(milling, tooth, rotation_rad, 0.0, axial_depth_m);
}

Eigen::Matrix2d cutting_stiffness(const Milling& milling, int tooth, double rotation_rad, double low_m, double high_m) {
  return stiffness_between(milling, milling.coefficients, tooth, rotation_rad, low_m, high_m);
}

Eigen::Matrix2d cutting_damping(const Milling& milling, int tooth, double rotation_rad, double low_m, double high_m,
                                double speed_rad_per_s) {
  const ProcessDamping& damping = milling.process_damping;
  const double radial = damping.indentation_n_per_m3 * damping.wear_land_m * damping.wear_land_m /
                        (speed_rad_per_s * milling.tool.diameter_m);
  const ForceCoefficients viscous = {.tangential_n_per_m2 = damping.friction * radial, .radial_n_per_m2 = radial};
  return stiffness_between(milling, viscous, tooth, rotation_rad, low_m, high_m);
}

Eigen::Matrix2d mean_cutting_stiffness(const Milling& milling, int tooth, double from_rad, double to_rad,
                                       double axial_depth_m) {
  const PairHarmonics h = pair_harmonics(milling.coefficients);
  const double standing = milling.tool.standing_angle(tooth);
  const double from = from_rad + standing;
  const double to = to_rad + standing;
  const double lag = milling.tool.lag_rad_per_m(tooth) * axial_depth_m;
  if (from - lag == from || to - lag == to) {
    return integral(h, milling.immersion, from, to) * (axial_depth_m / (to - from));
  }
  const double first = units::revolution * std::floor(std::min(from, from - lag) / units::revolution);
  const auto mean = [&](double angle) -> Eigen::Matrix2d {
    const double low = std::min(angle, angle - lag);
    const double high = std::max(angle, angle - lag);
    return double_integral(h, milling.immersion, first, low, high) / (high - low);
  };
  return (mean(to) - mean(from)) * (axial_depth_m / (to - from));
}

double mean_torque_n_m(const Milling& milling, double axial_depth_m, double feed_per_tooth_m) {
  milling.validate();
  require_non_negative("axial_depth_m", axial_depth_m, "m");
  require_non_negative("feed_per_tooth_m", feed_per_tooth_m, "m");
  const Immersion& immersion = milling.immersion;
  const ForceCoefficients& k = milling.coefficients;
  const double area = radial_depth(immersion, milling.tool.diameter_m) * feed_per_tooth_m;
  const double volume_per_rad = milling.tool.teeth * area * axial_depth_m / units::revolution;
  const double edge_area_per_rad = milling.tool.teeth * 0.5 * milling.tool.diameter_m *
                                   (immersion.exit_rad - immersion.entry_rad) * axial_depth_m / units::revolution;
  const double rubs =
      k.tangential_edge_n_per_m > 0.0 ? 1.0 - missed_share(milling, axial_depth_m, feed_per_tooth_m) : 0.0;
  return k.tangential_n_per_m2 * volume_per_rad + k.tangential_edge_n_per_m * rubs * edge_area_per_rad;
}

}  // namespace robomill::cutting
