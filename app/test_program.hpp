#pragma once
// For tests: the program as a user runs it: a shell, files, exit codes.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <string>

#include "testing/processes.hpp"
#include "testing/support.hpp"

namespace robomill::app {

using test::slurp;

struct Ended {
  int exit = -1;
  std::string out, err;
};

/// Each test in a folder of its own.
class ProgramTest : public testing::Test {
 protected:
  Ended shell(const std::string& command) {
    const std::string full = "cd '" + folder_.path().string() + "' && { " + command + " ; } >out.txt 2>err.txt";
    const int status = std::system(full.c_str());  // NOLINT(cert-env33-c): a user's shell is what is tested
    return {.exit = WIFEXITED(status) ? WEXITSTATUS(status) : -1,
            .out = slurp(folder_.at("out.txt")),
            .err = slurp(folder_.at("err.txt"))};
  }
  Ended robomill(const std::string& arguments) { return shell("'" ROBOMILL_PROGRAM "' " + arguments); }
  void write(const std::string& name, const std::string& text) { folder_.file(name, text); }
  void write_lobes(const std::string& coefficients = "tangential_n_per_mm2 = 712\nradial_n_per_mm2 = 287\n",
                   const std::string& grid = "[20, 10]") {
    write("lobes.toml",
          "[tool]\nteeth = 3\ndiameter_mm = 12\n[cut]\ndirection = \"up\"\nradial_depth_mm = 1.8\n"
          "feed_per_tooth_mm = 0.01\n[coefficients]\n" +
              coefficients +
              "[dynamics]\nmodes = \"" ROBOMILL_SOURCE_DIR
              "/data/robot-modes.toml\"\n[lobes]\nspindle_speed_rpm = [6000, 9000]\naxial_depth_mm = [0, 3]\ngrid = " +
              grid + "\n");
  }

  test::Folder folder_;
};

}  // namespace robomill::app
