#pragma once
#include <string>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/base/export.hpp"

/// Results of the other stages, as a page to look at and as the data of its plots: the stages' own JSON documents, as
/// text, and what is recorded for the page alone. Every part may be left empty, and the page leaves its section out.
namespace robomill::page {

/// A file that a stage wrote beside the report.
struct StageFile {
  std::string stage, file, description;
};

struct Report {
  std::string title = "Cutting conditions without chatter";
  std::string created = {};          ///< "31 July 2026, robomill 0.1.0"
  std::string summary = {};          ///< in lines of text, for where no script runs
  std::string plan = {};             ///< of plan.json what is no stage's document; empty: none
  std::string frf = {};              ///< tip.json: FRFs measured, or predicted from `assembly`; empty: none
  std::string fitted = {};           ///< the same lines and FRFs of the modes fitted to them; empty: none
  std::string measured = {};         ///< FRFs measured beside predicted ones; empty: none
  std::string assembly = {};         ///< plan.json's assembly; empty: none
  std::string recordings = {};       ///< of test cuts, recorded for the page alone; empty: none
  std::string modes = {};            ///< modes.json; empty: none
  std::string workpiece_modes = {};  ///< the same, of a part that vibrates too
  std::string lobes = {};            ///< lobes.json; empty: none
  std::string forces = {};           ///< forces.json; empty: none
  std::string blocks = {};           ///< blocks.json: stability of every block of a program; empty: none
  std::string smooth = {};           ///< smooth.json; empty: none
  std::string motion = {};  ///< the same program's outline and motion, recorded for the page alone; empty: none
  std::string cell = {};    ///< check.json of a robot cell; empty: none

  std::string monitor = {};              ///< a monitored recording, live/files/recorded_run_json.hpp; empty: none
  std::string calibration = {};          ///< calibration.json; empty: none
  std::string joint = {};                ///< joint.json, of FRFs in `frf` and `fitted`; empty: none
  std::string tools = {};                ///< the table of a list of tools as JSON; empty: none
  std::string sweep = {};                ///< lobes.json of a sweep; empty: none
  std::string comparison = {};           ///< lobes.json of methods compared; empty: none
  std::string postures = {};             ///< postures.json; empty: none
  std::string statistics = {};           ///< statistics.json of a study; empty: none
  std::string study_points = {};         ///< points of a study, recorded for the page alone; empty: none
  std::string explanation = {};          ///< explain.json; empty: none
  std::string simulation = {};           ///< simulation.json; empty: none
  std::string vibration = {};            ///< its columns, recorded for the page alone; empty: none
  std::string coefficients = {};         ///< coefficients.json; empty: none
  std::string stiffness = {};            ///< stiffness.json; empty: none
  std::vector<Assumption> assumed = {};  ///< because nobody said it
  std::vector<std::string> warnings = {}, notes = {};  ///< that no document holds
  std::vector<StageFile> files = {};
};

/// The data of the page in shop units, keys with their unit, about six significant digits; numbers finite, "none" is
/// null.
/// @throws InvalidInput naming the member that is not its JSON document
[[nodiscard]] ROBOMILL_API std::string report_json(const Report& report);

/// One file that opens without a network: the page's script (web/), which makes tables and plots of the data inside.
/// Where no script runs, and in a build without it (ROBOMILL_WEB=OFF), the page is the summary.
/// @throws InvalidInput naming the member that is not its JSON document
[[nodiscard]] ROBOMILL_API std::string report_html(const Report& report);

}  // namespace robomill::page
