#pragma once
// From FRFs to fit units and back.
#include <cstddef>
#include <vector>

#include "robomill/modal/fitting/fit_kernel.hpp"
#include "robomill/modal/fitting/fit_search.hpp"
#include "robomill/modal/modes.hpp"

namespace robomill::modal::detail {

/// The lines of the band, without one at 0 Hz.
/// @throws InvalidInput if the band holds no line
[[nodiscard]] FrfSet cut_band(const FrfSet& set, double low_hz, double high_hz);

/// FRFs that share responses or excitations, directly or through others: R and L of one mode relate them.
struct Part {
  std::vector<Dof> excitations, responses;
  std::vector<std::size_t> frfs;                   // into the set, in the order of data.entries
  FitData data;                                    // weights not yet set
  double omega_unit = 1.0;                         // [rad/s]
  Eigen::VectorXd response_unit, excitation_unit;  // receptance in units of their product
  [[nodiscard]] double unit(const FitEntry& entry) const {
    return response_unit(entry.response) * excitation_unit(entry.excitation);
  }
};
[[nodiscard]] std::vector<Part> split(const FrfSet& set);

/// The fit of one part.
struct PartFit {
  Poles poles;
  Evaluation at;
  Eigen::VectorXd omega_std, zeta_std;  // empty where unknown
  std::vector<double> dropped_omega;    // of weak modes without which the fit is as good
  bool converged = false;
  bool held_back = false;  // fewer modes than the criterion asks for: see fit_hybrid.cpp
  int iterations = 0;
  std::vector<double> cost;  // weighted relative error after each iteration
  std::vector<LscfPole> diagram;
};

/// Adds the part's modes and residuals to a model whose degrees of freedom hold the part's. Entries of degrees of
/// freedom outside the part are zero.
void add_to_model(ModalModel& model, const Part& part, const PartFit& fit, bool residuals);

/// Responses and excitations of the set in order of their first appearance, no modes.
[[nodiscard]] ModalModel empty_model(const FrfSet& set);

}  // namespace robomill::modal::detail
