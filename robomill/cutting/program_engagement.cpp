#include "robomill/cutting/program_engagement.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"

namespace robomill::cutting {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using std::numbers::pi;

constexpr std::size_t ring_grain = 8;
constexpr double most_looks = 1e12;    ///< along a program: hours
constexpr double worth_sharing = 3e4;  ///< looks; fewer are done before another thread has woken
constexpr double sliding = 1e-9;       ///< n·v of a face that slides along, from rounding, per speed

/// a sin φ + b cos φ + c > 0 on at most one range of φ.
std::optional<Arc> positive_arc(double a, double b, double c) {
  const double size = std::hypot(a, b);
  if (c >= size) return c > 0.0 ? std::optional(Arc{.entry_rad = 0.0, .exit_rad = 2.0 * pi}) : std::nullopt;
  if (c <= -size) return std::nullopt;
  const double middle = std::atan2(a, b);
  const double half = std::acos(-c / size);
  return Arc{.entry_rad = middle - half, .exit_rad = middle + half};
}

/// A pose with directions across its axis.
struct Stand {
  Vector3d tip, x, y, z;
  Vector3d velocity, turn;
  /// At most that of a ring's points.
  [[nodiscard]] double speed(const EdgeSlice& slice) const {
    return velocity.norm() + turn.norm() * (slice.radius_m + slice.height_m);
  }
};

struct Ring {
  const EdgeSlice& slice;
  const Stand& stand;
  const Workpiece& part;
  double ahead = 0.0;

  [[nodiscard]] Vector3d point(double phi) const {
    return stand.tip + slice.radius_m * (std::sin(phi) * stand.x + std::cos(phi) * stand.y) + slice.height_m * stand.z;
  }
  [[nodiscard]] double depth(double phi) const {
    Vector3d p = point(phi);
    if (ahead > 0.0) {
      const Vector3d v = stand.velocity + stand.turn.cross(p - stand.tip);
      if (const double speed = v.norm(); speed > 0.0) p += ahead / speed * v;
    }
    return part.depth_m(p);
  }
  /// Where depth changes sign between two angles of unlike sign.
  [[nodiscard]] double edge(double a, double depth_a, double b, double depth_b, double close) const {
    double weight_a = depth_a;
    double weight_b = depth_b;
    for (int i = 0; i < 40 && b - a > close; ++i) {
      const double share = std::clamp(weight_a / (weight_a - weight_b), 0.1, 0.9);
      const double middle = a + share * (b - a);
      const double at = depth(middle);
      if ((at > 0.0) == (depth_a > 0.0)) {  // Illinois: a side that stays is halved
        a = middle;
        weight_a = at;
        weight_b *= 0.5;
      } else {
        b = middle;
        weight_b = at;
        weight_a *= 0.5;
      }
    }
    return 0.5 * (a + b);
  }
};

Arc normalised(double entry, double exit) {
  const double turn = 2.0 * pi;
  double start = entry - turn * std::floor(entry / turn);
  if (start >= turn) start = 0.0;  // what lies a rounding below 0
  return {.entry_rad = start, .exit_rad = start + std::min(exit - entry, turn)};
}

/// Front of the ring by its normals and velocities, then material on it.
void look(const Ring& ring, double angle_step, double close_m, std::vector<Arc>& arcs) {
  arcs.clear();
  const EdgeSlice& s = ring.slice;
  const Stand& stand = ring.stand;
  const double sine = std::sin(s.position_rad);
  const double cosine = std::cos(s.position_rad);
  // n·v = n·v_tip + ω·(p × n), p × n = (r cos κ + z sin κ) e_z × e_r
  const double lever = s.radius_m * cosine + s.height_m * sine;
  const std::optional<Arc> front =
      positive_arc(sine * stand.velocity.dot(stand.x) + lever * stand.turn.dot(stand.z.cross(stand.x)),
                   sine * stand.velocity.dot(stand.y) + lever * stand.turn.dot(stand.z.cross(stand.y)),
                   -cosine * stand.velocity.dot(stand.z) - sliding * stand.speed(s));
  if (!front) return;
  const double length = front->exit_rad - front->entry_rad;
  const double step = std::max(angle_step, 1e-3);
  const int cells = std::max(static_cast<int>(std::ceil(length / step)), 2);
  const double close = close_m / std::max(s.radius_m, close_m);
  double before = front->entry_rad;
  double depth_before = ring.depth(before);
  double entry = before;
  for (int i = 1; i <= cells; ++i) {
    const double phi = front->entry_rad + length * i / cells;
    const double depth = ring.depth(phi);
    if ((depth > 0.0) != (depth_before > 0.0)) {
      const double edge = ring.edge(before, depth_before, phi, depth, close);
      if (depth > 0.0) {
        entry = edge;
      } else {
        arcs.push_back(normalised(entry, edge));
      }
    }
    before = phi;
    depth_before = depth;
  }
  if (depth_before > 0.0) arcs.push_back(normalised(entry, before));
}

/// What cuts: its middle, and how far it reaches.
struct Patch {
  Vector3d middle = Vector3d::Zero();
  double area = 0.0;
};

Patch patch_of(const std::vector<EdgeSlice>& slices, const std::vector<std::vector<Arc>>& arcs, const Stand& stand) {
  Patch out;
  for (std::size_t i = 0; i < slices.size(); ++i) {
    const EdgeSlice& s = slices[i];
    for (const Arc& arc : arcs[i]) {
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
  for (Arc& arc : e.arcs) arc = normalised(arc.entry_rad - by, arc.exit_rad - by);
}

}  // namespace

void WalkOptions::validate() const {
  require_non_negative("ring_width_m", ring_width_m, "m");
  require_non_negative("angle_step_rad", angle_step_rad, "rad");
  require_non_negative("max_step_m", max_step_m, "m");
  require_positive("max_turn_rad", max_turn_rad, "rad");
  if (batch < 1) throw InvalidInput("batch", static_cast<double>(batch), "", "must be at least 1");
}

EngagementFinder::EngagementFinder(const Cutter& cutter, double dexel_m, const WalkOptions& options)
    : dexel_m_(dexel_m) {
  options.validate();
  require_positive("dexel_m", dexel_m, "m");
  const Profile profile(cutter);
  angle_step_rad_ = options.angle_step_rad > 0.0 ? options.angle_step_rad : pi / 18.0;
  step_m_ = options.angle_step_rad > 0.0 ? 0.0 : 2.0 * dexel_m;
  for (const Profile::Piece& piece : profile.pieces()) {
    const bool side = piece.arc_radius_m == 0.0 && piece.first.position_rad > 0.25 * pi;
    const double width = options.ring_width_m > 0.0 ? options.ring_width_m : dexel_m;
    const double least = options.ring_width_m > 0.0 || side ? 1.0 : 12.0;
    const double count = std::clamp(std::ceil(piece.length_m / width - 1e-9), least, 1e5);
    for (double i = 0.0; i < count; i += 1.0) {
      const Profile::Point at = profile.at(piece.start_m + piece.length_m * (i + 0.5) / count);
      slices_.push_back({.radius_m = at.radius_m,
                         .height_m = at.height_m,
                         .position_rad = at.position_rad,
                         .width_m = piece.length_m / count,
                         .edge_length_per_width = edge_length_per_width(cutter.mill, 0, at)});
    }
  }
  for (const EdgeSlice& slice : slices_) looks_ += 2.0 * pi / step_rad(slice);
  ring_grain_ = looks_ > worth_sharing ? ring_grain : slices_.size();
}

double EngagementFinder::step_rad(const EdgeSlice& slice) const {
  return step_m_ > 0.0 ? std::min(step_m_ / slice.radius_m, angle_step_rad_) : angle_step_rad_;
}

PoseEngagement EngagementFinder::at(const Workpiece& workpiece, const program::Pose& pose, const Motion& motion,
                                    double ahead_m) const {
  PoseEngagement out;
  Matrix3d frame = feed_frame(
      motion.tip_m_per_s.squaredNorm() > 0.0 ? motion.tip_m_per_s : Vector3d(pose.axis.unitOrthogonal()), pose.axis);
  Stand stand = {.tip = pose.tip_m,
                 .x = frame.col(1).cross(pose.axis),
                 .y = frame.col(1),
                 .z = pose.axis,
                 .velocity = motion.tip_m_per_s,
                 .turn = motion.turn_rad_per_s};
  std::vector<std::vector<Arc>> arcs(slices_.size());
  parallel_for(slices_.size(), ring_grain_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Ring ring = {.slice = slices_[i], .stand = stand, .part = workpiece, .ahead = ahead_m};
      look(ring, step_rad(slices_[i]), 0.01 * dexel_m_, arcs[i]);
    }
  });
  Engagement& e = out.engagement;
  for (std::size_t i = 0; i < slices_.size(); ++i) {
    if (arcs[i].empty()) continue;
    e.slices.push_back(slices_[i]);
    e.first_arc.push_back(e.arcs.size());
    e.arcs.insert(e.arcs.end(), arcs[i].begin(), arcs[i].end());
  }
  e.first_arc.push_back(e.arcs.size());
  const Patch patch = patch_of(slices_, arcs, stand);
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

Stock stock_about(const program::Program& program, const Cutter& cutter, double dexel_m, double axial_depth_m) {
  require_positive("dexel_m", dexel_m, "m");
  require_positive("axial_depth_m", axial_depth_m, "m");
  const double radius = Profile(cutter).max_radius_m();
  Stock stock;
  stock.min_m.setConstant(1e300);
  stock.max_m.setConstant(-1e300);
  for (std::size_t i = 0; i < program.blocks.size(); ++i) {
    if (program.blocks[i].kind != program::Block::Kind::feed) continue;
    for (const Vector3d& tip : {program.begin_of(i).tip_m, program.blocks[i].end.tip_m}) {
      stock.min_m = stock.min_m.cwiseMin(tip);
      stock.max_m = stock.max_m.cwiseMax(tip);
    }
  }
  if (stock.min_m.x() > stock.max_m.x()) throw InvalidInput("program", "has no feed move", "It would cut nothing");
  stock.min_m -= Vector3d(radius, radius, dexel_m);
  stock.max_m += Vector3d(radius, radius, axial_depth_m);
  return stock;
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
    double poses = 0.0;
    for (std::size_t i = 0; i < program.blocks.size(); ++i) poses += parts_of(i);
    if (!(poses * finder_.looks() <= most_looks)) {
      throw InvalidInput("dexel_m", workpiece.dexel_m(), "m",
                         "asks for more than 1e12 looks at the material along this program",
                         "Give a larger one, or a shorter program");
    }
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

  void begin_block() {
    const program::Block& block = program_.blocks[block_];
    const program::Pose& begin = program_.begin_of(block_);
    at_ = begin;
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
    part.share_from = static_cast<double>(part_ - 1) / parts;
    part.share_to = static_cast<double>(part_) / parts;
    part.duration_s = block.duration_s / parts;
    part.pose = part_ == parts_ ? block.end : program::between(program_.begin_of(block_), block.end, part.share_to);
    if (block.kind == program::Block::Kind::dwell) return;  // the tool stands where it has cut already
    if (feed) part.cut = finder_.at(workpiece_, part.pose, motion_, std::max(0.0, 0.5 * dexel - way_m_ / parts));
    const Removal removal = workpiece_.remove(profile_, at_, part.pose);
    part.removed_volume_m3 = removal.volume_m3();
    part.shank_volume_m3 = removal.shank_volume_m3();
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
