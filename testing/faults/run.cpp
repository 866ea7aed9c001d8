#include "testing/faults/run.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "testing/processes.hpp"

namespace robomill::faults {
namespace {

namespace fs = std::filesystem;

/// One that hangs is killed.
constexpr const char* most_seconds = "120";

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  return {std::istream_iterator<std::string>(in), std::istream_iterator<std::string>()};
}

Report* map_report(const fs::path& path) {
  std::ofstream(path, std::ios::binary) << std::string(sizeof(Report), '\0');
  const int file = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
  void* mapped = file < 0 ? MAP_FAILED : ::mmap(nullptr, sizeof(Report), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  if (file >= 0) ::close(file);
  if (mapped == MAP_FAILED) throw std::runtime_error("no report: " + path.string());
  return static_cast<Report*>(mapped);
}

void clear(Report& report) {
  for (auto& count : report.calls) count = 0;
  report.reached = 0;
  report.call = 0;
  report.file.fill('\0');
  report.unsynced_files = 0;
  report.unsynced_folders = 0;
}

}  // namespace

Files files_of(const fs::path& folder) {
  Files files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    // Whoever holds a lock notes in it how far it is, by the clock.
    const bool is_lock = entry.path().extension() == ".lock";
    files[entry.path().lexically_relative(folder)] = is_lock ? std::string() : test::slurp(entry.path());
  }
  return files;
}

std::string without_times(std::string text) {
  for (const std::string marker :
       {"\"seconds\":", "\"plan_seconds\":", "\"microseconds_per_sample\":", "\"compute_us\":", "\"compute_mean_us\":",
        "\"compute_max_us\":", "planned in ", " evaluations in ", " of the chart in ", " removed; ", " runs, ",
        "\"created\":\""}) {
    for (std::size_t at = text.find(marker); at != std::string::npos; at = text.find(marker, at + 1)) {
      const std::size_t begin = at + marker.size();
      text.erase(begin, text.find_first_not_of(" :.0123456789e+-", begin) - begin);
    }
  }
  return text;
}

void restore(const fs::path& folder, const Files& files) {
  const Files now = files_of(folder);
  for (const auto& [name, content] : now) {
    if (!files.contains(name)) fs::remove(folder / name);
  }
  for (const auto& [name, content] : files) {
    const auto there = now.find(name);
    if (there != now.end() && there->second == content) continue;
    fs::create_directories((folder / name).parent_path());
    std::ofstream(folder / name, std::ios::binary) << content;
  }
}

Place::Place(Programs programs, const fs::path& base) : programs_(std::move(programs)) {
  fs::create_directories(base / "work");
  base_ = fs::canonical(base);
  folder_ = base_ / "work";
  report_ = map_report(base_ / "report");
  const rlimit none = {0, 0};  // no core dump of each signal that is found
  ::setrlimit(RLIMIT_CORE, &none);
}

Place::~Place() {
  ::munmap(report_, sizeof(Report));
}

std::vector<std::string> Place::words(const std::string& arguments, const Fault& fault, bool count_stdout) {
  clear(*report_);
  std::string environment = "LD_PRELOAD=" + programs_.shim.string() + " " + report_variable + "=" +
                            (base_ / "report").string() + " " + folder_variable + "=" + folder_.string() + " " +
                            fault_variable + "=" + std::to_string(static_cast<int>(fault.kind)) + ":" +
                            std::to_string(fault.n);
  if (count_stdout) environment += std::string(" ") + stdout_variable + "=1";
  return words_of(command(arguments, environment));
}

Outcome Place::counted() const {
  Outcome outcome;
  for (std::size_t i = 0; i < kind_count; ++i) outcome.calls.at(i) = report_->calls.at(i);
  outcome.reached = report_->reached > 0;
  outcome.call = static_cast<Call>(report_->call.load());
  outcome.file = report_->file.data();
  outcome.unsynced_files = report_->unsynced_files;
  outcome.unsynced_folders = report_->unsynced_folders;
  return outcome;
}

Outcome Place::run(const std::string& arguments, const Fault& fault, bool count_stdout) {
  const Outcome end = ended(words(arguments, fault, count_stdout), base_ / "out.txt");
  Outcome outcome = counted();
  outcome.exit = end.exit;
  outcome.err = end.err;
  outcome.out = test::slurp(base_ / "out.txt");
  return outcome;
}

Outcome Place::run_onto(const std::string& arguments, const fs::path& device) {
  return ended(words_of(command(arguments, "")), device);
}

Outcome Place::run_killed(const std::string& arguments, double after_s) {
  test::Process process(words_of(command(arguments, "")), base_ / "out.txt", base_ / "err.txt");
  std::this_thread::sleep_for(std::chrono::duration<double>(after_s));
  process.signal(SIGKILL);
  Outcome outcome;
  outcome.exit = process.wait();
  outcome.err = test::slurp(base_ / "err.txt");
  return outcome;
}

std::string Place::command(const std::string& arguments, const std::string& environment) const {
  return "env -C " + folder_.string() + " " + environment + " " + programs_.robomill.string() + " " + arguments +
         " --threads 1";
}

Outcome Place::ended(std::vector<std::string> words, const fs::path& out) {
  words.insert(words.begin(), {"timeout", "--signal=KILL", most_seconds});
  test::Process process(std::move(words), out, base_ / "err.txt");
  Outcome outcome;
  outcome.exit = process.wait();
  outcome.err = test::slurp(base_ / "err.txt");
  return outcome;
}

}  // namespace robomill::faults
