// Tool axes of rewritten G-code: words A, B and C of a machine, or I, J and K.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robomill/base/units.hpp"
#include "robomill/program/files/rewrite/gcode.hpp"

namespace robomill::program {
namespace {

using Eigen::Vector3d;

constexpr std::array<char, 3> rotary_words = {'a', 'b', 'c'};
constexpr std::array<char, 3> vector_words = {'i', 'j', 'k'};

}  // namespace

bool GcodeRewriter::stand_as_read(std::size_t index) const {
  constexpr double same_deg = 1e-6;
  const Vector3d off_deg = out_->modes().rotary_deg - modes_before(index).rotary_deg;
  return off_deg.cwiseAbs().maxCoeff() <= same_deg;
}

bool GcodeRewriter::axes_changed(std::size_t index) const {
  const Statement& statement = statements()[index];
  if (by_rotary() && !stand_as_read(index)) return true;
  if (!same_axis(job().wanted.begin_of(statement.first_block).axis,
                 job().as_read.begin_of(statement.first_block).axis)) {
    return true;
  }
  for (std::size_t i = statement.first_block; i < statement.first_block + statement.blocks; ++i) {
    if (!same_axis(job().wanted.blocks[i].end.axis, job().as_read.blocks[i].end.axis)) return true;
  }
  return false;
}

void GcodeRewriter::check_says_axis(const Statement& statement) const {
  if (by_vector_ || by_rotary()) return;
  reject(
      statement.line, "tool axis",
      "cannot be said by this program: it turns no axis, and without program.machine A, B and C have no meaning",
      "Give program.machine: \"xyzac-trt\", \"xyzbc-trt\", \"xyzac-head\" or \"xyzbc-head\"; a machine of three axes "
      "can only keep the tool as it stands");
}

Vector3d GcodeRewriter::nearest_deg(const Vector3d& axis, const Vector3d& from_deg) const {
  constexpr double digits_rad = 3e-8;
  // Nearer to a pole than digits say it is the pole, where C stays.
  const bool pole = axis.head<2>().norm() <= digits_rad;
  const Vector3d target = pole ? Vector3d(0.0, 0.0, std::copysign(1.0, axis.z())) : axis;
  return nearest_rotary(*job().reading.machine, target, from_deg * units::deg) / units::deg;
}

// A rapid brings the rotary axes back to where the program's own words have them, a feed goes on where they stand.
Vector3d GcodeRewriter::rotary_goal_deg(std::size_t index, const Move& move) const {
  const Statement& statement = statements()[index];
  Vector3d stand_deg = out_->modes().rotary_deg;
  if (!statement.starts && move.count == 0) return stand_deg;
  const std::size_t last = move.first + move.count;
  const Vector3d& read = statement.starts ? job().as_read.start.axis : job().as_read.blocks[last - 1].end.axis;
  const Vector3d& wanted = statement.starts ? job().wanted.start.axis : job().wanted.blocks[last - 1].end.axis;
  if (same_axis(wanted, read) && (!move.at_feed || stand_as_read(index))) return modes_[index].rotary_deg;
  return nearest_deg(wanted, stand_deg);
}

double GcodeRewriter::set_rotary(std::size_t index, const Move& move, Composed& composed) const {
  const Statement& statement = statements()[index];
  const Modes& modes = modes_[index];
  const Vector3d from_deg = out_->modes().rotary_deg;
  const Vector3d goal_deg = rotary_goal_deg(index, move);
  const bool stays = !statement.starts && move.count == 0;
  Vector3d end_deg = from_deg;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const Word* const word = find(rotary_words[i]);
    const Coordinate to = coordinate(word != nullptr ? std::optional(word->number) : std::nullopt, goal_deg[axis],
                                     from_deg[axis], modes.incremental, {.decimals = rotary_decimals}, stays);
    end_deg[axis] = to.end;
    if (to.act == Coordinate::Act::keep) continue;
    if (word == nullptr) {
      add_axis(rotary_words[i], to.text, composed);
    } else if (to.act == Coordinate::Act::write) {
      set_number(statement, *word, to.text, composed);
    } else {
      remove(statement, *word, composed);
    }
  }
  return (end_deg - from_deg).norm();
}

double GcodeRewriter::set_vector(std::size_t index, const Move& move, Composed& composed) const {
  const Statement& statement = statements()[index];
  const Vector3d from = out_->pose().axis;
  const Vector3d target = statement.starts ? job().wanted.start.axis
                          : move.count > 0 ? job().wanted.blocks[move.first + move.count - 1].end.axis
                                           : from;
  std::array<const Word*, 3> words = {};
  for (std::size_t i = 0; i < 3; ++i) words[i] = find(vector_words[i]);
  if (words[0] == nullptr || statement.round) {
    if (same_axis(target, from)) return 0.0;
    const AxisNumbers to = axis_numbers({}, target);
    for (std::size_t i = 0; i < 3; ++i) add_axis(vector_words[i], to.texts[i], composed);
    return angle_between(from, to.axis) / units::deg;
  }
  const AxisNumbers to = axis_numbers(Vector3d(words[0]->number, words[1]->number, words[2]->number), target);
  const bool stays = !statement.starts && move.count == 0 && to.axis != from;
  for (std::size_t i = 0; i < 3; ++i) {
    if (stays) {
      remove(statement, *words[i], composed);
    } else if (!to.keep) {
      set_number(statement, *words[i], to.texts[i], composed);
    }
  }
  return stays ? 0.0 : angle_between(from, to.axis) / units::deg;
}

double GcodeRewriter::set_axis(std::size_t index, const Move& move, Composed& composed) const {
  const Statement& statement = statements()[index];
  if (move.count == 0 && !statement.starts && !statement.after_start) return 0.0;  // what the start says counts
  if (by_rotary()) return set_rotary(index, move, composed);
  if (by_vector_) return set_vector(index, move, composed);
  const bool unchanged =
      statement.starts ? same_axis(job().wanted.start.axis, out_->pose().axis) : !axes_changed(index);
  if (!unchanged) check_says_axis(statement);
  return 0.0;
}

void GcodeRewriter::add_pieces(std::size_t block, Vector3d& rotary_deg, std::vector<Piece>& out) const {
  const Block& wanted = job().wanted.blocks[block];
  const Pose& from = job().wanted.begin_of(block);
  const auto goal_deg = [&](double share) {
    return nearest_deg(share == 1.0 ? wanted.end.axis : between(from, wanted.end, share).axis, rotary_deg);
  };
  const auto parts_to = [&](double share) {
    constexpr double margin = 0.98;  // for the digits
    const RotaryMove move = {.machine = *job().reading.machine,
                             .begin_rad = rotary_deg * units::deg,
                             .end_rad = goal_deg(share) * units::deg};
    return move.parts(margin * job().reading.axis_tolerance_rad);
  };
  const bool in_one = wanted.kind == Block::Kind::rapid || job().reading.rotary == Rotary::great_circle;
  constexpr double least_step = 1e-7;
  constexpr int halvings = 5;
  for (double at = 0.0; at < 1.0;) {
    double step = 1.0 - at;
    for (double parts = in_one ? 1.0 : parts_to(1.0); parts > 1.0; parts = parts_to(at + step)) {
      step /= parts;
      if (step >= least_step) continue;
      reject(wanted.line, "tool axis", "cannot be followed by turning the machine's axes within axis_tolerance_rad",
             "Allow a larger one");
    }
    // As far as the machine goes in one.
    double too_far = 1.0 - at;
    while (at + 2.0 * step < 1.0 && parts_to(at + 2.0 * step) == 1.0) step *= 2.0;
    too_far = std::min(too_far, 2.0 * step);
    for (int i = 0; i < halvings && at + step < 1.0; ++i) {
      const double middle = 0.5 * (step + too_far);
      (parts_to(at + middle) == 1.0 ? step : too_far) = middle;
    }
    const double end = at + step >= 1.0 - least_step ? 1.0 : at + step;
    rotary_deg = goal_deg(end);
    out.push_back({.block = block, .begin = at, .end = end, .rotary_deg = rotary_deg});
    at = end;
  }
}

std::vector<GcodeRewriter::Piece> GcodeRewriter::pieces_of(std::size_t index, const Move& move) const {
  const Vector3d begin_deg = modes_before(index).rotary_deg;
  const Vector3d way_deg = modes_[index].rotary_deg - begin_deg;
  const bool changed = axes_changed(index);
  if (changed) check_says_axis(statements()[index]);
  Vector3d rotary_deg = out_->modes().rotary_deg;
  std::vector<Piece> out;
  out.reserve(move.count);
  for (std::size_t part = 0; part < move.count; ++part) {
    if (changed && by_rotary()) {
      add_pieces(move.first + part, rotary_deg, out);
      continue;
    }
    const double share = static_cast<double>(part + 1) / static_cast<double>(move.count);
    out.push_back({.block = move.first + part, .rotary_deg = begin_deg + share * way_deg});
  }
  return out;
}

}  // namespace robomill::program
