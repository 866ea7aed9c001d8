#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robomill/program/files/gcode/calls.hpp"
#include "robomill/program/files/gcode/codes.hpp"
#include "robomill/program/files/gcode/words.hpp"
#include "robomill/program/files/gcode/work_frames.hpp"
#include "robomill/program/files/program_arc.hpp"
#include "robomill/program/files/program_reader.hpp"

namespace robomill::program {

/// What holds, and which line of G-code said so last; 0: none. Outside of the reader: of a member clang 14 finds no
/// copy assignment of std::optional<Said>.
template <class T>
struct Said {
  T value = {};
  std::size_t line = 0;
  std::string code = {};
};

/// Reads G-code; gcode.hpp says what of it.
class GcodeReader final : public ProgramReader {
 public:
  /// @throws InvalidInput where a work frame of the reading has no code of one
  GcodeReader(std::string file, const ProgramReading& reading, ProgramRemarks& remarks);
  GcodeReader(const GcodeReader&) = default;

  enum class Motion : std::uint8_t { none, rapid, feed, clockwise, counterclockwise, cycle };
  enum class FeedMode : std::uint8_t { per_minute, inverse_time };
  /// What holds after the lines that have been taken.
  struct Modes {
    Motion motion = Motion::none;
    FeedMode feed_mode = FeedMode::per_minute;
    bool inches = false, incremental = false, centers_absolute = false;
    bool feed_in_inches = false;
    std::optional<double> feed = {};                       ///< under G94, a minute
    Eigen::Vector3d rotary_deg = Eigen::Vector3d::Zero();  ///< A, B, C
    Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();    ///< where X0 Y0 Z0 lies in W
    double speed_rad_per_s = 0.0;
    bool passes = false;   ///< the last line is in a part of a tool that is not chosen
    bool special = false;  ///< the last line's words of positions are no ends of its move, or it makes no move of them
  };
  [[nodiscard]] Modes modes() const;

  /// Whether T alone changes the tool: the program has T words and no M6.
  [[nodiscard]] static bool changes_tool_by_t(ProgramLines lines, const std::string& file);
  /// … where a tool is chosen; else T prepares what M6 mounts.
  void set_changes_tool_by_t() { by_t_ = true; }
  /// Whoever takes calls has the lines of the file; else lines that call are rejected.
  void allow_calls() { calls_allowed_ = true; }
  /// How many calls deep the next line is.
  void set_depth(std::size_t depth) { depth_ = depth; }
  /// What the last line calls.
  [[nodiscard]] std::optional<GcodeCall> take_call() { return std::exchange(call_, std::nullopt); }
  /// The next line is in the definition of a subprogram, which is not carried out.
  [[nodiscard]] bool leaves_out_sub() const { return !leaves_out_sub_.empty(); }
  /// Whether the last line ends its subprogram.
  [[nodiscard]] bool take_return() { return std::exchange(returns_, false); }

  [[nodiscard]] Part part_of(std::string_view line, char ahead, bool continued) const override;

 private:
  /// The plane of arcs: its axes turn from first to second; normal is the third.
  struct Plane {
    Eigen::Index first = 0, second = 1, normal = 2;
    const char* centers = "I, J";  ///< words of its centre
    const char* name = "G17";
  };

  /// What a line does with its words of positions in place of a move.
  enum class Special : std::uint8_t {
    none,
    home,         ///< G28, G30: by a point to the machine's own position
    machine,      ///< G53
    local,        ///< G52
    turned,       ///< G68
    tilted,       ///< G68.2
    along_plane,  ///< G53.1
    shift,        ///< G92
    shift_reset,  ///< G92.1, G92.2
    table,        ///< G10
    noted         ///< a look-ahead or smoothing mode, whose words are no positions
  };

  /// What one line says.
  struct Line {
    std::array<std::optional<double>, 3> position = {};  ///< X, Y, Z in the program's unit
    std::array<std::optional<double>, 3> rotary = {};    ///< A, B, C [deg]
    std::array<std::optional<double>, 3> vector = {};    ///< I, J, K: the tool's axis, or an arc's centre
    std::optional<double> feed = {}, radius = {}, e = {};
    std::optional<GcodeWords::Word> p = {}, q = {}, l = {};
    Special special = Special::none;
    std::optional<GcodeWords::Word> special_code = {}, call = {}, cycle = {}, system = {}, other_unit = {}, corner = {};
    std::uint32_t groups = 0;   ///< modal groups that a G code has named
    std::uint32_t letters = 0;  ///< that have come
    std::optional<double> tool = {}, h = {};
    std::optional<GcodeWords::Word> length = {};  ///< the code of the tool's length
    std::optional<GcodeWords::Word> center_point = {};
    OperatorStop stop = OperatorStop::none;
    bool dwells = false, tool_change = false, begins_again = false, scaling_off = false, cycle_off = false,
         frame_off = false;
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

  /// A corner between the move to it, which waits, and the next one.
  struct Corner {
    std::size_t line = 0;
    std::string name = {};  ///< ",R" or ",C"
    double size_m = 0.0;
    Eigen::Vector3d at_m = Eigen::Vector3d::Zero();
    Eigen::Index normal = 2;  ///< of its plane
    double s_per_m = 0.0;     ///< at the feed of its line
    MoveStep::Running running = {};
  };

  /// Axes that words of positions count along, while they are not those of the work frame.
  struct Tilted {
    std::size_t line = 0;
    std::string code = {};
    bool plane = false;                                  ///< a plane in space that the tool can be turned to
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< in the work frame's, in columns
    Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();  ///< from that of the work frame, along its axes
  };

  /// What the positions rest on that is no more what it was at the first move at feed.
  struct Change {
    std::size_t line = 0;
    std::string code = {}, what = {}, hint = {};
    bool other_tool = false;
  };

  void read(std::string_view statement) override;
  void at_end() override;
  bool advance() override;
  /// Of a line without words.
  void read_wordless();
  void carry_out(Line& line);
  void carry_out_part(Line& line);
  /// Modes, frames and the tool's axis alone.
  void pass_over(const Line& line);
  /// @throws InvalidInput where words of a line do not go together
  void check_line(const Line& line) const;
  void leave_out_rest(Line& line) const;

  void take_word(const GcodeWords::Word& word, Line& line);
  void take_g(const GcodeWords::Word& word, Line& line);
  /// Whether the code sets a mode that is read here.
  bool set_mode(int code, const GcodeWords::Word& word, Line& line);
  /// … or a frame, or makes the line's words others than a move's.
  bool set_frame(int code, const GcodeWords::Word& word, Line& line);
  void claim(GcodeGroup group, const GcodeWords::Word& word, Line& line) const;
  void make_special(Special special, const GcodeWords::Word& word, Line& line) const;
  /// @throws InvalidInput unless a noted mode's words are its own
  void check_noted(const Line& line) const;
  /// Looks at how positions are written. @throws InvalidInput where that has two meanings
  void check_points(const Line& line);
  void take_feed(const Line& line);
  void wait(const Line& line);
  /// A dwell's P. Whole numbers of `least_ms` or more without a point are milliseconds.
  [[nodiscard]] double seconds_of(const GcodeWords::Word& p, double least_ms);
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

  // frames.cpp
  void choose_system(const Line& line);
  [[nodiscard]] bool is_frame_number(const Line& line) const;
  /// The offsets of the frame in use; empty where nothing gives them.
  [[nodiscard]] std::optional<Eigen::Vector3d> offsets_m() const;
  /// W from here on: the frame in use. Where other tools begin in another one, and the offsets of both are known, that
  /// one.
  void choose_base();
  /// Where X0 Y0 Z0 lies in W; empty where that is not known.
  [[nodiscard]] std::optional<Eigen::Vector3d> origin_m() const;
  void set_local(const Line& line);
  void shift(const Line& line);
  void reset_shift(const Line& line);
  void set_table(const Line& line);
  void go_home(const Line& line);
  void go_to_machine(const Line& line);
  /// The tool's position in an axis is not known from here on.
  void lose(std::size_t axis, const std::string& code);
  /// Where positions of the line do not mean what those of the cuts so far mean: rejected at feed, else left out.
  [[nodiscard]] bool is_elsewhere(const Line& line);
  /// Why origin_m is not known.
  [[nodiscard]] Change frame_change() const;
  /// A rapid after positions that were not known: up, across, down.
  void come_back(const Pose& end);
  [[nodiscard]] const char* unknown_axis() const;
  [[noreturn]] void reject_unknown(const char* axis) const;

  // planes.cpp
  /// @throws InvalidInput where a line cannot turn or tilt a plane
  void check_may_tilt(const Line& line) const;
  /// … or would change the work frame beneath one.
  void check_frame_stays(const Line& line) const;
  void tilt(const Line& line);
  void turn_plane(const Line& line);
  void end_tilt();
  void change_axes(const std::optional<Tilted>& to);
  /// A position along an axis of the machine is not known from here on.
  void lose_machine_axis(std::size_t axis);
  void turn_to_plane(const Line& line);
  /// A point of W as the words of positions count while a plane is turned, and back; else the same.
  [[nodiscard]] Eigen::Vector3d in_program(const Eigen::Vector3d& point_m) const;
  [[nodiscard]] Eigen::Vector3d out_of_program(const Eigen::Vector3d& point_m) const;
  [[nodiscard]] Eigen::Vector3d turned(const Eigen::Vector3d& vector) const;

  // corners.cpp
  void take_corner(const GcodeWords::Word& word, Line& line);
  [[noreturn]] void reject_no_begin(const GcodeWords::Word& corner) const;
  [[noreturn]] void reject_corner(std::string rule, std::string hint) const;
  /// @throws InvalidInput where a corner stands or waits beside what is no straight move
  void check_corner(const Line& line) const;
  /// A vector's components in the plane of arcs, and back.
  [[nodiscard]] Eigen::Vector2d in_plane(const Eigen::Vector3d& vector) const;
  [[nodiscard]] Eigen::Vector3d out_of_plane(const Eigen::Vector2d& vector) const;
  /// A straight move with a corner at its end or its begin.
  void go_by_corner(const Line& line, const Eigen::Vector3d& end_m);
  /// The move to the corner that waits, and the corner.
  void cut_corner(const Eigen::Vector3d& next_m);

  // cycles.cpp
  void choose_cycle(int code, const GcodeWords::Word& word, Line& line);
  void update_cycle(const Line& line);
  void drill(const Line& line);
  /// @param hole_m  X and Y
  void drill_hole(const Eigen::Vector3d& hole_m, const Line& line);
  [[nodiscard]] std::size_t repeats_of(const Line& line) const;

  // calls.cpp
  void call_program(const Line& line);
  void control(const OWord& word);

  // tools.cpp and machine.cpp
  void take_m(const GcodeWords::Word& word, Line& line);
  void set_up(const Line& line);
  void set_length(const GcodeWords::Word& word, const Line& line);
  [[nodiscard]] std::optional<Change> setup_change(const Line& line) const;
  [[nodiscard]] bool center_point_lost(const Line& line) const;
  [[noreturn]] void reject_change(const Change& change) const;
  void mount(double number, const char* code);
  void name_tool(double number);
  void list_tools(std::string_view statement);
  void begin_cutting();

  void go_round(const Line& line);  // gcode_arcs.cpp
  [[nodiscard]] Eigen::Vector2d center_of_words(const Line& line, const Eigen::Vector2d& from) const;
  [[nodiscard]] Eigen::Vector2d center_of_radius(const Line& line, const Eigen::Vector2d& from,
                                                 const Eigen::Vector2d& to) const;
  /// LinuxCNC's.
  [[nodiscard]] double strict_radius_error_m(double radius_m) const;
  /// … or what the program's digits make.
  [[nodiscard]] double allowed_radius_error_m(double radius_m) const;
  /// Of an arc's radius where its line has so many decimals.
  [[nodiscard]] double rounding_m(int decimals) const;
  void note_rounding(const Arc& arc, double chord_m, double strict_m) const;
  [[nodiscard]] Arc arc_to(const Line& line, const Eigen::Vector3d& end_in_w_m) const;
  [[nodiscard]] double turns_of(const Line& line) const;

  GcodeWords words_;
  bool begun_ = false;  ///< a line that is not empty has come

  Motion motion_ = Motion::none;
  FeedMode feed_mode_ = FeedMode::per_minute;
  bool inches_ = false, incremental_ = false, centers_absolute_ = false;
  Plane plane_;
  std::optional<double> feed_;  ///< under G94, in the unit of the line that said it per minute
  bool feed_in_inches_ = false;

  std::array<bool, 3> known_ = {};  ///< X, Y, Z
  int decimals_ = 0;                ///< of a position's word, at most
  int fixed_decimals_ = 9;          ///< that each position's word of the line has; 9: not alike
  double highest_m_ = 0.0;          ///< that the tool was in W at the end of a line …
  bool highest_known_ = false;      ///< … if one has come
  Said<bool> lost_;                 ///< what made positions unknown
  std::optional<Pose> pending_;     ///< where it is as far as that is known, while no blocks come
  std::array<bool, 3> lost_rotary_ = {};
  bool special_ = false;  ///< Modes::special
  Eigen::Vector3d rotary_deg_ = Eigen::Vector3d::Zero();
  bool by_rotary_ = false, by_vector_ = false;  ///< how this program gives its axis

  Said<int> system_ = {.value = first_work_frame};  ///< the work frame in use, by its number
  std::optional<Said<int>> base_;                   ///< the one that W is: of the first position
  std::map<int, Eigen::Vector3d> tables_m_;         ///< offsets of the frames that are given
  std::set<int> given_tables_;                      ///< those of the reading that G10 L2 has not changed
  std::optional<Eigen::Vector3d> base_table_m_;     ///< of W, at the first position
  std::size_t base_moved_line_ = 0;                 ///< G10 L2 that gives W other offsets, while base_table_m_ is none
  Eigen::Vector3d local_m_ = Eigen::Vector3d::Zero(), shift_m_ = Eigen::Vector3d::Zero();
  bool shift_declared_ = false;  ///< G92 said where the tool stands, and no line before it
  Said<bool> shift_lost_;

  struct Cycle {
    int code = 0;  ///< in tenths; 0: none
    std::optional<double> r, z, q;
    double dwell_s = 0.0, initial_m = 0.0;
    double zero_m = 0.0;  ///< height of the frame that r and z were said in
    bool to_r = false;    ///< G99
  };
  Cycle cycle_;
  std::optional<Corner> corner_;
  std::optional<Tilted> tilted_;

  bool calls_allowed_ = false, returns_ = false;
  std::size_t depth_ = 0;
  std::optional<GcodeCall> call_;
  std::string leaves_out_sub_;  ///< its label, while its lines are passed
  std::size_t sub_line_ = 0;

  enum class CenterPoint { not_said, on, on_by_length, off };
  std::optional<double> prepared_tool_;
  Said<std::optional<double>> tool_;    ///< that M6 has mounted; −1: without a T
  Said<std::optional<double>> length_;  ///< H of G43; none: off. The tool's own counts as −1
  Said<CenterPoint> center_point_;
  bool cutting_ = false;  ///< a move at feed has come
  bool by_t_ = false;     ///< T mounts the tool
  bool m6_has_come_ = false;
  Said<std::optional<double>> named_, named_cutting_;  ///< by T, while no M6 has come; the one that cut first
  std::optional<Change> second_named_;                 ///< that cuts
  std::size_t second_named_line_ = 0;
  std::optional<Said<int>> passed_system_;         ///< of the first position that is not read …
  std::optional<Eigen::Vector3d> passed_table_m_;  ///< … and its offsets
  std::optional<Change> second_tool_;              ///< that cuts: from here on tools alone are looked at
  std::size_t second_tool_line_ = 0;
  std::optional<double> cutting_tool_, cutting_length_;

  std::optional<Spindle> spindle_after_;  ///< of the line that was read last
  std::optional<Coolant> coolant_after_;
  OperatorStop stop_after_ = OperatorStop::none;

  PartedMove parted_;
};

}  // namespace robomill::program
