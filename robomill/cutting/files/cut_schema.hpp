#pragma once
#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "robomill/cutting/engagement.hpp"
#include "robomill/cutting/workpiece.hpp"
#include "robomill/io/schema.hpp"

namespace robomill::cutting {

/// The step-over: a key of [cut], of a chart and of results.
inline constexpr const char* radial_depth_of_cut = "cut.radial_depth_mm";
inline constexpr const char* radial_depth_key = radial_depth_of_cut + std::string_view("cut.").size();

/// [cut]: how the cutter goes through the material. Which keys must be given depends on the verb.
struct CutTable {
  bool drilling = false;
  std::optional<MillingDirection> direction = {};
  std::optional<double> entry_rad = {}, exit_rad = {};  ///< in place of direction and radial depth
  std::optional<double> radial_depth_m = {};            ///< by either of its names
  std::optional<double> axial_depth_m = {};
  double feed_per_tooth_m = 0.0;
  std::optional<double> feed_per_revolution_m = {};  ///< of a drill
  std::optional<double> spindle_speed_rad_per_s = {};
  double feed_direction_rad = 0.0;  ///< in the axes of the structure
  double lead_rad = 0.0, tilt_rad = 0.0;
  double curvature_along_feed_per_m = 0.0, curvature_across_feed_per_m = 0.0;  ///< of the surface, > 0: convex
  bool force_on_workpiece = false;

  /// What a milled cut is. Depths that are not given are 0, no direction is up.
  [[nodiscard]] Cut milled() const;
};
[[nodiscard]] const io::Schema<CutTable>& cut_table();

/// `force_on`: tool or workpiece. It may stand above the first table too.
inline constexpr Name<bool> force_on_names[] = {{"tool", false}, {"workpiece", true}};

/// What a program starts from.
enum class StockKind { box, cylinder, turned, neighbours };

/// [stock] along a program.
struct StockTable {
  std::optional<StockKind> kind = {};                              ///< none: a box is assumed
  std::optional<std::array<double, 3>> min_m = {}, max_m = {};     ///< of a box
  std::array<double, 2> center_m = {};                             ///< axis of a round one
  std::optional<double> radius_m = {}, bottom_m = {}, top_m = {};  ///< of a cylinder
  std::vector<double> outline_radius_m = {}, outline_z_m = {};     ///< of a turned one, from below to above
  double dexel_m = 0.25e-3;
};
[[nodiscard]] const io::Schema<StockTable>& stock_table();

/// The stock that the table describes; none where it names no kind, or neighbouring passes.
/// @throws InvalidInput where a key is missing, or one that is no part of this kind is given
[[nodiscard]] std::optional<Stock> stock_of(const io::TomlFile& file, const StockTable& table);

}  // namespace robomill::cutting
