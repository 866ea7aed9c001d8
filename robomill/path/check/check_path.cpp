#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "robomill/path/check/check_state.hpp"

namespace robomill::path {

using Eigen::Vector3d;

// One block more.
bool Checker::State::read() {
  if (ended_) return false;
  if (window_.full()) {
    if (open_ == window_.low()) close();
    window_.drop();
  }
  ended_ = !window_.read();
  if (ended_) return false;
  const std::size_t last = window_.high() - 1;
  if (last > window_.low() && window_.segment(last).dwell_s > 0.0) {  // dwells in a row are one
    window_.segment(last).dwell_s += window_.segment(last - 1).dwell_s;
    window_.segment(last - 1).dwell_s = 0.0;
  }
  return true;
}

// Blocks up to the named one, those near it, and where they are short as many as the tolerances may hide.
void Checker::State::advance(std::size_t block) {
  while (window_.high() <= block + near_blocks) {
    if (!read()) return;
  }
  if (block < window_.low() || block == reached_) return;
  reached_ = block;
  double length_m = 0.0, angle_rad = 0.0;
  for (std::size_t i = block + 1; i <= block + far_blocks; ++i) {
    const bool enough = (length_m == 0.0 || length_m > 2.0 * options_.tip_tolerance_m) &&
                        (angle_rad == 0.0 || angle_rad > 2.0 * options_.axis_tolerance_rad);
    if (enough && i > block + near_blocks) return;
    if (i >= window_.high() && !read()) return;
    length_m += window_.segment(i).length_m;
    angle_rad += window_.segment(i).angle_rad;
  }
}

// Where the tip is programmed to stand it moves only as its neighbours lend it.
double Checker::State::tip_feed_of(std::size_t block) const {
  if (window_.segment(block).length_m > 0.0) return window_.segment(block).tip_feed_m_per_s;
  double feed = 0.0;
  for (std::size_t i = block; i-- > window_.low() && block - i <= near_blocks;) {
    if (window_.segment(i).length_m > 0.0) {
      feed = window_.segment(i).tip_feed_m_per_s;
      break;
    }
  }
  for (std::size_t i = block + 1; i < window_.high() && i - block <= near_blocks; ++i) {
    if (window_.segment(i).length_m > 0.0) return std::max(feed, window_.segment(i).tip_feed_m_per_s);
  }
  return feed;
}

// … and where the axis alone moves, the blocks before and after it may lend it theirs.
double Checker::State::axis_feed_of(std::size_t block) const {
  double feed = window_.segment(block).axis_feed_rad_per_s;
  for (std::size_t i = block; i-- > window_.low();) {
    feed = std::max(feed, window_.segment(i).axis_feed_rad_per_s);
    if (window_.segment(i).moves() || block - i >= near_blocks) break;
  }
  for (std::size_t i = block + 1; i < window_.high(); ++i) {
    feed = std::max(feed, window_.segment(i).axis_feed_rad_per_s);
    if (window_.segment(i).moves() || i - block >= near_blocks) break;
  }
  return feed;
}

void Checker::State::feed(const Vector3d& tip_step, const Vector3d& axis_step) {
  if (window_.high() == 0) return;
  const std::size_t from = std::max(std::min(block_before_, block_), window_.low());
  const std::size_t to = std::max(block_before_, block_);
  double tip_feed = 0.0, axis_feed = 0.0;
  bool axis_alone = true;
  for (std::size_t i = from; i <= to && i < window_.high(); ++i) {
    const CheckedBlock& segment = window_.segment(i);
    if (segment.length_m > 0.0) axis_alone = false;
    tip_feed = std::max(tip_feed, tip_feed_of(i));
    if (axis_alone) axis_feed = std::max(axis_feed, axis_feed_of(i));
  }
  const double rate = 1.0 / options_.sample_period_s;
  const Place place = {.time_s = std::max(first_time_s_, time_s_ - 0.5 * options_.sample_period_s), .block = block_};
  if (tip_feed > 0.0) feed_.note(tip_step.norm() * rate / tip_feed, place, book_);
  if (axis_alone && axis_feed > 0.0) {
    feed_.note(angle_of_chord(axis_step.norm()) * rate / axis_feed, place, book_);
  }
}

// The least distance from the blocks around the named one; stops looking where it is `enough`.
template <class Distance>
double Checker::State::nearest(double enough, double tolerance, Distance&& distance) const {
  double best = distance(window_.segment(block_));
  for (std::size_t off = 1; off <= far_blocks && best > enough; ++off) {
    if (off > near_blocks && best <= tolerance) break;
    if (block_ >= window_.low() + off) best = std::min(best, distance(window_.segment(block_ - off)));
    if (block_ + off < window_.high()) best = std::min(best, distance(window_.segment(block_ + off)));
  }
  return best;
}

void Checker::State::errors(const Sample& sample) {
  const Place place = {.time_s = sample.time_s, .block = block_};
  if (window_.high() == 0) {  // an empty program: the tool stands at its start
    tip_error_.note((sample.tip_m - window_.start().tip_m).norm(), place, book_);
    axis_error_.note(angle_of_chord((sample.axis - window_.start().axis).norm()), place, book_);
    return;
  }
  const auto find = [&](double& tip_m, double& axis_rad) {
    tip_m = nearest(std::max(tip_error_.quiet(), 1e-3 * options_.tip_tolerance_m), options_.tip_tolerance_m,
                    [&](const CheckedBlock& segment) { return segment.tip_distance_m(sample.tip_m); });
    axis_rad = nearest(std::max(axis_error_.quiet(), 1e-3 * options_.axis_tolerance_rad), options_.axis_tolerance_rad,
                       [&](const CheckedBlock& segment) { return segment.axis_distance_rad(sample.axis); });
  };
  double tip_m = 0.0, axis_rad = 0.0;
  find(tip_m, axis_rad);
  if (tip_m > options_.tip_tolerance_m || axis_rad > options_.axis_tolerance_rad) {
    bool more = false;  // look further ahead before it is called a violation
    while (window_.high() <= block_ + far_blocks && read()) more = true;
    if (more) find(tip_m, axis_rad);
  }
  tip_error_.note(tip_m, place, book_);
  axis_error_.note(axis_rad, place, book_);
  const CheckedBlock& segment = window_.segment(block_);
  if (segment.length_m > options_.tip_tolerance_m) {
    synchrony_.note(angle_of_chord((sample.axis - segment.axis_beside(sample.tip_m)).norm()), place, book_);
  }
}

void Checker::State::pass(Pass& pass, const Vector3d& corner, const Vector3d& from, const Vector3d& to,
                          double travelled, double tolerance, double time_s) {
  const double distance = chord_distance(corner, from, to);
  if (distance < pass.best) {
    pass.best = distance;
    pass.at_s = time_s;
  }
  const double beyond = (to - corner).norm();
  pass.wake = travelled + std::max(beyond - pass.best, 0.5 * (beyond - 4.0 * tolerance));
}

void Checker::State::corners(const Vector3d& tip_from, const Vector3d& tip_to, const Vector3d& axis_from,
                             const Vector3d& axis_to) {
  const double tip_enough = std::max(tip_error_.quiet(), 1e-3 * options_.tip_tolerance_m);
  const double axis_enough = std::max(axis_error_.quiet(), 1e-3 * options_.axis_tolerance_rad);
  for (std::size_t i = open_; i < window_.high(); ++i) {
    Corner& corner = window_.corner(i);
    if (tip_travelled_ >= corner.tip.wake) {
      pass(corner.tip, window_.segment(i).tip_end_m, tip_from, tip_to, tip_travelled_, options_.tip_tolerance_m,
           time_s_);
      if (corner.tip.best <= tip_enough) corner.tip.wake = never;
    }
    if (axis_travelled_ >= corner.axis.wake) {
      pass(corner.axis, window_.segment(i).axis_end, axis_from, axis_to, axis_travelled_, options_.axis_tolerance_rad,
           time_s_);
      if (corner.axis.best <= axis_enough) corner.axis.wake = never;
    }
  }
}

void Checker::State::stand(const Vector3d& tip_step, const Vector3d& axis_step) {
  const double share = options_.sample_period_s / still_time_s;
  if (tip_step.norm() > share * options_.tip_tolerance_m || axis_step.norm() > share * options_.axis_tolerance_rad) {
    still_s_ = 0.0;
    still_from_ = block_;
    return;
  }
  if (still_s_ == 0.0) still_from_ = std::min(block_before_, block_);
  still_s_ += options_.sample_period_s;
  const Vector3d tip = row_.segment<3>(6), axis = row_.tail<3>();
  const std::size_t from = still_from_ > 0 ? still_from_ - 1 : 0;
  for (std::size_t i = std::max(from, window_.low()); i < window_.high(); ++i) {
    // Blocks that do not move may stand between the one named and its dwell.
    if (i > block_ + 1 && window_.segment(i - 1).moves()) break;
    const CheckedBlock& segment = window_.segment(i);
    if (segment.dwell_s > 0.0 && (tip - segment.tip_end_m).norm() <= options_.tip_tolerance_m &&
        (axis - segment.axis_end).norm() <= options_.axis_tolerance_rad) {
      window_.corner(i).still_s = std::max(window_.corner(i).still_s, still_s_);
    }
  }
}

// Accounts for the end of the first open block.
void Checker::State::close() {
  Corner& corner = window_.corner(open_);
  const CheckedBlock& segment = window_.segment(open_);
  if (corner.tip.wake != never) tip_error_.note(corner.tip.best, {.time_s = corner.tip.at_s, .block = open_}, book_);
  if (corner.axis.wake != never) {
    axis_error_.note(angle_of_chord(corner.axis.best), {.time_s = corner.axis.at_s, .block = open_}, book_);
  }
  if (segment.dwell_s > 0.0) {
    dwell_.note(segment.dwell_s - corner.still_s, {.time_s = time_s_, .block = open_}, book_);
  }
  ++open_;
}

bool Checker::State::finished(std::size_t block) {
  const Corner& corner = window_.corner(block);
  const bool passed = corner.tip.wake == never && corner.axis.wake == never;
  const bool stands = window_.segment(block).dwell_s > 0.0;
  if (passed && !stands) return true;
  const bool within = corner.tip.best <= options_.tip_tolerance_m && corner.axis.best <= options_.axis_tolerance_rad;
  return block_ > block + (within ? near_blocks : far_blocks);
}

void Checker::State::close_old() {
  while (open_ < window_.high() && finished(open_)) close();
  while (window_.low() + far_blocks < block_ && window_.low() < open_) window_.drop();
}

}  // namespace robomill::path
