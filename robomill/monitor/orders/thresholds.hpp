#pragma once

/// What the tests of a cut ask for. Ratios are of energies. Chosen on recordings of eleven machines; 20 % more or less
/// of any of them changes the recordings found by one at most (README.md, "Accuracy").
namespace robomill::monitor::thresholds {

// An alarm: hops of the last eight; in a row, since a knock has rung down by then.
inline constexpr int alarm_hops = 5, growing_hops = 4;
inline constexpr double over_s = 0.3;  // without, until it ends

// What every test asks of the cut.
inline constexpr double least_belief = 0.12;
inline constexpr double leaves = 0.3;       // of the most energy of 0.4 s: less is the tool leaving
inline constexpr double settled_s = 0.2;    // after an entry
inline constexpr double still_order = 0.8;  // widths of a line, by which the order beside it may move in 0.3 s
inline constexpr double most_of_another_speed = 0.1;  // of the mean of log₁₀(P'/P)/2: 2 dB
inline constexpr double explains = 0.35;              // of all energy, in the orders: the tool cuts
inline constexpr double quiet_is_known = 4.0;         // of the quietest energy: something louder than it has been

inline constexpr double least_loud = 2.0;  // of the quietest energy: holds an alarm at a speed that is not believed

// A calm is known, too, where a cut has had so little beside its orders, to these, for so long.
inline constexpr double least_beside = 0.02, clean_s = 0.5;

inline constexpr double least_ratio = 0.18;  // ratio: of L to S; 0.14 to 0.2 find the same in recordings
inline constexpr double level = 2.5;         // ratio: of L to the quietest energy
inline constexpr double mains_width_hz = 0.7, highest_of_mains = 3.5;
inline constexpr double family_ratio = 0.008;  // family: of L to S
inline constexpr int least_lines = 3;
inline constexpr double of_the_teeth = 0.05, of_the_swing = 0.5;  // growth: of a line to tooth passing; to its change
inline constexpr double least_sustained = 0.5;                    // of the strongest 25 ms: a knock rings down
// … of a line that has been there for some time: in the last turn and in the one before; and how evenly its energy is
// spread over the window, (Σx)²/(n Σx²): that of knocks is not, however few or fresh they are.
inline constexpr double least_kept_up = 0.3, least_spread = 0.5;

// dominant: 11 dB, 10 dB, 3 dB.
inline constexpr double least_rise = 12.6, loud = 10.0, least_rise_since = 2.0;
inline constexpr int least_kept = 9;  // of twelve hops
// By which the speed may be off where forced vibration is left out.
inline constexpr double forced_off = 0.01, forced_off_unsure = 0.04, forced_belief = 0.15;

// slow-ratio is asked up to the highest of these speeds [Hz], ratio from the lowest on.
inline constexpr double slow_speed_turns = 16.0, highest_slow_hz = 45.0, lowest_family_hz = 27.0;
// slow-ratio, of the rest that does not repeat from turn to turn: to what does; in the second half of its window, to
// the first; to its least of 2 s; what repeats, and all, to the most of a second; windows for which the cut has stood
// out; of 0.4 s. What repeats, to the least of all of late: hum and tones that come in air bring nothing that does.
// Chosen on the arms' cuts of seeds 1 to 20 and 1001 to 1020.
inline constexpr double least_rest = 0.3, least_holding = 0.8, least_rest_rise = 4.0, least_repeating = 0.2;
inline constexpr double least_repeating_above_quiet = 2.0;
inline constexpr double least_rest_staying = 0.4, rest_settled = 0.7, least_lasting = 7.0 / 8.0;

}  // namespace robomill::monitor::thresholds
