#pragma once
#include <cstddef>

#include "robomill/base/lanes.hpp"

namespace robomill::stability::detail {

inline constexpr std::size_t spatial_entries = 9;  ///< of a 3 x 3 matrix, row by row

/// Adds the moments ∫ K P_m(2x - 1) dx, m = 0 … count - 1, of eight edges, each over a part of one piece, x its share.
/// At the angle δ from the middle of its part an edge has
///   K_yy + K_xx = mean_re, K_yy - K_xx = Re second e^{2iδ}, K_xy + K_yx = Im second e^{2iδ}, K_xy - K_yx = mean_im,
///   K_yz + i K_xz = column e^{iδ}, K_zy + i K_zx = row e^{iδ}, K_zz = axial.
struct MomentArguments {
  std::size_t count = 0;
  std::size_t points = 0;        ///< of Gauss's rule
  const double* node = nullptr;  ///< on [0, 1]
  const double* weight = nullptr;
  Lanes middle = {}, half = {};  ///< of the part, in x
  Lanes half_rad = {};           ///< the same in angle, at most π/2
  Lanes mean[2] = {}, second[2] = {}, column[2] = {}, row[2] = {}, axial = {};
  Lanes* sum = nullptr;  ///< [entry][count]
};
void add_moments(MomentArguments& a);

}  // namespace robomill::stability::detail
