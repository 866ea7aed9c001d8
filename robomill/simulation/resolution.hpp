#pragma once
#include "robomill/simulation/cut_model.hpp"
#include "robomill/simulation/simulation.hpp"

namespace robomill::simulation::detail {

/// At least so many steps are taken in a period of the fastest mode, between two teeth, and between two samples of the
/// output.
inline constexpr double steps_per_natural_period = 30.0;
inline constexpr double steps_per_tooth = 60.0;
inline constexpr double steps_per_sample = 8.0;

/// How often the cut repeats.
struct Period {
  bool repeats = true;
  int revolutions = 1;  ///< in a period
  int parts = 1;        ///< periods in a revolution; 1 unless revolutions is 1
  [[nodiscard]] int steps(int steps_per_revolution) const { return steps_per_revolution * revolutions / parts; }
};
[[nodiscard]] Period period_of(const cutting::Milling& milling);
[[nodiscard]] Period period_of(const cutting::FlatEndMill& teeth);

/// Time steps of a revolution where the search begins, or what the options fix; a multiple of the number of teeth
/// where they are evenly spaced.
/// @param arc_rad  between entry and exit
[[nodiscard]] int first_steps(const modal::TipModes& structure, double spindle_speed_rad_per_s,
                              const cutting::FlatEndMill& teeth, double arc_rad, const SimulationOptions& options);
/// Where the search for a resolution starts; with what the options fix.
[[nodiscard]] Resolution first_resolution(const MillingCut& cut, const SimulationOptions& options);
[[nodiscard]] Resolution halved(const Resolution& resolution);
[[nodiscard]] Resolution doubled(const Resolution& resolution);

}  // namespace robomill::simulation::detail
