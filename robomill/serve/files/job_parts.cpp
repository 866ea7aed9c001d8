#include "robomill/serve/files/job_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <memory>
#include <string_view>
#include <system_error>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/coupling/files/assembly_toml.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/system/confinement.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/io/toml/lines.hpp"
#include "robomill/io/toml/samples.hpp"
#include "robomill/io/toml/values.hpp"
#include "robomill/jobs/files/job_toml.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"
#include "robomill/jobs/files/named_files.hpp"
#include "robomill/modal/files/hits_toml.hpp"
#include "robomill/modal/files/modes_files.hpp"
#include "robomill/monitor/files/monitor_toml.hpp"
#include "robomill/process/files/forces_toml.hpp"

namespace robomill::serve {
namespace {

namespace fs = std::filesystem;

/// The file of an error's place, "lobes.toml:14".
fs::path file_of(const InvalidInput& error) {
  std::string where = error.parts().where;
  const std::size_t colon = where.rfind(':');
  const auto is_digit = [](unsigned char letter) { return std::isdigit(letter) != 0; };
  if (colon != std::string::npos &&
      std::all_of(where.begin() + static_cast<std::ptrdiff_t>(colon) + 1, where.end(), is_digit)) {
    where.resize(colon);
  }
  return fs::path(where).lexically_normal();
}

/// The part that a key belongs to. The first that begins it counts.
struct KeyOfPart {
  std::string_view begins;
  JobPart JobParts::*part;
};
constexpr std::array<KeyOfPart, 29> keys_of_parts = {{{"job.hits", &JobParts::hits},
                                                      {"job.frf", &JobParts::frfs},
                                                      {"job.assembly", &JobParts::frfs},
                                                      {"job.joint", &JobParts::frfs},
                                                      {"job.measured", &JobParts::frfs},
                                                      {"job.modes", &JobParts::modes},
                                                      {"job.band_hz", &JobParts::modes},
                                                      {"job.fit_modes", &JobParts::modes},
                                                      {"job.equal_directions", &JobParts::modes},
                                                      {"job.rigid_directions", &JobParts::modes},
                                                      {"dynamics", &JobParts::modes},
                                                      {"job.lobes", &JobParts::cut},
                                                      {"tool", &JobParts::cut},
                                                      {"cut.", &JobParts::cut},
                                                      {"coefficients", &JobParts::cut},
                                                      {"lobes", &JobParts::cut},
                                                      {"job.cell", &JobParts::robot},
                                                      {"robot", &JobParts::robot},
                                                      {"workpiece.", &JobParts::robot},
                                                      {"geometry", &JobParts::robot},
                                                      {"smoothing", &JobParts::robot},
                                                      {"job.forces", &JobParts::program},
                                                      {"job.program", &JobParts::program},
                                                      {"stock", &JobParts::program},
                                                      {"spindle", &JobParts::limits},
                                                      {"safety", &JobParts::limits},
                                                      {"finishing", &JobParts::limits},
                                                      {"decide", &JobParts::limits},
                                                      {"cuts", &JobParts::limits}}};

/// Null of a key that belongs to no part.
JobPart JobParts::*part_of_key(std::string_view key) {
  const auto* const found =
      std::ranges::find_if(keys_of_parts, [&](const KeyOfPart& one) { return key.starts_with(one.begins); });
  return found == keys_of_parts.end() ? nullptr : found->part;
}

/// Values of a document that nobody has confirmed.
/// @param samples  what was assumed by its reader, sample values among it
/// @param guessed  whether comments mark guesses, as `robomill init` writes them about records
std::vector<Guess> guesses_of(const fs::path& file, const std::vector<Assumption>& samples, bool guessed = false) {
  std::vector<Guess> out;
  const auto is_sample = [&](const std::string& key) {
    return std::ranges::any_of(samples, [&](const Assumption& one) {
      return one.what == io::sample_left && one.key == key && one.file == file.filename().string();
    });
  };
  for (const io::TomlValue& value : io::toml_values(io::read_file(file, jobs::longest_document), file.string())) {
    const std::string key = io::shown_key(value.key);
    if (is_sample(key) || (guessed && value.comment.find("guessed from") != std::string::npos)) {
      out.push_back({.key = key, .line = value.line});
    }
  }
  return out;
}

std::string cut_text(const jobs::LobesFile& cut) {
  const cutting::Milling& milling = cut.problem.milling;
  const double diameter_mm = milling.tool.diameter_m / units::mm;
  if (cut.drilling) return fmt::format("drill of {:.4g} mm, {} lips", diameter_mm, milling.tool.teeth);
  return fmt::format("{} teeth, {:.4g} mm, radial depth {:.4g} mm", milling.tool.teeth, diameter_mm,
                     cut.radial_depth_m / units::mm);
}

class Reader {
 public:
  explicit Reader(const fs::path& job) : job_(job.lexically_normal()) {}

  JobParts read(const fs::path& results) {
    open();
    if (parts_.error && values_.empty()) return std::move(parts_);
    read_structure();
    read_cut();
    read_robot();
    read_program();
    read_monitor(results);
    read_whole();
    return std::move(parts_);
  }

 private:
  void open() {
    attempt(nullptr, [&] {
      values_ = io::toml_values(io::read_file(job_, jobs::longest_document), job_.string());
      for (const io::TomlValue& value : values_) {
        if (value.key.starts_with("job.")) parts_.names.push_back(value.key.substr(4));
      }
    });
    if (parts_.error) return;
    find_files();
    attempt(nullptr, [&] {
      document_ = std::make_unique<io::TomlFile>(io::TomlSource(job_));
      document_->text("job.title", parts_.title);
    });
    if (document_) find_files();
  }
  /// What the job names, or has itself.
  void find_files() {
    parts_.hits.file = named("job.hits");
    parts_.modes.file = named("job.modes");
    parts_.predicted = has("job.assembly");
    parts_.frf_files = all_named("job.frf");
    parts_.frfs.file = parts_.predicted ? named("job.assembly") : named("job.frf");
    if (parts_.hits.file.empty() && parts_.modes.file.empty() && parts_.frfs.file.empty()) {
      parts_.modes.file = named("dynamics.modes");
      parts_.frfs.file = named("dynamics.frf");
    }
    const bool holds_arm = std::ranges::any_of(cell::arm_keys, [&](const char* key) { return has(key); });
    parts_.robot.file = part("job.cell", holds_arm ? "robot" : nullptr);
    parts_.program.file = named("job.program");
    forces_ = part("job.forces", has("stock") ? "stock" : has("forces") ? "forces" : nullptr);
    parts_.recommends = has("job.lobes") || has("lobes");
    parts_.cut.file = parts_.recommends ? part("job.lobes", "lobes") : forces_;
    const bool judges_blocks = !forces_.empty() && !parts_.robot.file.empty() && !parts_.program.file.empty();
    parts_.decides = judges_blocks && has("decide");
    parts_.limits.file = job_;
  }
  [[nodiscard]] bool has(std::string_view key) const {
    if (document_) return document_->has(key);
    return std::ranges::any_of(values_, [&](const io::TomlValue& value) {
      return value.key.starts_with(key) &&
             (value.key.size() == key.size() || value.key[key.size()] == '.' || value.key[key.size()] == '[');
    });
  }
  /// The file that a key names, the first of a list; empty: none.
  [[nodiscard]] fs::path named(std::string_view key) const {
    const std::vector<fs::path> files = all_named(key);
    return files.empty() ? fs::path() : files.front();
  }
  [[nodiscard]] std::vector<fs::path> all_named(std::string_view key) const {
    std::vector<fs::path> out;
    if (document_) {
      try {
        document_->paths(key, out);
      } catch (const InvalidInput&) {
        return {};  // the reader of the job says so
      }
    }
    for (const io::TomlValue& value : document_ ? std::vector<io::TomlValue>() : values_) {
      if (value.key == key && value.value.is_string())
        out.push_back(job_.parent_path() / value.value.get<std::string>());
    }
    for (fs::path& file : out) file = file.lexically_normal();
    return out;
  }
  /// The file that a key names, else the one that has a table; empty: neither.
  [[nodiscard]] fs::path part(const char* key, const char* table) const {
    if (fs::path file = named(key); !file.empty() || table == nullptr) return file;
    return file_with(table);
  }
  [[nodiscard]] fs::path file_with(const char* table) const {
    return (document_ ? document_->file_of(table) : job_).lexically_normal();
  }
  /// What documents are read as: the job with all that it includes, or the part alone where that cannot be read.
  [[nodiscard]] const fs::path& source_of(const JobPart& part) const { return document_ ? job_ : part.file; }

  /// An error goes to the part whose file or key it is about; else to `part`, or the whole job.
  void put(JobPart* part, const InvalidInput& error) {
    const fs::path file = file_of(error);
    for (JobPart JobParts::*const one : {&JobParts::hits, &JobParts::frfs, &JobParts::modes, &JobParts::cut,
                                         &JobParts::robot, &JobParts::program, &JobParts::monitor}) {
      if (!file.empty() && file != job_ && (parts_.*one).file == file) return keep((parts_.*one).error, error);
    }
    const std::string& field = error.parts().field;
    if (JobPart JobParts::*const of_key = part_of_key(field)) return keep((parts_.*of_key).error, error);
    keep(field == "job" ? parts_.hits.error : part != nullptr ? part->error : parts_.error, error);
  }
  static void keep(std::optional<InvalidInput>& first, const InvalidInput& error) {
    if (!first) first = error;
  }
  template <class F>
  void attempt(JobPart* part, F&& f) {
    try {
      f();
    } catch (const InvalidInput& error) {
      put(part, error);
    }
  }
  /// The same of a part that the job has.
  template <class F>
  void attempt(JobPart& part, const char* key, F&& f) {
    if (part.file.empty()) return;
    attempt(&part, [&] {
      require(part.file, key);
      f();
    });
  }
  void require(const fs::path& file, std::string_view key) const {
    if (is_there(file)) return;
    if (document_ && document_->has(key)) throw document_->reject(key, no_such_file);
    throw InvalidInput(InvalidInput::Parts{
        .where = job_.string(), .field = std::string(key), .value = file.filename().string(), .rule = no_such_file});
  }
  /// @throws InvalidInput where it leads out of the folder that is served, whether it is there or not
  static bool is_there(const fs::path& file) {
    io::require_inside(file);
    std::error_code ignored;
    return fs::exists(file, ignored);
  }

  void read_structure() {
    attempt(parts_.hits, "job.hits", [&] {
      const io::TomlSource source(parts_.hits.file);
      const std::size_t hits = modal::read_hit_rows(source).rows.size();
      io::TomlFile document(source);
      for (const char* table : {"acquisition", "hits"}) document.skip(table);
      for (std::size_t i = 0; i < hits; ++i) {
        fs::path record;
        const std::string key = fmt::format("hits[{}].file", i);
        if (document.path(key, record) && !is_there(record)) throw document.reject(key, no_such_file);
      }
      parts_.hits.guesses = guesses_of(parts_.hits.file, io::sample_values(document), true);
      parts_.hits.says = fmt::format("{} {}", hits, hits == 1 ? "hit" : "hits");
    });
    attempt(parts_.frfs, parts_.predicted ? "job.assembly" : "job.frf", [&] {
      parts_.frfs.says = parts_.frfs.file.filename().string();
      if (parts_.predicted) {
        static_cast<void>(coupling::read_assembly(io::TomlSource(parts_.frfs.file), {.cuts = true}));
        parts_.frfs.says = "predicted by " + parts_.frfs.says;
      }
      for (const fs::path& file : parts_.frf_files) require(file, "job.frf");
    });
    attempt(parts_.modes, "job.modes", [&] {
      std::vector<std::string> notes;
      const std::size_t modes = modal::read_modes(parts_.modes.file, notes).modes.size();
      parts_.modes.says = fmt::format("{} {}", modes, modes == 1 ? "mode" : "modes");
    });
  }
  void read_cut() {
    const bool lobes = parts_.recommends;
    attempt(parts_.cut, lobes ? "job.lobes" : "job.forces", [&] {
      std::vector<Assumption> assumed;
      if (lobes) {
        const jobs::LobesFile cut = jobs::read_lobes(source_of(parts_.cut));
        parts_.cut.says = cut_text(cut);
        assumed = cut.assumed;
      } else {
        const process::ForcesFile cut = process::read_forces(source_of(parts_.cut), process::ForcesJob::program);
        parts_.cut.says =
            fmt::format("{} teeth, {:.4g} mm", cut.cutter.mill.teeth, cut.cutter.mill.diameter_m / units::mm);
        assumed = cut.assumed;
      }
      parts_.cut.guesses = guesses_of(parts_.cut.file, assumed);
    });
  }
  void read_robot() {
    attempt(parts_.robot, "job.cell", [&] {
      const cell::CellFile cell = cell::read_cell(source_of(parts_.robot), cell::Robots::any);
      parts_.robot.says = !cell.model.empty() ? cell.model : cell.hybrid ? "hybrid machine" : "arm of the document";
      parts_.robot.guesses = guesses_of(parts_.robot.file, cell.assumed);
    });
  }
  void read_program() {
    attempt(parts_.program, "job.program", [&] {
      parts_.program.says = parts_.program.file.filename().string();
      if (forces_.empty() || !parts_.recommends) return;  // the cut was read of them
      static_cast<void>(process::read_forces(document_ ? job_ : forces_, process::ForcesJob::program));
    });
  }
  void read_monitor(const fs::path& results) {
    const fs::path beside = job_.parent_path() / "monitor.toml", planned = results / "monitor.toml";
    attempt(&parts_.monitor, [&] {
      if (has("detector") || has("signal")) {
        parts_.monitor.file = file_with(has("detector") ? "detector" : "signal");
      } else if (is_there(beside)) {
        parts_.monitor.file = beside;
      } else if (!results.empty() && is_there(planned)) {
        parts_.monitor.file = planned;
      }
    });
    attempt(parts_.monitor, "detector", [&] {
      const monitor::MonitorFile file = monitor::read_monitor(parts_.monitor.file);
      parts_.monitor.says = fmt::format("{} {}", file.columns.channels.size(),
                                        file.columns.channels.size() == 1 ? "channel" : "channels");
      parts_.monitor.guesses = guesses_of(parts_.monitor.file, file.assumed);
    });
  }
  /// What no part says: rules between them, limits, unknown keys.
  void read_whole() {
    if (!document_) return;
    attempt(nullptr, [&] {
      std::vector<Assumption> assumed = jobs::read_job(job_).assumed;
      std::erase_if(assumed, [](const Assumption& one) { return part_of_key(one.key) != &JobParts::limits; });
      parts_.limits.guesses = guesses_of(job_, assumed);
    });
  }

  fs::path job_, forces_;
  std::vector<io::TomlValue> values_;
  std::unique_ptr<io::TomlFile> document_;  ///< with what it includes; null where it cannot be read
  JobParts parts_;
};

}  // namespace

JobParts read_job_parts(const fs::path& job, const fs::path& results) {
  return Reader(job).read(results);
}

}  // namespace robomill::serve
