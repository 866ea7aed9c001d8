#include "robomill/modal/mac.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "robomill/base/error.hpp"

namespace robomill::modal {

double mac(const Eigen::Ref<const Eigen::VectorXcd>& a, const Eigen::Ref<const Eigen::VectorXcd>& b) {
  if (a.size() != b.size() || a.size() == 0) throw InvalidInput("vectors", "must have the same length, at least 1");
  if (!a.allFinite() || !b.allFinite()) throw InvalidInput("vectors", "hold a value that is not finite");
  const double scale_a = a.cwiseAbs().maxCoeff();
  const double scale_b = b.cwiseAbs().maxCoeff();
  if (scale_a == 0.0 || scale_b == 0.0) return 0.0;
  // Unit vectors: receptances squared twice would leave the range of double.
  const Eigen::VectorXcd unit_a = (a / scale_a).normalized();
  const Eigen::VectorXcd unit_b = (b / scale_b).normalized();
  return std::min(1.0, std::norm(unit_a.dot(unit_b)));
}

Eigen::MatrixXd mac(const ModalModel& a, const ModalModel& b) {
  a.validate();
  b.validate();
  if (a.excitations != b.excitations || a.responses != b.responses) {
    throw InvalidInput("modes", "must have the same degrees of freedom in the same order to be compared");
  }
  const auto size = [](const ModalModel& model) { return static_cast<Eigen::Index>(model.modes.size()); };
  Eigen::MatrixXd result(size(a), size(b));
  for (Eigen::Index i = 0; i < size(a); ++i) {
    for (Eigen::Index j = 0; j < size(b); ++j) {
      const Mode& p = a.modes[static_cast<std::size_t>(i)];
      const Mode& q = b.modes[static_cast<std::size_t>(j)];
      result(i, j) = mac(p.right, q.right) * mac(p.left, q.left);
    }
  }
  return result;
}

Eigen::VectorXd frac(const FrfSet& measured, const FrfSet& synthesised) {
  measured.validate();
  synthesised.validate();
  if (measured.frequency_hz.size() != synthesised.frequency_hz.size() ||
      measured.frequency_hz != synthesised.frequency_hz) {
    throw InvalidInput("frequency_hz", "must be the same in both sets of FRFs");
  }
  Eigen::VectorXd result(static_cast<Eigen::Index>(measured.frfs.size()));
  Eigen::Index i = 0;
  for (const Frf& frf : measured.frfs) {
    const Frf* other = synthesised.find(frf.name);
    if (other == nullptr) throw InvalidInput("frfs." + to_string(frf.name), "is missing from the set to compare with");
    result(i++) = mac(frf.receptance, other->receptance);
  }
  return result;
}

}  // namespace robomill::modal
