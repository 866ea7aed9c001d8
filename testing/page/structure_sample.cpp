#include "testing/page/structure_sample.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "robomill/base/random.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/modal/files/modes_files.hpp"
#include "robomill/modal/fit.hpp"

namespace robomill::page {
namespace {

using Json = nlohmann::ordered_json;
using modal::Axis;
using modal::Dof;
using std::complex;

/// xx, yx, xy, yy from 5 to 1000 Hz. @param noise  relative; 0: exact
modal::FrfSet frfs(double factor, double noise) {
  Random random(7);
  const modal::ModalModel model = sample_model();
  modal::FrfSet set;
  set.frequency_hz = Eigen::VectorXd::LinSpaced(1991, 5.0, 1000.0);
  for (const int excitation : {0, 1}) {
    for (const int response : {0, 1}) {
      modal::Frf frf;
      frf.name = {Dof{0, response == 0 ? Axis::x : Axis::y}, Dof{0, excitation == 0 ? Axis::x : Axis::y}};
      frf.receptance.resize(set.frequency_hz.size());
      if (noise > 0.0) frf.coherence.resize(set.frequency_hz.size());
      for (Eigen::Index i = 0; i < set.frequency_hz.size(); ++i) {
        const complex<double> exact = factor * sample_receptance(model, response, excitation, set.frequency_hz[i]);
        const complex<double> unit(random.normal(), random.normal());
        frf.receptance[i] = exact + noise * (std::abs(exact) / std::numbers::sqrt2 + 1e-8) * unit;
        if (noise > 0.0) frf.coherence[i] = 1.0 / (1.0 + std::norm(0.03 * unit) + 1e-18 / std::norm(exact));
      }
      set.frfs.push_back(std::move(frf));
    }
  }
  return set;
}

Json segment(double length_mm, double diameter_mm, double bore_mm, double modulus_gpa, double density) {
  return {{"length_mm", length_mm},       {"diameter_mm", diameter_mm},
          {"inner_diameter_mm", bore_mm}, {"youngs_modulus_gpa", modulus_gpa},
          {"density_kg_per_m3", density}, {"poissons_ratio", 0.3},
          {"loss_factor", 0.005},         {"beam", "timoshenko"}};
}

}  // namespace

modal::ModalModel sample_model() {
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

complex<double> sample_receptance(const modal::ModalModel& model, int response, int excitation, double frequency_hz,
                                  const std::vector<int>& keep) {
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

std::string sample_modes() {
  modal::FitResult fit;
  fit.model = sample_model();
  fit.relative_error = 0.0213;
  fit.mean_relative_error = 0.0187;
  fit.band_low_hz = 5.0;
  fit.band_high_hz = 1000.0;
  fit.status = modal::FitResult::Status::converged;
  for (int i = 0; i < 24; ++i) fit.best.push_back(0.0187 + 0.6 * std::exp(-0.45 * i));
  Random random(3);
  const auto add = [&](int order, double frequency_hz, bool stable) {
    fit.stabilisation.push_back({.order = order,
                                 .frequency_hz = frequency_hz,
                                 .damping_ratio = 0.02,
                                 .frequency_stable = stable,
                                 .damping_stable = stable,
                                 .vector_stable = stable});
  };
  for (int order = 4; order <= 40; order += 2) {
    for (const modal::Mode& mode : fit.model.modes) {
      const bool stable = order > 8 + static_cast<int>(mode.damping_ratio * 100.0);
      add(order, mode.frequency_hz * (1.0 + (stable ? 1e-3 : 3e-2) * random.normal()), stable);
    }
    for (int k = 0; k < order / 6; ++k) add(order, random.uniform(5.0, 1000.0), false);
  }
  return modal::modes_json(fit);
}

std::string sample_frf(const std::string& text) {
  const auto said = [&](const char* own) { return text.empty() ? std::string(own) : text; };
  Json json = Json::parse(modal::frf_json(frfs(1.1, 0.02)));
  json["hits"] = Json::array();
  for (int k = 1; k <= 10; ++k) {
    const bool accepted = k != 4;
    const std::string file = "hit_" + std::string(k <= 5 ? "x_" : "y_") + std::to_string((k - 1) % 5 + 1) + ".csv";
    Json reasons = Json::array();
    if (!accepted) reasons.push_back(said("double hit: a second one of 7 % of the peak after 3.1 ms"));
    json["hits"].push_back({{"file", accepted ? file : said(file.c_str())},
                            {"accepted", accepted},
                            {"reasons", reasons},
                            {"peak_force_n", 310.0},
                            {"pulse_width_s", 3e-4},
                            {"second_pulse_ratio", accepted ? 0.004 : 0.07}});
  }
  for (const char* name : {"xx", "yx", "xy", "yy"}) {
    const bool direct = name[0] == name[1];
    Json faults = Json::array();
    Json remedies = Json::array();
    if (!direct) {
      faults = {said("coherence below 0.9 on 14 % of the band"), "xy and yx differ by 38 %"};
      remedies = {said("hit again, closer to the axis"), "check that the accelerometer sits where the hammer hits"};
    }
    json["grades"][name] = {{"grade", direct ? "good" : "usable"},
                            {"hits", name[1] == 'x' ? 4 : 5},
                            {"mean_coherence", direct ? 0.998 : 0.93},
                            {"relative_noise", direct ? 0.01 : 0.06},
                            {"reciprocity_error", direct ? Json() : Json(0.38)},
                            {"excited_band_hz", {5, 940}},
                            {"lowest_trustworthy_frequency_hz", 8},
                            {"peaks", Json::array()},
                            {"faults", std::move(faults)},
                            {"remedies", std::move(remedies)}};
  }
  return json.dump();
}

std::string sample_fitted() {
  return modal::frf_json(frfs(1.0, 0.0));
}

std::string sample_measured() {
  return modal::frf_json(frfs(1.0, 0.03));
}

std::string sample_assembly(const std::string& text) {
  const auto said = [&](const char* own) { return text.empty() ? std::string(own) : text; };
  Json fluted = segment(26.0, 12.0, 0.0, 580.0, 14400.0);
  fluted["flutes"] = 4;
  fluted["flute_diameter_ratio"] = 0.8;
  Json suspect = Json::array();
  Json unreliable = Json::array();
  for (double f = 120.5; f < 160.0; f += 0.5) suspect.push_back(f);
  for (double f = 700.5; f < 760.0; f += 0.5) unreliable.push_back(f);
  const auto peak = [](double at_hz, double receptance_m_per_n, const Json& measured_hz) -> Json {
    return {{"frf", "xx"},
            {"frequency_hz", at_hz},
            {"receptance_m_per_n", receptance_m_per_n},
            {"measured_frequency_hz", measured_hz}};
  };
  const Json json = {
      {"document", "assembly/1"},
      {"file", said("assembly.toml")},
      {"tool", Json::array({fluted, segment(7.0, 11.5, 2.0, 580.0, 14400.0), segment(4.0, 12.0, 2.0, 580.0, 14400.0)})},
      {"joint",
       {{"translational_stiffness_n_per_m", 2e7},
        {"translational_damping_n_s_per_m", 40.0},
        {"rotational_stiffness_n_m_per_rad", 5e4},
        {"rotational_damping_n_m_s_per_rad", 0.5},
        {"cross_stiffness_n_per_rad", 0.0},
        {"points", 1}}},
      {"holder",
       {{"segments", Json::array({segment(30.0, 28.0, 12.0, 200.0, 7800.0), segment(22.5, 40.0, 0.0, 200.0, 7800.0),
                                  segment(12.0, 63.0, 0.0, 200.0, 7800.0)})}}},
      {"peaks", Json::array({peak(543.9, 2.31e-6, 540.5), peak(57.7, 0.85e-6, nullptr)})},
      {"relative_error", {{"xx", 0.1}, {"yy", 0.1}}},
      {"suspect_hz", std::move(suspect)},
      {"unreliable_hz", std::move(unreliable)},
      {"notes", Json::array({said("The assembly is drawn beside FRFs of a robot; it serves to look at the page.")})}};
  return json.dump();
}

}  // namespace robomill::page
