#pragma once
#include <Eigen/Core>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "robomill/stability/collocation/mesh/cut_mesh.hpp"
#include "robomill/stability/time_steps/piece_plan.hpp"
#include "robomill/stability/vibration/tip_dynamics.hpp"

namespace robomill::stability::detail {

/// Everything about one spindle speed at one level, and where angles depend on it, about one depth: for the force
/// a b g at the nodes of each piece, with g = O z + a R g - c (collocation_kernels.hpp).
struct CollocationCase {
  struct Piece {
    std::size_t plan = 0;           ///< entry of plans
    Eigen::MatrixXd coupling;       ///< R, m x m
    Eigen::MatrixXd observation;    ///< O, m x 2n
    Eigen::MatrixXd influence;      ///< W, 2n x m
    Eigen::MatrixXd displacement;   ///< D, m x 2n; Form::several and blocks alone
    Eigen::MatrixXd node_response;  ///< C, m x m; the same
    Eigen::MatrixXd stiffness;      ///< M of the force M g at the nodes, m x m [N/m]; in three directions, Form::whole
    std::vector<Eigen::MatrixXd> delayed;  ///< Form::blocks: m x m for each source [N/m]
  };
  double spindle_speed_rad_per_s = 0.0;
  double axial_depth_m = 0.0;  ///< that the mesh was made for
  MeshLevel level;
  CutMesh mesh;
  std::vector<PiecePlan> plans;
  std::vector<Piece> pieces;
};

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

/// One period's motion from its state at the start, in D directions.
template <int D>
struct NodeForces {
  using Vector = Eigen::Matrix<std::complex<double>, D, 1>;
  std::vector<double> time_s, weight_s;  ///< of the nodes; weights integrate over the period
  std::vector<Vector> force_n;
  std::vector<Vector> displacement_m;    ///< at the nodes of pieces with contact; Form::several and blocks
  std::vector<Eigen::VectorXcd> starts;  ///< modes at the start of each piece
  Eigen::VectorXcd end;                  ///< state after the period
};
/// @param factor           what the case's stiffness is multiplied by
/// @param forcing_n_per_m  force per factor that acts beside the regenerative one, at the nodes in order; Form::several
///                         alone, or empty
template <int D>
NodeForces<D> trace(const CollocationCase& point, double factor, const Eigen::VectorXcd& state,
                    std::span<const Eigen::Matrix<double, D, 1>> forcing_n_per_m = {});
extern template NodeForces<2> trace<2>(const CollocationCase&, double, const Eigen::VectorXcd&,
                                       std::span<const Eigen::Vector2d>);
extern template NodeForces<3> trace<3>(const CollocationCase&, double, const Eigen::VectorXcd&,
                                       std::span<const Eigen::Vector3d>);

/// (1/T) ∫ F(t) exp(-s t) dt over the period T.
template <int D>
typename NodeForces<D>::Vector fourier_coefficient(const NodeForces<D>& forces, double period_s,
                                                   std::complex<double> s);
extern template NodeForces<2>::Vector fourier_coefficient<2>(const NodeForces<2>&, double, std::complex<double>);
extern template NodeForces<3>::Vector fourier_coefficient<3>(const NodeForces<3>&, double, std::complex<double>);

}  // namespace robomill::stability::detail
