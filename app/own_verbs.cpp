#include <string_view>
#include <vector>

#include "robomill/jobs/files/schemas.hpp"
#include "robomill/jobs/init.hpp"
#include "robomill/jobs/verbs/new_option.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

using jobs::flag_option;
using jobs::plain_option;
using jobs::positive_option;
using jobs::Takes;
using jobs::Verb;
using jobs::VerbOption;
using jobs::whole_option;
using jobs::word_option;

Verb init_verb() {
  return {
      .name = "init",
      .purpose = "a commented file in which what only you know is to be filled in",
      .more =
          "--example writes one that runs as it is, --interactive asks in shop terms, in any units. Columns and "
          "directions of recorded hits are guessed.",
      .example = "init job -o job.toml --interactive",
      .readme = "robomill/jobs/README.md",
      .input = {.name = "kind",
                .meaning = "what the file describes",
                .takes = Takes::word,
                .required = true,
                .words = jobs::words_of(jobs::template_names)},
      .computes = false,
      .options = {
          {.name = "output",
           .meaning = "write here (default: KIND.toml); - writes to standard output",
           .takes = Takes::new_file,
           .flag = "-o,--output"},
          flag_option("example", "made-up values that run as they are, each listed as assumed until changed"),
          flag_option("interactive", "ask for what is known, in shop terms and any unit"),
          plain_option("data", "of hits and job: a folder with recorded hits (default: that of the file)", Takes::file),
          plain_option("robot", "of a cell: an arm by its name, kuka-kr210-r2700 for one")}};
}

std::vector<VerbOption> monitor_options() {
  return {
      plain_option("input",
                   "a recording (.wav .csv .txt .mat .uff .h5 .npy .npz .lvm .tdms; several times where its channels "
                   "are in files of their own), - for standard input, or mqtt://HOST:PORT/TOPIC (mqtts:// with "
                   "TLS); default: mqtt.topic of monitor.toml",
                   Takes::files),
      word_option("format", "of standard input, or of a file whatever its ending (default: auto)",
                  {"auto", "f32", "i16", "csv"}),
      flag_option("live", "do not keep standard input waiting: leave out hops that come too fast"),
      flag_option("every_window", "an event each hop, not only on change"),
      flag_option("why", "each change of state, and each window, with its test, values and thresholds"),
      flag_option("watch", "level, score, state and spectrum on standard error"),
      plain_option("record", "a folder for the seconds before each alarm, as WAV", Takes::new_folder),
      whole_option("metrics_port", "answer GET /metrics on loopback; 0: any port that is free", 0, 65535),
      positive_option("seconds", "process so much of the stream, then end", "s")};
}

Verb monitor_verb() {
  return {.name = "monitor",
          .purpose = "a running accelerometer to an alarm, the mode that chatters and a better speed",
          .more = "From WAV, CSV, MAT, standard input or MQTT.",
          .example = "monitor monitor.toml --input cut.wav -o events.jsonl",
          .readme = "robomill/live/README.md, robomill/monitor/README.md",
          .input = jobs::file_option("monitor", "monitor.toml: channels, process, detector", {"monitor"}, true),
          .options = monitor_options()};
}

Verb stream_verb() {
  VerbOption cell = jobs::file_option("cell", "cell.toml: the robot, its joints' limits, [smoothing]", {"cell"}, true);
  cell.job_gives = true;
  return {.name = "smooth --stream",
          .purpose = "an NC program to set-points by the clock, one a sample period, with feed hold, override and stop",
          .more =
              "Lines of JSON, or CSV by the ending of -o. Commands come from standard input in lines: hold, resume, "
              "override SHARE (0 to 1.5), stop, status. At the end deadline misses and jitter on standard error; "
              "--report FILE.json has them.",
          .example = "smooth part.ngc --cell cell.toml --stream --listen 5005 -o setpoints.csv",
          .readme = "robomill/path/README.md",
          .input = jobs::file_option(
              "program", "an NC program: .ngc .nc .gcode, .apt .cls .cl .ncl .aptsource, .csv; or a job.toml",
              {"program"}, true),
          .options = {{.name = "stream", .meaning = "run the program in real time", .required = true},
                      cell,
                      plain_option("listen",
                                   "take commands here too: PORT on loopback (0: any that is free), HOST:PORT, or the "
                                   "path, with a slash, of a UNIX socket"),
                      flag_option("held", "begin at rest, until resume is commanded"),
                      {.name = "posture_deg",
                       .meaning = "begin the program as near to q1,q2,… as possible, in degrees (default: as at home)",
                       .takes = Takes::numbers,
                       .flag = "--posture",
                       .unit = "deg"}}};
}

Verb serve_verb() {
  return {.name = "serve",
          .purpose = "the page of a folder, over HTTP",
          .more =
              "Files edited with their errors, jobs run, the γ of a program dragged, lobes that follow sliders, "
              "hammer hits as they are made, the monitor live.",
          .example = "serve jobs/ --port 8437",
          .readme = "robomill/serve/README.md",
          .input = plain_option("folder", "what is served, and nothing outside it (default: the current folder)",
                                Takes::file),
          .computes = false,
          .options = {
              whole_option("port", "to listen at; 0: any that is free (default: 8437)", 0, 65535),
              plain_option("host",
                           "address to listen at, or localhost (default: 127.0.0.1); one that other machines "
                           "reach needs a token"),
              plain_option("token",
                           "that whoever asks must know: 16 or more letters and digits; other users of this "
                           "machine see it in ps"),
              {.name = "token_file",
               .meaning = "a file that has the token alone",
               .takes = Takes::file,
               .excludes = "token"},
              whole_option("job_memory_mb", "that a job may have (default: half the machine's)", 100, 100'000'000)}};
}

Verb schema_verb() {
  return {
      .name = "schema",
      .purpose = "the JSON Schema of a document; without a name the names of all",
      .example = "schema lobes.json",
      .readme = "robomill/jobs/README.md",
      .input = word_option("document", "which document", {jobs::schema_names().begin(), jobs::schema_names().end()}),
      .computes = false};
}

Verb completion_verb() {
  return {.name = "completion",
          .purpose = "a shell's completion of verbs, options and words",
          .example = "completion bash -o robomill.bash",
          .readme = "robomill/jobs/README.md",
          .input = {.name = "shell", .meaning = "the shell", .takes = Takes::word, .required = true, .words = {"bash"}},
          .computes = false};
}

Verb man_verb() {
  return {.name = "man",
          .purpose = "the manual page robomill(1)",
          .example = "man -o robomill.1",
          .readme = "robomill/jobs/README.md",
          .input = word_option("format", "roff, or the table of the verbs in Markdown (default: roff)",
                               {"roff", "markdown"}),
          .computes = false};
}

}  // namespace

std::vector<jobs::Verb> own_verbs() {
  return {init_verb(),  monitor_verb(), jobs::learn_verb(), stream_verb(),
          serve_verb(), schema_verb(),  completion_verb(),  man_verb()};
}

}  // namespace robomill::app
