#pragma once
#include <cstddef>
#include <exception>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robomill/io/json.hpp"
#include "robomill/modal/hits.hpp"

// Method: robomill/serve/README.md, "Tap test"

namespace robomill::serve {

/// A hit that was taken.
struct TapHit {
  std::string name = {};                          ///< its file's, or "hit 3"
  std::string direction = {};                     ///< "-y"
  std::vector<std::filesystem::path> files = {};  ///< of its record; empty: out of a stream
  std::size_t number = 1, of = 1;                 ///< among the hits of that record
  std::string row = {};                         ///< its keys in hits.toml but the file, as TOML; empty: out of a stream
  std::shared_ptr<const modal::Hit> hit = {};   ///< none: it is of no use
  std::vector<std::string> reasons = {};        ///< why it was rejected
  bool excluded = false;                        ///< by hand
  double peak_force_n = 0.0;                    ///< 0: not known
  std::shared_ptr<const io::Json> curves = {};  ///< hit_curves; none: it could not be read
  [[nodiscard]] bool accepted() const { return hit != nullptr && reasons.empty() && !excluded; }
};

/// The hits of a test, and what those that were accepted add up to. Used by several threads; one alone adds and
/// averages.
class TapHits {
 public:
  static constexpr std::size_t most_hits = 200;
  static constexpr std::size_t most_values = std::size_t{1} << 25;  ///< of all samples that are kept

  /// @param root  does not appear in reasons
  TapHits(const modal::HitOptions& options, std::filesystem::path root) : options_(options), root_(std::move(root)) {}

  [[nodiscard]] std::size_t size() const;
  /// A hit as it was read: judges it by itself and keeps it, its samples where it is of use.
  void add(TapHit taken, const modal::Hit& hit);
  /// One that could not be read, and why.
  void add(TapHit taken, const std::string& reason);
  /// The FRFs of all that are accepted.
  void average();
  /// @param number  from 1. False where there is no such hit
  /// @throws InvalidInput if one that was rejected by itself is to be accepted
  [[nodiscard]] bool set_accepted(std::size_t number, bool accepted);

  /// {"good", "taken", "frf", "peaks"}; of the FRFs at most some 1,600 lines, the highest and lowest among them.
  [[nodiscard]] io::Json state() const;
  /// Of one: as in "taken", and its curves. Null: there is none
  [[nodiscard]] io::Json about(std::size_t number) const;
  /// The accepted ones, with their numbers in the order in which they came.
  [[nodiscard]] std::vector<std::pair<std::size_t, TapHit>> accepted() const;

 private:
  modal::HitOptions options_;
  std::filesystem::path root_;
  mutable std::mutex mutex_;
  std::vector<TapHit> taken_;
  std::size_t values_ = 0;
  io::Json frf_ = nullptr, peaks_ = io::Json::array();
};

/// Why a hit is rejected, for a client: rule and hint of an InvalidInput, without the way to root.
[[nodiscard]] std::string rejection_reason(const std::exception& error, const std::filesystem::path& root);

/// What a page draws of one hit: its force about the pulse and its responses, over the time from the force's peak, at
/// most some 400 points each with the highest and lowest among them; and the magnitudes of its own FRFs on at most 400
/// lines: {"force", "responses", "frf"}.
/// @param alone  its FRFs; none: it was rejected
[[nodiscard]] io::Json hit_curves(const modal::Hit& hit, const std::optional<modal::FrfResult>& alone);

}  // namespace robomill::serve
