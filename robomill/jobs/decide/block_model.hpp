#pragma once
#include <Eigen/Core>
#include <array>
#include <atomic>
#include <cstddef>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "robomill/decision/program_decision.hpp"
#include "robomill/jobs/decide.hpp"
#include "robomill/jobs/decide/collisions.hpp"
#include "robomill/jobs/decide/loads.hpp"
#include "robomill/jobs/decide/units.hpp"
#include "robomill/robot/inverse.hpp"

namespace robomill::jobs {

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

/// A program's blocks as the search asks of them: loads over feed, and one look a class of blocks.
class BlockModel final : public decision::ProgramModel {
 public:
  /// @param problem  outlives the model
  explicit BlockModel(const DecideProblem& problem);

  [[nodiscard]] decision::FeedRange feeds(std::size_t cut, double spindle_speed_rad_per_s) const override;
  [[nodiscard]] decision::CutLook look(std::size_t look_class, double spindle_speed_rad_per_s,
                                       std::size_t gamma) const override;

  [[nodiscard]] const ProgramUnits& units() const { return units_; }
  [[nodiscard]] const decision::ProgramOptions& search() const { return search_; }
  [[nodiscard]] const std::array<double, 2>& chip_m() const { return chip_m_; }
  /// The stability margin of a class at γ [rad], of a limit up to eight times the depth; NaN: the robot cannot stand
  /// so.
  [[nodiscard]] double margin(std::size_t look_class, double spindle_speed_rad_per_s, double gamma_rad) const;
  [[nodiscard]] std::size_t classes() const { return first_.size(); }
  /// The class of a block that cuts.
  [[nodiscard]] std::size_t class_of(std::size_t block) const { return class_of_[block]; }
  [[nodiscard]] long long evaluations() const;
  /// Of the cell and the cutter; null: the cell has no [geometry].
  [[nodiscard]] const robot::CollisionChecker* checker() const { return checker_.get(); }

  /// The line of a block that cuts.
  [[nodiscard]] std::size_t line_of(std::size_t block) const { return line_of_[block]; }

  /// Holds a line further from the limits of its feed, by that share of what it may have.
  void tighten_feed(std::size_t line, double share);
  /// Asks so much more margin of a class.
  void tighten_margin(std::size_t look_class, double more);

 private:
  /// What vibrates where a class's first block stands turned by γ.
  struct Stand {
    bool reachable = false;
    modal::ModalModel modes = {};
  };
  /// One class at one speed in one posture.
  struct Raw {
    bool reachable = false;
    bool stable = false;
    double margin = 0.0;
    std::array<double, 2> surface_m = {0.0, 0.0};  ///< magnitudes at the ends of the class's range of feeds; NaN: none
  };
  using RawKey = std::tuple<std::size_t, double, double>;  ///< class, speed, γ

  /// Narrows the feeds of a line by what one of its blocks bears.
  void limit_by_block(std::size_t cut, std::size_t block, double speed, decision::FeedRange& range) const;
  void sort_into_classes();
  void set_search();
  [[nodiscard]] const Stand& stand(std::size_t look_class, double gamma_rad) const;
  /// 1 - depth / limit, of the 5 % quantile, and of the depth searched where there is no limit.
  [[nodiscard]] double margin_at(std::size_t look_class, const modal::ModalModel& modes, double speed, double deepest,
                                 bool& stable) const;
  [[nodiscard]] Raw compute(std::size_t look_class, double speed, double gamma_rad) const;
  [[nodiscard]] Raw raw(std::size_t look_class, double speed, double gamma_rad) const;
  /// Depths that looks search up to, as a multiple of the cut's.
  [[nodiscard]] double deepest() const;
  [[nodiscard]] double most_surface_m() const { return problem_.finish.max_surface_error_m; }

  const DecideProblem& problem_;
  ProgramUnits units_;
  std::array<double, 2> chip_m_ = {};
  std::vector<BlockLoad> loads_ = {};       ///< one a block
  std::vector<BlockPace> pace_ = {};        ///< one a block
  std::vector<double> feed_share_ = {};     ///< of each line, <= 1: tightened
  std::vector<std::size_t> class_of_ = {};  ///< of each block
  std::vector<std::size_t> first_ = {};     ///< block of each class
  std::vector<double> more_margin_ = {};    ///< of each class
  std::vector<std::size_t> line_of_ = {};   ///< of each block that cuts
  decision::ProgramOptions search_ = {};
  std::optional<robot::SphericalWristInverse> inverse_ = {};
  std::unique_ptr<robot::CollisionChecker> checker_ = {};  ///< none: nothing is known of what stands about
  mutable std::mutex mutex_;
  mutable std::map<std::pair<std::size_t, double>, Stand> stands_ = {};
  mutable std::map<RawKey, Raw> raw_ = {};
  mutable std::atomic<long long> map_looks_ = 0;
};

}  // namespace robomill::jobs
