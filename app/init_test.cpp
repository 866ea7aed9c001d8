// robomill init as a user runs it: files to begin with, and the verbs that take them.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "test_program.hpp"

namespace robomill::app {
namespace init_test {

class InitVerb : public ProgramTest {
 protected:
  [[nodiscard]] bool there(const std::string& name) const { return std::filesystem::exists(folder_.at(name)); }
  Ended told(const std::string& arguments, const std::string& answers) {
    write("answers.txt", answers);
    return robomill("init " + arguments + " --interactive <answers.txt");
  }
};

TEST_F(InitVerb, WritesExamplesThatRun) {
  const Ended job = robomill("init job --example");
  ASSERT_EQ(job.exit, 0) << job.err;
  for (const char* name : {"job.toml", "hits.toml", "example_hit_x.csv"}) {
    EXPECT_NE(job.out.find(std::string("wrote ") + name + "\n"), std::string::npos) << job.out;
  }
  EXPECT_NE(job.out.find("is made up, so that the file runs"), std::string::npos) << job.out;
  EXPECT_NE(job.out.find("Run: robomill plan job.toml -o out/\n"), std::string::npos) << job.out;
  const Ended plan = robomill("plan job.toml -o out");
  EXPECT_EQ(plan.exit, 0) << plan.err << plan.out;
  for (const char* sample : {"Sample value left as it was: 3 (tool.teeth of job.toml)",
                             "Sample value left as it was: \"example_hit_x.csv\" (hits[1].file of hits.toml)"}) {
    EXPECT_NE(plan.out.find(sample), std::string::npos) << plan.out;
  }
  EXPECT_TRUE(there("out/report.html"));
  EXPECT_EQ(robomill("frf hits.toml -o tip.uff").exit, 0);
  EXPECT_EQ(robomill("lobes job.toml --at 9000,1 -o lobes.json").exit, 0);
  EXPECT_EQ(robomill("init forces --example").exit, 0);
  EXPECT_EQ(robomill("forces forces.toml -o forces.csv").exit, 0);
  EXPECT_EQ(robomill("init assembly --example").exit, 0);
  EXPECT_EQ(robomill("couple assembly.toml -o predicted.uff").exit, 0);
  EXPECT_EQ(robomill("init cell --robot ur-10e --example").exit, 0);
  write("part.ngc", "G21 G90 G94\nG0 X0 Y0 Z20\nG1 Z0 F600\nG1 X30 F1200\nG1 Y20\nG0 Z20\n");
  const Ended smooth = robomill("smooth part.ngc --cell cell.toml -o trajectory.csv");
  EXPECT_EQ(smooth.exit, 0) << smooth.err;
  EXPECT_EQ(robomill("init monitor --example").exit, 0);
  EXPECT_EQ(robomill("simulate job.toml --at 9000,0.2 --seconds 1 -o cut.csv").exit, 0);
  const Ended monitor = robomill("monitor monitor.toml --input cut.csv -o events.jsonl");
  EXPECT_EQ(monitor.exit, 0) << monitor.err;
}

// Without an example each verb ends with exit 1 and names what it lacks.
TEST_F(InitVerb, AsksForWhatNobodySaid) {
  ASSERT_EQ(robomill("init job").exit, 0);
  for (const char* name : {"job.toml", "hits.toml"}) EXPECT_TRUE(there(name)) << name;
  EXPECT_FALSE(there("example_hit_x.csv"));
  for (const char* kind : {"lobes", "forces", "assembly", "cell", "monitor"}) {
    ASSERT_EQ(robomill(std::string("init ") + kind).exit, 0) << kind;
  }
  const std::pair<const char*, const char*> runs[] = {{"lobes lobes.toml", "lobes.toml:9: tool.teeth: is missing"},
                                                      {"plan job.toml -o out", "tool.teeth: is missing"},
                                                      {"lobes job.toml", "tool.teeth: is missing"},
                                                      {"frf hits.toml -o tip.uff", "hits[1].file: is missing"},
                                                      {"forces forces.toml", "tool.kind: is missing"},
                                                      {"couple assembly.toml", "tool[1].length_mm: is missing"},
                                                      {"cell check cell.toml", "robot.model: is missing"}};
  for (const auto& [run, lacks] : runs) {
    const Ended ended = robomill(run);
    EXPECT_EQ(ended.exit, 1) << run;
    EXPECT_NE(ended.err.find(lacks), std::string::npos) << run << ": " << ended.err;
  }
  EXPECT_FALSE(there("out/plan.json"));
}

TEST_F(InitVerb, OverwritesNothing) {
  write("lobes.toml", "mine\n");
  const Ended run = robomill("init lobes");
  EXPECT_EQ(run.exit, 1);
  EXPECT_NE(run.err.find("lobes.toml: exists, and is not overwritten"), std::string::npos) << run.err;
  EXPECT_EQ(slurp(folder_.at("lobes.toml")), "mine\n");
  EXPECT_EQ(robomill("init lobes -o other.toml").exit, 0);
  EXPECT_TRUE(there("other.toml"));
  EXPECT_EQ(robomill("init lobes -o lobes.txt").exit, 1);
  EXPECT_EQ(robomill("init").exit, 2);
  EXPECT_EQ(robomill("init poem").exit, 2);
}

TEST_F(InitVerb, SchemasArePrintedByTheirDocument) {
  EXPECT_NE(robomill("schema").out.find("lobes.json\n"), std::string::npos);
  EXPECT_NE(robomill("schema lobes.toml").out.find("\"spindle_speed_rpm\""), std::string::npos);
  EXPECT_NE(robomill("schema lobes.json").out.find("\"const\": \"lobes/1\""), std::string::npos);
  const Ended unknown = robomill("schema poem.json");
  EXPECT_EQ(unknown.exit, 2);
  EXPECT_NE(unknown.err.find("lobes.json"), std::string::npos) << unknown.err;
}

// As Taplo reads it: the first line, a path as it is.
TEST_F(InitVerb, DocumentsNameTheirSchema) {
  for (const std::string kind : {"job", "lobes", "forces", "assembly", "cell", "monitor", "hits"}) {
    for (const std::string option : {"", " --example"}) {
      const Ended run = robomill("init " + kind + option + " -o -");
      const std::string line = run.out.substr(0, run.out.find('\n')), directive = "#:schema ";
      ASSERT_EQ(line.rfind(directive + "/", 0), 0U) << line;
      const std::filesystem::path schema = line.substr(directive.size());
      EXPECT_EQ(schema.filename(), kind + ".toml.schema.json");
      EXPECT_EQ(slurp(schema), robomill("schema " + kind + ".toml").out);
    }
  }
}

TEST_F(InitVerb, DashWritesTheDocumentAlone) {
  const Ended run = robomill("init job -o -");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_EQ(run.out.find("# The whole job"), run.out.find('\n') + 1) << run.out;
  EXPECT_NE(run.err.find("not written: hits.toml, which it names"), std::string::npos) << run.err;
  EXPECT_FALSE(there("job.toml"));
  EXPECT_FALSE(there("hits.toml"));
  EXPECT_TRUE(robomill("init lobes -o - --quiet").err.empty());
}

TEST_F(InitVerb, AsksInShopTerms) {
  const Ended run =
      told("lobes --example", "inch\n4000\n12000 rpm\nhalf an inch\n0.5\n4\n7075-t6\nclimb\n1/8\n0.2\n0.1 mm\n");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_NE(run.err.find("Diameter of the cutter [12 mm]: "), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("\"half an inch\": is not a length. A number with one of mm, in"), std::string::npos)
      << run.err;
  const std::string text = slurp(folder_.at("lobes.toml"));
  for (const char* line :
       {"\nteeth = 4 ", "\ndiameter_mm = 12.7 ", "\ndirection = \"down\" ", "\nradial_depth_mm = 3.175 ",
        "\nmaterial = \"7075-t6\" ", "\nspindle_speed_rpm = [4000, 12000] "}) {
    EXPECT_NE(text.find(line), std::string::npos) << line << text;
  }
  EXPECT_NE(text.find("# of the cutter: on its drawing or in its catalogue"), std::string::npos);
  EXPECT_EQ(robomill("lobes lobes.toml --at 8000,1").exit, 0);
}

TEST_F(InitVerb, AnEndOfInputWritesNothing) {
  const Ended run = told("job", "mm\nV\n");
  EXPECT_EQ(run.exit, 1);
  EXPECT_NE(run.err.find("robomill: standard input: ended before the last question. Nothing was written"),
            std::string::npos)
      << run.err;
  for (const char* name : {"job.toml", "hits.toml", "lobes.toml", "example_hit_x.csv"})
    EXPECT_FALSE(there(name)) << name;
}

TEST_F(InitVerb, FindsTheHitsOfAFolder) {
  ASSERT_EQ(shell("'" ROBOMILL_SIMULATE_HITS "' records").exit, 0);
  const Ended run = robomill("init hits --data records");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_NE(run.out.find("records of hits were found in records: what is guessed is marked, check it"),
            std::string::npos)
      << run.out;
  const std::string text = slurp(folder_.at("hits.toml"));
  EXPECT_NE(text.find("file = \"records/"), std::string::npos) << text;
  const Ended frf = robomill("frf hits.toml -o tip.uff");
  EXPECT_EQ(frf.exit, 0) << frf.err;
  EXPECT_NE(frf.out.find("xx"), std::string::npos) << frf.out;
  EXPECT_NE(frf.out.find("yy"), std::string::npos) << frf.out;
}

}  // namespace init_test
}  // namespace robomill::app
