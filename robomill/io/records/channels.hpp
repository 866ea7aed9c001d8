#pragma once
// Of the readers of files whose channels have rates of their own.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/io/records/records.hpp"

namespace robomill::io {

/// When a channel starts. Days and seconds apart: a sample must not drown in the digits of a date.
struct ChannelStart {
  bool is_known = false;
  std::int64_t day = 0;
  double s = 0.0;  ///< [s] within the day, or beyond it
  /// How much later than another [s].
  [[nodiscard]] double after(const ChannelStart& other) const;
};

/// A channel of a file in which each has a rate, a start and a length of its own.
struct FileChannel {
  std::string name = {}, unit = {};
  double sample_rate_hz = 0.0;  ///< [Hz]; 0: the file does not say it
  double rate_error = 0.0;      ///< relative, of the digits that it is written with
  ChannelStart start = {};
  std::uint64_t samples = 0;
  std::string fault = {};  ///< why it can be no column: "is text"; empty: it can
};

/// A file with more is no record of vibration.
inline constexpr std::size_t most_channels = 4096;

/// Channels that can stand beside each other in one record.
struct ChannelsTogether {
  std::vector<std::size_t> places = {};    ///< of the channels taken, in their order
  std::size_t rated = 0;                   ///< the first of them that says its rate, else the first
  std::uint64_t samples = 0;               ///< that all of them have; of any lengths those of the longest
  std::vector<std::string> left_out = {};  ///< the others, each with the reason
};

/// Which lengths stand beside each other.
enum class ChannelLengths : std::uint8_t {
  alike,  ///< that differ by less than a tenth; all are to be cut to the shortest
  any     ///< each column has its own
};

/// Of one rate and start, and of such lengths: those that hold the most samples. A channel that says no rate goes with
/// others of its length, or where none says one with all.
/// @throws InvalidInput with the reasons if there are none, or more channels than most_channels
[[nodiscard]] ChannelsTogether channels_together(const std::vector<FileChannel>& channels, const std::string& file,
                                                 ChannelLengths lengths = ChannelLengths::alike);

/// Names, units and rate of the channels taken, and notes on the others; the columns are for the caller to fill.
void take_channels(Record& record, const std::vector<FileChannel>& channels, const ChannelsTogether& taken);

/// The first of some texts in one line, and how many more there are.
[[nodiscard]] std::string first_of(const std::vector<std::string>& texts, std::string_view separator);

}  // namespace robomill::io
