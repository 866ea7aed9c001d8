#include "robomill/serve/files/tap_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <system_error>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/toml/edit.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/modal/files/hits_toml.hpp"
#include "robomill/serve/tap/settings.hpp"

namespace robomill::serve {
namespace {

namespace fs = std::filesystem;

struct TapColumn {
  std::string name, direction;  ///< the force's has none
  const Eigen::VectorXd* samples;
};

std::vector<TapColumn> columns_of(const modal::Hit& hit, modal::ResponseKind kind) {
  std::vector<TapColumn> out = {{.name = "force_n", .direction = {}, .samples = &hit.force_n}};
  for (const modal::HitChannel& channel : hit.responses) {
    const std::string direction = direction_text(channel.dof, channel.against_axis);
    out.push_back({.name = fmt::format("{}_{}", direction, modal::response_unit(kind)),
                   .direction = direction,
                   .samples = &channel.samples});
  }
  return out;
}

/// As many digits as bring the same numbers back.
std::string csv_of(const std::vector<TapColumn>& columns) {
  std::string out;
  for (const TapColumn& column : columns) out += (out.empty() ? "" : ",") + column.name;
  out += '\n';
  for (Eigen::Index i = 0; i < columns.front().samples->size(); ++i) {
    for (const TapColumn& column : columns) {
      fmt::format_to(std::back_inserter(out), "{}{}", &column == &columns.front() ? "" : ",", (*column.samples)(i));
    }
    out += '\n';
  }
  return out;
}

std::string row_of(const std::vector<TapColumn>& columns, const std::string& direction) {
  std::string out = fmt::format("force = {}\nforce_direction = {}\nresponses = {{", io::toml_quoted(columns[0].name),
                                io::toml_quoted(direction));
  for (std::size_t i = 1; i < columns.size(); ++i) {
    out += fmt::format("{} {} = {}", i > 1 ? "," : "", columns[i].direction, io::toml_quoted(columns[i].name));
  }
  return out + " }\n";
}

/// Of a hit out of a stream.
fs::path record_path(const fs::path& document, const TapHit& taken, std::size_t number) {
  return document.parent_path() /
         fmt::format("{}_{}_{}.csv", document.stem().string(), to_string(taken.hit->excitation), number);
}

/// "\"hit.csv\"", or a list, relative to the document.
std::string file_value(const fs::path& document, const std::vector<fs::path>& files) {
  std::string list;
  for (const fs::path& file : files) {
    const std::string name = file.lexically_relative(document.parent_path()).generic_string();
    list += (list.empty() ? "" : ", ") + io::toml_quoted(name);
  }
  return files.size() == 1 ? list : fmt::format("[{}]", list);
}

/// Hits of a record that were not accepted.
std::string left_out(const TapDocument& document, const TapHit& first) {
  std::string numbers;
  for (std::size_t i = 1; i <= first.of; ++i) {
    const auto is_it = [&](const auto& one) { return one.second.files == first.files && one.second.number == i; };
    if (std::ranges::none_of(document.hits, is_it)) numbers += fmt::format("{}{}", numbers.empty() ? "" : ", ", i);
  }
  return numbers.empty() ? std::string() : fmt::format("leave_out = [{}]\n", numbers);
}

bool is_there(const fs::path& path) {
  std::error_code error;
  return fs::exists(fs::symlink_status(path, error));
}

}  // namespace

TapWritten write_tap_hits(const fs::path& path, const TapDocument& document, bool replace) {
  TapWritten out;
  for (const auto& [number, taken] : document.hits) {
    if (taken.files.empty()) out.files.push_back(record_path(path, taken, number));
  }
  out.files.push_back(path);
  for (const fs::path& file : out.files) {
    if (!replace && is_there(file)) return {.files = {}, .there = file};
  }
  io::make_folder(path.parent_path());
  std::string text = document.acquisition;
  std::set<std::vector<fs::path>> written;
  for (const auto& [number, taken] : document.hits) {
    if (!taken.files.empty()) {
      // A row is of all hits of its record.
      if (!written.insert(taken.files).second) continue;
      text += fmt::format("\n[[hits]]\nfile = {}\n{}{}", file_value(path, taken.files), taken.row,
                          left_out(document, taken));
      continue;
    }
    const fs::path record = record_path(path, taken, number);
    const std::vector<TapColumn> columns = columns_of(*taken.hit, document.response);
    io::write_file(record, csv_of(columns));
    text += fmt::format("\n[[hits]]\nfile = {}\n{}", file_value(path, {record}), row_of(columns, taken.direction));
  }
  io::write_file(path, text);
  return out;
}

TapWritten write_tap_frfs(const fs::path& path, const modal::FrfResult& result, bool replace) {
  if (!replace && is_there(path)) return {.files = {}, .there = path};
  io::make_folder(path.parent_path());
  modal::write_frfs(path, result);
  return {.files = {path}, .there = std::nullopt};
}

}  // namespace robomill::serve
