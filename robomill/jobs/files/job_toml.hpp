#pragma once
#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/names.hpp"
#include "robomill/decision/finish.hpp"
#include "robomill/io/toml_source.hpp"
#include "robomill/modal/directions.hpp"
#include "robomill/process/decide_options.hpp"

// Method: robomill/jobs/README.md, "Files"

namespace robomill::jobs {

/// What a cut did, or is predicted to do. Of a recording by the ratio r of its highest peak that is no multiple of the
/// rotation to the highest multiple.
enum class Verdict {
  unknown,     ///< nobody said, or a recording that may be either: the cut is predicted and not compared
  stable,      ///< no chatter. Predicted: |μ| < 1; recorded: r < 0.25
  borderline,  ///< marks that come and go; agrees where |predicted limit / depth - 1| <= 0.2; recorded: 0.25 <= r < 0.5
  chatter      ///< predicted: |μ| >= 1; recorded: r >= 0.5
};
inline constexpr Name<Verdict> verdict_names[] = {
    {"stable", Verdict::stable}, {"borderline", Verdict::borderline}, {"chatter", Verdict::chatter}};
/// "stable", …; empty where it is unknown.
[[nodiscard]] ROBOMILL_API std::string_view to_string(Verdict verdict);

/// What a machinist saw and measured at one test cut.
struct TestCut {
  double spindle_speed_rad_per_s = 0.0;  ///< > 0
  double axial_depth_m = 0.0;            ///< > 0
  Verdict result = Verdict::unknown;
  std::vector<double> peaks_hz = {};  ///< peaks of its spectrum, where known
  std::filesystem::path file = {};    ///< its recording, where there is one
  std::string column = "1";           ///< the recording's column, name or number from 1
  double scale = 1.0;                 ///< of a WAV: what full scale means, in m/s²
  double sample_rate_hz = 0.0;        ///< of a recording without a time column; 0: from the file
};

/// job.toml. Paths are resolved; an empty one is absent. Exactly one of hits, frf, modes and assembly
/// is given; a job that judges blocks may have none of them, nor lobes.
struct Job {
  std::filesystem::path file = {};      ///< this one
  std::vector<std::string> notes = {};  ///< sentences for the user
  std::string title = {};
  std::filesystem::path hits = {}, modes = {}, lobes = {};
  std::filesystem::path assembly = {};  ///< whose tip is predicted …
  std::filesystem::path joint = {};     ///< … with the joint of this joint.json in place of its own
  std::filesystem::path measured = {};  ///< … and FRFs of the tip to compare with it
  std::filesystem::path forces = {};    ///< a cut whose forces are reported …
  std::filesystem::path cell = {};      ///< … with the robot that it bends …
  std::filesystem::path program = {};   ///< … and along a program, which a cell with [smoothing] smooths
  std::vector<std::filesystem::path> frf = {};
  std::vector<std::string> frf_as = {};
  double band_low_hz = 0.0, band_high_hz = 0.0;  ///< of the fit; 0, 0: the whole data
  modal::MissingDirections directions = {};      ///< what an unmeasured direction is taken for
  int fit_modes = 0;                             ///< 0: chosen by the fit
  decision::MachineLimits recommend = {};
  decision::FinishLimits finish = {};
  process::DecideOptions decide = {};  ///< of a job that judges blocks
  std::vector<TestCut> cuts = {};
  std::vector<double> near_deg =
      {};  ///< joints to begin the program near, asked for beside the file; empty: the cell's

  /// Whether every block of a program is looked at: forces along it, and a robot.
  [[nodiscard]] bool judges_blocks() const { return !forces.empty() && !cell.empty() && !program.empty(); }
  [[nodiscard]] bool has_structure() const {
    return !hits.empty() || !frf.empty() || !modes.empty() || !assembly.empty();
  }
  ROBOMILL_API void validate() const;
};

/// @throws InvalidInput with file, line, key and value
[[nodiscard]] ROBOMILL_API Job read_job(const io::TomlSource& source);

/// What was recorded of a test cut.
struct CutSignal {
  Eigen::VectorXd acceleration;         ///< length n [m/s^2]
  double sample_rate_hz = 0.0;          ///< > 0
  std::vector<std::string> notes = {};  ///< sentences for the user
};
/// Reads the recording that a test cut names.
/// @throws InvalidInput if it cannot be read, or neither it nor the cut knows its rate
[[nodiscard]] ROBOMILL_API CutSignal read_cut_signal(const TestCut& cut);

}  // namespace robomill::jobs
