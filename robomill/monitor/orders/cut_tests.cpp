#include "robomill/monitor/orders/cut_tests.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "robomill/monitor/orders/hops.hpp"
#include "robomill/monitor/orders/mains.hpp"

namespace robomill::monitor {
namespace {

constexpr double least_ratio = 0.2;                     // of L to S
constexpr double alarm_s = 0.075, alone_alarm_s = 0.1;  // that something stands out for
constexpr double entry_alarm_s = 0.15;                  // the same while the tool enters
constexpr double over_s = 0.15;
constexpr double most_score = 99.0;     // of L to S
constexpr double evidence_a_hop = 3.6;  // of ln(hops an hour/alarms an hour)
constexpr double faint_share = 0.01;    // of the loudest cut
constexpr double growth_of_swing = 0.5;
constexpr double loud = 30.0;  // of the least energy: a tone of an idling machine is weaker
constexpr double alone_share = 0.6;
constexpr double line_moves = 0.04;  // of a frequency between the windows
// By which the speed may be off a hint, in its standard deviations, and a line is read wrong.
constexpr double hint_off = 4.7, line_off_hz = 5.0;
// Orders of rotation up to which a line may be one, or dominate; of tooth passing that rise first as the tool enters.
constexpr double any_of_rotation = 5.5, dominant_of_rotation = 2.5, first_of_teeth = 3.5;
constexpr double any_order = std::numeric_limits<double>::infinity();
constexpr double mains_width_hz = 0.7, highest_of_mains = 3.5;
constexpr std::size_t blocks = 6;  // that the short window is cut into
constexpr double first_tones_s = 0.3, air_memory_s = 10.0;
constexpr double stable_ratio = 0.05;   // L to S
constexpr double still_air = 2.0;       // of the least energy: more is not the air
constexpr double rung_down = 0.5;       // of the strongest block, in the last
constexpr double reading = 0.05;        // 1/T: how well a line's frequency is read off
constexpr double first_reading = 0.15;  // the same of a line that has just come
constexpr double sharp_line = 0.5;      // 1/T, by which an order moves in 0.3 s
constexpr float own_comb = 0.5F;        // of the rest, in the multiples of such a line
constexpr double lone_reach = 4.0;      // 1/T, to each side, that a line that dominates shows
constexpr double spread = 1.25;         // 1/T, to each side, that hold a line's energy

// Hum.
bool of_the_mains(double frequency_hz) {
  return std::ranges::any_of(mains_hz, [&](double hz) {
    return frequency_hz < highest_of_mains * hz && std::abs(std::remainder(frequency_hz, hz)) < mains_width_hz;
  });
}

}  // namespace

CutTests::CutTests(const Setup& setup)
    : setup_(setup),
      family_hops_(static_cast<std::size_t>(std::clamp(
          std::round(std::log(3600.0 / setup.hop_s / setup.false_alarms_per_hour) / evidence_a_hop), 2.0, 12.0))),
      spectra_(setup.sample_rate_hz, setup.channels),
      speed_({.hop_s = setup.hop_s,
              .highest_hz = spectra_.highest_hz(),
              .std_ratio = setup.speed_std_ratio,
              .teeth = setup.teeth}),
      search_(setup.hop_s),
      cut_(setup.hop_s),
      growth_(spectra_.highest_hz(), setup.hop_s),
      family_(setup.hop_s),
      runaway_(setup.hop_s),
      tones_(GrowthTest::cells(spectra_.highest_hz()), setup.hop_s),
      power_(spectra_.spectrum(0, 0).line.size()),
      long_power_(power_.size()),
      rest_(power_.size()),
      cells_(GrowthTest::cells(spectra_.highest_hz())) {
  for (std::size_t w = 0; w < windows; ++w) lines_.emplace_back(spectra_.spectrum(w, 0), spectra_.highest_hz());
}

void CutTests::set_hint(double rotation_hz) noexcept {
  if (rotation_hz <= 0.0 && given_) cut_.forget_speed();
  given_ = rotation_hz > 0.0;
  speed_.set_hint(std::max(0.0, rotation_hz));
}

void CutTests::measured(double rotation_hz, double std_ratio) noexcept {
  if (!given_) set_hint(rotation_hz);
  measured_hz_ = rotation_hz;
  measured_std_ratio_ = std_ratio;
}

void CutTests::reset() noexcept {
  spectra_.reset();
  if (!given_) speed_.set_hint(0.0);
  speed_.reset();
  search_.reset();
  cut_.reset();
  growth_.forget();
  family_.forget();
  runaway_.reset();
  tones_.reset();
  found_ = {};
  peak_ = {};
  counts_ = {};
  measured_hz_ = air_energy_ = frequency_hz_ = short_frequency_hz_ = 0.0;
  chatter_ = false;
}

void CutTests::measure(std::uint64_t bad_channels) noexcept {
  using Motion = SpeedPosterior::Motion;
  speed_.predict(chatter_ ? Motion::held : cut_.anchored(found_.back()) ? Motion::near : Motion::free);
  for (std::size_t w = 0; w < windows; ++w) {
    const Spectrum& like = spectra_.spectrum(w, 0);
    std::fill_n(power_.begin(), like.line.size(), 0.0F);
    for (std::size_t c = 0; c < setup_.channels; ++c) {
      if ((bad_channels >> c & 1U) != 0) continue;
      const Spectrum& own = spectra_.spectrum(w, c);
      for (std::size_t i = 1; i < own.line.size(); ++i) power_[i] += std::norm(own.line[i]);
    }
    if (w == 0) std::copy_n(power_.begin(), like.line.size(), long_power_.begin());
    if (w == 0 && (!given_ || !cut_.known())) {
      search_.observe(std::span(power_).first(like.line.size()), like);
      const bool sought = !given_ && !chatter_ && !cut_.known();
      if (sought && search_.rotation_hz() > 0.0) speed_.set_hint(search_.rotation_hz());
    }
    peak_[w] = strongest(like, 0.0, spectra_.highest_hz());
    speed_.observe(without_a_lone_line(w), like);
  }
  if (measured_hz_ > 0.0) speed_.observe(std::exchange(measured_hz_, 0.0), measured_std_ratio_);
  speed_.conclude();
  speed_.refine(long_power_, spectra_.spectrum(0, 0));
  if (speed_.rotation_hz() <= 0.0) {
    found_ = {};
    return;
  }
  for (std::size_t w = 0; w < windows; ++w) {
    lines_[w].begin(speed_.rotation_hz(), setup_.teeth, given_);
    for (std::size_t c = 0; c < setup_.channels; ++c) {
      if ((bad_channels >> c & 1U) == 0) lines_[w].add(spectra_.spectrum(w, c));
    }
    found_[w] = lines_[w].finish();
  }
}

// One line that dominates, and is none of the cut's, would in time be taken for an order. Where its multiples hold a
// good part of the rest it may be tooth passing at another speed than given.
std::span<const float> CutTests::without_a_lone_line(std::size_t window) noexcept {
  const Spectrum& like = spectra_.spectrum(window, 0);
  const Peak& peak = peak_[window];
  const auto power = std::span<const float>(power_).first(like.line.size());
  if (peak.share < alone_share ||
      may_be_the_cut(peak.frequency_hz, dominant_of_rotation, any_order, SpeedPosterior::reach))
    return power;
  std::ranges::copy(power, rest_.begin());
  const double reach_hz = lone_reach / like.seconds;
  const auto from = static_cast<std::size_t>(std::max(0.0, peak.frequency_hz - reach_hz) / like.step_hz);
  const auto to = std::min(power.size(), static_cast<std::size_t>((peak.frequency_hz + reach_hz) / like.step_hz) + 1);
  std::fill(rest_.begin() + static_cast<std::ptrdiff_t>(from), rest_.begin() + static_cast<std::ptrdiff_t>(to), 0.0F);
  const auto sum = [](std::span<const float> of) { return std::accumulate(of.begin(), of.end(), 0.0F); };
  float multiples = 0.0F;
  for (double hz = 2.0 * peak.frequency_hz; hz < spectra_.highest_hz(); hz += peak.frequency_hz) {
    const auto first = static_cast<std::size_t>((hz - spread / like.seconds) / like.step_hz);
    const auto count = static_cast<std::size_t>(2.0 * spread / (like.seconds * like.step_hz)) + 1;
    if (first < power.size()) multiples += sum(power.subspan(first, std::min(count, power.size() - first)));
  }
  const auto rest = std::span<const float>(rest_).first(power.size());
  return multiples > own_comb * sum(rest) ? power : rest;
}

CutTests::Peak CutTests::strongest(const Spectrum& like, double low_hz, double high_hz) const noexcept {
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

bool CutTests::ratio_stands_out() const noexcept {
  const ResidualFamily& far = found_.front();
  const ResidualFamily& near = found_.back();
  return cut_.known() && far.family > least_ratio * far.synchronous && near.family > least_ratio * near.synchronous &&
         near.family > faint_share * cut_.loudest() && !of_the_mains(far.frequency_hz);
}

// A low multiple of rotation or one of tooth passing, as far as the hint is unsure: where a harmonic of the teeth meets
// a mode it may hold nearly all energy.
bool CutTests::may_be_the_cut(double frequency_hz, double highest_of_rotation, double highest_of_teeth,
                              double off) const noexcept {
  const double hint_hz = speed_.hint_hz();
  if (hint_hz <= 0.0 || setup_.teeth == 0) return true;
  const auto multiple = [&](double of_hz, double highest) {
    const double order = frequency_hz / of_hz;
    return order < highest && std::abs(order - std::round(order)) < off * order + line_off_hz / of_hz;
  };
  return multiple(hint_hz, highest_of_rotation) || multiple(hint_hz * setup_.teeth, highest_of_teeth);
}

double CutTests::speed_off() const noexcept {
  return cut_.has_cut() ? SpeedPosterior::reach : std::min(SpeedPosterior::reach, hint_off * setup_.speed_std_ratio);
}

bool CutTests::stands_alone() const noexcept {
  const Peak& far = peak_.front();
  const Peak& near = peak_.back();
  if (cut_.known() ||
      (!chatter_ && (cut_.locked() || cut_.unsettled() || air_energy_ <= 0.0 || near.energy < loud * air_energy_))) {
    return false;
  }
  return std::min(far.share, near.share) > alone_share &&
         std::abs(far.frequency_hz - near.frequency_hz) < line_moves * near.frequency_hz &&
         !may_be_the_cut(near.frequency_hz, any_of_rotation, any_order, speed_off()) && !of_the_mains(far.frequency_hz);
}

bool CutTests::rings_down(double frequency_hz, std::uint64_t bad_channels) const noexcept {
  const bool known = given_ && cut_.known() && speed_.rotation_hz() >= lowest_rotation_hz;
  const double off_hz = known ? speed_.rotation_hz() : 0.0;  // of which the orders are taken off
  std::array<double, blocks> sum = {};
  for (std::size_t c = 0; c < setup_.channels; ++c) {
    if ((bad_channels >> c & 1U) != 0) continue;
    std::array<double, blocks> own = {};
    spectra_.course(c, frequency_hz, off_hz, own);
    for (std::size_t b = 0; b < blocks; ++b) sum[b] += own[b];
  }
  return sum.back() < rung_down * *std::ranges::max_element(sum);
}

// A speed that is not known explains a tone as well as a cut: what stands in air is all of it.
void CutTests::fill_cells() noexcept {
  std::ranges::fill(cells_, 0.0);
  if (cut_.known()) {
    lines_.back().share_out(GrowthTest::cell_hz, cells_);
    return;
  }
  const Spectrum& like = spectrum(0);
  for (std::size_t i = like.first_line(); i < like.line.size(); ++i) {
    const auto cell = static_cast<std::size_t>(static_cast<double>(i) * like.step_hz / GrowthTest::cell_hz);
    cells_[std::min(cells_.size() - 1, cell)] += like.energy_share() * static_cast<double>(power_[i]);
  }
}

void CutTests::find_in_cut(Finding& out) noexcept {
  const ResidualFamily& near = found_.back();
  const bool steady = cut_.steady();
  if (!cut_.known() || (!steady && !chatter_)) {
    growth_.forget();
    family_.forget();
  }
  if (!cut_.known()) return;
  const std::span<double> cells = growth_.begin();
  std::ranges::copy(cells_, cells.begin());
  lines_.back().share_out_between(GrowthTest::cell_hz, cells);
  const GrowthTest::Verdict grown = growth_.step(near.teeth);
  if (!chatter_) growth_.learn();
  // An order that moves by more than half of a line's width stands beside itself.
  const bool sharp = cut_.speed_range() * near.frequency_hz * spectrum(0).seconds < sharp_line;
  if (!cut_.enters() && family_.step(near, cut_.swing(), !chatter_) && sharp) {
    out.family = true;
    out.frequency_hz = near.frequency_hz;
  }
  if (grown.energy > 0.0) {
    out.growth = chatter_ || grown.energy > growth_of_swing * cut_.swing();
    out.frequency_hz = strongest(spectrum(0), grown.frequency_hz - 0.5 * GrowthTest::cell_hz,
                                 grown.frequency_hz + 0.5 * GrowthTest::cell_hz)
                           .frequency_hz;
  }
  if ((steady || chatter_) && ratio_stands_out()) {
    out.ratio = true;
    out.frequency_hz = near.frequency_hz;
  }
}

CutTests::Finding CutTests::find(std::uint64_t bad_channels) noexcept {
  Finding out;
  fill_cells();
  const Peak& peak = peak_.back();
  out.runaway = runaway_.step(peak.frequency_hz, peak.share * peak.energy, peak.share) &&
                !may_be_the_cut(peak.frequency_hz, any_of_rotation, first_of_teeth, speed_off());
  out.alone = stands_alone();
  if (out.runaway || out.alone) out.frequency_hz = peak.frequency_hz;
  find_in_cut(out);
  if (out.any() && !chatter_ && rings_down(out.frequency_hz, bad_channels)) out = {};
  const auto cell = static_cast<std::size_t>(out.frequency_hz / GrowthTest::cell_hz);
  if ((out.ratio || out.alone || out.runaway) && !chatter_ && tones_.stood(cell, cells_)) out = {};
  if (!chatter_ && !out.any()) learn_tones();
  return out;
}

// In air, and in cuts that are surely stable; what comes with the tool's entry may be chatter.
void CutTests::learn_tones() noexcept {
  if (spectra_.past_s() < first_tones_s) return;
  const bool stable = cut_.known() && !cut_.enters() && std::ranges::all_of(found_, [](const ResidualFamily& each) {
                        return each.family < stable_ratio * each.synchronous;
                      });
  const double energy = peak_.back().energy;
  air_energy_ = air_energy_ == 0.0 ? energy : std::min(energy, air_energy_ * std::exp(setup_.hop_s / air_memory_s));
  if (stable || energy <= still_air * air_energy_) tones_.learn(cells_);
}

void CutTests::describe(std::uint64_t bad_channels, Verdict& verdict) const noexcept {
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

// How far the hops have come that an alarm takes: 1 is one. What stands out by the ratio alone may beat: a hop without
// takes one back.
double CutTests::count(const Finding& found) noexcept {
  const auto in_a_row = [](bool now, std::size_t& running) { running = now ? running + 1 : 0; };
  in_a_row(found.growth, counts_.growth);
  in_a_row(found.family, counts_.family);
  in_a_row(found.alone, counts_.alone);
  in_a_row(!found.any(), counts_.calm);
  const auto part = [](std::size_t of, std::size_t all) { return static_cast<double>(of) / static_cast<double>(all); };
  const auto hops = [&](double seconds) { return hops_of(seconds, setup_.hop_s); };
  counts_.ratio = found.ratio ? std::min(counts_.ratio + 1, hops(entry_alarm_s)) : counts_.ratio - (counts_.ratio > 0);
  return std::max({part(counts_.ratio, hops(cut_.enters() ? entry_alarm_s : alarm_s)),
                   cut_.enters() ? 0.0 : part(counts_.growth, hops(alarm_s)), part(counts_.family, family_hops_),
                   part(counts_.alone, hops(alone_alarm_s)), found.runaway ? 1.0 : 0.0});
}

CutTests::Verdict CutTests::step(std::span<const float> samples, std::size_t frames, std::uint64_t bad_channels,
                                 bool still) noexcept {
  spectra_.push(samples, frames);
  spectra_.transform();
  measure(bad_channels);
  cut_.step(found_.back(), speed_, chatter_);
  Finding found = find(bad_channels);
  if (still && !chatter_) found = {};
  const double evidence = count(found);
  if (found.any()) {
    short_frequency_hz_ = found.frequency_hz;
    // Of a line that has stood for long, the long window reads better.
    const bool alone = found.alone || found.runaway;
    const double far_hz = alone ? peak_.front().frequency_hz : found_.front().frequency_hz;
    const bool same = std::abs(far_hz - found.frequency_hz) < line_moves * found.frequency_hz;
    frequency_hz_ = chatter_ && same && (found.ratio || alone) ? far_hz : found.frequency_hz;
  }
  if (!chatter_) {
    chatter_ = evidence >= 1.0;
  } else if (counts_.calm >= hops_of(over_s, setup_.hop_s)) {
    chatter_ = false;
    counts_ = {};
    cut_.chatter_ended();
  }
  const ResidualFamily& near = found_.back();
  const double ratio = near.family / (near.synchronous + 1e-300);
  Verdict out{.chatter = chatter_,
              .score = chatter_ ? 1.0 + std::clamp(ratio, least_ratio, most_score) : std::min(1.0, evidence),
              .ratio = ratio,
              .rotation_hz = given_ ? speed_.rotation_hz() : 0.0,
              .rotation_std_ratio = speed_.std_ratio(),
              .known = cut_.known(),
              .comb_hz = given_ && !cut_.known() ? search_.rotation_hz() : 0.0};
  if (out.score > 0.0) describe(bad_channels, out);
  return out;
}

}  // namespace robomill::monitor
