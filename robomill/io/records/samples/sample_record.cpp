#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/joined_records.hpp"
#include "robomill/io/records/records.hpp"
#include "robomill/io/records/samples/sample_parts.hpp"

namespace robomill::io {
namespace {

using Path = std::filesystem::path;

/// Whether channels are columns in their order: of files that name none and have as many.
bool are_in_order(const std::vector<Record>& parts, const std::vector<std::string>& channels) {
  std::size_t columns = 0;
  for (const Record& part : parts) {
    if (std::ranges::any_of(part.names, [](const std::string& name) { return !name.empty(); })) return false;
    columns += part.columns.size();
  }
  const auto is_name = [](const std::string& channel) {
    return channel.find(':') == std::string::npos && channel.find_first_not_of("0123456789") != std::string::npos;
  };
  return columns == channels.size() && std::ranges::all_of(channels, is_name);
}

std::vector<PartColumn> pick_of_files(const std::vector<Record>& parts, const std::vector<std::string>& channels) {
  std::vector<PartColumn> pick;
  if (are_in_order(parts, channels)) {
    for (std::size_t part = 0; part < parts.size(); ++part) {
      for (std::size_t place = 0; place < parts[part].columns.size(); ++place) pick.push_back({part, place});
    }
    return pick;
  }
  for (const std::string& channel : channels) {
    const PartColumn column = find_column(parts, channel);
    if (std::ranges::find(pick, column) != pick.end()) {
      throw InvalidInput(parts[column.part].file.string(),
                         fmt::format("column {} would be two channels, {} among them", column.place + 1, channel));
    }
    pick.push_back(column);
  }
  return pick;
}

/// Columns that are in memory.
class RecordSource : public SampleSource {
 public:
  RecordSource(const std::vector<Path>& files, const SampleColumns& columns) {
    if (files.size() == 1) {
      take_one(files.front(), columns);
    } else {
      take_joined(files, columns);
    }
  }

  bool next(std::size_t frames, SampleBlock& block) override {
    block.samples.clear();
    const Eigen::Index end = std::min(columns_.front().size(), at_ + static_cast<Eigen::Index>(frames));
    for (; at_ < end; ++at_) {
      for (const Eigen::VectorXd& column : columns_) block.samples.push_back(static_cast<float>(column(at_)));
    }
    return !block.samples.empty();
  }

 private:
  void take_one(const Path& path, const SampleColumns& columns) {
    Record record = read_record(path, {.time = {}, .scale = columns.scale});
    sample_rate_hz_ = record.sample_rate_hz;
    notes_ = record.notes;
    check_rate(sample_rate_hz_, columns.sample_rate_hz, std::max(1e-3, record.rate_error), path.string());
    const std::vector<std::size_t> pick =
        pick_columns(columns, record.names, record.columns.size(), path.string(), record.left_out);
    for (const std::size_t column : pick) columns_.push_back(std::move(record.columns[column]));
    for (const Eigen::VectorXd& column : columns_) {
      if (column.size() != columns_.front().size()) {
        throw InvalidInput(path.string(), "its channels have different numbers of samples");
      }
    }
  }

  void take_joined(const std::vector<Path>& files, const SampleColumns& columns) {
    std::vector<Record> parts;
    for (const Path& path : files) {
      Record part = read_record(path, {.time = {}, .scale = columns.scale});
      std::ranges::copy(part.notes, std::back_inserter(notes_));
      part.sample_rate_hz = rate_of(part, columns.sample_rate_hz, "signal.sample_rate_hz", notes_);
      parts.push_back(std::move(part));
    }
    JoinedRecords joined = join_records(std::move(parts));
    std::ranges::copy(joined.notes, std::back_inserter(notes_));
    sample_rate_hz_ = joined.sample_rate_hz;
    for (const PartColumn& column : pick_of_files(joined.parts, columns.channels)) {
      columns_.push_back(std::move(joined.parts[column.part].columns[column.place]));
    }
  }

  std::vector<Eigen::VectorXd> columns_;
  Eigen::Index at_ = 0;
};

}  // namespace

std::unique_ptr<SampleSource> record_source(const std::vector<Path>& files, const SampleColumns& columns) {
  return std::make_unique<RecordSource>(files, columns);
}

}  // namespace robomill::io
