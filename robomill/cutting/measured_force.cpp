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

namespace robomill::cutting {
namespace {

using detail::Run;
using std::numbers::pi;
using Measured = std::array<bool, 3>;
using Revolutions = std::vector<Eigen::Matrix3Xd>;

constexpr int least_revolutions = 5;
constexpr int most_revolutions = 200;
constexpr double least_samples_a_tooth = 4.0;
/// A mean revolution of noise alone has once the variance that the scatter gives it.
constexpr double least_variance_over_noise = 4.0;
constexpr double least_share_of_prediction = 0.02;

/// Root mean square of each row.
Eigen::Vector3d rms_of(const Eigen::Matrix3Xd& force) {
  return (force.rowwise().squaredNorm() / static_cast<double>(force.cols())).cwiseSqrt();
}
Eigen::Matrix3Xd without_mean(const Eigen::Matrix3Xd& force) {
  return force.colwise() - Eigen::Vector3d(force.rowwise().mean());
}

InvalidInput too_few(int count, const MeasuredForceOptions& options, const char* what) {
  return InvalidInput("record", fmt::format("has {} whole revolution{} {} at {:.6g} rpm; at least {} are needed", count,
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
  if (force.squaredNorm() == 0.0) {
    throw InvalidInput("predicted", "has no force: no tooth is in the material",
                       "Compare a cut that engages the cutter");
  }
  if (without_mean(force).squaredNorm() < 1e-12 * force.squaredNorm()) {
    throw InvalidInput("predicted",
                       "does not vary over the revolution, so that nothing says how the record lies to it");
  }
}

/// Where in the record it cuts, in revolutions at the speed as given, and the mean of what is air.
struct Stretch {
  Run run;
  std::vector<int> air;
};

Stretch stretch_of(const Eigen::Matrix3Xd& force, double samples, const ForceRecord& record,
                   const MeasuredForceOptions& options) {
  detail::CutAndAir found = detail::find_cut(detail::variation_by_revolution(force, samples));
  Stretch out{found.cut, std::move(found.air)};
  if (std::isfinite(options.to_s)) {
    const double per_s = record.sample_rate_hz / samples;
    out.run.begin = static_cast<int>(std::ceil(options.from_s * per_s - 1e-6));
    out.run.end = static_cast<int>(
        std::min(std::floor(options.to_s * per_s + 1e-6), std::floor(static_cast<double>(force.cols()) / samples)));
    std::erase_if(out.air, [&](int b) { return b >= out.run.begin && b < out.run.end; });
    if (out.run.length() < least_revolutions)
      throw too_few(std::max(out.run.length(), 0), options, "in this stretch of time");
  } else if (out.run.length() < least_revolutions) {
    throw too_few(out.run.length(), options, "in the cut");
  }
  if (out.air.size() < least_revolutions) out.air.clear();
  const int more = out.run.length() - most_revolutions;
  if (more > 0) {
    out.run.begin += more / 2;
    out.run.end = out.run.begin + most_revolutions;
  }
  return out;
}

Eigen::Vector3d mean_of_air(const Eigen::Matrix3Xd& force, double samples, const std::vector<int>& air) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const int b : air) {
    sum +=
        force.middleCols(static_cast<Eigen::Index>(b * samples), static_cast<Eigen::Index>(samples)).rowwise().mean();
  }
  return air.empty() ? sum : Eigen::Vector3d(sum / static_cast<double>(air.size()));
}

/// The record's own speed, in turns a sample, and the angle of its revolutions.
struct Speed {
  double turns = 0.0;
  detail::Angles angles;
};

Speed refined(const Eigen::Matrix3Xd& stretch, double turns, int teeth, double tolerance) {
  constexpr int passes = 3;
  constexpr Eigen::Index steps = 360;
  const int harmonics = std::clamp(3 * teeth, 12, std::max(1, static_cast<int>(0.5 / turns) - 1));
  Speed out{tolerance > 0.0 ? detail::find_speed(without_mean(stretch), turns, tolerance, harmonics) : turns, {}};
  for (int pass = 0; pass < passes; ++pass) {
    const Revolutions revolutions = detail::revolutions_at(stretch, 1.0, out.turns, steps);
    if (revolutions.size() < 3) return out;
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

/// What differs from tooth to tooth: the revolution less the mean over its teeth.
Eigen::Vector3d between_teeth(const Eigen::Matrix3Xd& force, int teeth) {
  const Eigen::Index steps = force.cols();
  Eigen::Matrix3Xd tooth = Eigen::Matrix3Xd::Zero(3, steps);
  for (int j = 0; j < teeth; ++j) {
    const auto shift = static_cast<Eigen::Index>(std::lround(static_cast<double>(j * steps) / teeth));
    for (Eigen::Index i = 0; i < steps; ++i) tooth.col(i) += force.col((i + shift) % steps);
  }
  return rms_of(force - tooth / static_cast<double>(teeth));
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
                       "No tooth is in the cut, or the speed is another one");
  }
  const double expected = without_mean(predicted).norm() / std::sqrt(static_cast<double>(predicted.cols()));
  if (std::sqrt(varies) < least_share_of_prediction * expected) {
    throw InvalidInput("record",
                       fmt::format("varies by {:.3g} N over a revolution, less than {:.0f} % of the predicted {:.3g} N",
                                   std::sqrt(varies), 100.0 * least_share_of_prediction, expected),
                       "Is the tool in air, or are these kN?");
  }
}

void add_notes(const MeasuredForceOptions& options, int teeth, MeasuredForce& out) {
  const double change = out.spindle_speed_rad_per_s / options.spindle_speed_rad_per_s - 1.0;
  if (options.speed_tolerance > 0.0 && std::abs(change) > 0.98 * options.speed_tolerance) {
    out.notes.push_back(
        fmt::format("The record's speed lies {:+.2f} % from the given one, at the border of what was searched: the "
                    "given one may be wrong.",
                    100.0 * change));
  }
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
  const double samples = 2.0 * pi * record.sample_rate_hz / options.spindle_speed_rad_per_s;
  if (samples < least_samples_a_tooth * predicted.teeth) {
    throw InvalidInput("sample_rate_hz", record.sample_rate_hz, "Hz",
                       fmt::format("must give at least {:.0f} samples a tooth; it gives {:.2g}", least_samples_a_tooth,
                                   samples / predicted.teeth));
  }
  MeasuredForce out;
  out.sample_rate_hz = record.sample_rate_hz;
  out.revolutions_in_record = static_cast<int>(static_cast<double>(force.cols()) / samples);
  if (out.revolutions_in_record < least_revolutions) throw too_few(out.revolutions_in_record, options, "");

  const Stretch at = stretch_of(force, samples, record, options);
  const auto begin = static_cast<Eigen::Index>(at.run.begin * samples);
  const auto length =
      std::min(static_cast<Eigen::Index>(std::ceil(at.run.length() * samples)) + 4, force.cols() - begin);
  const Eigen::Matrix3Xd stretch = force.middleCols(begin, length);
  const Speed speed = refined(stretch, 1.0 / samples, predicted.teeth, options.speed_tolerance);
  const double period_rad = predicted.teeth_alike ? 2.0 * pi / predicted.teeth : 2.0 * pi;
  const Eigen::Index steps = predicted.rotation_rad.size();
  Revolutions revolutions = detail::revolutions_at(stretch, 1.0, speed.turns, steps);
  if (revolutions.size() < 3) throw too_few(static_cast<int>(revolutions.size()), options, "in the cut");
  const detail::Correlation correlation(detail::mean_of(revolutions), prediction);
  const double offset_rad = correlation.best_offset(period_rad).first;

  // Once more, from where tooth 0 stands at the prediction's first step: nothing is interpolated twice.
  const double to_first_rad = std::remainder(predicted.rotation_rad(0) - offset_rad, period_rad);
  const double first = 1.0 + (to_first_rad < 0.0 ? to_first_rad + period_rad : to_first_rad) / (2.0 * pi * speed.turns);
  revolutions = detail::revolutions_at(stretch, first, speed.turns, steps);
  if (revolutions.size() < 3) throw too_few(static_cast<int>(revolutions.size()), options, "in the cut");
  std::tie(out.drift_n, out.mean_deviation_n) = take_drift(revolutions);
  out.zero_n = mean_of_air(force, samples, at.air);
  out.air_revolutions = static_cast<int>(at.air.size());
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
  add_notes(options, predicted.teeth, out);
  blank(measured, out);
  return out;
}

}  // namespace robomill::cutting
