#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <system_error>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/cell/files/known_arms.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/system/folder_change.hpp"
#include "robomill/io/toml/edit.hpp"
#include "robomill/jobs/init.hpp"
#include "robomill/jobs/init/hits_document.hpp"
#include "robomill/jobs/init/template_lines.hpp"
#include "robomill/modal/files/example_hit.hpp"
#include "robomill/modal/files/hit_files/hit_settings.hpp"
#include "robomill/modal/files/hits_toml.hpp"

namespace robomill::jobs {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_notes = 10;

/// A link too, whatever it points to; but not what an earlier call, which was ended, has begun.
bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::symlink_status(path, ignored).type() > fs::file_type::not_found && !io::is_unfinished(path);
}

/// A record that is made up, unless an earlier call has made it.
void add_example_hit(const fs::path& folder, InitFiles& out) {
  const fs::path example = folder / modal::example_hit_name;
  if (is_there(example)) {
    out.kept.push_back(example);
  } else {
    out.files.push_back({.path = example, .text = modal::example_hit_csv()});
  }
  out.notes.push_back(fmt::format("{} is made up, so that the file runs.", modal::example_hit_name));
}

void add_hits(const InitOptions& options, const fs::path& path, InitFiles& out, modal::MeasuredAxes& measured) {
  const fs::path folder = path.parent_path().empty() ? fs::path(".") : path.parent_path();
  modal::FoundHits found;
  const fs::path data = options.data.empty() ? folder : options.data;
  const bool looks = !options.example && (!options.data.empty() || fs::is_directory(data));
  if (looks) found = modal::find_hits(data, folder, modal::example_hit_name);
  out.files.push_back({.path = path, .text = hits_document(found, options.example), .kind = Template::hits});
  if (options.example) {
    measured = {.excitations = {'x'}, .responses = {'x'}};
    add_example_hit(path.parent_path(), out);
  } else if (found.hits.empty()) {
    out.notes.push_back(fmt::format(
        "No records of hits were found in {}: write [[hits]] for each one, or lay them there and begin again.",
        data.string()));
  } else {
    measured = modal::measured_axes(found);
    const bool one = found.hits.size() == 1;
    out.notes.push_back(fmt::format("{} record{} of hits {} found in {}: what is guessed is marked, check it.",
                                    found.hits.size(), one ? "" : "s", one ? "was" : "were", data.string()));
    for (const Assumption& unit : modal::assumed_units(found, path.filename().string()))
      out.notes.push_back("Assumed: " + assumption_text(unit));
  }
  for (std::size_t i = 0; i < std::min(found.left_out.size(), most_notes); ++i) {
    out.notes.push_back(fmt::format("Left out: {}.", found.left_out[i]));
  }
  if (found.left_out.size() > most_notes) {
    out.notes.push_back(fmt::format("Left out: {} more.", found.left_out.size() - most_notes));
  }
}

/// What a hits.toml that is there already knows; nothing where it is still to be filled in.
modal::MeasuredAxes axes_of(const fs::path& hits_toml) {
  modal::MeasuredAxes axes;
  const auto letter = [](const modal::Dof& dof) { return modal::to_string(modal::Dof{.axis = dof.axis}).front(); };
  try {
    for (const modal::Hit& hit : modal::read_hits(hits_toml).hits) {
      axes.excitations.insert(letter(hit.excitation));
      for (const modal::HitChannel& channel : hit.responses) axes.responses.insert(letter(channel.dof));
    }
  } catch (const InvalidInput&) {
    return {};  // the job's run says what is wrong with it
  }
  return axes;
}

void add_job(const InitOptions& options, const fs::path& path, InitFiles& out) {
  const fs::path hits = path.parent_path() / "hits.toml", lobes = path.parent_path() / "lobes.toml";
  NewFile& job = out.files.emplace_back(NewFile{.path = path, .kind = Template::job});
  modal::MeasuredAxes measured;
  InitFiles beside;
  if (is_there(hits)) {
    out.kept.push_back(hits);
    measured = axes_of(hits);
  } else {
    add_hits(options, hits, beside, measured);
  }
  const bool cut_beside = is_there(lobes);
  job.text = job_document(measured, cut_beside, options.example);
  job.holds_cut = !cut_beside;
  out.unmeasured = unmeasured_axis(measured);
  if (cut_beside) out.kept.push_back(lobes);
  std::ranges::move(beside.files, std::back_inserter(out.files));
  std::ranges::move(beside.kept, std::back_inserter(out.kept));
  out.notes = std::move(beside.notes);
}

/// The command that runs a document.
std::string command_for(Template kind, const fs::path& path) {
  switch (kind) {
    case Template::job:
      return fmt::format("plan {} -o out/", path.string());
    case Template::hits:
      return fmt::format("frf {} -o tip.uff", path.string());
    case Template::lobes:
      return fmt::format("lobes {} -o lobes.json", path.string());
    case Template::cell:
      return fmt::format("cell check {}", path.string());
    case Template::assembly:
      return fmt::format("couple {} -o tip.uff", path.string());
    case Template::forces:
      return fmt::format("forces {} -o forces.csv --report forces.html", path.string());
    case Template::monitor:
      break;
  }
  return fmt::format("monitor {} --input cut.wav -o events.jsonl", path.string());
}

}  // namespace

NewFile* InitFiles::document(Template kind) {
  const auto found = std::ranges::find_if(
      files, [&](const NewFile& file) { return file.kind == kind || (kind == Template::lobes && file.holds_cut); });
  return found != files.end() ? &*found : nullptr;
}

InitFiles init_files(const InitOptions& options) {
  const std::string usual = fmt::format("{}.toml", name_in(template_names, options.kind));
  fs::path path = options.file.empty() ? fs::path(usual) : options.file;
  if (fs::is_directory(path)) path /= usual;
  if (io::format_of(path) != io::Format::toml) {
    throw InvalidInput(path.string(), "must end in .toml", "It is what robomill reads");
  }
  if (!options.robot.empty() && options.kind != Template::cell) throw InvalidInput("--robot", "goes with init cell");
  if (!options.data.empty() && options.kind != Template::hits && options.kind != Template::job) {
    throw InvalidInput("--data", "goes with init hits and init job");
  }
  if (!options.data.empty() && options.example) {
    throw InvalidInput("--data", "does not go with --example", "An example has a record of its own");
  }
  InitFiles out = {.example = options.example};
  modal::MeasuredAxes measured;
  switch (options.kind) {
    case Template::job:
      add_job(options, path, out);
      break;
    case Template::hits:
      add_hits(options, path, out, measured);
      break;
    case Template::cell:
      out.files.push_back({.path = path, .text = cell_document(options.robot, options.example), .kind = options.kind});
      break;
    default:
      out.files.push_back({.path = path, .text = template_text(options.kind, options.example), .kind = options.kind});
  }
  out.next = command_for(options.kind, path);
  for (NewFile& file : out.files) {
    if (options.schemas.empty() || !file.kind) continue;
    const std::string name = fmt::format("{}.toml.schema.json", name_in(template_names, *file.kind));
    file.text = fmt::format("#:schema {}\n{}", (options.schemas / name).string(), file.text);
  }
  return out;
}

void require_new(const InitFiles& files) {
  for (const NewFile& file : files.files) {
    if (is_there(file.path)) {
      throw InvalidInput(file.path.string(), "exists, and is not overwritten", "Name another file by -o, or move it");
    }
  }
}

void write_init(const InitFiles& files) {
  require_new(files);
  if (files.files.size() == 1) return io::write_file(files.files.front().path, files.files.front().text);
  io::FolderChange all(files.files.front().path.parent_path());
  for (const NewFile& file : files.files) all.write(file.path.filename().string(), file.text);
  all.commit();
}

}  // namespace robomill::jobs
