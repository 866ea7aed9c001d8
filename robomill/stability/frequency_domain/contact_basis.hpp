#pragma once
#include <Eigen/Core>
#include <array>
#include <vector>

#include "robomill/cutting/milling.hpp"
#include "robomill/stability/frequency_response.hpp"

namespace robomill::stability::detail {

/// The force F(t) = e^{iωt} (periodic) of a vibration over one period of the cut, by Legendre polynomials on the arcs
/// between the angles at which some tooth enters or leaves: there it is smooth, so that few of them say it, while
/// harmonics of a force that jumps come slowly. Orthonormal over the period.
///
/// The force coefficients f obey f = a A(ω) f,
///   A(ω) = Σ_d 𝒦_d Σ_n ψ_nᴴ (c_d(s_n) G(s_n)) ψ_n,  s_n = i(ω + n ω_P),
/// with ψ_n the polynomials' Fourier transforms at s_n (spherical Bessel functions), 𝒦_d the specific cutting stiffness
/// of the teeth with delay τ_d, c_d = 1 - exp(-s τ_d); process damping adds a term with c = s. This is Hill's
/// determinant of the harmonic FRF blocks, det(I - a A(ω)) = 0, after a change of basis. All n together give the
/// identity, which takes care of what G tends to; harmonics beyond the resonances are smooth in ω and are interpolated
/// from a few Chebyshev points.
class ContactBasis {
 public:
  struct Size {
    double highest_rad_per_s = 0.0;  ///< the highest frequency that the polynomials must follow
    int extra = 6;                   ///< polynomials beyond that
    int harmonics = 600;             ///< N, at least; |n| <= N
    bool interpolated = true;        ///< the harmonics beyond the resonances, for many frequencies; else each anew
  };
  /// Frequencies must lie in [0, ω_P / 2].
  /// @param axial_depth_m  what the helix' lag is taken at; without helix nothing depends on it
  ContactBasis(const cutting::Milling& milling, const FrequencyResponse& response, double spindle_speed_rad_per_s,
               double axial_depth_m, const Size& size);

  /// ω_P: of tooth passing for equal pitch, of rotation otherwise [rad/s].
  [[nodiscard]] double period_frequency_rad_per_s() const { return period_frequency_; }
  /// A(ω) [m^-1], 2m x 2m: the x components of all polynomials, then y's.
  /// @param covered_only  leave out what the measured FRFs do not cover
  void matrix(double frequency_rad_per_s, Eigen::MatrixXcd& out, bool covered_only = false) const;
  /// F_n of force coefficients.
  [[nodiscard]] Eigen::Vector2cd harmonic(const Eigen::VectorXcd& coefficients, double frequency_rad_per_s,
                                          int n) const;
  [[nodiscard]] int near() const { return static_cast<int>(near_); }

 private:
  using Blocks = std::array<Eigen::MatrixXcd, 4>;  ///< xx, yx, xy, yy
  struct Arc {
    double from = 0.0, to = 0.0;  ///< rotation angles of the tip of tooth 0
    Eigen::Index first = 0, count = 0;
  };
  struct Term {
    bool damping = false;
    double delay_angle = 0.0;                                    ///< Ω τ_d
    std::array<std::vector<Eigen::MatrixXd>, 4> stiffness = {};  ///< 𝒦_d by arc: xx, yx, xy, yy
    std::array<Eigen::Matrix2d, 2> limit = {};  ///< what the gain tends to: constant, and times the delay's factor
    std::vector<Blocks> tail = {};  ///< Σ over near < |n| <= far of ψᴴ (gain - limit) ψ at the Chebyshev points
  };
  void find_arcs(const cutting::Milling& milling, double axial_depth_m, const Size& size);
  void find_stiffness(const cutting::Milling& milling, double axial_depth_m);
  void find_tails();
  void multiply(const Term& term, std::size_t arc, const Blocks& sum, Eigen::MatrixXcd& out) const;
  [[nodiscard]] bool acts(const Term& term, std::size_t arc) const;
  /// ψ at ω + n ω_P = turns κ Ω.
  void transform(double turns, Eigen::Ref<Eigen::RowVectorXcd> out) const;
  [[nodiscard]] Eigen::Matrix2cd gain(const Term& term, double frequency, const Eigen::Matrix2cd& receptance) const;
  void add_rows(double frequency, Eigen::Index from, Eigen::Index to, bool covered_only,
                std::vector<Blocks>& sums) const;

  const FrequencyResponse& response_;
  double period_rad_ = 0.0, period_frequency_ = 0.0, speed_ = 0.0;
  std::vector<Arc> arcs_;
  std::vector<Term> terms_;
  bool interpolated_ = true;
  Eigen::Index count_ = 0, near_ = 0, far_ = 0;
};

/// Where a tooth enters or leaves at the tip or at the top, in [0, period), increasing [rad].
[[nodiscard]] std::vector<double> contact_angles(const cutting::Milling& milling, double axial_depth_m,
                                                 double period_rad);
/// j_0(z) … j_{count-1}(z).
void spherical_bessel(double z, Eigen::Ref<Eigen::VectorXd> out);
/// Rejects what a frequency-domain method of one spindle speed and whole teeth cannot have.
void require_frequency_domain(const cutting::Milling& milling);

}  // namespace robomill::stability::detail
