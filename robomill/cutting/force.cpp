#include "robomill/cutting/force.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/cutting/chip.hpp"
#include "robomill/cutting/cut_limits.hpp"
#include "robomill/cutting/degrees.hpp"
#include "robomill/cutting/larger.hpp"
#include "robomill/cutting/polynomial.hpp"

namespace robomill::cutting {
namespace {

using detail::larger;
using detail::polynomial;
using std::numbers::pi;

[[noreturn]] void reject_negative(const char* field, double value, double position) {
  throw InvalidInput(field, value, "N/m^2",
                     "must not be negative; it is at a position angle of " + detail::degrees(position) + " degrees",
                     "The polynomial's powers run from the highest down, its angle is in rad from the tip's pole");
}

void check_polynomial(const char* field, const std::vector<double>& entries, const char* unit) {
  for (std::size_t i = 0; i < entries.size(); ++i) {
    require_finite(std::string(field).append("[").append(std::to_string(i + 1)).append("]").c_str(), entries[i], unit);
  }
}

struct Range {
  double least = 0.0, most = 0.0;
  double least_at = 0.0;
};

Range range_of(const std::vector<double>& entries, double from, double to) {
  const int samples = entries.size() > 1 ? 1000 : 1;  // a constant is the same everywhere
  Range range = {.least = 1e300, .most = -1e300};
  for (int i = 0; i <= samples; ++i) {
    const double at = from + (to - from) * i / samples;
    const double value = polynomial(entries, at);
    range.most = std::max(range.most, value);
    if (value >= range.least) continue;
    range.least = value;
    range.least_at = at;
  }
  return range;
}

void check_cutting(const char* field, const std::vector<double>& entries, double from, double to,
                   bool may_be_negative) {
  constexpr const char* hint = "Aluminium is near 700 N/mm^2 = 7e8 N/m^2; are the units mixed up?";
  check_polynomial(field, entries, "N/m^2");
  const Range range = range_of(entries, from, to);
  if (!may_be_negative && range.least < 0.0) reject_negative(field, range.least, range.least_at);
  const double size = std::max(range.most, -range.least);
  if (size == 0.0) return;
  if (size < 1e6) throw InvalidInput(field, size, "N/m^2", "is too small for any material", hint);
  if (size > 1e12) throw InvalidInput(field, size, "N/m^2", "is too large for any material", hint);
}

void check_edge(const char* field, const std::vector<double>& entries, double from, double to) {
  check_polynomial(field, entries, "N/m");
  const Range range = range_of(entries, from, to);
  const double size = std::max(range.most, -range.least);
  if (size > 1e7) {
    throw InvalidInput(field, size, "N/m", "is too large for any edge",
                       "30 N/mm = 3e4 N/m is usual; are the units mixed up?");
  }
}

/// A mean over a step, or a part of it, of what an edge element feels, as harmonics of an angle: the force across the
/// axis as y + i x, (fy, fx) = turning[0] + turning[1] e^{iφ} + turning[2] e^{2iφ}, force along the axis and torque as
/// constant + Re(first e^{iφ}).
struct Harmonics {
  enum : std::size_t { y0, x0, y1, x1, y2, x2, z0, z1, z1i, m0, m1, m1i, count };
  std::array<double, count> c = {};
};

struct Turn {
  double cosine = 1.0, sine = 0.0;
};

Turn turn_by(double angle) {
  return {.cosine = std::cos(angle), .sine = std::sin(angle)};
}
Turn twice(const Turn& t) {
  return {.cosine = (t.cosine - t.sine) * (t.cosine + t.sine), .sine = 2.0 * t.cosine * t.sine};
}

void turn_pair(double& re, double& im, const Turn& t) {
  const double old = re;
  re = old * t.cosine - im * t.sine;
  im = old * t.sine + im * t.cosine;
}

/// Of the angle φ = θ + α, expressed as harmonics of θ.
void turn(Harmonics& h, const Turn& alpha) {
  using H = Harmonics;
  turn_pair(h.c[H::y1], h.c[H::x1], alpha);
  turn_pair(h.c[H::y2], h.c[H::x2], twice(alpha));
  turn_pair(h.c[H::z1], h.c[H::z1i], alpha);
  turn_pair(h.c[H::m1], h.c[H::m1i], alpha);
}

/// Forces across and along T's axis, and torque.
struct Load {
  double x = 0.0, y = 0.0, z = 0.0, torque = 0.0;
};

Load value(const Harmonics& h, const Turn& at, double first = 1.0, double second = 1.0) {
  using H = Harmonics;
  const Turn two = twice(at);
  const double c1 = first * at.cosine;
  const double s1 = first * at.sine;
  const double c2 = second * two.cosine;
  const double s2 = second * two.sine;
  return {.x = h.c[H::x0] + h.c[H::y1] * s1 + h.c[H::x1] * c1 + h.c[H::y2] * s2 + h.c[H::x2] * c2,
          .y = h.c[H::y0] + h.c[H::y1] * c1 - h.c[H::x1] * s1 + h.c[H::y2] * c2 - h.c[H::x2] * s2,
          .z = h.c[H::z0] + h.c[H::z1] * c1 - h.c[H::z1i] * s1,
          .torque = h.c[H::m0] + h.c[H::m1] * c1 - h.c[H::m1i] * s1};
}

/// Integral over θ between two turns that are `length` apart.
Load integral(const Harmonics& h, const Turn& from, const Turn& to, double length) {
  using H = Harmonics;
  const Turn from2 = twice(from);
  const Turn to2 = twice(to);
  const double c1 = to.sine - from.sine;  // of cos θ
  const double s1 = from.cosine - to.cosine;
  const double c2 = 0.5 * (to2.sine - from2.sine);
  const double s2 = 0.5 * (from2.cosine - to2.cosine);
  return {.x = h.c[H::x0] * length + h.c[H::y1] * s1 + h.c[H::x1] * c1 + h.c[H::y2] * s2 + h.c[H::x2] * c2,
          .y = h.c[H::y0] * length + h.c[H::y1] * c1 - h.c[H::x1] * s1 + h.c[H::y2] * c2 - h.c[H::x2] * s2,
          .z = h.c[H::z0] * length + h.c[H::z1] * c1 - h.c[H::z1i] * s1,
          .torque = h.c[H::m0] * length + h.c[H::m1] * c1 - h.c[H::m1i] * s1};
}

/// Coefficients at a ring.
struct RingCoefficients {
  double tangential = 0.0, radial = 0.0, axial = 0.0;
  double tangential_edge = 0.0, radial_edge = 0.0, axial_edge = 0.0;
};

/// With chip t = t0 + ts sin φ + tc cos φ the tangential force Ft, the outward one across the axis P and the one along
/// it Q are such sums too, and y + i x = (P - i Ft) e^{iφ}.
Harmonics element(const RingCoefficients& k, double sine, double cosine, double radius, double width, double edge,
                  double t0, double ts, double tc) {
  using H = Harmonics;
  const double outward = (-k.radial * sine + k.axial * cosine) * width;
  const double upward = (k.radial * cosine + k.axial * sine) * width;
  const double tangential = k.tangential * width;
  const double g0 = tangential * t0 + k.tangential_edge * edge;
  const double gs = tangential * ts;
  const double gc = tangential * tc;
  const double p0 = outward * t0 + (-k.radial_edge * sine + k.axial_edge * cosine) * edge;
  const double ps = outward * ts;
  const double pc = outward * tc;
  Harmonics h;
  h.c[H::y0] = 0.5 * (pc + gs);
  h.c[H::x0] = 0.5 * (ps - gc);
  h.c[H::y1] = p0;
  h.c[H::x1] = -g0;
  h.c[H::y2] = 0.5 * (pc - gs);
  h.c[H::x2] = -0.5 * (gc + ps);
  h.c[H::z0] = upward * t0 + (k.radial_edge * cosine + k.axial_edge * sine) * edge;
  h.c[H::z1] = upward * tc;
  h.c[H::z1i] = -upward * ts;
  h.c[H::m0] = radius * g0;
  h.c[H::m1] = radius * gc;
  h.c[H::m1i] = -radius * gs;
  return h;
}

/// What the sum relies on.
void check(const Engagement& engagement) {
  constexpr double turn = 2.0 * pi * (1.0 + 1e-12);
  const bool parted = engagement.first_arc.size() == engagement.slices.size() + 1 &&
                      std::ranges::is_sorted(engagement.first_arc) &&
                      engagement.first_arc.back() == engagement.arcs.size();
  if (!parted && !engagement.slices.empty()) throw InvalidInput("first_arc", "must part the arcs among the slices");
  for (const Arc& arc : engagement.arcs) {
    const double length = arc.exit_rad - arc.entry_rad;
    if (!(length >= 0.0 && length <= turn)) {
      throw InvalidInput("arcs", length, "rad", "must be ranges of at most a turn, from entry to exit");
    }
  }
  if (!engagement.feed_from_tool.allFinite()) throw InvalidInput("feed_from_tool", "must be finite");
}

}  // namespace

bool counts_edge_length(EdgeMeasure measure, CutterKind kind) {
  return measure == EdgeMeasure::by_kind ? kind != CutterKind::flat_end : measure == EdgeMeasure::edge_length;
}

void MillingCoefficients::validate(double from_position_rad, double to_position_rad) const {
  if (tangential_n_per_m2.empty()) {
    throw InvalidInput("tangential_n_per_m2", "must be given", "Aluminium is near 700 N/mm^2 = 7e8 N/m^2");
  }
  check_cutting("tangential_n_per_m2", tangential_n_per_m2, from_position_rad, to_position_rad, false);
  // One number may be negative: some cutters and fibres pull the tooth in. A polynomial that turns so is a misprint.
  check_cutting("radial_n_per_m2", radial_n_per_m2, from_position_rad, to_position_rad, radial_n_per_m2.size() == 1);
  check_cutting("axial_n_per_m2", axial_n_per_m2, from_position_rad, to_position_rad, true);
  check_edge("tangential_edge_n_per_m", tangential_edge_n_per_m, from_position_rad, to_position_rad);
  check_edge("radial_edge_n_per_m", radial_edge_n_per_m, from_position_rad, to_position_rad);
  check_edge("axial_edge_n_per_m", axial_edge_n_per_m, from_position_rad, to_position_rad);
}

void CutMotion::validate() const {
  require_feed_per_tooth("feed_per_tooth_m", feed_per_tooth_m);
  if (spindle_speed_rad_per_s != 0.0) require_spindle_speed("spindle_speed_rad_per_s", spindle_speed_rad_per_s);
}

void ForceOptions::validate() const {
  if (steps < 8 || steps > 100000) throw InvalidInput("steps", steps, "", "must lie between 8 and 100,000");
}

/// A revolution is cut into even steps. An edge element's force is a sum of harmonics while it is in the cut: for whole
/// steps its harmonics are added where it enters and subtracted where it leaves; steps in which it enters or leaves
/// take their integral. So a ring costs the same whatever its arc and however many steps there are.
struct ForceKernel::Memory {
  FlatEndMill mill;
  MillingCoefficients coefficients;
  bool per_edge = true;  ///< edge forces are per ds, not db
  int steps = 0;
  double step = 0.0;
  std::vector<Turn> border;        ///< length steps: where step k begins
  std::vector<Harmonics> changes;  ///< length steps + 1: that begin, less those that have ended, at step k
  std::vector<int> active;         ///< how many begin, less those that have ended
  std::vector<Load> parts;         ///< length steps: of steps with a border of an arc
  detail::ChipShare chips;
  double engaged = 0.0, missed = 0.0;

  void add_whole(std::size_t from, std::size_t to, const Harmonics& h) {
    for (std::size_t i = 0; i < Harmonics::count; ++i) {
      changes[from].c[i] += h.c[i];
      changes[to].c[i] -= h.c[i];
    }
    ++active[from];
    --active[to];
  }
  void add_part(std::size_t at, const Load& load) {
    parts[at].x += load.x;
    parts[at].y += load.y;
    parts[at].z += load.z;
    parts[at].torque += load.torque;
  }
  void add(const Harmonics& h, const Turn& start, const Turn& end, double start_rad, double length);
  void add_ring(const Engagement& engagement, std::size_t i, double feed_m);
  [[nodiscard]] RingCoefficients at_ring(double position) const;
  ForceSummary run(const Engagement& engagement, const CutMotion& motion, CuttingForce* course);
};

/// h holds in θ over [start_rad, start_rad + length].
void ForceKernel::Memory::add(const Harmonics& h, const Turn& start, const Turn& end, double start_rad, double length) {
  const auto n = static_cast<std::size_t>(steps);
  double first = start_rad / step + 0.5;
  first -= steps * std::floor(first / steps);
  const double last = first + length / step;
  const auto k1 = std::min(static_cast<std::size_t>(first), n - 1);
  const auto k2 = static_cast<std::size_t>(last);
  if (k1 == k2) {
    add_part(k1, integral(h, start, end, length));
    return;
  }
  add_part(k1, integral(h, start, border[(k1 + 1) % n], (static_cast<double>(k1 + 1) - first) * step));
  add_part(k2 % n, integral(h, border[k2 % n], end, (last - static_cast<double>(k2)) * step));
  if (k2 == k1 + 1) return;
  if (k2 <= n) {
    add_whole(k1 + 1, k2, h);
  } else {
    if (k1 + 1 < n) add_whole(k1 + 1, n, h);
    add_whole(0, k2 - n, h);
  }
}

RingCoefficients ForceKernel::Memory::at_ring(double position) const {
  const RingCoefficients k = {.tangential = polynomial(coefficients.tangential_n_per_m2, position),
                              .radial = polynomial(coefficients.radial_n_per_m2, position),
                              .axial = polynomial(coefficients.axial_n_per_m2, position),
                              .tangential_edge = polynomial(coefficients.tangential_edge_n_per_m, position),
                              .radial_edge = polynomial(coefficients.radial_edge_n_per_m, position),
                              .axial_edge = polynomial(coefficients.axial_edge_n_per_m, position)};
  if (k.tangential < 0.0) reject_negative("tangential_n_per_m2", k.tangential, position);
  if (k.radial < 0.0 && coefficients.radial_n_per_m2.size() > 1) reject_negative("radial_n_per_m2", k.radial, position);
  return k;
}

void ForceKernel::Memory::add_ring(const Engagement& engagement, std::size_t i, double feed_m) {
  const EdgeSlice& slice = engagement.slices[i];
  const RingCoefficients k = at_ring(slice.position_rad);
  const double sine = std::sin(slice.position_rad);
  const double cosine = std::cos(slice.position_rad);
  const double along_sine = engagement.feed_from_tool(0, 0) * sine;  // n·x_F = .. sin φ + .. cos φ + ..
  const double along_cosine = engagement.feed_from_tool(0, 1) * sine;
  const double along_axis = -engagement.feed_from_tool(0, 2) * cosine;
  const detail::Forwards forwards = {.mean = along_axis,
                                     .amplitude = std::hypot(along_sine, along_cosine),
                                     .middle_rad = std::atan2(along_sine, along_cosine)};
  const Profile::Point point = {
      .radius_m = slice.radius_m, .height_m = slice.height_m, .position_rad = slice.position_rad};
  for (int j = 0; j < mill.teeth; ++j) {
    chips.set(mill, j, slice.height_m, sine, feed_m);
    double stretch = 1.0;
    if (per_edge) {
      stretch = mill.tooth_helix_rad.empty() ? slice.edge_length_per_width : edge_length_per_width(mill, j, point);
    }
    const double alpha = mill.standing_angle(j) - mill.lag_rad_per_m(j) * slice.height_m;
    const Turn forth = turn_by(alpha);
    for (const Arc& arc : engagement.of(i)) {
      double missed_rad = 0.0;
      for (const detail::ChipPiece& piece : chips.pieces(arc, forwards, missed_rad)) {
        Harmonics h = element(k, sine, cosine, slice.radius_m, slice.width_m, slice.width_m * stretch,
                              piece.offset_m + piece.slope_m * along_axis, piece.slope_m * along_sine,
                              piece.slope_m * along_cosine);
        turn(h, forth);
        const double start = piece.from_rad - alpha;
        const double end = piece.to_rad - alpha;
        add(h, turn_by(start), turn_by(end), start, piece.to_rad - piece.from_rad);
      }
      engaged += (arc.exit_rad - arc.entry_rad) * slice.width_m;
      missed += missed_rad * slice.width_m;
    }
  }
}

ForceSummary ForceKernel::Memory::run(const Engagement& engagement, const CutMotion& motion, CuttingForce* course) {
  motion.validate();
  check(engagement);
  std::ranges::fill(changes, Harmonics());
  std::ranges::fill(active, 0);
  std::ranges::fill(parts, Load());
  engaged = missed = 0.0;
  const double feed = motion.feed_per_tooth_m * mill.teeth;
  for (std::size_t i = 0; i < engagement.slices.size(); ++i) add_ring(engagement, i, feed);

  ForceSummary s;
  Harmonics now;
  int cutting = 0;
  const double first =
      std::sin(0.5 * step) / (0.5 * step);  // mean of a harmonic over a step, of its value in the middle
  const double second = std::sin(step) / step;
  const Turn half = turn_by(0.5 * step);
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  for (int k = 0; k < steps; ++k) {
    const auto at = static_cast<std::size_t>(k);
    cutting += active[at];
    for (std::size_t i = 0; i < Harmonics::count; ++i) now.c[i] += changes[at].c[i];
    if (cutting == 0) now = Harmonics();  // no residue of rounding
    Turn middle = border[at];
    turn_pair(middle.cosine, middle.sine, half);
    const Load whole = value(now, middle, first, second);
    const Load& part = parts[at];
    const Eigen::Vector3d tool(whole.x + part.x / step, whole.y + part.y / step, whole.z + part.z / step);
    const Eigen::Vector3d force = engagement.feed_from_tool * tool;
    const double torque = whole.torque + part.torque / step;
    s.mean_n += force;
    squares += force.cwiseAbs2();
    for (int a = 0; a < 3; ++a) s.peak_n[a] = larger(s.peak_n[a], force[a]);
    s.peak_force_n = std::max(s.peak_force_n, force.squaredNorm());
    s.mean_torque_n_m += torque;
    s.peak_torque_n_m = larger(s.peak_torque_n_m, torque);
    if (course == nullptr) continue;
    course->rotation_rad[k] = k * step;
    course->force_n.col(k) = force;
    course->torque_n_m[k] = torque;
  }
  s.mean_n /= steps;
  s.rms_n = (squares / steps).cwiseSqrt();
  s.peak_force_n = std::sqrt(s.peak_force_n);
  s.mean_torque_n_m /= steps;
  s.power_w = s.mean_torque_n_m * motion.spindle_speed_rad_per_s;
  s.chip_area_m2 = cutting::chip_area_m2(engagement);
  s.removal_rate_m3_per_s = s.chip_area_m2 * feed * motion.spindle_speed_rad_per_s / (2.0 * pi);
  s.missed_share = engaged > 0.0 ? missed / engaged : 0.0;
  return s;
}

ForceKernel::ForceKernel(const Cutter& cutter, const MillingCoefficients& coefficients, const ForceOptions& options)
    : memory_(std::make_unique<Memory>()) {
  cutter.validate();
  options.validate();
  if (coefficients.tangential_n_per_m2.empty()) coefficients.validate(0.0, 0.0);
  Memory& m = *memory_;
  m.mill = cutter.mill;
  m.coefficients = coefficients;
  m.per_edge = counts_edge_length(coefficients.edge_measure, cutter.kind);
  m.steps = options.steps;
  m.step = 2.0 * pi / options.steps;
  const auto n = static_cast<std::size_t>(options.steps);
  m.border.reserve(n);
  for (std::size_t k = 0; k < n; ++k) m.border.push_back(turn_by((static_cast<double>(k) - 0.5) * m.step));
  m.changes.resize(n + 1);
  m.active.resize(n + 1);
  m.parts.resize(n);
}

ForceKernel::~ForceKernel() = default;
ForceKernel::ForceKernel(ForceKernel&&) noexcept = default;
ForceKernel& ForceKernel::operator=(ForceKernel&&) noexcept = default;

ForceSummary ForceKernel::summary(const Engagement& engagement, const CutMotion& motion) {
  return memory_->run(engagement, motion, nullptr);
}

void ForceKernel::revolution(const Engagement& engagement, const CutMotion& motion, CuttingForce& result) {
  result.rotation_rad.resize(memory_->steps);
  result.force_n.resize(3, memory_->steps);
  result.torque_n_m.resize(memory_->steps);
  static_cast<ForceSummary&>(result) = memory_->run(engagement, motion, &result);
}

CuttingForce cutting_force(const Cutter& cutter, const Engagement& engagement, const MillingCoefficients& coefficients,
                           const CutMotion& motion, const ForceOptions& options) {
  double from = 1e300;
  double to = -1e300;
  for (const EdgeSlice& slice : engagement.slices) {
    from = std::min(from, slice.position_rad);
    to = std::max(to, slice.position_rad);
  }
  if (!engagement.slices.empty()) coefficients.validate(from, to);
  ForceKernel kernel(cutter, coefficients, options);
  CuttingForce result;
  kernel.revolution(engagement, motion, result);
  return result;
}

}  // namespace robomill::cutting
