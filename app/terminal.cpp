#include "terminal.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <string_view>

#include "robomill/base/error.hpp"
#include "robomill/base/printable.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/system/pending_names.hpp"
#include "robomill/io/text.hpp"

namespace robomill::app {
namespace {

/// How long a verb may take to end by itself: within a second all is over.
constexpr double patience_s = 0.8;
constexpr std::string_view bar_away = "\r\033[K";

std::atomic<bool> stop{false};
std::atomic<int> stop_signal{0};
timer_t patience = {};
std::atomic<bool> has_patience{false}, to_terminal{false};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free,
              "a signal handler may only touch lock-free atomics");

// What follows, up to set_handler, runs in signal handlers: nothing in it may allocate, lock or throw.

void end_after(double seconds) noexcept {
  if (!has_patience) return;
  itimerspec when = {};
  when.it_value.tv_sec = static_cast<time_t>(seconds);
  when.it_value.tv_nsec = static_cast<long>(1e9 * (seconds - static_cast<double>(when.it_value.tv_sec)));
  ::timer_settime(patience, 0, &when, nullptr);
}

extern "C" [[noreturn]] void end_now(int number) {
  int none = 0;
  stop_signal.compare_exchange_strong(none, number);
  constexpr std::string_view after_bar = "\r\033[Krobomill: interrupted\n";
  const std::string_view text = to_terminal ? after_bar : after_bar.substr(bar_away.size());
  io::remove_pending_files();
  if (::write(STDERR_FILENO, text.data(), text.size()) < 0) {
    // Nobody reads it.
  }
  ::_exit(exit_of_signal());
}

extern "C" void on_signal(int number) {
  const int error = errno;
  int none = 0;
  if (!stop_signal.compare_exchange_strong(none, number)) end_now(number);
  stop = true;
  end_after(patience_s);
  errno = error;
}

/// Who read standard output has seen enough: the process ends as it would have, but leaves nothing half-written.
extern "C" void on_broken_pipe(int number) {
  io::remove_pending_files();
  struct sigaction action = {};
  action.sa_handler = SIG_DFL;
  ::sigaction(number, &action, nullptr);
  ::raise(number);  // once this returns
}

void set_handler(int number, void (*handler)(int)) {
  struct sigaction old = {};
  // What the caller ignores stays ignored: nohup, a shell's background.
  if (number != SIGALRM && ::sigaction(number, nullptr, &old) == 0 && old.sa_handler == SIG_IGN) return;
  struct sigaction action = {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  ::sigaction(number, &action, nullptr);
}

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

const std::atomic<bool>& stop_on_signal() {
  static const bool set = [] {
    sigevent event = {};
    event.sigev_notify = SIGEV_SIGNAL;
    event.sigev_signo = SIGALRM;
    to_terminal = isatty(STDERR_FILENO) != 0;
    set_handler(SIGALRM, end_now);
    sigset_t alarm;
    ::sigemptyset(&alarm);
    ::sigaddset(&alarm, SIGALRM);
    ::pthread_sigmask(SIG_UNBLOCK, &alarm, nullptr);
    has_patience = ::timer_create(CLOCK_MONOTONIC, &event, &patience) == 0;
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) set_handler(number, on_signal);
    set_handler(SIGPIPE, on_broken_pipe);
    set_handler(SIGXFSZ, SIG_IGN);  // a write beyond the limit of files' sizes fails, as on a full disk
    return true;
  }();
  static_cast<void>(set);
  return stop;
}

bool is_html(const std::filesystem::path& path) {
  return io::lowered(path.extension().string()) == ".html";
}

void require_report_place(const std::filesystem::path& path) {
  if (path.empty() || is_html(path) || io::format_of(path) == io::Format::json) return;
  throw InvalidInput(path.string(), "a report is written as .html or .json");
}

void write_report(const std::filesystem::path& path, const page::Report& page, const std::string& json) {
  io::write_file(path, is_html(path) ? page::report_html(page) : json.empty() ? page::report_json(page) : json);
}

Exit exit_of(const std::string& shortfall) {
  if (shortfall.empty()) return done;
  fmt::print(stderr, "robomill: {}\n", printable(shortfall));
  return not_reached;
}

int exit_of_signal() noexcept {
  return 128 + stop_signal;
}

void take_time_to_end(double seconds) noexcept {
  if (stop) end_after(seconds);
}

ProgressBar::ProgressBar(bool quiet)
    : progress_(
          quiet || isatty(STDERR_FILENO) == 0
              ? Progress::Report{}
              : [this](const std::string& task, double fraction) { draw(task, fraction); },
          &stop_on_signal()) {}

ProgressBar::~ProgressBar() {
  if (visible_) std::fputs("\r\033[K", stderr);
}

void ProgressBar::draw(const std::string& task, double fraction) {
  const double now = now_s();
  if (fraction == 0.0) started_s_ = now;
  const double elapsed = now - started_s_;
  if (elapsed < 1.0 || now - drawn_s_ < 0.1) return;
  drawn_s_ = now;
  visible_ = true;
  constexpr int width = 30;
  const int filled = static_cast<int>(fraction * width);
  const double left_s = fraction > 0.0 ? elapsed * (1.0 - fraction) / fraction : 0.0;
  fmt::print(stderr, "\r\033[K{} [{:#<{}}{:.<{}}] {:3.0f} %, {:.0f} s left", task, "", filled, "", width - filled,
             100.0 * fraction, left_s);
  std::fflush(stderr);
}

}  // namespace robomill::app
