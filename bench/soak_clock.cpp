// Loaded before all others (LD_PRELOAD): the clocks of a program jump and slew as those of a badly kept machine do. The
// wall clock lies an hour ahead and an hour behind for ten seconds each; the steady clock runs up to 500 ppm fast and
// slow, the most that NTP slews by.
#include <dlfcn.h>

#include <cmath>
#include <ctime>
#include <numbers>

namespace {

constexpr long jump_s = 3600, jump_lasts_s = 10, slew_period_s = 60;
constexpr double slew = 500e-6, ns_per_s = 1e9;

void add(timespec& time, double seconds) {
  const double ns = static_cast<double>(time.tv_nsec) + ns_per_s * seconds;
  const double carry_s = std::floor(ns / ns_per_s);
  time.tv_sec += static_cast<time_t>(carry_s);
  time.tv_nsec = static_cast<long>(ns - ns_per_s * carry_s);
}

}  // namespace

extern "C" __attribute__((visibility("default"))) int clock_gettime(clockid_t clock, timespec* time) {
  using Call = int (*)(clockid_t, timespec*);
  static const Call real = reinterpret_cast<Call>(::dlsym(RTLD_NEXT, "clock_gettime"));
  const int result = real(clock, time);
  if (result != 0) return result;
  if (clock == CLOCK_MONOTONIC) {
    // Its derivative is 1 + slew * cos: the clock still runs forward.
    const double in_period_s =
        static_cast<double>(time->tv_sec % slew_period_s) + 1e-9 * static_cast<double>(time->tv_nsec);
    const double omega_per_s = 2.0 * std::numbers::pi / static_cast<double>(slew_period_s);
    add(*time, slew / omega_per_s * std::sin(omega_per_s * in_period_s));
  } else if (clock == CLOCK_REALTIME) {
    const long phase = time->tv_sec / jump_lasts_s % 3;
    time->tv_sec += phase == 0 ? 0 : (phase == 1 ? jump_s : -jump_s);
  }
  return result;
}
