#include "robomill/live/session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/live/health/watchdog.hpp"

namespace robomill::live {
namespace {

using monitor::BlindReason;
using monitor::MonitorEvent;
using monitor::State;

/// Hops between input and detector: 1.6 s at 25 ms.
constexpr std::size_t queued_hops = 64;
constexpr std::chrono::milliseconds longest_wait{100};
/// Faults that come and go are emitted at most so often.
constexpr double fault_pause_s = 1.0;
/// Chatter is emitted again when its frequency has moved by so much, and at most so often.
constexpr double frequency_step_hz = 2.0, frequency_pause_s = 0.25;
constexpr double speed_patience_s = 3.0;
/// A hint that the signal contradicts by so much, for so long, is reported once.
constexpr double contradicting_ratio = 0.02, contradicting_s = 1.0, surely_ratio = 0.02;
/// Samples lost for less, a hop say, are counted and notified, but make no event of their own.
constexpr double shortest_gap_s = 1.0;

void make_blind(monitor::Decision& decision, BlindReason reason) {
  decision.state = State::blind;
  decision.reason = reason;
  decision.chatter_frequency_hz = decision.chatter_frequency_std_hz = 0.0;
  decision.channel = 0;
  decision.synchronous = monitor::SynchronousChatter::none;
  decision.why = {};
}

}  // namespace

Session::Session(const monitor::MonitorFile& file, SessionOptions options, SessionOutputs outputs)
    : file_(file),
      options_(options),
      outputs_(std::move(outputs)),
      monitor_((monitor::validate(file), file.options)),
      queue_(queued_hops),
      actor_(file.act, file.options.spindle_speed_rad_per_s),
      hint_rad_per_s_(file.options.spindle_speed_rad_per_s),
      load_(options.live, file.options.look_back_s()) {
  if (!file_.recording_folder.empty()) {
    ring_.emplace(AlarmRing::Options{.folder = file_.recording_folder,
                                     .seconds = file_.recording_s,
                                     .channels = file_.options.channels,
                                     .sample_rate_hz = file_.options.sample_rate_hz},
                  [this](const std::filesystem::path& written, const std::string& error) {
                    if (error.empty()) {
                      notices_.add("alarm-recorded", written.string());
                    } else {
                      notices_.add("recording-failed", error);
                    }
                  });
  }
}

double Session::time_s() const {
  return static_cast<double>(frames_) / file_.options.sample_rate_hz;
}

void Session::run(const std::atomic<bool>& stop) {
  const auto timeout = std::chrono::milliseconds(std::lround(1e3 * file_.timeout_s));
  const std::chrono::milliseconds wait = std::clamp(timeout, std::chrono::milliseconds(1), longest_wait);
  Hop hop;
  samples_at_ = Clock::now();
  std::optional<Watchdog> watchdog;
  if (options_.live) watchdog.emplace(queue_, [this](double more_s, bool begins) { stall(more_s, begins); });
  while (!stop && !ended_) {
    const HopQueue::Taken taken = queue_.pop(hop, wait);
    if (taken == HopQueue::Taken::closed) break;
    if (taken == HopQueue::Taken::hop) {
      if (silence_s_ > 0.0) check_silence(Clock::now());
      process(std::move(hop));
    } else {
      if (outputs_.idle) outputs_.idle();
      if (options_.live) check_silence(Clock::now());
    }
    metrics_.queued_hops = queue_.size();
    emit_notices();
    if (options_.seconds > 0.0 && time_s() >= options_.seconds) break;
  }
  watchdog.reset();
  queue_.close();
  if (ring_) ring_->finish();
  emit_notices(true);
}

void Session::check_silence(Clock::time_point now) {
  const double silence_s = std::chrono::duration<double>(now - samples_at_).count();
  if (silence_s < file_.timeout_s) return;
  const double more_s = silence_s - std::exchange(silence_s_, silence_s);
  metrics_.add_blind(BlindReason::no_signal, more_s);
  if (outputs_.silent) outputs_.silent(more_s);
  become_blind(BlindReason::no_signal);
}

void Session::become_blind(BlindReason reason) {
  take_stall();
  if (last_.state == State::blind && last_.reason == reason) return;
  last_.changed = last_.state != State::blind;
  make_blind(last_, reason);
  metrics_.set_state(last_);
  MonitorEvent event;
  event.kind = MonitorEvent::Kind::state;
  event.time_s = time_s();
  event.decision = last_;
  emit_state(event);
}

void Session::leave_out(std::uint64_t frames, bool dropped) {
  if (frames == 0) return;
  const BlindReason reason = dropped ? BlindReason::overloaded : BlindReason::gap;
  const double gap_s = static_cast<double>(frames) / file_.options.sample_rate_hz;
  // Time that went by without samples was counted as it went.
  count_blind(reason, std::max(0.0, gap_s - silence_s_));
  if (gap_s >= shortest_gap_s && silence_s_ == 0.0) become_blind(reason);
  frames_ += frames;
  base_s_ += gap_s;
  if (outputs_.skipped) outputs_.skipped(frames, reason);
}

void Session::judge_load(const Hop& hop) {
  load_.take(hop, time_s(), queue_.size() == 0, Clock::now());
  metrics_.behind_s = load_.behind_s();
  if (!load_.overloaded()) {
    stall_counted_s_ = 0.0;
  } else if (last_.state != State::chatter) {
    become_blind(BlindReason::overloaded);
  }
}

/// What the watchdog has published is the state now.
void Session::take_stall() {
  const PublishedState::Stall stall = published_.take_stall();
  if (stall.was) load_.stalled();
  if (stall.published) make_blind(last_, BlindReason::overloaded);
}

/// Of the watchdog's thread.
void Session::stall(double more_s, bool begins) {
  metrics_.add_blind(BlindReason::overloaded, more_s);
  stall_counted_s_.fetch_add(more_s);
  metrics_.behind_s.fetch_add(more_s);
  metrics_.queued_hops = queue_.size();
  if (!begins || !published_.begin_stall()) return;
  MonitorEvent event;
  event.kind = MonitorEvent::Kind::state;
  event.time_s = metrics_.stream_s;
  event.decision.changed = true;
  event.decision.score = metrics_.score;
  event.decision.threshold = metrics_.threshold;
  event.decision.energy_entropy = metrics_.energy_entropy;
  event.decision.level = metrics_.level;
  make_blind(event.decision, BlindReason::overloaded);
  metrics_.set_state(event.decision);
  ++metrics_.events;
  if (outputs_.overloaded) outputs_.overloaded(event, monitor::event_line(event));
  published_.end_stall();
}

void Session::count_blind(BlindReason reason, double stream_s) {
  if (reason == BlindReason::overloaded) {
    // Of a stall the clock's time was counted as it went by.
    const double counted_s = std::min(stall_counted_s_.load(), stream_s);
    stall_counted_s_.fetch_sub(counted_s);
    stream_s -= counted_s;
  }
  metrics_.add_blind(reason, stream_s);
}

void Session::process(Hop&& hop) {
  take_stall();
  leave_out(hop.frames_before, hop.dropped);
  if (hop.restarted) begin_anew();
  judge_load(hop);
  take_speed(hop.spindle_speed_rad_per_s);
  const auto channels = static_cast<std::size_t>(file_.options.channels);
  std::span<const float> rest = hop.samples;
  while (!rest.empty()) {
    const std::size_t count = std::min(rest.size(), monitor_.frames_to_next_decision() * channels);
    const Clock::time_point begin = Clock::now();
    const monitor::Decision decision = monitor_.push(rest.first(count));
    compute_s_ += std::chrono::duration<double>(Clock::now() - begin).count();
    rest = rest.subspan(count);
    frames_ += count / channels;
    if (decision.hop == last_.hop) continue;
    decide(decision, std::exchange(compute_s_, 0.0));
  }
  if (outputs_.samples) outputs_.samples(hop.samples);
  samples_at_ = Clock::now();
  silence_s_ = 0.0;
  if (!ring_) return;
  ring_->add(std::move(hop.samples));
  if (std::exchange(alarm_, false) && !ring_->alarm(base_s_ + last_.time_s)) {
    notices_.add("recording-failed", "alarms come faster than they can be written");
  }
}

/// A speed that is not known says nothing against the one before, but that a spindle no longer stands still for sure.
void Session::take_speed(double rad_per_s) {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  const bool known = std::isfinite(rad_per_s) && rad_per_s >= 0.0;
  const bool was_still = speed_rad_per_s_ < file_.options.min_speed_rad_per_s;
  if (known ? rad_per_s == speed_rad_per_s_ : !was_still) return;
  speed_rad_per_s_ = known ? rad_per_s : unknown;
  const double hint_rad_per_s = hint_rad_per_s_ > 0.0 ? hint_rad_per_s_ : unknown;
  monitor_.set_spindle_speed(known ? rad_per_s : hint_rad_per_s);
}

void Session::begin_anew() {
  monitor_.reset();
  base_s_ = time_s();
  last_.hop = 0;
}

void Session::decide(monitor::Decision decision, double compute_s) {
  take_stall();
  const bool doubt = published_.take_doubt();
  if (load_.overloaded() && decision.state != State::chatter) make_blind(decision, BlindReason::overloaded);
  // Against what was emitted: a detector that begins anew compares with a stable state that never was.
  decision.changed = decision.state != last_.state;
  const bool blind = decision.state == State::blind;
  const bool reason_news = blind && decision.reason != last_.reason;
  last_ = decision;
  const double time_s = base_s_ + decision.time_s;
  metrics_.set(decision);
  metrics_.stream_s = time_s;
  metrics_.compute_s = compute_s;
  if (blind) {
    count_blind(decision.reason, static_cast<double>(file_.options.hop_samples()) / file_.options.sample_rate_hz);
  }
  if (decision.changed && decision.state == State::chatter) {
    ++metrics_.alarms;
    alarm_ = true;
  }
  if (outputs_.decision) outputs_.decision(decision, time_s, compute_s);
  check_hint(decision);
  const bool fault_news = fault_is_news(decision);
  const bool frequency_news = frequency_is_news(decision);
  const bool state_news = decision.changed || reason_news || frequency_news || doubt;
  const bool act_due = actor_.observe(decision, time_s);
  const auto event_of = [&](MonitorEvent::Kind kind) {
    MonitorEvent event;
    event.kind = kind;
    event.time_s = time_s;
    event.decision = decision;
    event.compute_s = compute_s;
    event.explained = options_.why;
    advise(event);
    return event;
  };
  // A change of state holds the faults; where they are its cause they are news of their own.
  if (fault_news && (!state_news || blind)) emit(event_of(MonitorEvent::Kind::fault));
  const bool window_news = !state_news && !fault_news && options_.every_window;
  if (!state_news && !window_news && !act_due) return;
  MonitorEvent event = event_of(state_news ? MonitorEvent::Kind::state : MonitorEvent::Kind::window);
  act(event);
  if (event.kind == MonitorEvent::Kind::state) {
    emit_state(event);
  } else if (window_news) {
    emit(event);
  }
}

void Session::check_hint(const monitor::Decision& decision) {
  const double given = speed_rad_per_s_ > 0.0 ? speed_rad_per_s_ : file_.options.spindle_speed_rad_per_s;
  const double found = decision.spindle_speed_rad_per_s;
  const bool sure = found > 0.0 && (decision.faults & monitor::speed_unknown) == 0 &&
                    decision.spindle_speed_std_rad_per_s < surely_ratio * found;
  const bool contradicts = given > 0.0 && sure && std::abs(found / given - 1.0) > contradicting_ratio;
  contradicting_hops_ = contradicts ? contradicting_hops_ + 1 : 0;
  if (static_cast<double>(contradicting_hops_) * file_.options.hop_s < contradicting_s ||
      given == contradicted_rad_per_s_)
    return;
  contradicted_rad_per_s_ = given;
  notices_.add("spindle-speed",
               fmt::format("the signal says {:.0f} rpm, {:.0f} rpm was given", found / units::rpm, given / units::rpm));
}

bool Session::fault_is_news(const monitor::Decision& decision) {
  const double time_s = base_s_ + decision.time_s;
  std::uint32_t faults = decision.faults;
  // A comb takes a while to be found: no fault yet.
  if ((faults & monitor::speed_unknown) == 0) {
    speed_known_s_ = time_s;
  } else if (time_s - speed_known_s_ < speed_patience_s) {
    faults &= ~static_cast<std::uint32_t>(monitor::speed_unknown);
  }
  if (faults == emitted_faults_ || time_s - faults_emitted_s_ < fault_pause_s) return false;
  emitted_faults_ = faults;
  faults_emitted_s_ = time_s;
  return true;
}

bool Session::frequency_is_news(const monitor::Decision& decision) {
  if (decision.state != State::chatter || decision.chatter_frequency_hz <= 0.0) return false;
  const double time_s = base_s_ + decision.time_s;
  const double step_hz = std::max(frequency_step_hz, 3.0 * decision.chatter_frequency_std_hz);
  const bool moved = std::abs(decision.chatter_frequency_hz - emitted_frequency_hz_) > step_hz;
  if (!decision.changed && (!moved || time_s - frequency_emitted_s_ < frequency_pause_s)) return false;
  emitted_frequency_hz_ = decision.chatter_frequency_hz;
  frequency_emitted_s_ = time_s;
  return true;
}

void Session::emit_notices(bool all) {
  for (Notice& notice : notices_.take(Notices::Clock::now(), all)) {
    MonitorEvent event;
    event.kind = MonitorEvent::Kind::stream;
    event.time_s = time_s();
    event.decision = last_;
    event.what = notice.what;
    event.count = notice.count;
    event.message = std::move(notice.message);
    if (notice.what == "alarm-recorded") {
      event.kind = MonitorEvent::Kind::recording;
      event.file = std::exchange(event.message, {});
    }
    advise(event);
    emit(event);
  }
}

void Session::advise(MonitorEvent& event) const {
  const monitor::Decision& d = event.decision;
  if (!outputs_.advise || d.state != monitor::State::chatter || d.chatter_frequency_hz <= 0.0) return;
  // While the spindle changes its speed the detector's is the one of before.
  if (!outputs_.command || !actor_.settling()) outputs_.advise(event);
}

void Session::emit(const MonitorEvent& event) {
  ++metrics_.events;
  if (outputs_.event && !outputs_.event(event, monitor::event_line(event))) ended_ = true;
}

void Session::emit_state(const MonitorEvent& event) {
  published_.begin(event.decision.state == State::blind && event.decision.reason == BlindReason::overloaded);
  emit(event);
  published_.end();
}

void Session::act(MonitorEvent& event) {
  const std::optional<Command> command = actor_.act(event);
  if (!command) return;
  event.kind = MonitorEvent::Kind::state;
  if (!outputs_.command) return;
  outputs_.command(*command);
  if (command->kind == Command::Kind::spindle_speed) hint_rad_per_s_ = command->spindle_speed_rad_per_s;
  // A stream that carries the speed says itself when the spindle turns at another one.
  if (command->kind == Command::Kind::spindle_speed && std::isnan(speed_rad_per_s_)) {
    monitor_.set_spindle_speed(command->spindle_speed_rad_per_s);
  }
}

}  // namespace robomill::live
