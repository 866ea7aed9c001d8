#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/io/stl.hpp"
#include "robomill/robot/arm.hpp"

// Method: robomill/robot/README.md, "Collisions (`collision.hpp`)"

namespace robomill::robot {

/// A solid that stands in the cell. Closed where every edge of its mesh belongs to two triangles; of a mesh that is
/// not, the surface alone counts.
struct Body {
  std::string name = {};
  io::TriangleMesh mesh = {};
};

/// All points within half a diameter of a line: a cylinder with round ends.
struct Capsule {
  Eigen::Vector3d from_m = Eigen::Vector3d::Zero(), to_m = Eigen::Vector3d::Zero();
  double diameter_m = 0.0;  ///< > 0
};

/// A solid that moves with a link of the arm: a mesh or a capsule.
struct LinkBody {
  int link = -1;  ///< k in 0 … n: with the frame after joint k (Arm::Joint); 0: stands still, in B
  std::string name = {};
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< from the mesh or the capsule to that frame
  io::TriangleMesh mesh = {};
  std::optional<Capsule> capsule = {};
};

/// A cylinder or a cone about the tool's axis.
struct ToolSection {
  double length_m = 0.0;          ///< > 0
  double lower_diameter_m = 0.0;  ///< at its end towards the tip, >= 0
  double upper_diameter_m = 0.0;  ///< at its other end, >= 0; one of them > 0
};

/// A corner of an outline that is turned about the tool's axis.
struct OutlinePoint {
  double height_m = 0.0;  ///< above the tip, >= 0
  double radius_m = 0.0;  ///< >= 0
};

/// What turns with the tool and what carries it. From the tip upwards: edges, shank up to stickout_m, holder, spindle.
struct ToolGeometry {
  /// What the cutter's edges sweep, from the tip up: the first point at height 0, no height falling, convex. An arc is
  /// given by points on it.
  std::vector<OutlinePoint> edges = {};
  double stickout_m = 0.0;               ///< from the tip to the holder; at least the height of the edges [m]; required
  double shank_diameter_m = 0.0;         ///< between edges and holder [m]; 0: as the edges at their top
  std::vector<ToolSection> holder = {};  ///< one above the other, the first at stickout_m
  std::vector<ToolSection> spindle = {};  ///< above the holder
  std::vector<Body> spindle_bodies = {};  ///< of any shape, in E; the tip is at (0, 0, tool_length_m)
};

/// What stands in the cell and what moves in it.
struct ROBOMILL_API CellGeometry {
  std::vector<Body> part = {}, fixtures = {};  ///< in W. The part is the finished one: stock is cut, not struck
  std::vector<Body> cell = {};                 ///< table, fence and the like, in B
  std::vector<LinkBody> arm = {};
  ToolGeometry tool = {};
  double clearance_m = -1.0;        ///< the least distance of everything but the cutter's edges, >= 0 [m]; required
  double gouge_tolerance_m = -1.0;  ///< how deep the edges may stand in the finished part, >= 0 [m]; required with part
  bool self_collision = false;      ///< also links i and j of the arm against each other where |i − j| > 1
  std::vector<std::pair<std::string, std::string>> ignored = {};  ///< pairs of bodies, by name, that are not checked
  /// @throws InvalidInput naming the member ("arm[2].link", counted from 1), or the two bodies of one name
  void validate(const Cell& cell) const;
};

/// How one position of the arm stands.
struct Clearance {
  enum class Status {
    clear,     ///< nothing is nearer than the clearance, and no gouge
    too_near,  ///< two bodies are nearer than the clearance
    gouge,     ///< the cutter's edges stand deeper in the finished part than the tolerance
    collision  ///< two bodies intersect, or one is inside the other
  };
  Status status = Status::clear;
  std::string first = {}, second = {};  ///< the two bodies that the status is about; where clear the nearest two, if
                                        ///< any within reach
  double distance_m = 0.0;  ///< least distance, up to the reach of the check [m]; 0 in a collision; in a gouge that of
                            ///< the rest
  double depth_m = 0.0;     ///< in a gouge or a collision of the edges: how deep [m], CollisionChecker; else 0
};

/// How a straight move of the joints stands.
struct MoveClearance {
  Clearance clearance = {};  ///< of the first look that is not clear; where all are, of the nearest
  double fraction = 1.0;     ///< of that look along the move, 0 … 1
  int looks = 0;             ///< how many positions were checked
};

/// Checks positions of an arm against all that stands in the cell.
///
/// Distances are those of triangles (FCL); cylinders and cones are meshes around them that stand off at most 20 µm, so
/// that a distance comes out short by that much at most. A depth is exact: the largest distance of a point of the part,
/// or fixture, that is inside the edges' outline from that outline's surface. Moves of a checker leave nothing behind;
/// its checks may run in several threads at once.
class ROBOMILL_API CollisionChecker {
 public:
  /// @throws InvalidInput as CellGeometry::validate and Cell::validate; also where the edges are not given
  CollisionChecker(const Cell& cell, const CellGeometry& geometry);
  ~CollisionChecker();
  CollisionChecker(CollisionChecker&&) noexcept;
  CollisionChecker& operator=(CollisionChecker&&) noexcept;
  CollisionChecker(const CollisionChecker&) = delete;
  CollisionChecker& operator=(const CollisionChecker&) = delete;

  /// Checked are: links 1 … n, holder, shank and spindle against part, fixtures and cell; shank, holder and spindle
  /// against links 0 … n − 2; edges against fixtures, cell and links 0 … n − 2 (collision), and against the part
  /// (gouge).
  /// @param position  length n
  /// @param reach_m   how far to look for the nearest two bodies; at least the clearance is
  /// @throws InvalidInput if position has another length or is not finite
  [[nodiscard]] Clearance check(const Eigen::Ref<const Eigen::VectorXd>& position, double reach_m = 0.0) const;

  /// Every joint runs evenly from one position to the other. Between two looks no point of arm or tool moves more than
  /// step_m. A clearance of at least half a step leaves no collision between two looks unseen.
  /// @throws InvalidInput as check, or unless step_m > 0 and there are at most 1,000,000 looks
  [[nodiscard]] MoveClearance check_move(const Eigen::Ref<const Eigen::VectorXd>& from,
                                         const Eigen::Ref<const Eigen::VectorXd>& to, double step_m) const;

  /// At least the length of the longest way of any point of arm and tool in such a move [m].
  [[nodiscard]] double longest_way_m(const Eigen::Ref<const Eigen::VectorXd>& from,
                                     const Eigen::Ref<const Eigen::VectorXd>& to) const;

  /// Sentences on what the check cannot see: meshes that are not closed.
  [[nodiscard]] const std::vector<std::string>& notes() const;

 private:
  struct State;
  std::unique_ptr<const State> state_;
};

}  // namespace robomill::robot
