#pragma once
#include <cstddef>
#include <vector>

#include "robomill/path/posture.hpp"
#include "robomill/program/program.hpp"
#include "robomill/robot/kinematics.hpp"

namespace robomill::path {

/// The first blocks of a program as poses along t: block t's beginning is pose t, its end pose t + 1.
struct Head {
  std::vector<program::Pose> pose = {};
  std::vector<std::size_t> line = {};  ///< of each block
  bool whole = true;                   ///< the program ends here
  [[nodiscard]] program::Pose at(double t) const;
};
/// Leaves the source at its beginning.
[[nodiscard]] Head read_head(program::Source& source, std::size_t max_blocks);

/// How far a block goes, in steps of the options.
[[nodiscard]] double steps_of(const Head& head, std::size_t block, const PostureOptions& options);

/// Places t along a head that are at most one step apart, in tip or axis; of each block's end only where that much has
/// passed since the place before.
[[nodiscard]] std::vector<double> stations(const Head& head, const PostureOptions& options);
/// At most so many of them, evenly, with the first and the last.
[[nodiscard]] std::vector<double> thinned(const std::vector<double>& all, std::size_t most);

/// Gamma at t: one for all, or one at the start and one at each block's end, linear between.
[[nodiscard]] double gamma_at(const std::vector<double>& gamma_rad, double t);

/// How far a position is from its limits, as a share of half the joint's range (half a turn or half a metre at most),
/// the least of its joints.
struct LimitShare {
  double share = 1.0;
  int joint = -1;
};
[[nodiscard]] LimitShare limit_share(const robot::Kinematics& kinematics, const robot::Position6& position);

/// How finely a walk looks between its stations.
struct WalkOptions {
  int halvings = 12;      ///< of the way between two stations at most
  double max_step = 0.1;  ///< of a joint between two looks [rad or m]
  bool careful = true;    ///< … and no larger than the regularity there: more might pass through a singularity; else
                          ///< regularity is found at the stations alone
};

/// What following a way along its stations met.
struct Walk {
  robot::Reach reach = {};                                                           ///< found: to the end
  double t = 0.0;                                                                    ///< where it ended
  Margin margin = {};                                                                ///< the least up to there
  robot::Position6 low = robot::Position6::Zero(), high = robot::Position6::Zero();  ///< of each joint up to there
  robot::Position6 last = robot::Position6::Zero();                                  ///< taken
};
[[nodiscard]] inline bool found(const Walk& walk) {
  return walk.reach.status == robot::Reach::Status::found;
}
[[nodiscard]] Walk walk(const robot::Kinematics& kinematics, const Head& head, const std::vector<double>& along,
                        const std::vector<double>& gamma_rad, const robot::Position6& start,
                        const WalkOptions& options);

/// A way with gamma turning along it, by dynamic programming over stations, a grid of gammas and the machine's ways;
/// an empty gamma_rad where there is none.
[[nodiscard]] Posture turning_posture(const robot::Kinematics& kinematics, const Head& head,
                                      const std::vector<double>& along, const PostureOptions& options);

}  // namespace robomill::path
