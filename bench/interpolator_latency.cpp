// How long PathInterpolator::next() takes over many samples, inverse kinematics of a 6R arm included, while another
// thread plans: mean, 99.99th percentile and maximum by the wall clock, and the memory held.
//   interpolator_latency [samples = 10000000]
// The maximum is the operating system's: run it on an idle core, with a real-time priority if that is of interest.
#include <fmt/core.h>
#include <sys/resource.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <thread>
#include <vector>

#include "testing/path/ride.hpp"
#include "testing/path/winding.hpp"

namespace {

using namespace robomill;
using Clock = std::chrono::steady_clock;

constexpr double bin_ns = 20.0;
constexpr std::size_t bins = 100'000;  // up to 2 ms

std::uint64_t nanoseconds(Clock::duration duration) {
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(duration).count());
}

double percentile_us(const std::vector<std::uint64_t>& histogram, std::uint64_t samples, double share) {
  const auto above = static_cast<std::uint64_t>(static_cast<double>(samples) * (1.0 - share));
  std::uint64_t sum = 0;
  for (std::size_t i = bins; i-- > 0;) {
    sum += histogram[i];
    if (sum > above) return 1e-3 * bin_ns * static_cast<double>(i + 1);
  }
  return 0.0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t samples = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 10'000'000;
  const auto machine = path::test::make_machine(path::test::Machine::kr210);
  program::Program some{.start = path::test::Winding::start(), .blocks = {}};
  for (path::test::Winding winding; winding.taken() < 5000; winding.take()) some.blocks.push_back(winding.block());
  const path::Posture posture = path::test::posture_for(some, *machine);
  path::PathInterpolator interpolator(*machine, path::test::published_options(path::Method::verified), some.start,
                                      posture.gamma_rad[0], posture.start);
  std::atomic<bool> done{false};
  std::thread reader([&] {
    for (path::test::Winding winding; !done.load();) {
      if (interpolator.push(winding.block()).accepted()) {
        winding.take();
      } else {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    }
  });
  std::vector<std::uint64_t> histogram(bins, 0);
  std::uint64_t sum_ns = 0, longest_ns = 0, running = 0;
  path::Sample sample;
  for (std::uint64_t n = 0; n < samples;) {
    if (interpolator.ready_s() < 1.0) {  // the machine would be this slow: it takes its samples by the clock
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      if (interpolator.ready_s() > 0.0) continue;
    }
    const Clock::time_point begin = Clock::now();
    const auto state = interpolator.next(sample);
    const std::uint64_t ns = nanoseconds(Clock::now() - begin);
    if (state != path::PathInterpolator::State::running) continue;
    ++n;
    ++running;
    sum_ns += ns;
    longest_ns = std::max(longest_ns, ns);
    ++histogram[std::min(bins - 1, static_cast<std::size_t>(static_cast<double>(ns) / bin_ns))];
  }
  done = true;
  reader.join();
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  fmt::print(
      "{} samples, {:.0f} s of motion: mean {:.2f} us, median {:.2f}, 99.99 % below {:.2f}, longest {:.1f} us; "
      "{:.1f} MB resident\n",
      running, sample.time_s, 1e-3 * static_cast<double>(sum_ns) / static_cast<double>(running),
      percentile_us(histogram, running, 0.5), percentile_us(histogram, running, 0.9999),
      1e-3 * static_cast<double>(longest_ns), 1e-3 * static_cast<double>(usage.ru_maxrss));
  return 0;
}
