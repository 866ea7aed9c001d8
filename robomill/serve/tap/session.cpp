#include "robomill/serve/tap/session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/printable.hpp"
#include "robomill/io/file.hpp"

namespace robomill::serve {
namespace {

constexpr int hits_per_direction = 5;

std::string full_test() {
  return fmt::format("the test has {} hits, which is as many as it may", TapHits::most_hits);
}

}  // namespace

TapSession::TapSession(const Options& options, Publish publish)
    : options_(options),
      settings_(options.hits, options.text),
      publish_(std::move(publish)),
      hits_(settings_.options(), options.root) {
  if (options_.wanted <= 0) options_.wanted = hits_per_direction * static_cast<int>(settings_.directions());
  if (options_.stream.empty()) {
    folder_ = std::make_unique<TapFolder>(options_.watch, settings_.named());
  } else {
    if (options_.direction.empty()) options_.direction = settings_.first_direction();
    const TapDirection excitation = parse_direction(options_.direction);
    TapStream::Options stream = {.address = options_.stream,
                                 .channels = settings_.channels(),
                                 .trigger = settings_.trigger(options_.level_n, options_.record_s),
                                 .direction = direction_text(excitation.dof, excitation.against_axis),
                                 .broker = options_.broker,
                                 .config = options_.config,
                                 .root = options_.root,
                                 .open = options_.open_stream};
    stream_ = std::make_unique<TapStream>(
        std::move(stream), [this] { wake(); },
        [this](const io::Json& status) {
          send("tap-stream", io::plain_text({{"id", options_.id}, {"stream", status}}));
        });
  }
  update();
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

TapSession::~TapSession() {
  stop();
}

void TapSession::stop() {
  {
    const std::lock_guard lock(publishing_);
    ended_ = true;
  }
  thread_.request_stop();
  if (stream_) stream_->stop();
}

void TapSession::send(std::string_view event, const std::string& data) {
  const std::lock_guard lock(publishing_);
  if (ended_) return;
  try {
    publish_(event, data);
  } catch (const std::exception&) {
    // No memory for a message, say: the next one tells how it stands.
  }
}

void TapSession::wake() {
  {
    const std::lock_guard lock(mutex_);
    due_ = true;
  }
  woken_.notify_all();
}

void TapSession::run(const std::stop_token& stop) {
  constexpr std::chrono::milliseconds pause(250);
  bool changed = false;  // and not yet shown
  while (!stop.stop_requested()) {
    {
      std::unique_lock lock(mutex_);
      woken_.wait_for(lock, stop, pause, [this] { return due_; });
      due_ = false;
      changed = std::exchange(changed_by_hand_, false) || changed;
    }
    try {
      if (folder_ ? take_files() : take_records()) changed = true;
      if (!changed) continue;
      update();
      send("tap", state());
      changed = false;
    } catch (const std::exception&) {
      // No memory for all of it, say: the test goes on with what it has, and tries again.
    }
  }
}

/// True where there was something.
bool TapSession::take_files() {
  const std::size_t size = hits_.size();
  if (size > TapHits::most_hits) return false;
  if (size < TapHits::most_hits) {
    bool any = false;
    for (const std::filesystem::path& file : folder_->look(TapHits::most_hits - size)) any = take_record(file) || any;
    return any;
  }
  for (const std::filesystem::path& file : folder_->look(1)) {
    hits_.add({.name = file.filename().string(), .files = {file}, .row = settings_.row(file)},
              full_test() + ": this record and later ones are not read");
    return true;
  }
  return false;
}

/// A file alone, or the last one of a record that has several. True: what is shown has changed
bool TapSession::take_record(const std::filesystem::path& file) {
  if (settings_.files_of(file) < 2) {
    add_hits({file});
    return true;
  }
  const std::string key = settings_.key_of(file);
  std::vector<std::filesystem::path>& set = waiting_[key];
  set.push_back(file);
  if (set.size() == settings_.files_of(file)) {
    add_hits(settings_.in_order(std::move(set)));
    waiting_.erase(key);
  }
  return true;
}

/// The hits of a record, as many as the test may still take.
void TapSession::add_hits(const std::vector<std::filesystem::path>& files) {
  std::string name;
  for (const std::filesystem::path& file : files) name += (name.empty() ? "" : " + ") + file.filename().string();
  const TapHit record = {.name = name, .files = files, .row = settings_.row(files.front())};
  try {
    const std::vector<modal::Hit> hits = settings_.read(files);
    if (hits.size() + hits_.size() > TapHits::most_hits) {
      throw InvalidInput(name, fmt::format("holds {} hits, and the test has {} of the {} that it may", hits.size(),
                                           hits_.size(), TapHits::most_hits));
    }
    for (std::size_t i = 0; i < hits.size(); ++i) {
      TapHit taken = record;
      taken.name = hits[i].file;
      taken.number = i + 1;
      taken.of = hits.size();
      taken.direction = direction_text(hits[i].excitation, hits[i].against_axis);
      hits_.add(std::move(taken), hits[i]);
    }
  } catch (const std::exception& error) {
    hits_.add(record, rejection_reason(error, options_.root));
  }
}

bool TapSession::take_records() {
  bool any = false;
  for (const TapStream::Cut& cut : stream_->take()) {
    if (hits_.size() >= TapHits::most_hits) {
      stream_->reject(full_test());
      continue;
    }
    TapHit taken = {.name = fmt::format("hit {}", hits_.size() + 1), .direction = cut.direction};
    any = true;
    try {
      hits_.add(taken, settings_.hit_of(cut.record, cut.direction, taken.name));
    } catch (const std::exception& error) {
      hits_.add(std::move(taken), rejection_reason(error, options_.root));
    }
  }
  return any;
}

void TapSession::update() {
  hits_.average();
  io::Json state = hits_.state();
  io::Json waiting = io::Json::array();
  for (const auto& [key, files] : waiting_) {
    for (const std::filesystem::path& file : files) waiting.push_back(printable(file.filename().string()));
  }
  state["waiting"] = std::move(waiting);
  const std::lock_guard lock(mutex_);
  state_ = std::move(state);
  ++revision_;
}

std::string TapSession::state() const {
  io::Json out = {{"id", options_.id},
                  {"revision", 0},
                  {"hits", options_.name},
                  {"stream", stream_ ? stream_->status() : io::Json(nullptr)},
                  {"force_direction", stream_ ? io::Json(stream_->direction()) : io::Json(nullptr)},
                  {"running", true},
                  {"wanted", options_.wanted}};
  const std::lock_guard lock(mutex_);
  out["revision"] = revision_;
  out.update(state_);
  return io::plain_text(out);
}

bool TapSession::set_accepted(std::size_t number, bool accepted) {
  if (!hits_.set_accepted(number, accepted)) return false;
  {
    const std::lock_guard lock(mutex_);
    due_ = changed_by_hand_ = true;
  }
  woken_.notify_all();
  return true;
}

void TapSession::set_direction(const std::string& direction) {
  if (!stream_) {
    throw InvalidInput("force_direction", "is of hits out of a stream",
                       "A file's direction stands in its name, tap_y_1.csv, or in its row of hits.toml");
  }
  const TapDirection excitation = parse_direction(direction);
  stream_->set_direction(direction_text(excitation.dof, excitation.against_axis));
  {
    const std::lock_guard lock(mutex_);
    ++revision_;
  }
  send("tap", state());
}

TapWritten TapSession::save(const std::filesystem::path& path, bool replace) {
  std::vector<std::pair<std::size_t, TapHit>> accepted = hits_.accepted();
  if (accepted.empty()) throw InvalidInput("path", "there is no accepted hit to save", "Hit the tool first");
  if (io::format_of(path) == io::Format::toml) {
    return write_tap_hits(path,
                          {.acquisition = settings_.acquisition(folder_ == nullptr),
                           .response = settings_.options().response,
                           .hits = std::move(accepted)},
                          replace);
  }
  if (folder_) folder_->ignore(path);
  // Of these hits: the average after the last change may still be on its way.
  std::vector<modal::Hit> hits;
  hits.reserve(accepted.size());
  for (const auto& [number, taken] : accepted) hits.push_back(*taken.hit);
  return write_tap_frfs(path, modal::estimate_frfs(hits, settings_.options()), replace);
}

}  // namespace robomill::serve
