#include "robomill/io/records/labview/lvm.hpp"

#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/records/channels.hpp"
#include "robomill/io/records/labview/lvm_axis.hpp"
#include "robomill/io/records/labview/lvm_header.hpp"
#include "robomill/io/records/samples/sample_parts.hpp"
#include "robomill/io/system/descriptor.hpp"
#include "robomill/io/text.hpp"
#include "robomill/io/usual_ranges.hpp"

namespace robomill::io {
namespace {

constexpr std::string_view magic = "LabVIEW Measurement";
constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
constexpr std::string_view end_of_header = "***End_of_Header***";
constexpr std::size_t longest_line = std::size_t{1} << 18;  ///< ByteReader gives far longer ones whole

/// A channel while its file is read.
struct LvmColumn {
  FileChannel channel = {};
  double delta_x_s = 0.0;
  double time_factor = 1.0;
  std::size_t field = 0;                 ///< of a row
  std::optional<std::size_t> x_field{};  ///< of its own column of x, or of all channels'
  std::size_t axis = 0;
  std::optional<std::size_t> stated{};  ///< samples of this segment
  std::size_t begin = 0;                ///< of this segment
  std::size_t ended = 0;                ///< the line of this segment that has no value of it; 0: none yet
  std::vector<double> values = {};
};

/// What a file of several segments, or one that was cut off, has to be noted for.
struct Findings {
  std::size_t segments = 0, pauses = 0;
  double longest_pause_s = 0.0;
  std::optional<std::pair<std::size_t, std::size_t>> cut = {};  ///< samples there, samples stated
  bool special = false, time_counts = false;
};

class LvmReader {
 public:
  explicit LvmReader(const std::filesystem::path& path) : path_(path) {
    (void)open_file(path);  // says what is wrong with a missing one
    int error = 0;
    file_ = open_descriptor(path.c_str(), O_RDONLY, error);
    if (error != 0) throw InvalidInput(path.string(), "cannot be read", error_text(error));
    bytes_.emplace(file_.get(), false, nullptr, path.string());
  }

  Record read() {
    read_header();
    bool more = next();
    while (more) {
      header_.split(line_, fields_);
      if (is_blank()) {
        more = next();
      } else if (fields_.front() == "***Start_Special***") {
        skip_special();
        more = next();
      } else {
        read_segment_header();
        more = read_rows();
        end_segment();
      }
    }
    return record();
  }

 private:
  [[nodiscard]] std::string here() const { return fmt::format("{}:{}", path_.string(), number_); }

  bool next() {
    const std::optional<std::string_view> line = bytes_->line();
    if (!line) return false;
    ++number_;
    line_ = *line;
    if (line_.size() <= longest_line) return true;
    throw InvalidInput(here(), fmt::format("a line is longer than {} characters", longest_line), "Is it damaged?");
  }

  [[nodiscard]] bool is_blank() const {
    return std::ranges::all_of(fields_, [](std::string_view field) { return field.empty(); });
  }

  void read_header() {
    if (!next()) throw InvalidInput(path_.string(), "is empty");
    if (line_.starts_with(byte_order_mark)) line_.remove_prefix(byte_order_mark.size());
    if (!line_.starts_with(magic)) {
      throw InvalidInput(path_.string(),
                         fmt::format("is no LabVIEW measurement file: it does not begin with {}", magic));
    }
    do {
      if (!next()) throw InvalidInput(path_.string(), fmt::format("has no line {}", end_of_header), "Was it cut off?");
      header_.take(line_, here());
    } while (!line_.starts_with(end_of_header));
    header_.validate(path_.string());
  }

  void skip_special() {
    findings_.special = true;
    const std::size_t begin = number_;
    do {
      const std::optional<std::string_view> line = bytes_->line();
      if (!line) throw InvalidInput(path_.string(), fmt::format("the special block of line {} has no end", begin));
      ++number_;
      line_ = *line;
    } while (!line_.starts_with("***End_Special***"));
  }

  /// Its lines, of which the first is here, and the names below them.
  void read_segment_header() {
    LvmSegmentHeader segment;
    const std::size_t begin = number_;
    while (!line_.starts_with(end_of_header)) {
      if (line_.starts_with("***Start_Special***")) skip_special();
      header_.split(line_, fields_);
      segment.take(fields_);
      if (!next()) {
        throw InvalidInput(fmt::format("{}:{}", path_.string(), begin),
                           fmt::format("the header of a segment has no line {}", end_of_header), "Was it cut off?");
      }
    }
    do {
      if (!next()) return;  // a segment without samples
      header_.split(line_, fields_);
    } while (is_blank());
    ++findings_.segments;
    std::vector<LvmColumn> columns = columns_of(segment);
    if (columns_.empty()) {
      columns_ = std::move(columns);
      axes_.resize(columns_.back().axis + 1);
      started_ = columns_.front().channel.start;
    } else {
      continue_with(columns);
    }
    short_from_ = columns_.size();
    for (LvmAxis& axis : axes_) axis.begin_segment();
  }

  /// By the row of names, which is here.
  [[nodiscard]] std::vector<LvmColumn> columns_of(const LvmSegmentHeader& segment) const {
    const bool own_x = header_.x_columns == LvmHeader::XColumns::one_a_channel;
    const std::size_t step = own_x ? 2 : 1;
    const std::size_t named = (fields_.size() - (fields_.back() == "Comment" ? 1 : 0)) / step - (own_x ? 0 : 1);
    const std::size_t count = segment.channels(header_).value_or(named);
    if (count == 0 || count > fields_.size() || step * count + (own_x ? 0 : 1) > fields_.size()) {
      throw InvalidInput(here(),
                         fmt::format("Channels is {}, and the row of names has {} fields", count, fields_.size()),
                         own_x ? "X_Columns is Multi: each channel has two columns" : "The first is that of x");
    }
    std::vector<LvmColumn> out(count);
    for (std::size_t i = 0; i < count; ++i) {
      LvmColumn& column = out[i];
      column.field = step * i + 1;
      if (header_.x_columns != LvmHeader::XColumns::none) column.x_field = own_x ? column.field - 1 : 0;
      column.axis = own_x ? i : 0;
      LvmSegmentHeader::Channel said = segment.channel(column.field, header_);
      column.channel = std::move(said.channel);
      column.channel.name = std::string(fields_[column.field]);
      column.delta_x_s = said.delta_x;
      column.time_factor = said.time_factor;
      column.stated = said.samples;
    }
    return out;
  }

  /// A further segment.
  void continue_with(const std::vector<LvmColumn>& segment) {
    const auto same = [](const LvmColumn& a, const LvmColumn& b) { return a.channel.name == b.channel.name; };
    if (!std::ranges::equal(columns_, segment, same)) {
      throw InvalidInput(here(), "a segment has other channels than those before it",
                         "Write each into a file of its own");
    }
    note_pause(columns_.front(), segment.front().channel.start);
    for (std::size_t i = 0; i < segment.size(); ++i) {
      LvmColumn& column = columns_[i];
      if (std::abs(segment[i].delta_x_s - column.delta_x_s) > 1e-6 * column.delta_x_s) {
        throw InvalidInput(here(),
                           fmt::format("Delta_X of {} is {:.6g} s in a segment and {:.6g} s before it",
                                       column.channel.name, segment[i].delta_x_s, column.delta_x_s),
                           "Write each rate into a file of its own");
      }
      column.stated = segment[i].stated;
      column.begin = column.values.size();
      column.ended = 0;
    }
  }

  /// Whether a segment follows the one before without a pause, by its first channel.
  void note_pause(const LvmColumn& before, const ChannelStart& now) {
    const double samples = static_cast<double>(before.values.size() - std::min(before.begin, before.values.size()));
    const double pause_s = now.after(started_) - samples * before.delta_x_s;
    if (started_.is_known && now.is_known && samples > 0.0 && std::abs(pause_s) > 1.5 * before.delta_x_s) {
      ++findings_.pauses;
      findings_.longest_pause_s = std::max(findings_.longest_pause_s, std::abs(pause_s));
    }
    started_ = now;
  }

  /// False at the end of the file; else the line that begins the next segment is here.
  bool read_rows() {
    while (next()) {
      header_.split(line_, fields_);
      if (is_blank()) continue;
      if (!fields_.front().empty() && !header_.number(fields_.front())) return true;
      const auto has_value = [this](const LvmColumn& column) { return !fields_[column.field].empty(); };
      const auto there = std::ranges::partition_point(
          columns_, [this](const LvmColumn& column) { return column.field < fields_.size(); });
      // A row may hold a comment alone.
      if (std::none_of(columns_.begin(), there, has_value)) continue;
      for (auto column = columns_.begin(); column != there; ++column) read_value(*column);
      const auto held = static_cast<std::size_t>(there - columns_.begin());
      if (held < short_from_) {
        short_from_ = held;
        short_line_ = number_;
      }
      if (header_.x_columns == LvmHeader::XColumns::one) read_x(columns_.front());
    }
    return false;
  }

  void read_value(LvmColumn& column) {
    if (!column.channel.fault.empty()) return;
    const std::string_view field = fields_[column.field];
    if (column.ended == 0 && static_cast<std::size_t>(&column - columns_.data()) >= short_from_)
      column.ended = short_line_;
    if (field.empty()) {
      if (column.ended == 0) column.ended = number_;
      return;
    }
    if (column.ended > 0) {  // no value, and then one: not one a row
      column.channel.fault = fmt::format("is empty in line {}", column.ended);
      column.values = {};
      return;
    }
    const std::optional<double> value = header_.number(field);
    if (!value || !std::isfinite(*value)) {
      throw InvalidInput({.where = here(),
                          .field = column.channel.name,
                          .value = fmt::format("\"{}\"", field),
                          .rule = "must be a finite number"});
    }
    column.values.push_back(*value);
    if (header_.x_columns == LvmHeader::XColumns::one_a_channel) read_x(column);
  }

  void read_x(const LvmColumn& column) {
    const std::string_view field = fields_[*column.x_field];
    if (field.empty()) return;
    const std::optional<double> x = header_.number(field);
    if (!x || !std::isfinite(*x)) {
      throw InvalidInput({.where = here(),
                          .field = std::string(lvm_time),
                          .value = fmt::format("\"{}\"", field),
                          .rule = "must be a finite number"});
    }
    axes_[column.axis].add(*x, number_);
  }

  void end_segment() {
    for (const LvmColumn& column : columns_) {
      const std::size_t there = column.values.size() - column.begin;
      if (!column.channel.fault.empty() || there >= column.stated.value_or(0) || findings_.cut) continue;
      findings_.cut = {there, *column.stated};
    }
  }

  /// The rate of a channel by its times, else by Delta_X. Whether the times say it.
  bool find_rate(LvmColumn& column) {
    constexpr double written_to_s = 1e-6;  ///< the digits of a time
    constexpr double near = 1e-3;
    FileChannel& channel = column.channel;
    const LvmAxis& axis = axes_[column.axis];
    if (!channel.fault.empty() || column.values.empty() || !axis.is_used()) return false;
    const double step_s = column.time_factor * axis.step_s();
    const double off = column.delta_x_s > 0.0 ? std::abs(column.delta_x_s / step_s - 1.0) : 1.0;
    const std::string fault = axis.fault();
    if (!fault.empty()) {
      if (!axis.is_rounded() || off > 10.0 * near + channel.rate_error) channel.fault = fault;
      return channel.fault.empty();
    }
    const double error = written_to_s / axis.span_s();
    const bool agree = off <= std::max(near, channel.rate_error + error);
    if (!agree && column.delta_x_s > 0.0) findings_.time_counts = true;
    if (agree && channel.rate_error <= error) return true;
    channel.sample_rate_hz = round_15(1.0 / step_s);
    channel.rate_error = error;
    return true;
  }

  Record record() {
    Record out{.file = path_, .names = {}, .units_by = "Y_Unit_Label", .columns = {}};
    std::vector<FileChannel> channels;
    bool by_time = false;
    for (LvmColumn& column : columns_) {
      by_time = find_rate(column) || by_time;
      column.channel.samples = column.values.size();
      channels.push_back(column.channel);
    }
    const ChannelsTogether taken = channels_together(channels, path_.string());
    take_channels(out, channels, taken);
    out.rate_is_stated = out.sample_rate_hz > 0.0 && !by_time;
    for (const std::size_t place : taken.places) {
      std::vector<double>& values = columns_[place].values;
      out.columns.emplace_back(
          Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(taken.samples)));
      values = {};
    }
    add_notes(out.notes);
    return out;
  }

  void add_notes(std::vector<std::string>& notes) const {
    const std::string file = path_.string();
    if (findings_.segments > 1) {
      notes.push_back(fmt::format("{}{}: its {} segments are read one behind the other{}",
                                  findings_.pauses > 0 ? warning_label : "", file, findings_.segments,
                                  findings_.pauses == 0 ? ""
                                                        : fmt::format(", though {} of them begin up to {:.4g} s off "
                                                                      "the end of the one before",
                                                                      findings_.pauses, findings_.longest_pause_s)));
    }
    if (findings_.cut) {
      notes.push_back(fmt::format("{}{} holds {} of the {} samples that its header states: was it cut off?",
                                  warning_label, file, findings_.cut->first, findings_.cut->second));
    }
    if (findings_.special) notes.push_back(file + ": its special blocks are left out");
    if (findings_.time_counts) notes.push_back(file + ": X_Value contradicts Delta_X, and counts");
  }

  std::filesystem::path path_;
  Descriptor file_;
  std::optional<ByteReader> bytes_;
  std::size_t number_ = 0;
  std::string_view line_;
  std::vector<std::string_view> fields_;
  LvmHeader header_;
  std::vector<LvmColumn> columns_;
  std::vector<LvmAxis> axes_;
  std::size_t short_from_ = 0;  ///< the first column that a row of this segment ends before …
  std::size_t short_line_ = 0;  ///< … and that row's line
  ChannelStart started_;        ///< of the segment before
  Findings findings_;
};

}  // namespace

bool is_lvm(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;
  std::string head(byte_order_mark.size() + magic.size(), '\0');
  std::ifstream file = open_file(path);
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  const std::string_view begin(head.data(), static_cast<std::size_t>(file.gcount()));
  return begin.starts_with(magic) ||
         (begin.starts_with(byte_order_mark) && begin.substr(byte_order_mark.size()).starts_with(magic));
}

Record read_lvm(const std::filesystem::path& path) {
  return LvmReader(path).read();
}

}  // namespace robomill::io
