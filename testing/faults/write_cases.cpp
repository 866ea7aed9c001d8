// The cases as folders with their inputs, for a robomill that is installed elsewhere: write_cases FOLDER
// Prints a line for each: its folder, the arguments that make an input (or nothing) and those of the case, between
// tabs.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>

#include "testing/faults/cases.hpp"

int main(int count, char** words) {
  using namespace robomill::faults;
  if (count != 2) {
    std::fprintf(stderr, "usage: write_cases FOLDER\n");
    return 2;
  }
  try {
    int number = 0;
    for (const Case& one : all_cases()) {
      const std::string name = std::to_string(++number);
      const std::filesystem::path folder = std::filesystem::path(words[1]) / name;
      std::filesystem::create_directories(folder);
      restore(folder, inputs_of(one));
      std::printf("%s\t%s\t%s\n", name.c_str(), one.make_inputs, one.arguments);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "write_cases: %s\n", error.what());
    return 1;
  }
}
