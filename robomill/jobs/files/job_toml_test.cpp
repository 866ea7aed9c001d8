#include "robomill/jobs/files/job_toml.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "robomill/base/units.hpp"
#include "testing/support.hpp"

namespace robomill::jobs {
namespace job_toml_test {

class JobToml : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& text) { return folder_.file(name, text); }
  std::string rejection(const std::string& text) {
    return test::rejection([&] { static_cast<void>(read_job(write("job.toml", text))); });
  }

  test::Folder folder_;
};

TEST_F(JobToml, ReadsEveryPartInSi) {
  write("cuts.toml", "[[cuts]]\nspindle_speed_rpm = 8000\naxial_depth_mm = 1.2\nresult = \"stable\"\n");
  const Job job = read_job(write("job.toml", R"([job]
frf = ["xx.txt", "yy.txt"]
frf_as = ["xx", "yy"]
lobes = "lobes.toml"
cuts = "cuts.toml"
[spindle]
max_speed_rpm = 18000
curve = [{ speed_rpm = 6000, torque_n_m = 12, power_kw = 7.5 }]
[finishing]
max_surface_error_um = 12
max_deflection_um = 30
[[cuts]]
spindle_speed_rpm = 6500
axial_depth_mm = 0.8
result = "chatter"
)"));
  ASSERT_EQ(job.frf.size(), 2U);
  EXPECT_EQ(job.frf[1], folder_.at("yy.txt"));
  EXPECT_EQ(job.lobes, folder_.at("lobes.toml"));
  EXPECT_DOUBLE_EQ(job.recommend.max_spindle_speed_rad_per_s, 18000 * units::rpm);
  ASSERT_EQ(job.recommend.spindle.size(), 1U);
  EXPECT_DOUBLE_EQ(job.recommend.spindle[0].power_w, 7500.0);
  EXPECT_DOUBLE_EQ(job.finish.max_surface_error_m, 12e-6);
  EXPECT_DOUBLE_EQ(job.finish.max_deflection_m, 30e-6);
  ASSERT_EQ(job.cuts.size(), 2U);
  EXPECT_EQ(job.cuts[0].result, decision::Verdict::chatter);
  EXPECT_DOUBLE_EQ(job.cuts[1].axial_depth_m, 1.2e-3);
}

TEST_F(JobToml, TakesAnAssemblyAndAMeasurementOfItsTip) {
  const Job job =
      read_job(write("job.toml", "[job]\nassembly = \"a.toml\"\nmeasured = \"tip.uff\"\nlobes = \"l.toml\"\n"));
  EXPECT_EQ(job.assembly, folder_.at("a.toml"));
  EXPECT_EQ(job.measured, folder_.at("tip.uff"));
  EXPECT_TRUE(job.joint.empty());
}

TEST_F(JobToml, TakesAJointInPlaceOfTheAssemblys) {
  const std::string rest = "joint = \"joint.json\"\nlobes = \"l.toml\"\n";
  EXPECT_EQ(read_job(write("job.toml", "[job]\nassembly = \"a.toml\"\n" + rest)).joint, folder_.at("joint.json"));
  EXPECT_NE(rejection("[job]\nmodes = \"m.json\"\n" + rest).find("job.toml:3: job.joint"), std::string::npos);
  EXPECT_NE(rejection("[job]\nmodes = \"m.json\"\n" + rest).find("goes with job.assembly"), std::string::npos);
}

TEST_F(JobToml, TakesAProgramWithItsCell) {
  const std::string source = "[job]\nmodes = \"m.json\"\nlobes = \"l.toml\"\n";
  const Job job = read_job(write("job.toml", source + "program = \"part.ngc\"\ncell = \"cell.toml\"\n"));
  EXPECT_EQ(job.program, folder_.at("part.ngc"));
  EXPECT_TRUE(job.forces.empty());
  EXPECT_NE(rejection(source + "program = \"part.ngc\"\n").find("job.toml:4: job.program"), std::string::npos);
  EXPECT_NE(rejection(source + "cell = \"cell.toml\"\n").find("job.toml:4: job.cell"), std::string::npos);
  EXPECT_EQ(read_job(write("job.toml", source + "forces = \"f.toml\"\ncell = \"cell.toml\"\n")).cell,
            folder_.at("cell.toml"));
}

TEST_F(JobToml, TakesWhatAMissingDirectionIsTakenFor) {
  const std::string source = "[job]\nmodes = \"m.json\"\nlobes = \"l.toml\"\n";
  EXPECT_FALSE(read_job(write("job.toml", source)).directions.equal);
  EXPECT_TRUE(read_job(write("job.toml", source + "equal_directions = true\n")).directions.equal);
  EXPECT_EQ(read_job(write("job.toml", source + "rigid_directions = [\"y\"]\n")).directions.rigid,
            std::vector<modal::Axis>{modal::Axis::y});
  EXPECT_NE(rejection(source + "rigid_directions = [\"up\"]\n").find("job.toml:4: job.rigid_directions"),
            std::string::npos);
}

TEST_F(JobToml, SaysWhatIsWrongInTheFilesOwnWords) {
  const std::string source = "[job]\nmodes = \"m.json\"\nlobes = \"l.toml\"\n";
  EXPECT_NE(rejection("[job]\nlobes = \"l.toml\"\n").find("exactly one of hits, frf, modes and assembly"),
            std::string::npos);
  EXPECT_NE(rejection(source + "assembly = \"a.toml\"\n").find("Several are given"), std::string::npos);
  EXPECT_NE(rejection(source + "measured = \"tip.uff\"\n").find("goes with job.assembly"), std::string::npos)
      << rejection(source + "measured = \"tip.uff\"\n");
  EXPECT_NE(rejection("[job]\nassembly = \"a.toml\"\nlobes = \"l.toml\"\nequal_directions = true\n")
                .find("Both directions of an assembly are predicted"),
            std::string::npos);
  EXPECT_NE(rejection(source + "[spindle]\nmax_speed_rpm = -5\n").find("job.toml:5: spindle.max_speed_rpm = -5 rpm"),
            std::string::npos)
      << rejection(source + "[spindle]\nmax_speed_rpm = -5\n");
  EXPECT_NE(
      rejection(source + "[[cuts]]\nspindle_speed_rpm = 0\naxial_depth_mm = 1\n").find("spindle_speed_rpm = 0 rpm"),
      std::string::npos);
  EXPECT_NE(rejection(source + "[[cuts]]\nspindle_speed_rpm = 10\naxial_depth_mm = 1\nresult = \"loud\"\n")
                .find("\"stable\""),
            std::string::npos);
  EXPECT_NE(rejection(source + "[safety]\ndepth_margin = 20\n").find("0.2 stays 20 % below"), std::string::npos);
  EXPECT_NE(rejection(source + "[finishing]\nmax_surface_error_um = -1\n").find("finishing.max_surface_error_um = -1"),
            std::string::npos);
  EXPECT_NE(rejection(source + "[[cuts]]\nspindle_speed_rpm = 10\naxial_depth_mm = 1\npeaks_hz = [300, -5]\n")
                .find("peaks_hz"),
            std::string::npos);
  EXPECT_NE(rejection(source + "band_hz = [300]\n").find("job.toml:4: job.band_hz"), std::string::npos);
  EXPECT_NE(rejection(source + "[spindle]\ncurve = [{ speed_rpm = 6000, torque_n_m = 2 }]\n")
                .find("spindle.curve[1].power_kw: is missing"),
            std::string::npos);
  EXPECT_NE(rejection(source + "[spindle]\ncurve = [{ speed_rpm = 6000, torque_n_m = 2, power_kw = -1 }]\n")
                .find("job.toml:5: spindle.curve[1].power_kw = -1 kW; must be >= 0"),
            std::string::npos);
  EXPECT_NE(rejection(source + "[spindel]\nmax_speed_rpm = 5\n").find("spindel"), std::string::npos);
}

// Without a program speed and depth are free, and what asks for something else is no silent wish.
TEST_F(JobToml, ADecisionWithoutAProgramIsThatOfSpeedAndDepth) {
  const std::string job = "[job]\nmodes = \"modes.json\"\nlobes = \"lobes.toml\"\n[decide]\n";
  EXPECT_NO_THROW(static_cast<void>(
      read_job(write("job.toml", job + "free = [\"axial_depth\", \"spindle_speed\"]\ngoal = \"removal_rate\"\n"))));
  for (const char* line : {"free = [\"spindle_speed\", \"feed\"]", "free = [\"axial_depth\"]", "goal = \"time\"",
                           "max_force_n = 100", "cone_deg = 10", "compensate = true"}) {
    const std::string text = rejection(job + line + "\n");
    EXPECT_NE(text.find("job.program"), std::string::npos) << text;
    EXPECT_NE(text.find("job.toml:5"), std::string::npos) << text;
  }
}

TEST_F(JobToml, AnswersSynonymsWithTheRightKey) {
  const std::string source = "[job]\nmodes = \"m.json\"\nlobes = \"l.toml\"\n";
  EXPECT_NE(rejection(source + "[spindle]\nmax_power_kw = 5\n")
                .find("job.toml:5: spindle.max_power_kw: is not known here. Here it is curve = [{ speed_rpm = "),
            std::string::npos)
      << rejection(source + "[spindle]\nmax_power_kw = 5\n");
  EXPECT_NE(rejection(source + "[[cuts]]\nrpm = 6000\naxial_depth_mm = 1\n")
                .find("job.toml:5: cuts[1].rpm: is not known here. Here it is spindle_speed_rpm"),
            std::string::npos)
      << rejection(source + "[[cuts]]\nrpm = 6000\naxial_depth_mm = 1\n");
}

// The time column gives the rate; a column in g is converted.
TEST_F(JobToml, ReadsWhatWasRecordedOfACut) {
  decision::TestCut cut = {.file = write("cut.csv", "time_s,ax_m_per_s2,ay_g\n0,1,2\n0.001,3,4\n0.002,5,6\n")};
  cut.column = "ax_m_per_s2";
  const decision::CutSignal signal = read_cut_signal(cut);
  EXPECT_NEAR(signal.sample_rate_hz, 1000.0, 1e-9);
  EXPECT_EQ(signal.acceleration, Eigen::Vector3d(1.0, 3.0, 5.0));
  cut.column = "ay_g";
  EXPECT_NEAR(read_cut_signal(cut).acceleration(2), 6.0 * units::standard_gravity, 1e-12);
  cut.file = write("no_time.csv", "ax_m_per_s2\n1\n2\n3\n");
  cut.column = "1";
  EXPECT_NE(test::rejection([&] { static_cast<void>(read_cut_signal(cut)); }).find("no time column"),
            std::string::npos);
}

}  // namespace job_toml_test
}  // namespace robomill::jobs
