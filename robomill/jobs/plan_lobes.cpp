#include "robomill/jobs/plan_lobes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "robomill/base/units.hpp"
#include "robomill/decision/choose.hpp"
#include "robomill/jobs/test_cuts.hpp"

namespace robomill::jobs {
namespace {

constexpr Eigen::Index feed_directions = 36;
constexpr int speeds_a_direction = 40;
/// Depths at which the comparisons beside the main lobes look for the limit, before they refine it.
constexpr int comparison_depths = 30;
constexpr int comparison_speeds = 100;

stability::LobesOptions comparison_options(const PlanResult& result) {
  stability::LobesOptions options = result.cut.options;
  options.grid[1] = std::min(options.grid[1], comparison_depths);
  return options;
}

/// The limit of each pair of neighbouring modes alone.
void pairs(PlanResult& result, Progress& progress) {
  const int modes = static_cast<int>(result.model.modes.size());
  if (modes < 3 || !result.cut.problem.keep_modes.empty()) return;
  const stability::LobesOptions options = comparison_options(result);
  const Eigen::Index count = std::min<Eigen::Index>(options.grid[0], comparison_speeds);
  const Eigen::VectorXd axis =
      Eigen::VectorXd::LinSpaced(count, options.spindle_speed_rad_per_s[0], options.spindle_speed_rad_per_s[1]);
  const std::vector<double> speeds(axis.begin(), axis.end());
  for (int k = 1; k <= modes; k += 2) {
    stability::LobesProblem problem = result.cut.problem;
    problem.keep_modes = k < modes ? std::vector<int>{k, k + 1} : std::vector<int>{k};
    const std::vector<stability::Limit> limits = stability::limit_depths(problem, options, speeds, progress);
    PartLimits part;
    part.label = k < modes ? fmt::format("modes {}–{}", k, k + 1) : fmt::format("mode {}", k);
    if (!problem.workpiece_dynamics.modes.empty()) part.label += " and the workpiece's";
    part.modes = problem.keep_modes;
    part.spindle_speed_rad_per_s = axis;
    part.limit_depth_m.resize(static_cast<Eigen::Index>(limits.size()));
    for (std::size_t i = 0; i < limits.size(); ++i) {
      const bool found = limits[i].status == stability::Limit::Status::found;
      part.limit_depth_m(static_cast<Eigen::Index>(i)) =
          found ? limits[i].axial_depth_m : std::numeric_limits<double>::quiet_NaN();
    }
    result.pairs.push_back(std::move(part));
  }
}

/// A mode that a multiple of tooth passing excites within its half-power width.
struct Resonance {
  modal::ModeId mode = {};
  double frequency_hz = 0.0;
  double harmonic = 0.0;
  double distance = 1.0;  ///< in half-power half-widths ζ f
};

Resonance nearest_resonance(const PlanResult& result, double tooth_passing_hz) {
  Resonance nearest;
  const auto look = [&](const modal::ModalModel& model, modal::ModeOwner owner) {
    int number = 0;
    for (const modal::Mode& mode : model.modes) {
      ++number;
      const double harmonic = std::max(1.0, std::round(mode.frequency_hz / tooth_passing_hz));
      const double distance =
          std::abs(harmonic * tooth_passing_hz - mode.frequency_hz) / (mode.damping_ratio * mode.frequency_hz);
      if (distance < nearest.distance) nearest = {{number, owner}, mode.frequency_hz, harmonic, distance};
    }
  };
  look(result.model, modal::ModeOwner::tool);
  look(result.cut.problem.workpiece_dynamics, modal::ModeOwner::workpiece);
  return nearest;
}

/// The deepest pockets of the lobes stand where tooth passing meets a mode: no chatter there, but forced vibration.
void report_resonance(PlanResult& result) {
  if (!result.recommendation.recommended) return;
  const decision::Operation& op = *result.recommendation.recommended;
  const double tooth_passing_hz =
      op.spindle_speed_rad_per_s / (2.0 * std::numbers::pi) * result.cut.problem.milling.tool.teeth;
  const Resonance nearest = nearest_resonance(result, tooth_passing_hz);
  if (!nearest.mode.known()) return;
  std::string text = fmt::format(
      "At the recommended speed {:.0f} × tooth passing ({:.1f} Hz) excites {} ({:.1f} Hz): no chatter, but forced "
      "vibration is greatest there.",
      nearest.harmonic, nearest.harmonic * tooth_passing_hz, to_string(nearest.mode), nearest.frequency_hz);
  if (result.job.finish.any()) {
    result.notes.push_back(text + " It keeps the limits of [finishing].");
  } else {
    result.warnings.push_back(text +
                              " Its surface error and deflection stand beside the recommendation; [finishing] "
                              "in the job limits them.");
  }
}

/// The limit as the feed turns through the plane: a robot is not the same in every direction.
void turn_feed(PlanResult& result, Progress& progress) {
  FeedDirections out;
  const stability::LobesOptions options = comparison_options(result);
  const double low = options.spindle_speed_rad_per_s[0];
  const double high = options.spindle_speed_rad_per_s[1];
  std::vector<double> speeds;
  speeds.reserve(speeds_a_direction + 1);
  for (int i = 0; i < speeds_a_direction; ++i)
    speeds.push_back(std::lerp(low, high, static_cast<double>(i) / (speeds_a_direction - 1)));
  const bool recommended = result.recommendation.recommended.has_value();
  if (recommended) {
    speeds.push_back(result.recommendation.recommended->spindle_speed_rad_per_s);
    out.limit_at_speed_m.resize(feed_directions);
  }
  out.direction_rad.resize(feed_directions);
  out.lowest_limit_m.setConstant(feed_directions, std::numeric_limits<double>::quiet_NaN());
  stability::LobesProblem problem = result.cut.problem;
  // Turning the feed by half a turn turns forces and displacements alike: the limit is the same.
  constexpr Eigen::Index half = feed_directions / 2;
  for (Eigen::Index i = 0; i < half; ++i) {
    problem.feed_direction_rad = std::numbers::pi * static_cast<double>(i) / half;
    out.direction_rad(i) = problem.feed_direction_rad;
    out.direction_rad(i + half) = problem.feed_direction_rad + std::numbers::pi;
    const std::vector<stability::Limit> limits = stability::limit_depths(problem, options, speeds, progress);
    for (std::size_t k = 0; k < limits.size(); ++k) {
      const double depth = limits[k].status == stability::Limit::Status::found
                               ? limits[k].axial_depth_m
                               : std::numeric_limits<double>::quiet_NaN();
      if (k < speeds_a_direction) {
        out.lowest_limit_m(i) = std::fmin(out.lowest_limit_m(i), depth);
      } else {
        out.limit_at_speed_m(i) = depth;
      }
    }
  }
  out.lowest_limit_m.tail(half) = out.lowest_limit_m.head(half);
  if (recommended) out.limit_at_speed_m.tail(half) = out.limit_at_speed_m.head(half);
  result.feed_directions = out;
}

void compare(PlanResult& result, Progress& progress) {
  result.cuts = compare_cuts(result.job.cuts, result.cut.problem, result.cut.options, progress);
  for (std::size_t i = 0; i < result.job.cuts.size(); ++i) {
    const TestCut& cut = result.job.cuts[i];
    if (cut.file.empty()) continue;
    result.recordings.push_back(read_recording(cut, result.cut.problem));
    const Recording& recording = result.recordings.back();
    ComparedCut& row = result.cuts[i];
    if (row.result == Verdict::unknown) {
      row.result = recording.verdict;
      const bool clear = row.result == Verdict::stable || row.result == Verdict::chatter;
      if (clear) row.agrees = row.result == row.predicted;
    }
    row.note += "; " + recording.file + ": " + recording.reason;
  }
}

/// How far the limit moves with what the fit, and the file of the cut, leave uncertain.
void spread(PlanResult& result, std::uint64_t seed, Progress& progress) {
  const auto known = [](const modal::Mode& mode) { return std::isfinite(mode.frequency_std_hz); };
  stability::Uncertainty& uncertainty = result.cut.uncertainty;
  if (uncertainty.samples == 0 && std::ranges::any_of(result.model.modes, known)) {
    uncertainty.samples = 100;
    uncertainty.grid = {40, 30};
  }
  if (uncertainty.samples == 0) return;
  if (!result.cut.band_note.empty()) result.notes.push_back(result.cut.band_note);
  uncertainty.seed = seed;
  // A band needs no more than three digits of each limit.
  stability::LobesOptions options = result.cut.options;
  options.tolerance = std::max(options.tolerance, 1e-4);
  result.uncertain = stability::uncertain_limits(result.cut.problem, options, uncertainty, progress);
}

}  // namespace

void choose_conditions(PlanResult& result, std::uint64_t seed, Progress& progress) {
  result.cut.drop_dynamics();  // the job's stand in their place
  load_dynamics(result.cut);
  result.cut.problem.dynamics = result.model;
  result.cut.validate();
  // The report draws the boundary in any case.
  if (result.cut.options.output == stability::Output::map) result.cut.options.output = stability::Output::both;
  result.lobes = stability::compute_lobes(result.cut.problem, result.cut.options, progress);
  spread(result, seed, progress);
  decision::RecommendOptions recommend = result.job.recommend;
  recommend.radial_depth_m = result.cut.radial_depth_m;
  result.recommendation = decision::choose(result.cut.problem, result.cut.options, result.lobes.limit, recommend,
                                           result.job.finish, progress);
  report_resonance(result);
  pairs(result, progress);
  turn_feed(result, progress);
  compare(result, progress);
}

}  // namespace robomill::jobs
