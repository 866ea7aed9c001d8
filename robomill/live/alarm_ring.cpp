#include "robomill/live/alarm_ring.hpp"

#include <cmath>
#include <exception>
#include <utility>

#include "robomill/io/file.hpp"
#include "robomill/live/files/alarm_wav.hpp"

namespace robomill::live {
namespace {

constexpr std::size_t max_jobs = 2;

}  // namespace

AlarmRing::AlarmRing(Options options, std::function<void(const std::filesystem::path&, const std::string&)> reported)
    : options_(std::move(options)), reported_(std::move(reported)) {
  io::make_folder(options_.folder);
  room_ = static_cast<std::size_t>(std::ceil(options_.seconds * options_.sample_rate_hz)) *
          static_cast<std::size_t>(options_.channels);
  thread_ = std::jthread([this] { write_jobs(); });
}

AlarmRing::~AlarmRing() {
  const std::scoped_lock lock(mutex_);
  ended_ = true;
  asked_.notify_all();
}

void AlarmRing::add(std::vector<float>&& samples) {
  kept_samples_ += samples.size();
  kept_.push_back(std::make_shared<const std::vector<float>>(std::move(samples)));
  while (kept_samples_ - kept_.front()->size() >= room_) {
    kept_samples_ -= kept_.front()->size();
    kept_.pop_front();
  }
}

bool AlarmRing::alarm(double time_s) {
  const std::scoped_lock lock(mutex_);
  if (jobs_.size() >= max_jobs) return false;
  std::filesystem::path file = free_alarm_name(options_.folder, time_s);
  jobs_.push_back({.file = std::move(file), .pieces = {kept_.begin(), kept_.end()}});
  asked_.notify_one();
  return true;
}

void AlarmRing::finish() {
  std::unique_lock lock(mutex_);
  written_.wait(lock, [this] { return jobs_.empty() && !busy_; });
}

void AlarmRing::write_jobs() {
  std::unique_lock lock(mutex_);
  while (true) {
    asked_.wait(lock, [this] { return ended_ || !jobs_.empty(); });
    if (jobs_.empty()) return;
    const Job job = std::move(jobs_.front());
    jobs_.pop_front();
    busy_ = true;
    lock.unlock();
    write(job);
    lock.lock();
    busy_ = false;
    written_.notify_all();
  }
}

void AlarmRing::write(const Job& job) const {
  try {
    std::vector<float> samples;
    for (const Piece& piece : job.pieces) samples.insert(samples.end(), piece->begin(), piece->end());
    if (samples.size() > room_) samples.erase(samples.begin(), samples.end() - static_cast<std::ptrdiff_t>(room_));
    write_alarm(job.file, samples, options_.channels, options_.sample_rate_hz);
    reported_(job.file, {});
  } catch (const std::exception& error) {
    reported_({}, error.what());
  }
}

}  // namespace robomill::live
