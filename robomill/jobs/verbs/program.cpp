#include "robomill/jobs/init.hpp"
#include "robomill/jobs/verbs/records.hpp"

namespace robomill::jobs {

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
                .words = words_of(template_names)},
      .computes = false,
      .options = {{.name = "output",
                   .meaning = "write here (default: KIND.toml); - writes to standard output",
                   .takes = Takes::new_file,
                   .flag = "-o,--output"},
                  flag_option("example", "made-up values that run as they are, each listed as assumed until changed"),
                  flag_option("interactive", "ask for what is known, in shop terms and any unit"),
                  {.name = "data",
                   .meaning = "of hits and job: a folder with recorded hits (default: that of the file)",
                   .takes = Takes::file},
                  {.name = "robot",
                   .meaning = "of a cell: an arm by its name, kuka-kr210-r2700 for one",
                   .takes = Takes::text}}};
}

namespace {

std::vector<VerbOption> monitor_options() {
  return {
      {.name = "input",
       .meaning = "a recording (.wav .csv .txt .mat .uff), - for standard input, or mqtt://HOST:PORT/TOPIC "
                  "(mqtts:// with TLS); default: mqtt.topic of monitor.toml",
       .takes = Takes::text},
      {.name = "format",
       .meaning = "of standard input, or of a file whatever its ending (default: auto)",
       .takes = Takes::word,
       .words = {"auto", "f32", "i16", "csv"}},
      flag_option("live", "do not keep standard input waiting: leave out hops that come too fast"),
      flag_option("every_window", "an event each hop, not only on change"),
      flag_option("watch", "level, score, state and spectrum on standard error"),
      {.name = "record", .meaning = "a folder for the seconds before each alarm, as WAV", .takes = Takes::new_folder},
      {.name = "metrics_port",
       .meaning = "answer GET /metrics on loopback; 0: any port that is free",
       .takes = Takes::whole,
       .at_least = 0,
       .at_most = 65535},
      {.name = "seconds",
       .meaning = "process so much of the stream, then end",
       .takes = Takes::number,
       .unit = "s",
       .above = 0}};
}

Verb monitor_verb() {
  return {.name = "monitor",
          .purpose = "a running accelerometer to an alarm, the mode that chatters and a better speed",
          .more = "From WAV, CSV, MAT, standard input or MQTT.",
          .example = "monitor monitor.toml --input cut.wav -o events.jsonl",
          .readme = "robomill/live/README.md, robomill/monitor/README.md",
          .input = file_option("monitor", "monitor.toml: channels, process, detector", "monitor", true),
          .options = monitor_options()};
}

Verb serve_verb() {
  return {.name = "serve",
          .purpose = "the page of a folder, over HTTP",
          .more =
              "Files edited with their errors, jobs run, the γ of a program dragged, lobes that follow sliders, "
              "hammer hits as they are made, the monitor live.",
          .example = "serve jobs/ --port 8437",
          .readme = "robomill/serve/README.md",
          .input = {.name = "folder",
                    .meaning = "what is served, and nothing outside it (default: the current folder)",
                    .takes = Takes::file},
          .computes = false,
          .options = {{.name = "port",
                       .meaning = "to listen at; 0: any that is free (default: 8437)",
                       .takes = Takes::whole,
                       .at_least = 0,
                       .at_most = 65535},
                      {.name = "host",
                       .meaning = "address to listen at, or localhost (default: 127.0.0.1); one that other machines "
                                  "reach needs a token",
                       .takes = Takes::text},
                      {.name = "token",
                       .meaning = "that whoever asks must know: 16 or more letters and digits; other users of this "
                                  "machine see it in ps",
                       .takes = Takes::text},
                      {.name = "token_file",
                       .meaning = "a file that has the token alone",
                       .takes = Takes::file,
                       .excludes = "token"},
                      {.name = "job_memory_mb",
                       .meaning = "that a job may have (default: half the machine's)",
                       .takes = Takes::whole,
                       .at_least = 100,
                       .at_most = 100'000'000}}};
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
          .input = {.name = "format",
                    .meaning = "roff, or the table of the verbs in Markdown (default: roff)",
                    .takes = Takes::word,
                    .words = {"roff", "markdown"}},
          .computes = false};
}

}  // namespace

std::vector<Verb> program_verbs() {
  return {monitor_verb(), serve_verb(), completion_verb(), man_verb()};
}

}  // namespace robomill::jobs
