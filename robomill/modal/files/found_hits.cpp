#include "robomill/modal/files/found_hits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/records/records.hpp"

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
                       other.file, other_hz);
  }
  for (const auto& [role, what] : {std::pair{Role::force, "force"}, {Role::response, "response"}}) {
    if (same_unit(hit, other, role)) continue;
    return fmt::format("its {} is in {}, that of {} in {}, and hits.toml has one unit for all", what,
                       unit_text(hit, role), other.file, unit_text(other, role));
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
      found.left_out.push_back(fmt::format("{}: {}", hit.file, reason));
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

}  // namespace

FoundHits find_hits(const fs::path& data, const fs::path& folder, std::string_view made_up) {
  FoundHits found;
  std::vector<fs::path> paths = records_in(data);
  if (paths.size() > most_records) {
    found.left_out.push_back(fmt::format("{} files more in {}", paths.size() - most_records, data.string()));
    paths.resize(most_records);
  }
  for (const fs::path& path : paths) {
    const std::string name = fs::absolute(path)
                                 .lexically_normal()
                                 .lexically_proximate(fs::absolute(folder).lexically_normal())
                                 .generic_string();
    if (path.filename() == made_up) continue;
    try {
      const io::Record record = io::read_record(path);
      HitGuess guess = guess_hit(record);
      if (!guess.is_hit()) {
        found.left_out.push_back(name +
                                 ": no column looks like a hammer's force, one short pulse, beside a response. Of two "
                                 "files, write force and "
                                 "response beside each other in one CSV");
        continue;
      }
      FoundHit hit{.file = name, .format = io::format_of(path), .sample_rate_hz = record.sample_rate_hz};
      const std::vector<std::size_t> times = guess.with(ColumnGuess::Role::time);
      if (!times.empty()) {
        const double per_unit = guess.columns[times.front()].si_per_unit;
        const Eigen::VectorXd& time = record.columns[times.front()];
        const double rounded_hz = io::rounded_sample_rate_of(time);
        hit.rounded_time = rounded_hz > 0.0;
        hit.sample_rate_hz = (hit.rounded_time ? rounded_hz : io::sample_rate_of(time, path.string())) / per_unit;
      }
      hit.guess = std::move(guess);
      found.hits.push_back(std::move(hit));
    } catch (const InvalidInput& error) {
      const InvalidInput::Parts& parts = error.parts();
      found.left_out.push_back(fmt::format("{}: {}{}{}", name, parts.rule, parts.hint.empty() ? "" : ". ", parts.hint));
    }
  }
  keep_what_goes_together(found);
  return found;
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
