#include "testing/monitor/recording.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "robomill/signal/spectrum.hpp"
#include "robomill/simulation/engine.hpp"
#include "robomill/simulation/resample.hpp"

namespace robomill::monitor::testing {
namespace {

using simulation::detail::CutModel;
using simulation::detail::Engine;
using simulation::detail::Physics;
using simulation::detail::Profile;
using simulation::detail::Resampler;
using std::numbers::pi;

constexpr double steps_per_sample = 4.2;  // 76 in a period of the robot's fastest mode
constexpr double diverged_m = 0.1;

CutModel model_of(const CutPlan& plan) {
  const int teeth = plan.teeth();
  const double steps = steps_per_sample * corpus_rate_hz * 2.0 * pi / plan.speed_rad_per_s();
  const int n = teeth * static_cast<int>(std::ceil(std::max(steps, 180.0) / teeth));
  const double lag = plan.drilling ? 0.0 : plan.milling.milling.tool.lag_rad_per_m(0) * plan.milling.axial_depth_m;
  CutModel model = plan.drilling ? simulation::detail::drilling_model(plan.drill, n)
                                 : simulation::detail::milling_model(plan.milling.milling, plan.speed_rad_per_s(),
                                                                     plan.milling.axial_depth_m,
                                                                     {n, 1 + static_cast<int>(lag / 0.1)});
  model.depth = Profile(plan.schedule().depth);
  model.spindle.schedule = Profile(plan.schedule().speed);
  return model;
}

template <int D>
bool run(const CutModel& model, const CutPlan& plan, Physics physics, Resampler& out) {
  Engine<D> engine(model, plan.structure(), physics);
  out.push(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  while (!out.done()) {
    engine.step();
    Eigen::Vector3d q = Eigen::Vector3d::Zero(), force = q;
    q.head<D>() = engine.displacement();
    force.head<D>() = engine.mean_force();
    if (!(q.squaredNorm() < diverged_m * diverged_m)) return false;
    out.push(q, force);
  }
  return true;
}

/// What changed since one revolution before.
CleanCut::Columns change_per_turn(const CleanCut::Columns& x, const std::vector<double>& rotation) {
  CleanCut::Columns change = x;
  std::size_t behind = 0;
  for (std::size_t i = 0; i < rotation.size(); ++i) {
    const double angle = rotation[i] - 2.0 * pi;
    if (angle < 0.0) continue;
    while (rotation[behind + 1] <= angle) ++behind;
    const double row =
        static_cast<double>(behind) + (angle - rotation[behind]) / (rotation[behind + 1] - rotation[behind]);
    change.row(static_cast<Eigen::Index>(i)) -= at_row(x, row);
  }
  return change;
}

std::vector<float> envelope(const CleanCut::Columns& c, double window_s) {
  const auto half = static_cast<Eigen::Index>(std::ceil(0.5 * window_s * corpus_rate_hz));
  const Eigen::Index n = c.rows();
  std::vector<double> sum(static_cast<std::size_t>(n) + 1, 0.0);
  for (Eigen::Index i = 0; i < n; ++i) {
    sum[static_cast<std::size_t>(i) + 1] = sum[static_cast<std::size_t>(i)] + c.row(i).squaredNorm();
  }
  std::vector<float> out(static_cast<std::size_t>(n));
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto from = static_cast<std::size_t>(std::max<Eigen::Index>(0, i - half));
    const auto to = static_cast<std::size_t>(std::min<Eigen::Index>(n, i + half + 1));
    const double mean = (sum[to] - sum[from]) / (2.0 * static_cast<double>(to - from));
    out[static_cast<std::size_t>(i)] = static_cast<float>(std::sqrt(std::max(0.0, mean)));
  }
  return out;
}

/// Of both columns together.
std::vector<signal::SpectralPeak> lines(const CleanCut::Columns& x, Eigen::Index from, Eigen::Index rows,
                                        const signal::PeakOptions& options) {
  if (rows < 512) return {};
  signal::Spectrum spectrum = signal::amplitude_spectrum(x.col(0).segment(from, rows), corpus_rate_hz);
  const signal::Spectrum other = signal::amplitude_spectrum(x.col(1).segment(from, rows), corpus_rate_hz);
  spectrum.amplitude = (spectrum.amplitude.array().square() + other.amplitude.array().square()).sqrt();
  return signal::find_peaks(spectrum, options);
}

/// The longest run of rows in which the amplitude is above a level.
std::pair<Eigen::Index, Eigen::Index> longest_above(const std::vector<float>& amplitude, double level) {
  Eigen::Index best_from = 0, best = 0, from = 0;
  const auto n = static_cast<Eigen::Index>(amplitude.size());
  for (Eigen::Index i = 0; i < n; ++i) {
    if (amplitude[static_cast<std::size_t>(i)] < level) from = i + 1;
    if (i + 1 - from > best) {
      best = i + 1 - from;
      best_from = from;
    }
  }
  return {best_from, best};
}

/// Two-pole resonance driven by white noise, of rms 1.
class Coloured {
 public:
  Coloured(double frequency_hz, double damping_ratio) {
    const double angle = 2.0 * pi * frequency_hz / corpus_rate_hz;
    radius_ = std::exp(-damping_ratio * angle);
    turn_ = 2.0 * radius_ * std::cos(angle);
    const double r2 = radius_ * radius_;
    const double variance = (1.0 + r2) / ((1.0 - r2) * ((1.0 + r2) * (1.0 + r2) - turn_ * turn_));
    gain_ = 1.0 / std::sqrt(variance);
  }
  /// Of its output, per cycle a sample, two-sided.
  [[nodiscard]] double density(double frequency_hz) const {
    const std::complex<double> back = std::polar(1.0, -2.0 * pi * frequency_hz / corpus_rate_hz);
    return gain_ * gain_ / std::norm(1.0 - turn_ * back + radius_ * radius_ * back * back);
  }
  double next(double white) {
    const double y = gain_ * white + turn_ * a_ - radius_ * radius_ * b_;
    b_ = a_;
    a_ = y;
    return y;
  }

 private:
  double radius_ = 0.0, turn_ = 0.0, gain_ = 1.0, a_ = 0.0, b_ = 0.0;
};

}  // namespace

double log_uniform(double low, double high, Random& random) {
  return std::exp(random.uniform(std::log(low), std::log(high)));
}

Eigen::RowVector2d at_row(const CleanCut::Columns& x, double row) {
  constexpr int reach = 12;
  const auto base = static_cast<Eigen::Index>(std::floor(row));
  Eigen::RowVector2d sum = Eigen::RowVector2d::Zero();
  const double fraction = row - static_cast<double>(base);
  if (fraction < 1e-9) return base >= 0 && base < x.rows() ? Eigen::RowVector2d(x.row(base)) : sum;
  const double sine = std::sin(pi * fraction) / pi;  // sin(π (row - k)) changes its sign from k to k + 1
  const std::complex<double> turn = std::polar(1.0, -pi / reach);
  std::complex<double> hann = std::polar(1.0, pi * (fraction + reach - 1) / reach);
  double sign = reach % 2 == 0 ? -1.0 : 1.0;
  for (Eigen::Index k = base - reach + 1; k <= base + reach; ++k) {
    if (k >= 0 && k < x.rows()) {
      sum += sign * sine / (row - static_cast<double>(k)) * (0.5 + 0.5 * hann.real()) * x.row(k);
    }
    sign = -sign;
    hann *= turn;
  }
  return sum;
}

void find_times(Truth& truth, double level) {
  const std::vector<float>& a = truth.amplitude_m_per_s2;
  const double largest = *std::ranges::max_element(a);
  std::vector<float> high;
  std::ranges::copy_if(a, std::back_inserter(high), [&](float v) { return v > 0.5 * largest; });
  std::ranges::nth_element(high, high.begin() + static_cast<std::ptrdiff_t>(high.size() / 2));
  const double final = high[high.size() / 2];
  truth.final_m_per_s2 = final;
  const auto time = [](std::size_t i) { return static_cast<double>(i) / corpus_rate_hz; };
  std::size_t first_half = 0;
  while (a[first_half] < 0.5 * final) ++first_half;
  std::size_t last_half = a.size() - 1;
  while (a[last_half] < 0.5 * final) --last_half;
  const auto last_below = [&](double least) {
    std::size_t i = first_half;
    while (i > 0 && a[i - 1] >= least) --i;
    return time(i);
  };
  truth.t10_s = last_below(0.1 * final);
  truth.start_s = last_below(std::min(0.02 * final, 0.1 * level));
  std::size_t end = last_half;
  while (end < a.size() && a[end] >= 0.1 * final) ++end;
  truth.ends = end < a.size();
  truth.end_s = time(end);
}

double CutPlan::speed_rad_per_s() const {
  return drilling ? drill.spindle_speed_rad_per_s : milling.spindle_speed_rad_per_s;
}

CleanCut simulate(const CutPlan& plan) {
  const CutModel model = model_of(plan);
  const double step_s = 2.0 * pi / model.steps_per_revolution / plan.speed_rad_per_s();
  const auto rows = static_cast<Eigen::Index>(plan.seconds * corpus_rate_hz);
  const int directions = plan.drilling ? 3 : 2;
  Resampler full(step_s, corpus_rate_hz, rows, directions), forced(step_s, corpus_rate_hz, rows, directions);
  CleanCut clean;
  const bool fine = plan.drilling
                        ? run<3>(model, plan, Physics::full, full) && run<3>(model, plan, Physics::forced, forced)
                        : run<2>(model, plan, Physics::full, full) && run<2>(model, plan, Physics::forced, forced);
  clean.diverged = !fine;
  const auto before = static_cast<Eigen::Index>(plan.idle_before_s * corpus_rate_hz);
  const Eigen::Index all = before + rows + static_cast<Eigen::Index>(plan.idle_after_s * corpus_rate_hz);
  const auto padded = [&](const Eigen::Matrix<double, Eigen::Dynamic, 3>& x) {
    CleanCut::Columns out = CleanCut::Columns::Zero(all, 2);
    out.middleRows(before, rows) = x.leftCols<2>();
    return out;
  };
  clean.acceleration_m_per_s2 = padded(full.acceleration_m_per_s2);
  clean.forced_m_per_s2 = padded(forced.acceleration_m_per_s2);
  clean.displacement_m = padded(full.displacement_m);
  clean.forced_displacement_m = padded(forced.displacement_m);
  clean.force_n = padded(full.force_n);
  clean.forced_force_n = padded(forced.force_n);
  clean.regenerated_m = clean.displacement_m - clean.forced_displacement_m;
  const double first = model.spindle.speed(0.0), start_s = static_cast<double>(before) / corpus_rate_hz;
  for (Eigen::Index i = 0; i < all; ++i) {
    const double t = static_cast<double>(i) / corpus_rate_hz - start_s;
    clean.rotation_rad.push_back(first * start_s + (t < 0.0 ? first * t : model.spindle.rotation(t)));
    clean.speed_rad_per_s.push_back(static_cast<float>(model.spindle.speed(std::max(t, 0.0))));
    clean.depth_share.push_back(t < 0.0 || i >= before + rows ? 0.0F : static_cast<float>(model.depth.at(t)));
  }
  return clean;
}

CleanCut::Columns chatter_of(const CutPlan& plan, const CleanCut& clean, const Truth& truth) {
  const CleanCut::Columns c = clean.acceleration_m_per_s2 - clean.forced_m_per_s2;
  if (plan.locked) return c;
  return change_per_turn(c, clean.rotation_rad) / truth.comb_gain;
}

Truth truth_of(const CutPlan& plan, const CleanCut& clean, bool chatter) {
  Truth truth;
  const double level = reference_level(plan, clean);
  truth.chatter = chatter;
  truth.speed_rad_per_s = clean.speed_rad_per_s;
  CleanCut::Columns c = clean.acceleration_m_per_s2 - clean.forced_m_per_s2;
  CleanCut::Columns moved = clean.regenerated_m;
  if (!plan.locked) {
    c = change_per_turn(c, clean.rotation_rad);
    moved = change_per_turn(moved, clean.rotation_rad);
  }
  const double tooth_s = 2.0 * pi / plan.speed_rad_per_s() / plan.teeth();
  truth.amplitude_m_per_s2 = envelope(c, tooth_s);
  if (!chatter) {
    truth.end_s = static_cast<double>(c.rows()) / corpus_rate_hz;
    return truth;
  }
  find_times(truth, level);
  const auto locate = [&](const CleanCut::Columns& x, const signal::PeakOptions& options) {
    const auto [from, rows] = longest_above(truth.amplitude_m_per_s2, 0.4 * truth.final_m_per_s2);
    return lines(x, from, rows, options);
  };
  const auto slow = locate(moved, {.count = 1, .min_frequency_hz = 5.0});
  if (!slow.empty()) {
    truth.displacement_hz = slow.front().frequency_hz;
    truth.amplitude_m_per_s2 = envelope(c, std::max(tooth_s, 1.0 / truth.displacement_hz));
    find_times(truth, level);
  }
  for (const signal::SpectralPeak& line :
       locate(c, {.count = 16, .min_frequency_hz = 5.0, .relative_height = std::sqrt(0.1)})) {
    if (truth.lines_hz.empty()) truth.frequency_hz = line.frequency_hz;
    truth.lines_hz.push_back(line.frequency_hz);
  }
  if (plan.locked || truth.lines_hz.empty()) return truth;
  const auto end = static_cast<std::size_t>(truth.end_s * corpus_rate_hz) - 1;
  truth.comb_gain = 2.0 * std::abs(std::sin(2.0 * pi * pi * truth.frequency_hz / clean.speed_rad_per_s[end]));
  if (truth.comb_gain > 0.0) truth.final_m_per_s2 /= truth.comb_gain;
  for (float& a : truth.amplitude_m_per_s2) a /= static_cast<float>(truth.comb_gain);
  return truth;
}

double reference_level(const CutPlan& plan, const CleanCut& clean) {
  const double least_m_per_s2 = plan.drilling ? 5.0 : 0.5;
  double sum = 0.0, count = 1e-300;
  for (std::size_t i = 0; i < clean.depth_share.size(); ++i) {
    if (clean.depth_share[i] <= 0.0F) continue;
    sum += clean.forced_m_per_s2.row(static_cast<Eigen::Index>(i)).squaredNorm();
    count += 2.0;
  }
  return std::max(least_m_per_s2, std::sqrt(sum / count));
}

void add_knock(const modal::TipModes& structure, double peak_m_per_s2, double time_s, Random& random,
               std::vector<float>& samples) {
  const double direction = random.uniform(0.0, 2.0 * pi), pulse_s = random.uniform(1e-4, 4e-4);
  const double local_hz = random.uniform(1500.0, 4000.0),
               local_decay = 2.0 * pi * local_hz * random.uniform(0.02, 0.05);
  const double local_share = random.uniform(0.2, 1.0);
  const Eigen::Vector3d blow(std::cos(direction), std::sin(direction), 0.0);
  const auto first = static_cast<std::size_t>(time_s * corpus_rate_hz);
  const std::size_t frames = samples.size() / 2;
  const std::size_t last = std::min(frames, first + static_cast<std::size_t>(1.0 * corpus_rate_hz));
  std::vector<std::complex<double>> rate, turn, x, y;
  for (Eigen::Index k = 0; k < structure.pole.size(); ++k) {
    const std::complex<double> pole = structure.pole(k);
    const std::complex<double> push = (structure.left.col(k).transpose() * blow)(0) * pole * pole;
    // A smooth pulse of that length excites what is faster the less.
    const double softened = std::exp(-0.5 * std::pow(pole.imag() * pulse_s, 2));
    turn.push_back(std::exp(pole / corpus_rate_hz));
    x.push_back(2.0 * structure.right(0, k) * push * softened);
    y.push_back(2.0 * structure.right(1, k) * push * softened);
  }
  std::vector<double> ring;
  double most = 1e-300;
  for (std::size_t i = first; i < last; ++i) {
    std::complex<double> a = 0.0, b = 0.0;
    for (std::size_t k = 0; k < turn.size(); ++k) {
      a += x[k];
      b += y[k];
      x[k] *= turn[k];
      y[k] *= turn[k];
    }
    const double rise = 1.0 - std::exp(-static_cast<double>(i - first) / corpus_rate_hz / pulse_s);
    ring.push_back(rise * a.real());
    ring.push_back(rise * b.real());
    most = std::max({most, std::abs(a.real()), std::abs(b.real())});
  }
  for (std::size_t i = first; i < last; ++i) {
    const double t = static_cast<double>(i - first) / corpus_rate_hz;
    const double local = local_share * std::exp(-local_decay * t) * std::sin(2.0 * pi * local_hz * t);
    for (std::size_t c = 0; c < 2; ++c) {
      const double share = c == 0 ? std::cos(direction) : std::sin(direction);
      const double value = ring[2 * (i - first) + c] / most + share * local;
      samples[2 * i + c] += static_cast<float>(peak_m_per_s2 * value);
    }
  }
}

double noise_density_per_hz(const NoiseResonances& of, double frequency_hz) {
  const double sum = 0.75 * 0.75 + 0.35 * 0.35 * Coloured(3.0, 0.7).density(frequency_hz) +
                     0.4 * 0.4 * Coloured(of.structure_hz, 0.02).density(frequency_hz) +
                     0.4 * 0.4 * Coloured(of.local_hz, 0.05).density(frequency_hz);
  return 2.0 * sum / corpus_rate_hz;
}

std::vector<float> disturbed(const CutPlan& plan, const CleanCut& clean, const Disturbance& disturbance, Random& random,
                             std::array<NoiseResonances, 2>* drawn) {
  const Eigen::Index n = clean.acceleration_m_per_s2.rows();
  const double level = reference_level(plan, clean);
  std::vector<float> samples(2 * static_cast<std::size_t>(n));
  const double hum_hz = 50.0 * random.uniform(0.998, 1.002);
  const double swing_s = random.uniform(2.0, 8.0), swing_phase = random.uniform(0.0, 2.0 * pi);
  for (std::size_t c = 0; c < 2; ++c) {
    const double structure_hz = random.uniform(500.0, 600.0), local_hz = random.uniform(1200.0, 3800.0);
    if (drawn != nullptr) drawn->at(c) = {structure_hz, local_hz};
    Coloured red(3.0, 0.7), structure(structure_hz, 0.02), local(local_hz, 0.05);
    const double hum_phase = random.uniform(0.0, 2.0 * pi), unbalance_phase = random.uniform(0.0, 2.0 * pi);
    const double share = random.uniform(0.5, 1.0);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const double t = static_cast<double>(i) / corpus_rate_hz;
      const double cutting = clean.depth_share[k] > 0.0F ? 1.0 : 0.0;
      const double noise = 0.75 * random.normal() + 0.35 * red.next(random.normal()) +
                           cutting * (0.4 * structure.next(random.normal()) + 0.4 * local.next(random.normal()));
      double hum = 0.0;
      for (const auto& [multiple, part] : {std::pair{1, 1.0}, {2, 0.6}, {3, 0.4}, {5, 0.2}}) {
        hum += part * std::sin(multiple * (2.0 * pi * hum_hz * t + hum_phase));
      }
      const double turn = std::sin(clean.rotation_rad[k] + unbalance_phase);
      const double gain = 1.0 + disturbance.gain_swing * std::sin(2.0 * pi * t / swing_s + swing_phase);
      const double value =
          clean.acceleration_m_per_s2(i, static_cast<Eigen::Index>(c)) +
          level * (disturbance.noise * noise + disturbance.hum * share * hum + disturbance.unbalance * turn);
      samples[2 * k + c] = static_cast<float>(gain * value);
    }
  }
  const double seconds = static_cast<double>(n) / corpus_rate_hz;
  for (double t = -std::log(1.0 - random.uniform()) / disturbance.knocks_per_s; t < seconds;
       t -= std::log(1.0 - random.uniform()) / disturbance.knocks_per_s) {
    add_knock(plan.structure(), level * std::exp(random.uniform(0.0, std::log(10.0))), t, random, samples);
  }
  return samples;
}

}  // namespace robomill::monitor::testing
