#include "robomill/serve/files/inspect.hpp"

#include <fmt/format.h>

#include <optional>
#include <string>
#include <utility>

#include "robomill/base/printable.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/records/records.hpp"
#include "robomill/modal/files/found_hits.hpp"
#include "robomill/serve/files/kind.hpp"

namespace robomill::serve {
namespace {

using Role = modal::ColumnGuess::Role;

io::Json name_of(Role role) {
  switch (role) {
    case Role::time:
      return "time";
    case Role::force:
      return "force";
    case Role::response:
      return "response";
    case Role::other:
    case Role::unknown:
      break;
  }
  return nullptr;
}

/// What only the person who measured knows.
io::Json questions(const modal::HitGuess& guess, double sample_rate_hz) {
  io::Json out = io::Json::array();
  const auto ask = [&out](const std::string& text) { out.push_back(printable(text)); };
  if (guess.with(Role::force).empty()) ask("Which column is the hammer's force?");
  if (guess.with(Role::response).empty()) ask("Which columns are the responses, and in which direction?");
  for (const modal::ColumnGuess& column : guess.columns) {
    if (column.role == Role::unknown) ask(fmt::format("What is column {}?", column.name));
    if (column.role == Role::response && column.axis == 0) ask(fmt::format("In which direction is {}?", column.name));
    if (column.volts != 0.0) ask(fmt::format("How many mV are a unit of {}?", column.name));
    const bool measured = column.role == Role::force || column.role == Role::response;
    if (measured && column.unit.empty()) ask(fmt::format("What is the unit of {}?", column.name));
  }
  if (guess.is_hit() && guess.direction_from.empty()) ask("In which direction was the hit?");
  if (!(sample_rate_hz > 0.0)) ask("What is the sample rate?");
  return out;
}

/// Of several files the columns of time are none to be asked about: "time" has them.
io::Json columns_of(const modal::HitGuess& guess, bool of_several_files) {
  io::Json columns = io::Json::array();
  for (const modal::ColumnGuess& column : guess.columns) {
    if (of_several_files && column.role == Role::time) continue;
    columns.push_back({{"name", printable(column.name)},
                       {"unit", io::text_or_null(printable(column.unit))},
                       {"guess", name_of(column.role)},
                       {"direction", column.axis == 0 ? io::Json(nullptr) : io::Json(std::string(1, column.axis))},
                       {"from", io::text_or_null(printable(column.from))}});
  }
  return columns;
}

/// Force and responses in files of their own.
std::optional<modal::FoundHit> set_of(const std::filesystem::path& path, const modal::HitGuess& guess) {
  return guess.is_hit() ? std::nullopt : modal::find_set_of(path);
}

}  // namespace

io::Json inspect(const std::filesystem::path& path) {
  static_cast<void>(io::open_file(path));
  const auto [kind, document] = kind_of_file(path);
  if (kind != "record" && document != "vibration") return {{"kind", kind}};
  const io::Record record = io::read_record(path);
  modal::HitGuess guess = modal::guess_hit(record);
  io::Json files = io::Json::array();
  std::string time;
  double sample_rate_hz = record.sample_rate_hz;
  if (std::optional<modal::FoundHit> set = set_of(path, guess)) {
    for (const std::string& file : set->files) files.push_back(printable(file));
    time = set->time;
    sample_rate_hz = set->sample_rate_hz;
    guess = std::move(set->guess);
  }
  return {{"kind", kind},
          {"columns", columns_of(guess, !files.empty())},
          {"rows", record.columns.empty() ? 0 : record.columns.front().size()},
          {"sample_rate_hz", io::positive(sample_rate_hz)},
          {"direction_guess", guess.direction_from.empty() ? io::Json(nullptr) : io::Json(guess.force_direction)},
          {"questions", questions(guess, sample_rate_hz)},
          {"files", files},
          {"time", io::text_or_null(printable(time))}};
}

}  // namespace robomill::serve
