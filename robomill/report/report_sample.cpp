#include "robomill/report/report_sample.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/report/forces_sample.hpp"
#include "robomill/report/monitor_sample.hpp"
#include "robomill/report/plan_sample.hpp"
#include "robomill/report/smooth_sample.hpp"

namespace robomill::report {
namespace {

using modal::Axis;
using modal::Dof;
using std::complex;

void add_frfs(Report& report) {
  Random random(7);
  const modal::ModalModel model = sample_model();
  const Eigen::Index lines = 1991;
  report.frf_frequency_hz = Eigen::VectorXd::LinSpaced(lines, 5.0, 1000.0);
  const std::array<std::pair<int, int>, 4> names = {{{0, 0}, {1, 0}, {0, 1}, {1, 1}}};
  for (const auto& [response, excitation] : names) {
    FrfPlot frf;
    frf.name = {Dof{0, response == 0 ? Axis::x : Axis::y}, Dof{0, excitation == 0 ? Axis::x : Axis::y}};
    frf.measured.resize(lines);
    frf.fitted.resize(lines);
    frf.coherence.resize(lines);
    for (Eigen::Index i = 0; i < lines; ++i) {
      const complex<double> exact = sample_receptance(model, response, excitation, report.frf_frequency_hz[i]);
      const complex<double> noise(random.normal(), random.normal());
      frf.fitted[i] = exact;
      frf.measured[i] = exact + 0.02 / std::numbers::sqrt2 * std::abs(exact) * noise + 2e-10 * noise;
      frf.coherence[i] = 1.0 / (1.0 + std::norm(0.03 * noise) + 1e-18 / std::norm(exact));
    }
    frf.grade = response == excitation ? Grade::good : Grade::fair;
    frf.trusted_from_hz = 8.0;
    frf.trusted_to_hz = 940.0;
    frf.relative_error = 0.021 + 0.002 * response;
    if (response != excitation) {
      frf.findings = {"coherence below 0.9 on 14 % of the band", "xy and yx differ by 38 %"};
      frf.remedies = {"hit again, closer to the axis", "check that the accelerometer sits where the hammer hits"};
    }
    report.frfs.push_back(frf);
  }
}

/// A tool in a holder that has nothing to do with the robot; what would be measured and predicted are its FRFs.
void add_prediction(Report& report) {
  const auto segment = [](double length_mm, double diameter_mm, double bore_mm, double modulus_gpa, double density) {
    return coupling::Segment{.length_m = length_mm * units::mm,
                             .diameter_m = diameter_mm * units::mm,
                             .inner_diameter_m = bore_mm * units::mm,
                             .youngs_modulus_pa = modulus_gpa * units::gpa,
                             .density_kg_per_m3 = density,
                             .loss_factor = 0.005};
  };
  Prediction prediction;
  coupling::Assembly& assembly = prediction.assembly;
  assembly.tool = {segment(26.0, 12.0, 0.0, 580.0, 14400.0), segment(7.0, 11.5, 2.0, 580.0, 14400.0),
                   segment(4.0, 12.0, 2.0, 580.0, 14400.0)};
  assembly.tool[0].flutes = 4;
  assembly.joint = coupling::Joint{.translational_stiffness_n_per_m = 2e7,
                                   .translational_damping_n_s_per_m = 40.0,
                                   .rotational_stiffness_n_m_per_rad = 5e4,
                                   .rotational_damping_n_m_s_per_rad = 0.5};
  assembly.holder.segments = {segment(30.0, 28.0, 12.0, 200.0, 7800.0), segment(22.5, 40.0, 0.0, 200.0, 7800.0),
                              segment(12.0, 63.0, 0.0, 200.0, 7800.0)};
  const FrfPlot& xx = report.frfs.front();
  for (Eigen::Index i = 0; i < report.frf_frequency_hz.size(); ++i) {
    const double f = report.frf_frequency_hz[i];
    if (f > 120.0 && f < 160.0) prediction.suspect_hz.push_back(f);
    if (f > 700.0 && f < 760.0) prediction.unreliable_hz.push_back(f);
  }
  prediction.peaks = {{xx.name, 543.9, 2.31e-6, 540.5}, {xx.name, 57.7, 0.85e-6, missing}};
  prediction.notes = {"The assembly is drawn beside FRFs of a robot; it serves to look at the page."};
  for (FrfPlot& frf : report.frfs) {
    frf.predicted = 1.1 * frf.fitted;
    frf.prediction_error = 0.1;
  }
  report.prediction = prediction;
}

}  // namespace

Report sample_report() {
  Report report;
  report.title = "Cutting conditions without chatter: sample of the page";
  report.created = "Made by the tests of robomill from invented lobes";
  add_frfs(report);
  add_prediction(report);
  report.modes = sample_modes();
  report.lobes = sample_lobes();
  report.plan = sample_plan();
  report.recordings = sample_recordings();
  report.forces = sample_forces();
  report.smooth = sample_smooth();
  report.monitor = sample_monitor();
  report.calibration = sample_calibration();
  for (int k = 1; k <= 10; ++k) {
    HitRow hit{"hit_" + std::string(k <= 5 ? "x_" : "y_") + std::to_string((k - 1) % 5 + 1) + ".csv",
               k <= 5 ? "x" : "y"};
    if (k == 4) hit.accepted = false;
    if (k == 4) hit.reasons = {"double hit: a second one of 7 % of the peak after 3.1 ms"};
    report.hits.push_back(hit);
  }
  report.files = {{"frf", "tip.uff", "frequency response functions"},
                  {"modes", "modes.json", "modal parameters"},
                  {"lobes", "lobes.json", "limit and boundary"}};
  return report;
}

}  // namespace robomill::report
