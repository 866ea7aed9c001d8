#include "robomill/jobs/files/study_toml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/digest.hpp"
#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/table.hpp"
#include "robomill/io/toml/edit.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/io/toml/values.hpp"
#include "robomill/jobs/files/named_files.hpp"
#include "robomill/jobs/files/study_schema.hpp"
#include "robomill/version.hpp"

namespace robomill::jobs {
namespace {

using io::declared;
using io::Holds;
using io::key;

/// A cell of a table, as TOML writes it.
std::string literal_of_cell(std::string_view cell) {
  return io::parse_cell(cell) ? fmt::format("{}", *io::parse_cell(cell)) : io::toml_quoted(cell);
}

void read_values(io::TomlFile& file, const std::string& path, Variation& out) {
  std::vector<std::string> values;
  if (!file.literals(path, values)) return;
  if (values.empty()) throw file.reject(path, "must not be empty");
  for (std::string& value : values) out.values.push_back({std::move(value)});
}

void read_table(io::TomlFile& file, const std::string& path, Variation& out) {
  std::filesystem::path table_path;
  if (!file.path(path, table_path)) return;
  std::vector<std::string> warnings;
  const io::TextTable table = io::parse_text_table(io::read_file(table_path), table_path.string(), warnings);
  out.keys = table.names;
  for (const io::TextTable::Row& row : table.rows) {
    std::vector<std::string>& cells = out.values.emplace_back();
    for (const std::string& field : row.fields) cells.push_back(literal_of_cell(field));
  }
}

void require_one_of(io::TomlFile& file, const std::string& row) {
  const int given =
      (file.has(row + ".values") ? 1 : 0) + (file.has(row + ".range") ? 1 : 0) + (file.has(row + ".table") ? 1 : 0);
  if (given != 1)
    throw file.reject(row, "must have values, range or table", given == 0 ? "None is given" : "Several are given");
  if (file.has(row + ".table") == file.has(row + ".key")) {
    throw file.reject(row, "must have a key, or a table whose columns are keys");
  }
  for (const char* word : {"count", "sampling"}) {
    if (file.has(row + "." + word) && !file.has(row + ".range")) throw file.reject(row + "." + word, "goes with range");
  }
}

/// Options of the job as its requests have them.
std::string options_of(io::TomlFile& file) {
  const std::string table = "study.options";
  if (!file.has(table)) return {};
  file.skip(table);
  io::Json out = io::Json::object();
  for (const io::TomlText& text : file.texts()) {
    for (io::TomlValue& value : io::toml_values(text.content, text.path.string())) {
      if (value.key.starts_with(table + ".")) out[value.key.substr(table.size() + 1)] = std::move(value.value);
    }
  }
  return io::plain_text(out);
}

/// The study but for what it asks of a cluster, which changes no result; and the files that it names.
void add_study(const std::filesystem::path& file, Digest& digest) {
  for (const io::TomlValue& value : io::toml_values(io::read_file(file), file.string())) {
    if (value.key.starts_with("slurm.")) continue;
    digest.text(value.key);
    digest.text(value.value.dump());
  }
  for (const std::filesystem::path& named : files_named_in(file, Unreadable::rejected)) {
    digest.text(io::read_file(named));
  }
}

/// A file, and the files that it names, by their content.
void add_file(const std::filesystem::path& file, Digest& digest) {
  digest.text(io::read_file(file));
  for (const std::filesystem::path& named : files_named_in(file, Unreadable::rejected))
    digest.text(io::read_file(named));
}

/// Files that the values of keys name, also in lists: their paths are relative to the base document.
void add_files_of_values(const Study& study, Digest& digest) {
  std::vector<io::Json> texts;
  for (const Variation& one : study.vary) {
    for (const std::vector<std::string>& row : one.values) {
      for (const std::string& literal : row) {
        if (literal.starts_with('"')) texts.emplace_back(io::toml_unquoted(literal));
        if (!is_list_literal(literal)) continue;
        for (io::TomlValue& list : io::toml_values("value = " + literal, study.file.string()))
          texts.push_back(std::move(list.value));
      }
    }
  }
  for (const std::filesystem::path& named : files_named_by(texts, study.base.parent_path())) add_file(named, digest);
}

}  // namespace

const io::Schema<Study>& study_table() {
  static const io::Schema<Study> table(
      "study", "a job that is done again and again, with other values of some keys of its document",
      {key("job", &Study::job, "the verb: lobes, simulate, forces, couple, plan").required(),
       key("base", &Study::base, "its document, whose keys vary").required(),
       key("collect", &Study::collect,
           "what is kept of each result: limit@RPM [mm], chatter_frequency@RPM [Hz] and abs_mu@RPM,MM of lobes, or a "
           "path "
           "in the verb's JSON document: recommended.removal_rate_mm3_per_s")
           .or_one(),
       declared<Study>("options", Holds::table,
                       "of the job, as its requests have them; paths are relative to this file: at = [8000, 0.5]"),
       key("seed", &Study::seed, "of samples").at_least(0.0),
       key("chunk_points", &Study::chunk_points, "points that are done together; 0: as many as take a minute")
           .at_least(0.0)});
  return table;
}

const io::Schema<Variation>& vary_table() {
  static const io::Schema<Variation> table(
      "vary", "a key, or several together, and the values that they take; the last changes fastest",
      {declared<Variation>("key", Holds::text, "of the base document: cut.radial_depth_mm")
           .read_by([](io::TomlFile& file, const std::string& path, Variation& out) {
             std::string text;
             if (file.text(path, text)) out.keys = {std::move(text)};
           }),
       declared<Variation>("values", Holds::number,
                           "numbers, texts, true or false, or lists of them, one after the other", 1)
           .or_also(Holds::text)
           .or_also(Holds::boolean)
           .or_also(Holds::list)
           .or_one()
           .read_by(read_values),
       key("range", &Variation::range, "or from, to, in the key's unit").no_default().entries(2),
       key("count", &Variation::count, "values in the range").at_least(0.0),
       key("sampling", &Variation::sampling, sampling_names,
           "evenly, by Latin hypercube or by Sobol' sequence; keys sampled in one way are sampled together"),
       declared<Variation>("table", Holds::path, "or a CSV file: its columns are keys, its rows their values")
           .read_by(read_table)});
  return table;
}

const io::Schema<BoundaryTask>& boundary_task_table() {
  static const io::Schema<BoundaryTask> table(
      "boundary", "where a value crosses a level: the ranges on a grid are the coarse grid, which is refined there",
      {key("value", &BoundaryTask::value, "as in study.collect: abs_mu@8000,0.5").required(),
       key("level", &BoundaryTask::level, "that it crosses, in its unit"),
       key("halvings", &BoundaryTask::halvings, "of the grid's steps").at_least(0.0).at_most(20.0),
       key("most_points", &BoundaryTask::most_points, "that are done or interpolated").at_least(1.0),
       key("interpolate", &BoundaryTask::interpolate,
           "points whose neighbours tell on which side of the level they lie, in place of doing them")});
  return table;
}

const io::Schema<SensitivityTask>& sensitivity_task_table() {
  static const io::Schema<SensitivityTask> table(
      "sensitivity", "Sobol' indices of what is collected, over the keys with sampling = \"sobol\"",
      {key("samples", &SensitivityTask::samples, "a power of two; each is as many points as keys, and two")
           .at_least(8.0)
           .required()});
  return table;
}

const io::Schema<ProbabilityTask>& probability_task_table() {
  static const io::Schema<ProbabilityTask> table(
      "probability",
      "how often a value keeps a condition over the keys that are sampled, for each combination of the others",
      {key("value", &ProbabilityTask::values, "as in study.collect, or several in one unit: limit@8000")
           .or_one()
           .required(),
       key("at_least", &ProbabilityTask::at_least, "the condition, in the value's unit").no_default(),
       key("at_most", &ProbabilityTask::at_most, "or this").no_default(),
       key("worst_share", &ProbabilityTask::worst_share,
           "the robust optimum has the best value that this share of the points stays short of")
           .at_least(0.0)
           .below(1.0)});
  return table;
}

namespace {

/// [boundary], [sensitivity], [probability], with the values that they need.
void read_tasks(io::TomlFile& file, Study& out) {
  const auto collect = [&](const std::string& value) {
    if (std::ranges::find(out.collect, value) == out.collect.end()) out.collect.push_back(value);
  };
  if (file.has("boundary")) {
    boundary_task_table().read(file, "boundary", out.boundary.emplace(), "boundary.");
    collect(out.boundary->value);
  }
  if (file.has("probability")) {
    probability_task_table().read(file, "probability", out.probability.emplace(), "probability.");
    std::ranges::for_each(out.probability->values, collect);
  }
  if (!file.has("sensitivity")) return;
  sensitivity_task_table().read(file, "sensitivity", out.sensitivity.emplace(), "sensitivity.");
  for (std::size_t i = 0; i < out.vary.size(); ++i) {
    const bool given = file.has(fmt::format("vary[{}].count", i));
    if (out.vary[i].is_sampled() && !given) out.vary[i].count = out.sensitivity->samples;
  }
}

}  // namespace

const io::Schema<SlurmSettings>& slurm_table() {
  static const io::Schema<SlurmSettings> table(
      "slurm", "what the study asks of a Slurm cluster, for --slurm",
      {key("shards", &SlurmSettings::shards, "tasks of the job array").at_least(1.0).at_most(1e5).required(),
       key("time_min", &SlurmSettings::time_s, "that a task may take; not given: what the cluster allows")
           .at_least(5.0, "A minute before the end it stops, and goes into the queue again")
           .no_default(),
       key("memory_mb", &SlurmSettings::memory_mb, "of a task, MiB; not given: what the cluster allows")
           .at_least(1.0)
           .no_default(),
       key("cpus", &SlurmSettings::cpus, "of a task, each for a thread").at_least(1.0),
       key("restarts", &SlurmSettings::restarts, "of a task that ended before its chunks were done").at_least(0.0),
       key("partition", &SlurmSettings::partition, "of the cluster; not given: its default").no_default(),
       key("account", &SlurmSettings::account, "that is charged; not given: the cluster's default").no_default()});
  return table;
}

Study read_study(const io::TomlSource& source) {
  io::TomlFile file(source);
  Study out{.file = source.path};
  study_table().read(file, "study", out);
  out.options = options_of(file);
  if (file.tables("vary") == 0) file.require("vary", "Write [[vary]] above each key");
  for (std::size_t i = 0; i < file.tables("vary"); ++i) {
    const std::string row = fmt::format("vary[{}]", i);
    require_one_of(file, row);
    vary_table().read(file, row, out.vary.emplace_back(), row + ".");
  }
  read_tasks(file, out);
  if (file.has("slurm")) {
    slurm_table().read(file, "slurm", out.slurm);
    file.locate([&] { out.slurm.validate(); });
  }
  out.notes = file.done();
  file.locate([&] { out.validate(); });
  return out;
}

std::string fingerprint_of(const Study& study) {
  Digest digest;
  digest.text(ROBOMILL_VERSION);
  add_study(study.file, digest);
  add_file(study.base, digest);
  add_files_of_values(study, digest);
  return digest.hex();
}

}  // namespace robomill::jobs
