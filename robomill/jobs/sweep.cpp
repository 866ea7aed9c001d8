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
#include "robomill/io/json.hpp"
#include "robomill/jobs/files/slurm_jobs.hpp"
#include "robomill/jobs/files/statistics_json.hpp"
#include "robomill/jobs/files/study_points_json.hpp"
#include "robomill/jobs/files/study_toml.hpp"
#include "robomill/jobs/files/sweep_folder.hpp"
#include "robomill/jobs/files/sweep_tables.hpp"
#include "robomill/jobs/sweep/chunks.hpp"
#include "robomill/jobs/sweep/evaluate.hpp"
#include "robomill/jobs/sweep/statistics.hpp"
#include "robomill/jobs/sweep/tasks.hpp"

namespace robomill::jobs {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t most_reasons = 5, most_processors = 20;

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
    if (job.shards > 1 || job.slurm) require_known_points(study_, job.slurm ? "slurm" : "shard");
    result_.study = study_;
    result_.points = most_points_of(study_, points_);
  }

  SweepResult run() {
    if (job_.slurm) {
      submit();
      return std::move(result_);
    }
    if (job_.dry_run) {
      try_one();
      return std::move(result_);
    }
    SweepPlan plan;
    if (job_.status || !job_.merge.empty()) {
      plan = folder_.plan();
      folder_.require_same(plan, plan_of(study_, points_));
    } else {
      plan = begin();
      locks_ = folder_.lock(job_.shard, job_.shards);
    }
    if (study_.boundary) {
      trace(plan);
    } else {
      add(plan);
    }
    result_.points = points_.size();
    result_.chunk_points = plan.chunk_points;
    look_at_chunks();
    if (job_.status) look_at_runs();
    if (!job_.status) write_tables();
    if (!job_.status && result_.complete() && job_.shards == 1) {
      write_findings();
      keep_points();
    }
    return std::move(result_);
  }

 private:
  void try_one() {
    PointOutcome outcome;
    result_.point_s = point_seconds(points_, evaluator_, progress_, outcome);
    add_once(result_.reasons, outcome.reason, most_reasons);
    count_state(outcome.state, result_);
    for (std::size_t i = 0; i < outcome.values.size(); ++i) {
      if (std::isnan(outcome.values[i])) result_.absent.push_back(study_.collect[i]);
    }
  }

  std::uint64_t chunk_points() { return fitting_chunk_points(study_, points_, evaluator_, progress_); }

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
    if (locks_) do_chunks(plan);
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
    SweepFolder::note(*locks_, ran_points_, ran_thread_s_, thread_count());
    for (const std::uint64_t chunk : missing) {
      const Clock::time_point begin = Clock::now();
      const std::vector<PointOutcome> outcomes =
          outcomes_of(evaluator_, points_, plan.first_of(chunk), plan.size_of(chunk), progress_);
      require_unchanged(study_, plan.fingerprint);
      folder_.save(plan, chunk, outcomes);
      ran_points_ += plan.size_of(chunk);
      ran_thread_s_ += seconds_since(begin) * std::max(thread_count(), 1);
      SweepFolder::note(*locks_, ran_points_, ran_thread_s_, thread_count());
      result_.point_s = ran_thread_s_ / static_cast<double>(ran_points_);
      ++result_.ran_chunks;
    }
  }

  void look_at_chunks() {
    Seen seen(study_.collect);
    Chunk chunk;
    // A shard looks at its own chunks alone: each of a thousand would read all of them.
    const bool all = !locks_ || job_.shards == 1;
    const auto first = static_cast<std::uint64_t>(all ? 0 : job_.shard - 1);
    const auto step = static_cast<std::uint64_t>(all ? 1 : job_.shards);
    for (const SweepPlan& plan : plans_) {
      result_.chunks += plan.chunks();
      there_.resize(there_.size() + plan.chunks(), false);
      for (std::uint64_t i = first; i < plan.chunks(); i += step) {
        if (folder_.find(plan, i, chunk) != SweepFolder::Found::there) continue;
        ++result_.done_chunks;
        there_[plan.first_chunk + i] = true;
        seen.count(chunk, result_);
      }
    }
    if (result_.done_chunks > 0) result_.absent = seen.absent();
  }

  [[nodiscard]] SweepPlan begin() {
    return folder_.begin(plan_of(study_, points_), [this] { return chunk_points(); });
  }

  /// Who works here, and how long it will take at what points took so far.
  void look_at_runs() {
    const SweepFolder::Work work = folder_.work();
    result_.running = work.running;
    int threads = work.threads;
    if (const std::optional<SlurmJobs> jobs = SlurmFolder(job_.folder).jobs()) {
      result_.tasks = tasks_of(*jobs, there_, work.running);
      std::error_code ignored;
      result_.tasks.has_tables = std::filesystem::exists(folder_.at("results.csv"), ignored);
      threads = std::max(threads, result_.tasks.running * study_.slurm.cpus);
    }
    const std::uint64_t looked_at = result_.done + result_.short_of + result_.rejected;
    const std::uint64_t left = result_.points - std::min(result_.points, looked_at);
    if (work.points > 0.0) {
      result_.point_s = work.thread_s / work.points;
      result_.left_thread_s = result_.point_s * static_cast<double>(left);
      if (threads > 0) result_.left_s = result_.left_thread_s / threads;
    }
  }

  void submit() {
    if (study_.slurm.shards == 0) {
      throw InvalidInput(study_.file.string(), "has no [slurm] table",
                         "As: [slurm] shards = 16, time_min = 120, memory_mb = 2000");
    }
    SweepPlan plan;
    if (job_.dry_run) {
      plan = {.points = points_.size(), .chunk_points = std::min<std::uint64_t>(chunk_points(), points_.size())};
    } else {
      plan = begin();
    }
    result_.chunk_points = plan.chunk_points;
    plans_.push_back(plan);
    const int shards =
        static_cast<int>(std::min<std::uint64_t>(static_cast<std::uint64_t>(study_.slurm.shards), plan.chunks()));
    const std::filesystem::path folder = job_.folder.empty() ? "FOLDER" : job_.folder;
    const SlurmScripts scripts = slurm_scripts(
        study_.slurm, {.program = slurm_program(), .study = whole(job_.study), .folder = whole(folder)}, shards);
    if (job_.dry_run) {
      result_.chunks = plan.chunks();
      result_.tasks = {.tasks = shards, .array_script = scripts.array, .merge_script = scripts.merge};
      return;
    }
    look_at_chunks();
    const SlurmFolder slurm(job_.folder);
    require_idle(slurm);
    const SlurmJobs jobs = slurm.submit(scripts, shards);
    result_.tasks = tasks_of(jobs, there_, {});
    for (const char* name : {"array.sh", "merge.sh"}) result_.written.push_back(slurm.at(name).string());
  }

  /// Two arrays would wait for each other's chunks.
  void require_idle(const SlurmFolder& slurm) const {
    const std::optional<SlurmJobs> jobs = slurm.jobs();
    const SweepTasks before = jobs ? tasks_of(*jobs, there_, {}) : SweepTasks();
    if (before.running + before.waiting == 0) return;
    throw InvalidInput(job_.folder.string(), fmt::format("is being worked on by job {} of Slurm", before.array),
                       fmt::format("scancel {} ends it", before.array));
  }

  static std::filesystem::path whole(const std::filesystem::path& path) {
    return std::filesystem::absolute(path).lexically_normal();
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
                         "Run the study, or its other shards, first");
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
    result_.statistics_json = io::dump(statistics_table().write(found));
  }

  void keep_points() {
    ShownPoints shown = shown_points_of(done_study(), boundary_ ? &*boundary_ : nullptr);
    shown.rejected = result_.rejected;
    result_.study_points_json = io::dump(study_points_table().write(shown));
  }

  const SweepJob& job_;
  Progress& progress_;
  Study study_;
  StudyPoints points_;
  Evaluator evaluator_;
  SweepFolder folder_;
  std::optional<SweepFolder::Locks> locks_ = {};  ///< of a run that does chunks
  std::vector<SweepPlan> plans_ = {};             ///< one, but of a boundary one a step
  std::vector<bool> there_ = {};                  ///< which chunks are done
  std::uint64_t ran_points_ = 0;                  ///< by this run
  double ran_thread_s_ = 0.0;
  std::optional<Boundary> boundary_ = {};
  SweepResult result_;
};

}  // namespace

SweepResult run_sweep(const SweepJob& job, Progress& progress) {
  if (job.shards < 1 || job.shard < 1 || job.shard > job.shards) {
    throw InvalidInput("shard", job.shard, "", fmt::format("must lie between 1 and {}", std::max(job.shards, 1)));
  }
  return Sweep(job, progress).run();
}

}  // namespace robomill::jobs
