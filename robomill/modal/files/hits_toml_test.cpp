#include "robomill/modal/files/hits_toml.hpp"

#include <gtest/gtest.h>
#include <sndfile.h>

#include <Eigen/Core>
#include <complex>
#include <memory>
#include <string>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/io/records/uff.hpp"
#include "testing/support.hpp"

namespace robomill::modal {
namespace hits_toml_test {

const std::string record = "time_s,force_v,ax,ay\n0,0,1,2\n0.001,0.5,3,4\n0.002,0,5,6\n";

TEST(HitsToml, TurnsVoltsIntoUnitsAndNamesDirections) {
  const test::Folder folder;
  static_cast<void>(folder.file("a.csv", record));
  const HitsFile file = read_hits(folder.file("hits.toml", R"([acquisition]
response = "acceleration"
estimator = "Hv"
accelerometer_mass_kg = 0.004
force_mv_per_n = 2.5
response_mv_per_m_per_s2 = 10
[[hits]]
file = "a.csv"
time = "time_s"
force = "force_v"
force_direction = "-x"
responses = { x = "ax", -y = 4 }
)"));
  ASSERT_EQ(file.hits.size(), 1U);
  const Hit& hit = file.hits[0];
  EXPECT_EQ(hit.excitation.axis, Axis::x);
  EXPECT_TRUE(hit.against_axis);
  EXPECT_NEAR(hit.sample_rate_hz, 1000.0, 1e-6);
  EXPECT_DOUBLE_EQ(hit.force_n(1), 0.5 * 1000.0 / 2.5);
  ASSERT_EQ(hit.responses.size(), 2U);
  for (const HitChannel& channel : hit.responses) {
    const bool y = channel.dof.axis == Axis::y;
    EXPECT_EQ(channel.against_axis, y);
    EXPECT_DOUBLE_EQ(channel.samples(1), (y ? 4.0 : 3.0) * 100.0);
  }
  EXPECT_EQ(file.options.estimator, Estimator::hv);
  EXPECT_EQ(file.options.accelerometer_mass_kg, 0.004);
}

// A column of a record may be several of a hit's.
TEST(HitsToml, TakesOneColumnTwice) {
  const test::Folder folder;
  static_cast<void>(folder.file("a.csv", "time_s,force,ax\n0,0,1\n0.001,0.5,3\n0.002,0,5\n"));
  const HitsFile file = read_hits(folder.file("hits.toml", R"([[hits]]
file = "a.csv"
force = "force"
force_direction = "x"
responses = { x = "ax", y = "ax", z = "ax" }
)"));
  ASSERT_EQ(file.hits.size(), 1U);
  const Hit& hit = file.hits[0];
  ASSERT_EQ(hit.responses.size(), 3U);
  EXPECT_EQ(hit.force_n, Eigen::Vector3d(0.0, 0.5, 0.0));
  for (const HitChannel& channel : hit.responses) EXPECT_EQ(channel.samples, Eigen::Vector3d(1.0, 3.0, 5.0));
}

// 100 mV/g are 100 / 9.80665 mV per m/s²: 1 V is 10 g.
TEST(HitsToml, TakesSensitivitiesInGAndRecordsInMillivolts) {
  const test::Folder folder;
  static_cast<void>(folder.file("a.csv", "time_s,force,ax\n0,0,1\n0.001,0.5,3\n0.002,0,5\n"));
  const std::string row =
      "[[hits]]\nfile = \"a.csv\"\nforce = \"force\"\nforce_direction = \"x\"\nresponses = { x = \"ax\" }\n";
  const auto read = [&](const std::string& keys) {
    return read_hits(folder.file("hits.toml", "[acquisition]\n" + keys + row)).hits[0];
  };
  const Hit in_volts = read("force_mv_per_n = 2.5\nresponse_mv_per_g = 100\n");
  EXPECT_NEAR(in_volts.responses[0].samples(1), 3.0 * 10.0 * 9.80665, 1e-10);
  const Hit in_mv = read("voltage_unit = \"mV\"\nforce_mv_per_n = 2.5\nresponse_mv_per_g = 100\n");
  EXPECT_NEAR(in_mv.responses[0].samples(1), 3.0 * 0.01 * 9.80665, 1e-13);
  EXPECT_DOUBLE_EQ(in_mv.force_n(1), 0.5 / 2.5);
  const auto say = [&](const std::string& keys) { return test::rejection([&] { static_cast<void>(read(keys)); }); };
  EXPECT_NE(say("response_mv_per_g = 100\nresponse_mv_per_m_per_s2 = 10\n").find("must not stand beside"),
            std::string::npos);
  EXPECT_NE(say("response_mv_per_g = 0\n").find("hits.toml:2: acquisition.response_mv_per_g = 0"), std::string::npos);
  EXPECT_NE(say("voltage_unit = \"mV\"\n").find("acquisition.force_mv_per_n: is missing"), std::string::npos);
  EXPECT_NE(say("voltage_unit = \"mV\"\nforce_mv_per_n = 2.5\n").find("acquisition.response_mv_per_g: is missing"),
            std::string::npos);
  EXPECT_NE(say("voltage_unit = \"mV\"\nresponse_mv_per_g = 100\n").find("acquisition.force_mv_per_n: is missing"),
            std::string::npos);
  EXPECT_NE(say("voltage_unit = \"kV\"\nforce_mv_per_n = 1\n").find("must be one of \"V\", \"mV\""), std::string::npos);
  EXPECT_NE(say("response = \"velocity\"\nforce_mv_per_n = 1\nresponse_mv_per_g = 100\n")
                .find("response_mv_per_g = 100 mV/g; is of another sensor than acquisition.response_mv_per_m_per_s"),
            std::string::npos);
}

/// What the file says of a record whose columns have these names.
struct NamedColumns {
  std::string time = "time_s", force = "force_n", response = "ax_m_per_s2", acquisition = {};

  HitsFile read() const {
    const test::Folder folder;
    static_cast<void>(folder.file("a.csv", time + "," + force + "," + response + "\n0,0,1\n0.001,0.5,3\n0.002,0,5\n"));
    return read_hits(folder.file("hits.toml", "[acquisition]\n" + acquisition +
                                                  "[[hits]]\nfile = \"a.csv\"\ntime = \"" + time + "\"\nforce = \"" +
                                                  force + "\"\nforce_direction = \"x\"\nresponses = { x = \"" +
                                                  response + "\" }\n"));
  }
  std::string rejection() const {
    return test::rejection([&] { static_cast<void>(read()); });
  }
};

TEST(HitsToml, ConvertsColumnsWhoseNameStatesAnotherUnit) {
  EXPECT_TRUE(NamedColumns{}.read().notes.empty());
  const HitsFile in_g = NamedColumns{.response = "ax_g"}.read();
  EXPECT_NEAR(in_g.hits[0].responses[0].samples(1), 3.0 * 9.80665, 1e-12);
  ASSERT_EQ(in_g.notes.size(), 1U);
  EXPECT_NE(in_g.notes[0].find("ax_g are in g by their name"), std::string::npos);
  EXPECT_DOUBLE_EQ(NamedColumns{.force = "Hammer [kN]"}.read().hits[0].force_n(1), 500.0);
  EXPECT_NEAR(NamedColumns{.time = "time_ms"}.read().hits[0].sample_rate_hz, 1e6, 1e-3);
  const NamedColumns in_um = {.response = "x_um", .acquisition = "response = \"displacement\"\n"};
  EXPECT_DOUBLE_EQ(in_um.read().hits[0].responses[0].samples(1), 3e-6);
}

TEST(HitsToml, RejectsColumnsWhoseNameContradictsTheFile) {
  const auto says = [](const NamedColumns& columns, const std::string& text) {
    const std::string message = columns.rejection();
    EXPECT_NE(message.find(text), std::string::npos) << message;
  };
  says({.acquisition = "response = \"velocity\"\n"}, "is in m/s^2 by its name, and is read in m/s");
  says({.response = "x_mm"}, "is in mm by its name, and is read in m/s²");
  says({.force = "ax_m_per_s2", .response = "force_n"}, "Are the columns of force and response exchanged?");
  says({.force = "force_v"}, "is a voltage by its name, and acquisition.force_mv_per_n is missing");
  says({.response = "ax_mv"}, "is a voltage by its name, and acquisition.response_mv_per_g is missing");
  says({.response = "ax_g", .acquisition = "response_mv_per_g = 100\n"},
       "is in g by its name, where acquisition.response_mv_per_g makes 98.07 m/s² of a 1");
  // 1000 mV/g of a record in V is how a record in g is written.
  NamedColumns in_g{.response = "ax_g", .acquisition = "response_mv_per_g = 1000\n"};
  EXPECT_NEAR(in_g.read().hits[0].responses[0].samples(1), 3.0 * 9.80665, 1e-12);
}

/// hits.toml of a record with a row of units below the names.
struct UnitsRow {
  std::string units = "s,N,m/s^2", names = "Time,Force,Acc", acquisition = {}, rows = "0,0,1\n0.001,5,3\n0.002,0,5\n";

  HitsFile read() const {
    const test::Folder folder;
    static_cast<void>(folder.file("a.csv", names + "\n" + units + "\n" + rows));
    const std::string force = names.substr(names.find(',') + 1);
    return read_hits(folder.file(
        "hits.toml", "[acquisition]\n" + acquisition + "[[hits]]\nfile = \"a.csv\"\nforce = \"" +
                         force.substr(0, force.find(',')) + "\"\nforce_direction = \"x\"\nresponses = { x = \"" +
                         names.substr(names.rfind(',') + 1) + "\" }\n"));
  }
  std::string rejection() const {
    return test::rejection([&] { static_cast<void>(read()); });
  }
};

TEST(HitsToml, ConvertsColumnsWhoseRowOfUnitsSaysSo) {
  EXPECT_TRUE(UnitsRow{}.read().notes.empty());
  for (const char* in_g : {"s,N,g", "(s),(N),(g)", "[s],[N],[g]"}) {
    const HitsFile file = UnitsRow{.units = in_g}.read();
    EXPECT_NEAR(file.hits[0].responses[0].samples(1), 3.0 * 9.80665, 1e-12) << in_g;
    ASSERT_EQ(file.notes.size(), 1U);
    EXPECT_EQ(file.notes[0], "Columns Acc are in g by the row of units: converted with 9.80665 to m/s².");
  }
  EXPECT_DOUBLE_EQ(UnitsRow{.units = "s,kN,g"}.read().hits[0].force_n(1), 5000.0);
  EXPECT_NEAR(UnitsRow{.units = "ms,N,m/s²"}.read().hits[0].sample_rate_hz, 1e6, 1e-3);
  const HitsFile in_volts =
      UnitsRow{.units = "s,V,V", .acquisition = "force_mv_per_n = 1000\nresponse_mv_per_g = 1000\n"}.read();
  EXPECT_NEAR(in_volts.hits[0].responses[0].samples(1), 3.0 * 9.80665, 1e-12);
  // Of the words behind a blank those count that are sure.
  const HitsFile blank = UnitsRow{.units = "s,-,-", .names = "Time,Force kN,Acc g"}.read();
  EXPECT_DOUBLE_EQ(blank.hits[0].force_n(1), 5000.0);
  EXPECT_NEAR(blank.hits[0].responses[0].samples(1), 3.0 * 9.80665, 1e-12);
}

TEST(HitsToml, RejectsARowOfUnitsThatDoesNotFit) {
  const auto says = [](const UnitsRow& row, const std::string& text) {
    EXPECT_NE(row.rejection().find(text), std::string::npos) << row.rejection();
  };
  says({.units = "s,N,µε"}, "is in µε by the row of units, and is read in m/s²");
  says({.units = "s,m/s^2,N"}, "Are the columns of force and response exchanged?");
  says({.units = "s,V,g"}, "is a voltage by the row of units, and acquisition.force_mv_per_n is missing");
  says({.units = "s,N,furlong"}, "a.csv:2: Acc = \"furlong\"; is no unit known here");
  says({.units = "s,N,m/s^2", .names = "Time,Force,ax_g"}, "is in g by its name and in m/s^2 by the row of units");
}

TEST(HitsToml, SaysWhereABracketIsNoUnit) {
  const HitsFile file = NamedColumns{.response = "acc x (front)"}.read();
  ASSERT_EQ(file.notes.size(), 1U);
  EXPECT_EQ(file.notes[0], "Columns acc x (front): \"front\" is no unit known here, and they are read in m/s².");
}

// What somebody typed stands before what a header states, and it is said.
TEST(HitsToml, TakesTheRateThatIsTypedBeforeThatOfAHeader) {
  const test::Folder folder;
  static_cast<void>(folder.file("a.csv", "Sample rate: 25.6 kHz\nforce,ax\n0,1\n0.5,3\n0,5\n"));
  static_cast<void>(folder.file("b.csv", "time_s,force,ax\n0,0,1\n0.001,0.5,3\n0.002,0,5\n"));
  const auto read = [&](const std::string& rate, const char* name = "a.csv") {
    return read_hits(folder.file("hits.toml", "[acquisition]\n" + rate + "[[hits]]\nfile = \"" + name +
                                                  "\"\nforce = \"force\"\nforce_direction = \"x\"\n"
                                                  "responses = { x = \"ax\" }\n"));
  };
  EXPECT_DOUBLE_EQ(read("").hits[0].sample_rate_hz, 25'600.0);
  EXPECT_TRUE(read("sample_rate_hz = 25600\n").notes.empty());
  const HitsFile other = read("sample_rate_hz = 51200\n");
  EXPECT_DOUBLE_EQ(other.hits[0].sample_rate_hz, 51'200.0);
  ASSERT_EQ(other.notes.size(), 1U);
  EXPECT_NE(other.notes[0].find("its header states 25600 Hz, and acquisition.sample_rate_hz = 51200 Hz is taken"),
            std::string::npos)
      << other.notes[0];
  EXPECT_NE(test::rejection([&] {
              static_cast<void>(read("sample_rate_hz = 2000\n", "b.csv"));
            }).find("was sampled at 1000 Hz, not at acquisition.sample_rate_hz = 2000 Hz"),
            std::string::npos)
      << "a column of time is no statement";
}

TEST(HitsToml, ListsWhatItAssumes) {
  const test::Folder folder;
  static_cast<void>(folder.file("a.csv", "time_s,force,ax\n0,0,1\n0.001,0.5,3\n0.002,0,5\n"));
  const auto keys = [&](const std::string& acquisition) {
    std::vector<std::string> out;
    for (const Assumption& one :
         read_hits(folder.file("hits.toml", acquisition + "[[hits]]\nfile = \"a.csv\"\nforce = \"force\"\n"
                                                          "force_direction = \"x\"\nresponses = { x = \"ax\" }\n"))
             .assumed) {
      EXPECT_EQ(one.file, "hits.toml");
      out.push_back(one.key);
    }
    return out;
  };
  EXPECT_EQ(keys(""),
            (std::vector<std::string>{"acquisition.response", "acquisition.force_mv_per_n",
                                      "acquisition.response_mv_per_m_per_s2", "acquisition.accelerometer_mass_kg"}));
  EXPECT_EQ(keys("[acquisition]\nresponse = \"displacement\"\nforce_mv_per_n = 2\n"),
            (std::vector<std::string>{"acquisition.response_mv_per_m", "acquisition.voltage_unit"}));
  EXPECT_EQ(keys("[acquisition]\nresponse = \"acceleration\"\nforce_mv_per_n = 2\nresponse_mv_per_g = 100\n"
                 "accelerometer_mass_kg = 0\n"),
            std::vector<std::string>{"acquisition.voltage_unit"})
      << "V of a record that says nothing";
  // 1 mV/N of a record in mV is 1, and given all the same.
  EXPECT_TRUE(keys("[acquisition]\nresponse = \"acceleration\"\nvoltage_unit = \"mV\"\nforce_mv_per_n = 1\n"
                   "response_mv_per_m_per_s2 = 1\naccelerometer_mass_kg = 0\n")
                  .empty());
}

// What a record states is no assumption.
TEST(HitsToml, AssumesNoUnitThatIsStated) {
  const auto keys = [](const HitsFile& file) {
    std::vector<std::string> out;
    for (const Assumption& one : file.assumed) out.push_back(one.key);
    return out;
  };
  const std::string mass = "acquisition.accelerometer_mass_kg";
  EXPECT_EQ(keys(NamedColumns{}.read()), std::vector<std::string>{mass});
  EXPECT_EQ(keys(NamedColumns{.force = "force"}.read()),
            (std::vector<std::string>{"acquisition.force_mv_per_n", mass}));
  EXPECT_EQ(keys(NamedColumns{.response = "acc x (front)"}.read()),
            (std::vector<std::string>{"acquisition.response", "acquisition.response_mv_per_m_per_s2", mass}));
  const std::string sensors = "response = \"acceleration\"\nforce_mv_per_n = 2.5\nresponse_mv_per_g = 100\n";
  EXPECT_EQ(keys(NamedColumns{.force = "force_v", .response = "ax_v", .acquisition = sensors}.read()),
            std::vector<std::string>{mass});
  EXPECT_EQ(keys(NamedColumns{.force = "force_v", .response = "ax", .acquisition = sensors}.read()),
            (std::vector<std::string>{"acquisition.voltage_unit", mass}));
  // A universal file states N and m/s²; without a unit, and without data set 164, nothing does.
  const test::Folder folder;
  io::UffFunction force, response;
  force.type = response.type = 1;
  force.abscissa = response.abscissa = Eigen::VectorXd::LinSpaced(64, 0.0, 63.0 / 1024.0);
  force.values = response.values = Eigen::VectorXd::LinSpaced(64, 0.0, 1.0).cast<std::complex<double>>();
  force.numerator = {.type = 13, .label = "Hammer"};
  response.numerator = {.type = 12, .label = "Tip"};
  const std::string text = io::format_uff({force, response}, false);
  const auto read = [&](const std::string& content) {
    folder.file("a.uff", content);
    return read_hits(folder.file("hits.toml",
                                 "[[hits]]\nfile = \"a.uff\"\nforce = \"Hammer\"\nforce_direction = \"x\"\n"
                                 "responses = { x = \"Tip\" }\n"));
  };
  EXPECT_EQ(keys(read(text)), std::vector<std::string>{mass});
  EXPECT_EQ(keys(read(text.substr(text.find("    -1\n    58")))),
            (std::vector<std::string>{"acquisition.response", "acquisition.force_mv_per_n",
                                      "acquisition.response_mv_per_m_per_s2", mass}));
}

// A column in mV is in mV, whatever the file leaves out; it read as V before.
TEST(HitsToml, TakesTheVoltageThatARecordStates) {
  const std::string sensors = "force_mv_per_n = 2.5\nresponse_mv_per_g = 100\n";
  const HitsFile file = NamedColumns{.force = "force_mv", .response = "ax_v", .acquisition = sensors}.read();
  EXPECT_DOUBLE_EQ(file.hits[0].force_n(1), 0.5 / 2.5);
  EXPECT_NEAR(file.hits[0].responses[0].samples(1), 3.0 * 10.0 * 9.80665, 1e-10);
  EXPECT_EQ(file.notes, std::vector<std::string>{"Column force_mv is in mV by its name."});
  const std::string in_mv = "voltage_unit = \"mV\"\n" + sensors;
  const std::string said = NamedColumns{.force = "force_v", .response = "ax_mv", .acquisition = in_mv}.rejection();
  EXPECT_NE(said.find("is in V by its name, and acquisition.voltage_unit says another unit"), std::string::npos)
      << said;
  const NamedColumns of_each{
      .force = "force_mv", .response = "ax_v", .acquisition = "response_voltage_unit = \"V\"\n" + in_mv};
  EXPECT_NEAR(of_each.read().hits[0].responses[0].samples(1), 3.0 * 10.0 * 9.80665, 1e-10);
}

TEST(HitsToml, TakesTheRateFromTheFileWhereThereIsNoTime) {
  const test::Folder folder;
  static_cast<void>(folder.file("b.txt", "0 1\n2 3\n0 5\n"));
  const std::string row = "[[hits]]\nfile = \"b.txt\"\nforce = 1\nforce_direction = \"y\"\nresponses = { y = 2 }\n";
  const HitsFile file = read_hits(folder.file("hits.toml", "[acquisition]\nsample_rate_hz = 51200\n" + row));
  EXPECT_EQ(file.hits[0].sample_rate_hz, 51200.0);
  EXPECT_EQ(file.hits[0].responses[0].samples(2), 5.0);
  const std::string said =
      test::rejection([&] { static_cast<void>(read_hits(folder.file("none.toml", "[acquisition]\n" + row))); });
  EXPECT_NE(said.find("sample_rate_hz is missing"), std::string::npos) << said;
}

TEST(HitsToml, RejectsInTheFilesWords) {
  const test::Folder folder;
  static_cast<void>(folder.file("a.csv", record));
  const std::string row =
      "[[hits]]\nfile = \"a.csv\"\nforce = \"force_v\"\nforce_direction = \"x\"\nresponses = { x = \"ax\" }\n";
  const auto say = [&](const std::string& text) {
    return test::rejection([&] { static_cast<void>(read_hits(folder.file("hits.toml", text))); });
  };
  EXPECT_NE(say("[acquisition]\naccelerometer_mass_kg = -1\n" + row)
                .find("hits.toml:2: acquisition.accelerometer_mass_kg = -1 kg"),
            std::string::npos);
  EXPECT_NE(say("[acquisition]\n").find("[[hits]]"), std::string::npos);
  EXPECT_NE(say("[acquisition]\nforce_mv_per_n = 0\n" + row).find("calibration"), std::string::npos);
  EXPECT_NE(say("[acquisition]\nsample_rate_hz = 2000\n" + row).find("1000 Hz"), std::string::npos);
  EXPECT_NE(say("[[hits]]\nfile = \"a.csv\"\nforce = \"f\"\nforce_direction = \"x\"\nresponses = { x = \"ax\" }\n")
                .find("force_v"),
            std::string::npos);
  EXPECT_NE(say("[[hits]]\nfile = \"a.csv\"\nforce = 2\nforce_direction = \"q\"\nresponses = { x = \"ax\" }\n")
                .find("direction"),
            std::string::npos);
  EXPECT_NE(say("[[hits]]\nfile = \"none.csv\"\nforce = 2\nforce_direction = \"x\"\nresponses = { x = \"ax\" }\n")
                .find("none.csv"),
            std::string::npos);
  EXPECT_NE(say("[acquisition]\nfilter = 3\nforce_mv_per_n = 1\n" + row).find("filter"), std::string::npos);
}

TEST(HitsToml, ReadsSoundWithItsScale) {
  const test::Folder folder;
  {
    SF_INFO info{.frames = 0,
                 .samplerate = 10240,
                 .channels = 2,
                 .format = SF_FORMAT_WAV | SF_FORMAT_DOUBLE,
                 .sections = 0,
                 .seekable = 0};
    const std::unique_ptr<SNDFILE, decltype(&sf_close)> sound(sf_open(folder.at("a.wav").c_str(), SFM_WRITE, &info),
                                                              &sf_close);
    const std::vector<double> frames = {0.0, 0.0, 0.5, -0.25, 0.0, 0.0};
    sf_write_double(sound.get(), frames.data(), 6);
  }
  const std::string row = "[[hits]]\nfile = \"a.wav\"\nforce = 1\nforce_direction = \"x\"\nresponses = { x = 2 }\n";
  // Full scale is 5 V: 2.5 V at 2.5 mV/N are 1000 N.
  const HitsFile file = read_hits(folder.file(
      "hits.toml", "[acquisition]\nscale = 5\nforce_mv_per_n = 2.5\nresponse_mv_per_m_per_s2 = 10\n" + row));
  EXPECT_EQ(file.hits[0].sample_rate_hz, 10240.0);
  EXPECT_DOUBLE_EQ(file.hits[0].force_n(1), 1000.0);
  EXPECT_DOUBLE_EQ(file.hits[0].responses[0].samples(1), -125.0);
  const auto say = [&](const std::string& text) {
    return test::rejection([&] { static_cast<void>(read_hits(folder.file("bad.toml", text))); });
  };
  EXPECT_NE(say(row).find("acquisition.scale is missing"), std::string::npos);
  EXPECT_NE(say("[acquisition]\nscale = 0\n" + row).find("bad.toml:2: acquisition.scale = 0"), std::string::npos);
}

// Cut off or changed at any place, a file is rejected or read, and never anything worse.
TEST(HitsToml, SurvivesMutations) {
  const test::Folder folder;
  static_cast<void>(folder.file("a.csv", record));
  const std::string good =
      "[acquisition]\nresponse = \"acceleration\"\nforce_mv_per_n = 2.5\nsample_rate_hz = 1000\nforce_window_s = 0.1\n"
      "[[hits]]\nfile = \"a.csv\"\ntime = 1\nforce = \"force_v\"\nforce_direction = \"-x\"\n"
      "responses = { x = \"ax\", -y = 4 }\n";
  for (int seed = 0; seed < test::seeds(2000); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    std::string text = good;
    for (std::uint64_t i = random.index(4); i > 0; --i)
      text[random.index(text.size())] = static_cast<char>(random.index(128));
    if (random.index(4) == 0) text.resize(1 + random.index(text.size()));
    try {
      const HitsFile file = read_hits(folder.file("hits.toml", text));
      EXPECT_FALSE(file.hits.empty());
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(folder.path().string()), std::string::npos) << error.what();
    }
  }
}

}  // namespace hits_toml_test
}  // namespace robomill::modal
