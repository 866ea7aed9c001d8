#pragma once
#include <Eigen/Core>
#include <vector>

#include "robomill/cutting/milling.hpp"
#include "robomill/stability/frequency_response.hpp"

namespace robomill::stability::detail {

/// The force of a vibration q e^{iωt} over one period of the cut, by Legendre polynomials on the arcs between the
/// angles at which some tooth enters or leaves: there it is smooth, so that few of them say it, while harmonics of a
/// force that jumps come slowly. Orthonormal over the period.
///
/// The force density is a A(ω) f for force coefficients f,
///   A(ω) = Σ_d 𝒦_d S_d(ω),  S_d = Σ_n ψ_nᴴ (c_d(s_n) G(s_n)) ψ_n,  s_n = i(ω + n ω_P),
/// with ψ_n the polynomials' n-th Fourier coefficients (spherical Bessel functions), 𝒦_d the specific cutting stiffness
/// of the teeth with delay τ_d, c_d = 1 - exp(-s τ_d); process damping adds a term with c = s. This is Hill's
/// determinant of the harmonic FRF blocks, det(I - a A(ω)) = 0, after a change of basis.
class ContactBasis {
 public:
  struct Size {
    double highest_rad_per_s = 0.0;  ///< the highest frequency that the polynomials must follow
    int extra = 6;                   ///< polynomials beyond that
    int harmonics = 600;             ///< N, at least; |n| <= N
  };
  /// @param axial_depth_m  what the helix' lag is taken at; without helix nothing depends on it
  ContactBasis(const cutting::Milling& milling, const FrequencyResponse& response, double spindle_speed_rad_per_s,
               double axial_depth_m, const Size& size);

  /// ω_P: of tooth passing for equal pitch, of rotation otherwise [rad/s].
  [[nodiscard]] double period_frequency_rad_per_s() const { return period_frequency_; }
  [[nodiscard]] int polynomials() const { return static_cast<int>(count_); }
  [[nodiscard]] int harmonics() const { return static_cast<int>(far_); }
  /// A(ω) [m^-1], 2m x 2m: the x components of all polynomials, then y's.
  /// @param covered_only  leave out what the measured FRFs do not cover
  void matrix(double frequency_rad_per_s, Eigen::MatrixXcd& out, bool covered_only = false) const;
  /// F_n of force coefficients, n from -near to near.
  [[nodiscard]] Eigen::Vector2cd harmonic(const Eigen::VectorXcd& coefficients, int n) const;
  [[nodiscard]] int near() const { return static_cast<int>(near_); }

 private:
  struct Arc {
    double from = 0.0, to = 0.0;  ///< rotation angles of the tip of tooth 0
    Eigen::Index first = 0, count = 0;
  };
  struct Term {
    bool damping = false;
    double delay_angle = 0.0;                    ///< Ω τ_d
    Eigen::MatrixXd stiffness[2][2];             ///< 𝒦_d, count x count each
    std::vector<Eigen::MatrixXcd> tail;          ///< Σ over near < |n| <= far of ψᴴψ / (in)^p, p from 0
    std::vector<Eigen::MatrixXcd> delayed_tail;  ///< the same with e^{-i n ω_P τ_d}
  };
  void find_arcs(const cutting::Milling& milling, double axial_depth_m, double time_per_rad, const Size& size);
  void find_transforms();
  void find_stiffness(const cutting::Milling& milling, double spindle_speed, double axial_depth_m);
  void find_tails();
  void add_tail(const Term& term, double omega, std::complex<double> delay_factor, Eigen::MatrixXcd (&sum)[2][2]) const;

  const FrequencyResponse& response_;
  double period_rad_ = 0.0, period_frequency_ = 0.0, speed_ = 0.0;
  std::vector<Arc> arcs_;
  std::vector<Term> terms_;
  Eigen::Index count_ = 0, near_ = 0, far_ = 0;
  Eigen::MatrixXcd transform_;  ///< (2 far + 1) x count: row far + n
};

/// Where a tooth enters or leaves at the tip or at the top, in [0, period), increasing [rad].
[[nodiscard]] std::vector<double> contact_angles(const cutting::Milling& milling, double axial_depth_m,
                                                 double period_rad);
/// Nodes in (-1, 1) and weights of Gauss' rule.
void gauss_legendre(Eigen::Index count, Eigen::VectorXd& nodes, Eigen::VectorXd& weights);
/// j_0(z) … j_{count-1}(z).
void spherical_bessel(double z, Eigen::Ref<Eigen::VectorXd> out);
/// Refuses what a frequency-domain method of one spindle speed and whole teeth cannot have.
void require_frequency_domain(const cutting::Milling& milling);

}  // namespace robomill::stability::detail
