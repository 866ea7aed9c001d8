#include "robomill/jobs/sweep/study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <string_view>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/jobs/sweep/samples.hpp"
#include "robomill/jobs/sweep/statistics.hpp"

namespace robomill::jobs {
namespace {

constexpr double most_points = 1e9;
/// Of keys: they are kept as text.
constexpr int most_values = 10'000'000;
/// Fewer than the Sobol' sequence has dimensions.
constexpr std::size_t most_keys = 1000;

std::string number_text(double value) {
  return fmt::format("{}", value);
}

double between(const std::array<double, 2>& range, double share) {
  return range[0] + (range[1] - range[0]) * share;
}

std::vector<std::vector<std::string>> grid_rows(const Variation& one) {
  std::vector<std::vector<std::string>> rows;
  rows.reserve(static_cast<std::size_t>(one.count));
  for (int i = 0; i < one.count; ++i) {
    rows.push_back({number_text(i + 1 == one.count ? one.range[1] : between(one.range, i / (one.count - 1.0)))});
  }
  return rows;
}

/// What is wrong with a variation; empty: nothing.
std::string fault_of(const Variation& one) {
  if (one.keys.empty() || std::ranges::any_of(one.keys, [](const std::string& key) { return key.empty(); })) {
    return "must name a key";
  }
  if (!one.values.empty()) {
    const auto fits = [&](const std::vector<std::string>& row) { return row.size() == one.keys.size(); };
    return std::ranges::all_of(one.values, fits) ? "" : "must have a value for each key";
  }
  if (one.keys.size() != 1) return "must have rows of values for several keys";
  if (!std::isfinite(one.range[0]) || !std::isfinite(one.range[1]) || !(one.range[0] < one.range[1])) {
    return "must have values, or a range that rises";
  }
  if (one.count < (one.sampling == Sampling::grid ? 2 : 1) || one.count > most_values) {
    return fmt::format("must have a count of 1 to {}, or of 2 and more on a grid", most_values);
  }
  return {};
}

std::size_t rows_of(const Variation& one) {
  return one.values.empty() ? static_cast<std::size_t>(one.count) : one.values.size();
}

void require_bounded(std::size_t keys, double values, double points) {
  if (keys > most_keys) {
    throw InvalidInput("vary", static_cast<double>(keys), "keys", fmt::format("must be at most {}", most_keys));
  }
  if (values > most_values) {
    throw InvalidInput("vary", values, "values", fmt::format("must be at most {} of all keys together", most_values));
  }
  if (points > most_points) {
    throw InvalidInput("vary", points, "points", fmt::format("must make at most {:.0e}", most_points),
                       "Sample the keys together: sampling = \"sobol\"");
  }
}

void require_collected(const Study& study, const std::string& member, const std::string& value) {
  if (std::ranges::find(study.collect, value) == study.collect.end()) {
    throw InvalidInput(member, fmt::format("\"{}\" must be collected", value));
  }
}

bool has_samples(const Study& study) {
  return std::ranges::any_of(study.vary, &Variation::is_sampled);
}

void validate_boundary(const Study& study) {
  if (study.sensitivity || study.probability) {
    throw InvalidInput("boundary", "must stand alone", "Indices and probabilities are of samples: write another study");
  }
  require_collected(study, "boundary.value", study.boundary->value);
  if (study.boundary->most_points < 1)
    throw InvalidInput("boundary.most_points", study.boundary->most_points, "points", "must be >= 1");
  if (!std::isfinite(study.boundary->level)) throw InvalidInput("boundary.level", "must be finite");
  for (std::size_t i = 0; i < study.vary.size(); ++i) {
    if (!study.vary[i].values.empty() || study.vary[i].is_sampled()) {
      throw InvalidInput(fmt::format("vary[{}]", i), "must be a range on a grid",
                         "The boundary is traced along every key that varies");
    }
  }
  try {
    boundary_options(study).validate();
  } catch (const InvalidInput& error) {
    throw within("boundary.", error);
  }
}

void validate_sensitivity(const Study& study) {
  const int samples = study.sensitivity->samples;
  if (samples < 8 || (samples & (samples - 1)) != 0) {
    throw InvalidInput("sensitivity.samples", samples, "", "must be a power of two, 8 at least",
                       "The Sobol' sequence is even in steps of them");
  }
  if (study.probability) {
    throw InvalidInput("sensitivity", "must stand without [probability]",
                       "The points of the indices are no independent samples: write another study");
  }
  if (!has_samples(study)) throw InvalidInput("sensitivity", "needs keys with sampling = \"sobol\"");
  for (std::size_t i = 0; i < study.vary.size(); ++i) {
    const Variation& one = study.vary[i];
    const std::string member = fmt::format("vary[{}]", i);
    if (one.is_sampled() && one.sampling != Sampling::sobol) {
      throw InvalidInput(member + ".sampling", "must be sobol beside [sensitivity]");
    }
    if (one.is_sampled() && one.count != samples) {
      throw InvalidInput(member + ".count", one.count, "", fmt::format("must be sensitivity.samples = {}", samples),
                         "Leave it out");
    }
  }
}

void validate_probability(const Study& study) {
  const ProbabilityTask& task = *study.probability;
  if (task.values.empty()) throw InvalidInput("probability.values", "must name a value at least");
  for (const std::string& value : task.values) require_collected(study, "probability.values", value);
  if (task.at_least.has_value() == task.at_most.has_value()) {
    throw InvalidInput("probability", "must have at_least or at_most",
                       task.at_least ? "Both are given" : "None is given");
  }
  if (!(task.worst_share >= 0.0 && task.worst_share < 1.0)) {
    throw InvalidInput("probability.worst_share", task.worst_share, "", "must be >= 0 and < 1");
  }
  if (!has_samples(study)) {
    throw InvalidInput("probability", "needs keys that are sampled", "As sampling = \"sobol\"");
  }
}

/// Points of a sample.
std::size_t points_of_sample(const Study& study, std::size_t keys) {
  return study.sensitivity ? keys + 2 : 1;
}

}  // namespace

void Study::validate() const {
  if (vary.empty()) throw InvalidInput("vary", "must name a key at least", "Write [[vary]] above each");
  if (collect.empty()) throw InvalidInput("collect", "must name a value at least", "As [\"limit@8000\"]");
  if (seed < 0) throw InvalidInput("seed", seed, "", "must be >= 0");
  if (chunk_points < 0) throw InvalidInput("chunk_points", chunk_points, "", "must be >= 0");
  std::set<std::string_view> known;
  double points = 1.0, kept = 0.0;
  std::array<int, 3> counted = {0, 0, 0};  // samples, by their kind
  const std::size_t parts =
      points_of_sample(*this, static_cast<std::size_t>(std::ranges::count_if(vary, &Variation::is_sampled)));
  for (std::size_t i = 0; i < vary.size(); ++i) {
    const Variation& one = vary[i];
    const std::string member = fmt::format("vary[{}]", i);
    if (const std::string fault = fault_of(one); !fault.empty()) throw InvalidInput(member, fault);
    for (const std::string& key : one.keys) {
      if (!known.insert(key).second) throw InvalidInput(member + ".key", fmt::format("varies {} twice", key));
    }
    int& count = counted[static_cast<std::size_t>(one.sampling)];
    if (one.is_sampled() && count != 0 && count != one.count) {
      throw InvalidInput(member + ".count", one.count, "",
                         fmt::format("must be {}, as of the other keys that are sampled in this way", count),
                         "They are sampled together");
    }
    const double rows = static_cast<double>(rows_of(one) * (one.is_sampled() ? parts : 1));
    kept += rows * static_cast<double>(one.keys.size());
    if (!one.is_sampled() || count == 0) points *= rows;
    if (one.is_sampled()) count = one.count;
  }
  require_bounded(known.size(), kept, points);
  if (boundary) validate_boundary(*this);
  if (sensitivity) validate_sensitivity(*this);
  if (probability) validate_probability(*this);
}

StudyPoints::StudyPoints(const Study& study) {
  study.validate();
  std::array<std::vector<std::size_t>, 3> sampled;  // variations, by their kind
  std::vector<std::size_t> first_key;
  for (std::size_t i = 0; i < study.vary.size(); ++i) {
    const Variation& one = study.vary[i];
    first_key.push_back(keys_.size());
    keys_.insert(keys_.end(), one.keys.begin(), one.keys.end());
    if (one.is_sampled()) sampled[static_cast<std::size_t>(one.sampling)].push_back(i);
  }
  for (std::size_t i = 0; i < study.vary.size(); ++i) {
    const Variation& one = study.vary[i];
    Axis axis;
    if (!one.is_sampled()) {
      for (std::size_t k = 0; k < one.keys.size(); ++k) axis.places.push_back(first_key[i] + k);
      axis.rows = one.values.empty() ? grid_rows(one) : one.values;
    } else {
      const std::vector<std::size_t>& together = sampled[static_cast<std::size_t>(one.sampling)];
      if (together.front() != i) continue;
      const auto count = static_cast<std::size_t>(one.count);
      const auto seed = static_cast<std::uint64_t>(study.seed);
      const Shares shares = study.sensitivity               ? saltelli_samples(count, together.size(), seed)
                            : one.sampling == Sampling::lhs ? latin_hypercube(count, together.size(), seed)
                                                            : sobol_sequence(count, together.size(), seed);
      axis.sampled = true;
      for (const std::size_t other : together) axis.places.push_back(first_key[other]);
      for (const std::vector<double>& row : shares) {
        std::vector<std::string>& texts = axis.rows.emplace_back();
        for (std::size_t k = 0; k < row.size(); ++k) {
          texts.push_back(number_text(between(study.vary[together[k]].range, row[k])));
        }
      }
    }
    axes_.push_back(std::move(axis));
  }
  set_strides();
}

StudyPoints::StudyPoints(std::vector<std::string> keys) : keys_(std::move(keys)), axes_(1), size_(0) {
  axes_.front().places.resize(keys_.size());
  std::iota(axes_.front().places.begin(), axes_.front().places.end(), std::size_t{0});
}

void StudyPoints::add(std::vector<std::string> values) {
  axes_.front().rows.push_back(std::move(values));
  ++size_;
}

void StudyPoints::set_strides() {
  for (std::size_t i = axes_.size(); i-- > 0;) {
    axes_[i].stride = size_;
    size_ *= axes_[i].rows.size();
    if (!axes_[i].sampled) combinations_ *= axes_[i].rows.size();
  }
}

std::size_t StudyPoints::point(std::size_t combination, std::size_t sample) const {
  std::size_t out = 0;
  for (std::size_t i = axes_.size(); i-- > 0;) {
    const Axis& axis = axes_[i];
    std::size_t& rest = axis.sampled ? sample : combination;
    out += rest % axis.rows.size() * axis.stride;
    rest /= axis.rows.size();
  }
  return out;
}

std::vector<io::TomlSetting> StudyPoints::settled(std::size_t combination) const {
  std::vector<io::TomlSetting> all = settings(point(combination, 0)), out;
  std::set<std::size_t> places;
  for (const Axis& axis : axes_) {
    if (!axis.sampled) places.insert(axis.places.begin(), axis.places.end());
  }
  for (const std::size_t place : places) out.push_back(std::move(all[place]));
  return out;
}

std::vector<std::string> StudyPoints::values(std::size_t point) const {
  std::vector<std::string> out(keys_.size());
  for (const Axis& axis : axes_) {
    const std::vector<std::string>& row = axis.rows[point / axis.stride % axis.rows.size()];
    for (std::size_t k = 0; k < row.size(); ++k) out[axis.places[k]] = row[k];
  }
  return out;
}

std::vector<bool> StudyPoints::with_lists() const {
  std::vector<bool> out(keys_.size());
  for (const Axis& axis : axes_) {
    for (std::size_t k = 0; k < axis.places.size(); ++k) {
      out[axis.places[k]] = std::ranges::any_of(axis.rows, [k](const auto& row) { return is_list_literal(row[k]); });
    }
  }
  return out;
}

std::vector<io::TomlSetting> StudyPoints::settings(std::size_t point) const {
  std::vector<std::string> texts = values(point);
  std::vector<io::TomlSetting> out;
  out.reserve(texts.size());
  for (std::size_t k = 0; k < texts.size(); ++k) out.push_back({keys_[k], std::move(texts[k])});
  return out;
}

}  // namespace robomill::jobs
