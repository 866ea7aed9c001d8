#include "robomill/serve/job_runner.hpp"

#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/jobs/plan.hpp"
#include "robomill/jobs/summary.hpp"
#include "robomill/page/report.hpp"
#include "robomill/serve/error_json.hpp"

namespace robomill::serve {
namespace {

using Clock = std::chrono::steady_clock;

enum class State { queued, running, done, failed, cancelled };
constexpr std::array<const char*, 5> state_names = {"queued", "running", "done", "failed", "cancelled"};

/// What a job came to.
struct Outcome {
  bool reached = true;
  std::string summary, report;
};

Outcome run_plan(const std::filesystem::path& input, const std::filesystem::path& output, Progress& progress) {
  constexpr std::uint64_t seed = 1;
  const jobs::PlanResult result = jobs::run_job(input, seed, progress, output);
  if (!output.empty()) jobs::write_plan(output, result);
  return {.reached = jobs::reached(result),
          .summary = jobs::summary(result),
          .report = page::report_json(jobs::make_report(result, {}))};
}

using Run = Outcome (*)(const std::filesystem::path&, const std::filesystem::path&, Progress&);
constexpr std::array<std::pair<std::string_view, Run>, 1> verbs = {{{"plan", &run_plan}}};

Run verb_of(const std::string& name) {
  for (const auto& [known, run] : verbs) {
    if (known == name) return run;
  }
  throw InvalidInput("verb", "must be \"plan\"");
}

}  // namespace

struct JobRunner::Job {
  int id = 0;
  JobRequest request;
  std::atomic<bool> stop{false};
  // The rest under the runner's mutex.
  State state = State::queued;
  std::string task = {};
  double fraction = 0.0;
  Clock::time_point started = {}, ended = {}, announced = {};
  io::Json error = nullptr;
  Outcome outcome = {};

  [[nodiscard]] io::Json json() const {
    const bool began = state != State::queued && started != Clock::time_point();
    const bool over = state != State::queued && state != State::running;
    const auto seconds = std::chrono::duration<double>((over ? ended : Clock::now()) - started).count();
    return {{"id", id},
            {"verb", request.verb},
            {"input", request.input},
            {"output", request.output.empty() ? io::Json(nullptr) : io::Json(request.output)},
            {"state", state_names[static_cast<std::size_t>(state)]},
            {"exit", state == State::done     ? io::Json(outcome.reached ? 0 : 3)
                     : state == State::failed ? io::Json(1)
                                              : io::Json(nullptr)},
            {"task", task},
            {"fraction", fraction},
            {"seconds", began ? io::number(seconds) : io::Json(nullptr)},
            {"error", error},
            {"summary", outcome.summary.empty() ? io::Json(nullptr) : io::Json(outcome.summary)},
            {"report", !outcome.report.empty()}};
  }
};

JobRunner::JobRunner(std::filesystem::path root, std::function<void(const std::string&)> changed)
    : root_(std::move(root)), changed_(std::move(changed)) {}

JobRunner::~JobRunner() {
  const std::lock_guard lock(mutex_);
  for (const std::shared_ptr<Job>& job : jobs_) job->stop = true;
}

std::optional<int> JobRunner::submit(const JobRequest& request) {
  static_cast<void>(verb_of(request.verb));
  const auto job = std::make_shared<Job>();
  job->request = request;
  {
    const std::lock_guard lock(mutex_);
    job->id = ++last_;
    jobs_.push_back(job);
  }
  if (!worker_.post([this, job] { run(job); })) {
    const std::lock_guard lock(mutex_);
    std::erase(jobs_, job);
    return std::nullopt;
  }
  announce(*job);
  return job->id;
}

void JobRunner::announce(const Job& job) const {
  std::string text;
  {
    const std::lock_guard lock(mutex_);
    text = job.json().dump(-1, ' ', false, io::Json::error_handler_t::replace);
  }
  changed_(text);
}

void JobRunner::run(const std::shared_ptr<Job>& job) {
  const auto set = [&](auto&& change) {
    const std::lock_guard lock(mutex_);
    change();
  };
  set([&] {
    job->state = State::running;
    job->started = Clock::now();
  });
  announce(*job);
  Progress progress(
      [&](const std::string& task, double fraction) {
        constexpr std::chrono::milliseconds pause(200);
        bool due = false;
        set([&] {
          due = Clock::now() - job->announced > pause || task != job->task;
          job->task = task;
          job->fraction = fraction;
          if (due) job->announced = Clock::now();
        });
        if (due) announce(*job);
      },
      &job->stop);
  Outcome outcome;
  State state = State::failed;
  io::Json error = nullptr;
  try {
    progress.check();
    const JobRequest& request = job->request;
    const std::filesystem::path output = request.output.empty() ? std::filesystem::path() : root_ / request.output;
    outcome = verb_of(request.verb)(root_ / request.input, output, progress);
    state = State::done;
  } catch (const InvalidInput& found) {
    error = error_object(found, root_);
  } catch (const Interrupted&) {
    state = State::cancelled;
  } catch (const std::bad_alloc&) {
    error = {{"text", "not enough memory for this input"}};
  } catch (const std::exception& found) {
    error = {{"text", found.what()}};
  }
  set([&] {
    job->state = state;
    job->outcome = std::move(outcome);
    job->error = std::move(error);
    job->ended = Clock::now();
    job->fraction = state == State::done ? 1.0 : job->fraction;
    forget_old();
  });
  announce(*job);
}

/// Reports are large: the last few stay. The mutex is held.
void JobRunner::forget_old() {
  std::size_t reports = 0;
  for (auto job = jobs_.rbegin(); job != jobs_.rend(); ++job) {
    if (!(*job)->outcome.report.empty() && ++reports > most_reports) (*job)->outcome.report = {};
  }
  const auto over = [](const std::shared_ptr<Job>& job) {
    return job->state != State::queued && job->state != State::running;
  };
  while (jobs_.size() > most_kept && over(jobs_.front())) jobs_.pop_front();
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
  return job ? job->outcome.report : std::string();
}

bool JobRunner::cancel(int id) {
  std::shared_ptr<Job> job;
  {
    const std::lock_guard lock(mutex_);
    job = find(id);
    if (!job) return false;
    job->stop = true;
    if (job->state == State::queued) job->state = State::cancelled;
  }
  announce(*job);
  return true;
}

}  // namespace robomill::serve
