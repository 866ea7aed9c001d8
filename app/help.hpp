#pragma once
#include <string_view>

namespace robomill::app {

/// What the help of a verb ends with.
struct VerbHelp {
  std::string_view verb;           ///< "cell check": of a verb below another one
  std::string_view example;        ///< without the program's name
  std::string_view documentation;  ///< files of the source tree
};

inline constexpr VerbHelp verb_helps[] = {
    {"calibrate", "calibrate recordings.toml -o monitor.toml", "docs/formats.md, robomill/monitor/README.md"},
    {"cell check", "cell check cell.toml --joints 0,-80,108,0,62,0 --report cell.html",
     "docs/formats.md, robomill/jobs/README.md"},
    {"cell check", "cell check cell.toml --joints 0,-90,90,0,0,0", "docs/formats.md, robomill/robot/README.md"},
    {"coefficients", "coefficients slots.csv --teeth 4 -o coefficients.toml",
     "docs/formats.md, robomill/cutting/README.md"},
    {"couple", "couple assembly.toml -o tip.uff", "docs/formats.md, robomill/coupling/README.md"},
    {"explain", "explain --peaks 325,667 --rpm 6500 --teeth 3 --modes modes.json",
     "docs/formats.md, robomill/stability/README.md"},
    {"forces", "forces forces.toml -o forces.csv --report forces.html", "docs/formats.md, robomill/cutting/README.md"},
    {"frf", "frf hits.toml -o tip.uff", "docs/formats.md, robomill/modal/README.md"},
    {"init", "init job -o job.toml --interactive", "docs/formats.md, robomill/jobs/README.md"},
    {"joint", "joint assembly.toml --measured tip.uff -o joint.json", "docs/formats.md, robomill/coupling/README.md"},
    {"lobes", "lobes lobes.toml --at 6500,0.8 -o lobes.json", "docs/formats.md, robomill/stability/README.md"},
    {"modes", "modes tip.uff --band 50,2000 -o modes.json", "docs/formats.md, robomill/modal/README.md"},
    {"monitor", "monitor monitor.toml --input cut.wav -o events.jsonl",
     "docs/formats.md, robomill/live/README.md, robomill/monitor/README.md"},
    {"plan", "plan job.toml -o out/", "docs/formats.md, robomill/jobs/README.md"},
    {"serve", "serve jobs/ --port 8437", "docs/formats.md, robomill/serve/README.md"},
    {"simulate", "simulate lobes.toml --at 6500,0.6 --seconds 2 -o vibration.csv",
     "docs/formats.md, robomill/simulation/README.md"},
    {"smooth", "smooth part.ngc --cell cell.toml -o trajectory.csv --report smooth.html",
     "docs/formats.md, robomill/path/README.md"},
    {"stiffness", "stiffness loads.csv --cell cell.toml -o stiffness.toml",
     "docs/formats.md, robomill/robot/README.md"},
};

}  // namespace robomill::app
