#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/coupling/assembly.hpp"
#include "robomill/modal/frf.hpp"
#include "robomill/modal/mode_id.hpp"
#include "robomill/modal/modes.hpp"
#include "robomill/report/fact.hpp"
#include "robomill/report/forces.hpp"
#include "robomill/report/monitor.hpp"
#include "robomill/report/smooth.hpp"

/// Results of the other stages, as a page to look at and as the data of its plots. The structs are filled by whoever
/// ran the stages; every part may be left empty, and the page leaves its section out. NaN means "missing", or "none in
/// the range" where a member says so; it becomes null.
namespace robomill::report {

/// How well a measurement serves, before any fit.
enum class Grade { unknown, good, fair, poor };

/// One FRF, measured, predicted and fitted, over Report::frf_frequency_hz.
struct FrfPlot {
  modal::FrfName name;
  Eigen::VectorXcd measured = {};   ///< length n, receptance [m/N], or the unit its name says; empty where none
  Eigen::VectorXcd predicted = {};  ///< length n, of Report::prediction; empty where none
  Eigen::VectorXcd fitted = {};     ///< length n; empty where none
  Eigen::VectorXd coherence = {};   ///< length n, in [0, 1]; empty where unknown
  Eigen::VectorXd measured_frequency_hz = {};  ///< of measured where it has an axis of its own; empty: the common one
  Grade grade = Grade::unknown;
  std::vector<std::string> findings = {};  ///< why that grade: "coherence below 0.9 on 12 % of the band"
  std::vector<std::string> remedies = {};  ///< what to do about it: "use a harder tip"
  double trusted_from_hz = missing;        ///< lowest trustworthy frequency [Hz]
  double trusted_to_hz = missing;          ///< highest, where the hammer stops exciting [Hz]
  double relative_error = missing;         ///< ‖fitted - H‖ / ‖H‖ over the fit's band, H what was fitted
  double prediction_error = missing;       ///< ‖predicted - measured‖ / ‖measured‖ over the lines of both
};

/// A peak of a predicted FRF.
struct TipPeak {
  modal::FrfName name;
  double frequency_hz = missing;
  double receptance_m_per_n = missing;     ///< its magnitude
  double measured_frequency_hz = missing;  ///< of the measured peak nearest to it, where there is one
};

/// A tool in its holder, and what is predicted of its tip. The FRFs stand in Report::frfs.
struct Prediction {
  coupling::Assembly assembly = {};
  std::string holder_file = {};  ///< of a measured holder
  std::vector<TipPeak> peaks = {};
  std::vector<double> suspect_hz = {};     ///< lines where the measured holder would create energy
  std::vector<double> unreliable_hz = {};  ///< lines where a small error of the measurement became a large one
  std::vector<std::string> notes = {};
};

/// One hammer hit.
struct HitRow {
  std::string file;
  std::string direction = {};  ///< of the force: "x", "-y"
  bool accepted = true;
  std::vector<std::string> reasons = {};  ///< why it was rejected, or what was noticed
};

/// One pole of one model order in a stabilisation diagram.
struct StabilisationPole {
  int order = 0;
  double frequency_hz = 0.0;  ///< [Hz]
  bool stable = false;        ///< frequency, damping and mode shape hardly moved since the order below
};

/// How the modes came out of the FRFs.
struct FitSummary {
  std::string method = {};               ///< "hybrid", "pso", "lscf"
  double relative_error = missing;       ///< ‖H_fit - H‖ / ‖H‖ over the band, all FRFs together
  double mean_relative_error = missing;  ///< mean over lines and FRFs of |H_fit - H| / |H|
  double band_from_hz = missing;         ///< [Hz]
  double band_to_hz = missing;           ///< [Hz]
  bool converged = true;
  Eigen::VectorXd convergence = {};  ///< best objective after each iteration; empty where the method has none
  std::vector<StabilisationPole> stabilisation = {};  ///< empty where the method has none
};

enum class BoundaryKind { hopf, flip, fold };

/// A point of the stability boundary.
struct BoundaryPoint {
  double spindle_speed_rad_per_s = 0.0;
  double axial_depth_m = 0.0;
  double chatter_frequency_hz = missing;
  BoundaryKind kind = BoundaryKind::hopf;
  modal::ModeId mode = {};
};

/// Where the limit lies with all that is not known exactly.
struct LimitBand {
  std::string label = {};                        ///< "5 to 95 % of 200 samples"
  Eigen::VectorXd spindle_speed_rad_per_s = {};  ///< length n, increasing; empty where there is none
  Eigen::VectorXd low_m = {}, high_m = {};       ///< length n; NaN: beyond searched_depth_m
};

/// Stability lobes of all modes or of some.
struct Lobes {
  std::string label = {};                        ///< "all modes", "modes 1–2"
  std::vector<int> modes = {};                   ///< from 1; empty: all
  Eigen::VectorXd spindle_speed_rad_per_s = {};  ///< length n, increasing
  Eigen::VectorXd limit_depth_m = {};            ///< length n, lowest unstable depth; NaN: none up to searched_depth_m
  double searched_depth_m = missing;             ///< the deepest that was looked at
  LimitBand band = {};
  std::vector<BoundaryPoint> boundary = {};
  Eigen::VectorXd map_speed_rad_per_s = {};  ///< length n_s, increasing; the next three are empty where there is no map
  Eigen::VectorXd map_depth_m = {};          ///< length n_d, increasing
  Eigen::MatrixXd spectral_radius = {};      ///< n_d x n_s
};

/// A file that a stage wrote beside the report.
struct StageFile {
  std::string stage, file, description;
};

struct Report {
  std::string title = "Cutting conditions without chatter";
  std::string created = {};     ///< "31 July 2026, robomill 0.1.0"
  std::string summary = {};     ///< in lines of text, for where no script runs
  std::string plan = {};        ///< of plan.json what is no stage's document; empty: none
  std::string recordings = {};  ///< of test cuts, a JSON array; empty: none

  std::optional<Prediction> prediction = {};
  Eigen::VectorXd frf_frequency_hz = {};  ///< length n, increasing
  std::vector<FrfPlot> frfs = {};
  std::vector<HitRow> hits = {};

  std::optional<modal::ModalModel> model = {};
  Eigen::VectorXd limit_share = {};  ///< one a mode, in [0, 1]: its share in the limit; empty where unknown
  std::optional<modal::ModalModel> workpiece_model = {};  ///< of a part that vibrates too
  Eigen::VectorXd workpiece_limit_share = {};
  std::optional<FitSummary> fit = {};

  std::vector<Lobes> lobes = {};  ///< the first is the one that counts: all modes
  std::optional<Forces> forces = {};
  std::optional<Smooth> smooth = {};
  std::optional<MonitorRun> monitor = {};
  std::string calibration = {};  ///< calibration.json; empty: none
  std::vector<StageFile> files = {};

  /// @throws InvalidInput naming the member if lengths do not match, an axis does not increase, or a required number is
  /// missing
  ROBOMILL_API void validate() const;
};

/// The data of the page in shop units, keys with their unit, about six significant digits; numbers finite, "none" is
/// null.
/// @throws InvalidInput as Report::validate
[[nodiscard]] ROBOMILL_API std::string report_json(const Report& report);

/// One file that opens without a network: the page's script (web/), which makes tables and plots of the data inside.
/// Where no script runs, and in a build without it (ROBOMILL_WEB=OFF), the page is the summary.
/// @throws InvalidInput as Report::validate
[[nodiscard]] ROBOMILL_API std::string report_html(const Report& report);

}  // namespace robomill::report
