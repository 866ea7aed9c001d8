// Where positions of an AptReader lie in W: coordinate systems, retracts and the machine's own positions.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/program/files/apt_reader.hpp"

namespace robomill::program {
namespace {

using Eigen::Vector3d;

constexpr const char* one_system = "Positions count in one system from the first on; write a file for each";
constexpr double axis_tolerance = 1e-3;

}  // namespace

AptReader::Frame AptReader::frame_of(const Vector3d& x, const Vector3d& y, const Vector3d& origin_m) const {
  const Vector3d z = x.cross(y);
  const bool well = std::abs(x.norm() - 1.0) <= axis_tolerance && std::abs(y.norm() - 1.0) <= axis_tolerance &&
                    std::abs(x.dot(y)) <= axis_tolerance;
  if (!well) reject_text(std::string(word_), shown_, "has axes that are not perpendicular unit vectors");
  for (Eigen::Index i = 0; i < 3; ++i) check_coordinate("origin", origin_m[i], origin_m[i] / unit_m(), unit_name());
  Frame frame = {.origin_m = origin_m};
  frame.rotation.col(2) = z.normalized();
  frame.rotation.col(0) = (x - x.dot(frame.rotation.col(2)) * frame.rotation.col(2)).normalized();
  frame.rotation.col(1) = frame.rotation.col(2).cross(frame.rotation.col(0));
  return frame;
}

// NX: the origin, X and Y of the system that positions count in. W is that of the first position.
void AptReader::take_system() {
  const std::vector<double> numbers = all_numbers();
  std::optional<Frame> frame;
  if (numbers.size() == 9 && fields_.size() == 9) {
    const auto vector = [&](std::size_t i) { return Vector3d(numbers[i], numbers[i + 1], numbers[i + 2]); };
    frame = frame_of(vector(3), vector(6), vector(0) * unit_m());
  }
  if (!begun() || text_ == system_) {
    if (!begun()) base_system_ = frame;
    system_ = text_;
    skip_statement();
    return;
  }
  if (!base_system_ || !frame) {
    reject_text("MSYS", shown_, "changes the coordinate system within the program", one_system);
  }
  system_ = text_;
  const Frame base = *base_system_;
  frame_.reset();
  if (!(*frame == base)) {
    frame_ = Frame{.rotation = base.rotation.transpose() * frame->rotation,
                   .origin_m = base.rotation.transpose() * (frame->origin_m - base.origin_m)};
    // Be it before the chosen tool is mounted: its positions come behind it.
    if (!std::exchange(assumed_[static_cast<std::size_t>(Once::systems)], true)) {
      remarks_.assume({.what = fmt::format("Positions behind another MSYS, from line {} on", line_),
                       .taken = "moved into the system of the first one",
                       .key = "a file for each MSYS"});
    }
  }
  plain_axis_ = frame_ ? Vector3d(frame_->rotation.col(2)) : Vector3d(Vector3d::UnitZ());
}

// SolidWorks CAM: rows of a matrix whose columns are the setup's X, Y, Z and an origin. Under TRNTYP/WORLD positions
// and axes count in one system for all setups; Z is their tool's axis.
void AptReader::take_setup_system() {
  const std::vector<double> numbers = all_numbers();
  if (numbers.size() != 12 || fields_.size() != 12) {
    reject_text("CSYS", shown_, "is not read: it may move the program's frame", "Known is CSYS/ with 12 numbers");
  }
  const auto column = [&](std::size_t i) { return Vector3d(numbers[i], numbers[i + 4], numbers[i + 8]); };
  const Frame frame = frame_of(column(0), column(1), column(3) * unit_m());
  if (column(0).cross(column(1)).dot(column(2)) < 0.0) {
    reject_text("CSYS", shown_, "is a mirrored system", "Let the CAM system write right-handed ones");
  }
  skip_statement();
  setup_x_ = frame.rotation.col(0);
  if (!begun()) setup_system_ = frame;
  const bool world = transformation_.starts_with("TRNTYP/WORLD");
  if (!setup_system_) {
    reject_text("CSYS", shown_, "changes the coordinate system within the program", one_system);
  }
  if (world ? frame.origin_m != setup_system_->origin_m : !(frame == *setup_system_)) {
    reject_text("CSYS", shown_, world ? "moves the origin within the program" : "changes the system within the program",
                one_system);
  }
  setup_turned_ = world && (frame.rotation.col(2) - Vector3d::UnitZ()).norm() > 1e-6;
  if (!world) return;
  plain_axis_ = Vector3d::UnitZ();
  plain_axis_stays_ = true;
}

void AptReader::take_transformation() {
  if (begun() && text_ != transformation_) {
    reject_text("TRNTYP", shown_, "changes the coordinate system within the program", one_system);
  }
  transformation_ = text_;
  skip_statement();
}

// CATIA: a matrix of three rows in comments, from the part's system to that of the positions.
void AptReader::take_matrix_comment() {
  if (text_.starts_with("$$*")) {
    matrix_rows_.clear();
    in_matrix_ = true;
    return;
  }
  if (!in_matrix_) return;
  matrix_rows_.push_back(text_);
  if (matrix_rows_.size() < 3) return;
  in_matrix_ = false;
  if (!begun()) first_matrix_rows_ = matrix_rows_;
  if (matrix_rows_ == first_matrix_rows_) return;
  reject_text("CATIA0", shown_, "ends a matrix that changes the coordinate system within the program", one_system);
}

void AptReader::take_shift() {
  const std::vector<double> numbers = all_numbers();
  const bool still = !numbers.empty() && std::ranges::all_of(numbers, [](double number) { return number == 0.0; });
  if (!still) reject_motion();
  skip_statement();
}

void AptReader::take_clearance() {
  const std::vector<double> numbers = all_numbers();
  clearance_.reset();
  if (numbers.size() == 4) {
    const Vector3d normal(numbers[0], numbers[1], numbers[2]);
    if (std::abs(normal.norm() - 1.0) <= axis_tolerance) {
      clearance_ = {.normal = normal.normalized(), .offset_m = numbers[3] / normal.norm() * unit_m()};
    }
  } else if (numbers.size() == 1 && (fields_.size() == 1 || fields_[0] == "XYPLAN")) {
    clearance_ = {.normal = Vector3d::UnitZ(), .offset_m = numbers[0] * unit_m()};
  }
  if (clearance_ && frame_) {
    clearance_->normal = (frame_->rotation * clearance_->normal).eval();
    clearance_->offset_m += clearance_->normal.dot(frame_->origin_m);
  }
  if (clearance_) check_coordinate("CLRSRF", clearance_->offset_m, clearance_->offset_m / unit_m(), unit_name());
  skip_statement();
}

// Along the tool's axis to the clearance plane.
void AptReader::take_retract() {
  skip_statement();
  if (!fields_.empty() || !start_ || lost_line_ > 0) return;  // RETRCT/ON, RETRCT/OFF: modes of cycles
  if (!clearance_) {
    lose();
    return;
  }
  made_ = Made::moves;
  const double along = clearance_->normal.dot(pose_.axis);
  constexpr double least = 0.1;
  if (!(along >= least)) {
    reject("RETRCT", std::nullopt, "", "goes along a tool axis that does not lead to the clearance plane",
           "Let the CAM system write the retract as RAPID and GOTO/");
  }
  const double way_m = (clearance_->offset_m - clearance_->normal.dot(pose_.tip_m)) / along;
  if (!(way_m > 0.0)) return;
  lift_m_.reset();
  begin_part_move();
  if (is_second_tool()) return;
  const Pose end = {.tip_m = pose_.tip_m + way_m * pose_.axis, .axis = pose_.axis};
  highest_m_ = std::max(highest_m_, end.tip_m.z());
  move(Block::Kind::rapid, end, 0.0);
}

bool AptReader::gives_home() const {
  const std::size_t count = all_numbers().size();
  return count == 3 || count == 6;
}

void AptReader::take_home() {
  if (!gives_home()) {
    skip_statement();
    if (start_ && lost_line_ == 0) lose();
    return;
  }
  take_numbers(3, 6);
  rapid_ = false;
  begin_part_move();
  const Pose end = pose_of_numbers();
  if (passes()) {
    begin_at(end);
    return;
  }
  made_ = Made::moves;
  go_straight(end, true);
}

void AptReader::lose() {
  lost_line_ = line_;
  lost_word_ = word_;
  circle_.reset();
  lift_m_.reset();
}

void AptReader::come_back(const Pose& end) {
  if (is_second_tool()) return;
  lost_line_ = 0;
  made_ = Made::moves;
  highest_m_ = std::max({highest_m_, pose_.tip_m.z(), end.tip_m.z()});
  begin_return(end, highest_m_);
}

void AptReader::turn_over(const Pose& end) {
  lift_m_.reset();
  if (is_second_tool()) return;
  made_ = Made::moves;
  assume_once(Once::turned_over,
              {.what = fmt::format("Turn of the tool by half a circle into another CSYS, in line {}", line_),
               .taken = "a rapid about the setup's X; the part may be clamped anew there",
               .key = "a file for each setup"});
  steps_.clear();
  steps_.push_back({.tip_m = 0.5 * (pose_.tip_m + end.tip_m), .axis = *setup_x_});
  steps_.push_back({.tip_m = end.tip_m, .axis = end.axis});
  begin_steps();
}

}  // namespace robomill::program
