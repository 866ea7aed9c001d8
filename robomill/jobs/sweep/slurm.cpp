#include "robomill/jobs/sweep/slurm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"

namespace robomill::jobs {
namespace {

constexpr int most_tasks = 100'000;
constexpr double shortest_task_s = 300.0;  // Slurm sends its signal up to two minutes before the end

/// As a value in a line #SBATCH.
std::string directive_word(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += '\\';
    out += c;
  }
  return out + "\"";
}

/// The file of a job's output, in Slurm's pattern: %a is the task's number.
std::string output_directive(const std::filesystem::path& folder, std::string_view name) {
  const std::string text = folder.string();
  if (text.find_first_of("\\\n\r") != std::string::npos) {
    throw InvalidInput(
        "folder",
        fmt::format("\"{}\" has a backslash or a line's end, which no output file of Slurm can have in its path",
                    text));
  }
  std::string pattern;
  for (const char c : text) pattern.append(c == '%' ? 2 : 1, c);
  return fmt::format("#SBATCH --output={}\n", directive_word(fmt::format("{}/slurm/{}", pattern, name)));
}

std::string where_directives(const SlurmSettings& settings) {
  std::string out;
  if (settings.time_s > 0.0) out += fmt::format("#SBATCH --time={:.0f}\n", std::ceil(settings.time_s / units::minute));
  if (settings.memory_mb > 0) out += fmt::format("#SBATCH --mem={}M\n", settings.memory_mb);
  if (!settings.partition.empty()) out += fmt::format("#SBATCH --partition={}\n", settings.partition);
  if (!settings.account.empty()) out += fmt::format("#SBATCH --account={}\n", settings.account);
  return out;
}

std::string names(const SlurmPlaces& places) {
  return fmt::format("program={}\nstudy={}\nfolder={}\n", shell_word(places.program), shell_word(places.study.string()),
                     shell_word(places.folder.string()));
}

constexpr std::string_view array_body = R"(
# Into the queue once more: what a process that died, a machine or a time limit left is done there.
again() {
  if [ "${SLURM_RESTART_COUNT:-0}" -ge "$restarts" ]; then
    echo "task $SLURM_ARRAY_TASK_ID of $shards: ended with $1 after $restarts restarts: it is not tried again"
    exit "$1"
  fi
  echo "task $SLURM_ARRAY_TASK_ID of $shards: ended with $1: it goes into the queue again"
  for _ in $(seq 60); do  # the controller may be away for a while
    scontrol requeue "$SLURM_JOB_ID" && sleep 60  # which ends this script
    sleep 5
  done
  exit "$1"
}

work=
trap 'kill -TERM "$work"; wait "$work"; again 124' USR1  # a minute before the time limit
"$program" sweep "$study" -o "$folder" --shard "$SLURM_ARRAY_TASK_ID/$shards" --threads "${SLURM_CPUS_PER_TASK:-1}" &
work=$!
wait "$work"
code=$?
case $code in
  0 | 3) exit 0 ;;  # 3: no point of the study could be done so far; its chunks are there
  *) again "$code" ;;
esac
)";

constexpr std::string_view merge_body = R"(
for table in results.csv results.h5; do
  "$program" sweep "$study" -o "$folder" --merge "$folder/$table" && continue
  code=$?
  "$program" sweep "$study" -o "$folder" --status
  exit "$code"
done
)";

bool is_plain_word(std::string_view text) {
  return std::ranges::all_of(text, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
           c == '.' || c == ',';
  });
}

/// Takes a number off the front of a text.
std::optional<int> take_number(std::string_view& text) {
  int out = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
  if (error != std::errc() || out < 0) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return out;
}

/// "4-6,9%2]"
void add_ranges(std::string_view text, const std::string& state, SlurmStates& out) {
  for (;;) {
    const std::optional<int> from = take_number(text);
    if (!from) return;
    int last = *from;
    if (text.starts_with('-')) {
      text.remove_prefix(1);
      last = take_number(text).value_or(last);
    }
    for (int task = *from; task <= std::min(last, most_tasks); ++task) out[task] = state;
    if (!text.starts_with(',')) return;
    text.remove_prefix(1);
  }
}

template <class Take>
void for_each_line(std::string_view text, Take&& take) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    if (const std::size_t bar = line.find('|'); bar != std::string_view::npos) {
      std::string_view state = line.substr(bar + 1);
      take(line.substr(0, bar), std::string(state.substr(0, state.find_first_of(" +\r"))));
    }
    text.remove_prefix(std::min(end + 1, text.size()));
  }
}

}  // namespace

void SlurmSettings::validate() const {
  if (shards < 0 || shards > most_tasks)
    throw InvalidInput("shards", shards, "", fmt::format("must lie between 1 and {}", most_tasks));
  if (time_s != 0.0 && !(time_s >= shortest_task_s && time_s < 1e9)) {
    throw InvalidInput("time_s", time_s, "s", fmt::format("must be >= {} s", shortest_task_s),
                       "A task that runs out of time ends its work before");
  }
  if (memory_mb < 0) throw InvalidInput("memory_mb", memory_mb, "", "must be >= 0");
  if (cpus < 1 || cpus > 10'000) throw InvalidInput("cpus", cpus, "", "must lie between 1 and 10000");
  if (restarts < 0) throw InvalidInput("restarts", restarts, "", "must be >= 0");
  for (const auto& [member, text] : {std::pair("partition", &partition), std::pair("account", &account)}) {
    if (!is_plain_word(*text)) {
      throw InvalidInput(member, fmt::format("\"{}\" must have letters, digits, _ - . and , alone", *text));
    }
  }
}

std::string shell_word(std::string_view text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'') out += "'\\'";
    out += c;
  }
  return out + "'";
}

SlurmScripts slurm_scripts(const SlurmSettings& settings, const SlurmPlaces& places, int shards) {
  const std::string where = where_directives(settings);
  return {
      .array = fmt::format(
          "#!/bin/bash\n"
          "# A study's shards as a job array of Slurm. By hand: sbatch array.sh; then merge.sh, with its number.\n"
          "#SBATCH --job-name=robomill-sweep\n#SBATCH --array=1-{}\n#SBATCH --cpus-per-task={}\n"
          "#SBATCH --requeue\n#SBATCH --open-mode=append\n#SBATCH --signal=B:USR1@60\n{}{}{}shards={}\nrestarts={}\n{}",
          shards, settings.cpus, output_directive(places.folder, "%a.out"), where, names(places), shards,
          settings.restarts, array_body),
      .merge = fmt::format("#!/bin/bash\n"
                           "# Writes the tables of a study whose shards are done. By hand: sbatch "
                           "--dependency=afterany:NUMBER merge.sh\n"
                           "#SBATCH --job-name=robomill-merge\n#SBATCH --requeue\n#SBATCH --open-mode=append\n{}{}{}{}",
                           output_directive(places.folder, "merge.out"), where, names(places), merge_body)};
}

SlurmStates states_of_squeue(std::string_view text) {
  SlurmStates out;
  for_each_line(text, [&](std::string_view task, const std::string& state) { add_ranges(task, state, out); });
  return out;
}

SlurmStates states_of_sacct(std::string_view text) {
  SlurmStates out;
  for_each_line(text, [&](std::string_view job, const std::string& state) {
    const std::size_t bar = job.find('_');
    if (bar == std::string_view::npos) return;
    job.remove_prefix(bar + 1);
    if (job.starts_with('[')) job.remove_prefix(1);
    if (job.find('.') == std::string_view::npos) add_ranges(job, state, out);
  });
  return out;
}

TaskState task_state(std::string_view state) {
  constexpr std::array<std::string_view, 8> waits = {"PENDING",      "REQUEUED",      "REQUEUE_HOLD", "REQUEUE_FED",
                                                     "SPECIAL_EXIT", "RESV_DEL_HOLD", "CONFIGURING",  "SUSPENDED"};
  constexpr std::array<std::string_view, 5> runs = {"RUNNING", "COMPLETING", "SIGNALING", "STAGE_OUT", "RESIZING"};
  if (std::ranges::find(waits, state) != waits.end()) return TaskState::waiting;
  if (std::ranges::find(runs, state) != runs.end()) return TaskState::running;
  return TaskState::failed;
}

}  // namespace robomill::jobs
