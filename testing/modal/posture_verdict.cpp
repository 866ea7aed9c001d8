#include "testing/modal/posture_verdict.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/modal/tip.hpp"
#include "robomill/robot/stiffness.hpp"
#include "robomill/simulation/posture.hpp"

namespace robomill::modal::testing {
namespace {

using std::numbers::pi;

/// Table 4-5 of [RobotMillingChatter]: four depths at each speed, here as shares of their mean, which stands for the
/// limit that they lie around. Up-milling, 12 mm, 1.8 mm radial, 0.01 mm a tooth; two teeth fit its results best.
struct PublishedSpeed {
  double spindle_speed_rpm;
  std::array<double, 4> depth_mm;
};
constexpr std::array<PublishedSpeed, 8> published_cuts{{{5000.0, {0.5, 0.7, 0.9, 1.0}},
                                                        {5500.0, {0.8, 1.0, 1.2, 1.4}},
                                                        {6500.0, {0.4, 0.6, 0.8, 1.0}},
                                                        {8000.0, {0.8, 1.0, 1.2, 1.5}},
                                                        {9500.0, {0.5, 0.7, 0.9, 1.0}},
                                                        {11000.0, {0.4, 0.6, 0.8, 0.9}},
                                                        {12500.0, {0.5, 0.7, 0.9, 1.0}},
                                                        {15000.0, {0.9, 1.1, 1.3, 1.5}}}};

/// A cut whose depth is still a share of a limit that nobody knows.
struct Drawn {
  stability::SpatialMilling milling;
  double spindle_speed_rpm = 0.0, share_of_limit = 0.0, deepest_m = 0.0;
};

Drawn published(Random& random) {
  Drawn out;
  out.milling.cutter.mill = {.teeth = 2, .diameter_m = 0.012};
  out.milling.cut.radial_depth_m = 1.8e-3;
  out.milling.cut.direction = cutting::MillingDirection::up;
  out.milling.coefficients = {.tangential_n_per_m2 = {712e6}, .radial_n_per_m2 = {287e6}};
  out.milling.feed_per_tooth_m = 1e-5;
  const PublishedSpeed& row = published_cuts[random.index(8)];
  const double mean_mm = (row.depth_mm[0] + row.depth_mm[1] + row.depth_mm[2] + row.depth_mm[3]) / 4.0;
  out.spindle_speed_rpm = row.spindle_speed_rpm;
  out.share_of_limit = row.depth_mm[random.index(4)] / mean_mm;
  out.deepest_m = 0.006;
  return out;
}

Drawn random_cut(bool ball, Random& random) {
  Drawn out;
  cutting::FlatEndMill& mill = out.milling.cutter.mill;
  mill.teeth = 2 + static_cast<int>(random.index(3));
  mill.diameter_m = ball ? random.uniform(0.006, 0.012) : random.uniform(0.008, 0.016);
  mill.helix_rad = random.uniform(0.0, 40.0) * units::deg;
  cutting::Cut& cut = out.milling.cut;
  cut.direction = static_cast<cutting::MillingDirection>(random.index(3));
  cut.radial_depth_m = mill.diameter_m * (ball ? random.uniform(0.05, 0.3) : random.uniform(0.05, 0.6));
  if (ball) {
    out.milling.cutter.kind = cutting::CutterKind::ball_end;
    cut.lead_rad = random.uniform(-25.0, 25.0) * units::deg;
    cut.tilt_rad = random.uniform(-25.0, 25.0) * units::deg;
  }
  const double tangential = random.uniform(6e8, 1.2e9);
  out.milling.coefficients = {.tangential_n_per_m2 = {tangential},
                              .radial_n_per_m2 = {tangential * random.uniform(0.25, 0.5)},
                              .axial_n_per_m2 = {tangential * random.uniform(0.05, 0.25)}};
  out.milling.feed_per_tooth_m = random.uniform(2e-5, 1e-4);
  out.spindle_speed_rpm = random.uniform(3000.0, 15000.0);
  out.share_of_limit = random.uniform(0.0, 2.0);
  out.deepest_m = (ball ? 0.25 : 0.5) * mill.diameter_m;
  return out;
}

/// Of the feed's frame with the tool leant in it: the feed in a random direction across the tool, which points down.
Eigen::Matrix3d feed_from_base(const SimulatedArm& arm, const Eigen::VectorXd& joints, const cutting::Cut& cut,
                               Random& random) {
  const Eigen::Matrix3d spindle = robot::forward(arm.exact().arm, joints).linear();
  const Eigen::Matrix3d upright = Eigen::AngleAxisd(pi, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const Eigen::Matrix3d feed =
      Eigen::AngleAxisd(random.uniform(0.0, 2.0 * pi), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return cutting::feed_from_tool(cut.lead_rad, cut.tilt_rad) * (spindle * upright * feed).transpose();
}

/// Nothing where there is no limit down to the deepest depth, or where the cut reaches the shank.
std::optional<JudgedCut> placed(const Drawn& drawn, const SimulatedArm& arm, const Eigen::VectorXd& joints,
                                const ModalModel& truth, Random& random) {
  JudgedCut out;
  out.cut.spatial = drawn.milling;
  cutting::Cut& cut = out.cut.spatial->cut;
  out.spindle_speed_rad_per_s = drawn.spindle_speed_rpm * units::rpm;
  out.feed_from_base = feed_from_base(arm, joints, cut, random);
  try {
    cut.axial_depth_m = 2.0 * drawn.deepest_m;
    static_cast<void>(cutting::engage(drawn.milling.cutter, cut));
    stability::LobesProblem problem = out.cut;
    problem.dynamics = turned(truth, out.feed_from_base);
    stability::LobesOptions options;
    options.axial_depth_m = {0.0, drawn.deepest_m};
    options.grid = {2, 60};
    options.tolerance = 1e-4;
    const stability::Limit limit = stability::limit_depths(problem, options, {out.spindle_speed_rad_per_s}).front();
    if (limit.status != stability::Limit::Status::found) return std::nullopt;
    out.limit_m = limit.axial_depth_m;
  } catch (const InvalidInput&) {
    return std::nullopt;
  }
  out.axial_depth_m = drawn.share_of_limit * out.limit_m;
  cut.axial_depth_m = out.axial_depth_m;
  return out;
}

/// The cut with loss of contact, from rest: for a second, and longer until what its motion does agrees with the growth
/// of a small vibration or, where that is not known, changes clearly.
bool simulated_chatter(const JudgedCut& judged, const ModalModel& truth) {
  const stability::SpatialMilling& milling = *judged.cut.spatial;
  const cutting::FlatEndMill& mill = milling.cutter.mill;
  const double lag = mill.lag_rad_per_m(0) * judged.axial_depth_m;
  cutting::EngagementOptions rings{.slices = 1 + static_cast<int>(std::ceil(lag / (3.0 * units::deg)))};
  if (milling.cutter.kind == cutting::CutterKind::ball_end) rings = {.rings_per_stretch = 6};
  simulation::PostureCut cut;
  cut.cutter = milling.cutter;
  cut.engagement = cutting::engage(milling.cutter, milling.cut, rings);
  cut.coefficients = milling.coefficients;
  cut.motion = {.feed_per_tooth_m = milling.feed_per_tooth_m,
                .spindle_speed_rad_per_s = judged.spindle_speed_rad_per_s};
  cut.structure = tip_modes(turned(truth, judged.feed_from_base), {}, 0.0);
  bool chatters = false;
  for (const double seconds : {1.0, 4.0, 16.0}) {
    const simulation::Simulation run =
        simulation::simulate(cut, {.seconds = seconds, .sample_rate_hz = 2048.0, .tolerance = 1e-2});
    chatters = run.verdict == simulation::Verdict::undecided ? run.growth_per_period >= 1.0
                                                             : run.verdict == simulation::Verdict::chatter;
    const double change = std::pow(run.growth_per_period, 0.25 * seconds / run.period_s);
    const bool known = run.small.status == simulation::SmallVibration::Status::found;
    if (known ? chatters == (run.small.spectral_radius >= 1.0) : change < 0.7 || change > 1.4) break;
  }
  return chatters;
}

JudgedCut draw(const SimulatedArm& arm, const Eigen::VectorXd& joints, CutFamily family, const ModalModel& truth,
               Random& random) {
  constexpr int most_draws = 1000;
  for (int k = 0; k < most_draws; ++k) {
    const Drawn drawn =
        family == CutFamily::published ? published(random) : random_cut(family == CutFamily::ball_end, random);
    if (std::optional<JudgedCut> out = placed(drawn, arm, joints, truth, random)) {
      out->family = family;
      out->chatters = simulated_chatter(*out, truth);
      return *out;
    }
  }
  throw std::runtime_error("no cut of a family has a limit");
}

}  // namespace

VerdictCounts& VerdictCounts::operator+=(const VerdictCounts& other) {
  right += other.right;
  wrongly_stable += other.wrongly_stable;
  wrongly_unstable += other.wrongly_unstable;
  return *this;
}

VerdictCounts VerdictScore::all() const {
  VerdictCounts out;
  for (const VerdictCounts& of_family : family) out += of_family;
  return out;
}

VerdictScore& VerdictScore::operator+=(const VerdictScore& other) {
  for (std::size_t k = 0; k < family.size(); ++k) family[k] += other.family[k];
  near += other.near;
  return *this;
}

PostureVerdicts::PostureVerdicts(const SimulatedArm& arm, const PostureVerdictOptions& options) : arm_(&arm) {
  constexpr std::array families{CutFamily::published, CutFamily::flat_end, CutFamily::published, CutFamily::ball_end};
  std::vector<ModalModel> truth;
  for (std::size_t p = 0; p < options.postures; ++p) {
    truth.push_back(arm.modes(arm.held_out_postures().at(p), options.up_to_hz));
  }
  const auto each = static_cast<std::size_t>(options.cuts);
  cuts_.resize(each * options.postures);
  parallel_for(cuts_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Random random(options.seed, i);
      const std::size_t p = i / each;
      cuts_[i] = draw(arm, arm.held_out_postures()[p], families[i % families.size()], truth[p], random);
      cuts_[i].posture = p;
    }
  });
}

VerdictScore PostureVerdicts::judge(const PosturePredictor& predict) const {
  std::vector<ModalModel> predicted;
  for (std::size_t p = 0; p <= cuts_.back().posture; ++p) predicted.push_back(predict(arm_->held_out_postures()[p]));
  std::vector<char> stable(cuts_.size());
  parallel_for(cuts_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      stability::LobesProblem problem = cuts_[i].cut;
      const ModalModel& modes = predicted[cuts_[i].posture];
      stable[i] = 1;
      if (modes.modes.empty()) continue;
      problem.dynamics = turned(modes, cuts_[i].feed_from_base);
      const stability::PointResult point = stability::evaluate_point(
          problem, {.tolerance = 1e-4}, {cuts_[i].spindle_speed_rad_per_s, cuts_[i].axial_depth_m});
      stable[i] = point.stable ? 1 : 0;
    }
  });
  VerdictScore out;
  for (std::size_t i = 0; i < cuts_.size(); ++i) {
    const bool said = stable[i] != 0, is = !cuts_[i].chatters;
    const VerdictCounts one{.right = said == is, .wrongly_stable = said && !is, .wrongly_unstable = !said && is};
    out.family[static_cast<std::size_t>(cuts_[i].family)] += one;
    if (std::abs(cuts_[i].axial_depth_m / cuts_[i].limit_m - 1.0) < 0.1) out.near += one;
  }
  return out;
}

}  // namespace robomill::modal::testing
