#pragma once
// The modal fit's data in fit units, and its parameters.
#include <Eigen/Core>
#include <complex>
#include <vector>

namespace robomill::modal::detail {

/// One FRF of the fit.
struct FitEntry {
  Eigen::Index response = 0, excitation = 0;  // rows of `right`, rows of `left`
  Eigen::VectorXcd receptance;                // length n
  Eigen::VectorXd weight;                     // length n: 1 / standard deviation
};

/// FRFs in units of their size, over ω in units of the band's upper edge: s = iω.
struct FitData {
  Eigen::VectorXd omega;  // length n, > 0, at most 1
  Eigen::Index responses = 0, excitations = 0;
  std::vector<FitEntry> entries;
  bool residuals = true;  // mass and stiffness terms for each entry
};

/// The parameters of the fit that are not linear. Of each mode's left vector the entry `gauge` is 1.
struct Poles {
  Eigen::VectorXd omega, zeta;  // length m
  Eigen::MatrixXcd left;        // excitations x m
  std::vector<Eigen::Index> gauge;

  [[nodiscard]] Eigen::Index size() const { return omega.size(); }
  [[nodiscard]] std::complex<double> pole(Eigen::Index k) const;
  /// Divides each left vector by its largest entry, which becomes its gauge.
  void fix_gauge();
  /// All but the modes of that index.
  [[nodiscard]] Poles without(Eigen::Index k) const;
  /// With one mode more at the end.
  [[nodiscard]] Poles with(double new_omega, double new_zeta, const Eigen::VectorXcd& new_left) const;
};

/// Free real parameters: for each mode ω, ζ, and the real and imaginary part of every entry of left but its gauge.
[[nodiscard]] Eigen::Index parameter_count(const FitData& data, Eigen::Index modes);
[[nodiscard]] Eigen::VectorXd to_parameters(const Poles& poles);
/// @param shape  gives the sizes and the gauges
[[nodiscard]] Poles from_parameters(const Eigen::VectorXd& parameters, const Poles& shape);

}  // namespace robomill::modal::detail
