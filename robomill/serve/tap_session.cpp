#include "robomill/serve/tap_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/printable.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/toml_edit.hpp"
#include "robomill/io/toml_source.hpp"
#include "robomill/io/toml_values.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/modal/files/hits_toml.hpp"
#include "robomill/page/thin.hpp"

namespace robomill::serve {
namespace {

namespace fs = std::filesystem;

constexpr int hits_per_direction = 5;
constexpr std::size_t most_hits = 200;
constexpr Eigen::Index most_lines = 1600;

bool is_record(const fs::path& path) {
  switch (io::format_of(path)) {
    case io::Format::csv:
    case io::Format::text:
    case io::Format::mat:
    case io::Format::uff:
    case io::Format::wav:
      return !path.filename().string().starts_with('.');
    default:
      return false;
  }
}

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
  return std::string(
      direction.substr(direction.find_last_of("xyz") == std::string_view::npos ? 0 : direction.find_last_of("xyz")));
}

std::string literal(const io::Json& value) {
  return value.is_string() ? io::toml_quoted(value.get<std::string>()) : value.dump();
}

modal::FrfSet thinned(const modal::FrfSet& set) {
  std::vector<Eigen::VectorXd> magnitudes;
  for (const modal::Frf& frf : set.frfs) magnitudes.emplace_back(frf.receptance.cwiseAbs());
  const std::vector<Eigen::Index> keep = page::thin_together(magnitudes, most_lines);
  modal::FrfSet out;
  out.frequency_hz = set.frequency_hz(keep);
  for (const modal::Frf& frf : set.frfs) {
    out.frfs.push_back({.name = frf.name, .receptance = frf.receptance(keep)});
    if (frf.coherence.size() > 0) out.frfs.back().coherence = frf.coherence(keep);
  }
  return out;
}

double coherence_at(const modal::FrfSet& set, const modal::FrfName& name, double frequency_hz) {
  const modal::Frf* const frf = set.find(name);
  if (frf == nullptr || frf->coherence.size() == 0) return std::numeric_limits<double>::quiet_NaN();
  Eigen::Index nearest = 0;
  (set.frequency_hz.array() - frequency_hz).abs().minCoeff(&nearest);
  return frf->coherence(nearest);
}

io::Json peaks_of(const modal::FrfResult& result) {
  io::Json out = io::Json::array();
  for (const modal::FrfGrade& grade : result.grades) {
    for (const modal::FrfPeak& peak : grade.peaks) {
      out.push_back({{"frequency_hz", io::number(peak.frequency_hz)},
                     {"name", to_string(grade.name)},
                     {"receptance_m_per_n", io::number(peak.receptance_m_per_n)},
                     {"coherence", io::number(coherence_at(result.set, grade.name, peak.frequency_hz))}});
    }
  }
  return out;
}

}  // namespace

TapSettings::TapSettings(fs::path hits, const std::string& text) : path_(std::move(hits)) {
  std::set<std::string> directions;
  for (const io::TomlValue& value : io::toml_values(text, path_.string())) {
    constexpr std::string_view table = "hits[";
    if (!value.key.starts_with(table)) {
      acquisition_ += fmt::format("{} = {}\n", value.key, literal(value.value));
      continue;
    }
    const std::size_t row = std::strtoul(value.key.c_str() + table.size(), nullptr, 10);
    if (rows_.size() <= row) {
      rows_.resize(row + 1);
      pushes_.resize(row + 1);
      named_.resize(row + 1);
    }
    const std::string key = value.key.substr(value.key.find("].") + 2);
    if (key == "file" && value.value.is_string()) {
      named_[row] = path_.parent_path() / value.value.get<std::string>();
      continue;
    }
    if (key == "force_direction" && value.value.is_string()) {
      pushes_[row] = value.value.get<std::string>();
      directions.insert(axis_of(pushes_[row]));
    }
    rows_[row] += fmt::format("{} = {}\n", key, literal(value.value));
  }
  if (rows_.empty()) {
    throw InvalidInput(path_.string(), "has no [[hits]]",
                       "Write one row a direction: its columns and force_direction serve the files that appear");
  }
  directions_ = directions.size();
}

std::size_t TapSettings::row_of(const fs::path& record) const {
  for (std::size_t i = 0; i < named_.size(); ++i) {
    if (named_[i].lexically_normal() == record.lexically_normal()) return i;
  }
  const std::string name = record.stem().string();
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (!pushes_[i].empty() && has_word(name, axis_of(pushes_[i]))) return i;
  }
  return 0;
}

modal::Hit TapSettings::read(const fs::path& record, modal::HitOptions& options) const {
  const std::string text =
      fmt::format("{}\n[[hits]]\nfile = {}\n{}", acquisition_, io::toml_quoted(record.string()), rows_[row_of(record)]);
  modal::HitsFile file = modal::read_hits(io::TomlSource(path_, text));
  options = file.options;
  return std::move(file.hits.front());
}

TapSession::TapSession(const Options& options, std::function<void(const std::string&)> changed)
    : options_(options), settings_(options.hits, options.text), changed_(std::move(changed)) {
  std::error_code error;
  if (!fs::is_directory(options_.watch, error)) {
    throw InvalidInput("watch", "there is no folder " + printable(options_.watch.filename().string()));
  }
  if (options_.wanted <= 0) options_.wanted = hits_per_direction * static_cast<int>(settings_.directions());
  for (const fs::directory_entry& entry : fs::directory_iterator(options_.watch, error)) {
    const bool named = std::ranges::find(settings_.named(), entry.path()) != settings_.named().end();
    if (is_record(entry.path()) && !named) seen_[entry.path().filename().string()] = {.done = true};
  }
  average();
  thread_ = std::jthread([this](const std::stop_token& stop) { watch(stop); });
}

TapSession::~TapSession() {
  thread_.request_stop();
  ended_.notify_all();
}

std::string TapSession::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

void TapSession::watch(const std::stop_token& stop) {
  constexpr std::chrono::milliseconds pause(250);
  while (!stop.stop_requested()) {
    if (look()) {
      average();
      changed_(state());
    }
    std::unique_lock lock(waiting_);
    ended_.wait_for(lock, stop, pause, [] { return false; });
  }
}

/// Takes what is new and no longer grows. True where there was something.
bool TapSession::look() {
  bool any = false;
  std::vector<fs::path> found = settings_.named();
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(options_.watch, error)) {
    if (is_record(entry.path())) found.push_back(entry.path());
  }
  std::ranges::sort(found);
  for (const fs::path& record : found) {
    if (taken_.size() >= most_hits) break;
    std::error_code missing;
    const Seen now = {.bytes = fs::file_size(record, missing), .written = fs::last_write_time(record, missing)};
    if (missing || now.bytes == 0) continue;
    const auto [known, first] = seen_.try_emplace(record.filename().string(), now);
    if (first || known->second.done) continue;
    if (known->second == now) {
      take(record);
      known->second.done = true;
      any = true;
    } else {
      known->second = now;  // it is still being written
    }
  }
  return any;
}

void TapSession::take(const fs::path& record) {
  Taken taken = {.file = record.filename().string()};
  try {
    taken.hit = settings_.read(record, hit_options_);
    taken.direction = (taken.hit->against_axis ? "-" : "") + to_string(taken.hit->excitation);
    if (!taken_.empty()) {
      const auto like = std::ranges::find_if(taken_, [](const Taken& other) { return other.hit.has_value(); });
      if (like != taken_.end() && like->hit->sample_rate_hz != taken.hit->sample_rate_hz) {
        throw InvalidInput(taken.file, "has another sample rate than the hits before");
      }
    }
    // Alone: what is wrong with it by itself is its own reason.
    const modal::FrfResult alone = modal::estimate_frfs({*taken.hit}, hit_options_);
    static_cast<void>(alone);
  } catch (const InvalidInput& error) {
    const InvalidInput::Parts& parts = error.parts();
    taken.reasons = {parts.rule + (parts.hint.empty() ? "" : ". " + parts.hint)};
    taken.hit.reset();
  }
  taken_.push_back(std::move(taken));
}

/// The FRFs of all that was accepted, and the state with them.
void TapSession::average() {
  std::vector<modal::Hit> hits;
  for (const Taken& taken : taken_) {
    if (taken.hit) hits.push_back(*taken.hit);
  }
  io::Json frf = nullptr;
  io::Json peaks = io::Json::array();
  if (!hits.empty()) {
    try {
      const modal::FrfResult result = modal::estimate_frfs(hits, hit_options_);
      std::size_t next = 0;
      for (Taken& taken : taken_) {
        if (taken.hit) taken.reasons = result.hits[next++].reasons;
      }
      frf = io::Json::parse(modal::frf_json(thinned(result.set)));
      peaks = peaks_of(result);
    } catch (const InvalidInput& error) {
      // The last does not go with the others: lengths, for one.
      const auto last =
          std::ranges::find_if(taken_.rbegin(), taken_.rend(), [](const Taken& t) { return t.hit.has_value(); });
      last->reasons = {error.what()};
      last->hit.reset();
      average();
      return;
    }
  }
  io::Json list = io::Json::array();
  int good = 0;
  for (const Taken& taken : taken_) {
    const bool accepted = taken.hit.has_value() && taken.reasons.empty();
    good += accepted ? 1 : 0;
    io::Json reasons = io::Json::array();
    for (const std::string& reason : taken.reasons) reasons.push_back(printable(reason));
    list.push_back({{"file", printable(taken.file)},
                    {"accepted", accepted},
                    {"reasons", std::move(reasons)},
                    {"force_direction", taken.direction}});
  }
  const io::Json state = {{"hits", options_.name},     {"running", true},          {"good", good},
                          {"wanted", options_.wanted}, {"taken", std::move(list)}, {"frf", std::move(frf)},
                          {"peaks", std::move(peaks)}};
  const std::lock_guard lock(mutex_);
  state_ = state.dump(-1, ' ', false, io::Json::error_handler_t::replace);
}

}  // namespace robomill::serve
