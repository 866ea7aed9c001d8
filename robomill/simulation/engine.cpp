#include "robomill/simulation/engine.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "robomill/base/units.hpp"

namespace robomill::simulation::detail {
namespace {

constexpr int most_passes = 8;  // to find which edges touch

constexpr double rounding = 1e-7;  // of a position, in nodes

/// An edge that stands at a node up to rounding stands there: not before it in one step and behind it in the next.
double snapped(double position) {
  const double nearest = std::round(position);
  return std::abs(position - nearest) < rounding ? nearest : position;
}

}  // namespace

/// The forces of one step as they follow from the modes' displacement x at its end. Edges that cut all step long give a
/// force that runs from start to end; those that enter or leave within it the straight line with their impulse and its
/// first moment: with share w, middle σ and mean force c it runs from w c (4 - 6σ) to w c (6σ - 2).
template <int D>
struct Engine<D>::Assembly {
  Affine whole;                                // of edges that cut from start to end, at its end: of q
  Affine end;                                  // of all edges that cut at its end: of q
  Affine start_part, end_part;                 // of entering and leaving edges: of x
  Square<D> start_static = Square<D>::Zero();  // of entering edges: of the static part of q at the end
  Square<D> end_static = Square<D>::Zero();
  Square<D> damping = Square<D>::Zero();
};

template <int D>
Engine<D>::Engine(const CutModel& model, const modal::TipModes& structure, Physics physics)
    : model_(model),
      physics_(physics),
      step_s_(units::revolution / model.steps_per_revolution / model.spindle.mean_rad_per_s),
      modes_(structure, step_s_),
      surface_(model),
      elements_(model.elements),
      compliance_(structure.compliance.topLeftCorner<D, D>()),
      compliant_(!compliance_.isZero(0.0)),
      damped_(model.damping.active()),
      pending_(model.elements.size()) {
  near_.reserve(elements_.size());
  touches_.reserve(elements_.size());
  if (physics_ == Physics::perturbation) {
    for (Element& element : elements_) element.edge = {};
  }
  surface_.set_rigid();
  set_depth(0.0);
  leave_start();
}

template <int D>
Vector<D> Engine<D>::normal(const Ring& ring, double sine, double cosine) const {
  if constexpr (D == 2) return {sine, cosine};
  if constexpr (D == 3) return {ring.lateral * sine, ring.lateral * cosine, -ring.axial};
}

template <int D>
typename Engine<D>::Chip Engine<D>::chip(const Element& element, double position, double sine, double cosine,
                                         double feed_m) const {
  const Node left = surface_.at(surface_.strip(element.ring), position);
  const double rigid = element.radius_m - left.out_m + surface_.fed(ring_of(element), feed_m, left, sine, cosine);
  if (physics_ == Physics::full) return {sine, cosine, rigid, true};
  if (physics_ == Physics::forced) return {sine, cosine, rigid, rigid >= 0.0};
  return {sine, cosine, (physics_ == Physics::linear ? rigid : 0.0) - left.vibration_m, rigid >= 0.0};
}

/// Whether the chip's contact changed with this displacement.
template <int D>
bool Engine<D>::update_contact(const Touch& touch, Chip& chip, const Vector<D>& q) const {
  if (physics_ != Physics::full) return false;
  const bool cuts = normal(*touch.ring, chip.sine, chip.cosine).dot(q) + chip.gap_m >= 0.0;
  const bool changed = cuts != chip.cuts;
  chip.cuts = cuts;
  return changed;
}

template <int D>
void Engine<D>::add(const Touch& touch, const Chip& chip, double width, Affine& sum) const {
  if (!chip.cuts) return;
  const auto against = [&](const Resistance& resistance) {
    const double t = resistance.tangential, r = resistance.radial;
    Vector<D> force;
    force(0) = -width * (t * chip.cosine + r * chip.sine);
    force(1) = -width * (r * chip.cosine - t * chip.sine);
    if constexpr (D == 3) force(2) = -width * resistance.axial;
    return force;
  };
  const Vector<D> per_chip = against(touch.element->chip);
  if (physics_ != Physics::forced) {
    sum.k.noalias() += per_chip * normal(*touch.ring, chip.sine, chip.cosine).transpose();
  }
  sum.f += per_chip * chip.gap_m + against(touch.element->edge);
}

template <int D>
void Engine<D>::add_damping(const Touch& touch, Square<D>& sum) const {
  const double cuts = touch.whole()
                          ? 0.5 * (static_cast<double>(touch.start.cuts) + static_cast<double>(touch.end.cuts))
                          : static_cast<double>(touch.middle.cuts);
  if (cuts == 0.0) return;
  const Vector<D> n = normal(*touch.ring, touch.middle.sine, touch.middle.cosine);
  Vector<D> t = Vector<D>::Zero();
  t(0) = touch.middle.cosine;
  t(1) = -touch.middle.sine;
  const double viscous = touch.element->width_m * touch.share * cuts * damping_;
  sum.noalias() -= viscous * (model_.damping.friction * t + n) * n.transpose();
}

template <int D>
void Engine<D>::touch(const Near& near) {
  const Element& element = elements_[static_cast<std::size_t>(near.element)];
  if (element.width_m == 0.0 && !model_.depth.empty()) return;
  const Strip& strip = surface_.strip(element.ring);
  double from = 0.0, to = 1.0;
  const double run = near.position_b - near.position_a;
  if (!strip.whole_circle) {
    from = (strip.entry - near.position_a) / run;
    to = (strip.exit - near.position_a) / run;
    // Rounding must not make a sliver of an edge that enters or leaves at a step's end.
    from = from < 1e-9 ? 0.0 : from;
    to = to > 1.0 - 1e-9 ? 1.0 : to;
    if (!(from < 1.0 - 1e-9 && to > 1e-9 && to > from)) return;
  }
  Touch& t = touches_.emplace_back();
  t.element = &element;
  t.ring = &ring_of(element);
  t.from_start = from == 0.0;
  t.to_end = to == 1.0;
  t.share = to - from;
  t.mid = 0.5 * (from + to);
  if (t.from_start) t.start = chip(element, near.position_a, near.sine_a, near.cosine_a, feed_a_);
  if (t.to_end) t.end = chip(element, near.position_b, near.sine_b, near.cosine_b, feed_b_);
  if (t.whole()) {
    t.middle.sine = 0.5 * (near.sine_a + near.sine_b);
    t.middle.cosine = 0.5 * (near.cosine_a + near.cosine_b);
    return;
  }
  const double angle = (run * t.mid) * surface_.step_rad();
  const double s = std::sin(angle), c = std::cos(angle);
  t.middle = chip(element, near.position_a + run * t.mid, near.sine_a * c + near.cosine_a * s,
                  near.cosine_a * c - near.sine_a * s, feed_a_ + t.mid * (feed_b_ - feed_a_));
}

/// As the step begins, in nodes of its ring, less than a revolution before the last; negative where there are none.
template <int D>
double Engine<D>::position(const Element& element) const {
  const Strip& strip = surface_.strip(element.ring);
  double nodes = (angle_a_ + element.standing_rad - strip.offset_rad) / surface_.step_rad();
  const double top = (strip.whole_circle ? strip.count : strip.count + 1.0) - rounding;
  while (nodes > top) nodes -= model_.steps_per_revolution;
  if (nodes < top - model_.steps_per_revolution) nodes += model_.steps_per_revolution;
  return nodes;
}

/// Which elements are where the surface is kept, and which of them cut.
template <int D>
void Engine<D>::collect() {
  near_.clear();
  touches_.clear();
  const double sine_a = std::sin(angle_a_), cosine_a = std::cos(angle_a_);
  const double sine_b = std::sin(angle_b_), cosine_b = std::cos(angle_b_);
  const double per_step = 1.0 / surface_.step_rad();
  const double run = (angle_b_ - angle_a_) * per_step;
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    const Element& e = elements_[i];
    const double from = position(e);
    if (from + run < 0.0) continue;
    Near& near = near_.emplace_back();
    near.element = static_cast<int>(i);
    near.position_a = snapped(from);
    near.position_b = snapped(from + run);
    near.sine_a = sine_a * e.cosine + cosine_a * e.sine;
    near.cosine_a = cosine_a * e.cosine - sine_a * e.sine;
    near.sine_b = sine_b * e.cosine + cosine_b * e.sine;
    near.cosine_b = cosine_b * e.cosine - sine_b * e.sine;
    touch(near);
  }
}

/// What cuts as the step begins; a static compliance makes the displacement jump with it.
template <int D>
void Engine<D>::solve_start() {
  q_a_ = modal_a_;
  if (!compliant_) {
    for (Touch& t : touches_) {
      if (t.from_start) update_contact(t, t.start, q_a_);
    }
    return;
  }
  q_a_ = q_;
  for (int pass = 0; pass < most_passes; ++pass) {
    Affine sum;
    for (Touch& t : touches_) {
      if (!t.from_start) continue;
      update_contact(t, t.start, q_a_);
      add(t, t.start, t.element->width_m, sum);
    }
    const Square<D> implicit = Square<D>::Identity() - sum.k * compliance_;
    q_a_ = modal_a_ + compliance_ * (implicit.inverse() * (sum.k * modal_a_ + sum.f));
    bool changed = false;
    for (Touch& t : touches_) {
      if (!t.from_start) continue;
      Chip looked = t.start;
      changed = update_contact(t, looked, q_a_) || changed;
    }
    if (!changed) break;
  }
}

template <int D>
void Engine<D>::assemble(Assembly& sum) {
  for (const Touch& t : touches_) {
    const double width = t.element->width_m;
    if (t.to_end) add(t, t.end, width, sum.end);
    if (t.whole()) {
      add(t, t.end, width, sum.whole);
    } else if (t.middle.cuts) {
      Affine part;
      add(t, t.middle, width * t.share, part);
      // Its displacement: (1 - σ) x_a + σ x and the static part of the side on which it cuts.
      part.f += part.k * ((1.0 - t.mid) * modal_a_);
      if (t.from_start) part.f += part.k * (q_a_ - modal_a_);
      const double at_start = 4.0 - 6.0 * t.mid, at_end = 6.0 * t.mid - 2.0;
      sum.start_part.k += (at_start * t.mid) * part.k;
      sum.start_part.f += at_start * part.f;
      sum.end_part.k += (at_end * t.mid) * part.k;
      sum.end_part.f += at_end * part.f;
      if (compliant_ && t.to_end) {
        sum.start_static += at_start * part.k;
        sum.end_static += at_end * part.k;
      }
    }
    if (damped_) add_damping(t, sum.damping);
  }
}

template <int D>
void Engine<D>::solve_step() {
  Affine start;
  for (Touch& t : touches_) {
    if (t.whole()) add(t, t.start, t.element->width_m, start);
  }
  const Vector<D> fixed_start = start.k * q_a_ + start.f;
  const Vector<D> free = modes_.free_motion();
  for (Touch& t : touches_) {
    if (t.to_end) update_contact(t, t.end, q_a_);
    if (!t.whole()) update_contact(t, t.middle, q_a_);
  }
  Vector<D> from = Vector<D>::Zero(), to = Vector<D>::Zero();
  modal_b_ = free;
  q_ = free;
  for (int pass = 0; pass < most_passes && !touches_.empty(); ++pass) {
    Assembly sum;
    assemble(sum);
    // Static part of q at the end, S (M x + m), from F = K (x + S F) + f.
    Affine still;
    if (compliant_) {
      const Square<D> inverse = (Square<D>::Identity() - sum.end.k * compliance_).inverse();
      still.k = compliance_ * inverse * sum.end.k;
      still.f = compliance_ * (inverse * sum.end.f);
    }
    Affine a = sum.start_part, b = sum.end_part;
    a.f += fixed_start;
    b.k += sum.whole.k;
    b.f += sum.whole.f;
    if (compliant_) {
      a.k += sum.start_static * still.k;
      a.f += sum.start_static * still.f;
      b.k += (sum.whole.k + sum.end_static) * still.k;
      b.f += (sum.whole.k + sum.end_static) * still.f;
    }
    if (damped_) {
      const Square<D> viscous = sum.damping / step_s_;
      a.k += viscous;
      b.k += viscous;
      a.f -= viscous * modal_a_;
      b.f -= viscous * modal_a_;
    }
    const Square<D> implicit = Square<D>::Identity() - modes_.gain_start() * a.k - modes_.gain_end() * b.k;
    modal_b_ = implicit.inverse() * (free + modes_.gain_start() * a.f + modes_.gain_end() * b.f);
    q_ = modal_b_ + still.k * modal_b_ + still.f;
    from = a.k * modal_b_ + a.f;
    to = b.k * modal_b_ + b.f;
    bool changed = false;
    for (Touch& t : touches_) {
      if (t.to_end) changed = update_contact(t, t.end, q_) || changed;
      if (!t.whole()) changed = update_contact(t, t.middle, (1.0 - t.mid) * q_a_ + t.mid * q_) || changed;
    }
    if (!changed) break;
  }
  modes_.finish(from, to);
  mean_force_ = 0.5 * (from + to);
}

template <int D>
void Engine<D>::leave_node(const Near& near, int node) {
  const Element& e = elements_[static_cast<std::size_t>(near.element)];
  const Ring& ring = ring_of(e);
  const Strip& strip = surface_.strip(e.ring);
  const int kept = strip.whole_circle && node >= strip.count ? node - strip.count : node;
  if (kept < 0 || kept >= strip.count) return;
  const double s = (node - near.position_a) / (near.position_b - near.position_a);
  const std::size_t index = strip.index(kept);
  const double sine = surface_.sine(index), cosine = surface_.cosine(index);
  const double vibration = normal(ring, sine, cosine).dot((1.0 - s) * q_a_ + s * q_);
  const double feed = feed_a_ + s * (feed_b_ - feed_a_);
  const Node& old = surface_.node(index);
  const double behind = surface_.behind(ring, feed, old, sine, cosine);
  Pending& p = pending_[static_cast<std::size_t>(near.element)];
  p.node = kept;
  if (physics_ == Physics::full) {
    p.value = {e.radius_m + vibration, feed, 0.0};
    p.cuts = p.value.out_m - old.out_m + behind >= 0.0;
  } else {
    p.value = {e.radius_m, feed, vibration};
    p.cuts = e.radius_m - old.out_m + behind >= 0.0;
  }
}

/// The node behind each edge as the cut starts, as leave_surface would have found it.
template <int D>
void Engine<D>::leave_start() {
  feed_b_ = model_.feed_m_per_s * surface_.step_rad() / model_.spindle.speed(0.0);
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    Near near;
    near.element = static_cast<int>(i);
    near.position_a = snapped(position(elements_[i]));
    near.position_b = near.position_a + 1.0;
    if (near.position_a >= 0.0) leave_node(near, static_cast<int>(near.position_a));
  }
  feed_b_ = 0.0;
}

/// A node takes its new value only when the edge has passed the one after it: until then the edge itself still reads
/// what stood there before.
template <int D>
void Engine<D>::leave_surface() {
  for (const Near& near : near_) {
    const int last = static_cast<int>(std::floor(near.position_b));
    for (int k = static_cast<int>(std::floor(near.position_a)) + 1; k <= last; ++k) {
      Pending& p = pending_[static_cast<std::size_t>(near.element)];
      if (p.node >= 0 && p.cuts) {
        const Strip& strip = surface_.strip(elements_[static_cast<std::size_t>(near.element)].ring);
        surface_.node(strip.index(p.node)) = p.value;
      }
      p.node = -1;
      leave_node(near, k);
    }
  }
}

template <int D>
void Engine<D>::pass_wall(const Near& near, WatchedWall& watched) {
  const double position_a = near.position_a, position_b = near.position_b;
  const Element& e = elements_[static_cast<std::size_t>(near.element)];
  const double wall = (watched.angle_rad - surface_.strip(e.ring).offset_rad) / surface_.step_rad();
  if (!(position_a < wall && wall <= position_b)) return;
  const double s = (wall - position_a) / (position_b - position_a);
  const double outward = watched.angle_rad < 1.0 ? 1.0 : -1.0;  // of y
  const Vector<D> q = (1.0 - s) * q_a_ + s * q_;
  const Vector<D> speed = (q_ - q_a_) / step_s_;
  const double turning = model_.spindle.speed(time_s());
  const double along = model_.feed_m_per_s * model_.feed.at(time_s()) + speed(0) + outward * model_.radius_m * turning;
  WallPass pass;
  pass.ring = e.ring;
  pass.x_m = feed_a_ + s * (feed_b_ - feed_a_) + q(0);
  pass.out_m = e.radius_m + outward * q(1);
  pass.slope = outward * speed(1) / along;
  pass.bend_per_m = 0.5 * model_.radius_m * turning * turning / (along * along);
  if (watched.passes.size() < watched.capacity) {
    watched.passes.push_back(pass);
  } else {
    watched.passes[watched.next] = pass;
    watched.next = (watched.next + 1) % watched.capacity;
  }
}

/// The depth cuts through one slice, whose width is the part of it below.
template <int D>
void Engine<D>::set_depth(double time_s) {
  if (model_.depth.empty()) return;
  const double slices = model_.depth.at(time_s) * static_cast<double>(model_.rings.size());
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    elements_[i].width_m = model_.elements[i].width_m * std::clamp(slices - elements_[i].ring, 0.0, 1.0);
  }
}

template <int D>
void Engine<D>::step() {
  angle_a_ = angle_b_;
  feed_a_ = feed_b_;
  modal_a_ = modal_b_;
  const std::int64_t after = steps_ + 1;
  const double end_s = static_cast<double>(after) * step_s_;
  if (model_.spindle.steady()) {
    const std::int64_t n = model_.steps_per_revolution;
    angle_a_ = static_cast<double>(steps_ % n) * surface_.step_rad();
    angle_b_ = angle_a_ + surface_.step_rad();
  } else {
    const double turns = std::floor(model_.spindle.rotation(time_s()) / units::revolution);
    angle_a_ = model_.spindle.rotation(time_s()) - turns * units::revolution;
    angle_b_ = model_.spindle.rotation(end_s) - turns * units::revolution;
  }
  feed_b_ = model_.feed_m_per_s * model_.feed.before(end_s);
  set_depth(0.5 * (time_s() + end_s));
  if (damped_) {
    // K l² / 2V with V = Ω D / 2.
    const double speed = model_.spindle.speed(0.5 * (time_s() + end_s));
    const double land = model_.damping.wear_land_m;
    damping_ = model_.damping.indentation_n_per_m3 * land * land / (2.0 * speed * model_.radius_m);
  }
  collect();
  solve_start();
  solve_step();
  bool missed = false;
  for (const Touch& t : touches_) missed = missed || (t.to_end && !t.end.cuts);
  if (missed) ++without_contact_;
  leave_surface();
  for (WatchedWall& wall : walls_) {
    for (const Near& near : near_) pass_wall(near, wall);
  }
  steps_ = after;
}

template <int D>
void Engine<D>::set_mode(std::size_t mode, std::complex<double> value) {
  modes_.set(mode, value);
  modal_b_ = modes_.displacement();
  q_ = modal_b_;
}

template <int D>
void Engine<D>::scale(double factor) {
  modes_.scale(factor);
  surface_.scale_vibration(factor);
  for (Pending& p : pending_) p.value.vibration_m *= factor;
  modal_b_ *= factor;
  q_ *= factor;
}

template <int D>
void Engine<D>::watch_wall(double angle_rad, std::size_t capacity) {
  walls_.push_back({angle_rad, capacity, 0, {}});
  walls_.back().passes.reserve(capacity);
}

template <int D>
std::vector<WallPass> Engine<D>::wall_passes(std::size_t wall) const {
  const WatchedWall& watched = walls_[wall];
  std::vector<WallPass> passes = watched.passes;
  // std::ranges::rotate does not compile with clang 14 and libstdc++ 12.
  std::rotate(passes.begin(), passes.begin() + static_cast<std::ptrdiff_t>(watched.next), passes.end());
  return passes;
}

template class Engine<2>;
template class Engine<3>;

}  // namespace robomill::simulation::detail
