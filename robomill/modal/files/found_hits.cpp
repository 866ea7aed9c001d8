#include "robomill/modal/files/found_hits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/records/records.hpp"
#include "robomill/modal/files/hit_files/hit_sets.hpp"

namespace robomill::modal {
namespace {

namespace fs = std::filesystem;
using Role = ColumnGuess::Role;

/// More files of a folder are not read, nor larger ones.
constexpr std::size_t most_records = 200;
constexpr std::uintmax_t largest_record_bytes = std::uintmax_t{256} << 20;

bool same_unit(const FoundHit& a, const FoundHit& b, Role role) {
  const ColumnGuess &left = *a.first(role), &right = *b.first(role);
  return (a.format == io::Format::wav) == (b.format == io::Format::wav) && left.volts == right.volts &&
         left.si_per_unit == right.si_per_unit && left.kind == right.kind;
}

/// What a column seems to be in, in words.
std::string unit_text(const FoundHit& hit, Role role) {
  const ColumnGuess& column = *hit.first(role);
  if (hit.format == io::Format::wav) return "the scale of a WAV";
  if (!column.unit.empty()) return column.unit;
  if (role == Role::force) return "N";
  return column.kind == ResponseKind::acceleration ? "m/s^2" : column.kind == ResponseKind::velocity ? "m/s" : "m";
}

/// Why two records cannot stand in one hits.toml; empty: they can.
std::string difference(const FoundHit& hit, const FoundHit& other) {
  constexpr double same_rate = 1e-3;
  const double rate_hz = hit.sample_rate_hz, other_hz = other.sample_rate_hz;
  if (rate_hz > 0.0 && other_hz > 0.0 && std::abs(rate_hz - other_hz) > same_rate * other_hz) {
    return fmt::format("its sample rate is {:.6g} Hz, that of {} {:.6g} Hz, and all hits must have one", rate_hz,
                       other.name(), other_hz);
  }
  for (const auto& [role, what] : {std::pair{Role::force, "force"}, {Role::response, "response"}}) {
    if (same_unit(hit, other, role)) continue;
    return fmt::format("its {} is in {}, that of {} in {}, and hits.toml has one unit for all", what,
                       unit_text(hit, role), other.name(), unit_text(other, role));
  }
  return {};
}

void keep_what_goes_together(FoundHits& found) {
  const std::vector<FoundHit> hits = std::move(found.hits);
  found.hits.clear();
  std::ptrdiff_t most = 0;
  const FoundHit* common = nullptr;
  for (const FoundHit& hit : hits) {
    const auto like =
        std::ranges::count_if(hits, [&](const FoundHit& other) { return difference(other, hit).empty(); });
    if (like > most) {
      most = like;
      common = &hit;
    }
  }
  for (const FoundHit& hit : hits) {
    const std::string reason = difference(hit, *common);
    if (reason.empty()) {
      found.hits.push_back(hit);
    } else {
      found.left_out.push_back(fmt::format("{}: {}", hit.name(), reason));
    }
  }
}

/// Numbers in names count as numbers: hit_2 before hit_10.
bool comes_before(const std::string& a, const std::string& b) {
  const auto digit = [](char letter) { return std::isdigit(static_cast<unsigned char>(letter)) != 0; };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (digit(a[i]) && digit(b[j])) {
      const auto number = [&digit](const std::string& text, std::size_t& at) {
        while (at + 1 < text.size() && text[at] == '0' && digit(text[at + 1])) ++at;
        const std::size_t begin = at;
        while (at < text.size() && digit(text[at])) ++at;
        return text.substr(begin, at - begin);
      };
      const std::string left = number(a, i), right = number(b, j);
      if (left != right) return std::pair(left.size(), left) < std::pair(right.size(), right);
    } else if (a[i] != b[j]) {
      return a[i] < b[j];
    } else {
      ++i;
      ++j;
    }
  }
  return std::pair(a.size() - i, a) < std::pair(b.size() - j, b);
}

/// Files of a folder that are records by their ending, read here or not.
std::vector<fs::path> records_in(const fs::path& folder) {
  std::vector<fs::path> paths;
  try {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
      const bool record = io::is_read_as_record(entry.path()) || !io::unread_record(entry.path()).what.empty();
      if (record && entry.is_regular_file() && entry.file_size() <= largest_record_bytes) paths.push_back(entry.path());
    }
  } catch (const fs::filesystem_error& error) {
    throw InvalidInput(folder.string(), "cannot be looked through: " + error.code().message());
  }
  std::ranges::sort(paths,
                    [](const fs::path& a, const fs::path& b) { return comes_before(a.filename(), b.filename()); });
  return paths;
}

std::string relative_name(const fs::path& path, const fs::path& folder) {
  return fs::absolute(path)
      .lexically_normal()
      .lexically_proximate(fs::absolute(folder).lexically_normal())
      .generic_string();
}

std::string reason_of(const InvalidInput& error) {
  const InvalidInput::Parts& parts = error.parts();
  return fmt::format("{}{}{}", parts.rule, parts.hint.empty() ? "" : ". ", parts.hint);
}

/// One file by itself; none: it shows no hit. @throws InvalidInput as io::read_record
std::optional<FoundHit> found_alone(const fs::path& path) {
  const io::Record record = io::read_record(path);
  FoundHit hit{.format = io::format_of(path), .si_assumed = record.si_assumed, .guess = guess_hit(record)};
  if (!hit.guess.is_hit()) return std::nullopt;
  const std::vector<std::size_t> times = hit.guess.with(Role::time);
  if (!times.empty()) {
    if (!hit.guess.rounded_time) static_cast<void>(io::sample_rate_of(record.columns[times.front()], path.string()));
    const ColumnGuess& time = hit.guess.columns[times.front()];
    if (time.si_per_unit == 1.0 && !hit.guess.rounded_time) hit.time = time.name;
  }
  hit.sample_rate_hz = hit.guess.sample_rate_hz;
  return hit;
}

constexpr const char* no_hit =
    "no column looks like a hammer's force, one short pulse, beside a response. Of two files, give force and responses "
    "names that differ by these words alone (force_1.csv, acc_1.csv), or write file = [\"FORCE\", \"RESPONSE\"]";

/// Files that show no hit by themselves may together.
void add_sets(const std::vector<fs::path>& alone, bool of_any_name, const fs::path& folder, FoundHits& found) {
  std::vector<std::vector<fs::path>> sets;
  if (of_any_name && alone.size() == 2) {
    sets.push_back(alone);
  } else {
    sets = sets_by_name(alone);
  }
  for (std::vector<fs::path>& set : sets) {
    std::string reason = no_hit;
    std::optional<FoundHit> hit;
    try {
      if (set.size() > 1) hit = found_in_set(set);
    } catch (const InvalidInput& error) {
      reason = reason_of(error);
    }
    std::vector<std::string> names;
    names.reserve(set.size());
    for (const fs::path& path : set) names.push_back(relative_name(path, folder));
    if (hit) {
      hit->files = std::move(names);
      found.hits.push_back(std::move(*hit));
    } else {
      found.left_out.push_back(fmt::format("{}: {}", fmt::join(names, " + "), reason));
    }
  }
}

FoundHits found_among(const std::vector<fs::path>& paths, const fs::path& folder, bool of_any_name) {
  FoundHits found;
  std::vector<fs::path> others;
  for (const fs::path& path : paths) {
    try {
      if (std::optional<FoundHit> hit = found_alone(path)) {
        hit->files = {relative_name(path, folder)};
        found.hits.push_back(std::move(*hit));
      } else {
        others.push_back(path);
      }
    } catch (const InvalidInput& error) {
      found.left_out.push_back(fmt::format("{}: {}", relative_name(path, folder), reason_of(error)));
    }
  }
  add_sets(others, of_any_name, folder, found);
  std::ranges::stable_sort(
      found.hits, [](const FoundHit& a, const FoundHit& b) { return comes_before(a.files.front(), b.files.front()); });
  keep_what_goes_together(found);
  return found;
}

}  // namespace

FoundHits find_hits(const fs::path& data, const fs::path& folder, std::string_view made_up) {
  std::vector<fs::path> paths = records_in(data);
  std::string more;
  if (paths.size() > most_records) {
    more = fmt::format("{} files more in {}", paths.size() - most_records, data.string());
    paths.resize(most_records);
  }
  std::erase_if(paths, [&](const fs::path& path) { return path.filename() == made_up; });
  FoundHits found = found_among(paths, folder, false);
  if (!more.empty()) found.left_out.insert(found.left_out.begin(), more);
  return found;
}

FoundHits find_hits(const std::vector<fs::path>& files, const fs::path& folder) {
  return found_among(files, folder, true);
}

std::optional<FoundHit> find_set_of(const fs::path& file) {
  std::vector<fs::path> set;
  for (const fs::path& path : records_in(file.parent_path())) {
    if (set_key(path) != set_key(file)) continue;
    try {
      if (!found_alone(path)) set.push_back(path);
    } catch (const InvalidInput&) {
      continue;  // it cannot be read, and belongs to none
    }
  }
  const auto is_file = [&](const fs::path& path) { return path.filename() == file.filename(); };
  if (set.size() < 2 || std::ranges::none_of(set, is_file)) return std::nullopt;
  std::optional<FoundHit> hit;
  try {
    hit = found_in_set(set);
  } catch (const InvalidInput&) {
    return std::nullopt;
  }
  if (!hit) return std::nullopt;
  for (const fs::path& path : set) hit->files.push_back(path.filename().string());
  return hit;
}

std::string FoundHit::name() const {
  return fmt::format("{}", fmt::join(files, " + "));
}

const ColumnGuess* FoundHit::first(ColumnGuess::Role role) const {
  const std::vector<std::size_t> places = guess.with(role);
  return places.empty() ? nullptr : &guess.columns[places.front()];
}

MeasuredAxes measured_axes(const FoundHits& found) {
  MeasuredAxes axes;
  for (const FoundHit& hit : found.hits) {
    axes.excitations.insert(hit.guess.force_direction.back());
    for (const std::size_t i : hit.guess.with(Role::response)) axes.responses.insert(hit.guess.columns[i].axis);
  }
  return axes;
}

}  // namespace robomill::modal
