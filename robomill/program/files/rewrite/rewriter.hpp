#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/program/files/program_reader.hpp"
#include "robomill/program/files/rewrite.hpp"
#include "robomill/program/files/rewrite/compare.hpp"

namespace robomill::program {

/// What is rewritten, and into what.
struct RewriteJob {
  std::string file;  ///< its name, for errors
  std::string_view text;
  const ProgramReading& reading;
  const Program& as_read;
  const Program& wanted;
};

/// A number without trailing zeros. @param point  a whole one ends with its point
[[nodiscard]] std::string decimal_text(double value, int decimals, bool point);
/// … of seven significant digits.
[[nodiscard]] std::string significant_text(double value, bool point);
/// Whether two speeds, feeds or times are the same for a program: within 1e-6.
[[nodiscard]] bool same_rate(double a, double b);

/// Rewrites a program statement by statement. A first pass finds the statements and which blocks each of them makes.
/// The second edits each; a second reader takes what was written, so that its modes and its position are those of the
/// machine that runs it.
class Rewriter {
 public:
  explicit Rewriter(const RewriteJob& job) : job_(job) {}
  virtual ~Rewriter() = default;
  Rewriter(const Rewriter&) = delete;
  Rewriter& operator=(const Rewriter&) = delete;
  Rewriter(Rewriter&&) = delete;
  Rewriter& operator=(Rewriter&&) = delete;

  struct Result {
    Rewritten rewritten;
    std::vector<std::size_t> origins;  ///< of each new line: the program's line that it comes from; 0: the header
    std::vector<ToolChoice> others;    ///< parts of the program that are not the one that was read
  };
  /// @throws InvalidInput as rewrite_program
  Result rewrite(const std::vector<std::string>& header);

 protected:
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

  struct Statement {
    std::size_t begin = 0, end = 0;  ///< bytes of the text, with line ends
    std::size_t line = 0;            ///< the first, from 1
    std::size_t first_block = 0, blocks = 0;
    bool starts = false;       ///< makes the program's start
    bool after_start = false;  ///< comes behind it
    // What the dialect notes:
    bool says_speed = false;
    bool says_feed = false;                        ///< that holds until another one does
    bool breaks_feed = false;                      ///< a feed said before means nothing from here on
    bool moves_at_feed = false;                    ///< by the feed that holds
    bool round = false;                            ///< an arc
    double per_minute = 0.0;                       ///< its feed as read [mm or deg]
    bool passes = false;                           ///< of a tool that was not read …
    bool takes_speed = false, takes_feed = false;  ///< … and runs by the speed and the feed that hold
    // What follows from those behind it:
    std::size_t speed_until = 0;  ///< the first block that another statement's speed holds for
    std::size_t feeds = none;     ///< the first statement that moves by the feed said here, where it does not itself
  };

  /// Of a statement's blocks that move.
  struct Move {
    std::size_t first = 0, count = 0;
    bool at_feed = false;
    Eigen::Vector3d begin_m, end_m, read_begin_m, read_end_m;  ///< wanted, and as read
    double way_m = 0.0, read_way_m = 0.0;                      ///< from end to end
    double time_s = 0.0, read_time_s = 0.0;
    /// The tip stands.
    [[nodiscard]] bool still() const { return way_m == 0.0 || (read_way_m == 0.0 && way_m <= 1e-10); }
  };

  struct Feed {
    double per_minute = 0.0;  ///< [mm or deg]
    bool degrees = false;
  };

  /// In place of bytes of the text.
  struct Edit {
    std::size_t begin = 0, end = 0;
    std::string text;
  };
  struct Composed {
    std::vector<Edit> edits = {};
    std::vector<std::string> before = {}, after = {};  ///< lines
  };

  /// How numbers of a kind are written.
  struct Digits {
    double unit = 1.0;  ///< of the program, in what is compared
    int decimals = 0;
    [[nodiscard]] double resolution() const;
  };
  /// How one coordinate or one angle comes where it is wanted.
  struct Coordinate {
    enum class Act { keep, write, drop };
    Act act = Act::keep;
    std::string text = {};
    double end = 0.0;  ///< where it is then
  };
  /// How the three components of a tool axis come where they are wanted.
  struct AxisNumbers {
    bool keep = true;
    std::array<std::string, 3> texts = {};
    Eigen::Vector3d written, axis;  ///< as they stand there then, and as they are read
  };

  [[nodiscard]] virtual ProgramReader& in() = 0;
  [[nodiscard]] virtual ProgramReader& out() = 0;
  /// Notes what the last statement says, when `in` has taken it.
  virtual void note(Statement& statement) = 0;
  [[nodiscard]] virtual Composed compose(std::size_t index) = 0;
  [[nodiscard]] virtual std::string comment(std::string_view text) const = 0;
  /// The statement that the header precedes.
  [[nodiscard]] virtual std::size_t header_place() const { return 0; }
  /// By how much the axis turns where the tip stands [deg].
  [[nodiscard]] virtual double turn_deg(std::size_t index) const;

  [[nodiscard]] const std::vector<Statement>& statements() const { return statements_; }
  [[nodiscard]] const RewriteJob& job() const { return job_; }
  [[nodiscard]] std::string_view raw(const Statement& statement) const {
    return job_.text.substr(statement.begin, statement.end - statement.begin);
  }
  /// The statement as its reader sees it, good until the next call.
  [[nodiscard]] std::string_view join(const Statement& statement);
  /// Where letters [begin, end) of what was joined last stand in the text; none where they run over two lines.
  [[nodiscard]] std::optional<std::size_t> place_of(std::size_t begin, std::size_t end) const;

  [[nodiscard]] Move move_of(const Statement& statement) const;
  /// What a statement as written moves.
  struct Motions {
    double way_m = 0.0;     ///< of the tip from end to end: one below the digits is none
    double turn_deg = 0.0;  ///< of the axis, as a feed counts it
    [[nodiscard]] bool stands() const { return way_m == 0.0; }
    /// The way that a feed counts. Digits that change a short one must not change the time in which the axis turns.
    [[nodiscard]] double counted_way_m(double wanted_way_m) const;
  };
  /// @param motions  none: not written yet
  [[nodiscard]] Feed needed_feed(std::size_t index, const std::optional<Motions>& motions = {}) const;
  /// The axis that is wanted where a statement ends: of its last move, of the start; else where the new text stands.
  [[nodiscard]] Eigen::Vector3d wanted_axis(const Statement& statement, const Move& move);
  /// The first block in [first, last) whose spindle speed counts; none where none does.
  [[nodiscard]] std::size_t first_turning(std::size_t first, std::size_t last) const;
  /// @throws InvalidInput where the parts of one move ask for several feeds
  void check_one_feed(const Statement& statement, const Move& move) const;
  /// … or its blocks for several speeds.
  void check_one_speed(const Statement& statement, const char* field) const;
  [[nodiscard]] double wanted_rpm(std::size_t block) const;

  /// Whether the part of the chosen tool ends before a statement.
  [[nodiscard]] bool leaves_part(std::size_t index) const;
  /// What the parts of other tools, from a statement on, take over from those before it.
  struct Carried {
    bool speed = false, feed = false;
  };
  [[nodiscard]] Carried carried_from(std::size_t index) const;
  /// @throws InvalidInput where the part before a statement ends elsewhere than as read
  void check_left_as_read(std::size_t index) const;
  /// Looks at how a position is written.
  void note_position(std::string_view number);
  /// Whether positions, feeds, speeds are written with a point where they are whole.
  struct Points {
    bool position = false, feed = false, speed = false;
  };
  Points points_;
  /// @param number  that stands in the program, if one does
  /// @param from    where the tip or the angle is
  /// @param step    the number counts from there
  /// @param stays   it must not change at all
  /// @param origin  the number counts from there where it is no step
  [[nodiscard]] Coordinate coordinate(std::optional<double> number, double target, double from, bool step,
                                      const Digits& digits, bool stays, double origin = 0.0) const;
  /// Of positions: 0.1 um, or as the program writes itself.
  [[nodiscard]] Digits position_digits(double unit_m) const;
  /// @param numbers  that stand in the statement, if they do
  /// @param target   unit vector
  [[nodiscard]] AxisNumbers axis_numbers(const std::optional<Eigen::Vector3d>& numbers,
                                         const Eigen::Vector3d& target) const;
  /// The texts of numbers that are read as the very same numbers.
  [[nodiscard]] static std::array<std::string, 3> exact_texts(const Eigen::Vector3d& numbers);

  /// In what the text of a statement, taken by a reader, is not what is wanted; empty where it is.
  [[nodiscard]] std::string read_back(ProgramReader& reader, std::string_view piece, const Statement& statement) const;
  [[nodiscard]] std::string assemble(const Statement& statement, Composed& composed) const;
  [[noreturn]] void reject(std::size_t line, std::string field, std::string rule, std::string hint = {}) const;

 private:
  struct Segment {
    std::size_t joined, text, length;
  };
  void read_statements();
  void check_read(std::size_t index, const Block& block) const;
  void look_ahead();
  void write(std::size_t index, Result& result);
  void write_header(const std::vector<std::string>& header, Result& result) const;

  const RewriteJob job_;
  std::vector<Statement> statements_;
  std::size_t head_ = 0;  ///< bytes before the first line: a byte order mark
  std::string_view line_end_ = "\n";
  std::string joined_;
  std::vector<Segment> segments_;
  int position_decimals_ = 0;
  bool whole_positions_ = false;  ///< written without a point
};

[[nodiscard]] std::unique_ptr<Rewriter> make_gcode_rewriter(const RewriteJob& job);
[[nodiscard]] std::unique_ptr<Rewriter> make_apt_rewriter(const RewriteJob& job);
[[nodiscard]] std::unique_ptr<Rewriter> make_csv_rewriter(const RewriteJob& job);

}  // namespace robomill::program
