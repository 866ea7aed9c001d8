#include "robomill/stability/evaluator.hpp"

#include <algorithm>
#include <cmath>

namespace robomill::stability::detail {
namespace {

using Complex = std::complex<double>;

bool finer(const Resolution& a, const Resolution& b) {
  return a.halvings != b.halvings ? a.halvings > b.halvings : a.nodes > b.nodes;
}

bool finite(Complex value) {
  return std::isfinite(value.real()) && std::isfinite(value.imag());
}

}  // namespace

double spectral_radius(const Dominant& dominant) {
  const double modulus = std::abs(dominant.multiplier);
  return std::isfinite(modulus) && modulus < 1e100 ? modulus : 1e100;
}

void Evaluator::evaluate(std::span<const Point> points, std::span<Dominant> out) {
  Resolution finest = {.nodes = 0};
  const auto step_s = [&](std::size_t lane) { return model_.cut.step_rad() / points[lane].spindle_speed_rad_per_s; };
  for (std::size_t lane = 0; lane < points.size(); ++lane) {
    points_[lane].depth = points[lane].plan;
    if (points_[lane].depth == nullptr) {
      model_.cut.at_depth(points[lane].axial_depth_m, depths_[lane]);
      points_[lane].depth = &depths_[lane];
    }
    const Resolution needed = resolution(model_.tip, step_s(lane), points_[lane].depth->largest_n_per_m);
    if (finer(needed, finest)) finest = needed;
  }
  for (std::size_t lane = 0; lane < points.size(); ++lane) {
    if (lane > 0 && points[lane].spindle_speed_rad_per_s == points[lane - 1].spindle_speed_rad_per_s) {
      points_[lane].speed = points_[lane - 1].speed;
      continue;
    }
    SpeedPlan& plan = speeds_[lane];
    const bool known = plan.step_s == step_s(lane) && plan.resolution.nodes == finest.nodes &&
                       plan.resolution.halvings == finest.halvings;
    if (!known) plan_speed(model_.tip, step_s(lane), finest, plan);
    points_[lane].speed = &plan;
  }
  monodromy_.prepare(std::span(points_).first(points.size()));
  arnoldi_.find(monodromy_, out);
  evaluations_ += static_cast<long long>(points.size());
  unsettled_ += std::ranges::count_if(out, [](const Dominant& d) { return d.by == Dominant::By::unsettled; });
}

void Evaluator::apply_vectors(std::span<const Eigen::VectorXcd> vectors, bool imaginary) {
  for (std::size_t i = 0; i < in_.size(); ++i) {
    for (std::size_t lane = 0; lane < vectors.size(); ++lane) {
      const Complex entry = vectors[lane](static_cast<Eigen::Index>(i));
      in_[i].v[lane] = imaginary ? entry.imag() : entry.real();
    }
  }
  monodromy_.apply(in_.data(), out_.data());
}

void Evaluator::describe(std::span<const Dominant> dominant, std::span<Motion> out) {
  std::array<Eigen::VectorXcd, lane_count> vectors;
  std::size_t known = 0;
  for (std::size_t lane = 0; lane < dominant.size(); ++lane) {
    vectors[lane] = arnoldi_.vector(lane);
    if (finite(dominant[lane].multiplier) && vectors[lane].allFinite()) {
      ++known;
    } else {
      vectors[lane].setZero();
    }
  }
  std::ranges::fill(out, Motion{});
  if (known == 0) return;
  in_.assign(monodromy_.size(), Lanes{});
  out_.resize(monodromy_.size());
  forces_.resize(monodromy_.cut_steps().size());
  const std::span<const Eigen::VectorXcd> used = std::span(vectors).first(dominant.size());
  for (const bool imaginary : {false, true}) {
    apply_vectors(used, imaginary);
    for (std::size_t c = 0; c < forces_.size(); ++c) {
      for (std::size_t lane = 0; lane < lane_count; ++lane) {
        const Lanes* force = monodromy_.force(c);
        const Eigen::Vector2cd part(force[0].v[lane], force[1].v[lane]);
        forces_[c][lane] = imaginary ? (forces_[c][lane] + Complex(0.0, 1.0) * part).eval() : part;
      }
    }
  }
  for (std::size_t lane = 0; lane < dominant.size(); ++lane) {
    if (!vectors[lane].isZero(0.0)) out[lane] = motion(lane, vectors[lane], dominant[lane].multiplier);
  }
}

Motion Evaluator::motion(std::size_t lane, const Eigen::VectorXcd& vector, Complex multiplier) const {
  const double step_s = points_[lane].speed->step_s;
  const auto force = [&](Complex s) -> Eigen::Vector2cd {
    const Complex x = s * step_s;
    const Complex weight = std::abs(x) > 1e-6 ? (1.0 - std::exp(-x)) / x : 1.0 - 0.5 * x;
    Eigen::Vector2cd sum = Eigen::Vector2cd::Zero();
    for (std::size_t c = 0; c < forces_.size(); ++c) {
      sum += forces_[c][lane] * std::exp(-x * static_cast<double>(monodromy_.cut_steps()[c]));
    }
    return sum * (weight / static_cast<double>(model_.cut.steps()));
  };
  return find_motion(model_.tip, multiplier, step_s * model_.cut.steps(), vector, force);
}

}  // namespace robomill::stability::detail
