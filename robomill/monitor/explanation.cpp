#include "robomill/monitor/explanation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace robomill::monitor {
namespace {

constexpr std::array quantity_table = {
    QuantityWords{Quantity::line_share, "line_share", "share of the strongest unforced line in all energy"},
    QuantityWords{Quantity::line_kept, "line_kept", "hops of the last 12 in which that line kept its frequency"},
    QuantityWords{Quantity::line_rise, "line_rise", "rise of that line in 1.7 s", Scale::decibels},
    QuantityWords{Quantity::line_rise_since, "line_rise_since", "rise of that line since it dominates",
                  Scale::decibels},
    QuantityWords{Quantity::above_quiet, "above_quiet", "all energy above the quietest of late", Scale::decibels},
    QuantityWords{Quantity::speed_belief, "speed_belief", "belief in the tracked speed"},
    QuantityWords{Quantity::anchored, "anchored", "energy of the orders, to what a right speed leaves them"},
    QuantityWords{Quantity::cutting, "cutting", "signs that the tool cuts"},
    QuantityWords{Quantity::staying, "staying", "all energy, to its most of late"},
    QuantityWords{Quantity::entered, "entered", "time since the tool entered", Scale::seconds},
    QuantityWords{Quantity::asynchronous_ratio, "asynchronous_ratio", "energy beside the orders, to theirs"},
    QuantityWords{Quantity::family_above_quiet, "family_above_quiet",
                  "energy beside the orders, above the quietest of late", Scale::decibels},
    QuantityWords{Quantity::mains_distance, "mains_distance", "distance of the line to hum", Scale::hertz},
    QuantityWords{Quantity::order_change, "order_change",
                  "movement of the order beside it in 0.3 s, in widths of a line"},
    QuantityWords{Quantity::family_lines, "family_lines", "lines beside the orders that belong together"},
    QuantityWords{Quantity::family_growth, "family_growth", "growth of these lines in 2 s", Scale::decibels},
    QuantityWords{Quantity::line_growth, "line_growth", "growth of a line beside tooth passing in 1 s",
                  Scale::decibels},
    QuantityWords{Quantity::line_to_teeth, "line_to_teeth", "energy of that line, to tooth passing"},
    QuantityWords{Quantity::line_to_swing, "line_to_swing", "its energy, to the change of the orders in 0.3 s"},
    QuantityWords{Quantity::line_sustained, "line_sustained", "its last turn, to the strongest 25 ms"},
    QuantityWords{Quantity::line_kept_up, "line_kept_up", "its last two turns, the weaker one, to the strongest 25 ms"},
    QuantityWords{Quantity::line_spread, "line_spread", "how evenly its energy is spread over the window"},
    QuantityWords{Quantity::line_new, "line_new", "that line above what the machine shows without chatter",
                  Scale::decibels},
    QuantityWords{Quantity::other_speed, "other_speed",
                  "evidence for a speed at which it is an order, beyond that for the tracked one"},
    QuantityWords{Quantity::rest_ratio, "rest_ratio",
                  "energy that does not repeat from turn to turn, to that which does"},
    QuantityWords{Quantity::rest_holding, "rest_holding", "that energy in the second half of its window, to the first"},
    QuantityWords{Quantity::rest_rise, "rest_rise", "rise of that energy in 2 s", Scale::decibels},
    QuantityWords{Quantity::rest_lasting, "rest_lasting", "part of the last 0.4 s in which all of that was so"},
    QuantityWords{Quantity::repeating, "repeating", "energy that repeats, to its most of a second"},
    QuantityWords{Quantity::repeating_above_quiet, "repeating_above_quiet",
                  "energy that repeats, above the quietest of late", Scale::decibels},
    QuantityWords{Quantity::loud_for, "loud_for", "time since the cut stands above the quietest", Scale::seconds},
    QuantityWords{Quantity::runaway_rise, "runaway_rise", "a line grows exponentially (1: it does)"},
    QuantityWords{Quantity::agreement, "agreement", "agreement of the sensors, to what an alarm takes"}};

consteval bool is_in_order() {
  for (std::size_t i = 0; i < quantity_table.size(); ++i) {
    if (static_cast<std::size_t>(quantity_table[i].quantity) != i) return false;
  }
  return quantity_table.back().quantity == Quantity::agreement;
}
static_assert(is_in_order());

std::string shown_value(Scale scale, double value) {
  if (scale != Scale::decibels) return fmt::format("{:.3g}", value);
  constexpr double least = 1e-30;
  return fmt::format("{:.1f}", 10.0 * std::log10(std::max(value, least)));
}

std::span<const Condition> conditions_of(const Explanation& why) {
  return std::span(why.condition).first(static_cast<std::size_t>(why.conditions));
}

}  // namespace

std::span<const QuantityWords> quantity_words() {
  return quantity_table;
}

const QuantityWords& words_for(Quantity quantity) {
  return quantity_table[std::min(static_cast<std::size_t>(quantity), quantity_table.size() - 1)];
}

std::string_view unit_of(Scale scale) {
  if (scale == Scale::decibels) return "dB";
  if (scale == Scale::hertz) return "Hz";
  return scale == Scale::seconds ? "s" : "";
}

std::string condition_text(const Condition& condition) {
  const QuantityWords& words = words_for(condition.quantity);
  const std::string_view unit = unit_of(words.scale);
  const auto with_unit = [&](float value) {
    return shown_value(words.scale, static_cast<double>(value)) + (unit.empty() ? "" : fmt::format(" {}", unit));
  };
  return fmt::format("{}: {} (at {} {})", words.meaning, with_unit(condition.value),
                     condition.at_most ? "most" : "least", with_unit(condition.threshold));
}

std::string why_text(const Explanation& why, State state) {
  if (why.test == Test::none || why.conditions == 0) return {};
  const std::string test = fmt::format("{} ({} of {} hops{})", to_string(why.test), why.hops, why.enough_hops,
                                       why.sensor > 0 ? fmt::format(" of sensor {}", why.sensor) : "");
  const std::span<const Condition> conditions = conditions_of(why);
  if (state == State::chatter) {
    std::string out = fmt::format("chatter by {}: ", test);
    for (const Condition& condition : conditions) {
      out += fmt::format("{}{}", &condition == conditions.data() ? "" : "; ", condition_text(condition));
    }
    return out;
  }
  const auto lacks = std::ranges::find_if_not(conditions, &Condition::holds);
  if (lacks == conditions.end()) return fmt::format("no alarm; closest is {}, which lacks hops alone", test);
  return fmt::format("no alarm; closest is {}, which lacks {}", test, condition_text(*lacks));
}

}  // namespace robomill::monitor
