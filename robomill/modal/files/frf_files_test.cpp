#include "robomill/modal/files/frf_files.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/records/uff.hpp"
#include "testing/robot_modes.hpp"
#include "testing/support.hpp"
#include "testing/text.hpp"

namespace robomill::modal {
namespace frf_files_test {

FrfSet robot_frfs() {
  FrfSet set = synthesize(data::robot_modes(), Eigen::VectorXd::LinSpaced(97, 5.0, 600.0));
  for (Frf& frf : set.frfs) {
    frf.coherence = Eigen::VectorXd::LinSpaced(97, 0.5, 1.0);
    frf.deviation = 1e-3 * frf.receptance.cwiseAbs();
  }
  return set;
}

void expect_same(const FrfSet& read, const FrfSet& written, double tolerance) {
  ASSERT_EQ(read.frfs.size(), written.frfs.size());
  EXPECT_LT((read.frequency_hz - written.frequency_hz).norm(), 1e-6 * written.frequency_hz.norm());
  for (const Frf& frf : written.frfs) {
    const Frf* other = read.find(frf.name);
    ASSERT_NE(other, nullptr) << to_string(frf.name);
    EXPECT_LE((other->receptance - frf.receptance).norm(), tolerance * frf.receptance.norm());
    ASSERT_EQ(other->coherence.size(), frf.coherence.size());
    EXPECT_LE((other->coherence - frf.coherence).norm(), tolerance * frf.coherence.norm());
    ASSERT_EQ(other->deviation.size(), frf.deviation.size());
    EXPECT_LE((other->deviation - frf.deviation).norm(), tolerance * frf.deviation.norm());
  }
}

TEST(FrfFiles, EveryFormatGivesTheSetBack) {
  const test::Folder folder;
  const FrfSet set = robot_frfs();
  for (const char* name : {"tip.csv", "tip.txt", "tip.mat", "tip.json"}) {
    write_frfs(folder.at(name), set);
    expect_same(read_frfs({folder.at(name)}).set, set, 0.0);
  }
  // Remarks on a prediction stand beside it and do not disturb the reader.
  const std::string annotated =
      frf_json(set, {.suspect_hz = {7.0}, .unreliable_hz = {8.0, 9.5}, .notes = {"a \"note\""}});
  expect_same(read_frfs({folder.file("annotated.json", annotated)}).set, set, 0.0);
  EXPECT_NE(annotated.find("\"suspect_hz\": [7.0]"), std::string::npos);
  EXPECT_NE(annotated.find("\"unreliable_hz\": [8.0, 9.5]"), std::string::npos);
  // E20.12 carries 13 digits.
  write_frfs(folder.at("tip.uff"), set);
  expect_same(read_frfs({folder.at("tip.uff")}).set, set, 1e-12);
  write_frfs(folder.at("binary.uff"), set, {.binary_uff = true});
  expect_same(read_frfs({folder.at("binary.uff")}).set, set, 0.0);
}

TEST(FrfFiles, PointsAndRotationsKeepTheirNames) {
  const test::Folder folder;
  const auto gives_back = [&](const std::vector<const char*>& names) {
    FrfSet set;
    set.frequency_hz = Eigen::Vector3d(1.0, 2.0, 3.0);
    for (const char* name : names) {
      set.frfs.push_back({.name = parse_frf_name(name), .receptance = Eigen::Vector3cd::Random()});
      set.frfs.back().deviation = Eigen::Vector3d(1e-3, 2e-3, 3e-3);
    }
    for (const char* name : {"p.csv", "p.txt", "p.mat", "p.json", "p.uff"}) {
      write_frfs(folder.at(name), set);
      expect_same(read_frfs({folder.at(name)}).set, set, 1e-11);
    }
    write_frfs(folder.at("binary.uff"), set, {.binary_uff = true});
    const FrfFile binary = read_frfs({folder.at("binary.uff")});
    expect_same(binary.set, set, 0.0);
    EXPECT_TRUE(binary.notes.empty());
  };
  gives_back({"xx", "x:my", "ry:x", "ry:my", "yy", "y:mx", "rx:y", "rx:mx", "zx", "rz:mz"});
  gives_back({"1x:1x", "2x:1x", "1x:3my", "1ry:3my", "12ry:3x"});
}

// Record 6 of data set 58 names directions 1 to 3 for translations and 4 to 6 for rotations; records 9 and 10 hold the
// exponents of length, force and temperature.
TEST(FrfFiles, UniversalFilesHoldRotationsAsTheFormatHasThem) {
  FrfSet set;
  set.frequency_hz = Eigen::Vector2d(1.0, 2.0);
  const auto text = [&](const char* name) {
    set.frfs = {{.name = parse_frf_name(name), .receptance = Eigen::Vector2cd(1.0, 2.0)}};
    const test::Folder folder;
    write_frfs(folder.at("a.uff"), set);
    return io::read_file(folder.at("a.uff"));
  };
  EXPECT_NE(text("ry:3mx").find(" NONE               0   5 NONE               3   4\n"), std::string::npos)
      << text("ry:3mx");
  EXPECT_NE(text("x:my").find("         8    1    0    0 Displacement         m "), std::string::npos) << text("x:my");
  EXPECT_NE(text("x:my").find("        13    1    1    0 Moment               N m "), std::string::npos);
  EXPECT_NE(text("ry:x").find("         8    0    0    0 Rotation             rad "), std::string::npos);
  EXPECT_NE(text("ry:x").find("        13    0    1    0 Force                N "), std::string::npos);
}

TEST(FrfFiles, HeaderlessColumnsTakeTheirNamesFromTheUser) {
  const test::Folder folder;
  const auto a = folder.file("a.txt", "0 7e-001 0\n1 1e-6 -2e-6\n2 3e-6 4e-6\n");
  const auto b = folder.file("b.txt", "0\t1\t0\n1\t5e-6\t6e-6\n2\t7e-6\t8e-6\n");
  EXPECT_EQ(to_string(read_frfs({a}).set.frfs[0].name), "xx");
  const FrfSet both = read_frfs({a, b}, {"xx", "yy"}).set;
  EXPECT_EQ(both.find(parse_frf_name("yy"))->receptance(2), std::complex<double>(7e-6, 8e-6));
  EXPECT_NE(test::rejection([&] { static_cast<void>(read_frfs({a, b})); }).find("--as"), std::string::npos);
  EXPECT_NE(test::rejection([&] {
              static_cast<void>(read_frfs({a, b}, {"xx", "xx"}));
            }).find("comes twice"),
            std::string::npos);
}

TEST(FrfFiles, RejectsAxesThatDiffer) {
  const test::Folder folder;
  const auto a = folder.file("a.txt", "1 1 0\n2 1 0\n");
  const auto b = folder.file("b.txt", "1 1 0\n2.1 1 0\n");
  const std::string said = test::rejection([&] { static_cast<void>(read_frfs({a, b}, {"xx", "yy"})); });
  EXPECT_NE(said.find("a.txt"), std::string::npos);
  EXPECT_NE(said.find("b.txt"), std::string::npos);
}

// A sine of displacement X has the acceleration -ω² X.
TEST(FrfFiles, AccelerancesBecomeReceptances) {
  const test::Folder folder;
  io::UffFunction function;
  function.type = 4;
  function.is_complex = true;
  function.response_direction = -1;
  function.reference_direction = 1;
  function.abscissa = Eigen::Vector3d(0.0, 10.0, 20.0);
  function.values = Eigen::Vector3cd(0.0, {2.0, 1.0}, 3.0);
  function.abscissa_axis = {.type = 18, .unit = "Hz"};
  function.numerator = {.type = 12, .unit = "m/s^2"};
  function.denominator = {.type = 13, .unit = "N"};
  const FrfFile file = read_frfs({folder.file("a.uff", io::format_uff({function}, false))});
  ASSERT_EQ(file.set.frequency_hz.size(), 2);
  const double omega = 2 * std::numbers::pi * 10.0;
  const std::complex<double> expected = std::complex<double>(2.0, 1.0) / (omega * omega);
  EXPECT_LT(std::abs(file.set.frfs[0].receptance(0) - expected), 1e-11 * std::abs(expected));
  EXPECT_FALSE(file.notes.empty());
}

io::UffFunction one_function() {
  io::UffFunction function;
  function.type = 4;
  function.is_complex = true;
  function.response_direction = 1;
  function.reference_direction = 1;
  function.abscissa = Eigen::Vector3d(10.0, 20.0, 30.0);
  function.values = Eigen::Vector3cd(1.0, {2.0, 1.0}, 3.0);
  return function;
}

TEST(FrfFiles, UniversalFilesKeepTheirUnits) {
  const test::Folder folder;
  const auto read = [&](const std::vector<io::UffFunction>& functions) {
    return read_frfs({folder.file("a.uff", io::format_uff(functions, true))});
  };
  const auto first = [&](const io::UffFunction& function) { return read({function}).set.frfs[0].receptance(0); };
  io::UffFunction function = one_function();
  // Nothing said: m/N is assumed.
  EXPECT_EQ(first(function), std::complex<double>(1.0));
  ASSERT_EQ(read({function}).assumed.size(), 1U);
  EXPECT_EQ(read({function}).assumed[0].taken, "receptances in m/N");
  function.numerator = {.type = 8, .unit = "mm"};
  function.denominator = {.type = 13, .unit = "kN"};
  EXPECT_DOUBLE_EQ(first(function).real(), 1e-6);
  function.numerator = {.type = 1, .unit = "(1/N)*(mm)"};
  EXPECT_DOUBLE_EQ(first(function).real(), 1e-3);
  const double omega = 2 * std::numbers::pi * 10.0;
  function.numerator = {.type = 11, .unit = "m/s"};
  function.denominator = {.type = 13, .unit = "N"};
  EXPECT_LT(std::abs(first(function) - std::complex<double>(0.0, -1.0 / omega)), 1e-15);
  function.numerator = {.type = 12, .unit = "g"};
  EXPECT_NEAR(first(function).real(), -9.80665 / (omega * omega), 1e-15);
  function.abscissa_axis.unit = "rad/s";
  EXPECT_NEAR(read({function}).set.frequency_hz(2), 30.0 / (2 * std::numbers::pi), 1e-12);
  function.reference_direction = -1;
  EXPECT_GT(first(function).real(), 0.0);
  // Force per displacement, and acceleration per acceleration.
  function.numerator = {.type = 13};
  EXPECT_NE(test::rejection([&] { static_cast<void>(read({function})); }).find("per force"), std::string::npos);
  function.numerator = function.denominator = {.type = 12};
  EXPECT_NE(test::rejection([&] { static_cast<void>(read({function})); }).find("per force"), std::string::npos);
}

// Millimetres and newtons by data set 164 alone: an angle has no length, and a moment has one.
TEST(FrfFiles, UniversalFilesKeepTheUnitsOfRotations) {
  const test::Folder folder;
  const auto first = [&](int response, int reference, bool say_exponents) {
    io::UffFunction function = one_function();
    function.response_direction = response;
    function.reference_direction = reference;
    function.numerator = {.type = 8, .length_exponent = say_exponents && response < 4 ? 1 : 0};
    function.denominator = {.type = 13, .force_exponent = say_exponents ? 1 : 0};
    if (say_exponents && reference > 3) function.denominator.length_exponent = 1;
    std::string text = io::format_uff({function}, false);
    const std::string metre = "  1.00000000000000000D+00";
    text.replace(text.find(metre), metre.size(), "  1.00000000000000000D+03");
    return read_frfs({folder.file("a.uff", text)}).set.frfs[0].receptance(0).real();
  };
  for (const bool say_exponents : {false, true}) {
    EXPECT_DOUBLE_EQ(first(1, 1, say_exponents), 1e-3);
    EXPECT_DOUBLE_EQ(first(1, 5, say_exponents), 1.0);
    EXPECT_DOUBLE_EQ(first(5, 1, say_exponents), 1.0);
    EXPECT_DOUBLE_EQ(first(5, 5, say_exponents), 1e3);
  }
  io::UffFunction function = one_function();
  function.response_direction = -5;
  function.reference_direction = 5;
  function.numerator = {.type = 8, .unit = "mrad"};
  function.denominator = {.type = 13, .unit = "N*mm"};
  const FrfFile file = read_frfs({folder.file("a.uff", io::format_uff({function}, true))});
  EXPECT_EQ(to_string(file.set.frfs[0].name), "ry:my");
  EXPECT_DOUBLE_EQ(file.set.frfs[0].receptance(0).real(), -1.0);
}

TEST(FrfFiles, ColumnsOfRotationsKeepTheirUnits) {
  const test::Folder folder;
  const auto first = [&](const std::string& name, const std::string& unit) {
    return read_frfs({folder.file("a.csv", "f," + name + "_re_" + unit + "," + name + "_im_" + unit + "\n10,2,0\n")})
        .set.frfs[0]
        .receptance(0)
        .real();
  };
  EXPECT_DOUBLE_EQ(first("x:my", "m_per_n_m"), 2.0);
  EXPECT_DOUBLE_EQ(first("x:my", "um_per_n_m"), 2e-6);
  EXPECT_DOUBLE_EQ(first("ry:x", "urad_per_n"), 2e-6);
  EXPECT_DOUBLE_EQ(first("ry:my", "rad_per_n_mm"), 2e3);
  const double omega = 2 * std::numbers::pi * 10.0;
  EXPECT_DOUBLE_EQ(first("ry:my", "rad_per_s2_per_n_m"), -2.0 / (omega * omega));
  const auto rejected = [&](const char* name, const char* unit) {
    const std::string said = test::rejection([&] { static_cast<void>(first(name, unit)); });
    EXPECT_NE(said.find("does not fit its name"), std::string::npos) << said;
  };
  rejected("x:my", "m_per_n");
  rejected("ry:x", "m_per_n");
  rejected("xx", "rad_per_n_m");
}

TEST(FrfFiles, UniversalFilesMixWhatTheyHold) {
  const test::Folder folder;
  io::UffFunction receptance = one_function(), accelerance = one_function(), time = one_function(),
                  coherence = one_function();
  receptance.abscissa(0) = accelerance.abscissa(0) = coherence.abscissa(0) = 0.0;
  receptance.numerator = {.type = 8};
  accelerance.numerator = {.type = 12};
  accelerance.response_direction = 2;
  time.type = 1;
  time.is_complex = false;
  time.values = time.values.real().cast<std::complex<double>>();
  coherence.type = 6;
  coherence.is_complex = false;
  coherence.response_direction = -2;
  coherence.values = Eigen::Vector3cd(0.25, 0.5, 1.0);
  const FrfFile file =
      read_frfs({folder.file("a.uff", io::format_uff({coherence, receptance, time, accelerance}, false))});
  // The line at 0 Hz goes for all.
  ASSERT_EQ(file.set.frequency_hz.size(), 2);
  EXPECT_EQ(file.set.find(parse_frf_name("xx"))->receptance(0), std::complex<double>(2.0, 1.0));
  EXPECT_EQ(file.set.find(parse_frf_name("yx"))->coherence, Eigen::Vector2d(0.5, 1.0));
  EXPECT_EQ(file.notes.size(), 3U);
  accelerance.abscissa *= 1.01;
  EXPECT_NE(test::rejection([&] {
              static_cast<void>(read_frfs({folder.file("a.uff", io::format_uff({receptance, accelerance}, false))}));
            }).find("has other frequencies than the FRF before it"),
            std::string::npos);
}

TEST(FrfFiles, UniversalFilesWithoutDirectionsTakeNamesFromTheUser) {
  const test::Folder folder;
  io::UffFunction function = one_function();
  function.response_direction = function.reference_direction = 0;
  const auto path = folder.file("a.uff", io::format_uff({function, function}, false));
  EXPECT_NE(test::rejection([&] { static_cast<void>(read_frfs({path})); }).find("--as"), std::string::npos);
  EXPECT_NE(read_frfs({path}, {"xx", "yy"}).set.find(parse_frf_name("yy")), nullptr);
  EXPECT_EQ(to_string(read_frfs({folder.file("b.uff", io::format_uff({function}, false))}).set.frfs[0].name), "xx");
}

TEST(FrfFiles, ColumnsKeepTheirUnits) {
  const test::Folder folder;
  const FrfFile um = read_frfs(
      {folder.file("a.csv", "xx_re_um_per_n;xx_im_um_per_n;f_hz;xx_coherence;spare\n1,5;2;10;0,5;7\n3;4;20;1;7\n")});
  EXPECT_NEAR(std::abs(um.set.frfs[0].receptance(0) - std::complex<double>(1.5e-6, 2e-6)), 0.0, 1e-18);
  EXPECT_EQ(um.set.frfs[0].coherence, Eigen::Vector2d(0.5, 1.0));
  EXPECT_EQ(um.notes.size(), 1U);
  const FrfFile a = read_frfs({folder.file(
      "b.csv",
      "frequency_hz,xx_re_m_per_s2_per_n,xx_im_m_per_s2_per_n,xx_deviation_m_per_s2_per_n\n0,0,0,0\n10,1,0,0.1\n")});
  ASSERT_EQ(a.set.frequency_hz.size(), 1);
  const double omega = 2 * std::numbers::pi * 10.0;
  EXPECT_NEAR(a.set.frfs[0].receptance(0).real(), -1.0 / (omega * omega), 1e-18);
  EXPECT_NEAR(a.set.frfs[0].deviation(0), 0.1 / (omega * omega), 1e-18);
  const FrfFile words = read_frfs({folder.file("c.csv", "Frequency (Hz),Real,Imag\n1,2,3\n")});
  EXPECT_EQ(words.set.frfs[0].receptance(0), std::complex<double>(2.0, 3.0));
  const auto say = [&](const std::string& text) {
    return test::rejection([&] { static_cast<void>(read_frfs({folder.file("d.csv", text)})); });
  };
  EXPECT_NE(say("f,xx_re_v,xx_im_v\n1,2,3\n").find("xx_re_v has a unit that is not known"), std::string::npos);
  EXPECT_NE(say("f,xx_re_m_per_n,xx_im_mm_per_n\n1,2,3\n").find("differ in unit"), std::string::npos);
  EXPECT_NE(say("f,up_re,up_im\n1,2,3\n").find("d.csv: FRF name = \"up\""), std::string::npos);
  EXPECT_NE(say("xx_re,xx_im\n1,2\n").find("frequency_hz"), std::string::npos);
}

// A row of units below the names says what the names could.
TEST(FrfFiles, ARowOfUnitsCounts) {
  const test::Folder folder;
  const auto read = [&](const std::string& text) { return read_frfs({folder.file("a.csv", text)}); };
  const std::complex<double> value(2e-6, -3e-6);
  const auto off = [&](const FrfFile& file) { return std::abs(file.set.frfs[0].receptance(0) - value); };
  const FrfFile words = read("Frequency,Real,Imag\nkHz,um/N,um/N\n0.1,2,-3\n0.2,2,-3\n");
  EXPECT_LT(off(words), 1e-18);
  EXPECT_DOUBLE_EQ(words.set.frequency_hz(0), 100.0);
  const FrfFile names = read("frequency_hz,xx_re,xx_im,xx_coherence\n(Hz),(µm/N),(µm/N),(-)\n100,2,-3,1\n200,2,-3,1\n");
  EXPECT_LT(off(names), 1e-18);
  EXPECT_TRUE(names.assumed.empty()) << "the unit is stated";
  EXPECT_NE(test::rejection([&] {
              static_cast<void>(read("Frequency,Real,Imag\nmm,m/N,m/N\n100,2,-3\n"));
            }).find("has its first column in mm, which is no frequency"),
            std::string::npos);
}

TEST(FrfFiles, OneNumberedPointIsTheTip) {
  const test::Folder folder;
  FrfSet set;
  set.frequency_hz = Eigen::Vector2d(1.0, 2.0);
  set.frfs.push_back({.name = parse_frf_name("4x:4x"), .receptance = Eigen::Vector2cd(1.0, 2.0)});
  write_frfs(folder.at("p.json"), set);
  const FrfFile file = read_frfs({folder.at("p.json")});
  EXPECT_EQ(to_string(file.set.frfs[0].name), "xx");
  ASSERT_EQ(file.assumed.size(), 1U);
  EXPECT_EQ(file.assumed[0].what, "Point 4, where all FRFs stand");
  EXPECT_EQ(file.assumed[0].taken, taken_as_tip);
  set.frfs.push_back({.name = parse_frf_name("4ry:4x"), .receptance = Eigen::Vector2cd(1.0, 2.0)});
  write_frfs(folder.at("p.uff"), set);
  EXPECT_NE(read_frfs({folder.at("p.uff")}).set.find(parse_frf_name("ry:x")), nullptr);
}

TEST(FrfFiles, RejectsWhatCannotBeAnFrf) {
  const test::Folder folder;
  const auto say = [&](const char* name, const std::string& text) {
    return test::rejection([&] { static_cast<void>(read_frfs({folder.file(name, text)})); });
  };
  EXPECT_NE(say("a.csv", "frequency_hz,xx_re_m_per_n,xx_im_m_per_n\n1,2,nan\n").find("a.csv:2"), std::string::npos);
  EXPECT_NE(say("a.csv", "frequency_hz,xx_re_m_per_n,xx_im_m_per_n\n2,2,1\n1,2,1\n").find("must be above"),
            std::string::npos);
  EXPECT_NE(say("a.csv", "frequency_hz,xx_re_m_per_n\n2,2\n").find("xx_im_m_per_n"), std::string::npos);
  EXPECT_NE(say("a.txt", "1 2\n2 3\n").find("three columns"), std::string::npos);
  EXPECT_NE(say("a.json", "{\"frequency_hz\":[1,2]}").find("receptance_m_per_n"), std::string::npos);
  EXPECT_NE(say("a.json", "{\"frequency_hz\":[1,\"x\"],\"receptance_m_per_n\":{}}").find("frequency_hz[2]"),
            std::string::npos);
  EXPECT_NE(say("a.doc", "hello").find(".uff"), std::string::npos);
  EXPECT_NE(say("a.csv", " ").find("a.csv"), std::string::npos);
}

// Cut off or changed at any place, a file is rejected or read, and never anything worse.
TEST(FrfFiles, SurviveMutations) {
  const test::Folder folder;
  const FrfSet set = robot_frfs();
  for (const char* name : {"m.csv", "m.json", "m.uff", "m.mat"}) {
    write_frfs(folder.at(name), set);
    const std::string good = io::read_file(folder.at(name));
    Random random(7);
    for (int i = 0; i < test::seeds(500); ++i) {
      try {
        read_frfs({folder.file(name, test_support::mutated(good, i, random))}).set.validate();
      } catch (const InvalidInput&) {
        continue;
      }
    }
  }
}

}  // namespace frf_files_test
}  // namespace robomill::modal
