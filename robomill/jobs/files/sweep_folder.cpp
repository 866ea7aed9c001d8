#include "robomill/jobs/files/sweep_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/json.hpp"
#include "robomill/io/system/output_places.hpp"
#include "robomill/io/text.hpp"

namespace robomill::jobs {
namespace {

constexpr const char* plan_name = "study.json";

SweepPlan read_plan(const std::filesystem::path& path) {
  const io::ReadBack own(path.parent_path());
  const io::Json json = io::read_json(path);
  const io::JsonNode root(json, path.string());
  const auto texts = [&](const char* name) {
    const io::JsonNode list = root.at(name);
    std::vector<std::string> out;
    for (std::size_t i = 0; i < list.size(); ++i) out.push_back(list.at(i).text());
    return out;
  };
  const auto count = [&](const char* name) {
    const double number = root.at(name).number();
    if (!(number >= 1.0 && number <= 1e9)) throw root.at(name).reject("must be a count");
    return static_cast<std::uint64_t>(number);
  };
  return {.fingerprint = root.at("fingerprint").text(),
          .points = count("points"),
          .chunk_points = count("chunk_points"),
          .keys = texts("keys"),
          .collect = texts("collect")};
}

bool is_chunk_of(const SweepPlan& plan, std::uint64_t chunk, const Chunk& read) {
  return read.fingerprint == plan.fingerprint && read.first == plan.first_of(chunk) &&
         read.points.size() == plan.size_of(chunk) && read.points.front().values.size() == plan.collect.size();
}

constexpr std::string_view run_lock = ".run.lock", shard_begin = ".shard-", shard_middle = "-of-", shard_end = ".lock";

std::string shard_lock(int shard, int shards) {
  return fmt::format("{}{}{}{}{}", shard_begin, shard, shard_middle, shards, shard_end);
}

/// "3/16" of the lock of a shard, "1/1" of that of all; empty: no such file.
std::string shard_of(std::string_view name) {
  if (name == run_lock) return "1/1";
  const std::size_t middle = name.find(shard_middle);
  if (!name.starts_with(shard_begin) || !name.ends_with(shard_end) || middle == std::string_view::npos) return {};
  const std::size_t second = middle + shard_middle.size();
  return fmt::format("{}/{}", name.substr(shard_begin.size(), middle - shard_begin.size()),
                     name.substr(second, name.size() - shard_end.size() - second));
}

/// Whoever looks at a lock holds it for a moment.
std::optional<io::FileLock> patiently(const std::filesystem::path& path, io::FileLock::Kind kind) {
  std::optional<io::FileLock> out = io::FileLock::try_take(path, kind);
  for (int i = 0; i < 3 && !out; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    out = io::FileLock::try_take(path, kind);
  }
  return out;
}

}  // namespace

const io::Schema<SweepPlan>& sweep_plan_table() {
  static const io::Schema<SweepPlan> table(
      "study", "how a study is parted into chunks",
      {io::key("fingerprint", &SweepPlan::fingerprint,
               "of the study, the documents and files that it names, and the version: another one is another study"),
       io::key("points", &SweepPlan::points, "of the study; of a boundary at most so many"),
       io::key("chunk_points", &SweepPlan::chunk_points, "points of a chunk; the last may have fewer"),
       io::key("keys", &SweepPlan::keys, "that vary"),
       io::key("collect", &SweepPlan::collect, "what is kept of each point")},
      io::Use::written, 1);
  return table;
}

std::string this_processor() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("model name")) continue;
    return std::string(io::trimmed(std::string_view(line).substr(std::min(line.find(':') + 1, line.size()))));
  }
  return {};
}

SweepPlan SweepFolder::begin(SweepPlan plan, const std::function<std::uint64_t()>& chunk_points) const {
  io::make_folder(folder_ / "chunks");
  const io::FileLock lock = io::FileLock::take(at(".plan.lock"), io::FileLock::Kind::exclusive);
  const std::filesystem::path path = at(plan_name);
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) {
    plan.chunk_points = std::clamp<std::uint64_t>(chunk_points(), 1, plan.points);
    io::write_file(path, io::dump(sweep_plan_table().write(plan)));
    return plan;
  }
  SweepPlan there = read_plan(path);
  require_same(there, plan);
  return there;
}

void SweepFolder::require_same(const SweepPlan& there, const SweepPlan& asked) const {
  if (there.fingerprint != asked.fingerprint) {
    throw InvalidInput(
        folder_.string(), "is of another study",
        "The study, a document or a file that it names, or robomill has changed since; give another folder");
  }
  if (there.points != asked.points || there.keys != asked.keys || there.collect != asked.collect) {
    throw InvalidInput(at(plan_name).string(), "does not fit its study", "It was changed, or damaged");
  }
}

SweepPlan SweepFolder::plan() const {
  std::error_code ignored;
  if (!std::filesystem::exists(at(plan_name), ignored)) {
    throw InvalidInput(folder_.string(), "has no study.json", "No run of a study has begun there");
  }
  return read_plan(at(plan_name));
}

void SweepFolder::note(const Locks& locks, std::uint64_t points, double thread_s, int threads) {
  const io::FileLock& lock = locks.own ? *locks.own : *locks.all;
  lock.note(fmt::format("{} {} {}\n", points, thread_s, threads));
}

SweepFolder::Work SweepFolder::work() const {
  Work out;
  const io::ReadBack own(folder_);
  std::error_code error;
  for (const std::filesystem::directory_entry& entry : std::filesystem::directory_iterator(folder_, error)) {
    const std::string shard = shard_of(entry.path().filename().string());
    if (shard.empty()) continue;
    std::ifstream in = io::open_file(entry.path());
    double points = 0.0, thread_s = 0.0;
    int threads = 0;
    if (in >> points >> thread_s >> threads && points > 0.0 && thread_s > 0.0) {
      out.points += points;
      out.thread_s += thread_s;
    }
    if (io::FileLock::try_take(entry.path(), io::FileLock::Kind::shared)) continue;
    out.threads += std::max(threads, 1);
    out.running.push_back(shard);
  }
  std::ranges::sort(out.running);
  return out;
}

SweepFolder::Locks SweepFolder::lock(int shard, int shards) const {
  using Kind = io::FileLock::Kind;
  Locks out;
  out.all = patiently(at(std::string(run_lock)), shards == 1 ? Kind::exclusive : Kind::shared);
  if (out.all && shards > 1) {
    out.own = patiently(at(shard_lock(shard, shards)), Kind::exclusive);
  }
  if (!out.all || (shards > 1 && !out.own)) {
    throw InvalidInput(folder_.string(), "is being worked on by another run",
                       "robomill sweep STUDY -o FOLDER --status shows how far it is");
  }
  return out;
}

std::filesystem::path SweepFolder::file_of(const SweepPlan& plan, std::uint64_t chunk) const {
  return folder_ / "chunks" / fmt::format("{:07}.chunk", plan.first_chunk + chunk);
}

SweepFolder::Found SweepFolder::find(const SweepPlan& plan, std::uint64_t chunk, Chunk& out) const {
  const std::filesystem::path path = file_of(plan, chunk);
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return Found::missing;
  const io::ReadBack own(folder_);
  if (std::filesystem::file_size(path, ignored) == 0) return Found::damaged;
  std::optional<Chunk> read = read_chunk(io::read_file(path));
  if (!read || !is_chunk_of(plan, chunk, *read)) return Found::damaged;
  out = *std::move(read);
  return Found::there;
}

void SweepFolder::save_bytes(const SweepPlan& plan, std::uint64_t chunk, const std::string& bytes) const {
  const std::optional<Chunk> read = read_chunk(bytes);
  if (!read || !is_chunk_of(plan, chunk, *read)) {
    throw InvalidInput(folder_.string(), fmt::format("gets bytes for chunk {} that are not those of it", chunk));
  }
  io::write_file(file_of(plan, chunk), bytes);
}

void SweepFolder::save(const SweepPlan& plan, std::uint64_t chunk, const std::vector<PointOutcome>& points) const {
  io::write_file(file_of(plan, chunk), chunk_bytes({.fingerprint = plan.fingerprint,
                                                    .processor = this_processor(),
                                                    .first = plan.first_of(chunk),
                                                    .points = points}));
}

}  // namespace robomill::jobs
