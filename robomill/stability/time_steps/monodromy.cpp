#include "robomill/stability/time_steps/monodromy.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <complex>

#include "robomill/stability/time_steps/lane_math.hpp"

namespace robomill::stability::detail {
namespace {

std::complex<double> power(std::complex<double> base, int exponent) {
  std::complex<double> result = 1.0;
  for (; exponent > 0; exponent /= 2) {
    if (exponent % 2 == 1) result *= base;
    base *= base;
  }
  return result;
}

/// Row by row.
void set(std::vector<Lanes>& to, std::size_t lane, const Eigen::MatrixXd& matrix) {
  std::size_t i = 0;
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) to[i++].v[lane] = matrix(r, c);
  }
}

}  // namespace

Monodromy::Monodromy(const TipDynamics& tip, const CutSteps& cut)
    : tip_(tip),
      cut_(cut),
      modal_(2 * static_cast<std::size_t>(tip.pole.size())),
      displacement_(2 * modal_),
      compliant_(!tip.compliance.isZero(0.0)) {
  for (Eigen::Index k = 0; k < tip.pole.size(); ++k) {
    const std::size_t column = 2 * static_cast<std::size_t>(k);
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      const std::size_t row = static_cast<std::size_t>(axis) * modal_;
      displacement_[row + column] = 2.0 * tip.right(axis, k).real();
      displacement_[row + column + 1] = -2.0 * tip.right(axis, k).imag();
    }
  }
  for (std::size_t lane = 0; lane < lane_count; ++lane) set(compliance_.data(), lane, tip.compliance);
  state_.resize(2 * ((modal_ + 3) / 4 * 4 + 2));
}

void Monodromy::add_step(int number, bool cuts, int record) {
  Step step;
  step.number = number;
  step.record = record;
  if (cuts) {
    step.index = cut_numbers_.size();
    cut_numbers_.push_back(number);
  } else if (!steps_.empty() && steps_.back().coast > 0 && steps_.back().record < 0 && record < 0) {
    ++steps_.back().coast;
    return;
  } else {
    step.coast = 1;
  }
  steps_.push_back(step);
}

/// Orders the period for pattern_: which steps cut, which are remembered and where, who looks back at what.
void Monodromy::lay_out() {
  const int period = cut_.steps();
  const auto& delays = cut_.delays();
  steps_.clear();
  references_.clear();
  cut_numbers_.clear();
  coast_lengths_.clear();
  outputs_.clear();

  // Entries of memory: steps of the period before come first, in order, then those of this one. -1: not needed; step j
  // of either period is at j + period.
  std::vector<int> entry(2 * static_cast<std::size_t>(period), -1);
  const auto looks_back = [&](const auto& visit) {
    for (int i = 0; i < period; ++i) {
      for (std::size_t g = 0; g < delays.size(); ++g) {
        if (!pattern_[g * static_cast<std::size_t>(period) + static_cast<std::size_t>(i)]) continue;
        const std::size_t from = static_cast<std::size_t>(i + period - delays[g].whole);
        visit(i, g, from, 1.0 - delays[g].fraction);
        if (delays[g].fraction > 0.0) visit(i, g, from + 1, delays[g].fraction);
      }
    }
  };
  looks_back([&](int, std::size_t, std::size_t from, double) { entry[from] = 0; });
  for (std::size_t j = 0; j < static_cast<std::size_t>(period); ++j) {
    if (entry[j] == 0) entry[j + static_cast<std::size_t>(period)] = 0;
  }
  int count = 0;
  for (int& e : entry) {
    if (e == 0) e = count++;
  }
  for (std::size_t j = 0; j < static_cast<std::size_t>(period); ++j) {
    if (entry[j] < 0) continue;
    outputs_.push_back(static_cast<std::size_t>(entry[j + static_cast<std::size_t>(period)]));
  }
  memory_.resize(2 * static_cast<std::size_t>(count));

  std::vector<std::vector<Reference>> by_step(static_cast<std::size_t>(period));
  looks_back([&](int i, std::size_t g, std::size_t from, double weight) {
    Reference reference;
    reference.entry = static_cast<std::size_t>(entry[from]);
    reference.delay = g;
    reference.weight = weight;
    by_step[static_cast<std::size_t>(i)].push_back(reference);
  });
  for (int i = 0; i < period; ++i) {
    const auto& references = by_step[static_cast<std::size_t>(i)];
    add_step(i, !references.empty(), entry[static_cast<std::size_t>(i + period)]);
    if (references.empty()) continue;
    steps_.back().first_reference = references_.size();
    references_.insert(references_.end(), references.begin(), references.end());
    steps_.back().last_reference = references_.size();
  }
  for (Step& step : steps_) {
    if (step.coast == 0) continue;
    const auto known = std::ranges::find(coast_lengths_, step.coast);
    step.index = static_cast<std::size_t>(known - coast_lengths_.begin());
    if (known == coast_lengths_.end()) coast_lengths_.push_back(step.coast);
  }
  contacts_.assign(cut_numbers_.size(), {});
  blocks_.resize(cut_numbers_.size() * block_size(modal_));
  coasts_.resize(coast_lengths_.size() * modal_);
}

void Monodromy::prepare(std::span<const LanePoint> points) {
  wanted_pattern_.assign(points[0].depth->cuts.size(), 0);
  for (const LanePoint& point : points) {
    std::ranges::transform(wanted_pattern_, point.depth->cuts, wanted_pattern_.begin(),
                           [](char a, char b) { return static_cast<char>(a | b); });
  }
  if (pattern_.empty() || wanted_pattern_ != pattern_) {
    pattern_ = wanted_pattern_;
    lay_out();
  }
  fill_speeds(points);
  fill_contacts(points);
  build_blocks();
}

void Monodromy::fill_speeds(std::span<const LanePoint> points) {
  resolution_ = points[0].speed->resolution;
  const std::size_t nodes = 2 * static_cast<std::size_t>(resolution_.nodes);
  substep_.resize(modal_);
  at_nodes_.resize(nodes * modal_);
  response_.resize(nodes * nodes);
  influence_.resize(modal_ * nodes);
  work_.resize(block_work(modal_, nodes));
  for (std::size_t lane = 0; lane < lane_count; ++lane) {
    const SpeedPlan& speed = *points[std::min(lane, points.size() - 1)].speed;
    set(at_nodes_, lane, speed.at_nodes);
    set(response_, lane, speed.response);
    set(influence_, lane, speed.influence);
    for (std::size_t k = 0; k < modal_ / 2; ++k) {
      substep_[2 * k].v[lane] = speed.substep(static_cast<Eigen::Index>(k)).real();
      substep_[2 * k + 1].v[lane] = speed.substep(static_cast<Eigen::Index>(k)).imag();
      for (std::size_t c = 0; c < coast_lengths_.size(); ++c) {
        const std::complex<double> factor = power(speed.step(static_cast<Eigen::Index>(k)), coast_lengths_[c]);
        coasts_[c * modal_ + 2 * k].v[lane] = factor.real();
        coasts_[c * modal_ + 2 * k + 1].v[lane] = factor.imag();
      }
    }
  }
}

void Monodromy::fill_contacts(std::span<const LanePoint> points) {
  const Eigen::Matrix2d one = Eigen::Matrix2d::Identity();
  const std::size_t period = static_cast<std::size_t>(cut_.steps());
  const std::size_t delays = cut_.delays().size();
  for (const Step& step : steps_) {
    if (step.coast > 0) continue;
    StepContact& contact = contacts_[step.index];
    for (std::size_t lane = 0; lane < lane_count; ++lane) {
      const DepthPlan& depth = *points[std::min(lane, points.size() - 1)].depth;
      Eigen::Matrix2d stiffness = Eigen::Matrix2d::Zero();
      for (std::size_t g = 0; g < delays; ++g) {
        stiffness += depth.stiffness[g * period + static_cast<std::size_t>(step.number)];
      }
      Eigen::Matrix2d delayed = one;  // (I - K S)^-1
      if (compliant_) {
        delayed = (one - stiffness * tip_.compliance).inverse();
        stiffness = (delayed * stiffness).eval();
        set(contact.compliance, lane, one + tip_.compliance * stiffness);
      }
      set(contact.stiffness, lane, stiffness);
      for (std::size_t r = step.first_reference; r < step.last_reference; ++r) {
        Reference& reference = references_[r];
        const std::size_t at = reference.delay * period + static_cast<std::size_t>(step.number);
        set(reference.matrix, lane, delayed * depth.stiffness[at] * reference.weight);
      }
    }
  }
}

void Monodromy::build_blocks() {
  BlockArguments arguments;
  arguments.modal = modal_;
  arguments.nodes = 2 * static_cast<std::size_t>(resolution_.nodes);
  arguments.halvings = resolution_.halvings;
  arguments.substep = substep_.data();
  arguments.at_nodes = at_nodes_.data();
  arguments.response = response_.data();
  arguments.influence = influence_.data();
  arguments.work = work_.data();
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    arguments.stiffness = contacts_[i].stiffness;
    arguments.block = blocks_.data() + i * block_size(modal_);
    build_block(arguments);
  }
}

void Monodromy::apply(const Lanes* in, Lanes* out) {
  PeriodArguments arguments;
  arguments.modal = modal_;
  arguments.steps = steps_.data();
  arguments.step_count = steps_.size();
  arguments.references = references_.data();
  arguments.blocks = blocks_.data();
  arguments.contacts = contacts_.data();
  arguments.coasts = coasts_.data();
  arguments.displacement = displacement_.data();
  arguments.compliance = compliant_ ? compliance_.data() : nullptr;
  arguments.inputs = outputs_.size();
  arguments.outputs = outputs_.data();
  arguments.memory = memory_.data();
  arguments.state = state_.data();
  arguments.in = in;
  arguments.out = out;
  run_period(arguments);
}

}  // namespace robomill::stability::detail
