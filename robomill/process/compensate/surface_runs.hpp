#pragma once
#include <Eigen/Core>
#include <vector>

#include "robomill/cutting/cutter.hpp"
#include "robomill/cutting/program_forces.hpp"
#include "robomill/cutting/workpiece.hpp"
#include "robomill/decision/mirror.hpp"
#include "robomill/process/blocks/classes.hpp"
#include "robomill/process/blocks/finished_surface.hpp"
#include "robomill/process/compensate.hpp"
#include "robomill/stability/lobes.hpp"

namespace robomill::process {

/// What one block leaves of the surface that remains.
struct LeftBlock {
  bool cuts = false;
  bool stable = true;                        ///< of a block that leaves some
  bool opposite = false;                     ///< decision::opposite_walls
  decision::MirrorCondition condition = {};  ///< width 0: it leaves nothing
  double worst_m = 0.0;                      ///< e − n·o of greatest magnitude, o the offset that the block ran with
  [[nodiscard]] bool leaves() const { return condition.width_m > 0.0; }
};

/// Runs of paths that differ little, each of whose blocks cuts where its mean force bends the structure to.
class SurfaceRuns {
 public:
  /// @param forces, dynamics, options, progress  outlive it
  /// @throws InvalidInput if forces lack program, cell or stock
  SurfaceRuns(const ForcesResult& forces, const DynamicsAt& dynamics, const CompensateOptions& options,
              Progress& progress);
  /// @param offset_m  by which each block's ends are moved already, their mean
  [[nodiscard]] std::vector<LeftBlock> run(const program::Program& program,
                                           const std::vector<Eigen::Vector3d>& offset_m);
  /// Whether force and deflection agreed in every run.
  [[nodiscard]] bool settled() const { return settled_; }

 private:
  struct Cut {
    stability::LobesProblem problem;
    stability::OperatingPoint point;
    Eigen::Matrix3d compliance_m_per_n;  ///< static, in W
    std::vector<LeftPlace> places;
    bool leaves = false, stable = true;
  };
  [[nodiscard]] std::vector<cutting::BlockForce> cut_once(const program::Program& program,
                                                          cutting::Workpiece& workpiece);
  void sort_cuts(const std::vector<cutting::BlockForce>& forces);
  void find_structures(const std::vector<cutting::BlockForce>& forces);
  [[nodiscard]] bool bend(const std::vector<cutting::BlockForce>& forces, int pass);
  void find_places(Cut& cut) const;
  [[nodiscard]] std::vector<decision::WallPlace> remaining(const program::Program& program, std::size_t block,
                                                           const cutting::Workpiece& workpiece) const;
  template <class F>
  void for_cuts(F&& f);

  const ForcesResult& forces_;
  DynamicsAt dynamics_;
  bool vibrates_;
  const CompensateOptions& options_;
  Progress& progress_;
  cutting::Profile profile_;
  bool settled_ = true;
  std::vector<Eigen::Vector3d> bend_m_;                ///< of each block's tip, in W
  std::vector<cutting::PoseEngagement> engaged_ = {};  ///< of each block, where most of the cutter cuts
  std::vector<std::size_t> cut_of_ = {};               ///< of each block that cuts
  std::vector<std::size_t> first_ = {};                ///< block of each cut
  std::vector<Cut> cuts_ = {};
};

}  // namespace robomill::process
