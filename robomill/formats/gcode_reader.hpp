#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/formats/gcode_words.hpp"
#include "robomill/program/machine.hpp"
#include "robomill/program/program.hpp"

namespace robomill::formats {

/// Turns lines of G-code into blocks, one after another; what it holds does not grow with the program, except for what
/// it skips, which a caller may take away. What is read: gcode.hpp.
class GcodeReader {
 public:
  /// @param file  its name, for errors
  GcodeReader(std::string file, std::optional<program::Machine> machine);

  /// The move that the next line makes, if it makes one. @throws InvalidInput as read_gcode
  std::optional<program::Block> next(std::string_view line);
  /// Where the first block begins; empty until X, Y and Z are known.
  [[nodiscard]] const std::optional<program::Pose>& start() const { return start_; }
  /// M2 or M30 came: what follows is not carried out.
  [[nodiscard]] bool ended() const { return ended_; }
  [[nodiscard]] std::vector<program::Skipped>& skipped() { return skipped_; }

 private:
  enum class Motion { none, rapid, feed };
  enum class FeedMode { per_minute, inverse_time };

  /// What one line says.
  struct Line {
    std::array<std::optional<double>, 3> position = {};  ///< X, Y, Z in the program's unit
    std::array<std::optional<double>, 3> rotary = {};    ///< A, B, C [deg]
    std::array<std::optional<double>, 3> axis = {};      ///< I, J, K
    std::optional<double> feed = {};
    std::uint32_t groups = 0;   ///< modal groups that a G code has named
    std::uint32_t letters = 0;  ///< that have come
    bool dwells = false;
    std::string left_out = {};
    [[nodiscard]] bool moves() const;
    void leave_out(const GcodeWords::Word& word);
  };

  [[noreturn]] void refuse(std::string field, std::optional<double> number, const char* unit, std::string rule,
                           std::string hint = {}) const;
  void take(const GcodeWords::Word& word, Line& line);
  void take_g(const GcodeWords::Word& word, Line& line);
  void choose_system(int code, const GcodeWords::Word& word);
  void take_feed(const Line& line);
  [[nodiscard]] Eigen::Vector3d position_after(const Line& line);
  [[nodiscard]] Eigen::Vector3d axis_after(const Line& line);
  [[nodiscard]] Eigen::Vector3d axis_of_words(const Line& line) const;
  [[nodiscard]] double duration_s(const Line& line, const program::Pose& end, double rotary_change_deg) const;
  std::optional<program::Block> move(const Line& line);

  std::string file_;
  std::optional<program::Machine> machine_;
  GcodeWords words_;
  std::size_t line_ = 0;
  bool ended_ = false;

  Motion motion_ = Motion::none;
  FeedMode feed_mode_ = FeedMode::per_minute;
  bool inches_ = false, incremental_ = false;
  int system_ = 0;              ///< coordinate system named so far; 0: none
  std::optional<double> feed_;  ///< under G94, in the unit of the line that said it per minute
  bool feed_in_inches_ = false;
  double spindle_speed_rad_per_s_ = 0.0;

  std::array<bool, 3> known_ = {};  ///< X, Y, Z
  program::Pose pose_;
  Eigen::Vector3d rotary_deg_ = Eigen::Vector3d::Zero();
  bool by_rotary_ = false, by_vector_ = false;  ///< how this program gives its axis
  std::optional<program::Pose> start_;
  std::vector<program::Skipped> skipped_;
};

}  // namespace robomill::formats
