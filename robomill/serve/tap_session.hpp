#pragma once
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "robomill/io/json.hpp"
#include "robomill/modal/hits.hpp"

// Method: robomill/serve/README.md, "Tap test"

namespace robomill::serve {

/// How the records of a tap test are read: the tables of hits.toml, whose rows are patterns for the files that appear.
class TapSettings {
 public:
  /// @throws InvalidInput if the text is no hits.toml: no row, or a key that is missing or wrong
  TapSettings(std::filesystem::path hits, const std::string& text);

  /// The hit of one record, by the row that names it; else by the first whose direction stands in its name as a word
  /// ("x" in "tap_x_3.csv"), or by the first of all.
  /// @throws InvalidInput as modal::read_hits
  [[nodiscard]] modal::Hit read(const std::filesystem::path& record, modal::HitOptions& options) const;
  /// Records that the rows name, resolved.
  [[nodiscard]] const std::vector<std::filesystem::path>& named() const { return named_; }
  /// Directions of the rows: "x", "-y".
  [[nodiscard]] std::size_t directions() const { return directions_; }

 private:
  [[nodiscard]] std::size_t row_of(const std::filesystem::path& record) const;
  std::filesystem::path path_;
  std::string acquisition_;                   ///< as TOML
  std::vector<std::string> rows_, pushes_;    ///< the keys of each row but its file, as TOML; its direction
  std::vector<std::filesystem::path> named_;  ///< one a row
  std::size_t directions_ = 0;
};

/// A tap test while it is made: records that appear in a folder become hits, accepted or rejected, and the FRFs of
/// those that were accepted build up.
class TapSession {
 public:
  struct Options {
    std::filesystem::path hits;   ///< hits.toml
    std::string text;             ///< what it holds
    std::string name;             ///< of it, for the client
    std::filesystem::path watch;  ///< the folder in which records appear
    int wanted = 0;               ///< good hits; 0: five a direction
  };
  /// @param changed  is given the state on every change; from another thread
  /// @throws InvalidInput as TapSettings, or if there is no such folder
  TapSession(const Options& options, std::function<void(const std::string&)> changed);
  ~TapSession();
  TapSession(const TapSession&) = delete;
  TapSession& operator=(const TapSession&) = delete;

  /// {"hits", "running", "good", "wanted", "taken", "frf", "peaks"}; of the FRFs at most some 1,600 lines, the highest
  /// and lowest among them.
  [[nodiscard]] std::string state() const;

 private:
  /// A record that was taken.
  struct Taken {
    std::string file = {}, direction = {};
    std::optional<modal::Hit> hit = {};     ///< none: it could not be read, or is of no use alone
    std::vector<std::string> reasons = {};  ///< why it was rejected
  };
  void watch(const std::stop_token& stop);
  [[nodiscard]] bool look();
  void take(const std::filesystem::path& record);
  void average();

  Options options_;
  TapSettings settings_;
  std::function<void(const std::string&)> changed_;
  struct Seen {
    std::uintmax_t bytes = 0;
    std::filesystem::file_time_type written = {};
    bool done = false;  ///< taken, or there before the test
    bool operator==(const Seen&) const = default;
  };
  std::map<std::string, Seen> seen_;  ///< of the watching thread alone, as taken_ and hit_options_
  std::vector<Taken> taken_;
  modal::HitOptions hit_options_;
  mutable std::mutex mutex_;
  std::string state_;
  std::mutex waiting_;
  std::condition_variable_any ended_;
  std::jthread thread_;
};

}  // namespace robomill::serve
