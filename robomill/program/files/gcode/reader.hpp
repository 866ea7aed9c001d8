#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "robomill/program/files/gcode/codes.hpp"
#include "robomill/program/files/gcode/words.hpp"
#include "robomill/program/files/program_arc.hpp"
#include "robomill/program/files/program_reader.hpp"

namespace robomill::program {

/// Reads G-code; gcode.hpp says what of it.
class GcodeReader final : public ProgramReader {
 public:
  using ProgramReader::ProgramReader;
  GcodeReader(const GcodeReader&) = default;

  enum class Motion : std::uint8_t { none, rapid, feed, clockwise, counterclockwise };
  enum class FeedMode : std::uint8_t { per_minute, inverse_time };
  /// What holds after the lines that have been taken.
  struct Modes {
    Motion motion = Motion::none;
    FeedMode feed_mode = FeedMode::per_minute;
    bool inches = false, incremental = false, centers_absolute = false;
    bool feed_in_inches = false;
    std::optional<double> feed = {};                       ///< under G94, a minute
    Eigen::Vector3d rotary_deg = Eigen::Vector3d::Zero();  ///< A, B, C
  };
  [[nodiscard]] Modes modes() const;

  [[nodiscard]] Part part_of(std::string_view line, char ahead, bool continued) const override;

 private:
  /// The plane of arcs: its axes turn from first to second; normal is the third.
  struct Plane {
    Eigen::Index first = 0, second = 1, normal = 2;
    const char* centers = "I, J";  ///< words of its centre
    const char* name = "G17";
  };

  /// What one line says.
  struct Line {
    std::array<std::optional<double>, 3> position = {};  ///< X, Y, Z in the program's unit
    std::array<std::optional<double>, 3> rotary = {};    ///< A, B, C [deg]
    std::array<std::optional<double>, 3> vector = {};    ///< I, J, K: the tool's axis, or an arc's centre
    std::optional<double> feed = {}, radius = {};
    std::optional<GcodeWords::Word> p = {};
    std::uint32_t groups = 0;   ///< modal groups that a G code has named
    std::uint32_t letters = 0;  ///< that have come
    std::optional<double> tool = {}, h = {};
    std::optional<GcodeWords::Word> length = {};  ///< the code of the tool's length
    std::optional<GcodeWords::Word> center_point = {};
    OperatorStop stop = OperatorStop::none;
    bool dwells = false, tool_change = false, begins_again = false, scaling_off = false;
    std::string left_out = {};
    [[nodiscard]] bool has(char letter) const;
    [[nodiscard]] bool moves() const;
    void leave_out(const GcodeWords::Word& word);
  };

  /// A move that is made into blocks of equal time: an arc, a straight move of turning axes, or both.
  struct PartedMove {
    Block::Kind kind = Block::Kind::feed;
    std::optional<Arc> arc = {};  ///< none: a line
    Eigen::Vector3d begin_m = Eigen::Vector3d::Zero(), end_m = Eigen::Vector3d::Zero();
    std::optional<RotaryMove> turn = {};  ///< none: the axis stays
    Deviation deviation = {.tip_m = 0.0, .axis_rad = 0.0};
    double duration_s = 0.0;  ///< of one block
    double count = 0.0, next = 0.0;
    [[nodiscard]] Eigen::Vector3d tip_at(double share) const;
  };

  void read(std::string_view statement) override;
  bool advance() override;

  void take_word(const GcodeWords::Word& word, Line& line);
  void take_g(const GcodeWords::Word& word, Line& line);
  /// Whether the code sets a mode that is read here.
  bool set_mode(int code, const GcodeWords::Word& word, Line& line);
  void claim(GcodeGroup group, const GcodeWords::Word& word, Line& line) const;
  void choose_system(int code, const GcodeWords::Word& word);
  void take_feed(const Line& line);
  void wait(const Line& line);
  [[nodiscard]] Eigen::Vector3d position_after(const Line& line);
  [[nodiscard]] Eigen::Vector3d axis_after(const Line& line);
  [[nodiscard]] Eigen::Vector3d axis_of_vector(const Line& line) const;
  void turn_rotary(const Line& line);
  /// The turn of A, B and C from where they stood to where they stand now.
  [[nodiscard]] RotaryMove turn_from(const Eigen::Vector3d& rotary_before_deg) const;
  /// @throws InvalidInput where the shortest way is not the one that the words say
  void check_shortest(const RotaryMove& turn) const;
  [[nodiscard]] double feed_duration_s(const Line& line, double length_m, double turn_deg) const;
  [[nodiscard]] double unit_m() const;
  [[nodiscard]] const char* unit_name() const { return inches_ ? "in" : "mm"; }
  void go(const Line& line);
  void go_straight(const Line& line);
  /// Begins to make blocks of a move whose kind, ends, arc and turn are set.
  /// @param field  named where they would be too many
  void split(PartedMove parted, double duration_s, const char* field);

  // gcode_machine.cpp
  void take_m(const GcodeWords::Word& word, Line& line);
  void set_up(const Line& line);
  void set_length(const GcodeWords::Word& word, const Line& line);
  /// @throws InvalidInput where the line's positions do not mean what those of the first move at feed meant
  void check_setup(const Line& line) const;
  void begin_cutting();

  void go_round(const Line& line);  // gcode_arcs.cpp
  [[nodiscard]] Eigen::Vector2d center_of_words(const Line& line, const Eigen::Vector2d& from) const;
  [[nodiscard]] Eigen::Vector2d center_of_radius(const Line& line, const Eigen::Vector2d& from,
                                                 const Eigen::Vector2d& to) const;
  [[nodiscard]] double allowed_radius_error_m(double radius_m) const;
  [[nodiscard]] Arc arc_to(const Line& line, const Eigen::Vector3d& end_m) const;
  [[nodiscard]] double turns_of(const Line& line) const;

  GcodeWords words_;
  bool begun_ = false;  ///< a line that is not empty has come

  Motion motion_ = Motion::none;
  FeedMode feed_mode_ = FeedMode::per_minute;
  bool inches_ = false, incremental_ = false, centers_absolute_ = false;
  Plane plane_;
  int system_ = 0;              ///< coordinate system named so far; 0: none
  std::optional<double> feed_;  ///< under G94, in the unit of the line that said it per minute
  bool feed_in_inches_ = false;

  std::array<bool, 3> known_ = {};  ///< X, Y, Z
  Eigen::Vector3d rotary_deg_ = Eigen::Vector3d::Zero();
  bool by_rotary_ = false, by_vector_ = false;  ///< how this program gives its axis

  /// What the positions rest on, and which line said so last; 0: none.
  template <class T>
  struct Said {
    T value = {};
    std::size_t line = 0;
    std::string code = {};
  };
  enum class CenterPoint { not_said, on, on_by_length, off };
  std::optional<double> prepared_tool_;
  Said<std::optional<double>> tool_;    ///< that M6 has mounted; −1: without a T
  Said<std::optional<double>> length_;  ///< H of G43; none: off. The tool's own counts as −1
  Said<CenterPoint> center_point_;
  bool cutting_ = false;  ///< a move at feed has come
  std::optional<double> cutting_tool_, cutting_length_;

  std::optional<Spindle> spindle_after_;  ///< of the line that was read last
  std::optional<Coolant> coolant_after_;
  OperatorStop stop_after_ = OperatorStop::none;

  PartedMove parted_;
};

}  // namespace robomill::program
