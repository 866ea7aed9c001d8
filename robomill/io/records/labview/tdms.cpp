#include "robomill/io/records/labview/tdms.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/records/channels.hpp"
#include "robomill/io/records/labview/tdms_scale.hpp"
#include "robomill/io/records/labview/tdms_segments.hpp"
#include "robomill/io/si.hpp"
#include "robomill/io/text.hpp"
#include "robomill/io/usual_ranges.hpp"

namespace robomill::io {
namespace {

/// The numbers of a channel become a column.
class TdmsColumn {
 public:
  TdmsColumn(std::uint64_t samples, TdmsScale scale)
      : values_(static_cast<Eigen::Index>(samples)), scale_(std::move(scale)) {}

  void take(const TdmsSegments& segments, const TdmsRun& run, std::string_view bytes) {
    const std::size_t sources = run.sources.size();
    raw_.resize(sources);
    places_.resize(sources);
    for (std::uint64_t i = 0; i < run.samples && at_ < values_.size(); ++i) {
      const bool is_chunk = i % run.a_chunk == 0;
      for (std::size_t k = 0; k < sources; ++k) {
        const TdmsSource& source = run.sources[k];
        places_[k] = is_chunk ? segments.begin_of(source, i / run.a_chunk) : places_[k] + source.stride;
        raw_[k] = {.value = number(bytes, places_[k], source, segments.big_endian()), .scale = source.id};
      }
      values_(at_++) = scale_(raw_);
    }
  }

  [[nodiscard]] Eigen::VectorXd& values() { return values_; }

 private:
  double number(std::string_view bytes, std::size_t at, const TdmsSource& source, bool big_endian) {
    if (source.type->kind == TdmsType::Kind::time) {
      const TdmsTime time = tdms_time(bytes, at, big_endian);
      if (at_ == 0) first_ = time;
      return time.after(first_);
    }
    const double number = tdms_number(bytes, at, *source.type, big_endian);
    return source.bit < 0 ? number : static_cast<double>(static_cast<unsigned>(number) >> source.bit & 1U);
  }

  Eigen::VectorXd values_;
  Eigen::Index at_ = 0;
  TdmsScale scale_;
  TdmsTime first_;  ///< of a channel of times
  std::vector<TdmsRaw> raw_;
  std::vector<std::size_t> places_;
};

/// The scales of a channel: its own, else those of its group, else those of the file.
TdmsScale scale_of(const TdmsSegments& segments, const TdmsObject& object) {
  TdmsScale out(object.properties);
  if (!object.properties.contains("NI_Scaling_Status")) {
    std::string group = "/'";
    for (const char letter : object.group) group += letter == '\'' ? std::string("''") : std::string(1, letter);
    for (const std::string& path : {group + "'", std::string("/")}) {
      const TdmsObject* const above = segments.object(path);
      if (out.is_none() && above != nullptr) out = TdmsScale(above->properties);
    }
  }
  const auto has = [&object](std::uint32_t id) {
    return std::ranges::find(object.scalers, id, &TdmsScaler::id) != object.scalers.end();
  };
  for (const std::uint32_t id : out.scalers()) {
    if (!object.is_daqmx || !has(id)) throw InvalidInput("", fmt::format("its scale {} is not described", id));
  }
  return out;
}

ChannelStart tdms_start(const TdmsProperties& properties) {
  constexpr std::int64_t day_s = 86400;
  const auto found = properties.find("wf_start_time");
  if (found == properties.end() || !found->second.is_time) return {};
  const TdmsTime& time = found->second.time;
  const double offset_s = number_of(properties, "wf_start_offset");
  return {.is_known = true,
          .day = time.seconds / day_s,
          .s = static_cast<double>(time.seconds % day_s) + std::ldexp(static_cast<double>(time.fraction), -64) +
               (std::isfinite(offset_s) ? offset_s : 0.0)};
}

/// What a file says of a channel, but for its name.
FileChannel channel_of(const TdmsSegments& segments, const TdmsObject& object, TdmsScale& scale) {
  const TdmsProperties& properties = object.properties;
  FileChannel out{
      .unit = text_of(properties, "unit_string"), .start = tdms_start(properties), .samples = object.samples};
  if (out.unit.empty()) out.unit = text_of(properties, "NI_UnitDescription");
  const double step = number_of(properties, "wf_increment");
  const std::string x_unit = text_of(properties, "wf_xunit_string");
  const double unit_s = x_unit.empty() ? 1.0 : seconds_in(x_unit);
  if (step > 0.0 && unit_s == 0.0 && is_unit(x_unit)) out.fault = "over " + x_unit;
  if (std::isfinite(step) && step > 0.0) out.sample_rate_hz = round_15(1.0 / ((unit_s > 0.0 ? unit_s : 1.0) * step));
  if (!std::isfinite(out.sample_rate_hz)) out.sample_rate_hz = 0.0;
  if (object.type != nullptr && object.type->kind == TdmsType::Kind::text) out.fault = "text";
  if (object.type != nullptr && object.type->kind == TdmsType::Kind::complex) out.fault = "complex numbers";
  if (object.type != nullptr && object.type->kind == TdmsType::Kind::time) out.unit = "s";
  try {
    scale = scale_of(segments, object);
  } catch (const InvalidInput& error) {
    out.fault = error.parts().rule;
  }
  return out;
}

/// Channels of one name have their groups' before it.
void set_names(std::vector<FileChannel>& channels, const std::vector<const TdmsObject*>& objects) {
  std::vector<std::string_view> names;
  names.reserve(objects.size());
  for (const TdmsObject* object : objects) names.emplace_back(object->name);
  std::ranges::sort(names);
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const auto [begin, end] = std::equal_range(names.begin(), names.end(), std::string_view(objects[i]->name));
    channels[i].name = end - begin > 1 ? objects[i]->group + "/" + objects[i]->name : objects[i]->name;
  }
}

void note_channels(Record& record, const std::vector<const TdmsObject*>& objects, const std::vector<TdmsScale>& scales,
                   const ChannelsTogether& taken) {
  const std::string file = record.file.string();
  std::vector<std::string> restarted, counts;
  for (std::size_t i = 0; i < taken.places.size(); ++i) {
    const std::size_t place = taken.places[i];
    if (objects[place]->restarted) restarted.push_back(record.names[i]);
    const auto is_digital = [](const TdmsScaler& scaler) { return scaler.bit >= 0; };
    if (!objects[place]->is_daqmx || std::ranges::any_of(objects[place]->scalers, is_digital)) continue;
    if (scales[place].is_none()) counts.push_back(record.names[i]);
  }
  if (!restarted.empty()) {
    record.notes.push_back(
        fmt::format("{}{}: recordings that began at different times are read one behind the other: {}", warning_label,
                    file, first_of(restarted, ", ")));
  }
  if (!counts.empty()) {
    record.notes.push_back(fmt::format("{}{}: raw counts of the converter, for which the file has no scale: {}",
                                       warning_label, file, first_of(counts, ", ")));
  }
}

}  // namespace

Record read_tdms(const std::filesystem::path& path) {
  const std::string content = read_file(path), file = path.string();
  TdmsSegments segments(content, file);
  while (segments.next()) {
  }
  std::vector<const TdmsObject*> objects;
  std::vector<std::size_t> order(segments.objects().size());  // of an object among the channels
  for (const TdmsObject& object : segments.objects()) {
    order[static_cast<std::size_t>(&object - segments.objects().data())] = objects.size();
    if (!object.name.empty() || object.has_index) objects.push_back(&object);
  }
  std::vector<FileChannel> channels;
  std::vector<TdmsScale> scales(objects.size());
  for (std::size_t i = 0; i < objects.size(); ++i) channels.push_back(channel_of(segments, *objects[i], scales[i]));
  set_names(channels, objects);
  const ChannelsTogether taken = channels_together(channels, file);
  Record out{.file = path, .names = {}, .units_by = "unit_string", .columns = {}, .notes = segments.notes()};
  take_channels(out, channels, taken);
  note_channels(out, objects, scales, taken);

  std::vector<std::optional<std::size_t>> column_of(objects.size());
  std::vector<TdmsColumn> columns;
  for (const std::size_t place : taken.places) {
    column_of[place] = columns.size();
    columns.emplace_back(taken.samples, std::move(scales[place]));
  }
  TdmsSegments again(content, file);
  while (again.next()) {
    for (const TdmsRun& run : again.runs()) {
      if (const auto column = column_of[order[run.object]]) columns[*column].take(again, run, content);
    }
  }
  for (TdmsColumn& column : columns) out.columns.push_back(std::move(column.values()));
  return out;
}

}  // namespace robomill::io
