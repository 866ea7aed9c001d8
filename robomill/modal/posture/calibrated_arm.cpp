#include "robomill/modal/posture/calibrated_arm.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "robomill/modal/posture/calibration.hpp"
#include "robomill/modal/posture/column_deviation.hpp"
#include "robomill/modal/posture/tool_peaks.hpp"

namespace robomill::modal::detail {
namespace {

using std::numbers::pi;

std::vector<Dof> tip_dofs() {
  return {{.point = 0, .axis = Axis::x}, {.point = 0, .axis = Axis::y}, {.point = 0, .axis = Axis::z}};
}

/// Relative standard deviation of a mode's residue. Modes whose peaks overlap swap shares from posture to posture while
/// the sum of their residues stays: of those it is the deviation of the sum.
/// @param scale  factor on the deviation of each of the nine entries
double residue_deviation(const FlexibleArm::Modes& modes, const FlexibleArm::Sensitivity& by,
                         const Eigen::MatrixXd& covariance, const Eigen::Matrix<double, 9, 1>& scale, Eigen::Index k) {
  Eigen::MatrixXcd change = Eigen::MatrixXcd::Zero(9, covariance.rows());
  Eigen::Matrix3cd sum = Eigen::Matrix3cd::Zero();
  for (Eigen::Index j = 0; j < modes.pole.size(); ++j) {
    const double apart = std::abs(std::abs(modes.pole(j)) - std::abs(modes.pole(k)));
    if (apart > -modes.pole(j).real() - modes.pole(k).real()) continue;
    const Eigen::Matrix3cd residue = modes.at_tip.col(j) * modes.at_tip.col(j).transpose();
    change += residue.norm() * by.residue[static_cast<std::size_t>(j)];
    sum += residue;
  }
  change = scale.asDiagonal() * change;
  return std::sqrt(total_variance(change, covariance)) / sum.norm();
}

/// A model of the arm, calibrated or as the cell says.
class CalibratedArm final : public PostureSource {
 public:
  CalibratedArm(const robot::Cell& told, const std::optional<robot::Link>& payload,
                const std::vector<MeasuredPosture>& measured, const PostureModelOptions& options,
                const PostureCalibration* kept, Progress& progress)
      : highest_hz_(options.band_high_hz), payload_(payload) {
    cell = told;
    std::vector<PostureData> data;
    for (const MeasuredPosture& posture : measured) {
      data.emplace_back(posture, options);
      postures.push_back(posture.joints);
    }
    report.source = measured.empty() ? PostureReport::Source::cell : PostureReport::Source::calibrated;
    if (kept != nullptr && !measured.empty()) {
      data_ = std::make_unique<CalibrationData>(data, CalibrationData::Stages::last);
      if (take(*kept, progress)) return;
    }
    data_ = std::make_unique<CalibrationData>(data);
    searched_ = !measured.empty();
    if (searched_) {
      choose(tool_peaks(cell, data, highest_hz_), progress);
      judge_columns(progress, nullptr);
      return;
    }
    Candidate as_told{.arm = arm_of({}, {})};
    as_told.calibration =
        calibrate(*as_told.arm, *data_, highest_hz_, {}, {.parameters = as_told.arm->start()}, progress);
    keep(std::move(as_told));
    report.notes.push_back(
        "No posture was measured: the modes are those of the cell's own numbers, with rigid bearings and no tool.");
  }

  [[nodiscard]] bool searched() const { return searched_; }

  [[nodiscard]] std::optional<PostureCalibration> calibration() const override {
    if (data_->size() == 0) return std::nullopt;
    PostureCalibration out{.structure = arm_->structure(),
                           .tools = arm_->tools(),
                           .common = calibration_.common,
                           .differing = calibration_.differing,
                           .noise = calibration_.noise,
                           .error = calibration_.error,
                           .left_out = calibration_.left_out,
                           .unmeasured_scale = unmeasured_scale_,
                           .band_scale = band_scale_};
    for (std::size_t k = 0; k < report.direct.size(); ++k) {
      out.held_out_error(static_cast<Eigen::Index>(k)) = report.direct[k].held_out_error;
    }
    return out;
  }

  [[nodiscard]] ModalModel at(const Eigen::VectorXd& joints) const override {
    const PostureParameters parameters = predict(*arm_, calibration_, postures, joints);
    const FlexibleArm::System system = arm_->at(joints, parameters.mean);
    const FlexibleArm::Modes modes = arm_->modes(system, highest_hz_);
    const FlexibleArm::Sensitivity by = arm_->sensitivity(system, modes);
    ModalModel out{.excitations = tip_dofs(), .responses = tip_dofs(), .modes = {}};
    for (Eigen::Index k = 0; k < modes.pole.size(); ++k) {
      Mode mode;
      const double rate = std::abs(modes.pole(k));
      mode.frequency_hz = rate / (2.0 * pi);
      mode.damping_ratio = std::clamp(-modes.pole(k).real() / rate, 1e-6, 0.999);
      mode.left = mode.right = modes.at_tip.col(k);
      const auto deviation = [&](const Eigen::RowVectorXd& row) {
        return std::sqrt(std::max(0.0, (row * parameters.covariance * row.transpose()).value()));
      };
      const double unmeasured = unmeasured_share(modes.at_tip.col(k));
      mode.frequency_std_hz = mode.frequency_hz * widened(calibration_.left_out.frequency_scale, unmeasured) *
                              deviation(by.log_frequency.row(k));
      mode.damping_ratio_std =
          widened(calibration_.left_out.damping_scale, unmeasured) * deviation(by.damping_ratio.row(k));
      mode.residue_std_ratio = residue_deviation(modes, by, parameters.covariance, entry_scale(), k);
      normalise(mode);
      out.modes.push_back(std::move(mode));
    }
    const std::vector<Dof> dofs = tip_dofs();
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) {
        out.residuals.push_back({.name = {dofs[static_cast<std::size_t>(i)], dofs[static_cast<std::size_t>(j)]},
                                 .stiffness = modes.rest(i, j)});
      }
    }
    return out;
  }

  [[nodiscard]] Eigen::Vector3d direct_deviation(const Eigen::VectorXd& joints) const override {
    Eigen::Vector3d out = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    if (data_->size() == 0) return out;
    const PostureParameters parameters = predict(*arm_, calibration_, postures, joints);
    const FlexibleArm::System system = arm_->at(joints, parameters.mean);
    const SmoothedFrf& lines = data_->last_stage().front();
    const Eigen::Vector3d covered = detail::direct_deviation(*arm_, system, parameters.covariance, lines);
    const Eigen::Vector3d beyond = unmodelled_ ? unmodelled_->deviation(system) : Eigen::Vector3d::Zero().eval();
    double held_out = 0.0;
    for (const PostureReport::Direct& direct : report.direct) held_out = std::fmax(held_out, direct.held_out_error);
    for (std::size_t k = 0; k < report.direct.size(); ++k) {
      const PostureReport::Direct& direct = report.direct[k];
      const auto axis = static_cast<Eigen::Index>(k);
      // What left-out postures show of a measured axis grows as the covariance does, away from what was measured.
      const bool left_out = std::isfinite(direct.left_out_error);
      const double usual = left_out ? calibration_.left_out.predicted(axis) : covered(axis);
      const double shown = left_out ? direct.left_out_error : direct.error;
      const double known = direct.measured ? shown * std::max(1.0, covered(axis) / usual)
                                           : std::max(held_out, unmeasured_scale_ * covered(axis));
      out(axis) = std::hypot(known, taken_up * beyond(axis));
    }
    return out;
  }

 private:
  /// Fewer postures do not tell structures apart.
  static constexpr std::size_t fewest_for_structure = 3;
  /// Where one axis alone was measured, nothing shows what the covariance of an unmeasured one is worth.
  static constexpr double scale_without_evidence = 3.0;
  static constexpr double largest_scale = 10.0;  ///< of deviations
  /// The calibration takes up about half of what its model lacks: simulated arms whose spindle deflects along its
  /// axis.
  static constexpr double taken_up = 2.0;

  /// A structure calibrated.
  struct Candidate {
    std::unique_ptr<FlexibleArm> arm = nullptr;
    Calibration calibration = {};
    /// What it is judged by: receptances of left-out postures, where there are enough.
    [[nodiscard]] double error() const {
      return std::isfinite(calibration.left_out.error) ? calibration.left_out.error : calibration.error;
    }
  };

  [[nodiscard]] std::unique_ptr<FlexibleArm> arm_of(const ArmStructure& structure,
                                                    const std::vector<FlexibleArm::Tool>& tools) const {
    auto out = std::make_unique<FlexibleArm>(cell, payload_, structure, tools);
    if (!postures.empty()) out->scale_loads(postures);
    return out;
  }

  [[nodiscard]] bool varying() const { return postures.size() >= fewest_for_structure; }

  /// The outcome of an earlier search. False where it is not of these inputs.
  bool take(const PostureCalibration& kept, Progress& progress) {
    Candidate known{.arm = arm_of(kept.structure, kept.tools)};
    std::optional<Calibration> calibration = again(*known.arm, *data_, varying(), kept);
    if (!calibration) return false;
    known.calibration = std::move(*calibration);
    keep(std::move(known));
    judge_columns(progress, &kept);
    return true;
  }

  using Start = std::pair<ArmStructure, std::vector<FlexibleArm::Tool>>;
  struct Begun {
    std::unique_ptr<FlexibleArm> arm = nullptr;
    Beginning at = {.parameters = {}, .noise = std::numeric_limits<double>::infinity()};
  };

  /// The best of several starts, told by their structures' and tools' first guesses.
  [[nodiscard]] Begun begin(const std::vector<Start>& starts, Progress& progress) const {
    Begun out;
    for (const auto& [structure, tools] : starts) {
      std::unique_ptr<FlexibleArm> arm = arm_of(structure, tools);
      Beginning at = begin_calibration(*arm, *data_, progress);
      progress.advance();
      if (out.arm != nullptr && !(at.noise < out.at.noise)) continue;
      out.at = std::move(at);
      out.arm = std::move(arm);
    }
    return out;
  }

  [[nodiscard]] Candidate finish(Begun begun, Progress& progress) const {
    Candidate out{.arm = std::move(begun.arm)};
    out.calibration = calibrate(*out.arm, *data_, highest_hz_, {.varying = varying()}, begun.at, progress);
    progress.advance();
    return out;
  }

  void keep(Candidate best) {
    report.bearings = best.arm->structure().bearings;
    report.bracket = best.arm->structure().bracket;
    report.tool_modes = best.arm->structure().tool_modes;
    report.error = best.calibration.error;
    report.left_out_error = best.calibration.left_out.error;
    arm_ = std::move(best.arm);
    calibration_ = std::move(best.calibration);
  }

  /// How much wider than its covariance what was not measured is, over the measured postures.
  void widen_bands(const std::vector<FlexibleArm::System>& systems) {
    Eigen::Vector3d stated = Eigen::Vector3d::Zero(), covered = Eigen::Vector3d::Zero();
    for (std::size_t p = 0; p < postures.size(); ++p) {
      stated += direct_deviation(postures[p]);
      covered += detail::direct_deviation(
          *arm_, systems[p], predict(*arm_, calibration_, postures, postures[p]).covariance, data_->last_stage()[p]);
    }
    for (std::size_t axis = 0; axis < report.direct.size(); ++axis) {
      const auto a = static_cast<Eigen::Index>(axis);
      if (!report.direct[axis].measured) band_scale_ = std::clamp(stated(a) / covered(a), band_scale_, largest_scale);
    }
  }

  /// How well each direct receptance is known, and what an axis costs that nobody hit along.
  /// @param kept  what an earlier search found of that, or null
  void judge_columns(Progress& progress, const PostureCalibration* kept) {
    std::vector<FlexibleArm::System> systems;
    for (const Eigen::VectorXd& joints : postures) {
      systems.push_back(arm_->at(joints, predict(*arm_, calibration_, postures, joints).mean));
    }
    int measured = 0;
    for (int axis = 0; axis < 3; ++axis) {
      PostureReport::Direct& direct = report.direct[static_cast<std::size_t>(axis)];
      direct.measured = is_measured(*data_, axis);
      if (!direct.measured) continue;
      ++measured;
      DirectError all;
      for (std::size_t k = 0; k < data_->size(); ++k) {
        const DirectError one = direct_error(systems[k], data_->last_stage()[k], axis);
        all.error += one.error;
        all.size += one.size;
      }
      direct.error = all.ratio();
      if (std::isfinite(calibration_.left_out.error)) direct.left_out_error = calibration_.left_out.direct(axis);
    }
    unmodelled_.emplace(systems, *data_);
    if (kept != nullptr) {
      for (std::size_t k = 0; k < report.direct.size(); ++k) {
        report.direct[k].held_out_error = kept->held_out_error(static_cast<Eigen::Index>(k));
      }
      unmeasured_scale_ = kept->unmeasured_scale;
      band_scale_ = kept->band_scale;
      return;
    }
    if (measured == 3) return;
    if (measured < 2) {
      unmeasured_scale_ = scale_without_evidence;
      widen_bands(systems);
      return;
    }
    for (int axis = 0; axis < 3; ++axis) {
      PostureReport::Direct& direct = report.direct[static_cast<std::size_t>(axis)];
      if (!direct.measured) continue;
      const HeldOut out = hold_out(*arm_, *data_, highest_hz_, varying(),
                                   {.parameters = calibration_.common, .noise = calibration_.noise}, axis, progress);
      direct.held_out_error = out.error;
      unmeasured_scale_ = std::clamp(out.error / out.predicted, unmeasured_scale_, largest_scale);
    }
    widen_bands(systems);
  }

  /// Of a mode's residue, what lies in direct entries that nobody measured.
  [[nodiscard]] double unmeasured_share(const Eigen::Vector3cd& at_tip) const {
    double share = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!is_unmeasured(axis)) continue;
      const double part = std::norm(at_tip(static_cast<Eigen::Index>(axis))) / at_tip.squaredNorm();
      share += part * part;
    }
    return share;
  }
  [[nodiscard]] bool is_unmeasured(std::size_t axis) const {
    return data_->size() > 0 && !report.direct[axis].measured;
  }
  [[nodiscard]] double widened(double scale, double unmeasured) const {
    const double wide = std::max(scale, band_scale_);
    return std::sqrt((1.0 - unmeasured) * scale * scale + unmeasured * wide * wide);
  }
  [[nodiscard]] Eigen::Matrix<double, 9, 1> entry_scale() const {
    Eigen::Matrix<double, 9, 1> scale = Eigen::Matrix<double, 9, 1>::Constant(calibration_.left_out.residue_scale);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (is_unmeasured(axis)) scale(4 * static_cast<Eigen::Index>(axis)) = std::max(scale(0), band_scale_);
    }
    return scale;
  }

  /// The structure that predicts left-out receptances best; a bracket has to pay for itself.
  void choose(const std::vector<FlexibleArm::Tool>& peaks, Progress& progress) {
    constexpr double worth = 0.97;
    const bool several = varying();
    std::vector<Start> stiff, tilting, stiffer;
    if (peaks.empty() || !several) stiff.push_back({{.bearings = true, .load = several}, {}});
    for (std::size_t k = 0; several && k < std::max<std::size_t>(peaks.size(), 1); ++k) {
      // What carries the tool lowers the peak below the tool's own frequency, a soft bracket by much.
      const auto tools = [&](double above_peak) {
        return peaks.empty() ? std::vector<FlexibleArm::Tool>{} : chain(peaks[k], above_peak);
      };
      constexpr double far_above = 1.25;
      if (!peaks.empty()) stiff.push_back({{.bearings = true, .load = true}, tools(1.0)});
      for (const double inner_share : {0.25, 0.5}) {
        const ArmStructure structure{.bearings = true, .bracket = true, .inner_share = inner_share, .load = true};
        tilting.push_back({structure, tools(1.0)});
        stiffer.push_back({structure, tools(far_above)});
      }
    }
    progress.start("posture model", stiff.size() + 1 + (several ? tilting.size() + stiffer.size() + 1 : 0));
    Candidate best = finish(begin(stiff, progress), progress);
    if (several) {
      // In units of 5 % of the receptance squared, neighbouring lines alike: more is a wrong valley.
      constexpr double well_fitted = 4.0;
      Begun begun = begin(tilting, progress);
      if (begun.at.noise > well_fitted) {
        Begun again = begin(stiffer, progress);
        if (again.at.noise < begun.at.noise) begun = std::move(again);
      }
      Candidate other = finish(std::move(begun), progress);
      if (other.error() < worth * best.error()) best = std::move(other);
    }
    keep(std::move(best));
  }

  /// Two masses: a peak's, and one with its own mode beyond the band, which still acts within it.
  [[nodiscard]] std::vector<FlexibleArm::Tool> chain(const FlexibleArm::Tool& peak, double above_peak) const {
    constexpr double beyond_band = 1.25, beyond_mass_share = 0.25;
    return {{.frequency_hz = above_peak * peak.frequency_hz, .mass_kg = (1.0 - beyond_mass_share) * peak.mass_kg},
            {.frequency_hz = beyond_band * highest_hz_, .mass_kg = beyond_mass_share * peak.mass_kg}};
  }

  double highest_hz_;
  bool searched_ = false;
  std::optional<Unmodelled> unmodelled_;
  double unmeasured_scale_ = 1.0;  ///< factor on the covariance's deviations along axes that nobody hit along
  double band_scale_ = 1.0;        ///< the same of modes, with what lies beyond the model
  std::unique_ptr<FlexibleArm> arm_;
  Calibration calibration_;
  std::optional<robot::Link> payload_;
  std::unique_ptr<CalibrationData> data_;
};

}  // namespace

std::unique_ptr<PostureSource> calibrated_arm(const robot::Cell& cell, const std::optional<robot::Link>& payload,
                                              const std::vector<MeasuredPosture>& measured,
                                              const PostureModelOptions& options, const PostureCalibration* kept,
                                              bool& searched, Progress& progress) {
  auto out = std::make_unique<CalibratedArm>(cell, payload, measured, options, kept, progress);
  searched = out->searched();
  return out;
}

}  // namespace robomill::modal::detail
