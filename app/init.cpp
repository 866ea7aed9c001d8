#include "robomill/jobs/init.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <iostream>
#include <string>
#include <system_error>

#include "robomill/base/error.hpp"
#include "robomill/base/printable.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

/// Asks on standard error, since the document may go to standard output.
void ask(jobs::Template kind, jobs::InitFiles& files) {
  jobs::Interview interview(kind, files);
  fmt::print(stderr, "Enter takes what stands in brackets; units may be given: 0.25 in, 100 mV/g, 12 Nm, 7.5 kW.\n");
  while (const std::optional<std::string> question = interview.question()) {
    fmt::print(stderr, "{}", *question);
    std::string line;
    if (!std::getline(std::cin, line)) {
      fmt::print(stderr, "\n");
      throw InvalidInput("standard input", "ended before the last question", "Nothing was written");
    }
    try {
      interview.answer(line);
    } catch (const InvalidInput& error) {
      fmt::print(stderr, "  {}\n", printable(error.what()));
    }
  }
}

/// The schemas that are installed with this program, or those of the sources around its build; empty: neither is there.
std::filesystem::path schema_folder() {
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  for (std::filesystem::path above = program; above.has_relative_path(); above = above.parent_path()) {
    for (const char* place : {"share/robomill/schema", "docs/schema"}) {
      std::filesystem::path folder = above.parent_path() / place;
      if (std::filesystem::is_regular_file(folder / "job.toml.schema.json", error)) return folder;
    }
  }
  return {};
}

void print_summary(const jobs::InitFiles& files) {
  for (const jobs::NewFile& file : files.files) fmt::print("wrote {}\n", printable(file.path.string()));
  for (const std::filesystem::path& kept : files.kept) fmt::print("kept  {}\n", printable(kept.string()));
  for (const std::string& note : files.notes) fmt::print("{}\n", printable(note));
  fmt::print("Run: robomill {}\n", printable(files.next));
}

}  // namespace

Exit run_init(const jobs::VerbJob& job, const Common& common, Progress& /*progress*/) {
  const jobs::Template kind = value_in(jobs::template_names, job.input().string()).value();
  const bool interactive = job.flag("interactive");
  jobs::InitFiles files = jobs::init_files({.kind = kind,
                                            .file = common.to_stdout() ? std::string() : common.output,
                                            .data = job.file("data"),
                                            .robot = job.text("robot"),
                                            .example = job.flag("example"),
                                            .schemas = schema_folder()});
  if (common.to_stdout()) {
    if (interactive) ask(kind, files);
    fmt::print("{}", files.files.front().text);
    if (common.quiet) return done;
    for (std::size_t i = 1; i < files.files.size(); ++i) {
      fmt::print(stderr, "not written: {}, which it names\n", printable(files.files[i].path.string()));
    }
    return done;
  }
  jobs::require_new(files);
  if (interactive) ask(kind, files);
  jobs::write_init(files);
  if (common.wants_summary()) print_summary(files);
  return done;
}

}  // namespace robomill::app
