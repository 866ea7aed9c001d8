#include "robomill/monitor/files/explanation_schema.hpp"

#include <fmt/format.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/monitor/explanation.hpp"

namespace robomill::monitor {
namespace {

using io::key;
using io::Row;
using io::Schema;
using io::where;

/// Six digits: more a float has not.
double short_number(float value) {
  return std::stod(fmt::format("{:.6g}", value));
}

std::vector<std::string> names_of_quantities() {
  std::vector<std::string> names;
  for (const QuantityWords& words : quantity_words()) names.emplace_back(words.name);
  return names;
}

Row<Condition> threshold_key(const std::string& name, bool at_most) {
  return where([at_most](const Condition& condition) { return condition.at_most == at_most; },
               key(
                   name, [](const Condition& condition) { return short_number(condition.threshold); },
                   "the condition's threshold"));
}

const Schema<Condition>& condition_table() {
  static const Schema<Condition> table(
      "explained_condition", "what a test compares with a threshold",
      {key(
           "quantity", [](const Condition& condition) { return to_string(condition.quantity); }, "what is compared")
           .words(names_of_quantities()),
       key(
           "meaning", [](const Condition& condition) { return words_for(condition.quantity).meaning; },
           "of the quantity, for people"),
       key(
           "shown_in", [](const Condition& condition) { return unit_of(words_for(condition.quantity).scale); },
           "for people; value and threshold are ratios of energies, or s, or Hz; none: a plain number")
           .words({std::string(unit_of(Scale::decibels)), std::string(unit_of(Scale::seconds)),
                   std::string(unit_of(Scale::hertz))})
           .nullable(),
       key(
           "value", [](const Condition& condition) { return short_number(condition.value); }, "none: no finite number")
           .nullable(),
       threshold_key("at_least", false), threshold_key("at_most", true),
       key(
           "holds", [](const Condition& condition) { return condition.holds(); }, "whether the value keeps to it")},
      io::Use::written);
  return table;
}

}  // namespace

const Schema<Explanation>& explanation_table() {
  using Why = Explanation;
  static const Schema<Why> table(
      "explanation", "why a decision is what it is",
      {key("test", &Why::test, test_names, "that holds the alarm, or came closest to one"),
       key(
           "sensor", [](const Why& why) { return why.sensor > 0 ? std::optional(why.sensor) : std::nullopt; },
           "that it is about, from 1, in the order of signal.sensors; none: there is one")
           .nullable(),
       key("hops", &Why::hops, "in which it held, of the last 8; of `growth` in a row"),
       key("of", &Why::enough_hops, "hops that an alarm takes"),
       key(
           "speed_belief", [](const Why& why) { return short_number(why.speed_belief); },
           "in the tracked speed, 0 to 1"),
       key(
           "conditions",
           [](const Why& why) {
             return std::vector<Condition>(why.condition.begin(), why.condition.begin() + why.conditions);
           },
           condition_table(), "all that the test asks for")},
      io::Use::written);
  return table;
}

}  // namespace robomill::monitor
