#include "robomill/modal/modes.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include "robomill/base/error.hpp"

namespace robomill::modal {
namespace {

void validate_mode(const ModalModel& model, std::size_t k) {
  const Mode& mode = model.modes[k];
  const std::string path = "modes[" + std::to_string(k + 1) + "].";
  require_positive((path + "frequency_hz").c_str(), mode.frequency_hz, "Hz");
  if (!(mode.damping_ratio > 0.0 && mode.damping_ratio < 1.0)) {
    throw InvalidInput(path + "damping_ratio", mode.damping_ratio, "", "must lie between 0 and 1",
                       "It is a ratio, not a percentage; a passive structure has it above 0");
  }
  const auto check = [&](const char* member, const Eigen::VectorXcd& vector, std::size_t size) {
    if (vector.size() != static_cast<Eigen::Index>(size)) {
      throw InvalidInput(path + member, static_cast<double>(vector.size()), "entries",
                         "must have one entry for each degree of freedom (" + std::to_string(size) + ")");
    }
    if (!vector.allFinite()) throw InvalidInput(path + member, "holds a value that is not finite");
  };
  check("left", mode.left, model.excitations.size());
  check("right", mode.right, model.responses.size());
}

}  // namespace

std::complex<double> pole(const Mode& mode) {
  const double omega = 2.0 * std::numbers::pi * mode.frequency_hz;
  return {-mode.damping_ratio * omega, omega * std::sqrt(1.0 - mode.damping_ratio * mode.damping_ratio)};
}

void ModalModel::validate() const {
  if (excitations.empty() || responses.empty()) throw InvalidInput("modes", "name no degree of freedom");
  for (std::size_t k = 0; k < modes.size(); ++k) validate_mode(*this, k);
  for (const Residual& residual : residuals) {
    if (!std::isfinite(std::abs(residual.mass)) || !std::isfinite(std::abs(residual.stiffness))) {
      throw InvalidInput("residuals." + to_string(residual.name), "holds a value that is not finite");
    }
  }
}

}  // namespace robomill::modal
