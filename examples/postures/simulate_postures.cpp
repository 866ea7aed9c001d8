// simulate_postures DIRECTORY: a KR 210-like arm at ten postures: cell.toml, the FRFs that a hammer would
// measure there (posture_1.uff …, 5 % noise), a lobes_1.toml … for each posture, and limits.csv: the limit depths of
// the simulated arm itself, of all its modes and of those at 500 to 600 Hz alone.
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>

#include "examples/postures/limits_svg.hpp"
#include "examples/postures/ten_postures.hpp"
#include "robomill/io/file.hpp"
#include "robomill/modal/files/frf_files.hpp"

namespace {

using namespace robomill;

std::string depth_mm(double limit_m) {
  return std::isfinite(limit_m) ? fmt::format("{:.4f}", 1e3 * limit_m) : std::string();
}

/// limits.csv, a row a posture and speed, and its figure; how far the curves of each direction lie apart.
void write_limits(const std::filesystem::path& directory, const modal::testing::SimulatedArm& arm,
                  const std::vector<Eigen::VectorXd>& joints) {
  std::vector<double> speeds;
  for (double rpm = 3000.0; rpm <= 15000.0; rpm += 200.0) speeds.push_back(rpm);
  std::vector<std::vector<double>> all, few;
  std::string out = "posture,spindle_speed_rpm,limit_depth_mm,limit_depth_500_600_hz_mm\n";
  for (std::size_t p = 0; p < joints.size(); ++p) {
    const modal::ModalModel modes = arm.modes(joints[p]);
    all.push_back(examples::limit_curve(modes, speeds));
    few.push_back(examples::limit_curve(examples::modes_between(modes, 500.0, 600.0), speeds));
    for (std::size_t k = 0; k < speeds.size(); ++k) {
      out += fmt::format("{},{:g},{},{}\n", p + 1, speeds[k], depth_mm(all[p][k]), depth_mm(few[p][k]));
    }
  }
  for (const examples::Direction& direction : examples::directions()) {
    std::vector<std::vector<double>> of_all, of_few;
    for (const std::size_t p : direction.postures) {
      of_all.push_back(all[p]);
      of_few.push_back(few[p]);
    }
    fmt::print("limits over {}: {:.0f} % apart; of the modes at 500 to 600 Hz alone: {:.0f} %\n", direction.name,
               100.0 * examples::spread(of_all), 100.0 * examples::spread(of_few));
  }
  io::write_file(directory / "limits.csv", out);
  io::write_file(directory / "limits.svg",
                 examples::limits_svg(speeds, {{.title = "modes at 500 to 600 Hz", .limit_m = few},
                                               {.title = "all modes", .limit_m = all}}));
}

void run(const std::filesystem::path& directory) {
  const modal::testing::SimulatedArm arm(examples::arm_seed);
  const std::vector<Eigen::VectorXd> joints = examples::joints_of_poses(arm);
  std::filesystem::create_directories(directory);
  for (std::size_t p = 0; p < joints.size(); ++p) {
    modal::write_frfs(directory / fmt::format("posture_{}.uff", p + 1), arm.measure(joints[p], p + 1));
    io::write_file(directory / fmt::format("lobes_{}.toml", p + 1), examples::lobes_toml(joints[p]));
  }
  io::write_file(directory / "cell.toml", examples::cell_toml(arm, joints));
  write_limits(directory, arm, joints);
  fmt::print("{} postures in {}\n", joints.size(), directory.string());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: simulate_postures DIRECTORY\n", stderr);
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
