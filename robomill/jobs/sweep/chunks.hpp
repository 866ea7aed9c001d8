#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/jobs/files/sweep_folder.hpp"
#include "robomill/jobs/sweep/evaluate.hpp"
#include "robomill/jobs/sweep/study.hpp"

// Method: robomill/jobs/README.md, "Clusters"

namespace robomill::jobs {

/// What becomes of points that follow each other, by all threads. @throws Interrupted
[[nodiscard]] std::vector<PointOutcome> outcomes_of(const Evaluator& evaluator, const StudyPoints& points,
                                                    std::uint64_t first, std::uint64_t count, Progress& progress);
/// Points are computed from the files as they stood when the study began. @throws InvalidInput if they changed since
void require_unchanged(const Study& study, const std::string& fingerprint);
/// Does the point in the middle, since those at the edges may be out of range. @returns what it took [s]
double point_seconds(const StudyPoints& points, const Evaluator& evaluator, Progress& progress, PointOutcome& outcome);
/// The points of a chunk: as the study says, or as many as take a minute.
[[nodiscard]] std::uint64_t fitting_chunk_points(const Study& study, const StudyPoints& points,
                                                 const Evaluator& evaluator, Progress& progress);
/// All points; of a boundary those that it may ask for.
[[nodiscard]] std::uint64_t most_points_of(const Study& study, const StudyPoints& points);
/// Of a study; how many points a chunk has is left open.
[[nodiscard]] SweepPlan plan_of(const Study& study, const StudyPoints& points);

/// @throws InvalidInput naming what was asked for if the points of a study follow from values of others
void require_known_points(const Study& study, const char* asked);

/// A study by its chunks, for whoever hands them out to processes of his own: here they are done.
class ROBOMILL_API StudyChunks {
 public:
  /// @throws InvalidInput with file, line, key and value
  explicit StudyChunks(const std::filesystem::path& study);
  ~StudyChunks();
  StudyChunks(const StudyChunks&) = delete;
  StudyChunks& operator=(const StudyChunks&) = delete;

  /// Of the study, its documents and the version.
  [[nodiscard]] const std::string& fingerprint() const;
  /// Does a chunk, on this thread. Of any thread. @returns the bytes of its file
  /// @throws InvalidInput if there is no such chunk, or a point cannot be done
  [[nodiscard]] std::string bytes_of(std::uint64_t chunk, std::uint64_t chunk_points, Progress& progress) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// And here they are kept: the folder, locked against other runs.
class ROBOMILL_API StudyFolder {
 public:
  /// Makes the folder, or goes on in it. @throws InvalidInput as run_sweep
  StudyFolder(const std::filesystem::path& study, const std::filesystem::path& folder);
  ~StudyFolder();
  StudyFolder(const StudyFolder&) = delete;
  StudyFolder& operator=(const StudyFolder&) = delete;

  [[nodiscard]] const std::string& fingerprint() const;
  [[nodiscard]] std::uint64_t chunk_points() const;
  /// The chunks that were missing at first.
  [[nodiscard]] const std::vector<std::uint64_t>& todo() const;
  /// @param bytes  of StudyChunks::bytes_of. @throws InvalidInput if they are not those of this chunk, or cannot be
  /// written
  void save(std::uint64_t chunk, const std::string& bytes);
  /// Unlocks it.
  void close();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace robomill::jobs
