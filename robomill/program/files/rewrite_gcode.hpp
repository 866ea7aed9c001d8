#pragma once
#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/program/files/gcode_reader.hpp"
#include "robomill/program/files/gcode_words.hpp"
#include "robomill/program/files/rewriter.hpp"

namespace robomill::program {

/// Rewrites G-code.
class GcodeRewriter final : public Rewriter {
 public:
  explicit GcodeRewriter(const RewriteJob& job)
      : Rewriter(job),
        in_(job.file, job.reading, remarks_),
        out_(std::make_unique<GcodeReader>(job.file, job.reading, remarks_)) {}

 private:
  using Motion = GcodeReader::Motion;
  using Modes = GcodeReader::Modes;

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
  void set_feed(std::size_t index, bool stands, Composed& composed) const;
  void set_inverse_time(std::size_t index, Composed& composed) const;
  void set_feed_for_later(std::size_t index, Composed& composed) const;
  /// What a modal F asks for [mm or deg a minute].
  [[nodiscard]] static double per_minute(double feed, bool inches, bool degrees);
  /// @param word  whose number it replaces; null: a new one's
  [[nodiscard]] std::string feed_text(double per_minute, bool inches, bool degrees, const Word* word) const;

  Composed compose_parted(std::size_t index, const Move& move);
  /// Whether one line can say where the parts of a move end.
  [[nodiscard]] bool parts_fit(const Statement& statement, const Move& move) const;

  // rewrite_gcode_split.cpp
  /// What holds from one of the lines of a split move to the next.
  struct Running {
    Eigen::Vector3d tip_m, rotary_deg;
    double speed_rad_per_s = 0.0;
    std::optional<double> feed = {};
    bool feed_in_inches = false;
  };
  /// Says a move of several blocks by a line for each.
  [[nodiscard]] Composed split(std::size_t index, const Move& move) const;
  void split_axes(std::size_t index, const Move& move, std::size_t part, Running& running, Composed& composed,
                  std::string& line) const;
  void split_rates(std::size_t index, const Move& move, std::size_t part, double way_m, Running& running,
                   Composed& composed, std::string& line) const;
  [[nodiscard]] std::string take_late_codes(const Statement& statement, Composed& composed) const;

  ProgramRemarks remarks_{0};
  GcodeReader in_;
  std::unique_ptr<GcodeReader> out_;
  std::vector<Modes> modes_;  ///< after each statement
  std::size_t header_place_ = 0;
  bool in_head_ = true;

  GcodeWords scanned_;
  std::vector<std::size_t> places_;
  std::vector<Word> words_;  ///< of the statement scanned last
};

}  // namespace robomill::program
