#include "robomill/jobs/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/jobs/files/statistics_json.hpp"
#include "robomill/jobs/files/study_toml.hpp"
#include "robomill/jobs/files/sweep_folder.hpp"
#include "robomill/jobs/files/sweep_tables.hpp"
#include "robomill/jobs/sweep/evaluate.hpp"
#include "robomill/jobs/sweep/statistics.hpp"

namespace robomill::jobs {
namespace {

using Clock = std::chrono::steady_clock;

/// Of one thread. A chunk is what a run that is killed loses at most.
constexpr double chunk_s = 60.0;
constexpr std::size_t most_chunk_points = 100'000, most_reasons = 5, most_processors = 20;

void add_once(std::vector<std::string>& to, const std::string& text, std::size_t most) {
  if (!text.empty() && to.size() < most && std::ranges::find(to, text) == to.end()) to.push_back(text);
}

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

void count_state(PointState state, SweepResult& result) {
  (state == PointState::done ? result.done : state == PointState::short_of ? result.short_of : result.rejected) += 1;
}

/// What the points that are done so far say of each value that is collected.
class Seen {
 public:
  explicit Seen(const std::vector<std::string>& collect) : names_(collect), seen_(collect.size(), false) {}
  void count(const Chunk& chunk, SweepResult& result) {
    for (const PointOutcome& point : chunk.points) {
      count_state(point.state, result);
      add_once(result.reasons, point.reason, most_reasons);
      for (std::size_t i = 0; i < names_.size(); ++i) seen_[i] = seen_[i] || !std::isnan(point.values[i]);
    }
    add_once(result.processors, chunk.processor, most_processors);
  }
  [[nodiscard]] std::vector<std::string> absent() const {
    std::vector<std::string> out;
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (!seen_[i]) out.push_back(names_[i]);
    }
    return out;
  }

 private:
  const std::vector<std::string>& names_;
  std::vector<bool> seen_;
};

class Sweep {
 public:
  Sweep(const SweepJob& job, Progress& progress)
      : job_(job),
        progress_(progress),
        study_(read_study(job.study)),
        points_(study_),
        evaluator_(study_),
        folder_(job.folder) {
    if (study_.boundary && job.shards > 1) {
      throw InvalidInput("shard", "is not for a study with [boundary]",
                         "Which points are next depends on those before. One run does a step on all threads");
    }
    result_.study = study_;
    result_.points = study_.boundary ? static_cast<std::uint64_t>(study_.boundary->most_points) : points_.size();
  }

  SweepResult run() {
    if (job_.dry_run) {
      try_one();
      return std::move(result_);
    }
    SweepPlan plan = {.fingerprint = fingerprint_of(study_),
                      .points = result_.points,
                      .keys = points_.keys(),
                      .collect = study_.collect};
    std::optional<SweepFolder::Locks> locks;
    if (job_.status) {
      const SweepPlan there = folder_.plan();
      folder_.require_same(there, plan);
      plan = there;
    } else {
      plan = folder_.begin(std::move(plan), [this] { return chunk_points(); });
      locks = folder_.lock(job_.shard, job_.shards);
    }
    if (study_.boundary) {
      trace(plan);
    } else {
      add(plan);
    }
    result_.points = points_.size();
    result_.chunk_points = plan.chunk_points;
    look_at_chunks();
    if (!job_.status) write_tables();
    if (!job_.status && result_.complete() && job_.shards == 1) write_findings();
    return std::move(result_);
  }

 private:
  /// A point in the middle, since those at the edges may be out of range.
  /// @return the seconds that it took
  double measure(PointOutcome& outcome) {
    const Clock::time_point begin = Clock::now();
    outcome = evaluator_.at(points_.settings(points_.size() / 2), progress_);
    return seconds_since(begin);
  }

  void try_one() {
    PointOutcome outcome;
    result_.point_s = measure(outcome);
    add_once(result_.reasons, outcome.reason, most_reasons);
    count_state(outcome.state, result_);
    for (std::size_t i = 0; i < outcome.values.size(); ++i) {
      if (std::isnan(outcome.values[i])) result_.absent.push_back(study_.collect[i]);
    }
  }

  std::uint64_t chunk_points() {
    if (study_.chunk_points > 0) return static_cast<std::uint64_t>(study_.chunk_points);
    PointOutcome ignored;
    const double points = chunk_s / std::max(measure(ignored), 1e-6);
    return static_cast<std::uint64_t>(std::clamp(points, 1.0, static_cast<double>(most_chunk_points)));
  }

  /// The chunks of this shard that are not done.
  std::vector<std::uint64_t> missing_chunks(const SweepPlan& plan) {
    std::vector<std::uint64_t> out;
    Chunk there;
    const auto step = static_cast<std::uint64_t>(job_.shards);
    for (auto chunk = static_cast<std::uint64_t>(job_.shard - 1); chunk < plan.chunks(); chunk += step) {
      const SweepFolder::Found found = folder_.find(plan, chunk, there);
      if (found == SweepFolder::Found::there) continue;
      if (found == SweepFolder::Found::damaged) result_.damaged.push_back(plan.first_chunk + chunk);
      out.push_back(chunk);
    }
    return out;
  }

  void add(const SweepPlan& plan) {
    plans_.push_back(plan);
    if (!job_.status) do_chunks(plan);
  }

  struct Unfinished {};

  /// The chunks of each step of the boundary follow those of the step before, on whose values they depend.
  void trace(SweepPlan plan) {
    const BoundaryOptions options = boundary_options(study_);
    const BoundaryGrid grid(options);
    points_ = StudyPoints(points_.keys());
    try {
      boundary_ = trace_boundary(options, [&](std::span<const std::uint64_t> asked) {
        plan.points = asked.size();
        plan.first_point = points_.size();
        for (const std::uint64_t point : asked) points_.add(texts_of(grid, point));
        add(plan);
        std::vector<double> out = heights_of(plan);
        plan.first_chunk += plan.chunks();
        return out;
      });
    } catch (const Unfinished&) {
      boundary_.reset();
    }
  }

  static std::vector<std::string> texts_of(const BoundaryGrid& grid, std::uint64_t point) {
    std::vector<std::string> out;
    for (std::size_t axis = 0; axis < grid.axes(); ++axis)
      out.push_back(fmt::format("{}", grid.coordinate(point, axis)));
    return out;
  }

  /// Of the boundary's value above its level. @throws Unfinished if a chunk is missing
  [[nodiscard]] std::vector<double> heights_of(const SweepPlan& plan) const {
    const auto column = std::ranges::find(plan.collect, study_.boundary->value) - plan.collect.begin();
    std::vector<double> out;
    Chunk chunk;
    for (std::uint64_t i = 0; i < plan.chunks(); ++i) {
      if (folder_.find(plan, i, chunk) != SweepFolder::Found::there) throw Unfinished();
      for (const PointOutcome& point : chunk.points) {
        out.push_back(point.values[static_cast<std::size_t>(column)] - study_.boundary->level);
      }
    }
    return out;
  }

  void do_chunks(const SweepPlan& plan) {
    const std::vector<std::uint64_t> missing = missing_chunks(plan);
    std::uint64_t points = 0;
    for (const std::uint64_t chunk : missing) points += plan.size_of(chunk);
    progress_.start("points", points);
    const Clock::time_point begin = Clock::now();
    for (const std::uint64_t chunk : missing) {
      const std::vector<PointOutcome> outcomes = outcomes_of(plan, chunk);
      require_unchanged(plan);
      folder_.save(plan, chunk, outcomes);
      ++result_.ran_chunks;
    }
    if (points == 0) return;
    result_.point_s = seconds_since(begin) * std::max(thread_count(), 1) / static_cast<double>(points);
  }

  /// Points are computed from the files as they stood when the study began.
  void require_unchanged(const SweepPlan& plan) const {
    if (fingerprint_of(study_) == plan.fingerprint) return;
    throw InvalidInput(study_.file.string(), "or a file that it names has changed while the study ran",
                       "The points that were just done are dropped");
  }

  std::vector<PointOutcome> outcomes_of(const SweepPlan& plan, std::uint64_t chunk) {
    const std::uint64_t first = plan.first_of(chunk);
    std::vector<PointOutcome> out(plan.size_of(chunk));
    parallel_for(out.size(), 1, [&](std::size_t from, std::size_t to) {
      const ThreadLimit alone(1);
      for (std::size_t i = from; i < to; ++i) {
        Progress inside([this](const std::string&, double) { progress_.check(); }, nullptr);
        out[i] = evaluator_.at(points_.settings(first + i), inside);
        // Once more: what could not be read for a moment is no fault of the point.
        if (out[i].state == PointState::rejected) out[i] = evaluator_.at(points_.settings(first + i), inside);
        progress_.advance();
      }
    });
    return out;
  }

  void look_at_chunks() {
    Seen seen(study_.collect);
    Chunk chunk;
    for (const SweepPlan& plan : plans_) {
      result_.chunks += plan.chunks();
      for (std::uint64_t i = 0; i < plan.chunks(); ++i) {
        if (folder_.find(plan, i, chunk) != SweepFolder::Found::there) continue;
        ++result_.done_chunks;
        seen.count(chunk, result_);
      }
    }
    if (result_.done_chunks > 0) result_.absent = seen.absent();
  }

  [[nodiscard]] DoneStudy done_study() const { return {.plans = plans_, .points = points_, .folder = folder_}; }

  void write_tables() {
    std::vector<std::filesystem::path> tables;
    if (!job_.merge.empty()) tables.push_back(job_.merge);
    if (job_.merge.empty() && result_.complete() && job_.shards == 1)
      tables = {folder_.at("results.csv"), folder_.at("results.h5")};
    if (job_.merge.empty() && !result_.complete() && job_.shards == 1) {
      throw InvalidInput(folder_.at("chunks").string(),
                         fmt::format("{} of {} chunks are whole", result_.done_chunks, result_.chunks),
                         "Others were changed, or are damaged: run the study again");
    }
    if (tables.empty()) return;
    if (!result_.complete()) {
      throw InvalidInput(job_.merge.string(),
                         fmt::format("needs all chunks: {} of {} are done", result_.done_chunks, result_.chunks),
                         "Run the other shards first");
    }
    for (const std::filesystem::path& table : tables) {
      write_sweep_table(table, done_study());
      result_.written.push_back(table.string());
    }
  }

  /// What the points say together, where the study asks for it.
  void write_findings() {
    if (!study_.boundary && !study_.sensitivity && !study_.probability) return;
    Statistics found;
    if (boundary_) {
      found.boundary = summary_of_boundary(study_, *boundary_);
      for (const char* name : {"boundary.csv", "boundary.h5"}) {
        write_boundary_table(folder_.at(name), plans_.front(), *boundary_);
        result_.written.push_back(folder_.at(name).string());
      }
    } else {
      found = statistics_of(study_, points_, columns_of(done_study()));
    }
    const std::filesystem::path path = folder_.at("statistics.json");
    write_statistics(path, found);
    result_.written.push_back(path.string());
    result_.findings = lines_of(found);
  }

  const SweepJob& job_;
  Progress& progress_;
  Study study_;
  StudyPoints points_;
  Evaluator evaluator_;
  SweepFolder folder_;
  SweepResult result_;
  std::vector<SweepPlan> plans_ = {};  ///< one, but of a boundary one a step
  std::optional<Boundary> boundary_ = {};
};

}  // namespace

SweepResult run_sweep(const SweepJob& job, Progress& progress) {
  if (job.shards < 1 || job.shard < 1 || job.shard > job.shards) {
    throw InvalidInput("shard", job.shard, "", fmt::format("must lie between 1 and {}", std::max(job.shards, 1)));
  }
  return Sweep(job, progress).run();
}

}  // namespace robomill::jobs
