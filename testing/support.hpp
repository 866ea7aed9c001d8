#pragma once
// What the tests of every stage share.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

#include "robomill/base/error.hpp"

namespace robomill::test {

/// A folder of one test's own, gone with it.
class Folder {
 public:
  Folder() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string(test->test_suite_name()) + "_" + test->name() + "_" + std::to_string(::getpid());
    for (char& letter : name) {
      if (letter == '/') letter = '_';
    }
    path_ = std::filesystem::temp_directory_path() / name;
    std::filesystem::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path at(const std::string& name) const { return path_ / name; }
  /// Of files and folders in it.
  [[nodiscard]] std::size_t count() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(path_), std::filesystem::directory_iterator()));
  }
  /// Writes a file and returns its path.
  std::filesystem::path file(const std::string& name, std::string_view content) const {
    std::ofstream(at(name), std::ios::binary).write(content.data(), static_cast<std::streamsize>(content.size()));
    return at(name);
  }

 private:
  std::filesystem::path path_;
};

/// Files of this process can grow to so many bytes while it lives: a write beyond fails, as on a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(std::size_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int);
};

/// What the InvalidInput that f throws says; fails the test where it throws none.
template <class F>
std::string rejection(F&& f) {
  try {
    f();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  ADD_FAILURE() << "threw no InvalidInput";
  return {};
}

/// The field that the InvalidInput which f throws names, or "accepted" where it throws none.
template <class F>
std::string field_of(F&& f) {
  try {
    f();
  } catch (const InvalidInput& error) {
    return error.parts().field;
  }
  return "accepted";
}

/// Seeds of a heavy property: a tenth of them unless ROBOMILL_FULL=1; ROBOMILL_SEEDS=n asks for n, by hand.
inline int seeds(int all) {
  if (const char* asked = std::getenv("ROBOMILL_SEEDS")) return std::atoi(asked);
  const char* full = std::getenv("ROBOMILL_FULL");
  return full != nullptr && std::string_view(full) == "1" ? all : all / 10;
}

}  // namespace robomill::test
