#include "robomill/process/written_program.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/process/blocks/stand_at.hpp"
#include "robomill/process/decide/block_times.hpp"
#include "robomill/process/decide/motion_loads.hpp"
#include "robomill/program/files/program_files.hpp"
#include "robomill/program/files/rewrite.hpp"
#include "robomill/robot/inverse.hpp"
#include "robomill/robot/pose.hpp"

namespace robomill::process {
namespace {

/// A program as its text says it, for a robot that is to run it.
class ReadAgain {
 public:
  ReadAgain(const std::string& name, const std::string& text, const program::ProgramReading& reading,
            const program::Program& wanted)
      : wanted_(wanted), read_(program::read_program_text(text, name, reading)) {
    // A move that turns the tool may be read as several blocks, and rapids that run on as fewer.
    std::size_t next = 0;
    for (const program::Block& block : read_.blocks) {
      std::size_t k = next;
      while (k + 1 < wanted.blocks.size() && !same_end(block, wanted.blocks[k]) &&
             wanted.blocks[k].kind == program::Block::Kind::rapid) {
        ++k;
      }
      const bool ends = same_end(block, wanted.blocks[k]);
      block_of_.push_back(ends ? k : next);
      if (ends) next = std::min(k + 1, wanted.blocks.size() - 1);
    }
  }
  /// As it is read.
  [[nodiscard]] const program::Program& read() const { return read_; }
  /// Of each block that is read the one that was wanted.
  [[nodiscard]] const std::vector<std::size_t>& block_of() const { return block_of_; }
  /// Of values at the wanted program's start and at each block's end those of the program that is read.
  [[nodiscard]] std::vector<double> along(const std::vector<double>& wanted) const {
    std::vector<double> out = {wanted.front()};
    for (std::size_t i = 0; i < read_.blocks.size(); ++i) {
      const std::size_t k = block_of_[i];
      const Eigen::Vector3d& from_m = wanted_.begin_of(k).tip_m;
      const double way_m = (wanted_.blocks[k].end.tip_m - from_m).norm();
      const bool part = way_m > 0.0 && !same_end(read_.blocks[i], wanted_.blocks[k]);
      const double share = part ? std::min((read_.blocks[i].end.tip_m - from_m).norm() / way_m, 1.0) : 1.0;
      out.push_back(std::lerp(wanted[k], wanted[k + 1], share));
    }
    return out;
  }
  /// Puts places along the wanted program where they are in the program that is read.
  void move(std::vector<path::AxisTilt>& tilts) const {
    if (tilts.empty()) return;
    std::vector<double> place(wanted_.blocks.size() + 1);
    std::iota(place.begin(), place.end(), 0.0);
    place = along(place);
    const auto moved = [&](double t) {
      const auto above = std::ranges::lower_bound(place, t) - place.begin();
      const auto end = std::min<std::size_t>(static_cast<std::size_t>(above), place.size() - 1);
      if (end == 0) return 0.0;
      const double step = place[end] - place[end - 1];
      return static_cast<double>(end) - (step > 0.0 ? std::clamp((place[end] - t) / step, 0.0, 1.0) : 0.0);
    };
    for (path::AxisTilt& tilt : tilts) {
      for (double path::AxisTilt::*const at :
           {&path::AxisTilt::from, &path::AxisTilt::full_from, &path::AxisTilt::full_to, &path::AxisTilt::to}) {
        tilt.*at = moved(tilt.*at);
      }
    }
  }

 private:
  static bool same_end(const program::Block& a, const program::Block& b) {
    constexpr double same_m = 1e-6, same_axis = 1e-6;
    return a.kind == b.kind && (a.end.tip_m - b.end.tip_m).norm() <= same_m &&
           (a.end.axis - b.end.axis).norm() <= same_axis;
  }
  const program::Program& wanted_;
  program::Program read_;
  std::vector<std::size_t> block_of_ = {};
};

/// Where the machine starts and how the flange stands along a program, turned by γ from where it was along the one that
/// was smoothed.
path::Posture posture_of(const SmoothResult& smoothed, const ReadAgain& written, const program::Program& program,
                         const std::vector<double>& gamma_offset_rad, const cell::Cell& cell) {
  const path::Posture& before = smoothed.posture.posture;
  path::Posture out = before;
  if (out.gamma_rad.empty()) out.gamma_rad = {cell.redundant_gamma_rad};
  if (!gamma_offset_rad.empty() || out.gamma_rad.size() > 1) {
    out.gamma_rad.resize(program.blocks.size() + 1, out.gamma_rad.front());
    for (std::size_t i = 0; i < gamma_offset_rad.size(); ++i) out.gamma_rad[i] += gamma_offset_rad[i];
    out.gamma_rad = written.along(out.gamma_rad);
  }
  written.move(out.tilts);
  const std::optional<Eigen::VectorXd> joints = stand_at(
      cell.robot, robot::spherical_wrist(cell.robot.arm),
      {.tip_m = program.start.tip_m, .axis = program.start.axis, .gamma_rad = out.gamma_rad.front()}, before.start);
  if (!joints) {
    throw InvalidInput("gamma", out.gamma_rad.front() / units::deg, "°", "cannot be taken where the program starts");
  }
  out.start = *joints;
  return out;
}

}  // namespace

RobotRun run_on_robot(const ProgrammedPath& programmed, const cell::Cell& cell, const WantedProgram& wanted,
                      const ProgramBlocks& blocks, Progress& progress) {
  const program::Program& program = wanted.forces.program->program;
  const program::ProgramReading& reading = programmed.path.reading;
  const program::Rewritten text = program::rewrite_program(programmed.file, reading, programmed.program, program);
  const std::string name = programmed.file.filename().string();
  const ReadAgain written(name, text.text, reading, program);
  const path::SmoothingFile& smoothing = programmed.path.smoothing;
  std::optional<MotionLoads> loads;
  if (knows_torques(cell)) loads.emplace(cell, smoothing.options.sample_period_s, written.block_of());
  BlockTimes times(written.block_of());
  const SmoothOptions options = {
      .record = false,
      .place = false,
      .posture = posture_of(programmed.path, written, program, wanted.gamma_offset_rad, cell),
      .check_collisions = false,
      .observe = [&](std::span<const path::Sample> samples) {
        times.add(samples);
        if (loads) loads->add(samples);
      }};
  program::ProgramSource source(written.read());
  const SmoothResult smoothed = smooth(source, name, cell, smoothing, options, progress);
  RobotRun out = {.time_s = smoothed.first().summary.duration_s, .block_time_s = times.times_s(), .torque_shares = {}};
  if (loads) out.torque_shares = loads->shares(wanted.forces, blocks.joint_loads);
  return out;
}

SmoothResult smooth_written(const ProgrammedPath& programmed, const cell::Cell& cell, const WantedProgram& wanted,
                            const WrittenText& written, Progress& progress) {
  const program::Program& program = wanted.forces.program->program;
  const ReadAgain read(written.name, written.text, programmed.path.reading, program);
  const SmoothOptions options = {.output = written.output,
                                 .place = false,
                                 .posture = posture_of(programmed.path, read, program, wanted.gamma_offset_rad, cell),
                                 .cutter = wanted.forces.cut.cutter};
  program::ProgramSource source(read.read());
  return smooth(source, written.name, cell, programmed.path.smoothing, options, progress);
}

}  // namespace robomill::process
