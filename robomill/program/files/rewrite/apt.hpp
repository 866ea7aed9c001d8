#pragma once
#include <fmt/format.h>

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/program/files/apt_reader.hpp"
#include "robomill/program/files/rewrite/rewriter.hpp"

namespace robomill::program {

/// Rewrites APT/CL.
class AptRewriter final : public Rewriter {
 public:
  explicit AptRewriter(const RewriteJob& job)
      : Rewriter(job), in_(job.file, job.reading, remarks_), out_(job.file, job.reading, remarks_) {}

 private:
  struct Field {
    std::size_t begin = 0, end = 0;  ///< of what is joined, without blanks about it
    std::string text;                ///< capitals without blanks
  };
  /// How the program has written a feed or a speed, to be written so again.
  struct Template {
    std::string before, behind;  ///< the number
    bool inches = false, per_revolution = false, unit_said = false;
    Spindle direction = Spindle::clockwise;
  };

  ProgramReader& in() override { return in_; }
  ProgramReader& out() override { return out_; }
  void note(Statement& statement) override;
  Composed compose(std::size_t index) override;
  [[nodiscard]] std::string comment(std::string_view text) const override { return fmt::format("$$ {}", text); }

  /// A statement of another tool: it stays, and what it takes over is said again before the first of them.
  [[nodiscard]] Composed compose_passed(std::size_t index) const;
  void split(const Statement& statement);
  /// The one field that is a number; none where there is none, or several.
  [[nodiscard]] const Field* number_field() const;
  [[nodiscard]] bool says_speed() const;
  [[nodiscard]] double unit_m(std::size_t index) const { return modes_[index].inches ? units::inch : units::mm; }
  [[nodiscard]] std::size_t place_of_field(const Statement& statement, const Field& field) const;
  void set_field(const Statement& statement, const Field& field, std::string text, Composed& composed) const;
  [[nodiscard]] std::size_t count_numbers() const;
  void set_ends(std::size_t index, Composed& composed);
  void set_axis(std::size_t index, Composed& composed);
  /// @throws InvalidInput where no axis can be added to a statement that has none
  void check_says_axis(std::size_t line) const;
  void set_step(std::size_t index, Composed& composed);
  /// A step becomes the position and the axis that it comes to.
  void set_position(std::size_t index, const Eigen::Vector3d& axis, Composed& composed);
  void keep_template(std::size_t index, std::optional<Template>& kept) const;
  void set_said_feed(std::size_t index, Composed& composed);
  void set_said_speed(std::size_t index, Composed& composed);
  void add_speed(std::size_t index, Composed& composed);
  void add_feed(std::size_t index, Composed& composed);
  /// A line that says a speed as the program does; empty where none is needed.
  [[nodiscard]] std::string speed_line(const Statement& statement, std::size_t block, double held_rad_per_s) const;
  /// … that says a feed.
  [[nodiscard]] std::string feed_line(std::size_t index, const Feed& needed, AptReader::FeedRate& held,
                                      double rpm) const;
  /// A feed as a statement counts it: of a minute or a revolution, in its unit.
  [[nodiscard]] static double said(double per_minute, bool inches, bool degrees, bool per_revolution, double rpm);

  // rewrite/apt_moves.cpp
  /// What moves the tool in ways that a statement's numbers alone do not say stays where it is.
  void check_unmoved(std::size_t index, const char* what) const;
  [[nodiscard]] bool is_unmoved(std::size_t index) const;
  /// Whether the arc that a statement ends can stay one.
  [[nodiscard]] bool stays_round(std::size_t index) const;
  /// The statement that gives the circle of an arc, or its direction.
  void compose_opener(std::size_t index, Composed& composed);
  void compose_arc(std::size_t index, Composed& composed);
  /// An arc as straight moves.
  void set_chords(std::size_t index, Composed& composed);
  void comment_out(const Statement& statement, Composed& composed) const;
  [[nodiscard]] std::string chord_numbers(std::size_t index, const Pose& target, Pose& at) const;
  void set_last_chord(std::size_t index, const Pose& target, const Pose& at, Composed& composed);
  void compose_moves(std::size_t index, Composed& composed);
  /// The feed that a cycle needs for the hole of a statement; none: as it is read.
  [[nodiscard]] std::optional<double> needed_cycle_feed(std::size_t index) const;
  void set_said_cycle(std::size_t index, Composed& composed);
  /// The field of a cycle's feed. @throws InvalidInput where it is not said as one
  [[nodiscard]] const Field& cycle_feed_field(std::size_t index) const;

  ProgramRemarks remarks_{0};
  AptReader in_, out_;
  std::vector<AptReader::Modes> modes_;  ///< after each statement
  std::string word_;                     ///< of the statement split last
  std::vector<Field> fields_;
  std::string_view joined_text_;
  std::optional<Template> feed_template_, speed_template_;
  double speed_rad_per_s_ = 0.0;                     ///< that holds behind what has been composed
  bool says_axes_ = false;                           ///< some position comes with its axis
  std::optional<bool> multax_;                       ///< MULTAX is on; none: not said yet
  Eigen::Vector3d axis_ = Eigen::Vector3d::UnitZ();  ///< as written last behind what has been composed
  Motions motions_;                                  ///< of the statement composed last
  std::size_t last_opener_ = none, last_cycle_ = none;
  std::unordered_map<std::size_t, std::vector<std::size_t>> arcs_;  ///< the statements that end the arcs of an opener
  std::vector<std::size_t> openers_, cycles_;  ///< of each statement: what gives its circle, the cycle that is on
};

}  // namespace robomill::program
