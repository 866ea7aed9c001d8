#include "robomill/modal/impact/hit_split.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "robomill/base/statistics.hpp"

namespace robomill::modal {
namespace {

using Eigen::Index;

constexpr double least_share = 0.1;      ///< of the highest pulse, that a pulse begins a hit
constexpr double least_noises = 12.0;    ///< the same, of the noise's standard deviation
constexpr double longest_pulse_s = 0.2;  ///< what stays longer is a load or a drift
constexpr double before_share = 0.05;    ///< of the distance to the hit before, that is before a pulse
constexpr Index fewest_before = 256;     ///< at least so many, …
constexpr Index transformed_lead = 128;  ///< … these among them, which are transformed
constexpr Index fewest_kept = 256;       ///< that a record may have
constexpr double shortest_share = 0.5;   ///< of the usual length
constexpr double smallest_share = 0.25;  ///< of the usual size of a response

/// A stretch of the force above the lower of two levels that reaches the higher one.
struct Run {
  Index first = 0, last = 0, peak = 0;
};

std::vector<Run> runs_above(const Eigen::VectorXd& push, double high, Index longest) {
  const double low = 0.5 * high;
  std::vector<Run> runs;
  for (Index i = 0; i < push.size(); ++i) {
    if (push(i) <= low) continue;
    Run run{.first = i, .last = i, .peak = i};
    for (; i < push.size() && push(i) > low; ++i) {
      if (push(i) > push(run.peak)) run.peak = i;
    }
    run.last = i - 1;
    if (push(run.peak) >= high && run.last - run.first < longest) runs.push_back(run);
  }
  return runs;
}

/// Runs with less than `rest` between them are one.
std::vector<Run> merged(const std::vector<Run>& runs, const Eigen::VectorXd& push, Index rest) {
  std::vector<Run> out;
  for (const Run& run : runs) {
    if (out.empty() || run.first - out.back().last > rest) {
      out.push_back(run);
      continue;
    }
    if (push(run.peak) > push(out.back().peak)) out.back().peak = run.peak;
    out.back().last = run.last;
  }
  return out;
}

/// Samples before a pulse that are of its hit.
Index before(Index distance) {
  const Index share = static_cast<Index>(before_share * static_cast<double>(distance));
  return std::min(std::max(fewest_before, transformed_lead + share), distance / 4);
}

/// Root of the response's energy over that of the force.
double response_size(const Hit& record, const HitSegment& segment, Index length) {
  double energy = 0.0;
  for (const HitChannel& channel : record.responses) {
    const Eigen::VectorXd stretch = channel.samples.segment(segment.onset, length);
    energy += (stretch.array() - stretch.mean()).square().sum();
  }
  const Eigen::VectorXd force = record.force_n.segment(segment.begin, segment.onset - segment.begin + length);
  const double pushed = (force.array() - median(force)).square().sum();
  return pushed > 0.0 ? std::sqrt(energy / pushed) : 0.0;
}

/// Why a hit of several does not go with the others; empty: it does.
class Faults {
 public:
  Faults(const Hit& record, const std::vector<HitSegment>& segments) : record_(record), segments_(segments) {
    std::vector<double> lengths;
    lengths.reserve(segments.size());
    for (const HitSegment& segment : segments) lengths.push_back(static_cast<double>(segment.after));
    usual_length_ = median(lengths);
    Index shortest = record.force_n.size();
    for (const HitSegment& segment : segments) {
      if (!is_short(segment)) shortest = std::min(shortest, segment.end - segment.onset);
    }
    std::vector<double> sizes;
    for (const HitSegment& segment : segments) {
      sizes_.push_back(is_short(segment) ? 0.0 : response_size(record, segment, shortest));
      if (!is_short(segment)) sizes.push_back(sizes_.back());
    }
    usual_size_ = median(sizes);
  }

  [[nodiscard]] std::string of(std::size_t which) const {
    const HitSegment& segment = segments_[which];
    if (is_short(segment)) {
      return fmt::format("{} {:.3g} s after it, where the others have {:.3g} s: its response is cut off",
                         which + 1 < segments_.size() ? "the next hit follows" : "the record ends",
                         seconds(static_cast<double>(segment.after)), seconds(usual_length_));
    }
    if (sizes_[which] < smallest_share * usual_size_) {
      return fmt::format(
          "the structure responds to it {:.2g} times as much as to the others of the record: was the "
          "hammer laid down, or another place hit?",
          sizes_[which] / usual_size_);
    }
    return {};
  }

 private:
  [[nodiscard]] bool is_short(const HitSegment& segment) const {
    return static_cast<double>(segment.after) < shortest_share * usual_length_;
  }
  [[nodiscard]] double seconds(double samples) const { return samples / record_.sample_rate_hz; }

  const Hit& record_;
  const std::vector<HitSegment>& segments_;
  double usual_length_ = 0.0, usual_size_ = 0.0;
  std::vector<double> sizes_;
};

std::vector<std::string> faults_of(const Hit& record, const std::vector<HitSegment>& segments) {
  const Faults faults(record, segments);
  std::vector<std::string> out;
  for (std::size_t k = 0; k < segments.size(); ++k) out.push_back(faults.of(k));
  return out;
}

/// Where a hit's samples begin. A record that is too short to be one reaches into the hit before: it is rejected
/// anyway.
Index first_of(const HitSegment& segment) {
  return std::max<Index>(0, std::min(segment.begin, segment.end - fewest_kept));
}

/// Cuts a channel apart, which ends it: the record and its hits are never held twice.
std::vector<Eigen::VectorXd> cut_apart(Eigen::VectorXd samples, const std::vector<HitSegment>& segments) {
  std::vector<Eigen::VectorXd> out;
  out.reserve(segments.size());
  for (const HitSegment& segment : segments) {
    const Index begin = first_of(segment);
    out.emplace_back(samples.segment(begin, segment.end - begin));
  }
  return out;
}

std::vector<Hit> cut_apart(Hit record, const std::vector<HitSegment>& segments) {
  std::vector<Hit> out(segments.size());
  std::vector<Eigen::VectorXd> forces = cut_apart(std::move(record.force_n), segments);
  for (std::size_t k = 0; k < out.size(); ++k) {
    out[k].file = record.file;
    out[k].excitation = record.excitation;
    out[k].against_axis = record.against_axis;
    out[k].sample_rate_hz = record.sample_rate_hz;
    out[k].force_n = std::move(forces[k]);
  }
  for (HitChannel& channel : record.responses) {
    std::vector<Eigen::VectorXd> samples = cut_apart(std::move(channel.samples), segments);
    for (std::size_t k = 0; k < out.size(); ++k) {
      out[k].responses.push_back(
          {.dof = channel.dof, .samples = std::move(samples[k]), .against_axis = channel.against_axis});
    }
  }
  return out;
}

/// Lengths that are equal and numbers that are finite: what cannot be cut is left to who judges it.
bool can_be_cut(const Hit& record) {
  const Index n = record.force_n.size();
  return n >= fewest_kept && record.sample_rate_hz > 0.0 && std::isfinite(record.sample_rate_hz) &&
         record.force_n.allFinite() && std::ranges::all_of(record.responses, [&](const HitChannel& channel) {
           return channel.samples.size() == n && channel.samples.allFinite();
         });
}

}  // namespace

std::vector<HitSegment> find_hit_segments(const Eigen::VectorXd& force_n, double sample_rate_hz, double spacing_s) {
  const Index n = force_n.size();
  if (n < fewest_kept) return {};
  Eigen::VectorXd push = force_n.array() - median(force_n);
  // For normal noise the median of |x| is 0.6745 standard deviations.
  const double noise = median(push.cwiseAbs()) / 0.6745;
  Index highest = 0;
  push.cwiseAbs().maxCoeff(&highest);
  // Of a hammer that is wired the other way round every hit is rejected, and none is lost.
  if (push(highest) < 0.0) push = -push;
  const double high = std::max(least_share * push(highest), least_noises * noise);
  if (!(push(highest) >= high && high > 0.0)) return {};
  const auto samples = [&](double seconds) {
    return static_cast<Index>(std::min(std::ceil(seconds * sample_rate_hz), static_cast<double>(n)));
  };
  const std::vector<Run> hits = merged(runs_above(push, high, samples(longest_pulse_s)), push, samples(spacing_s));
  if (hits.size() < 2) return {};
  std::vector<double> distances;
  for (std::size_t k = 1; k < hits.size(); ++k) {
    distances.push_back(static_cast<double>(hits[k].first - hits[k - 1].first));
  }
  const auto longest = static_cast<Index>(*std::ranges::max_element(distances));
  std::vector<HitSegment> out;
  for (std::size_t k = 0; k < hits.size(); ++k) {
    const Index onset = hits[k].first;
    const auto distance = static_cast<Index>(k == 0 ? median(distances) : distances[k - 1]);
    const Index end = k + 1 < hits.size() ? hits[k + 1].first : std::min(n, onset + longest);
    out.push_back({.begin = std::max<Index>(0, onset - before(distance)),
                   .end = end,
                   .onset = onset,
                   .peak = hits[k].peak,
                   .after = end - onset});
    if (k > 0) out[k - 1].end = out[k].begin;
  }
  return out;
}

std::vector<Hit> split_hits(Hit record, double spacing_s, double begin_s) {
  std::vector<HitSegment> segments;
  if (can_be_cut(record)) segments = find_hit_segments(record.force_n, record.sample_rate_hz, spacing_s);
  std::vector<Hit> out;
  if (segments.empty()) {
    out.push_back(std::move(record));
    return out;
  }
  const std::vector<std::string> faults = faults_of(record, segments);
  out = cut_apart(std::move(record), segments);
  for (std::size_t k = 0; k < out.size(); ++k) {
    Hit& hit = out[k];
    hit.fault = faults[k];
    hit.file = fmt::format("{}, hit {} of {} at {:.2f} s", hit.file, k + 1, segments.size(),
                           begin_s + static_cast<double>(segments[k].peak) / hit.sample_rate_hz);
  }
  return out;
}

}  // namespace robomill::modal
