#pragma once
#include <vector>

#include "robomill/stability/lobes.hpp"

namespace robomill::stability::detail {

/// A stretch of one tooth, in height and in angle, that cuts what another left one delay before.
struct Contact {
  int tooth = 0;
  double low_m = 0.0, high_m = 0.0;  ///< heights
  cutting::Immersion immersion;      ///< φ over which it cuts so
  double delay_rad = 0.0;            ///< rotation between the two, at the tip
  double delay_rad_per_m = 0.0;      ///< how it changes with height
  double step_m = 0.0;               ///< radius of the one that cuts less that of the other
};

/// The angle less whole periods, in [0, period).
double wrap(double angle, double period);

/// The part of a contact's edge whose angle φ = turned - lag z lies between entry and exit.
struct HeightsInCut {
  double turned_rad = 0.0;  ///< of the tooth's tip, less whole revolutions
  double low_m = 0.0, length_m = 0.0;
};
/// @param tip_rad  where the tooth's tip stands
HeightsInCut heights_in_cut(const Contact& contact, double lag_rad_per_m, double tip_rad);

/// Who cuts what who left, from the cutter's shape, runout and feed alone; vibration has no part in it.
///
/// Teeth of equal pitch and helix that stand true each follow the one before: the period is that of a tooth. With
/// runout a tooth may miss the cut, and the next one then meets the surface of the last that did not: a tooth at φ cuts
/// min_m (ρ_j - ρ_{j+m} + f_m sin φ) where that is positive, m counting the teeth before it and f_m the feed between.
/// With unequal helix the delay changes with height. Runout on a cutter with helix is taken in slices, each with the
/// radii of its middle.
class CutterContacts {
 public:
  /// @param slices  axial slices of a cutter with helix and runout
  CutterContacts(const cutting::Milling& milling, int slices);

  [[nodiscard]] Period period() const { return equal_ ? Period::tooth : Period::revolution; }
  [[nodiscard]] double period_rad() const;
  /// Whether angles or delays change with depth.
  [[nodiscard]] bool depends_on_depth() const { return twisted_; }
  [[nodiscard]] const cutting::Milling& milling() const { return milling_; }
  /// @param axial_depth_m  > 0
  /// @throws InvalidInput where teeth of unequal helix overtake each other within the depth
  void at_depth(double axial_depth_m, std::vector<Contact>& out) const;

 private:
  void add_slice(int tooth, double low_m, double high_m, std::vector<Contact>& out) const;

  cutting::Milling milling_;
  int slices_ = 1;
  bool equal_ = true, twisted_ = false, runout_ = false;
};

}  // namespace robomill::stability::detail
