#include "robomill/serve/latest.hpp"

#include <algorithm>
#include <utility>

namespace robomill::serve {
namespace {

using Kind = Latest::Outcome::Kind;

Latest::Outcome outcome_of(const Latest::Request& request, const std::atomic<bool>& stop) {
  try {
    Progress progress({}, &stop);
    return {.kind = Kind::answered, .answer = request.compute(progress)};
  } catch (const Interrupted&) {
    return {.kind = Kind::superseded};
  } catch (...) {
    return {.kind = Kind::failed, .error = std::current_exception()};
  }
}

}  // namespace

Latest::Latest(std::size_t most_channels)
    : most_channels_(std::max<std::size_t>(most_channels, 1)), thread_([this] { work(); }) {}

Latest::~Latest() {
  std::deque<Request> left;
  {
    const std::scoped_lock lock(mutex_);
    closing_ = true;
    stop_ = true;
    for (const Channels::iterator& channel : turns_) left.push_back(std::move(*channel->waits));
    turns_.clear();
  }
  changed_.notify_all();
  thread_.join();
  for (const Request& request : left) request.done({.kind = Kind::superseded});
}

std::size_t Latest::channels() const {
  const std::scoped_lock lock(mutex_);
  return channels_.size();
}

/// The channel of a request, moved to the end; a new one takes the place of the longest idle one if need be. None where
/// every place is taken.
Latest::Channels::iterator Latest::find(const Request& request) {
  const auto known = std::ranges::find_if(
      channels_, [&](const Channel& c) { return c.client == request.client && c.name == request.channel; });
  if (known != channels_.end()) {
    channels_.splice(channels_.end(), channels_, known);
    return known;
  }
  if (channels_.size() >= most_channels_) {
    const auto idle = std::ranges::find_if(channels_, [](const Channel& c) { return !c.waits && !c.computing; });
    if (idle == channels_.end()) return channels_.end();
    channels_.erase(idle);
  }
  return channels_.insert(channels_.end(), Channel{.client = request.client, .name = request.channel});
}

void Latest::submit(Request request) {
  std::optional<Request> dropped;
  Kind why = Kind::superseded;
  {
    const std::scoped_lock lock(mutex_);
    const auto channel = closing_ ? channels_.end() : find(request);
    if (channel == channels_.end()) {
      if (!closing_) why = Kind::full;
      dropped = std::move(request);
    } else if (channel->newest && request.sequence <= *channel->newest) {
      dropped = std::move(request);
    } else {
      channel->newest = request.sequence;
      if (channel->computing) stop_ = true;
      if (channel->waits) {
        dropped = std::move(channel->waits);
      } else {
        turns_.push_back(channel);
      }
      channel->waits = std::move(request);
    }
  }
  changed_.notify_one();
  if (dropped) dropped->done({.kind = why});
}

void Latest::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return closing_ || !turns_.empty(); });
    if (closing_) return;
    const auto channel = turns_.front();
    turns_.pop_front();
    Request request = std::move(*channel->waits);
    channel->waits.reset();
    channel->computing = true;
    stop_ = false;
    lock.unlock();
    request.done(outcome_of(request, stop_));
    request = {};
    lock.lock();
    channel->computing = false;
  }
}

}  // namespace robomill::serve
