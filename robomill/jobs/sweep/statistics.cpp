#include "robomill/jobs/sweep/statistics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robomill/base/printable.hpp"
#include "robomill/jobs/sweep/shown_points.hpp"

namespace robomill::jobs {
namespace {

/// Rows of a summary; all are in statistics.json.
constexpr std::size_t most_rows = 20;
/// Of samples that are left out: more than that is said to bias the result.
constexpr double much = 0.05;

Settled settled_at(const StudyPoints& points, std::size_t combination) {
  Settled out;
  for (io::TomlSetting& one : points.settled(combination)) out.emplace_back(std::move(one.key), std::move(one.value));
  return out;
}

/// A value at each sample of a combination.
std::vector<double> samples_of(const std::vector<double>& column, const StudyPoints& points, std::size_t combination) {
  std::vector<double> out(points.samples());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = column[points.point(combination, i)];
  return out;
}

std::size_t place_in(const std::vector<std::string>& names, const std::string& name) {
  return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
}

std::vector<std::string> sampled_keys(const Study& study) {
  std::vector<std::string> out;
  for (const Variation& one : study.vary) {
    if (one.is_sampled()) out.push_back(one.keys.front());
  }
  return out;
}

std::vector<SensitivityRow> sensitivity_of(const Study& study, const StudyPoints& points,
                                           const std::vector<std::vector<double>>& columns) {
  std::vector<SensitivityRow> out;
  const std::vector<std::string> keys = sampled_keys(study);
  for (std::size_t c = 0; c < points.combinations(); ++c) {
    for (std::size_t v = 0; v < columns.size(); ++v) {
      out.push_back({.at = settled_at(points, c),
                     .value = study.collect[v],
                     .keys = keys,
                     .indices = sobol_indices(samples_of(columns[v], points, c), keys.size(),
                                              static_cast<std::uint64_t>(study.seed))});
    }
  }
  return out;
}

ProbabilityStatistics probability_of(const Study& study, const StudyPoints& points,
                                     const std::vector<std::vector<double>>& columns) {
  ProbabilityStatistics out{.task = *study.probability};
  const Condition condition{.at_least = out.task.at_least, .at_most = out.task.at_most};
  for (std::size_t c = 0; c < points.combinations(); ++c) {
    for (const std::string& value : out.task.values) {
      const std::vector<double> samples = samples_of(columns[place_in(study.collect, value)], points, c);
      out.rows.push_back(
          {.at = settled_at(points, c), .value = value, .share = share_of(samples, condition, out.task.worst_share)});
    }
  }
  const auto is_better = [&](const ConditionShare& one, const ConditionShare& than) {
    if (one.worst != than.worst) return condition.at_least ? one.worst > than.worst : one.worst < than.worst;
    return one.share.value > than.share.value;
  };
  for (const ProbabilityRow& row : out.rows) {
    if (row.share.points == 0) continue;
    if (!out.optimum || is_better(row.share, out.optimum->share)) out.optimum = row;
  }
  if (!out.optimum) return out;
  for (const ProbabilityRow& row : out.rows) out.equal += row.share.worst == out.optimum->share.worst ? 1 : 0;
  --out.equal;
  return out;
}

std::string at_text(const Settled& at) {
  std::string out;
  for (const auto& [key, value] : at) out += fmt::format("{}{} = {}", out.empty() ? "" : ", ", key, shown_text(value));
  return printable(out);
}

/// What was left out of a result, and what that means; empty: nothing.
std::string left_out_text(std::size_t left_out, std::size_t of, const char* what) {
  if (left_out == 0) return {};
  std::string out = fmt::format("; {} of {} {} left out", left_out, of, what);
  if (static_cast<double>(left_out) > much * static_cast<double>(of)) out += ", which may bias it";
  return out;
}

void add_boundary(const BoundaryStatistics& found, std::vector<std::string>& lines) {
  std::string steps;
  for (const auto& [key, step] : found.steps) steps += fmt::format("{}{} {:.3g}", steps.empty() ? "" : ", ", key, step);
  lines.push_back(fmt::format("Boundary {} = {}: {} points, between points of a grid of steps {}.",
                              printable(found.task.value), found.task.level, found.points, printable(steps)));
  lines.push_back(fmt::format("{} evaluations; the grid has {:.4g}: {:.3g} times as many.", found.evaluations,
                              found.grid_points, found.grid_points / static_cast<double>(found.evaluations)));
  if (!found.complete) {
    lines.push_back(fmt::format("Warning: most_points = {} was reached before all {} halvings were done.",
                                found.task.most_points, found.task.halvings));
  }
  if (found.unknown > 0) {
    lines.push_back(fmt::format("Warning: {} points have no value; the boundary ends there, and {} cubes lost it.",
                                found.unknown, found.lost_cubes));
  }
  if (found.interpolated > 0) {
    lines.push_back(
        fmt::format("{} more points were interpolated. Of {} values that were evaluated and interpolated, {} differ by "
                    "more than the "
                    "estimated error.",
                    found.interpolated, found.compared, found.beyond_error));
  }
  if (found.middle_points > 0) {
    lines.push_back(
        fmt::format("{} points lie in the middle of a step whose one end is infinite.", found.middle_points));
  }
  if (found.points == 0) {
    lines.emplace_back(
        "No point of the coarse grid lies on another side of the level than the others. A closed boundary within one "
        "of its cubes is not seen.");
  }
}

std::string estimate_text(const Estimate& one) {
  return fmt::format("{:.3f} ({:.3f} to {:.3f})", one.value, one.low, one.high);
}

void add_sensitivity(const SensitivityRow& row, std::vector<std::string>& lines) {
  const std::string name = printable(row.value) + (row.at.empty() ? "" : " at " + at_text(row.at));
  const SobolIndices& found = row.indices;
  const std::string left_out =
      left_out_text(found.left_out, found.samples + found.left_out, "samples without finite values");
  if (found.status != SobolStatus::found) {
    lines.push_back(fmt::format("{}: {}{}.", name,
                                found.status == SobolStatus::constant ? "is constant, no key matters"
                                                                      : "too few samples have a value for indices",
                                left_out));
    return;
  }
  lines.push_back(fmt::format("{}: Sobol' indices from {} samples{}", name, found.samples, left_out));
  for (std::size_t i = 0; i < row.keys.size(); ++i) {
    lines.push_back(fmt::format("  {}: first {}, total {}", printable(row.keys[i]),
                                estimate_text(found.inputs[i].first), estimate_text(found.inputs[i].total)));
  }
}

std::string probability_text(const ProbabilityRow& row) {
  const ConditionShare& found = row.share;
  return fmt::format("{}{}{}: {} of {} points{}", printable(row.value), row.at.empty() ? "" : " at ", at_text(row.at),
                     estimate_text(found.share), found.points,
                     left_out_text(found.left_out, found.points + found.left_out, "points without a value"));
}

void add_probability(const ProbabilityStatistics& found, std::vector<std::string>& lines) {
  lines.push_back(
      fmt::format("Probability of {} {}, with its 95 % interval:", found.task.at_least ? "at least" : "at most",
                  found.task.at_least ? *found.task.at_least : *found.task.at_most));
  for (std::size_t i = 0; i < std::min(found.rows.size(), most_rows); ++i) {
    lines.push_back("  " + probability_text(found.rows[i]));
  }
  if (found.rows.size() > most_rows) {
    lines.push_back(fmt::format("  … {} more in statistics.json", found.rows.size() - most_rows));
  }
  if (!found.optimum || found.rows.size() < 2) return;
  const double worst = found.optimum->share.worst;
  lines.push_back(fmt::format("Robust optimum: {}{}{}, at most {:g} % of its points are {} {}{}.",
                              printable(found.optimum->value), found.optimum->at.empty() ? "" : " at ",
                              at_text(found.optimum->at), 100.0 * found.task.worst_share,
                              found.task.at_least ? "below" : "above",
                              std::isinf(worst) ? std::string("infinity, no limit") : fmt::format("{:.4g}", worst),
                              found.equal > 0 ? fmt::format("; {} others are equal in that", found.equal) : ""));
}

}  // namespace

BoundaryOptions boundary_options(const Study& study) {
  BoundaryOptions out{.halvings = study.boundary->halvings,
                      .most_points = static_cast<std::uint64_t>(study.boundary->most_points),
                      .interpolate = study.boundary->interpolate};
  for (const Variation& one : study.vary) {
    out.axes.push_back({.low = one.range[0], .high = one.range[1], .count = one.count});
  }
  return out;
}

BoundaryStatistics summary_of_boundary(const Study& study, const Boundary& boundary) {
  BoundaryStatistics out{.task = *study.boundary,
                         .points = static_cast<std::uint64_t>(boundary.points.rows()),
                         .evaluations = boundary.evaluations,
                         .interpolated = boundary.interpolated,
                         .compared = boundary.compared,
                         .beyond_error = boundary.beyond_error,
                         .grid_points = boundary.grid_points,
                         .unknown = boundary.unknown,
                         .lost_cubes = boundary.lost_cubes,
                         .middle_points = boundary.middle_points,
                         .complete = boundary.complete};
  const BoundaryGrid grid(boundary_options(study));
  for (std::size_t axis = 0; axis < grid.axes(); ++axis) {
    const double range = study.vary[axis].range[1] - study.vary[axis].range[0];
    const std::uint64_t steps = (grid.count(axis) - 1) / boundary.step;
    out.steps.emplace_back(study.vary[axis].keys.front(), range / static_cast<double>(steps));
  }
  return out;
}

Statistics statistics_of(const Study& study, const StudyPoints& points,
                         const std::vector<std::vector<double>>& columns) {
  Statistics out;
  if (study.sensitivity) out.sensitivity = sensitivity_of(study, points, columns);
  if (study.probability) out.probability = probability_of(study, points, columns);
  return out;
}

std::vector<std::string> lines_of(const Statistics& statistics) {
  std::vector<std::string> out;
  if (statistics.boundary) add_boundary(*statistics.boundary, out);
  for (std::size_t i = 0; i < std::min(statistics.sensitivity.size(), most_rows); ++i) {
    add_sensitivity(statistics.sensitivity[i], out);
  }
  if (statistics.sensitivity.size() > most_rows) {
    out.push_back(fmt::format("… indices of {} more in statistics.json", statistics.sensitivity.size() - most_rows));
  }
  if (statistics.probability) add_probability(*statistics.probability, out);
  return out;
}

}  // namespace robomill::jobs
