#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <deque>
#include <limits>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/records/records.hpp"
#include "robomill/io/records/samples/sample_parts.hpp"
#include "robomill/io/si.hpp"
#include "robomill/io/table.hpp"
#include "robomill/io/text.hpp"

namespace robomill::io {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr std::size_t rows_for_the_rate = 1000;  ///< read ahead in a file, to see how its time runs

std::optional<double> number_of(std::string_view field, char separator) {
  return separator == ',' ? parse_number(field) : parse_cell(field);
}

/// Rows of numbers under a header that may be missing.
class TextSource : public SampleSource {
 public:
  TextSource(std::unique_ptr<ByteReader> bytes, const SampleColumns& columns, std::string where, bool is_file)
      : bytes_(std::move(bytes)), where_(std::move(where)) {
    read_header(columns);
    if (is_file) find_rate(columns);
  }

  bool next(std::size_t frames, SampleBlock& block) override {
    block.samples.clear();
    for (std::size_t frame = 0; frame < frames; ++frame) {
      if (frame > 0 && ahead_.empty() && !bytes_->line_here()) break;  // what is there, rather than wait
      std::optional<std::string_view> line = next_line();
      while (line && is_table_comment(*line)) line = next_line();
      if (!line) break;
      read_row(*line, block);
    }
    block.followed = followed_;
    return !block.samples.empty();
  }

 private:
  /// Lines held back by find_rate come first.
  std::optional<std::string_view> next_line() {
    if (!ahead_.empty()) {
      held_ = std::move(ahead_.front());
      ahead_.pop_front();
      ++line_number_;
      return std::string_view(held_);
    }
    const std::optional<std::string_view> line = bytes_->line();
    if (line) ++line_number_;
    return line;
  }

  void split(std::string_view line) {
    fields_.clear();
    if (line.find('"') != std::string_view::npos) {
      unquoted_ = split_texts(line, separator_);
      fields_.assign(unquoted_.begin(), unquoted_.end());
      return;
    }
    line = trimmed(line);
    while (!line.empty()) {
      std::size_t end = separator_ == ' ' ? line.find_first_of(" \t") : line.find(separator_);
      if (end == std::string_view::npos) end = line.size();
      fields_.push_back(trimmed(line.substr(0, end)));
      line.remove_prefix(std::min(end + 1, line.size()));
      if (separator_ == ' ') line = trimmed(line);
    }
  }

  /// Numbers, some of which may be missing.
  [[nodiscard]] bool is_row_of_numbers() const {
    const auto readable = [this](std::string_view field) { return field.empty() || number_of(field, separator_); };
    return !fields_.empty() && std::all_of(fields_.begin(), fields_.end(), readable) &&
           std::any_of(fields_.begin(), fields_.end(), [](std::string_view field) { return !field.empty(); });
  }

  void read_header(const SampleColumns& columns) {
    std::vector<std::string> header;
    while (true) {
      const std::optional<std::string_view> line = next_line();
      if (!line || header.size() > max_header_lines) throw InvalidInput(where_, "holds no line of numbers");
      if (line->find('\0') != std::string_view::npos) {
        throw InvalidInput(where_, "is no plain text", "Raw samples need --format f32 or i16");
      }
      std::string text(line->starts_with("\xEF\xBB\xBF") ? line->substr(3) : *line);
      if (is_table_comment(text)) continue;
      separator_ = separator_of(text) == '\t' ? ' ' : separator_of(text);
      split(text);
      if (is_row_of_numbers()) {
        count_ = fields_.size();
        take_names(header);
        ahead_.push_front(std::move(text));
        --line_number_;
        break;
      }
      header.push_back(std::move(text));
    }
    pick_ = pick_columns(columns, names_, count_, where_);
    const auto followed = std::find(names_.begin(), names_.end(), columns.followed);
    if (columns.followed.empty() || followed == names_.end()) return;
    followed_column_ = static_cast<std::size_t>(followed - names_.begin());
    followed_factor_ = columns.followed_factor;
  }

  /// The last line above the numbers that has as many fields, or the one above it where that one holds units.
  void take_names(const std::vector<std::string>& header) {
    std::vector<std::string> below;
    for (std::size_t back = 1; back <= std::min<std::size_t>(header.size(), 2); ++back) {
      const std::string& line = header[header.size() - back];
      const char separator = separator_of(line) == '\t' || separator_of(line) == ' ' ? ' ' : separator_of(line);
      std::vector<std::string> names = split_texts(line, separator);
      if (names.size() != count_) break;
      below = std::exchange(names_, std::move(names));
    }
    if (!below.empty()) units_ = units_of_row(below, names_, where_).value_or(std::vector<std::string>());
  }

  /// From the first rows, where a column is the time.
  void find_rate(const SampleColumns& columns) {
    const auto time = std::find_if(names_.begin(), names_.end(), is_time_column);
    if (time == names_.end()) return;
    const auto column = static_cast<std::size_t>(time - names_.begin());
    // Of a row of units, where there is one: of the name it is s.
    const double unit_s = column < units_.size() ? seconds_in(units_[column]) : 0.0;
    std::vector<double> times_s;
    while (ahead_.size() < rows_for_the_rate) {
      const std::optional<std::string_view> line = bytes_->line();
      if (!line) break;
      ahead_.emplace_back(*line);
    }
    for (const std::string& line : ahead_) {
      split(line);
      const std::optional<double> time_s =
          fields_.size() == count_ ? number_of(fields_[column], separator_) : std::nullopt;
      if (time_s) times_s.push_back(unit_s > 0.0 ? unit_s * *time_s : *time_s);
    }
    const Eigen::Map<const Eigen::VectorXd> times(times_s.data(), static_cast<Eigen::Index>(times_s.size()));
    if (columns.sample_rate_hz <= 0.0) {
      sample_rate_hz_ = round_15(sample_rate_of(times, where_));
    } else if (times.size() > 1 && times(times.size() - 1) > times(0)) {
      // Of times with few digits only the mean step is good.
      const double mean_hz = static_cast<double>(times.size() - 1) / (times(times.size() - 1) - times(0));
      check_rate(mean_hz, columns.sample_rate_hz, 0.01, where_);
    }
  }

  void read_row(std::string_view line, SampleBlock& block) {
    split(line);
    const std::size_t begin = block.samples.size();
    bool readable = fields_.size() == count_;
    for (std::size_t i = 0; readable && i < pick_.size(); ++i) {
      const std::string_view field = fields_[pick_[i]];
      const std::optional<double> value = field.empty() ? nan : number_of(field, separator_);
      readable = value.has_value();
      if (readable) block.samples.push_back(static_cast<float>(*value));
    }
    if (!readable) {
      block.samples.resize(begin);
      block.samples.resize(begin + pick_.size(), nan);
      if (unreadable_rows_++ == 0) first_unreadable_line_ = line_number_;
      return;
    }
    if (followed_column_ >= count_) return;
    const std::optional<double> value = number_of(fields_[followed_column_], separator_);
    if (value && *value >= 0.0) followed_ = *value * followed_factor_;
  }

  std::unique_ptr<ByteReader> bytes_;
  std::string where_, held_;
  std::deque<std::string> ahead_;
  char separator_ = ',';
  std::size_t count_ = 0, line_number_ = 0;
  std::size_t followed_column_ = std::numeric_limits<std::size_t>::max();
  double followed_factor_ = 1.0, followed_ = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::string> names_, units_, unquoted_;
  std::vector<std::string_view> fields_;
  std::vector<std::size_t> pick_;
};

}  // namespace

std::unique_ptr<SampleSource> text_source(std::unique_ptr<ByteReader> bytes, const SampleColumns& columns,
                                          const std::string& where, bool is_file) {
  return std::make_unique<TextSource>(std::move(bytes), columns, where, is_file);
}

}  // namespace robomill::io
