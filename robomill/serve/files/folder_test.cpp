#include "robomill/serve/files/folder.hpp"

#include <gtest/gtest.h>

#include "robomill/io/confinement.hpp"
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
  for (const FolderFile& file : folder.list(left_out)) seen += file.path + "=" + file.kind + " ";
  EXPECT_EQ(seen,
            "a/b/tap.wav=record a/cell.toml=cell forces.toml=forces job.toml=job lobes.toml=lobes modes.json=modes "
            "part.ngc=program tip.csv=frf ");
  EXPECT_EQ(left_out, 0u);
  EXPECT_EQ(folder.list(left_out, 3).size(), 3u);
  EXPECT_EQ(left_out, 5u);
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
