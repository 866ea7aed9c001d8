#include "robomill/monitor/comb_cusum.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace robomill::monitor {
namespace {

constexpr double dying = 0.3;         // fall of a log energy that no growing chatter shows
constexpr double died = 4.0;          // fall of a log energy at which chatter is over
constexpr double faint = 1.5;         // height over the baseline at which it is over, too
constexpr double broad_height = 1.2;  // of the median line: entry, exit
constexpr std::size_t broad_hops = 3;
constexpr std::size_t calm_hops = 2;
constexpr std::size_t hidden_hops = 6;   // for which a harmonic must stand out
constexpr double hidden_growth = 8.0;    // of its power against what was learnt, beyond that of tooth passing
constexpr double hidden_share = 0.25;    // of the whole power
constexpr double hidden_learnt_s = 0.5;  // before that it is not known what is usual
constexpr double dominant = 0.15;        // of the whole power

}  // namespace

bool CombCusum::look_for_hidden() noexcept {
  const auto teeth = static_cast<std::size_t>(options_.teeth);
  if (rotation_hz_ == 0.0 || teeth < 2 || !trusted()) return false;
  double cutting = 0.0;
  double cutting_before = 0.0;
  double total = 1e-300;
  for (const double power : power_) total += power;
  const std::size_t count = combs_[0].harmonics();
  for (std::size_t k = 1; k <= count; ++k) {
    harmonic_[k - 1] = 0.0;
    for (const Comb& comb : combs_) harmonic_[k - 1] += 0.5 * std::norm(comb.amplitude(k));
    if (k % teeth != 0) continue;
    cutting += harmonic_[k - 1];
    cutting_before += harmonic_before_[k - 1];
  }
  double most = 0.0;
  std::size_t at = 0;
  const double grown = hidden_growth * std::max(1.0, cutting / std::max(1e-300, cutting_before));
  for (std::size_t k = 2; k <= count; ++k) {
    if (k % teeth != 0 && harmonic_[k - 1] > grown * harmonic_before_[k - 1] && harmonic_[k - 1] > most) {
      most = harmonic_[k - 1];
      at = k;
    }
  }
  const bool known = since_lock_s_ > hidden_learnt_s;
  hidden_hops_ = known && most > hidden_share * total && at == hidden_harmonic_ ? hidden_hops_ + 1 : 0;
  hidden_harmonic_ = at;
  const double slow = known ? 0.02 : 0.2;
  for (std::size_t k = 1; k <= count && hidden_hops_ == 0; ++k)
    harmonic_before_[k - 1] += slow * (harmonic_[k - 1] - harmonic_before_[k - 1]);
  if (hidden_hops_ < hidden_hops) return false;
  if (cutting < 0.3 * cutting_before || !speed_holds()) {
    hidden_hops_ = 0;
    return false;
  }
  hidden_ = 2 * (at % teeth) == teeth ? Hidden::period_doubling : Hidden::locked;
  hidden_power_ = most;
  found_ = {.frequency_hz = static_cast<double>(at) * rotation_hz_,
            .std_hz = 1.0 / (hidden_hops * options_.hop_s) / std::sqrt(12.0)};
  return true;
}

double CombCusum::line_hz(std::size_t line) const noexcept {
  return static_cast<double>(line) * options_.sample_rate_hz / static_cast<double>(2 * (lines_ - 1));
}

double CombCusum::level(std::size_t line) const noexcept {
  return history_[hops_ % kept * lines_ + line];
}

void CombCusum::judge(Decision& decision) noexcept {
  double total = 1e-300;
  for (const double power : power_) total += power;
  const double n = static_cast<double>(2 * (lines_ - 1));
  for (std::size_t k = 0; k < lines_; ++k) {
    double energy = 0.0;
    for (std::size_t c = 0; c < channels_; ++c)
      energy += std::max(0.0, energy_[c * lines_ + k] - taken_[c * lines_ + k]);
    const double share = energy / (2.0 * columns_a_hop * n * n) / total;
    certain_[k] = rotation_hz_ > 0.0 && trusted() && share > dominant;
  }
  const Cusum::Verdict verdict = lines_test_.step(energy_, taken_, {certain_.get(), lines_});
  double* now = history_.data() + hops_ % kept * lines_;
  for (std::size_t k = 0; k < lines_; ++k) {
    now[k] = -1e9;
    for (std::size_t c = 0; c < channels_; ++c) now[k] = std::max(now[k], lines_test_.log_energy(c, k));
  }
  if (state_ == State::chatter) {
    in_chatter();
  } else {
    in_cut(verdict);
  }
  if (state_ != State::chatter && trusted()) lines_test_.learn();
  decision.state = state_;
  decision.score = verdict.score;
  decision.threshold = lines_test_.threshold();
  decision.channel = static_cast<int>(channel_);
  decision.hidden = hidden_;
  if (state_ != State::stable) tell_frequency(decision);
}

void CombCusum::in_cut(const Cusum::Verdict& verdict) noexcept {
  const double threshold = lines_test_.threshold();
  if (!trusted()) {
    lines_test_.relearn();
    state_ = State::stable;
    broad_ = hidden_hops_ = 0;
    return;
  }
  if (look_for_hidden()) {
    state_ = State::chatter;
    above_baseline_ = false;
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
    const double most = (rotation_hz_ > 0.0 ? 0.5 : 0.07) * line_hz(1);
    steady_ = std::abs(found_.frequency_hz - before_hz) < most ? steady_ + 1 : 0;
  } else {
    steady_ = 0;
  }
  if (verdict.score > threshold && !dies && steady_ > 0 && speed_holds()) {
    state_ = State::chatter;
    above_baseline_ = verdict.height > 2.0 * faint;
    highest_ = level(line_);
    calm_ = 0;
  } else {
    state_ = verdict.score > 0.5 * threshold ? State::transition : State::stable;
  }
}

void CombCusum::follow_line() noexcept {
  const auto height = [&](std::size_t line) {
    double most = 0.0;
    for (std::size_t c = 0; c < channels_; ++c) {
      most = std::max(most, energy_[c * lines_ + line] - taken_[c * lines_ + line]);
    }
    return most;
  };
  std::size_t best = line_;
  double most = height(line_);
  // Not to the lines that a drifting offset reaches.
  for (std::size_t k = 3; k + 1 < lines_; ++k) {
    const bool near = k + 2 >= line_ && k <= line_ + 2;
    const double here = (near ? 1.0 : 0.5) * height(k);
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
  if (hidden_ != Hidden::none) {
    // The comb follows on: it is what sees this one.
    double power = 0.0;
    for (const Comb& comb : combs_) power += 0.5 * std::norm(comb.amplitude(hidden_harmonic_));
    hidden_power_ = std::max(hidden_power_, power);
    calm_ = power < 0.1 * hidden_power_ ? calm_ + 1 : 0;
    if (calm_ < calm_hops) return;
    hidden_ = Hidden::none;
    hidden_hops_ = calm_ = 0;
    state_ = State::transition;
    lines_test_.relearn();
    return;
  }
  follow_line();
  double height = -1e9;
  for (std::size_t c = 0; c < channels_; ++c) height = std::max(height, lines_test_.height(c, line_));
  highest_ = std::max(highest_, level(line_));
  calm_ = (above_baseline_ && height < faint) || level(line_) < highest_ - died ? calm_ + 1 : 0;
  if (calm_ < calm_hops) return;
  state_ = State::transition;
  lines_test_.relearn();
}

void CombCusum::tell_frequency(Decision& decision) noexcept {
  // Once its line has fallen, what is left there is another's.
  if (state_ == State::chatter && hidden_ == Hidden::none && calm_ == 0)
    found_ = rings_[channel_].estimate(line_hz(line_), line_hz(1), 8.0 * options_.hop_s);
  decision.chatter_frequency_hz = found_.frequency_hz;
  decision.chatter_frequency_std_hz = found_.std_hz;
}

}  // namespace robomill::monitor
