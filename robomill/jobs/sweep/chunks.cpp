#include "robomill/jobs/sweep/chunks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/jobs/files/study_toml.hpp"

namespace robomill::jobs {
namespace {

/// By the clock. A chunk is what a run that is killed loses at most.
constexpr double chunk_s = 60.0;
constexpr double most_chunk_points = 100'000;

}  // namespace

std::vector<PointOutcome> outcomes_of(const Evaluator& evaluator, const StudyPoints& points, std::uint64_t first,
                                      std::uint64_t count, Progress& progress) {
  std::vector<PointOutcome> out(count);
  parallel_for(out.size(), 1, [&](std::size_t from, std::size_t to) {
    const ThreadLimit alone(1);
    for (std::size_t i = from; i < to; ++i) {
      Progress inside([&progress](const std::string&, double) { progress.check(); }, nullptr);
      out[i] = evaluator.at(points.settings(first + i), inside);
      // Once more: what could not be read for a moment is no fault of the point.
      if (out[i].state == PointState::rejected) out[i] = evaluator.at(points.settings(first + i), inside);
      progress.advance();
    }
  });
  return out;
}

void require_unchanged(const Study& study, const std::string& fingerprint) {
  if (fingerprint_of(study) == fingerprint) return;
  throw InvalidInput(study.file.string(), "or a file that it names has changed while the study ran",
                     "The points that were just done are dropped");
}

double point_seconds(const StudyPoints& points, const Evaluator& evaluator, Progress& progress, PointOutcome& outcome) {
  const auto begin = std::chrono::steady_clock::now();
  outcome = evaluator.at(points.settings(points.size() / 2), progress);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

std::uint64_t fitting_chunk_points(const Study& study, const StudyPoints& points, const Evaluator& evaluator,
                                   Progress& progress) {
  if (study.chunk_points > 0) return static_cast<std::uint64_t>(study.chunk_points);
  PointOutcome ignored;
  const double count = chunk_s * study.slurm.cpus / std::max(point_seconds(points, evaluator, progress, ignored), 1e-6);
  return static_cast<std::uint64_t>(std::clamp(count, 1.0, most_chunk_points));
}

std::uint64_t most_points_of(const Study& study, const StudyPoints& points) {
  return study.boundary ? static_cast<std::uint64_t>(study.boundary->most_points) : points.size();
}

SweepPlan plan_of(const Study& study, const StudyPoints& points) {
  return {.fingerprint = fingerprint_of(study),
          .points = most_points_of(study, points),
          .keys = points.keys(),
          .collect = study.collect};
}

void require_known_points(const Study& study, const char* asked) {
  if (!study.boundary) return;
  throw InvalidInput(asked, "is not for a study with [boundary]",
                     "Which points are next depends on those before. One run does a step on all threads");
}

struct StudyChunks::Parts {
  explicit Parts(const std::filesystem::path& file)
      : study(read_study(file)), points(study), evaluator(study), fingerprint(fingerprint_of(study)) {
    require_known_points(study, "client");
  }
  Study study;
  StudyPoints points;
  Evaluator evaluator;
  std::string fingerprint;
};

StudyChunks::StudyChunks(const std::filesystem::path& study) : parts_(std::make_unique<Parts>(study)) {}
StudyChunks::~StudyChunks() = default;

const std::string& StudyChunks::fingerprint() const {
  return parts_->fingerprint;
}

std::string StudyChunks::bytes_of(std::uint64_t chunk, std::uint64_t chunk_points, Progress& progress) const {
  const SweepPlan plan{.points = parts_->points.size(), .chunk_points = std::max<std::uint64_t>(chunk_points, 1)};
  if (chunk >= plan.chunks()) throw InvalidInput("chunk", static_cast<double>(chunk), "", "is none of the study");
  const ThreadLimit alone(1);
  const std::vector<PointOutcome> outcomes =
      outcomes_of(parts_->evaluator, parts_->points, plan.first_of(chunk), plan.size_of(chunk), progress);
  require_unchanged(parts_->study, parts_->fingerprint);
  return chunk_bytes({.fingerprint = parts_->fingerprint,
                      .processor = this_processor(),
                      .first = plan.first_of(chunk),
                      .points = outcomes});
}

struct StudyFolder::Parts {
  explicit Parts(std::filesystem::path path) : folder(std::move(path)) {}
  SweepFolder folder;
  SweepPlan plan = {};
  std::optional<SweepFolder::Locks> locks = {};
  std::vector<std::uint64_t> todo = {};
};

StudyFolder::StudyFolder(const std::filesystem::path& study, const std::filesystem::path& folder)
    : parts_(std::make_unique<Parts>(folder)) {
  const Study read = read_study(study);
  require_known_points(read, "client");
  const StudyPoints points(read);
  const Evaluator evaluator(read);
  parts_->plan = parts_->folder.begin(plan_of(read, points),
                                      [&] { return fitting_chunk_points(read, points, evaluator, Progress::none()); });
  parts_->locks = parts_->folder.lock(1, 1);
  Chunk there;
  for (std::uint64_t i = 0; i < parts_->plan.chunks(); ++i) {
    if (parts_->folder.find(parts_->plan, i, there) != SweepFolder::Found::there) parts_->todo.push_back(i);
  }
}
StudyFolder::~StudyFolder() = default;

const std::string& StudyFolder::fingerprint() const {
  return parts_->plan.fingerprint;
}
std::uint64_t StudyFolder::chunk_points() const {
  return parts_->plan.chunk_points;
}
const std::vector<std::uint64_t>& StudyFolder::todo() const {
  return parts_->todo;
}

void StudyFolder::save(std::uint64_t chunk, const std::string& bytes) {
  if (!parts_->locks) throw InvalidInput("folder", "is closed");
  if (chunk >= parts_->plan.chunks())
    throw InvalidInput("chunk", static_cast<double>(chunk), "", "is none of the study");
  parts_->folder.save_bytes(parts_->plan, chunk, bytes);
}

void StudyFolder::close() {
  parts_->locks.reset();
}

}  // namespace robomill::jobs
