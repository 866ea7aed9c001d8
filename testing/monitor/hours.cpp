#include "testing/monitor/hours.hpp"

#include <cmath>
#include <numbers>

#include "testing/monitor/corpus.hpp"

namespace robomill::monitor::testing {
namespace {

using std::numbers::pi;

constexpr std::size_t noise_size = std::size_t{1} << 21;

}  // namespace

StableHours::StableHours(std::uint64_t seed, double hours, int bank, int teeth)
    : random_(seed, 11), wanted_(static_cast<std::uint64_t>(hours * 3600.0 * corpus_rate_hz)) {
  for (std::uint64_t k = 0; bank_.size() < static_cast<std::size_t>(bank); ++k) {
    Random random(seed, 1000 + k);
    Entry entry;
    entry.plan = stable_plan(k % 5 == 4, random.uniform(3.0, 6.0), random);
    if (teeth > 0 && entry.plan.teeth() != teeth) continue;
    entry.clean = simulate(entry.plan);
    if (entry.clean.diverged || !settles(entry.plan, entry.clean)) continue;
    entry.level = reference_level(entry.plan, entry.clean);
    // Of a long bank only what is joined is kept.
    CleanCut& clean = entry.clean;
    for (CleanCut::Columns* unused :
         {&clean.displacement_m, &clean.forced_displacement_m, &clean.force_n, &clean.forced_force_n}) {
      unused->resize(0, 2);
    }
    bank_.push_back(std::move(entry));
  }
  noise_.resize(noise_size);
  double red = 0.0;
  for (float& v : noise_) {
    red = 0.98 * red + 0.2 * random_.normal();
    v = static_cast<float>(0.85 * random_.normal() + 0.5 * red);
  }
}

std::span<const float> StableHours::next() {
  if (frames_ >= wanted_) return {};
  current_ = random_.index(bank_.size());
  const Entry& entry = bank_[current_];
  hint_ = static_cast<double>(entry.clean.speed_rad_per_s.front()) * random_.uniform(0.97, 1.03);
  const auto cut = static_cast<std::size_t>(entry.clean.acceleration_m_per_s2.rows());
  const auto idle = static_cast<std::size_t>(random_.uniform(0.0, 1.5) * corpus_rate_hz);
  samples_.assign(2 * (idle + cut), 0.0F);
  for (std::size_t i = 0; i < cut; ++i) {
    for (std::size_t c = 0; c < 2; ++c) {
      samples_[2 * (idle + i) + c] = static_cast<float>(
          entry.clean.acceleration_m_per_s2(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(c)));
    }
  }
  add_disturbances(entry, idle + cut);
  frames_ += idle + cut;
  return samples_;
}

void StableHours::add_disturbances(const Entry& entry, std::size_t frames) {
  const auto noise = static_cast<float>(entry.level * 0.05 * std::exp(random_.uniform(0.0, std::log(8.0))));
  const double hum = entry.level * random_.uniform(0.01, 0.1), hum_turn = 2.0 * pi * 50.0 / corpus_rate_hz;
  const double swing = random_.uniform(0.0, 0.25), swing_turn = 2.0 * pi / (random_.uniform(2.0, 8.0) * corpus_rate_hz);
  const double phase = random_.uniform(0.0, 2.0 * pi);
  for (std::size_t c = 0; c < 2; ++c) {
    // Two places of the table, far apart in turns that never come back together.
    std::size_t a = random_.index(noise_size), b = random_.index(noise_size);
    const double hum_phase = random_.uniform(0.0, 2.0 * pi);
    double level_hum = 0.0, gain = 1.0;
    for (std::size_t i = 0; i < frames; ++i) {
      const auto t = static_cast<double>(i);
      level_hum = hum * std::sin(hum_turn * t + hum_phase);
      if (i % 64 == 0) gain = 1.0 + swing * std::sin(swing_turn * t + phase);
      a = (a + 1) % noise_size;
      b = (b + 1) % noise_size;
      const float sum = samples_[2 * i + c] + 0.7071F * noise * (noise_[a] + noise_[b]) + static_cast<float>(level_hum);
      samples_[2 * i + c] = static_cast<float>(gain) * sum;
    }
  }
  const double seconds = static_cast<double>(frames) / corpus_rate_hz;
  for (double t = -std::log(1.0 - random_.uniform()) / 0.3; t < seconds; t -= std::log(1.0 - random_.uniform()) / 0.3) {
    add_knock(entry.plan.structure(), entry.level * std::exp(random_.uniform(0.0, std::log(10.0))), t, random_,
              samples_);
  }
}

}  // namespace robomill::monitor::testing
