#include "robomill/io/records/labview/tdms_segments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "robomill/io/byte_order.hpp"
#include "robomill/io/records/channels.hpp"
#include "robomill/io/usual_ranges.hpp"

namespace robomill::io {
namespace {

constexpr std::size_t lead_in_bytes = 28;
// Flags of a segment.
constexpr std::uint32_t metadata_flag = 1U << 1, new_list_flag = 1U << 2, raw_flag = 1U << 3;
constexpr std::uint32_t interleaved_flag = 1U << 5, big_endian_flag = 1U << 6, daqmx_flag = 1U << 7;
// What stands in the place of a raw data index.
constexpr std::uint32_t no_raw_data = 0xFFFFFFFF, as_before = 0, format_changing = 0x1269, digital_line = 0x1369;

/// The names of a path /'group'/'channel'; a quote within a name stands there twice. Empty where it is none.
std::vector<std::string> names_of(std::string_view path) {
  std::vector<std::string> out;
  while (path.starts_with("/'")) {
    path.remove_prefix(2);
    out.emplace_back();
    while (true) {
      const std::size_t quote = path.find('\'');
      if (quote == std::string_view::npos) return {};
      out.back() += path.substr(0, quote);
      path.remove_prefix(quote + 1);
      if (!path.starts_with('\'')) break;
      out.back() += '\'';
      path.remove_prefix(1);
    }
  }
  return path.empty() ? out : std::vector<std::string>();
}

bool is_wanted(std::string_view property) {
  return property.starts_with("wf_") || property.starts_with("NI_Scal") || property == "NI_Number_Of_Scales" ||
         property == "unit_string" || property == "NI_UnitDescription";
}

/// A small file could name millions.
constexpr std::size_t most_tdms_objects = 4 * most_channels;

/// Lengths that a file states may be anything.
constexpr std::uint64_t huge = std::uint64_t{1} << 62;
std::uint64_t product(std::uint64_t a, std::uint64_t b) {
  return b != 0 && a > huge / b ? huge : a * b;
}
std::uint64_t sum(std::uint64_t a, std::uint64_t b) {
  return std::min(huge, std::min(a, huge) + std::min(b, huge));
}

/// Whole samples of a source in the first bytes of a chunk.
std::uint64_t held(const TdmsSource& source, std::uint64_t bytes) {
  const std::uint64_t first = sum(source.offset, source.type->width);
  return bytes < first ? 0 : (bytes - first) / source.stride + 1;
}

}  // namespace

TdmsSegments::TdmsSegments(std::string_view bytes, std::string file) : bytes_(bytes), file_(std::move(file)) {
  if (bytes.starts_with("TDSm")) return;
  throw InvalidInput(file_, "is no TDMS file",
                     bytes.starts_with("TDSh") ? "It is the index of one: give the .tdms beside it" : "");
}

InvalidInput TdmsSegments::damaged(const std::string& what) const {
  return InvalidInput(file_, fmt::format("is damaged: {}, in the segment at byte {}", what, begin_));
}

void TdmsSegments::note_end(const std::string& what) {
  notes_.push_back(fmt::format("{}{} {}: it was not closed or was cut off, and is read as far as it goes",
                               warning_label, file_, what));
}

bool TdmsSegments::next() {
  has_raw_ = false;
  if (!read_lead_in()) return false;
  if ((flags_ & new_list_flag) != 0) {
    for (const std::size_t object : active_) objects_[object].is_listed = false;
    active_.clear();
    is_laid_out_ = false;
  }
  if ((flags_ & metadata_flag) != 0) read_metadata();
  has_raw_ = (flags_ & raw_flag) != 0 && raw_bytes_ > 0;
  if (!has_raw_) return true;
  if (!is_laid_out_ || layout_.flags != (flags_ & (interleaved_flag | daqmx_flag))) lay_out();
  count_samples(raw_bytes_);
  return true;
}

bool TdmsSegments::read_lead_in() {
  begin_ = following_;
  const std::size_t rest = bytes_.size() - begin_;
  if (rest == 0) return false;
  if (rest < lead_in_bytes) {
    note_end("ends within a segment");
    return false;
  }
  if (bytes_.substr(begin_, 4) != "TDSm") throw damaged("no segment begins where the one before it ends");
  flags_ = static_cast<std::uint32_t>(number_at(bytes_, begin_ + 4, 4, false));
  big_endian_ = (flags_ & big_endian_flag) != 0;
  at_ = begin_ + 8;
  end_ = begin_ + lead_in_bytes;
  const std::uint64_t version = number(4), length = number(8), raw = number(8);
  if (version != 4712 && version != 4713) {
    throw InvalidInput(file_, fmt::format("is of version {} of TDMS, and 4712 and 4713 are read", version));
  }
  const std::uint64_t there = std::min<std::uint64_t>(length, rest - lead_in_bytes);
  const bool is_cut = there < length;
  if (is_cut) note_end("ends within its last segment");
  if (raw > there) {
    if (is_cut) return false;
    throw damaged("its raw data would begin behind its end");
  }
  end_ = raw_ = at_ + static_cast<std::size_t>(raw);
  raw_bytes_ = there - raw;
  following_ = at_ + static_cast<std::size_t>(there);
  return true;
}

std::uint64_t TdmsSegments::number(std::size_t width) {
  if (width > end_ - at_) throw damaged("its metadata is longer than it says");
  at_ += width;
  return number_at(bytes_, at_ - width, width, big_endian_);
}

std::string_view TdmsSegments::text() {
  const std::uint64_t length = number(4);
  if (length > end_ - at_) throw damaged("a text is longer than its metadata");
  at_ += static_cast<std::size_t>(length);
  return bytes_.substr(at_ - static_cast<std::size_t>(length), static_cast<std::size_t>(length));
}

void TdmsSegments::read_metadata() {
  is_laid_out_ = false;
  for (std::uint64_t left = number(4); left > 0; --left) read_object();
}

void TdmsSegments::read_object() {
  const std::string_view path = text();
  auto found = places_.find(path);
  if (found == places_.end()) {
    if (objects_.size() == most_tdms_objects) {
      throw InvalidInput(file_, fmt::format("holds more than {} objects", most_tdms_objects), "Is it a record?");
    }
    found = places_.emplace(path, objects_.size()).first;
    TdmsObject& object = objects_.emplace_back();
    object.path = std::string(path);
    std::vector<std::string> names = names_of(path);
    if (names.size() == 2) object.name = std::move(names[1]);
    if (!names.empty()) object.group = std::move(names[0]);
    if (names.empty() && path != "/") object.name = object.path;
  }
  TdmsObject& object = objects_[found->second];
  const auto index = static_cast<std::uint32_t>(number(4));
  object.has_data = index != no_raw_data;
  if (index == as_before && !object.has_index) throw damaged("an object has an index as before, and none before");
  if (index != as_before && index != no_raw_data) read_index(object, index);
  if (object.has_data && !object.is_listed) {
    object.is_listed = true;
    active_.push_back(found->second);
  }
  for (std::uint64_t left = number(4); left > 0; --left) read_property(object);
}

void TdmsSegments::read_index(TdmsObject& object, std::uint32_t header) {
  const auto code = static_cast<std::uint32_t>(number(4));
  const std::uint64_t dimension = number(4);
  if (dimension != 1) throw damaged(fmt::format("{} has data of dimension {}", object.path, dimension));
  object.values = number(8);
  object.has_index = true;
  object.is_daqmx = header == format_changing || header == digital_line;
  object.type = nullptr;
  if (object.is_daqmx) return read_scalers(object, header == digital_line);
  object.type = tdms_type(code);
  if (object.type == nullptr) {
    throw InvalidInput(file_, fmt::format("{} is of type 0x{:X}, which is not read", object.path, code),
                       "Write it as double precision");
  }
  object.bytes = object.type->kind == TdmsType::Kind::text ? number(8) : product(object.values, object.type->width);
}

void TdmsSegments::read_scalers(TdmsObject& object, bool digital) {
  object.scalers.clear();
  for (std::uint64_t left = number(4); left > 0; --left) {
    TdmsScaler scaler;
    const auto code = static_cast<std::uint32_t>(number(4));
    scaler.type = tdms_scaler_type(code);
    if (scaler.type == nullptr) throw damaged(fmt::format("{} has a scaler of type {}", object.path, code));
    scaler.buffer = static_cast<std::uint32_t>(number(4));
    scaler.byte = static_cast<std::uint32_t>(number(4));
    if (digital) {
      scaler.bit = static_cast<int>(scaler.byte % 8);
      scaler.byte /= 8;
      scaler.type = tdms_scaler_type(0);  // the byte that has the line's bit
    }
    static_cast<void>(number(digital ? 1 : 4));  // a bitmap of its format
    scaler.id = static_cast<std::uint32_t>(number(4));
    object.scalers.push_back(scaler);
  }
  object.widths.clear();
  for (std::uint64_t left = number(4); left > 0; --left) object.widths.push_back(number(4));
}

void TdmsSegments::read_property(TdmsObject& object) {
  const std::string_view name = text();
  const auto code = static_cast<std::uint32_t>(number(4));
  const TdmsType* const type = tdms_type(code);
  if (type == nullptr && code != 0) {  // 0: nothing follows
    throw InvalidInput(
        file_, fmt::format("its property {} of {} is of type 0x{:X}, which is not read", name, object.path, code));
  }
  TdmsProperty value;
  if (type != nullptr && type->kind == TdmsType::Kind::text) {
    value.text = std::string(text());
  } else if (type != nullptr) {
    if (type->width > end_ - at_) throw damaged("a property is longer than its metadata");
    if (type->kind == TdmsType::Kind::time) {
      value.time = tdms_time(bytes_, at_, big_endian_);
      value.is_time = true;
    } else if (type->is_number()) {
      value.number = tdms_number(bytes_, at_, *type, big_endian_);
    }
    at_ += type->width;
  }
  if (!is_wanted(name)) return;
  TdmsProperty& kept = object.properties[std::string(name)];
  if (name == "wf_start_time" && kept.is_time && object.samples > 0 && kept.time.after(value.time) != 0.0) {
    object.restarted = true;
  }
  kept = std::move(value);
}

void TdmsSegments::lay_out() {
  // Each object of a list costs bytes, in the list or as raw data.
  work_ += active_.size();
  if (work_ > 100'000 + 2 * bytes_.size()) throw damaged("its lists of objects are too long for its size");
  runs_.clear();
  layout_ = {.flags = flags_ & (interleaved_flag | daqmx_flag)};
  const bool daqmx = (flags_ & daqmx_flag) != 0;
  std::uint64_t values = 0;
  for (const std::size_t place : active_) {
    const TdmsObject& object = objects_[place];
    if (!object.has_data) continue;
    if (object.is_daqmx != daqmx) throw damaged("raw data of DAQmx stands beside other raw data");
    if (values != 0 && object.values != values) layout_.equal = false;
    values = object.values;
  }
  if (daqmx) {
    lay_out_daqmx();
  } else {
    lay_out_plain();
  }
  for (const TdmsRun& run : runs_) {
    for (const TdmsSource& source : run.sources) {
      layout_.least_bytes = std::max(layout_.least_bytes, sum(source.offset, source.type->width));
    }
  }
  is_laid_out_ = true;
}

void TdmsSegments::lay_out_plain() {
  const bool rows = (flags_ & interleaved_flag) != 0;
  std::uint64_t offset = 0;
  for (const std::size_t place : active_) {
    const TdmsObject& object = objects_[place];
    if (!object.has_data || object.values == 0) continue;
    if (rows && object.type->width == 0) throw damaged("a text stands among interleaved samples");
    if (object.type->is_number()) {
      runs_.push_back({.object = place,
                       .a_chunk = object.values,
                       .sources = {{.type = object.type, .offset = offset, .stride = object.type->width}}});
    }
    offset = sum(offset, rows ? object.type->width : object.bytes);
  }
  layout_.chunk_bytes = offset;
  if (!rows) return;
  if (!layout_.equal) throw damaged("interleaved channels have different numbers of samples");
  layout_.row_bytes = offset;
  for (TdmsRun& run : runs_) run.sources.front().stride = offset;
}

std::vector<std::uint64_t> TdmsSegments::buffers_of(const TdmsObject& first) const {
  std::vector<std::uint64_t> rows(first.widths.size(), first.values);
  std::vector<bool> known(rows.size(), false);
  for (const std::size_t place : active_) {
    const TdmsObject& object = objects_[place];
    if (!object.has_data) continue;
    if (object.widths != first.widths) throw damaged("channels of DAQmx state different widths of its buffers");
    for (const TdmsScaler& scaler : object.scalers) {
      if (scaler.buffer >= rows.size() ||
          scaler.byte + std::uint64_t{scaler.type->width} > first.widths[scaler.buffer]) {
        throw damaged(fmt::format("{} has a scaler outside its buffer", object.path));
      }
      if (known[scaler.buffer] && rows[scaler.buffer] != object.values) {
        throw damaged("channels of one buffer have different numbers of samples");
      }
      rows[scaler.buffer] = object.values;
      known[scaler.buffer] = true;
    }
  }
  return rows;
}

void TdmsSegments::lay_out_daqmx() {
  const auto first = std::ranges::find_if(active_, [this](std::size_t place) { return objects_[place].has_data; });
  if (first == active_.end()) return;
  const std::vector<std::uint64_t> widths = objects_[*first].widths, rows = buffers_of(objects_[*first]);
  std::vector<std::uint64_t> begins;
  for (std::size_t i = 0; i < widths.size(); ++i) {
    begins.push_back(layout_.chunk_bytes);
    layout_.chunk_bytes = sum(layout_.chunk_bytes, product(rows[i], widths[i]));
  }
  if (widths.size() == 1) layout_.row_bytes = widths.front();
  for (const std::size_t place : active_) {
    const TdmsObject& object = objects_[place];
    if (!object.has_data || object.values == 0 || object.scalers.empty()) continue;
    TdmsRun run{.object = place, .a_chunk = object.values};
    for (const TdmsScaler& scaler : object.scalers) {
      run.sources.push_back({.type = scaler.type,
                             .offset = sum(begins[scaler.buffer], scaler.byte),
                             .stride = widths[scaler.buffer],
                             .bit = scaler.bit,
                             .id = scaler.id});
    }
    runs_.push_back(std::move(run));
  }
}

void TdmsSegments::count_samples(std::uint64_t raw_bytes) {
  const std::uint64_t unit = layout_.row_bytes > 0 ? layout_.row_bytes : layout_.chunk_bytes;
  if (unit == 0) throw damaged("its raw data is of no channel");
  const std::uint64_t whole = raw_bytes / unit, rest = raw_bytes % unit;
  if (rest > 0 && following_ < bytes_.size() && notes_.empty()) {
    notes_.push_back(
        fmt::format("{}{}: the raw data of the segment at byte {} does not end with a whole sample of all "
                    "channels: what is beyond is left out",
                    warning_label, file_, begin_));
  }
  has_raw_ = whole > 0 || rest >= layout_.least_bytes;
  if (!has_raw_) return;
  std::uint64_t tail = huge;  // samples of each channel in what is no whole chunk
  for (const TdmsRun& run : runs_) {
    for (const TdmsSource& source : run.sources) tail = std::min({tail, held(source, rest), run.a_chunk});
  }
  if (layout_.row_bytes > 0 || !layout_.equal) tail = 0;
  for (TdmsRun& run : runs_) {
    if (layout_.row_bytes > 0) run.a_chunk = whole;
    run.samples = layout_.row_bytes > 0 ? whole : whole * run.a_chunk + tail;
    objects_[run.object].samples += run.samples;
    samples_ += run.samples;
  }
  // Channels of DAQmx may share bytes, down to a bit.
  if (samples_ > 8 * std::uint64_t{bytes_.size()}) throw damaged("it states more samples than it can hold");
}

std::size_t TdmsSegments::begin_of(const TdmsSource& source, std::uint64_t chunk) const {
  return raw_ + static_cast<std::size_t>(chunk * layout_.chunk_bytes + source.offset);
}

const TdmsObject* TdmsSegments::object(std::string_view path) const {
  const auto found = places_.find(path);
  return found == places_.end() ? nullptr : &objects_[found->second];
}

}  // namespace robomill::io
