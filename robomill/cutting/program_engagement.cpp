#include "robomill/cutting/program_engagement.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "robomill/base/cost.hpp"
#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/cutting/dexels/ring_look.hpp"

namespace robomill::cutting {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using std::numbers::pi;

constexpr std::size_t ring_grain = 8;
constexpr double operations_of_look = 60.0;  ///< at the material, with what is taken away
constexpr double looks_worth_sharing = 3e4;  ///< looks; fewer are done before another thread has woken

using detail::RingLook;
using detail::Seen;
using detail::Stand;

/// What cuts: its middle, and how far it reaches.
struct Patch {
  Vector3d middle = Vector3d::Zero();
  double area = 0.0;
};

Patch patch_of(const Engagement& e, const Stand& stand) {
  Patch out;
  for (std::size_t i = 0; i < e.slices.size(); ++i) {
    const EdgeSlice& s = e.slices[i];
    for (const Arc& arc : e.of(i)) {
      const double length = arc.exit_rad - arc.entry_rad;
      const double area = s.radius_m * s.width_m * length;
      const Vector3d across = (std::cos(arc.entry_rad) - std::cos(arc.exit_rad)) * stand.x +
                              (std::sin(arc.exit_rad) - std::sin(arc.entry_rad)) * stand.y;
      out.middle += area * (s.height_m * stand.z) + s.radius_m * s.width_m * s.radius_m * across;
      out.area += area;
    }
  }
  if (out.area > 0.0) out.middle /= out.area;
  return out;
}

/// x along v, z the axis without its part along x.
Matrix3d feed_frame(const Vector3d& v, const Vector3d& axis) {
  const Vector3d x = v.normalized();
  Vector3d z = axis - axis.dot(x) * x;
  if (z.norm() < 1e-6) z = x.unitOrthogonal();
  z.normalize();
  Matrix3d frame;
  frame << x, z.cross(x), z;
  return frame;
}

/// Least and most of a sin φ + b cos φ over an arc.
void widen(double a, double b, const Arc& arc, double& least, double& most) {
  const auto at = [&](double phi) { return a * std::sin(phi) + b * std::cos(phi); };
  for (const double phi : {arc.entry_rad, arc.exit_rad}) {
    least = std::min(least, at(phi));
    most = std::max(most, at(phi));
  }
  const double top = std::atan2(a, b);
  for (int k = -1; k <= 4; ++k) {
    const double phi = top + k * pi;
    if (phi <= arc.entry_rad || phi >= arc.exit_rad) continue;
    least = std::min(least, at(phi));
    most = std::max(most, at(phi));
  }
}

void measure(const Stand& stand, PoseEngagement& out) {
  double low = 1e300;
  double high = -1e300;
  double left = -1e300;
  double right = 1e300;
  const Engagement& e = out.engagement;
  const Vector3d y = out.work_from_feed.col(1);
  for (std::size_t i = 0; i < e.slices.size(); ++i) {
    const EdgeSlice& s = e.slices[i];
    const double half = 0.5 * s.width_m * std::sin(s.position_rad);  // of its height
    low = std::min(low, s.height_m - half);
    high = std::max(high, s.height_m + half);
    const double offset = s.height_m * y.dot(stand.z);
    for (const Arc& arc : e.of(i)) {
      double least = 1e300;
      double most = -1e300;
      widen(s.radius_m * y.dot(stand.x), s.radius_m * y.dot(stand.y), arc, least, most);
      right = std::min(right, offset + least);
      left = std::max(left, offset + most);
    }
  }
  out.axial_depth_m = std::max(high - low, 0.0);
  out.radial_depth_m = std::max(left - right, 0.0);
}

/// Turns arcs about the axis: φ' = φ - by.
void turn_arcs(Engagement& e, double by) {
  for (Arc& arc : e.arcs) arc = detail::normalised(arc.entry_rad - by, arc.exit_rad - by);
}

}  // namespace

void WalkOptions::validate() const {
  require_non_negative("ring_width_m", ring_width_m, "m");
  require_non_negative("angle_step_rad", angle_step_rad, "rad");
  require_non_negative("max_step_m", max_step_m, "m");
  require_positive("max_turn_rad", max_turn_rad, "rad");
  if (batch < 1) throw InvalidInput("batch", static_cast<double>(batch), "", "must be at least 1");
  for (const Vector3d& offset_m : tip_offset_m) {
    if (!offset_m.allFinite()) throw InvalidInput("tip_offset_m", "must be finite");
  }
}

/// Goes along the profile piece by piece, whose rings were looked at in their middles, and adds those parts of it that
/// cut. Where the cut begins or ends between two looks the border is found, so that no ring is in it by halves.
class EngagementFinder::Gather {
 public:
  Gather(const EngagementFinder& finder, const RingLook& look, Engagement& out)
      : finder_(finder), look_(look), out_(out) {}

  void piece(const Cells& cells, std::span<const Seen> middles) {
    const Seen first = seen_first(cells, middles.front());
    const Seen last = middles.back().arcs.empty() ? middles.back() : seen_end(cells.last);
    const double end = cells.start_m + static_cast<double>(cells.count) * cells.width_m;
    double from = cells.start_m;
    double at = from;
    const Seen* before = &first;
    for (std::size_t i = 0; i <= cells.count; ++i) {
      const Seen& seen = i < cells.count ? middles[i] : last;
      const double place = i < cells.count ? cells.middle(i) : end;
      if (seen.arcs.empty() != before->arcs.empty()) {
        const double border = border_between(at, *before, place, seen);
        if (seen.arcs.empty()) {
          add(cells, middles, from, border);
        } else {
          from = border;
        }
      }
      before = &seen;
      at = place;
    }
    if (!before->arcs.empty()) add(cells, middles, from, end);
  }

 private:
  [[nodiscard]] Seen seen_end(const EdgeSlice& slice) {
    Seen seen;
    look_.at(slice, finder_.step_rad(slice), seen);
    if (seen.depth_m < close_m()) seen.arcs.clear();  // it may just touch what it has left before
    return seen;
  }
  /// A cut may end below the middle of the first ring. On the axis there is nothing to see.
  [[nodiscard]] Seen seen_first(const Cells& cells, const Seen& middle) {
    return cells.first.radius_m > 0.0 ? seen_end(cells.first) : middle;
  }
  [[nodiscard]] double border_between(double a, const Seen& seen_a, double b, const Seen& seen_b) {
    // The depth of a ring without arcs may be 0, where it only touches.
    const auto signed_depth = [](const Seen& seen) {
      constexpr double least = 1e-12;
      return seen.arcs.empty() ? std::min(seen.depth_m, -least) : std::max(seen.depth_m, least);
    };
    const auto depth_at = [&](double place) {
      const EdgeSlice slice = finder_.slice_at(place, 0.0);
      look_.at(slice, finder_.step_rad(slice), seen_);
      return signed_depth(seen_);
    };
    return detail::crossing(depth_at, a, signed_depth(seen_a), b, signed_depth(seen_b), close_m(), 0.25 * close_m());
  }
  /// How well a border is found.
  [[nodiscard]] double close_m() const { return 0.02 * finder_.dexel_m_; }

  /// Rings of the piece between two places, the first and the last cut off there.
  void add(const Cells& cells, std::span<const Seen> middles, double from, double to) {
    for (std::size_t i = 0; i < cells.count; ++i) {
      const double low = std::max(from, cells.start_m + static_cast<double>(i) * cells.width_m);
      const double high = std::min(to, cells.start_m + static_cast<double>(i + 1) * cells.width_m);
      if (!(high - low > sliver * cells.width_m)) continue;
      if (high - low > (1.0 - sliver) * cells.width_m) {
        push(finder_.slices_[cells.begin + i], middles[i].arcs);
        continue;
      }
      const EdgeSlice slice = finder_.slice_at(0.5 * (low + high), high - low);
      look_.at(slice, finder_.step_rad(slice), seen_);
      if (!seen_.arcs.empty()) push(slice, seen_.arcs);
    }
  }

  void push(const EdgeSlice& slice, const std::vector<Arc>& arcs) {
    out_.slices.push_back(slice);
    out_.first_arc.push_back(out_.arcs.size());
    out_.arcs.insert(out_.arcs.end(), arcs.begin(), arcs.end());
  }

  static constexpr double sliver = 1e-6;  ///< of a ring's width
  const EngagementFinder& finder_;
  const RingLook& look_;
  Engagement& out_;
  Seen seen_;
};

EngagementFinder::EngagementFinder(const Cutter& cutter, double dexel_m, const WalkOptions& options)
    : profile_(cutter), mill_(cutter.mill), dexel_m_(dexel_m) {
  options.validate();
  require_positive("dexel_m", dexel_m, "m");
  angle_step_rad_ = options.angle_step_rad > 0.0 ? options.angle_step_rad : pi / 18.0;
  step_m_ = options.angle_step_rad > 0.0 ? 0.0 : 2.0 * dexel_m;
  for (const Profile::Piece& piece : profile_.pieces()) {
    const bool side = piece.arc_radius_m == 0.0 && piece.first.position_rad > 0.25 * pi;
    const double width = options.ring_width_m > 0.0 ? options.ring_width_m : dexel_m;
    const double least = options.ring_width_m > 0.0 || side ? 1.0 : 12.0;
    const double count = std::clamp(std::ceil(piece.length_m / width - 1e-9), least, 1e5);
    const Cells cells = {.start_m = piece.start_m,
                         .width_m = piece.length_m / count,
                         .begin = slices_.size(),
                         .count = static_cast<std::size_t>(count),
                         .first = slice_at(piece.first, 0.0),
                         .last = slice_at(piece.last, 0.0)};
    for (std::size_t i = 0; i < cells.count; ++i) slices_.push_back(slice_at(cells.middle(i), cells.width_m));
    cells_.push_back(cells);
  }
  for (const EdgeSlice& slice : slices_) looks_ += 2.0 * pi / step_rad(slice);
  ring_grain_ = looks_ > looks_worth_sharing ? ring_grain : slices_.size();
}

EdgeSlice EngagementFinder::slice_at(const Profile::Point& at, double width_m) const {
  return {.radius_m = at.radius_m,
          .height_m = at.height_m,
          .position_rad = at.position_rad,
          .width_m = width_m,
          .edge_length_per_width = edge_length_per_width(mill_, 0, at)};
}

double EngagementFinder::step_rad(const EdgeSlice& slice) const {
  return step_m_ > 0.0 ? std::min(step_m_ / slice.radius_m, angle_step_rad_) : angle_step_rad_;
}

PoseEngagement EngagementFinder::at(const Workpiece& workpiece, const program::Pose& pose, const Motion& motion,
                                    double ahead_m) const {
  PoseEngagement out;
  Matrix3d frame = feed_frame(
      motion.tip_m_per_s.squaredNorm() > 0.0 ? motion.tip_m_per_s : Vector3d(pose.axis.unitOrthogonal()), pose.axis);
  const Stand stand = {.tip = pose.tip_m,
                       .x = frame.col(1).cross(pose.axis),
                       .y = frame.col(1),
                       .z = pose.axis,
                       .velocity = motion.tip_m_per_s,
                       .turn = motion.turn_rad_per_s};
  const RingLook look = {.stand = stand, .part = workpiece, .ahead_m = ahead_m, .close_m = 0.01 * dexel_m_};
  std::vector<Seen> seen(slices_.size());
  parallel_for(slices_.size(), ring_grain_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) look.at(slices_[i], step_rad(slices_[i]), seen[i]);
  });
  Engagement& e = out.engagement;
  Gather gather(*this, look, e);
  for (const Cells& cells : cells_) gather.piece(cells, std::span(seen).subspan(cells.begin, cells.count));
  e.first_arc.push_back(e.arcs.size());
  const Patch patch = patch_of(e, stand);
  const Vector3d velocity = motion.tip_m_per_s + motion.turn_rad_per_s.cross(patch.middle);
  out.feed_speed_m_per_s = velocity.norm();
  if (out.feed_speed_m_per_s > 0.0) frame = feed_frame(velocity, pose.axis);
  out.work_from_feed = frame;
  measure(stand, out);
  // T takes its y from F: what was found about the first y is turned on.
  const Vector3d y = frame.col(1);
  const Vector3d y_across = (y - y.dot(pose.axis) * pose.axis).normalized();
  turn_arcs(e, std::atan2(y_across.dot(stand.x), y_across.dot(stand.y)));
  Matrix3d tool;
  tool << y_across.cross(pose.axis), y_across, pose.axis;
  e.feed_from_tool = frame.transpose() * tool;
  return out;
}

namespace {

/// Goes through a program part by part.
class Walker {
 public:
  Walker(const program::Program& program, const Cutter& cutter, Workpiece& workpiece, const WalkOptions& options,
         Progress& progress)
      : program_(program),
        workpiece_(workpiece),
        options_(options),
        progress_(progress),
        finder_(cutter, workpiece.dexel_m(), options),
        profile_(cutter),
        max_step_m_(options.max_step_m > 0.0 ? options.max_step_m : 0.5 * profile_.max_radius_m()) {
    if (!options.tip_offset_m.empty() && options.tip_offset_m.size() != program.blocks.size()) {
      throw InvalidInput("tip_offset_m", "must hold one offset a block of the program");
    }
    double poses = 0.0;
    for (std::size_t i = 0; i < program.blocks.size(); ++i) poses += parts_of(i);
    constexpr double usual_dexel_m = 2.5e-4, usual_poses = 10'000.0;
    require_affordable(
        {.operations = operations_of_look * poses * finder_.looks(),
         .dominant = dominant_of(
             {{.field = "dexel_m",
               .value = workpiece.dexel_m(),
               .unit = "m",
               .times_usual = std::pow(usual_dexel_m / workpiece.dexel_m(), 2)},
              {.field = "program, parts of its blocks", .value = poses, .times_usual = poses / usual_poses}})});
  }

  /// Up to a batch of further parts; none at the end.
  void fill(std::vector<BlockEngagement>& batch) {
    batch.clear();
    while (batch.size() < options_.batch && block_ < program_.blocks.size()) {
      if (part_ == 0) begin_block();
      progress_.check();
      ++part_;
      cut_part(batch.emplace_back());
      if (part_ < parts_) continue;
      part_ = 0;
      ++block_;
      progress_.advance();
    }
  }

 private:
  /// Into how many parts a block is cut.
  [[nodiscard]] double parts_of(std::size_t index) const {
    const program::Block& block = program_.blocks[index];
    if (block.kind != program::Block::Kind::feed) return 1.0;
    const program::Pose& begin = program_.begin_of(index);
    const double way_m = (block.end.tip_m - begin.tip_m).norm();
    const double turn = program::angle_between(begin.axis, block.end.axis);
    return std::max({std::ceil(way_m / max_step_m_), std::ceil(turn / options_.max_turn_rad), 1.0});
  }

  [[nodiscard]] Vector3d offset_m() const {
    return options_.tip_offset_m.empty() ? Vector3d(Vector3d::Zero()) : options_.tip_offset_m[block_];
  }

  void begin_block() {
    const program::Block& block = program_.blocks[block_];
    const program::Pose& begin = program_.begin_of(block_);
    at_ = begin;
    at_.tip_m += offset_m();
    motion_ = {};
    parts_ = static_cast<std::size_t>(parts_of(block_));
    way_m_ = (block.end.tip_m - begin.tip_m).norm();
    if (block.kind != program::Block::Kind::feed) return;
    require_positive("duration_s", block.duration_s, "s", "A feed move takes time");
    const double turn = program::angle_between(begin.axis, block.end.axis);
    motion_.tip_m_per_s = (block.end.tip_m - begin.tip_m) / block.duration_s;
    if (turn > 0.0) {
      motion_.turn_rad_per_s = begin.axis.cross(block.end.axis).normalized() * (turn / block.duration_s);
    }
  }

  void cut_part(BlockEngagement& part) {
    const program::Block& block = program_.blocks[block_];
    const bool feed = block.kind == program::Block::Kind::feed;
    const auto parts = static_cast<double>(parts_);
    const double dexel = workpiece_.dexel_m();
    part.block = block_;
    part.share_to = static_cast<double>(part_) / parts;
    part.duration_s = block.duration_s / parts;
    part.pose = part_ == parts_ ? block.end : program::between(program_.begin_of(block_), block.end, part.share_to);
    part.pose.tip_m += offset_m();
    if (block.kind == program::Block::Kind::dwell) return;  // the tool stands where it has cut already
    if (feed) part.cut = finder_.at(workpiece_, part.pose, motion_, std::max(0.0, 0.5 * dexel - way_m_ / parts));
    const Removal removal = workpiece_.remove(profile_, at_, part.pose);
    part.removed_volume_m3 = removal.volume_m3();
    part.shank_depth_m = removal.shank_depth_m;
    part.shank = removal.shank_depth_m > dexel;
    part.rapid_in_material = !feed && part.removed_volume_m3 > dexel * dexel * dexel;
    at_ = part.pose;
  }

  const program::Program& program_;
  Workpiece& workpiece_;
  const WalkOptions& options_;
  Progress& progress_;
  EngagementFinder finder_;
  Profile profile_;
  double max_step_m_;
  std::size_t block_ = 0, part_ = 0, parts_ = 1;
  double way_m_ = 0.0;
  program::Pose at_;
  Motion motion_;
};

}  // namespace

void walk(const program::Program& program, const Cutter& cutter, Workpiece& workpiece, const WalkOptions& options,
          const Deliver& deliver, Progress& progress) {
  Walker walker(program, cutter, workpiece, options, progress);
  progress.start("engagement", program.blocks.size());
  std::vector<BlockEngagement> ready;
  std::vector<BlockEngagement> next;
  walker.fill(ready);
  while (!ready.empty()) {
    parallel_for(2, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t task = begin; task < end; ++task) {
        if (task == 0) {
          deliver(ready);
        } else {
          walker.fill(next);
        }
      }
    });
    ready.swap(next);
  }
}

}  // namespace robomill::cutting
