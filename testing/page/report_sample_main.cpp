#include <fstream>
#include <iostream>
#include <string_view>

#include "testing/page/blocks_sample.hpp"
#include "testing/page/cell_sample.hpp"
#include "testing/page/cut_sample.hpp"
#include "testing/page/forces_sample.hpp"
#include "testing/page/identified_sample.hpp"
#include "testing/page/monitor_sample.hpp"
#include "testing/page/plan_sample.hpp"
#include "testing/page/report_sample.hpp"
#include "testing/page/smooth_sample.hpp"
#include "testing/page/structure_sample.hpp"
#include "testing/page/study_sample.hpp"

/// report_sample OUT.html [sample|hostile|long]: the sample page for the browser test; hostile puts markup into every
/// text it can; long has a program of 40,000 blocks and nothing else.
int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: report_sample OUT.html [sample|hostile|long]\n";
    return 2;
  }
  robomill::page::Report report = robomill::page::sample_report();
  if (argc > 2 && std::string_view(argv[2]) == "hostile") {
    const std::string evil =
        "</script><script>throw new Error('escaped')</script><img src=x onerror=alert(1)><!--<script>";
    report.title = evil;
    report.frf = robomill::page::sample_frf(evil);
    report.assembly = robomill::page::sample_assembly(evil);
    report.plan = robomill::page::sample_plan(evil);
    report.recordings = robomill::page::sample_recordings(evil);
    report.forces = robomill::page::sample_forces(evil);
    report.blocks = robomill::page::sample_blocks(evil);
    report.smooth = robomill::page::sample_smooth(evil);
    report.cell = robomill::page::sample_cell(evil);
    report.statistics = robomill::page::sample_statistics(evil);
    report.study_points = robomill::page::sample_study_points(evil);
    report.monitor = robomill::page::sample_monitor(evil);
    report.calibration = robomill::page::sample_calibration(evil);
    report.joint = robomill::page::sample_joint(evil);
    report.tools = robomill::page::sample_tools(evil);
    report.comparison = robomill::page::sample_comparison(evil);
    report.coefficients = robomill::page::sample_coefficients(evil);
    report.stiffness = robomill::page::sample_stiffness(evil);
    report.assumed = robomill::page::sample_assumed(evil);
    report.warnings = report.notes = {evil};
  }
  if (argc > 2 && std::string_view(argv[2]) == "long") {
    report = {};
    report.blocks = robomill::page::sample_blocks({}, 952);
  }
  std::ofstream(argv[1], std::ios::binary) << robomill::page::report_html(report);
  return 0;
}
