#include "robomill/jobs/plan_stages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/cost.hpp"
#include "robomill/base/units.hpp"
#include "robomill/decision/choose.hpp"
#include "robomill/decision/test_cuts.hpp"
#include "robomill/jobs/files/in_words.hpp"
#include "robomill/process/vibration_text.hpp"

namespace robomill::jobs {
namespace {

/// Of the vibration at the recommended cut: which harmonic makes most of it, and which mode answers.
void report_vibration(PlanResult& result) {
  if (!result.recommendation.recommended) return;
  const decision::Operation& op = *result.recommendation.recommended;
  const stability::ForcedVibration& v = op.vibration;
  if (!std::isfinite(v.amplitude_m)) return;
  constexpr double mentioned = 0.1;  // of the feed per tooth
  constexpr double warned = 0.5;
  const double share = v.amplitude_m / op.feed_per_tooth_m;
  if (share < mentioned) return;
  const std::string text = "Forced vibration at the recommended cut: " + process::vibration_text(v, share) + ".";
  if (share < warned) {
    result.notes.push_back(text);
    return;
  }
  result.warnings.push_back(
      text + (result.job.finish.any() ? " It keeps the limits of [finishing]."
                                      : " A speed off its resonance vibrates less; [finishing] in the job limits it."));
}

void compare(PlanResult& result, Progress& progress) {
  using decision::Verdict;
  result.cuts = decision::compare_cuts(result.job.cuts, result.cut.problem, result.cut.options, progress);
  for (decision::ComparedCut& row : result.cuts) {
    if (row.cut.file.empty()) continue;
    result.recordings.push_back(decision::judge_recording(row.cut, read_cut_signal(row.cut), result.cut.problem));
    const std::vector<std::string>& notes = result.recordings.back().notes;
    result.notes.insert(result.notes.end(), notes.begin(), notes.end());
    const decision::Recording& recording = result.recordings.back();
    if (row.cut.result == Verdict::unknown) {
      row.cut.result = recording.verdict;
      const bool clear = row.cut.result == Verdict::stable || row.cut.result == Verdict::chatter;
      if (clear) row.agrees = row.cut.result == row.predicted;
    }
    row.note += "; " + recording.file + ": " + recording.reason;
  }
}

/// How far the limit moves with what the fit, and the file of the cut, leave uncertain.
void spread(PlanResult& result, std::uint64_t seed, Progress& progress) {
  const auto known = [](const modal::Mode& mode) { return std::isfinite(mode.frequency_std_hz); };
  stability::Uncertainty& uncertainty = result.cut.uncertainty;
  const bool asked = uncertainty.samples > 0;
  if (!asked && std::ranges::any_of(result.model.modes, known)) {
    uncertainty.samples = 100;
    uncertainty.grid = {40, 30};
  }
  if (uncertainty.samples == 0) return;
  uncertainty.seed = seed;
  // A band needs no more than three digits of each limit.
  stability::LobesOptions options = result.cut.options;
  options.tolerance = std::max(options.tolerance, 1e-4);
  if (!asked) {
    const Cost cost = stability::cost_of_uncertain_limits(result.cut.problem, options, uncertainty);
    if (const std::string over = above_limit(cost); !over.empty()) {
      result.notes.push_back(fmt::format(
          "The band of the limit by what the fit leaves uncertain is left out: its {} samples would take {}. "
          "[uncertainty] in {} asks for one, of 20 samples or more.",
          uncertainty.samples, over, result.cut.path.filename().string()));
      uncertainty.samples = 0;
      return;
    }
  }
  if (!result.cut.band_note.empty()) result.notes.push_back(result.cut.band_note);
  result.uncertain = stability::uncertain_limits(result.cut.problem, options, uncertainty, progress);
}

/// As many nodes a length as before.
int nodes_for(int before, double old_length, double new_length) {
  const double most = std::max(2000.0, static_cast<double>(before));
  return static_cast<int>(std::clamp(std::ceil(before * new_length / old_length), 2.0, most));
}

/// Whether a cut ends where the chart does, and cutter and spindle would take more.
bool ends_with_chart(const PlanResult& result) {
  if (!(result.job.recommend.max_axial_depth_m > result.cut.options.axial_depth_m[1])) return false;
  const auto at_end = [](const decision::Operation& op) { return op.limited_by == decision::LimitedBy::depth_range; };
  const decision::Recommendation& found = result.recommendation;
  return (found.recommended && at_end(*found.recommended)) || std::ranges::any_of(found.alternatives, at_end);
}

void find_limits(PlanResult& result, Progress& progress) {
  result.lobes = stability::compute_lobes(result.cut.problem, result.cut.options, progress);
  decision::RecommendOptions recommend;
  recommend.machine = result.job.recommend;
  recommend.radial_depth_m = result.cut.radial_depth_m;
  result.recommendation = decision::choose(result.cut.problem, result.cut.options, result.lobes.limit, recommend,
                                           result.job.finish, progress);
}

/// Depths up to the cutter's are searched where no chatter was found up to the chart's.
void cover_cutter(PlanResult& result, Progress& progress) {
  if (!ends_with_chart(result)) return;
  std::array<double, 2>& chart = result.cut.options.axial_depth_m;
  const double deepest = result.job.recommend.max_axial_depth_m;
  result.notes.push_back(fmt::format(
      "The chart of {} goes to {:.3g} mm, where no chatter was found at some speeds, the cutter's edges to {:.3g} mm: "
      "all of it was searched.",
      result.cut.path.filename().string(), chart[1] / units::mm, deepest / units::mm));
  result.cut.options.grid[1] = nodes_for(result.cut.options.grid[1], chart[1] - chart[0], deepest - chart[0]);
  chart[1] = deepest;
  find_limits(result, progress);
}

}  // namespace

std::string cover_spindle(LobesFile& cut, const decision::MachineLimits& recommend) {
  const std::array<double, 2> spindle = decision::spindle_range(recommend);
  double from = spindle[0];
  const double to = spindle[1];
  std::array<double, 2>& chart = cut.options.spindle_speed_rad_per_s;
  const std::array<double, 2> asked = chart;
  if (from <= 0.0) from = asked[0];
  const double high = std::max(asked[1], to);
  // Slow speeds cost most and remove least.
  constexpr double slowest = 0.1;
  const double low = std::min(asked[0], std::max(from, slowest * high));
  if (low >= asked[0] && high <= asked[1]) return {};
  chart = {low, high};
  cut.options.grid[0] = nodes_for(cut.options.grid[0], asked[1] - asked[0], high - low);
  std::string text = fmt::format(
      "The chart of {} goes from {:.0f} to {:.0f} rpm, the spindle from {:.0f} to {:.0f} rpm: {:.0f} to {:.0f} rpm "
      "were searched.",
      cut.path.filename().string(), asked[0] / units::rpm, asked[1] / units::rpm, from / units::rpm,
      (to > 0.0 ? to : asked[1]) / units::rpm, low / units::rpm, high / units::rpm);
  if (from < low) text += " Slower ones were not.";
  return text;
}

void choose_conditions(PlanResult& result, std::uint64_t seed, Progress& progress) {
  result.cut.drop_dynamics();  // the job's stand in their place
  load_dynamics(result.cut);
  result.cut.problem.dynamics = result.model;
  result.cut.validate();
  // The report draws the boundary in any case.
  if (result.cut.options.output == stability::Output::map) result.cut.options.output = stability::Output::both;
  if (std::string text = cover_spindle(result.cut, result.job.recommend); !text.empty()) {
    result.notes.push_back(std::move(text));
  }
  with_words_of(result.cut, [&] {
    find_limits(result, progress);
    cover_cutter(result, progress);
    spread(result, seed, progress);
  });
  report_vibration(result);
  result.pairs = decision::limits_of_pairs(result.cut.problem, result.cut.options, progress);
  const std::optional<decision::Operation>& recommended = result.recommendation.recommended;
  result.feed_directions = decision::limits_over_feed(
      result.cut.problem, result.cut.options,
      recommended ? std::optional(recommended->spindle_speed_rad_per_s) : std::nullopt, progress);
  compare(result, progress);
}

}  // namespace robomill::jobs
