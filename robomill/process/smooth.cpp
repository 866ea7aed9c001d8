#include "robomill/process/smooth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <numbers>
#include <span>
#include <system_error>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cell/clearance.hpp"
#include "robomill/cell/posture_choice.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/text.hpp"
#include "robomill/path/drive.hpp"
#include "robomill/path/files/trajectory.hpp"
#include "robomill/path/smooth.hpp"

namespace robomill::process {
namespace {

/// Of the tolerances, what arcs' chords and the great circles of turning axes may use.
constexpr double chord_share = 0.1, turn_share = 0.05;
/// … but not less: what a reader takes.
constexpr double least_chord_m = 1e-9, least_turn_rad = 1e-9;

/// Beside a singularity of the wrist through which a program leads, ways are taken up to this condition number, and the
/// axis may leave the program's by this share of its tolerance; corners have the rest.
constexpr double condition_beside = 1e5, tilt_share = 0.6;

/// A machine with a program before it.
struct Bench {
  const cell::Cell& cell;
  const path::SmoothingFile& smoothing;
  program::Source& program;
  const std::filesystem::path& path;  ///< of the program
  std::unique_ptr<robot::Kinematics> machine = {};
  std::array<bool, 6> prismatic = {};
  path::PostureChoice posture = {};
  [[nodiscard]] std::string program_name() const { return path.filename().string(); }
};

std::array<bool, 6> prismatic_of(const cell::Cell& cell) {
  std::array<bool, 6> prismatic = {};
  if (cell.hybrid) {
    prismatic.fill(true);
    return prismatic;
  }
  const std::vector<robot::Joint>& joints = cell.robot.arm.joints;
  for (std::size_t i = 0; i < std::min(joints.size(), prismatic.size()); ++i) prismatic.at(i) = joints[i].prismatic;
  return prismatic;
}

/// @param beside  the machine that passes beside a singularity
path::PostureChoice posture_of(const Bench& bench, const robot::Kinematics& beside, Progress& progress) {
  path::PostureOptions options = cell::posture_options(bench.cell, *bench.machine);
  options.free_gamma = bench.smoothing.free_gamma;
  const path::SmoothingOptions& smoothing = bench.smoothing.options;
  if (smoothing.method == path::Method::verified || smoothing.method == path::Method::optimal) {
    options.beside = &beside;
    options.max_axis_tilt_rad =
        std::min(tilt_share * smoothing.axis_tolerance_rad, path::PostureOptions::most_tilt_rad);
  }
  return path::choose_posture(bench.program, *bench.machine, options, progress);
}

/// Calls f; an error that names no place is the program's.
template <class F>
auto located_in_program(const std::filesystem::path& program, F&& f) {
  try {
    return f();
  } catch (const InvalidInput& error) {
    if (!error.parts().where.empty()) throw;
    InvalidInput::Parts parts = error.parts();
    parts.where = program.string();
    throw InvalidInput(std::move(parts));
  }
}

/// The machine, and its posture where none is given.
void prepare(Bench& bench, const SmoothOptions& options, Progress& progress) {
  bench.machine = cell::kinematics(bench.cell);
  bench.prismatic = prismatic_of(bench.cell);
  std::unique_ptr<robot::Kinematics> beside = cell::kinematics(bench.cell, condition_beside);
  if (options.posture) {
    bench.posture.posture = *options.posture;
  } else {
    bench.posture = located_in_program(bench.path, [&] { return posture_of(bench, *beside, progress); });
  }
  if (bench.posture.posture.beside_singularity) bench.machine = std::move(beside);
}

std::unique_ptr<path::SampleFile> open_output(const SmoothOptions& options, const Bench& bench) {
  if (options.output.empty()) return nullptr;
  path::TrajectoryInfo info;
  info.joints = bench.machine->joints();
  info.prismatic = bench.prismatic;
  info.limits = bench.machine->limits();
  info.sample_period_s = bench.smoothing.options.sample_period_s;
  info.program_period_s = options.program_period_s;
  info.cell = bench.cell.path.filename().string();
  info.program = bench.program_name();
  info.end_effector = bench.cell.end_effector;
  info.workpiece = bench.cell.robot.workpiece;
  info.maker = bench.cell.maker;
  return path::open_sample_file(options.output, info);
}

/// The drives that [smoothing] describes; none where it describes none.
std::vector<path::Drive> drives_of(const path::SmoothingFile& smoothing) {
  std::vector<path::Drive> drives(smoothing.drive_bandwidth_hz.size());
  for (std::size_t i = 0; i < drives.size(); ++i) {
    path::Drive& drive = drives[i];
    drive.natural_frequency_hz = smoothing.drive_bandwidth_hz[i];
    drive.damping_ratio = smoothing.drive_damping_ratio;
    if (i >= smoothing.flexible_joint_hz.size()) continue;
    // Of the load's equation only the ratios count.
    const double omega = 2.0 * std::numbers::pi * smoothing.flexible_joint_hz[i];
    drive.load_inertia = 1.0;
    drive.joint_stiffness = omega * omega;
    drive.joint_damping = 2.0 * smoothing.flexible_joint_damping_ratio * omega;
  }
  return drives;
}

/// Drives that follow a trajectory sample by sample.
class DriveModel {
 public:
  DriveModel(const std::vector<path::Drive>& drives, double sample_period_s)
      : model_(drives, sample_period_s,
               [this](double, std::span<const double> error) { std::ranges::copy(error, tracking_error_.begin()); }) {}
  DriveModel(const DriveModel&) = delete;
  DriveModel& operator=(const DriveModel&) = delete;
  DriveModel(DriveModel&&) = delete;
  DriveModel& operator=(DriveModel&&) = delete;
  ~DriveModel() = default;

  const robot::Position6& follow(const path::Sample& sample) {
    model_.add(std::span(&sample, 1));
    return tracking_error_;
  }
  [[nodiscard]] std::vector<double> worst() const {
    std::vector<double> out;
    for (const path::TrackingError::Joint& joint : model_.result().joints) out.push_back(joint.max);
    return out;
  }

 private:
  robot::Position6 tracking_error_ = robot::Position6::Zero();
  path::DriveModel model_;
};

/// Keeps the last sample of each block.
void note_joints(std::span<const path::Sample> samples, std::vector<robot::Position6>& block_joints) {
  for (const path::Sample& sample : samples) {
    // A block too short for a sample ends where the next one begins.
    if (sample.block >= block_joints.size()) block_joints.resize(sample.block + 1, sample.joints);
    block_joints[sample.block] = sample.joints;
  }
}

using InWords = std::function<InvalidInput(const InvalidInput&)>;  // SmoothOptions::in_words

/// One method over the whole program.
/// @param file          takes the samples; may be null
/// @param recorder      as well
/// @param block_joints  as well
/// @param observe       as well; may be empty
/// @param in_words      as SmoothOptions::in_words
path::SmoothedBy smooth_by(path::Method method, const Bench& bench, path::SampleFile* file,
                           path::MotionRecorder* recorder, std::vector<robot::Position6>* block_joints,
                           const path::SampleSink& observe, const InWords& in_words, Progress& progress) {
  path::SmoothingOptions options = bench.smoothing.options;
  options.method = method;
  path::SmoothedBy out{.method = method};
  const std::vector<path::Drive> drives = drives_of(bench.smoothing);
  std::optional<DriveModel> drive_model;
  const auto take = [&](std::span<const path::Sample> samples) {
    if (file != nullptr) file->add(samples);
    if (block_joints != nullptr) note_joints(samples, *block_joints);
    if (observe) observe(samples);
    if (recorder != nullptr) {
      recorder->add(samples);
    } else if (drive_model) {
      for (const path::Sample& sample : samples) drive_model->follow(sample);
    }
  };
  const auto restart = [&] {
    if (file != nullptr) file->restart();
    if (block_joints != nullptr) block_joints->clear();
    if (!drives.empty()) drive_model.emplace(drives, options.sample_period_s);
    if (recorder == nullptr) return;
    recorder->restart(drive_model ? path::Tracking([&](const path::Sample& s) { return drive_model->follow(s); })
                                  : path::Tracking());
  };
  try {
    out.summary = path::smooth(bench.program, *bench.machine, bench.posture.posture, options, take, restart, progress);
  } catch (const InvalidInput& error) {
    throw in_words ? in_words(error) : error;
  }
  if (drive_model) out.tracking_error = drive_model->worst();
  return out;
}

/// What a controller makes of a joint program that leaves its tolerances, and what would help.
std::string program_note(const path::ProgramRun& run) {
  const double tip_m = std::max(run.distances.tip_deviation_m, run.distances.tip_error_m);
  const double axis_rad = std::max(run.distances.axis_deviation_rad, run.distances.axis_error_rad);
  std::string note = fmt::format(
      "Joints interpolated between the program's points leave the programmed path by {:.4g} mm and {:.4g}° and the "
      "trajectory by {:.4g} mm and {:.4g}°; the tolerances are {:.4g} mm and {:.4g}°.",
      run.distances.tip_error_m / units::mm, run.distances.axis_error_rad / units::deg,
      run.distances.tip_deviation_m / units::mm, run.distances.axis_deviation_rad / units::deg,
      run.tip_tolerance_m / units::mm, run.axis_tolerance_rad / units::deg);
  if (run.would_hold_s > 0.0) {
    return note + fmt::format(" --program-period-ms {:.6g} would hold.", run.would_hold_s / units::ms);
  }
  note += run.fixed_cycle ? " No shorter cycle of whole samples holds." : " Points at every sample do not hold.";
  return note + fmt::format(
                    " Smooth with a shorter sample_period_ms or less acceleration, or allow tip_tolerance_mm = {:.4g} "
                    "and axis_tolerance_deg = {:.4g}.",
                    std::max(tip_m, run.tip_tolerance_m) / units::mm,
                    std::max(axis_rad, run.axis_tolerance_rad) / units::deg);
}

/// A joint program that its controller is not known to load, and what would help.
std::string length_note(const path::ProgramRun& run) {
  return fmt::format(
      "The robot program has {} points; such a controller is known to load about {}. {}", run.points, run.most_points,
      run.fixed_cycle ? "Write .servoj, whose rows a client sends, give a longer --program-period-ms, or split the NC "
                        "program where the tool is clear of the part."
                      : "Split the NC program where the tool is clear of the part.");
}

/// A joint program of more spindle speeds than it can carry out, and what would help.
std::string speeds_note(const path::ProgramRun& run) {
  std::string speeds;
  for (const double speed : run.spindle_speeds_rad_per_s) {
    speeds += fmt::format("{}{:.6g}", speeds.empty() ? "" : ", ", speed / units::rpm);
  }
  return fmt::format(
      "The NC program asks for {} spindle speeds, {} rpm; a robot program only switches the spindle on and carries out "
      "one. Give the program one speed (decide.speed_changes = \"none\" in the job of robomill plan), or split it "
      "where the speed changes.",
      run.spindle_speeds_rad_per_s.size(), speeds);
}

/// How far bodies are looked for beyond the cell's clearance, so that a least distance can be said.
constexpr double reach_m = 0.05;

std::size_t line_of(program::Source& program, std::size_t block) {
  program.rewind();
  program::Block at;
  for (std::size_t k = 0; program.next(at); ++k) {
    if (k == block) return at.line;
  }
  return 0;
}

/// The way from where the arm stands first to where a joint program begins, which its controller drives in the joints.
void note_approach(const Bench& bench, const robot::CollisionChecker& checker, const robot::Position6& first,
                   std::vector<std::string>& notes) {
  const std::vector<double>& home = bench.cell.start_joints;
  const auto joints = static_cast<Eigen::Index>(bench.cell.robot.arm.joints.size());
  if (static_cast<Eigen::Index>(home.size()) != joints || bench.cell.posture_asked) return;
  const Eigen::VectorXd from = Eigen::Map<const Eigen::VectorXd>(home.data(), joints);
  const robot::MoveClearance move =
      checker.check_move(from, first.head(joints), cell::look_step_m(*bench.cell.geometry));
  if (move.clearance.status == robot::Clearance::Status::clear) return;
  notes.push_back(
      fmt::format("On the straight way of the joints from start_joints_deg to the first position, {:.0f} % of the way, "
                  "{}: bring the "
                  "robot to the first position another way.",
                  100.0 * move.fraction, cell::near_miss_text(move.clearance)));
}

/// Whose controller a joint program is for, where the cell does not say whose arm it is.
std::optional<Assumption> assumed_maker(const SmoothOptions& options, const cell::Cell& cell) {
  if (!cell.maker.empty()) return std::nullopt;
  const std::string ending = io::lowered(options.output.extension().string());
  const char* maker = ending == ".src" ? path::maker_kuka : ending == ".mod" ? path::maker_abb : nullptr;
  if (ending == ".script" || ending == ".servoj") maker = path::maker_universal_robots;
  if (maker == nullptr) return std::nullopt;
  return Assumption{.what = "Maker of the arm",
                    .taken = fmt::format("{}, by the ending {}; joints must have its zeros and signs", maker, ending),
                    .key = "robot.model",
                    .file = cell.path.filename().string()};
}

/// @param exported  the trajectory is written as a robot program, which sets the load
std::vector<Assumption> assumed_of(const Bench& bench, bool exported) {
  std::vector<Assumption> out = cell::assumed_along_program(bench.cell, true);
  add_assumed(out, bench.program.remarks().assumed);
  const path::EndEffector& end = bench.cell.end_effector;
  if (exported && end.mass_kg && !end.load_number && end.tool_name.empty()) {
    out.push_back({.what = "Load on the flange",
                   .taken = end.center_m ? "without moments of inertia"
                                         : "its centre half-way to the tip, without moments of inertia",
                   .key = end.center_m ? "tool.load_number" : "tool.center_mm",
                   .file = bench.cell.path.filename().string()});
  }
  return out;
}

void report(SmoothResult& result, const SmoothOptions& options, const Bench& bench) {
  path::SmoothedProgram& smoothed = result.smoothed;
  smoothed.program = bench.program_name();
  smoothed.cell = bench.cell.path.filename().string();
  smoothed.prismatic = bench.prismatic;
  const std::vector<double>& gamma_rad = bench.posture.posture.gamma_rad;
  if (bench.machine->turns_about_axis() && !gamma_rad.empty()) {
    const auto [lowest, highest] = std::ranges::minmax(gamma_rad);
    smoothed.gamma_rad = {lowest, highest};
  }
  const program::Remarks remarks = bench.program.remarks();
  smoothed.skipped = remarks.skipped;
  std::vector<std::string>& notes = smoothed.notes;
  notes.insert(notes.end(), bench.cell.notes.begin(), bench.cell.notes.end());
  if (!options.posture) {
    smoothed.posture = bench.posture;
    const std::vector<std::string> of_posture = cell::posture_notes(bench.posture);
    notes.insert(notes.end(), of_posture.begin(), of_posture.end());
  }
  notes.insert(notes.end(), remarks.notes.begin(), remarks.notes.end());
  add_assumed(smoothed.assumed, assumed_of(bench, smoothed.robot_program.has_value()));
  if (const std::optional<Assumption> maker = assumed_maker(options, bench.cell)) smoothed.assumed.push_back(*maker);
  if (!smoothed.clearance) smoothed.assumed.push_back(unchecked_collisions(bench.cell));
  if (remarks.skipped_count > smoothed.skipped.size()) {
    notes.push_back(fmt::format("{} statements of the program were left out; the first {} are listed.",
                                remarks.skipped_count, smoothed.skipped.size()));
  }
  if (result.trajectory_holds() && smoothed.robot_program) {
    if (!smoothed.robot_program->keeps_tolerances()) notes.push_back(program_note(*smoothed.robot_program));
    if (!smoothed.robot_program->one_speed()) notes.push_back(speeds_note(*smoothed.robot_program));
    if (smoothed.robot_program->too_long()) notes.push_back(length_note(*smoothed.robot_program));
  }
  if (!bench.posture.whole) {
    notes.push_back(
        fmt::format("The machine's posture was chosen by the program's first {} blocks.", bench.posture.blocks));
  }
}

/// What the check for collisions cannot say, or says of the way to the first position.
void note_clearance(SmoothResult& result, const Bench& bench, const robot::CollisionChecker& checker,
                    const std::optional<robot::Position6>& first) {
  std::vector<std::string>& notes = result.smoothed.notes;
  for (const std::string& note : checker.notes()) notes.push_back("Collisions: " + note + ".");
  if (!result.smoothed.clearance->covers_moves()) {
    notes.push_back(
        fmt::format("Collisions: between two positions that were looked at a point moves up to {:.3g} mm; only a "
                    "clearance of half of "
                    "that, geometry.clearance_mm, leaves nothing unseen.",
                    result.smoothed.clearance->between_m / units::mm));
  }
  if (result.smoothed.robot_program && first) note_approach(bench, checker, *first, notes);
}

/// What takes the samples of the smoothing's own method.
struct Takers {
  path::SampleFile* file = nullptr;
  path::MotionRecorder* recorder = nullptr;
  const path::SampleSink& observe;
};

void run_first(SmoothResult& result, const Bench& bench, const InWords& in_words, const Takers& takers,
               Progress& progress) {
  result.smoothed.methods.push_back(located_in_program(bench.path, [&] {
    return smooth_by(bench.smoothing.options.method, bench, takers.file, takers.recorder, &result.block_joints,
                     takers.observe, in_words, progress);
  }));
  if (takers.recorder != nullptr) result.motions.push_back(takers.recorder->motion());
}

void run_others(SmoothResult& result, const Bench& bench, const SmoothOptions& options, path::MotionRecorder* recorder,
                Progress& progress) {
  for (const path::Method method : options.compare) {
    try {
      result.smoothed.methods.push_back(located_in_program(bench.path, [&] {
        return smooth_by(method, bench, nullptr, recorder, nullptr, {}, options.in_words, progress);
      }));
    } catch (const InvalidInput& error) {
      result.smoothed.notes.push_back(left_out_note(method, error));
      continue;
    }
    if (recorder != nullptr) result.motions.push_back(recorder->motion());
  }
}

}  // namespace

Assumption unchecked_collisions(const cell::Cell& cell) {
  Assumption out{.what = "Collisions", .taken = "none; nothing was checked"};
  if (cell.hybrid) return out;  // whose bodies cannot be given
  out.key = "geometry";
  out.file = cell.path.filename().string();
  return out;
}

program::ProgramReading smoothed_reading(const cell::Cell& cell, const path::SmoothingOptions& options) {
  program::ProgramReading reading = cell::program_reading(cell);
  reading.chord_tolerance_m = std::max(chord_share * options.tip_tolerance_m, least_chord_m);
  reading.axis_tolerance_rad = std::max(turn_share * options.axis_tolerance_rad, least_turn_rad);
  return reading;
}

SmoothResult smooth(program::Source& program, const std::filesystem::path& path, const cell::Cell& cell,
                    const path::SmoothingFile& smoothing, const SmoothOptions& options, Progress& progress) {
  Bench bench = {.cell = cell, .smoothing = smoothing, .program = program, .path = path};
  prepare(bench, options, progress);
  SmoothResult result;
  result.smoothing = smoothing;
  result.posture = bench.posture;
  result.reading = smoothed_reading(cell, smoothing.options);
  std::unique_ptr<path::SampleFile> file = open_output(options, bench);
  std::unique_ptr<robot::CollisionChecker> checker;
  if (options.check_collisions) {
    checker = cell::clearance_checker(cell, options.cutter ? &*options.cutter : nullptr, result.smoothed.assumed);
  }
  std::optional<cell::PathLooks> looks;
  if (checker) looks.emplace(*checker, bench.machine->joints(), cell::look_step_m(*cell.geometry));
  std::optional<robot::Position6> first_position;
  const path::SampleSink observe = [&](std::span<const path::Sample> samples) {
    if (looks && !samples.empty() && samples.front().time_s == 0.0) {
      looks->restart();
      first_position = samples.front().joints;
    }
    if (looks) looks->add(samples);
    if (options.observe) options.observe(samples);
  };
  std::optional<path::MotionRecorder> recorder;
  if (options.record) {
    result.outline = path::outline(program, smoothing.options.tip_tolerance_m);
    recorder.emplace(bench.machine->joints(), bench.prismatic, smoothing.options.sample_period_s,
                     result.outline.corners);
  }
  run_first(result, bench, options.in_words,
            {.file = file.get(), .recorder = recorder ? &*recorder : nullptr, .observe = observe}, progress);
  if (looks) {
    path::PathClearance& clearance =
        result.smoothed.clearance.emplace(looks->check(cell.geometry->clearance_m, reach_m));
    clearance.line = line_of(program, clearance.block);
  }
  if (file != nullptr) {
    result.smoothed.robot_program = located_in_program(path, [&] {
      return file->verify(program, *bench.machine, smoothing.options, result.trajectory_holds(), progress);
    });
  }
  run_others(result, bench, options, recorder ? &*recorder : nullptr, progress);
  report(result, options, bench);
  if (checker) note_clearance(result, bench, *checker, first_position);
  if (file == nullptr) return result;
  if (result.smoothed.clearance) file->state_collisions(path::clearance_text(*result.smoothed.clearance));
  result.output = options.output;
  result.smoothed.written = result.holds() || (options.keep_violations && result.clear());
  if (result.smoothed.written) {
    result.trajectory = std::move(file);
  } else {
    std::error_code ignored;
    result.stale = std::filesystem::is_regular_file(options.output, ignored);
  }
  if (result.stale) {
    result.smoothed.notes.push_back(
        fmt::format("The {} of an earlier run was removed: this one has none.", options.output.filename().string()));
  }
  if (options.place) place(result);
  return result;
}

PreparedMachine prepare_machine(program::Source& program, const std::filesystem::path& path, const cell::Cell& cell,
                                const path::SmoothingFile& smoothing, Progress& progress) {
  Bench bench = {.cell = cell, .smoothing = smoothing, .program = program, .path = path};
  prepare(bench, {}, progress);
  return {.machine = std::move(bench.machine), .posture = std::move(bench.posture)};
}

void place(const SmoothResult& result) {
  if (result.trajectory) result.trajectory->commit();
  if (result.stale) io::remove_file(result.output);
}

std::string left_out_note(path::Method method, const InvalidInput& error) {
  return fmt::format("{} is left out: {}", name_in(path::method_names, method), error.what());
}

double joint_share(const path::CheckResult& check) {
  double share = 0.0;
  for (const path::CheckResult::Joint& joint : check.joints) {
    for (const path::Usage* usage : {&joint.velocity, &joint.acceleration, &joint.jerk}) {
      if (usage->limit > 0.0) share = std::max(share, usage->max / usage->limit);
    }
  }
  return share;
}

}  // namespace robomill::process
