#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/program/files/drilling.hpp"
#include "robomill/program/files/program_files.hpp"
#include "robomill/program/files/tool_parts.hpp"
#include "robomill/program/program.hpp"

namespace robomill::program {

/// What a reader left out, corrected or took for granted: reported once, however often the program is read again.
class ProgramRemarks {
 public:
  /// @param most  that are kept; the others are counted
  explicit ProgramRemarks(std::size_t most) : most_(most) {}

  /// What the next line says has been reported before.
  void repeat(bool repeated) { repeated_ = repeated; }
  void skip(std::size_t line, std::string_view what);
  /// @param error  |length - 1| of the axis
  void normalised(std::size_t line, double error);
  void long_dwell(std::size_t line, double seconds);
  void operator_stop(std::size_t line);
  /// A move at feed with rotary axes turned, where nothing has said that positions are those of the tip.
  void no_center_point(std::size_t line);
  /// A word of a position. Where some end in a point, "Z50.", others without one may count the smallest step.
  void coordinate(std::size_t line, std::string_view word, std::string_view unit);
  /// A word of a position that ends in a point, and one that is whole without it; both once the program has both.
  struct MixedPoints {
    std::size_t point_line = 0, whole_line = 0;
    std::string point_word = {}, whole_word = {};
  };
  [[nodiscard]] std::optional<MixedPoints> mixed_points() const;
  /// What a program's lines are counted for: a sentence each, with the first line.
  enum class Count : std::size_t {
    almost_whole,    ///< arcs that end within a rounding of their begin and go all the way round
    almost_nothing,  ///< … and do not
    rounded_radius,  ///< arcs whose radius a program's few decimals change
    deleted_block,   ///< lines with a slash
    lost_rapid,      ///< rapids where the tool's position is not known
    last             ///< how many
  };
  void count(Count what, std::size_t line, double value = 0.0);
  void assume(Assumption assumption);

  [[nodiscard]] std::vector<Skipped>& skipped() { return skipped_; }
  [[nodiscard]] std::size_t skipped_count() const { return skipped_count_; }
  [[nodiscard]] std::vector<std::string> notes() const;
  [[nodiscard]] std::vector<Assumption> assumed() const;

 private:
  struct Counted {
    std::size_t count = 0, first_line = 0;
    double most = 0.0;
    void add(std::size_t line, double value);
  };
  std::size_t most_;
  bool repeated_ = false;
  std::vector<Skipped> skipped_;
  std::size_t skipped_count_ = 0;
  Counted normalised_, long_dwells_, operator_stops_, no_center_point_;
  std::array<Counted, static_cast<std::size_t>(Count::last)> counts_ = {};
  std::vector<Assumption> assumed_;
  MixedPoints points_;  ///< the first of each; a line of 0: none. A whole number is not 0
  std::string whole_unit_;
};

/// Letters of a file as a message may show them: the first `most`, those that are not plain as \x1b.
[[nodiscard]] std::string printable(std::string_view text, std::size_t most);

/// Turns lines of a program into blocks, one after another; holds no more than the machine's state.
class ProgramReader {
 public:
  /// @param file     its name, for errors
  /// @param remarks  outlive the reader
  ProgramReader(std::string file, const ProgramReading& reading, ProgramRemarks& remarks);
  virtual ~ProgramReader() = default;
  ProgramReader& operator=(const ProgramReader&) = delete;
  ProgramReader& operator=(ProgramReader&&) = delete;

  /// Takes the next line, when the blocks of those before have been taken away.
  /// @param ahead  first letter of the line after it
  /// @throws InvalidInput as ProgramFile::next
  void take(std::string_view line, char ahead = '\n');
  /// The file has ended, or what follows is not carried out.
  void finish();
  /// The next line has this number.
  void go_on_at(std::size_t line) { count_ = line - 1; }
  /// The next block of the lines taken; false where they have no more.
  bool pop(Block& out);
  /// What follows is not carried out.
  [[nodiscard]] bool ended() const { return ended_; }
  /// Where the first block begins; empty until that is known.
  [[nodiscard]] const std::optional<Pose>& start() const { return start_; }
  /// Where the tool stands after the lines taken.
  [[nodiscard]] const Pose& pose() const { return pose_; }
  [[nodiscard]] double spindle_speed_rad_per_s() const { return spindle_speed_rad_per_s_; }
  /// The tools of the lines taken.
  [[nodiscard]] const ToolParts& tools() const { return tools_; }
  /// The statement of the line taken last goes on in the next one.
  [[nodiscard]] bool continued() const { return continued_; }

  struct Part {
    std::string_view text;   ///< what of a line counts
    bool continues = false;  ///< the statement goes on in the next line
  };
  /// @param ahead      first letter of the line after it
  /// @param continued  the line before it goes on in this one
  [[nodiscard]] virtual Part part_of(std::string_view line, char ahead, bool continued) const = 0;

  static constexpr double farthest_m = 1e3;  ///< of a coordinate or a radius

 protected:
  /// A reader that stands where the other one does.
  ProgramReader(const ProgramReader&) = default;

  /// Carries out a statement; calls begin_at, move or dwell at most once.
  virtual void read(std::string_view statement) = 0;
  /// The program has ended.
  virtual void at_end() {}
  /// Turns `block_` into the statement's next block; false where it has none.
  virtual bool advance() { return false; }

  [[noreturn]] void reject(std::string field, std::optional<double> number, const char* unit, std::string rule,
                           std::string hint = {}) const;
  /// The same with a value that is no number.
  [[noreturn]] void reject_text(std::string field, std::string_view value, std::string rule,
                                std::string hint = {}) const;
  /// @throws InvalidInput unless a coordinate lies within 1 km
  void check_coordinate(const char* name, double coordinate_m, double written, const char* unit) const;
  /// @throws InvalidInput unless a dwell lasts from 0 to a day
  void check_dwell(const char* name, double time_s, const char* hint = "") const;
  /// @throws InvalidInput unless a feed of any unit lies in [0, 1e9]
  void check_feed(const char* name, double feed) const;
  /// The direction that a program writes as a unit vector. @throws InvalidInput unless its length is about 1
  [[nodiscard]] Eigen::Vector3d unit_axis(const char* names, const Eigen::Vector3d& written) const;
  /// Angle by which the axis turns on the way to `end` [rad]. @throws InvalidInput if that is half a circle
  [[nodiscard]] double turn_to(const Eigen::Vector3d& axis) const;
  /// Of a part that is not read the pose alone is kept.
  void begin_at(const Pose& pose);
  [[nodiscard]] bool moves_to(const Pose& end) const;
  /// Of a straight move from the curve that it stands for.
  struct Deviation {
    double tip_m, axis_rad;
  };
  /// Makes a block from where the tool stands to `end`.
  void move(Block::Kind kind, const Pose& end, double duration_s,
            Deviation deviation = {.tip_m = 0.0, .axis_rad = 0.0});
  void dwell(double duration_s, OperatorStop operator_stop = OperatorStop::none);
  /// Begins to make blocks of `steps_`.
  void begin_steps();
  /// … of rapids up to a height, across with the turn of the axis, and down. @throws InvalidInput as turn_to
  void begin_return(const Pose& end, double height_m);
  /// Makes the next block of `steps_`; false where they have no more.
  bool take_step();
  void skip(std::string_view what) const {
    if (!passes()) remarks_.skip(line_, what);
  }
  /// What moves is of a tool that is not chosen.
  [[nodiscard]] bool passes() const { return tools_.passes(); }
  /// The chosen tool is mounted again behind moves of others: it may make no move more, and stands nowhere.
  [[nodiscard]] bool is_over() const { return tools_.between() != nullptr; }
  /// From this statement on. @param name  "T4"
  void mount_tool(std::optional<int> number, std::string name);
  /// The tool that is mounted moves. @throws InvalidInput where another one has moved since the chosen one did
  void begin_part_move();

  const std::string file_;
  const ProgramReading reading_;
  ProgramRemarks& remarks_;
  ToolParts tools_;
  std::size_t line_ = 0;  ///< where the statement begins
  bool ended_ = false;
  Pose pose_;  ///< where the tool stands
  std::optional<Pose> start_;
  double spindle_speed_rad_per_s_ = 0.0;
  Spindle spindle_ = Spindle::not_given;
  Coolant coolant_;
  Block block_;
  bool ready_ = false;           ///< block_ is to be taken away
  std::vector<MoveStep> steps_;  ///< of a statement that makes several moves

 private:
  void read_joined();
  void read_counted(std::string_view statement);
  /// @param lines  of the part that is over
  void note_passed(std::size_t lines) const;
  /// @throws InvalidInput where the chosen tool moves nothing
  void check_chosen() const;

  std::size_t next_step_ = 0;
  std::size_t count_ = 0;  ///< of lines
  bool continued_ = false;
  std::string joined_;  ///< of a statement over several lines
};

}  // namespace robomill::program
