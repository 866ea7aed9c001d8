#include "robomill/coupling/files/assembly_toml.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <complex>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "testing/coupling/free_beam.hpp"
#include "testing/support.hpp"
#include "testing/text.hpp"

namespace robomill::coupling {
namespace assembly_toml_test {

const std::string good = R"([frequency]
range_hz = [1, 5000]
step_hz = 1
[[tool]]
length_mm = 20
diameter_mm = 12
flutes = 3
flute_diameter_ratio = 0.85
youngs_modulus_gpa = 580
density_kg_per_m3 = 14450
poissons_ratio = 0.22
loss_factor = 0.002
[[tool]]
length_mm = 98.92
diameter_mm = 12
inner_diameter_mm = 2
youngs_modulus_gpa = 200
mass_kg = 0.08
loss_factor = 0.02
beam = "euler-bernoulli"
[joint]
translational_stiffness_n_per_m = 9.7e7
translational_damping_n_s_per_m = 18.6
rotational_stiffness_n_m_per_rad = 9.6e5
rotational_damping_n_m_s_per_rad = 10.4
cross_stiffness_n_per_rad = 1e3
points = 5
insertion_length_mm = 30
[[joint.shank]]
length_mm = 30
diameter_mm = 12
youngs_modulus_gpa = 200
density_kg_per_m3 = 7800
[holder]
segments = [{ length_mm = 50.90, diameter_mm = 40, youngs_modulus_gpa = 200, density_kg_per_m3 = 7800 },
            { length_mm = 10, diameter_mm = 60, youngs_modulus_gpa = 200, density_kg_per_m3 = 7800 }]
)";

const std::string bar = R"([[tool]]
length_mm = 60
diameter_mm = 12
youngs_modulus_gpa = 200
density_kg_per_m3 = 7800
loss_factor = 0.02
)";

std::string with(const std::string& old_text, const std::string& new_text) {
  return test_support::replaced(good, old_text, new_text);
}

modal::Frf frf(const char* name, const Eigen::VectorXcd& values) {
  return {.name = modal::parse_frf_name(name), .receptance = values};
}

Segment steel(double length_m, double diameter_m) {
  return {.length_m = length_m,
          .diameter_m = diameter_m,
          .youngs_modulus_pa = 200e9,
          .density_kg_per_m3 = 7800.0,
          .loss_factor = 0.02};
}

/// Receptances at a holder's mouth, rotations included, from 50 to 3,000 Hz.
modal::FrfSet holder_frfs() {
  const Assembly bare{.tool = {steel(0.05, 0.03)}, .joint = {}, .holder = {}};
  return tip_frfs(bare, Eigen::VectorXd::LinSpaced(60, 50.0, 3000.0), {.rotations = true}).frfs;
}

TEST(AssemblyToml, ReadsEverythingInSi) {
  const test::Folder folder;
  const AssemblyFile file = read_assembly(folder.file("assembly.toml", good));
  ASSERT_EQ(file.assembly.tool.size(), 2U);
  const Segment& tip = file.assembly.tool[0];
  EXPECT_DOUBLE_EQ(tip.length_m, 0.02);
  EXPECT_DOUBLE_EQ(tip.diameter_m, 0.012);
  EXPECT_EQ(tip.flutes, 3);
  EXPECT_DOUBLE_EQ(tip.flute_diameter_ratio, 0.85);
  EXPECT_DOUBLE_EQ(tip.youngs_modulus_pa, 580e9);
  EXPECT_DOUBLE_EQ(tip.density_kg_per_m3, 14450.0);
  EXPECT_DOUBLE_EQ(tip.poissons_ratio, 0.22);
  EXPECT_DOUBLE_EQ(tip.loss_factor, 0.002);
  EXPECT_EQ(tip.beam, Beam::timoshenko);
  EXPECT_EQ(tip.mass_kg, 0.0);
  const Segment& shank = file.assembly.tool[1];
  EXPECT_DOUBLE_EQ(shank.inner_diameter_m, 0.002);
  EXPECT_DOUBLE_EQ(shank.mass_kg, 0.08);
  EXPECT_EQ(shank.flutes, 0);
  EXPECT_EQ(shank.beam, Beam::euler_bernoulli);
  ASSERT_TRUE(file.assembly.joint);
  const Joint& joint = *file.assembly.joint;
  EXPECT_DOUBLE_EQ(joint.translational_stiffness_n_per_m, 9.7e7);
  EXPECT_DOUBLE_EQ(joint.translational_damping_n_s_per_m, 18.6);
  EXPECT_DOUBLE_EQ(joint.rotational_stiffness_n_m_per_rad, 9.6e5);
  EXPECT_DOUBLE_EQ(joint.rotational_damping_n_m_s_per_rad, 10.4);
  EXPECT_DOUBLE_EQ(joint.cross_stiffness_n_per_rad, 1e3);
  EXPECT_EQ(joint.points, 5);
  EXPECT_DOUBLE_EQ(joint.insertion_length_m, 0.03);
  ASSERT_EQ(joint.shank.size(), 1U);
  EXPECT_DOUBLE_EQ(joint.shank[0].length_m, 0.03);
  ASSERT_EQ(file.assembly.holder.segments.size(), 2U);
  EXPECT_DOUBLE_EQ(file.assembly.holder.segments[0].length_m, 0.0509);
  EXPECT_DOUBLE_EQ(file.assembly.holder.segments[1].diameter_m, 0.06);
  ASSERT_EQ(file.frequency_hz.size(), 5000);
  EXPECT_EQ(file.frequency_hz(0), 1.0);
  EXPECT_EQ(file.frequency_hz(4999), 5000.0);
  EXPECT_TRUE(file.notes.empty());
}

TEST(AssemblyToml, ReadsHowTheJointIsSearchedFor) {
  const test::Folder folder;
  const auto search = [&](const std::string& text) {
    return read_assembly(folder.file("assembly.toml", good + "[search]\n" + text)).search;
  };
  const JointFitOptions options = search(
      "translational_stiffness_n_per_m = [1e6, 1e9]\nrotational_damping_n_m_s_per_rad = [0, 50]\n"
      "population = 40\ngenerations = 80\ncrossover = 0.7\nmutation_rate = 0.02\nmutation = \"adaptive\"\n");
  EXPECT_EQ(options.lower, (std::array<double, 4>{1e6, 0.0, 0.0, 0.0}));
  EXPECT_EQ(options.upper, (std::array<double, 4>{1e9, 0.0, 0.0, 50.0}));
  EXPECT_EQ(options.population, 40);
  EXPECT_EQ(options.generations, 80);
  EXPECT_DOUBLE_EQ(options.crossover, 0.7);
  EXPECT_DOUBLE_EQ(options.mutation_rate, 0.02);
  EXPECT_EQ(options.mutation, Mutation::adaptive);
  // Absent: as published.
  const JointFitOptions none = search("");
  EXPECT_EQ(none.upper, (std::array<double, 4>{}));
  EXPECT_EQ(none.population, 20);
  EXPECT_EQ(none.generations, 50);

  const auto expect = [&](const std::string& text, const std::string& words) {
    const std::string said = test::rejection([&] { static_cast<void>(search(text)); });
    EXPECT_NE(said.find(words), std::string::npos) << said;
  };
  expect("population = 2\n", "assembly.toml:38: search.population = 2");
  expect("generations = 0\n", "search.generations = 0");
  expect("crossover = 1.5\n", "search.crossover = 1.5");
  expect("mutation = \"other\"\n", "must be one of \"uniform\", \"adaptive\"");
  expect("translational_stiffness_n_per_m = [0, 1e9]\n", "must be [from, to] with 0 < from <= to");
  expect("translational_stiffness_n_per_m = [1e9, 1e6]\n", "must be [from, to] with 0 < from <= to");
  expect("rotational_damping_n_m_s_per_rad = [-1, 5]\n", "must be [from, to] with 0 <= from <= to");
  expect("rotational_damping_n_m_s_per_rad = 5\n", "must be [from, to]");
  expect("rotational_damping_n_m_s_per_rad = [0, 0]\n", "must not end at 0");
  expect("populaton = 20\n", "populaton");
}

TEST(AssemblyToml, LinesEndWhereTheRangeDoes) {
  const test::Folder folder;
  const auto lines = [&](const std::string& frequency) {
    return read_assembly(folder.file("assembly.toml", "[frequency]\n" + frequency + bar)).frequency_hz;
  };
  const Eigen::VectorXd tenths = lines("range_hz = [0.1, 0.7]\nstep_hz = 0.1\n");
  ASSERT_EQ(tenths.size(), 7);
  EXPECT_NEAR(tenths(6), 0.7, 1e-12);
  EXPECT_EQ(lines("range_hz = [1, 10]\nstep_hz = 4\n"), Eigen::Vector3d(1.0, 5.0, 9.0));
  EXPECT_EQ(lines("range_hz = [1, 10]\nstep_hz = 40\n").size(), 1);
}

TEST(AssemblyToml, WithoutAHolderTheToolStandsOnAWall) {
  const test::Folder folder;
  const std::string lines = "[frequency]\nrange_hz = [100, 101]\nstep_hz = 1\n";
  for (const char* holder : {"", "[holder]\nsegments = []\n"}) {
    const AssemblyFile file = read_assembly(folder.file("assembly.toml", lines + bar + holder));
    EXPECT_FALSE(file.assembly.joint);
    EXPECT_TRUE(file.assembly.holder.segments.empty());
    EXPECT_TRUE(file.assembly.holder.receptances.frfs.empty());
    const bool said = *holder != '\0';
    EXPECT_EQ(file.notes.size(), said ? 1U : 0U);
    EXPECT_EQ(std::ranges::any_of(file.assumed, [](const Assumption& one) { return one.key == "holder"; }), !said);
  }
}

// 20,000 lines of 100 points take 3.6 s of processor time and those of a joint at the mouth 0.06 s.
TEST(AssemblyToml, AJointOfManyPointsCosts) {
  const test::Folder folder;
  const std::string lines = "[frequency]\nrange_hz = [1, 1000]\nstep_hz = 0.001\n";
  const std::string joint = "[joint]\ntranslational_stiffness_n_per_m = 1e8\nrotational_stiffness_n_m_per_rad = 1e5\n";
  const auto read = [&](const std::string& more) {
    return read_assembly(folder.file("assembly.toml", lines + bar + joint + more));
  };
  EXPECT_EQ(read("").frequency_hz.size(), 999001);
  const std::string said = test::rejection([&] {
    static_cast<void>(read("points = 100\ninsertion_length_mm = 30\n[[joint.shank]]\n" +
                           std::string("length_mm = 30\ndiameter_mm = 12\nyoungs_modulus_gpa = 200\n") +
                           "density_kg_per_m3 = 7800\n"));
  });
  EXPECT_NE(said.find("assembly.toml:3: frequency.step_hz = 0.001 Hz"), std::string::npos) << said;
}

TEST(AssemblyToml, AFreeToolIsHeldByNothing) {
  const test::Folder folder;
  const std::string lines = "[frequency]\nrange_hz = [100, 101]\nstep_hz = 1\n";
  const AssemblyFile file = read_assembly(folder.file("assembly.toml", lines + bar + "[holder]\nfree = true\n"));
  EXPECT_TRUE(file.assembly.holder.free);
  EXPECT_EQ(file.notes, std::vector<std::string>{"The tool hangs free: nothing holds it."});
  EXPECT_TRUE(std::ranges::none_of(file.assumed, [](const Assumption& one) { return one.key == "joint"; }));
  const auto said = [&](const std::string& more) {
    return test::rejection([&] {
      static_cast<void>(read_assembly(folder.file("assembly.toml", lines + bar + "[holder]\nfree = true\n" + more)));
    });
  };
  EXPECT_NE(said("segments = []\n").find("assembly.toml:12: holder.segments"), std::string::npos)
      << said("segments = []\n");
  EXPECT_NE(said("[joint]\ntranslational_stiffness_n_per_m = 1\nrotational_stiffness_n_m_per_rad = 1\n")
                .find("must not stand beside holder.free = true"),
            std::string::npos);
  // Nor does a tool that cuts hang free, nor one whose joint is looked for.
  const auto rejects = [&](const AssemblyReading& reading) {
    return test::rejection([&] { static_cast<void>(read_assembly(folder.at("assembly.toml"), reading)); });
  };
  folder.file("assembly.toml", lines + bar + "[holder]\nfree = true\n");
  const std::string cutting = rejects({.cuts = true}), sought = rejects({.joint_sought = true});
  EXPECT_NE(cutting.find("assembly.toml:11: holder.free = true; must not be true where the tool is to cut"),
            std::string::npos)
      << cutting;
  EXPECT_NE(sought.find("assembly.toml:11: holder.free = true; must not be true where a joint is looked for"),
            std::string::npos)
      << sought;
  EXPECT_FALSE(read_assembly(folder.file("assembly.toml", lines + bar + "[holder]\nfree = false\nsegments = []\n"))
                   .assembly.holder.free);
}

TEST(AssemblyToml, AnAccelerometerStandsOnTheTip) {
  const test::Folder folder;
  const std::string lines = "[frequency]\nrange_hz = [100, 101]\nstep_hz = 1\n";
  const auto read = [&](const std::string& table) {
    return read_assembly(folder.file("assembly.toml", lines + bar + table));
  };
  const AssemblyFile file = read("[accelerometer]\nmass_kg = 0.0031\noffset_mm = 3.5\n");
  EXPECT_DOUBLE_EQ(file.assembly.accelerometer.mass_kg, 0.0031);
  EXPECT_DOUBLE_EQ(file.assembly.accelerometer.offset_m, 0.0035);
  ASSERT_EQ(file.notes.size(), 1U);
  EXPECT_NE(file.notes[0].find("an accelerometer of 0.0031 kg on it"), std::string::npos) << file.notes[0];
  EXPECT_EQ(read("").assembly.accelerometer.mass_kg, 0.0);
  const auto said = [&](const std::string& table) { return test::rejection([&] { static_cast<void>(read(table)); }); };
  EXPECT_NE(said("[accelerometer]\nmass_kg = -1\n").find("accelerometer.mass_kg = -1 kg"), std::string::npos);
  EXPECT_NE(said("[accelerometer]\nmass_kg = 3.1\n").find("accelerometer.mass_kg = 3.1 kg"), std::string::npos);
  EXPECT_NE(said("[accelerometer]\noffset_mm = 3\n").find("accelerometer.mass_kg"), std::string::npos);
}

// Of hits whose acquisition.accelerometer_mass_kg was stated the mass is out of the FRFs already.
TEST(AssemblyToml, AnAccelerometerUnderASoughtJointMustBeInTheFrfs) {
  const test::Folder folder;
  const AssemblyFile file =
      read_assembly(folder.file("assembly.toml", bar + "[accelerometer]\nmass_kg = 0.0031\n"), {.joint_sought = true});
  EXPECT_DOUBLE_EQ(file.assembly.accelerometer.mass_kg, 0.0031);
  ASSERT_EQ(file.notes.size(), 1U);
  EXPECT_NE(file.notes[0].find("acquisition.accelerometer_mass_kg"), std::string::npos) << file.notes[0];
}

TEST(AssemblyToml, AToolThatCutsCarriesNoAccelerometer) {
  const test::Folder folder;
  const std::string lines = "[frequency]\nrange_hz = [100, 101]\nstep_hz = 1\n";
  const AssemblyFile file =
      read_assembly(folder.file("assembly.toml", lines + bar + "[accelerometer]\nmass_kg = 0.0031\noffset_mm = 3.5\n"),
                    {.cuts = true});
  EXPECT_EQ(file.assembly.accelerometer.mass_kg, 0.0);
  EXPECT_DOUBLE_EQ(file.removed_accelerometer.mass_kg, 0.0031);
  EXPECT_DOUBLE_EQ(file.removed_accelerometer.offset_m, 0.0035);
  EXPECT_TRUE(file.notes.empty());
  EXPECT_NE(file.cutting_note.find("The accelerometer of 0.0031 kg"), std::string::npos) << file.cutting_note;
}

// What the file leaves open is listed with its key, of segments by how many of a table leave it.
TEST(AssemblyToml, ListsWhatItAssumes) {
  const test::Folder folder;
  const std::string lines = "[frequency]\nrange_hz = [1, 2]\nstep_hz = 1\n";
  const std::string segment = "length_mm = 20\ndiameter_mm = 12\nyoungs_modulus_gpa = 200\ndensity_kg_per_m3 = 7800\n";
  const auto text_of = [&](const std::string& text) {
    return assumed_text(read_assembly(folder.file("assembly.toml", lines + text)).assumed);
  };
  EXPECT_EQ(
      text_of("[[tool]]\n" + segment + "flutes = 2\nloss_factor = 0.01\n[[tool]]\n" + segment),
      "Assumed, because not given:\n"
      "  Joint between tool and holder: rigid (joint of assembly.toml)\n"
      "  Holder: none, the tool stands on a rigid wall (holder of assembly.toml)\n"
      "  Loss factor, 1 of 2 segments of [[tool]]: 0, the material does not damp (tool.loss_factor of assembly.toml)\n"
      "  Poisson's ratio, 2 of 2 segments of [[tool]]: 0.3 (tool.poissons_ratio of assembly.toml)\n"
      "  Diameter that flutes count with, 1 of 2 segments of [[tool]]: 0.8 of the cutter's "
      "(tool.flute_diameter_ratio of assembly.toml)\n");
  const std::string said = segment + "loss_factor = 0.01\npoissons_ratio = 0.3\n";
  EXPECT_EQ(text_of("[[tool]]\n" + said +
                    "[joint]\ntranslational_stiffness_n_per_m = 1e8\nrotational_stiffness_n_m_per_rad = 1e6\n"
                    "[[holder.segments]]\n" +
                    said),
            "Assumed, because not given:\n"
            "  Damping of the joint: none (joint.translational_damping_n_s_per_m of assembly.toml)\n");
}

TEST(AssemblyToml, RejectsInTheFilesWords) {
  const test::Folder folder;
  const auto expect = [&](const std::string& old_text, const std::string& new_text, const std::string& words) {
    const std::string said = test::rejection(
        [&] { static_cast<void>(read_assembly(folder.file("assembly.toml", with(old_text, new_text)))); });
    EXPECT_NE(said.find(words), std::string::npos) << said;
  };
  expect("length_mm = 20", "length_mm = 0", "assembly.toml:5: tool[1].length_mm = 0 mm; must be > 0");
  expect("length_mm = 98.92", "length_mm = -98.92", "assembly.toml:14: tool[2].length_mm = -98.92 mm; must be > 0");
  expect("length_mm = 20\n", "", "assembly.toml:4: tool[1].length_mm: is missing");
  expect("inner_diameter_mm = 2", "inner_diameter_mm = 12", "assembly.toml:16: tool[2].inner_diameter_mm = 12 mm");
  expect("youngs_modulus_gpa = 580", "youngs_modulus_gpa = -1", "assembly.toml:9: tool[1].youngs_modulus_gpa = -1 GPa");
  expect("poissons_ratio = 0.22", "poissons_ratio = 0.7", "assembly.toml:11: tool[1].poissons_ratio = 0.7");
  expect("loss_factor = 0.002", "loss_factor = 2", "assembly.toml:12: tool[1].loss_factor = 2");
  expect("flutes = 3", "flutes = -3", "assembly.toml:7: tool[1].flutes = -3");
  expect("flutes = 3", "flutes = 2.5", "must be a whole number");
  expect("beam = \"euler-bernoulli\"", "beam = \"euler\"",
         "assembly.toml:20: tool[2].beam = \"euler\"; must be one of \"timoshenko\", \"euler-bernoulli\"");
  expect("translational_stiffness_n_per_m = 9.7e7", "translational_stiffness_n_per_m = -1",
         "assembly.toml:22: joint.translational_stiffness_n_per_m = -1 N/m; must be > 0");
  expect("rotational_stiffness_n_m_per_rad = 9.6e5\n", "", "joint.rotational_stiffness_n_m_per_rad: is missing");
  expect("rotational_damping_n_m_s_per_rad = 10.4", "rotational_damping_n_m_s_per_rad = -10.4",
         "assembly.toml:25: joint.rotational_damping_n_m_s_per_rad = -10.4 N m s/rad");
  expect("cross_stiffness_n_per_rad = 1e3", "cross_stiffness_n_per_rad = 1e9",
         "assembly.toml:26: joint.cross_stiffness_n_per_rad = 1e+09 N/rad");
  expect("points = 5", "points = 0", "assembly.toml:27: joint.points = 0");
  expect("insertion_length_mm = 30", "insertion_length_mm = 31", "assembly.toml:28: joint.insertion_length_mm = 31 mm");
  expect("[[joint.shank]]\nlength_mm = 30", "[[joint.shank]]\nlength_mm = -30",
         "assembly.toml:30: joint.shank[1].length_mm = -30 mm");
  expect("length_mm = 50.90", "length_mm = -50.90", "assembly.toml:35: holder.segments[1].length_mm = -50.9 mm");
  expect("range_hz = [1, 5000]", "range_hz = [5000, 1]", "assembly.toml:2: frequency.range_hz: must be [from, to]");
  expect("range_hz = [1, 5000]", "range_hz = [-1, 5000]",
         "assembly.toml:2: frequency.range_hz[1] = -1 Hz; must be >= 0");
  expect("range_hz = [1, 5000]", "range_hz = [1]", "must hold 2 entries; it holds 1. [from, to]");
  expect("step_hz = 1\n", "step_hz = 0\n", "assembly.toml:3: frequency.step_hz = 0 Hz; must be > 0");
  expect("step_hz = 1\n", "step_hz = 1e-9\n", "frequency.step_hz = 1e-09 Hz; would take about ");
  expect("step_hz = 1\n", "", "frequency.step_hz: is missing");
  expect("range_hz = [1, 5000]\n", "", "frequency.range_hz: is missing");
  expect("[frequency]\nrange_hz = [1, 5000]\nstep_hz = 1\n", "", "assembly.toml: frequency: is missing");
  expect("inner_diameter_mm", "bore_mm", "tool[2].bore_mm: is not known here");
  expect("[holder]\n", "[holder]\nreceptances = \"holder.uff\"\n", "must not stand beside segments");
  expect("[holder]\n", "[holder]\npoints_mm = [0, 15]\n", "holder.points_mm: goes with holder.receptances");
  expect("[[tool]]\nlength_mm = 20", "[tool]\nlength_mm = 20", "assembly.toml");
  const auto say = [&](const std::string& text) {
    return test::rejection([&] { static_cast<void>(read_assembly(folder.file("assembly.toml", text))); });
  };
  EXPECT_NE(say("[frequency]\nrange_hz = [1, 2]\nstep_hz = 1\n").find("tool: is missing"), std::string::npos);
  EXPECT_NE(say("tool = []\n").find("at least one segment"), std::string::npos);
  EXPECT_NE(say(bar + "[holder]\n").find("must give segments or receptances"), std::string::npos);
}

// What is sought need not be said, and its FRF brings its own lines.
TEST(AssemblyToml, ASoughtJointNeedsNoStiffness) {
  const test::Folder folder;
  const AssemblyFile bare = read_assembly(folder.file("assembly.toml", bar), {.joint_sought = true});
  EXPECT_FALSE(bare.assembly.joint);
  EXPECT_EQ(bare.frequency_hz.size(), 0);
  const AssemblyFile file =
      read_assembly(folder.file("assembly.toml", "[frequency]\nrange_hz = [200, 3000]\n" + bar +
                                                     "[joint]\ncross_stiffness_n_per_rad = 1e9\n"),
                    {.joint_sought = true});
  ASSERT_TRUE(file.assembly.joint);
  EXPECT_NO_THROW(file.assembly.validate());
  EXPECT_EQ(file.low_hz, 200.0);
  EXPECT_EQ(file.high_hz, 3000.0);
  // Values to start from are not used, so they are not judged either; what is kept is.
  const std::string start =
      "[joint]\ntranslational_stiffness_n_per_m = 0\ntranslational_damping_n_s_per_m = -1\n"
      "rotational_stiffness_n_m_per_rad = 10\nrotational_damping_n_m_s_per_rad = -1\n"
      "cross_stiffness_n_per_rad = 1e5\n";
  const auto sought = [&](const std::string& joint) {
    return read_assembly(folder.file("assembly.toml", bar + joint), {.joint_sought = true}).assembly;
  };
  EXPECT_EQ(sought(start).joint->cross_stiffness_n_per_rad, 1e5);
  EXPECT_NO_THROW(sought(start).validate());
  EXPECT_NE(test::rejection([&] { static_cast<void>(sought(start + "points = 0\n")); }).find("joint.points = 0"),
            std::string::npos);
}

// A holder's segments and their receptances, written and read, carry the tool alike.
TEST(AssemblyToml, AMeasuredHolderStandsForItsSegments) {
  const test::Folder folder;
  const modal::FrfSet holder = holder_frfs();
  Assembly whole{.tool = {steel(0.06, 0.012)}, .joint = {}, .holder = {.segments = {steel(0.05, 0.03)}}};
  for (const char* name : {"holder.uff", "holder.json", "holder.mat", "holder.csv"}) {
    modal::write_frfs(folder.at(name), holder);
    const AssemblyFile file =
        read_assembly(folder.file("assembly.toml", bar + "[holder]\nreceptances = \"" + name + "\"\n"));
    EXPECT_EQ(file.receptances, folder.at(name));
    EXPECT_FALSE(file.holder);
    const modal::FrfSet measured = tip_frfs(file.assembly, file.frequency_hz).frfs;
    const modal::FrfSet built = tip_frfs(whole, file.frequency_hz).frfs;
    for (const char* frf_name : {"xx", "yy"}) {
      const Eigen::VectorXcd& expected = built.find(modal::parse_frf_name(frf_name))->receptance;
      const Eigen::VectorXcd& found = measured.find(modal::parse_frf_name(frf_name))->receptance;
      EXPECT_LT((found - expected).norm(), 1e-7 * expected.norm()) << name;
    }
  }
}

TEST(AssemblyToml, AMeasuredHolderGivesTheLines) {
  const test::Folder folder;
  const modal::FrfSet holder = holder_frfs();
  modal::write_frfs(folder.at("holder.json"), holder);
  const std::string measured = "[holder]\nreceptances = \"holder.json\"\n";
  const auto lines = [&](const std::string& frequency) {
    return read_assembly(folder.file("assembly.toml", frequency + bar + measured)).frequency_hz;
  };
  EXPECT_EQ(lines(""), holder.frequency_hz);
  EXPECT_EQ(lines("[frequency]\nrange_hz = [100, 200]\n"), Eigen::Vector3d(100.0, 150.0, 200.0));
  EXPECT_EQ(lines("[frequency]\nrange_hz = [100, 200]\nstep_hz = 100\n"), Eigen::Vector2d(100.0, 200.0));
  const std::string said = test::rejection([&] { static_cast<void>(lines("[frequency]\nrange_hz = [1, 2]\n")); });
  EXPECT_NE(said.find("holds none of the measured holder's lines, 50 to 3000 Hz"), std::string::npos) << said;
}

TEST(AssemblyToml, SaysWhichRotationsAreLacking) {
  const test::Folder folder;
  const modal::FrfSet holder = holder_frfs();
  const auto say = [&](const std::vector<const char*>& names, const std::string& more = "") {
    modal::FrfSet some{.frequency_hz = holder.frequency_hz, .frfs = {}};
    for (const char* name : names) some.frfs.push_back(frf(name, holder.frfs.front().receptance));
    modal::write_frfs(folder.at("holder.uff"), some);
    return test::rejection([&] {
      static_cast<void>(
          read_assembly(folder.file("assembly.toml", bar + "[holder]\nreceptances = \"holder.uff\"\n" + more)));
    });
  };
  const std::string bare = say({"xx"});
  EXPECT_NE(bare.find("holder.uff: lacks ry:x (or x:my) and ry:my"), std::string::npos) << bare;
  EXPECT_NE(bare.find("points_mm = [0, 15, 30]"), std::string::npos);
  EXPECT_NE(say({"xx", "yy", "y:mx"}).find("lacks rx:mx:"), std::string::npos);
  EXPECT_NE(say({"1x:1x", "2x:1x", "2x:2x"}).find("lacks xx, ry:x (or x:my) and ry:my"), std::string::npos);
  EXPECT_NE(say({"xx"}, "max_amplification = 10\n").find("holder.points_mm: is missing"), std::string::npos);
  EXPECT_NE(say({"xx"}, "[[holder.artefact]]\nlength_mm = 3\ndiameter_mm = 3\nyoungs_modulus_gpa = 1\nmass_kg = 1\n")
                .find("holder.points_mm: is missing"),
            std::string::npos);
}

// A mouth that moves as a rigid body: u(z) = u + θ z, of which finite differences lose nothing.
TEST(AssemblyToml, CompletesRotationsFromPoints) {
  const test::Folder folder;
  const modal::FrfSet holder = holder_frfs();
  const auto plane = [&](const char* name) { return holder.find(modal::parse_frf_name(name))->receptance; };
  const std::vector<double> z = {0.0, 0.015, 0.03};
  modal::FrfSet points{.frequency_hz = holder.frequency_hz, .frfs = {}};
  for (std::size_t k = 0; k < z.size(); ++k) {
    for (std::size_t l = 0; l <= k; ++l) {
      const std::string name = std::to_string(k + 1) + "x:" + std::to_string(l + 1) + "x";
      points.frfs.push_back(
          frf(name.c_str(), plane("xx") + z[l] * plane("x:my") + z[k] * plane("ry:x") + z[k] * z[l] * plane("ry:my")));
    }
  }
  modal::write_frfs(folder.at("points.mat"), points);
  const AssemblyFile file = read_assembly(
      folder.file("assembly.toml",
                  bar + "[holder]\nreceptances = \"points.mat\"\npoints_mm = [0, 15, 30]\nmax_amplification = 1e9\n"));
  ASSERT_TRUE(file.holder);
  EXPECT_TRUE(file.holder->unreliable_hz.empty());
  for (const char* name : {"xx", "ry:my"}) {
    const modal::Frf* found = file.assembly.holder.receptances.find(modal::parse_frf_name(name));
    ASSERT_NE(found, nullptr);
    EXPECT_LT((found->receptance - plane(name)).norm(), 1e-8 * plane(name).norm()) << name;
  }
  const auto say = [&](const std::string& keys) {
    return test::rejection([&] {
      static_cast<void>(
          read_assembly(folder.file("assembly.toml", bar + "[holder]\nreceptances = \"points.mat\"\n" + keys)));
    });
  };
  EXPECT_NE(say("points_mm = [0, 15, 15]\n").find("assembly.toml:9: holder.points_mm"), std::string::npos)
      << say("points_mm = [0, 15, 15]\n");
  EXPECT_NE(say("points_mm = [0]\n").find("assembly.toml:9: holder.points_mm"), std::string::npos);
  EXPECT_NE(
      say("points_mm = [0, 15]\nmax_amplification = -1\n").find("assembly.toml:10: holder.max_amplification = -1"),
      std::string::npos);
  points.frfs.erase(points.frfs.begin());
  modal::write_frfs(folder.at("points.mat"), points);
  const std::string missing = say("points_mm = [0, 15, 30]\n");
  EXPECT_NE(missing.find("points.mat"), std::string::npos) << missing;
  EXPECT_NE(missing.find("1x:1x"), std::string::npos) << missing;
}

// A rod of two parts on the holder: translations at its end and where the parts meet give the holder back.
TEST(AssemblyToml, TakesAnArtefactOff) {
  const test::Folder folder;
  const modal::FrfSet holder = holder_frfs();
  const Eigen::VectorXd& f = holder.frequency_hz;
  const modal::FrfSet end = testing::free_frfs({steel(0.02, 0.012)}, f);
  const modal::FrfSet rest =
      tip_frfs({.tool = {steel(0.04, 0.012)}, .joint = {}, .holder = {.receptances = holder}}, f, {.rotations = true})
          .frfs;
  const auto matrix = [](const modal::FrfSet& set, const std::string& to, const std::string& from, Eigen::Index line) {
    const auto at = [&](const std::string& name) { return set.find(modal::parse_frf_name(name))->receptance(line); };
    Eigen::Matrix2cd out;
    out << at(to + "x:" + from + "x"), at(to + "x:" + from + "my"), at(to + "ry:" + from + "x"),
        at(to + "ry:" + from + "my");
    return out;
  };
  modal::FrfSet measured{.frequency_hz = f, .frfs = {}};
  for (const char* name : {"1x:1x", "2x:1x", "2x:2x"}) measured.frfs.push_back(frf(name, Eigen::VectorXcd(f.size())));
  for (Eigen::Index i = 0; i < f.size(); ++i) {
    const Eigen::Matrix2cd base = matrix(rest, "", "", i);
    const Eigen::Matrix2cd r22 = matrix(end, "2", "2", i), r12 = matrix(end, "1", "2", i);
    const Eigen::Matrix2cd sum = (r22 + base).inverse();
    measured.frfs[0].receptance(i) = (matrix(end, "1", "1", i) - r12 * sum * matrix(end, "2", "1", i))(0, 0);
    measured.frfs[1].receptance(i) = (base * sum * matrix(end, "2", "1", i))(0, 0);
    measured.frfs[2].receptance(i) = (base * sum * r22)(0, 0);
  }
  modal::write_frfs(folder.at("rod.mat"), measured);
  const std::string material =
      "diameter_mm = 12\nyoungs_modulus_gpa = 200\ndensity_kg_per_m3 = 7800\nloss_factor = 0.02\n";
  const AssemblyFile file = read_assembly(
      folder.file("assembly.toml", bar +
                                       "[holder]\nreceptances = \"rod.mat\"\npoints_mm = [0, 20]\nregularisation = 0\n"
                                       "[[holder.artefact]]\nlength_mm = 60\n" +
                                       material));
  ASSERT_TRUE(file.holder);
  for (const char* name : {"xx", "ry:my"}) {
    const Eigen::VectorXcd& expected = holder.find(modal::parse_frf_name(name))->receptance;
    const modal::Frf* found = file.assembly.holder.receptances.find(modal::parse_frf_name(name));
    ASSERT_NE(found, nullptr);
    EXPECT_LT((found->receptance - expected).norm(), 1e-6 * expected.norm()) << name;
  }
}

// At the free end of a rod: translation, rotation and moment of one point give the holder back.
TEST(AssemblyToml, TakesAnArtefactOffFromOnePoint) {
  const test::Folder folder;
  const modal::FrfSet holder = holder_frfs();
  const modal::FrfSet tip = tip_frfs({.tool = {steel(0.06, 0.012)}, .joint = {}, .holder = {.receptances = holder}},
                                     holder.frequency_hz, {.rotations = true})
                                .frfs;
  for (const std::string point : {"1", ""}) {
    modal::FrfSet measured{.frequency_hz = holder.frequency_hz, .frfs = {}};
    for (const auto& [to, from] : {std::pair("x", "x"), std::pair("ry", "x"), std::pair("ry", "my")}) {
      measured.frfs.push_back(
          frf((point + to + ":" + point + from).c_str(),
              tip.find(modal::parse_frf_name(std::string(to) + ":" + std::string(from)))->receptance));
    }
    modal::write_frfs(folder.at("rod.mat"), measured);
    const AssemblyFile file = read_assembly(folder.file(
        "assembly.toml", bar + "[holder]\nreceptances = \"rod.mat\"\npoints_mm = [0]\nregularisation = 0\n"
                               "[[holder.artefact]]\nlength_mm = 60\ndiameter_mm = 12\nyoungs_modulus_gpa = 200\n"
                               "density_kg_per_m3 = 7800\nloss_factor = 0.02\n"));
    for (const Assumption& one : file.assumed) EXPECT_NE(one.taken, modal::taken_as_tip);
    for (const char* name : {"xx", "ry:my"}) {
      const Eigen::VectorXcd& expected = holder.find(modal::parse_frf_name(name))->receptance;
      const modal::Frf* found = file.assembly.holder.receptances.find(modal::parse_frf_name(name));
      ASSERT_NE(found, nullptr);
      EXPECT_LT((found->receptance - expected).norm(), 1e-6 * expected.norm()) << name;
    }
  }
}

TEST(AssemblyToml, LinesBetweenKeepWhatTheyCarry) {
  modal::FrfSet set{.frequency_hz = Eigen::Vector4d(0.0, 10.0, 20.0, 30.0),
                    .frfs = {frf("xx", Eigen::Vector4cd(1, 2, 3, 4))}};
  set.frfs[0].coherence = Eigen::Vector4d(0.1, 0.2, 0.3, 0.4);
  const modal::FrfSet part = lines_between(set, 0.0, 20.0);
  EXPECT_EQ(part.frequency_hz, Eigen::Vector2d(10.0, 20.0));
  EXPECT_EQ(part.frfs[0].receptance, Eigen::Vector2cd(2, 3));
  EXPECT_EQ(part.frfs[0].coherence, Eigen::Vector2d(0.2, 0.3));
  EXPECT_NE(test::rejection([&] { static_cast<void>(lines_between(set, 21.0, 29.0)); }).find("no line"),
            std::string::npos);
}

// Cut off or changed at any place, a file is rejected or read, and never anything worse.
TEST(AssemblyToml, SurvivesMutations) {
  const test::Folder folder;
  Random random(11);
  for (int i = 0; i < test::seeds(1000); ++i) {
    std::string text = good;
    text[random.index(text.size())] = static_cast<char>(random.index(256));
    if (i % 2 == 0) text.resize(1 + random.index(good.size() - 1));
    try {
      read_assembly(folder.file("assembly.toml", text)).assembly.validate();
    } catch (const InvalidInput&) {
      continue;
    }
  }
}

}  // namespace assembly_toml_test
}  // namespace robomill::coupling
