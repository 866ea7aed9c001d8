#pragma once
#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "robomill/decision/test_cuts.hpp"
#include "robomill/stability/lobes.hpp"

/// What [RobotMillingChatter] leaves open about its 32 cuts, and the evidence for each way to read it.
namespace robomill::examples {

/// A value of table 4-4 whose cell is shared by two lines of the text, which read it differently.
struct DoubleReading {
  const char* name;              ///< "mode_2_hz": a column of readings.csv
  std::size_t mode;              ///< from 0
  bool damping;                  ///< or the frequency
  std::array<double, 2> values;  ///< first and second line [1 or Hz]
};
[[nodiscard]] const std::array<DoubleReading, 5>& double_readings();

/// How table 4-4 is read: which line of each double reading, in their order.
using ModeTable = std::array<int, 5>;

/// How the cuts are read. Feed at 180° is feed at 0°, since H(-x, -y) = H(x, y); 270° is 90°.
struct CutReading {
  int teeth = 2;
  double feed_direction_rad = 0.0;  ///< in the plane of the hits, counter-clockwise from x
  bool y_to_the_right = false;      ///< the hits' y, seen from the spindle with x ahead
};

struct Reading {
  CutReading cut;
  ModeTable table = {};
};

/// The table as data/robot-modes.toml has it: 1.27 %, 19.57 Hz, 2.23 %, 53.51 Hz, 543.67 Hz.
inline constexpr ModeTable as_data = {1, 0, 1, 1, 1};

/// Teeth 2, 3, 4 × feed along x, along y × y to the left, to the right.
[[nodiscard]] std::vector<CutReading> cut_readings();
/// Each line of each double reading with each of the others: 32.
[[nodiscard]] std::vector<ModeTable> mode_tables();

/// stability::testing::robot() with teeth, feed and modes as read.
[[nodiscard]] stability::LobesProblem problem_of(const Reading& reading);

inline constexpr double deepest_m = 5e-3;  ///< where the search for a limit ends
inline constexpr double no_limit = std::numeric_limits<double>::infinity();

/// A cut whose result the text states.
struct StatedCut {
  std::size_t speed;  ///< in CutTable::speeds_rpm
  double depth_mm;
  decision::Verdict result;
};

/// Table 4-5 as data/robot-cuts.toml has it.
struct CutTable {
  std::array<double, 8> speeds_rpm = {};                ///< [rpm]
  std::array<std::array<double, 4>, 8> depths_mm = {};  ///< that were cut at each [mm]
  std::vector<StatedCut> stated = {};
};
[[nodiscard]] const CutTable& cut_table();

/// What the 20 % of a borderline cut are a share of.
enum class BorderlineOf { depth, limit };
/// Stable below the limit, chatter above it, borderline where the limit is within 20 % of the cut's depth beside it
/// (decision::ComparedCut's rule), or, of the other, within 20 % of itself beside the depth.
[[nodiscard]] bool agrees(const StatedCut& cut, double limit_mm, BorderlineOf of = BorderlineOf::depth);

struct Evidence {
  std::array<double, 8> limit_mm = {};  ///< at CutTable::speeds_rpm
  int agreed = 0;                       ///< of CutTable::stated
  double correlation = 0.0;  ///< Spearman's, of the limits with the middles of the depths; equal values share a rank
  int peaks = 0;  ///< of the eight multiples of rotation in the named peaks, those that are multiples of tooth passing
};
[[nodiscard]] Evidence evidence_of(const Reading& reading, BorderlineOf of = BorderlineOf::depth);

/// Of one reading of the cuts, over all 32 of the table.
struct Score {
  CutReading cut;
  double agreed = 0.0, correlation = 0.0;  ///< means
};

/// The rule: the reading of the cuts with most agreed cuts, in the mean over all readings of the table; where two lie
/// within half a cut, the one whose limits correlate better with the depths.
/// @throws InvalidInput of no scores
[[nodiscard]] std::size_t chosen(const std::vector<Score>& scores);

/// Limits of a pair of modes alone, as fig. 4-11 draws them: the lowest at 4,000 to 16,000 rpm.
struct PairLimit {
  double lowest_mm = no_limit, at_rpm = 0.0;
};
[[nodiscard]] PairLimit pair_limit(const Reading& reading, int first_mode);
/// The speeds of such a chart [rpm], and the limit at each of these modes alone, or of all [mm].
[[nodiscard]] std::vector<double> chart_speeds_rpm();
[[nodiscard]] std::vector<double> chart_mm(const Reading& reading, const std::vector<int>& keep_modes);
/// Whether this table is the first of those that read the modes first_mode and first_mode + 1 as it does.
[[nodiscard]] bool differs_in(const ModeTable& table, int first_mode);

}  // namespace robomill::examples
