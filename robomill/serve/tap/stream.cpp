#include "robomill/serve/tap/stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <exception>
#include <memory>
#include <string_view>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/printable.hpp"
#include "robomill/serve/error_json.hpp"

namespace robomill::serve {
namespace {

constexpr std::array<const char*, 4> stream_status_names = {"connecting", "receiving", "silent", "failed"};
constexpr std::size_t most_waiting_records = 4, most_kinds = 16;
constexpr std::chrono::milliseconds hop_wait{100}, publish_pause{500}, silent_after{2000};

monitor::MonitorFile stream_file(const TapStream::Options& options) {
  monitor::MonitorFile out;
  out.path = options.config;
  out.mqtt = options.broker;
  if (!monitor::parse_mqtt_address(options.address, out.mqtt)) {
    throw InvalidInput("stream", printable(options.address.substr(0, 100)) + " is no address of a stream",
                       "Write mqtt://HOST:PORT/TOPIC");
  }
  out.columns.channels = options.channels;
  out.options.channels = static_cast<int>(options.channels.size());
  out.options.sample_rate_hz = options.trigger.sample_rate_hz;
  return out;
}

/// The intake names the keys of monitor.toml.
std::string in_words_of_hits(std::string text) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 2> words = {
      {{"signal.sample_rate_hz", "acquisition.sample_rate_hz"}, {"signal.channels", "force and responses"}}};
  for (const auto& [theirs, ours] : words) {
    const std::size_t at = text.find(theirs);
    if (at != std::string::npos) text.replace(at, theirs.size(), ours);
  }
  return text;
}

}  // namespace

TapStream::TapStream(Options options, std::function<void()> arrived, std::function<void(const io::Json&)> changed)
    : options_(std::move(options)),
      file_(stream_file(options_)),
      arrived_(std::move(arrived)),
      changed_(std::move(changed)) {
  if (!options_.open) {
    throw InvalidInput("stream", options_.address + " is a stream, and this server takes none",
                       "Leave it out: hits come as files in the folder");
  }
  options_.trigger.validate();
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

TapStream::~TapStream() {
  stop();
}

void TapStream::stop() {
  stop_ = true;
  thread_.request_stop();
  queue_.close();
}

void TapStream::run(const std::stop_token& stop) {
  io::Json error = nullptr;
  try {
    receive(stop);
    return;
  } catch (const InvalidInput& found) {
    error = error_object(found, options_.root);
  } catch (const std::exception& found) {
    error = error_object(client_text(found.what(), options_.root));
  }
  {
    const std::lock_guard lock(mutex_);
    status_ = Status::failed;
    error_ = std::move(error);
    recording_ = false;
  }
  try {
    publish_changes();
  } catch (const std::exception&) {
    // Who asks for the state sees it all the same.
  }
}

void TapStream::receive(const std::stop_token& stop) {
  using Clock = std::chrono::steady_clock;
  modal::HitTrigger trigger(options_.trigger,
                            {.triggered =
                                 [this] {
                                   const std::lock_guard lock(mutex_);
                                   ++triggered_;
                                   triggered_by_ = options_.direction;
                                 },
                             .record = [this](const modal::HitRecord& record) { take_record(record); },
                             .discarded = [this](const modal::HitRecord&) { reject("samples were lost in it"); }});
  const std::shared_ptr<void> connection = options_.open(file_, {queue_, notices_, metrics_}, stop_);
  live::Hop hop;
  Clock::time_point came = Clock::now(), published = came - publish_pause;
  Status status = Status::silent;
  while (!stop.stop_requested()) {
    const live::HopQueue::Taken taken = queue_.pop(hop, hop_wait);
    if (taken == live::HopQueue::Taken::closed) return;
    const Clock::time_point now = Clock::now();
    if (taken == live::HopQueue::Taken::hop) {
      if (hop.frames_before > 0 || hop.restarted) trigger.gap(std::max<std::uint64_t>(1, hop.frames_before));
      trigger.add(hop.samples);
      came = now;
      status = Status::receiving;
    } else if (now - came > silent_after) {
      status = Status::silent;
    }
    {
      const std::lock_guard lock(mutex_);
      if (status_ != Status::connecting || status == Status::receiving || now - came > silent_after) status_ = status;
      level_n_ = trigger.level_n();
      recording_ = trigger.recording();
    }
    if (now - published < publish_pause) continue;
    published = now;
    gather_notices();
    publish_changes();
  }
}

void TapStream::take_record(const modal::HitRecord& record) {
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.size() < most_waiting_records) {
      waiting_.push_back({.record = record, .direction = triggered_by_});
    } else {
      ++discarded_["hits came faster than they can be evaluated"];
    }
  }
  arrived_();
}

void TapStream::reject(const std::string& reason) {
  const std::lock_guard lock(mutex_);
  ++discarded_[reason];
}

void TapStream::gather_notices() {
  const std::vector<live::Notice> due = notices_.take(live::Notices::Clock::now());
  const std::lock_guard lock(mutex_);
  for (const live::Notice& notice : due) {
    if (noticed_.size() >= most_kinds && !noticed_.contains(notice.what)) continue;
    Notice& known = noticed_[notice.what];
    known.count += notice.count;
    known.message = in_words_of_hits(client_text(notice.message, options_.root));
  }
}

void TapStream::publish_changes() {
  const io::Json now = status();
  // The level follows the noise all the time: twice or half of it is a change.
  io::Json compared = now;
  if (now["level_n"].is_number()) compared["level_n"] = std::round(std::log2(now["level_n"].get<double>()));
  std::string text = io::plain_text(compared);
  if (text == published_) return;
  published_ = std::move(text);
  changed_(now);
}

std::vector<TapStream::Cut> TapStream::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(waiting_, {});
}

void TapStream::set_direction(const std::string& direction) {
  const std::lock_guard lock(mutex_);
  options_.direction = direction;
}

std::string TapStream::direction() const {
  const std::lock_guard lock(mutex_);
  return options_.direction;
}

io::Json TapStream::status() const {
  const std::lock_guard lock(mutex_);
  io::Json discarded = io::Json::array(), notices = io::Json::array();
  for (const auto& [reason, count] : discarded_) discarded.push_back({{"reason", reason}, {"count", count}});
  for (const auto& [what, notice] : noticed_) {
    notices.push_back({{"what", what}, {"count", notice.count}, {"message", notice.message}});
  }
  return {{"address", printable(options_.address)},
          {"status", stream_status_names[static_cast<std::size_t>(status_)]},
          {"error", error_},
          {"sample_rate_hz", io::number(options_.trigger.sample_rate_hz)},
          {"record_s", io::number(options_.trigger.record_s)},
          {"level_n", io::positive(level_n_)},
          {"recording", recording_},
          {"triggered", triggered_},
          {"discarded", std::move(discarded)},
          {"notices", std::move(notices)}};
}

}  // namespace robomill::serve
