#include "robomill/modal/impact/hits_average.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "robomill/base/cost.hpp"
#include "robomill/base/error.hpp"
#include "robomill/signal/fft.hpp"
#include "robomill/signal/window.hpp"

namespace robomill::modal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

// Force in the direction of its axis, windowed; length layout.samples.
Eigen::VectorXd force_stretch(const Struck& struck, const Layout& layout, const HitOptions& options) {
  const Index begin = stretch_begin(struck.pulse);
  Eigen::VectorXd force = struck.hit->force_n.segment(begin, layout.samples).array() - struck.pulse.offset_n;
  if (options.force_window) {
    // What a filter rings on beside the pulse rings in the response too, so the window leaves room for it.
    const Index room = std::max<Index>(2, std::lround(2.0 * struck.pulse.width));
    const Index chosen = std::lround(options.force_window_s * layout.sample_rate_hz);
    const Index end = chosen > 0 ? struck.pulse.first + chosen : struck.pulse.last + room;
    const Index first = std::max<Index>(0, struck.pulse.first - room - begin);
    const Index last = std::clamp<Index>(end - begin, first, layout.samples - 1);
    force = force.cwiseProduct(signal::force_window(layout.samples, first, last, room));
  }
  return struck.hit->against_axis ? Eigen::VectorXd(-force) : force;
}

Eigen::VectorXcd spectrum(const Eigen::VectorXd& stretch, const Layout& layout) {
  Eigen::VectorXd padded = Eigen::VectorXd::Zero(layout.transform);
  padded.head(layout.samples) = stretch;
  if (layout.decay_per_s > 0.0) {
    padded.head(layout.samples).array() *=
        signal::exponential_window(layout.samples, layout.sample_rate_hz, 1.0 / layout.decay_per_s).array();
  }
  return signal::real_fft(padded);
}

const HitChannel& channel_at(const Hit& hit, const Dof& dof) {
  return *std::find_if(hit.responses.begin(), hit.responses.end(),
                       [&](const HitChannel& channel) { return channel.dof == dof; });
}

// Sums over the hits.
struct Sums {
  Eigen::VectorXd force;     // |F|²
  Eigen::VectorXd response;  // |X|²
  Eigen::VectorXcd cross;    // X F*
};

Eigen::VectorXcd estimate(const Sums& sums, Estimator estimator) {
  Eigen::VectorXcd h1 = sums.cross.cwiseQuotient(sums.force.cast<Complex>());
  if (estimator == Estimator::h1) return h1;
  Eigen::VectorXcd h2 = sums.response.cast<Complex>().cwiseQuotient(sums.cross.conjugate());
  if (estimator == Estimator::h2) return h2;
  // H1 and H2 have one phase, so their geometric mean is plain.
  return h1.cwiseProduct((h2.cwiseAbs().cwiseQuotient(h1.cwiseAbs())).cwiseSqrt().cast<Complex>());
}

// Moving average over 7 lines: the power of noise changes slowly, while five hits alone give it to 35 % only.
Eigen::VectorXd smoothed(const Eigen::VectorXd& x) {
  constexpr Index reach = 3;
  Eigen::VectorXd out(x.size());
  for (Index k = 0; k < x.size(); ++k) {
    const Index begin = std::max<Index>(0, k - reach);
    const Index end = std::min(x.size(), k + reach + 1);
    out(k) = x.segment(begin, end - begin).mean();
  }
  return out;
}

// Mean power that the sensor's noise has in a transform of the layout, from the density that the tails show.
Eigen::VectorXd tail_power(const std::vector<Tail>& tails, const Layout& layout) {
  double window_power = static_cast<double>(layout.samples);
  if (layout.decay_per_s > 0.0) {
    window_power =
        signal::exponential_window(layout.samples, layout.sample_rate_hz, 1.0 / layout.decay_per_s).squaredNorm();
  }
  Eigen::VectorXd power = Eigen::VectorXd::Zero(layout.lines());
  for (const Tail& tail : tails) {
    const Eigen::VectorXd density = smoothed(tail.noise_density);
    for (Index i = 0; i < layout.lines(); ++i) {
      const double frequency_hz = static_cast<double>(layout.first_line + i) * layout.spacing_hz();
      const Index line = std::min<Index>(density.size() - 1, std::lround(frequency_hz / tail.spacing_hz));
      power(i) += density(line);
    }
  }
  return power * (window_power / static_cast<double>(tails.size()));
}

/// Of records that are padded to a length: a transform of each channel, and of each line what the window's decay takes
/// to be removed.
void require_affordable_transforms(double samples, const std::vector<Struck>& hits, const HitOptions& options) {
  constexpr double operations_of_sample = 300.0, operations_of_line = 5e3, bytes_of_sample = 100.0;
  double channels = 0.0;
  for (const Struck& struck : hits) channels += 1.0 + static_cast<double>(struck.hit->responses.size());
  const double of_line = options.exponential_window == ExponentialWindow::off ? 0.0 : operations_of_line;
  require_affordable(
      {.operations = samples * (channels * operations_of_sample + of_line),
       .bytes = samples * bytes_of_sample,
       .dominant = {.field = "frequency_resolution_hz", .value = options.frequency_resolution_hz, .unit = "Hz"}});
}

}  // namespace

Index stretch_begin(const Pulse& pulse) {
  const Index lead = std::max<Index>(128, static_cast<Index>(std::ceil(8.0 * pulse.width)));
  return std::max<Index>(0, pulse.first - lead);
}

Layout lay_out(const std::vector<Struck>& hits, const HitOptions& options) {
  Layout layout;
  layout.sample_rate_hz = hits.front().hit->sample_rate_hz;
  layout.samples = hits.front().hit->force_n.size();
  layout.transform = layout.samples;
  for (const Struck& struck : hits) {
    layout.samples = std::min(layout.samples, struck.hit->force_n.size() - stretch_begin(struck.pulse));
    layout.transform = std::min(layout.transform, struck.hit->force_n.size());
  }
  if (options.frequency_resolution_hz > 0.0) {
    const double wanted = std::round(layout.sample_rate_hz / options.frequency_resolution_hz);
    if (!(wanted >= 64.0)) {
      throw InvalidInput("frequency_resolution_hz", options.frequency_resolution_hz, "Hz",
                         "must leave at least 64 samples in a transform");
    }
    require_affordable_transforms(wanted, hits, options);
    layout.transform = static_cast<Index>(wanted);
    layout.samples = std::min(layout.samples, layout.transform);
  }
  const double spacing_hz = layout.spacing_hz();
  const double highest_hz = options.max_frequency_hz > 0.0 ? options.max_frequency_hz : layout.sample_rate_hz / 2.56;
  layout.first_line = std::max<Index>(1, static_cast<Index>(std::ceil(options.min_frequency_hz / spacing_hz - 1e-9)));
  layout.last_line =
      std::min<Index>(layout.transform / 2, static_cast<Index>(std::floor(highest_hz / spacing_hz + 1e-9)));
  if (layout.last_line - layout.first_line < 16) {
    throw InvalidInput("max_frequency_hz", highest_hz, "Hz",
                       "must leave at least 17 lines above min_frequency_hz and below half the sample rate",
                       "Are the frequencies in Hz, and is the sample rate right?");
  }
  return layout;
}

Eigen::VectorXd response_stretch(const Struck& struck, const HitChannel& channel, const Layout& layout,
                                 ResponseKind kind) {
  const Index begin = stretch_begin(struck.pulse);
  const Eigen::VectorXd stretch = channel.samples.segment(begin, layout.samples);
  // Before the hit the structure rests. Where too little was recorded of that: a structure that rests in the end has no
  // mean acceleration or velocity, and no displacement in the end.
  double offset = 0.0;
  if (begin >= layout.samples / 20 && begin >= 32) {
    offset = channel.samples.head(begin).mean();
  } else if (kind == ResponseKind::displacement) {
    offset = stretch.tail(std::max<Index>(1, layout.samples / 20)).mean();
  } else {
    offset = stretch.mean();
  }
  const Eigen::VectorXd still = stretch.array() - offset;
  return channel.against_axis ? Eigen::VectorXd(-still) : still;
}

Average average_hits(const std::vector<Struck>& hits, const std::vector<Tail>& tails, const Dof& response,
                     const Layout& layout, const HitOptions& options) {
  const Index half = layout.transform / 2 + 1;
  Sums sums{.force = Eigen::VectorXd::Zero(half),
            .response = Eigen::VectorXd::Zero(half),
            .cross = Eigen::VectorXcd::Zero(half)};
  for (const Struck& struck : hits) {
    const HitChannel& channel = channel_at(*struck.hit, response);
    const Eigen::VectorXcd f = spectrum(force_stretch(struck, layout, options), layout);
    const Eigen::VectorXcd x = spectrum(response_stretch(struck, channel, layout, options.response), layout);
    sums.force += f.cwiseAbs2();
    sums.response += x.cwiseAbs2();
    sums.cross += x.cwiseProduct(f.conjugate());
  }
  // Where a pulse excites nothing at all the ratio is noise over noise; it must stay a number.
  sums.force = sums.force.cwiseMax(1e-30 * sums.force.maxCoeff());

  const double count = static_cast<double>(hits.size());
  const auto on_lines = [&](const Eigen::VectorXd& x) {
    return Eigen::VectorXd(x.segment(layout.first_line, layout.lines()));
  };
  Average average;
  average.ratio = estimate(sums, options.estimator);
  const Eigen::VectorXd force = on_lines(sums.force);
  average.force_n_s = (force / count).cwiseSqrt() / layout.sample_rate_hz;
  average.sensor_deviation = (tail_power(tails, layout).cwiseQuotient(force)).cwiseSqrt();
  if (hits.size() > 1) {
    const Eigen::VectorXd explained = sums.cross.cwiseAbs2().cwiseQuotient(sums.force);
    const Eigen::VectorXd coherence = explained.cwiseQuotient(sums.response).cwiseMax(0.0).cwiseMin(1.0);
    average.coherence = on_lines(coherence);
    // Residual power of the response, with one degree of freedom taken by H.
    const Eigen::VectorXd residual = smoothed((sums.response - explained).cwiseMax(0.0)) / (count - 1.0);
    average.deviation = (on_lines(residual).cwiseQuotient(force)).cwiseSqrt();
  }
  return average;
}

}  // namespace robomill::modal
