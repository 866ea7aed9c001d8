#pragma once
// Of the reader of LVM.
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/io/records/channels.hpp"

namespace robomill::io {

/// What the header of an LVM file says of all its lines.
struct LvmHeader {
  enum class XColumns { none, one, one_a_channel };
  char separator = '\t';
  char decimal = 0;  ///< a point or a comma; 0: a file of the first version does not say it
  XColumns x_columns = XColumns::one;

  /// A line of it. @throws InvalidInput naming `where`, if its value is not known
  void take(std::string_view line, const std::string& where);
  /// @throws InvalidInput naming `where`, if its lines contradict each other
  void validate(const std::string& where) const;
  /// The number in a field of such a file.
  [[nodiscard]] std::optional<double> number(std::string_view field) const;
  /// The fields of a line; they live as long as the line.
  void split(std::string_view line, std::vector<std::string_view>& fields) const;
};

/// What the header of a segment says of its channels. Its fields stand in the columns of the samples that they are of.
class LvmSegmentHeader {
 public:
  void take(const std::vector<std::string_view>& fields);

  /// Number of channels; none where it is not said.
  [[nodiscard]] std::optional<std::size_t> channels(const LvmHeader& header) const;
  /// The channel whose samples stand in a column of the file, without its name.
  struct Channel {
    FileChannel channel = {};
    double delta_x = 0.0;                     ///< [s]; 0: not said
    std::optional<std::size_t> samples = {};  ///< that the segment is to hold
    double time_factor = 1.0;                 ///< seconds in the unit of x
  };
  [[nodiscard]] Channel channel(std::size_t column, const LvmHeader& header) const;

 private:
  enum Tag {
    channels_tag,
    samples_tag,
    date_tag,
    time_tag,
    y_unit_tag,
    x_unit_tag,
    x_dimension_tag,
    x0_tag,
    delta_x_tag,
    tags
  };
  [[nodiscard]] std::string_view field(Tag tag, std::size_t column) const;
  std::array<std::vector<std::string>, tags> fields_ = {};
};

}  // namespace robomill::io
