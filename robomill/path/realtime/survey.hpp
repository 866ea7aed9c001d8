#pragma once
#include <array>
#include <cstddef>

#include "robomill/path/options.hpp"
#include "robomill/path/realtime/look_ahead.hpp"
#include "robomill/robot/kinematics.hpp"

namespace robomill::path {

/// Runs along the plan before the machine does, at override 1 and twice a period, and measures by the differences of a
/// whole period what every stretch demands of the machine. What it finds bounds the override there, below 1 too where
/// samples see more than the planner's derivatives do; and what the machine cannot take is known before it moves.
class Survey {
 public:
  /// @param kinematics  outlives the survey, as the look-ahead does
  Survey(LookAhead& ahead, const robot::Kinematics& kinematics, const SmoothingOptions& options,
         const robot::Position6& start);

  enum class ScanStatus { on, full, unreachable };
  /// Takes a segment that follows; its polynomials are in the look-ahead. Called again with the same one after `full`.
  ScanStatus take(const Segment& segment) noexcept;
  [[nodiscard]] const robot::Reach& reach() const noexcept { return reach_; }
  /// Where it is.
  [[nodiscard]] const Polynomial& at() const noexcept { return ahead_.path.put_at(path_at_); }

 private:
  static constexpr std::size_t steps = 8;       // of half a period, in a stretch
  static constexpr std::size_t reach_back = 7;  // of them, in two third differences half a period apart
  using Row = Eigen::Matrix<double, 12, 1>;     // joints, tip, axis

  [[nodiscard]] bool look(double u_m) noexcept;
  [[nodiscard]] Demand demand() const noexcept;
  void record(const Row& row) noexcept;
  void put(const Stretch& stretch) noexcept;
  void close(double end_s) noexcept;

  LookAhead& ahead_;
  const robot::Kinematics& kinematics_;
  ChannelLimits limits_;
  double period_s_, max_slope_;
  robot::Position6 near_;
  robot::Reach reach_ = {};
  std::size_t path_at_ = 0;
  bool begun_ = false;                     // with the segment that is being taken
  double begin_s_ = 0.0, length_s_ = 0.0;  // of it
  double next_s_ = 0.0;                    // of the next sample, from there
  double chain_s_ = 0.0;                   // where the tool rested last
  std::size_t count_ = 0;                  // samples since then
  std::array<Row, reach_back + 1> rows_;   // the newest first
  std::array<double, 2> feeds_ = {};       // programmed at the newest
  Demand before_, now_;                    // of the present stretch and the one before
  bool has_before_ = false;
};

}  // namespace robomill::path
