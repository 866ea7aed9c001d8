#include <Eigen/Core>

#include "robomill/base/units.hpp"
#include "robomill/cell/check.hpp"
#include "robomill/cell/dynamics.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/cell/posture_choice.hpp"
#include "robomill/jobs/smooth.hpp"
#include "robomill/jobs/stiffness.hpp"
#include "robomill/jobs/verbs/records.hpp"
#include "robomill/path/options.hpp"

namespace robomill::jobs {
namespace {

Outcome run_stiffness_verb(const VerbJob& job, Progress&) {
  StiffnessJob wanted = {.loads = job.input(), .cell = job.file("cell"), .output = job.output};
  if (const std::vector<double> point = job.numbers("point_mm", units::mm); !point.empty()) {
    wanted.point_m = Eigen::Vector3d(point[0], point[1], point[2]);
  }
  return finished(job, run_stiffness(wanted));
}

Outcome run_cell_check_verb(const VerbJob& job, Progress& progress) {
  cell::CellFile cell = cell::read_cell(job.input(), cell::Robots::any);
  const double unit = cell.hybrid ? units::mm : units::deg;  // all of its joints slide
  const cell::CellCheckJob wanted = {
      .cell = job.input(), .joints = job.numbers("joints", unit), .program = job.file("program")};
  return with_posture(job, [&] {
    if (job.has("posture_deg")) cell::ask_for_posture(cell, job.numbers("posture_deg"));
    return with_option(job, "joints", "joints", unit,
                       [&] { return finished(job, cell::run_cell_check(wanted, std::move(cell), progress)); });
  });
}

Outcome run_posture_modes_verb(const VerbJob& job, Progress& progress) {
  const auto axes = job.word("axes", cell::posture_axes_names).value_or(cell::PostureAxes::base);
  return with_option(job, "joints", "joints_deg", units::deg, [&] {
    return finished(job, cell::posture_modes(job.input(), job.numbers("joints_deg", units::deg), axes, progress));
  });
}

Outcome run_smooth_verb(const VerbJob& job, Progress& progress) {
  const SmoothJob wanted = {.program = job.input(),
                            .cell = job.file("cell"),
                            .method = job.word("method", path::method_names),
                            .compare = job.flag("compare"),
                            .near_deg = job.numbers("posture_deg"),
                            .options = {.output = job.output,
                                        .keep_violations = job.flag("keep_violations"),
                                        .record = job.wants_curves,
                                        .program_period_s = job.get("program_period_ms", 0.0) * units::ms}};
  process::SmoothResult result = with_posture(job, [&] {
    return with_option(job, "program_period_s", "program_period_ms", units::ms,
                       [&] { return run_smooth(wanted, progress); });
  });
  std::string json = job.wants_json ? path::smooth_json(result.smoothed) : std::string();
  return outcome_of(std::move(result), std::move(json));
}

Verb stiffness_verb() {
  return {.name = "stiffness",
          .button = "Identify joint stiffness",
          .purpose = "loads on a robot's tool and the displacements measured to joint stiffness",
          .more = "With standard deviations, and which joints the loads do not determine.",
          .example = "stiffness loads.csv --cell cell.toml -o stiffness.toml",
          .readme = "robomill/robot/README.md",
          .input = file_option("loads", "loads.csv: joint angles, force on the robot, displacement", {"loads"}, true),
          .output = "stiffness.json",
          .document = Document::stiffness,
          .options = {file_option("cell", "cell.toml: the robot and its tool", {"cell"}, true),
                      {.name = "point_mm",
                       .meaning = "X,Y,Z where the load attacks, in mm in the flange frame (default: the tool's tip)",
                       .takes = Takes::numbers,
                       .unit = "mm",
                       .count = 3}},
          .run = &run_stiffness_verb};
}

Verb cell_check_verb() {
  return {.name = "cell check",
          .button = "Check the cell",
          .purpose = "a cell's poses, limits and reach, and workpiece poses that work where its own does not",
          .more =
              "An arm by its name, or your own. Poses to compare with the pendant, a picture, and of poses out of "
              "reach by how much.",
          .example = "cell check cell.toml --joints 0,-80,108,0,62,0 --report cell.html",
          .readme = "robomill/cell/README.md",
          .input = file_option("cell", "cell.toml", {"cell"}, true),
          .output = "check.json",
          .document = Document::cell_check,
          .report = &page::Report::cell,
          .options = {file_option("program", "an NC program that the tool must follow there", {"program"}),
                      plain_option("joints", "show this position too: q1,q2,… in degrees (mm where joints slide)",
                                   Takes::numbers),
                      posture_option("program")},
          .run = &run_cell_check_verb};
}

Verb posture_modes_verb() {
  return {.name = "modes --cell",
          .button = "Predict a posture's modes",
          .purpose = "a robot with measured postures to its modes in another one",
          .example = "modes --cell cell.toml --joints 0,10,20,0,60,0 -o modes.json",
          .readme = "robomill/cell/README.md",
          .input = {.name = "cell",
                    .meaning = "cell.toml: the modes of a posture, from its [[postures]]",
                    .takes = Takes::file,
                    .required = true,
                    .flag = "--cell",
                    .kinds = {"cell"}},
          .output = "modes.json",
          .document = Document::modes,
          .options = {{.name = "joints_deg",
                       .meaning = "joints of the posture, in degrees: q1,q2,…",
                       .takes = Takes::numbers,
                       .required = true,
                       .flag = "--joints",
                       .unit = "deg"},
                      word_option("axes", "axes that the posture's modes are written in (default: base)",
                                  words_of(cell::posture_axes_names))},
          .run = &run_posture_modes_verb};
}

VerbOption smooth_cell() {
  VerbOption cell = file_option("cell", "cell.toml: the robot, its joints' limits, [smoothing]", {"cell"}, true);
  cell.job_gives = true;
  return cell;
}

Verb smooth_verb() {
  return {
      .name = "smooth",
      .button = "Smooth the program",
      .purpose = "an NC program to a joint trajectory within every limit of the robot",
      .more =
          "As CSV, HDF5, or a program for KUKA, ABB or Universal Robots; checked for collisions where the cell "
          "has [geometry].",
      .example = "smooth part.ngc --cell cell.toml -o trajectory.csv --report smooth.html",
      .readme = "robomill/path/README.md",
      .input =
          file_option("program", "an NC program: .ngc .nc .gcode, .apt .cls .cl .ncl .aptsource, .csv; or a job.toml",
                      {"program"}, true),
      .output = "trajectory.csv",
      .report = &page::Report::smooth,
      .options = {smooth_cell(), word_option("method", "method (default: the cell's)", words_of(path::method_names)),
                  flag_option("compare", "all other methods beside it, in the summary and the report"),
                  flag_option("keep_violations", "write the trajectory even where it violates a limit"),
                  positive_option("program_period_ms",
                                  "longest time between the points of a joint program, in ms (default: 20; 2 for "
                                  ".script and .servoj, always)",
                                  "ms"),
                  posture_option()},
      .run = &run_smooth_verb};
}

}  // namespace

std::vector<Verb> robot_verbs() {
  return {stiffness_verb(), cell_check_verb(), posture_modes_verb(), smooth_verb()};
}

}  // namespace robomill::jobs
