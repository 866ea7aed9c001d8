#include "robomill/jobs/init.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/cell/files/known_arms.hpp"
#include "robomill/cutting/files/materials_toml.hpp"
#include "robomill/io/toml/edit.hpp"
#include "robomill/io/toml/samples.hpp"
#include "robomill/jobs/files/job_toml.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"
#include "robomill/jobs/init/questions.hpp"
#include "robomill/modal/files/hits_toml.hpp"
#include "testing/samples.hpp"
#include "testing/support.hpp"

namespace robomill::jobs {
namespace interview_test {

class Asked : public ::testing::Test {
 protected:
  /// Files of a kind that no folder has.
  InitFiles begun(Template kind, bool example = true) {
    return init_files(
        {.kind = kind, .file = folder_.at(std::string(name_in(template_names, kind)) + ".toml"), .example = example});
  }
  /// Gives the answers; those that are missing are the defaults.
  void tell(Template kind, InitFiles& files, const std::vector<std::string>& answers) {
    Interview interview(kind, files);
    std::size_t next = 0;
    while (interview.question()) {
      const std::string answer = next < answers.size() ? answers[next] : "";
      ++next;
      interview.answer(answer);
    }
    EXPECT_LE(answers.size(), next);
  }
  static std::string value(InitFiles& files, Template kind, const std::string& key) {
    return io::setting_of(files.document(kind)->text, key).value_or("none");
  }

  test::Folder folder_;
};

/// A record of one hit beside its response, with the names of its two columns.
std::string tap(const std::string& force, const std::string& response) {
  std::string text = "time_s," + force + "," + response + "\n";
  for (int i = 0; i < 200; ++i) {
    text += std::to_string(1e-3 * i) + (i == 50 ? ",10," : ",0,") + (i > 50 ? "1" : "0") + "\n";
  }
  return text;
}

TEST(ShopUnits, AreUnderstoodAndConverted) {
  const auto mm = [](const char* text, const char* plain = "") {
    return io::parse_quantity(text, Quantity::length, plain);
  };
  EXPECT_DOUBLE_EQ(mm("12"), 12.0);
  EXPECT_DOUBLE_EQ(mm(" 0,5 mm"), 0.5);
  EXPECT_DOUBLE_EQ(mm("0.25 in"), 6.35);
  EXPECT_DOUBLE_EQ(mm("1/4\""), 6.35);
  EXPECT_DOUBLE_EQ(mm("1 1/4 inch"), 31.75);
  EXPECT_DOUBLE_EQ(mm("3/8", "in"), 9.525);
  EXPECT_DOUBLE_EQ(mm("10 mm", "in"), 10.0);
  EXPECT_DOUBLE_EQ(mm("50 µm"), 0.05);
  EXPECT_DOUBLE_EQ(io::parse_quantity("10 mV/g", Quantity::acceleration_sensitivity), 10.0);
  EXPECT_DOUBLE_EQ(io::parse_quantity("10 mV/(m/s²)", Quantity::acceleration_sensitivity), 98.0665);
  EXPECT_NEAR(io::parse_quantity("10 mV/lbf", Quantity::force_sensitivity), 2.248, 1e-3);
  EXPECT_DOUBLE_EQ(io::parse_quantity("12 Nm", Quantity::torque), 12.0);
  EXPECT_DOUBLE_EQ(io::parse_quantity("12 N·m", Quantity::torque), 12.0);
  EXPECT_NEAR(io::parse_quantity("10 ft lbf", Quantity::torque), 13.558, 1e-3);
  EXPECT_DOUBLE_EQ(io::parse_quantity("7.5 kW", Quantity::power), 7.5);
  EXPECT_NEAR(io::parse_quantity("10 hp", Quantity::power), 7.457, 1e-3);
  EXPECT_DOUBLE_EQ(io::parse_quantity("12000 1/min", Quantity::spindle_speed), 12000.0);
  EXPECT_DOUBLE_EQ(io::parse_quantity("200 Hz", Quantity::spindle_speed), 12000.0);
  EXPECT_DOUBLE_EQ(io::parse_quantity("4 g", Quantity::mass), 0.004);
}

TEST(ShopUnits, RejectWhatIsNoneOfTheQuantity) {
  const auto say = [](const char* text, Quantity quantity) {
    return test::rejection([&] { static_cast<void>(io::parse_quantity(text, quantity)); });
  };
  EXPECT_EQ(say("12 kg", Quantity::length),
            "\"12 kg\": is not a length. A number with one of mm, in, thou, um, cm, m, or alone");
  EXPECT_EQ(say("twelve", Quantity::number), "\"twelve\": is not a number");
  for (const char* text : {"inf mm", "nan", "1/0 in", "mm", "--3 mm", "3 mm mm"}) {
    EXPECT_NE(say(text, Quantity::length).find("is not a length"), std::string::npos) << text;
  }
  EXPECT_EQ(io::parse_quantity("12", Quantity::number), 12.0);
}

// Thousands to some, a decimal to others: neither is guessed.
TEST(ShopUnits, RejectACommaThatMayPartThousands) {
  const auto say = [](const char* text, Quantity quantity) {
    return test::rejection([&] { static_cast<void>(io::parse_quantity(text, quantity)); });
  };
  EXPECT_EQ(say("16,000 rpm", Quantity::spindle_speed),
            "\"16,000 rpm\": may have a comma for thousands or one for decimals. Write 16000 or 16.0");
  EXPECT_NE(say("7,500 W", Quantity::power).find("Write 7500 or 7.5"), std::string::npos);
  EXPECT_NE(say("-1,250", Quantity::length).find("Write -1250 or -1.25"), std::string::npos);
  EXPECT_NE(say("1,000/4 in", Quantity::length).find("Write 1000 or 1.0"), std::string::npos);
  EXPECT_NE(say("1,234,567 rpm", Quantity::spindle_speed), "");
  EXPECT_DOUBLE_EQ(io::parse_quantity("0,125 mm", Quantity::length), 0.125);
  EXPECT_DOUBLE_EQ(io::parse_quantity("0,05", Quantity::length), 0.05);
  EXPECT_DOUBLE_EQ(io::parse_quantity("7,5 kW", Quantity::power), 7.5);
  EXPECT_DOUBLE_EQ(io::parse_quantity("1234,567 mm", Quantity::length), 1234.567);
  EXPECT_DOUBLE_EQ(io::parse_quantity("16000 rpm", Quantity::spindle_speed), 16000.0);
}

TEST_F(Asked, DefaultsLeaveTheTemplateAsItIs) {
  for (const Template kind : {Template::lobes, Template::forces, Template::assembly, Template::cell, Template::monitor,
                              Template::hits, Template::job}) {
    for (const bool example : {true, false}) {
      InitFiles files = begun(kind, example);
      const std::string before = files.files.front().text;
      tell(kind, files, {});
      EXPECT_EQ(files.files.front().text, before);
    }
  }
}

// What is not answered stays behind its #, and nothing is offered for it.
TEST_F(Asked, WithoutAnExampleNothingIsMadeUp) {
  InitFiles files = begun(Template::lobes, false);
  {
    Interview interview(Template::lobes, files);
    while (interview.question()) {
      const std::string question = *interview.question();
      const bool choice = question.starts_with("Lengths") || question.starts_with("Deepest");
      EXPECT_EQ(question.find("[not known]") == std::string::npos, choice) << question;
      interview.answer("");
    }
  }
  tell(Template::lobes, files, {"", "6000", "", "12", "4"});
  EXPECT_EQ(value(files, Template::lobes, "tool.teeth"), "4");
  EXPECT_EQ(value(files, Template::lobes, "lobes.spindle_speed_rpm"), "none") << "half of a range is none";
  tell(Template::lobes, files, {"", "6000", "18000", "", "", "7075", "up", "2", "", "0.1"});
  EXPECT_EQ(value(files, Template::lobes, "lobes.spindle_speed_rpm"), "[6000, 18000]");
  EXPECT_NO_THROW(static_cast<void>(read_lobes(io::TomlSource("lobes.toml", files.document(Template::lobes)->text))));
}

// An answer is a fact, though it be the example's.
TEST_F(Asked, AnAnswerIsNoSample) {
  InitFiles files = begun(Template::lobes);
  const auto samples = [&] {
    return test_support::all_samples(io::TomlSource("lobes.toml", files.document(Template::lobes)->text)).size();
  };
  const std::size_t before = samples();
  tell(Template::lobes, files, {"", "", "", "12", "3"});
  EXPECT_EQ(samples(), before - 2);
}

TEST_F(Asked, AJobAsksWhatADirectionIsLikeThatWasNotHit) {
  static_cast<void>(folder_.file("tap_x.csv", tap("hammer (N)", "acc (m/s2)")));
  for (const auto& [answer, key, told] : {std::tuple{"like", "job.equal_directions", "true"},
                                          {"rigid", "job.rigid_directions", "[\"y\"]"},
                                          {"", "job.equal_directions", "none"}}) {
    InitFiles files = begun(Template::job, false);
    Interview interview(Template::job, files);
    while (interview.question()) {
      interview.answer(interview.question()->starts_with("The direction that was not hit") ? answer : "");
    }
    EXPECT_EQ(value(files, Template::job, key), told);
  }
}

TEST_F(Asked, AnswersStandInTheirPlaces) {
  InitFiles files = begun(Template::lobes);
  tell(Template::lobes, files, {"inch", "3000 rpm", "200 Hz", "1/2", "4", "7075", "climb", "1 mm", "0.2", "0.003"});
  EXPECT_EQ(value(files, Template::lobes, "lobes.spindle_speed_rpm"), "[3000, 12000]");
  EXPECT_EQ(value(files, Template::lobes, "tool.diameter_mm"), "12.7");
  EXPECT_EQ(value(files, Template::lobes, "tool.teeth"), "4");
  EXPECT_EQ(value(files, Template::lobes, "coefficients.material"), "\"7075-t6\"");
  EXPECT_EQ(value(files, Template::lobes, "cut.direction"), "\"down\"");
  EXPECT_EQ(value(files, Template::lobes, "cut.radial_depth_mm"), "1");
  EXPECT_EQ(value(files, Template::lobes, "lobes.axial_depth_mm[1]"), "5.08");
  EXPECT_EQ(value(files, Template::lobes, "cut.feed_per_tooth_mm"), "0.0762");
  const std::string& text = files.document(Template::lobes)->text;
  EXPECT_NE(text.find("diameter_mm = 12.7                    # mm, of the cutting edges\n"), std::string::npos) << text;
  EXPECT_NO_THROW(static_cast<void>(read_lobes(io::TomlSource("lobes.toml", text))));
}

TEST_F(Asked, ABadAnswerKeepsTheQuestion) {
  InitFiles files = begun(Template::lobes);
  Interview interview(Template::lobes, files);
  const auto expect = [&](const char* question, const char* answer, const char* reason) {
    ASSERT_NE(interview.question()->find(question), std::string::npos) << *interview.question();
    const std::string said = test::rejection([&] { interview.answer(answer); });
    EXPECT_NE(said.find(reason), std::string::npos) << said;
    EXPECT_NE(interview.question()->find(question), std::string::npos);
  };
  expect("mm or inch [mm]", "furlong", "must be one of mm, inch");
  interview.answer("");
  expect("Lowest spindle speed [4000 rpm]", "-5", "must lie between 1 and 200000 rpm");
  expect("Lowest spindle speed", "fast", "is not a spindle speed");
  interview.answer("9000");
  expect("Highest spindle speed [16000 rpm]", "8000", "must be above the lowest speed, 9000 rpm");
  interview.answer("");
  expect("Diameter of the cutter [12 mm]", "0.5 kg", "is not a length");
  interview.answer("2");
  expect("Teeth of the cutter [3]", "2.5", "must be a whole number");
  interview.answer("2");
  expect("Material of the part", "unobtainium", "6061-t6");
  interview.answer("6061");
  expect("Climb (down)", "c", "must be one of climb");
  interview.answer("conv");
  // The default does not go with the diameter.
  expect("Radial depth (ae) [3 mm]", "", "must be at most the cutter's diameter, 2 mm");
  interview.answer("2 mm");
  interview.answer("");
  interview.answer("");
  EXPECT_FALSE(interview.question());
  EXPECT_EQ(value(files, Template::lobes, "cut.direction"), "\"up\"");
}

TEST_F(Asked, ASlotIsAsWideAsItsCutter) {
  InitFiles files = begun(Template::forces);
  tell(Template::forces, files, {"", "", "20", "", "", "", "slot"});
  EXPECT_EQ(value(files, Template::forces, "cut.radial_depth_mm"), "20");
  EXPECT_EQ(value(files, Template::forces, "cut.direction"), "\"slot\"");
}

TEST_F(Asked, AMaterialWithoutARadialCoefficientGetsARatio) {
  InitFiles files = begun(Template::lobes);
  tell(Template::lobes, files, {"", "", "", "", "", "oak"});
  const std::string& text = files.document(Template::lobes)->text;
  EXPECT_NE(text.find("\nradial_ratio = 0.3 "), std::string::npos) << text;
  EXPECT_NO_THROW(static_cast<void>(read_lobes(io::TomlSource("lobes.toml", text))));
}

// [Fullerton] and [Niagara2016] of 7075-T6 at 12.7 mm.
TEST_F(Asked, ShowsTheFeedsThatAreRecommended) {
  InitFiles files = begun(Template::lobes);
  Interview interview(Template::lobes, files);
  for (const char* answer : {"", "", "", "12.7", "", "7075", "", "", ""}) interview.answer(answer);
  ASSERT_TRUE(interview.question());
  EXPECT_NE(interview.question()->find("(fz); recommended: 0.102 mm [Fullerton], 0.102 mm [Niagara2016] ["),
            std::string::npos)
      << *interview.question();
}

TEST_F(Asked, AJobAsksForItsHitsAndItsCutToo) {
  InitFiles files = begun(Template::job);
  tell(
      Template::job, files,
      {"", "V", "2.3 mV/N", "10 mV/g", "4 g", "6000", "18000", "12 Nm", "7.5 kW", "10", "30", "2", "", "up", "1", "3"});
  EXPECT_EQ(value(files, Template::hits, "acquisition.voltage_unit"), "\"V\"");
  EXPECT_EQ(value(files, Template::hits, "acquisition.force_mv_per_n"), "2.3");
  EXPECT_EQ(value(files, Template::hits, "acquisition.response_mv_per_g"), "10");
  EXPECT_EQ(value(files, Template::hits, "acquisition.accelerometer_mass_kg"), "0.004");
  EXPECT_EQ(value(files, Template::lobes, "lobes.spindle_speed_rpm"), "[6000, 18000]");
  EXPECT_EQ(value(files, Template::lobes, "tool.diameter_mm"), "10");
  EXPECT_EQ(value(files, Template::lobes, "tool.teeth"), "2");
  const Job job = read_job(io::TomlSource("job.toml", files.document(Template::job)->text));
  ASSERT_EQ(job.recommend.spindle.size(), 2U);
  EXPECT_DOUBLE_EQ(job.recommend.spindle[0].torque_n_m, 12.0);
  EXPECT_NEAR(job.recommend.spindle[1].spindle_speed_rad_per_s, 18000.0 * units::rpm, 1e-6);
  EXPECT_DOUBLE_EQ(job.recommend.spindle[1].power_w, 7500.0);
  EXPECT_DOUBLE_EQ(job.recommend.max_axial_depth_m, 0.03);
}

// "V" in the names of columns is a guess, which the answer SI takes back.
TEST_F(Asked, RecordsInSiHaveNoSensitivities) {
  static_cast<void>(folder_.file("tap.csv", tap("hammer (V)", "acc (V)")));
  InitFiles files = begun(Template::hits, false);
  EXPECT_EQ(value(files, Template::hits, "acquisition.voltage_unit"), "\"V\"");
  tell(Template::hits, files, {"SI"});
  for (const char* key : {"voltage_unit", "force_mv_per_n", "response_mv_per_g"}) {
    EXPECT_EQ(value(files, Template::hits, std::string("acquisition.") + key), "none") << key;
  }
  const auto read = [&] {
    return modal::read_hits(io::TomlSource(folder_.at("hits.toml"), files.document(Template::hits)->text));
  };
  // The columns still say otherwise.
  const std::string said = test::rejection([&] { static_cast<void>(read()); });
  EXPECT_NE(said.find("is a voltage by its name"), std::string::npos) << said;
  EXPECT_NE(said.find("rename the column if it holds N"), std::string::npos) << said;
}

// What a 1 of a column in g is, no sensor's.
TEST_F(Asked, RecordsInGKeepTheirSize) {
  static_cast<void>(folder_.file("tap.csv", tap("hammer (kN)", "acc (g)")));
  InitFiles files = begun(Template::hits, false);
  tell(Template::hits, files, {"SI"});
  const modal::HitsFile hits =
      modal::read_hits(io::TomlSource(folder_.at("hits.toml"), files.document(Template::hits)->text));
  EXPECT_DOUBLE_EQ(hits.hits.at(0).force_n(50), 10e3);
  EXPECT_NEAR(hits.hits.at(0).responses.at(0).samples(60), 9.80665, 1e-5);
}

// Of which one is not known, it does not limit: 5 kW at 3000 rpm are 15.9 N m.
TEST_F(Asked, PowerAloneMakesACurveToo) {
  InitFiles files = begun(Template::job);
  tell(Template::job, files, {"", "", "", "3000", "", "", "5 kW"});
  const Job job = read_job(io::TomlSource("job.toml", files.document(Template::job)->text));
  ASSERT_EQ(job.recommend.spindle.size(), 2U);
  EXPECT_NEAR(job.recommend.spindle[0].torque_n_m, 15.9155, 1e-3);
}

// What can be answered stands in the question, in lines that a terminal holds.
TEST_F(Asked, NamesRobotsAndMaterials) {
  const auto question = [&](Template kind, const char* about) {
    InitFiles files = begun(kind);
    Interview interview(kind, files);
    while (interview.question() && !interview.question()->starts_with(about)) interview.answer("");
    const std::string text = interview.question().value_or("");
    for (std::istringstream lines(text); !lines.eof();) {
      std::string line;
      std::getline(lines, line);
      EXPECT_LE(line.size(), 100U) << line;
    }
    return text;
  };
  const std::string robot = question(Template::cell, "Robot, one of\n");
  for (const cell::KnownArm& arm : cell::known_arms())
    EXPECT_NE(robot.find(" " + arm.name), std::string::npos) << robot;
  const std::string material = question(Template::lobes, "Material of the part, one of\n");
  for (const cutting::Material& one : cutting::materials()) {
    const bool named = material.find(" " + one.name + ",") != std::string::npos ||
                       material.find(" " + one.name + " [") != std::string::npos;
    EXPECT_EQ(named, !one.coefficients.empty()) << one.name;
  }
}

TEST_F(Asked, ARobotBringsItsPlace) {
  InitFiles files = begun(Template::cell);
  Interview interview(Template::cell, files);
  interview.answer("");
  EXPECT_NE(test::rejection([&] { interview.answer("robbie"); }).find("ur-5e"), std::string::npos);
  interview.answer("ur-5e");
  EXPECT_NE(interview.question()->find("[150 mm]"), std::string::npos) << *interview.question();
  while (interview.question()) interview.answer("");
  EXPECT_EQ(value(files, Template::cell, "robot.model"), "\"ur-5e\"");
  EXPECT_EQ(value(files, Template::cell, "workpiece.origin_mm"), "[-500, -133, 0]");
  EXPECT_NE(files.document(Template::cell)->text.find("\n# joint_max_velocity_deg_per_s = [180, 180, 180,"),
            std::string::npos);
}

}  // namespace interview_test
}  // namespace robomill::jobs
