// make_program_stability DIRECTORY [PASSES MOVES_A_PASS]: a KR 210-like arm measured in ten postures and a five-axis
// program for it: cell.toml, posture_1.uff …, forces.toml, part.ngc and job.toml.
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>

#include "examples/postures/ten_postures.hpp"
#include "examples/program-stability/hollow.hpp"
#include "robomill/io/file.hpp"
#include "robomill/modal/files/frf_files.hpp"

namespace {

using namespace robomill;

void run(const std::filesystem::path& directory, int passes, int moves_a_pass) {
  const modal::testing::SimulatedArm arm(examples::arm_seed);
  const std::vector<Eigen::VectorXd> joints = examples::joints_of_poses(arm);
  std::filesystem::create_directories(directory);
  for (std::size_t p = 0; p < joints.size(); ++p) {
    modal::write_frfs(directory / fmt::format("posture_{}.uff", p + 1), arm.measure(joints[p], p + 1));
  }
  io::write_file(directory / "cell.toml",
                 examples::cell_toml(arm, joints) + "\n[program]\nmachine = \"xyzac-trt\"  # tip positions\n");
  io::write_file(directory / "forces.toml", examples::hollow_forces(passes, moves_a_pass));
  io::write_file(directory / "part.ngc", examples::hollow_program(passes, moves_a_pass));
  io::write_file(directory / "job.toml",
                 "[job]\ntitle = \"Stability of every block\"\nforces = \"forces.toml\"\ncell = \"cell.toml\"\n"
                 "program = \"part.ngc\"\n\n[decide]\nfree = []  # the program is judged as it is\n");
  fmt::print("{} postures and {} passes in {}\n", joints.size(), passes, directory.string());
}

}  // namespace

int main(int argc, char** argv) {
  const int passes = argc == 4 ? std::atoi(argv[2]) : 12;
  const int moves_a_pass = argc == 4 ? std::atoi(argv[3]) : 24;
  if ((argc != 2 && argc != 4) || passes < 2 || moves_a_pass < 1) {
    std::fputs("usage: make_program_stability DIRECTORY [PASSES MOVES_A_PASS]\n", stderr);
    return 2;
  }
  try {
    run(argv[1], passes, moves_a_pass);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
