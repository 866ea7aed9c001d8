#include "robomill/modal/files/hit_guess.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>
#include <string_view>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/si.hpp"
#include "robomill/io/text.hpp"
#include "robomill/modal/impact/hit_split.hpp"

namespace robomill::modal {
namespace {

using Role = ColumnGuess::Role;

/// A record's rise is looked at in so many samples at most.
constexpr Eigen::Index looked_at = 4096;

bool any_begins(const std::vector<std::string>& words, std::initializer_list<std::string_view> beginnings) {
  return std::ranges::any_of(words, [&](const std::string& word) {
    return std::ranges::any_of(beginnings, [&](std::string_view begin) { return word.starts_with(begin); });
  });
}

void apply_unit(ColumnGuess& column) {
  column.volts = io::volts_in(column.unit);
  if (const double s = io::seconds_in(column.unit); s > 0.0) {
    column.role = Role::time;
    column.from = "its unit";
    column.si_per_unit = s;
  }
  const io::SiFactor si = io::parse_unit(column.unit);
  if (si.is_ratio || si.quantity == io::Quantity::unknown || column.unit.find("rad") != std::string::npos) return;
  column.role = si.quantity == io::Quantity::force ? Role::force : Role::response;
  column.from = "its unit";
  column.si_per_unit = si.factor;
  if (si.quantity == io::Quantity::velocity) column.kind = ResponseKind::velocity;
  if (si.quantity == io::Quantity::displacement) column.kind = ResponseKind::displacement;
}

/// 'x' of "x", "x1", "ax", "fx2", "accx", "force_x".
char axis_of(const std::vector<std::string>& words) {
  for (std::string word : words) {
    while (!word.empty() && std::isdigit(static_cast<unsigned char>(word.back())) != 0) word.pop_back();
    if (word.empty() || std::string_view("xyz").find(word.back()) == std::string_view::npos) continue;
    const char axis = word.back();
    word.pop_back();
    for (const char* before :
         {"", "a", "f", "v", "d", "u", "acc", "accel", "force", "vel", "disp", "hit", "tap", "ch"}) {
      if (word == before) return axis;
    }
  }
  return 0;
}

bool rises_evenly(const Eigen::VectorXd& column) {
  try {
    return io::sample_rate_of(column.head(std::min(looked_at, column.size())), {}) > 0.0;
  } catch (const InvalidInput&) {
    return false;
  }
}

/// Whether a column only rises, as a time does that may be rounded, and no signal.
bool never_falls(const Eigen::VectorXd& column) {
  constexpr double least_share = 0.05;  // of steps that rise
  const Eigen::Index n = column.size();
  if (n < 10) return false;
  const Eigen::ArrayXd steps = column.tail(n - 1) - column.head(n - 1);
  return steps.minCoeff() >= 0.0 && static_cast<double>((steps > 0.0).count()) >= least_share * static_cast<double>(n);
}

/// Whether it counts samples: 0, 1, 2.
bool counts(const Eigen::VectorXd& column) {
  const Eigen::Index n = column.size();
  return n > 1 && ((column.tail(n - 1) - column.head(n - 1)).array() == 1.0).all();
}

/// What only rises is no signal, whatever its name seems to say: the first such column is the time, unless it counts.
void find_times(const io::Record& record, HitGuess& guess) {
  for (std::size_t i = 0; i < guess.columns.size(); ++i) {
    ColumnGuess& column = guess.columns[i];
    if (column.role == Role::time || column.role == Role::force || !never_falls(record.columns[i])) continue;
    column.role = Role::other;
    column.from.clear();
    column.axis = 0;
    if (!guess.with(Role::time).empty() || counts(record.columns[i])) continue;
    column.role = Role::time;
    column.from = "its even rise";
    column.si_per_unit = 1.0;
  }
}

/// Highest magnitude over rms; 0 of a column of zeros.
double crest(const Eigen::VectorXd& column) {
  const double rms = std::sqrt(column.squaredNorm() / static_cast<double>(std::max<Eigen::Index>(column.size(), 1)));
  return rms > 0.0 ? column.cwiseAbs().maxCoeff() / rms : 0.0;
}

/// Whether a force is that of a hammer: one short pulse, perhaps with bounces. A cut pushes once a tooth, a load stays.
bool is_pulse(const Eigen::Ref<const Eigen::VectorXd>& force) {
  constexpr double most_share = 0.1;  // of samples above half the peak: 4 ms of a soft tip within 50 ms are 5 %
  constexpr int most_pulses = 3;
  const auto count = static_cast<std::size_t>(force.size());
  if (count == 0) return false;
  std::vector<double> sorted(force.begin(), force.end());
  std::ranges::nth_element(sorted, sorted.begin() + static_cast<std::ptrdiff_t>(count / 2));
  const double offset = sorted[count / 2];
  const double peak = (force.array() - offset).abs().maxCoeff();
  if (!(peak > 0.0)) return false;
  std::size_t above = 0;
  int pulses = 0;
  bool within = false;  // a pulse, until the force is well below its half
  for (const double value : force) {
    const double share = std::abs(value - offset) / peak;
    if (share > 0.5) {
      ++above;
      if (!within) ++pulses;
      within = true;
    } else if (share < 0.25) {
      within = false;
    }
  }
  return pulses <= most_pulses && static_cast<double>(above) <= most_share * static_cast<double>(count);
}

/// How many hits a force is of; 0: it is no hammer's.
int hits_in(const Eigen::VectorXd& force, double sample_rate_hz) {
  const std::vector<HitSegment> segments =
      sample_rate_hz > 0.0 ? find_hit_segments(force, sample_rate_hz) : std::vector<HitSegment>();
  if (segments.empty()) return is_pulse(force) ? 1 : 0;
  const bool are_pulses = std::ranges::all_of(segments, [&](const HitSegment& segment) {
    return is_pulse(force.segment(segment.begin, segment.end - segment.begin));
  });
  return are_pulses ? static_cast<int>(segments.size()) : 0;
}

/// A force that was found by its name may be that of a cut.
void drop_other_forces(const io::Record& record, HitGuess& guess) {
  for (const std::size_t i : guess.with(Role::force)) {
    if (const int hits = hits_in(record.columns[i], guess.sample_rate_hz); hits > 0) {
      guess.hits = hits;
      continue;
    }
    guess.columns[i].role = Role::unknown;
    guess.columns[i].from.clear();
  }
}

/// By the column of time, rounded or not, else as the record says it.
void find_rate(const io::Record& record, HitGuess& guess) {
  guess.sample_rate_hz = record.sample_rate_hz;
  const std::vector<std::size_t> times = guess.with(Role::time);
  if (times.empty()) return;
  const Eigen::VectorXd& time = record.columns[times.front()];
  const double rounded_hz = io::rounded_sample_rate_of(time);
  guess.rounded_time = rounded_hz > 0.0;
  try {
    guess.sample_rate_hz =
        (guess.rounded_time ? rounded_hz : io::sample_rate_of(time, {})) / guess.columns[times.front()].si_per_unit;
  } catch (const InvalidInput&) {
    guess.sample_rate_hz = 0.0;  // who reads the record says what is wrong with its time
  }
}

/// Where names say nothing, what the signals look like.
void guess_by_signal(const io::Record& record, HitGuess& guess) {
  std::vector<ColumnGuess>& columns = guess.columns;
  if (guess.with(Role::time).empty()) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (columns[i].role != Role::unknown || !rises_evenly(record.columns[i])) continue;
      columns[i].role = Role::time;
      columns[i].from = "its even rise";
      break;
    }
  }
  const std::vector<std::size_t> unknown = guess.with(Role::unknown);
  const bool responds = !guess.with(Role::response).empty();
  if (guess.with(Role::force).empty()) {
    // Beside responses that are known, one alone that is not is the hammer's.
    const bool over_time = record.sample_rate_hz > 0.0 || !guess.with(Role::time).empty();
    if (unknown.empty() || (responds && (unknown.size() > 1 || !over_time))) return;
    const std::size_t sharpest =
        *std::ranges::max_element(unknown, {}, [&](std::size_t i) { return crest(record.columns[i]); });
    columns[sharpest].role = Role::force;
    columns[sharpest].from = "its sharp peak";
  }
  if (responds) return;
  for (const std::size_t i : guess.with(Role::unknown)) {
    columns[i].role = Role::response;
    columns[i].from = "what is left";
  }
}

/// One time, one force, responses of one kind and unit, each in a direction of its own.
void keep_one_of_each(HitGuess& guess) {
  std::set<Role> seen;
  std::set<char> axes;
  const ColumnGuess* first = nullptr;
  for (ColumnGuess& column : guess.columns) {
    bool keep = true;
    if (column.role == Role::time || column.role == Role::force) keep = seen.insert(column.role).second;
    if (column.role == Role::response) {
      if (first == nullptr) first = &column;
      const bool like_first =
          column.kind == first->kind && column.volts == first->volts && column.si_per_unit == first->si_per_unit;
      keep = like_first && (column.axis == 0 || axes.insert(column.axis).second);
    }
    if (!keep) column.role = Role::unknown;
    if (column.role == Role::unknown) column.from.clear();
  }
}

/// Responses whose names do not say it are in the hammer's direction, the further ones in what is left.
void complete_directions(const io::Record& record, HitGuess& guess) {
  const std::vector<std::size_t> forces = guess.with(Role::force);
  const char of_column = forces.empty() ? '\0' : guess.columns[forces.front()].axis;
  const char of_file = axis_of(words_in(record.file.stem().string()));
  if (of_column != 0) {
    guess.force_direction = of_column;
    guess.direction_from = "the column's name";
  } else if (of_file != 0) {
    guess.force_direction = of_file;
    guess.direction_from = "the file's name";
  }
  // Hit where the only sensor is, which says its direction.
  const std::vector<std::size_t> responses = guess.with(Role::response);
  if (guess.direction_from.empty() && responses.size() == 1 && guess.columns[responses.front()].axis != 0) {
    guess.force_direction = guess.columns[responses.front()].axis;
    guess.direction_from = "that of the only response";
  }
  std::string free = guess.force_direction + "xyz";
  for (const std::size_t i : guess.with(Role::response)) std::erase(free, guess.columns[i].axis);
  for (const std::size_t i : guess.with(Role::response)) {
    ColumnGuess& column = guess.columns[i];
    if (column.axis != 0) continue;
    if (free.empty()) {
      column.role = Role::unknown;
      continue;
    }
    column.axis = free.front();
    std::erase(free, column.axis);
  }
}

}  // namespace

std::vector<std::string> words_in(std::string_view text) {
  std::vector<std::string> words(1);
  for (const char letter : io::lowered(text)) {
    const auto byte = static_cast<unsigned char>(letter);
    if (std::isalnum(byte) != 0 || byte >= 0x80) {
      words.back() += letter;
    } else if (!words.back().empty()) {
      words.emplace_back();
    }
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

bool states_unit(const ColumnGuess& column) {
  return !column.unit.empty() && column.unit != "-";
}

ColumnGuess guess_by_name(const io::Record& record, std::size_t place) {
  const std::string name = place < record.names.size() ? record.names[place] : std::string();
  ColumnGuess out;
  out.name = name.empty() ? std::to_string(place + 1) : name;
  out.unit = record.unit(place);
  apply_unit(out);
  const std::vector<std::string> words = words_in(name);
  out.axis = axis_of(words);
  out.axis_said = out.axis != 0;
  const auto is = [&](Role role) {
    out.role = role;
    out.from = "its name";
  };
  if (io::is_time_column(name) || any_begins(words, {"time", "zeit"})) {
    is(Role::time);
  } else if (any_begins(words, {"force", "hammer", "kraft", "impact"}) ||
             (!words.empty() && (words[0] == "f" || words[0] == "fx" || words[0] == "fy" || words[0] == "fz"))) {
    is(Role::force);
  } else if (out.role == Role::unknown &&
             (out.axis != 0 || any_begins(words, {"acc", "resp", "beschl", "antwort", "vel", "disp", "sensor"}))) {
    is(Role::response);
    if (any_begins(words, {"vel"})) out.kind = ResponseKind::velocity;
    if (any_begins(words, {"disp"})) out.kind = ResponseKind::displacement;
  }
  return out;
}

std::vector<std::size_t> HitGuess::with(ColumnGuess::Role role) const {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i].role == role) out.push_back(i);
  }
  return out;
}

bool HitGuess::is_hit() const {
  return !with(Role::force).empty() && !with(Role::response).empty();
}

HitGuess guess_hit(const io::Record& record) {
  HitGuess guess;
  for (std::size_t i = 0; i < record.columns.size(); ++i) {
    const std::string name = i < record.names.size() ? record.names[i] : std::string();
    // Of columns of one name only the number tells which.
    const bool twice = !name.empty() && std::ranges::count(record.names, name) > 1;
    guess.columns.push_back(guess_by_name(record, i));
    if (twice) guess.columns.back().name = std::to_string(i + 1);
  }
  // Lines over frequency are no record of time.
  if (std::ranges::any_of(record.names, [](const std::string& n) { return any_begins(words_in(n), {"freq", "hz"}); })) {
    for (ColumnGuess& column : guess.columns) column.role = Role::unknown;
    return guess;
  }
  find_times(record, guess);
  guess_by_signal(record, guess);
  find_rate(record, guess);
  drop_other_forces(record, guess);
  keep_one_of_each(guess);
  complete_directions(record, guess);
  return guess;
}

}  // namespace robomill::modal
