#pragma once
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/coupling/assembly.hpp"
#include "robomill/coupling/files/assembly_toml.hpp"
#include "robomill/modal/fit.hpp"
#include "robomill/modal/frf.hpp"

// Method: robomill/jobs/README.md, "From an assembly (`predict.hpp`)"

namespace robomill::jobs {

/// A peak of a predicted FRF.
struct TipPeak {
  modal::FrfName name;
  double frequency_hz = 0.0;
  double receptance_m_per_n = 0.0;  ///< its magnitude
  /// Of the measured peak nearest to it; NaN: there is none.
  double measured_frequency_hz = std::numeric_limits<double>::quiet_NaN();
};

/// The tip of an assembly as predicted, and how far a measurement of it is away.
struct TipPrediction {
  coupling::AssemblyFile file;
  coupling::TipResult tip;
  bool round = false;                     ///< yy is xx, and there is nothing between x and y
  std::optional<modal::FrfSet> measured;  ///< of what was measured the FRFs that were predicted too, within the range
  /// Of each measured FRF, ‖predicted - measured‖ / ‖measured‖ over its lines.
  std::vector<modal::FrfFitError> error;
  std::vector<TipPeak> peaks;  ///< the first ones of each FRF on the diagonal; of a round tool of xx alone
  std::vector<std::string> notes;
  /// The measured holder's receptances, with their deviation where they were found from a measurement: whoever couples
  /// to them sees which lines are bad. Empty without a measured holder.
  modal::FrfSet holder = {};
};

/// @param measured  FRFs to compare with; empty: none
/// @param joint     joint.json, in place of the assembly's joint; empty: the assembly's own
/// @throws InvalidInput naming the file, as read_assembly, tip_frfs and read_frfs, or if nothing measured can be
///     compared
/// @throws Interrupted when progress asks to stop
[[nodiscard]] ROBOMILL_API TipPrediction predict_tip(const std::filesystem::path& assembly,
                                                     const std::filesystem::path& measured = {},
                                                     const coupling::TipOptions& options = {},
                                                     Progress& progress = Progress::none(),
                                                     const std::filesystem::path& joint = {});

/// The modes of predicted FRFs, without standard deviations. A round tool is fitted in x, and the same modes stand in
/// y.
/// @throws InvalidInput as fit_modes
[[nodiscard]] ROBOMILL_API modal::FitResult fit_tip(const modal::FrfSet& tip, const modal::FitOptions& options,
                                                    Progress& progress);

/// tip.json with the lines that are not to be trusted, and why.
[[nodiscard]] ROBOMILL_API std::string tip_json(const TipPrediction& prediction);

/// A frequency at which a receptance is greatest.
struct PeakFound {
  double frequency_hz = 0.0;
  double magnitude = 0.0;
};

/// Local maxima of |H| that stand by half above the higher of the minima to either side, between the lines by a
/// parabola through log |H|.
[[nodiscard]] ROBOMILL_API std::vector<PeakFound> find_peaks(const Eigen::VectorXd& frequency_hz,
                                                             const Eigen::VectorXcd& receptance);

}  // namespace robomill::jobs
