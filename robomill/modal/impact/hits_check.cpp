#include "robomill/modal/impact/hits_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <set>
#include <string>

namespace robomill::modal {
namespace {

using Eigen::Index;

constexpr Index fewest_samples = 256;

InvalidInput about(const Hit& hit, std::string field, std::string rule, std::string hint = {}) {
  return InvalidInput(InvalidInput::Parts{
      .where = hit.file, .field = std::move(field), .rule = std::move(rule), .hint = std::move(hint)});
}

void require_finite_samples(const Hit& hit, const std::string& field, const Eigen::VectorXd& samples) {
  for (Index j = 0; j < samples.size(); ++j) {
    if (!std::isfinite(samples(j))) throw about(hit, field, fmt::format("sample {} is not a finite number", j + 1));
  }
}

void require_sound(const Hit& hit) {
  if (!(hit.sample_rate_hz > 0.0 && std::isfinite(hit.sample_rate_hz))) {
    throw InvalidInput(InvalidInput::Parts{.where = hit.file,
                                           .field = "sample_rate_hz",
                                           .number = hit.sample_rate_hz,
                                           .unit = "Hz",
                                           .rule = "must be > 0",
                                           .hint = "Give it under [acquisition], or name the time column"});
  }
  const Index n = hit.force_n.size();
  if (n < fewest_samples) {
    throw about(hit, "force_n", fmt::format("has {} samples; a hit needs at least {}", n, fewest_samples));
  }
  require_finite_samples(hit, "force_n", hit.force_n);
  if (hit.force_n.maxCoeff() == hit.force_n.minCoeff()) {
    throw about(hit, "force_n", "is the same throughout", "Is this the force's column, and was the hammer connected?");
  }
  if (hit.excitation.axis > Axis::z)
    throw about(hit, "force_direction", "must be x, y or z", "A hammer gives no moment");
  if (hit.responses.empty()) throw about(hit, "responses", "are none");
  std::set<Dof> seen;
  for (const HitChannel& channel : hit.responses) {
    const std::string field = "responses." + to_string(channel.dof);
    if (!seen.insert(channel.dof).second) throw about(hit, field, "comes twice");
    if (channel.samples.size() != n) {
      throw about(hit, field, fmt::format("has {} samples, the force {}", channel.samples.size(), n));
    }
    require_finite_samples(hit, field, channel.samples);
  }
}

std::set<Dof> dofs_of(const Hit& hit) {
  std::set<Dof> dofs;
  for (const HitChannel& channel : hit.responses) dofs.insert(channel.dof);
  return dofs;
}

// One FRF must not be averaged over hits with different sensors on the structure: they load it differently.
void require_same_sensors(const Hit& hit, const Hit& other) {
  if (hit.excitation != other.excitation) return;
  const std::set<Dof> here = dofs_of(hit);
  const std::set<Dof> there = dofs_of(other);
  if (here == there) return;
  for (const Dof& dof : here) {
    if (there.count(dof) > 0) {
      throw about(other, "responses",
                  fmt::format("differ from those of {}, which is a hit in {} too and shares {}", hit.file,
                              to_string(hit.excitation), to_string(dof)),
                  "Hits of one direction must name the same responses, or none in common");
    }
  }
}

void judge_pulse(const Hit& hit, const Pulse& pulse, const HitOptions& options, std::vector<std::string>& reasons) {
  if (pulse.peak_n <= 0.0) {
    reasons.push_back(
        fmt::format("the force's highest excursion is a pull of {:.3g} N, and a hammer only pushes: turn the "
                    "sign of the force (a push reads positive, also for a hit against the axis)",
                    -pulse.peak_n));
    return;
  }
  if (pulse.peak_n < 10.0 * pulse.noise_n) {
    reasons.push_back(fmt::format("no hit stands out of the noise: the highest force is {:.3g} N, the noise {:.3g} N",
                                  pulse.peak_n, pulse.noise_n));
    return;
  }
  // A steel tip touches for 0.02 ms, a sledge's soft one for 30 ms.
  constexpr double briefest_s = 2e-6, longest_s = 0.1;
  const double width_s = pulse.width / hit.sample_rate_hz;
  if (width_s < briefest_s || width_s > longest_s) {
    reasons.push_back(
        fmt::format("the pulse is {:.3g} ms wide, and a hammer's lasts 0.02 to 30 ms: is the time in s and "
                    "the sample rate in Hz?",
                    1e3 * width_s));
  }
  const double n = static_cast<double>(hit.force_n.size());
  if (hit.force_n(0) - pulse.offset_n > 0.1 * pulse.peak_n) {
    reasons.push_back("the record begins inside the pulse: set the trigger earlier");
  }
  if (n - static_cast<double>(pulse.last) < std::max(8.0 * pulse.width, 0.25 * n)) {
    reasons.push_back("the pulse comes so late that the response is cut off: set the trigger later or record longer");
  }
  if (pulse.second_ratio > options.double_hit_limit) {
    reasons.push_back(fmt::format("double hit: a second pulse has {:.1f} % of the first's height, {:.1f} % are allowed",
                                  100.0 * pulse.second_ratio, 100.0 * options.double_hit_limit));
  }
}

void judge_overload(const Hit& hit, const HitOptions& options, std::vector<std::string>& reasons) {
  const auto judge = [&](const std::string& what, const Eigen::VectorXd& samples, double limit) {
    const double highest = samples.cwiseAbs().maxCoeff();
    if (limit > 0.0 && highest >= limit) {
      reasons.push_back(
          fmt::format("overload: {} reaches {:.4g}, its sensor's range ends at {:.4g}", what, highest, limit));
    } else if (has_flat_top(samples)) {
      reasons.push_back(fmt::format("overload: {} is clipped at {:.4g}", what, highest));
    }
  };
  judge("the force", hit.force_n, options.force_overload_n);
  for (const HitChannel& channel : hit.responses) {
    const std::string what = "the response in " + to_string(channel.dof);
    if (channel.samples.maxCoeff() == channel.samples.minCoeff()) {
      reasons.push_back(what + " is the same throughout: was its sensor connected?");
    } else {
      judge(what, channel.samples, options.response_overload);
    }
  }
}

double deviation(const Eigen::VectorXd& x) {
  return std::sqrt((x.array() - x.mean()).square().mean());
}

}  // namespace

void require_sound(const std::vector<Hit>& hits) {
  if (hits.empty()) throw InvalidInput("hits", "are none", "Each file of a hit has its [[hits]] table");
  for (const Hit& hit : hits) require_sound(hit);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const double rate_hz = hits.front().sample_rate_hz;
    if (std::abs(hits[i].sample_rate_hz - rate_hz) > 1e-5 * rate_hz) {
      throw about(hits[i], "sample_rate_hz",
                  fmt::format("is {:.6g} Hz, but {:.6g} Hz in {}", hits[i].sample_rate_hz, rate_hz, hits.front().file),
                  "All hits must be recorded at one rate");
    }
    for (std::size_t j = 0; j < i; ++j) require_same_sensors(hits[j], hits[i]);
  }
}

std::optional<std::string> repetition(const std::vector<Hit>& hits, std::size_t which) {
  const Hit& hit = hits[which];
  const auto in_both = [&](const Hit& earlier) {
    return std::ranges::any_of(hit.responses, [&](const HitChannel& here) {
      return std::ranges::any_of(earlier.responses, [&](const HitChannel& there) {
        const bool asked_anew = earlier.excitation == hit.excitation && there.dof != here.dof;
        return !asked_anew && there.samples == here.samples;
      });
    });
  };
  for (std::size_t i = 0; i < which; ++i) {
    const Hit& earlier = hits[i];
    if (earlier.force_n.size() != hit.force_n.size() || earlier.force_n != hit.force_n || !in_both(earlier)) continue;
    if (earlier.excitation == hit.excitation) {
      return fmt::format("is the hit of {} again, sample for sample: a hit counts once", earlier.file);
    }
    return fmt::format("is the hit of {} again, sample for sample, which was in {}: a hit has one direction",
                       earlier.file, to_string(earlier.excitation));
  }
  return std::nullopt;
}

HitVerdict judge_hit(const Hit& hit, const Pulse& pulse, const HitOptions& options) {
  HitVerdict verdict;
  verdict.file = hit.file;
  verdict.peak_force_n = pulse.peak_n;
  verdict.pulse_width_s = pulse.width / hit.sample_rate_hz;
  verdict.second_pulse_ratio = pulse.second_ratio;
  if (!hit.fault.empty()) {
    verdict.reasons.push_back(hit.fault);
    return verdict;
  }
  judge_pulse(hit, pulse, options, verdict.reasons);
  judge_overload(hit, options, verdict.reasons);
  verdict.accepted = verdict.reasons.empty();
  return verdict;
}

InvalidInput none_accepted(const std::vector<HitVerdict>& verdicts) {
  std::string reasons;
  for (const HitVerdict& verdict : verdicts) {
    for (const std::string& reason : verdict.reasons) reasons += "\n  " + verdict.file + ": " + reason;
  }
  return InvalidInput("hits", "leave none that can be used:" + reasons);
}

bool moved_before(const Hit& hit, const Pulse& pulse, const Dof& response) {
  const Index quiet = pulse.first - static_cast<Index>(std::ceil(4.0 * pulse.width));
  if (quiet < 64) return false;
  const auto channel =
      std::find_if(hit.responses.begin(), hit.responses.end(), [&](const HitChannel& c) { return c.dof == response; });
  const Eigen::VectorXd& x = channel->samples;
  const double before = deviation(x.head(quiet));
  const double after = deviation(x.tail(std::min(quiet, x.size() / 8)));
  return before > 3.0 * after && before > 0.01 * x.cwiseAbs().maxCoeff();
}

}  // namespace robomill::modal
