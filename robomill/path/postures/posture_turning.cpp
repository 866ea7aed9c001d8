#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "robomill/base/parallel.hpp"
#include "robomill/base/units.hpp"
#include "robomill/path/postures/posture_walk.hpp"

namespace robomill::path {
namespace {

constexpr int most_branches = 32;
constexpr std::size_t most_stations = 400;
constexpr int most_change = 3;         // of gamma between two stations, in steps of the grid
constexpr double per_turned = 100.0;   // of the squared change of gamma [1/rad²], against 1 / margin
constexpr double least_margin = 0.01;  // added to the margin, so that its inverse stays finite
constexpr double most_travel = 0.7;    // of a joint between two stations [rad]; another branch is farther off

struct State {
  robot::Position6 position = robot::Position6::Zero();
  double cost = 0.0;       ///< of standing there, then of the best way there
  std::int32_t from = -1;  ///< state of the station before
  std::int32_t gamma = 0;  ///< on the grid
};
/// States of one station in order of gamma; those of gamma g are [first[g], first[g + 1]).
struct Station {
  std::vector<State> states = {};
  std::vector<std::size_t> first = {};
};

class Turning {
 public:
  Turning(const robot::Kinematics& kinematics, const Head& head, std::vector<double> along,
          const PostureOptions& options, bool as_at_home)
      : kinematics_(kinematics), head_(head), along_(std::move(along)), options_(options), as_at_home_(as_at_home) {}

  /// Gamma at each station, continuous beyond a turn; empty where no way goes through.
  std::vector<double> best(robot::Position6& start) {
    stations_.resize(along_.size());
    parallel_for(along_.size(), 4, [&](std::size_t begin, std::size_t end) {
      for (std::size_t s = begin; s < end; ++s) fill(s);
    });
    for (std::size_t s = 1; s < stations_.size(); ++s) advance(stations_[s - 1], stations_[s]);
    return traced(start);
  }

 private:
  void fill(std::size_t s) {
    Station& station = stations_[s];
    const program::Pose pose = head_.at(along_[s]);
    std::array<robot::Position6, most_branches> branches;
    station.first.push_back(0);
    for (int g = 0; g < options_.gammas; ++g) {
      int count = kinematics_.all(
          {.tip_m = pose.tip_m, .axis = pose.axis, .gamma_rad = units::revolution * g / options_.gammas},
          branches.data(), most_branches);
      if (s == 0 && options_.start && count > 0) {
        const auto far = [&](const robot::Position6& branch) { return (branch - *options_.start).squaredNorm(); };
        branches.front() = *std::min_element(branches.begin(), branches.begin() + count,
                                             [&](const auto& a, const auto& b) { return far(a) < far(b); });
        count = 1;
      }
      for (int k = 0; k < count; ++k) {
        const robot::Position6& position = branches[static_cast<std::size_t>(k)];
        if (s == 0 && as_at_home_) {
          const Resemblance like = resemblance(kinematics_, *options_.home, position, position, position);
          if (!like.shoulder || !like.elbow || !like.wrist || like.turns > 0) continue;
        }
        const double margin = std::min(limit_share(kinematics_, position).share, kinematics_.regularity(position));
        station.states.push_back({.position = position, .cost = 1.0 / (margin + least_margin), .gamma = g});
      }
      station.first.push_back(station.states.size());
    }
  }

  /// The best way into each state of a station.
  void advance(const Station& before, Station& now) const {
    const double per_step = per_turned * std::pow(units::revolution / options_.gammas, 2);
    for (State& state : now.states) {
      double best = std::numeric_limits<double>::infinity();
      for (int change = -most_change; change <= most_change; ++change) {
        const auto g = static_cast<std::size_t>((state.gamma + change + options_.gammas) % options_.gammas);
        for (std::size_t k = before.first[g]; k < before.first[g + 1]; ++k) {
          const State& from = before.states[k];
          const robot::Position6 travel = state.position - from.position;
          if (!(travel.cwiseAbs().maxCoeff() <= most_travel)) continue;
          const double cost = from.cost + per_step * change * change + travel.squaredNorm();
          if (!(cost < best)) continue;
          best = cost;
          state.from = static_cast<std::int32_t>(k);
        }
      }
      state.cost += best;
    }
  }

  std::vector<double> traced(robot::Position6& start) const {
    const std::vector<State>& last = stations_.back().states;
    const auto end =
        std::min_element(last.begin(), last.end(), [](const State& a, const State& b) { return a.cost < b.cost; });
    if (end == last.end() || !std::isfinite(end->cost)) return {};
    std::vector<double> gamma(stations_.size());
    const State* state = &*end;
    gamma.back() = units::revolution * state->gamma / options_.gammas;
    for (std::size_t s = stations_.size() - 1; s > 0; --s) {
      const State& from = stations_[s - 1].states[static_cast<std::size_t>(state->from)];
      gamma[s - 1] = gamma[s] + std::remainder(units::revolution * (from.gamma - state->gamma) / options_.gammas,
                                               units::revolution);
      state = &from;
    }
    start = state->position;
    return gamma;
  }

  const robot::Kinematics& kinematics_;
  const Head& head_;
  std::vector<double> along_;
  const PostureOptions& options_;
  bool as_at_home_;  ///< begin there in no other configuration and without whole turns
  std::vector<Station> stations_ = {};
};

/// Means over so many neighbours to both sides, fewer at the ends, which stay.
std::vector<double> smoothed(const std::vector<double>& values, std::size_t width) {
  std::vector<double> out(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t reach = std::min({width, i, values.size() - 1 - i});
    double sum = 0.0;
    for (std::size_t k = i - reach; k <= i + reach; ++k) sum += values[k];
    out[i] = sum / static_cast<double>(2 * reach + 1);
  }
  return out;
}

/// From values at stations to the start and each block's end.
std::vector<double> at_blocks(const std::vector<double>& along, const std::vector<double>& values, std::size_t blocks) {
  std::vector<double> out(blocks + 1);
  std::size_t s = 0;
  for (std::size_t block = 0; block <= blocks; ++block) {
    const double t = static_cast<double>(block);
    while (s + 2 < along.size() && along[s + 1] < t) ++s;
    const double share = std::clamp((t - along[s]) / (along[s + 1] - along[s]), 0.0, 1.0);
    out[block] = values[s] + share * (values[s + 1] - values[s]);
  }
  return out;
}

}  // namespace

Posture turning_posture(const robot::Kinematics& kinematics, const Head& head, const std::vector<double>& along,
                        const PostureOptions& options) {
  const std::vector<double> places = thinned(along, most_stations);
  Posture out;
  for (const bool as_at_home : {true, false}) {
    if (as_at_home && !options.home) continue;
    const std::vector<double> steps = Turning(kinematics, head, places, options, as_at_home).best(out.start);
    if (steps.empty()) continue;
    // The grid's steps are smoothed as far as the way allows.
    for (const std::size_t width : {16U, 8U, 4U, 2U, 1U, 0U}) {
      const std::vector<double> gamma = at_blocks(places, smoothed(steps, width), head.line.size());
      if (walk(kinematics, head, along, gamma, out.start, {}).reach.status != robot::Reach::Status::found) continue;
      out.gamma_rad = gamma;
      return out;
    }
  }
  return out;
}

}  // namespace robomill::path
