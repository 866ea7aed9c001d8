#pragma once
#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/coupling/assembly.hpp"
#include "robomill/modal/fit.hpp"
#include "robomill/modal/frf.hpp"

// Method: robomill/coupling/README.md, "Predicted tips (`prediction.hpp`)"

namespace robomill::coupling {

/// Whether the FRFs are those of a round tool on a round holder: yy is xx, and there is nothing between x and y.
[[nodiscard]] ROBOMILL_API bool is_round(const modal::FrfSet& tip);

/// A frequency at which a receptance is greatest.
struct PeakFound {
  double frequency_hz = 0.0;
  double magnitude = 0.0;
};

/// Local maxima of |H| that stand by half above the higher of the minima to either side, between the lines by a
/// parabola through log |H|.
[[nodiscard]] ROBOMILL_API std::vector<PeakFound> find_peaks(const Eigen::VectorXd& frequency_hz,
                                                             const Eigen::VectorXcd& receptance);

/// A peak of a predicted FRF.
struct TipPeak {
  modal::FrfName name;
  double frequency_hz = 0.0;
  double receptance_m_per_n = 0.0;  ///< its magnitude
  /// Of the measured peak nearest to it; NaN: there is none.
  double measured_frequency_hz = std::numeric_limits<double>::quiet_NaN();
};

/// The first peaks of each FRF on the diagonal; of a round tool of xx alone.
/// @param measured  whose peaks stand beside them; null: none
[[nodiscard]] ROBOMILL_API std::vector<TipPeak> tip_peaks(const modal::FrfSet& tip, const modal::FrfSet* measured);

/// How far a measurement of a tip is from its prediction.
struct TipComparison {
  modal::FrfSet measured = {};  ///< of what was measured the FRFs that were predicted too, within the range
  /// Of each measured FRF, ‖predicted - measured‖ / ‖measured‖ over its lines.
  std::vector<modal::FrfFitError> error = {};
};
/// @param tip   of the assembly
/// @param name  of the measurement, for messages
/// @throws InvalidInput if nothing measured can be compared
[[nodiscard]] ROBOMILL_API TipComparison compare_tip(const Assembly& assembly, const TipResult& tip,
                                                     const modal::FrfSet& measured, const std::string& name);

/// The modes of predicted FRFs, without standard deviations. A round tool is fitted in x, and the same modes stand in
/// y.
/// @throws InvalidInput as fit_modes
[[nodiscard]] ROBOMILL_API modal::FitResult fit_tip(const modal::FrfSet& tip, const modal::FitOptions& options,
                                                    Progress& progress);

}  // namespace robomill::coupling
