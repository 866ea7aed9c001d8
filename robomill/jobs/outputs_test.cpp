#include "robomill/jobs/outputs.hpp"

#include <gtest/gtest.h>

#include "robomill/cell/check.hpp"
#include "robomill/jobs/coefficients.hpp"
#include "robomill/jobs/modes.hpp"
#include "robomill/jobs/predict.hpp"
#include "robomill/jobs/stiffness.hpp"
#include "robomill/jobs/tools.hpp"
#include "robomill/process/forces.hpp"
#include "testing/support.hpp"

namespace robomill::jobs {
namespace outputs_test {

using test::rejection;

TEST(Outputs, EveryDocumentNamesItsEndings) {
  struct Case {
    Document document;
    const char *takes, *rejects, *rule;
  };
  for (const Case& one : {Case{Document::frfs, "a.uff", "a.toml", "FRFs are written as .uff"},
                          Case{Document::tools, "a.csv", "a.uff", "a table of tools"},
                          Case{Document::modes, "a.csv", "a.uff", "modes are written"},
                          Case{Document::joint, "a.csv", "a.toml", "joints are written"},
                          Case{Document::lobes, "a.csv", "a.mat", "lobes are written"},
                          Case{Document::explanation, "a.csv", "a.toml", "explanations are written"},
                          Case{Document::simulation, "a.wav", "a.uff", "a simulation is written"},
                          Case{Document::forces, "a.csv", "a.toml", "forces are written"},
                          Case{Document::coefficients, "a.toml", "a.uff", "coefficients are written"},
                          Case{Document::stiffness, "a.toml", "a.uff", "joint stiffness is written"},
                          Case{Document::cell_check, "a.JSON", "a.csv", "a cell's check"}}) {
    EXPECT_NO_THROW(require_output(one.document, one.takes)) << one.takes;
    EXPECT_NO_THROW(require_output(one.document, "x.json")) << one.rule;
    const std::string text = rejection([&] { require_output(one.document, one.rejects); });
    EXPECT_EQ(text.rfind(std::string(one.rejects) + ": " + one.rule, 0), 0U) << text;
  }
}

TEST(Outputs, SayWhyAnAnswerWasNotReached) {
  ModesResult modes;
  modes.fit.status = modal::FitResult::Status::converged;
  modes.fit.relative_error = 0.1;
  EXPECT_EQ(shortfall(modes), "");
  modes.fit.relative_error = 0.5;
  EXPECT_EQ(shortfall(modes), "the modes do not describe the FRFs");
  modes.fit.accepted = true;
  EXPECT_EQ(shortfall(modes), "");

  ToolsResult tools;
  tools.tools.resize(2);
  EXPECT_EQ(shortfall(tools), "");
  tools.tools[1].no_cut = "too deep";
  EXPECT_NE(shortfall(tools), "");

  cell::CellCheck check;
  EXPECT_EQ(shortfall(check), "");
  check.placement.no_way = "between blocks 3 and 4";
  EXPECT_NE(shortfall(check), "");

  process::ForcesResult forces;
  EXPECT_EQ(shortfall(forces), "");
  forces.revolution.emplace();
  forces.revolution->deflected.status = cutting::StaticDeflection::Status::lifts_off;
  EXPECT_NE(shortfall(forces), "");

  CoefficientsResult coefficients;
  EXPECT_NE(shortfall(coefficients).find("forces on the tool"), std::string::npos);
}

TEST(Outputs, StiffnessThatWasNotFoundIsNoLineOfACell) {
  const test::Folder folder;
  StiffnessResult result;
  result.found.status = robot::IdentifiedStiffness::Status::not_converged;
  write_document(folder.at("stiffness.toml"), result);
  EXPECT_FALSE(std::filesystem::exists(folder.at("stiffness.toml")));
  EXPECT_EQ(shortfall(result), "the joint stiffness was not found to convergence");
  result.output = "cell/stiffness.toml";
  EXPECT_EQ(shortfall(result), "the joint stiffness was not found to convergence; cell/stiffness.toml was not written");
  result.output = "stiffness.json";
  EXPECT_EQ(shortfall(result), "the joint stiffness was not found to convergence") << "which says so itself";
}

TEST(Outputs, AHolderIsKeptOnlyWhereOneWasMeasured) {
  TipPrediction prediction;
  EXPECT_NE(
      rejection([&] { require_holder(prediction, "--holder-out"); }).find("--holder-out: needs a measured holder"),
      std::string::npos);
  prediction.holder.frfs.resize(1);
  EXPECT_NO_THROW(require_holder(prediction, "--holder-out"));
}

}  // namespace outputs_test
}  // namespace robomill::jobs
