#include "examples/first-lobes/hammer.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/signal/fft.hpp"

namespace robomill::examples {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

// ∫ sin(πt/T) exp(-iωt) dt over 0 … T = πT (1 + exp(-iωT)) / (π² - ω²T²), and -iT/2 in the limit ωT = π.
Complex half_sine(double omega, double length_s) {
  constexpr double pi = std::numbers::pi;
  const double angle = omega * length_s;
  if (std::abs(angle - pi) < 1e-6) return {0.0, -0.5 * length_s};
  return pi * length_s * (1.0 + std::polar(1.0, -angle)) / (pi * pi - angle * angle);
}

double low_pass(double frequency_hz, double sample_rate_hz) {
  const double way = std::clamp((frequency_hz / sample_rate_hz - 0.35) / 0.10, 0.0, 1.0);
  return 0.5 + 0.5 * std::cos(std::numbers::pi * way);
}

// Until the slowest mode has fallen to 1e-10, as a power of two.
Index long_enough(const modal::ModalModel& model, const Hammer& hammer) {
  double decay_per_s = 1e3;
  for (const modal::Mode& mode : model.modes) decay_per_s = std::min(decay_per_s, -modal::pole(mode).real());
  const double time_s = hammer.record_s + std::log(1e10) / decay_per_s;
  Index n = 1;
  while (static_cast<double>(n) < time_s * hammer.sample_rate_hz) n *= 2;
  return n;
}

void add_noise(Eigen::VectorXd& samples, double deviation, Random& random) {
  for (Index j = 0; j < samples.size(); ++j) samples(j) += deviation * random.normal();
}

// Receptances on the lines of a transform that is long enough; the same for every hit.
struct Structure {
  Index transform = 0;
  modal::FrfSet frfs;
  std::vector<modal::Dof> responses;
};

Structure structure_of(const modal::ModalModel& model, const Hammer& hammer) {
  const Index n = long_enough(model, hammer);
  const Eigen::VectorXd frequency_hz = Eigen::VectorXd::LinSpaced(n / 2 + 1, 0.0, 0.5 * hammer.sample_rate_hz);
  return {.transform = n, .frfs = modal::synthesize(model, frequency_hz), .responses = model.responses};
}

Eigen::VectorXcd force_spectrum(const Eigen::VectorXd& frequency_hz, const Hammer& hammer, double start_s) {
  Eigen::VectorXcd force(frequency_hz.size());
  for (Index k = 0; k < force.size(); ++k) {
    const double omega = 2.0 * std::numbers::pi * frequency_hz(k);
    force(k) = hammer.peak_force_n * hammer.sample_rate_hz * low_pass(frequency_hz(k), hammer.sample_rate_hz) *
               half_sine(omega, hammer.pulse_s) * std::polar(1.0, -omega * start_s);
  }
  return force;
}

modal::Hit hit_on(const Structure& structure, const modal::Dof& excitation, const Hammer& hammer, Random& random) {
  const Eigen::VectorXd& frequency_hz = structure.frfs.frequency_hz;
  // The pulse begins anywhere between two samples.
  const double start_s = hammer.pretrigger_s + random.uniform() / hammer.sample_rate_hz;
  const Eigen::VectorXcd force = force_spectrum(frequency_hz, hammer, start_s);
  const Index samples = std::lround(hammer.record_s * hammer.sample_rate_hz);
  modal::Hit hit;
  hit.excitation = excitation;
  hit.sample_rate_hz = hammer.sample_rate_hz;
  hit.force_n = signal::inverse_real_fft(force, structure.transform).head(samples);
  add_noise(hit.force_n, hammer.force_noise_n, random);
  for (const modal::Dof& dof : structure.responses) {
    const modal::Frf* const frf = structure.frfs.find({.response = dof, .excitation = excitation});
    if (frf == nullptr) throw InvalidInput("excitation", "is none of the model's", modal::to_string(excitation, true));
    Eigen::VectorXcd response = frf->receptance.cwiseProduct(force);
    for (Index k = 0; k < response.size(); ++k) {
      const Complex s(0.0, 2.0 * std::numbers::pi * frequency_hz(k));
      if (hammer.response != modal::ResponseKind::displacement) response(k) *= s;
      if (hammer.response == modal::ResponseKind::acceleration) response(k) *= s;
    }
    modal::HitChannel channel;
    channel.dof = dof;
    channel.samples = signal::inverse_real_fft(response, structure.transform).head(samples);
    add_noise(channel.samples, hammer.response_noise, random);
    hit.responses.push_back(channel);
  }
  return hit;
}

}  // namespace

modal::Hit simulate_hit(const modal::ModalModel& model, const modal::Dof& excitation, const Hammer& hammer,
                        Random& random) {
  return hit_on(structure_of(model, hammer), excitation, hammer, random);
}

std::vector<modal::Hit> simulate_hits(const modal::ModalModel& model, int count, double scatter, const Hammer& hammer,
                                      std::uint64_t seed) {
  const Structure structure = structure_of(model, hammer);
  std::vector<modal::Hit> hits;
  for (const modal::Dof& excitation : model.excitations) {
    for (int i = 1; i <= count; ++i) {
      Random random(seed, hits.size());
      Hammer blow = hammer;
      blow.peak_force_n *= 1.0 + scatter * random.normal();
      blow.pulse_s *= 1.0 + scatter * random.normal();
      modal::Hit hit = hit_on(structure, excitation, blow, random);
      hit.file = "hit_" + modal::to_string(excitation) + "_" + std::to_string(i) + ".csv";
      hits.push_back(hit);
    }
  }
  return hits;
}

}  // namespace robomill::examples
