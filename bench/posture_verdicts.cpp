// Whether cuts at postures that nobody measured are told stable or not as they turn out: posture_verdicts [arms] [first
// seed] [cuts a posture] [--band]. Twelve postures of each simulated arm are measured up to 700 Hz (5 % noise). In its
// eight held-out ones random cuts are simulated in time with all modes of the arm, and told by |μ| with others: the
// same (what the method loses), those up to 700 Hz (what the band loses), the model's, and those of two
// inverse-distance weightings of the modes that fit_modes finds in the same FRFs. --band leaves the simulation the
// modes up to 700 Hz too.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <exception>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robomill/base/parallel.hpp"
#include "robomill/modal/posture/inverse_distance.hpp"
#include "robomill/modal/posture_model.hpp"
#include "testing/modal/measured_arm.hpp"
#include "testing/modal/posture_verdict.hpp"

namespace {

using namespace robomill;
using modal::ModalModel;
using modal::testing::SimulatedArm;
using modal::testing::VerdictCounts;
using modal::testing::VerdictScore;

struct Settings {
  std::size_t arms = 24;
  std::uint64_t first = 0;
  modal::testing::PostureVerdictOptions verdicts = {};
};

constexpr double band_hz = 700.0;

enum Predictor : std::size_t { truth, in_band, model, base_axes, flange_axes, predictors };
constexpr std::array<const char*, predictors> names{"true modes", "true modes up to 700 Hz", "model",
                                                    "inverse distance, base axes", "inverse distance, flange axes"};
struct ArmResult {
  std::array<VerdictScore, predictors> score = {};
  int chattering = 0;
  std::string error = {};
};

void judge(const SimulatedArm& arm, std::uint64_t seed, const Settings& settings, ArmResult& out) {
  modal::testing::PostureVerdictOptions options = settings.verdicts;
  options.seed = seed;
  const modal::testing::PostureVerdicts verdicts(arm, options);
  out.chattering = static_cast<int>(
      std::count_if(verdicts.cuts().begin(), verdicts.cuts().end(), [](const auto& cut) { return cut.chatters; }));
  out.score[truth] = verdicts.judge([&](const Eigen::VectorXd& joints) { return arm.modes(joints, options.up_to_hz); });
  out.score[in_band] = verdicts.judge([&](const Eigen::VectorXd& joints) { return arm.modes(joints, band_hz); });
  const std::vector<modal::MeasuredPosture> measured = modal::testing::measure_postures(arm, seed);
  const std::vector<modal::PostureModes> known = modal::testing::fit_postures(measured);
  for (const auto& [predictor, axes] :
       {std::pair{base_axes, modal::ResidueAxes::base}, std::pair{flange_axes, modal::ResidueAxes::flange}}) {
    out.score[predictor] = verdicts.judge(
        [&, at = axes](const Eigen::VectorXd& joints) { return inverse_distance(known, arm.told().arm, joints, at); });
  }
  const modal::PostureModel calibrated(arm.told(), {}, measured);
  out.score[model] = verdicts.judge([&](const Eigen::VectorXd& joints) { return calibrated.at(joints).modes; });
}

std::string share(const VerdictCounts& counts) {
  return counts.all() > 0 ? fmt::format("{:.1f}", 100.0 * counts.right / counts.all()) : "-";
}

/// Of the better weighting; in doubt the first.
const VerdictScore& better(const ArmResult& arm) {
  return arm.score[flange_axes].all().right > arm.score[base_axes].all().right ? arm.score[flange_axes]
                                                                               : arm.score[base_axes];
}

void print_total(const char* name, const VerdictScore& score) {
  const VerdictCounts all = score.all();
  fmt::print("| {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", name, all.all(), share(all), all.wrongly_stable,
             all.wrongly_unstable, share(score.family[0]), share(score.family[1]), share(score.family[2]),
             share(score.near));
}

void print(const std::vector<ArmResult>& results, const Settings& settings) {
  std::array<VerdictScore, predictors> total;
  VerdictScore total_better;
  fmt::print("| arm | chatter | true modes, right, % | model | wrongly stable, unstable | better inverse distance |\n");
  fmt::print("|---|---|---|---|---|---|\n");
  for (std::size_t k = 0; k < results.size(); ++k) {
    const ArmResult& arm = results[k];
    const std::uint64_t seed = settings.first + k;
    if (!arm.error.empty()) {
      fmt::print("| {} | failed: {} |\n", seed, arm.error);
      continue;
    }
    const VerdictCounts of_model = arm.score[model].all();
    fmt::print("| {} {} | {} of {} | {} | {} | {}, {} | {} |\n", seed, SimulatedArm(seed).is_heavy() ? "KR" : "UR",
               arm.chattering, of_model.all(), share(arm.score[truth].all()), share(of_model), of_model.wrongly_stable,
               of_model.wrongly_unstable, share(better(arm).all()));
    for (std::size_t p = 0; p < predictors; ++p) total[p] += arm.score[p];
    total_better += better(arm);
  }
  fmt::print("\n| modes | cuts | right, % | wrongly stable | wrongly unstable |");
  for (const char* family : modal::testing::cut_family_names) fmt::print(" {}, right, % |", family);
  fmt::print(" within 10 % of the limit, right, % |\n|---|---|---|---|---|---|---|---|---|\n");
  for (std::size_t p = 0; p < predictors; ++p) print_total(names[p], total[p]);
  print_total("inverse distance, each arm's better axes", total_better);
}

Settings read(int argc, char** argv) {
  Settings out;
  int numbers = 0;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--band") {
      out.verdicts.up_to_hz = band_hz;
      continue;
    }
    const std::uint64_t number = std::strtoull(argv[i], nullptr, 10);
    if (numbers == 0) out.arms = number;
    if (numbers == 1) out.first = number;
    if (numbers == 2) out.verdicts.cuts = static_cast<int>(number);
    ++numbers;
  }
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  const Settings settings = read(argc, argv);
  std::vector<ArmResult> results(settings.arms);
  parallel_for(settings.arms, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const SimulatedArm arm(settings.first + k);
      try {
        judge(arm, settings.first + k, settings, results[k]);
      } catch (const std::exception& error) {
        results[k].error = error.what();
      }
      fmt::print(stderr, "{}: {} % right\n", settings.first + k, share(results[k].score[model].all()));
    }
  });
  print(results, settings);
  return 0;
}
