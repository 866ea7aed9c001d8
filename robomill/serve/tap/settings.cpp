#include "robomill/serve/tap/settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <set>
#include <string_view>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/printable.hpp"
#include "robomill/io/system/confinement.hpp"
#include "robomill/io/toml/edit.hpp"
#include "robomill/io/toml/values.hpp"
#include "robomill/io/toml_source.hpp"
#include "robomill/modal/files/hit_files/hit_sets.hpp"

namespace robomill::serve {
namespace {

constexpr double usual_record_s = 1.0;
constexpr std::string_view acquisition_table = "acquisition.";

/// Whether a name has a word, whatever parts words in it: "x" in "tap_x-3.csv".
bool has_word(std::string_view name, std::string_view word) {
  const auto parts_words = [&](std::size_t at) {
    return at >= name.size() || std::isalpha(static_cast<unsigned char>(name[at])) == 0;
  };
  for (std::size_t at = name.find(word); at != std::string_view::npos; at = name.find(word, at + 1)) {
    if ((at == 0 || parts_words(at - 1)) && parts_words(at + word.size())) return true;
  }
  return false;
}

/// The axis of a direction, "y" of "-1y".
std::string axis_of(std::string_view direction) {
  const std::size_t at = direction.find_last_of("xyz");
  return std::string(direction.substr(at == std::string_view::npos ? 0 : at));
}

std::string toml_text(const io::Json& value) {
  return value.is_string() ? io::toml_quoted(value.get<std::string>()) : io::plain_text(value);
}

/// Keys that say what a 1 of a record is.
bool is_scale(std::string_view key) {
  key.remove_prefix(std::min(key.size(), acquisition_table.size()));
  return key.starts_with("force_mv_") || key.starts_with("response_mv_") || key == "voltage_unit" || key == "scale";
}

}  // namespace

TapDirection parse_direction(const std::string& text) {
  std::string_view rest = text;
  const bool against = rest.starts_with('-');
  if (against) rest.remove_prefix(1);
  const auto rejected = [&] {
    return InvalidInput("force_direction", printable(text.substr(0, 20)) + " is no direction",
                        "Write x, y or z; -x for a hit against the axis; 3x at point 3");
  };
  try {
    const modal::Dof dof = modal::parse_dof(rest);
    if (dof.axis > modal::Axis::z) throw rejected();
    return {.dof = dof, .against_axis = against};
  } catch (const InvalidInput&) {
    throw rejected();
  }
}

std::string direction_text(const modal::Dof& dof, bool against_axis) {
  return (against_axis ? "-" : "") + modal::to_string(dof);
}

TapSettings::TapSettings(std::filesystem::path hits, const std::string& text) : path_(std::move(hits)) {
  read_rows(text);
  if (rows_.empty()) {
    throw InvalidInput(path_.string(), "has no [[hits]]",
                       "Write one row a direction: its columns and force_direction serve the hits that come");
  }
  columns_ = modal::read_hit_rows(io::TomlSource(path_, text));
  std::set<std::string> axes;
  for (const std::string& direction : excitation_directions_) axes.insert(axis_of(direction));
  directions_ = axes.size();
  name_channels();
}

void TapSettings::read_rows(const std::string& text) {
  for (const io::TomlValue& value : io::toml_values(text, path_.string())) {
    constexpr std::string_view table = "hits[";
    if (!value.key.starts_with(table)) {
      acquisition_.push_back({.key = value.key, .value = toml_text(value.value)});
      continue;
    }
    const std::size_t row = std::strtoul(value.key.c_str() + table.size(), nullptr, 10);
    if (rows_.size() <= row) {
      rows_.resize(row + 1);
      excitation_directions_.resize(row + 1);
      named_.resize(row + 1);
    }
    const std::string key = value.key.substr(value.key.find("].") + 2);
    if (key == "file") {
      for (const io::Json& file : value.value.is_array() ? value.value : io::Json::array({value.value})) {
        if (!file.is_string()) continue;  // read_hit_rows says so
        named_[row].push_back(path_.parent_path() / file.get<std::string>());
        io::require_inside(named_[row].back());  // even whether it is there is nobody's business
      }
      continue;
    }
    if (key == "leave_out") continue;  // of the record that the row names, and of no other
    if (key == "force_direction" && value.value.is_string())
      excitation_directions_[row] = value.value.get<std::string>();
    rows_[row] += fmt::format("{} = {}\n", key, toml_text(value.value));
  }
}

void TapSettings::name_channels() {
  const auto add = [this](const std::string& column) {
    if (std::ranges::find(channels_, column) == channels_.end()) channels_.push_back(column);
  };
  for (const modal::HitRow& row : columns_.rows) {
    add(row.force);
    for (const modal::HitRow::Response& response : row.responses) add(response.column);
  }
}

std::string TapSettings::acquisition(bool si) const {
  std::string out = "[acquisition]\n";
  for (const auto& [key, value] : acquisition_) {
    if (!key.starts_with(acquisition_table) || (si && is_scale(key))) continue;
    out += fmt::format("{} = {}\n", key.substr(acquisition_table.size()), value);
  }
  return out;
}

std::optional<std::size_t> TapSettings::row_that_names(const std::filesystem::path& record) const {
  for (std::size_t i = 0; i < named_.size(); ++i) {
    const auto is_it = [&](const std::filesystem::path& file) {
      return file.lexically_normal() == record.lexically_normal();
    };
    if (std::ranges::any_of(named_[i], is_it)) return i;
  }
  return std::nullopt;
}

std::string TapSettings::key_of(const std::filesystem::path& file) const {
  if (const std::optional<std::size_t> row = row_that_names(file)) return fmt::format("row {}", *row);
  return (file.parent_path() / modal::set_key(file)).lexically_normal().string();
}

std::size_t TapSettings::row_of(const std::filesystem::path& record) const {
  if (const std::optional<std::size_t> row = row_that_names(record)) return *row;
  const std::string name = record.stem().string();
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (!excitation_directions_[i].empty() && has_word(name, axis_of(excitation_directions_[i]))) return i;
  }
  return 0;
}

std::vector<modal::Hit> TapSettings::read(const std::vector<std::filesystem::path>& files) const {
  std::string list, whole, names;
  for (const std::filesystem::path& file : files) {
    list += (list.empty() ? "" : ", ") + io::toml_quoted(file.string());
    whole += (whole.empty() ? "" : " + ") + file.string();
    names += (names.empty() ? "" : " + ") + file.filename().string();
  }
  const std::string text = fmt::format("{}\n[[hits]]\nfile = [{}]\n{}", acquisition(false), list, row(files.front()));
  std::vector<modal::Hit> hits = modal::read_hits(io::TomlSource(path_, text)).hits;
  for (modal::Hit& hit : hits) hit.file = names + hit.file.substr(std::min(whole.size(), hit.file.size()));
  return hits;
}

std::vector<std::filesystem::path> TapSettings::in_order(std::vector<std::filesystem::path> files) const {
  const std::vector<std::filesystem::path>& named = named_[row_of(files.front())];
  const auto place = [&](const std::filesystem::path& file) {
    const auto same = [&](const std::filesystem::path& one) {
      return one.lexically_normal() == file.lexically_normal();
    };
    return std::ranges::find_if(named, same) - named.begin();
  };
  std::stable_partition(files.begin(), files.end(), modal::is_named_force);
  std::ranges::stable_sort(files, {}, place);
  return files;
}

std::vector<std::filesystem::path> TapSettings::named() const {
  std::vector<std::filesystem::path> out;
  for (const std::vector<std::filesystem::path>& files : named_) out.insert(out.end(), files.begin(), files.end());
  return out;
}

std::string TapSettings::first_direction() const {
  return direction_text(columns_.rows.front().excitation, columns_.rows.front().against_axis);
}

modal::HitTriggerOptions TapSettings::trigger(double level_n, double record_s) const {
  if (columns_.sample_rate_hz <= 0.0) {
    throw InvalidInput(InvalidInput::Parts{
        .where = path_.string(), .field = "acquisition.sample_rate_hz", .rule = "must be given for a stream"});
  }
  const std::string& force = columns_.rows.front().force;
  for (const modal::HitRow& row : columns_.rows) {
    if (row.force == force) continue;
    throw InvalidInput(path_.string(),
                       fmt::format("has the forces {} and {}; a stream has one hammer", force, row.force),
                       "Give every row the same force");
  }
  const double resolution_hz = columns_.options.frequency_resolution_hz;
  if (record_s == 0.0) record_s = resolution_hz > 0.0 ? 1.0 / resolution_hz : usual_record_s;
  modal::HitTriggerOptions out = {.sample_rate_hz = columns_.sample_rate_hz,
                                  .channels = static_cast<int>(std::min<std::size_t>(channels_.size(), 1000)),
                                  .force_channel = 0,
                                  .force_factor = columns_.force_factor,
                                  .level_n = level_n,
                                  .record_s = record_s};
  out.validate();
  return out;
}

modal::Hit TapSettings::hit_of(const modal::HitRecord& record, const std::string& direction,
                               const std::string& name) const {
  const TapDirection excitation = parse_direction(direction);
  const std::vector<modal::HitRow>& rows = columns_.rows;
  auto row = std::ranges::find_if(rows, [&](const modal::HitRow& r) {
    return r.excitation == excitation.dof && r.against_axis == excitation.against_axis;
  });
  if (row == rows.end()) row = std::ranges::find(rows, excitation.dof, &modal::HitRow::excitation);
  if (row == rows.end()) {
    row = std::ranges::find_if(rows, [&](const modal::HitRow& r) { return r.excitation.axis == excitation.dof.axis; });
  }
  if (row == rows.end()) row = rows.begin();

  const std::size_t channels = channels_.size();
  const auto column = [&](const std::string& wanted, double factor) {
    const auto at = static_cast<std::size_t>(std::ranges::find(channels_, wanted) - channels_.begin());
    Eigen::VectorXd out(static_cast<Eigen::Index>(record.samples.size() / channels));
    for (Eigen::Index i = 0; i < out.size(); ++i) {
      out(i) = factor * static_cast<double>(record.samples[static_cast<std::size_t>(i) * channels + at]);
    }
    return out;
  };
  modal::Hit hit{.file = name,
                 .excitation = excitation.dof,
                 .against_axis = excitation.against_axis,
                 .sample_rate_hz = columns_.sample_rate_hz,
                 .force_n = column(row->force, columns_.force_factor),
                 .responses = {}};
  for (const modal::HitRow::Response& response : row->responses) {
    hit.responses.push_back({.dof = response.dof,
                             .samples = column(response.column, columns_.response_factor),
                             .against_axis = response.against_axis});
  }
  return hit;
}

}  // namespace robomill::serve
