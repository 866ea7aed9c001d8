#include "robomill/io/records/uff_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/records/channels.hpp"
#include "robomill/io/records/uff.hpp"
#include "robomill/io/si.hpp"
#include "robomill/io/text.hpp"
#include "robomill/io/usual_ranges.hpp"

namespace robomill::io {
namespace {

bool says_nothing_of(std::string_view text) {
  return text.empty() || text == "NONE";
}

/// "2-y" of a negative second direction at node 2.
std::string degree_of_freedom(const UffFunction& function) {
  constexpr std::string_view axes[] = {"", "x", "y", "z", "rx", "ry", "rz"};
  const int direction = std::abs(function.response_direction);
  return fmt::format("{}{}{}", function.response_node,
                     direction == 0                    ? ""
                     : function.response_direction < 0 ? "-"
                                                       : "+",
                     direction < 7 ? axes[direction] : "");
}

std::string_view si_unit(Quantity quantity) {
  switch (quantity) {
    case Quantity::displacement:
      return "m";
    case Quantity::velocity:
      return "m/s";
    case Quantity::acceleration:
      return "m/s^2";
    case Quantity::force:
      return "N";
    case Quantity::unknown:
      break;
  }
  return {};
}

class UffRecordReader {
 public:
  explicit UffRecordReader(const std::filesystem::path& path) : file_(path.string()) {
    record_.file = path;
    record_.units_by = "the ordinate of the universal file";
  }

  Record read() {
    const std::string content = read_file(record_.file);
    std::vector<std::string> of_file =
        read_uff(content, file_, [this](UffFunction&& function) { take(std::move(function)); });
    record_.notes.insert(record_.notes.begin(), of_file.begin(), of_file.end());
    if (channels_.empty()) throw InvalidInput(file_, "holds no function", "It needs data sets 58 of time responses");
    tell_twins_apart();
    const ChannelsTogether taken = channels_together(channels_, file_, ChannelLengths::any);
    take_channels(record_, channels_, taken);
    for (const std::size_t place : taken.places) record_.columns.push_back(std::move(columns_[place]));
    return std::move(record_);
  }

 private:
  void take(UffFunction&& function) {
    const std::string where = fmt::format("{}:{}", file_, function.line);
    FileChannel channel{.samples = static_cast<std::uint64_t>(function.values.size())};
    const std::string& label = function.numerator.label;
    channel.name = !says_nothing_of(label) ? label : says_nothing_of(function.id[0]) ? "" : function.id[0];
    if (function.type != 1 && function.type != 0) {
      channel.fault = fmt::format("function type {} is no time response", function.type);
    } else if (function.is_complex) {
      channel.fault = "complex values";
    } else {
      find_rate(function, channel);
    }
    columns_.emplace_back();
    if (channel.fault.empty()) {
      columns_.back() = function.values.real();
      to_si(function, where, channel, columns_.back());
    }
    channels_.push_back(std::move(channel));
    places_.push_back(degree_of_freedom(function));
  }

  static void find_rate(const UffFunction& function, FileChannel& channel) {
    constexpr int time_type = 17, frequency_type = 18;
    const UffAxis& axis = function.abscissa_axis;
    const std::string unit = says_nothing_of(axis.unit) ? "s" : axis.unit;
    const double s = seconds_in(unit);
    if (axis.type == frequency_type || (s == 0.0 && axis.type != time_type && is_unit(unit))) {
      channel.fault = "over " + (s > 0.0 ? std::string("frequency") : unit);
      return;
    }
    try {
      channel.sample_rate_hz = round_15(sample_rate_of(function.abscissa, "") / (s > 0.0 ? s : 1.0));
      channel.start = {.is_known = true, .s = (s > 0.0 ? s : 1.0) * function.abscissa(0)};
    } catch (const InvalidInput& error) {
      channel.fault = error.parts().rule;
    }
  }

  /// By the unit's text where it contradicts the data type: it says the factor too.
  void to_si(const UffFunction& function, const std::string& where, FileChannel& channel, Eigen::VectorXd& values) {
    if (volts_in(function.numerator.unit) > 0.0) {
      channel.unit = function.numerator.unit;  // who reads the record knows what they are of
      return;
    }
    SiFactor si = si_factor(function.numerator, function.length_factor, function.force_factor);
    const SiFactor said = parse_unit(function.numerator.unit);
    if (said.quantity != Quantity::unknown && si.quantity != said.quantity) {
      si = said;
      si.note = fmt::format("{}its ordinate is of data type {}, and in \"{}\": the unit counts", warning_label,
                            function.numerator.type, function.numerator.unit);
    }
    const bool is_warning = si.note.starts_with(warning_label);
    if (!si.note.empty()) {
      record_.notes.push_back(fmt::format("{}{}: {}", is_warning ? warning_label : "", where,
                                          si.note.substr(is_warning ? warning_label.size() : 0)));
    }
    if (si.factor != 1.0) values *= si.factor;
    channel.unit = si_unit(si.quantity);
    if (!channel.unit.empty() && said.quantity == Quantity::unknown && !function.has_units) record_.si_assumed = true;
    if (channel.unit.empty() && !says_nothing_of(function.numerator.unit)) channel.unit = function.numerator.unit;
  }

  /// Several channels of one name have their degree of freedom behind it.
  void tell_twins_apart() {
    std::vector<std::string> names;
    for (const FileChannel& channel : channels_) names.push_back(channel.name);
    std::ranges::sort(names);
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      const auto [begin, end] = std::equal_range(names.begin(), names.end(), channels_[i].name);
      if (end - begin > 1) channels_[i].name += (channels_[i].name.empty() ? "" : " ") + places_[i];
    }
  }

  std::string file_;
  std::vector<FileChannel> channels_;
  std::vector<Eigen::VectorXd> columns_;
  std::vector<std::string> places_;  ///< degree of freedom of each
  Record record_;
};

}  // namespace

Record read_uff_record(const std::filesystem::path& path) {
  return UffRecordReader(path).read();
}

}  // namespace robomill::io
