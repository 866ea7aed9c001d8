#pragma once
#include <Eigen/Core>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "robomill/stability/collocation/cut_mesh.hpp"
#include "robomill/stability/time_steps/piece_plan.hpp"
#include "robomill/stability/tip_dynamics.hpp"

namespace robomill::stability::detail {

/// What no point of the chart changes. Shared by threads.
struct CollocationModel {
  /// @throws InvalidInput if swing and cut of a varied speed have no common period of a sensible length
  explicit CollocationModel(const LobesProblem& problem, MeshTopology::Form least = MeshTopology::Form::chip);
  TipDynamics tip;
  cutting::SpeedVariation variation;
  CutterContacts contacts;  ///< its angles and delays; where slices count, see MeshLevel
  cutting::Milling milling;
  int repeats = 1;                 ///< of the cutter's period in that of the whole
  double fastest_rad_per_s = 0.0;  ///< of the modes
  /// By how much the cut quickens the structure: the square of its rate grows by this with the depth [rad^2/(s^2 m)].
  double quickening = 0.0;
  MeshTopology::Form least = MeshTopology::Form::chip;  ///< remember no less
  /// Rotation over which the spectral radius is reported, and that of the whole period.
  [[nodiscard]] double reported_rad() const;
  [[nodiscard]] double whole_rad() const { return contacts.period_rad() * repeats; }
};

/// Everything about one spindle speed at one level, and where angles depend on it, about one depth: for the force
/// a b g at the nodes of each piece, with g = O z + a R g - c (collocation_kernels.hpp).
struct CollocationCase {
  struct Piece {
    std::size_t plan = 0;           ///< entry of plans
    Eigen::MatrixXd coupling;       ///< R, m x m
    Eigen::MatrixXd observation;    ///< O, m x 2n
    Eigen::MatrixXd influence;      ///< W, 2n x m
    Eigen::MatrixXd displacement;   ///< D, m x 2n; Form::several alone
    Eigen::MatrixXd node_response;  ///< C, m x m; Form::several alone
  };
  double spindle_speed_rad_per_s = 0.0;
  double axial_depth_m = 0.0;  ///< that the mesh was made for
  MeshLevel level;
  CutMesh mesh;
  std::vector<PiecePlan> plans;
  std::vector<Piece> pieces;
};
void prepare_case(const CollocationModel& model, double spindle_speed_rad_per_s, double axial_depth_m,
                  const MeshLevel& level, CollocationCase& out);

/// Where things stand in the state and in the memory of one period.
struct NodeLayout {
  NodeLayout() = default;
  NodeLayout(const MeshTopology& topology, std::size_t modes);
  std::size_t modal = 0;            ///< 2n
  std::size_t nodes = 0;            ///< m, nodes times channels of a piece
  std::vector<std::size_t> before;  ///< [piece]: entry of memory with what it left in the period before
  std::vector<std::size_t> record;  ///< [piece]: entry of memory for what it leaves in this one
  std::vector<std::size_t> handed;  ///< entries of memory that the next period starts from
  std::size_t memory = 0;           ///< length
  [[nodiscard]] std::size_t size() const { return modal + handed.size(); }
  static constexpr std::size_t nowhere = static_cast<std::size_t>(-1);
};

/// One period's motion from its state at the start.
struct NodeForces {
  std::vector<double> time_s, weight_s;  ///< of the nodes; weights integrate over the period
  std::vector<Eigen::Vector2cd> force_n;
  std::vector<Eigen::Vector2cd> displacement_m;  ///< at the nodes of pieces with contact; Form::several alone
  std::vector<Eigen::VectorXcd> starts;          ///< modes at the start of each piece
  Eigen::VectorXcd end;                          ///< state after the period
};
/// @param forcing_n_per_m  force per depth that acts beside the regenerative one, at the nodes in order; Form::several
///                         alone, or empty
NodeForces trace(const CollocationModel& model, const CollocationCase& point, double axial_depth_m,
                 const Eigen::VectorXcd& state, std::span<const Eigen::Vector2d> forcing_n_per_m = {});

}  // namespace robomill::stability::detail
