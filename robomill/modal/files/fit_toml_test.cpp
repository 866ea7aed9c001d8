#include "robomill/modal/files/fit_toml.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "testing/support.hpp"

namespace robomill::modal {
namespace fit_toml_test {

FitOptions read_fit_options(const io::TomlSource& source) {
  std::vector<std::string> notes;
  return modal::read_fit_options(source, notes);
}

TEST(FitToml, ReadsMethodBandAndNumbers) {
  const test::Folder folder;
  const FitOptions o = read_fit_options(folder.file(
      "modes.toml",
      "[fit]\nmethod = \"lscf\"\nweighting = \"relative\"\nband_hz = [500, 3500]\nmodes = 6\nstable_mac = 0.9\n"));
  EXPECT_EQ(o.method, FitMethod::lscf);
  EXPECT_EQ(o.weighting, Weighting::relative);
  EXPECT_EQ(o.band_low_hz, 500.0);
  EXPECT_EQ(o.band_high_hz, 3500.0);
  EXPECT_EQ(o.modes, 6);
  EXPECT_EQ(o.stable_mac, 0.9);
}

TEST(FitToml, ReadsEveryNumberOfTheSwarm) {
  const test::Folder folder;
  const FitOptions o = read_fit_options(
      folder.file("modes.toml",
                  "[fit]\nmethod = \"pso\"\npso_particles = 40\npso_max_iterations = 80\npso_inertia_start = 0.8\n"
                  "pso_inertia_end = 0.3\npso_inertia_iterations = 70\npso_cognitive = 1.5\npso_social = 1.6\n"
                  "pso_velocity_fraction = 0\npso_max_damping_ratio = 1\npso_frequency_half_width = 0.2\n"));
  EXPECT_EQ(o.pso_particles, 40);
  EXPECT_EQ(o.pso_max_iterations, 80);
  EXPECT_EQ(o.pso_inertia_start, 0.8);
  EXPECT_EQ(o.pso_inertia_end, 0.3);
  EXPECT_EQ(o.pso_inertia_iterations, 70);
  EXPECT_EQ(o.pso_cognitive, 1.5);
  EXPECT_EQ(o.pso_social, 1.6);
  EXPECT_EQ(o.pso_velocity_fraction, 0.0);
  EXPECT_EQ(o.pso_max_damping_ratio, 1.0);
  EXPECT_EQ(o.pso_frequency_half_width, 0.2);
}

TEST(FitToml, RejectsInTheFilesWords) {
  const test::Folder folder;
  const auto say = [&](const char* text) {
    return test::rejection([&] { static_cast<void>(read_fit_options(folder.file("modes.toml", text))); });
  };
  EXPECT_NE(say("[fit]\nmax_damping_ratio = -1\n").find("modes.toml:2: fit.max_damping_ratio = -1"), std::string::npos);
  EXPECT_NE(say("[fit]\nband_hz = [3, 2]\n").find("low < high"), std::string::npos);
  EXPECT_NE(say("[fit]\nmethod = \"magic\"\n").find("\"hybrid\""), std::string::npos);
  EXPECT_NE(say("[fit]\npso_inertia_start = 0.3\n").find("pso_inertia_end"), std::string::npos);
  EXPECT_NE(say("[fit]\npso_cognitive = 200\n").find("pso_cognitive = 200"), std::string::npos);
  EXPECT_NE(say("[fit]\npso_social = 200\n").find("pso_social = 200"), std::string::npos);
  EXPECT_NE(say("[fit]\npso_velocity_fraction = 2\n").find("pso_velocity_fraction = 2"), std::string::npos);
  EXPECT_NE(say("[fit]\nmods = 3\n").find("modes"), std::string::npos);
}

}  // namespace fit_toml_test
}  // namespace robomill::modal
