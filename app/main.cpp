#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <functional>
#include <new>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

#include "help.hpp"
#include "options.hpp"
#include "robomill/base/cost.hpp"
#include "robomill/base/error.hpp"
#include "robomill/base/names.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/base/printable.hpp"
#include "robomill/cell/dynamics.hpp"
#include "robomill/coupling/joint_fit.hpp"
#include "robomill/io/output_places.hpp"
#include "robomill/jobs/init.hpp"
#include "robomill/modal/fit.hpp"
#include "robomill/path/options.hpp"
#include "robomill/version.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

template <class Value, std::size_t n>
CLI::IsMember one_of_words(const Name<Value> (&names)[n]) {
  std::vector<std::string> words;
  for (const auto& [name, value] : names) words.emplace_back(name);
  return CLI::IsMember(words);
}

/// Every verb's parser and what it runs once parsed.
struct CommandLine {
  CLI::App parser{"robomill keeps a milling robot out of chatter: hammer hits to safe cutting conditions.", "robomill"};
  Common common;
  bool allow_large = false;  ///< work that takes long or much memory is not rejected before it begins
  InitCommand init;
  FrfCommand frf;
  ModesCommand modes;
  CoupleCommand couple;
  JointCommand joint;
  LobesCommand lobes;
  ExplainCommand explain;
  SimulateCommand simulate;
  ForcesCommand forces;
  CoefficientsCommand coefficients;
  StiffnessCommand stiffness;
  CellCheckCommand cell_check;
  SmoothCommand smooth;
  MonitorCommand monitor;
  CalibrateCommand calibrate;
  PlanCommand plan;
  ServeCommand serve;
  std::function<Exit(Progress&)> chosen;

  CommandLine();
  /// Where the verb writes, in whatever option that stands.
  [[nodiscard]] std::vector<std::filesystem::path> outputs() const {
    return {common.to_stdout() ? std::string() : common.output, common.report, couple.holder_out, couple.frfs,
            monitor.record};
  }
  void add_first_verbs();
  void add_structure_verbs();
  void add_cut_verbs();
  void add_robot_verbs();
  void add_machine_verbs();
  CLI::App* verb(const char* name, const char* description, std::function<Exit(Progress&)> run,
                 CLI::App* above = nullptr);
};

/// @param above  the verb that it is one of; null: a verb of its own
CLI::App* CommandLine::verb(const char* name, const char* description, std::function<Exit(Progress&)> run,
                            CLI::App* above) {
  CLI::App* sub = (above != nullptr ? above : &parser)->add_subcommand(name, description);
  sub->add_option("-o,--output", common.output,
                  "write here, the format by its ending; - writes JSON to standard output");
  sub->add_option("--report", common.report, "a page to look at (.html), or its data (.json)");
  sub->add_flag("--quiet", common.quiet, "no summary and no progress");
  sub->add_option("--threads", common.threads, "threads to use (default: one a core)")->check(whole_number(1));
  sub->add_option("--seed", common.seed, "seed of every random number (default: 1)")->check(unsigned_number());
  sub->add_flag("--allow-large", allow_large,
                "do what takes more than 10 minutes of one core or 2 GB, instead of rejecting it before it begins");
  sub->callback([this, run = std::move(run)] { chosen = run; });
  return sub;
}

/// Below the help of each verb: an example and where to read on.
void add_footers(CLI::App& parser, const std::string& parents) {
  for (CLI::App* verb : parser.get_subcommands([](CLI::App*) { return true; })) {
    const std::string name = parents + verb->get_name();
    for (const VerbHelp& help : verb_helps) {
      if (help.verb != name) continue;
      verb->footer("Example: robomill " + std::string(help.example) +
                   "\nDocumentation: " + std::string(help.documentation));
    }
    add_footers(*verb, name + " ");
  }
}

CommandLine::CommandLine() {
  parser.set_version_flag("--version", "robomill " ROBOMILL_VERSION);
  parser.require_subcommand(1);
  add_first_verbs();
  add_structure_verbs();
  add_cut_verbs();
  add_robot_verbs();
  add_machine_verbs();
  add_footers(parser, {});
}

/// Where an arm begins a program, of every verb that puts one on a robot.
CLI::Option* add_posture(CLI::App* sub, std::vector<double>& posture_deg) {
  return sub
      ->add_option("--posture", posture_deg,
                   "begin the program as near to q1,q2,… as it goes through, in degrees (default: as at home)")
      ->delimiter(',')
      ->check(number());
}

/// Files to begin with.
void CommandLine::add_first_verbs() {
  CLI::App* sub = verb("init", "a commented file in which what only you know is to be filled in",
                       [this](Progress& p) { return run(init, common, p); });
  sub->remove_option(sub->get_option("--report"));
  sub->add_option("kind", init.kind, "job, hits, lobes, cell, assembly, forces or monitor")
      ->check(one_of_words(jobs::template_names))
      ->required();
  sub->get_option("--output")->description("write here (default: KIND.toml); - writes to standard output");
  sub->add_flag("--example", init.example, "made-up values that run as they are, each listed as assumed until changed");
  sub->add_flag("--interactive", init.interactive, "ask for what is known, in shop terms and any unit");
  sub->add_option("--data", init.data, "of hits and job: a folder with recorded hits (default: that of the file)");
  sub->add_option("--robot", init.robot, "of a cell: an arm by its name, kuka-kr210-r2700 for one");
}

/// Hits, FRFs, modes, and the tool in its holder.
void CommandLine::add_structure_verbs() {
  CLI::App* sub =
      verb("frf", "hammer hits to frequency response functions", [this](Progress& p) { return run(frf, common, p); });
  sub->add_option("hits", frf.hits, "hits.toml")->required();
  sub->add_flag("--binary", frf.binary, "write .uff as data set 58b");

  sub = verb("modes", "frequency response functions to modes", [this](Progress& p) { return run(modes, common, p); });
  auto* const frfs = sub->add_option("frfs", modes.inputs, "FRF files: .uff .csv .txt .mat .json");
  sub->add_option("--as", modes.as, "names of headerless FRFs, one a file: xx,yy")->delimiter(',');
  sub->add_option("--band", modes.band_hz, "low,high in Hz")->delimiter(',')->expected(2)->check(number());
  sub->add_option("--modes", modes.modes, "exactly this many modes")->check(whole_number(1));
  sub->add_option("--method", modes.method, "hybrid, pso or lscf")->check(one_of_words(modal::fit_method_names));
  sub->add_option("--config", modes.config, "modes.toml: every option of the fit");
  sub->add_flag("--accept-fit", modes.accept_fit, "take modes whose relative error is 20 % or more");
  auto* const cell = sub->add_option("--cell", modes.cell, "cell.toml: the modes of a posture, from its [[postures]]");
  auto* const joints = sub->add_option("--joints", modes.joints_deg, "of the posture, in degrees: q1,q2,…")
                           ->delimiter(',')
                           ->check(number());
  sub->add_option("--axes", modes.axes, "base or flange: what the posture's modes are written in")
      ->check(one_of_words(cell::posture_axes_names))
      ->needs(cell);
  cell->needs(joints)->excludes(frfs);
  joints->needs(cell);

  sub = verb("couple", "a tool in a holder to the FRFs at its tip, without a tap test",
             [this](Progress& p) { return run(couple, common, p); });
  sub->add_option("assembly", couple.input, "assembly.toml")->required();
  CLI::Option* rotations =
      sub->add_flag("--rotations", couple.rotations, "also the rotations and moments at the tip; not with --tools");
  CLI::Option* holder_out = sub->add_option(
      "--holder-out", couple.holder_out,
      "keep the measured holder's receptances here, for every tool after: .uff .csv .mat .json; not with --tools");
  CLI::Option* tools = sub->add_option("--tools", couple.tools, "tools.csv: a table of them, as .csv or .json")
                           ->excludes(rotations)
                           ->excludes(holder_out);
  sub->add_option("--lobes", couple.lobes, "lobes.toml: each tool's best speed and depth in this cut")->needs(tools);
  sub->add_option("--frfs", couple.frfs, "a folder for the FRFs at each tool's tip, N_TOOL.uff")->needs(tools);

  sub = verb("joint", "a measured tip FRF to the stiffness and damping between tool and holder",
             [this](Progress& p) { return run(joint, common, p); });
  sub->add_option("assembly", joint.input, "assembly.toml")->required();
  sub->add_option("--measured", joint.measured, "FRFs at the tip: .uff .csv .txt .mat .json")
      ->required()
      ->allow_extra_args(false);
  sub->add_option("--as", joint.as, "names of headerless FRFs, one a file: xx,yy")->delimiter(',');
  sub->add_option("--method", joint.method, "hybrid or ga (default: hybrid)")
      ->check(one_of_words(coupling::joint_method_names));
  sub->add_option("--mutation", joint.mutation, "of ga: uniform or adaptive (default: search.mutation, else uniform)")
      ->check(one_of_words(coupling::mutation_names));
  sub->add_option("--axis", joint.axis, "which FRF is fitted: x (xx) or y (yy) (default: x)")
      ->check(CLI::IsMember({"x", "y"}));
}

/// A cut: its stability, motion and forces.
void CommandLine::add_cut_verbs() {
  CLI::App* sub =
      verb("lobes", "modes and a cut to stability lobes", [this](Progress& p) { return run(lobes, common, p); });
  sub->add_option("lobes", lobes.input, "lobes.toml")->required();
  sub->add_option("--at", lobes.at,
                  "RPM,MM (degrees where an angle is swept): spectral radius at this point; may be repeated");
  sub->add_flag("--compare", lobes.compare, "the limits by every method: error against collocation and time");

  sub = verb("explain", "measured peaks to what they are: rotation, tooth passing, or chatter and its mode",
             [this](Progress& p) { return run(explain, common, p); });
  sub->add_option("--peaks", explain.peaks_hz, "frequencies of the peaks in Hz: F,F,...")
      ->delimiter(',')
      ->check(number())
      ->required();
  sub->add_option("--rpm", explain.rpm, "spindle speed")->check(number())->required();
  sub->add_option("--teeth", explain.teeth, "teeth of the cutter")->check(whole_number(1))->required();
  sub->add_option("--modes", explain.modes, "modes.json or modes.toml")->required();
  sub->add_option(
         "--tolerance-hz", explain.tolerance_hz,
         "how far a peak may lie from what explains it, or half a mode's width where that is more (default: 1)")
      ->check(number());
  sub->add_option("--speed-tolerance-percent", explain.speed_tolerance_percent,
                  "by how much the true speed may differ from --rpm (default: 0.2)")
      ->check(number());
  sub->add_option("--lobes", explain.lobes, "lobes.toml of the cut: decides whether its chatter is regenerative");
  sub->add_option("--at", explain.at, "RPM,MM of the cut, with --lobes")->delimiter(',')->expected(2)->check(number());

  sub = verb("simulate", "a cut in the time domain: vibration, forces, the wall, stable or chatter",
             [this](Progress& p) { return run(simulate, common, p); });
  sub->add_option("lobes", simulate.input, "lobes.toml")->required();
  sub->add_option("--at", simulate.at, "RPM,MM: spindle speed and axial depth")->required();
  sub->add_option("--seconds", simulate.seconds, "how long to cut (default: 2)")->check(number());
  sub->add_option("--sample-rate-hz", simulate.sample_rate_hz, "of the output (default: 10240)")->check(number());
  sub->add_flag("--linear", simulate.linear, "no loss of contact, as lobes take the cut");

  sub = verb("forces", "a cutter in its cut, or along a program, to cutting forces",
             [this](Progress& p) { return run(forces, common, p); });
  sub->add_option("forces", forces.input, "forces.toml")->required();
  CLI::Option* along =
      sub->add_option("--program", forces.program, "an NC program: a row a block in place of one revolution");
  sub->add_option("--cell", forces.cell, "cell.toml: the robot that the cut bends");
  add_posture(sub, forces.posture_deg)->needs(along);

  sub = verb("coefficients", "average forces of slots to cutting force coefficients",
             [this](Progress& p) { return run(coefficients, common, p); });
  sub->add_option("slots", coefficients.slots, "slots.csv")->required();
  sub->add_option("--teeth", coefficients.teeth, "teeth of the cutter (default: 4, listed as assumed)")
      ->check(whole_number(1, 100));
}

/// The robot under load, and along a program.
void CommandLine::add_robot_verbs() {
  CLI::App* sub = verb("stiffness", "loads on a robot's tool and the displacements measured to joint stiffness",
                       [this](Progress& p) { return run(stiffness, common, p); });
  sub->add_option("loads", stiffness.loads, "loads.csv: joint angles, force on the robot, displacement")->required();
  sub->add_option("--cell", stiffness.cell, "cell.toml: the robot and its tool")->required();
  sub->add_option("--point-mm", stiffness.point_mm,
                  "X,Y,Z where the load attacks, in the flange frame (default: the tool's tip)")
      ->delimiter(',')
      ->expected(3)
      ->check(number());

  CLI::App* cell = parser.add_subcommand("cell", "a robot before a workpiece, cell.toml");
  cell->require_subcommand(1);
  sub = verb(
      "check", "a cell's poses, limits and reach, and workpiece poses that work where its own does not",
      [this](Progress& p) { return run(cell_check, common, p); }, cell);
  sub->add_option("cell", cell_check.cell, "cell.toml")->required();
  sub->add_option("--joints", cell_check.joints, "show this position too: q1,q2,… in degrees (mm where joints slide)")
      ->delimiter(',')
      ->check(number());
  CLI::Option* along =
      sub->add_option("--program", cell_check.program, "an NC program that the tool must follow there");
  add_posture(sub, cell_check.posture_deg)->needs(along);

  sub = verb("smooth", "an NC program to a joint trajectory within every limit of the robot",
             [this](Progress& p) { return run(smooth, common, p); });
  sub->add_option("program", smooth.program, "an NC program: .ngc .nc .gcode, .apt .cls, .csv")->required();
  sub->add_option("--cell", smooth.cell, "cell.toml: the robot, its joints' limits, [smoothing]")->required();
  sub->add_option("--method", smooth.method, "verified, optimal, paper, paper-as-printed or no-joint-jerk")
      ->check(one_of_words(path::method_names));
  add_posture(sub, smooth.posture_deg);
  sub->add_flag("--compare", smooth.compare, "all other methods beside it, in the summary and the report");
  sub->add_flag("--keep-violations", smooth.keep_violations, "write the trajectory even where it violates a limit");
  sub->add_option("--program-period-ms", smooth.program_period_ms,
                  "longest time between the points of a joint program (default: 20; 2 for .script and .servoj, always)")
      ->check(number());
}

/// While cutting, and the whole job.
void CommandLine::add_machine_verbs() {
  CLI::App* sub = verb("monitor", "a running accelerometer to an alarm, the mode that chatters and a better speed",
                       [this](Progress& p) { return run(monitor, common, p); });
  sub->add_option("monitor", monitor.config, "monitor.toml: channels, process, detector")->required();
  sub->add_option("--input", monitor.input,
                  "a recording (.wav .csv .txt .mat .uff), - for standard input, or mqtt://HOST:PORT/TOPIC (mqtts:// "
                  "with TLS); default: mqtt.topic of monitor.toml");
  sub->add_option("--format", monitor.format,
                  "of standard input, or of a file whatever its ending: f32, i16 or csv (default: auto)")
      ->check(CLI::IsMember({"auto", "f32", "i16", "csv"}));
  sub->add_flag("--live", monitor.live, "do not keep standard input waiting: leave out hops that come too fast");
  sub->add_flag("--every-window", monitor.every_window, "an event each hop, not only on change");
  sub->add_flag("--watch", monitor.watch, "level, score, state and spectrum on standard error");
  sub->add_option("--record", monitor.record, "a folder for the seconds before each alarm, as WAV");
  sub->add_option("--metrics-port", monitor.metrics_port, "answer GET /metrics on loopback; 0: any port that is free")
      ->check(whole_number(0, 65535));
  sub->add_option("--seconds", monitor.seconds, "process so much of the stream, then end")->check(number_above_zero());

  sub = verb("calibrate", "labelled recordings to the published detector's threshold",
             [this](Progress& p) { return run(calibrate, common, p); });
  sub->add_option("recordings", calibrate.recordings, "recordings.toml: files with labels")->required();

  sub = verb("plan", "the whole job: hits to safe cutting conditions",
             [this](Progress& p) { return run(plan, common, p); });
  sub->add_option("job", plan.job, "job.toml")->required();
  sub->add_flag("--accept-fit", plan.accept_fit, "go on with modes whose relative error is 20 % or more");
  add_posture(sub, plan.posture_deg);

  sub = verb("serve", "the page of a folder, over HTTP", [this](Progress& p) { return run(serve, common, p); });
  for (const char* const option : {"--report", "--allow-large"}) sub->remove_option(sub->get_option(option));
  serve::ServeOptions& options = serve.options;
  sub->add_option("folder", options.folder, "what is served, and nothing outside it (default: the current folder)");
  sub->add_option("--port", options.port, "to listen at; 0: any that is free (default: 8437)")
      ->check(whole_number(0, 65535));
  sub->add_option(
      "--host", options.host,
      "address to listen at, or localhost (default: 127.0.0.1); one that other machines reach needs a token");
  CLI::Option* const token = sub->add_option(
      "--token", options.token,
      "that whoever asks must know: 16 or more letters and digits; other users of this machine see it in ps");
  sub->add_option("--token-file", serve.token_file, "a file that has the token alone")->excludes(token);
  sub->add_option("--job-memory-mb", serve.job_memory_mb, "that a job may have (default: half the machine's)")
      ->check(whole_number(100, 100'000'000));
}

int report_error(const char* text, int exit) {
  std::fprintf(stderr, "robomill: %s\n", printable(text).c_str());
  return exit;
}

/// By errno.
int report_unwritten() {
  const std::string why = errno != 0 ? std::string(": ") + std::strerror(errno) : "";
  return report_error(("standard output cannot be written" + why).c_str(), bad_input);
}

/// Help to standard output, or what is wrong with the arguments, whose bytes may be anybody's.
Exit report_usage(const CLI::App& parser, const CLI::ParseError& error) {
  std::stringstream out, err;
  const int code = parser.exit(error, out, err);
  std::fputs(out.str().c_str(), stdout);
  for (std::string row; std::getline(err, row);) std::fprintf(stderr, "%s\n", printable(row).c_str());
  return code == 0 ? done : wrong_usage;
}

int run_chosen(int argc, char** argv) {
  CommandLine line;
  try {
    line.parser.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return report_usage(line.parser, error);
  }
  try {
    require_report_place(line.common.report);
    const io::OutputPlaces outputs(line.outputs());
    set_thread_count(line.common.threads);
    set_cost_limit(line.allow_large ? no_cost_limit : CostLimit{.way_out = "--allow-large takes it"});
    ProgressBar bar(line.common.quiet);
    return line.chosen(bar.progress());
  } catch (const InvalidInput& error) {
    return report_error(error.what(), bad_input);
  } catch (const Interrupted&) {
    return report_error("interrupted", exit_of_signal());
  } catch (const std::bad_alloc&) {
    return report_error("not enough memory for this input", bad_input);
  } catch (const std::system_error& error) {
    errno = error.code().value();
    return std::ferror(stdout) != 0 ? report_unwritten() : report_error(error.what(), bad_input);
  } catch (const std::exception& error) {
    return report_error(error.what(), bad_input);
  }
}

/// Closes standard output, where a full disk behind a redirection shows at the latest.
int end_with(int exit) {
  const bool said = exit != done && exit != not_reached;
  errno = 0;
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) return said ? exit : report_unwritten();
  // One that was closed before took nothing; all was flushed where a signal interrupts closing.
  return std::fclose(stdout) == 0 || errno == EBADF || errno == EINTR || said ? exit : report_unwritten();
}

}  // namespace
}  // namespace robomill::app

int main(int argc, char** argv) {
  try {
    // No verb: nobody but `robomill serve` starts it.
    if (argc == 2 && robomill::app::serve_worker == argv[1]) return robomill::app::work_for_server();
    return robomill::app::end_with(robomill::app::run_chosen(argc, argv));
  } catch (...) {
    // Thrown before there is a verb to blame, or by the report of another error.
    std::fputs("robomill: cannot run\n", stderr);
    return robomill::app::bad_input;
  }
}
