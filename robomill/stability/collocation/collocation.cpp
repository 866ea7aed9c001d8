#include "robomill/stability/collocation/collocation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace robomill::stability::detail {
namespace {

using Complex = std::complex<double>;

class Collocation final : public Scheme {
 public:
  Collocation(const LobesProblem& problem, double tolerance) : model_(problem), tolerance_(tolerance) {}
  [[nodiscard]] std::unique_ptr<PointEvaluator> evaluator() const override {
    return std::make_unique<CollocationEvaluator>(model_, tolerance_);
  }
  [[nodiscard]] Period period() const override {
    return model_.reported_rad() < 0.999 * 2.0 * std::numbers::pi || model_.milling.tool.teeth == 1
               ? Period::tooth
               : Period::revolution;
  }

 private:
  CollocationModel model_;
  double tolerance_;
};

}  // namespace

MeshLevel mesh_level(int number) {
  MeshLevel level;
  level.nodes = number <= 6 ? 4 + 2 * number : 14;
  level.splits = number <= 6 ? 1 : 1 << (number - 6);
  level.heights = std::min(4 + 2 * number, 24);
  level.slices = 4 << std::min(number, 5);
  return level;
}

int first_level(const CollocationModel& model, const OperatingPoint& point, double tolerance) {
  // A piece is cut to the structure's own radians; the cut makes it quicker.
  const cutting::Immersion& immersion = model.milling.immersion;
  const double stretch = std::min(immersion.exit_rad - immersion.entry_rad, model.contacts.period_rad()) *
                         model.fastest_rad_per_s / point.spindle_speed_rad_per_s;
  const double quicker =
      std::sqrt(1.0 + model.quickening * point.axial_depth_m / (model.fastest_rad_per_s * model.fastest_rad_per_s));
  const double nodes = 0.5 * std::min(stretch, 8.0) * quicker + 1.5 - 0.5 * std::log10(tolerance);
  return std::clamp(static_cast<int>(std::ceil((nodes - 4.0) / 2.0)), 1, 6);
}

const CollocationCase& CollocationEvaluator::find_case(std::size_t lane, const OperatingPoint& point, int level) {
  const bool by_depth = model_.contacts.depends_on_depth();
  const MeshLevel wanted = mesh_level(level);
  const auto fits = [&](const CollocationCase& c) {
    return c.spindle_speed_rad_per_s == point.spindle_speed_rad_per_s && c.level.nodes == wanted.nodes &&
           c.level.splits == wanted.splits && (!by_depth || c.axial_depth_m == point.axial_depth_m);
  };
  auto& cases = cases_[static_cast<std::size_t>(level % 2)];
  if (lane > 0 && at_[lane - 1] != nullptr && fits(*at_[lane - 1])) return *at_[lane - 1];
  if (!fits(cases[lane])) {
    prepare_case(model_, point.spindle_speed_rad_per_s, point.axial_depth_m, wanted, cases[lane]);
  }
  return cases[lane];
}

void CollocationEvaluator::assess(std::size_t lane, std::size_t column, const Dominant& dominant,
                                  const OperatingPoint& point, Ask ask, Outcome& out) {
  Lane& here = lanes_[lane];
  const double share = model_.reported_rad() / model_.whole_rad();
  const double radius = spectral_radius(dominant);
  const double reported = share == 1.0 ? radius : std::pow(radius, share);
  const double difference = std::abs(reported - here.coarse);
  here.done = !ask.estimate || (here.compared && (difference <= tolerance_ * std::max(1.0, reported) ||
                                                  here.level == last_level || map_.size() > largest_state));
  if (!here.done) {
    here.coarse = reported;
    here.compared = true;
    ++here.level;
    return;
  }
  out.spectral_radius = reported;
  out.multiplier = reported;
  if (radius < 1e100) out.multiplier = std::polar(reported, std::arg(dominant.multiplier) * share);
  if (share == 1.0 && radius < 1e100) out.multiplier = dominant.multiplier;
  out.kind = kind_of(dominant.multiplier);
  if (ask.estimate) out.error_estimate = difference;
  if (dominant.by == Dominant::By::unsettled) ++unsettled_;
  if (!ask.motion || radius >= 1e100) return;
  const Eigen::VectorXcd vector = arnoldi_.vector(column);
  if (!vector.allFinite()) return;
  const NodeForces forces = trace(model_, *at_[lane], point.axial_depth_m, vector);
  const Rotation turning(point.spindle_speed_rad_per_s, model_.variation);
  const double start = at_[lane]->mesh.pieces.front().from_rad;
  const double period_s = turning.time_s(start + model_.whole_rad()) - turning.time_s(start);
  const auto coefficient = [&](Complex s) -> Eigen::Vector2cd {
    Eigen::Vector2cd sum = Eigen::Vector2cd::Zero();
    for (std::size_t i = 0; i < forces.time_s.size(); ++i) {
      sum += forces.force_n[i] * (std::exp(-s * forces.time_s[i]) * (forces.weight_s[i] / period_s));
    }
    return sum;
  };
  const Motion motion = find_motion(model_.tip, dominant.multiplier, period_s, vector, coefficient);
  out.chatter_frequency_hz = motion.frequency_hz;
  out.mode = motion.mode;
}

void CollocationEvaluator::run(std::span<const OperatingPoint> points, Ask ask, std::span<Outcome> out) {
  std::array<bool, lane_count> waits = {};
  at_.fill(nullptr);
  for (std::size_t lane = 0; lane < points.size(); ++lane) {
    waits[lane] = !lanes_[lane].done;
    if (waits[lane]) at_[lane] = &find_case(lane, points[lane], lanes_[lane].level);
  }
  for (std::size_t first = 0; first < points.size(); ++first) {
    if (!waits[first]) continue;
    std::array<CollocationMap::Point, lane_count> together;
    std::array<std::size_t, lane_count> lane_of = {};
    std::array<Dominant, lane_count> found;
    std::size_t count = 0;
    for (std::size_t lane = first; lane < points.size(); ++lane) {
      if (!waits[lane] || !(at_[lane]->mesh.topology == at_[first]->mesh.topology)) continue;
      together[count] = {at_[lane], points[lane].axial_depth_m};
      lane_of[count++] = lane;
      waits[lane] = false;
    }
    map_.prepare(model_, std::span(together).first(count));
    arnoldi_.find(map_, std::span(found).first(count));
    evaluations_ += static_cast<long long>(count);
    for (std::size_t i = 0; i < count; ++i) {
      assess(lane_of[i], i, found[i], points[lane_of[i]], ask, out[lane_of[i]]);
    }
  }
}

void CollocationEvaluator::evaluate(std::span<const OperatingPoint> points, Ask ask, std::span<Outcome> out) {
  for (std::size_t lane = 0; lane < points.size(); ++lane) {
    const int level = first_level(model_, points[lane], tolerance_);
    lanes_[lane] = {.level = ask.estimate ? level - 1 : level};
    out[lane] = Outcome{};
  }
  const auto left = [&] {
    return std::ranges::any_of(std::span(lanes_).first(points.size()), [](const Lane& lane) { return !lane.done; });
  };
  while (left()) run(points, ask, out);
}

void CollocationEvaluator::evaluate_at(std::span<const OperatingPoint> points, int level, std::span<Dominant> out) {
  for (std::size_t lane = 0; lane < points.size(); ++lane) {
    CollocationCase single;
    prepare_case(model_, points[lane].spindle_speed_rad_per_s, points[lane].axial_depth_m, mesh_level(level), single);
    const CollocationMap::Point point{&single, points[lane].axial_depth_m};
    map_.prepare(model_, {&point, 1});
    arnoldi_.find(map_, out.subspan(lane, 1));
  }
}

std::unique_ptr<Scheme> collocation(const LobesProblem& problem, double tolerance) {
  return std::make_unique<Collocation>(problem, tolerance);
}

}  // namespace robomill::stability::detail
