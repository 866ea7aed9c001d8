#pragma once
// A trajectory that is needed more than once, kept on disk: its memory does not grow with it.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <vector>

#include "robomill/path/sample.hpp"
#include "robomill/robot/inverse.hpp"

namespace robomill::path {

/// Joints and blocks of samples that are evenly spaced in time, in a file without a name.
class SampleSpool {
 public:
  struct Row {
    std::array<double, 6> joints = {};
    std::uint64_t block = 0;
    [[nodiscard]] robot::Position6 position() const { return Eigen::Map<const robot::Position6>(joints.data()); }
  };
  /// @param beside  the file is made in this path's folder and vanishes with the object, however the program ends
  /// @throws InvalidInput if it cannot be made
  explicit SampleSpool(const std::filesystem::path& beside);
  void clear();
  /// @throws InvalidInput if the disk is full
  void add(const Sample& sample);
  [[nodiscard]] std::size_t size() const { return size_; }
  /// Fast where the rows asked for are near each other. @throws InvalidInput if it cannot be read
  [[nodiscard]] Row row(std::size_t index);

 private:
  struct Close {
    void operator()(std::FILE* file) const noexcept { std::fclose(file); }
  };
  struct Chunk {
    std::size_t number = SIZE_MAX;
    std::vector<Row> rows = {};
  };
  [[noreturn]] void fail(const char* what) const;

  std::filesystem::path beside_;
  std::unique_ptr<std::FILE, Close> file_;
  std::size_t size_ = 0;
  bool writing_ = true;
  std::array<Chunk, 16> chunks_ = {};
};

}  // namespace robomill::path
