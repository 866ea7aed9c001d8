#include "robomill/cutting/files/force_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "robomill/base/cost.hpp"
#include "robomill/base/error.hpp"
#include "robomill/io/records/records.hpp"
#include "robomill/io/si.hpp"

namespace robomill::cutting {
namespace {

constexpr std::string_view not_measured = "none";

/// 'x' of "Fx", "force_x", "FX [N]", "Z"; 0: the name says no direction of a force.
char direction_of(std::string_view name) {
  std::string word;
  for (const char c : name) {
    if (c == '[' || c == '(' || c == '/') break;
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  if (word.ends_with("n") && word.size() > 2) word.pop_back();  // fx_n
  for (const std::string_view before : {"", "f", "force", "kraft"}) {
    if (word.size() == before.size() + 1 && word.starts_with(before) &&
        std::string_view("xyz").find(word.back()) != std::string_view::npos) {
      return word.back();
    }
  }
  return 0;
}

/// "3 columns: Time, Fx, Fy"
std::string columns_of(const io::Record& record) {
  std::string out = fmt::format("It has {} column{}", record.columns.size(), record.columns.size() == 1 ? "" : "s");
  const char* before = ": ";
  for (const std::string& name : record.names) {
    if (name.empty()) continue;
    out += std::exchange(before, ", ") + name;
  }
  return out;
}

std::string file_of(const io::Record& record) {
  return record.file.filename().string();
}

std::vector<std::string> found_channels(const io::Record& record) {
  std::vector<std::string> out(3, std::string(not_measured));
  for (std::size_t i = 0; i < record.names.size(); ++i) {
    const char direction = direction_of(record.names[i]);
    if (direction == 0) continue;
    std::string& channel = out[static_cast<std::size_t>(direction - 'x')];
    if (channel != not_measured) {
      throw InvalidInput("channels",
                         fmt::format("must say which column of {} is {}: {} and {} may be", file_of(record), direction,
                                     channel, record.names[i]),
                         columns_of(record));
    }
    channel = record.names[i];
  }
  if (std::ranges::all_of(out, [](const std::string& channel) { return channel == not_measured; })) {
    throw InvalidInput("channels", "must name the columns of x, y and z: no name of " + file_of(record) + " says them",
                       columns_of(record));
  }
  return out;
}

/// N in what a column holds.
double newtons_in(const io::Record& record, std::size_t place, const std::string& channel, bool is_wav,
                  std::vector<std::string>& without_unit) {
  const std::string unit = record.unit(place);
  if (unit.empty()) {
    if (!is_wav) without_unit.push_back(channel);
    return 1.0;
  }
  const io::SiFactor factor = io::parse_unit(unit);
  if (factor.quantity == io::Quantity::force && !factor.is_ratio) return factor.factor;
  throw InvalidInput(record.file.string(), fmt::format("column {} is in {}, which is no unit of force", channel, unit),
                     io::volts_in(unit) > 0.0 ? "Convert it to N by the sensitivity of its amplifier" : "");
}

/// Text holds a number in some six characters; columns and the force are two copies of 8 bytes.
void require_affordable_record(const std::filesystem::path& path) {
  constexpr double bytes_of_byte = 6.0, usual_bytes = 1e7;
  std::error_code none;
  const std::uintmax_t size = std::filesystem::file_size(path, none);
  if (none) return;  // read_record says what is wrong with it
  const auto bytes = static_cast<double>(size);
  require_affordable({.bytes = bytes_of_byte * bytes,
                      .dominant = {.field = "size of " + path.filename().string(),
                                   .value = 1e-6 * bytes,
                                   .unit = "MB",
                                   .times_usual = bytes / usual_bytes}});
}

std::string joined(const std::vector<std::string>& texts) {
  return fmt::format("{}", fmt::join(texts, ", "));
}

}  // namespace

ForceRecordFile read_force_record(const std::filesystem::path& path, const ForceRecordOptions& options) {
  const bool is_wav = path.extension() == ".wav" || path.extension() == ".WAV";
  if (is_wav && !(options.full_scale_n > 0.0)) {
    throw InvalidInput("full_scale_n", "must be given for " + path.filename().string() +
                                           ", a WAV: the force that its full scale means");
  }
  if (!is_wav && options.full_scale_n != 0.0) {
    throw InvalidInput("full_scale_n", "goes with a WAV: " + path.filename().string() + " has forces in a unit");
  }
  require_affordable_record(path);
  io::Record record = io::read_record(path, {.scale = is_wav ? options.full_scale_n : 1.0});
  ForceRecordFile out{.path = path, .record = {}, .notes = record.notes};
  out.record.sample_rate_hz = io::rate_of(record, options.sample_rate_hz, "sample_rate_hz", out.notes);
  if (!(out.record.sample_rate_hz > 0.0)) {
    throw InvalidInput("sample_rate_hz", "must be given: " + path.string() + " does not state it");
  }
  if (!options.channels.empty() && options.channels.size() != 3) {
    throw InvalidInput(
        "channels",
        fmt::format("must be three, of x, y and z in {}; there are {}", file_of(record), options.channels.size()),
        "\"none\" stands for one that was not measured");
  }
  const std::vector<std::string> channels = options.channels.empty() ? found_channels(record) : options.channels;
  if (options.channels.empty()) {
    out.assumed.push_back(
        {.what = "Axes of the force record",
         .taken = fmt::format("{} are x along the feed, y to its left and z to the spindle", joined(channels)),
         .key = "--channels"});
  }
  std::vector<std::string> without_unit;
  std::vector<std::size_t> places;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    out.channels[axis] = channels[axis];
    std::string_view name = channels[axis];
    const auto row = static_cast<Eigen::Index>(axis);
    if (name == not_measured) continue;
    // A column may itself begin with a minus.
    const bool is_column = std::ranges::find(record.names, name) != record.names.end();
    const bool turned = !is_column && name.starts_with('-');
    if (turned) name.remove_prefix(1);
    const std::size_t place = record.place(std::string(name));
    if (std::ranges::find(places, place) != places.end()) {
      throw InvalidInput("channels",
                         fmt::format("must name a column once; {} of {} is two components", name, file_of(record)));
    }
    places.push_back(place);
    const double factor = newtons_in(record, place, std::string(name), is_wav, without_unit);
    const Eigen::VectorXd& column = record.columns[place];
    if (out.record.force_n.cols() == 0) {
      out.record.force_n.setConstant(3, column.size(), std::numeric_limits<double>::quiet_NaN());
    }
    if (column.size() != out.record.force_n.cols()) throw InvalidInput(path.string(), "has forces of several lengths");
    out.record.force_n.row(row) = (turned ? -factor : factor) * column.transpose();
  }
  if (out.record.force_n.cols() == 0)
    throw InvalidInput("channels", "must name a column of " + file_of(record) + ": no component is left");
  if (!without_unit.empty()) {
    out.assumed.push_back({.what = "Unit of " + joined(without_unit),
                           .taken = "N",
                           .key = "the record's row of units",
                           .file = path.filename().string()});
  }
  return out;
}

}  // namespace robomill::cutting
