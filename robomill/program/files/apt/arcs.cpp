// The arcs of an AptReader.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/io/text.hpp"
#include "robomill/program/files/apt_reader.hpp"

namespace robomill::program {
namespace {

using Eigen::Vector3d;

constexpr double whole_turn = 2.0 * std::numbers::pi;
constexpr const char* known_circles = "Known are CIRCLE/ with 6, 7 or 11 numbers: centre, axis, radius, …";

Vector3d three(const std::vector<double>& numbers, std::size_t first) {
  return {numbers[first], numbers[first + 1], numbers[first + 2]};
}

/// The numbers between a minor word and the bracket behind it; empty where they do not stand there.
std::vector<double> numbers_in(std::string_view text, std::string_view word) {
  std::vector<double> out;
  const std::size_t at = text.find(word);
  if (at == std::string_view::npos) return out;
  text.remove_prefix(at + word.size());
  text = text.substr(0, text.find(')'));
  while (true) {
    const std::size_t comma = text.find(',');
    const std::optional<double> number = io::parse_number(text.substr(0, comma));
    if (number && std::isfinite(*number)) {
      out.push_back(*number);
    } else if (text.substr(0, comma) != "CANON") {
      return {};
    }
    if (comma == std::string_view::npos) return out;
    text.remove_prefix(comma + 1);
  }
}

}  // namespace

AptReader::Circle AptReader::circle_of(const Vector3d& center, const Vector3d& normal) const {
  Circle circle = {.center_m = center * unit_m(), .normal = unit_axis("axis of the arc", normal)};
  for (Eigen::Index i = 0; i < 3; ++i) check_coordinate("centre", circle.center_m[i], center[i], unit_name());
  if (frame_) {
    circle.center_m = (frame_->rotation * circle.center_m + frame_->origin_m).eval();
    circle.normal = (frame_->rotation * circle.normal).eval();
  }
  return circle;
}

// SolidWorks CAM (6 numbers) and Creo (7) turn counterclockwise about the axis that they give, NX (11) clockwise.
void AptReader::take_circle() {
  if (circle_) reject_text("CIRCLE", shown_, "follows another CIRCLE/ without a position between them");
  double turns = 1.0;
  if (fields_.size() > 2 && fields_[fields_.size() - 2] == "TIMES") {
    turns = number_of(fields_.back());
    constexpr double most_turns = 1000.0;
    if (!(turns >= 1.0 && turns <= most_turns && turns == std::round(turns))) {
      reject("TIMES", turns, "", "must be a whole number of turns from 1 to 1000");
    }
    fields_.resize(fields_.size() - 2);
  }
  numbers_.clear();
  for (const std::string_view field : fields_) numbers_.push_back(number_of(field));
  const std::size_t count = numbers_.size();
  if (count != 6 && count != 7 && count != 11) {
    reject("CIRCLE", std::nullopt, "", fmt::format("has {} numbers; must have 6, 7 or 11", count), known_circles);
  }
  circle_ = circle_of(three(numbers_, 0), three(numbers_, 3));
  if (count == 11) circle_->normal = -circle_->normal;
  circle_->has_points = count == 7;
  circle_->turns = turns;
  if (count > 6) circle_->radius_m = numbers_[6] * unit_m();
}

// MOVARC/x,y,z,i,j,k,r,ANGLE,a and MOVARC/CENTER,x,y,z,AXIS,i,j,k,RADIUS,r
void AptReader::take_arc() {
  if (circle_) reject_text("MOVARC", shown_, "follows another arc without a position between them");
  const bool by_words =
      fields_.size() == 10 && fields_[0] == "CENTER" && fields_[4] == "AXIS" && fields_[8] == "RADIUS";
  const bool by_angle = fields_.size() == 9 && fields_[7] == "ANGLE";
  if (!by_words && !by_angle) {
    reject_text("MOVARC", shown_, "is not read", "Known are MOVARC/x,y,z,i,j,k,r,ANGLE,a and MOVARC/CENTER,…,AXIS,…");
  }
  numbers_.clear();
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    if (!is_word(i)) numbers_.push_back(number_of(fields_[i]));
  }
  if (numbers_.size() != (by_words ? 7U : 8U)) reject_text("MOVARC", shown_, "has a word in place of a number");
  circle_ = circle_of(three(numbers_, 0), three(numbers_, 3));
  circle_->radius_m = numbers_[6] * unit_m();
  if (by_angle) circle_->angle_rad = numbers_[7] * units::deg;
}

// Where the next curve goes.
void AptReader::take_direction() {
  take_numbers(3, 3);
  Vector3d direction = three(numbers_, 0);
  if (word_ == "INDIRP") {
    direction = direction * unit_m();
    if (frame_) direction = (frame_->rotation * direction + frame_->origin_m).eval();
    direction -= pose_.tip_m;
  } else if (frame_) {
    direction = (frame_->rotation * direction).eval();
  }
  if (!(direction.norm() > 0.0)) reject_text(std::string(word_), shown_, "has no direction");
  direction_ = direction.normalized();
}

// CATIA: TLON,GOFWD/(CIRCLE/x,y,z,r),ON,(LINE/x,y,z,x,y,z); the line goes from the centre to the end.
void AptReader::take_curve() {
  const std::vector<double> circle = numbers_in(text_, "(CIRCLE/");
  const std::vector<double> line = numbers_in(text_, "(LINE/");
  if ((circle.size() != 4 && circle.size() != 7) || line.size() != 6) {
    reject_text("TLON", shown_, "is not read: it may move the tool",
                "Known is TLON,GOFWD/(CIRCLE/x,y,z,r),ON,(LINE/x,y,z,x,y,z)");
  }
  if (!direction_) {
    reject_text("TLON", shown_, "has no direction before it", "Known is INDIRV/ before TLON,GOFWD/");
  }
  begin_part_move();
  if (lost_line_ > 0 && is_second_tool()) return;
  if (!start_ || lost_line_ > 0) reject_start("an arc");
  const bool rapid = std::exchange(rapid_, false);
  const Vector3d direction = *std::exchange(direction_, std::nullopt);
  const Vector3d normal = circle.size() == 7 ? three(circle, 3) : Vector3d(Vector3d::UnitZ());
  Circle round = circle_of(three(circle, 0), normal);
  round.radius_m = circle.back() * unit_m();
  numbers_ = {line[3], line[4], line[5]};
  Pose end = pose_of_numbers();
  // A circle stands for the cylinder about it, whose line gives no height.
  if (circle.size() == 4) end.tip_m += (pose_.tip_m - end.tip_m).dot(round.normal) * round.normal;
  const Vector3d ahead = round.normal.cross(pose_.tip_m - round.center_m);
  const double along = ahead.norm() > 0.0 ? ahead.normalized().dot(direction) : 0.0;
  constexpr double least = 0.1;
  if (std::abs(along) < least) {
    reject_text("TLON", shown_, "begins across its direction", "INDIRV/ is along the circle where the arc begins");
  }
  if (along < 0.0) round.normal = -round.normal;
  go_round(std::move(round), end, rapid);
}

bool AptReader::is_on(const Circle& circle, const Vector3d& tip_m) const {
  const auto radius_of = [&](const Vector3d& at) {
    const Vector3d way = at - circle.center_m;
    return (way - way.dot(circle.normal) * circle.normal).norm();
  };
  const double radius_m = radius_of(pose_.tip_m);
  const double rounding_m = arc_radius_error_m(0.0, inches_);
  return tip_m != pose_.tip_m && std::abs(radius_of(tip_m) - radius_m) <= rounding_m &&
         std::abs((tip_m - pose_.tip_m).dot(circle.normal)) <= rounding_m;
}

void AptReader::check_radii(const Circle& circle, const Arc& arc) const {
  const auto fits = [&](double a, double b) { return std::abs(a - b) <= arc_radius_error_m(a, inches_); };
  const double said_m = circle.radius_m.value_or(arc.begin_radius_m);
  if (!fits(arc.begin_radius_m, arc.end_radius_m) || !fits(arc.begin_radius_m, said_m)) {
    reject("CIRCLE", io::round_15(arc.begin_radius_m / unit_m()), unit_name(),
           fmt::format("is the arc's radius where it begins; at its end it is {:.9g}{}", arc.end_radius_m / unit_m(),
                       circle.radius_m ? fmt::format(", in the statement {:.9g}", said_m / unit_m()) : ""),
           "Is the position before it the arc's begin?");
  }
  constexpr double least_m = 1e-10;
  if (!(std::min(arc.begin_radius_m, arc.end_radius_m) > least_m)) {
    reject("CIRCLE", std::nullopt, "", "has its centre where the arc begins or ends: it has no radius");
  }
  if (!(arc.begin_radius_m <= farthest_m)) {
    reject("CIRCLE", std::nullopt, "", "gives an arc a radius above 1 km", "Is it meant to be a straight move?");
  }
}

// Some writers turn the axis for a clockwise arc and others do not: its angle tells.
void AptReader::choose_sense(const Circle& circle, Arc& arc, const Pose& end) const {
  if (!circle.angle_rad) return;
  constexpr double rounding_rad = 0.01;
  const auto fits = [&](double sweep_rad) { return std::abs(sweep_rad - std::abs(*circle.angle_rad)) <= rounding_rad; };
  const Arc other = arc_about(circle.center_m, -circle.normal, pose_.tip_m, end.tip_m);
  const bool this_fits = fits(arc.sweep_rad);
  const bool other_fits = fits(other.sweep_rad);
  if (!this_fits && !other_fits) {
    reject("ANGLE", io::round_15(*circle.angle_rad / units::deg), "deg",
           fmt::format("does not lead to the position behind it, which is {:.6g} or {:.6g} deg away",
                       arc.sweep_rad / units::deg, other.sweep_rad / units::deg));
  }
  if (other_fits && (!this_fits || *circle.angle_rad < 0.0)) arc = other;
}

void AptReader::go_round(Circle circle, const Pose& end, bool rapid) {
  if (!start_ || lost_line_ > 0) reject_start("an arc");
  if (cycle_.on) {
    reject("CIRCLE", std::nullopt, "", fmt::format("comes while CYCLE/{} of line {} is on", cycle_.name, cycle_.line),
           "Is a CYCLE/OFF missing?");
  }
  if (is_second_tool()) return;
  static_cast<void>(turn_to(end.axis));
  Arc arc = arc_about(circle.center_m, circle.normal, pose_.tip_m, end.tip_m);
  check_radii(circle, arc);
  choose_sense(circle, arc, end);
  if (circle.turns > 1.0) {
    if (arc.sweep_rad < whole_turn - 1e-6) {
      reject("TIMES", circle.turns, "", "is read for whole turns alone",
             "Let the CAM system write an arc for each turn");
    }
    arc.sweep_rad *= circle.turns;
  }
  constexpr double short_m = 1e-6;
  const double chord_m = (end.tip_m - pose_.tip_m - arc.rise_m).norm();
  if (chord_m > 1e-10 && chord_m <= short_m) {
    using Count = ProgramRemarks::Count;
    remarks_.count(arc.sweep_rad > std::numbers::pi ? Count::almost_whole : Count::almost_nothing, line_);
  }
  last_circle_.reset();
  if (circle.has_points) {
    if (circle.swept_rad > 0.0) {
      assume_once(Once::points,
                  {.what = fmt::format("Several positions on the circle of one CIRCLE/, from line {} on", line_),
                   .taken = "points of one arc, as Creo writes them",
                   .key = "a CIRCLE/ for each arc"});
    }
    circle.swept_rad += arc.sweep_rad;
    constexpr double rounding_rad = 0.01;
    if (circle.swept_rad > whole_turn + rounding_rad) {
      reject("CIRCLE", std::nullopt, "", "has points that run the other way round than its axis tells");
    }
    last_circle_ = circle;
  }
  made_ = Made::arc;
  highest_m_ = std::max({highest_m_, end.tip_m.z(),
                         arc.center_m.z() + arc.begin_radius_m * std::hypot(circle.normal.x(), circle.normal.y())});
  begin_chords(arc, end, rapid);
}

void AptReader::begin_chords(const Arc& arc, const Pose& end, bool rapid) {
  round_ = {.kind = rapid ? Block::Kind::rapid : Block::Kind::feed, .arc = arc, .begin = pose_, .end = end};
  round_.count = arc.chords(reading_.chord_tolerance_m);
  constexpr double most_parts = 1e6;
  if (!(round_.count <= most_parts)) {
    reject("CIRCLE", std::nullopt, "", fmt::format("would make a move of {:.3g} parts", round_.count),
           "Allow larger tolerances");
  }
  if (!rapid) {
    begin_cutting();
    round_.duration_s = feed_duration_s(feed_, arc.length_m(), 0.0) / round_.count;
  }
  ready_ = advance();
}

bool AptReader::advance() {
  if (!(round_.next < round_.count)) return take_step();
  const double share = (round_.next += 1.0) / round_.count;
  Pose at = round_.end;
  if (share < 1.0) {
    at = between(round_.begin, round_.end, share);
    at.tip_m = round_.arc.at(share);
    if (round_.begin.axis == round_.end.axis) at.axis = round_.end.axis;
  }
  move(round_.kind, at, round_.duration_s, {.tip_m = round_.arc.deviation_m(round_.count), .axis_rad = 0.0});
  return true;
}

}  // namespace robomill::program
