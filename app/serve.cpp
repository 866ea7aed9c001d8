#include "robomill/serve/serve.hpp"

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "monitor/broker.hpp"
#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/text.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

std::shared_ptr<void> open_broker(const monitor::MonitorFile& file, const serve::StreamSink& sink,
                                  const std::atomic<bool>& ended) {
  auto broker = std::make_shared<Broker>(file, true, sink.queue, sink.notices, sink.metrics);
  broker->require_connection(ended);
  return broker;
}

/// Without the line's end behind it.
std::string token_in(const std::filesystem::path& file) {
  constexpr std::uint64_t longest = 4096;
  const std::string text = io::read_file(file, longest);
  return std::string(io::trimmed(text));
}

}  // namespace

int work_for_server() {
  return serve::work_for_server(open_broker);
}

Exit run_serve(const jobs::VerbJob& job, const Common& common, Progress&) {
  if (!common.output.empty()) throw InvalidInput("--output", "serve writes nothing by itself", "Leave -o out");
  const std::atomic<bool>& stop = stop_on_signal();
  std::signal(SIGCHLD, SIG_DFL);  // a launcher may ignore it: then nobody would know how a process ended
  serve::ServeOptions options;
  if (!job.inputs.empty()) options.folder = job.input();
  options.host = job.get("host", options.host);
  options.port = job.get("port", options.port);
  options.token = job.has("token_file") ? token_in(job.file("token_file")) : job.text("token");
  options.validate();
  options.memory_bytes = std::uint64_t{1'000'000} * job.get("job_memory_mb", std::uint64_t{0});
  options.worker = {"/proc/self/exe", std::string(serve_worker)};  // this program, also where its file was replaced
  const bool restricted = serve::restrict_to_folder(options.folder);
  options.open_stream = open_broker;
  const serve::Server server(options);
  fmt::print("{}\n", server.address());
  if (!common.quiet) {
    fmt::print("Serves {}. Ctrl-C ends it.\n", std::filesystem::canonical(options.folder).string());
    if (!restricted)
      fmt::print("This kernel has no Landlock: only robomill itself sees to it that no file outside is read.\n");
    if (!options.token.empty()) {
      fmt::print("Reachable at {} by whoever has the token: they can read and write the folder and run jobs.\n",
                 options.host);
    }
  }
  std::fflush(stdout);
  while (!stop) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  take_time_to_end(5.0);  // for jobs that run
  return done;
}

}  // namespace robomill::app
