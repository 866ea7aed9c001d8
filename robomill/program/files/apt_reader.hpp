#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/program/files/program_arc.hpp"
#include "robomill/program/files/program_reader.hpp"

namespace robomill::program {

/// Reads cutter location files in APT; program_files.hpp says what of them.
class AptReader final : public ProgramReader {
 public:
  using ProgramReader::ProgramReader;

  /// A feed as a statement says it.
  struct FeedRate {
    double value = 0.0;  ///< a minute or a revolution; 0: none yet
    bool inches = false, per_revolution = false;
    friend bool operator==(const FeedRate&, const FeedRate&) = default;
  };
  /// What the blocks of a statement are.
  enum class Made : std::uint8_t {
    straight,  ///< one straight move, or none
    arc,       ///< chords
    moves      ///< several moves that the statement's numbers alone do not say: a hole, a retract
  };
  /// What holds after the lines that have been taken.
  struct Modes {
    bool inches = false;
    double feed = 0.0;  ///< a minute or a revolution; 0: none yet
    bool feed_in_inches = false, feed_per_revolution = false;
    double speed_rad_per_s = 0.0;
    Spindle spindle = Spindle::not_given;
    std::optional<FeedRate> cycle_feed = {};         ///< of a drilling cycle that is on
    std::optional<Eigen::Vector3d> plain_axis = {};  ///< of positions without an axis; none: as it stands
    bool moved_frame = false;                        ///< positions do not count in W
    Made made = Made::straight;                      ///< by the last statement
    bool passes = false;                             ///< the last statement is in a part of a tool that is not chosen
  };
  [[nodiscard]] Modes modes() const;

  [[nodiscard]] Part part_of(std::string_view line, char ahead, bool continued) const override;

 private:
  using Take = void (AptReader::*)();
  struct Statement {
    std::string_view word;
    Take take;
  };
  static const std::vector<Statement>& statements();

  void read(std::string_view statement) override;
  bool advance() override;
  /// Whether a statement moves a tool that is not chosen, and so counts for nothing.
  bool pass_over();
  void at_end() override;

  void split(std::string_view statement);
  [[nodiscard]] double number_of(std::string_view field) const;
  /// All numbers of the statement, those in brackets and behind minor words too.
  [[nodiscard]] std::vector<double> all_numbers() const;
  /// The statement's fields as numbers, so many as one of the counts.
  void take_numbers(std::size_t few, std::size_t many);
  /// … of GOTO: a position, its axis, and what some systems write behind it.
  void take_position();
  [[nodiscard]] Eigen::Vector3d position_of_numbers() const;
  [[nodiscard]] Pose pose_of_numbers();
  void go(const Pose& end);
  void go_straight(const Pose& end, bool rapid);
  [[nodiscard]] double feed_duration_s(const FeedRate& feed, double length_m, double turn_rad) const;
  /// Some tool has a position, be it one that is not chosen.
  [[nodiscard]] bool begun() const { return start_ || tools_.moved(); }
  /// Another tool than the one that has cut moves: from here on tools alone are looked at.
  bool is_second_tool();
  void mount();
  void begin_cutting();
  /// What a program takes for granted, each named with the line where it comes first.
  enum class Once : std::uint8_t {
    numbers,
    rapid_in_cycle,
    systems,
    points,
    start_height,
    return_height,
    cycle_end,
    compensation,
    turned_over,
    last  ///< how many
  };
  void assume_once(Once what, Assumption assumption);
  void skip_statement() { skip(shown_); }
  [[noreturn]] void reject_motion() const;
  [[noreturn]] void reject_start(const char* what) const;
  [[nodiscard]] double unit_m() const;
  [[nodiscard]] const char* unit_name() const { return inches_ ? "in" : "mm"; }
  [[nodiscard]] bool is_word(std::size_t field) const;

  void take_goto();
  void take_godlta();
  void take_from();
  void take_rapid() { rapid_ = true; }
  void take_feed();
  void take_units();
  void take_mode();
  void take_spindle();
  void take_coolant();
  void take_stop();
  void take_tool();
  void take_load();
  void take_tool_path();
  void take_delay();
  void take_tracut();
  void take_compensation();
  void take_end() { ended_ = true; }
  void take_known() {}

  // apt/frames.cpp
  struct Frame {
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
    friend bool operator==(const Frame& a, const Frame& b) {
      return a.rotation == b.rotation && a.origin_m == b.origin_m;
    }
  };
  void take_system();
  void take_setup_system();
  void take_transformation();
  void take_matrix_comment();
  /// Table, head and origin: noted where they move nothing.
  void take_shift();
  [[nodiscard]] Frame frame_of(const Eigen::Vector3d& x, const Eigen::Vector3d& y,
                               const Eigen::Vector3d& origin_m) const;
  void take_clearance();
  void take_retract();
  void take_home();
  /// Whether GOHOME says where it is.
  [[nodiscard]] bool gives_home() const;
  void lose();
  /// A rapid after a position that was not known: up, across, down.
  void come_back(const Pose& end);
  /// A rapid into a setup that has turned the part over, about the setup's X.
  void turn_over(const Pose& end);

  // apt/arcs.cpp
  /// The circle that the next position ends an arc of.
  struct Circle {
    Eigen::Vector3d center_m = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::UnitZ();
    std::optional<double> radius_m = {};
    std::optional<double> angle_rad = {};  ///< of the arc; it tells the sense of rotation where the normal may not
    double turns = 1.0;
    bool has_points = false;  ///< several positions may follow that lie on it
    double swept_rad = 0.0;   ///< so far
  };
  /// An arc whose chords are being made.
  struct Round {
    Block::Kind kind = Block::Kind::feed;
    Arc arc;
    Pose begin, end;
    double count = 0.0, next = 0.0, duration_s = 0.0;  ///< the time of one chord
  };
  void take_circle();
  void take_arc();
  void take_direction();
  void take_curve();
  [[nodiscard]] Circle circle_of(const Eigen::Vector3d& center, const Eigen::Vector3d& normal) const;
  void go_round(Circle circle, const Pose& end, bool rapid);
  void choose_sense(const Circle& circle, Arc& arc, const Pose& end) const;
  void check_radii(const Circle& circle, const Arc& arc) const;
  [[nodiscard]] bool is_on(const Circle& circle, const Eigen::Vector3d& tip_m) const;
  void begin_chords(const Arc& arc, const Pose& end, bool rapid);

  // apt/cycles.cpp
  struct Cycle {
    bool on = false;
    std::string name = {};
    std::size_t line = 0;  ///< of its statement
    Drilling how = {};
    bool taps = false;
    double depth_m = 0.0;
    std::optional<double> start_m = {}, return_m = {};  ///< above the hole
    bool returns_to_start = false;
    std::optional<FeedRate> feed = {};                    ///< none: FEDRAT's
    Eigen::Vector3d initial_m = Eigen::Vector3d::Zero();  ///< where the tool was
    bool has_initial = false;
  };
  /// The words of a cycle's statement.
  struct CycleWords {
    std::vector<double> plain = {};  ///< numbers without a word before them
    std::vector<double> steps = {};
    std::optional<double> depth, rapto, clear, back, feed, threads_per_inch;
    bool back_to_start = false;
    std::string_view unit = {};
  };
  void take_cycle();
  void end_cycle();
  void choose_cycle(std::string_view name);
  [[nodiscard]] CycleWords read_cycle_words();
  /// Takes the word at field i and its number. @returns the field behind them
  std::size_t take_cycle_word(std::size_t i, CycleWords& words);
  void set_cycle(const CycleWords& words);
  void set_cycle_feed(const CycleWords& words);
  void drill(const Pose& hole);
  [[nodiscard]] DrilledHole hole_of(const Pose& hole);
  /// Before FEDRAT: a cycle without CYCLE/OFF may end here.
  void feed_in_cycle(const FeedRate& feed);

  std::string text_;                      ///< of the statement: capitals without blanks
  std::string shown_;                     ///< as messages show it
  std::string_view word_;                 ///< before the slash
  std::vector<std::string_view> fields_;  ///< behind it
  std::vector<double> numbers_;

  bool inches_ = false, rapid_ = false;
  FeedRate feed_;
  std::string loaded_, path_tool_;    ///< as LOADTL names it, and as TOOL PATH does
  std::string tool_, cutting_tool_;   ///< both; the one of the moves at feed
  std::string tool_word_ = "LOADTL";  ///< of the statement that mounted it
  std::size_t tool_line_ = 0;
  std::size_t compensation_line_ = 0;  ///< of a CUTCOM behind which nothing has moved yet
  std::string second_tool_word_;
  std::string passed_switch_;  ///< of tools that are not chosen: a cycle that is on
  std::size_t second_tool_line_ = 0, second_move_line_ = 0;
  bool cutting_ = false;  ///< a move at feed has come
  Made made_ = Made::straight;
  std::array<bool, static_cast<std::size_t>(Once::last)> assumed_ = {};

  std::string system_;                      ///< the coordinate system's statement, where its numbers are not known
  std::optional<Frame> base_system_;        ///< of the first MSYS: W
  std::optional<Eigen::Vector3d> setup_x_;  ///< of the last CSYS
  std::optional<Frame> setup_system_;       ///< of the first CSYS
  std::string transformation_;              ///< the statement TRNTYP
  bool setup_turned_ = false;               ///< the tool's axis of the setup is not Z
  std::optional<Frame> frame_;              ///< of the positions in W; none: W
  std::optional<Eigen::Vector3d> plain_axis_;
  bool plain_axis_stays_ = false;  ///< … behind positions that give theirs
  std::vector<std::string> matrix_rows_, first_matrix_rows_;
  bool in_matrix_ = false;
  struct Plane {
    Eigen::Vector3d normal;
    double offset_m;
  };
  std::optional<Plane> clearance_;
  double highest_m_ = 0.0;
  std::size_t lost_line_ = 0;  ///< of the statement after which the position is not known; 0: it is
  std::string lost_word_;

  std::optional<Circle> circle_;       ///< that the next position ends
  std::optional<Circle> last_circle_;  ///< that the next position may go on along
  std::optional<Eigen::Vector3d> direction_;
  Round round_;

  Cycle cycle_;
  bool to_start_ = false;                  ///< CYCLE/CLEAR
  std::size_t cycle_cut_line_ = 0;         ///< of the FEDRAT that has ended a cycle
  std::size_t moved_since_cut_line_ = 0;   ///< of the first move behind it
  std::optional<Eigen::Vector3d> lift_m_;  ///< where the cycle goes back to at its end
};

}  // namespace robomill::program
