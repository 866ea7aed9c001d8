#pragma once
// The controllers' languages, one class each.
#include <cstddef>
#include <memory>
#include <string>

#include "robomill/formats/joint_programs.hpp"
#include "robomill/formats/trajectory_parts.hpp"
#include "robomill/robot/inverse.hpp"

namespace robomill::formats {

/// A line of a program's header that is filled in at its end: as many bytes as were left for it.
struct Later {
  std::size_t at = 0, width = 0;
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
  /// Before the header's comments.
  virtual void open(fmt::memory_buffer& out) = 0;
  /// After them: drives to where the trajectory begins.
  virtual void start(fmt::memory_buffer& out, const robot::Position6& joints) = 0;
  /// @param seconds  since the point before
  /// @param rests    whether the trajectory stands still from here on, for a while or for good
  virtual void point(fmt::memory_buffer& out, const robot::Position6& joints, double seconds, bool rests) = 0;
  /// The trajectory stands still.
  virtual void wait(fmt::memory_buffer& out, const robot::Position6& joints, double seconds) = 0;
  virtual void close(fmt::memory_buffer& out) = 0;
  /// What the user must know before running it.
  [[nodiscard]] virtual std::string advice() const = 0;
};

[[nodiscard]] std::unique_ptr<JointDialect> krl_dialect(const std::string& name);
[[nodiscard]] std::unique_ptr<JointDialect> rapid_dialect(const std::string& name);
/// @param period_s  from point to point
[[nodiscard]] std::unique_ptr<JointDialect> urscript_dialect(const std::string& name, double period_s);
[[nodiscard]] std::unique_ptr<JointDialect> servoj_dialect(double period_s);

}  // namespace robomill::formats
