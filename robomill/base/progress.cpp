#include "robomill/base/progress.hpp"

#include <algorithm>
#include <utility>

namespace robomill {

const char* Interrupted::what() const noexcept {
  return "interrupted";
}

Progress::Progress(Report report, const std::atomic<bool>* stop) : report_(std::move(report)), stop_(stop) {}

void Progress::start(std::string task, std::size_t total) {
  check();
  if (!report_) return;
  task_ = std::move(task);
  total_ = total;
  done_ = 0;
  report_(task_, 0.0);
}

void Progress::advance(std::size_t steps) {
  check();
  if (!report_) return;
  const std::size_t done = done_ += steps;
  // A thread that finds another one reporting goes on working, unless it brings the last step.
  std::unique_lock lock(reporting_, std::defer_lock);
  if (done >= total_) {
    lock.lock();
  } else if (!lock.try_lock()) {
    return;
  }
  report_(task_, total_ == 0 ? 1.0 : std::min(1.0, static_cast<double>(done) / static_cast<double>(total_)));
}

void Progress::check() const {
  if (stop_ != nullptr && stop_->load(std::memory_order_relaxed)) throw Interrupted();
}

Progress& Progress::none() {
  static Progress silent;
  return silent;
}

}  // namespace robomill
