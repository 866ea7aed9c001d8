#include "robomill/serve/files/folder.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <cmath>
#include <complex>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/records/mat.hpp"
#include "robomill/io/records/records.hpp"
#include "robomill/io/system/confinement.hpp"
#include "robomill/jobs/files/named_files.hpp"
#include "robomill/serve/files/inspect.hpp"
#include "testing/support.hpp"

namespace robomill::serve {
namespace folder_test {

namespace fs = std::filesystem;
using test::rejection;

TEST(Folder, ListsVisibleFilesByKind) {
  const test::Folder place;
  fs::create_directories(place.at("a/b"));
  fs::create_directories(place.at(".git"));
  place.file("job.toml", "# a job\n[job]\nlobes = \"lobes.toml\"\n");
  place.file("lobes.toml", "[tool]\nteeth = 2\n [lobes]\n");
  place.file("forces.toml", "[tool]\n[cut]\n");
  place.file("a/cell.toml", "[robot]\n");
  place.file("a/b/tap.wav", "x");
  place.file("tip.csv", "frequency_hz, xx_re_m_per_n, xx_im_m_per_n\n");
  place.file("modes.json", R"({"modes":[{"right":{}}]})");
  place.file("part.ngc", "G0\n");
  place.file(".secret", "x");
  place.file(".git/config", "x");
  fs::create_symlink("/etc/passwd", place.at("link"));
  Folder folder(place.path());
  std::size_t left_out = 0;
  std::string seen;
  for (const FolderFile& file : folder.list(left_out)) seen += file.path + "=" + file.what.kind + " ";
  EXPECT_EQ(seen,
            "a/b/tap.wav=record a/cell.toml=cell forces.toml=forces job.toml=job lobes.toml=lobes modes.json=modes "
            "part.ngc=program tip.csv=frf ");
  EXPECT_EQ(left_out, 0u);
  EXPECT_EQ(folder.list(left_out, 3).size(), 3u);
  EXPECT_EQ(left_out, 5u);
}

TEST(Folder, ListsWhatIsNearFirst) {
  const test::Folder place;
  fs::create_directories(place.at("a/b"));
  for (int i = 0; i < 30; ++i) place.file("a/b/" + std::to_string(i) + ".csv", "x");
  for (int i = 0; i < 3; ++i) place.file("a/" + std::to_string(i) + ".csv", "x");
  place.file("job.toml", "[job]\n");
  fs::create_directories(place.at("1/2/3/4/5/6/7"));
  place.file("1/2/3/4/5/6/near", "x");
  place.file("1/2/3/4/5/6/7/far", "x");
  Folder folder(place.path());
  std::size_t left_out = 0;
  std::string seen;
  for (const FolderFile& file : folder.list(left_out, 4)) seen += file.path + " ";
  EXPECT_EQ(seen, "a/0.csv a/1.csv a/2.csv job.toml ");
  EXPECT_EQ(left_out, 31U);
  // A folder that cannot be read hides nothing else.
  EXPECT_EQ(::chmod(place.at("a/b").c_str(), 0), 0);
  const std::size_t files = folder.list(left_out).size();
  EXPECT_TRUE(files == 5U || files == 35U) << files;  // who may read everything reads it too
  EXPECT_EQ(::chmod(place.at("a/b").c_str(), 0700), 0);
}

TEST(Folder, SeesChangesWithinASecond) {
  const test::Folder place;
  const fs::path path = place.file("a.toml", "[job]\n");
  Folder folder(place.path());
  std::size_t left_out = 0;
  const std::vector<FolderFile> first = folder.list(left_out);
  EXPECT_EQ(first.front().what.kind, "job");
  place.file("a.toml", "[fit]\n");
  fs::last_write_time(path, first.front().modified + std::chrono::milliseconds(1));
  const std::vector<FolderFile> second = folder.list(left_out);
  EXPECT_EQ(second.front().what.kind, "fit");
  EXPECT_NE(first, second);
}

TEST(NamedFiles, AreNotReadWithoutBound) {
  const test::Folder place;
  std::string names;
  for (int i = 0; i < 70; ++i) {
    const std::string name = fmt::format("d{}.toml", i);
    place.file(name, "a = 1\n");
    names += fmt::format("\"{}\", ", name);
    if (i != 50) continue;
    EXPECT_EQ(jobs::files_named_in(place.file("few.toml", "a = [" + names + "]\n")).size(), 51U);
  }
  EXPECT_THROW(static_cast<void>(jobs::files_named_in(place.file("many.toml", "a = [" + names + "]\n"))), InvalidInput);
  const std::string long_one = "# " + std::string(1'000'000, '-') + "\n";
  std::string long_names;
  for (int i = 0; i < 10; ++i) {
    place.file(fmt::format("l{}.toml", i), long_one);
    long_names += fmt::format("\"l{}.toml\", ", i);
  }
  EXPECT_THROW(static_cast<void>(jobs::files_named_in(place.file("long.toml", "a = [" + long_names + "]\n"))),
               InvalidInput);
}

TEST(FileKindTest, FrfsWithoutAHeaderAreNoRecords) {
  const test::Folder place;
  const auto rows = [](double first, double step, double scale, const char* header = "") {
    std::string text = header;
    for (int i = 0; i < 400; ++i) {
      const std::complex<double> s(0.0, first + step * i);
      const std::complex<double> h = scale / (s * s + 20.0 * s + 1e6);
      text += fmt::format("{:.6g} {:.8g} {:.8g}\n", first + step * i, h.real(), h.imag());
    }
    return text;
  };
  const auto kind = [&](const char* name, const std::string& text) {
    return kind_of_file(place.file(name, text)).kind;
  };
  EXPECT_EQ(kind("tip.txt", rows(0, 5, 1)), "frf");
  EXPECT_EQ(kind("tip.csv", rows(100, 0.5, 1)), "frf");
  EXPECT_EQ(kind("force.txt", rows(0, 1, 1e8)), "record");   // counted samples of a hit: up to hundreds of N
  EXPECT_EQ(kind("time.txt", rows(0, 2e-5, 1)), "record");   // steps of a time
  EXPECT_EQ(kind("before.txt", rows(-10, 1, 1)), "record");  // no frequency
  EXPECT_EQ(kind("named.txt", rows(0, 5, 1, "time force x\n")), "record");
  EXPECT_EQ(kind("tap.mat", "no MAT file"), "record");
  const Eigen::VectorXd values = Eigen::VectorXd::LinSpaced(20, 1.0, 20.0);
  io::write_mat(place.at("tip.mat"),
                {{.name = "frequency_hz", .re = values}, {.name = "H_xx", .re = values, .im = values}});
  io::write_mat(place.at("hit.mat"), {{.name = "force", .re = values}, {.name = "acceleration", .re = values}});
  EXPECT_EQ(kind_of_file(place.at("tip.mat")).kind, "frf");
  EXPECT_EQ(kind_of_file(place.at("hit.mat")).kind, "record");
}

TEST(FileKindTest, TrajectoriesAreNoRecords) {
  const test::Folder place;
  EXPECT_EQ(kind_of_file(place.file("hit.h5", "\x89HDF\r\n force")).kind, "record");
  EXPECT_EQ(kind_of_file(place.file("path.h5", "\x89HDF\r\n sample_period_s")), (FileKind{"result", "trajectory"}));
  for (const std::string_view ending : io::record_endings()) {
    const std::string kind = kind_of_file(place.file("a" + std::string(ending), "1 2\n2 3\n3 5\n")).kind;
    EXPECT_TRUE(kind == "record" || kind == "frf") << ending << " " << kind;
  }
}

// A hit whose force and response are in two files is one, once both are there.
TEST(Inspect, FilesOfOneHitAreDescribedTogether) {
  const test::Folder place;
  fs::create_directories(place.at("taps"));
  const auto put = [&](const char* name, const char* header, bool force) {
    std::string text = header;
    for (int i = 0; i < 1000; ++i) {
      const double value = force     ? (i >= 150 && i < 160 ? 100.0 * std::sin(0.314159 * (i - 150)) : 0.0)
                           : i < 150 ? 0.0
                                     : std::exp(-0.02 * (i - 150)) * std::sin(0.4 * (i - 150));
      text += fmt::format("{:.6f} {:.9f}\n", 1e-4 * i, value);
    }
    return place.file(std::string("taps/") + name, text);
  };
  const fs::path force = put("hit1_force.txt", "time_s force_n\n", true);
  const io::Json alone = inspect(force);
  EXPECT_EQ(alone["kind"], "record");
  EXPECT_TRUE(alone["files"].empty());
  EXPECT_EQ(alone["columns"].size(), 2U);
  const fs::path response = put("hit1_accel.txt", "time_s ay_g\n", false);
  put("hit2_accel.txt", "time_s ay_g\n", false);
  for (const fs::path& file : {force, response}) {
    const io::Json both = inspect(file);
    EXPECT_EQ(both["files"], io::Json({"hit1_force.txt", "hit1_accel.txt"})) << both;
    ASSERT_EQ(both["columns"].size(), 2U) << both;
    EXPECT_EQ(both["columns"][0]["name"], "force_n");
    EXPECT_EQ(both["columns"][0]["guess"], "force");
    EXPECT_EQ(both["columns"][1]["name"], "ay_g");
    EXPECT_EQ(both["columns"][1]["guess"], "response");
    EXPECT_EQ(both["direction_guess"], "y");
    EXPECT_NEAR(both["sample_rate_hz"].get<double>(), 1e4, 1e-3);
    EXPECT_EQ(both["time"], "time_s");
    EXPECT_TRUE(both["questions"].empty()) << both["questions"];
  }
  // Neither does the other's file count, nor one that is a hit by itself.
  EXPECT_TRUE(inspect(place.at("taps/hit2_accel.txt"))["files"].empty());
}

TEST(FileKindTest, TextsAreRecordsOnlyWhereTheyHoldNumbers) {
  const test::Folder place;
  const auto kind = [&](const char* name, const std::string& text) {
    return kind_of_file(place.file(name, text)).kind;
  };
  EXPECT_EQ(kind("CMakeLists.txt", "add_executable(a a.cpp)\nset(b 1)\n"), "other");
  EXPECT_EQ(kind("README.txt", "Cut 3 of 5.\n\n3 4 5\nis a triangle.\n"), "other");
  EXPECT_EQ(kind("answer.txt", "42\n"), "other");
  EXPECT_EQ(kind("empty.csv", ""), "other");
  EXPECT_EQ(kind("names.csv", "name,what\na,b\n"), "other");
  EXPECT_EQ(kind("binary.dat", std::string("1 2\n\0\1\2", 8)), "other");
  EXPECT_EQ(kind("tap.TXT", "time force\n0 1\n1e-4 2\n2e-4 3\n"), "record");
  EXPECT_EQ(kind("tap.csv", "% DAQ 7\nTime [s];Hammer [N]\n0,0;1,5\n0,1;2,5\n0,2;1,0\n"), "record");
  EXPECT_EQ(kind("channel.asc", "0.1\n0.2\n-0.1\n0.4\n"), "record");
  EXPECT_EQ(kind("tip.txt", "frequency_hz\txx_re_m_per_n\txx_im_m_per_n\n1\t2\t3\n"), "frf");
  // Longer than what is read of it: the line that is cut off there does not count.
  std::string rows = "time_s,x\n";
  while (rows.size() < 200'000) rows += "0.125,-1.5e-3\n";
  EXPECT_EQ(kind("long.csv", rows), "record");
  EXPECT_EQ(kind("tools.csv", "tool,length_mm,diameter_mm\nA,20,8\n"), "tools");
  EXPECT_EQ(kind("slots.csv", "feed_per_tooth_mm;axial_depth_mm;fx_n;fy_n\n0.1;1;5;6\n"), "slots");
  EXPECT_EQ(kind("loads.csv", "q1_deg,fx_n,fy_n,fz_n,dx_mm,dy_mm,dz_mm\n0,1,2,3,4,5,6\n"), "loads");
  EXPECT_EQ(kind("part.csv", "x_mm,y_mm,z_mm,i,j,k,feed_mm_per_min\n0,0,0,0,0,1,\n"), "program");
  EXPECT_EQ(kind("fit.toml", "[fit]\nmodes = 3\n"), "fit");
}

TEST(FileKindTest, ResultsNameTheirDocument) {
  const test::Folder place;
  const auto document = [&](const char* name, const std::string& text) {
    const FileKind kind = kind_of_file(place.file(name, text));
    return kind.kind == "result" ? kind.document : "(" + kind.kind + ")";
  };
  // What a document holds inside makes it none of those.
  const std::string inside = R"([{"receptance_m_per_n": 1, "title": "", "created": "", "modes": [{"right": 1}]}])";
  EXPECT_EQ(document("plan.json", R"({"document": "plan/1", "agreement": )" + inside + "}"), "plan");
  EXPECT_EQ(document("lobes.json", R"({"document": "lobes/1", "spindle_speed_rpm": [1)"), "lobes");
  EXPECT_EQ(document("sweep.json", R"({"document": "sweep/1", "sweep": "lead"})"), "lobes");
  EXPECT_EQ(document("blocks.json", "{\"document\": \"blocks/1\", \"blocks\": [" + std::string(100'000, ' ')),
            "blocks");
  EXPECT_EQ(document("tip.json", "{\"document\": \"frf/1\", \"frequency_hz\": [1" + std::string(100'000, ' ')),
            "(frf)");
  EXPECT_EQ(document("modes.json", R"({"document": "modes/1", "modes": [{"right": {}}]})"), "(modes)");
  EXPECT_EQ(document("report.json", R"({"title": "", "created": "", "plan": null})"), "(report)");
  for (const char* other :
       {"", "{", "[]", "3", "{\"a\": ", "no JSON", "{\"a\": {\"agreement\": 1, \"recommended\": 2}}",
        R"({"document": "letter/1"})", R"({"document": 1})", R"({"a": {"document": "lobes/1"}})"}) {
    EXPECT_EQ(document("other.json", other), "(other)") << other;
  }
  EXPECT_EQ(document("deep.json", std::string(60'000, '[')), "(other)");
  EXPECT_EQ(document("blocks.csv", "block,line,x_mm,q1,spectral_radius\n1,2,3,4,\n"), "blocks");
  EXPECT_EQ(document("forces.csv", "rotation_deg,fx_n,fy_n,fz_n,torque_n_m\n0,1,2,3,4\n"), "forces");
  EXPECT_EQ(document("along.csv", "block,line,x_mm,mean_fx_n\n1,2,3,4\n"), "forces");
  EXPECT_EQ(document("trajectory.csv", "time_s,q1,q2,x_mm,block\n0,1,2,3,4\n"), "trajectory");
  EXPECT_EQ(document("vibration.csv", "time_s,x_m,y_m,ax_m_per_s2,ay_m_per_s2,fx_n\n0,1,2,3,4,5\n"), "vibration");
  EXPECT_EQ(document("modes.csv", "mode,frequency_hz,damping_ratio\n1,2,3\n"), "modes");
  EXPECT_EQ(document("explain.csv", "frequency_hz,state,kind\n1,a,b\n"), "explain");
  EXPECT_EQ(document("lobes.csv", "spindle_speed_rpm,axial_depth_mm,chatter_frequency_hz\n1,2,3\n"), "lobes");
  EXPECT_EQ(document("coefficients.toml", "[coefficients]\n[identification]\n"), "coefficients");
  EXPECT_EQ(document("part.src", "DEF PART()\n"), "trajectory");
}

TEST(Folder, LetsNobodyOut) {
  const test::Folder place;
  fs::create_directories(place.at("inside"));
  place.file("secret.txt", "42");
  fs::create_symlink(place.at("secret.txt"), place.at("inside/link"));
  fs::create_directory_symlink(place.path(), place.at("inside/up"));
  const Folder folder(place.at("inside"));
  const io::Confinement confinement(folder.root());
  EXPECT_EQ(folder.resolve("a/b.toml"), folder.root() / "a/b.toml");
  for (const std::string path : {"", "/etc/passwd", "../secret.txt", "a/../../secret.txt", "..", ".", "./a", ".hidden",
                                 "a/.git/config", "link", "up/secret.txt", "a\\..\\b", "a\nb"}) {
    EXPECT_NE(rejection([&] { (void)folder.resolve(path); }), "") << path;
  }
  EXPECT_NE(rejection([&] { (void)folder.resolve(std::string(2000, 'a')); }), "");
  EXPECT_NE(rejection([&] { (void)folder.resolve(std::string_view("a\0b", 3)); }), "");
}

TEST(Folder, ReadsAndWritesWholeTexts) {
  const test::Folder place;
  const Folder folder(place.path());
  const fs::path path = folder.resolve("new/deep/a.toml");
  Folder::write(path, "a = 1\n");
  EXPECT_EQ(Folder::read(path), "a = 1\n");
  EXPECT_NE(Folder::tag_of("a"), Folder::tag_of("b"));
  Folder::write(path, "");
  EXPECT_EQ(Folder::read(path), "");
  EXPECT_NE(rejection([&] { (void)Folder(place.at("none")); }).find("no such folder"), std::string::npos);
}

}  // namespace folder_test
}  // namespace robomill::serve
