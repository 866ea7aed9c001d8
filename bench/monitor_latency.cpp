// What a hop of 256 samples at 10,240 Hz costs over many of them, one thread: the streamed transform into 16 bands with
// their entropy, and ChatterMonitor of each kind; by the processor's time and by the clock.
//   monitor_latency [--hops 40000] [--channels 1] [--rotation 80]
// With more channels: one monitor of them all, and as many monitors of one channel, a hop of all of them at a time.
// Prints a table, what a channel holds in memory, and the histograms as CSV for latency_histogram.py.
#include <fmt/core.h>
#include <malloc.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "robomill/monitor/entropy.hpp"
#include "robomill/monitor/monitor.hpp"
#include "robomill/signal/synchrosqueeze.hpp"
#include "testing/monitor/signal.hpp"

namespace {

using namespace robomill;
using monitor::ChatterMonitor;
using monitor::Kind;

constexpr std::size_t hop = 256, bands = 16;
constexpr double rate_hz = 10240.0;
constexpr int bins_a_decade = 20;

double processor_us() {
  timespec now = {};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

/// Allocated at present, small blocks and large.
double held_kib() {
  const struct mallinfo2 now = mallinfo2();
  return static_cast<double>(now.uordblks + now.hblkhd) / 1024.0;
}

/// Of the spindle [Hz], and a hint that is off; chatter of the tool, of slow spindles of an arm.
struct Cut {
  double rotation_hz = 80.0;
  [[nodiscard]] double hint_hz() const { return 81.0 / 80.0 * rotation_hz; }
  [[nodiscard]] double chatter_hz() const { return rotation_hz > 45.0 ? 683.0 : 3.4 * rotation_hz; }
};

/// 20 s that join their own beginning: 2 s without a cut, so that each round begins with the search for its speed; then
/// the cut, which chatters from 10 to 14 s.
std::vector<float> rounds(const Cut& cut, int channels) {
  std::vector<float> samples = monitor::testing::vibration({.rotation_hz = cut.rotation_hz,
                                                            .channels = channels,
                                                            .chatter_hz = cut.chatter_hz(),
                                                            .starts_s = 10.0,
                                                            .ends_s = 14.0,
                                                            .seconds = 20.0});
  const auto idle = static_cast<std::ptrdiff_t>(2.0 * rate_hz) * channels;
  std::for_each(samples.begin(), samples.begin() + idle, [](float& sample) { sample *= 0.01F; });
  return samples;
}

struct Costs {
  std::string what = {};
  double kib_a_channel = 0.0;
  std::vector<double> processor_us = {}, clock_us = {};  // rising
};

/// `push(n)` takes the hop number n.
template <class Push>
void measure(Costs& costs, std::size_t hops, const Push& push) {
  costs.processor_us.reserve(hops);
  costs.clock_us.reserve(hops);
  for (std::size_t n = 0; n < hops; ++n) {
    const auto start = std::chrono::steady_clock::now();
    const double start_us = processor_us();
    push(n);
    const double end_us = processor_us();
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - start;
    costs.processor_us.push_back(end_us - start_us);
    costs.clock_us.push_back(took.count());
  }
  std::ranges::sort(costs.processor_us);
  std::ranges::sort(costs.clock_us);
}

/// Hop number n of rounds that follow each other.
template <class Sample>
std::span<const Sample> block_of(const std::vector<Sample>& samples, std::size_t n, int channels = 1) {
  const std::size_t size = hop * static_cast<std::size_t>(channels);
  return std::span(samples).subspan(n % (samples.size() / size) * size, size);
}

Costs transform(const Cut& cut, std::size_t hops) {
  const std::vector<float> given = rounds(cut, 1);
  const std::vector<double> samples(given.begin(), given.end());
  Costs costs = {.what = "transform"};
  const double before_kib = held_kib();
  signal::SynchrosqueezeStream stream({.sample_rate_hz = rate_hz}, signal::equal_bands(rate_hz, bands));
  costs.kib_a_channel = held_kib() - before_kib;
  std::vector<double> out(hop * bands);
  double sum = 0.0;
  measure(costs, hops, [&](std::size_t n) {
    const std::size_t columns = stream.push(block_of(samples, n), out).columns;
    std::array<double, bands> energy = {};
    for (std::size_t m = 0; m < columns; ++m) {
      for (std::size_t b = 0; b < bands; ++b) energy.at(b) += out[m * bands + b] * out[m * bands + b];
    }
    sum += monitor::energy_entropy(energy, monitor::Entropy::normalised);
  });
  if (!std::isfinite(sum)) fmt::print(stderr, "the entropy is not finite\n");
  return costs;
}

monitor::MonitorOptions options(const Cut& cut, Kind kind, int channels) {
  return {.kind = kind,
          .sample_rate_hz = rate_hz,
          .channels = channels,
          .spindle_speed_rad_per_s = 2.0 * std::numbers::pi * cut.hint_hz(),
          .teeth = 3,
          .threshold = 1e9};
}

/// `monitors` of `channels` each.
Costs monitor_costs(const Cut& cut, Kind kind, int monitors, int channels, std::size_t hops) {
  const std::vector<float> samples = rounds(cut, channels);
  const std::string_view name = to_string(kind);
  Costs costs = {.what = monitors * channels == 1 ? std::string(name)
                         : monitors == 1          ? fmt::format("{}, one monitor of {} channels", name, channels)
                                                  : fmt::format("{}, {} monitors of one channel", name, monitors)};
  const double before_kib = held_kib();
  std::vector<ChatterMonitor> all;
  all.reserve(static_cast<std::size_t>(monitors));
  for (int i = 0; i < monitors; ++i) all.emplace_back(options(cut, kind, channels));
  costs.kib_a_channel = (held_kib() - before_kib) / (monitors * channels);
  measure(costs, hops, [&](std::size_t n) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      all[i].push(block_of(samples, n + 37 * i, channels));  // each somewhere else in its round
    }
  });
  return costs;
}

double part(const std::vector<double>& rising, double share) {
  return rising[static_cast<std::size_t>(share * static_cast<double>(rising.size() - 1))];
}

void print_tables(const std::vector<Costs>& all) {
  fmt::print("| | clock | mean, us | median | 99 % | 99.9 % | 99.99 % | longest | KiB a channel |\n");
  fmt::print("|---|---|---|---|---|---|---|---|---|\n");
  for (const Costs& costs : all) {
    for (const auto& [clock, us] : {std::pair("processor", &costs.processor_us), std::pair("wall", &costs.clock_us)}) {
      double sum = 0.0;
      for (const double one : *us) sum += one;
      fmt::print("| {} | {} | {:.0f} | {:.0f} | {:.0f} | {:.0f} | {:.0f} | {:.0f} | {:.0f} |\n", costs.what, clock,
                 sum / static_cast<double>(us->size()), part(*us, 0.5), part(*us, 0.99), part(*us, 0.999),
                 part(*us, 0.9999), us->back(), costs.kib_a_channel);
    }
  }
}

void print_histograms(const std::vector<Costs>& all) {
  fmt::print("\nwhat,clock,from_us,to_us,hops\n");
  for (const Costs& costs : all) {
    for (const auto& [clock, us] : {std::pair("processor", &costs.processor_us), std::pair("wall", &costs.clock_us)}) {
      const auto edge_us = [](int bin) { return std::pow(10.0, static_cast<double>(bin) / bins_a_decade); };
      auto bin = static_cast<int>(std::floor(bins_a_decade * std::log10(std::max(1e-3, us->front()))));
      for (auto from = us->begin(); from != us->end(); ++bin) {
        const auto to = std::lower_bound(from, us->end(), edge_us(bin + 1));
        fmt::print("\"{}\",{},{:.3f},{:.3f},{}\n", costs.what, clock, edge_us(bin), edge_us(bin + 1), to - from);
        from = to;
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::size_t hops = 40'000;
  int channels = 1;
  Cut cut;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string name = argv[i];
    if (name == "--hops") hops = std::strtoull(argv[i + 1], nullptr, 10);
    if (name == "--channels") channels = std::atoi(argv[i + 1]);
    if (name == "--rotation") cut.rotation_hz = std::strtod(argv[i + 1], nullptr);
  }
  if (hops < 1 || channels < 1 || channels > 64 || !(cut.rotation_hz > 0.5 && cut.rotation_hz < 500.0)) {
    fmt::print(
        stderr,
        "usage: monitor_latency [--hops 40000] [--channels 1] [--rotation 80]; at most 64 channels, 0.5 to 500 Hz\n");
    return 2;
  }
  std::vector<Costs> all;
  if (channels == 1) all.push_back(transform(cut, hops));
  for (const Kind kind : {Kind::comb_cusum, Kind::energy_entropy}) {
    all.push_back(monitor_costs(cut, kind, 1, channels, hops));
    if (channels > 1) all.push_back(monitor_costs(cut, kind, channels, 1, hops));
  }
  print_tables(all);
  print_histograms(all);
  return 0;
}
