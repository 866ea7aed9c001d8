#include "testing/page/report_sample.hpp"

#include "testing/page/blocks_sample.hpp"
#include "testing/page/forces_sample.hpp"
#include "testing/page/monitor_sample.hpp"
#include "testing/page/plan_sample.hpp"
#include "testing/page/smooth_sample.hpp"
#include "testing/page/structure_sample.hpp"

namespace robomill::page {

Report sample_report() {
  Report report;
  report.title = "Cutting conditions without chatter: sample of the page";
  report.created = "Made by the tests of robomill from invented lobes";
  report.frf = sample_frf();
  report.fitted = sample_fitted();
  report.measured = sample_measured();
  report.assembly = sample_assembly();
  report.modes = sample_modes();
  report.lobes = sample_lobes();
  report.plan = sample_plan();
  report.recordings = sample_recordings();
  report.forces = sample_forces();
  report.blocks = sample_blocks();
  report.smooth = sample_smooth();
  report.motion = sample_motion();
  report.monitor = sample_monitor();
  report.calibration = sample_calibration();
  report.files = {{"frf", "tip.uff", "frequency response functions"},
                  {"modes", "modes.json", "modal parameters"},
                  {"lobes", "lobes.json", "limit and boundary"}};
  return report;
}

}  // namespace robomill::page
