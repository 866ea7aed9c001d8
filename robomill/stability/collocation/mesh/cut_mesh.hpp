#pragma once
#include <Eigen/Core>
#include <vector>

#include "robomill/stability/collocation/mesh/contacts.hpp"
#include "robomill/stability/rotation.hpp"

namespace robomill::stability::detail {

inline constexpr double same_angle = 1e-10;       ///< closer is at one place [rad]
inline constexpr double longest_piece_rad = 8.0;  ///< of the fastest mode: what a piece's nodes can follow

/// How finely the rotation is taken.
struct MeshLevel {
  int nodes = 8;    ///< p, Gauss points of a piece
  int splits = 1;   ///< parts of each piece that is otherwise as long as it may be
  int heights = 6;  ///< Gauss points along the edge where the delay changes with height
  int slices = 8;   ///< of a cutter with runout and helix
};

/// Where a node looks back to.
struct Source {
  int piece = 0;
  bool before = false;  ///< in the period before this one
  bool exact = false;   ///< at the same node of that piece; else by interpolation through its nodes
  bool operator==(const Source&) const = default;
};

/// What a point has in common with its neighbours in the chart: points of one topology are solved side by side.
struct MeshTopology {
  /// What is remembered of a node. chip: sᵀq along the chip thickness, enough where one straight tooth cuts at a time;
  /// whole: q, where all that cut look back by one delay; several: q, with several delays or process damping; blocks:
  /// the same in three directions, a matrix for each earlier piece that is looked back to.
  enum class Form { chip, whole, several, blocks };
  struct Piece {
    bool records = false;              ///< false: free flight that nobody looks back to
    int groups = 0;                    ///< delays at work
    std::vector<Source> sources = {};  ///< [group * nodes + node]; of blocks one for each earlier piece
    bool operator==(const Piece&) const = default;
  };
  int nodes = 0;
  Form form = Form::chip;
  int directions = 2;
  std::vector<Piece> pieces = {};
  bool operator==(const MeshTopology&) const = default;
  [[nodiscard]] int channels() const { return form == Form::chip ? 1 : directions; }
};

/// One period of rotation in pieces. Borders stand where a tooth, or an end of its edge, enters or leaves.
struct CutMesh {
  struct Piece {
    double from_rad = 0.0, length_rad = 0.0;
    // At each node, per axial depth:
    std::vector<Eigen::Vector2d> chip, push;         ///< Form::chip: s, and b of F = a b (sᵀΔ) [N/m^2]
    std::vector<Eigen::Matrix2d> stiffness;          ///< other forms: K, of all that cuts [N/m^2]
    std::vector<Eigen::Matrix2d> delayed_stiffness;  ///< Form::several: [group * nodes + node]
    std::vector<Eigen::Matrix2d> damping;            ///< empty without process damping [N s/m^2]
    std::vector<double> weights;  ///< [(group * nodes + node) * nodes + l]: what interpolation takes from node l
  };
  MeshTopology topology;
  std::vector<Piece> pieces;
  double period_rad = 0.0;
};

/// @param repeats            how often the cutter's period fits into that of the whole
/// @param fastest_rad_per_s  of the structure's modes
/// @param axial_depth_m      > 0
/// @param least              remember no less than this
void build_mesh(const CutterContacts& contacts, int repeats, double fastest_rad_per_s, const Rotation& turning,
                double axial_depth_m, const MeshLevel& level, MeshTopology::Form least, CutMesh& out);

}  // namespace robomill::stability::detail
