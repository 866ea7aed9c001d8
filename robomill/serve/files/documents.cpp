#include "robomill/serve/files/documents.hpp"

#include <array>
#include <utility>

#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/coupling/files/assembly_toml.hpp"
#include "robomill/io/toml_source.hpp"
#include "robomill/jobs/files/job_toml.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"
#include "robomill/jobs/files/study_toml.hpp"
#include "robomill/modal/files/hits_toml.hpp"
#include "robomill/monitor/files/monitor_toml.hpp"
#include "robomill/monitor/files/recordings_toml.hpp"
#include "robomill/process/files/forces_toml.hpp"

namespace robomill::serve {
namespace {

using Read = void (*)(const io::TomlSource&);

/// A job, and its cut where it has that itself.
void read_job_and_cut(const io::TomlSource& source) {
  const jobs::Job job = jobs::read_job(source);
  if (job.lobes == source.path) static_cast<void>(jobs::read_lobes(source));
}

constexpr std::array<std::pair<std::string_view, Read>, 9> readers = {{
    {"job", read_job_and_cut},
    {"hits", [](const io::TomlSource& source) { (void)modal::read_hits(source); }},
    {"lobes", [](const io::TomlSource& source) { (void)jobs::read_lobes(source); }},
    {"forces", [](const io::TomlSource& source) { (void)process::read_forces(source); }},
    {"cell", [](const io::TomlSource& source) { (void)cell::read_cell(source, cell::Robots::any); }},
    {"assembly", [](const io::TomlSource& source) { (void)coupling::read_assembly(source); }},
    {"monitor", [](const io::TomlSource& source) { (void)monitor::read_monitor(source); }},
    {"recordings", [](const io::TomlSource& source) { (void)monitor::read_recordings(source); }},
    {"study", [](const io::TomlSource& source) { (void)jobs::read_study(source); }},
}};

}  // namespace

std::optional<InvalidInput> check_document(std::string_view kind, const std::filesystem::path& path,
                                           const std::string& text) {
  for (const auto& [name, read] : readers) {
    if (name != kind) continue;
    try {
      read(io::TomlSource(path, text));
    } catch (const InvalidInput& error) {
      return error;
    }
  }
  return std::nullopt;
}

}  // namespace robomill::serve
