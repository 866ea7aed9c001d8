#include "examples/labelled-cuts/labelled_cuts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/modal/fit.hpp"
#include "robomill/modal/frf.hpp"
#include "robomill/stability/lobes.hpp"

namespace robomill::examples {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double deepest_m = 0.012;
constexpr std::array<double, 2> speeds_rpm = {4000.0, 12000.0};
constexpr double lapse = 0.04, slope = 12.0;

double probability(double axial_depth_m, double limit_m) {
  return lapse + (1.0 - 2.0 * lapse) / (1.0 + std::pow(limit_m / axial_depth_m, slope));
}

std::vector<double> speeds_of(const std::vector<LabelledCut>& cuts) {
  std::vector<double> out;
  for (const LabelledCut& cut : cuts) {
    if (out.empty() || out.back() != cut.spindle_speed_rad_per_s) out.push_back(cut.spindle_speed_rad_per_s);
  }
  return out;
}

double log_likelihood(const std::vector<LabelledCut>& cuts, const std::vector<double>& speeds, const ToolModes& modes) {
  const std::vector<double> limit_m = limits(modes.model(), {}, speeds);
  double sum = 0.0;
  std::size_t speed = 0;
  for (const LabelledCut& cut : cuts) {
    if (cut.spindle_speed_rad_per_s != speeds[speed]) ++speed;
    const double p = probability(cut.axial_depth_m, limit_m[speed]);
    for (const bool chatter : cut.chatter) sum += std::log(chatter ? p : 1.0 - p);
  }
  return sum;
}

/// Six shares of the logarithmic ranges, as modes.
using Shares = std::array<double, 6>;
ToolModes modes_at(const Shares& shares) {
  const auto between = [&](std::size_t at, double low, double high) {
    return low * std::pow(high / low, shares.at(at));
  };
  return {.frequency_hz = {between(0, 150.0, 1000.0), between(1, 150.0, 1000.0)},
          .damping_ratio = {between(2, 0.01, 0.1), between(3, 0.01, 0.1)},
          .stiffness_n_per_m = {between(4, 3e5, 6e7), between(5, 3e5, 6e7)}};
}

}  // namespace

modal::ModalModel ToolModes::model() const {
  modal::ModalModel out;
  out.excitations = out.responses = {{.axis = modal::Axis::x}, {.axis = modal::Axis::y}};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double omega = 2.0 * pi * frequency_hz.at(axis);
    const double damped = omega * std::sqrt(1.0 - damping_ratio.at(axis) * damping_ratio.at(axis));
    // R L = 1 / (2 i m ω_d), m = k / ω².
    const std::complex<double> residue =
        1.0 / (std::complex<double>(0.0, 2.0) * (stiffness_n_per_m.at(axis) / (omega * omega)) * damped);
    modal::Mode mode;
    mode.frequency_hz = frequency_hz.at(axis);
    mode.damping_ratio = damping_ratio.at(axis);
    mode.left = mode.right = Eigen::VectorXcd::Zero(2);
    mode.left(static_cast<Eigen::Index>(axis)) = mode.right(static_cast<Eigen::Index>(axis)) = std::sqrt(residue);
    out.modes.push_back(std::move(mode));
  }
  return out;
}

std::vector<double> limits(const modal::ModalModel& modes, const CutKind& kind,
                           const std::vector<double>& spindle_speed_rad_per_s) {
  stability::LobesProblem problem;
  problem.milling.tool = {.teeth = 3, .diameter_m = 0.016};
  problem.milling.immersion = cutting::immersion(kind.direction, kind.radial_depth_m, 0.016);
  problem.milling.coefficients = {.tangential_n_per_m2 = 800e6, .radial_n_per_m2 = 300e6};
  problem.milling.feed_per_tooth_m = 1e-4;
  problem.dynamics = modes;
  stability::LobesOptions options;
  options.spindle_speed_rad_per_s = {speeds_rpm[0] * units::rpm, speeds_rpm[1] * units::rpm};
  options.axial_depth_m = {0.0, deepest_m};
  options.method = stability::Method::zeroth_order;
  std::vector<double> out;
  for (const stability::Limit& limit : stability::limit_depths(problem, options, spindle_speed_rad_per_s)) {
    const bool found = limit.status == stability::Limit::Status::found;
    out.push_back(found ? limit.axial_depth_m : std::numeric_limits<double>::infinity());
  }
  return out;
}

std::vector<LabelledCut> label_cuts(std::uint64_t seed) {
  constexpr int speeds = 12, depths = 10;
  Random random(seed);
  std::vector<LabelledCut> out;
  std::vector<double> all(speeds);
  for (int i = 0; i < speeds; ++i) {
    all[static_cast<std::size_t>(i)] =
        std::lerp(speeds_rpm[0], speeds_rpm[1], static_cast<double>(i) / (speeds - 1)) * units::rpm;
  }
  const std::vector<double> limit_m = limits(true_modes.model(), {}, all);
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (int k = 0; k < depths; ++k) {
      LabelledCut cut{.spindle_speed_rad_per_s = all[i], .axial_depth_m = random.uniform(0.5e-3, 8e-3)};
      for (bool& chatter : cut.chatter) chatter = random.uniform() < probability(cut.axial_depth_m, limit_m[i]);
      out.push_back(cut);
    }
  }
  return out;
}

LabelFit fit_to_labels(const std::vector<LabelledCut>& cuts, std::uint64_t seed) {
  constexpr std::size_t first = 3000, kept = 20, tries = 150;
  constexpr std::array widths = {0.06, 0.04, 0.03, 0.02, 0.015, 0.01, 0.005, 0.003};
  Random random(seed);
  const std::vector<double> speeds = speeds_of(cuts);
  std::vector<std::pair<double, Shares>> found;
  const auto add = [&](const Shares& shares) {
    found.emplace_back(log_likelihood(cuts, speeds, modes_at(shares)), shares);
  };
  for (std::size_t i = 0; i < first; ++i) {
    Shares shares;
    for (double& share : shares) share = random.uniform();
    add(shares);
  }
  const auto sort = [&] { std::ranges::sort(found, std::greater<>(), [](const auto& one) { return one.first; }); };
  for (const double width : widths) {
    sort();
    found.resize(kept);
    for (std::size_t i = 0; i < tries; ++i) {
      Shares shares = found[random.index(kept)].second;
      for (double& share : shares) share = std::clamp(share + width * random.normal(), 0.0, 1.0);
      add(shares);
    }
  }
  sort();
  return {.modes = modes_at(found.front().second),
          .log_likelihood = found.front().first,
          .log_likelihood_of_true = log_likelihood(cuts, speeds, true_modes)};
}

double threshold_of(const std::vector<LabelledCut>& cuts) {
  double best_m = 0.0;
  std::ptrdiff_t most = -1;
  for (double depth_m = 0.0; depth_m <= deepest_m; depth_m += 1e-4) {
    std::ptrdiff_t right = 0;
    for (const LabelledCut& cut : cuts) right += std::ranges::count(cut.chatter, cut.axial_depth_m > depth_m);
    if (right <= most) continue;
    most = right;
    best_m = depth_m;
  }
  return best_m;
}

modal::ModalModel tap_test(std::uint64_t seed) {
  constexpr double noise = 0.05;
  Random random(seed);
  modal::FrfSet set = modal::synthesize(true_modes.model(), Eigen::VectorXd::LinSpaced(951, 50.0, 1000.0));
  for (modal::Frf& frf : set.frfs) {
    const double rms = std::sqrt(frf.receptance.squaredNorm() / static_cast<double>(frf.receptance.size()));
    for (std::complex<double>& value : frf.receptance) {
      value += noise * rms * std::complex<double>(random.normal(), random.normal());
    }
  }
  std::erase_if(set.frfs, [](const modal::Frf& frf) { return frf.name.response != frf.name.excitation; });
  return modal::fit_modes(set, {.band_low_hz = 100.0, .band_high_hz = 800.0}).model;
}

Question ask(const CutKind& kind, std::uint64_t seed) {
  constexpr int asked = 400;
  Random random(seed);
  Question out;
  for (int i = 0; i < asked; ++i) {
    out.spindle_speed_rad_per_s.push_back(random.uniform(speeds_rpm[0], speeds_rpm[1]) * units::rpm);
  }
  const std::vector<double> limit_m = limits(true_modes.model(), kind, out.spindle_speed_rad_per_s);
  for (const double one_m : limit_m) {
    const double factor = std::exp2(random.uniform(-1.0, 1.0));
    out.axial_depth_m.push_back(factor * std::min(one_m, deepest_m));
    out.chatter.push_back(out.axial_depth_m.back() > one_m);
  }
  return out;
}

double answered(const Question& question, const CutKind& kind, const modal::ModalModel& modes) {
  const std::vector<double> limit_m = limits(modes, kind, question.spindle_speed_rad_per_s);
  int right = 0;
  for (std::size_t i = 0; i < limit_m.size(); ++i) {
    right += (question.axial_depth_m[i] > limit_m[i]) == question.chatter[i] ? 1 : 0;
  }
  return static_cast<double>(right) / static_cast<double>(limit_m.size());
}

double answered(const Question& question, double threshold_m) {
  int right = 0;
  for (std::size_t i = 0; i < question.chatter.size(); ++i) {
    right += (question.axial_depth_m[i] > threshold_m) == question.chatter[i] ? 1 : 0;
  }
  return static_cast<double>(right) / static_cast<double>(question.chatter.size());
}

}  // namespace robomill::examples
