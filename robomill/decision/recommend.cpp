#include "robomill/decision/recommend.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/cutting/cut_limits.hpp"

namespace robomill::decision {
namespace {

double depth_or_all(const stability::Limit& limit, const RecommendOptions& options) {
  const bool found = limit.status == stability::Limit::Status::found;
  return found ? std::min(limit.axial_depth_m, options.searched_depth_m) : options.searched_depth_m;
}

/// What binds at the speeds of a window.
struct Window {
  std::optional<stability::Limit> lowest = {};  ///< with the lowest limit
  FinishDepth finish = {};

  void add(const DepthLimit& limit, const RecommendOptions& options) {
    if (!lowest || depth_or_all(limit.chatter, options) < depth_or_all(*lowest, options)) lowest = limit.chatter;
    if (limit.finish.axial_depth_m < finish.axial_depth_m) finish = limit.finish;
  }
};

struct Candidate {
  Operation operation;
  Window window;
};

/// The operation at `speed`, given what binds in its window.
Operation operation_at(double speed, const Window& window, const RecommendOptions& options) {
  const stability::Limit& lowest = *window.lowest;
  Operation op;
  op.spindle_speed_rad_per_s = speed;
  op.feed_per_tooth_m = options.feed_per_tooth_m;
  op.feed_m_per_s = options.feed_per_tooth_m * options.teeth * speed / (2.0 * std::numbers::pi);
  op.cutting_speed_m_per_s = 0.5 * options.diameter_m * speed;
  op.limit_depth_m = depth_or_all(lowest, options);
  op.axial_depth_m = op.limit_depth_m * (1.0 - options.machine.depth_margin);
  op.limited_by = lowest.status == stability::Limit::Status::found ? LimitedBy::chatter : LimitedBy::depth_range;
  op.chatter_frequency_hz = lowest.chatter_frequency_hz;
  op.mode = lowest.mode;
  const auto cap = [&op](double depth, LimitedBy reason) {
    if (depth < op.axial_depth_m) {
      op.axial_depth_m = std::max(depth, 0.0);
      op.limited_by = reason;
    }
  };
  if (options.machine.max_axial_depth_m > 0.0) cap(options.machine.max_axial_depth_m, LimitedBy::cutter);
  if (!options.machine.spindle.empty() && options.mean_torque_n_m) {
    const SpindleCapacity capacity = capacity_at(options.machine.spindle, speed);
    const auto depth_of = [&](double torque_n_m) {
      return depth_of_torque_m(options.mean_torque_n_m, torque_n_m, op.axial_depth_m);
    };
    cap(depth_of(capacity.torque_n_m), LimitedBy::spindle_torque);
    cap(depth_of(capacity.power_w / speed), LimitedBy::spindle_power);
  }
  cap(window.finish.axial_depth_m, window.finish.reason);
  op.margin = op.limit_depth_m > 0.0 ? 1.0 - op.axial_depth_m / op.limit_depth_m : 0.0;
  op.torque_n_m = options.mean_torque_n_m ? options.mean_torque_n_m(op.axial_depth_m) : 0.0;
  op.power_w = op.torque_n_m * speed;
  op.removal_rate_m3_per_s = op.axial_depth_m * options.radial_depth_m * op.feed_m_per_s;
  return op;
}

/// One operation for each given speed whose whole window lies within the limits and the spindle's range.
std::vector<Candidate> candidates(const std::vector<DepthLimit>& limits, const RecommendOptions& options) {
  std::vector<Candidate> out;
  const double highest = options.machine.max_spindle_speed_rad_per_s > 0.0
                             ? options.machine.max_spindle_speed_rad_per_s
                             : limits.back().chatter.spindle_speed_rad_per_s;
  for (const DepthLimit& centre : limits) {
    const double speed = centre.chatter.spindle_speed_rad_per_s;
    const double from = speed * (1.0 - options.machine.speed_window);
    const double to = speed * (1.0 + options.machine.speed_window);
    if (speed < options.machine.min_spindle_speed_rad_per_s || speed > highest) continue;
    if (from < limits.front().chatter.spindle_speed_rad_per_s || to > limits.back().chatter.spindle_speed_rad_per_s)
      continue;
    Window window;
    window.add(centre, options);
    for (const DepthLimit& other : limits) {
      const double other_speed = other.chatter.spindle_speed_rad_per_s;
      const bool inside = other_speed >= from && other_speed <= to;
      if (inside) window.add(other, options);
    }
    out.push_back({operation_at(speed, window, options), window});
  }
  return out;
}

bool distinct(const Operation& op, const std::vector<Operation>& chosen, double fraction) {
  return std::all_of(chosen.begin(), chosen.end(), [&](const Operation& other) {
    return std::abs(op.spindle_speed_rad_per_s - other.spindle_speed_rad_per_s) >=
           fraction * other.spindle_speed_rad_per_s;
  });
}

bool better(const Operation& a, const Operation& b) {
  if (a.removal_rate_m3_per_s != b.removal_rate_m3_per_s) return a.removal_rate_m3_per_s > b.removal_rate_m3_per_s;
  return a.spindle_speed_rad_per_s < b.spindle_speed_rad_per_s;
}

/// Candidates in the order in which they are tried: peaks of the removal rate first, the best first.
std::vector<Candidate> ranked(const std::vector<Candidate>& all) {
  const auto rate = [&all](std::size_t i) { return all[i].operation.removal_rate_m3_per_s; };
  const auto first = [](const Candidate& a, const Candidate& b) { return better(a.operation, b.operation); };
  std::vector<Candidate> peaks;
  std::vector<Candidate> others;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool rises = i == 0 || rate(i) > rate(i - 1);
    const bool falls = i + 1 == all.size() || rate(i) >= rate(i + 1);
    (rises && falls ? peaks : others).push_back(all[i]);
  }
  std::sort(peaks.begin(), peaks.end(), first);
  std::sort(others.begin(), others.end(), first);
  peaks.insert(peaks.end(), others.begin(), others.end());
  return peaks;
}

/// The operation again, with the limits looked up at nine speeds over its window.
Operation verified(const Candidate& candidate, const RecommendOptions& options,
                   const std::function<DepthLimit(double)>& limit_at) {
  constexpr int looks = 9;
  const double speed = candidate.operation.spindle_speed_rad_per_s;
  Window window = candidate.window;
  for (int i = 0; i < looks; ++i) {
    const double part = 2.0 * i / (looks - 1) - 1.0;
    window.add(limit_at(speed * (1.0 + options.machine.speed_window * part)), options);
  }
  return operation_at(speed, window, options);
}

void validate_limits(const std::vector<DepthLimit>& limits) {
  if (limits.size() < 2) throw InvalidInput("limits", "need at least two spindle speeds");
  for (std::size_t i = 0; i < limits.size(); ++i) {
    const double speed = limits[i].chatter.spindle_speed_rad_per_s;
    require_positive("spindle_speed_rad_per_s", speed, "rad/s");
    if (i > 0 && speed <= limits[i - 1].chatter.spindle_speed_rad_per_s) {
      throw InvalidInput("spindle_speed_rad_per_s", speed, "rad/s", "must increase");
    }
  }
}

}  // namespace

SpindleCapacity capacity_at(const std::vector<SpindleCapacity>& curve, double spindle_speed_rad_per_s) {
  const double speed = spindle_speed_rad_per_s;
  const auto above = std::find_if(curve.begin(), curve.end(),
                                  [&](const SpindleCapacity& p) { return p.spindle_speed_rad_per_s >= speed; });
  if (above == curve.end()) return {.spindle_speed_rad_per_s = speed};
  if (above == curve.begin()) {
    return above->spindle_speed_rad_per_s == speed ? *above : SpindleCapacity{.spindle_speed_rad_per_s = speed};
  }
  const SpindleCapacity& low = *(above - 1);
  const double t =
      (speed - low.spindle_speed_rad_per_s) / (above->spindle_speed_rad_per_s - low.spindle_speed_rad_per_s);
  return {.spindle_speed_rad_per_s = speed,
          .torque_n_m = std::lerp(low.torque_n_m, above->torque_n_m, t),
          .power_w = std::lerp(low.power_w, above->power_w, t)};
}

double depth_of_torque_m(const std::function<double(double)>& mean_torque_n_m, double torque_n_m, double deepest_m) {
  if (!(mean_torque_n_m(deepest_m) > torque_n_m)) return deepest_m;
  // Nearly proportional to depth: a chord from 0 is close, and every next one closer.
  double low_m = 0.0;
  double high_m = deepest_m;
  double low = -torque_n_m;
  double high = mean_torque_n_m(deepest_m) - torque_n_m;
  for (int i = 0; i < 60 && high_m - low_m > 1e-12 * deepest_m && low < 0.0; ++i) {
    // Halving every third time bounds the number of steps.
    const double at_m = i % 3 == 2 ? 0.5 * (low_m + high_m) : low_m - low * (high_m - low_m) / (high - low);
    const double excess = mean_torque_n_m(at_m) - torque_n_m;
    if (std::abs(excess) <= 1e-12 * torque_n_m) return at_m;
    (excess > 0.0 ? high_m : low_m) = at_m;
    (excess > 0.0 ? high : low) = excess;
  }
  return low_m;
}

std::array<double, 2> spindle_range(const MachineLimits& limits) {
  double from = limits.min_spindle_speed_rad_per_s;
  double to = limits.max_spindle_speed_rad_per_s;
  if (!limits.spindle.empty()) {
    from = std::max(from, limits.spindle.front().spindle_speed_rad_per_s);
    const double end = limits.spindle.back().spindle_speed_rad_per_s;
    to = to > 0.0 ? std::min(to, end) : end;
  }
  return {from, to};
}

void MachineLimits::validate() const {
  require_non_negative("max_axial_depth_m", max_axial_depth_m, "m");
  if (max_axial_depth_m > 0.5) {
    throw InvalidInput("max_axial_depth_m", max_axial_depth_m, "m", "is deeper than any milling cut",
                       "It is the length of the cutter's edges; are the units mixed up?");
  }
  const std::pair<const char*, double> range[] = {{"min_spindle_speed_rad_per_s", min_spindle_speed_rad_per_s},
                                                  {"max_spindle_speed_rad_per_s", max_spindle_speed_rad_per_s}};
  for (const auto& [name, speed] : range) {
    if (speed != 0.0) cutting::require_spindle_speed(name, speed);
  }
  if (max_spindle_speed_rad_per_s > 0.0 && max_spindle_speed_rad_per_s <= min_spindle_speed_rad_per_s) {
    throw InvalidInput("max_spindle_speed_rad_per_s", max_spindle_speed_rad_per_s, "rad/s",
                       "must be above the spindle's lowest speed");
  }
  cutting::require_depth_margin(depth_margin);
  cutting::require_speed_window(speed_window);
  for (std::size_t i = 0; i < spindle.size(); ++i) {
    const std::string path = "spindle[" + std::to_string(i + 1) + "].";
    const SpindleCapacity& p = spindle[i];
    cutting::require_spindle_speed(path + "spindle_speed_rad_per_s", p.spindle_speed_rad_per_s);
    require_non_negative((path + "torque_n_m").c_str(), p.torque_n_m, "N m");
    require_non_negative((path + "power_w").c_str(), p.power_w, "W");
    if (i > 0 && p.spindle_speed_rad_per_s <= spindle[i - 1].spindle_speed_rad_per_s) {
      throw InvalidInput(path + "spindle_speed_rad_per_s", p.spindle_speed_rad_per_s, "rad/s",
                         "must be above the speed of the point before it");
    }
  }
}

void RecommendOptions::validate() const {
  machine.validate();
  if (teeth < 1) throw InvalidInput("teeth", teeth, "", "must be >= 1");
  require_positive("radial_depth_m", radial_depth_m, "m");
  require_non_negative("diameter_m", diameter_m, "m");
  require_positive("feed_per_tooth_m", feed_per_tooth_m, "m");
  require_positive("searched_depth_m", searched_depth_m, "m");
  if (alternatives < 0) throw InvalidInput("alternatives", alternatives, "", "must be >= 0");
}

Recommendation recommend(const std::vector<DepthLimit>& limits, const RecommendOptions& options,
                         const std::function<DepthLimit(double)>& limit_at) {
  options.validate();
  validate_limits(limits);
  Recommendation result;
  const std::vector<Candidate> all = candidates(limits, options);
  if (all.empty()) {
    result.reason = "no spindle speed of the lobes lies within the spindle's range with its speed window";
    return result;
  }
  std::vector<Operation> chosen;
  constexpr double fraction_apart = 0.05;
  const std::size_t wanted = 1 + static_cast<std::size_t>(options.alternatives);
  for (const Candidate& candidate : ranked(all)) {
    if (chosen.size() == wanted) break;
    const Operation& op = candidate.operation;
    if (op.axial_depth_m <= 0.0 || !distinct(op, chosen, fraction_apart)) continue;
    const Operation checked = verified(candidate, options, limit_at);
    if (checked.axial_depth_m > 0.0) chosen.push_back(checked);
  }
  if (chosen.empty()) {
    result.reason =
        "every spindle speed chatters at any depth, the spindle gives no torque, or surface error, deflection or "
        "forced vibration allows no depth";
    return result;
  }
  std::sort(chosen.begin(), chosen.end(), better);
  result.status = Recommendation::Status::found;
  result.recommended = chosen.front();
  result.alternatives.assign(chosen.begin() + 1, chosen.end());
  return result;
}

}  // namespace robomill::decision
