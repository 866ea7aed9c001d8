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
constexpr int teeth = 3;

/// The eight modes of data/robot-modes.toml.
modal::ModalModel robot_modes() {
  struct Row {
    double frequency_hz, damping_percent;
    complex<double> left_x, left_y, right_x, right_y;
  };
  const std::array<Row, 8> rows = {
      {{17.40, 1.27, {-0.52, 0.88}, {-92.57, 23.71}, {-1.13, -18.25}, {-8.9, 93.36}},
       {19.57, 2.23, {-41.87, 24.01}, {-0.025, -0.49}, {-118.74, 168.83}, {35.74, -40.36}},
       {49.86, 10, {51.08, 147.75}, {-0.47, 0.45}, {-149.35, 15.18}, {12.66, -25.99}},
       {53.51, 10, {0.66, -0.09}, {-94.27, -136.68}, {-34.35, -57.71}, {14.96, -155.42}},
       {57.77, 10, {-0.3, -0.77}, {-27.26, 163.60}, {15.67, -53.87}, {-58.20, -145.84}},
       {67.26, 10, {-105.83, -82.49}, {0.51, 0.49}, {-93.87, 88.52}, {12.15, -16.74}},
       {540.08, 0.68, {-0.81, 0.61}, {-317.91, -148.16}, {19.27, -26.45}, {173.44, 303.95}},
       {543.67, 2.1, {-246.87, 215.31}, {0.24, -0.32}, {-269.37, 275.61}, {36.20, 7.45}}}};
  modal::ModalModel model;
  model.excitations = {Dof{0, Axis::x}, Dof{0, Axis::y}};
  model.responses = model.excitations;
  for (const Row& row : rows) {
    modal::Mode mode;
    mode.frequency_hz = row.frequency_hz;
    mode.damping_ratio = row.damping_percent / 100.0;
    mode.left = Eigen::Vector2cd(row.left_x, row.left_y) * 1e-4;
    mode.right = Eigen::Vector2cd(row.right_x, row.right_y) * 1e-4;
    mode.frequency_std_hz = 2e-4 * mode.frequency_hz;
    mode.damping_ratio_std = 0.01 * mode.damping_ratio;
    model.modes.push_back(mode);
  }
  return model;
}

complex<double> receptance(const modal::ModalModel& model, int response, int excitation, double frequency_hz,
                           const std::vector<int>& keep = {}) {
  const complex<double> s(0.0, 2.0 * std::numbers::pi * frequency_hz);
  complex<double> sum = 0.0;
  for (std::size_t k = 0; k < model.modes.size(); ++k) {
    if (!keep.empty() && std::ranges::find(keep, static_cast<int>(k) + 1) == keep.end()) continue;
    const modal::Mode& mode = model.modes[k];
    const double omega = 2.0 * std::numbers::pi * mode.frequency_hz;
    const complex<double> pole(-mode.damping_ratio * omega, omega * std::sqrt(1.0 - std::pow(mode.damping_ratio, 2)));
    const complex<double> residue = mode.right[response] * mode.left[excitation];
    sum += residue / (s - pole) + std::conj(residue) / (s - std::conj(pole));
  }
  return sum;
}

void add_frfs(Report& report) {
  Random random(7);
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
      const complex<double> exact = receptance(*report.model, response, excitation, report.frf_frequency_hz[i]);
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

/// Limit depth of the feed direction alone: b = -1 / (2 Ks Re G N*) at each chatter frequency, its speeds from the
/// phase.
void add_lobes(Report& report, const std::string& label, const std::vector<int>& keep) {
  const double specific_force_n_per_m2 = 712e6;
  const double teeth_in_cut = 0.09;
  Lobes lobes;
  lobes.label = label;
  lobes.modes = keep;
  lobes.searched_depth_m = 3.0 * units::mm;
  lobes.spindle_speed_rad_per_s = Eigen::VectorXd::LinSpaced(241, 4000.0, 16000.0) * units::rpm;
  lobes.limit_depth_m.setConstant(241, missing);
  std::vector<BoundaryPoint> lowest(241);
  for (double f = 8.0; f < 900.0; f += 0.02) {
    const complex<double> g = receptance(*report.model, 0, 0, f, keep) + receptance(*report.model, 1, 1, f, keep);
    if (g.real() >= 0.0) continue;
    const double depth = -1.0 / (2.0 * specific_force_n_per_m2 * teeth_in_cut * g.real());
    if (depth > lobes.searched_depth_m) continue;
    const double waves = 0.5 + std::atan2(g.imag(), g.real()) / std::numbers::pi;
    for (int lobe = 0; lobe < 40; ++lobe) {
      const double speed_rad_per_s = 2.0 * std::numbers::pi * f / (teeth * (lobe + waves - std::floor(waves)));
      const double at = (speed_rad_per_s / units::rpm - 4000.0) / 50.0;
      if (!(at >= 0.0 && at <= 240.0)) continue;
      const auto index = std::lround(at);
      if (lobes.limit_depth_m[index] <= depth) continue;
      lobes.limit_depth_m[index] = depth;
      const int mode = f > 541.5 ? 8 : f > 300.0 ? 7 : f > 40.0 ? 4 : 1;
      const BoundaryKind kind = index % 40 == 0 ? BoundaryKind::flip : BoundaryKind::hopf;
      lowest[static_cast<std::size_t>(index)] = {speed_rad_per_s, depth, f, kind, {mode}};
    }
  }
  for (const BoundaryPoint& point : lowest) {
    if (point.mode.known()) lobes.boundary.push_back(point);
  }
  if (keep.empty()) {
    lobes.band.label = "5 to 95 % of 200 samples";
    lobes.band.spindle_speed_rad_per_s = lobes.spindle_speed_rad_per_s;
    lobes.band.low_m = 0.9 * lobes.limit_depth_m;
    lobes.band.high_m = 1.15 * lobes.limit_depth_m;
    lobes.map_speed_rad_per_s = Eigen::VectorXd::LinSpaced(61, 4000.0, 16000.0) * units::rpm;
    lobes.map_depth_m = Eigen::VectorXd::LinSpaced(31, 0.0, 3.0) * units::mm;
    lobes.spectral_radius.resize(31, 61);
    for (Eigen::Index j = 0; j < 61; ++j) {
      const double limit = lobes.limit_depth_m[4 * j];
      for (Eigen::Index i = 0; i < 31; ++i) {
        const double depth = lobes.map_depth_m[i];
        lobes.spectral_radius(i, j) = std::sqrt(0.4 + 0.6 * depth / (std::isfinite(limit) ? limit : 3.2 * units::mm));
      }
    }
  }
  report.lobes.push_back(lobes);
}

void add_fit(Report& report) {
  FitSummary fit;
  fit.method = "hybrid";
  fit.relative_error = 0.0213;
  fit.mean_relative_error = 0.0187;
  fit.band_from_hz = 5.0;
  fit.band_to_hz = 1000.0;
  fit.convergence.resize(24);
  for (Eigen::Index i = 0; i < 24; ++i) fit.convergence[i] = 0.0187 + 0.6 * std::exp(-0.45 * static_cast<double>(i));
  Random random(3);
  for (int order = 4; order <= 40; order += 2) {
    for (const modal::Mode& mode : report.model->modes) {
      const bool settled = order > 8 + static_cast<int>(mode.damping_ratio * 100.0);
      const double scatter = settled ? 1e-3 : 3e-2;
      fit.stabilisation.push_back({order, mode.frequency_hz * (1.0 + scatter * random.normal()), settled});
    }
    for (int k = 0; k < order / 6; ++k) fit.stabilisation.push_back({order, random.uniform(5.0, 1000.0), false});
  }
  report.fit = fit;
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
  report.model = robot_modes();
  report.limit_share = (Eigen::VectorXd(8) << 0.03, 0.02, 0.01, 0.02, 0.02, 0.01, 0.31, 0.58).finished();
  add_fit(report);
  add_frfs(report);
  add_prediction(report);
  add_lobes(report, "all modes", {});
  for (int k = 1; k < 8; k += 2) {
    add_lobes(report, "modes " + std::to_string(k) + "–" + std::to_string(k + 1), {k, k + 1});
  }
  report.plan = sample_plan(report.lobes.front());
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
