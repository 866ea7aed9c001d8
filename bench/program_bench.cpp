// A whole job as `robomill plan` runs it: the hollow of examples/program-stability at its size and at ten times as many
// blocks. Calibration of the arm is a part of the job that does not grow with the program, so that what a block costs
// is that of engagement, forces and stability.
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "examples/postures/ten_postures.hpp"
#include "examples/program-stability/hollow.hpp"
#include "robomill/jobs/plan.hpp"
#include "robomill/modal/files/frf_files.hpp"

namespace robomill {
namespace {

class HollowJob {
 public:
  HollowJob(int passes, int moves_a_pass)
      : folder_(std::filesystem::temp_directory_path() /
                fmt::format("robomill_bench_{}_{}_{}", ::getpid(), passes, moves_a_pass)) {
    std::filesystem::create_directories(folder_);
    const modal::testing::SimulatedArm arm(examples::arm_seed);
    const std::vector<Eigen::VectorXd> joints = examples::joints_of_poses(arm);
    for (std::size_t p = 0; p < joints.size(); ++p) {
      modal::write_frfs(folder_ / fmt::format("posture_{}.uff", p + 1), arm.measure(joints[p], p + 1));
    }
    write("cell.toml", examples::cell_toml(arm, joints) + "\n[program]\nmachine = \"xyzac-trt\"\n");
    write("forces.toml", examples::hollow_forces(passes, moves_a_pass));
    write("part.ngc", examples::hollow_program(passes, moves_a_pass));
    write("job.toml",
          "[job]\nforces = \"forces.toml\"\ncell = \"cell.toml\"\nprogram = \"part.ngc\"\n[decide]\nfree = []\n");
  }
  HollowJob(const HollowJob&) = delete;
  HollowJob& operator=(const HollowJob&) = delete;
  ~HollowJob() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  [[nodiscard]] std::filesystem::path job() const { return folder_ / "job.toml"; }

 private:
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }

  std::filesystem::path folder_;
};

double smaller_seconds = 0.0;  // of engagement, forces and stability of the program at its own size

/// Passes and moves a pass.
void whole_program(benchmark::State& state) {
  const HollowJob hollow(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  double seconds = 0.0;
  for (auto _ : state) {
    const jobs::PlanResult result = jobs::run_job(hollow.job(), 1);
    if (!result.shown().blocks || !result.shown().forces || !result.shown().forces->program) {
      state.SkipWithError("no blocks were judged");
      return;
    }
    const double blocks = static_cast<double>(result.shown().blocks->rows.size());
    seconds = result.shown().blocks->seconds + result.shown().forces->program->seconds;
    state.counters["blocks"] = blocks;
    state.counters["evaluations"] = static_cast<double>(result.shown().blocks->evaluations);
    state.counters["forces_s"] = result.shown().forces->program->seconds;
    state.counters["stability_s"] = result.shown().blocks->seconds;
    state.counters["ms_a_block"] = 1e3 * seconds / blocks;
  }
  if (smaller_seconds > 0.0) {
    state.counters["times_the_smaller"] = seconds / smaller_seconds;
  } else {
    smaller_seconds = seconds;
  }
}

// 300 blocks and ten times as many. The size of the figures in robomill/process/README.md is 40 x 100.
BENCHMARK(whole_program)
    ->Args({12, 24})
    ->Args({30, 99})
    ->Iterations(1)
    ->Unit(benchmark::kSecond)
    ->UseRealTime()
    ->MeasureProcessCPUTime();

}  // namespace
}  // namespace robomill
