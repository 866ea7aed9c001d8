#pragma once
#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/program/files/gcode/reader.hpp"
#include "robomill/program/files/gcode/words.hpp"
#include "robomill/program/files/rewrite/rewriter.hpp"

namespace robomill::program {

/// Rewrites G-code.
class GcodeRewriter final : public Rewriter {
 public:
  explicit GcodeRewriter(const RewriteJob& job);

 private:
  using Motion = GcodeReader::Motion;
  using Modes = GcodeReader::Modes;
  static constexpr int rotary_decimals = 6;  ///< of a degree: within 1e-8 rad

  struct Word {
    char letter = 0;  ///< lower case
    double number = 0.0;
    std::string_view text;                       ///< without blanks
    std::size_t begin = 0, digits = 0, end = 0;  ///< of the program's text: letter, number, and behind
    bool broken = false;                         ///< runs over two lines
  };

  ProgramReader& in() override { return in_; }
  ProgramReader& out() override { return *out_; }
  void note(Statement& statement) override;
  Composed compose(std::size_t index) override;
  [[nodiscard]] std::string comment(std::string_view text) const override;
  [[nodiscard]] std::size_t header_place() const override { return header_place_; }
  [[nodiscard]] double turn_deg(std::size_t index) const override;

  void scan(const Statement& statement);
  [[nodiscard]] const Word* find(char letter) const;
  [[nodiscard]] const Word* find_g(double least, double most) const;
  [[nodiscard]] bool moves() const;
  [[nodiscard]] Modes modes_before(std::size_t index) const { return index == 0 ? Modes{} : modes_[index - 1]; }
  [[nodiscard]] std::string word_text(char letter, std::string_view number) const;
  void set_number(const Statement& statement, const Word& word, std::string number, Composed& composed) const;
  void remove(const Statement& statement, const Word& word, Composed& composed) const;
  void add(char letter, std::string_view number, Composed& composed) const;
  void add_axis(char letter, std::string_view number, Composed& composed) const;
  void add_first(char letter, std::string_view number, Composed& composed) const;

  /// A move of one block or of several, said by one line as it was.
  void compose_kept(std::size_t index, const Move& move, Composed& composed) const;
  void set_motion(std::size_t index, Composed& composed) const;
  /// Where the tip is then.
  Eigen::Vector3d set_ends(std::size_t index, const Move& move, Composed& composed) const;
  void set_centers(std::size_t index, const Eigen::Vector3d& offset_m, Composed& composed) const;
  void set_speed(std::size_t index, Composed& composed) const;
  void set_feed(std::size_t index, const Motions& motions, Composed& composed) const;
  void set_inverse_time(std::size_t index, Composed& composed) const;
  void set_feed_for_later(std::size_t index, Composed& composed) const;
  /// What a modal F asks for [mm or deg a minute].
  [[nodiscard]] static double per_minute(double feed, bool inches, bool degrees);
  /// @param word  whose number it replaces; null: a new one's
  [[nodiscard]] std::string feed_text(double per_minute, bool inches, bool degrees, const Word* word) const;

  /// A line of another tool: it stays, and what it takes over is said again before the first of them.
  [[nodiscard]] Composed compose_passed(std::size_t index) const;
  /// A line whose words of positions are no ends of its move.
  [[nodiscard]] Composed compose_special(std::size_t index) const;
  /// @throws InvalidInput where the moves of a drilling cycle ask for several feeds
  void check_cycle_feed(const Statement& statement) const;
  Composed compose_parted(std::size_t index, const Move& move);
  /// Whether one line can say where the tips of a move's parts end.
  [[nodiscard]] bool parts_fit(const Statement& statement, const Move& move) const;
  /// Whether a line, taken by a machine that stands where the new text does, is what is wanted.
  [[nodiscard]] bool reads_well(const Statement& statement, Composed& composed) const;

  // rewrite_gcode_axes.cpp
  /// A and C, B and C; else I, J, K.
  [[nodiscard]] bool by_rotary() const { return !by_vector_ && job().reading.machine.has_value(); }
  /// Whether the rotary axes stand where those of the program as read stood before a statement.
  [[nodiscard]] bool stand_as_read(std::size_t index) const;
  /// Whether a statement's tool axes, or where the rotary axes stand, are not those as read.
  [[nodiscard]] bool axes_changed(std::size_t index) const;
  /// Where the rotary axes stand at the end of a statement.
  [[nodiscard]] Eigen::Vector3d rotary_goal_deg(std::size_t index, const Move& move) const;
  [[nodiscard]] Eigen::Vector3d nearest_deg(const Eigen::Vector3d& axis, const Eigen::Vector3d& from_deg) const;
  /// @throws InvalidInput where the program says no axes
  void check_says_axis(const Statement& statement) const;
  /// By how much the line turns, as a feed counts it [deg].
  double set_axis(std::size_t index, const Move& move, Composed& composed) const;
  double set_rotary(std::size_t index, const Move& move, Composed& composed) const;
  double set_vector(std::size_t index, const Move& move, Composed& composed) const;
  /// What one line of a move says: some of a wanted block.
  struct Piece {
    std::size_t block = 0;
    double begin = 0.0, end = 1.0;  ///< shares of it
    Eigen::Vector3d rotary_deg;     ///< at its end
  };
  /// The pieces of which each is one block for the machine. Where the rotary axes stand is left behind the last.
  void add_pieces(std::size_t block, Eigen::Vector3d& rotary_deg, std::vector<Piece>& out) const;
  [[nodiscard]] std::vector<Piece> pieces_of(std::size_t index, const Move& move) const;

  // rewrite_gcode_split.cpp
  /// What holds from one of the lines of a split move to the next.
  struct Running {
    Eigen::Vector3d tip_m, axis, rotary_deg;
    double speed_rad_per_s = 0.0;
    std::optional<double> feed = {};
    bool feed_in_inches = false;
  };
  /// One of the lines of a split move: the first is the program's, with edits, the others are new.
  struct SplitLine {
    bool first = false, last = false;
    std::string text;
  };
  /// Says a move by a line for each of its pieces.
  [[nodiscard]] Composed split(std::size_t index, const std::vector<Piece>& pieces) const;
  void say(const Statement& statement, char letter, const std::string& number, SplitLine& line,
           Composed& composed) const;
  void split_tip(std::size_t index, const Piece& piece, Running& running, Composed& composed, SplitLine& line) const;
  /// By how much the line turns [deg].
  double split_axis(std::size_t index, const Piece& piece, Running& running, Composed& composed, SplitLine& line) const;
  void split_rates(std::size_t index, const Piece& piece, const Motions& motions, Running& running, Composed& composed,
                   SplitLine& line) const;
  [[nodiscard]] std::string take_late_codes(const Statement& statement, Composed& composed) const;

  ProgramRemarks remarks_{0};
  GcodeReader in_;
  std::unique_ptr<GcodeReader> out_;
  std::vector<Modes> modes_;  ///< after each statement
  bool by_vector_ = false;    ///< the program says its axes by I, J and K
  std::size_t header_place_ = 0;
  bool in_head_ = true;

  GcodeWords scanned_;
  std::vector<std::size_t> places_;
  std::vector<Word> words_;  ///< of the statement scanned last
};

}  // namespace robomill::program
