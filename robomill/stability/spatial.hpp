#pragma once
#include <optional>

#include "robomill/base/export.hpp"
#include "robomill/base/names.hpp"
#include "robomill/cutting/engagement.hpp"
#include "robomill/cutting/force.hpp"

// Method: robomill/stability/README.md, "Three directions (`spatial.hpp`, `collocation/spatial_model.hpp`)"

namespace robomill::stability {

/// Milling with any cutter at any lead and tilt, whose tool vibrates in x, y and z.
///
/// The surface that a tooth meets is that of the tooth before; what the neighbouring pass left is taken for smooth.
struct ROBOMILL_API SpatialMilling {
  cutting::Cutter cutter;
  cutting::Cut cut;  ///< what a chart varies of it is replaced
  /// In place of cut: what a workpiece of rays shows (cutting/program_engagement.hpp). The depth of a chart is then the
  /// height of the engaged part along the tool's axis: less clips what was found above its lowest place, more lets the
  /// arcs of its upper quarter's widest ring go on upwards at the same angles, to the end of the edges.
  std::optional<cutting::Engagement> engagement = {};
  cutting::MillingCoefficients coefficients;
  double feed_per_tooth_m = 0.0;  ///< f [m], >= 0; with runout, which needs it, it decides which teeth miss the cut
  /// The modes' x, y and z are those of the tool frame T and lean with it; else those of the feed's frame F.
  bool modes_turn_with_tool = false;
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// Height of the engaged part along the tool's axis, from the lowest edge of a ring to the highest [m]: the depth at
/// which a cut with a given engagement is what was found. 0 where nothing cuts.
[[nodiscard]] ROBOMILL_API double engaged_height_m(const cutting::Engagement& engagement);

/// What a stability chart varies beside the spindle speed.
enum class SweptParameter {
  axial_depth,   ///< [m]
  radial_depth,  ///< step-over [m]
  lead,          ///< [rad]
  tilt           ///< [rad]
};
/// Whether it is one in rad, and not in m.
[[nodiscard]] constexpr bool is_angle(SweptParameter parameter) {
  return parameter == SweptParameter::lead || parameter == SweptParameter::tilt;
}
inline constexpr Name<SweptParameter> swept_names[] = {{"axial_depth", SweptParameter::axial_depth},
                                                       {"radial_depth", SweptParameter::radial_depth},
                                                       {"lead", SweptParameter::lead},
                                                       {"tilt", SweptParameter::tilt}};

}  // namespace robomill::stability
