#pragma once
// The tables of assembly.toml.
#include <filesystem>
#include <optional>
#include <vector>

#include "robomill/coupling/assembly.hpp"
#include "robomill/coupling/holder.hpp"
#include "robomill/coupling/joint_fit.hpp"
#include "robomill/io/schema.hpp"

namespace robomill::coupling {

/// A number of a segment, as a key of a document and as a column of tools.csv.
struct SegmentNumber {
  io::Row<Segment> row = {};
  double Segment::*value = nullptr;
};
[[nodiscard]] const std::vector<SegmentNumber>& segment_numbers();
/// [[tool]], [[joint.shank]], holder.segments and [[holder.artefact]].
[[nodiscard]] const io::Schema<Segment>& segment_options_table();

/// [frequency]
struct FrequencyTable {
  std::vector<double> range_hz = {};  ///< from, to
  std::optional<double> step_hz = {};
};
[[nodiscard]] const io::Schema<FrequencyTable>& frequency_table();

/// [joint]
[[nodiscard]] const io::Schema<Joint>& joint_options_table();

/// [holder]
struct HolderTable {
  std::vector<Segment> segments = {};
  std::filesystem::path receptances = {};
  std::vector<double> position_m = {};  ///< where these were measured, from the mouth
  std::vector<Segment> artefact = {};
  HolderOptions options = {};
  bool free = false;
};
[[nodiscard]] const io::Schema<HolderTable>& holder_table();

/// [accelerometer]
[[nodiscard]] const io::Schema<Accelerometer>& accelerometer_table();

/// [search]
[[nodiscard]] const io::Schema<JointFitOptions>& search_table();

}  // namespace robomill::coupling
