#include "robomill/report/checks.hpp"

#include <cmath>

#include "robomill/base/error.hpp"

namespace robomill::report {

std::string member(std::string_view list, std::size_t index, std::string_view name) {
  return std::string(list) + "[" + std::to_string(index) + "]." + std::string(name);
}

void require_axis(const std::string& field, const Eigen::VectorXd& axis) {
  for (Eigen::Index i = 0; i < axis.size(); ++i) {
    if (!std::isfinite(axis[i])) throw InvalidInput(field, "must be finite");
    if (i > 0 && axis[i] <= axis[i - 1]) throw InvalidInput(field, "must increase");
  }
}

void require_length(const std::string& field, Eigen::Index length, Eigen::Index expected, bool may_be_empty) {
  if (length == expected || (may_be_empty && length == 0)) return;
  throw InvalidInput(field, "has " + std::to_string(length) + " values where its axis has " + std::to_string(expected));
}

void require_all_finite(const std::string& field, const Eigen::Ref<const Eigen::MatrixXd>& values) {
  if (!values.allFinite()) throw InvalidInput(field, "must be finite");
}

void require_band(const std::string& field, const signal::Band& band, Eigen::Index runs, bool may_be_empty) {
  require_length(field + ".low", band.low.size(), runs, may_be_empty);
  require_length(field + ".high", band.high.size(), band.low.size(), false);
  require_all_finite(field + ".low", band.low);
  require_all_finite(field + ".high", band.high);
}

}  // namespace robomill::report
