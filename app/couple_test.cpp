// robomill couple and joint as a user runs them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "test_program.hpp"

namespace robomill::app {
namespace couple_test {

class CoupleVerb : public ProgramTest {
 protected:
  /// The bar of a published experiment, in two parts: 169.82 mm from the wall, whose first mode is at 294.7 Hz.
  static std::string bar(double length_mm) {
    return "length_mm = " + std::to_string(length_mm) +
           "\ndiameter_mm = 12\nyoungs_modulus_gpa = 200\ndensity_kg_per_m3 = 7800\nloss_factor = 0.02\n"
           "beam = \"euler-bernoulli\"\n";
  }
  void write_assembly(const std::string& name, const std::string& joint = "",
                      const std::string& holder = "[[holder.segments]]\n" + bar(50.90),
                      const std::string& frequency = "[frequency]\nrange_hz = [1, 1000]\nstep_hz = 1\n") {
    write(name, frequency + "[[tool]]\n" + bar(118.92) + joint + "[holder]\n" + holder);
  }
};

TEST_F(CoupleVerb, CouplesAToolToItsHolder) {
  write_assembly("assembly.toml");
  const Ended run = robomill("couple assembly.toml -o tip.uff");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_NE(run.out.find("xx: peak at 294.77"), std::string::npos) << run.out;
  // L³ / (3 E I) / (1 + η²) = 8.016 µm/N.
  EXPECT_NE(run.out.find("static compliance 8.016 µm/N (stiffness 0.1248 N/µm)"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("yy: the same as xx"), std::string::npos);
  const Ended json = robomill("couple assembly.toml --rotations -o -");
  ASSERT_EQ(json.exit, 0) << json.err;
  const auto tip = nlohmann::json::parse(json.out);
  EXPECT_EQ(tip["frequency_hz"].size(), 1000U);
  for (const char* name : {"xx", "x:my", "ry:x", "ry:my", "yy", "y:mx", "rx:y", "rx:mx"}) {
    EXPECT_EQ(tip["receptance_m_per_n"][name]["re"].size(), 1000U) << name;
  }
  for (const char* name : {"tip.csv", "tip.json", "tip.mat"}) {
    EXPECT_EQ(robomill(std::string("couple assembly.toml --quiet -o ") + name).exit, 0) << name;
    const Ended modes = robomill(std::string("modes ") + name + " --modes 2 --band 200,400 -o -");
    EXPECT_NEAR(nlohmann::json::parse(modes.out)["modes"][0]["frequency_hz"].get<double>(), 294.8, 0.05) << name;
  }
}

// The holder alone, measured with its rotations, carries the same tool alike, and is kept for the next one.
TEST_F(CoupleVerb, CouplesAToolToAMeasuredHolder) {
  write("bare.toml", "[frequency]\nrange_hz = [1, 1000]\nstep_hz = 1\n[[tool]]\n" + bar(50.90));
  const Ended bare = robomill("couple bare.toml --rotations -o holder.uff");
  ASSERT_EQ(bare.exit, 0) << bare.err;
  EXPECT_NE(bare.out.find("rigid wall"), std::string::npos);
  write_assembly("assembly.toml", "", "receptances = \"holder.uff\"\n", "");
  const Ended run = robomill("couple assembly.toml -o tip.json --holder-out kept.mat");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_NE(run.out.find("xx: peak at 294.77"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("µm/N at the first line, 1 Hz"), std::string::npos);
  write_assembly("next.toml", "", "receptances = \"kept.mat\"\n", "");
  EXPECT_NE(robomill("couple next.toml").out.find("xx: peak at 294.77"), std::string::npos);
}

// Lines that a finite difference makes unreliable are reported in every file derived from them.
TEST_F(CoupleVerb, CoupleWritesWhichLinesAreNotReliable) {
  const std::string head =
      "frequency_hz,1x:1x_re_m_per_n,1x:1x_im_m_per_n,2x:1x_re_m_per_n,2x:1x_im_m_per_n,2x:2x_re_m_per_n,"
      "2x:2x_im_m_per_n\n";
  std::string rows;
  for (int line = 1; line <= 40; ++line) {
    rows += std::to_string(10 * line) + ",1e-6,-1e-7,0.98e-6,-0.98e-7,0.961e-6,-0.961e-7\n";
  }
  write("points.csv", head + rows);
  write_assembly("a.toml", "", "receptances = \"points.csv\"\npoints_mm = [0, 10]\nmax_amplification = 20\n", "");
  const Ended run = robomill("couple a.toml -o tip.json --holder-out kept.uff");
  ASSERT_EQ(run.exit, 0) << run.err;
  const auto tip = nlohmann::json::parse(slurp(folder_.at("tip.json")));
  EXPECT_EQ(tip["unreliable_hz"].size(), 40U);
  EXPECT_EQ(tip["unreliable_hz"][1], 20.0);
  EXPECT_TRUE(tip["suspect_hz"].is_array());
  EXPECT_NE(tip["notes"].dump().find("do not rely on them"), std::string::npos) << tip["notes"];
  EXPECT_EQ(nlohmann::json::parse(robomill("couple a.toml -o -").out)["unreliable_hz"], tip["unreliable_hz"]);

  // The kept file says it too: more than 20 × 1 % of each receptance, the same share of all of one line.
  EXPECT_EQ(robomill("couple a.toml --quiet --holder-out kept.json").exit, 0);
  const auto kept = nlohmann::json::parse(slurp(folder_.at("kept.json")));
  double share = 0.0;
  for (const char* name : {"xx", "ry:x", "ry:my"}) {
    const auto& h = kept["receptance_m_per_n"][name];
    const double size = std::hypot(h["re"][4].get<double>(), h["im"][4].get<double>());
    const double part = kept["deviation_m_per_n"][name][4].get<double>() / size;
    EXPECT_GT(part, 0.2) << name;
    if (share == 0.0) share = part;
    EXPECT_NEAR(part, share, 1e-9 * share) << name;
  }
  write_assembly("next.toml", "", "receptances = \"kept.uff\"\n", "");
  EXPECT_EQ(robomill("couple next.toml").exit, 0);
  EXPECT_NE(slurp(folder_.at("kept.uff")).find("standard deviation"), std::string::npos);

  write("tools.csv", "tool,length_mm,diameter_mm\nbar,118.92,12\n");
  const Ended table = robomill("couple a.toml --tools tools.csv -o table.json");
  EXPECT_NE(table.out.find("do not rely on them"), std::string::npos) << table.out << table.err;
  const auto holder = nlohmann::json::parse(slurp(folder_.at("table.json")))["holder"];
  EXPECT_EQ(holder["unreliable_hz"].size(), 40U);
  EXPECT_NE(holder["notes"].dump().find("do not rely on them"), std::string::npos);
}

TEST_F(CoupleVerb, CoupleRejectsInTheFilesWords) {
  const auto rejected = [&](const std::string& arguments, const std::string& words) {
    const Ended run = robomill("couple " + arguments + " -o tip.uff");
    EXPECT_EQ(run.exit, 1);
    EXPECT_NE(run.err.find(words), std::string::npos) << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_FALSE(std::filesystem::exists(folder_.at("tip.uff")));
  };
  write_assembly("a.toml", "[joint]\ntranslational_stiffness_n_per_m = -1\nrotational_stiffness_n_m_per_rad = 1\n");
  rejected("a.toml", "a.toml:12: joint.translational_stiffness_n_per_m = -1 N/m; must be > 0");
  write_assembly("a.toml", "", "[[holder.segments]]\n" + bar(-3));
  rejected("a.toml", "holder.segments[1].length_mm = -3 mm; must be > 0");
  write_assembly("a.toml", "", "[[holder.segments]]\n" + bar(50.90), "");
  rejected("a.toml", "a.toml: frequency: is missing");
  write_assembly("a.toml");
  rejected("a.toml --holder-out holder.uff", "--holder-out: needs a measured holder");
  write("half.csv", "frequency_hz,xx_re_m_per_n,xx_im_m_per_n\n1,1e-6,0\n2,1e-6,0\n");
  write_assembly("a.toml", "", "receptances = \"half.csv\"\n", "");
  rejected("a.toml", "half.csv: lacks ry:x (or x:my) and ry:my");
  write("bare.toml", "[frequency]\nrange_hz = [10, 1000]\nstep_hz = 10\n[[tool]]\n" + bar(50.90));
  ASSERT_EQ(robomill("couple bare.toml --rotations -o holder.mat").exit, 0);
  write_assembly("a.toml", "", "receptances = \"holder.mat\"\n");
  rejected("a.toml", "a.toml: frequency_hz = 1 Hz; must lie in the range of the measured holder, 10 to 1000 Hz");
  rejected("missing.toml", "missing.toml");
  EXPECT_EQ(robomill("couple").exit, 2);
  EXPECT_EQ(robomill("couple a.toml --sideways").exit, 2);
}

TEST_F(CoupleVerb, CouplesAListOfTools) {
  write_assembly("assembly.toml", "", "[[holder.segments]]\n" + bar(50.90),
                 "[frequency]\nrange_hz = [20, 1000]\nstep_hz = 2\n");
  write("tools.csv", "tool,length_mm,diameter_mm,teeth\nbar,118.92,12,2\nthin,118.92,1,2\nshort,80,12,3\n");
  write_lobes();
  const Ended run = robomill("couple assembly.toml --tools tools.csv --lobes lobes.toml -o table.csv");
  EXPECT_EQ(run.exit, 3) << run.err;  // 1.8 mm are more than the thin one has
  EXPECT_NE(run.out.find("must be at most the cutter's diameter"), std::string::npos) << run.out;
  EXPECT_NE(run.err.find("not every tool has a result; its row says why"), std::string::npos) << run.err;
  const std::string csv = slurp(folder_.at("table.csv"));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 4) << csv;
  EXPECT_NE(csv.find("\"bar\",2,12,118.92,294,"), std::string::npos) << csv;
  const Ended json = robomill("couple assembly.toml --tools tools.csv -o -");
  ASSERT_EQ(json.exit, 0) << json.err;
  const auto rows = nlohmann::json::parse(json.out)["tools"];
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_NEAR(rows[0]["modes"][0]["frequency_hz"].get<double>(), 294.7, 1.0);
  EXPECT_EQ(robomill("couple assembly.toml --tools tools.csv --frfs tips --quiet").exit, 0);
  EXPECT_TRUE(std::filesystem::is_regular_file(folder_.at("tips/3_short.uff")));
  EXPECT_EQ(robomill("couple assembly.toml --tools tools.csv -o table.uff").exit, 1);
  EXPECT_EQ(robomill("couple assembly.toml --lobes lobes.toml").exit, 2);
  for (const char* other : {"--rotations", "--holder-out kept.uff"}) {
    const Ended both = robomill(std::string("couple assembly.toml --tools tools.csv ") + other);
    EXPECT_EQ(both.exit, 2) << other;
    EXPECT_NE(both.err.find("excludes"), std::string::npos) << both.err;
  }
  write("bad.csv", "tool,length_mm,diameter_mm\nbar,0,12\n");
  EXPECT_NE(robomill("couple assembly.toml --tools bad.csv").err.find("bad.csv:2: length_mm = 0 mm; must be > 0"),
            std::string::npos);
}

// A planted joint, seen through the tip FRF that it gives.
TEST_F(CoupleVerb, FindsAJoint) {
  write_assembly("true.toml",
                 "[joint]\ntranslational_stiffness_n_per_m = 2e7\ntranslational_damping_n_s_per_m = 40\n"
                 "rotational_stiffness_n_m_per_rad = 5e4\nrotational_damping_n_m_s_per_rad = 0.5\n");
  ASSERT_EQ(robomill("couple true.toml -o tip.uff").exit, 0);
  write_assembly("assembly.toml", "", "[[holder.segments]]\n" + bar(50.90), "[frequency]\nrange_hz = [5, 900]\n");
  for (const char* axis : {"x", "y"}) {
    const Ended run = robomill(std::string("joint assembly.toml --measured tip.uff -o joint.json --axis ") + axis);
    ASSERT_EQ(run.exit, 0) << run.err;
    EXPECT_NE(run.out.find("rotational stiffness"), std::string::npos) << run.out;
    const auto json = nlohmann::json::parse(slurp(folder_.at("joint.json")));
    EXPECT_NEAR(json["joint"]["translational_stiffness_n_per_m"].get<double>(), 2e7, 2e4);
    EXPECT_NEAR(json["joint"]["rotational_stiffness_n_m_per_rad"].get<double>(), 5e4, 50.0);
    EXPECT_EQ(json["convergence"]["status"], "converged");
  }
  const auto ga = [&](const char* seed) {
    const std::string arguments =
        "joint assembly.toml --measured tip.uff -o - --method ga --mutation adaptive --seed " + std::string(seed);
    return robomill(arguments).out;
  };
  const std::string first = ga("1");
  EXPECT_EQ(first, ga("1"));
  EXPECT_NE(first, ga("2"));
  EXPECT_EQ(nlohmann::json::parse(first)["joint"].size(), 4U);
}

TEST_F(CoupleVerb, JointRejectsWhatDoesNotFit) {
  write_assembly("assembly.toml");
  ASSERT_EQ(robomill("couple assembly.toml -o tip.csv").exit, 0);
  const auto rejected = [&](const std::string& arguments, const std::string& words) {
    const Ended run = robomill("joint " + arguments);
    EXPECT_EQ(run.exit, 1) << run.out;
    EXPECT_NE(run.err.find(words), std::string::npos) << run.err;
  };
  rejected("assembly.toml --measured tip.csv -o joint.uff", "joints are written as .csv or .json");
  rejected("assembly.toml --measured missing.csv", "missing.csv");
  write("lone.txt", "10 1e-6 0\n20 1e-6 0\n");
  rejected("assembly.toml --measured lone.txt --axis y", "lone.txt: lacks yy");
  rejected("assembly.toml --measured lone.txt", "lone.txt: has 2 lines above 0 Hz");
  write_assembly("far.toml", "", "[[holder.segments]]\n" + bar(50.90), "[frequency]\nrange_hz = [4000, 5000]\n");
  rejected("far.toml --measured tip.csv", "has no line from 4000 to 5000 Hz");
  write("bare.toml", "[frequency]\nrange_hz = [10, 1000]\nstep_hz = 10\n[[tool]]\n" + bar(50.90));
  ASSERT_EQ(robomill("couple bare.toml --rotations -o holder.mat").exit, 0);
  write_assembly("coarse.toml", "", "receptances = \"holder.mat\"\n", "");
  rejected("coarse.toml --measured tip.csv", "coarse.toml: frequency_hz = 1 Hz; must lie in the range");
  EXPECT_EQ(robomill("joint assembly.toml").exit, 2);
  EXPECT_EQ(robomill("joint assembly.toml --measured tip.csv --method magic").exit, 2);
  EXPECT_EQ(robomill("joint assembly.toml --measured tip.csv --axis z").exit, 2);
}

}  // namespace couple_test
}  // namespace robomill::app
