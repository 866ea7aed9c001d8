// The arcs of a GcodeReader, and the moves that it makes into several blocks.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/io/text.hpp"
#include "robomill/program/files/gcode/reader.hpp"

namespace robomill::program {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double same_place_m = 1e-10;

}  // namespace

void GcodeReader::go_round(const Line& line) {
  if (const char* const axis = unknown_axis()) reject_unknown(axis);
  if (pending_) reject_unknown("X, Y, Z");
  for (const char letter : {'l', 'q'}) {
    if (line.has(letter)) {
      reject(letter == 'l' ? "L" : "Q", std::nullopt, "", "is not read with an arc: what it would change is not known",
             "Turns are given by P");
    }
  }
  const Vector3d rotary_before_deg = rotary_deg_;
  PartedMove parted = {.begin_m = pose_.tip_m, .end_m = position_after(line)};
  parted.arc = arc_to(line, parted.end_m);
  if (line.rotary[0] || line.rotary[1] || line.rotary[2]) {
    by_rotary_ = true;
    if (by_vector_) {
      reject("A, B, C", std::nullopt, "", "stand in a program that gives its axis the other way as well",
             "Use A, B and C or I, J and K");
    }
    turn_rotary(line);
    parted.turn = turn_from(rotary_before_deg);
  }
  begin_cutting();
  const double turn_deg = (rotary_deg_ - rotary_before_deg).norm();
  const double duration_s = feed_duration_s(line, parted.arc->length_m(), turn_deg);
  split(std::move(parted), duration_s, plane_.centers);
}

Vector3d GcodeReader::PartedMove::tip_at(double share) const {
  if (share == 1.0) return end_m;
  return arc ? arc->at(share) : Vector3d(begin_m + share * (end_m - begin_m));
}

void GcodeReader::split(PartedMove parted, double duration_s, const char* field) {
  parted.count = 1.0;
  if (parted.arc) parted.count = parted.arc->chords(reading_.chord_tolerance_m);
  if (parted.turn) parted.count = std::max(parted.count, parted.turn->parts(reading_.axis_tolerance_rad));
  constexpr double most_parts = 1e6;
  if (!(parted.count <= most_parts)) {
    reject(field, std::nullopt, "", fmt::format("would make a move of {:.3g} parts", parted.count),
           "Allow larger tolerances");
  }
  if (parted.arc) parted.deviation.tip_m = parted.arc->deviation_m(parted.count);
  if (parted.turn) parted.deviation.axis_rad = parted.turn->deviation_rad(parted.count);
  parted.duration_s = duration_s / parted.count;
  parted_ = std::move(parted);
  ready_ = advance();
}

bool GcodeReader::advance() {
  if (!(parted_.next < parted_.count)) {
    if (take_step()) return true;
    if (stop_after_ == OperatorStop::none) return false;
    dwell(0.0, std::exchange(stop_after_, OperatorStop::none));
    return true;
  }
  const double share = (parted_.next += 1.0) / parted_.count;
  const Pose end = {.tip_m = parted_.tip_at(share), .axis = parted_.turn ? parted_.turn->axis_at(share) : pose_.axis};
  move(parted_.kind, end, parted_.duration_s, parted_.deviation);
  return true;
}

double GcodeReader::turns_of(const Line& line) const {
  if (!line.p) return 1.0;
  constexpr double most_turns = 1000.0;
  const double turns = line.p->number;
  if (!(turns >= 1.0 && turns <= most_turns && turns == std::round(turns))) {
    reject("P", turns, "", "must be a whole number of turns from 1 to 1000");
  }
  return turns;
}

double GcodeReader::strict_radius_error_m(double radius_m) const {
  return arc_radius_error_m(radius_m, inches_);
}

double GcodeReader::allowed_radius_error_m(double radius_m) const {
  // Two decimals of mm, three of inches: fewer have dropped their zeros.
  const double digits_m = fixed_decimals_ == (inches_ ? 3 : 2) ? rounding_m(fixed_decimals_) : 0.0;
  return std::max(strict_radius_error_m(radius_m), digits_m);
}

// Half a last digit each way of three points: begin, end and centre.
double GcodeReader::rounding_m(int decimals) const {
  return 2.2 * std::pow(10.0, -decimals) * unit_m();
}

void GcodeReader::note_rounding(const Arc& arc, double chord_m, double strict_m) const {
  using Count = ProgramRemarks::Count;
  const double error_m = std::abs(arc.end_radius_m - arc.begin_radius_m);
  if (error_m > strict_m) remarks_.count(Count::rounded_radius, line_, error_m / units::mm);
  constexpr double small = 3.0;
  const bool short_chord = chord_m > same_place_m && chord_m <= rounding_m(std::max(decimals_, inches_ ? 3 : 2));
  if (!short_chord || arc.begin_radius_m < small * chord_m) return;
  remarks_.count(arc.sweep_rad > std::numbers::pi ? Count::almost_whole : Count::almost_nothing, line_);
}

Vector2d GcodeReader::center_of_words(const Line& line, const Vector2d& from) const {
  static constexpr std::array<const char*, 3> names = {"I", "J", "K"};
  const auto word = [&](Eigen::Index axis) { return line.vector[static_cast<std::size_t>(axis)]; };
  const char* const across = names[static_cast<std::size_t>(plane_.normal)];
  if (word(plane_.normal) && (centers_absolute_ || *word(plane_.normal) != 0.0)) {
    reject(across, *word(plane_.normal), unit_name(), fmt::format("lies across the plane {} of the arc", plane_.name),
           "Is a G17, G18 or G19 missing?");
  }
  const std::optional<double> first = word(plane_.first);
  const std::optional<double> second = word(plane_.second);
  if (!first && !second) {
    reject(fmt::format("{} or R", plane_.centers), std::nullopt, "",
           fmt::format("is missing: an arc in the plane {} needs its centre or its radius", plane_.name));
  }
  if (centers_absolute_ && !(first && second)) {
    reject(plane_.centers, std::nullopt, "", "must both be given where centres are absolute (G90.1)");
  }
  Vector2d center_m = unit_m() * Vector2d(first.value_or(0.0), second.value_or(0.0));
  if (!centers_absolute_) return from + center_m;
  if (tilted_) return center_m;
  const Vector3d origin = origin_m().value_or(Vector3d::Zero());
  return center_m + Vector2d(origin[plane_.first], origin[plane_.second]);
}

// The centre lies on the perpendicular bisector of the ends: left of the way for a short arc that turns left.
Vector2d GcodeReader::center_of_radius(const Line& line, const Vector2d& from, const Vector2d& to) const {
  if (line.vector[0] || line.vector[1] || line.vector[2]) {
    reject("R", *line.radius, unit_name(), "stands beside I, J or K: an arc has a radius or a centre");
  }
  const Vector2d way = to - from;
  const double half_m = 0.5 * way.norm();
  const double radius_m = std::abs(*line.radius) * unit_m();
  if (!(radius_m > 0.0)) reject("R", *line.radius, unit_name(), "must not be 0");
  if (2.0 * half_m <= same_place_m) {
    reject("R", *line.radius, unit_name(), "does not define an arc that ends where it begins",
           fmt::format("Give its centre by {}", plane_.centers));
  }
  if (half_m - radius_m > allowed_radius_error_m(radius_m)) {
    reject("R", *line.radius, unit_name(),
           fmt::format("is too small by {:.6g} {}: half the distance of the arc's ends is {:.9g} {}",
                       (half_m - radius_m) / unit_m(), unit_name(), half_m / unit_m(), unit_name()));
  }
  const double off_m = half_m < radius_m ? std::sqrt((radius_m - half_m) * (radius_m + half_m)) : 0.0;
  const bool left = (motion_ == Motion::counterclockwise) == (*line.radius > 0.0);
  const Vector2d across = Vector2d(-way.y(), way.x()) / (2.0 * half_m);
  return from + 0.5 * way + (left ? off_m : -off_m) * across;
}

Arc GcodeReader::arc_to(const Line& line, const Vector3d& end_in_w_m) const {
  const Vector3d begin_m = in_program(pose_.tip_m);
  const Vector3d end_m = in_program(end_in_w_m);
  const Vector2d from(begin_m[plane_.first], begin_m[plane_.second]);
  const Vector2d to(end_m[plane_.first], end_m[plane_.second]);
  const Vector2d center = line.radius ? center_of_radius(line, from, to) : center_of_words(line, from);
  const Vector2d a = from - center;
  const Vector2d b = to - center;
  Arc arc;
  arc.begin_radius_m = a.norm();
  arc.end_radius_m = b.norm();
  const double error_m = std::abs(arc.end_radius_m - arc.begin_radius_m);
  const double allowed_m = allowed_radius_error_m(arc.begin_radius_m);
  if (!(error_m <= allowed_m)) {
    reject(
        plane_.centers, io::round_15(error_m / unit_m()), unit_name(),
        fmt::format("is by how much the arc's radius at its end ({:.9g}) differs from that at its begin ({:.9g}); must "
                    "be <= {:.3g}",
                    arc.end_radius_m / unit_m(), arc.begin_radius_m / unit_m(), allowed_m / unit_m()),
        centers_absolute_ ? "Centres are absolute (G90.1)" : "Centres count from the begin of the arc (G91.1)");
  }
  if (!(std::min(arc.begin_radius_m, arc.end_radius_m) > same_place_m)) {
    reject(plane_.centers, std::nullopt, "", "lies where the arc begins or ends: it has no radius");
  }
  if (!(arc.begin_radius_m <= farthest_m)) {
    reject(line.radius ? "R" : plane_.centers, std::nullopt, "", "gives an arc a radius above 1 km",
           "Is it meant to be a straight move?");
  }
  const double side = motion_ == Motion::counterclockwise ? 1.0 : -1.0;
  const bool whole = (to - from).norm() <= same_place_m;
  double sweep = whole ? 0.0 : std::atan2(side * (a.x() * b.y() - a.y() * b.x()), a.dot(b));
  if (sweep <= 0.0) sweep += 2.0 * std::numbers::pi;
  arc.sweep_rad = sweep;
  note_rounding(arc, (to - from).norm(), strict_radius_error_m(arc.begin_radius_m));
  arc.sweep_rad = sweep + 2.0 * std::numbers::pi * (turns_of(line) - 1.0);
  const auto in_space = [&](const Vector2d& in_plane, double height) {
    Vector3d out;
    out[plane_.first] = in_plane.x();
    out[plane_.second] = in_plane.y();
    out[plane_.normal] = height;
    return out;
  };
  arc.center_m = out_of_program(in_space(center, begin_m[plane_.normal]));
  arc.towards = turned(in_space(a / arc.begin_radius_m, 0.0));
  arc.ahead = turned(in_space(side / arc.begin_radius_m * Vector2d(-a.y(), a.x()), 0.0));
  arc.rise_m = turned(in_space(Vector2d::Zero(), end_m[plane_.normal] - begin_m[plane_.normal]));
  return arc;
}

}  // namespace robomill::program
