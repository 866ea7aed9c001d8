// The calibration beside its cell: results do not depend on it, and nothing but its own inputs makes it stand.
#include "robomill/cell/files/calibration_document.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <complex>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "robomill/base/digest.hpp"
#include "robomill/cell/dynamics.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/json.hpp"
#include "robomill/io/system/output_places.hpp"
#include "testing/support.hpp"

namespace robomill::cell {
namespace calibration_document_test {

using test::Folder;
namespace fs = std::filesystem;

/// Two links on springs.
const std::string urdf = R"(<robot name="two"><link name="base"/>
<link name="upper"><inertial><origin xyz="0.3 0 0"/><mass value="40"/><inertia ixx="1" iyy="2" izz="2" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="fore"><inertial><origin xyz="0.2 0 0"/><mass value="20"/><inertia ixx="0.5" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="tool0"/>
<joint name="a" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="100" velocity="2"/></joint>
<joint name="b" type="revolute"><parent link="upper"/><child link="fore"/><origin xyz="0.6 0 0"/><axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="100" velocity="2"/></joint>
<joint name="t" type="fixed"><parent link="fore"/><child link="tool0"/><origin xyz="0.4 0 0" rpy="0 1.5707963267948966 0"/></joint></robot>
)";

const std::string cell = R"([robot]
urdf = "two.urdf"
urdf_base = "base"
urdf_tip = "tool0"
joint_stiffness_n_m_per_rad = [4e5, 3e5]
joint_damping_n_m_s_per_rad = [60, 40]
[workpiece]
origin_mm = [500, 0, 100]
[tool]
length_mm = 150
mass_kg = 2
[[postures]]
joints_deg = [0, 20]
frf = "tip.csv"
)";

/// What a hammer would measure: one mode a direction.
std::string frfs() {
  std::string text =
      "frequency_hz,xx_re_m_per_n,xx_im_m_per_n,yy_re_m_per_n,yy_im_m_per_n,zz_re_m_per_n,zz_im_m_per_n\n";
  for (int f = 5; f <= 205; f += 5) {
    text += fmt::format("{}", f);
    for (const double mode_hz : {18.0, 24.0, 31.0}) {
      const double ratio = f / mode_hz;
      const std::complex<double> h = 2e-6 / std::complex<double>(1.0 - ratio * ratio, 0.08 * ratio);
      text += fmt::format(",{:.9e},{:.9e}", h.real(), h.imag());
    }
    text += "\n";
  }
  return text;
}

struct Place {
  Folder folder;
  fs::path path = folder.file("cell.toml", cell), kept = folder.at("cell.calibration.json");
  Place() {
    folder.file("two.urdf", urdf);
    folder.file("tip.csv", frfs());
  }
  [[nodiscard]] ModesOfPosture modes() const { return posture_modes(path, {0.1, 0.5}); }
  [[nodiscard]] std::string fingerprint() const {
    static_cast<void>(modes());
    return io::read_json(kept).at("inputs_sha256").get<std::string>();
  }
};

std::string all_notes(const ModesOfPosture& posture) {
  std::string out;
  for (const std::string& note : posture.notes) out += note + "\n";
  return out;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

TEST(CalibrationDocument, LeavesEveryResultAsItIs) {
  const Place place;
  const std::string made = posture_modes_json(place.modes());
  ASSERT_TRUE(fs::is_regular_file(place.kept));
  EXPECT_NE(made.find("is kept in cell.calibration.json"), std::string::npos);
  const std::string document = io::read_file(place.kept);
  const fs::file_time_type written = fs::last_write_time(place.kept);
  EXPECT_EQ(posture_modes_json(place.modes()), made);
  EXPECT_EQ(fs::last_write_time(place.kept), written);
  fs::remove(place.kept);
  EXPECT_EQ(posture_modes_json(place.modes()), made);
  EXPECT_EQ(io::read_file(place.kept), document);
  EXPECT_EQ(place.folder.count(), 4U);
}

TEST(CalibrationDocument, IsMadeAnewForOtherInputs) {
  const Place place;
  const std::string first = place.fingerprint();
  const auto with = [&](const char* file, const std::string& text, const std::string& from, const std::string& to) {
    place.folder.file(file, replaced(text, from, to));
    std::string out = place.fingerprint();
    place.folder.file(file, text);
    return out;
  };
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"[0, 20]", "[0, 20.001]"},
           {"frf = \"tip.csv\"", "frf = \"tip.csv\"\n[[postures]]\njoints_deg = [0, 30]\nfrf = \"other.csv\""},
           {"length_mm = 150", "length_mm = 151"},
           {"mass_kg = 2", "mass_kg = 2.5"},
           {"[4e5, 3e5]", "[4e5, 3.1e5]"},
           {"[60, 40]", "[60, 41]"}}) {
    place.folder.file("other.csv", frfs());
    EXPECT_NE(with("cell.toml", cell, from, to), first) << to;
  }
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"value=\"20\"", "value=\"21\""}, {"izz=\"2\"", "izz=\"2.1\""}, {"0.6 0 0", "0.61 0 0"}}) {
    EXPECT_NE(with("two.urdf", urdf, from, to), first) << to;
  }
  const std::string measured = frfs();
  const std::size_t digit = measured.find('.', measured.size() / 2) + 9;
  const std::string other_digit = measured.substr(digit - 9, 9) + (measured[digit] == '1' ? "2" : "1");
  EXPECT_NE(with("tip.csv", measured, measured.substr(digit - 9, 10), other_digit), first);
  EXPECT_EQ(place.fingerprint(), first);
  const Cell read = read_cell(place.path);
  EXPECT_NE(modal::calibration_fingerprint(read.robot, {}, {}, {.band_high_hz = 600.0}),
            modal::calibration_fingerprint(read.robot, {}, {}, {}));
}

TEST(CalibrationDocument, StandsWhereWhatChangesIsNoInput) {
  const Place place;
  const std::string first = place.fingerprint();
  const fs::file_time_type written = fs::last_write_time(place.kept);
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"[500, 0, 100]", "[510, 0, 90]"},
           {"[robot]\n", "# a cell\n[robot]\njoint_max_velocity = [1, 2]\n"},
           {"[0, 20]", "[0.0, 2e1]"}}) {
    place.folder.file("cell.toml", replaced(cell, from, to));
    EXPECT_EQ(place.fingerprint(), first) << to;
  }
  place.folder.file("renamed.csv", frfs());
  place.folder.file("cell.toml", replaced(cell, "tip.csv", "renamed.csv"));
  EXPECT_EQ(place.fingerprint(), first);
  EXPECT_EQ(fs::last_write_time(place.kept), written);
}

TEST(CalibrationDocument, IsIgnoredAndReplacedWhereItIsBroken) {
  const Place place;
  const std::string made = posture_modes_json(place.modes());
  const std::string whole = io::read_file(place.kept);
  const auto rejects = [&](const std::string& text) {
    place.folder.file("cell.calibration.json", text);
    EXPECT_NE(all_notes(place.modes()).find("made anew: cell.calibration.json"), std::string::npos) << text;
    EXPECT_EQ(io::read_file(place.kept), whole);
    EXPECT_EQ(posture_modes_json(place.modes()), made);
  };
  rejects(whole.substr(0, whole.size() / 2));
  rejects(replaced(whole, "posture-calibration/1", "posture-calibration/2"));
  rejects(replaced(whole, "\"noise\": ", "\"noise\": 1"));
  rejects(replaced(whole, "\"noise\": ", "\"noise\": 1e999, \"n\": "));
  // With a digest that fits.
  const io::Json json = io::parse_json(whole, "document");
  const auto hostile = [&](const auto& change) {
    io::Json other = json;
    change(other["found"]);
    other["found_sha256"] = digest_of(io::plain_text(other["found"]));
    rejects(io::dump(other));
  };
  hostile([](io::Json& found) { found["parameters"].erase(0); });
  hostile([](io::Json& found) { found["parameters"][0] = found["parameters"][0].get<double>() + 0.01; });
  hostile([](io::Json& found) { found["parameters"] = "none"; });
  hostile([](io::Json& found) { found["posture_parameters"] = {{1.0}, {1.0, 2.0}}; });
  hostile([](io::Json& found) { found["noise"] = -1.0; });
  hostile([](io::Json& found) { found["error"] = 0.5; });
  hostile([](io::Json& found) { found["bearings"] = 1; });
  hostile([](io::Json& found) { found["tool"].push_back({{"frequency_hz", 0.0}, {"mass_kg", 1.0}}); });
  hostile([](io::Json& found) { found["band_scale"] = 1e6; });
  hostile([](io::Json& found) { found.erase("left_out"); });
}

TEST(CalibrationDocument, LeavesWhatIsNoCalibration) {
  const Place place;
  const std::string without = [&] {
    place.folder.file("cell.calibration.json", "{\"mine\": 1}\n");
    return all_notes(place.modes());
  }();
  EXPECT_NE(without.find("could not be kept"), std::string::npos);
  EXPECT_EQ(io::read_file(place.kept), "{\"mine\": 1}\n");
  fs::remove(place.kept);
  fs::create_directory(place.kept);
  EXPECT_NE(all_notes(place.modes()).find("could not be kept"), std::string::npos);
  EXPECT_TRUE(fs::is_directory(place.kept));
  fs::remove(place.kept);
  fs::create_symlink(place.folder.at("nowhere.json"), place.kept);
  EXPECT_NE(all_notes(place.modes()).find("could not be kept"), std::string::npos);
  EXPECT_FALSE(fs::exists(place.folder.at("nowhere.json")));
}

TEST(CalibrationDocument, IsNotWrittenOntoAFullDisk) {
  const Place place;
  const auto modes = [&] {
    const test::FileSizeLimit limit(100);
    return place.modes();
  }();
  EXPECT_NE(all_notes(modes).find("could not be kept"), std::string::npos);
  EXPECT_FALSE(fs::exists(place.kept));
  EXPECT_EQ(place.folder.count(), 3U);
}

TEST(CalibrationDocument, IsNoOutputOfTheJob) {
  const Place place;
  const io::OutputPlaces outputs({place.kept});
  EXPECT_NE(test::rejection([&] { static_cast<void>(place.modes()); }).find("would be replaced by its output"),
            std::string::npos);
}

TEST(CalibrationDocument, IsWholeWhereSeveralWriteIt) {
  const Place place;
  std::vector<std::string> results(4);
  {
    std::vector<std::jthread> threads;
    for (std::string& result : results) {
      threads.emplace_back([&] { result = posture_modes_json(place.modes()); });
    }
  }
  for (const std::string& result : results) EXPECT_EQ(result, results.front());
  EXPECT_EQ(place.folder.count(), 4U);
  EXPECT_EQ(posture_modes_json(place.modes()), results.front());
}

TEST(CalibrationDocument, IsNamedByTheCheckOfACell) {
  const Place place;
  const auto note = [&] { return calibration_notes(read_cell(place.path)).back(); };
  EXPECT_NE(note().find("not calibrated yet"), std::string::npos);
  EXPECT_FALSE(fs::exists(place.kept));
  static_cast<void>(place.modes());
  EXPECT_EQ(note(), "The calibration is kept in cell.calibration.json until its inputs change.");
  place.folder.file("tip.csv", replaced(frfs(), "\n5,", "\n5.1,"));
  EXPECT_NE(note().find("not calibrated yet"), std::string::npos);
  fs::remove(place.folder.at("tip.csv"));
  EXPECT_NE(note().find("cannot be calibrated: "), std::string::npos);
}

TEST(CalibrationDocument, IsWrittenForNoCellWithoutAFileOrPostures) {
  const Place place;
  Cell read = read_cell(place.path);
  read.path = "in memory";
  EXPECT_EQ(cell_dynamics(read).notes.size() + 1, cell_dynamics(read_cell(place.path)).notes.size());
  fs::remove(place.kept);
  place.folder.file("cell.toml", cell.substr(0, cell.find("[[postures]]")));
  static_cast<void>(place.modes());
  EXPECT_FALSE(fs::exists(place.kept));
}

}  // namespace calibration_document_test
}  // namespace robomill::cell
