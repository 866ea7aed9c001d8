// make_whole_program DIRECTORY: a KR 210-like arm measured in ten postures, and two five-axis programs for it:
// cell.toml, posture_1.uff …, face.ngc, face_forces.toml, hollow.ngc, hollow_forces.toml.
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <filesystem>

#include "examples/postures/ten_postures.hpp"
#include "examples/whole-program/part.hpp"
#include "robomill/io/file.hpp"
#include "robomill/modal/files/frf_files.hpp"

namespace {

using namespace robomill;

/// The drives' limits, and how the program is smoothed.
constexpr const char* drives = R"(gamma_deg = 0                       # as in the measured postures
joint_max_velocity_deg_per_s = [123, 115, 112, 179, 172, 219]
joint_max_acceleration_deg_per_s2 = [300, 300, 300, 600, 600, 900]
joint_max_jerk_deg_per_s3 = [4000, 4000, 4000, 12000, 12000, 18000]
joint_max_torque_n_m = [12000, 16000, 9000, 2500, 2500, 1500]  # assumed: makers do not publish them
)";
constexpr const char* smoothing = R"(
[program]
machine = "xyzac-trt"               # what A and C mean; tip positions

[smoothing]
tip_tolerance_mm = 0.02
axis_tolerance_deg = 0.1
max_velocity_mm_per_s = 100
max_acceleration_mm_per_s2 = 1000
max_jerk_mm_per_s3 = 20000
max_angular_velocity_deg_per_s = 60
max_angular_acceleration_deg_per_s2 = 600
max_angular_jerk_deg_per_s3 = 12000
sample_period_ms = 4
)";
/// Obstacles around the tool.
constexpr const char* geometry = R"(
[geometry]
stickout_mm = 45
holder = [{ length_mm = 30, diameter_mm = 26, upper_diameter_mm = 36 }, { length_mm = 25, diameter_mm = 48 }]
spindle = [{ length_mm = 160, diameter_mm = 90 }]
clearance_mm = 2
fixtures = [
  { name = "front jaw", box_from_mm = [-45, -60, -45], box_to_mm = [45, -26, -2] },
  { name = "rear jaw", box_from_mm = [-45, 26, -45], box_to_mm = [45, 60, -2] },
  { name = "table", box_from_mm = [-300, -300, -80], box_to_mm = [300, 300, -45] },
]
)";

void run(const std::filesystem::path& directory) {
  const modal::testing::SimulatedArm arm(examples::arm_seed);
  const std::vector<Eigen::VectorXd> joints = examples::joints_of_poses(arm);
  std::filesystem::create_directories(directory);
  for (std::size_t p = 0; p < joints.size(); ++p) {
    modal::write_frfs(directory / fmt::format("posture_{}.uff", p + 1), arm.measure(joints[p], p + 1));
  }
  io::write_file(directory / "cell.toml", examples::cell_toml(arm, joints, drives) + smoothing + geometry);
  io::write_file(directory / "face.ngc", examples::face_program());
  io::write_file(directory / "face_forces.toml", examples::face_forces());
  io::write_file(directory / "hollow.ngc", examples::hollow_program());
  io::write_file(directory / "hollow_forces.toml", examples::hollow_forces());
  fmt::print("{} postures and 2 programs in {}\n", joints.size(), directory.string());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: make_whole_program DIRECTORY\n", stderr);
    return 2;
  }
  try {
    run(argv[1]);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
