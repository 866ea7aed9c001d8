#include "robomill/monitor/comb_cusum/comb_cusum.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace robomill::monitor {
namespace {

constexpr double dying = 0.3;         // fall of a log energy that no growing chatter shows
constexpr double died = 4.0;          // fall of a log energy at which chatter is over
constexpr double faint = 1.5;         // height over the baseline at which it is over, too
constexpr double fainter = 1.0;       // and fall from its highest
constexpr double broad_height = 1.2;  // of the median line: entry, exit
constexpr std::size_t broad_hops = 3;
constexpr std::size_t calm_hops = 2;
constexpr double lowest_line_hz = 90.0;  // mains hum lies below
constexpr double entry_width_hz = 6.0;   // by which a line misses its harmonic while the tool enters
constexpr double highest_of_rotation = 5.5, highest_of_teeth = 6.0;  // orders that a hint resolves
constexpr double highest_of_unknown_teeth = 12.0;                    // three of four teeth

}  // namespace

double CombCusum::line_hz(std::size_t line) const noexcept {
  return static_cast<double>(line) * options_.sample_rate_hz / static_cast<double>(2 * (lines_ - 1));
}

double CombCusum::power() const noexcept {
  return std::accumulate(power_.begin(), power_.end(), 0.0);
}

double CombCusum::energy_of_power() const noexcept {
  const double n = static_cast<double>(2 * (lines_ - 1));
  return 2.0 * columns_a_hop * n * n;
}

double CombCusum::level(std::size_t line) const noexcept {
  return history_[hops_ % kept * lines_ + line];
}

void CombCusum::judge(Decision& decision) noexcept {
  const Cusum::Verdict verdict = lines_test_.step(energy_, taken_, {falls_.get(), channels_});
  double* now = history_.data() + hops_ % kept * lines_;
  for (std::size_t k = 0; k < lines_; ++k) {
    now[k] = -1e9;
    for (std::size_t c = 0; c < channels_; ++c) now[k] = std::max(now[k], lines_test_.log_energy(c, k));
  }
  const bool alone = process_narrowband();
  if (state_ == State::chatter) {
    in_chatter();
  } else {
    in_cut(verdict, alone);
  }
  if (state_ != State::chatter && trusted()) lines_test_.learn();
  decision.state = state_;
  decision.score = alone ? std::max(verdict.score, 1.001 * lines_test_.threshold()) : verdict.score;
  decision.threshold = lines_test_.threshold();
  decision.channel = static_cast<int>(channel_);
  if (state_ != State::stable) report_frequency(decision);
}

// A multiple of rotation or of tooth passing, at a speed near the given one; high orders lie too close together.
bool CombCusum::may_be_the_cut(double frequency_hz) const noexcept {
  const double near_hz = spindle_.expected_hz();
  if (near_hz <= 0.0) return true;
  const auto multiple = [&](double of_hz, double highest) {
    const double order = frequency_hz / of_hz;
    return order < highest &&
           std::abs(order - std::round(order)) < SpindleTracker::hint_share * order + 0.5 * line_hz(1) / of_hz;
  };
  if (options_.teeth == 0) return multiple(near_hz, highest_of_unknown_teeth);
  return multiple(near_hz, highest_of_rotation) || multiple(near_hz * options_.teeth, highest_of_teeth);
}

bool CombCusum::near_a_harmonic(double frequency_hz) const noexcept {
  return std::abs(std::remainder(frequency_hz, spindle_.rotation_hz() * std::max(1, options_.teeth))) < entry_width_hz;
}

bool CombCusum::process_narrowband() noexcept {
  std::size_t line = 0;
  double most = 0.0;
  for (std::size_t k = 2; k + 1 < lines_; ++k) {
    if (line_hz(k) < lowest_line_hz) continue;
    double energy = 0.0;
    for (std::size_t c = 0; c < channels_; ++c)
      energy += std::max(0.0, energy_[c * lines_ + k] - taken_[c * lines_ + k]);
    if (energy > most) {
      most = energy;
      line = k;
    }
  }
  // The transform looks at two hops.
  const double now = power() + 1e-300;
  const double whole = 0.5 * (now + power_before_);
  power_before_ = now;
  // Without a comb the residual is the whole; each line is summed thrice.
  const double energy =
      comb_known() ? whole * energy_of_power() : std::accumulate(energy_.begin(), energy_.end(), 1e-300) / 3.0;
  return narrowband_.step({.line = line,
                           .share = most / energy,
                           .power = whole,
                           .comb_known = comb_known(),
                           .falls = std::all_of(falls_.get(), falls_.get() + channels_, [](bool each) { return each; }),
                           .may_be_the_cut = may_be_the_cut(line_hz(line))});
}

void CombCusum::begin_chatter(bool above_baseline) noexcept {
  state_ = State::chatter;
  above_baseline_ = above_baseline;
  highest_ = level(line_);
  calm_ = 0;
}

void CombCusum::in_cut(const Cusum::Verdict& verdict, bool at_once) noexcept {
  const double threshold = lines_test_.threshold();
  if (at_once && away_ == 0 && speed_holds()) {
    line_ = narrowband_.line();
    begin_chatter(false);
    return;
  }
  if (!trusted()) {
    lines_test_.relearn();
    state_ = State::stable;
    broad_ = 0;
    return;
  }
  broad_ = std::abs(verdict.common) > broad_height ? broad_ + 1 : 0;
  if (broad_ >= broad_hops && verdict.score < threshold) {
    lines_test_.relearn();
    broad_ = 0;
    state_ = State::stable;
    return;
  }
  double before = -1e9;
  for (std::size_t i = 0; i < kept; ++i) before = std::max(before, history_[i * lines_ + verdict.line]);
  const bool dies = level(verdict.line) < before - dying;
  if (verdict.score > 0.4 * threshold) {
    line_ = verdict.line;
    channel_ = verdict.channel;
    const double before_hz = found_.frequency_hz;
    found_ = rings_[channel_].estimate(line_hz(line_), line_hz(1), 4.0 * options_.hop_s);
    const double most = (spindle_.rotation_hz() > 0.0 ? 0.5 : 0.07) * line_hz(1);
    steady_ = std::abs(found_.frequency_hz - before_hz) < most ? steady_ + 1 : 0;
  } else {
    steady_ = 0;
  }
  const bool cut = spindle_.rotation_hz() == 0.0 ? spindle_.expected_hz() > 0.0 && may_be_the_cut(found_.frequency_hz)
                                                 : entry_hops_ > 0 && near_a_harmonic(found_.frequency_hz);
  if (cut && verdict.score > threshold) lines_test_.accept(verdict.line);
  if (verdict.score > threshold && !dies && !cut && steady_ > 0 && spindle_.fits() && speed_holds()) {
    begin_chatter(verdict.height > 2.0 * faint);
  } else {
    state_ = verdict.score > 0.5 * threshold ? State::transition : State::stable;
  }
}

void CombCusum::follow_line() noexcept {
  // Where baselines are known, only what stands above them: the mains hum on.
  const auto excess = [&](std::size_t line) {
    double most = 0.0;
    for (std::size_t c = 0; c < channels_; ++c) {
      const double own = energy_[c * lines_ + line] - taken_[c * lines_ + line];
      const double usual = above_baseline_ ? std::exp(-std::max(0.0, lines_test_.height(c, line))) : 0.0;
      most = std::max(most, own * (1.0 - usual));
    }
    return most;
  };
  std::size_t best = line_;
  double most = excess(line_);
  // Not to the lines that a drifting offset reaches.
  for (std::size_t k = 3; k + 1 < lines_; ++k) {
    const bool near = k + 2 >= line_ && k <= line_ + 2;
    const double here = (near ? 1.0 : 0.5) * excess(k);
    if (here > most) {
      most = here;
      best = k;
    }
  }
  line_ = best;
  for (std::size_t c = 0; c < channels_; ++c) {
    if (energy_[c * lines_ + line_] > energy_[channel_ * lines_ + line_]) channel_ = c;
  }
}

void CombCusum::in_chatter() noexcept {
  follow_line();
  double height = -1e9;
  for (std::size_t c = 0; c < channels_; ++c) height = std::max(height, lines_test_.height(c, line_));
  highest_ = std::max(highest_, level(line_));
  const double fallen = highest_ - level(line_);
  calm_ = (above_baseline_ && height < faint && fallen > fainter) || fallen > died ? calm_ + 1 : 0;
  if (calm_ < calm_hops) return;
  state_ = State::transition;
  // The comb stood still, and the tool may have left.
  learn_anew();
  lose();
}

void CombCusum::report_frequency(Decision& decision) noexcept {
  // Once its line has fallen, the residual there is another's.
  if (state_ == State::chatter && calm_ == 0)
    found_ = rings_[channel_].estimate(line_hz(line_), line_hz(1), 8.0 * options_.hop_s);
  decision.chatter_frequency_hz = found_.frequency_hz;
  decision.chatter_frequency_std_hz = found_.std_hz;
}

}  // namespace robomill::monitor
