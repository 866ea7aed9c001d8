#include "robomill/jobs/learn.hpp"

#include "robomill/base/printable.hpp"
#include "robomill/jobs/verbs/records.hpp"
#include "robomill/monitor/files/machine_json.hpp"

namespace robomill::jobs {
namespace {

Outcome run_learn_verb(const VerbJob& job, Progress& progress) {
  const LearnResult result = run_learn(job.input(), job.files("learn"), progress);
  Outcome outcome = {.summary = monitor::machine_text(result.machine), .json = monitor::machine_json(result.machine)};
  outcome.page = [notes = result.notes, summary = outcome.summary] {
    page::Report page;
    page.title = "A machine, as the chatter monitor learnt it";
    page.notes = notes;
    page.summary = summary;
    return page;
  };
  for (const std::string& note : result.notes) outcome.summary += printable(note) + "\n";
  if (!job.output.empty()) write_text(job.output, outcome.json);
  return outcome;
}

}  // namespace

Verb learn_verb() {
  return {.name = "monitor --learn",
          .purpose = "recordings without chatter to what this machine shows: fewer false alarms",
          .more = "Idling, running up, stable cuts. process.machine of monitor.toml then names machine.json.",
          .example = "monitor monitor.toml --learn air.wav,stable.wav -o machine.json",
          .readme = "robomill/monitor/README.md",
          .input = file_option("monitor", "monitor.toml: channels, process, detector", {"monitor"}, true),
          .document = Document::machine,
          .options = {{.name = "learn",
                       .meaning = "learn the machine from these recordings without chatter: air.wav,stable.wav",
                       .takes = Takes::texts,
                       .required = true}},
          .run = &run_learn_verb};
}

}  // namespace robomill::jobs
