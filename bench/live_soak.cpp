// robomill monitor on a day of samples that come through a pipe as fast as it takes them, while what stands around it
// fails again and again: the broker of its events is killed, the disk is full, the clocks jump and slew, the spindle
// stands still, the sensor goes dead or sends nothing. Ends with 1 where an event is missing, an alarm is late or
// false, or the memory grows.
//   live_soak [hours 24]
#include <fcntl.h>
#include <fmt/core.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <mutex>
#include <nlohmann/json.hpp>
#include <numbers>
#include <stop_token>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include "robomill/base/random.hpp"
#include "testing/processes.hpp"

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using robomill::Random;

constexpr int rate_hz = 5120;
constexpr double turning_rpm = 3000.0, standing_rpm = 0.05, chatter_hz = 683.0;
// A cycle of the machine [s].
constexpr int cycle_s = 600, cut_from_s = 20, chatter_from_s = 200, chatter_to_s = 208, dead_from_s = 300,
              not_finite_from_s = 305, heals_s = 306, pause_at_s = 400;
constexpr double longest_delay_s = 1.0;
constexpr double most_growth_kib = 2048.0;  // after the first tenth

/// A second of samples, periodic (fifty revolutions), as lines of acceleration and spindle speed.
using Second = std::string;
constexpr const char* header = "ax_m_per_s2,spindle_speed_rpm\n";

/// Two teeth at 3000 rpm, noise, and chatter that grows from zero or stands.
Second second_of(Random& random, double rpm, double chatter, bool grows) {
  Second out;
  for (int i = 0; i < rate_hz; ++i) {
    const double t = static_cast<double>(i) / rate_hz;
    double x = 0.3 * random.normal();
    for (int k = 1; k <= 6 && rpm > standing_rpm; ++k)
      x += 4.0 / k * std::sin(2.0 * std::numbers::pi * 50.0 * k * t + k);
    const double size = grows ? std::min(chatter, 0.02 * std::exp(t / 0.05)) : chatter;
    x += size * std::sin(2.0 * std::numbers::pi * chatter_hz * t);
    out += fmt::format("{:.4f},{}\n", x, rpm);
  }
  return out;
}

/// The seconds that a cycle is put together from, several of each kind.
class Machine {
 public:
  explicit Machine(std::uint64_t seed) : random_(seed) {
    for (std::size_t i = 0; i < kinds; ++i) {
      standing_[i] = second_of(random_, standing_rpm, 0.0, false);
      stable_[i] = second_of(random_, turning_rpm, 0.0, false);
      chatter_[i] = second_of(random_, turning_rpm, 20.0, false);
    }
    growing_ = second_of(random_, turning_rpm, 20.0, true);
    for (int i = 0; i < rate_hz; ++i) {
      dead_ += fmt::format("0,{}\n", turning_rpm);
      not_finite_ += fmt::format("nan,{}\n", turning_rpm);
    }
  }
  const Second& at(int second) {
    const int phase = second % cycle_s;
    const auto kind = static_cast<std::size_t>(random_.index(kinds));
    if (phase < cut_from_s) return standing_[kind];
    if (phase == chatter_from_s) return growing_;
    if (phase > chatter_from_s && phase < chatter_to_s) return chatter_[kind];
    if (phase >= dead_from_s && phase < not_finite_from_s) return dead_;
    if (phase >= not_finite_from_s && phase < heals_s) return not_finite_;
    return stable_[kind];
  }

 private:
  static constexpr std::size_t kinds = 16;
  Random random_;
  std::array<Second, kinds> standing_, stable_, chatter_;
  Second growing_, dead_, not_finite_;
};

/// Has something done again and again while it lives.
class Again {
 public:
  /// @param act  true begins a fault, false ends it
  Again(std::chrono::milliseconds well, std::chrono::milliseconds ill, std::function<void(bool)> act)
      : thread_([this, well, ill, act = std::move(act)](const std::stop_token& stop) {
          while (wait(stop, well)) {
            act(true);
            wait(stop, ill);
            act(false);
            ++count_;
          }
        }) {}
  [[nodiscard]] int count() const { return count_; }

 private:
  bool wait(const std::stop_token& stop, std::chrono::milliseconds time) {
    std::unique_lock lock(mutex_);
    ended_.wait_for(lock, stop, time, [] { return false; });
    return !stop.stop_requested();
  }

  std::mutex mutex_;
  std::condition_variable_any ended_;
  std::atomic<int> count_{0};
  std::jthread thread_;
};

/// Of a process [KiB].
double resident_kib(pid_t pid) {
  std::ifstream status(fmt::format("/proc/{}/status", pid));
  std::string word;
  double kib = 0.0;
  while (status >> word) {
    if (word == "VmRSS:") status >> kib;
  }
  return kib;
}

bool write_whole(int pipe, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(pipe, text.data(), text.size());
    if (written <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

/// What the monitor wrote of a day.
struct Found {
  int lines = 0, broken = 0, started = 0, back_in_time = 0, lost = 0, not_saved = 0, saved = 0;
  int alarms = 0, false_alarms = 0, standstills = 0, no_signals = 0, recordings = 0, recordings_failed = 0;
  int connections_lost = 0;
  double longest_delay_s = 0.0;
};

Found found_in(const fs::path& events) {
  Found out;
  std::ifstream file(events);
  double last_s = 0.0;
  std::string state, reason;
  for (std::string line; std::getline(file, line);) {
    ++out.lines;
    const json event = json::parse(line, nullptr, false);
    if (event.is_discarded()) {
      ++out.broken;
      continue;
    }
    const double time_s = event.value("time_s", -1.0);
    if (time_s < last_s) ++out.back_in_time;
    last_s = time_s;
    const std::string kind = event.at("event"), what = event.value("what", "");
    if (kind == "started") ++out.started;
    if (kind == "recording") ++out.recordings;
    if (what == "events-lost") ++out.lost;
    if (what == "events-not-saved") ++out.not_saved;
    if (what == "events-saved") ++out.saved;
    if (what == "recording-failed") ++out.recordings_failed;
    if (what == "broker-lost") ++out.connections_lost;
    if (kind != "state") continue;
    const std::string now = event.at("state"), why = event.at("reason").is_null() ? "" : event.at("reason");
    if (now == "chatter" && state != "chatter") {
      const double delay_s = std::fmod(time_s, cycle_s) - chatter_from_s;
      const bool is_true = delay_s >= 0.0 && delay_s < chatter_to_s - chatter_from_s;
      ++(is_true ? out.alarms : out.false_alarms);
      if (is_true) out.longest_delay_s = std::max(out.longest_delay_s, delay_s);
    }
    if (now == "blind" && (state != "blind" || why != reason)) {
      out.standstills += why == "standstill" ? 1 : 0;
      out.no_signals += why == "no-signal" ? 1 : 0;
    }
    state = now;
    reason = why;
  }
  return out;
}

int lines_of(const fs::path& path) {
  std::ifstream file(path);
  int count = 0;
  for (std::string line; std::getline(file, line);) count += line.find(" s  ") != std::string::npos ? 1 : 0;
  return count;
}

bool demand(bool so, const std::string& what) {
  fmt::print("{}: {}\n", so ? "ok" : "VIOLATED", what);
  return so;
}

}  // namespace

int main(int argc, char** argv) {
  const double hours = argc > 1 ? std::atof(argv[1]) : 24.0;
  const int cycles = std::max(1, static_cast<int>(std::lround(3600.0 * hours / cycle_s)));
  const int seconds = cycles * cycle_s;
  const fs::path folder = fs::temp_directory_path() / fmt::format("robomill_live_soak_{}", ::getpid());
  fs::create_directories(folder);
  std::signal(SIGPIPE, SIG_IGN);
  robomill::test::Mosquitto broker(folder);
  std::ofstream(folder / "monitor.toml") << fmt::format(
      "[signal]\nsample_rate_hz = {}\nchannels = [\"ax_m_per_s2\"]\nanti_alias_filter = true\n"
      "[process]\nteeth = 2\n[mqtt]\nport = {}\nevents_topic = \"cell/events\"\n"
      "[recording]\nfolder = \"alarms\"\nseconds = 5\n",
      rate_hz, broker.port());
  const fs::path pipe = folder / "samples", events = folder / "events.jsonl";
  if (::mkfifo(pipe.c_str(), 0600) != 0) return 1;
  robomill::test::Process monitor(
      {"env", "LD_PRELOAD=" ROBOMILL_SOAK_CLOCK, ROBOMILL_PROGRAM, "monitor", (folder / "monitor.toml").string(),
       "--input", pipe.string(), "--format", "csv", "-o", events.string()},
      folder / "out.txt", folder / "err.txt");
  const int to = ::open(pipe.c_str(), O_WRONLY | O_CLOEXEC);
  write_whole(to, header);
  const auto file_size = [&monitor](rlim_t most) {
    const rlimit limit{most, RLIM_INFINITY};
    ::prlimit(monitor.pid(), RLIMIT_FSIZE, &limit, nullptr);
  };
  const auto begun = std::chrono::steady_clock::now();
  double after_tenth_kib = 0.0, most_kib = 0.0;
  int broker_faults = 0, disk_faults = 0;
  fmt::print("| simulated, h | resident, KiB | clock, s |\n|---|---|---|\n");
  {
    const Again broken_broker(std::chrono::seconds(5), std::chrono::seconds(2),
                              [&](bool begins) { begins ? broker.stop() : broker.start(); });
    // The next line is cut off in its middle.
    const Again full_disk(std::chrono::seconds(3), std::chrono::milliseconds(1500), [&](bool begins) {
      std::error_code none;
      file_size(begins ? fs::file_size(events, none) + 40 : RLIM_INFINITY);
    });
    Machine machine(7);
    for (int second = 0; second < seconds; ++second) {
      if (second % cycle_s == pause_at_s) std::this_thread::sleep_for(std::chrono::milliseconds(1500));
      if (!write_whole(to, machine.at(second))) break;
      const double kib = second % 60 == 0 ? resident_kib(monitor.pid()) : 0.0;
      if (second == seconds / 10 / 60 * 60) after_tenth_kib = kib;
      most_kib = std::max(most_kib, kib);
      if (second % 3600 != 0) continue;
      const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begun;
      fmt::print("| {} | {:.0f} | {:.0f} |\n", second / 3600, kib, taken.count());
      std::fflush(stdout);
    }
    broker_faults = broken_broker.count();
    disk_faults = full_disk.count();
  }
  file_size(RLIM_INFINITY);
  ::close(to);
  const int exit = monitor.wait();
  const Found found = found_in(events);
  fmt::print(
      "{} lines of events, {} recordings ({} failed), broker killed {} times ({} times as the events say), disk "
      "full {} times (not saved {}, saved again {})\n",
      found.lines, found.recordings, found.recordings_failed, broker_faults, found.connections_lost, disk_faults,
      found.not_saved, found.saved);
  bool good = demand(exit == 0, fmt::format("exit code {}", exit));
  good &= demand(found.broken == 0 && found.started == 1 && found.back_in_time == 0 && found.lost == 0,
                 fmt::format("{} broken lines, {} \"started\", {} back in time, {} of lost events", found.broken,
                             found.started, found.back_in_time, found.lost));
  good &= demand(found.lines - 1 == lines_of(folder / "out.txt"),
                 fmt::format("events saved and shown: {} and {}", found.lines - 1, lines_of(folder / "out.txt")));
  good &= demand(found.alarms == cycles && found.longest_delay_s <= longest_delay_s,
                 fmt::format("{} alarms of {} cuts that chatter, {:.3f} s after they begin at most", found.alarms,
                             cycles, found.longest_delay_s));
  good &= demand(found.false_alarms == 0, fmt::format("{} false alarms", found.false_alarms));
  good &= demand(found.standstills == cycles && found.no_signals >= 2 * cycles,
                 fmt::format("blind: {} times standstill, {} times no signal", found.standstills, found.no_signals));
  good &= demand(most_kib - after_tenth_kib < most_growth_kib,
                 fmt::format("resident memory {:.0f} KiB after a tenth, {:.0f} at most", after_tenth_kib, most_kib));
  if (good)
    fs::remove_all(folder);
  else
    fmt::print("left in {}\n", folder.string());
  return good ? 0 : 1;
}
