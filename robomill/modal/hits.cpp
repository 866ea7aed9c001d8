#include "robomill/modal/hits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <set>

#include "robomill/base/error.hpp"
#include "robomill/modal/impact/frf_quality.hpp"
#include "robomill/modal/impact/hits_average.hpp"
#include "robomill/modal/impact/hits_axis.hpp"
#include "robomill/modal/impact/hits_check.hpp"
#include "robomill/modal/impact/hits_mass.hpp"

namespace robomill::modal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

/// Hits with the same sensors; a row of FRFs for each of their excitations.
struct Setup {
  std::vector<Dof> sensors;  // sorted
  std::vector<Dof> forces;
  std::vector<std::vector<Struck>> hits;  // one list for each force
};

std::vector<Dof> sensors_of(const Hit& hit) {
  std::vector<Dof> sensors;
  for (const HitChannel& channel : hit.responses) sensors.push_back(channel.dof);
  std::sort(sensors.begin(), sensors.end());
  return sensors;
}

std::vector<Setup> sort_by_setup(const std::vector<Struck>& accepted) {
  std::vector<Setup> setups;
  for (const Struck& struck : accepted) {
    const std::vector<Dof> sensors = sensors_of(*struck.hit);
    auto setup = std::find_if(setups.begin(), setups.end(), [&](const Setup& s) { return s.sensors == sensors; });
    if (setup == setups.end()) setup = setups.insert(setups.end(), Setup{.sensors = sensors, .forces = {}, .hits = {}});
    const auto force = std::find(setup->forces.begin(), setup->forces.end(), struck.hit->excitation);
    const std::size_t j = static_cast<std::size_t>(force - setup->forces.begin());
    if (force == setup->forces.end()) {
      setup->forces.push_back(struck.hit->excitation);
      setup->hits.emplace_back();
    }
    setup->hits[j].push_back(struck);
  }
  return setups;
}

// Tails of every response of every accepted hit, and the loudest thing that still rings in any.
struct Tails {
  std::vector<std::vector<Tail>> of_hit;  // [accepted hit][its response]
  double remaining = 0.0;
  double remaining_hz = 0.0;
};

Tails look_at_tails(const std::vector<Struck>& accepted, const Layout& layout, const HitOptions& options) {
  const double highest_hz = static_cast<double>(layout.last_line) * layout.spacing_hz();
  Tails tails;
  for (const Struck& struck : accepted) {
    std::vector<Tail> row;
    for (const HitChannel& channel : struck.hit->responses) {
      row.push_back(
          look_at_tail(response_stretch(struck, channel, layout, options.response), layout.sample_rate_hz, highest_hz));
      if (row.back().remaining > tails.remaining) {
        tails.remaining = row.back().remaining;
        tails.remaining_hz = row.back().remaining_hz;
      }
    }
    tails.of_hit.push_back(row);
  }
  return tails;
}

double choose_decay(const Tails& tails, const Layout& layout, const HitOptions& options) {
  if (options.exponential_window == ExponentialWindow::off) return 0.0;
  const bool automatic = options.exponential_window == ExponentialWindow::automatic;
  if (automatic && tails.remaining <= 0.02) return 0.0;
  if (options.exponential_time_constant_s > 0.0) return 1.0 / options.exponential_time_constant_s;
  // No stronger than needed: what it adds has to be taken out again.
  const double fall = std::max(tails.remaining / 0.005, automatic ? 4.0 : 20.0);
  return std::log(fall) * layout.sample_rate_hz / static_cast<double>(layout.samples);
}

int integrations(ResponseKind kind) {
  switch (kind) {
    case ResponseKind::acceleration:
      return 2;
    case ResponseKind::velocity:
      return 1;
    case ResponseKind::displacement:
      break;
  }
  return 0;
}

// s of the layout's lines: on the imaginary axis, or beside it where the window's damping stays in.
Eigen::VectorXcd lines_of(const Layout& layout, bool decay_removed) {
  Eigen::VectorXcd s(layout.lines());
  for (Index i = 0; i < s.size(); ++i) {
    const double omega = 2.0 * std::numbers::pi * static_cast<double>(layout.first_line + i) * layout.spacing_hz();
    s(i) = Complex(decay_removed ? 0.0 : layout.decay_per_s, omega);
  }
  return s;
}

class Estimation {
 public:
  Estimation(const std::vector<Struck>& accepted, const Layout& layout, const Tails& tails, const HitOptions& options)
      : accepted_(accepted), layout_(layout), tails_(tails), options_(options) {
    removed_ = layout.decay_per_s > 0.0 && options.remove_added_damping;
    line_s_ = lines_of(layout, removed_);
  }

  void run(FrfResult& result) {
    result.set.frequency_hz = line_s_.imag() / (2.0 * std::numbers::pi);
    for (const Setup& setup : sort_by_setup(accepted_)) add_setup(setup, result);
    result.set.validate();
    result.added_decay_per_s = layout_.decay_per_s;
    result.added_decay_removed = removed_;
    result.grades = grade_frfs(result.set, evidence_, options_);
    for (const FrfGrade& grade : result.grades) {
      result.lowest_trustworthy_frequency_hz =
          std::max(result.lowest_trustworthy_frequency_hz, grade.lowest_trustworthy_frequency_hz);
    }
  }

 private:
  void add_setup(const Setup& setup, FrfResult& result) {
    std::vector<Frf> frfs;
    for (std::size_t j = 0; j < setup.forces.size(); ++j) {
      for (const Dof& response : setup.sensors) {
        frfs.push_back(receptance(setup.hits[j], {.response = response, .excitation = setup.forces[j]}));
      }
    }
    if (options_.accelerometer_mass_kg > 0.0) {
      const std::vector<Dof> left = remove_mass(frfs, setup.sensors, line_s_, options_.accelerometer_mass_kg);
      for (const Dof& dof : left) {
        result.notes.push_back(
            fmt::format("the accelerometer's mass stays in what its motion in {0} does: no accepted "
                        "hit is at its place in {0}",
                        to_string(dof)));
      }
    }
    for (Frf& frf : frfs) result.set.frfs.push_back(std::move(frf));
  }

  Frf receptance(const std::vector<Struck>& hits, const FrfName& name) {
    std::vector<Tail> tails;
    FrfEvidence evidence;
    evidence.hits = static_cast<int>(hits.size());
    for (const Struck& struck : hits) {
      const Tail& tail = tail_of(struck, name.response);
      tails.push_back(tail);
      if (tail.remaining > evidence.remaining) {
        evidence.remaining = tail.remaining;
        evidence.remaining_hz = tail.remaining_hz;
      }
      evidence.restless = evidence.restless || moved_before(*struck.hit, struck.pulse, name.response);
    }
    const Average average = average_hits(hits, tails, name.response, layout_, options_);
    const Eigen::VectorXcd on_axis =
        removed_ ? without_decay(average.ratio, 2.0 * std::numbers::pi * layout_.spacing_hz(), layout_.decay_per_s)
                 : average.ratio;
    // Displacement is the response over s, once or twice.
    const int p = integrations(options_.response);
    Frf frf{.name = name, .receptance = on_axis.segment(layout_.first_line, layout_.lines())};
    for (Index i = 0; i < frf.receptance.size(); ++i) frf.receptance(i) /= p == 0 ? 1.0 : std::pow(line_s_(i), p);
    const Eigen::VectorXd shrink = line_s_.cwiseAbs().array().pow(-p);
    const Eigen::VectorXd size = frf.receptance.cwiseAbs().cwiseMax(1e-300);
    frf.coherence = average.coherence;
    // Hits that agree to the last digit still leave a fit finite weights.
    if (hits.size() > 1) frf.deviation = average.deviation.cwiseProduct(shrink).cwiseMax(1e-9 * size);

    evidence.force_n_s = average.force_n_s;
    evidence.sensor_noise = average.sensor_deviation.cwiseProduct(shrink).cwiseQuotient(size);
    evidence.relative_noise =
        hits.size() > 1 ? Eigen::VectorXd(frf.deviation.cwiseQuotient(size)) : evidence.sensor_noise;
    evidence.drift = Eigen::VectorXd::Zero(layout_.lines());
    if (p > 0) {
      const Eigen::VectorXd drift = drift_of(on_axis, 2.0 * std::numbers::pi * layout_.spacing_hz(), p);
      evidence.drift = drift.segment(layout_.first_line, layout_.lines()).cwiseProduct(shrink).cwiseQuotient(size);
    }
    evidence_.push_back(evidence);
    return frf;
  }

  const Tail& tail_of(const Struck& struck, const Dof& response) const {
    const auto same = [&](const Struck& other) { return other.hit == struck.hit; };
    const auto hit = std::find_if(accepted_.begin(), accepted_.end(), same);
    const auto& channels = struck.hit->responses;
    const auto channel =
        std::find_if(channels.begin(), channels.end(), [&](const HitChannel& c) { return c.dof == response; });
    return tails_.of_hit[static_cast<std::size_t>(hit - accepted_.begin())]
                        [static_cast<std::size_t>(channel - channels.begin())];
  }

  const std::vector<Struck>& accepted_;
  const Layout& layout_;
  const Tails& tails_;
  const HitOptions& options_;
  bool removed_ = false;
  Eigen::VectorXcd line_s_;
  std::vector<FrfEvidence> evidence_;
};

void note_windows(const Layout& layout, const Tails& tails, const HitOptions& options, FrfResult& result) {
  if (options.force_window) result.notes.push_back("the force is zeroed outside its pulse");
  if (layout.decay_per_s == 0.0) {
    result.notes.push_back("no exponential window");
    return;
  }
  std::string note = fmt::format(
      "exponential window with a time constant of {:.4g} s on force and responses: it adds {:.4g} 1/s to "
      "the decay rate of every mode, ",
      1.0 / layout.decay_per_s, layout.decay_per_s);
  note += result.added_decay_removed ? "which has been taken out of the FRFs again"
                                     : "which is still in the FRFs and has to be taken off the modes";
  result.notes.push_back(note);
  if (tails.remaining > 0.0) {
    result.notes.push_back(fmt::format("{:.1f} % of the vibration at {:.4g} Hz is left when the records end",
                                       100.0 * tails.remaining, tails.remaining_hz));
  }
}

void note_averages(const std::vector<Hit>& hits, FrfResult& result) {
  const auto rejected =
      std::count_if(result.hits.begin(), result.hits.end(), [](const auto& v) { return !v.accepted; });
  if (rejected > 0) result.notes.push_back(fmt::format("{} of {} hits are rejected", rejected, hits.size()));
  std::set<Dof> lost;
  for (const Hit& hit : hits) lost.insert(hit.excitation);
  for (const FrfGrade& grade : result.grades) {
    lost.erase(grade.name.excitation);
    if (grade.hits == 1) {
      result.notes.push_back(to_string(grade.name) + " comes from one hit: it has no coherence");
    }
  }
  for (const Dof& dof : lost) {
    result.notes.push_back(fmt::format("no hit in {} is accepted: its FRFs are missing", to_string(dof)));
  }
}

}  // namespace

void HitOptions::validate() const {
  require_non_negative("accelerometer_mass_kg", accelerometer_mass_kg, "kg");
  if (accelerometer_mass_kg > 1.0) {
    throw InvalidInput("accelerometer_mass_kg", accelerometer_mass_kg, "kg", "must be at most 1",
                       "An accelerometer weighs grams; is the value in kg?");
  }
  require_non_negative("min_frequency_hz", min_frequency_hz, "Hz");
  require_non_negative("max_frequency_hz", max_frequency_hz, "Hz");
  if (max_frequency_hz > 0.0 && max_frequency_hz <= min_frequency_hz) {
    throw InvalidInput("max_frequency_hz", max_frequency_hz, "Hz", "must be above min_frequency_hz");
  }
  require_non_negative("frequency_resolution_hz", frequency_resolution_hz, "Hz");
  require_non_negative("force_overload_n", force_overload_n, "N");
  require_non_negative("response_overload", response_overload, "");
  if (!(double_hit_limit > 0.0 && double_hit_limit <= 1.0)) {
    throw InvalidInput("double_hit_limit", double_hit_limit, "", "must lie between 0 and 1",
                       "It is a part of the first pulse's peak, not a percentage");
  }
  require_non_negative("force_window_s", force_window_s, "s");
  require_non_negative("exponential_time_constant_s", exponential_time_constant_s, "s");
}

FrfResult estimate_frfs(const std::vector<Hit>& hits, const HitOptions& options, Progress& progress) {
  options.validate();
  require_sound(hits);
  FrfResult result;
  progress.start("hits", 2 * hits.size());
  std::vector<Struck> accepted;
  for (const Hit& hit : hits) {
    const Pulse pulse = find_pulse(hit.force_n);
    result.hits.push_back(judge_hit(hit, pulse, options));
    HitVerdict& verdict = result.hits.back();
    if (const auto again = repetition(hits, result.hits.size() - 1)) verdict.reasons.push_back(*again);
    verdict.accepted = verdict.reasons.empty();
    if (verdict.accepted) accepted.push_back({.hit = &hit, .pulse = pulse});
    progress.advance();
  }
  if (accepted.empty()) throw none_accepted(result.hits);

  Layout layout = lay_out(accepted, options);
  const Tails tails = look_at_tails(accepted, layout, options);
  layout.decay_per_s = choose_decay(tails, layout, options);
  progress.check();
  Estimation(accepted, layout, tails, options).run(result);
  note_windows(layout, tails, options, result);
  note_averages(hits, result);
  progress.advance(hits.size());
  return result;
}

std::array<double, 2> FrfResult::band_hz() const {
  double highest_hz = 0.0;
  for (const FrfGrade& grade : grades) highest_hz = std::max(highest_hz, grade.excited_high_hz);
  if (!(highest_hz > lowest_trustworthy_frequency_hz)) highest_hz = std::numeric_limits<double>::infinity();
  return {lowest_trustworthy_frequency_hz, highest_hz};
}

}  // namespace robomill::modal
