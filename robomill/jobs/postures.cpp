#include "robomill/jobs/postures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/jobs/files/in_words.hpp"
#include "robomill/robot/arm.hpp"

namespace robomill::jobs {
namespace {

constexpr double same_m = 1e-3, same_rad = 0.5 * units::deg;
constexpr std::array direction_names = {"x", "y", "z", "gamma"};
constexpr std::size_t turn = 3;

using Pose = robot::ToolPose;

/// x, y, z of the tip, γ.
double along(const Pose& pose, std::size_t direction) {
  return direction == turn ? pose.gamma_rad : pose.tip_m[static_cast<Eigen::Index>(direction)];
}

/// From a to b.
double way(const Pose& a, const Pose& b, std::size_t direction) {
  const double difference = along(b, direction) - along(a, direction);
  return direction == turn ? std::remainder(difference, 2.0 * std::numbers::pi) : difference;
}

bool same(const Pose& a, const Pose& b, std::size_t direction) {
  return std::abs(way(a, b, direction)) <= (direction == turn ? same_rad : same_m);
}

/// Whether two poses agree in everything else.
bool alike_beside(const Pose& a, const Pose& b, std::size_t direction) {
  if (std::acos(std::clamp(a.axis.dot(b.axis), -1.0, 1.0)) > same_rad) return false;
  for (std::size_t other = 0; other < direction_names.size(); ++other) {
    if (other != direction && !same(a, b, other)) return false;
  }
  return true;
}

void find_spread(const std::vector<PostureLimits>& all, PostureDirection& direction) {
  double sum = 0.0;
  for (std::size_t s = 0; s < all.front().limits.size(); ++s) {
    double least = std::numeric_limits<double>::infinity(), most = 0.0, mean = 0.0;
    bool found = true;
    for (const std::size_t number : direction.postures) {
      const stability::Limit& limit = all[number - 1].limits[s];
      found = found && limit.status == stability::Limit::Status::found;
      least = std::min(least, limit.axial_depth_m);
      most = std::max(most, limit.axial_depth_m);
      mean += limit.axial_depth_m / static_cast<double>(direction.postures.size());
    }
    if (!found || !(mean > 0.0)) continue;
    sum += (most - least) / mean;
    ++direction.speeds;
  }
  direction.spread =
      direction.speeds > 0 ? sum / static_cast<double>(direction.speeds) : std::numeric_limits<double>::quiet_NaN();
}

std::vector<PostureDirection> directions_of(const std::vector<PostureLimits>& all) {
  std::vector<PostureDirection> out;
  for (std::size_t direction = 0; direction < direction_names.size(); ++direction) {
    std::vector<bool> taken(all.size(), false);
    for (std::size_t i = 0; i < all.size(); ++i) {
      PostureDirection one{.name = direction_names.at(direction), .postures = {}};
      bool differ = false;
      for (std::size_t j = i; j < all.size() && !taken[i]; ++j) {
        if (taken[j] || !alike_beside(all[i].pose, all[j].pose, direction)) continue;
        one.postures.push_back(all[j].number);
        differ = differ || !same(all[i].pose, all[j].pose, direction);
      }
      if (!differ) continue;
      for (const std::size_t number : one.postures) taken[number - 1] = true;
      std::ranges::stable_sort(one.postures, {},
                               [&](std::size_t number) { return way(all[i].pose, all[number - 1].pose, direction); });
      find_spread(all, one);
      out.push_back(std::move(one));
    }
  }
  return out;
}

robot::ToolPose pose_of(const cell::Cell& cell, const std::vector<double>& joints) {
  robot::Cell in_base = cell.robot;
  in_base.workpiece = Eigen::Isometry3d::Identity();
  const Eigen::Map<const Eigen::VectorXd> q(joints.data(), static_cast<Eigen::Index>(joints.size()));
  return robot::tool_pose(in_base, robot::forward(cell.robot.arm, q));
}

/// What is said of every posture stands once, anything else with its posture.
void take_notes(const std::vector<LobesFile>& of_each, std::vector<std::string>& notes) {
  const auto of_all = [&](const std::string& text) {
    return std::ranges::all_of(of_each, [&](const LobesFile& one) { return std::ranges::count(one.notes, text) > 0; });
  };
  for (std::size_t p = 0; p < of_each.size(); ++p) {
    for (const std::string& text : of_each[p].notes) {
      if (!of_all(text)) {
        notes.push_back(fmt::format("Posture {}: {}", p + 1, text));
      } else if (p == 0) {
        notes.push_back(text);
      }
    }
  }
}

}  // namespace

PosturesResult run_postures(const PosturesJob& job, Progress& progress) {
  PosturesResult result;
  LobesFile cut = read_lobes(job.cut);
  if (cut.sweep != stability::SweptParameter::axial_depth) {
    throw cut.document->reject("lobes.sweep", "does not go with --postures", "Their limits are axial depths");
  }
  const cell::PostureAxes axes = cut.posture_axes;
  const bool replaced = !cut.job.empty() || !cut.modes.empty() || !cut.frf.empty() || !cut.cell.empty() ||
                        !cut.problem.dynamics.modes.empty();
  cut.drop_dynamics();
  load_dynamics(cut, progress);  // the workpiece's
  if (replaced) cut.notes.emplace_back("The structure that the cut's file names is replaced by that of the postures.");
  cut.notes.emplace_back(
      "The limits are nominal; robomill lobes with dynamics.joints_deg of a posture gives their band.");
  const cell::CellFile cell = cell::read_cell(job.cell);
  const std::vector<cell::ModesOfPosture> all = cell::modes_of_postures(job.cell, axes, progress);
  const auto& [slowest, fastest] = cut.options.spindle_speed_rad_per_s;
  const Eigen::VectorXd speeds = Eigen::VectorXd::LinSpaced(cut.options.grid[0], slowest, fastest);
  result.spindle_speed_rad_per_s.assign(speeds.begin(), speeds.end());
  std::vector<LobesFile> of_each(all.size(), cut);
  for (std::size_t p = 0; p < all.size(); ++p) {
    LobesFile& own = of_each[p];
    own.notes.clear();
    take_posture(own, std::make_shared<const cell::ModesOfPosture>(all[p]));
    own.validate();
    with_words_of(own, [&] {
      PostureLimits row{.number = p + 1, .posture = all[p], .pose = pose_of(cell, all[p].joints), .limits = {}};
      row.limits = stability::limit_depths(own.problem, own.options, result.spindle_speed_rad_per_s, progress);
      result.postures.push_back(std::move(row));
    });
  }
  take_notes(of_each, cut.notes);
  for (const LobesFile& one : of_each) add_assumed(cut.assumed, one.assumed);
  result.directions = directions_of(result.postures);
  result.cut = std::move(cut);
  return result;
}

}  // namespace robomill::jobs
