#include "robomill/modal/modes.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "robomill/base/error.hpp"

namespace robomill::modal {
namespace {

void require_mode_frequency(const std::string& field, double frequency_hz) {
  constexpr double highest_hz = 1e6;
  require_positive(field.c_str(), frequency_hz, "Hz");
  if (frequency_hz > highest_hz) {
    throw InvalidInput(field, frequency_hz, "Hz", "must be at most 1 MHz",
                       "Tools, spindles and robots vibrate far below; are the units mixed up?");
  }
}

void validate_mode(const ModalModel& model, std::size_t k) {
  const Mode& mode = model.modes[k];
  const std::string path = "modes[" + std::to_string(k + 1) + "].";
  require_mode_frequency(path + "frequency_hz", mode.frequency_hz);
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

Mode mode_from_mass(const MassMode& mode, Eigen::Index axis, Eigen::Index axes) {
  Mode out{.frequency_hz = mode.frequency_hz, .damping_ratio = mode.damping_ratio, .left = {}, .right = {}};
  const double size = 1.0 / std::sqrt(2.0 * mode.modal_mass_kg * pole(out).imag());
  out.left = Eigen::VectorXcd::Unit(axes, axis) * size;
  out.right = Eigen::VectorXcd::Unit(axes, axis) * std::complex<double>(0.0, -size);
  return out;
}

ModalModel modes_from_mass(const std::vector<MassMode>& x, const std::vector<MassMode>& y,
                           const std::vector<MassMode>& z) {
  ModalModel model;
  model.excitations = {{.axis = Axis::x}, {.axis = Axis::y}};
  if (!z.empty()) model.excitations.push_back({.axis = Axis::z});
  model.responses = model.excitations;
  const std::array<const std::vector<MassMode>*, 3> given = {&x, &y, &z};
  for (std::size_t axis = 0; axis < given.size(); ++axis) {
    for (std::size_t k = 0; k < given[axis]->size(); ++k) {
      const MassMode& mode = (*given[axis])[k];
      const std::string path = std::string(1, "xyz"[axis]) + "[" + std::to_string(k + 1) + "].";
      require_mode_frequency(path + "frequency_hz", mode.frequency_hz);
      require_positive((path + "modal_mass_kg").c_str(), mode.modal_mass_kg, "kg");
      if (!(mode.damping_ratio > 0.0 && mode.damping_ratio < 1.0)) {
        throw InvalidInput(path + "damping_ratio", mode.damping_ratio, "", "must lie between 0 and 1",
                           "It is a ratio, not a percentage");
      }
      model.modes.push_back(
          mode_from_mass(mode, static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(model.excitations.size())));
    }
  }
  return model;
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

void normalise(Mode& mode) {
  if (mode.left.size() == 0 || mode.right.size() == 0) throw InvalidInput("mode", "has an empty vector");
  if (!mode.left.allFinite() || !mode.right.allFinite()) {
    throw InvalidInput("mode", "holds a value that is not finite");
  }
  const double left = mode.left.stableNorm();
  const double right = mode.right.stableNorm();
  if (left == 0.0 || right == 0.0) {
    mode.left.setZero();
    mode.right.setZero();
    return;
  }
  Eigen::Index largest = 0;
  mode.left.cwiseAbs().maxCoeff(&largest);
  const std::complex<double> turn = std::abs(mode.left(largest)) / mode.left(largest);
  const double norm = std::sqrt(left) * std::sqrt(right);
  mode.left *= turn * (norm / left);
  mode.right *= std::conj(turn) * (norm / right);
  mode.left(largest) = mode.left(largest).real();
}

FrfSet synthesize(const ModalModel& model, const Eigen::VectorXd& frequency_hz) {
  model.validate();
  FrfSet set;
  set.frequency_hz = frequency_hz;
  for (const Dof& excitation : model.excitations) {
    for (const Dof& response : model.responses) {
      set.frfs.push_back({.name = {.response = response, .excitation = excitation},
                          .receptance = Eigen::VectorXcd::Zero(frequency_hz.size())});
    }
  }
  set.validate();
  const Eigen::ArrayXcd s = std::complex<double>(0.0, 2.0 * std::numbers::pi) * frequency_hz.array();
  const auto responses = static_cast<Eigen::Index>(model.responses.size());
  for (const Mode& mode : model.modes) {
    const std::complex<double> lambda = pole(mode);
    const Eigen::ArrayXcd basis = (s - lambda).inverse();
    const Eigen::ArrayXcd conjugate_basis = (s - std::conj(lambda)).inverse();
    for (std::size_t f = 0; f < set.frfs.size(); ++f) {
      const auto index = static_cast<Eigen::Index>(f);
      const std::complex<double> residue = mode.right(index % responses) * mode.left(index / responses);
      set.frfs[f].receptance.array() += residue * basis + std::conj(residue) * conjugate_basis;
    }
  }
  for (const Residual& residual : model.residuals) {
    for (Frf& frf : set.frfs) {
      if (frf.name != residual.name) continue;
      frf.receptance.array() += residual.stiffness;
      if (residual.mass == 0.0) continue;
      if (frequency_hz(0) == 0.0) {
        throw InvalidInput("frequency_hz[0]", 0.0, "Hz", "must be > 0 where a residual has a mass");
      }
      frf.receptance.array() += residual.mass / s.square();
    }
  }
  return set;
}

}  // namespace robomill::modal
