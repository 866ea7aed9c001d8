#include "robomill/path/smooth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <deque>
#include <span>
#include <string>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/path/duration.hpp"
#include "robomill/path/emitter.hpp"
#include "robomill/path/posture.hpp"
#include "robomill/path/postures/axis_tilt.hpp"
#include "robomill/path/published/fir.hpp"
#include "robomill/path/speed/planner.hpp"
#include "robomill/path/speed/preview.hpp"

namespace robomill::path {
namespace {

/// Rounds of planning before it is given up.
constexpr int max_rounds = 40;
/// Times that a row is planned again before it is left to the check.
constexpr int max_revisions = 6;
/// Blocks up to which the lower bound is found.
constexpr std::size_t lower_bound_blocks = 50'000;

double processor_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// One program for two readers, who run at their own pace.
class Shared {
 public:
  explicit Shared(program::Source& source) : source_(source) {}
  bool next(std::size_t reader, program::Block& out) {
    std::size_t& at = at_[reader];
    if (at == held_.size()) {
      program::Block block;
      if (!source_.next(block)) return false;
      held_.push_back(block);
    }
    out = held_[at++];
    for (; at_[0] > 0 && at_[1] > 0; --at_[0], --at_[1]) held_.pop_front();
    return true;
  }
  [[nodiscard]] const program::Pose& start() const { return source_.start(); }

 private:
  program::Source& source_;
  std::deque<program::Block> held_;
  std::array<std::size_t, 2> at_ = {};
};
class Reader final : public program::Source {
 public:
  Reader(Shared& shared, std::size_t index) : shared_(shared), index_(index) {}
  [[nodiscard]] const program::Pose& start() const override { return shared_.start(); }
  bool next(program::Block& out) override { return shared_.next(index_, out); }
  void rewind() override {}

 private:
  Shared& shared_;
  std::size_t index_;
};

/// The turn about the tool's axis at the end of a block; block −1 is the start.
double gamma_after(const Posture& posture, std::size_t blocks_done) {
  const std::vector<double>& gamma = posture.gamma_rad;
  if (gamma.empty()) return 0.0;
  return gamma[std::min(blocks_done, gamma.size() - 1)];
}

[[noreturn]] void reject(const Planner::Status& status, const robot::Kinematics& kinematics) {
  using Kind = Planner::Status::Kind;
  if (status.kind == Kind::antipodal) {
    throw InvalidInput(
        "block " + std::to_string(status.block + 1),
        "turns the tool's axis by half a circle (line " + std::to_string(status.line) + "): no one way leads there",
        "Give a pose between");
  }
  throw cannot_take(status.reach, kinematics, status.block, status.line);
}

/// A block that is tilted, in its parts; each leaves the program's axis by the tilt.
std::vector<program::Block> in_parts(std::span<const AxisTilt> tilts, std::size_t index, const program::Pose& from,
                                     const program::Block& block, double tilt_rad) {
  std::vector<program::Block> out;
  double begin = 0.0;
  for (const TiltedPart& part : tilted_parts(tilts, index, from, block.end)) {
    out.push_back(block);
    out.back().end = part.end;
    out.back().duration_s = block.duration_s * (part.share - begin);
    out.back().axis_deviation_rad += tilt_rad;
    begin = part.share;
  }
  return out;
}

/// Between two reports of progress.
constexpr std::size_t blocks_a_report = 64;

/// Feeds a program through a planner, which advances the progress by its blocks; `take` gets what is planned.
template <class Take>
void run(program::Source& source, const Posture& posture, const robot::Kinematics& kinematics, Planner& planner,
         Progress& progress, std::size_t& blocks, Take&& take) {
  const auto hold = [&](const Planner::Status& status) {
    if (!status.ok()) reject(status, kinematics);
    take();
    while (planner.busy()) {
      const Planner::Status more = planner.resume();
      if (!more.ok()) reject(more, kinematics);
      take();
    }
  };
  hold(planner.begin(source.start(), gamma_after(posture, 0), posture.start));
  program::Block block;
  program::Pose at = source.start();
  for (blocks = 0; source.next(block); ++blocks) {
    const double gamma_rad = gamma_after(posture, blocks + 1), tilt_rad = tilt_within(posture.tilts, blocks);
    const bool moves = block.kind != program::Block::Kind::dwell;
    if (moves && tilt_rad > 0.0) {
      for (const program::Block& part : in_parts(posture.tilts, blocks, at, block, tilt_rad)) {
        hold(planner.push(part, blocks, gamma_rad));
      }
    } else {
      hold(planner.push(block, blocks, gamma_rad));
    }
    if (moves) at = block.end;
    if (blocks % blocks_a_report == 0) progress.advance(blocks_a_report);
  }
  hold(planner.finish());
}

/// Slower, or nearer to the programmed path, where limits were broken.
/// @return false where nothing of it helps
bool correct(const std::vector<Violation>& violations, SpeedCorrections& corrections) {
  SpeedCorrections more;
  const auto least = [](auto& map, auto key, double factor) {
    const auto [at, fresh] = map.emplace(key, factor);
    if (!fresh) at->second = std::min(at->second, factor);
  };
  for (const Violation& violation : violations) {
    if (violation.order < 0) continue;
    if (violation.order == 0) {
      const double factor = std::clamp(0.97 / violation.ratio, 0.5, 0.97);
      for (std::size_t block = violation.block == 0 ? 0 : violation.block - 1; block <= violation.block + 1; ++block) {
        least(more.tolerance, block, factor);
      }
    } else {
      // Differences reach over three samples.
      const double factor = std::clamp(0.97 * std::pow(violation.ratio, -1.0 / violation.order), 0.5, 0.97);
      const auto cell = static_cast<std::int64_t>(std::floor(violation.path_m * SpeedCorrections::cells_per_m));
      for (std::int64_t at = cell - 1; at <= cell + 1; ++at) least(more.speed, at, factor);
    }
  }
  for (const auto& [block, factor] : more.tolerance) corrections.tolerance.emplace(block, 1.0).first->second *= factor;
  for (const auto& [cell, factor] : more.speed) corrections.speed.emplace(cell, 1.0).first->second *= factor;
  return !more.tolerance.empty() || !more.speed.empty();
}

double lower_bound_s(program::Source& source, const Posture& posture, const robot::Kinematics& kinematics,
                     const SmoothingOptions& options, const SpeedCorrections& corrections, Progress& progress) {
  PlannerOptions to_the_limit;
  to_the_limit.share = 1.0;
  const SpeedCorrections shape{.tolerance = corrections.tolerance, .speed = {}};  // the same path, at any speed
  std::vector<BoundPoint> points;
  Planner planner(kinematics, options, to_the_limit, &shape, Planner::Task::points);
  source.rewind();
  double dwells_s = 0.0;
  std::size_t blocks = 0;
  run(source, posture, kinematics, planner, progress, blocks, [&] {
    for (const Segment& segment : planner.motion()) dwells_s += segment.dwell_s;
    points.insert(points.end(), planner.points().begin(), planner.points().end());
    planner.motion().clear();
    planner.points().clear();
    planner.path().clear();
  });
  return dwells_s + least_time_s(points, planner.limits());
}

/// A plan of the windowed planner, its samples and their check; once.
void plan_once(program::Source& source, const robot::Kinematics& kinematics, const Posture& posture,
               const SmoothingOptions& options, SpeedCorrections& corrections, const SampleSink& sink,
               Progress& progress, Summary& out) {
  Shared shared(source);
  Reader to_plan(shared, 0), to_check(shared, 1);
  Planner planner(kinematics, options, options.method == Method::optimal ? PlannerOptions::optimal() : PlannerOptions{},
                  &corrections, Planner::Task::proposals);
  Emitter emitter(kinematics, options.sample_period_s, posture.start);
  Checker checker(to_check, kinematics, options);
  Preview preview(kinematics, options);
  std::vector<Sample> samples;
  out.samples = 0;
  out.emit_s = 0.0;
  double aside_s = 0.0;
  const double begin_s = processor_s();
  const auto send = [&](bool whole) {
    if (!whole) throw cannot_take(emitter.reach(), kinematics, emitter.at().block, emitter.at().line);
    checker.add(samples);
    preview.pass(samples);
    sink(samples);
    out.samples += samples.size();
    samples.clear();
  };
  // Before a row is sampled, and slower again: how long it takes.
  const auto look_at_end = [&] {
    const std::span<const Segment> kept = std::span<const Segment>(planner.motion()).first(planner.kept());
    if (kept.empty()) return;
    double planned_s = emitter.duration_s();
    for (const Segment& segment : kept) planned_s += duration_s(segment);
    require_end(options, planned_s, emitter.at().block, emitter.at().line);
  };
  // A row that would break limits is planned again before it is taken over.
  const auto revise = [&] {
    std::vector<Violation> violations;
    for (int i = 0; planner.proposes() && i < max_revisions; ++i) {
      violations.clear();
      const std::span<const Segment> motion = planner.motion();
      Emitter ahead = emitter;
      for (std::size_t from = 0, to = 0; from < motion.size(); from = to + 1) {
        for (to = from; to < motion.size() && planner.suspect(to); ++to) {
        }
        if (to > from) preview.look(ahead, motion.subspan(from, to - from), from == 0, violations);
      }
      progress.check();
      if (!correct(violations, corrections) || !planner.revise()) return;
    }
  };
  run(to_plan, posture, kinematics, planner, progress, out.blocks, [&] {
    static_cast<void>(emitter.add(planner.path(), {}, samples));
    planner.path().clear();
    look_at_end();
    revise();
    look_at_end();
    const double from_s = processor_s();
    double sent_s = 0.0;
    const std::span<const Segment> kept = std::span<const Segment>(planner.motion()).first(planner.kept());
    const bool whole = emitter.add({}, kept, samples, [&] {
      const double at_s = processor_s();
      progress.check();
      send(true);
      sent_s += processor_s() - at_s;
    });
    out.emit_s += processor_s() - from_s - sent_s;
    planner.motion().clear();
    send(whole);
    progress.check();
    aside_s += processor_s() - from_s;
  });
  out.plan_s += processor_s() - begin_s - aside_s;
  const bool whole = emitter.finish(samples);
  send(whole);
  out.duration_s = emitter.duration_s();
  out.check = checker.finish();
}

/// The published methods: the program in memory, no second round.
void plan_published(program::Source& source, const robot::Kinematics& kinematics, const Posture& posture,
                    const SmoothingOptions& options, const SampleSink& sink, Progress& progress, Summary& out) {
  program::Program program{.start = source.start(), .blocks = {}};
  program::Block block;
  while (source.next(block)) program.blocks.push_back(block);
  progress.check();
  double begin_s = processor_s();
  const FirPlan plan = plan_fir(program, kinematics, posture, options);
  require_end(options, plan.duration_s, 0, 0);
  out.plan_s = processor_s() - begin_s;
  out.blocks = program.blocks.size();
  out.duration_s = plan.duration_s;
  out.sum_t2_s = plan.sum_t2_s;
  out.largest_overlap_s = plan.largest_overlap_s;
  program::ProgramSource to_check(program);
  Checker checker(to_check, kinematics, options);
  double aside_s = 0.0;
  begin_s = processor_s();
  out.samples =
      sample_fir(plan, program, kinematics, posture, options.sample_period_s, [&](std::span<const Sample> samples) {
        const double from_s = processor_s();
        progress.check();
        checker.add(samples);
        sink(samples);
        aside_s += processor_s() - from_s;
      });
  out.emit_s = processor_s() - begin_s - aside_s;
  out.check = checker.finish();
}

}  // namespace

Summary smooth(program::Source& source, const robot::Kinematics& kinematics, const Posture& posture,
               const SmoothingOptions& options, const SampleSink& sink, const std::function<void()>& restart,
               Progress& progress) {
  options.validate();
  Summary out;
  source.rewind();
  const std::size_t blocks = require_duration(source, options, progress);
  source.rewind();
  restart();
  if (options.method != Method::verified && options.method != Method::optimal) {
    out.rounds = 1;
    progress.start("smoothing", blocks);
    plan_published(source, kinematics, posture, options, sink, progress, out);
    return out;
  }
  SpeedCorrections corrections;
  for (out.rounds = 1;; ++out.rounds) {
    progress.start(out.rounds == 1 ? "smoothing" : "smoothing again, round " + std::to_string(out.rounds), blocks);
    plan_once(source, kinematics, posture, options, corrections, sink, progress, out);
    if (out.samples == 0) {
      throw InvalidInput("program", "moves nothing", "A program of dwells alone has no path to plan");
    }
    if (out.check.violations() == 0 || out.rounds == max_rounds) break;
    if (!correct(out.check.worst_violations, corrections)) break;
    source.rewind();
    restart();
  }
  if (out.blocks <= lower_bound_blocks) {
    progress.start("least time", blocks);
    out.lower_bound_s = lower_bound_s(source, posture, kinematics, options, corrections, progress);
  }
  return out;
}

}  // namespace robomill::path
