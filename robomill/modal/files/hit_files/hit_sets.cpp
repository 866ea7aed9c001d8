#include "robomill/modal/files/hit_files/hit_sets.hpp"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <span>
#include <string_view>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/joined_records.hpp"
#include "robomill/modal/files/hit_files/hit_record.hpp"

namespace robomill::modal {
namespace {

namespace fs = std::filesystem;
using Role = ColumnGuess::Role;

constexpr std::string_view force_words[] = {"force", "hammer", "impact", "kraft", "f"};
constexpr std::string_view response_words[] = {
    "acc",     "accel", "accelerometer", "acceleration", "beschl",       "beschleunigung", "resp", "response",
    "antwort", "vel",   "velocity",      "disp",         "displacement", "sensor",         "a"};

std::string_view without_number(std::string_view word) {
  while (!word.empty() && std::isdigit(static_cast<unsigned char>(word.back())) != 0) word.remove_suffix(1);
  return word;
}

/// Its number aside: "accel2".
bool is_one_of(std::string_view word, std::span<const std::string_view> known) {
  return std::ranges::find(known, without_number(word)) != known.end();
}

bool has_word_of(const fs::path& path, std::span<const std::string_view> known) {
  return std::ranges::any_of(words_in(path.stem().string()),
                             [&](const std::string& word) { return is_one_of(word, known); });
}

/// What columns without names of a file are by the file's name, but its time.
std::vector<std::string> names_by_file(const io::Record& part) {
  std::vector<std::string> names = part.names;
  names.resize(part.columns.size());
  const bool responds = has_word_of(part.file, response_words);
  if (!responds && !has_word_of(part.file, force_words)) return names;
  const HitGuess guess = guess_hit(part);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Role role = guess.columns[i].role;
    if (names[i].empty() && role != Role::time && role != Role::other) names[i] = responds ? "response" : "force";
  }
  return names;
}

/// The columns of all files, for guesses alone.
io::Record side_by_side(const std::vector<io::Record>& parts) {
  io::Record out{.file = parts.front().file, .names = {}, .columns = {}};
  for (const io::Record& part : parts) {
    if (!(out.sample_rate_hz > 0.0)) out.sample_rate_hz = part.sample_rate_hz;
    const std::vector<std::string> names = names_by_file(part);
    for (std::size_t i = 0; i < part.columns.size(); ++i) {
      out.names.push_back(names[i]);
      out.units.push_back(i < part.units.size() ? part.units[i] : std::string());
      out.columns.push_back(part.columns[i]);
    }
  }
  return out;
}

/// The file of a column of all files.
std::size_t part_of_column(const std::vector<io::Record>& parts, std::size_t& place) {
  std::size_t part = 0;
  while (place >= parts[part].columns.size()) place -= parts[part++].columns.size();
  return part;
}

/// The force's file first.
void order(std::vector<fs::path>& files, std::vector<io::Record>& parts) {
  const HitGuess guess = guess_hit(side_by_side(parts));
  const std::vector<std::size_t> forces = guess.with(Role::force);
  if (forces.empty()) return;
  std::size_t place = forces.front();
  const std::size_t part = part_of_column(parts, place);
  std::swap(files[0], files[part]);
  std::swap(parts[0], parts[part]);
}

/// The column of time of each file, as read_hit_record takes it for all of them.
std::string common_time(const std::vector<HitGuess>& parts) {
  std::vector<std::string> times;
  for (const HitGuess& guess : parts) {
    const std::vector<std::size_t> found = guess.with(Role::time);
    if (found.empty()) continue;
    times.push_back(guess.columns[found.front()].name);
  }
  const bool all = times.size() == parts.size() &&
                   std::ranges::all_of(times, [&](const std::string& time) { return time == times.front(); });
  if (!all) return {};
  return times.front();
}

}  // namespace

std::string set_key(const fs::path& path) {
  std::string key;
  for (const std::string& word : words_in(path.stem().string())) {
    const bool of_role = is_one_of(word, force_words) || is_one_of(word, response_words);
    const std::string rest = of_role ? word.substr(without_number(word).size()) : word;
    if (!rest.empty()) key += (key.empty() ? "" : "_") + rest;
  }
  return key;
}

bool is_named_force(const fs::path& path) {
  return has_word_of(path, force_words) && !has_word_of(path, response_words);
}

std::vector<std::vector<fs::path>> sets_by_name(const std::vector<fs::path>& paths) {
  std::vector<std::vector<fs::path>> out;
  std::vector<std::pair<fs::path, std::string>> keys;
  for (const fs::path& path : paths) {
    std::pair<fs::path, std::string> key(path.parent_path(), set_key(path));
    const auto known = std::ranges::find(keys, key);
    if (known != keys.end()) {
      out[static_cast<std::size_t>(known - keys.begin())].push_back(path);
    } else {
      keys.push_back(std::move(key));
      out.push_back({path});
    }
  }
  return out;
}

std::optional<FoundHit> found_in_set(std::vector<fs::path>& files) {
  std::vector<io::Record> parts;
  parts.reserve(files.size());
  for (const fs::path& file : files) parts.push_back(io::read_record(file));
  // Of signals alone the sharpest is the force; a name that says it stands before that.
  std::stable_partition(files.begin(), files.end(), is_named_force);
  std::stable_partition(parts.begin(), parts.end(), [](const io::Record& part) { return is_named_force(part.file); });
  order(files, parts);
  FoundHit hit{.format = io::format_of(files.front()),
               .si_assumed = std::ranges::any_of(parts, &io::Record::si_assumed),
               .guess = guess_hit(side_by_side(parts))};
  if (!hit.guess.is_hit()) return std::nullopt;
  std::vector<HitGuess> apart;
  apart.reserve(parts.size());
  for (const io::Record& part : parts) apart.push_back(guess_hit(part));
  const std::string time = common_time(apart);
  for (std::size_t i = 0; i < hit.guess.columns.size(); ++i) {
    std::size_t place = i;
    const std::size_t part = part_of_column(parts, place);
    if (apart[part].columns[place].role == Role::time) hit.guess.columns[i].role = Role::time;
    const bool is_force = hit.guess.columns[i].role == Role::force;
    hit.guess.columns[i].name = io::column_name(parts, {.part = part, .place = place}, own_part(parts, is_force));
  }
  const RecordOfHits record = read_hit_record(files, {.time = time});
  hit.sample_rate_hz = hit.guess.sample_rate_hz = record.sample_rate_hz;
  hit.guess.rounded_time = false;
  hit.time = time;
  return hit;
}

}  // namespace robomill::modal
