#include "robomill/stability/collocation/collocation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robomill/stability/collocation/milling_model.hpp"
#include "robomill/stability/collocation/spatial_model.hpp"

namespace robomill::stability::detail {
namespace {

class Collocation final : public Scheme {
 public:
  Collocation(std::unique_ptr<CollocationModel> model, int teeth, double tolerance)
      : model_(std::move(model)), teeth_(teeth), tolerance_(tolerance) {}
  [[nodiscard]] std::unique_ptr<PointEvaluator> evaluator() const override {
    return std::make_unique<CollocationEvaluator>(*model_, tolerance_);
  }
  [[nodiscard]] Period period() const override {
    return model_->reported_rad() < 0.999 * 2.0 * std::numbers::pi || teeth_ == 1 ? Period::tooth : Period::revolution;
  }

  void expect(std::span<const double> depths_m, bool picture) override { model_->expect(depths_m, picture); }

 private:
  std::unique_ptr<CollocationModel> model_;
  int teeth_;
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

int level_for(double radians, double quicker, double tolerance) {
  const double nodes = 0.5 * std::min(radians, 8.0) * quicker + 1.5 - 0.5 * std::log10(tolerance);
  return std::clamp(static_cast<int>(std::ceil((nodes - 4.0) / 2.0)), 1, 6);
}

const CollocationCase& CollocationEvaluator::find_case(std::size_t lane, const OperatingPoint& point, int level) {
  const bool by_depth = model_.depends_on_depth();
  const MeshLevel wanted = mesh_level(level);
  const auto fits = [&](const CollocationCase& c) {
    return c.spindle_speed_rad_per_s == point.spindle_speed_rad_per_s && c.level.nodes == wanted.nodes &&
           c.level.splits == wanted.splits && (!by_depth || c.axial_depth_m == point.axial_depth_m);
  };
  auto& cases = cases_[static_cast<std::size_t>(level % 2)];
  if (lane > 0 && at_[lane - 1] != nullptr && fits(*at_[lane - 1])) return *at_[lane - 1];
  if (!fits(cases[lane])) model_.prepare(point, wanted, cases[lane], lane > 0 ? at_[lane - 1] : nullptr);
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
                                                  here.level == last_level || map_.size() > model_.largest_state()));
  if (!here.done) {
    here.coarse = reported;
    here.compared = true;
    here.nodes = at_[lane]->level.nodes;
    const Eigen::VectorXcd vector = arnoldi_.vector(column);
    here.motion = vector.real() + vector.imag();
    if (!(radius < 1e100) || !here.motion.allFinite()) here.motion.setZero();
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
  const Motion motion = model_.motion(*at_[lane], model_.factor(point), dominant.multiplier, vector);
  out.chatter_frequency_hz = motion.frequency_hz;
  out.mode = motion.mode;
}

/// What the level below found, on the nodes of this one.
void CollocationEvaluator::guess(std::span<const std::size_t> lane_of) {
  guess_.assign(map_.size(), Lanes{});
  for (std::size_t i = 0; i < lane_of.size(); ++i) {
    map_.take_over(lanes_[lane_of[i]].motion, lanes_[lane_of[i]].nodes, i, guess_);
  }
}

void CollocationEvaluator::run(std::span<const OperatingPoint> points, Ask ask, std::span<Outcome> out) {
  std::array<bool, lane_count> waits = {};
  at_.fill(nullptr);
  for (std::size_t lane = 0; lane < points.size(); ++lane) {
    waits[lane] = !lanes_[lane].done;
    if (waits[lane]) at_[lane] = &find_case(lane, points[lane], lanes_[lane].level);
    if (lane == 0 && waits[0]) last_ = at_[0];
  }
  for (std::size_t first = 0; first < points.size(); ++first) {
    if (!waits[first]) continue;
    std::array<CollocationMap::Point, lane_count> together;
    std::array<std::size_t, lane_count> lane_of = {};
    std::array<Dominant, lane_count> found;
    std::size_t count = 0;
    for (std::size_t lane = first; lane < points.size(); ++lane) {
      if (!waits[lane] || lanes_[lane].compared != lanes_[first].compared) continue;
      if (!(at_[lane]->mesh.topology == at_[first]->mesh.topology)) continue;
      together[count] = {at_[lane], model_.factor(points[lane])};
      lane_of[count++] = lane;
      waits[lane] = false;
    }
    map_.prepare(model_.modes(), std::span(together).first(count));
    guess_.clear();
    if (lanes_[first].compared) guess(std::span(lane_of).first(count));
    arnoldi_.find(map_, std::span(found).first(count), guess_,
                  lanes_[first].compared ? next_tolerance_ : first_tolerance_);
    evaluations_ += static_cast<long long>(count);
    for (std::size_t i = 0; i < count; ++i) {
      assess(lane_of[i], i, found[i], points[lane_of[i]], ask, out[lane_of[i]]);
    }
  }
}

void CollocationEvaluator::evaluate(std::span<const OperatingPoint> points, Ask ask, std::span<Outcome> out) {
  for (std::size_t lane = 0; lane < points.size(); ++lane) {
    const int own = model_.first_level(points[lane], tolerance_);
    const int level = ask.level > 0 ? ask.level : ask.rough ? model_.rough_level(own) : own;
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
    model_.prepare(points[lane], mesh_level(level), single);
    const CollocationMap::Point point{&single, model_.factor(points[lane])};
    map_.prepare(model_.modes(), {&point, 1});
    arnoldi_.find(map_, out.subspan(lane, 1));
  }
}

std::unique_ptr<CollocationModel> collocation_model(const LobesProblem& problem) {
  if (!problem.in_three_directions()) return std::make_unique<MillingModel>(problem);
  return std::make_unique<SpatialModel>(spatial_parts(problem, SweptParameter::axial_depth));
}

std::unique_ptr<Scheme> collocation(const LobesProblem& problem, double tolerance) {
  if (problem.in_three_directions()) return sweep_collocation(problem, SweptParameter::axial_depth, tolerance);
  return std::make_unique<Collocation>(std::make_unique<MillingModel>(problem), problem.milling.tool.teeth, tolerance);
}

std::unique_ptr<Scheme> sweep_collocation(const LobesProblem& problem, SweptParameter parameter, double tolerance) {
  const int teeth = problem.spatial ? problem.spatial->cutter.mill.teeth : problem.drilling->lips;
  return std::make_unique<Collocation>(std::make_unique<SpatialModel>(spatial_parts(problem, parameter)), teeth,
                                       tolerance);
}

}  // namespace robomill::stability::detail
