#include "robomill/live/act.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/names.hpp"
#include "robomill/base/units.hpp"

namespace robomill::live {
namespace {

using monitor::ActRule;
using monitor::MonitorEvent;
using monitor::State;

/// Speeds closer than this share are one.
constexpr double same_speed = 0.01;
/// In which chatter's frequency becomes known well enough to name its mode.
constexpr double patience_s = 0.5;
constexpr double rounding_s = 1e-9;

bool same(double a, double b) {
  return std::abs(a - b) <= same_speed * b;
}

std::string rpm_text(double rad_per_s) {
  return fmt::format("{:.0f} rpm", rad_per_s / units::rpm);
}

void validate(const monitor::ActSettings& s) {
  if (!(s.reduce_to > 0.0 && s.reduce_to < 1.0)) {
    throw InvalidInput("reduce_to", s.reduce_to, "", "must lie between 0 and 1");
  }
  require_non_negative("retract_m", s.retract_m, "m");
  if (s.rule == ActRule::hold) {
    require_positive("retract_m", s.retract_m, "m", "A tool that stands still in the cut rubs and marks the part");
  }
  require_non_negative("lowest_rad_per_s", s.lowest_rad_per_s, "rad/s");
  require_non_negative("highest_rad_per_s", s.highest_rad_per_s, "rad/s");
  if (s.highest_rad_per_s > 0.0 && s.highest_rad_per_s <= s.lowest_rad_per_s) {
    throw InvalidInput("highest_rad_per_s", s.highest_rad_per_s, "rad/s", "must be above lowest_rad_per_s");
  }
  require_positive("settle_s", s.settle_s, "s");
  require_positive("calm_s", s.calm_s, "s");
}

/// The suggested one, then those of whole periods, nearest first; each once.
std::vector<double> suggestions(const MonitorEvent& event) {
  std::vector<double> out;
  if (event.suggested_spindle_speed_rad_per_s > 0.0) out.push_back(event.suggested_spindle_speed_rad_per_s);
  for (const double speed : event.stable_speeds_rad_per_s) {
    if (std::ranges::none_of(out, [speed](double other) { return same(speed, other); })) out.push_back(speed);
  }
  return out;
}

std::string why_no_speed(const MonitorEvent& event) {
  switch (event.no_speed) {
    case monitor::NoSpeed::arm:
      return "a mode of the arm chatters, which no spindle speed in range avoids: take less depth or another posture";
    case monitor::NoSpeed::unclear:
      return "it is not clear whether a mode of the arm chatters, which no spindle speed would avoid";
    case monitor::NoSpeed::mode_coupling:
      return "modes couple through the force, whatever the spindle speed: take less depth or another feed direction";
    case monitor::NoSpeed::forced_vibration:
      return "at the speeds of its lobes tooth passing makes the tip vibrate by more than the feed per tooth: "
             "take less depth";
    case monitor::NoSpeed::ambiguous_alias:
      return fmt::format("signal.anti_alias_filter is not stated: the line may be {}",
                         monitor::line_text(event.line_hz));
    case monitor::NoSpeed::none:
      break;
  }
  if (!(event.decision.chatter_frequency_hz > 0.0)) return "the frequency of chatter is not known";
  return "no speed is suggested: is the number of teeth known?";
}

}  // namespace

Actor::Actor(const monitor::ActSettings& settings, double spindle_speed_rad_per_s)
    : settings_((validate(settings), settings)), given_rad_per_s_(spindle_speed_rad_per_s) {
  require_non_negative("spindle_speed_rad_per_s", spindle_speed_rad_per_s, "rad/s");
}

bool Actor::observe(const monitor::Decision& decision, double time_s) noexcept {
  const double passed_s = std::max(0.0, time_s - std::exchange(observed_s_, time_s));
  if (settings_.rule == ActRule::none || decision.state == State::blind) return false;
  const bool chatters = decision.state == State::chatter;
  if (settling_s_ > 0.0) {
    settling_s_ = std::max(0.0, settling_s_ - passed_s - rounding_s);
    if (chatters && settling_s_ > 0.0) return false;
  }
  stable_for_s_ = decision.state != State::stable ? -1.0 : stable_for_s_ < 0.0 ? 0.0 : stable_for_s_ + passed_s;
  if (alarm_ && stable_for_s_ >= settings_.calm_s - rounding_s) {
    alarm_ = held_ = false;
    release_due_ = settings_.rule == ActRule::reduce && feed_override_ < 1.0;
  }
  if (chatters && !alarm_) {
    alarm_ = true;
    said_ = false;
    waiting_s_ = 0.0;
    tried_.clear();
  } else if (chatters) {
    waiting_s_ += passed_s;
  }
  return release_due_ || (chatters && settings_.rule == ActRule::speed);
}

std::optional<Command> Actor::act(MonitorEvent& event) {
  const bool of_decision = event.kind != MonitorEvent::Kind::stream && event.kind != MonitorEvent::Kind::recording;
  if (settings_.rule == ActRule::none || !of_decision) return std::nullopt;
  std::optional<Command> command;
  if (event.decision.state == State::blind) {
    if (event.kind == MonitorEvent::Kind::state) event.message = in_force();
  } else if (std::exchange(release_due_, false)) {
    feed_override_ = 1.0;
    command = Command{.kind = Command::Kind::release,
                      .reason = fmt::format("stable for {:.3g} s", settings_.calm_s),
                      .not_claimed = "chatter may come back at the full feed: nothing but the feed was changed"};
  } else if (event.decision.state == State::chatter) {
    command = on_chatter(event);
  }
  if (!command) return std::nullopt;
  command->time_s = event.time_s;
  command->feed_override = feed_override_;
  event.command = name_in(command_names, command->kind);
  event.message = command->reason;
  return command;
}

std::optional<Command> Actor::on_chatter(const MonitorEvent& event) {
  if (settings_.rule == ActRule::speed) return change_speed(event);
  if (settings_.rule == ActRule::reduce) {
    if (feed_override_ < 1.0) return std::nullopt;
    feed_override_ = settings_.reduce_to;
    return Command{.kind = Command::Kind::feed,
                   .reason = fmt::format("chatter: feed to {:.0f} % until it has been stable for {:.3g} s",
                                         100.0 * settings_.reduce_to, settings_.calm_s),
                   .not_claimed =
                       "it bounds the damage and does not end regenerative chatter, whose limit of depth "
                       "does not depend on the feed"};
  }
  if (held_ && !event.decision.changed) return std::nullopt;
  held_ = true;
  return Command{
      .kind = Command::Kind::hold,
      .retract_m = settings_.retract_m,
      .reason = fmt::format("chatter: stop, and {:.4g} mm out of the cut", settings_.retract_m / units::mm),
      .not_claimed = "it ends this cut and not the cause of chatter: people change speed or depth, and resume"};
}

std::optional<Command> Actor::change_speed(const MonitorEvent& event) {
  if (settling_s_ > 0.0) return std::nullopt;
  const double tracked = event.decision.spindle_speed_rad_per_s;
  const double present = tracked > 0.0 ? tracked : commanded_rad_per_s_ > 0.0 ? commanded_rad_per_s_ : given_rad_per_s_;
  if (!(present > 0.0)) return nothing("the spindle speed is not known");
  if (programmed_rad_per_s_ == 0.0) programmed_rad_per_s_ = present;
  if (tried_.empty()) tried_.push_back(present);
  const std::vector<double> speeds = suggestions(event);
  if (speeds.empty()) return nothing(why_no_speed(event));
  if (tried_.size() == 1) suggested_ = speeds.size();
  const auto next = std::ranges::find_if(speeds, [this](double speed) { return allowed(speed); });
  if (next == speeds.end() || tried_.size() > suggested_) {
    if (tried_.size() == 1) return nothing("no suggested speed lies in the allowed range");
    return nothing(fmt::format("chatter is still there after {} change{} of speed: take less depth", tried_.size() - 1,
                               tried_.size() == 2 ? "" : "s"));
  }
  tried_.push_back(*next);
  said_ = false;
  waiting_s_ = 0.0;
  commanded_rad_per_s_ = *next;
  feed_override_ = *next / programmed_rad_per_s_;
  settling_s_ = settings_.settle_s;
  return Command{.kind = Command::Kind::spindle_speed,
                 .spindle_speed_rad_per_s = *next,
                 .feed_first = *next < present,
                 .reason = fmt::format("chatter at {:.1f} Hz: from {} to {}, feed to {:.1f} %",
                                       event.decision.chatter_frequency_hz, rpm_text(present), rpm_text(*next),
                                       100.0 * feed_override_),
                 .not_claimed =
                     "the depth may be above the limit of this speed, too: where chatter is still there when "
                     "the spindle has settled, the next speed follows"};
}

std::optional<Command> Actor::nothing(std::string reason) {
  if (said_ || waiting_s_ < patience_s - rounding_s) return std::nullopt;
  said_ = true;
  return Command{.kind = Command::Kind::none, .reason = std::move(reason), .not_claimed = "chatter goes on"};
}

bool Actor::allowed(double speed_rad_per_s) const {
  constexpr double least_share = 0.5;
  const double lowest =
      settings_.lowest_rad_per_s > 0.0 ? settings_.lowest_rad_per_s : least_share * programmed_rad_per_s_;
  const double highest = settings_.highest_rad_per_s > 0.0 ? settings_.highest_rad_per_s : programmed_rad_per_s_;
  return speed_rad_per_s >= lowest && speed_rad_per_s <= highest &&
         speed_rad_per_s <= greatest_feed_override * programmed_rad_per_s_ &&
         std::ranges::none_of(tried_, [&](double tried) { return same(tried, speed_rad_per_s); });
}

std::string Actor::in_force() const {
  const std::string feed =
      feed_override_ == 1.0 ? std::string() : fmt::format("a feed override of {:.1f} %", 100.0 * feed_override_);
  std::string rest;
  if (held_) {
    rest = "; the hold stays";
  } else if (commanded_rad_per_s_ > 0.0) {
    rest = fmt::format("; {} and {} stay", rpm_text(commanded_rad_per_s_), feed.empty() ? "the full feed" : feed);
  } else if (!feed.empty()) {
    rest = fmt::format("; {} stays", feed);
  }
  return "blind: nothing is commanded" + rest;
}

}  // namespace robomill::live
