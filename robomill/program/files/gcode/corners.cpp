// Corners of a GcodeReader that the program rounds (,R) or cuts off (,C) between two straight moves.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/program/files/gcode/reader.hpp"

namespace robomill::program {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double corner_rounding_m = 1e-7;  ///< by which a corner may be larger than its moves

std::string corner_name(const GcodeWords::Word& word) {
  return word.text.substr(1, 1) == "r" ? ",R" : ",C";
}

bool any_word(const std::array<std::optional<double>, 3>& words) {
  return words[0] || words[1] || words[2];
}

}  // namespace

void GcodeReader::take_corner(const GcodeWords::Word& word, Line& line) {
  if (line.corner) reject(corner_name(word), word.number, "", "is the second corner of this line", "Only one can hold");
  if (!(word.number > 0.0)) reject(corner_name(word), word.number, unit_name(), "must be > 0");
  line.corner = word;
}

void GcodeReader::reject_no_begin(const GcodeWords::Word& corner) const {
  reject(corner_name(corner), corner.number, unit_name(),
         "needs a move to its corner: this line gives the first position", "Begin with a G0 to X, Y and Z");
}

void GcodeReader::reject_corner(std::string rule, std::string hint) const {
  throw InvalidInput(InvalidInput::Parts{.where = fmt::format("{}:{}", file_, corner_->line),
                                         .field = corner_->name,
                                         .rule = std::move(rule),
                                         .hint = std::move(hint)});
}

void GcodeReader::check_corner(const Line& line) const {
  const bool others = line.system || line.call || line.tool_change || line.tool || line.length || line.center_point ||
                      line.frame_off || line.dwells || line.special != Special::none;
  const bool turns = any_word(line.rotary) || any_word(line.vector);
  const bool straight = motion_ == Motion::feed && any_word(line.position) && !others && !turns;
  if (corner_ && !(straight && plane_.normal == corner_->normal)) {
    reject_corner(fmt::format("needs a straight move G1 in the same plane right after it, and line {} is none", line_),
                  "Let the CAM system write corners beside arcs as arcs G2, G3 and straight moves");
  }
  if (!line.corner) return;
  const auto needs = [&](bool well, const char* rule, const char* hint = "") {
    if (!well) reject(corner_name(*line.corner), line.corner->number, unit_name(), rule, hint);
  };
  needs(straight, "is read on a line of a straight move G1 alone, without A, B, C, I, J, K and other codes",
        "Let the CAM system write corners beside arcs as arcs G2, G3 and straight moves");
  needs(feed_mode_ == FeedMode::per_minute, "needs a feed per minute (G94)");
  needs(line.stop == OperatorStop::none, "stands on a line with M0 or M1", "Write it behind the move after the corner");
}

Vector2d GcodeReader::in_plane(const Vector3d& vector) const {
  const Vector3d own = tilted_ ? Vector3d(tilted_->axes.transpose() * vector) : vector;
  return {own[plane_.first], own[plane_.second]};
}

Vector3d GcodeReader::out_of_plane(const Vector2d& vector) const {
  Vector3d own = Vector3d::Zero();
  own[plane_.first] = vector.x();
  own[plane_.second] = vector.y();
  return tilted_ ? Vector3d(tilted_->axes * own) : own;
}

void GcodeReader::go_by_corner(const Line& line, const Vector3d& end_m) {
  special_ = true;
  begin_cutting();
  const Vector3d begin_m = corner_ ? corner_->at_m : pose_.tip_m;
  const Vector3d way_m = end_m - begin_m;
  const Vector2d in_plane_m = in_plane(way_m);
  const std::string name = corner_ ? corner_->name : corner_name(*line.corner);
  if (way_m.norm() <= corner_rounding_m) {
    reject(name, std::nullopt, "", "stands between moves of which this line's moves nothing");
  }
  if ((way_m - out_of_plane(in_plane_m)).norm() > corner_rounding_m) {
    reject(name, std::nullopt, "",
           fmt::format("stands between moves in the plane {} alone, and this line leaves it", plane_.name),
           "Let the CAM system write arcs and straight moves");
  }
  const double s_per_m = feed_duration_s(line, 1.0, 0.0);
  steps_.clear();
  if (corner_) cut_corner(end_m);
  if (line.corner) {
    corner_ = Corner{.line = line_,
                     .name = corner_name(*line.corner),
                     .size_m = line.corner->number * unit_m(),
                     .at_m = end_m,
                     .normal = plane_.normal,
                     .s_per_m = s_per_m,
                     .running = {spindle_speed_rad_per_s_, spindle_, coolant_}};
  } else {
    const Vector3d from_m = steps_.empty() ? pose_.tip_m : steps_.back().tip_m;
    steps_.push_back({.kind = Block::Kind::feed, .tip_m = end_m, .duration_s = (end_m - from_m).norm() * s_per_m});
    corner_.reset();
  }
  begin_steps();
}

// Tangent at both ends: an arc of radius r that turns by θ takes r tan θ/2 of each move, a chamfer its own length.
void GcodeReader::cut_corner(const Vector3d& next_m) {
  const Corner& corner = *corner_;
  const Vector2d in = in_plane(corner.at_m - pose_.tip_m);
  const Vector2d out = in_plane(next_m - corner.at_m);
  const double turn = std::atan2(in.x() * out.y() - in.y() * out.x(), in.dot(out));
  constexpr double none_rad = 1e-9;
  constexpr double back_rad = std::numbers::pi - 1e-6;
  if (std::abs(turn) > back_rad) reject_corner("stands where the path turns back", "");
  const bool round = corner.name == ",R";
  const double shorter_m = std::min(in.norm(), out.norm());
  double cut_m = round ? corner.size_m * std::tan(0.5 * std::abs(turn)) : corner.size_m;
  if (cut_m > shorter_m + corner_rounding_m) {
    reject_corner(fmt::format("takes {:.6g} {} of each move beside it, and the shorter has {:.6g} {} left",
                              cut_m / unit_m(), unit_name(), shorter_m / unit_m(), unit_name()),
                  "Give a smaller corner");
  }
  cut_m = std::abs(turn) > none_rad ? std::min(cut_m, shorter_m) : 0.0;
  const Vector2d ahead = in.normalized();
  const Vector3d begin_m = corner.at_m - cut_m * out_of_plane(ahead);
  const Vector3d end_m = corner.at_m + cut_m * out_of_plane(out.normalized());
  const auto add = [&](const Vector3d& tip_m, double length_m, double off_m) {
    steps_.push_back({.kind = Block::Kind::feed,
                      .tip_m = tip_m,
                      .duration_s = length_m * corner.s_per_m,
                      .line = corner.line,
                      .tip_deviation_m = off_m,
                      .running = corner.running});
  };
  add(begin_m, (begin_m - pose_.tip_m).norm(), 0.0);
  if (cut_m == 0.0) return;
  if (!round) {
    add(end_m, (end_m - begin_m).norm(), 0.0);
    return;
  }
  const double side = turn > 0.0 ? 1.0 : -1.0;
  const Vector3d across = out_of_plane(Vector2d(-side * ahead.y(), side * ahead.x()));
  const Arc arc = {.center_m = begin_m + corner.size_m * across,
                   .towards = -across,
                   .ahead = out_of_plane(ahead),
                   .begin_radius_m = corner.size_m,
                   .end_radius_m = corner.size_m,
                   .sweep_rad = std::abs(turn)};
  const double chords = arc.chords(reading_.chord_tolerance_m);
  constexpr double most_chords = 1e5;
  if (!(chords <= most_chords)) reject_corner(fmt::format("would make an arc of {:.3g} parts", chords), "");
  for (double i = 1.0; i <= chords; i += 1.0) {
    add(i < chords ? arc.at(i / chords) : end_m, arc.length_m() / chords, arc.deviation_m(chords));
  }
}

}  // namespace robomill::program
