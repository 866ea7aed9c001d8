#pragma once
// Beams that nothing holds.
#include <Eigen/Core>
#include <Eigen/LU>
#include <cstddef>
#include <utility>
#include <vector>

#include "robomill/coupling/assembly.hpp"
#include "robomill/coupling/base.hpp"
#include "robomill/coupling/beam_element.hpp"
#include "robomill/modal/frf.hpp"

namespace robomill::coupling::testing {

/// Receptances of segments that hang free, between their ends: point 1 is the first segment's end, 2 the last one's.
/// FRFs 1x:1x, 1x:1my, 1ry:1x, …, 2ry:2my: sixteen, in the plane of x.
inline modal::FrfSet free_frfs(const std::vector<Segment>& segments, const Eigen::VectorXd& frequency_hz) {
  std::vector<Eigen::Matrix4cd> receptance;
  for (const detail::BeamElement& element : detail::beam_elements(segments, frequency_hz)) {
    const Eigen::Matrix2cd r22 = element.stiffness.inverse();
    const Eigen::Matrix2cd r12 = element.carry * r22;
    receptance.emplace_back();
    receptance.back() << element.clamped + r12 * element.carry.transpose(), r12, r12.transpose(), r22;
  }
  modal::FrfSet set{.frequency_hz = frequency_hz, .frfs = {}};
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) {
      using modal::Axis;
      modal::Frf frf;
      frf.name = detail::element_name(Axis::x, row % 2, Axis::x, column % 2, row / 2 + 1, column / 2 + 1);
      const double sign = detail::element_sign(Axis::x, row % 2, Axis::x, column % 2);
      frf.receptance.resize(frequency_hz.size());
      for (std::size_t i = 0; i < receptance.size(); ++i) {
        frf.receptance(static_cast<Eigen::Index>(i)) = sign * receptance[i](row, column);
      }
      set.frfs.push_back(std::move(frf));
    }
  }
  return set;
}

}  // namespace robomill::coupling::testing
