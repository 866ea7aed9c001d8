#pragma once
// Keeps what a check found: largest values, and the worst violation of each block and order.
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "robomill/path/check.hpp"

namespace robomill::path {

/// Where and when something was met.
struct Place {
  double time_s = 0.0;
  std::size_t block = 0;
};

class ViolationBook {
 public:
  static constexpr std::size_t room = 100000;
  /// Where violations that follow are met.
  void at(double path_m) { path_m_ = path_m; }
  /// A violation; ratios that are not finite count as the largest number.
  void add(const Place& place, int order, double ratio);
  /// In order of time; the book is empty after it.
  [[nodiscard]] std::vector<Violation> take();

 private:
  double path_m_ = 0.0;
  std::vector<Violation> violations_;
  std::unordered_map<std::uint64_t, std::size_t> index_;  // by block and order
};

/// One limit under watch.
class Watch {
 public:
  Watch() = default;
  /// @param usage  outlives the watch; its limit is set here. 0: watched without a limit
  Watch(Usage& usage, double limit, double relative_tolerance, int order);
  /// Notes a magnitude.
  void note(double value, const Place& place, ViolationBook& book) {
    if (value <= quiet_) return;
    raise(value, place, book);
  }
  /// From where on a magnitude matters: none below it changes anything.
  [[nodiscard]] double quiet() const { return quiet_; }

 private:
  void raise(double value, const Place& place, ViolationBook& book);
  Usage* usage_ = nullptr;
  double bound_ = 0.0;  // what is a violation
  double quiet_ = 0.0;
  int order_ = 1;
};

}  // namespace robomill::path
