#include "robomill/jobs/joint.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "robomill/io/file.hpp"
#include "robomill/jobs/predict.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "testing/support.hpp"

namespace robomill::jobs {
namespace joint_test {

const std::filesystem::path bar = ROBOMILL_SOURCE_DIR "/examples/joint-bar/soft.toml";

// A planted joint, seen through the tip FRFs that it gives.
TEST(RunJoint, FindsTheJointThatGivesTheTip) {
  const test::Folder folder;
  std::string text = io::read_file(bar);
  const std::size_t joint = text.find("[joint]");
  text.replace(joint, text.find("[holder]") - joint,
               "[joint]\ntranslational_stiffness_n_per_m = 2e7\ntranslational_damping_n_s_per_m = 40\n"
               "rotational_stiffness_n_m_per_rad = 5e4\nrotational_damping_n_m_s_per_rad = 0.5\n");
  const TipPrediction planted = predict_tip(folder.file("planted.toml", text));
  modal::write_frfs(folder.at("tip.json"), planted.tip.frfs);
  const JointResult found = run_joint({.assembly = bar, .measured = {folder.at("tip.json")}, .axis = modal::Axis::y});
  EXPECT_EQ(found.fit.status, coupling::JointFitResult::Status::converged);
  EXPECT_LT(found.fit.relative_error, 1e-4);
  EXPECT_NEAR(found.fit.joint.translational_stiffness_n_per_m, 2e7, 2e4);
  EXPECT_NEAR(found.fit.joint.rotational_stiffness_n_m_per_rad, 5e4, 50.0);
}

TEST(RunJoint, NamesTheFileThatIsNotValid) {
  const test::Folder folder;
  const auto say = [&](const JointJob& job) { return test::rejection([&] { static_cast<void>(run_joint(job)); }); };
  JointJob job{.assembly = bar, .measured = {folder.file("lone.txt", "10 1e-6 0\n20 1e-6 0\n")}};
  EXPECT_NE(say(job).find("lone.txt: has 2 lines above 0 Hz"), std::string::npos) << say(job);
  job.axis = modal::Axis::y;
  EXPECT_NE(say(job).find("lone.txt: lacks yy"), std::string::npos) << say(job);
  modal::FrfResult windowed;
  windowed.set = predict_tip(bar).tip.frfs;
  windowed.added_decay_per_s = 2.0;
  modal::write_frfs(folder.at("windowed.json"), windowed);
  job.measured = {folder.at("windowed.json")};
  EXPECT_NE(say(job).find("windowed.json: still holds the damping"), std::string::npos) << say(job);
}

}  // namespace joint_test
}  // namespace robomill::jobs
