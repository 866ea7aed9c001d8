#pragma once
#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <string>

#include "robomill/base/export.hpp"

// Method: robomill/base/README.md, "Method"

namespace robomill {

/// Thrown out of long work when its caller asked it to stop.
class ROBOMILL_API Interrupted : public std::exception {
 public:
  [[nodiscard]] const char* what() const noexcept override;
};

/// What long work reports to, and where it learns that it should stop. start and report come from one thread;
/// advance and check may come from any.
class ROBOMILL_API Progress {
 public:
  /// task, and the fraction done in [0, 1].
  using Report = std::function<void(const std::string& task, double fraction)>;
  /// Reports to nobody and never stops.
  Progress() = default;
  /// @param stop  becomes true when the work should end; outlives this object; may be null
  Progress(Report report, const std::atomic<bool>* stop);

  /// Begins a task of `total` steps.
  void start(std::string task, std::size_t total);
  /// @throws Interrupted when asked to stop
  void advance(std::size_t steps = 1);
  /// @throws Interrupted when asked to stop
  void check() const;

  /// One that reports to nobody, for callers that do not care.
  static Progress& none();

 private:
  Report report_;
  const std::atomic<bool>* stop_ = nullptr;
  std::string task_;
  std::size_t total_ = 0;
  std::atomic<std::size_t> done_{0};
  std::mutex reporting_;
};

}  // namespace robomill
