#pragma once
#include <Eigen/Core>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/cutting/milling.hpp"

/// Tool frame T: origin at the tip (where the axis meets the plane that the cutter stands on), z along the axis towards
/// the spindle; a point of the cutter at (r sin φ, r cos φ, z), φ clockwise from +y as in milling.hpp. docs/frames.md.
// Method: robomill/cutting/README.md, "Cutters (`cutter.hpp`)"
namespace robomill::cutting {

/// The shape of an end mill, and which members of Cutter give it.
enum class CutterKind {
  flat_end,   ///< a cylinder of diameter D with a sharp corner: mill alone
  ball_end,   ///< a hemisphere of radius D/2 below a cylinder: mill alone
  bull_nose,  ///< a flat bottom and a side upright, joined by a corner arc of corner_radius_m
  general     ///< bottom, corner and side are free: tapers, drill points; every member counts
};

/// Any end mill: a bottom rising at `bottom_angle_rad`, a corner arc, a side at `side_angle_rad` from the axis
/// [EnginAltintas2001]. Edges have constant lead: a point at height z lags the tip by 2 z tan(β) / D on every shape, so
/// on a ball by (1 - cos θ) tan β.
struct ROBOMILL_API Cutter {
  CutterKind kind = CutterKind::flat_end;
  FlatEndMill mill;                     ///< teeth, D, helix, pitch, runout. D of a general cutter: where bottom and
                                        ///< side, produced, meet
  double cutting_height_m = 0.0;        ///< how far above the tip the edges reach; above it is shank [m]; 0: 2 D
  double corner_radius_m = 0.0;         ///< R: of bull_nose (0 < R < D/2) and general (>= 0) [m]
  double corner_center_radius_m = 0.0;  ///< general, where R > 0: of the arc's centre from the axis [m]
  double corner_center_height_m = 0.0;  ///< general, where R > 0: of the arc's centre above the tip [m]
  double bottom_angle_rad = 0.0;        ///< general: in [0, 0.48 π), above the plane that the cutter stands on [rad]
  double side_angle_rad = 0.0;  ///< general: in (-0.48 π, 0.48 π), bottom + side < π/2; > 0 widens upwards [rad]
  /// @throws InvalidInput naming the member, also where arc and lines do not meet in a convex outline
  void validate() const;
};

/// The convex profile of a cutter by its length s from the tip: bottom, corner, side.
class ROBOMILL_API Profile {
 public:
  /// @throws InvalidInput as Cutter::validate
  explicit Profile(const Cutter& cutter);

  struct Point {
    double radius_m = 0.0, height_m = 0.0;
    double position_rad = 0.0;  ///< κ, of the outward normal from -z: 0 at a ball's pole, π/2 on a cylinder
  };
  struct Piece {
    double start_m = 0.0, length_m = 0.0;  ///< of s
    Point first, last;
    double arc_radius_m = 0.0;  ///< 0: a straight line
  };
  /// s in [0, length_m()].
  [[nodiscard]] Point at(double length_m) const;
  /// Of the part with edges.
  [[nodiscard]] double length_m() const { return pieces_.back().start_m + pieces_.back().length_m; }
  /// Where the edges end and the shank begins, above the tip.
  [[nodiscard]] double height_m() const { return pieces_.back().last.height_m; }
  /// Of the envelope at a height >= 0 above the tip; the shank goes on straight with the last radius.
  [[nodiscard]] double radius_m(double height_m) const;
  [[nodiscard]] double max_radius_m() const;
  /// In the order of s, none of zero length.
  [[nodiscard]] const std::vector<Piece>& pieces() const { return pieces_; }

 private:
  std::vector<Piece> pieces_;
};

/// ds / db of tooth j: its helical edge against the profile, sqrt(1 + (r sin κ dφ/dz)²) with the lag dφ/dz = 2
/// tan(β_j) / D; on a ball sqrt(1 + sin⁴κ tan²β).
[[nodiscard]] ROBOMILL_API double edge_length_per_width(const FlatEndMill& mill, int tooth,
                                                        const Profile::Point& point);

}  // namespace robomill::cutting
