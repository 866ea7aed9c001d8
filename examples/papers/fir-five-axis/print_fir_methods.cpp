// print_fir_methods PROGRAM CELL FOLDER: what the published methods make of a program, block by block. Writes
//   blocks.csv          a row a block: T1, T2, T3, overlap and the sum of T2 so far, of each method
//   motion-METHOD.csv   a row a millisecond: path, speeds, joint 4's jerk and tracking error
//   moments.csv         the five corners where joint 4's jerk is largest without its limit, A to E in order of time
//   drives.csv          the change of the tracking error by the joint jerk limit, over the drive's frequencies
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/names.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/io/file.hpp"
#include "robomill/path/drive.hpp"
#include "robomill/path/files/smoothing_toml.hpp"
#include "robomill/path/published/fir.hpp"
#include "robomill/process/smooth.hpp"
#include "robomill/program/files/program_files.hpp"

namespace {

using namespace robomill;
using path::Method;

constexpr std::size_t tracked = 3;  // joint 4
constexpr std::size_t moments = 5;  // A to E

struct Run {
  Method method = Method::paper;
  path::FirPlan plan;
  std::vector<path::Sample> samples;
  [[nodiscard]] const std::vector<path::FirBlock>& blocks() const { return plan.trajectory.blocks(); }
  [[nodiscard]] double middle_of(std::size_t block) const {
    return 0.5 * (blocks()[block].start_s + blocks()[block].end_s);
  }
};

struct Inputs {
  program::Program program;
  cell::CellFile cell;
  path::SmoothingFile smoothing;
  std::unique_ptr<robot::Kinematics> machine;
};

Inputs read(const std::filesystem::path& program, const std::filesystem::path& cell_file) {
  Inputs in = {.program = {}, .cell = cell::read_cell(cell_file, cell::Robots::any), .smoothing = {}, .machine = {}};
  in.machine = cell::kinematics(in.cell);
  in.smoothing = path::read_smoothing(*in.cell.document, in.machine->limits(), in.machine->joints());
  if (in.smoothing.drive_bandwidth_hz.empty() || in.smoothing.flexible_joint_hz.empty()) {
    throw InvalidInput(cell_file.string(), "smoothing.drive_bandwidth_hz and flexible_joint_hz are needed",
                       "They say what drives follow the trajectory");
  }
  in.program = program::read_program(program, process::smoothed_reading(in.cell, in.smoothing.options));
  return in;
}

/// The machine begins as `robomill smooth` has it begin.
path::Posture posture_of(const Inputs& in, const std::filesystem::path& program) {
  program::ProgramSource source(in.program);
  process::SmoothOptions options;
  options.record = false;
  return process::smooth(source, program, in.cell, in.smoothing, options).posture.posture;
}

Run run(const Inputs& in, const path::Posture& posture, Method method) {
  path::SmoothingOptions options = in.smoothing.options;
  options.method = method;
  Run out = {.method = method, .plan = plan_fir(in.program, *in.machine, posture, options), .samples = {}};
  (void)sample_fir(
      out.plan, in.program, *in.machine, posture, options.sample_period_s,
      [&](std::span<const path::Sample> part) { out.samples.insert(out.samples.end(), part.begin(), part.end()); });
  return out;
}

/// Joint 4's jerk by the third differences that the check takes; 0 where three samples are not there.
std::vector<double> jerks(const Run& run, double period_s) {
  std::vector<double> out(run.samples.size(), 0.0);
  const auto q = [&run](std::size_t i) { return run.samples[i].joints[tracked]; };
  for (std::size_t i = 1; i + 2 < out.size(); ++i) {
    out[i] = (q(i + 2) - 3.0 * q(i + 1) + 3.0 * q(i) - q(i - 1)) / std::pow(period_s, 3);
  }
  return out;
}

/// The drives of [smoothing], all joints alike, with another frequency of the servo or of the load on a spring behind
/// it.
struct Drives {
  const path::SmoothingFile& smoothing;
  [[nodiscard]] path::Drive servo(double hz) const {
    return {.natural_frequency_hz = hz, .damping_ratio = smoothing.drive_damping_ratio};
  }
  [[nodiscard]] path::Drive loaded(double hz, double feed_forward = 0.0) const {
    path::Drive drive = servo(smoothing.drive_bandwidth_hz.front());
    const double omega = 2.0 * std::numbers::pi * hz;
    drive.velocity_feed_forward = feed_forward;
    drive.load_inertia = 1.0;  // of the load's equation only the ratios count
    drive.joint_stiffness = omega * omega;
    drive.joint_damping = 2.0 * smoothing.flexible_joint_damping_ratio * omega;
    return drive;
  }
  [[nodiscard]] path::Drive as_given() const { return loaded(smoothing.flexible_joint_hz.front()); }
};

/// Tracking errors of the joints, sample by sample.
std::vector<std::array<double, 5>> errors(const Run& run, const path::Drive& drive, double period_s) {
  std::vector<std::array<double, 5>> out;
  path::DriveModel model(std::vector<path::Drive>(5, drive), period_s, [&](double, std::span<const double> error) {
    std::ranges::copy(error, out.emplace_back().begin());
  });
  model.add(run.samples);
  return out;
}

/// When two blocks' corner counts: from the middle of the one to the middle of the next.
struct Window {
  std::size_t begin = 0, end = 0;
};
Window window_of(const Run& run, std::size_t corner, double period_s) {
  const auto at = [&](double time_s) {
    return std::min(run.samples.size(), static_cast<std::size_t>(std::ceil(time_s / period_s)));
  };
  return {.begin = at(run.middle_of(corner)), .end = at(run.middle_of(corner + 1))};
}

/// Index of the largest magnitude in a window.
template <class F>
std::size_t largest(const Window& window, F value) {
  std::size_t best = window.begin;
  for (std::size_t i = window.begin; i < window.end; ++i) {
    if (std::abs(value(i)) > std::abs(value(best))) best = i;
  }
  return best;
}

std::string blocks_csv(const std::vector<Run>& runs) {
  std::string text = "block";
  for (const Run& run : runs) {
    for (const std::string_view what : {"t1_s", "t2_s", "t3_s", "overlap_s", "sum_t2_s"}) {
      text += fmt::format(",{}_{}", name_in(path::method_names, run.method), what);
    }
  }
  text += '\n';
  std::vector<double> sums(runs.size(), 0.0);
  for (std::size_t block = 0; block < runs.front().blocks().size(); ++block) {
    text += fmt::format("{}", block + 1);
    for (std::size_t k = 0; k < runs.size(); ++k) {
      const path::FirBlock& at = runs[k].blocks()[block];
      sums[k] += at.tip.width_s[1];
      text += fmt::format(",{:.6f},{:.6f},{:.6f},{:.6f},{:.6f}", at.tip.width_s[0], at.tip.width_s[1],
                          at.tip.width_s[2], at.overlap_s, sums[k]);
    }
    text += '\n';
  }
  return text;
}

std::string motion_csv(const Run& run, const Drives& drives, double limit, double period_s) {
  const std::vector<double> jerk = jerks(run, period_s);
  const std::vector<std::array<double, 5>> error = errors(run, drives.as_given(), period_s);
  std::string text =
      "time_s,block,x_mm,y_mm,tip_mm_per_s,axis_deg_per_s,joint_4_jerk_m_per_s3,limit_m_per_s3,lower_limit_m_per_s3,"
      "joint_4_error_um\n";
  for (std::size_t i = 0; i < run.samples.size(); ++i) {
    const path::Sample& at = run.samples[i];
    const robot::ToolJet jet = run.plan.trajectory.at(at.time_s);
    text +=
        fmt::format("{:.3f},{},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{},{},{:.4f}\n", at.time_s, at.block + 1,
                    1e3 * at.tip_m.x(), 1e3 * at.tip_m.y(), 1e3 * jet.tip_m.col(1).norm(),
                    jet.axis.col(1).norm() * 180.0 / std::numbers::pi, jerk[i], limit, -limit, 1e6 * error[i][tracked]);
  }
  return text;
}

/// The corners A to E, by the jerk that the first run has there.
std::vector<std::size_t> worst_corners(const Run& earlier, double period_s) {
  const std::vector<double> jerk = jerks(earlier, period_s);
  std::vector<std::size_t> corners(earlier.blocks().size() - 1);
  for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = i;
  const auto size = [&](std::size_t corner) {
    return std::abs(jerk[largest(window_of(earlier, corner, period_s), [&](std::size_t i) { return jerk[i]; })]);
  };
  std::ranges::stable_sort(corners, std::ranges::greater(), size);
  corners.resize(std::min(corners.size(), moments));
  std::ranges::sort(corners);
  return corners;
}

std::string moments_csv(const Run& earlier, const Run& paper, const Drives& drives, double period_s) {
  std::string text = "moment,after_block";
  for (const Run* run : {&earlier, &paper}) {
    for (const std::string_view what :
         {"time_s", "jerk_m_per_s3", "error_at_time_um", "largest_error_time_s", "largest_error_um"}) {
      text += fmt::format(",{}_{}", name_in(path::method_names, run->method), what);
    }
  }
  text += ",change_at_time_percent,change_of_largest_percent\n";
  const std::vector<std::size_t> corners = worst_corners(earlier, period_s);
  for (std::size_t k = 0; k < corners.size(); ++k) {
    text += fmt::format("{},{}", static_cast<char>('A' + k), corners[k] + 1);
    std::array<std::array<double, 2>, 2> found = {};
    for (const std::size_t which : {std::size_t{0}, std::size_t{1}}) {
      const Run& run = which == 0 ? earlier : paper;
      const std::vector<double> jerk = jerks(run, period_s);
      const std::vector<std::array<double, 5>> error = errors(run, drives.as_given(), period_s);
      const Window window = window_of(run, corners[k], period_s);
      const std::size_t peak = largest(window, [&](std::size_t i) { return jerk[i]; });
      // What the corner does to the drive comes after it: from where the next block begins.
      const double begin_s = run.blocks()[corners[k] + 1].start_s;
      const Window after = {.begin = static_cast<std::size_t>(std::ceil(begin_s / period_s)), .end = window.end};
      const std::size_t off = largest(after, [&](std::size_t i) { return error[i][tracked]; });
      found.at(which) = {std::abs(error[peak][tracked]), std::abs(error[off][tracked])};
      text += fmt::format(",{:.3f},{:.3f},{:.2f},{:.3f},{:.2f}", run.samples[peak].time_s, jerk[peak],
                          1e6 * error[peak][tracked], run.samples[off].time_s, 1e6 * error[off][tracked]);
    }
    for (const std::size_t what : {std::size_t{0}, std::size_t{1}}) {
      text += fmt::format(",{:.2f}", 100.0 * (found[1].at(what) / found[0].at(what) - 1.0));
    }
    text += '\n';
  }
  return text;
}

/// Largest error of all joints, and of joint 4.
std::array<double, 2> largest_errors(const Run& run, const path::Drive& drive, double period_s) {
  path::DriveModel model(std::vector<path::Drive>(5, drive), period_s);
  model.add(run.samples);
  const path::TrackingError result = model.result();
  std::array<double, 2> out = {0.0, result.joints[tracked].max};
  for (const path::TrackingError::Joint& joint : result.joints) out[0] = std::max(out[0], joint.max);
  return out;
}

std::string drives_csv(const Run& earlier, const Run& paper, const Drives& drives, double period_s) {
  std::string text =
      "frequency_hz,load_percent,load_joint_4_percent,load_fed_forward_percent,load_fed_forward_joint_4_percent,"
      "servo_percent,servo_joint_4_percent\n";
  for (int tenths = 60; tenths <= 150; ++tenths) {
    const double hz = 0.1 * tenths;
    text += fmt::format("{:.1f}", hz);
    for (const path::Drive& drive : {drives.loaded(hz), drives.loaded(hz, 1.0), drives.servo(hz)}) {
      const std::array<double, 2> before = largest_errors(earlier, drive, period_s),
                                  after = largest_errors(paper, drive, period_s);
      for (const std::size_t k : {std::size_t{0}, std::size_t{1}}) {
        text += fmt::format(",{:.3f}", 100.0 * (after.at(k) / before.at(k) - 1.0));
      }
    }
    text += '\n';
  }
  return text;
}

void write(const std::filesystem::path& program, const std::filesystem::path& cell,
           const std::filesystem::path& folder) {
  const Inputs in = read(program, cell);
  const path::Posture posture = posture_of(in, program);
  const double period_s = in.smoothing.options.sample_period_s;
  const Drives drives = {in.smoothing};
  std::vector<Run> runs;
  for (const Method method : {Method::no_joint_jerk, Method::paper, Method::paper_as_printed}) {
    runs.push_back(run(in, posture, method));
  }
  std::filesystem::create_directories(folder);
  io::write_file(folder / "blocks.csv", blocks_csv(runs));
  for (const Run& run : runs) {
    io::write_file(folder / fmt::format("motion-{}.csv", name_in(path::method_names, run.method)),
                   motion_csv(run, drives, in.machine->limits().max_jerk[tracked], period_s));
  }
  io::write_file(folder / "moments.csv", moments_csv(runs[0], runs[1], drives, period_s));
  io::write_file(folder / "drives.csv", drives_csv(runs[0], runs[1], drives, period_s));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fputs("usage: print_fir_methods PROGRAM CELL FOLDER\n", stderr);
    return 2;
  }
  try {
    write(argv[1], argv[2], argv[3]);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
