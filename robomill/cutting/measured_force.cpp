#include "robomill/cutting/measured_force.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cutting/measured/alignment.hpp"
#include "robomill/cutting/measured/revolutions.hpp"
#include "robomill/io/usual_ranges.hpp"

namespace robomill::cutting {
namespace {

using detail::Run;
using std::numbers::pi;
using Measured = std::array<bool, 3>;
using Revolutions = std::vector<Eigen::Matrix3Xd>;

using detail::least_revolutions;
constexpr int most_revolutions = 200;
/// Of all revolutions together: 24 bytes each.
constexpr double most_steps = 4e6;
constexpr double least_samples_a_tooth = 4.0;
/// A mean revolution of noise alone has once the variance that the scatter gives it.
constexpr double least_variance_over_noise = 4.0;
constexpr double least_share_of_prediction = 0.02;
/// Of 1 / N, beyond which N teeth at one speed look like others at another.
constexpr double most_tolerance_of_tooth = 0.4;

/// Root mean square of each row.
Eigen::Vector3d rms_of(const Eigen::Matrix3Xd& force) {
  return (force.rowwise().squaredNorm() / static_cast<double>(force.cols())).cwiseSqrt();
}
Eigen::Matrix3Xd without_mean(const Eigen::Matrix3Xd& force) {
  return force.colwise() - Eigen::Vector3d(force.rowwise().mean());
}

InvalidInput too_few(int count, const MeasuredForceOptions& options, const char* what) {
  return InvalidInput("record", fmt::format("has {} whole revolution{} {}at {:.6g} rpm; at least {} are needed", count,
                                            count == 1 ? "" : "s", what, options.spindle_speed_rad_per_s / units::rpm,
                                            least_revolutions));
}

Measured measured_components(const ForceRecord& record) {
  Measured out{};
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const bool none = record.force_n.cols() > 0 && record.force_n.row(axis).array().isNaN().all();
    out[static_cast<std::size_t>(axis)] = !none;
    if (!none && !record.force_n.row(axis).allFinite()) {
      throw InvalidInput("record", fmt::format("has a value in {} that is not finite", "xyz"[axis]));
    }
  }
  if (std::ranges::none_of(out, [](bool measured) { return measured; })) {
    throw InvalidInput("record", "must have a component of the force");
  }
  return out;
}

/// Components that were not measured are 0.
Eigen::Matrix3Xd measured_only(Eigen::Matrix3Xd force, const Measured& measured) {
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (!measured[static_cast<std::size_t>(axis)]) force.row(axis).setZero();
  }
  return force;
}

void check_prediction(const PredictedRevolution& predicted, const Eigen::Matrix3Xd& force) {
  if (predicted.teeth < 1) throw InvalidInput("teeth", predicted.teeth, "", "must be >= 1");
  if (predicted.rotation_rad.size() < 8 || predicted.rotation_rad.size() != force.cols() || !force.allFinite()) {
    throw InvalidInput("predicted", "must have a finite force at each of 8 rotations or more");
  }
  const double step_rad = 2.0 * pi / static_cast<double>(force.cols());
  for (Eigen::Index i = 0; i < force.cols(); ++i) {
    const double even_rad = predicted.rotation_rad(0) + static_cast<double>(i) * step_rad;
    if (!(std::abs(predicted.rotation_rad(i) - even_rad) <= 1e-6 * step_rad + 1e-12)) {
      throw InvalidInput("predicted", fmt::format("must have even steps of one revolution; step {} is at {:.9g} rad", i,
                                                  predicted.rotation_rad(i)));
    }
  }
  if (force.squaredNorm() == 0.0) {
    throw InvalidInput("predicted", "has no force: no tooth is in the material",
                       "Compare a cut that engages the cutter");
  }
  if (without_mean(force).squaredNorm() < 1e-12 * force.squaredNorm()) {
    throw InvalidInput("predicted",
                       "does not vary over the revolution, so that nothing says how the record lies to it");
  }
}

/// @throws InvalidInput where they are too few, or the speed would be sought too far away
double samples_a_revolution(const ForceRecord& record, const PredictedRevolution& predicted,
                            const MeasuredForceOptions& options) {
  const double samples = 2.0 * pi * record.sample_rate_hz / options.spindle_speed_rad_per_s;
  if (samples < least_samples_a_tooth * predicted.teeth) {
    throw InvalidInput("record", fmt::format("has {:.2g} samples a tooth at {:.6g} rpm and {:.6g} Hz; at least {:.0f} "
                                             "samples a tooth are needed",
                                             samples / predicted.teeth, options.spindle_speed_rad_per_s / units::rpm,
                                             record.sample_rate_hz, least_samples_a_tooth));
  }
  if (options.speed_tolerance * predicted.teeth > most_tolerance_of_tooth) {
    throw InvalidInput(
        "speed_tolerance", options.speed_tolerance, "",
        fmt::format("must be at most {:.3g} with {} teeth", most_tolerance_of_tooth / predicted.teeth, predicted.teeth),
        "Beyond it the tooth passing may be that of one tooth more or less at another speed");
  }
  return samples;
}

/// Where in the record it cuts, in revolutions at the speed as given, and where it is in air.
struct Stretch {
  Run run;
  std::array<Run, 2> of_air;  ///< before it and after it, of `air`
  std::vector<int> air;
  std::vector<std::string> notes;
};

/// The run of the time that is given. @throws InvalidInput where the record does not hold it
Run run_of_time(const MeasuredForceOptions& options, double revolutions_per_s, int count) {
  const double begin = std::ceil(options.from_s * revolutions_per_s - 1e-6);
  const double end = std::min(std::floor(options.to_s * revolutions_per_s + 1e-6), static_cast<double>(count));
  if (!(end - begin >= least_revolutions)) {
    throw too_few(static_cast<int>(std::max(end - begin, 0.0)), options, "in this range of time ");
  }
  return {static_cast<int>(begin), static_cast<int>(end)};
}

/// What lies beside the stretch that was found, or within the one that was given, is a warning.
void note_levels(const detail::CutAndAir& found, const std::vector<double>& variation, bool given, Stretch& out) {
  const auto begin = variation.begin() + out.run.begin, end = begin + out.run.length();
  if (given) {
    const auto beyond =
        std::count_if(begin, end, [&](double one) { return one <= 0.5 * found.strong || one >= 2.0 * found.strong; });
    if (beyond > 0) {
      out.notes.push_back(fmt::format(
          "{}{} of the {} revolutions in the range of time vary by less than half or more than twice of the strongest "
          "{} in succession: they are averaged with the cut.",
          io::warning_label, beyond, out.run.length(), least_revolutions));
    }
    return;
  }
  if (found.jolts > 0) {
    out.notes.push_back(fmt::format(
        "{}revolutions that vary by more than twice of the strongest {} in succession count as jolts: {}. Where they "
        "are the cut, it is too short.",
        io::warning_label, least_revolutions, found.jolts));
  }
  if (found.weak >= least_revolutions) {
    out.notes.push_back(fmt::format(
        "{}{} revolutions in succession vary by a tenth to half of the strongest: they are neither the cut nor air. If "
        "they are the cut, give its range of time.",
        io::warning_label, found.weak));
  }
}

/// Sides with fewer than five revolutions in air do not count.
void part_air(Stretch& out) {
  const auto split = std::ranges::find_if(out.air, [&](int b) { return b >= out.run.begin; });
  const auto before = static_cast<int>(split - out.air.begin());
  const auto all = static_cast<int>(out.air.size());
  out.of_air[0] = {0, before < least_revolutions ? 0 : before};
  out.of_air[1] = {all - before < least_revolutions ? all : before, all};
}

Stretch stretch_of(const Eigen::Matrix3Xd& force, double samples, Eigen::Index steps, const ForceRecord& record,
                   const MeasuredForceOptions& options) {
  const std::vector<double> variation = detail::variation_by_revolution(force, samples);
  const auto count = static_cast<int>(variation.size());
  const bool given = options.from_s > 0.0 || std::isfinite(options.to_s);
  const Run within = given ? run_of_time(options, record.sample_rate_hz / samples, count) : Run{0, count};
  detail::CutAndAir found = detail::find_cut(variation, within);
  Stretch out{.run = given ? within : found.cut, .of_air = {}, .air = std::move(found.air), .notes = {}};
  std::erase_if(out.air, [&](int b) { return b >= out.run.begin && b < out.run.end; });
  if (out.run.length() < least_revolutions) throw too_few(out.run.length(), options, "in the cut ");
  const int most = static_cast<int>(
      std::clamp(most_steps / static_cast<double>(steps), 1.0 * least_revolutions + 2.0, 1.0 * most_revolutions));
  const int more = out.run.length() - most;
  if (more > 0) {
    out.run.begin += more / 2;
    out.run.end = out.run.begin + most;
  }
  part_air(out);
  note_levels(found, variation, given, out);
  return out;
}

/// The mean of what is air, and where in the record it stands, in revolutions.
std::pair<Eigen::Vector3d, double> mean_of_air(const Eigen::Matrix3Xd& force, double samples, const Stretch& at,
                                               const Run& part) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double place = 0.0;
  for (int i = part.begin; i < part.end; ++i) {
    const int b = at.air[static_cast<std::size_t>(i)];
    place += b + 0.5;
    sum +=
        force.middleCols(static_cast<Eigen::Index>(b * samples), static_cast<Eigen::Index>(samples)).rowwise().mean();
  }
  return {sum / part.length(), place / part.length()};
}

/// What the record shows without a force, at the middle of the stretch: between air on both sides a straight line.
void set_zero(const Eigen::Matrix3Xd& force, double samples, const Stretch& at, MeasuredForce& out) {
  const Run &before = at.of_air[0], &after = at.of_air[1];
  out.air_revolutions = before.length() + after.length();
  if (out.air_revolutions == 0) return;
  if (before.length() == 0 || after.length() == 0) {
    const bool is_before = after.length() == 0;
    out.zero_n = mean_of_air(force, samples, at, is_before ? before : after).first;
    out.notes.push_back(
        fmt::format("The record is in air {} the cut alone: what the amplifier drifts between there and the cut is in "
                    "the means.",
                    is_before ? "before" : "after"));
    return;
  }
  const auto [first_n, first] = mean_of_air(force, samples, at, before);
  const auto [last_n, last] = mean_of_air(force, samples, at, after);
  const double middle = 0.5 * (at.run.begin + at.run.end);
  out.zero_n = first_n + (last_n - first_n) * (middle - first) / (last - first);
}

/// The record's own speed, in turns a sample, and the angle of its revolutions.
struct Speed {
  double turns = 0.0;
  detail::Angles angles;
};

Speed refined(const Eigen::Matrix3Xd& stretch, double turns, int teeth, double tolerance) {
  constexpr int passes = 3;
  constexpr Eigen::Index steps = 360;
  constexpr int most_speed_harmonics = 36;
  // Three of the tooth passing; many teeth need no more than its first.
  const int wanted = std::max(teeth, std::min(std::max(3 * teeth, 12), most_speed_harmonics));
  const int harmonics = std::min(wanted, std::max(1, static_cast<int>(std::ceil(0.5 / turns)) - 1));
  Speed out{tolerance > 0.0 ? detail::find_speed(without_mean(stretch), turns, tolerance, harmonics) : turns, {}};
  for (int pass = 0; pass < passes; ++pass) {
    const Revolutions revolutions = detail::revolutions_at(stretch, 1.0, out.turns, steps);
    if (revolutions.size() < 3) return out;  // no line through fewer
    out.angles = detail::angles_of(revolutions);
    if (tolerance > 0.0) out.turns *= 1.0 + out.angles.slope_rad / (2.0 * pi);
  }
  return out;
}

/// Takes the straight line through the means out of the revolutions, about its middle. Its rise over all of them, and
/// the scatter of the means about it.
std::pair<Eigen::Vector3d, Eigen::Vector3d> take_drift(Revolutions& revolutions) {
  const auto count = static_cast<Eigen::Index>(revolutions.size());
  Eigen::Matrix3Xd means(3, count);
  for (Eigen::Index b = 0; b < count; ++b) means.col(b) = revolutions[static_cast<std::size_t>(b)].rowwise().mean();
  const Eigen::RowVectorXd place =
      Eigen::RowVectorXd::LinSpaced(count, -0.5 * static_cast<double>(count - 1), 0.5 * static_cast<double>(count - 1));
  const Eigen::Vector3d slope = means * place.transpose() / place.squaredNorm();
  const Eigen::Matrix3Xd left = without_mean(means) - slope * place;
  for (Eigen::Index b = 0; b < count; ++b) {
    Eigen::Matrix3Xd& revolution = revolutions[static_cast<std::size_t>(b)];
    const Eigen::Index steps = revolution.cols();
    for (Eigen::Index i = 0; i < steps; ++i) {
      revolution.col(i) -= slope * (place(b) + static_cast<double>(i) / static_cast<double>(steps) - 0.5);
    }
  }
  return {slope * static_cast<double>(count),
          (left.rowwise().squaredNorm() / static_cast<double>(std::max<Eigen::Index>(count - 2, 1))).cwiseSqrt()};
}

/// What differs from tooth to tooth: the root mean square of the revolution less the mean over its teeth, which has the
/// harmonics that are multiples of them.
Eigen::Vector3d between_teeth(const Eigen::Matrix3Xd& force, int teeth) {
  const Eigen::Index steps = force.cols();
  Eigen::Vector3d squares = force.rowwise().squaredNorm() / static_cast<double>(steps);
  if (teeth == 1) return Eigen::Vector3d::Zero();
  for (Eigen::Index k = 0; 2 * k <= steps; k += teeth) {
    squares -= (k == 0 || 2 * k == steps ? 1.0 : 2.0) * detail::harmonic(force, k).cwiseAbs2();
  }
  return squares.cwiseMax(0.0).cwiseSqrt();
}

void describe(const Revolutions& revolutions, MeasuredForce& out) {
  const auto count = static_cast<double>(revolutions.size());
  out.force_n = detail::mean_of(revolutions);
  Eigen::Matrix3Xd squares = Eigen::Matrix3Xd::Zero(3, out.force_n.cols());
  for (const Eigen::Matrix3Xd& revolution : revolutions) squares += (revolution - out.force_n).cwiseAbs2();
  out.deviation_n = (squares / (count - 1.0)).cwiseSqrt();
  out.scatter_n = rms_of(out.deviation_n);
  out.mean_n = out.force_n.rowwise().mean();
  out.peak_n = detail::peaks_of(out.force_n);
  out.rms_n = rms_of(out.force_n);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero(), sum_of_squares = Eigen::Vector3d::Zero();
  for (const Eigen::Matrix3Xd& revolution : revolutions) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const double peak = out.peak_n(axis) < 0.0 ? revolution.row(axis).minCoeff() : revolution.row(axis).maxCoeff();
      const double beyond = peak - out.peak_n(axis);
      sum(axis) += beyond;
      sum_of_squares(axis) += beyond * beyond;
    }
  }
  out.peak_deviation_n = ((sum_of_squares - sum.cwiseAbs2() / count).cwiseMax(0.0) / (count - 1.0)).cwiseSqrt();
}

void compare(const Eigen::Matrix3Xd& predicted, MeasuredForce& out) {
  out.predicted_mean_n = predicted.rowwise().mean();
  out.predicted_peak_n = detail::peaks_of(predicted);
  out.predicted_rms_n = rms_of(predicted);
  const Eigen::Matrix3Xd error = predicted - out.force_n;
  out.error_n = rms_of(error);
  out.error_ratio = out.error_n.cwiseQuotient(out.rms_n);
  out.shape_error_n = rms_of(without_mean(error));
  out.shape_error_ratio = out.shape_error_n.cwiseQuotient(rms_of(without_mean(out.force_n)));
  out.error_ratio_of_all = error.norm() / out.force_n.norm();
}

void add_harmonics(const Eigen::Matrix3Xd& predicted, MeasuredForce& out) {
  constexpr int most = 16;
  const double rotation_hz = out.spindle_speed_rad_per_s / (2.0 * pi);
  for (int k = 1; k <= most && k * rotation_hz < 0.5 * out.sample_rate_hz && 2 * k < out.force_n.cols(); ++k) {
    out.harmonics.push_back({.multiple = k,
                             .frequency_hz = k * rotation_hz,
                             .measured_n = 2.0 * detail::harmonic(out.force_n, k).cwiseAbs(),
                             .predicted_n = 2.0 * detail::harmonic(predicted, k).cwiseAbs()});
  }
}

void find_better_axes(double period_rad, const Eigen::Matrix3Xd& predicted, MeasuredForce& out) {
  constexpr double worth_it = 0.3, better = 0.75;
  if (out.error_ratio_of_all < worth_it) return;
  const Eigen::Matrix3Xd& measured = out.force_n;
  const detail::Correlation correlation(measured, predicted);
  double least = better * out.error_ratio_of_all;
  for (const SignedAxes& axes : detail::all_signed_axes()) {
    const double alike = correlation.best(period_rad, axes).second * static_cast<double>(measured.cols());
    const double error = measured.squaredNorm() + predicted.squaredNorm() - 2.0 * alike;
    const double ratio = std::sqrt(std::max(error, 0.0)) / measured.norm();
    if (ratio >= least) continue;
    least = ratio;
    out.better_axes = axes;
    out.better_axes_error_ratio = ratio;
  }
}

/// What was not measured has no numbers.
void blank(const Measured& measured, MeasuredForce& out) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (measured[static_cast<std::size_t>(axis)]) continue;
    out.force_n.row(axis).setConstant(none);
    out.deviation_n.row(axis).setConstant(none);
    for (Eigen::Vector3d* of :
         {&out.zero_n, &out.drift_n, &out.mean_n, &out.peak_n, &out.rms_n, &out.mean_deviation_n, &out.peak_deviation_n,
          &out.scatter_n, &out.between_teeth_n, &out.predicted_mean_n, &out.predicted_peak_n, &out.predicted_rms_n,
          &out.error_n, &out.error_ratio, &out.shape_error_n, &out.shape_error_ratio}) {
      (*of)(axis) = none;
    }
    for (ForceHarmonic& harmonic : out.harmonics) harmonic.measured_n(axis) = harmonic.predicted_n(axis) = none;
  }
}

/// @throws InvalidInput where the mean revolution is noise, or next to nothing beside the prediction
void check_signal(const MeasuredForce& found, const Eigen::Matrix3Xd& predicted) {
  const double varies = without_mean(found.force_n).squaredNorm() / static_cast<double>(found.force_n.cols());
  const double noise = found.scatter_n.squaredNorm() / found.revolutions;
  if (varies < least_variance_over_noise * noise) {
    throw InvalidInput("record",
                       fmt::format("repeats nothing with the rotation: its mean revolution varies by {:.3g} N, which "
                                   "noise alone would give it",
                                   std::sqrt(varies)),
                       "No tooth is in the cut, the cut is shorter than five revolutions, or the speed is another one");
  }
  const double expected = without_mean(predicted).norm() / std::sqrt(static_cast<double>(predicted.cols()));
  if (std::sqrt(varies) < least_share_of_prediction * expected) {
    throw InvalidInput("record",
                       fmt::format("varies by {:.3g} N over a revolution, less than {:.0f} % of the predicted {:.3g} N",
                                   std::sqrt(varies), 100.0 * least_share_of_prediction, expected),
                       "Is the tool in air, or are these kN?");
  }
}

/// The highest multiple of the rotation with a tenth of the largest amplitude of all.
int highest_harmonic(const Eigen::Matrix3Xd& force) {
  constexpr Eigen::Index most = 256;
  const Eigen::Index count = std::min(most, (force.cols() - 1) / 2);
  Eigen::VectorXd amplitude(count);
  for (Eigen::Index k = 0; k < count; ++k) amplitude(k) = detail::harmonic(force, k + 1).norm();
  const double least = 0.1 * amplitude.maxCoeff();
  Eigen::Index last = count;
  while (last > 1 && amplitude(last - 1) < least) --last;
  return static_cast<int>(last);
}

void add_notes(const MeasuredForceOptions& options, int teeth, const Eigen::Matrix3Xd& predicted, MeasuredForce& out) {
  const double change = out.spindle_speed_rad_per_s / options.spindle_speed_rad_per_s - 1.0;
  if (options.speed_tolerance > 0.0 && std::abs(change) > 0.98 * options.speed_tolerance) {
    out.notes.push_back(
        fmt::format("The record's speed lies {:+.2f} % from the given one, at the border of what was searched: the "
                    "given one may be wrong.",
                    100.0 * change));
  }
  out.notes.push_back(fmt::format(
      "The predicted force has harmonics of a tenth of its largest up to {:.0f} Hz: what the dynamometer adds near its "
      "resonances, and what it loses above its bandwidth, is in the measured one.",
      out.spindle_speed_rad_per_s / (2.0 * pi) * highest_harmonic(predicted)));
  const double tooth_rad = 2.0 * pi / teeth;
  if (out.wander_rad > 0.05 * tooth_rad) {
    out.notes.push_back(fmt::format(
        "Single revolutions lie {:.2g}° apart in angle: the speed wanders, and the mean revolution is smoothed by it.",
        out.wander_rad / units::deg));
  }
}

/// Where the revolutions lie in the record, and how fast they are.
void set_place(double begin_sample, std::size_t revolutions, const Speed& speed, MeasuredForce& out) {
  const double count = static_cast<double>(revolutions);
  out.revolutions = static_cast<int>(revolutions);
  out.from_s = begin_sample / out.sample_rate_hz;
  out.to_s = out.from_s + count / (speed.turns * out.sample_rate_hz);
  const double rad_per_s = 2.0 * pi * out.sample_rate_hz;
  out.spindle_speed_rad_per_s = speed.turns * rad_per_s;
  out.spindle_speed_deviation_rad_per_s = speed.turns * rad_per_s * speed.angles.slope_deviation_rad / (2.0 * pi);
  out.wander_rad = speed.angles.scatter_rad;
  out.offset_deviation_rad = out.wander_rad / std::sqrt(count);
}

}  // namespace

void MeasuredForceOptions::validate() const {
  require_positive("spindle_speed_rad_per_s", spindle_speed_rad_per_s, "rad/s");
  if (!(speed_tolerance >= 0.0 && speed_tolerance <= 0.1)) {
    throw InvalidInput("speed_tolerance", speed_tolerance, "", "must lie between 0 and 0.1");
  }
  require_non_negative("from_s", from_s, "s");
  if (!(to_s > from_s)) throw InvalidInput("to_s", to_s, "s", "must be > from_s");
}

MeasuredForce compare_forces(const ForceRecord& record, const PredictedRevolution& predicted,
                             const MeasuredForceOptions& options) {
  options.validate();
  require_positive("sample_rate_hz", record.sample_rate_hz, "Hz");
  const Measured measured = measured_components(record);
  const Eigen::Matrix3Xd prediction = measured_only(predicted.force_n, measured);
  check_prediction(predicted, prediction);
  const Eigen::Matrix3Xd force = measured_only(record.force_n, measured);
  const double samples = samples_a_revolution(record, predicted, options);
  MeasuredForce out;
  out.sample_rate_hz = record.sample_rate_hz;
  out.revolutions_in_record = static_cast<int>(static_cast<double>(force.cols()) / samples);
  if (out.revolutions_in_record < least_revolutions) throw too_few(out.revolutions_in_record, options, "");

  const Eigen::Index steps = predicted.rotation_rad.size();
  Stretch at = stretch_of(force, samples, steps, record, options);
  const auto begin = static_cast<Eigen::Index>(at.run.begin * samples);
  const auto length =
      std::min(static_cast<Eigen::Index>(std::ceil(at.run.length() * samples)) + 4, force.cols() - begin);
  const Eigen::Matrix3Xd stretch = force.middleCols(begin, length);
  const Speed speed = refined(stretch, 1.0 / samples, predicted.teeth, options.speed_tolerance);
  const double period_rad = predicted.teeth_alike ? 2.0 * pi / predicted.teeth : 2.0 * pi;
  Revolutions revolutions = detail::revolutions_at(stretch, 1.0, speed.turns, steps);
  if (revolutions.empty()) throw too_few(0, options, "in the cut ");
  const detail::Correlation correlation(detail::mean_of(revolutions), prediction);
  const double offset_rad = correlation.best_offset(period_rad).first;

  // Once more, from where tooth 0 stands at the prediction's first step: nothing is interpolated twice.
  const double to_first_rad = std::remainder(-offset_rad, period_rad);
  const double first = 1.0 + (to_first_rad < 0.0 ? to_first_rad + period_rad : to_first_rad) / (2.0 * pi * speed.turns);
  revolutions = detail::revolutions_at(stretch, first, speed.turns, steps);
  if (revolutions.size() < least_revolutions) {
    throw too_few(static_cast<int>(revolutions.size()), options,
                  "in the cut from where tooth 0 stands at the first step ");
  }
  std::tie(out.drift_n, out.mean_deviation_n) = take_drift(revolutions);
  out.notes = std::move(at.notes);
  set_zero(force, samples, at, out);
  for (Eigen::Matrix3Xd& revolution : revolutions) revolution.colwise() -= out.zero_n;

  set_place(static_cast<double>(begin) + first, revolutions.size(), speed, out);
  out.rotation_rad = predicted.rotation_rad;
  describe(revolutions, out);
  check_signal(out, prediction);
  out.between_teeth_n = between_teeth(out.force_n, predicted.teeth);
  compare(prediction, out);
  add_harmonics(prediction, out);
  if (std::ranges::all_of(measured, [](bool has) { return has; })) {
    find_better_axes(period_rad, prediction, out);
  }
  add_notes(options, predicted.teeth, prediction, out);
  blank(measured, out);
  return out;
}

}  // namespace robomill::cutting
