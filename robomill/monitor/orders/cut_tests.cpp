#include "robomill/monitor/orders/cut_tests.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "robomill/monitor/orders/hops.hpp"
#include "robomill/monitor/orders/thresholds.hpp"

namespace robomill::monitor {

using namespace thresholds;

namespace {

constexpr std::array fast_s = {0.3, 0.15};
constexpr std::array slow_s = {1.0, 0.5};
constexpr std::array slowest_s = {2.0, 1.0, 0.5};
constexpr double slow_rate_hz = 5120.0, slowest_rate_hz = 1280.0;  // enough where the spindle is slow
constexpr double turns = 8.0;        // in a window of families: orders are told apart, and lines between them
constexpr double most_score = 99.0;  // of L to S

constexpr double lobe = 1.25;  // 1/T, to each side, that hold a line's energy
// Orders of rotation and of tooth passing up to which a line that runs away may be one, and by how much it is read
// wrong.
constexpr double low_of_rotation = 5.5, low_of_teeth = 3.5, line_off_hz = 5.0;
// Of a slow spindle the lobes of the orders fill half of the lines: the floor is the lower quartile of four orders.
constexpr double slow_floor_part = 0.25, slow_floor_orders = 4.0;
constexpr double usual_false_alarms_per_hour = 0.1, evidence_a_hop = 3.6;  // ln 37: family hops
constexpr int fewest_family_hops = 3, kept_hops = 8;
constexpr double reading = 0.05;  // 1/T: how well a line's frequency is read off

// The first that holds names an alarm.
constexpr Test order_of_tests[] = {Test::dominant, Test::ratio,   Test::growth,
                                   Test::family,   Test::runaway, Test::slow_ratio};

}  // namespace

CutTests::CutTests(const Setup& setup)
    : setup_(setup),
      fast_(setup.sample_rate_hz, setup.channels, fast_s),
      slow_(setup.sample_rate_hz, setup.channels, slow_s, slow_rate_hz),
      slowest_(setup.sample_rate_hz, setup.channels, slowest_s, slowest_rate_hz),
      floor_(most_lines()),
      speed_({.hop_s = setup.hop_s, .std_ratio = setup.speed_std_ratio, .teeth = setup.teeth, .lines = most_lines()}),
      search_(setup.hop_s),
      slow_speed_({.hop_s = setup.hop_s,
                   .std_ratio = setup.speed_std_ratio,
                   .teeth = setup.teeth,
                   .lines = slowest_.spectrum(0, 0).line.size()}),
      slow_line_(slowest_.spectrum(0, 0), slowest_.highest_hz()),
      turn_split_(setup.sample_rate_hz, setup.channels, setup.hop_s),
      cut_(setup.hop_s, setup.machine ? setup.machine->quietest_energy : 0.0),
      dominant_(fast_.spectrum(0, 0).line.size(), setup.hop_s),
      growth_(fast_.highest_hz(), setup.hop_s),
      past_(setup.hop_s),
      machine_(setup.machine),
      runaway_(setup.hop_s),
      family_hops_(std::clamp(
          alarm_hops - static_cast<int>(std::lround(
                           std::log(setup.false_alarms_per_hour / usual_false_alarms_per_hour) / evidence_a_hop)),
          fewest_family_hops, kept_hops)),
      calm_known_(setup.machine != nullptr) {
  const auto add = [&](Spectra& spectra, std::size_t at, double seconds) {
    const Spectrum& like = spectra.spectrum(at, 0);
    const auto lines = std::min(like.line.size(), static_cast<std::size_t>(spectra.highest_hz() / like.step_hz) + 1);
    windows_.push_back(
        {&spectra, at, seconds,
         ResidualLines(like, {.highest_hz = spectra.highest_hz(), .sample_rate_hz = setup.sample_rate_hz}),
         std::vector<float>(lines)});
  };
  add(fast_, 1, fast_s[1]);
  add(fast_, 0, fast_s[0]);
  add(slow_, 1, slow_s[1]);
  add(slow_, 0, slow_s[0]);
  add(slowest_, 0, slowest_s[0]);
  for (std::size_t i = slowest_s.size(); i-- > 0;) {
    const Spectrum& like = slowest_.spectrum(i, 0);
    const auto lines = std::min(like.line.size(), static_cast<std::size_t>(slowest_.highest_hz() / like.step_hz) + 1);
    slow_windows_.push_back({i, slowest_s[i], std::vector<float>(lines)});
  }
}

std::size_t CutTests::most_lines() const noexcept {
  const auto lines = [](const Spectra& of) { return of.spectrum(0, 0).line.size(); };
  return std::max({lines(fast_), lines(slow_), lines(slowest_)});
}

void CutTests::set_hint(double rotation_hz) noexcept {
  given_ = rotation_hz > 0.0;
  speed_.set_hint(std::max(0.0, rotation_hz));
  slow_speed_.set_hint(std::max(0.0, rotation_hz));
}

void CutTests::measured(double rotation_hz, double std_ratio) noexcept {
  if (!given_) set_hint(rotation_hz);
  speed_.measured(rotation_hz, std_ratio);
  slow_speed_.measured(rotation_hz, std_ratio);
}

void CutTests::reset() noexcept {
  fast_.reset();
  slow_.reset();
  slowest_.reset();
  if (!given_) speed_.set_hint(0.0);
  speed_.reset();
  slow_speed_.reset();
  slow_line_.reset();
  turn_split_.reset();
  search_.reset();
  cut_.reset();
  dominant_.reset();
  growth_.forget();
  past_.forget();
  runaway_.reset();
  found_far_ = found_near_ = {};
  grown_ = {};
  why_ = {};
  held_ = {};
  growing_ = calm_ = clean_ = 0;
  calm_known_ = setup_.machine != nullptr;
  grown_hz_ = rises_hz_ = 0.0;
  chatter_ = rises_ = false;
  alarm_ = read_by_ = Test::none;
  frequency_hz_ = 0.0;
}

double CutTests::history_s(double rotation_hz) noexcept {
  if (rotation_hz < lowest_rotation_hz) return fast_s[0];
  const double seconds = (rotation_hz <= highest_slow_hz ? slow_speed_turns : turns) / rotation_hz;
  for (const double window_s : {fast_s[0], slow_s[1], slow_s[0]}) {
    if (seconds <= window_s) return window_s;
  }
  return slowest_s[0];
}

// Of eight turns at least where these fit into two seconds, and no longer than that: chatter of a fast spindle is found
// sooner in a short window.
void CutTests::choose_windows() noexcept {
  const double hint_hz = speed_.hint_hz();
  armed_ = hint_hz >= lowest_rotation_hz;
  far_ = s_0_3;
  near_ = s_0_15;
  if (!armed_) return;
  const double seconds = turns / hint_hz;
  while (far_ + 1 < windows && windows_[far_].seconds < seconds - 1e-9) far_ = static_cast<Of>(far_ + 1);
  while (near_ + 1 < windows && windows_[near_].seconds < seconds - 1e-9) near_ = static_cast<Of>(near_ + 1);
}

void CutTests::transform(std::size_t window, std::uint64_t bad_channels) noexcept {
  Window& of = windows_[window];
  of.spectra->transform(of.at);
  of.spectra->power(of.at, bad_channels, of.power);
}

std::span<const float> CutTests::floor_of(const Window& window) noexcept {
  return floor_.of(window.power, static_cast<std::size_t>(2.0 * speed_.hint_hz() / window.like().step_hz));
}

void CutTests::measure(std::uint64_t bad_channels) noexcept {
  transform(s_0_15, bad_channels);
  transform(s_0_3, bad_channels);
  const Window& usual = windows_[s_0_3];
  const bool known = follows();
  if (!given_ || !explained()) {
    search_.observe(usual.power, usual.like());
    if (!given_ && !known && search_.rotation_hz() > 0.0) speed_.set_hint(search_.rotation_hz());
  }
  choose_windows();
  found_far_ = found_near_ = {};
  if (armed_) {
    Window& far = windows_[far_];
    if (far_ > s_0_3) transform(far_, bad_channels);
    const std::span<const float> floor = floor_of(far);
    speed_.step(far.power, floor, far.like());
    const ResidualLines::Orders orders{speed_.rotation_hz(), setup_.teeth, given_};
    found_far_ = far.lines.find(far.power, floor, orders);
    Window& near = windows_[near_];
    found_near_ = near_ == far_ ? found_far_ : near.lines.find(near.power, {}, orders);
  } else {
    speed_.reset();
  }
  energy_ = energy_of(usual.power, usual.like(), fast_.highest_hz()).whole;
  cut_.step({.energy = energy_,
             .synchronous = found_far_.synchronous,
             .whole = found_far_.whole,
             .teeth = found_far_.teeth,
             .family = found_far_.family,
             .short_synchronous = found_near_.synchronous,
             .rotation_hz = armed_ ? speed_.rotation_hz() : 0.0,
             .comb = armed_ ? speed_.seen() : 0.0,
             .given = given_,
             .full = fast_.past_s() >= usual.seconds - 1e-9},
            chatter_);
}

void CutTests::follow_growth() noexcept {
  grown_ = {};
  grown_hz_ = 0.0;
  if (!armed_) return;
  if (cut_.entered_s() == 0.0) growth_.forget();  // what a cut brings with it has no past
  const Window& near = windows_[near_];
  const std::span<double> cells = growth_.begin();
  near.lines.share_out(GrowthTest::cell_hz, cells);
  near.lines.share_out_between(GrowthTest::cell_hz, cells);
  grown_ = growth_.step(found_near_.teeth);
  if (fast_.past_s() >= fast_s[0] && !chatter_) growth_.learn();
  if (grown_.energy <= 0.0) return;
  // The strongest line of its cell.
  const Spectrum& like = near.like();
  const auto line = [&](double hz) {
    return std::clamp<double>(hz / like.step_hz, 1.0, static_cast<double>(near.power.size()) - 2.0);
  };
  const auto from = static_cast<std::size_t>(line(grown_.frequency_hz - 0.5 * GrowthTest::cell_hz));
  const auto end = static_cast<std::size_t>(line(grown_.frequency_hz + 0.5 * GrowthTest::cell_hz)) + 1;
  std::size_t at = from;
  for (std::size_t i = from; i < end; ++i) at = near.power[i] > near.power[at] ? i : at;
  grown_hz_ = like.peak_hz(at, near.power[at - 1], near.power[at], near.power[at + 1]);
}

void CutTests::follow_dominant() noexcept {
  const Window& usual = windows_[s_0_3];
  const double comb_hz = given_ ? 0.0 : search_.rotation_hz();
  dominant_.step(usual.power, usual.like(), energy_,
                 {.rotation_hz = given_ ? speed_.rotation_hz() : 0.0,
                  .teeth = setup_.teeth,
                  .off_ratio = speed_.belief() > forced_belief ? forced_off : forced_off_unsure,
                  .comb_hz = comb_hz},
                 fast_.past_s() >= usual.seconds - 1e-9);
}

// A harmonic of the teeth rises as fast where the tool enters: low multiples do not count.
void CutTests::follow_runaway() noexcept {
  const Window& near = windows_[s_0_15];
  const Spectrum& like = near.like();
  const std::size_t first = std::min(like.first_line(), near.power.size() - 3);
  const std::size_t end = near.power.size() - 2;
  std::size_t at = first;
  for (std::size_t i = first; i < end; ++i) at = near.power[i] > near.power[at] ? i : at;
  const auto beside = static_cast<std::size_t>(lobe / (like.seconds * like.step_hz));
  const std::size_t from = std::max(first, at - std::min(at, beside));
  const auto power = std::span<const float>(near.power);
  const double line = sums_of(power.subspan(from, std::min(end, at + beside + 1) - from)).plain;
  const double whole = sums_of(power.subspan(first, end - first)).plain;
  rises_hz_ = like.peak_hz(at, near.power[at - 1], near.power[at], near.power[at + 1]);
  rises_ =
      runaway_.step(rises_hz_, line * like.energy_share(), energy_ratio(line, whole)) && !may_be_the_cut(rises_hz_);
}

// Of a slow spindle the orders are followed in sixteen turns, and the strongest line in eight.
void CutTests::follow_slow_line(std::uint64_t bad_channels) noexcept {
  const double hint_hz = given_ ? slow_speed_.hint_hz() : 0.0;
  const bool was_slow = slow_spindle_;
  slow_spindle_ = hint_hz >= lowest_rotation_hz && hint_hz <= highest_slow_hz;
  if (!slow_spindle_) {
    if (was_slow) {
      slow_line_.reset();
      turn_split_.reset();
    }
    return;
  }
  const auto of_turns = [&](double turns_of_it) {
    std::size_t i = 0;
    while (i + 1 < slow_windows_.size() && slow_windows_[i].seconds < turns_of_it / hint_hz - 1e-9) ++i;
    return i;
  };
  slow_orders_at_ = of_turns(slow_speed_turns);
  slow_at_ = of_turns(turns);
  for (std::size_t i = 0; i < slow_windows_.size(); ++i) {
    if (i != slow_orders_at_ && i != slow_at_) continue;
    slowest_.transform(slow_windows_[i].at);
    slowest_.power(slow_windows_[i].at, bad_channels, slow_windows_[i].power);
  }
  const SlowWindow& of_orders = slow_windows_[slow_orders_at_];
  const Spectrum& like = slowest_.spectrum(of_orders.at, 0);
  const auto block = static_cast<std::size_t>(slow_floor_orders * hint_hz / like.step_hz);
  slow_speed_.step(of_orders.power, floor_.of(of_orders.power, block, slow_floor_part), like);
  const SlowWindow& window = slow_windows_[slow_at_];
  slow_line_.step(window.power, slowest_.spectrum(window.at, 0), slow_speed_.rotation_hz());
  turn_split_.step({.rotation_hz = slow_speed_.rotation_hz(), .hint_hz = hint_hz, .teeth = std::max(1, setup_.teeth)},
                   bad_channels);
}

bool CutTests::may_be_the_cut(double frequency_hz) const noexcept {
  const double hint_hz = speed_.hint_hz();
  if (hint_hz <= 0.0 || setup_.teeth == 0) return true;
  const auto multiple = [&](double of_hz, double highest) {
    const double order = frequency_hz / of_hz;
    return order < highest && std::abs(order - std::round(order)) < SpeedTracker::reach * order + line_off_hz / of_hz;
  };
  return multiple(hint_hz, low_of_rotation) || multiple(hint_hz * setup_.teeth, low_of_teeth);
}

// A comb that was found without a hint is one, until it explains the cut no more.
double CutTests::belief() const noexcept {
  if (!armed_) return 0.0;
  return given_ ? speed_.belief() : 1.0;
}

bool CutTests::follows() const noexcept {
  return armed_ && belief() >= least_belief && cut_.anchored() >= 1.0;
}

bool CutTests::explained() const noexcept {
  return follows() && cut_.synchronous_share() >= explains;
}

// A knock rings down, and what is left of one that has rung down says nothing.
CutTests::Sustained CutTests::sustained(Test test, std::uint64_t bad_channels) const noexcept {
  const Window& window = windows_[window_of(test)];
  const auto blocks = static_cast<std::size_t>(std::lround(window.seconds / block_s));
  const bool off = armed_ && given_ && cut_.anchored() >= 1.0;  // the orders are taken off
  std::array<double, most_blocks> memory = {};
  const std::span<double> sum = std::span(memory).first(blocks);
  for (std::size_t c = 0; c < setup_.channels; ++c) {
    if ((bad_channels >> c & 1U) != 0) continue;
    std::array<double, most_blocks> own = {};
    window.spectra->course(window.at, c, reading_hz(test), off ? speed_.rotation_hz() : 0.0,
                           std::span(own).first(blocks));
    for (std::size_t b = 0; b < blocks; ++b) sum[b] += own[b];
  }
  const auto of_a_turn = static_cast<std::size_t>(armed_ ? std::ceil(1.0 / (speed_.hint_hz() * block_s)) : 1.0);
  const std::size_t turn = std::clamp<std::size_t>(of_a_turn, 1, blocks / 2);
  const double last = *std::ranges::max_element(sum.last(turn));
  const double before = *std::ranges::max_element(sum.last(2 * turn).first(turn));
  const double most = *std::ranges::max_element(sum);
  double whole = 0.0, squares = 0.0;
  for (const double each : sum) {
    whole += each;
    squares += each * each;
  }
  return {energy_ratio(last, most), energy_ratio(std::min(last, before), most),
          energy_ratio(whole * whole, static_cast<double>(blocks) * squares)};
}

double CutTests::reading_hz(Test test) const noexcept {
  switch (test) {
    case Test::dominant:
      return dominant_.frequency_hz();
    case Test::ratio:
    case Test::family:
      return found_far_.frequency_hz;
    case Test::growth:
      return grown_hz_;
    case Test::slow_ratio:
      return slow_line_.frequency_hz();
    case Test::runaway:
      return rises_hz_;
    case Test::none:
      break;
  }
  return 0.0;
}

void CutTests::decide(std::uint64_t bad_channels, bool still) noexcept {
  Test begins = Test::none;
  for (const Test test : order_of_tests) {
    const auto at = static_cast<std::size_t>(test);
    Explanation& why = why_[at];
    bool holds = why.conditions > 0 && why.held() == why.conditions && !still;
    // A line that rings down: of growth and of a runaway in any hop, of a ratio or a family as the alarm would begin.
    const bool in_each = test == Test::growth || test == Test::runaway;
    const bool at_begin = test == Test::ratio || test == Test::family;
    bool rings = false;
    if (!chatter_ && holds && (in_each || (at_begin && std::popcount(held_[at]) + 1 >= why.enough_hops))) {
      const Sustained line = sustained(test, bad_channels);
      if (in_each) {
        why.ask(Quantity::line_sustained, line.last, least_sustained);
      } else {
        why.ask(Quantity::line_kept_up, line.last_two, least_kept_up);
        why.ask(Quantity::line_spread, line.spread, least_spread);
      }
      rings = why.held() < why.conditions;
    }
    holds = holds && !(rings && in_each);
    held_[at] = static_cast<std::uint8_t>((static_cast<unsigned>(held_[at]) << 1U) | (holds ? 1U : 0U));
    if (test == Test::growth) growing_ = holds ? growing_ + 1 : 0;
    const int hops = test == Test::growth ? static_cast<int>(growing_) : std::popcount(held_[at]);
    why.hops = std::min(hops, why.enough_hops);
    if (begins == Test::none && holds && !rings && why.hops >= why.enough_hops) begins = test;
  }
  if (!chatter_) {
    if (begins == Test::none) return;
    chatter_ = true;
    alarm_ = read_by_ = begins;
    calm_ = 0;
    frequency_hz_ = reading_hz(begins);
    return;
  }
  const auto stays_by = std::ranges::find_if(order_of_tests, [&](Test test) { return stays(test); });
  if (stays_by != std::end(order_of_tests)) {
    calm_ = 0;
    read_by_ = *stays_by;
    if (reading_hz(read_by_) > 0.0) frequency_hz_ = reading_hz(read_by_);
  } else if (++calm_ >= hops_of(over_s, setup_.hop_s)) {
    chatter_ = false;
    alarm_ = Test::none;
    held_ = {};
    growing_ = 0;
  }
}

// Against the quietest energy, or by what stands beside the orders: two ways to see that a cut is not all chatter.
void CutTests::look_for_calm(std::uint64_t bad_channels) noexcept {
  const std::uint64_t all = ~std::uint64_t{0} >> (64U - setup_.channels);
  const bool full = fast_.past_s() >= windows_[s_0_3].seconds - 1e-9;
  const bool clean = full && !chatter_ && (~bad_channels & all) != 0 && follows() && cut_.cutting() >= 1.0 &&
                     found_far_.family < least_beside * found_far_.synchronous;
  clean_ = clean ? clean_ + 1 : 0;
  if (cut_.above_quiet() >= quiet_is_known || clean_ >= hops_of(clean_s, setup_.hop_s)) calm_known_ = true;
}

CutTests::Of CutTests::window_of(Test test) const noexcept {
  switch (test) {
    case Test::runaway:
      return s_0_15;
    case Test::growth:
      return near_;
    case Test::ratio:
    case Test::family:
      return far_;
    default:
      return s_0_3;
  }
}

// The spectra and the window in which the frequency was read.
std::pair<const Spectra*, std::size_t> CutTests::read_in() const noexcept {
  if (read_by_ == Test::slow_ratio) return {&slowest_, slow_windows_[slow_at_].at};
  const Window& window = windows_[window_of(read_by_)];
  return {window.spectra, window.at};
}

void CutTests::describe(std::uint64_t bad_channels, Verdict& verdict) const noexcept {
  const auto [spectra, window] = read_in();
  const Spectrum& like = spectra->spectrum(window, 0);
  verdict.frequency_hz = frequency_hz_;
  verdict.frequency_std_hz = reading / like.seconds;
  const auto at = std::min(like.line.size() - 1, static_cast<std::size_t>(std::lround(frequency_hz_ / like.step_hz)));
  float strongest = -1.0F;
  for (std::size_t c = 0; c < setup_.channels; ++c) {
    const float strength = std::norm(spectra->spectrum(window, c).line[at]);
    if ((bad_channels >> c & 1U) != 0 || strength <= strongest) continue;
    strongest = strength;
    verdict.channel = c;
  }
  if (!verdict.known || verdict.rotation_hz <= 0.0 || setup_.teeth < 2) return;
  const double order = frequency_hz_ / verdict.rotation_hz;
  const double near = std::round(order);
  const auto k = static_cast<int>(near);
  if (std::abs(order - near) * verdict.rotation_hz * like.seconds > on_an_order || k % setup_.teeth == 0) return;
  verdict.synchronous = 2 * k % setup_.teeth == 0 ? SynchronousChatter::period_doubling : SynchronousChatter::locked;
}

CutTests::Verdict CutTests::step(std::span<const float> samples, std::size_t frames, std::uint64_t bad_channels,
                                 bool still) noexcept {
  fast_.push(samples, frames);
  slow_.push(samples, frames);
  slowest_.push(samples, frames);
  if (slow_spindle_) turn_split_.push(samples, frames);
  measure(bad_channels);
  bad_channels_ = bad_channels;
  follow_growth();
  follow_dominant();
  follow_runaway();
  follow_slow_line(bad_channels);
  explain_all();
  decide(bad_channels, still);
  look_for_calm(bad_channels);
  const bool settled = cut_.entered_s() >= settled_s;
  if (!chatter_ && armed_ && settled && fast_.past_s() >= fast_s[0]) past_.learn(found_far_.family);
  const auto closest = std::ranges::max_element(why_, {}, [](const Explanation& why) {
    return why.conditions == 0 ? -1.0 : why.hops + static_cast<double>(why.held()) / why.conditions;
  });
  const Explanation& why = chatter_ ? why_[static_cast<std::size_t>(read_by_)] : *closest;
  const double ratio = energy_ratio(found_far_.family, found_far_.synchronous);
  const double evidence = static_cast<double>(why.hops) / std::max(1, why.enough_hops);
  Verdict out{.chatter = chatter_,
              .score = chatter_ ? 1.0 + std::clamp(ratio, least_ratio, most_score) : std::min(1.0, evidence),
              .rotation_hz = given_ ? speed_.rotation_hz() : 0.0,
              .rotation_std_ratio = speed_.std_ratio(),
              .known = follows(),
              .explained = explained(),
              .calm_known = calm_known_,
              .why = why};
  out.comb_hz = given_ && !explained() ? search_.rotation_hz() : 0.0;
  if (!chatter_ && out.score > 0.0) {
    read_by_ = static_cast<Test>(closest - why_.begin());
    frequency_hz_ = reading_hz(read_by_);
  }
  if (out.score > 0.0) describe(bad_channels, out);
  return out;
}

}  // namespace robomill::monitor
