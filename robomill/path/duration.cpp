#include "robomill/path/duration.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "robomill/base/cost.hpp"
#include "robomill/base/units.hpp"

namespace robomill::path {
namespace {

constexpr double hour_s = 60.0 * units::minute;
constexpr double mm_per_min = units::mm / units::minute;  // as programs give feeds

std::string text(double value, const char* unit) {
  std::array<char, 48> out = {};
  std::snprintf(out.data(), out.size(), "%.4g %s", value, unit);
  return out.data();
}

std::string allowed(const SmoothingOptions& options) {
  return text(options.max_duration_s / hour_s, "h") + " are allowed";
}

constexpr const char* settable = "[smoothing] max_duration_h sets what is allowed";

/// What a program is made of.
struct Program {
  double length_m = 0.0, angle_rad = 0.0;  ///< of the whole way
  std::size_t blocks = 0;
  double duration_s = 0.0;  ///< by its feeds and dwells and the limits of velocity
  double longest_s = 0.0;   ///< of its blocks
  program::Block longest;
  std::size_t longest_block = 0;
  double longest_m = 0.0;
};

Program survey(program::Source& source, const SmoothingOptions& options, Progress& progress) {
  Program out;
  program::Pose at = source.start();
  program::Block block;
  progress.start("reading the program", 0);
  for (std::size_t i = 0; source.next(block); out.blocks = ++i) {
    if (i % 1024 == 0) progress.check();
    double took_s = block.duration_s, length_m = 0.0;
    if (block.kind != program::Block::Kind::dwell) {
      length_m = (block.end.tip_m - at.tip_m).norm();
      const double angle_rad = program::angle_between(at.axis, block.end.axis);
      took_s = std::max(
          {took_s, length_m / options.max_velocity_m_per_s, angle_rad / options.max_angular_velocity_rad_per_s});
      out.length_m += length_m;
      out.angle_rad += angle_rad;
      at = block.end;
    }
    out.duration_s += took_s;
    if (took_s <= out.longest_s) continue;
    out.longest_s = took_s;
    out.longest = block;
    out.longest_block = i;
    out.longest_m = length_m;
  }
  return out;
}

void require_limits(const Program& program, const SmoothingOptions& options) {
  struct Limit {
    const char* member;
    const char* unit;
    double value, least_s;
  };
  const double s = program.length_m, a = program.angle_rad;
  const SmoothingOptions& o = options;
  const auto accelerated = [](double way, double limit) { return 2.0 * std::sqrt(way / limit); };
  const auto jerked = [](double way, double limit) { return std::cbrt(32.0 * way / limit); };
  const std::array<Limit, 6> limits = {{
      {"max_velocity_m_per_s", "m/s", o.max_velocity_m_per_s, s / o.max_velocity_m_per_s},
      {"max_acceleration_m_per_s2", "m/s^2", o.max_acceleration_m_per_s2, accelerated(s, o.max_acceleration_m_per_s2)},
      {"max_jerk_m_per_s3", "m/s^3", o.max_jerk_m_per_s3, jerked(s, o.max_jerk_m_per_s3)},
      {"max_angular_velocity_rad_per_s", "rad/s", o.max_angular_velocity_rad_per_s,
       a / o.max_angular_velocity_rad_per_s},
      {"max_angular_acceleration_rad_per_s2", "rad/s^2", o.max_angular_acceleration_rad_per_s2,
       accelerated(a, o.max_angular_acceleration_rad_per_s2)},
      {"max_angular_jerk_rad_per_s3", "rad/s^3", o.max_angular_jerk_rad_per_s3,
       jerked(a, o.max_angular_jerk_rad_per_s3)},
  }};
  for (const Limit& limit : limits) {
    if (limit.least_s <= options.max_duration_s) continue;
    throw InvalidInput(limit.member, limit.value, limit.unit,
                       "makes the program last at least " + text(limit.least_s / hour_s, "h") + "; " + allowed(options),
                       settable);
  }
}

/// A sample is computed, checked and written.
void require_affordable_samples(const SmoothingOptions& options, double duration_s) {
  constexpr double operations_of_sample = 4e3, usual_period_s = 1e-3;
  require_affordable({.operations = operations_of_sample * duration_s / options.sample_period_s,
                      .dominant = dominant_of({{.field = "sample_period_s",
                                                .value = options.sample_period_s,
                                                .unit = "s",
                                                .times_usual = usual_period_s / options.sample_period_s},
                                               {.field = "the program's duration",
                                                .value = duration_s,
                                                .unit = "s",
                                                .times_usual = duration_s / hour_s}})});
}

}  // namespace

std::size_t require_duration(program::Source& source, const SmoothingOptions& options, Progress& progress) {
  const Program program = survey(source, options, progress);
  require_limits(program, options);
  if (program.duration_s <= options.max_duration_s) {
    require_affordable_samples(options, program.duration_s);
    return program.blocks;
  }
  const bool dwell = program.longest.kind == program::Block::Kind::dwell;
  const double feed = program.longest_m / program.longest_s / mm_per_min;
  InvalidInput::Parts parts{.field = "block " + std::to_string(program.longest_block + 1) + " (line " +
                                     std::to_string(program.longest.line) + ")"};
  parts.rule = (dwell ? "dwells for " : "takes ") + text(program.longest_s / hour_s, "h");
  if (!dwell && program.longest_m > 0.0) parts.rule += " at " + text(feed, "mm/min");
  parts.rule += ", the program " + text(program.duration_s / hour_s, "h") + "; " + allowed(options);
  parts.hint = settable;
  throw InvalidInput(std::move(parts));
}

void require_end(const SmoothingOptions& options, double planned_s, std::size_t block, std::size_t line) {
  if (planned_s <= options.max_duration_s) return require_affordable_samples(options, planned_s);
  InvalidInput::Parts parts{.field = "program"};
  parts.rule = "lasts " + text(planned_s / hour_s, "h");
  if (line > 0) {
    parts.rule += " up to block " + std::to_string(block + 1) + " (line " + std::to_string(line) + ") alone";
  }
  parts.rule += " within the limits of the tool and the joints; " + allowed(options);
  parts.hint = "Is a joint's limit in another unit? ";
  parts.hint += settable;
  throw InvalidInput(std::move(parts));
}

}  // namespace robomill::path
