#include <array>
#include <charconv>
#include <cstddef>

#include "robomill/base/units.hpp"
#include "robomill/io/system/append.hpp"
#include "robomill/path/files/trajectory_parts.hpp"

namespace robomill::path {
namespace {

class Csv final : public SampleFile {
 public:
  Csv(const std::filesystem::path& path, const TrajectoryInfo& info) : joints_(info.joints), text_(path) { begin(); }

  void restart() override {
    text_.restart();
    begin();
  }

  void add(std::span<const Sample> samples) override {
    for (const Sample& sample : samples) row(sample);
  }

  io::PendingFile& finish() override { return text_.finish(); }

 private:
  void begin() {
    fmt::memory_buffer& out = text_.buffer();
    io::append(out, "time_s");
    for (int joint = 1; joint <= joints_; ++joint) io::append(out, ",q{}", joint);
    io::append(out, ",x_mm,y_mm,z_mm,i,j,k,block\n");
  }

  /// The shortest digits that read back as the same number: what was checked is what is in the file.
  void row(const Sample& sample) {
    put(sample.time_s, ',');
    for (int joint = 0; joint < joints_; ++joint) put(sample.joints[joint], ',');
    for (int axis = 0; axis < 3; ++axis) put(sample.tip_m[axis] / units::mm, ',');
    for (int axis = 0; axis < 3; ++axis) put(sample.axis[axis], ',');
    put(sample.block + 1, '\n');
    text_.drain();
  }

  template <class Number>
  void put(Number value, char after) {
    std::array<char, 32> digits{};
    char* const end = std::to_chars(digits.data(), digits.data() + digits.size() - 1, value).ptr;
    *end = after;
    text_.buffer().append(digits.data(), end + 1);
  }

  int joints_;
  PendingText text_;
};

}  // namespace

std::unique_ptr<SampleFile> open_trajectory_csv(const std::filesystem::path& path, const TrajectoryInfo& info) {
  return std::make_unique<Csv>(path, info);
}

}  // namespace robomill::path
