#include "robomill/program/machine.hpp"

#include <cmath>

namespace robomill::program {

Eigen::Vector3d tool_axis(Machine machine, double a_rad, double b_rad, double c_rad) {
  const double sin_c = std::sin(c_rad);
  const double cos_c = std::cos(c_rad);
  switch (machine) {
    case Machine::xyzac_trt:
      return {sin_c * std::sin(a_rad), cos_c * std::sin(a_rad), std::cos(a_rad)};
    case Machine::xyzbc_trt:
      return {-cos_c * std::sin(b_rad), sin_c * std::sin(b_rad), std::cos(b_rad)};
    case Machine::xyzac_head:
      return {sin_c * std::sin(a_rad), -cos_c * std::sin(a_rad), std::cos(a_rad)};
    case Machine::xyzbc_head:
      return {cos_c * std::sin(b_rad), sin_c * std::sin(b_rad), std::cos(b_rad)};
  }
  return Eigen::Vector3d::UnitZ();
}

}  // namespace robomill::program
