#include "robomill/coupling/files/joint_json.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "robomill/coupling/files/assembly_toml.hpp"
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
  EXPECT_EQ(json["convergence"]["best"][1], 0.01);
  EXPECT_EQ(json["suspect_hz"][0], 120.0);
  EXPECT_EQ(json["notes"][0], "rotational damping: not identifiable from this FRF");
  EXPECT_EQ(json["notes"][1], "a note");
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

}  // namespace joint_json_test
}  // namespace robomill::coupling
