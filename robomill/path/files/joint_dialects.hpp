#pragma once
// The controllers' languages, one class each.
#include <fmt/format.h>

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "robomill/path/files/end_effector.hpp"
#include "robomill/path/files/joint_programs.hpp"
#include "robomill/path/files/joint_run.hpp"
#include "robomill/robot/inverse.hpp"

namespace robomill::path {

/// What a program switches on before its first move and off after its last.
struct Outputs {
  bool spindle = false, coolant = false;
};

/// One language: what stands before, at, between and after the points.
class JointDialect {
 public:
  JointDialect() = default;
  JointDialect(const JointDialect&) = delete;
  JointDialect& operator=(const JointDialect&) = delete;
  JointDialect(JointDialect&&) = delete;
  JointDialect& operator=(JointDialect&&) = delete;
  virtual ~JointDialect() = default;
  /// "; " for KRL
  [[nodiscard]] virtual const char* comment() const = 0;
  /// How the controller may join the points; the worst of them counts.
  [[nodiscard]] virtual std::span<const Joining> joinings() const = 0;
  /// The number that the controller holds for a joint that is written.
  [[nodiscard]] virtual JointPoints::Held held() const = 0;
  /// Whether it takes a point each cycle, no more and no fewer.
  [[nodiscard]] virtual bool fixed_cycle() const = 0;
  /// That its controllers are known to load; 0: not known.
  [[nodiscard]] virtual std::size_t most_points() const = 0;
  /// Before the header's comments.
  virtual void open(fmt::memory_buffer& out) = 0;
  /// What the cell does not give, so that the program leaves it to the user or assumes it: tool and load first.
  [[nodiscard]] virtual std::vector<std::string> not_set(const Outputs& wanted) const = 0;
  /// After them: tool and load; drives to where the trajectory begins; outputs that the cell names.
  virtual void start(fmt::memory_buffer& out, const robot::Position6& joints, const Outputs& on) = 0;
  /// @param seconds  since the point before
  /// @param rests    whether the trajectory stands still from here on, for a while or for good
  virtual void point(fmt::memory_buffer& out, const robot::Position6& joints, double seconds, bool rests) = 0;
  /// The trajectory stands still.
  virtual void wait(fmt::memory_buffer& out, const robot::Position6& joints, double seconds) = 0;
  virtual void close(fmt::memory_buffer& out, const Outputs& off) = 0;
  /// What the user must know before running it.
  [[nodiscard]] virtual std::string advice() const = 0;
};

[[nodiscard]] std::unique_ptr<JointDialect> krl_dialect(const std::string& name, const EndEffector& end);
[[nodiscard]] std::unique_ptr<JointDialect> rapid_dialect(const std::string& name, const EndEffector& end);
/// @param period_s  from point to point
[[nodiscard]] std::unique_ptr<JointDialect> urscript_dialect(const std::string& name, const EndEffector& end,
                                                             double period_s);
[[nodiscard]] std::unique_ptr<JointDialect> servoj_dialect(double period_s);

}  // namespace robomill::path
