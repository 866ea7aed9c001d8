#include "terminal.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>

#include "robomill/base/printable.hpp"

namespace robomill::app {
namespace {

std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may only touch lock-free atomics");

extern "C" void on_signal(int number) {
  stop = true;
  std::signal(number, SIG_DFL);
}

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

const std::atomic<bool>& stop_on_signal() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  return stop;
}

void print_notes(const std::vector<std::string>& notes, std::string_view label) {
  for (const std::string& note : notes) fmt::print("{}{}\n", label, printable(note));
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
