#include "robomill/report/forces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <string>

#include "robomill/base/random.hpp"
#include "robomill/report/forces_sample.hpp"
#include "robomill/report/json.hpp"
#include "robomill/report/report.hpp"
#include "robomill/report/thin.hpp"
#include "testing/support.hpp"

namespace robomill::report {
namespace {

using nlohmann::json;

TEST(ForcesJson, NumbersAreTheStructsInShopUnits) {
  const Forces forces = sample_forces();
  const json data = json::parse(forces_json(forces).dump());
  const auto& turn = data["revolution"];
  const ForceRevolution& r = *forces.revolution;
  ASSERT_EQ(turn["rotation_deg"].size(), 361u);
  EXPECT_EQ(turn["rotation_deg"][90].get<double>(), 90.0);
  EXPECT_NEAR(turn["fy_n"][40].get<double>(), r.force_n(1, 40), 1e-5 * r.peak_n.norm());
  EXPECT_NEAR(turn["mean_n"][2].get<double>(), r.mean_n.z(), 1e-5 * r.mean_n.norm());
  EXPECT_EQ(turn["chip_area_mm2"].get<double>(), 0.5);
  EXPECT_NEAR(turn["removal_rate_mm3_per_s"].get<double>(), 0.5 * 0.02 * 2 * 300.0, 1e-9);
  EXPECT_NEAR(turn["deflection_um"][0].get<double>(), 1.9 * r.mean_n.x(), 1e-5 * std::abs(1.9 * r.mean_n.x()));
  EXPECT_EQ(turn["on"], "tool");
  EXPECT_TRUE(turn["chatter_frequency_hz"].is_null());
  const auto& ring = turn["engagement"][23];
  EXPECT_NEAR(ring["height_mm"].get<double>(), 3.0 * (1.0 - std::cos(r.engagement[23].position_rad)), 1e-5);
  EXPECT_NEAR(ring["arcs"][0]["exit_deg"].get<double>(), r.engagement[23].arcs[0].exit_rad * 180.0 / std::numbers::pi,
              1e-3);
  EXPECT_EQ(data["program"]["blocks"], 800);
  EXPECT_EQ(data["program"]["cutting_blocks"], 800 - 17);
  EXPECT_NEAR(data["program"]["length_mm"].get<double>(), forces.path->path_m[799] * 1e3, 0.01);
  EXPECT_EQ(data["program"]["curves"]["path_mm"].size(), 800u);
  EXPECT_EQ(data["program"]["track"]["cuts"][0], false);
  EXPECT_TRUE(data["spindle_rotation"]["deflection_um"][0].is_null()) << "out of reach";
}

TEST(ForcesJson, WorstBlocksAreThoseWithTheHighestForce) {
  Forces forces = sample_forces();
  ForcePath& path = *forces.path;
  path.peak_force_n[0] = 1e9;  // in air: no block that cuts
  path.peak_force_n[77] = missing;
  path.line.array() += 12345678.0;  // more digits than other numbers keep
  const json program = json::parse(forces_json(forces).dump())["program"];
  const auto& worst = program["worst"];
  ASSERT_EQ(worst.size(), 10u);
  std::multiset<double, std::greater<>> all;
  for (Eigen::Index i = 2; i < 800; ++i) {
    if (path.cuts[static_cast<std::size_t>(i)] && i != 77) all.insert(path.peak_force_n[i]);
  }
  auto expected = all.begin();
  for (const auto& row : worst) {
    EXPECT_NEAR(row["peak_force_n"].get<double>(), *expected, 1e-5 * *expected);
    ++expected;
    const auto i = row["block"].get<Eigen::Index>() - 1;
    EXPECT_NEAR(row["tip_mm"][1].get<double>(), path.tip_m(1, i) * 1e3, 1e-3);
    EXPECT_EQ(row["line"].get<double>(), path.line[i]);
  }
  EXPECT_EQ(program["highest"]["peak_force_n"]["block"], worst[0]["block"]);
}

// Property: of a long program the highest of every curve is drawn, and what is drawn stays small.
TEST(ForcesJson, LongProgramsKeepTheirPeaks) {
  Random random(11);
  const Eigen::Index n = 60000;
  ForcePath path;
  path.block = Eigen::VectorXd::LinSpaced(n, 1.0, static_cast<double>(n));
  path.line = path.block;
  path.path_m = path.block * 1e-3;
  path.tip_m.setZero(3, n);
  path.mean_force_n.setZero(3, n);
  path.axial_depth_m.setConstant(n, 1e-3);
  path.radial_depth_m = path.axial_depth_m;
  const auto noise = [&] {
    Eigen::VectorXd values(n);
    for (double& value : values) value = random.uniform();
    return values;
  };
  path.peak_force_n = noise();
  path.torque_n_m = noise();
  path.peak_torque_n_m = noise();
  path.power_w = noise();
  path.deflection_m = 1e-6 * noise();
  path.cuts.assign(static_cast<std::size_t>(n), true);
  for (std::size_t i = 0; i < path.cuts.size(); i += 3) path.cuts[i] = false;
  Forces forces;
  forces.path = path;
  const json program = json::parse(forces_json(forces).dump())["program"];
  const std::map<std::string, double> highest = {{"peak_force_n", path.peak_force_n.maxCoeff()},
                                                 {"torque_n_m", path.torque_n_m.maxCoeff()},
                                                 {"peak_torque_n_m", path.peak_torque_n_m.maxCoeff()},
                                                 {"power_w", path.power_w.maxCoeff()},
                                                 {"deflection_um", 1e6 * path.deflection_m.maxCoeff()}};
  for (const auto& [name, value] : highest) {
    const auto shown = program["curves"][name].get<std::vector<double>>();
    ASSERT_LT(shown.size(), 4100u);
    EXPECT_NEAR(*std::ranges::max_element(shown), value, 1e-5) << name;
  }
  EXPECT_LT(program["track"]["x_mm"].size(), 6100u);
  const auto tracked = program["track"]["peak_force_n"].get<std::vector<double>>();
  EXPECT_NEAR(*std::ranges::max_element(tracked), path.peak_force_n.maxCoeff(), 1e-5);
}

// Property: increasing indices, and of every curve the extremes.
TEST(ThinTogether, KeepsThePeaksOfEveryCurve) {
  Random random(3);
  for (int round = 0; round < 30; ++round) {
    const auto n = static_cast<Eigen::Index>(100 + random.index(5000));
    const auto most = static_cast<Eigen::Index>(40 + random.index(400));
    std::vector<Eigen::VectorXd> curves(1 + random.index(5), Eigen::VectorXd(n));
    for (Eigen::VectorXd& curve : curves) {
      for (double& value : curve) value = random.normal();
    }
    const std::vector<Eigen::Index> keep = thin_together(curves, most);
    ASSERT_LE(static_cast<Eigen::Index>(keep.size()), most + 2 * static_cast<Eigen::Index>(curves.size()));
    EXPECT_EQ(std::ranges::adjacent_find(keep, std::greater_equal<>()), keep.end());
    for (const Eigen::VectorXd& curve : curves) {
      const Eigen::VectorXd shown = curve(keep);
      EXPECT_EQ(shown.maxCoeff(), curve.maxCoeff());
      EXPECT_EQ(shown.minCoeff(), curve.minCoeff());
    }
  }
}

TEST(ForcesJson, DeflectionAtAMarkLiesOnTheCurve) {
  Forces forces;
  forces.spindle_rotation = RedundancySweep{};
  RedundancySweep& sweep = *forces.spindle_rotation;
  sweep.rotation_rad = Eigen::Vector3d(-1.0, 0.0, 1.0);
  sweep.deflection_m = Eigen::Vector3d(4e-6, 2e-6, missing);
  sweep.best_rad = 0.0;
  sweep.used_rad = -0.5;
  const json data = json::parse(forces_json(forces).dump())["spindle_rotation"];
  EXPECT_EQ(data["best_um"].get<double>(), 2.0);
  EXPECT_EQ(data["used_um"].get<double>(), 3.0);
  EXPECT_TRUE(data["condition_number"].is_null());
  for (const double beyond : {-1.5, 0.5, 1.5, missing}) {
    sweep.used_rad = beyond;
    EXPECT_TRUE(json::parse(forces_json(forces).dump())["spindle_rotation"]["used_um"].is_null()) << beyond;
  }
}

template <class Change>
std::string rejected(Change&& change) {
  Forces forces = sample_forces();
  change(forces);
  return test::field_of([&] { forces.validate(); });
}

TEST(ForcesValidate, NamesTheMember) {
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_EQ(rejected([](Forces&) {}), "accepted");
  EXPECT_EQ(rejected([](Forces& f) { f.revolution->rotation_rad[3] = 0.0; }), "revolution.rotation_rad");
  EXPECT_EQ(rejected([](Forces& f) { f.revolution->force_n.resize(3, 7); }), "revolution.force_n");
  EXPECT_EQ(rejected([](Forces& f) { f.revolution->force_n(1, 5) = missing; }), "revolution.force_n");
  EXPECT_EQ(rejected([](Forces& f) { f.revolution->torque_n_m.resize(2); }), "revolution.torque_n_m");
  EXPECT_EQ(rejected([](Forces& f) { f.revolution->rms_n.y() = missing; }), "revolution.rms_n");
  EXPECT_EQ(rejected([](Forces& f) { f.revolution->power_w = missing; }), "accepted");
  EXPECT_EQ(rejected([&](Forces& f) { f.revolution->power_w = infinite; }), "revolution.power_w");
  EXPECT_EQ(rejected([](Forces& f) { f.revolution->engagement[2].height_m = 0.0; }),
            "revolution.engagement[2].height_m");
  EXPECT_EQ(rejected([](Forces& f) { f.revolution->engagement[1].arcs[0].exit_rad = -1.0; }),
            "revolution.engagement[1].arcs.exit_rad");
  EXPECT_EQ(rejected([](Forces& f) { f.path->line.resize(1); }), "path.line");
  EXPECT_EQ(rejected([](Forces& f) { f.path->line[5] = 1.5; }), "path.line");
  EXPECT_EQ(rejected([](Forces& f) { f.path->block[5] = missing; }), "path.block");
  EXPECT_EQ(rejected([](Forces& f) { f.path->tip_m(2, 9) = missing; }), "path.tip_m");
  EXPECT_EQ(rejected([](Forces& f) { f.path->path_m[9] = 0.0; }), "path.path_m");
  EXPECT_EQ(rejected([](Forces& f) { f.path->time_s.resize(0); }), "accepted");
  EXPECT_EQ(rejected([](Forces& f) { f.path->deflection_m.resize(0); }), "accepted");
  EXPECT_EQ(rejected([](Forces& f) { f.path->deflection_m.resize(4); }), "path.deflection_m");
  EXPECT_EQ(rejected([](Forces& f) { f.path->peak_force_n[3] = missing; }), "accepted");
  EXPECT_EQ(rejected([&](Forces& f) { f.path->peak_force_n[3] = infinite; }), "path.peak_force_n");
  EXPECT_EQ(rejected([](Forces& f) { f.path->power_w.resize(0); }), "path.power_w");
  EXPECT_EQ(rejected([](Forces& f) { f.path->cuts.pop_back(); }), "path.cuts");
  EXPECT_EQ(rejected([](Forces& f) { f.path->torque_limit_n_m = 0.0; }), "path.torque_limit_n_m");
  EXPECT_EQ(rejected([](Forces& f) { f.path->power_limit_w = missing; }), "accepted");
  EXPECT_EQ(rejected([](Forces& f) { f.spindle_rotation->deflection_m.resize(2); }), "spindle_rotation.deflection_m");
  EXPECT_EQ(rejected([](Forces& f) { f.spindle_rotation->condition_number.resize(0); }), "accepted");
  EXPECT_EQ(rejected([&](Forces& f) { f.spindle_rotation->best_rad = infinite; }), "spindle_rotation.best_rad");
}

}  // namespace
}  // namespace robomill::report
