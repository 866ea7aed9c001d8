#pragma once
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "robomill/io/schema.hpp"
#include "robomill/io/system/file_lock.hpp"
#include "robomill/jobs/sweep/chunk.hpp"

// Method: robomill/jobs/README.md, "Studies (`sweep.hpp`)"

namespace robomill::jobs {

/// study.json: how a study is parted.
struct SweepPlan {
  std::string fingerprint = {};  ///< of the study (fingerprint_of)
  std::uint64_t points = 0, chunk_points = 0;
  std::vector<std::string> keys = {}, collect = {};
  std::uint64_t first_point = 0, first_chunk = 0;  ///< where points are known in parts, of which this is one

  [[nodiscard]] std::uint64_t chunks() const { return (points + chunk_points - 1) / chunk_points; }
  /// Of the study's points.
  [[nodiscard]] std::uint64_t first_of(std::uint64_t chunk) const { return first_point + chunk * chunk_points; }
  [[nodiscard]] std::uint64_t size_of(std::uint64_t chunk) const {
    return std::min(chunk_points, points - chunk * chunk_points);
  }
};

[[nodiscard]] const io::Schema<SweepPlan>& sweep_plan_table();

/// Of the machine: "Intel(R) Xeon(R) …"; empty where it does not say.
[[nodiscard]] std::string this_processor();

/// A study's folder: study.json, and a file a chunk that is done, each whole or absent.
class SweepFolder {
 public:
  explicit SweepFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// The plan that stands there; else this one, with as many points in a chunk as are asked for then. Of processes that
  /// begin at the same time one writes it.
  /// @throws InvalidInput if the folder is of another study, or cannot be written
  [[nodiscard]] SweepPlan begin(SweepPlan plan, const std::function<std::uint64_t()>& chunk_points) const;
  /// @throws InvalidInput if there is none
  [[nodiscard]] SweepPlan plan() const;
  /// @throws InvalidInput if the plan that stands there is not of this study, or is damaged
  void require_same(const SweepPlan& there, const SweepPlan& asked) const;

  /// While a run lives: of the chunks i, i + n, … alone where it is the i-th of n; of all where n is 1.
  struct Locks {
    std::optional<io::FileLock> all = {}, own = {};
  };
  /// Says in the run's lock how far it is: points that it did, and the seconds of one thread that they took.
  static void note(const Locks& locks, std::uint64_t points, double thread_s, int threads);
  /// What the notes of all runs say; `threads` and `running` of those whose locks are held now.
  struct Work {
    double points = 0.0, thread_s = 0.0;
    int threads = 0;
    std::vector<std::string> running = {};  ///< "3/16"; of all chunks "1/1"
  };
  [[nodiscard]] Work work() const;
  /// @param shard  from 1. @throws InvalidInput where another run has some of these chunks
  [[nodiscard]] Locks lock(int shard, int shards) const;

  enum class Found {
    missing,
    damaged,  ///< or of another study
    there
  };
  /// @throws InvalidInput if it is there and cannot be read
  [[nodiscard]] Found find(const SweepPlan& plan, std::uint64_t chunk, Chunk& out) const;
  void save(const SweepPlan& plan, std::uint64_t chunk, const std::vector<PointOutcome>& points) const;
  /// @param bytes  of the chunk's file. @throws InvalidInput if they are not, or cannot be written
  void save_bytes(const SweepPlan& plan, std::uint64_t chunk, const std::string& bytes) const;

  [[nodiscard]] std::filesystem::path at(const std::string& name) const { return folder_ / name; }

 private:
  [[nodiscard]] std::filesystem::path file_of(const SweepPlan& plan, std::uint64_t chunk) const;
  std::filesystem::path folder_;
};

}  // namespace robomill::jobs
