#include "robomill/coupling/files/joint_json.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "robomill/base/random.hpp"
#include "robomill/coupling/files/assembly_toml.hpp"
#include "robomill/coupling/files/segment_fields.hpp"
#include "testing/support.hpp"

namespace robomill::coupling {
namespace joint_json_test {

JointFitResult found() {
  JointFitResult out;
  out.status = JointFitResult::Status::converged;
  out.joint.translational_stiffness_n_per_m = 2e7;
  out.joint.translational_damping_n_s_per_m = 40.0;
  out.joint.rotational_stiffness_n_m_per_rad = 5e4;
  out.joint.rotational_damping_n_m_s_per_rad = 0.5;
  out.objective_m_per_n = 3e-9;
  out.relative_error = 0.01;
  out.knowledge[0] = {.deviation = 1e4, .identifiable = true, .visible_up_to = 3e9};
  out.knowledge[3] = {.deviation = std::numeric_limits<double>::infinity(),
                      .note = "rotational damping: not identifiable from this FRF"};
  out.iterations = 2;
  out.start = 0.6;
  out.best = {0.5, 0.01};
  out.suspect_hz = {120.0};
  out.notes = {"a note"};
  return out;
}

TEST(JointJson, HoldsWhatWasFound) {
  const auto json = nlohmann::json::parse(joint_json(found()));
  EXPECT_EQ(json["joint"]["rotational_damping_n_m_s_per_rad"], 0.5);
  EXPECT_EQ(json["joint"].size(), 4U);
  EXPECT_EQ(json["objective"], 3e-9);
  EXPECT_EQ(json["relative_error"], 0.01);
  EXPECT_EQ(json["std"]["translational_stiffness_n_per_m"], 1e4);
  EXPECT_TRUE(json["std"]["rotational_damping_n_m_s_per_rad"].is_null());
  EXPECT_EQ(json["identifiable"]["translational_stiffness_n_per_m"], true);
  EXPECT_EQ(json["identifiable"]["rotational_damping_n_m_s_per_rad"], false);
  EXPECT_EQ(json["visible_up_to"]["translational_stiffness_n_per_m"], 3e9);
  EXPECT_EQ(json["visible_up_to"].size(), 2U);
  EXPECT_EQ(json["convergence"]["status"], "converged");
  EXPECT_EQ(json["convergence"]["iterations"], 2);
  EXPECT_EQ(json["convergence"]["start"], 0.6);
  EXPECT_EQ(json["convergence"]["best"][1], 0.01);
  EXPECT_EQ(json["suspect_hz"][0], 120.0);
  EXPECT_EQ(json["notes"][0], "rotational damping: not identifiable from this FRF");
  EXPECT_EQ(json["notes"][1], "a note");
}

TEST(JointCsv, HasARowAParameter) {
  EXPECT_EQ(joint_csv(found()),
            "parameter,value,std,identifiable\ntranslational_stiffness_n_per_m,20000000,10000,true\n"
            "translational_damping_n_s_per_m,40,0,false\nrotational_stiffness_n_m_per_rad,50000,0,false\n"
            "rotational_damping_n_m_s_per_rad,0.5,,false\n");
}

// The keys are those of assembly.toml: what was found can be pasted there.
TEST(JointJson, ItsKeysAreThoseOfTheAssembly) {
  const test::Folder folder;
  std::string text =
      "[frequency]\nrange_hz = [1, 2]\nstep_hz = 1\n[[tool]]\nlength_mm = 100\ndiameter_mm = 12\n"
      "youngs_modulus_gpa = 200\ndensity_kg_per_m3 = 7800\n[joint]\n";
  const auto json = nlohmann::json::parse(joint_json(found()));
  for (const auto& [key, value] : json["joint"].items()) text += key + " = " + value.dump() + "\n";
  const AssemblyFile file = read_assembly(folder.file("assembly.toml", text));
  ASSERT_TRUE(file.assembly.joint);
  EXPECT_EQ(file.assembly.joint->translational_stiffness_n_per_m, 2e7);
  EXPECT_EQ(file.assembly.joint->translational_damping_n_s_per_m, 40.0);
  EXPECT_EQ(file.assembly.joint->rotational_stiffness_n_m_per_rad, 5e4);
  EXPECT_EQ(file.assembly.joint->rotational_damping_n_m_s_per_rad, 0.5);
}

const std::string rigid_assembly =
    "[frequency]\nrange_hz = [1, 2]\nstep_hz = 1\n[[tool]]\nlength_mm = 100\ndiameter_mm = 12\n"
    "youngs_modulus_gpa = 200\ndensity_kg_per_m3 = 7800\n";

/// Some joint, of any size that a search may find.
Joint random_joint(Random& random) {
  const auto size = [&](double low, double high) { return std::pow(10.0, random.uniform(low, high)); };
  return {.translational_stiffness_n_per_m = size(3.0, 12.0),
          .translational_damping_n_s_per_m = size(-6.0, 6.0),
          .rotational_stiffness_n_m_per_rad = size(3.0, 12.0),
          .rotational_damping_n_m_s_per_rad = size(-6.0, 6.0)};
}

// All that is written comes back, to the 15 digits of the file, alone and as an assembly's joint.
TEST(JointJson, ReadsWhatItWrites) {
  const test::Folder folder;
  for (int k = 0; k < 50; ++k) {
    Random random(7, static_cast<std::uint64_t>(k));
    JointFitResult result = found();
    result.joint = random_joint(random);
    const std::filesystem::path path = folder.file("joint.json", joint_json(result));
    const Joint read = read_joint_json(path).joint;
    const AssemblyFile file = read_assembly(folder.file("assembly.toml", rigid_assembly), {.joint = path});
    ASSERT_TRUE(file.assembly.joint);
    for (const io::Field<Joint>& field : joint_fields) {
      const double written = result.joint.*field.value;
      EXPECT_NEAR(read.*field.value, written, 1e-14 * written);
      EXPECT_EQ(file.assembly.joint.value().*field.value, read.*field.value);
    }
    EXPECT_EQ(read.points, 1);
    EXPECT_EQ(read.cross_stiffness_n_per_rad, 0.0);
  }
}

TEST(JointJson, WarnsOfWhatTheFrfDidNotShow) {
  const test::Folder folder;
  const auto warnings = [&](const JointFitResult& result) {
    return read_joint_json(folder.file("joint.json", joint_json(result))).warnings;
  };
  JointFitResult result = found();
  ASSERT_EQ(warnings(result).size(), 1U);
  EXPECT_NE(warnings(result)[0].find("joint.json: translational damping, rotational stiffness and rotational damping "
                                     "are not identifiable"),
            std::string::npos)
      << warnings(result)[0];
  for (JointKnowledge& knowledge : result.knowledge) knowledge.identifiable = true;
  EXPECT_TRUE(warnings(result).empty());
  result.knowledge[3].identifiable = false;
  EXPECT_NE(warnings(result)[0].find("joint.json: rotational damping is not"), std::string::npos);
  result.status = JointFitResult::Status::not_converged;
  EXPECT_EQ(warnings(result).size(), 2U);
  result.status = JointFitResult::Status::stalled;
  ASSERT_EQ(warnings(result).size(), 2U);
  EXPECT_EQ(warnings(result)[1], "joint.json: the search for the joint stalled at its random start.");
  // Written by hand: the four alone.
  const std::string values = R"({"joint": {"translational_stiffness_n_per_m": 1e7, "translational_damping_n_s_per_m": 0,
                 "rotational_stiffness_n_m_per_rad": 2e4, "rotational_damping_n_m_s_per_rad": 0}})";
  const JointFile by_hand = read_joint_json(folder.file("joint.json", values));
  EXPECT_TRUE(by_hand.warnings.empty());
  ASSERT_EQ(by_hand.notes.size(), 1U);
  EXPECT_NE(by_hand.notes[0].find("joint.json, in place of the assembly's: 1e+07 N/m with 0 N"), std::string::npos);
}

// The table may hold what the search does not find, and lack what it does.
TEST(JointJson, StandsInPlaceOfTheAssemblysJoint) {
  const test::Folder folder;
  const std::filesystem::path path = folder.file("joint.json", joint_json(found()));
  const auto read = [&](const std::string& table) {
    return read_assembly(folder.file("assembly.toml", rigid_assembly + table), {.joint = path});
  };
  const AssemblyFile file = read(
      "[joint]\ntranslational_stiffness_n_per_m = 1e5\nrotational_stiffness_n_m_per_rad = 1e3\n"
      "cross_stiffness_n_per_rad = 100\n");
  EXPECT_EQ(file.assembly.joint->translational_stiffness_n_per_m, 2e7);
  EXPECT_EQ(file.assembly.joint->rotational_damping_n_m_s_per_rad, 0.5);
  EXPECT_EQ(file.assembly.joint->cross_stiffness_n_per_rad, 100.0);
  EXPECT_EQ(file.joint_notes.size(), 1U);
  EXPECT_EQ(file.joint_warnings.size(), 1U);
  EXPECT_EQ(read("[joint]\n").assembly.joint->translational_stiffness_n_per_m, 2e7);
  const auto said = [&](const std::string& table) { return test::rejection([&] { static_cast<void>(read(table)); }); };
  EXPECT_NE(said("[joint]\npoints = 3\n").find("assembly.toml:10: joint.points = 3; must be 1 where the joint is that"),
            std::string::npos)
      << said("[joint]\npoints = 3\n");
  EXPECT_NE(
      said("[joint]\ncross_stiffness_n_per_rad = 1e9\n").find("assembly.toml:10: joint.cross_stiffness_n_per_rad"),
      std::string::npos);
}

// A joint that is spread over the shank stands in place of another that is spread so, and of no other.
TEST(JointJson, OfSeveralPointsStandsWhereSoManyAre) {
  const test::Folder folder;
  JointFitResult result = found();
  result.joint.points = 3;
  const std::filesystem::path path = folder.file("joint.json", joint_json(result));
  EXPECT_EQ(read_joint_json(path).joint.points, 3);
  const auto read = [&](const std::string& table) {
    return read_assembly(folder.file("assembly.toml", rigid_assembly + table), {.joint = path});
  };
  const std::string shank =
      "insertion_length_mm = 30\n[[joint.shank]]\nlength_mm = 30\ndiameter_mm = 12\nyoungs_modulus_gpa = 200\n"
      "density_kg_per_m3 = 7800\n";
  const Joint joint = read("[joint]\npoints = 3\n" + shank).assembly.joint.value();
  EXPECT_EQ(joint.points, 3);
  EXPECT_EQ(joint.translational_stiffness_n_per_m, 2e7);
  EXPECT_EQ(joint.shank.size(), 1U);
  const auto said = [&](const std::string& table) { return test::rejection([&] { static_cast<void>(read(table)); }); };
  EXPECT_NE(said("[joint]\npoints = 4\n" + shank).find("joint.points = 4; must be 3 where the joint is that"),
            std::string::npos);
  EXPECT_NE(said("[joint]\n").find("must be of 3 points where the joint is that"), std::string::npos)
      << said("[joint]\n");
  EXPECT_NE(said("").find("must say where the 3 points of joint.json stand"), std::string::npos) << said("");
}

TEST(JointJson, SaysWhatIsWrongWithAFile) {
  const test::Folder folder;
  const std::string good = joint_json(found());
  const auto said = [&](const std::string& text) {
    const std::filesystem::path path = folder.file("joint.json", text);
    return test::rejection([&] { static_cast<void>(read_joint_json(path)); }).substr(path.string().size());
  };
  const auto with = [&](const std::string& old_text, const std::string& new_text) {
    std::string text = good;
    const std::size_t at = text.find(old_text);
    EXPECT_NE(at, std::string::npos) << old_text;
    return text.replace(at, old_text.size(), new_text);
  };
  EXPECT_EQ(said("{}"), ": joint: is missing");
  EXPECT_EQ(said("[]").substr(0, 19), ": must be an object");
  EXPECT_EQ(said("{\"joint\": {}}"), ": joint.translational_stiffness_n_per_m: is missing");
  EXPECT_EQ(said("{\"joint\": 3}").substr(0, 30), ": joint = 3; must be an object");
  EXPECT_EQ(said(with("\"rotational_damping_n_m_s_per_rad\": 0.5", "\"rotational_damping_n_m_s_per_rad\": null")),
            ": joint.rotational_damping_n_m_s_per_rad = null; must be a finite number");
  EXPECT_EQ(said(with("50000", "0")), ": joint.rotational_stiffness_n_m_per_rad = 0 N m/rad; must be > 0");
  EXPECT_EQ(said(with("\"rotational_damping_n_m_s_per_rad\": 0.5", "\"rotational_damping_n_m_s_per_rad\": -1")),
            ": joint.rotational_damping_n_m_s_per_rad = -1 N m s/rad; must be >= 0");
  EXPECT_EQ(said(with("\"translational_stiffness_n_per_m\": true", "\"translational_stiffness_n_per_m\": 1")),
            ": identifiable.translational_stiffness_n_per_m = 1; must be true or false");
  for (const char* points : {"0", "2.5", "101", "-1"}) {
    EXPECT_EQ(said(with("\"points\": 1", std::string("\"points\": ") + points)),
              std::string(": points = ") + points + "; must be a whole number in 1 ... 100");
  }
  EXPECT_EQ(said(with("\"converged\"", "7")), ": convergence.status = 7; must be text");
  EXPECT_NE(test::rejection([&] { static_cast<void>(read_joint_json(folder.at("none.json"))); }).find("none.json"),
            std::string::npos);
  // Cut off anywhere it is read or rejected.
  for (std::size_t end = 0; end + 1 < good.size(); end += 7) {
    folder.file("joint.json", good.substr(0, end));
    EXPECT_THROW(static_cast<void>(read_joint_json(folder.at("joint.json"))), InvalidInput) << end;
  }
}

}  // namespace joint_json_test
}  // namespace robomill::coupling
