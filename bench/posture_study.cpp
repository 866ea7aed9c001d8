// What predictions of modes over postures are worth on simulated arms: posture_study [arms] [first seed] [--quick]
// [--exact] [--cheat]. Twelve postures of each arm are measured (5 % noise), eight are held out and judged. Beside the
// model stand two inverse-distance weightings, in base and in flange axes, of the modes that fit_modes finds in the
// same FRFs; with --exact of the true modes. --quick leaves out the bands of limits. --cheat judges the truth with
// errors of 0.5 % in place of the model.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/parallel.hpp"
#include "robomill/base/random.hpp"
#include "robomill/modal/posture/inverse_distance.hpp"
#include "robomill/modal/posture_model.hpp"
#include "testing/modal/measured_arm.hpp"
#include "testing/modal/posture_judge.hpp"

namespace {

using namespace robomill;
using modal::ModalModel;
using modal::testing::PostureScore;
using modal::testing::quantile;
using modal::testing::SimulatedArm;

struct Settings {
  std::size_t arms = 24;
  std::uint64_t first = 0;
  bool quick = false, exact = false, cheat = false;
};

/// The model and the two weightings.
struct ArmResult {
  std::array<PostureScore, 3> score = {};
  std::string structure = {}, error = {};
};
constexpr std::array<const char*, 3> names{"model", "inverse distance, base axes", "inverse distance, flange axes"};

double median_limit(const PostureScore& score) {
  return quantile(score.limit_error, 0.5);
}
/// Of the model's median limit error to that of the better weighting.
double ratio(const ArmResult& arm) {
  const double better = std::min(median_limit(arm.score[1]), median_limit(arm.score[2]));
  return better > 0.0 ? median_limit(arm.score[0]) / better : 0.0;
}

modal::testing::PosturePredictor cheat(const SimulatedArm& arm, std::uint64_t seed) {
  return [&arm, random = Random(seed, 5)](const Eigen::VectorXd& joints) mutable {
    ModalModel out = arm.modes(joints);
    for (modal::Mode& mode : out.modes) {
      mode.frequency_std_hz = 0.005 * mode.frequency_hz;
      mode.damping_ratio_std = 0.02 * mode.damping_ratio;
      mode.residue_std_ratio = 0.02;
      mode.frequency_hz *= 1.0 + 0.005 * random.normal();
      mode.damping_ratio *= 1.0 + 0.02 * random.normal();
      mode.right *= 1.0 + 0.02 * random.normal();
    }
    return out;
  };
}

/// What the weightings know.
std::vector<modal::PostureModes> modes_of(const SimulatedArm& arm, const std::vector<modal::MeasuredPosture>& measured,
                                          bool exact) {
  if (!exact) return modal::testing::fit_postures(measured);
  std::vector<modal::PostureModes> out;
  for (const Eigen::VectorXd& joints : arm.measured_postures()) {
    out.push_back({.joints = joints, .modes = arm.modes(joints)});
  }
  return out;
}

void judge_model(const SimulatedArm& arm, const std::vector<modal::MeasuredPosture>& measured,
                 const modal::testing::PostureJudge& judge, ArmResult& out) {
  const modal::PostureModel model(arm.told(), {}, measured);
  const modal::PostureReport& report = model.report();
  out.structure = fmt::format("{}{}{} tool pairs, left out {:.1f} %", report.bearings ? "bearings, " : "",
                              report.bracket ? "bracket, " : "", report.tool_modes, 100.0 * report.left_out_error);
  out.score[0] = judge.judge([&](const Eigen::VectorXd& joints) { return model.at(joints).modes; });
}

ArmResult study(std::uint64_t seed, const Settings& settings) {
  const SimulatedArm arm(seed);
  const modal::testing::PostureJudge judge(arm, {.bands = !settings.quick});
  ArmResult out;
  const std::vector<modal::MeasuredPosture> measured = modal::testing::measure_postures(arm, seed);
  const std::vector<modal::PostureModes> known = modes_of(arm, measured, settings.exact);
  constexpr std::array axes{modal::ResidueAxes::base, modal::ResidueAxes::flange};
  for (std::size_t k = 0; k < axes.size(); ++k) {
    out.score[k + 1] = judge.judge(
        [&](const Eigen::VectorXd& joints) { return modal::inverse_distance(known, arm.told().arm, joints, axes[k]); });
  }
  try {
    if (settings.cheat) {
      out.score[0] = judge.judge(cheat(arm, seed));
    } else {
      judge_model(arm, measured, judge, out);
    }
  } catch (const std::exception& error) {
    out.error = error.what();
  }
  return out;
}

std::string share(int part, int all) {
  return all > 0 ? fmt::format("{:.1f}", 100.0 * part / all) : "-";
}

void print_row(const std::string& name, const PostureScore& s, const std::string& end) {
  fmt::print("| {} | {:.2f} / {:.1f} | {} | {:.1f} / {:.0f} | {} | {:.1f} / {:.0f} | {} | {} | {} |\n", name,
             100.0 * quantile(s.frequency_error, 0.5), 100.0 * quantile(s.frequency_error, 0.95), s.missed,
             100.0 * quantile(s.residue_error, 0.5), 100.0 * quantile(s.residue_error, 0.95),
             share(s.frequencies_in_band, s.banded), 100.0 * median_limit(s), 100.0 * quantile(s.limit_error, 0.95),
             share(s.too_deep, static_cast<int>(s.limit_error.size())), share(s.limits_in_band, s.banded_limits), end);
}

void add(const PostureScore& one, PostureScore& all) {
  const auto append = [](const std::vector<double>& from, std::vector<double>& to) {
    to.insert(to.end(), from.begin(), from.end());
  };
  append(one.frequency_error, all.frequency_error);
  append(one.residue_error, all.residue_error);
  append(one.limit_error, all.limit_error);
  all.missed += one.missed;
  all.frequencies_in_band += one.frequencies_in_band;
  all.banded += one.banded;
  all.too_deep += one.too_deep;
  all.limits_in_band += one.limits_in_band;
  all.banded_limits += one.banded_limits;
}

std::string name_of(std::uint64_t seed) {
  const SimulatedArm arm(seed);
  return fmt::format("{} {}{}{}", seed, arm.is_heavy() ? "KR" : "UR",
                     arm.bracket_axes() > 0 ? fmt::format(", bracket {}", arm.bracket_axes()) : "",
                     arm.is_spindle_across() ? ", across" : "");
}

void print(const std::vector<ArmResult>& results, const Settings& settings) {
  fmt::print(
      "| arm | frequency error, %: median / 95 % | missed | residue error, %: median / 95 % | frequencies in 95 % band "
      "| limit error, %: median / 95 % | limits > 10 % too deep, % | limits in 5-95 % band | ratio, structure |\n"
      "|---|---|---|---|---|---|---|---|---|\n");
  std::array<PostureScore, 3> all;
  std::vector<double> ratios;
  for (std::size_t k = 0; k < results.size(); ++k) {
    const ArmResult& result = results[k];
    const std::string name = name_of(settings.first + k);
    if (!result.error.empty()) {
      fmt::print("| {} | failed: {} |\n", name, result.error);
    } else {
      print_row(name, result.score[0], fmt::format("{:.2f}, {}", ratio(result), result.structure));
      ratios.push_back(ratio(result));
      add(result.score[0], all[0]);
    }
    for (std::size_t s = 1; s < 3; ++s) add(result.score[s], all[s]);
  }
  for (std::size_t s = 0; s < 3; ++s) {
    const auto below = std::count_if(ratios.begin(), ratios.end(), [](double r) { return r <= 0.7; });
    print_row(fmt::format("all: {}", names[s]), all[s],
              s > 0 ? ""
                    : fmt::format("median {:.2f}, {} arms <= 0.7", quantile(ratios, 0.5),
                                  share(static_cast<int>(below), static_cast<int>(ratios.size())) + " % of"));
  }
  fmt::print("| goal | 0.5 / 3 |  | 8 | 93 to 97 | | 5 | 85 to 95 | median 0.5, 80 % of arms <= 0.7 |\n");
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  int numbers = 0;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--quick") {
      settings.quick = true;
    } else if (word == "--exact") {
      settings.exact = true;
    } else if (word == "--cheat") {
      settings.cheat = true;
    } else if (numbers++ == 0) {
      settings.arms = static_cast<std::size_t>(std::strtoull(argv[i], nullptr, 10));
    } else {
      settings.first = std::strtoull(argv[i], nullptr, 10);
    }
  }
  std::vector<ArmResult> results(settings.arms);
  parallel_for(settings.arms, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      results[k] = study(settings.first + k, settings);
      const PostureScore& model = results[k].score[0];
      fmt::print(stderr, "{}: limits {:.1f} %, ratio {:.2f}\n", name_of(settings.first + k),
                 100.0 * median_limit(model), ratio(results[k]));
    }
  });
  print(results, settings);
  return 0;
}
