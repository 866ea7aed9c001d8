#include "robomill/serve/process/work.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "robomill/base/cost.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/io/json.hpp"
#include "robomill/io/system/confinement.hpp"
#include "robomill/io/system/pending_names.hpp"
#include "robomill/io/system/sandbox.hpp"
#include "robomill/jobs/plan.hpp"
#include "robomill/serve/error_json.hpp"
#include "robomill/serve/files/answers.hpp"
#include "robomill/serve/files/folder.hpp"
#include "robomill/serve/jobs/verbs.hpp"
#include "robomill/serve/lobes/live_lobes.hpp"
#include "robomill/serve/monitor/sessions.hpp"
#include "robomill/serve/overview/overview.hpp"
#include "robomill/serve/process/frames.hpp"
#include "robomill/serve/process/job_process.hpp"
#include "robomill/serve/process/monitor_service.hpp"
#include "robomill/serve/process/own_library.hpp"
#include "robomill/serve/process/work.hpp"
#include "robomill/serve/program/live_program.hpp"
#include "robomill/serve/serve.hpp"

namespace robomill::serve {
namespace {

/// What a process that works for a server may do, once and for all: before it has a second thread.
struct Rights {
  std::filesystem::path root;
  std::uint64_t memory_bytes = 0;
  int threads = 0;
  bool connects = false;
  int last_id = 0;

  /// As WorkerProgram says it: "MEMORY THREADS CONNECTS LAST_ID", a line's end, the root, whose name may be any bytes.
  explicit Rights(const std::string& body) {
    const std::size_t line_end = std::min(body.find('\n'), body.size());
    std::istringstream numbers(body.substr(0, line_end));
    if (!(numbers >> memory_bytes >> threads >> connects >> last_id))
      throw std::runtime_error("is started by a server, not by hand");
    root = body.substr(std::min(line_end + 1, body.size()));
  }
  void give_up_the_rest() const {
    const rlimit no_core{0, 0};
    ::setrlimit(RLIMIT_CORE, &no_core);
    CostLimit limit = {.way_out = "run it on the command line with --allow-large"};
    if (memory_bytes > 0) {
      io::limit_own_memory(memory_bytes);
      limit.bytes = std::min(limit.bytes, static_cast<double>(memory_bytes));
    }
    set_cost_limit(limit);
    set_thread_count(threads);
    static_cast<void>(io::restrict_files(file_rights_of_worker(root, connects)));  // else its Confinement remains
  }
};

/// Ends the process at once; what it was writing goes.
[[noreturn]] void end_now(int code) {
  io::remove_pending_files();
  ::_exit(code);
}

extern "C" void on_end(int) {
  end_now(128 + SIGTERM);
}

/// More of what the server sends; it is the server's end that ends this process.
void read_more(FrameReader& frames) {
  std::array<char, 1 << 16> block = {};
  ssize_t count = -1;
  do {
    count = ::recv(worker_socket, block.data(), block.size(), 0);
  } while (count < 0 && errno == EINTR);
  if (count <= 0) end_now(0);
  frames.add({block.data(), static_cast<std::size_t>(count)});
}

/// Waits for the next frame.
Frame next_frame(FrameReader& frames) {
  for (;;) {
    if (std::optional<Frame> frame = frames.next()) return *std::move(frame);
    read_more(frames);
  }
}

/// Answers one question after the other. A thread of its own listens meanwhile, for a word to stop.
class Work {
 public:
  Work(Rights rights, FrameReader frames, OpenStream open_stream)
      : rights_(std::move(rights)),
        folder_(rights_.root),
        confinement_(folder_.root()),
        monitors_(
            folder_, std::move(open_stream),
            [this](std::string_view event, std::string_view data) {
              send(Frame::event, fmt::format("{}\n{}", event, data));
            },
            rights_.last_id),
        listener_([this, frames = std::move(frames)]() mutable { listen(frames); }) {}

  [[noreturn]] void run() {
    for (;;) {
      const Frame asked = take();
      try {
        answer(asked);
      } catch (const std::exception&) {  // no memory for the answer
        send(Frame::answer, no_memory_);
      }
    }
  }

 private:
  void send(char kind, std::string_view body) {
    const std::lock_guard lock(sending_);
    if (!send_frame(worker_socket, kind, body)) end_now(0);
  }
  void answer(const Frame& asked) {
    HttpResponse found = answer_of(folder_.root(), [&] { return answer_to(asked); });
    const std::string status = fmt::format("{} ", found.status);
    if (status.size() + found.body.size() > longest_answer) {
      return send(Frame::answer, frame_text(error_response(500, "the answer is longer than 256 MB")));
    }
    send(Frame::answer, found.body.insert(0, status));
  }
  [[noreturn]] void listen(FrameReader& frames) {
    try {
      for (;;) {
        Frame frame = next_frame(frames);
        if (frame.kind == Frame::stop) {
          stop_ = true;
          continue;
        }
        stop_ = false;
        const std::lock_guard lock(mutex_);
        asked_.push_back(std::move(frame));
        arrived_.notify_one();
      }
    } catch (const std::exception&) {
      end_now(1);  // what came is no question
    }
  }
  Frame take() {
    std::unique_lock lock(mutex_);
    arrived_.wait(lock, [this] { return !asked_.empty(); });
    Frame out = std::move(asked_.front());
    asked_.pop_front();
    return out;
  }
  HttpResponse answer_to(const Frame& asked) {
    switch (asked.kind) {
      case Frame::job:
        return run_job(asked.body);
      case Frame::program:
        return turn_program(asked.body);
      case Frame::lobes:
        return {.body = answer_lobes(asked.body)};
      case Frame::check:
        return check_text(folder_, asked.body);
      case Frame::inspect:
        return inspect_file(folder_, asked.body);
      case Frame::overview:
        return answer_overview(folder_, plans_, asked.body);
      case Frame::monitors:
        return monitors_.answer(http_request_of(asked.body));
      default:
        return error_response(500, "this is no question");
    }
  }
  HttpResponse run_job(const std::string& body) {
    const JobRequest request = request_of(body);
    Progress progress([this](const std::string& task, double fraction) { tell(task, fraction); }, &stop_);
    try {
      JobOutcome outcome = run_verb(request, folder_.root(), progress);
      plan_ = std::move(outcome.plan);
      return {.body = text_of(outcome, plan_ ? plan_->shown().blocks->rows.size() : 0)};
    } catch (const std::bad_alloc&) {
      constexpr std::uint64_t mb = 1'000'000;
      return error_response(
          500, fmt::format("not enough memory for this input: a job may have {} MB here", rights_.memory_bytes / mb));
    }
  }
  HttpResponse turn_program(const std::string& body) {
    if (!plan_) return error_response(404, "the job judged no program");
    Progress progress({}, &stop_);
    return {.body = live_program(read_live_program_request(body), *plan_, progress)};
  }
  std::string answer_lobes(const std::string& body) {
    LiveLobesRequest request = read_live_lobes_request(body);
    request.file = folder_.resolve(request.file.string());
    Progress progress({}, &stop_);
    return lobes_.answer(request, progress);
  }
  /// Ten times a second at most.
  void tell(const std::string& task, double fraction) {
    constexpr std::chrono::milliseconds pause(100);
    const auto now = std::chrono::steady_clock::now();
    if (task == task_ && now - told_ < pause) return;
    task_ = task;
    told_ = now;
    send(Frame::progress, io::plain_text({{"task", task}, {"fraction", io::number(fraction)}}));
  }

  static std::string frame_text(const HttpResponse& response) {
    return fmt::format("{} {}", response.status, response.body);
  }

  const std::string no_memory_ =
      frame_text(error_response(500, "not enough memory for this"));  ///< made while there is some
  Rights rights_;
  Folder folder_;
  io::Confinement confinement_;
  std::mutex sending_;
  MonitorSessions monitors_;
  LiveLobes lobes_;
  PlanReader plans_;
  std::shared_ptr<const jobs::PlanResult> plan_;  ///< of the last job
  std::string task_;
  std::chrono::steady_clock::time_point told_ = {};
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<Frame> asked_;
  std::atomic<bool> stop_{false};
  std::thread listener_;
};

}  // namespace

io::FileRights file_rights_of_worker(const std::filesystem::path& root, bool connects) {
  io::FileRights files = {.readable = {"/usr/lib", "/usr/share/zoneinfo", "/lib", "/lib64", "/etc/ld.so.cache",
                                       "/etc/localtime", "/proc/self", "/sys/devices/system"},
                          .writable = {root, "/dev/null"},
                          .connects = connects};
  if (connects) {  // names of hosts, and certificates
    for (const char* path : {"/etc", "/usr", "/run/systemd/resolve", "/run/resolvconf", "/dev/urandom"}) {
      files.readable.emplace_back(path);
    }
  }
  return files;
}

int work_for_server(OpenStream open_stream) {
  int type = 0;
  socklen_t size = sizeof(type);
  if (::getsockopt(worker_socket, SOL_SOCKET, SO_TYPE, &type, &size) != 0) return 2;  // nobody who could ask
  std::signal(SIGTERM, on_end);
  forget_preload(worker_library);
  try {
    FrameReader frames(longest_question);
    const Rights rights(next_frame(frames).body);
    rights.give_up_the_rest();
    Work work(rights, std::move(frames), std::move(open_stream));
    work.run();
  } catch (const std::exception& error) {
    fmt::print(stderr, "robomill: {}\n", error.what());
    return 1;
  }
}

}  // namespace robomill::serve
