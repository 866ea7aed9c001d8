#pragma once
// The controllers' languages, a class and a source each: krl.cpp, rapid.cpp, urscript.cpp (with the rows for servoj).
#include <fmt/format.h>

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/path/files/end_effector.hpp"
#include "robomill/path/files/robot_programs/joint_programs.hpp"
#include "robomill/path/files/robot_programs/joint_run.hpp"
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
  /// A pose as the controller's pendant shows it.
  [[nodiscard]] virtual std::string pose(const Eigen::Isometry3d& frame) const = 0;
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

 protected:  // what the languages have in common
  static constexpr const char* same_angles =
      "Joint angles are those of the cell's model: compare signs and zeros with the controller's before the first "
      "run.\n";
  static constexpr const char* wrong_load =
      "With a wrong load the arm sags, its dynamics are wrong, and it may leave its path by far more than is stated "
      "here.";
  /// About 4 MB of text at 120 bytes a point: what is known to fit into the memory of a KR C4. A Universal Robots
  /// controller is known to fail at 18 MB; that it loads as much is an inference. docs/formats.md.
  static constexpr std::size_t points_in_memory = 33'000;

  static void put(fmt::memory_buffer& out, std::string_view text) {
    out.append(text.data(), text.data() + text.size());
  }
  /// "{A1 1.5,A2 …}" or "1.5,…": six decimals of a degree, more than a controller's 32-bit numbers hold.
  static void degrees(fmt::memory_buffer& out, const robot::Position6& joints, bool named);
  /// Written by degrees(), read as a 32-bit number.
  [[nodiscard]] static robot::Position6 held_degrees(const robot::Position6& joints);
  /// "1,2,3", in mm or m.
  [[nodiscard]] static std::string three(const Eigen::Vector3d& value, double unit,
                                         const char* form = "{:.6g},{:.6g},{:.6g}");
  /// Lines about outputs that the cell does not name.
  static void add_missing_outputs(const EndEffector& end, const Outputs& wanted, std::vector<std::string>& lines);
  /// "X 1,Y 2,Z 3,A 4,B 5,C 6": mm and degrees, turned about z, the new y and the new x.
  [[nodiscard]] static std::string euler_pose(const Eigen::Isometry3d& frame);
  /// What the file gives the controller for the load although nobody measured it.
  static void add_assumed_load(const EndEffector& end, std::vector<std::string>& lines);
};

[[nodiscard]] std::unique_ptr<JointDialect> krl_dialect(const std::string& name, const EndEffector& end);
[[nodiscard]] std::unique_ptr<JointDialect> rapid_dialect(const std::string& name, const EndEffector& end);
/// @param period_s  from point to point
[[nodiscard]] std::unique_ptr<JointDialect> urscript_dialect(const std::string& name, const EndEffector& end,
                                                             double period_s);
[[nodiscard]] std::unique_ptr<JointDialect> servoj_dialect(double period_s);

}  // namespace robomill::path
