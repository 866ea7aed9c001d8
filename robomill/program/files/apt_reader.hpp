#pragma once
#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/program/files/program_reader.hpp"

namespace robomill::program {

/// Reads cutter location files in APT; program_files.hpp says what of them.
class AptReader final : public ProgramReader {
 public:
  using ProgramReader::ProgramReader;

  /// What holds after the lines that have been taken.
  struct Modes {
    bool inches = false;
    double feed = 0.0;  ///< a minute or a revolution; 0: none yet
    bool feed_in_inches = false, feed_per_revolution = false;
    double speed_rad_per_s = 0.0;
    bool passes = false;  ///< the last statement is in a part of a tool that is not chosen
  };
  [[nodiscard]] Modes modes() const {
    return {.inches = inches_,
            .feed = feed_,
            .feed_in_inches = feed_in_inches_,
            .feed_per_revolution = feed_per_revolution_,
            .speed_rad_per_s = spindle_speed_rad_per_s_,
            .passes = passes()};
  }

  [[nodiscard]] Part part_of(std::string_view line, char ahead, bool continued) const override;

 private:
  using Take = void (AptReader::*)();
  struct Statement {
    std::string_view word;
    Take take;
  };
  static const std::vector<Statement>& statements();

  void read(std::string_view statement) override;
  /// Whether a statement moves a tool that is not chosen, and so counts for nothing.
  bool pass_over();
  void at_end() override;

  void split(std::string_view statement);
  [[nodiscard]] double number_of(std::string_view field) const;
  /// The statement's fields as numbers, so many as one of the counts.
  void take_numbers(std::size_t few, std::size_t many);
  [[nodiscard]] Eigen::Vector3d position_of_numbers() const;
  void go(const Pose& end);
  [[nodiscard]] double feed_duration_s(double length_m, double turn_rad) const;
  void skip_statement() { skip(shown_); }
  [[noreturn]] void reject_motion() const;
  [[nodiscard]] const char* unit_name() const { return inches_ ? "in" : "mm"; }

  void take_goto();
  void take_godlta();
  void take_from();
  void take_rapid() { rapid_ = true; }
  void take_feed();
  void take_units();
  void take_spindle();
  void take_coolant();
  void take_stop();
  void take_tool();
  void take_delay();
  void take_system();
  void take_switch();
  void take_end() { ended_ = true; }
  void take_known() {}

  std::string text_;                      ///< of the statement: capitals without blanks
  std::string shown_;                     ///< as messages show it
  std::string_view word_;                 ///< before the slash
  std::vector<std::string_view> fields_;  ///< behind it
  std::vector<double> numbers_;

  bool inches_ = false, rapid_ = false;
  double feed_ = 0.0;  ///< a minute or a revolution; 0: none yet
  bool feed_in_inches_ = false, feed_per_revolution_ = false;
  std::string tool_, cutting_tool_;  ///< as LOADTL names it; the one of the moves at feed
  std::size_t tool_line_ = 0;
  /// Of the first other tool that moves, and of its move: from here on tools alone are looked at.
  std::string passed_switch_;  ///< of those tools: a cycle or a compensation that is on
  std::size_t second_tool_line_ = 0, second_move_line_ = 0;
  bool cutting_ = false;  ///< a move at feed has come
  std::string system_;    ///< the coordinate system's statement
};

}  // namespace robomill::program
