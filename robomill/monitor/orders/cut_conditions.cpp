// What each test asks of a hop, and what keeps an alarm.
#include <algorithm>
#include <cmath>

#include "robomill/monitor/orders/cut_tests.hpp"
#include "robomill/monitor/orders/mains.hpp"
#include "robomill/monitor/orders/thresholds.hpp"

namespace robomill::monitor {

using namespace thresholds;

namespace {

/// Of a line, to the nearest low multiple of 50 or 60 Hz: hum [Hz].
double from_the_mains(double frequency_hz) noexcept {
  double nearest = 1e9;
  for (const double hz : mains_hz) {
    if (frequency_hz < highest_of_mains * hz) nearest = std::min(nearest, std::abs(std::remainder(frequency_hz, hz)));
  }
  return nearest;
}

}  // namespace

// What every test that needs the orders asks for.
void CutTests::ask_of_the_cut(Explanation& why, double line_hz, std::size_t window) const noexcept {
  why.ask(Quantity::speed_belief, belief(), least_belief);
  why.ask(Quantity::anchored, cut_.anchored(), 1.0);
  why.ask(Quantity::cutting, cut_.cutting(), 1.0);
  why.ask(Quantity::staying, cut_.staying(), leaves);
  why.ask(Quantity::entered, cut_.entered_s(), settled_s);
  ask_of_other_speeds(why, line_hz, windows_[window]);
  why.ask(Quantity::order_change, cut_.speed_change() * line_hz * windows_[window].like().seconds, still_order, true);
}

// While a spindle changes its speed the line of an order stands beside the orders of the speed before.
void CutTests::ask_of_other_speeds(Explanation& why, double line_hz, const Window& window) const noexcept {
  if (!given_ || !armed_ || line_hz <= 0.0) return;
  why.ask(Quantity::other_speed, speed_.lead_of_an_order(line_hz, window.power, window.like()), most_of_another_speed,
          true);
}

void CutTests::ask_of_the_turns(Explanation& why) const noexcept {
  why.ask(Quantity::rest_ratio, turn_split_.ratio(), least_rest);
  why.ask(Quantity::rest_holding, turn_split_.holding(), least_holding);
  why.ask(Quantity::rest_rise, turn_split_.rise(), least_rest_rise);
  why.ask(Quantity::repeating, turn_split_.repeating(), least_repeating);
  why.ask(Quantity::staying, turn_split_.staying(), least_rest_staying);
  why.ask(Quantity::above_quiet, turn_split_.above_quiet(), quiet_is_known);
  why.ask(Quantity::repeating_above_quiet, turn_split_.repeating_above_quiet(), least_repeating_above_quiet);
  why.ask(Quantity::loud_for, turn_split_.loud_s(), turn_split_.settled_s());
  why.ask(Quantity::rest_lasting, turn_split_.lasting(), least_lasting);
}

void CutTests::explain_all() noexcept {
  const auto begin = [&](Test test, int enough) -> Explanation& {
    Explanation& why = why_[static_cast<std::size_t>(test)];
    why = {.test = test, .enough_hops = enough, .speed_belief = static_cast<float>(belief())};
    return why;
  };
  Explanation& dominant = begin(Test::dominant, alarm_hops);
  dominant.ask(Quantity::line_share, dominant_.share(), DominantLine::least_share);
  dominant.ask(Quantity::line_kept, dominant_.kept(), least_kept);
  dominant.ask(Quantity::line_rise, dominant_.rise(), least_rise);
  dominant.ask(Quantity::above_quiet, cut_.above_quiet(), loud);
  dominant.ask(Quantity::line_rise_since, dominant_.rise_since(), least_rise_since);
  ask_of_other_speeds(dominant, dominant_.frequency_hz(), windows_[s_0_3]);

  Explanation& ratio = begin(Test::ratio, alarm_hops);
  Explanation& family = begin(Test::family, family_hops_);
  Explanation& growth = begin(Test::growth, growing_hops);
  if (armed_ && fast_.past_s() >= windows_[s_0_3].seconds) {
    const double of_orders = energy_ratio(found_far_.family, found_far_.synchronous);
    // Of a slow spindle one line cannot be told from the floor by its family: it is followed alone. A family of three
    // lines can.
    if (!slow_spindle_ || speed_.hint_hz() >= lowest_family_hz) {
      ratio.ask(Quantity::asynchronous_ratio, of_orders, least_ratio);
      ratio.ask(Quantity::mains_distance, from_the_mains(found_far_.frequency_hz), mains_width_hz);
      const bool quiet_known = cut_.above_quiet() >= quiet_is_known;
      if (quiet_known) ratio.ask(Quantity::family_above_quiet, energy_ratio(found_far_.family, cut_.quiet()), level);
      ask_of_the_cut(ratio, found_far_.frequency_hz, far_);
    }

    family.ask(Quantity::family_lines, found_far_.lines, least_lines);
    family.ask(Quantity::asynchronous_ratio, of_orders, family_ratio);
    family.ask(Quantity::family_growth, past_.growth(found_far_.family), FamilyPast::family_growth);
    ask_of_the_cut(family, found_far_.frequency_hz, far_);

    growth.ask(Quantity::line_growth, grown_.growth, GrowthTest::least_growth);
    growth.ask(Quantity::line_to_teeth, energy_ratio(grown_.energy, found_near_.teeth), of_the_teeth);
    growth.ask(Quantity::line_to_swing, energy_ratio(grown_.energy, cut_.swing()), of_the_swing);
    ask_of_the_cut(growth, grown_hz_, near_);
  }
  Explanation& slow = begin(Test::slow_ratio, 1);
  if (slow_spindle_ && slow_line_.frequency_hz() > 0.0) ask_of_the_turns(slow);
  Explanation& runaway = begin(Test::runaway, 1);
  runaway.ask(Quantity::runaway_rise, rises_ ? 1.0 : 0.0, 1.0);
  ask_what_is_new();
}

// What stands beside the orders is no noise of the air. Where the speed is not believed it may be the orders: then all
// is louder than in a calm that is known.
bool CutTests::lives() const noexcept {
  const double loud = cut_.above_quiet();
  if (loud >= quiet_is_known && found_far_.family >= 0.5 * level * cut_.quiet()) return true;
  if (belief() < least_belief && calm_known_ && loud < least_loud) return false;
  return found_far_.synchronous + found_far_.family >= explains * found_far_.whole;
}

bool CutTests::stays(Test test) const noexcept {
  const Explanation& why = why_[static_cast<std::size_t>(test)];
  if (why.conditions > 0 && why.held() == why.conditions && test != Test::dominant) return true;
  if (test == Test::slow_ratio) {
    return slow_spindle_ && turn_split_.ratio() >= 0.5 * least_rest &&
           turn_split_.above_quiet() >= 0.5 * quiet_is_known;
  }
  const bool of_line = alarm_ == Test::dominant || alarm_ == Test::runaway;
  switch (test) {
    case Test::dominant:
      return of_line && dominant_.share() >= 0.5 * DominantLine::least_share;
    case Test::ratio:
      return armed_ && lives() && found_far_.family >= 0.5 * least_ratio * found_far_.synchronous;
    case Test::family:
      return armed_ && alarm_ == Test::family && lives() && found_far_.lines >= 2 &&
             found_far_.family >= 0.5 * family_ratio * found_far_.synchronous;
    default:
      return false;
  }
}

}  // namespace robomill::monitor
