#pragma once
#include <Eigen/Core>
#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/modal/frf.hpp"
#include "robomill/modal/modes.hpp"
#include "robomill/robot/arm.hpp"

// Method: robomill/modal/README.md, "Modes over posture (`posture_model.hpp`)"

namespace robomill::modal {

struct PostureCalibration;  // not installed: what a calibration's search found, for files
namespace detail {
class PostureSource;
}

/// What was measured at the tool's tip in one posture, in the robot's base axes: FRFs or modes.
struct MeasuredPosture {
  std::string name = {};                 ///< for messages: "postures[3]", a file
  Eigen::VectorXd joints = {};           ///< length n [rad or m]
  FrfSet frfs = {};                      ///< of the tip, x, y, z; at least one force; empty where modes are given
  std::optional<ModalModel> modes = {};  ///< of the tip in x, y, z
};

struct ROBOMILL_API PostureModelOptions {
  double band_low_hz = 0.0;     ///< FRFs count from here [Hz], >= 0
  double band_high_hz = 700.0;  ///< to here [Hz], > band_low_hz; modes are given up to there
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// The dynamics of a posture, predicted.
struct PosturePrediction {
  ModalModel modes;           ///< of the tip in B, x, y and z, with deviations; the rest of the structure as residuals
  double distance_rad = 0.0;  ///< to the nearest measured posture, over the joints that count; infinite: none
  std::string nearest = {};   ///< its name
  bool measured_nearby = false;  ///< within the measured region: distance_rad <= PostureReport::region_rad
};

/// What a calibration came to.
struct PostureReport {
  enum class Source {
    cell,          ///< nothing was measured: the cell's numbers alone
    calibrated,    ///< the arm's model, calibrated with every posture
    interpolated,  ///< the cell has no masses or no stiffness: measured modes by inverse distance
  };
  Source source = Source::cell;
  bool bearings = false, bracket = false;  ///< what the left-out postures bear out
  int tool_modes = 0;                      ///< masses in the chain of spindle and tool

  std::size_t postures = 0;
  double error = 0.0;           ///< mean |H_fit − H| over |H|, all postures
  double left_out_error = 0.0;  ///< the same of each posture predicted from the others; NaN below three postures
  double region_rad = 0.0;      ///< how far from a measured posture counts as measured
  /// The direct receptances xx, yy and zz, of a calibrated model each by Σ |ΔH| / Σ |H| over lines and postures.
  struct Direct {
    bool measured = false;                                             ///< somebody hit along that axis
    double error = std::numeric_limits<double>::quiet_NaN();           ///< of the postures measured
    double left_out_error = std::numeric_limits<double>::quiet_NaN();  ///< each predicted from the other postures
    /// Predicted by a calibration without the forces along that axis. NaN where all three were measured, or one alone
    double held_out_error = std::numeric_limits<double>::quiet_NaN();
  };
  std::array<Direct, 3> direct = {};
  std::vector<std::string> notes = {};
};

/// The dynamics of a robot at any posture. One model of the arm (compliant joints, tilting bearings, a bracket under
/// the spindle, a chain of masses for spindle and tool) is calibrated over the FRFs of all postures together,
///     minimise Σ |H(φ_p) − H_p|² / d² + prior,  φ_p = θ + S u_p,  H = Bᵀ (K + sC + s²M)⁻¹ B + C_rest,
/// where u_p, a Gaussian process over the joints, is what the joints' stiffness and damping differ by in posture p.
/// Which structure is kept is decided by the receptances of left-out postures.
class ROBOMILL_API PostureModel {
 public:
  /// @param cell      with tool_length_m; links with mass and joints with stiffness, else measured modes are
  ///     interpolated
  /// @param payload   what hangs on the flange beside the last link, in flange axes
  /// @param measured  may be empty
  /// @param kept      what the search of an earlier model of the same inputs found: the same model without the search.
  ///     Where it is not of them, the search is done
  /// @throws InvalidInput naming the posture: a position of another length or outside the joints' limits, FRFs with
  ///     other names or another band than the first's, nothing at the tip; neither a model nor measurements;
  ///     Interrupted
  PostureModel(const robot::Cell& cell, const std::optional<robot::Link>& payload,
               const std::vector<MeasuredPosture>& measured, const PostureModelOptions& options = {},
               Progress& progress = Progress::none(), const PostureCalibration* kept = nullptr);
  ~PostureModel();
  PostureModel(PostureModel&&) noexcept;
  PostureModel& operator=(PostureModel&&) noexcept;

  /// @param joints  length n
  /// @throws InvalidInput if it has another length, is not finite or outside the joints' limits (which, by how much)
  [[nodiscard]] PosturePrediction at(const Eigen::VectorXd& joints) const;
  /// Deviations of xx, yy and zz there, a share of each. Of a measured axis what left-out postures show, or more where
  /// the parameters' covariance is larger than there. Of an unmeasured axis what the covariance leaves, times what
  /// measured axes are missed by beyond theirs when the forces along them are left out, and no less than that miss. Of
  /// both also twice what the measurements have beyond the model, as it moves with the flange. NaN of a model that is
  /// not calibrated.
  /// @throws InvalidInput as at
  [[nodiscard]] Eigen::Vector3d direct_deviation(const Eigen::VectorXd& joints) const;
  [[nodiscard]] const PostureReport& report() const;
  /// Nothing where there was nothing to search for.
  [[nodiscard]] std::optional<PostureCalibration> calibration() const;
  /// Whether there was a search.
  [[nodiscard]] bool searched() const { return searched_; }

 private:
  std::unique_ptr<detail::PostureSource> source_;
  bool searched_ = false;
};

}  // namespace robomill::modal
