#pragma once
// What a prediction of modes over postures is worth, judged by the truth of a simulated arm.
#include <Eigen/Core>
#include <functional>
#include <vector>

#include "robomill/modal/modes.hpp"
#include "testing/modal/simulated_arm.hpp"

namespace robomill::modal::testing {

/// Modes of the tip in the base axes at a posture.
using PosturePredictor = std::function<ModalModel(const Eigen::VectorXd& joints)>;

struct PostureJudgeOptions {
  double highest_hz = 600.0;  ///< of the true modes that count
  std::vector<double> spindle_speed_rpm = {3000.0, 5200.0, 7500.0, 9800.0, 12300.0, 15000.0};
  bool limits = true;                                              ///< limit depths
  bool bands = true;                                               ///< bands of the limit
  std::vector<double> band_spindle_speed_rpm = {5200.0, 12300.0};  ///< two
};

/// Every error by itself, over all held-out postures.
struct PostureScore {
  /// |f̂ - f| / f of each true mode that makes up a tenth of the receptance at its own frequency. Modes closer than 3 %
  /// count as one, with the mean frequency (by size of residue) and the sum of the residues.
  std::vector<double> frequency_error;
  int missed = 0;                     ///< of these modes, without a counterpart
  std::vector<double> residue_error;  ///< ‖R̂ - R‖ / ‖R‖ of those that carry 1 % of the receptance's peak
  int frequencies_in_band = 0, banded = 0;    ///< f within f̂ ± 1.96 deviations, of those that have one
  std::vector<double> limit_error;            ///< |d̂ - d| / d of the limits that exist in the range
  int too_deep = 0;                           ///< of these, d̂ > 1.1 d
  int limits_in_band = 0, banded_limits = 0;  ///< d within the 5 to 95 % band
};

/// The truth at the held-out postures of an arm, found once.
class PostureJudge {
 public:
  /// @param arm  outlives the judge
  explicit PostureJudge(const SimulatedArm& arm, const PostureJudgeOptions& options = {});
  [[nodiscard]] PostureScore judge(const PosturePredictor& predict) const;

 private:
  struct Truth {
    ModalModel modes;
    double peak_m_per_n = 0.0;                  // the greatest ‖H‖ in the band
    std::vector<double> limit_m, band_limit_m;  // infinite: none in the range
  };
  [[nodiscard]] std::vector<double> limits(const ModalModel& modes, const std::vector<double>& spindle_speed_rpm) const;
  void judge_modes(const Truth& truth, const ModalModel& predicted, PostureScore& score) const;
  void judge_limits(const Truth& truth, const ModalModel& predicted, PostureScore& score) const;

  const SimulatedArm* arm_;
  PostureJudgeOptions options_;
  std::vector<Truth> truth_;  // of each held-out posture
};

/// The value below which this share of the values lies; 0 where there are none.
[[nodiscard]] double quantile(std::vector<double> values, double share);

}  // namespace robomill::modal::testing
