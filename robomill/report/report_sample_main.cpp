#include <fstream>
#include <iostream>
#include <string_view>

#include "robomill/report/forces_sample.hpp"
#include "robomill/report/monitor_sample.hpp"
#include "robomill/report/plan_sample.hpp"
#include "robomill/report/report_sample.hpp"
#include "robomill/report/structure_sample.hpp"

/// report_sample OUT.html [sample|hostile]: the sample page for the browser test; hostile puts markup into every text
/// it can.
int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: report_sample OUT.html [sample|hostile]\n";
    return 2;
  }
  robomill::report::Report report = robomill::report::sample_report();
  if (argc > 2 && std::string_view(argv[2]) == "hostile") {
    const std::string evil =
        "</script><script>throw new Error('escaped')</script><img src=x onerror=alert(1)><!--<script>";
    report.title = evil;
    report.frf = robomill::report::sample_frf(evil);
    report.assembly = robomill::report::sample_assembly(evil);
    report.plan = robomill::report::sample_plan(evil);
    report.recordings = robomill::report::sample_recordings(evil);
    report.forces = robomill::report::sample_forces(evil);
    report.smooth->facts = {{evil, evil}};
    report.smooth->notes = {evil};
    report.smooth->skipped = {evil};
    report.smooth->methods.front().name = evil;
    report.smooth->methods.front().uses.front().what = evil;
    report.monitor = robomill::report::sample_monitor(evil);
    report.calibration = robomill::report::sample_calibration(evil);
  }
  std::ofstream(argv[1], std::ios::binary) << robomill::report::report_html(report);
  return 0;
}
