// Runs the program as a user does: the verbs that have no test file of their own.
#include <gtest/gtest.h>

#include <algorithm>
#include <complex>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>

#include "robomill/base/printable.hpp"
#include "test_program.hpp"

namespace robomill::app {
namespace app_test {

using App = ProgramTest;

TEST_F(App, PrintsVersionAndHelp) {
  EXPECT_EQ(robomill("--version").out.rfind("robomill ", 0), 0U);
  EXPECT_EQ(robomill("--help").exit, 0);
  EXPECT_NE(robomill("lobes --help").out.find("--at"), std::string::npos);
}

TEST_F(App, WrongUsageExitsWithTwo) {
  EXPECT_EQ(robomill("").exit, 2);
  EXPECT_EQ(robomill("dance").exit, 2);
  EXPECT_EQ(robomill("lobes").exit, 2);
  EXPECT_EQ(robomill("lobes lobes.toml --sideways").exit, 2);
  EXPECT_EQ(robomill("modes tip.uff --method magic").exit, 2);
}

TEST_F(App, BadInputExitsWithOneAndOneMessage) {
  write_lobes("tangential_n_per_mm2 = 0\nradial_n_per_mm2 = 287\n");
  const Ended run = robomill("lobes lobes.toml -o lobes.json");
  EXPECT_EQ(run.exit, 1);
  EXPECT_NE(run.err.find("lobes.toml:9: coefficients.tangential_n_per_mm2 = 0 N/mm^2"), std::string::npos) << run.err;
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1);
  EXPECT_TRUE(run.out.empty());
  EXPECT_FALSE(std::filesystem::exists(folder_.at("lobes.json")));
  EXPECT_EQ(robomill("lobes missing.toml").exit, 1);
  EXPECT_EQ(robomill("modes missing.uff").exit, 1);
  EXPECT_EQ(robomill("frf missing.toml").exit, 1);
  EXPECT_EQ(robomill("plan missing.toml -o out").exit, 1);
  EXPECT_FALSE(std::filesystem::exists(folder_.at("out")));
}

TEST_F(App, DashWritesJsonAndNothingElse) {
  write_lobes();
  const Ended run = robomill("lobes lobes.toml --at 6500,0.6 --at 8000,1.2 -o -");
  ASSERT_EQ(run.exit, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  ASSERT_EQ(json["points"].size(), 2U);
  // Converged values of these points.
  EXPECT_NEAR(json["points"][0]["spectral_radius"].get<double>(), 1.10584684, 1e-7);
  EXPECT_NEAR(json["points"][1]["spectral_radius"].get<double>(), 1.07595981, 1e-7);
  EXPECT_FALSE(json["points"][0]["stable"].get<bool>());
  EXPECT_NE(robomill("lobes lobes.toml --at 6500 -o -").err.find("RPM,MM"), std::string::npos);
}

TEST_F(App, SimulatesACut) {
  write_lobes();
  const Ended summary = robomill("simulate lobes.toml --at 6500,0.6 --seconds 0.5 -o vibration.csv");
  ASSERT_EQ(summary.exit, 0) << summary.err;
  EXPECT_NE(summary.out.find("6500 rpm, 0.6 mm: chatter at"), std::string::npos) << summary.out;
  const std::string csv = slurp(folder_.at("vibration.csv"));
  EXPECT_EQ(csv.rfind("time_s,x_m,y_m,ax_m_per_s2,ay_m_per_s2,fx_n,fy_n,fz_n\n0,", 0), 0U);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 5121);
  const Ended run = robomill("simulate lobes.toml --at 6500,0.6 --seconds 0.5 -o -");
  ASSERT_EQ(run.exit, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_EQ(json["verdict"], "chatter");
  // Converged value of this point: 1.10584684.
  EXPECT_NEAR(json["small_vibration"]["spectral_radius"].get<double>(), 1.10584684, 1e-4);
  EXPECT_EQ(robomill("simulate lobes.toml --at 6500,0.1 --seconds 0.5 --sample-rate-hz 5000 -o a.wav -o a.wav").exit,
            2);
  EXPECT_EQ(robomill("simulate lobes.toml --at 6500,0.1 --seconds 0.5 --sample-rate-hz 5000 -o a.wav").exit, 0);
  EXPECT_EQ(robomill("simulate lobes.toml --at 6500,0.1 --seconds 0.5 -o a.uff").exit, 1);
  EXPECT_EQ(robomill("simulate lobes.toml --at 6500,0.1 --seconds -1").exit, 1);
  EXPECT_EQ(robomill("simulate lobes.toml").exit, 2);
  EXPECT_NE(robomill("simulate lobes.toml --at 6500").err.find("RPM,MM"), std::string::npos);
}

// One mode of 922 Hz, 1.1 %, 0.03993 kg in x, as its receptance.
TEST_F(App, SimulatesFromFrfs) {
  std::string csv = "frequency_hz,xx_re_m_per_n,xx_im_m_per_n\n";
  const double natural = 2.0 * std::numbers::pi * 922.0;
  for (int line = 400; line <= 4000; ++line) {
    const double omega = std::numbers::pi * line;
    const std::complex<double> h =
        1.0 / (0.03993 * std::complex<double>(natural * natural - omega * omega, 0.022 * natural * omega));
    csv += std::to_string(0.5 * line) + ',' + std::to_string(1e9 * h.real()) + "e-9," + std::to_string(1e9 * h.imag()) +
           "e-9\n";
  }
  write("tip.csv", csv);
  write_lobes();
  std::string text = slurp(folder_.at("lobes.toml"));
  const std::size_t from = text.find("modes = ");
  text.replace(from, text.find('\n', from) - from, "frf = \"tip.csv\"\nrigid_directions = [\"y\"]");
  write("lobes.toml", text);
  const Ended run = robomill("simulate lobes.toml --at 6500,0.3 --seconds 0.5");
  EXPECT_EQ(run.exit, 0) << run.err;
  EXPECT_NE(run.out.find("tip.csv: 1 modes fitted"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("  Direction y, not measured: rigid (dynamics.rigid_directions of lobes.toml)"),
            std::string::npos)
      << run.out;
  const Ended lobes = robomill("lobes lobes.toml");
  EXPECT_EQ(lobes.exit, 1);
  EXPECT_NE(lobes.err.find("multi-frequency"), std::string::npos) << lobes.err;
}

TEST_F(App, SimulatesDrilling) {
  write("drill.toml",
        "[tool]\nteeth = 2\ndiameter_mm = 10\npoint_angle_deg = 118\n[cut]\nkind = \"drilling\"\n"
        "feed_per_revolution_mm = 0.1\n[coefficients]\ntangential_n_per_mm2 = 900\nradial_n_per_mm2 = 500\n"
        "[dynamics]\nx = [{ frequency_hz = 400, damping_ratio = 0.03, modal_mass_kg = 0.3 }]\n"
        "z = [{ frequency_hz = 900, damping_ratio = 0.03, modal_mass_kg = 0.5 }]\n"
        "[lobes]\nspindle_speed_rpm = [1000, 5000]\naxial_depth_mm = [0, 5]\n");
  const Ended run = robomill("simulate drill.toml --at 3000,1 --seconds 0.2 -o -");
  ASSERT_EQ(run.exit, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  // Two lips: n (b / sin p) (Kr f/n sin p) sin p = 500 * 1 * 0.1 * sin 59 degrees.
  EXPECT_NEAR(json["vibrating_peak_n"][2].get<double>(), 42.9, 4.0);
  EXPECT_EQ(robomill("simulate drill.toml --at 3000,6 --seconds 0.2").exit, 1);
  const Ended lobes = robomill("lobes drill.toml --at 3000,1");
  EXPECT_EQ(lobes.exit, 0) << lobes.err;
  EXPECT_NE(lobes.out.find("gain margin"), std::string::npos) << lobes.out;
}

TEST_F(App, ResultsDoNotDependOnTheNumberOfThreads) {
  write_lobes();
  const auto lobes = [this](const char* threads) {
    auto json = nlohmann::json::parse(robomill(std::string("lobes lobes.toml -o - --threads ") + threads).out);
    json.erase("seconds");
    return json;
  };
  EXPECT_EQ(lobes("1"), lobes("4"));
}

// The peaks that a study of this robot names at 6,500 rpm, read with three teeth: the first is tooth passing, the
// others are its first mode.
TEST_F(App, ExplainNamesMeasuredPeaks) {
  const std::string peaks =
      "explain --peaks 324.99,666.98,991.98,1966.95 --rpm 6500 --teeth 3 --modes " ROBOMILL_SOURCE_DIR
      "/data/robot-modes.toml ";
  const Ended run = robomill(peaks + "-o explain.json");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_NE(run.out.find("324.99 Hz  tooth passing x 1"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("666.98 Hz  chatter: mode 1 at 17.40 Hz + tooth passing x 2"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("depends on the cut"), std::string::npos);
  const auto json = nlohmann::json::parse(slurp(folder_.at("explain.json")));
  EXPECT_EQ(json["peaks"][3]["mode"], 1);
  EXPECT_EQ(json["peaks"][3]["rotations"], 18);
  EXPECT_TRUE(json["chatter"].is_null());

  write_lobes();
  const Ended judged = robomill(peaks + "--lobes lobes.toml --at 6500,0.6 -o -");
  ASSERT_EQ(judged.exit, 0) << judged.err;
  const auto verdict = nlohmann::json::parse(judged.out)["chatter"];
  EXPECT_NEAR(verdict["spectral_radius"].get<double>(), 1.10584684, 1e-4);
  EXPECT_EQ(verdict["kind"],
            verdict["spectral_radius_without_delay"].get<double>() < 1.0 ? "regenerative" : "mode coupling");

  const Ended open = robomill("explain --peaks 540.9,539.5 --rpm 6500 --teeth 3 --modes " ROBOMILL_SOURCE_DIR
                              "/data/robot-modes.toml");
  EXPECT_NE(open.out.find("540.90 Hz  ambiguous: the cut, or chatter"), std::string::npos) << open.out;
  EXPECT_NE(open.out.find("539.50 Hz  chatter of an unidentified mode"), std::string::npos) << open.out;
  EXPECT_NE(open.out.find("These peaks do not determine which mode chatters, if any."), std::string::npos);

  EXPECT_EQ(robomill("explain --peaks 300 --rpm 6500 --teeth 3").exit, 2);
  EXPECT_EQ(robomill(peaks + "--lobes lobes.toml").exit, 1);
  EXPECT_EQ(robomill(peaks + "--tolerance-hz 40").exit, 1);
  const Ended bad =
      robomill("explain --peaks 300,-4 --rpm 6500 --teeth 3 --modes " ROBOMILL_SOURCE_DIR "/data/robot-modes.toml");
  EXPECT_EQ(bad.exit, 1);
  EXPECT_NE(bad.err.find("--peaks = -4 Hz"), std::string::npos) << bad.err;
}

// A structure that chatters at any depth that matters: finished, but without the answer; the report is there all the
// same.
TEST_F(App, NoSafeDepthExitsWithThree) {
  write_lobes();
  write("job.toml", "[job]\nmodes = \"" ROBOMILL_SOURCE_DIR
                    "/data/robot-modes.toml\"\nlobes = \"lobes.toml\"\n[spindle]\nmax_speed_rpm = 3000\n");
  const Ended ended = robomill("plan job.toml -o out");
  EXPECT_EQ(ended.exit, 3) << ended.err;
  EXPECT_NE(ended.out.find("no safe depth"), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(folder_.at("out") / "report.html"));
}

// From hits to FRFs to modes, each verb by its own files.
TEST_F(App, GoesFromHitsToModes) {
  ASSERT_EQ(shell("'" ROBOMILL_SIMULATE_HITS "' hits").exit, 0);
  const Ended frf = robomill("frf hits/hits.toml -o tip.uff");
  ASSERT_EQ(frf.exit, 0) << frf.err;
  EXPECT_NE(frf.out.find("accepted"), std::string::npos);
  for (const char* name : {"tip.csv", "tip.json", "tip.mat"}) {
    EXPECT_EQ(robomill(std::string("frf hits/hits.toml --quiet -o ") + name).exit, 0) << name;
  }
  EXPECT_EQ(robomill("frf hits/hits.toml --quiet --binary -o binary.uff").exit, 0);
  EXPECT_LT(std::filesystem::file_size(folder_.at("binary.uff")), std::filesystem::file_size(folder_.at("tip.uff")));
  const Ended modes = robomill("modes tip.uff --band 10,700 -o modes.json");
  ASSERT_EQ(modes.exit, 0) << modes.err;
  const auto json = nlohmann::json::parse(slurp(folder_.at("modes.json")));
  EXPECT_GE(json["modes"].size(), 6U);
  EXPECT_LT(json["fit"]["relative_error"].get<double>(), 0.1);
  // One mode for eight: the report is there, and nobody may use it before it is accepted.
  const Ended bad = robomill("modes tip.uff --band 10,700 --modes 1 -o bad.json");
  EXPECT_EQ(bad.exit, 3) << bad.out;
  EXPECT_NE(bad.out.find("Warning: The modes do not describe the FRFs"), std::string::npos) << bad.out;
  EXPECT_NE(bad.err.find("--accept-fit"), std::string::npos) << bad.err;
  const std::string peaks = "explain --peaks 300 --rpm 6500 --teeth 3 --modes bad.json";
  EXPECT_EQ(robomill(peaks).exit, 1);
  EXPECT_EQ(robomill("modes tip.uff --band 10,700 --modes 1 --accept-fit -o bad.json").exit, 0);
  EXPECT_EQ(robomill(peaks).exit, 0);
}

TEST_F(App, LobesComparesMethodsAndTakesFrfs) {
  write_lobes("tangential_n_per_mm2 = 712\nradial_n_per_mm2 = 287\n", "[12, 30]");
  const Ended table = robomill("lobes lobes.toml --compare");
  EXPECT_EQ(table.exit, 0) << table.err;
  for (const char* method : {"collocation", "semi-discretization", "zeroth-order", "multi-frequency"}) {
    EXPECT_NE(table.out.find(method), std::string::npos) << table.out;
  }
  const Ended json = robomill("lobes lobes.toml --compare -o -");
  EXPECT_EQ(nlohmann::json::parse(json.out)["methods"][0]["worst_error"], 0.0);
}

// Two joints of 1e6 and 1e5 N m/rad, levers 0.8 and 0.2 m: each displacement is Σ J_i (J_i · F) / k_i, but for the
// second order of the joints' 1e-4 rad.
TEST_F(App, StiffnessComesBackFromLoads) {
  write("cell.toml", "[robot]\ndh = [{ a_mm = 800 }, { a_mm = 200, alpha_deg = 90 }]\n");
  write("loads.csv",
        "q1_deg,q2_deg,fx_n,fy_n,fz_n,dx_mm,dy_mm,dz_mm\n0,90,100,0,0,0.044,-0.016,0\n0,0,0,100,0,0,0.14,0\n"
        "0,90,0,100,0,-0.016,0.064,0\n");
  const Ended run = robomill("stiffness loads.csv --cell cell.toml -o stiffness.json");
  EXPECT_EQ(run.exit, 0) << run.err;
  EXPECT_NE(run.out.find("joint 1  "), std::string::npos) << run.out;
  const auto json = nlohmann::json::parse(slurp(folder_.at("stiffness.json")));
  EXPECT_NEAR(json["joint_stiffness_n_m_per_rad"][0].get<double>(), 1e6, 1e3);
  EXPECT_NEAR(json["joint_stiffness_n_m_per_rad"][1].get<double>(), 1e5, 1e2);
  EXPECT_EQ(json["convergence"]["status"], "converged");
  EXPECT_EQ(robomill("stiffness loads.csv --cell cell.toml -o stiffness.toml").exit, 0);
  EXPECT_NE(slurp(folder_.at("stiffness.toml")).find("joint_stiffness_n_m_per_rad = ["), std::string::npos);
  const Ended standard = robomill("stiffness loads.csv --cell cell.toml -o -");
  EXPECT_EQ(nlohmann::json::parse(standard.out), json);
  EXPECT_EQ(robomill("stiffness loads.csv --cell cell.toml -o stiffness.csv").exit, 0);
  EXPECT_EQ(slurp(folder_.at("stiffness.csv")).rfind("joint,stiffness,std,unit,identifiable,reason\n1,", 0), 0U);
  EXPECT_EQ(robomill("stiffness loads.csv --cell cell.toml -o stiffness.mat").exit, 1);
  EXPECT_EQ(robomill("stiffness loads.csv").exit, 2);
  write("loads.csv", "q1_deg,q2_deg,fx_n,fy_n,fz_n,dx_mm,dy_mm,dz_mm\n0,90,100,zero,0,0,0,0\n");
  const Ended rejected = robomill("stiffness loads.csv --cell cell.toml");
  EXPECT_EQ(rejected.exit, 1);
  EXPECT_NE(rejected.err.find("loads.csv:2: fy_n = \"zero\"; must be a finite number"), std::string::npos)
      << rejected.err;
}

// Source: [BudakAltintasArmarego1996], Ti6Al4V; the first row's means are those of its constants, the others' too.
TEST_F(App, FindsCoefficientsFromSlots) {
  const std::string head = "feed_per_tooth_mm,axial_depth_mm,spindle_speed_rpm,fx_n,fy_n,fz_n\n";
  const std::string first = "0.05,5.08,3000,-555.8508,655.6513,255.9891\n";
  write("slots.csv",
        head + first + "0.1,5.08,3000,-751.4308,1119.2013,493.6902\n0.025,5.08,3000,-458.0608,423.8763,137.1385\n");
  const Ended run = robomill("coefficients slots.csv --teeth 4 -o coefficients.toml");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_NE(run.out.find("1825"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("R² 1.000000"), std::string::npos) << run.out;
  EXPECT_NE(slurp(folder_.at("coefficients.toml")).find("[identification]"), std::string::npos);
  const auto json = nlohmann::json::parse(robomill("coefficients slots.csv --teeth 4 -o -").out);
  const auto expect = [&](const char* key, double value) {
    EXPECT_NEAR(json["coefficients"][key].get<double>(), value, 1e-4 * value) << key;
  };
  expect("tangential_n_per_mm2", 1825.0);
  expect("radial_n_per_mm2", 770.0);
  expect("axial_n_per_mm2", 735.0);
  expect("tangential_edge_n_per_mm", 29.7);
  expect("radial_edge_n_per_mm", 55.7);
  expect("axial_edge_n_per_mm", 1.8);
  EXPECT_NE(robomill("coefficients slots.csv").out.find("Assumed, because not given:\n  Teeth of the cutter: 4"),
            std::string::npos);
  // One feed: the fit ends, but it does not separate cutting from edge.
  write("one.csv", head + first + "0.05,2.54,3000,-277.9254,327.82565,127.99455\n");
  const Ended one = robomill("coefficients one.csv --teeth 4 -o one.json");
  EXPECT_EQ(one.exit, 3);
  EXPECT_EQ(nlohmann::json::parse(slurp(folder_.at("one.json")))["identification"]["status"], "edge unknown");
  EXPECT_NE(one.out.find("not stated"), std::string::npos) << one.out;
  write("bad.csv", head + first + "0.1,0,3000,-751,887,493\n");
  const Ended bad = robomill("coefficients bad.csv --teeth 4 -o bad.toml");
  EXPECT_EQ(bad.exit, 1);
  EXPECT_NE(bad.err.find("bad.csv:3: axial_depth_mm = 0 mm"), std::string::npos) << bad.err;
  EXPECT_FALSE(std::filesystem::exists(folder_.at("bad.toml")));
  write("short.csv", head + first);
  EXPECT_NE(robomill("coefficients short.csv --teeth 4").err.find("short.csv: slots = 1"), std::string::npos);
  EXPECT_EQ(robomill("coefficients slots.csv --teeth 4 -o k.csv").exit, 0);
  EXPECT_EQ(slurp(folder_.at("k.csv")).rfind("spindle_speed_rpm,coefficient,value,std,r_squared,noise_n\n", 0), 0U);
  EXPECT_EQ(robomill("coefficients slots.csv --teeth 4 -o k.mat").exit, 1);
}

TEST_F(App, ReportsForcesOverARevolutionAndAlongAProgram) {
  const std::string along = std::string(ROBOMILL_SOURCE_DIR) + "/examples/force-along-program/";
  const Ended cut = robomill("forces " + std::string(ROBOMILL_SOURCE_DIR) +
                             "/examples/ball-end-ur5e/cut-1.toml -o forces.csv --report forces.json");
  ASSERT_EQ(cut.exit, 0) << cut.err;
  EXPECT_NE(cut.out.find("deflection"), std::string::npos) << cut.out;
  EXPECT_EQ(slurp(folder_.at("forces.csv")).rfind("rotation_deg,fx_n,fy_n,fz_n,torque_n_m\n", 0), 0U);
  EXPECT_TRUE(nlohmann::json::parse(slurp(folder_.at("forces.json")))["forces"]["rotation_deg"].is_array());
  const std::string program = "forces " + along + "forces.toml --program " + along + "hollow.ngc --cell ";
  const Ended run = robomill(program + along + "cell.toml -o -");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_EQ(nlohmann::json::parse(run.out)["blocks"].size(), 254U);
  // Out of reach: one message with file and line, no output.
  std::string cell = slurp(along + "cell.toml");
  cell.replace(cell.find("[1700"), 5, "[9700");
  write("far.toml", cell);
  const Ended far = robomill(program + "far.toml -o far.csv");
  EXPECT_EQ(far.exit, 1);
  EXPECT_NE(far.err.find("hollow.ngc:5"), std::string::npos) << far.err;
  EXPECT_FALSE(std::filesystem::exists(folder_.at("far.csv")));
  EXPECT_EQ(robomill("forces " + along + "forces.toml -o forces.wav").exit, 1);
  EXPECT_EQ(robomill("forces").exit, 2);
}

// Names and values of files reach the terminal as text: no byte of them moves its cursor or changes its colours.
TEST_F(App, NoByteOfAFileControlsTheTerminal) {
  const std::string escape = "\x1b[31m\xff\x07";
  write_lobes();
  write("head.csv", "frequency_hz,xx_re_m_per_n,xx_im_m_per_n,q" + escape + "\n1,2,3,4\n2,3," + escape + ",5\n");
  write("cell.csv", "1,2," + escape + "\n2,3,4\n");
  write("unit.csv", "f,xx_re_" + escape + ",xx_im_" + escape + "\n1,2,3\n");
  write("tip.json", "{\"frequency_hz\":[1,2],\"receptance_m_per_n\":{\"" + std::string("\\u001b[31m") +
                        "\":{\"re\":[1,2],\"im\":[1,2]}}}");
  write("broken.json", "{\"frequency_hz\":[1,2" + escape + "]}");
  write("tip.uff", "    -1\n" + escape + "\n    -1\n");
  write("data.uff", "    -1\n    58\n" + escape + "\nNONE\nNONE\nNONE\nNONE\n" + escape + "\n    -1\n");
  write("job.toml", "[job]\nmodes = \"" + escape + "\"\n");
  write("key.toml", "[job]\nmodes = \"a\\u001b[31m.json\"\nlobes = \"lobes.toml\"\n\"b\\u001b[31m\" = 3\n");
  write("file.toml", "[job]\nmodes = \"a\\u001b[31m.json\"\nlobes = \"lobes.toml\"\n");
  write("hits.toml", "[acquisition]\nresponse = \"\\u001b[31m\"\n[[hits]]\nfile = \"a.csv\"\n");
  write("part.ngc", "G21 G90 G94\nG1 X" + escape + "\n");
  write("part.apt", "GOTO/1,2," + escape + "\n");
  write("part.csv", "x_mm,y_mm,z_mm,i,j,k,feed_mm_per_min\n1,2,3,0,0,1," + escape + "\n");
  write("monitor.toml",
        "[signal]\nsample_rate_hz = 10240\nchannels = [\"a\\u001b[31m\"]\n[process]\n"
        "spindle_speed_rpm = 3000\nteeth = 2\n[detector]\nkind = \"comb-cusum\"\n");
  write("a.csv", "t" + escape + ",b\n1,2\n2,3\n");
  const std::string cell = std::string(ROBOMILL_SOURCE_DIR) + "/examples/smooth-impeller-like/cell.toml";
  for (const std::string& arguments :
       {std::string("modes head.csv"), std::string("modes cell.csv"), std::string("modes unit.csv"),
        std::string("modes tip.json"), std::string("modes broken.json"), std::string("modes tip.uff"),
        std::string("modes data.uff"), std::string("modes 'no\x1b[31m.csv'"), std::string("modes tip.uff '--\x1b[31m'"),
        std::string("plan job.toml"), std::string("plan key.toml"), std::string("plan file.toml"),
        std::string("frf hits.toml"), "smooth part.ngc --cell " + cell, "smooth part.apt --cell " + cell,
        "smooth part.csv --cell " + cell, std::string("monitor monitor.toml --input a.csv")}) {
    const Ended ended = robomill(arguments);
    EXPECT_NE(ended.exit, 0) << arguments;
    EXPECT_FALSE(ended.err.empty()) << arguments;
    std::istringstream rows(ended.err + ended.out);
    for (std::string row; std::getline(rows, row);) EXPECT_EQ(printable(row), row) << arguments;
  }
}

TEST_F(App, LinesOfAMessageStandBelowEachOther) {
  write("hit.csv", "time_s,Hammer (V),acc x (V)\n0,0,0\n0.001,1,2\n0.002,0,1\n");
  const Ended ended = robomill("frf hit.csv -o tip.uff");
  EXPECT_EQ(ended.exit, 1);
  EXPECT_NE(ended.err.find("run robomill frf hits.toml:\n  [acquisition]\n  sample_rate_hz"), std::string::npos)
      << ended.err;
}

TEST_F(App, CtrlCStopsAndLeavesNoFile) {
  write_lobes("tangential_n_per_mm2 = 712\nradial_n_per_mm2 = 287\n", "[4000, 4000]\noutput = \"map\"");
  const Ended run = shell("env --default-signal=INT timeout --foreground --signal=INT 1 '" ROBOMILL_PROGRAM
                          "' lobes lobes.toml -o lobes.json; echo $? >code.txt");
  EXPECT_NE(run.err.find("interrupted"), std::string::npos) << run.err;
  EXPECT_FALSE(std::filesystem::exists(folder_.at("lobes.json")));
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
    const std::string name = entry.path().filename().string();
    EXPECT_TRUE(name == "lobes.toml" || name == "out.txt" || name == "err.txt" || name == "code.txt") << name;
  }
}

}  // namespace app_test
}  // namespace robomill::app
