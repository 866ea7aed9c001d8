#include "testing/page/report_sample.hpp"

#include "testing/page/blocks_sample.hpp"
#include "testing/page/cell_sample.hpp"
#include "testing/page/cut_sample.hpp"
#include "testing/page/forces_sample.hpp"
#include "testing/page/identified_sample.hpp"
#include "testing/page/monitor_sample.hpp"
#include "testing/page/plan_sample.hpp"
#include "testing/page/smooth_sample.hpp"
#include "testing/page/structure_sample.hpp"
#include "testing/page/study_sample.hpp"

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
  report.cell = sample_cell();
  report.monitor = sample_monitor();
  report.calibration = sample_calibration();
  report.joint = sample_joint();
  report.tools = sample_tools();
  report.sweep = sample_sweep();
  report.comparison = sample_comparison();
  report.postures = sample_postures();
  report.statistics = sample_statistics();
  report.study_points = sample_study_points();
  report.explanation = sample_explanation();
  report.simulation = sample_simulation();
  report.vibration = sample_vibration();
  report.coefficients = sample_coefficients();
  report.stiffness = sample_stiffness();
  report.assumed = sample_assumed();
  report.notes = {"A note that no document holds."};
  report.files = {{"frf", "tip.uff", "frequency response functions"},
                  {"modes", "modes.json", "modal parameters"},
                  {"lobes", "lobes.json", "limit and boundary"}};
  return report;
}

}  // namespace robomill::page
