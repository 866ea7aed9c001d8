#include "robomill/process/decide/lean_ways.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/base/units.hpp"
#include "robomill/process/blocks/named_block.hpp"
#include "robomill/process/decide/apply.hpp"
#include "robomill/process/decide/collisions.hpp"
#include "robomill/process/decide/exact_run.hpp"

namespace robomill::process {
namespace {

/// Of the ball's radius, which dexels see the engaged part beyond.
constexpr double ball_tolerance = 0.02;

/// Whether more of the cutter than its ball is in the material.
bool cuts_above_ball(const ForcesResult& forces, std::size_t block) {
  const double ball_m = 0.5 * forces.cut.cutter.mill.diameter_m * (1.0 + ball_tolerance);
  const cutting::Engagement& engagement = forces.program->cuts[block].engagement;
  for (std::size_t i = 0; i < engagement.slices.size(); ++i) {
    if (engagement.slices[i].height_m > ball_m && !engagement.of(i).empty()) return true;
  }
  return false;
}

/// What is wrong with the cut of a block that leans; empty: nothing.
/// @param programmed  the block as it is programmed
std::string wrong_cut(const ForcesResult& forces, const BlockResult& programmed, std::size_t block) {
  const BlockResult& row = forces.program->blocks[block];
  if (row.force.shank_depth_m > forces.cut.dexel_m) return "the shank runs into the material";
  if (row.force.rapid_in_material && !programmed.force.rapid_in_material) return "a rapid move runs through material";
  if (row.settled == BlockResult::Settled::lost && programmed.settled != BlockResult::Settled::lost)
    return "the force pushes the tool out of the cut";
  if (cuts_above_ball(forces, block)) return "more than the ball cuts";
  return {};
}

/// One lean of all stretches that can have it.
class LeanRun {
 public:
  LeanRun(const DecideProblem& problem, const ProgramUnits& units, const std::vector<Eigen::Matrix3d>& frames,
          const robot::CollisionChecker& checker)
      : problem_(problem), units_(units), frames_(frames), checker_(checker) {}

  LeanWay at(const Lean& lean, Progress& progress) const {
    LeanWay out = {.lean = lean};
    out.fails.resize(units_.stretches.size());
    const StandingProgram standing = stand(lean, out.fails);
    if (!leans(out.fails)) return out;
    out.forces = run_again(problem_, standing, progress);
    for (std::size_t k = 0; k < out.fails.size(); ++k) {
      if (out.fails[k].empty()) out.fails[k] = found_wrong(out.forces, k);
    }
    return out;
  }

  static bool leans(const std::vector<std::string>& fails) {
    return std::ranges::any_of(fails, [](const std::string& why) { return why.empty(); });
  }

 private:
  /// Stretches in which the robot cannot stand so keep their axes.
  StandingProgram stand(const Lean& lean, std::vector<std::string>& fails) const {
    std::vector<Lean> of_stretch(units_.stretches.size(), lean);
    for (;;) {
      StandingProgram out = {.program = leant(problem_.forces, units_, frames_, of_stretch), .stands = {}};
      out.stands = joints_at(problem_.forces, out.program, {});
      if (!out.stands.lost) return out;
      // A lean is lost at its own blocks or, as the way led elsewhere, at later ones that do not lean.
      std::size_t k = stretch_at(*out.stands.lost);
      while (k > 0 && of_stretch[k] == Lean{}) --k;
      of_stretch[k] = {};
      fails[k] = "the robot cannot stand so in " + named_block(problem_.forces, *out.stands.lost);
    }
  }

  std::size_t stretch_at(std::size_t block) const {
    const auto after = std::ranges::upper_bound(units_.lean_from, block);
    return static_cast<std::size_t>(std::max(after - units_.lean_from.begin() - 1, std::ptrdiff_t{0}));
  }

  std::string found_wrong(const ForcesResult& forces, std::size_t stretch) const {
    std::vector<std::size_t> blocks;
    for (std::size_t c = units_.stretches[stretch].begin; c < units_.stretches[stretch].end; ++c) {
      for (std::size_t i = units_.lines[c].first_block; i <= units_.lines[c].last_block; ++i) blocks.push_back(i);
    }
    std::vector<std::string> why(blocks.size());
    parallel_for(blocks.size(), 8, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        // Where more than the ball cuts as programmed, a lean leaves another surface.
        why[i] = cuts_above_ball(problem_.forces, blocks[i])
                     ? "more than the ball cuts"
                     : wrong_cut(forces, problem_.forces.program->blocks[blocks[i]], blocks[i]);
        if (!why[i].empty()) continue;
        const robot::Clearance clearance = checker_.check(forces.program->blocks[blocks[i]].joints);
        if (clearance.status != robot::Clearance::Status::clear) why[i] = cell::near_miss_text(clearance);
      }
    });
    const auto first = std::ranges::find_if(why, [](const std::string& text) { return !text.empty(); });
    if (first == why.end()) return {};
    return *first + " in " + named_block(forces, blocks[static_cast<std::size_t>(first - why.begin())]);
  }

  const DecideProblem& problem_;
  const ProgramUnits& units_;
  const std::vector<Eigen::Matrix3d>& frames_;
  const robot::CollisionChecker& checker_;
};

}  // namespace

std::vector<LeanWay> lean_ways(const DecideProblem& problem, const ProgramUnits& units,
                               const std::vector<Eigen::Matrix3d>& frames, const robot::CollisionChecker& checker,
                               std::vector<std::string>& notes, Progress& progress) {
  if (problem.forces.cut.cutter.kind != cutting::CutterKind::ball_end) {
    throw InvalidInput("decide.free", "must hold neither \"lead\" nor \"tilt\" but for a ball end",
                       "Another cutter leaves another surface where it leans otherwise");
  }
  const std::vector<Lean> leans = leans_within(problem.options);
  const LeanRun run(problem, units, frames, checker);
  std::vector<LeanWay> out;
  std::size_t left_out = 0;
  std::string first;
  for (const Lean& lean : leans) {
    LeanWay way = run.at(lean, progress);
    for (const std::string& why : way.fails) {
      if (why.empty()) continue;
      if (left_out++ > 0) continue;
      first =
          fmt::format("lead {:.3g}°, tilt {:.3g}°: {}", lean.lead_rad / units::deg, lean.tilt_rad / units::deg, why);
    }
    if (LeanRun::leans(way.fails)) out.push_back(std::move(way));
  }
  if (left_out > 0) {
    notes.push_back(fmt::format("{} of {} leans of a stretch are left out, the first with {}.", left_out,
                                leans.size() * units.stretches.size(), first));
  }
  return out;
}

}  // namespace robomill::process
