// --report and tables of every verb, as a user asks for them.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "test_program.hpp"

namespace robomill::app {
namespace page_test {

using nlohmann::json;

class PageOfVerb : public ProgramTest {
 protected:
  /// The verb's page and the page's data, which has all these members.
  json report(const std::string& arguments, const std::vector<std::string>& members, int exit = 0) {
    const Ended html = robomill(arguments + " --quiet --report page.html");
    EXPECT_EQ(html.exit, exit) << arguments << ": " << html.err;
    EXPECT_TRUE(html.out.empty()) << arguments << ": " << html.out;
    EXPECT_EQ(slurp(folder_.at("page.html")).rfind("<!doctype html>", 0), 0U) << arguments;
    const Ended data = robomill(arguments + " --quiet --report page.json");
    EXPECT_EQ(data.exit, exit) << arguments << ": " << data.err;
    json page = json::parse(slurp(folder_.at("page.json")));
    for (const std::string& member : members) {
      EXPECT_FALSE(page[member].is_null()) << arguments << ": " << member;
    }
    return page;
  }
  /// The first line of the table, which has so many more.
  std::string table(const std::string& arguments, std::size_t rows) {
    const Ended run = robomill(arguments + " --quiet -o table.csv");
    EXPECT_EQ(run.exit, 0) << arguments << ": " << run.err;
    const std::string text = slurp(folder_.at("table.csv"));
    EXPECT_EQ(static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')), rows + 1) << text;
    return text.substr(0, text.find('\n'));
  }
  static bool assumes(const json& page, const std::string& what) {
    for (const json& one : page["assumed"]) {
      if (one["what"] == what) return true;
    }
    return false;
  }
  void write_assembly(const std::string& joint = {}) {
    const std::string bar =
        "diameter_mm = 12\nyoungs_modulus_gpa = 200\ndensity_kg_per_m3 = 7800\nloss_factor = 0.02\n";
    write("assembly.toml", "[frequency]\nrange_hz = [20, 900]\nstep_hz = 2\n[[tool]]\nlength_mm = 119\n" + bar + joint +
                               "[[holder.segments]]\nlength_mm = 51\n" + bar);
  }
};

TEST_F(PageOfVerb, GoesFromHitsToModes) {
  ASSERT_EQ(shell("'" ROBOMILL_SIMULATE_HITS "' hits").exit, 0);
  const json frf = report("frf hits/hits.toml -o tip.json", {"frf"});
  EXPECT_FALSE(frf["frf"]["hits"].empty());
  EXPECT_EQ(frf["title"], "Frequency response functions");
  const json modes = report("modes tip.json --band 10,700", {"frf", "fitted", "modes"});
  EXPECT_EQ(modes["fitted"]["frequency_hz"], modes["frf"]["frequency_hz"]);
  const std::size_t count = modes["modes"]["modes"].size();
  EXPECT_EQ(table("modes tip.json --band 10,700", count).rfind("mode,frequency_hz,frequency_std_hz,", 0), 0U);
}

TEST_F(PageOfVerb, ShowsAToolInItsHolder) {
  write_assembly();
  const json tip = report("couple assembly.toml -o tip.json", {"frf", "assembly"});
  EXPECT_TRUE(assumes(tip, "Joint between tool and holder")) << tip["assumed"].dump();
  EXPECT_EQ(json::parse(slurp(folder_.at("tip.json")))["assumed"], tip["assumed"]);
  write("tools.csv", "tool,length_mm,diameter_mm,teeth\nbar,119,12,2\nshort,80,12,3\n");
  EXPECT_EQ(report("couple assembly.toml --tools tools.csv", {"tools"})["tools"]["tools"].size(), 2U);
  write_assembly(
      "[joint]\ntranslational_stiffness_n_per_m = 2e7\ntranslational_damping_n_s_per_m = 40\n"
      "rotational_stiffness_n_m_per_rad = 5e4\nrotational_damping_n_m_s_per_rad = 0.5\n");
  ASSERT_EQ(robomill("couple assembly.toml -o tip.uff").exit, 0);
  write_assembly();
  const std::string joint = "joint assembly.toml --measured tip.uff";
  EXPECT_EQ(report(joint, {"joint", "frf", "fitted"})["joint"]["std"].size(), 4U);
  EXPECT_EQ(table(joint, 4), "parameter,value,std,identifiable");
}

TEST_F(PageOfVerb, ShowsTheStabilityOfACut) {
  write_lobes();
  const json chart = report("lobes lobes.toml --at 6500,0.6", {"lobes"});
  EXPECT_EQ(chart["lobes"]["points"].size(), 1U);
  EXPECT_TRUE(assumes(chart, "Helix angle")) << chart["assumed"].dump();
  EXPECT_EQ(table("lobes lobes.toml", 20),
            "spindle_speed_rpm,axial_depth_mm,chatter_frequency_hz,kind,mode,mode_of,error_estimate");
  EXPECT_EQ(table("lobes lobes.toml --at 6500,0.6 --at 8000,1", 2).rfind("spindle_speed_rpm,axial_depth_mm,limit", 0),
            0U);
  const json methods = report("lobes lobes.toml --compare", {"comparison"});
  const std::size_t count = methods["comparison"]["methods"].size();
  EXPECT_EQ(table("lobes lobes.toml --compare", count).rfind("method,lowest_limit_mm,", 0), 0U);

  const json cut = report("simulate lobes.toml --at 6500,0.6 --seconds 0.3 -o cut.csv", {"simulation", "vibration"});
  EXPECT_EQ(cut["simulation"]["verdict"], "chatter");
  EXPECT_FALSE(cut["vibration"]["displacement_um"]["x"]["low"].empty());
  EXPECT_TRUE(assumes(cut, "Runout")) << cut["assumed"].dump();

  const std::string peaks =
      "explain --peaks 325,667,992 --rpm 6500 --teeth 3 --modes " ROBOMILL_SOURCE_DIR "/data/robot-modes.toml";
  EXPECT_EQ(report(peaks, {"explanation"})["explanation"]["peaks"].size(), 3U);
  EXPECT_TRUE(assumes(report(peaks + " --lobes lobes.toml --at 6500,0.6", {"explanation"}), "Helix angle"));
  EXPECT_EQ(table(peaks, 3).rfind("frequency_hz,state,kind,", 0), 0U);
}

TEST_F(PageOfVerb, ShowsASweep) {
  write("lead.toml",
        "[tool]\nkind = \"ball-end\"\nteeth = 2\ndiameter_mm = 10\n[cut]\ndirection = \"slot\"\naxial_depth_mm = 0.5\n"
        "feed_per_tooth_mm = 0.05\n[coefficients]\ntangential_n_per_mm2 = 712\nradial_n_per_mm2 = 287\n[dynamics]\n"
        "modes = \"" ROBOMILL_SOURCE_DIR
        "/data/robot-modes.toml\"\n[lobes]\nspindle_speed_rpm = [6000, 9000]\nsweep = \"lead\"\n"
        "lead_deg = [-20, 20]\ngrid = [3, 4]\n");
  EXPECT_EQ(report("lobes lead.toml", {"sweep"})["sweep"]["lead_deg"].size(), 4U);
  const Ended run = robomill("lobes lead.toml -o sweep.csv");
  EXPECT_EQ(run.exit, 0) << run.err;
  EXPECT_EQ(slurp(folder_.at("sweep.csv")).rfind("spindle_speed_rpm,from_lead_deg,to_lead_deg\n6000,", 0), 0U);
}

TEST_F(PageOfVerb, ShowsWhatWasIdentified) {
  write(
      "slots.csv",
      "feed_per_tooth_mm,axial_depth_mm,spindle_speed_rpm,fx_n,fy_n,fz_n\n0.05,5.08,3000,-555.8508,655.6513,255.9891\n"
      "0.1,5.08,3000,-751.4308,1119.2013,493.6902\n0.025,5.08,3000,-458.0608,423.8763,137.1385\n");
  const json slots = report("coefficients slots.csv -o k.toml", {"coefficients"});
  EXPECT_EQ(slots["coefficients"]["identification"]["residuals"][0]["feed_per_tooth_mm"], 0.05);
  EXPECT_TRUE(assumes(slots, "Teeth of the cutter"));
  write("cell.toml", "[robot]\ndh = [{ a_mm = 800 }, { a_mm = 200, alpha_deg = 90 }]\n");
  write("loads.csv",
        "q1_deg,q2_deg,fx_n,fy_n,fz_n,dx_mm,dy_mm,dz_mm\n0,90,100,0,0,0.044,-0.016,0\n0,0,0,100,0,0,0.14,0\n"
        "0,90,0,100,0,-0.016,0.064,0\n");
  const json loads = report("stiffness loads.csv --cell cell.toml", {"stiffness"});
  EXPECT_EQ(loads["stiffness"]["displacement_mm"].size(), loads["stiffness"]["residual_mm"].size());
  EXPECT_TRUE(assumes(loads, "Point that the loads attack and that moved")) << loads["assumed"].dump();
}

TEST_F(PageOfVerb, ShowsForcesAndAPlan) {
  const std::string forces = "forces " ROBOMILL_SOURCE_DIR "/examples/ball-end-ur5e/cut-1.toml";
  EXPECT_TRUE(report(forces, {"forces"})["forces"]["rotation_deg"].is_array());
  write_lobes();
  write("job.toml", "[job]\nmodes = \"" ROBOMILL_SOURCE_DIR "/data/robot-modes.toml\"\nlobes = \"lobes.toml\"\n");
  const json plan = report("plan job.toml -o out", {"plan", "modes", "lobes"});
  EXPECT_EQ(plan["assumed"], json::parse(slurp(folder_.at("out/plan.json")))["assumed"]);
  EXPECT_TRUE(assumes(plan, "Torque and power of the spindle")) << plan["assumed"].dump();
  EXPECT_NE(slurp(folder_.at("page.html")).find("Torque and power of the spindle"), std::string::npos);
}

// The list stands once in the summary, after all else, and in no note.
TEST_F(PageOfVerb, SaysWhatWasAssumedOnce) {
  write_lobes();
  const Ended run = robomill("lobes lobes.toml");
  const std::size_t at = run.out.find("Assumed, because not given:\n  Cutter: flat end (tool.kind of lobes.toml)\n");
  ASSERT_NE(at, std::string::npos) << run.out;
  EXPECT_EQ(run.out.find("Assumed", at + 1), std::string::npos) << run.out;
  EXPECT_TRUE(robomill("lobes lobes.toml --quiet").out.empty());
}

// Before the work: of a wrong name nothing is written, and no file is read.
TEST_F(PageOfVerb, RejectsAReportOfAnotherKind) {
  for (const char* verb :
       {"frf none.toml", "modes none.uff", "couple none.toml", "joint none.toml --measured none.uff", "lobes none.toml",
        "explain --peaks 300 --rpm 6500 --teeth 3 --modes none.json", "simulate none.toml --at 6500,0.6",
        "forces none.toml", "coefficients none.csv", "stiffness none.csv --cell none.toml",
        "smooth none.ngc --cell none.toml", "plan none.toml -o out", "cell check none.toml"}) {
    const Ended run = robomill(std::string(verb) + " --report page.pdf");
    EXPECT_EQ(run.exit, 1) << verb;
    EXPECT_NE(run.err.find("page.pdf: a report is written as .html or .json"), std::string::npos)
        << verb << ": " << run.err;
  }
  EXPECT_FALSE(std::filesystem::exists(folder_.at("page.pdf")));
  EXPECT_FALSE(std::filesystem::exists(folder_.at("out")));
  write_lobes();
  EXPECT_EQ(robomill("lobes lobes.toml -o lobes.json --report page.htm").exit, 1);
  EXPECT_FALSE(std::filesystem::exists(folder_.at("lobes.json")));
}

}  // namespace page_test
}  // namespace robomill::app
