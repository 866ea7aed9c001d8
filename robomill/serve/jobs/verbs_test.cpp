#include "robomill/serve/jobs/verbs.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>
#include <utility>

#include "robomill/io/json.hpp"
#include "robomill/jobs/init.hpp"
#include "robomill/serve/files/folder.hpp"
#include "testing/serve/slot.hpp"
#include "testing/support.hpp"

namespace robomill::serve {
namespace job_verbs_test {

using io::Json;
using test::rejection;

class JobVerbs : public ::testing::Test {
 protected:
  /// A file to begin with.
  void begin(jobs::Template kind) const {
    jobs::write_init(jobs::init_files({.kind = kind, .file = place_.at(""), .example = true}));
  }
  [[nodiscard]] JobRequest read(const Json& body) const {
    return read_job_request(body, [this](const std::string& path) { return folder_.resolve(path); });
  }
  JobOutcome run(const Json& body) const { return run_verb(read(body), folder_.root(), Progress::none()); }
  /// Runs it with an output, which must be listed as what it is, and gives its page's data.
  Json made(Json body, const std::string& output, const FileKind& kind) const {
    body["output"] = output;
    const JobOutcome outcome = run(body);
    EXPECT_EQ(outcome.shortfall, "") << body;
    EXPECT_FALSE(outcome.summary.empty()) << body;
    EXPECT_EQ(kind_of_file(place_.at(output)), kind)
        << output << ": " << kind_of_file(place_.at(output)).kind << " " << kind_of_file(place_.at(output)).document;
    return Json::parse(outcome.report);
  }
  /// What is said of a request that is not accepted.
  [[nodiscard]] std::string no(const Json& body) const {
    return rejection([&] { static_cast<void>(read(body)); });
  }
  [[nodiscard]] bool there(const char* name) const { return std::filesystem::exists(place_.at(name)); }

  test::Folder place_;
  Folder folder_{place_.path()};
  static constexpr const char* lobes = test::slot_lobes;
  static constexpr const char* assembly = R"([frequency]
range_hz = [200, 3000]
step_hz = 20
[[tool]]
length_mm = 60
diameter_mm = 12
youngs_modulus_gpa = 580
density_kg_per_m3 = 14400
loss_factor = 0.02
[joint]
translational_stiffness_n_per_m = 2e7
translational_damping_n_s_per_m = 40
rotational_stiffness_n_m_per_rad = 2e4
rotational_damping_n_m_s_per_rad = 0.5
[holder]
segments = [{ length_mm = 40, diameter_mm = 28, youngs_modulus_gpa = 205, density_kg_per_m3 = 7850, loss_factor = 0.02 }]
)";
  static constexpr const char* arm = R"([robot]
dh = [{ a_mm = 350, alpha_deg = -90, d_mm = 449.4 }, { a_mm = 1150, theta_offset_deg = -90 },
      { a_mm = 41, alpha_deg = -90, theta_offset_deg = 180 }, { alpha_deg = 90, d_mm = -1200 }, { alpha_deg = -90 },
      { alpha_deg = 180, d_mm = -420, theta_offset_deg = 180 }]
joint_stiffness_n_m_per_rad = [2.2072e6, 3.37672e6, 2.77569e6, 2.35016e6, 2.15746e6, 0.467056e6]
joint_damping_n_m_s_per_rad = [1200, 1500, 900, 400, 300, 60]
joint_rotor_inertia_kg_m2 = [60, 50, 40, 10, 8, 4]
links = [{ mass_kg = 300, inertia_kg_m2 = [10, 20, 30, 1, 2, 3] }, { mass_kg = 200, inertia_kg_m2 = [5, 9, 9, 0, 0, 0] },
         { mass_kg = 150, inertia_kg_m2 = [4, 4, 4, 0, 0, 0] }, { mass_kg = 50, inertia_kg_m2 = [1, 1, 1, 0, 0, 0] },
         { mass_kg = 30, inertia_kg_m2 = [0.5, 0.5, 0.5, 0, 0, 0] },
         { mass_kg = 20, inertia_kg_m2 = [0.5, 0.5, 0.5, 0, 0, 0] }]
[tool]
length_mm = 300
mount_rotation_deg = [0, 90, 0]
)";
};

TEST_F(JobVerbs, HitsBecomeFrfsAndTheseModes) {
  begin(jobs::Template::hits);
  Json page = made({{"verb", "frf"}, {"input", "hits.toml"}}, "out/tip.uff", {.kind = "frf"});
  EXPECT_FALSE(page["frf"].is_null());
  made({{"verb", "frf"}, {"input", "hits.toml"}}, "tip.json", {.kind = "frf"});
  made({{"verb", "frf"}, {"input", "hits.toml"}, {"options", {{"binary", true}}}}, "binary.uff", {.kind = "frf"});
  page = made({{"verb", "modes"},
               {"input", {"out/tip.uff"}},
               {"options", {{"modes", 1}, {"band_hz", {200, 1200}}, {"method", "lscf"}, {"accept_fit", true}}}},
              "modes.json", {.kind = "modes"});
  EXPECT_NEAR(page["modes"]["modes"][0]["frequency_hz"].get<double>(), 620.0, 5.0);
}

TEST_F(JobVerbs, ModesThatDoNotDescribeTheFrfsAreNoAnswer) {
  std::string csv = "frequency_hz,xx_re_m_per_n,xx_im_m_per_n\n";
  for (int line = 1; line <= 40; ++line)
    csv += std::to_string(50 * line) + (line % 2 == 0 ? ",1e-6,0\n" : ",-1e-6,0\n");
  place_.file("tip.csv", csv);
  const JobOutcome outcome =
      run({{"verb", "modes"}, {"input", "tip.csv"}, {"options", {{"modes", 1}, {"method", "lscf"}}}});
  EXPECT_NE(outcome.shortfall, "");
  EXPECT_FALSE(outcome.report.empty());
}

TEST_F(JobVerbs, ACellsPostureHasModes) {
  place_.file("cell.toml", arm);
  const Json page = made({{"verb", "modes --cell"},
                          {"input", "cell.toml"},
                          {"options", {{"joints_deg", {10, -5, 15, 20, 60, -10}}, {"axes", "flange"}}}},
                         "modes.json", {.kind = "modes"});
  EXPECT_NEAR(page["modes"]["posture"]["joints_deg"][2].get<double>(), 15.0, 1e-9);
}

TEST_F(JobVerbs, LobesAndACutOfThem) {
  place_.file("lobes.toml", lobes);
  Json page = made({{"verb", "lobes"}, {"input", "lobes.toml"}, {"options", {{"at", {{9000, 0.5}, {12000, 1}}}}}},
                   "lobes.json", {"result", "lobes"});
  EXPECT_EQ(page["lobes"]["points"].size(), 2U);
  EXPECT_NEAR(page["lobes"]["points"][1]["axial_depth_mm"].get<double>(), 1.0, 1e-12);
  page = made({{"verb", "lobes"}, {"input", "lobes.toml"}, {"options", {{"compare", true}}}}, "compared.csv",
              {"result", "lobes"});
  EXPECT_FALSE(page["comparison"].is_null());
  page = made({{"verb", "simulate"}, {"input", "lobes.toml"}, {"options", {{"at", {9000, 0.1}}, {"seconds", 0.3}}}},
              "vibration.csv", {"result", "vibration"});
  EXPECT_NEAR(page["simulation"]["spindle_speed_rpm"].get<double>(), 9000.0, 1e-9);
  EXPECT_EQ(page["simulation"]["verdict"], "stable");
  EXPECT_FALSE(page["vibration"].is_null());
  made({{"verb", "simulate"}, {"input", "lobes.toml"}, {"options", {{"at", {9000, 0.1}}, {"seconds", 0.3}}}},
       "simulation.json", {"result", "simulation"});
}

TEST_F(JobVerbs, MeasuredPeaksAreExplained) {
  place_.file("modes.json", R"({"modes":[
{"frequency_hz":900,"damping_ratio":0.02,"left":{"x":[1,0],"y":[0,0]},"right":{"x":[0,-8.8437e-4],"y":[0,0]}}]})");
  place_.file("lobes.toml", lobes);
  const Json peaks = {{"peaks_hz", {300, 905}}, {"rpm", 9000}, {"teeth", 2}};
  Json body = {{"verb", "explain"}, {"input", "modes.json"}, {"options", peaks}};
  made(body, "explain.json", {"result", "explain"});
  body["options"]["lobes"] = "lobes.toml";
  EXPECT_NE(rejection([&] { run(body); }).find("go together"), std::string::npos);
  body["options"]["at"] = {9000, 2};
  const Json page = made(body, "explain.csv", {"result", "explain"});
  EXPECT_FALSE(page["explanation"]["chatter"].is_null());
}

TEST_F(JobVerbs, AnAssemblyIsPredictedAndItsJointFound) {
  place_.file("assembly.toml", assembly);
  made({{"verb", "couple"}, {"input", "assembly.toml"}}, "tip.json", {.kind = "frf"});
  const Json page = made({{"verb", "joint"}, {"input", "assembly.toml"}, {"options", {{"measured", {"tip.json"}}}}},
                         "joint.json", {"result", "joint"});
  EXPECT_NEAR(page["joint"]["joint"]["translational_stiffness_n_per_m"].get<double>(), 2e7, 2e5);
  EXPECT_NE(rejection([&] {
              run({{"verb", "couple"}, {"input", "assembly.toml"}, {"options", {{"holder_out", "holder.uff"}}}});
            }).find("options.holder_out: needs a measured holder"),
            std::string::npos);
  EXPECT_FALSE(there("holder.uff"));
}

TEST_F(JobVerbs, AListOfToolsIsCompared) {
  place_.file("assembly.toml", assembly);
  place_.file("tools.csv", "tool,length_mm,diameter_mm,teeth\nshort,40,12,2\nlong,60,12,2\n");
  std::string cut = lobes;
  place_.file("cut.toml", cut.erase(cut.find("[dynamics]"), cut.find("[lobes]") - cut.find("[dynamics]")));
  const Json page = made(
      {{"verb", "couple --tools"}, {"input", "assembly.toml"}, {"options", {{"tools", "tools.csv"}, {"frfs", "tips"}}}},
      "table.json", {"result", "tools"});
  EXPECT_EQ(page["tools"]["tools"].size(), 2U);
  EXPECT_TRUE(there("tips/1_short.uff"));
}

TEST_F(JobVerbs, ForcesOfARevolutionAndAlongAProgram) {
  begin(jobs::Template::forces);
  made({{"verb", "forces"}, {"input", "forces.toml"}}, "forces.json", {"result", "forces"});
  made({{"verb", "forces"}, {"input", "forces.toml"}}, "forces.csv", {"result", "forces"});
  place_.file("part.ngc", "G21 G90 G94\nS9000\nG0 X-10 Y5 Z5\nG1 Z-2 F900\nG1 X10\nG0 Z5\nM30\n");
  const Json page = made({{"verb", "forces"}, {"input", "forces.toml"}, {"options", {{"program", "part.ngc"}}}},
                         "along.csv", {"result", "forces"});
  EXPECT_FALSE(page["forces"]["blocks"].empty());
}

TEST_F(JobVerbs, MeasurementsBecomeCoefficientsAndStiffness) {
  place_.file("slots.csv",
              "feed_per_tooth_mm,axial_depth_mm,spindle_speed_rpm,fx_n,fy_n,fz_n\n"
              "0.05,5.08,3000,-555.8508,655.6513,255.9891\n0.1,5.08,3000,-751.4308,1119.2013,493.6902\n");
  Json page = made({{"verb", "coefficients"}, {"input", "slots.csv"}, {"options", {{"teeth", 4}}}}, "coefficients.toml",
                   {"result", "coefficients"});
  EXPECT_NEAR(page["coefficients"]["coefficients"]["tangential_n_per_mm2"].get<double>(), 1825.0, 1.0);
  place_.file("cell.toml", "[robot]\ndh = [{ a_mm = 800 }, { a_mm = 200, alpha_deg = 90 }]\n");
  place_.file("loads.csv",
              "q1_deg,q2_deg,fx_n,fy_n,fz_n,dx_mm,dy_mm,dz_mm\n0,90,100,0,0,0.044,-0.016,0\n0,0,0,100,0,0,0.14,0\n"
              "0,90,0,100,0,-0.016,0.064,0\n");
  page = made({{"verb", "stiffness"}, {"input", "loads.csv"}, {"options", {{"cell", "cell.toml"}}}}, "stiffness.json",
              {"result", "stiffness"});
  EXPECT_NEAR(page["stiffness"]["joint_stiffness_n_m_per_rad"][0].get<double>(), 1e6, 1e3);
}

TEST_F(JobVerbs, ACellIsCheckedAndAProgramSmoothed) {
  begin(jobs::Template::cell);
  place_.file("part.ngc", "G21 G90 G94\nG0 X0 Y0 Z20 A0 C0\nG1 X8 F1800\nG1 Y4\nM30\n");
  Json page = made({{"verb", "cell check"}, {"input", "cell.toml"}, {"options", {{"joints", {0, -90, 90, 0, 30, 0}}}}},
                   "check.json", {"result", "check"});
  EXPECT_FALSE(page["cell"].is_null());
  page = made({{"verb", "smooth"}, {"input", "part.ngc"}, {"options", {{"cell", "cell.toml"}}}}, "trajectory.csv",
              {"result", "trajectory"});
  EXPECT_EQ(page["smooth"]["violations"], 0);
  // A program far away: exit 3, and what would help.
  place_.file("far.ngc", "G21 G90 G94\nG0 X9000 Y0 Z0 A0 C0\nG1 X9010 F600\nM30\n");
  const JobOutcome far = run({{"verb", "cell check"}, {"input", "cell.toml"}, {"options", {{"program", "far.ngc"}}}});
  EXPECT_NE(far.shortfall.find("does not come to the workpiece"), std::string::npos);
}

TEST_F(JobVerbs, AJobIsPlanned) {
  place_.file("modes.json", R"({"modes":[
{"frequency_hz":900,"damping_ratio":0.02,"left":{"x":[1,0],"y":[0,0]},"right":{"x":[0,-8.8437e-4],"y":[0,0]}},
{"frequency_hz":950,"damping_ratio":0.02,"left":{"x":[0,0],"y":[1,0]},"right":{"x":[0,0],"y":[0,-8.3782e-4]}}]})");
  std::string cut = lobes;
  place_.file("cut.toml", cut.erase(cut.find("[dynamics]"), cut.find("[lobes]") - cut.find("[dynamics]")));
  place_.file("job.toml", "[job]\nmodes = \"modes.json\"\nlobes = \"cut.toml\"\n");
  const JobOutcome outcome = run({{"input", "job.toml"}, {"output", "out"}, {"options", {{"seed", 3}}}});
  EXPECT_EQ(outcome.shortfall, "");
  EXPECT_EQ(kind_of_file(place_.at("out/plan.json")), (FileKind{"result", "plan"}));
  EXPECT_EQ(kind_of_file(place_.at("out/lobes.json")), (FileKind{"result", "lobes"}));
}

TEST_F(JobVerbs, RequestsAreCheckedBeforeTheyWait) {
  const Json simulate = {{"verb", "simulate"}, {"input", "lobes.toml"}, {"options", {{"at", {6000, 1}}}}};
  EXPECT_EQ(read(simulate).inputs, std::vector<std::string>{"lobes.toml"});
  const auto with = [&](const char* key, const Json& value) {
    Json body = simulate;
    body["options"][key] = value;
    return no(body);
  };
  EXPECT_NE(no({{"verb", "rm"}, {"input", "a"}}).find("verb: must be one of \"plan\", \"frf\""), std::string::npos);
  EXPECT_EQ(no({{"verb", "frf"}, {"input", Json::array()}}), "input: must be a path or a list of paths");
  EXPECT_EQ(no({{"verb", "lobes"}, {"input", {"a", "b"}}}), "input: lobes takes one file");
  EXPECT_NE(no({{"verb", "frf"}, {"input", "../hits.toml"}}).find("must not lead upwards"), std::string::npos);
  EXPECT_NE(no({{"verb", "frf"}, {"input", "a"}, {"output", "../b.uff"}}).find("upwards"), std::string::npos);
  EXPECT_NE(no({{"verb", "frf"}, {"input", "a"}, {"output", "b.doc"}}).find("FRFs are written as"), std::string::npos);
  EXPECT_NE(no({{"verb", "simulate"}, {"input", "lobes.toml"}}).find("options.at: is missing; simulate needs it"),
            std::string::npos);
  EXPECT_NE(with("secnds", 1).find("options.secnds: is no option of simulate. Did you mean seconds?"),
            std::string::npos);
  EXPECT_NE(with("seconds", -1).find("options.seconds = -1 s; must be > 0"), std::string::npos);
  EXPECT_NE(with("seconds", "long").find("must be a number"), std::string::npos);
  EXPECT_NE(with("at", {6000}).find("options.at = [6000]; must be [spindle speed in rpm"), std::string::npos);
  EXPECT_NE(with("at", {0, 1}).find("must be [spindle speed"), std::string::npos);
  EXPECT_NE(with("linear", 1).find("must be true or false"), std::string::npos);
  EXPECT_NE(with("seed", 1.5).find("must be a whole number >= 0"), std::string::npos);
  EXPECT_NO_THROW(static_cast<void>(read({{"verb", "lobes"}, {"input", "a"}, {"options", {{"at", nullptr}}}})));
  EXPECT_NE(no({{"verb", "lobes"}, {"input", "a"}, {"options", 3}}).find("options: must be an object"),
            std::string::npos);
  EXPECT_NE(no({{"verb", "modes"}, {"input", "a"}, {"options", {{"band_hz", {1, 2, 3}}}}}).find("a list of 2 numbers"),
            std::string::npos);
  EXPECT_NE(
      no({{"verb", "modes"}, {"input", "a"}, {"options", {{"method", "magic"}}}}).find("must be one of \"hybrid\""),
      std::string::npos);
  EXPECT_NE(no({{"verb", "smooth"}, {"input", "a"}, {"options", {{"cell", "/etc/passwd"}}}}).find("options.cell"),
            std::string::npos);
  EXPECT_NE(no({{"verb", "joint"}, {"input", "a"}, {"options", {{"measured", {"a/../../b"}}}}}).find("upwards"),
            std::string::npos);
  EXPECT_NE(no({{"verb", "joint"}, {"input", "a"}, {"options", {{"measured", Json::array()}}}}).find("list of paths"),
            std::string::npos);
}

TEST_F(JobVerbs, NothingThatIsReadIsOverwritten) {
  EXPECT_NE(
      no({{"verb", "coefficients"}, {"input", "a/slots.toml"}, {"output", "a/slots.toml"}}).find("is read by this job"),
      std::string::npos);
  EXPECT_NE(no({{"verb", "couple"},
                {"input", "assembly.toml"},
                {"output", "tip.uff"},
                {"options", {{"holder_out", "assembly.toml"}}}})
                .find("is read by this job"),
            std::string::npos);
  EXPECT_NE(no({{"verb", "joint"},
                {"input", "assembly.toml"},
                {"output", "tip.json"},
                {"options", {{"measured", {"tip.json"}}}}})
                .find("is read by this job"),
            std::string::npos);
}

TEST_F(JobVerbs, NothingThatADocumentNamesIsOverwritten) {
  std::filesystem::create_directories(place_.at("a"));
  place_.file("a/modes.json", "{}");
  place_.file("a/lobes.toml", "[dynamics]\nfile = \"modes.json\"\n");
  place_.file("job.toml", "[job]\nlobes = \"a/lobes.toml\"\n");
  place_.file("a/self.toml", "me = [\"self.toml\", [\"none.toml\", \"\"]]\n");
  std::filesystem::create_symlink("modes.json", place_.at("a/alias.json"));
  const auto lobes_to = [](const char* output) {
    return Json{{"verb", "lobes"}, {"input", "a/lobes.toml"}, {"output", output}};
  };
  EXPECT_NE(no(lobes_to("a/modes.json")).find("a/modes.json: is read by this job"), std::string::npos);
  EXPECT_NE(no(lobes_to("a/alias.json")).find("is read by this job"), std::string::npos);
  EXPECT_EQ(read(lobes_to("a/lobes.json")).output, "a/lobes.json");
  EXPECT_EQ(read(lobes_to("modes.json")).output, "modes.json");
  // A folder gets files of many names.
  EXPECT_NE(no({{"verb", "plan"}, {"input", "job.toml"}, {"output", "a"}}).find("stands in the folder that it writes"),
            std::string::npos);
  EXPECT_EQ(read({{"verb", "plan"}, {"input", "job.toml"}, {"output", "out"}}).output, "out");
  EXPECT_EQ(read({{"verb", "lobes"}, {"input", "a/self.toml"}, {"output", "a/b.json"}}).output, "a/b.json");
  // Two things in one place.
  const Json twice = {{"verb", "couple"},
                      {"input", "assembly.toml"},
                      {"output", "tip.uff"},
                      {"options", {{"holder_out", "a/../tip.uff"}}}};
  EXPECT_NE(no(twice), "");
  Json same = twice;
  same["options"]["holder_out"] = "tip.uff";
  EXPECT_NE(no(same).find("is where two outputs would be written"), std::string::npos);
}

TEST_F(JobVerbs, AreListedForThePage) {
  const Json list = verbs_json();
  std::set<std::string> names;
  for (const Json& verb : list) {
    names.insert(verb["verb"].get<std::string>());
    EXPECT_FALSE(verb["inputs"].empty());
    EXPECT_FALSE(verb["output"].get<std::string>().empty());
    for (const Json& option : verb["options"]) {
      EXPECT_FALSE(option["does"].get<std::string>().empty()) << option;
      EXPECT_EQ(option["takes"] == "word", option.contains("words")) << option;
    }
  }
  EXPECT_EQ(names.size(), list.size());
  EXPECT_EQ(names.size(), 17U);
}

}  // namespace job_verbs_test
}  // namespace robomill::serve
