#include "robomill/process/program_forces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cutting/unusual_cut.hpp"
#include "robomill/path/posture.hpp"
#include "robomill/robot/inverse.hpp"
#include "robomill/robot/kinematics/choose.hpp"
#include "robomill/robot/stiffness.hpp"

namespace robomill::process {
namespace {

using cutting::BlockForce;

std::string where(const std::filesystem::path& program, const program::Block& block) {
  return fmt::format("{}:{}", program.string(), block.line);
}

/// Why the robot cannot stand where a block ends.
std::string reason(const robot::Choice& choice) {
  switch (choice.status) {
    case robot::Reach::Status::out_of_reach:
      return choice.out_of_reach_m > 0.0
                 ? fmt::format("is out of the robot's reach by {:.4g} mm", choice.out_of_reach_m / units::mm)
                 : fmt::format("asks the wrist to bend {:.3g}° too far", choice.out_of_reach_rad / units::deg);
    case robot::Reach::Status::outside_limits:
      return fmt::format("takes joint {} {:.3g}° beyond its limit", choice.joint + 1, choice.beyond_rad / units::deg);
    case robot::Reach::Status::singular:
      return fmt::format("is singular for the robot (condition number {:.3g})", choice.condition_number);
    case robot::Reach::Status::jump:
      return fmt::format("makes a joint jump by {:.3g}°", choice.travel_rad / units::deg);
    case robot::Reach::Status::found:
      break;
  }
  return "can be reached";
}

/// An error that names no place is one of the cell.
template <class F>
void reported_of_cell(const cell::Cell& cell, F&& f) {
  try {
    f();
  } catch (const InvalidInput& error) {
    InvalidInput::Parts parts = error.parts();
    if (!parts.where.empty()) throw;
    parts.where = cell.path.string();
    throw InvalidInput(std::move(parts));
  }
}

InvalidInput out_of_the_way(const cell::Cell& cell, const std::filesystem::path& path, const program::Block& block,
                            std::string rule) {
  const bool in_line = path::turns_last_joint_alone(*cell::kinematics(cell));
  return InvalidInput(
      InvalidInput::Parts{.where = where(path, block),
                          .field = "this block",
                          .rule = std::move(rule),
                          .hint = in_line ? "Move [workpiece] origin_mm"
                                          : "Move [workpiece] origin_mm, or turn the flange with robot.gamma_deg"});
}

/// Joints at the end of every block of an arm without a spherical wrist: by Newton's method from one block to the next.
std::vector<robot::Position6> joints_near(const cell::Cell& file, const program::Program& program,
                                          const std::vector<Eigen::Isometry3d>& flanges,
                                          const std::filesystem::path& path) {
  const robot::Arm& arm = file.robot.arm;
  if (arm.size() != 6 || file.start_joints.size() != 6) {
    throw InvalidInput("robot.start_joints_deg", "must be given for an arm without a spherical wrist, of six joints",
                       "It is followed from there, near the program's first position");
  }
  std::vector<robot::Position6> out;
  out.reserve(flanges.size());
  robot::Position6 at(file.start_joints.data());
  for (std::size_t i = 0; i < flanges.size(); ++i) {
    const robot::NearResult near = robot::solve_near(arm, flanges[i], at);
    if (near.status != robot::NearResult::Status::converged) {
      throw out_of_the_way(file, path, program.blocks[i],
                           fmt::format("was not reached: {:.3g} mm and {:.3g}° are left", near.error_m / units::mm,
                                       near.error_rad / units::deg));
    }
    at = near.position;
    const robot::LimitCheck limits = robot::within_limits(arm, at);
    if (!limits.inside) {
      throw out_of_the_way(
          file, path, program.blocks[i],
          fmt::format("takes joint {} {:.3g}° beyond its limit", limits.joint + 1, -limits.distance / units::deg));
    }
    out.push_back(at);
  }
  return out;
}

/// Joints at the end of every block.
std::vector<robot::Position6> joints_along(const cell::Cell& file, const program::Program& program,
                                           const std::filesystem::path& path) {
  const robot::Cell& cell = file.robot;
  std::vector<Eigen::Isometry3d> flanges;
  flanges.reserve(program.blocks.size());
  for (const program::Block& block : program.blocks) {
    flanges.push_back(robot::flange_pose(
        cell, {.tip_m = block.end.tip_m, .axis = block.end.axis, .gamma_rad = file.redundant_gamma_rad}));
  }
  const std::optional<robot::SphericalWristInverse> inverse = robot::spherical_wrist(cell.arm);
  if (!inverse) return joints_near(file, program, flanges, path);
  std::optional<robot::Position6> start;
  if (file.start_joints.size() == 6) start = robot::Position6(file.start_joints.data());
  const robot::ChooseOptions options = {.point_m = robot::tip_point(cell)};
  if (!start && file.home.size() == 6) {
    const robot::Position6 home(file.home.data());
    robot::Followed way = robot::follow(cell.arm, *inverse, flanges, home, options);
    if (way.status == robot::Reach::Status::found) return std::move(way.position_rad);
  }
  const robot::Followed way = robot::follow(cell.arm, *inverse, flanges, start, options);
  if (way.status != robot::Reach::Status::found) {
    throw out_of_the_way(file, path, program.blocks[way.reached], reason(way.last));
  }
  return way.position_rad;
}

/// Compliance of the tip in W at the end of each block, without load: what forces are weighed by.
std::vector<Eigen::Matrix3d> compliances(const cell::Cell& file, const std::vector<robot::Position6>& joints) {
  const robot::Cell& cell = file.robot;
  const Eigen::Matrix3d base_from_work = cell.workpiece.linear();
  std::vector<Eigen::Matrix3d> out(joints.size(), Eigen::Matrix3d::Identity());
  parallel_for(joints.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const robot::Stiffness stiffness = robot::stiffness(cell.arm, joints[i], robot::tip_point(cell), {});
      if (stiffness.status == robot::Stiffness::Status::singular) continue;
      out[i] = base_from_work.transpose() * stiffness.compliance.topLeftCorner<3, 3>() * base_from_work;
    }
  });
  return out;
}

void require_held(robot::Stiffness::Status status, const cell::Cell& cell, const program::Block& block,
                  const std::filesystem::path& path, const BlockResult& row) {
  if (status == robot::Stiffness::Status::singular) {
    throw out_of_the_way(cell, path, block,
                         fmt::format("is singular for the robot (condition number {:.3g})", row.condition_number));
  }
  if (status == robot::Stiffness::Status::buckled) {
    throw InvalidInput(InvalidInput::Parts{.where = where(path, block),
                                           .field = "this block",
                                           .rule = "bends the robot beyond what its joints hold",
                                           .hint = "Is joint_stiffness_n_m_per_rad right?"});
  }
}

/// The tip's deflection under the forces of every block.
void bend(const cell::Cell& file, const std::vector<robot::Position6>& joints, const program::Program& program,
          const std::filesystem::path& path, std::vector<BlockResult>& rows) {
  parallel_for(rows.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      rows[i].joints = joints[i];
      require_held(bend_block(file.robot, rows[i]), file, program.blocks[i], path, rows[i]);
    }
  });
}

ProgramStock stock_of(const Cut& cut, const program::Program& program) {
  if (cut.stock) return {.stock = *cut.stock};
  const cutting::DefaultStock assumed = cutting::default_stock(program, cut.cutter, cut.dexel_m, cut.cut.axial_depth_m);
  return {.stock = assumed.stock, .assumed = assumed};
}

/// One run through the material: the forces of every block.
void run_once(const Cut& cut, const ProgramForces& out, const cutting::ProgramForceOptions& options,
              const cutting::DeliverForce& deliver, Progress& progress) {
  if (cut.neighbours) {
    cutting::local_program_forces(out.program, cut.cutter, cut.coefficients, cut.cut.axial_depth_m, options, deliver,
                                  progress);
    return;
  }
  cutting::Workpiece workpiece(out.stock->stock, cut.dexel_m);
  cutting::program_forces(out.program, cut.cutter, cut.coefficients, workpiece, options, deliver, progress);
}

/// Passes through the material until force and deflection agree.
constexpr int most_passes = 5;
/// They agree where the deflection changes by less than this, or by less than this share of it.
constexpr double settled_m = 1e-6, settled_share = 0.05;

/// Where the tool stands in the next pass, and whether any block has still to settle.
bool deflect_on(const std::vector<Eigen::Matrix3d>& compliance, int pass, double most_m,
                std::vector<Eigen::Vector3d>& offset_m, std::vector<BlockResult>& rows) {
  bool moves = false;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    BlockResult& row = rows[i];
    Eigen::Vector3d bent = compliance[i] * row.force.mean_force_n;
    if (bent.norm() > most_m) bent *= most_m / bent.norm();
    const Eigen::Vector3d change = bent - offset_m[i];
    const bool settled = change.norm() <= std::max(settled_m, settled_share * offset_m[i].norm());
    if (!settled) moves = true;
    if (row.settled != BlockResult::Settled::lost) {
      row.settled = settled ? BlockResult::Settled::found : BlockResult::Settled::unsettled;
    }
    // From the third pass on by halves: a tool that jumps out of the cut and back settles between.
    if (!settled) offset_m[i] += (pass >= 2 ? 0.5 : 1.0) * change;
  }
  return moves;
}

/// Fills the forces, and the cuts where they are kept. Where the tool deflects, the passes repeat with each block's tip
/// where the mean force of the pass before has bent it.
void cut_program(const Cut& cut, bool keep_cuts, const std::vector<Eigen::Matrix3d>& compliance, ProgramForces& out,
                 Progress& progress) {
  cutting::ProgramForceOptions options = {.spindle_speed_rad_per_s = cut.motion.spindle_speed_rad_per_s,
                                          .power_time_s = cut.power_time_s,
                                          .force = cut.force};
  if (!compliance.empty()) {
    options.weight = [&compliance](std::size_t block, const Eigen::Vector3d& force_n) {
      return (compliance[block] * force_n).norm();
    };
  }
  std::vector<double> area_m2;
  if (keep_cuts) {
    options.observe = [&](const cutting::PartOfBlock& part) {
      const double area = cutting::patch_area_m2(part.cut.engagement);
      if (area <= area_m2[part.block]) return;
      area_m2[part.block] = area;
      out.cuts[part.block] = part.cut;
    };
  }
  const std::size_t count = out.blocks.size();
  std::vector<bool> rigid_cuts(count);
  std::vector<bool> rigid_rapid(count);  // a rapid that springs back out of a bent cut is no move through material
  std::vector<Eigen::Vector3d> offset_m(out.deflected ? count : 0, Eigen::Vector3d::Zero());
  for (int pass = 0; pass < most_passes; ++pass) {
    if (keep_cuts) {
      area_m2.assign(count, 0.0);
      out.cuts.assign(count, {});
    }
    options.walk.tip_offset_m = offset_m;
    const auto keep = [&](const BlockForce& force) {
      const std::size_t i = force.block;
      BlockResult& row = out.blocks[i];
      row.force = force;
      if (pass == 0) {
        rigid_cuts[i] = force.cuts();
        rigid_rapid[i] = force.rapid_in_material;
      }
      row.force.rapid_in_material = force.rapid_in_material && rigid_rapid[i];
      const bool lost = rigid_cuts[i] && !force.cuts();
      row.settled = lost ? BlockResult::Settled::lost : BlockResult::Settled::found;
    };
    run_once(cut, out, options, keep, progress);
    if (!out.deflected) return;
    if (!deflect_on(compliance, pass, 0.5 * cut.cutter.mill.diameter_m, offset_m, out.blocks)) return;
  }
}

/// The first of the blocks for which something is so, and how many they are.
template <class Is>
void warn_of(const ProgramForces& program, std::vector<std::string>& warnings, Is is, const char* text) {
  std::size_t count = 0;
  std::size_t first = 0;
  for (const BlockResult& row : program.blocks) {
    if (!is(row)) continue;
    if (count == 0) first = row.force.block;
    ++count;
  }
  if (count > 0)
    warnings.push_back(fmt::format("{} block{} {}, the first in line {} (block {}).", count, count == 1 ? "" : "s",
                                   text, program.program.blocks[first].line, first + 1));
}

/// Where a program and its cut do not fit each other.
void warn_of_program(const Cut& cut, const ProgramForces& out, std::vector<std::string>& warnings) {
  const auto cuts = [](const BlockResult& row) { return row.force.cuts(); };
  if (std::ranges::none_of(out.blocks, cuts)) {
    warnings.emplace_back(
        "No block cuts: the program does not touch the stock. Compare where stock and program stand in the work "
        "frame.");
    return;
  }
  std::vector<double> feeds_m;
  for (const BlockResult& row : out.blocks) {
    if (cuts(row)) feeds_m.push_back(row.force.feed_per_tooth_m);
  }
  std::ranges::sort(feeds_m);
  constexpr double unlike = 10.0;  // plunges alone are slower
  const double said_m = cut.motion.feed_per_tooth_m, middle_m = feeds_m[feeds_m.size() / 2];
  if (said_m > 0.0 && (feeds_m.back() > unlike * said_m || middle_m * unlike < said_m)) {
    warnings.push_back(fmt::format(
        "The program feeds {:.3g} to {:.3g} mm per tooth where it cuts, and cut.feed_per_tooth_mm is {:.3g}: do the "
        "program's F, the spindle speed and the teeth fit each other?",
        feeds_m.front() / units::mm, feeds_m.back() / units::mm, said_m / units::mm));
  }
  cutting::FromTo speed_rad_per_s = {HUGE_VAL, 0.0};
  for (const BlockResult& row : out.blocks) {
    if (!cuts(row)) continue;
    speed_rad_per_s[0] = std::min(speed_rad_per_s[0], row.force.spindle_speed_rad_per_s);
    speed_rad_per_s[1] = std::max(speed_rad_per_s[1], row.force.spindle_speed_rad_per_s);
  }
  const double radius_m = 0.5 * cut.cutter.mill.diameter_m;
  std::ranges::move(cutting::unusual_cut(2.0 * radius_m, feeds_m.back(),
                                         {radius_m * speed_rad_per_s[0], radius_m * speed_rad_per_s[1]}),
                    std::back_inserter(warnings));
  warn_of(
      out, warnings,
      [&](const BlockResult& row) {
        return cuts(row) && out.program.blocks[row.force.block].spindle == program::Spindle::counterclockwise;
      },
      "cut while the spindle turns left (M4), and a right-hand cutter was taken");
}

void warn_of_blocks(const Cut& cut, const ProgramForces& out, std::vector<std::string>& warnings) {
  using Settled = BlockResult::Settled;
  const auto of_force = [](auto is) { return [is](const BlockResult& row) { return is(row.force); }; };
  warn_of(out, warnings, of_force([](const BlockForce& f) { return f.shank_depth_m > 0.0; }),
          "run the shank into material");
  warn_of(out, warnings, of_force([](const BlockForce& f) { return f.rapid_in_material; }),
          "move through material in rapid");
  warn_of_program(cut, out, warnings);
  const double least_m3 = std::pow(cut.dexel_m, 3);  // less is what rays see of a cutter that slides along
  warn_of(out, warnings, of_force([&](const BlockForce& f) {
            const bool feeds = out.program.blocks[f.block].kind == program::Block::Kind::feed;
            return feeds && !f.cuts() && f.removed_volume_m3 > least_m3;
          }),
          "remove material where no tooth was found in it, and have no force");
  warn_of(
      out, warnings, [](const BlockResult& row) { return row.settled == Settled::lost; },
      "lose the engagement: the force pushes the tool out of the cut");
  warn_of(
      out, warnings, [](const BlockResult& row) { return row.settled == Settled::unsettled; },
      "have a deflection that does not settle: force and deflection drive each other");
}

}  // namespace

robot::Stiffness::Status bend_block(const robot::Cell& cell, BlockResult& row) {
  const Eigen::Matrix3d base_from_work = cell.workpiece.linear();
  const auto bend_under = [&](const Eigen::Vector3d& force_in_work_n, Eigen::Vector3d& deflection_m) {
    const Eigen::Vector3d force_n = base_from_work * force_in_work_n;
    const robot::Stiffness stiffness =
        robot::stiffness(cell.arm, row.joints, robot::tip_point(cell), {.force_n = force_n});
    row.condition_number = stiffness.condition_number;
    if (stiffness.status == robot::Stiffness::Status::regular) {
      deflection_m = base_from_work.transpose() * (stiffness.compliance.topLeftCorner<3, 3>() * force_n);
    }
    return stiffness.status;
  };
  const robot::Stiffness::Status at_peak = bend_under(row.force.heaviest_force_n, row.peak_deflection_m);
  if (at_peak != robot::Stiffness::Status::regular) return at_peak;
  return bend_under(row.force.mean_force_n, row.deflection_m);
}

std::string stock_text(const ProgramForces& program) {
  if (!program.stock) return {};
  const Eigen::Vector3d low = program.stock->stock.lowest_m() / units::mm;
  const Eigen::Vector3d high = program.stock->stock.highest_m() / units::mm;
  std::string box = fmt::format("from ({:.5g}, {:.5g}, {:.5g}) to ({:.5g}, {:.5g}, {:.5g}) mm", low.x(), low.y(),
                                low.z(), high.x(), high.y(), high.z());
  if (!program.stock->assumed) return box;
  const cutting::DefaultStock& assumed = *program.stock->assumed;
  const std::size_t line = program.program.blocks[assumed.highest_pass_block].line;
  const std::string top =
      assumed.top == cutting::DefaultStock::Top::program_zero
          ? fmt::format("its top at z = 0, below which every pass lies (the highest at {:.5g} mm, line {})",
                        assumed.highest_pass_m / units::mm, line)
          : fmt::format("its top cut.axial_depth_mm above the highest pass (z = {:.5g} mm, line {})",
                        assumed.highest_pass_m / units::mm, line);
  return fmt::format("a box {}, {}", box, top);
}

void require_cuts(const ForcesResult& forces) {
  if (forces.cell && forces.program && forces.program->cuts.size() == forces.program->blocks.size()) return;
  throw InvalidInput("forces", "must be those along a program, with a cell and the cut of each block");
}

void run_program(ForcesResult& result, program::Program program, const std::filesystem::path& path,
                 const ProgramRun& run, Progress& progress) {
  const auto begun = std::chrono::steady_clock::now();
  const Cut& cut = result.cut;
  const std::optional<cell::Cell>& cell = result.cell;
  ProgramForces& out = result.program.emplace();
  out.path = path;
  out.program = std::move(program);
  if (out.program.blocks.empty()) {
    throw InvalidInput(InvalidInput::Parts{.where = path.string(), .rule = "has no move"});
  }
  std::vector<robot::Position6> joints = run.joints;
  if (cell && joints.size() != out.program.blocks.size()) {
    reported_of_cell(*cell, [&] { joints = joints_along(*cell, out.program, path); });
  }
  if (!cut.neighbours) out.stock = stock_of(cut, out.program);
  out.blocks.resize(out.program.blocks.size());
  out.deflected = run.deflect && cell && !cut.neighbours;
  cut_program(cut, run.keep_cuts, cell ? compliances(*cell, joints) : std::vector<Eigen::Matrix3d>(), out, progress);
  for (const BlockResult& row : out.blocks) out.removed_volume_m3 += row.force.removed_volume_m3;
  if (cell) reported_of_cell(*cell, [&] { bend(*cell, joints, out.program, path, out.blocks); });
  warn_of_blocks(cut, out, result.warnings);
  if (!out.program.skipped.empty()) {
    result.notes.push_back(fmt::format("{} words of the program were not read, the first in line {}: {}.",
                                       out.program.skipped.size(), out.program.skipped.front().line,
                                       out.program.skipped.front().what));
  }
  result.notes.insert(result.notes.end(), out.program.notes.begin(), out.program.notes.end());
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
}

}  // namespace robomill::process
