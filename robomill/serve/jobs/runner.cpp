#include "robomill/serve/jobs/runner.hpp"

#include <algorithm>
#include <array>
#include <exception>
#include <new>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/jobs/plan.hpp"
#include "robomill/serve/error_json.hpp"
#include "robomill/serve/program/live_program.hpp"

namespace robomill::serve {
namespace {

using Clock = std::chrono::steady_clock;

enum class RunState { queued, running, done, failed, cancelled };
constexpr std::array<const char*, 5> state_names = {"queued", "running", "done", "failed", "cancelled"};

}  // namespace

struct JobRunner::Job {
  int id = 0;
  JobRequest request;
  std::atomic<bool> stop{false};
  // The rest under the runner's mutex.
  RunState state = RunState::queued;
  std::string task = {};
  double fraction = 0.0;
  Clock::time_point started = {}, ended = {}, announced = {};
  io::Json error = nullptr;
  JobRun result = {};

  [[nodiscard]] bool is_over() const { return state != RunState::queued && state != RunState::running; }
  [[nodiscard]] io::Json json() const {
    const bool began = started != Clock::time_point();
    const auto seconds = std::chrono::duration<double>((is_over() ? ended : Clock::now()) - started).count();
    return {{"id", id},
            {"verb", request.verb},
            {"input", request.inputs.front()},
            {"inputs", request.inputs},
            {"output", io::text_or_null(request.output)},
            {"options", request.options},
            {"state", state_names[static_cast<std::size_t>(state)]},
            {"exit", state == RunState::done     ? io::Json(result.outcome.shortfall.empty() ? 0 : 3)
                     : state == RunState::failed ? io::Json(1)
                                                 : io::Json(nullptr)},
            {"task", task},
            {"fraction", fraction},
            {"seconds", began ? io::number(seconds) : io::Json(nullptr)},
            {"error", error},
            {"shortfall", io::text_or_null(result.outcome.shortfall)},
            {"summary", io::text_or_null(result.outcome.summary)},
            {"report", !result.outcome.report.empty()}};
  }
};

RunJob run_here(std::filesystem::path root) {
  return [root = std::move(root)](const JobRequest& request, const Progress::Report& report,
                                  const std::atomic<bool>& stop) {
    Progress progress(report, &stop);
    JobRun run = {.outcome = run_verb(request, root, progress)};
    if (const std::shared_ptr<const jobs::PlanResult> plan = std::move(run.outcome.plan)) {
      run.blocks = plan->shown().blocks->rows.size();
      run.turn = [plan](const std::string& body, Progress& turning) {
        return live_program(read_live_program_request(body), *plan, turning);
      };
    }
    return run;
  };
}

JobRunner::JobRunner(std::filesystem::path root, std::function<void(const std::string&)> changed, RunJob run_job)
    : root_(std::move(root)),
      changed_(std::move(changed)),
      run_job_(std::move(run_job)),
      thread_([this](const std::stop_token& stop) { work(stop); }) {}

JobRunner::~JobRunner() {
  thread_.request_stop();
  const std::lock_guard lock(mutex_);
  for (const std::shared_ptr<Job>& job : jobs_) job->stop = true;
}

std::optional<int> JobRunner::submit(const JobRequest& request) {
  const auto job = std::make_shared<Job>();
  job->request = request;
  {
    const std::lock_guard lock(mutex_);
    const auto unfinished = std::ranges::count_if(jobs_, [](const auto& one) { return !one->is_over(); });
    if (unfinished > static_cast<std::ptrdiff_t>(most_queued)) return std::nullopt;  // one of them runs
    job->id = ++last_;
    jobs_.push_back(job);
  }
  announce(*job);
  arrived_.notify_one();
  return job->id;
}

void JobRunner::work(const std::stop_token& stop) {
  const auto is_queued = [](const std::shared_ptr<Job>& job) { return job->state == RunState::queued; };
  for (;;) {
    std::shared_ptr<Job> job;
    {
      std::unique_lock lock(mutex_);
      arrived_.wait(lock, stop, [&] { return std::ranges::any_of(jobs_, is_queued); });
      if (stop.stop_requested()) return;
      job = *std::ranges::find_if(jobs_, is_queued);
      job->state = RunState::running;
      job->started = Clock::now();
    }
    run(job);
  }
}

void JobRunner::announce(const Job& job) const {
  std::string text;
  {
    const std::lock_guard lock(mutex_);
    text = io::plain_text(job.json());
  }
  changed_(text);
}

void JobRunner::run(const std::shared_ptr<Job>& job) {
  const auto set = [&](auto&& change) {
    const std::lock_guard lock(mutex_);
    change();
  };
  announce(*job);
  const auto report = [&](const std::string& task, double fraction) {
    constexpr std::chrono::milliseconds pause(200);
    bool due = false;
    set([&] {
      due = Clock::now() - job->announced > pause || task != job->task;
      job->task = task;
      job->fraction = fraction;
      if (due) job->announced = Clock::now();
    });
    if (due) announce(*job);
  };
  JobRun result;
  RunState state = RunState::failed;
  io::Json error = nullptr;
  try {
    if (job->stop) throw Interrupted();
    result = run_job_(job->request, report, job->stop);
    result.outcome.shortfall = client_text(std::move(result.outcome.shortfall), root_);
    result.outcome.summary = without_root(std::move(result.outcome.summary), root_);
    result.outcome.report = without_root(std::move(result.outcome.report), root_);
    state = RunState::done;
  } catch (const InvalidInput& found) {
    error = error_object(found, root_);
  } catch (const AnsweredElsewhere& found) {
    error = found.error();
  } catch (const Interrupted&) {
    state = RunState::cancelled;
  } catch (const std::bad_alloc&) {
    error = error_object("not enough memory for this input");
  } catch (const std::exception& found) {
    error = error_object(client_text(found.what(), root_));
  }
  set([&] {
    job->state = state;
    job->result = std::move(result);
    job->error = std::move(error);
    job->ended = Clock::now();
    job->fraction = state == RunState::done ? 1.0 : job->fraction;
    forget_old();
  });
  announce(*job);
}

/// Reports and plans are large: the last few stay. The mutex is held.
void JobRunner::forget_old() {
  std::size_t reports = 0;
  std::size_t plans = 0;
  std::size_t blocks = 0;
  for (auto job = jobs_.rbegin(); job != jobs_.rend(); ++job) {
    JobRun& result = (*job)->result;
    if (!result.outcome.report.empty() && ++reports > most_reports) result.outcome.report = {};
    if (!result.turn) continue;
    blocks += result.blocks;
    const bool many = ++plans > most_plans || (plans > 1 && blocks > most_plan_blocks);
    if (many) result.turn = {};
  }
  while (jobs_.size() > most_kept) {
    const auto oldest = std::ranges::find_if(jobs_, [](const std::shared_ptr<Job>& job) { return job->is_over(); });
    if (oldest == jobs_.end()) return;
    jobs_.erase(oldest);
  }
}

std::shared_ptr<JobRunner::Job> JobRunner::find(int id) const {
  for (const std::shared_ptr<Job>& job : jobs_) {
    if (job->id == id) return job;
  }
  return nullptr;
}

io::Json JobRunner::list() const {
  const std::lock_guard lock(mutex_);
  io::Json out = io::Json::array();
  for (const std::shared_ptr<Job>& job : jobs_) out.push_back(job->json());
  return out;
}

io::Json JobRunner::job(int id) const {
  const std::lock_guard lock(mutex_);
  const std::shared_ptr<Job> job = find(id);
  return job ? job->json() : io::Json(nullptr);
}

std::string JobRunner::report(int id) const {
  const std::lock_guard lock(mutex_);
  const std::shared_ptr<Job> job = find(id);
  return job ? job->result.outcome.report : std::string();
}

TurnProgram JobRunner::turn(int id) const {
  const std::lock_guard lock(mutex_);
  const std::shared_ptr<Job> job = find(id);
  return job ? job->result.turn : TurnProgram();
}

bool JobRunner::cancel(int id) {
  std::shared_ptr<Job> job;
  {
    const std::lock_guard lock(mutex_);
    job = find(id);
    if (!job) return false;
    job->stop = true;
    if (job->state == RunState::queued) {
      job->state = RunState::cancelled;
      forget_old();
    }
  }
  announce(*job);
  return true;
}

}  // namespace robomill::serve
