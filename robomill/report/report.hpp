#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/coupling/assembly.hpp"
#include "robomill/modal/frf.hpp"
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

/// A file that a stage wrote beside the report.
struct StageFile {
  std::string stage, file, description;
};

struct Report {
  std::string title = "Cutting conditions without chatter";
  std::string created = {};          ///< "31 July 2026, robomill 0.1.0"
  std::string summary = {};          ///< in lines of text, for where no script runs
  std::string plan = {};             ///< of plan.json what is no stage's document; empty: none
  std::string recordings = {};       ///< of test cuts, a JSON array; empty: none
  std::string modes = {};            ///< modes.json; empty: none
  std::string workpiece_modes = {};  ///< the same, of a part that vibrates too
  std::string lobes = {};            ///< lobes.json; empty: none

  std::optional<Prediction> prediction = {};
  Eigen::VectorXd frf_frequency_hz = {};  ///< length n, increasing
  std::vector<FrfPlot> frfs = {};
  std::vector<HitRow> hits = {};

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
