#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robomill/base/progress.hpp"
#include "robomill/jobs/plan.hpp"
#include "robomill/serve/serve.hpp"

namespace robomill::app {

/// Exit codes of a verb that ended by itself; bad input and wrong usage are main's, what a signal ended is
/// exit_of_signal().
enum Exit : int { done = 0, bad_input = 1, wrong_usage = 2, not_reached = 3 };

/// What every verb takes.
struct Common {
  std::string output;            ///< path, "-" for JSON on standard output, empty for a summary alone
  std::filesystem::path report;  ///< .html or .json; empty: none
  bool quiet = false;
  int threads = 0;
  std::uint64_t seed = jobs::default_seed;

  [[nodiscard]] bool to_stdout() const { return output == "-"; }
  [[nodiscard]] bool wants_summary() const { return !quiet && !to_stdout(); }
};

struct InitCommand {
  std::string kind;  ///< one of jobs::template_names
  bool interactive = false;
  bool example = false;        ///< made up, and such that it runs
  std::filesystem::path data;  ///< of hits and job: a folder with records; empty: that of the output
  std::string robot;           ///< of a cell; empty: the template's
};
struct FrfCommand {
  std::filesystem::path hits;
  bool binary = false;  ///< .uff as data set 58b
};
struct ModesCommand {
  std::vector<std::filesystem::path> inputs;
  std::vector<std::string> as;
  std::vector<double> band_hz;  ///< empty, or low and high
  int modes = 0;                ///< 0: chosen by the fit
  std::optional<std::string> method;
  std::filesystem::path config;
  bool accept_fit = false;         ///< modes that do not describe the FRFs will do
  std::filesystem::path cell;      ///< in place of inputs: the modes of one of its postures
  std::vector<double> joints_deg;  ///< that posture
  std::string axes = "base";       ///< that they are written in
};
struct CoupleCommand {
  std::filesystem::path input;
  bool rotations = false;
  std::filesystem::path holder_out;  ///< empty: the holder's receptances are not kept
  std::filesystem::path tools;       ///< tools.csv: a table of them in place of the assembly's own
  std::filesystem::path lobes;       ///< with tools: the cut that each is to make
  std::filesystem::path frfs;        ///< with tools: a folder for the FRFs at each one's tip
};
struct JointCommand {
  std::filesystem::path input;
  std::vector<std::filesystem::path> measured;
  std::vector<std::string> as;
  std::string method = "hybrid", mutation = {}, axis = "x";  // mutation empty: the assembly's
};
struct LobesCommand {
  std::filesystem::path input;
  std::vector<std::string> at;  ///< "RPM,MM"
  bool compare = false;         ///< every method, in place of the chart
};
struct ExplainCommand {
  std::vector<double> peaks_hz;
  double rpm = 0.0;
  int teeth = 0;
  std::filesystem::path modes;
  double tolerance_hz = 1.0;
  double speed_tolerance_percent = 0.2;
  std::filesystem::path lobes;  ///< empty: no cut to judge
  std::vector<double> at;       ///< empty, or rpm and mm
};
struct SimulateCommand {
  std::filesystem::path input;
  std::string at;  ///< "RPM,MM"
  double seconds = 2.0;
  double sample_rate_hz = 10240.0;
  bool linear = false;
};
struct ForcesCommand {
  std::filesystem::path input;
  std::filesystem::path program;    ///< empty: one revolution
  std::filesystem::path cell;       ///< empty: the one that the input names, if any
  std::vector<double> posture_deg;  ///< where the arm begins along a program; empty: the cell's
};
struct CoefficientsCommand {
  std::filesystem::path slots;
  int teeth = 0;  ///< 0: not said
};
struct StiffnessCommand {
  std::filesystem::path loads, cell;
  std::vector<double> point_mm;  ///< in the flange frame; empty: the tool's tip
};
struct CellCheckCommand {
  std::filesystem::path cell;
  std::vector<double> joints;       ///< one more position: degrees, or millimetres where joints slide
  std::filesystem::path program;    ///< empty: the workpiece's origin
  std::vector<double> posture_deg;  ///< where the arm begins along a program; empty: the cell's
};
struct SmoothCommand {
  std::filesystem::path program, cell;
  std::optional<std::string> method;        ///< the cell's unless given
  bool compare = false;                     ///< the other methods beside it
  std::vector<double> posture_deg;          ///< where the arm begins; empty: the cell's
  bool keep_violations = false;             ///< write a trajectory that breaks limits
  std::optional<double> program_period_ms;  ///< of joint programs; not given: the language's
};
struct MonitorCommand {
  std::filesystem::path config;
  std::string input;            ///< file, "-", mqtt://HOST/TOPIC; empty: mqtt.topic of the file
  std::string format = "auto";  ///< of bytes without an ending: auto, f32, i16, csv
  bool every_window = false, watch = false;
  bool live = false;             ///< standard input is not kept waiting
  std::filesystem::path record;  ///< folder for alarms; empty: the file's
  std::optional<int> metrics_port;
  double seconds = 0.0;  ///< of the stream; 0: to its end
};
struct CalibrateCommand {
  std::filesystem::path recordings;
};
struct PlanCommand {
  std::filesystem::path job;
  bool accept_fit = false;          ///< go on with modes that do not describe the FRFs
  std::vector<double> posture_deg;  ///< where the arm begins along a program; empty: the cell's
};
struct ServeCommand {
  serve::ServeOptions options;
  int job_memory_mb = 0;             ///< 0: half the machine's
  std::filesystem::path token_file;  ///< options.token stands in it; empty: in no file
};
/// What this program is asked for where it is to work for a server that it is too (ServeOptions::worker).
inline constexpr std::string_view serve_worker = "serve-worker";
/// The program's exit code.
[[nodiscard]] int work_for_server();

Exit run(const InitCommand& command, const Common& common, Progress& progress);
Exit run(const FrfCommand& command, const Common& common, Progress& progress);
Exit run(const ModesCommand& command, const Common& common, Progress& progress);
Exit run(const CoupleCommand& command, const Common& common, Progress& progress);
Exit run(const JointCommand& command, const Common& common, Progress& progress);
Exit run(const LobesCommand& command, const Common& common, Progress& progress);
Exit run(const ExplainCommand& command, const Common& common, Progress& progress);
Exit run(const SimulateCommand& command, const Common& common, Progress& progress);
Exit run(const ForcesCommand& command, const Common& common, Progress& progress);
Exit run(const CoefficientsCommand& command, const Common& common, Progress& progress);
Exit run(const StiffnessCommand& command, const Common& common, Progress& progress);
Exit run(const CellCheckCommand& command, const Common& common, Progress& progress);
Exit run(const SmoothCommand& command, const Common& common, Progress& progress);
Exit run(const MonitorCommand& command, const Common& common, Progress& progress);
Exit run(const CalibrateCommand& command, const Common& common, Progress& progress);
Exit run(const PlanCommand& command, const Common& common, Progress& progress);
Exit run(const ServeCommand& command, const Common& common, Progress& progress);

}  // namespace robomill::app
