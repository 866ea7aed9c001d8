#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <tuple>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/decision/program_decision.hpp"
#include "robomill/process/blocks/classes.hpp"
#include "robomill/process/blocks/stability.hpp"
#include "robomill/process/decide.hpp"
#include "robomill/process/decide/loads.hpp"
#include "robomill/process/decide/units.hpp"
#include "robomill/robot/collision.hpp"
#include "robomill/robot/inverse.hpp"

namespace robomill::process {

/// Blocks that one look stands for differ by no more: it is the exact run that judges each of them.
inline constexpr BlockTolerance look_tolerance = {.joint_rad = 2.0 * units::deg, .cut_share = 0.05};

/// The greatest feed of the tip at which no joint is faster than its limit over a block.
struct JointSpeed {
  double feed_m_per_s = std::numeric_limits<double>::infinity();
  double allowed = 0.0;  ///< speed of that joint
};

/// What of a block's limits does not depend on spindle speed and feed.
struct BlockPace {
  JointSpeed joint = {};
  double radius_m = 0.0;  ///< of the outermost point that cuts
};

/// One class of blocks at one speed in one posture.
struct ClassLook {
  bool reachable = false;
  bool stable = false;
  double margin = 0.0;                           ///< not looked at where a stable cut vibrates too much at both ends
  std::array<double, 2> surface_m = {0.0, 0.0};  ///< magnitudes at the ends of the class's range of feeds; NaN: none
  /// Of forced vibration at these ends; NaN: not known.
  std::array<double, 2> vibration_m = {std::numeric_limits<double>::quiet_NaN(),
                                       std::numeric_limits<double>::quiet_NaN()};
};

/// What every way of a program is asked with.
struct WaySetting {
  const DecideProblem* problem = nullptr;
  std::array<double, 2> chip_m = {};                 ///< greatest chip thickness, least and most
  const robot::CollisionChecker* checker = nullptr;  ///< none: no obstacles are known
  bool posture_free = false;                         ///< γ or the lean may differ from the program's
  std::optional<robot::SphericalWristInverse> inverse = {};
};

/// The blocks of a program with their tool axes, as it was run through the material: loads over feed, and one look a
/// class of blocks.
class WayModel {
 public:
  /// @param setting, forces  outlive the model
  WayModel(const WaySetting& setting, const ForcesResult& forces, ProgramUnits units);

  [[nodiscard]] decision::FeedRange feeds(std::size_t line, double spindle_speed_rad_per_s) const;
  [[nodiscard]] decision::CutLook look(std::size_t look_class, double spindle_speed_rad_per_s, double gamma_rad) const;
  /// The stability margin of a class at γ [rad], of a limit up to eight times the depth; NaN: the robot cannot stand
  /// so.
  [[nodiscard]] double margin(std::size_t look_class, double spindle_speed_rad_per_s, double gamma_rad) const;
  [[nodiscard]] long long evaluations() const;

  [[nodiscard]] const ForcesResult& forces() const { return forces_; }
  /// With the classes of each line as its looks.
  [[nodiscard]] const ProgramUnits& units() const { return units_; }
  [[nodiscard]] std::size_t classes() const { return first_.size(); }
  /// None of a block that does not cut.
  [[nodiscard]] std::optional<std::size_t> class_of(std::size_t block) const;

  /// Holds a line further from the limits of its feed, by that share of what it may have.
  void tighten_feed(std::size_t line, double share) { feed_share_[line] *= share; }
  /// … from its least chip.
  void tighten_chip(std::size_t line, double factor) { chip_factor_[line] *= factor; }
  /// Corrects the radius of the outermost point of a block that cuts.
  void set_radius(std::size_t block, double radius_m) { pace_[block].radius_m = radius_m; }
  /// Asks so much more margin of a class.
  void tighten_margin(std::size_t look_class, double more) { more_margin_[look_class] += more; }
  /// Allows a class that share of the vibration that it may have.
  void tighten_vibration(std::size_t look_class, double share) { vibration_share_[look_class] *= share; }

 private:
  /// What vibrates where a class's first block stands turned by γ.
  struct Stand {
    bool reachable = false;
    modal::ModalModel modes = {};
  };
  using LookKey = std::tuple<std::size_t, double, double>;  ///< class, speed, γ
  static constexpr std::size_t no_class = std::numeric_limits<std::size_t>::max();

  /// Narrows the feeds of a line by what one of its blocks bears.
  void limit_by_block(std::size_t line, std::size_t block, double speed, decision::FeedRange& range) const;
  /// A load limit with the greatest value of a line's blocks at a feed; other limits as they are.
  [[nodiscard]] decision::LimitUse at_feed(std::size_t line, decision::LimitUse use, double feed_m_per_s,
                                           double speed) const;
  void sort_into_classes();
  [[nodiscard]] const Stand& stand(std::size_t look_class, double gamma_rad) const;
  /// 1 - depth / limit, of the 5 % quantile, and of the depth searched where there is no limit.
  /// @param stable  set to whether the cut is below its lowest limit, where it is asked for
  [[nodiscard]] double margin_at(std::size_t look_class, const modal::ModalModel& modes, double speed, double deepest,
                                 bool* stable) const;
  [[nodiscard]] ClassLook compute(std::size_t look_class, double speed, double gamma_rad) const;
  [[nodiscard]] BlockCut cut_at(std::size_t look_class, double speed) const;
  [[nodiscard]] bool is_stable(std::size_t look_class, const modal::ModalModel& modes, double speed) const;
  /// Surface error and vibration at the ends of the range of feeds.
  void add_steady_motion(std::size_t look_class, const modal::ModalModel& modes, double speed, ClassLook& out) const;
  /// The feeds per tooth at which the surface error stays within its limit; false: not at the least.
  [[nodiscard]] bool keep_surface(std::size_t look_class, const ClassLook& found, decision::CutLook& out) const;
  /// The feeds per tooth at which forced vibration stays within them; false: at neither end of the range.
  [[nodiscard]] bool keep_vibration(std::size_t look_class, const ClassLook& found, decision::CutLook& out) const;
  [[nodiscard]] ClassLook known_or_computed(std::size_t look_class, double speed, double gamma_rad) const;
  /// Depths that looks search up to, as a multiple of the cut's.
  [[nodiscard]] double deepest() const;
  [[nodiscard]] double most_surface_m() const { return setting_.problem->finish.max_surface_error_m; }
  [[nodiscard]] double teeth_per_s(double spindle_speed_rad_per_s) const;

  const WaySetting& setting_;
  const ForcesResult& forces_;
  ProgramUnits units_;
  std::vector<BlockLoad> loads_ = {};         ///< one a block
  std::vector<BlockPace> pace_ = {};          ///< one a block
  std::vector<double> feed_share_ = {};       ///< of each line, <= 1: tightened
  std::vector<double> chip_factor_ = {};      ///< of each line, >= 1: tightened
  std::vector<std::size_t> class_of_ = {};    ///< of each block
  std::vector<std::size_t> first_ = {};       ///< block of each class
  std::vector<double> more_margin_ = {};      ///< of each class
  std::vector<double> vibration_share_ = {};  ///< of each class, <= 1: of the feed per tooth
  std::vector<double> left_share_ = {};       ///< of each class: what of its surface error remains at the end
  mutable std::mutex mutex_;
  mutable std::map<std::pair<std::size_t, double>, Stand> stands_ = {};
  mutable std::map<LookKey, ClassLook> looks_ = {};
  mutable long long map_looks_ = 0;
};

}  // namespace robomill::process
