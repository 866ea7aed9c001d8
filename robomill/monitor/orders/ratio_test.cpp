#include "robomill/monitor/orders/ratio_test.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace robomill::monitor {
namespace {

constexpr double rings_s = 0.3;                         // of the rings
constexpr double least_ratio = 0.2;                     // of L to S
constexpr double alarm_s = 0.075, alone_alarm_s = 0.1;  // that something stands out for
constexpr double entry_alarm_s = 0.2, entry_s = 0.4;    // the same while the tool enters; which lasts so long
constexpr double over_s = 0.15;
constexpr double enters = 4.0;        // growth of the energy in 0.3 s
constexpr double locks_at = 0.4;      // probability
constexpr double locks_share = 0.35;  // of the energy, in the comb
constexpr double follows = 0.1;       // a hop, of cut_
constexpr double leaves = 0.1;        // of cut_
constexpr double vanishes = 0.4;      // of S in 0.3 s
constexpr double stays = 0.5;         // of cut_, or of the energy before
constexpr double least_anchor = 0.1;  // of the whole, in S: less does not hold the speed
constexpr double lost_s = 1.0;        // after which a lone line counts again
constexpr double loudest_memory_s = 10.0;
constexpr double idle = 0.03;           // of loudest_, in S
constexpr double faint_share = 0.01;    // of loudest_
constexpr double steady_ratio = 0.008;  // of the speed, in 0.3 s
constexpr double growth_of_swing = 0.5;
constexpr double loud = 30.0;  // of the least energy: a tone of an idling machine is weaker
constexpr double alone_share = 0.6;
constexpr double line_moves = 0.04;                     // of a frequency between the windows
constexpr double unsure_ratio = 0.07, unsure_hz = 5.0;  // by which a hint and a line may be off
constexpr double highest_of_rotation = 5.5, highest_of_teeth = 6.0, highest_of_unknown_teeth = 12.0;  // orders
constexpr double mains_width_hz = 0.7, highest_of_mains = 3.5;
constexpr std::size_t blocks = 6;  // that the short window is cut into
constexpr double tone_memory_s = 1.0;
constexpr double stable_ratio = 0.05;  // L to S
constexpr double still_air = 2.0;      // of the least energy: more is not the air
constexpr double tone_growth = 4.0;    // of the energy within ± tone_cells
constexpr std::size_t tone_cells = 2;
constexpr double rung_down = 0.4;       // of the strongest block, in the last
constexpr double reading = 0.05;        // 1/T: how well a line's frequency is read off
constexpr double first_reading = 0.15;  // the same of a line that has just come
constexpr double spread = 1.25;         // 1/T, to each side, that hold a line's energy
constexpr double on_an_order = 0.75;    // 1/T

// Hum.
bool of_the_mains(double frequency_hz) {
  return std::ranges::any_of(std::array{50.0, 60.0}, [&](double mains_hz) {
    return frequency_hz < highest_of_mains * mains_hz &&
           std::abs(std::remainder(frequency_hz, mains_hz)) < mains_width_hz;
  });
}

}  // namespace

RatioTest::RatioTest(const Setup& setup)
    : setup_(setup),
      spectra_(setup.sample_rate_hz, setup.channels),
      speed_({.hop_s = setup.hop_s,
              .highest_hz = spectra_.highest_hz(),
              .std_ratio = setup.speed_std_ratio,
              .teeth = setup.teeth}),
      search_(setup.hop_s),
      growth_(spectra_.highest_hz(), setup.hop_s),
      power_(spectra_.spectrum(0, 0).line.size()),
      long_power_(power_.size()),
      cells_(GrowthTest::cells(spectra_.highest_hz())),
      tones_(cells_.size()),
      synchronous_(hops(rings_s)),
      whole_(hops(rings_s)),
      rotation_(hops(rings_s)) {
  for (std::size_t w = 0; w < windows; ++w) lines_.emplace_back(spectra_.spectrum(w, 0), spectra_.highest_hz());
}

std::size_t RatioTest::hops(double seconds) const noexcept {
  return std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(seconds / setup_.hop_s)));
}

void RatioTest::set_hint(double rotation_hz) noexcept {
  if (rotation_hz <= 0.0 && given_) cut_ = 0.0;
  given_ = rotation_hz > 0.0;
  speed_.set_hint(std::max(0.0, rotation_hz));
}

void RatioTest::measured(double rotation_hz, double std_ratio) noexcept {
  if (!given_) set_hint(rotation_hz);
  measured_hz_ = rotation_hz;
  measured_std_ratio_ = std_ratio;
}

void RatioTest::reset() noexcept {
  spectra_.reset();
  if (!given_) speed_.set_hint(0.0);
  speed_.reset();
  search_.reset();
  growth_.forget();
  found_ = {};
  peak_ = {};
  for (auto* ring : {&synchronous_, &whole_, &rotation_}) std::ranges::fill(*ring, 0.0);
  tone_hops_ = 0;
  air_energy_ = 0.0;
  hop_ = ratio_hops_ = growth_hops_ = alone_hops_ = calm_hops_ = entry_hops_ = lost_hops_ = 0;
  cut_ = loudest_ = frequency_hz_ = short_frequency_hz_ = 0.0;
  chatter_ = false;
}

void RatioTest::measure(std::uint64_t bad_channels) noexcept {
  using Motion = SpeedPosterior::Motion;
  const ResidualFamily& before = found_.back();
  const bool anchored = cut_ > 0.0 && before.synchronous > std::max(stays * cut_, least_anchor * before.whole);
  speed_.predict(chatter_ ? Motion::held : anchored ? Motion::near : Motion::free);
  for (std::size_t w = 0; w < windows; ++w) {
    const Spectrum& like = spectra_.spectrum(w, 0);
    std::fill_n(power_.begin(), like.line.size(), 0.0F);
    for (std::size_t c = 0; c < setup_.channels; ++c) {
      if ((bad_channels >> c & 1U) != 0) continue;
      const Spectrum& own = spectra_.spectrum(w, c);
      for (std::size_t i = 1; i < own.line.size(); ++i) power_[i] += std::norm(own.line[i]);
    }
    if (w == 0) std::copy_n(power_.begin(), like.line.size(), long_power_.begin());
    if (w == 0 && !given_) {
      search_.observe(std::span(power_).first(like.line.size()), like);
      if (!chatter_ && cut_ == 0.0 && search_.rotation_hz() > 0.0) speed_.set_hint(search_.rotation_hz());
    }
    peak_[w] = strongest(like, 0.0, spectra_.highest_hz());
    speed_.observe(std::span(power_).first(like.line.size()), like);
  }
  if (measured_hz_ > 0.0) speed_.observe(std::exchange(measured_hz_, 0.0), measured_std_ratio_);
  speed_.conclude();
  speed_.refine(long_power_, spectra_.spectrum(0, 0));
  if (speed_.rotation_hz() <= 0.0) return;
  for (std::size_t w = 0; w < windows; ++w) {
    lines_[w].begin(speed_.rotation_hz(), setup_.teeth, given_);
    for (std::size_t c = 0; c < setup_.channels; ++c) {
      if ((bad_channels >> c & 1U) == 0) lines_[w].add(spectra_.spectrum(w, c));
    }
    found_[w] = lines_[w].finish();
  }
}

RatioTest::Peak RatioTest::strongest(const Spectrum& like, double low_hz, double high_hz) const noexcept {
  const auto first = std::max(like.first_line(), static_cast<std::size_t>(low_hz / like.step_hz) + 1);
  const auto end = std::min(like.line.size() - 1, static_cast<std::size_t>(high_hz / like.step_hz) + 1);
  const auto beside = static_cast<std::size_t>(spread / (like.seconds * like.step_hz));
  if (first >= end) return {};
  double whole = 1e-300;
  std::size_t at = first;
  for (std::size_t i = first; i < end; ++i) {
    whole += static_cast<double>(power_[i]);
    if (power_[i] > power_[at]) at = i;
  }
  double line = 0.0;
  for (std::size_t i = std::max(first, at - std::min(at, beside)); i < std::min(end, at + beside + 1); ++i) {
    line += static_cast<double>(power_[i]);
  }
  return {like.peak_hz(at, power_[at - 1], power_[at], power_[at + 1]), line / whole, whole * like.energy_share()};
}

void RatioTest::follow_cut() noexcept {
  const ResidualFamily& now = found_.back();
  const double whole_before = whole_[hop_];
  synchronous_[hop_] = now.synchronous;
  whole_[hop_] = now.whole;
  rotation_[hop_] = speed_.rotation_hz();
  hop_ = hop_ + 1 == whole_.size() ? 0 : hop_ + 1;
  if (now.whole > enters * whole_before && !chatter_ && cut_ == 0.0) {
    entry_hops_ = hops(entry_s);
  } else if (entry_hops_ > 0) {
    --entry_hops_;
  }
  if (lost_hops_ > 0) --lost_hops_;
  const bool locked = speed_.known() > locks_at && speed_.share() > locks_share;
  // An idling spindle is no cut.
  const bool cuts = now.synchronous > idle * loudest_;
  if (locked && cuts && !chatter_) cut_ = cut_ == 0.0 ? now.synchronous : cut_ + follows * (now.synchronous - cut_);
  loudest_ = std::max(cut_, loudest_ * (1.0 - setup_.hop_s / loudest_memory_s));
  if (now.synchronous < leaves * cut_) cut_ = 0.0;
  if (cut_ > 0.0 && !chatter_ && now.synchronous < vanishes * *std::ranges::max_element(synchronous_) &&
      now.synchronous < stays * now.whole && now.whole > stays * whole_before) {
    cut_ = 0.0;
    lost_hops_ = hops(lost_s);
  }
}

double RatioTest::swing() const noexcept {
  const auto [least, most] = std::ranges::minmax_element(synchronous_);
  return *most - *least;
}

bool RatioTest::ratio_stands_out() const noexcept {
  const ResidualFamily& far = found_.front();
  const ResidualFamily& near = found_.back();
  return cut_ > 0.0 && far.family > least_ratio * far.synchronous && near.family > least_ratio * near.synchronous &&
         near.family > std::max(swing(), faint_share * loudest_) && !of_the_mains(far.frequency_hz);
}

// A low multiple of rotation or of tooth passing, at the speed that is known or near the given one; high orders lie too
// close together.
bool RatioTest::may_be_the_cut(double frequency_hz) const noexcept {
  const double near_hz = cut_ > 0.0 ? speed_.rotation_hz() : speed_.hint_hz();
  if (near_hz <= 0.0) return true;
  const auto multiple = [&](double of_hz, double highest) {
    const double order = frequency_hz / of_hz;
    return order < highest && std::abs(order - std::round(order)) < unsure_ratio * order + unsure_hz / of_hz;
  };
  if (setup_.teeth == 0) return multiple(near_hz, highest_of_unknown_teeth);
  return multiple(near_hz, highest_of_rotation) || multiple(near_hz * setup_.teeth, highest_of_teeth);
}

bool RatioTest::one_line_dominates() const noexcept {
  const Peak& far = peak_.front();
  const Peak& near = peak_.back();
  return std::min(far.share, near.share) > alone_share &&
         std::abs(far.frequency_hz - near.frequency_hz) < line_moves * near.frequency_hz &&
         !may_be_the_cut(near.frequency_hz) && !of_the_mains(far.frequency_hz);
}

bool RatioTest::stands_alone() const noexcept {
  return cut_ == 0.0 &&
         (chatter_ || (lost_hops_ == 0 && air_energy_ > 0.0 && peak_.back().energy > loud * air_energy_)) &&
         one_line_dominates();
}

bool RatioTest::rings_down(double frequency_hz, std::uint64_t bad_channels) const noexcept {
  std::array<double, blocks> sum = {};
  for (std::size_t c = 0; c < setup_.channels; ++c) {
    if ((bad_channels >> c & 1U) != 0) continue;
    std::array<double, blocks> own = {};
    spectra_.course(c, frequency_hz, own);
    for (std::size_t b = 0; b < blocks; ++b) sum[b] += own[b];
  }
  return sum.back() < rung_down * *std::ranges::max_element(sum);
}

RatioTest::Finding RatioTest::find(std::uint64_t bad_channels) noexcept {
  Finding out;
  std::ranges::fill(cells_, 0.0);
  lines_.back().share_out(GrowthTest::cell_hz, cells_);
  if (cut_ == 0.0) {
    growth_.forget();
  } else {
    const std::span<double> cells = growth_.begin();
    std::ranges::copy(cells_, cells.begin());
    lines_.back().share_out_between(GrowthTest::cell_hz, cells);
  }
  const auto [slowest, fastest] = std::ranges::minmax_element(rotation_);
  const bool steady = *fastest - *slowest < steady_ratio * *fastest;
  if (!steady && !chatter_) growth_.forget();
  const GrowthTest::Verdict grown = cut_ > 0.0 ? growth_.step(found_.back().synchronous) : GrowthTest::Verdict{};
  if (cut_ > 0.0 && !chatter_) growth_.learn();
  if (stands_alone()) {
    out.alone = true;
    out.frequency_hz = peak_.back().frequency_hz;
  }
  if (grown.energy > 0.0) {
    out.growth = chatter_ || grown.energy > growth_of_swing * swing();
    out.frequency_hz = strongest(spectra_.spectrum(windows - 1, 0), grown.frequency_hz - 0.5 * GrowthTest::cell_hz,
                                 grown.frequency_hz + 0.5 * GrowthTest::cell_hz)
                           .frequency_hz;
  }
  if ((steady || chatter_) && ratio_stands_out()) {
    out.ratio = true;
    out.frequency_hz = found_.back().frequency_hz;
  }
  if (out.any() && !chatter_ && rings_down(out.frequency_hz, bad_channels)) out = {};
  if ((out.ratio || out.alone) && !chatter_ && was_there(out.frequency_hz)) out = {};
  if (!chatter_ && !out.any()) learn_tones();
  return out;
}

// In air, and in cuts that are surely stable; what comes with the tool's entry may be chatter.
void RatioTest::learn_tones() noexcept {
  const ResidualFamily& near = found_.back();
  const ResidualFamily& far = found_.front();
  const bool stable = cut_ > 0.0 && entry_hops_ == 0 && near.family < stable_ratio * near.synchronous &&
                      far.family < stable_ratio * far.synchronous;
  const double energy = peak_.back().energy;
  if (spectra_.past_s() < rings_s) return;
  air_energy_ = tone_hops_ == 0 ? energy : std::min(energy, air_energy_ * (1.0 + setup_.hop_s / loudest_memory_s));
  if (!stable && energy > still_air * air_energy_) return;
  ++tone_hops_;
  const double share = std::max(setup_.hop_s / tone_memory_s, 1.0 / static_cast<double>(tone_hops_));
  for (std::size_t i = 0; i < cells_.size(); ++i) tones_[i] += share * (cells_[i] - tones_[i]);
}

bool RatioTest::was_there(double frequency_hz) const noexcept {
  if (tone_hops_ < hops(rings_s)) return false;
  const auto at = static_cast<std::size_t>(frequency_hz / GrowthTest::cell_hz);
  double now = 0.0;
  double before = 0.0;
  for (std::size_t i = at > tone_cells ? at - tone_cells : 0; i < std::min(cells_.size(), at + tone_cells + 1); ++i) {
    now += cells_[i];
    before += tones_[i];
  }
  return now < tone_growth * before;
}

void RatioTest::describe(std::uint64_t bad_channels, Verdict& verdict) const noexcept {
  const Spectrum& like = spectra_.spectrum(0, 0);
  const bool at_first = frequency_hz_ == short_frequency_hz_;  // read in the short window, where the line is still new
  const double read_hz = at_first ? first_reading / spectra_.spectrum(windows - 1, 0).seconds : reading / like.seconds;
  verdict.frequency_hz = frequency_hz_;
  verdict.frequency_std_hz = std::hypot(read_hz, (frequency_hz_ - short_frequency_hz_) / 3.0);
  const auto at = std::min(like.line.size() - 1, static_cast<std::size_t>(std::lround(frequency_hz_ / like.step_hz)));
  for (std::size_t c = 0; c < setup_.channels; ++c) {
    if ((bad_channels >> c & 1U) != 0) continue;
    const auto level = [&](std::size_t channel) { return std::norm(spectra_.spectrum(0, channel).line[at]); };
    if (level(c) > level(verdict.channel)) verdict.channel = c;
  }
  if (!verdict.known || verdict.rotation_hz <= 0.0 || setup_.teeth < 2) return;
  const double order = frequency_hz_ / verdict.rotation_hz;
  const double near = std::round(order);
  const auto k = static_cast<int>(near);
  if (std::abs(order - near) * verdict.rotation_hz * like.seconds > on_an_order || k % setup_.teeth == 0) return;
  verdict.synchronous = 2 * k % setup_.teeth == 0 ? SynchronousChatter::period_doubling : SynchronousChatter::locked;
}

RatioTest::Verdict RatioTest::step(std::span<const float> samples, std::size_t frames,
                                   std::uint64_t bad_channels) noexcept {
  spectra_.push(samples, frames);
  spectra_.transform();
  measure(bad_channels);
  follow_cut();
  const Finding found = find(bad_channels);
  const auto count = [](bool now, std::size_t& running) { running = now ? running + 1 : 0; };
  count(found.ratio, ratio_hops_);
  count(found.growth, growth_hops_);
  count(found.alone, alone_hops_);
  count(!found.any(), calm_hops_);
  if (found.any()) {
    short_frequency_hz_ = found.frequency_hz;
    // Of a line that has stood for long, the long window reads better.
    const double far_hz = found.alone ? peak_.front().frequency_hz : found_.front().frequency_hz;
    const bool same = std::abs(far_hz - found.frequency_hz) < line_moves * found.frequency_hz;
    frequency_hz_ = chatter_ && same && (found.ratio || found.alone) ? far_hz : found.frequency_hz;
  }
  if (!chatter_) {
    chatter_ = ratio_hops_ >= hops(entry_hops_ > 0 ? entry_alarm_s : alarm_s) ||
               (growth_hops_ >= hops(alarm_s) && entry_hops_ == 0) || alone_hops_ >= hops(alone_alarm_s);
  } else if (calm_hops_ >= hops(over_s)) {
    chatter_ = false;
    lost_hops_ = hops(lost_s);
  }
  const ResidualFamily& near = found_.back();
  Verdict out{.chatter = chatter_,
              .pending = !chatter_ && found.any(),
              .ratio = near.family / (near.synchronous + 1e-300),
              .swing = swing() / (near.synchronous + 1e-300),
              .one_line = one_line_dominates(),
              .energy = peak_.back().energy,
              .rotation_hz = given_ ? speed_.rotation_hz() : 0.0,
              .rotation_std_ratio = speed_.std_ratio(),
              .known = cut_ > 0.0};
  if (chatter_ || out.pending) describe(bad_channels, out);
  return out;
}

}  // namespace robomill::monitor
