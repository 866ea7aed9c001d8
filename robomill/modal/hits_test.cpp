#include "robomill/modal/hits.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <numbers>
#include <string>

#include "examples/first-lobes/hammer.hpp"
#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/modal/modes.hpp"
#include "testing/robot_modes.hpp"
#include "testing/support.hpp"

namespace robomill::modal {
namespace hits_test {

using Complex = std::complex<double>;
using Eigen::Index;
using examples::Hammer;

// One mass of 2 kg on a spring, with the accelerometer's mass where it is given.
ModalModel one_mass(double frequency_hz, double damping_ratio, double mass_kg = 2.0) {
  Mode mode;
  mode.frequency_hz = frequency_hz;
  mode.damping_ratio = damping_ratio;
  const Complex norm = std::sqrt(1.0 / (2.0 * mass_kg * Complex(0.0, pole(mode).imag())));
  mode.left = Eigen::VectorXcd::Constant(1, norm);
  mode.right = mode.left;
  ModalModel model;
  model.excitations = {Dof{}};
  model.responses = {Dof{}};
  model.modes = {mode};
  return model;
}

Hammer quiet() {
  Hammer hammer;
  hammer.force_noise_n = 0.0;
  hammer.response_noise = 0.0;
  return hammer;
}

// A small, quick case: 1,024 samples at 2,048 Hz, a mode at 100 Hz that has died by then.
Hammer brief() {
  Hammer hammer = quiet();
  hammer.sample_rate_hz = 2048.0;
  hammer.record_s = 0.5;
  hammer.pretrigger_s = 0.03;
  hammer.pulse_s = 2.5e-3;
  return hammer;
}

std::vector<Hit> brief_hits(const Hammer& hammer = brief(), int count = 3, std::uint64_t seed = 1) {
  return examples::simulate_hits(one_mass(100.0, 0.05), count, 0.05, hammer, seed);
}

HitOptions up_to(double max_frequency_hz) {
  HitOptions options;
  options.max_frequency_hz = max_frequency_hz;
  return options;
}

// ‖H - H_true‖ / ‖H_true‖ over a band.
double error(const FrfSet& set, const ModalModel& truth, const FrfName& name, double low_hz, double high_hz) {
  const FrfSet exact = synthesize(truth, set.frequency_hz);
  const Frf& have = *set.find(name);
  const Frf& want = *exact.find(name);
  double difference = 0.0;
  double size = 0.0;
  for (Index i = 0; i < set.frequency_hz.size(); ++i) {
    if (set.frequency_hz(i) < low_hz || set.frequency_hz(i) > high_hz) continue;
    difference += std::norm(have.receptance(i) - want.receptance(i));
    size += std::norm(want.receptance(i));
  }
  return std::sqrt(difference / size);
}

double error(const FrfResult& result, const ModalModel& truth, double low_hz, double high_hz) {
  return error(result.set, truth, FrfName{}, low_hz, high_hz);
}

void expect_rejection(const std::vector<Hit>& hits, const HitOptions& options, const std::string& part) {
  const std::string message = test::rejection([&] { static_cast<void>(estimate_frfs(hits, options)); });
  EXPECT_NE(message.find(part), std::string::npos) << "message: " << message;
}

// What is left of mode 1 at the end of 5 s, 0.1 % of it, is the error.
TEST(EstimateFrfs, GivesTheRobotsFrfsWithoutNoise) {
  const ModalModel model = data::robot_modes();
  Hammer hammer = quiet();
  hammer.record_s = 5.0;
  const FrfResult result = estimate_frfs(examples::simulate_hits(model, 2, 0.05, hammer, 1), up_to(1000.0));
  ASSERT_EQ(result.set.frfs.size(), 4u);
  EXPECT_EQ(result.added_decay_per_s, 0.0);
  for (const char* name : {"xx", "yx", "xy", "yy"}) {
    const FrfName frf = parse_frf_name(name);
    ASSERT_NE(result.set.find(frf), nullptr);
    EXPECT_LT(error(result.set, model, frf, 5.0, 1000.0), 2e-3) << name;
    EXPECT_LT(error(result.set, model, frf, 100.0, 1000.0), 1e-4) << name;
  }
  EXPECT_NEAR(result.set.frequency_hz(0), 0.2, 1e-12);
  EXPECT_NEAR(result.set.frequency_hz(result.set.frequency_hz.size() - 1), 1000.0, 1e-9);
}

// With sensor noise the error is what `deviation` says: norms within a third, and hardly a line beyond four deviations.
TEST(EstimateFrfs, KnowsItsOwnDeviation) {
  const ModalModel model = data::robot_modes();
  const FrfResult result = estimate_frfs(examples::simulate_hits(model, 5, 0.05, Hammer{}, 3), up_to(1000.0));
  const FrfSet exact = synthesize(model, result.set.frequency_hz);
  for (const Frf& frf : result.set.frfs) {
    ASSERT_EQ(frf.deviation.size(), frf.receptance.size());
    const Eigen::VectorXd miss =
        (frf.receptance - exact.find(frf.name)->receptance).cwiseAbs().cwiseQuotient(frf.deviation);
    const Index from = 100;  // 25 Hz
    const Eigen::VectorXd above = miss.tail(miss.size() - from);
    EXPECT_NEAR(std::sqrt(above.cwiseAbs2().mean()), 1.0, 0.34) << to_string(frf.name);
    EXPECT_LT(static_cast<double>((above.array() > 4.0).count()), 0.002 * static_cast<double>(above.size()));
  }
}

TEST(EstimateFrfs, TakesVelocityAndDisplacementToo) {
  const ModalModel model = one_mass(100.0, 0.05);
  for (const ResponseKind kind : {ResponseKind::acceleration, ResponseKind::velocity, ResponseKind::displacement}) {
    Hammer hammer = brief();
    hammer.response = kind;
    HitOptions options = up_to(600.0);
    options.response = kind;
    EXPECT_LT(error(estimate_frfs(brief_hits(hammer), options), model, 10.0, 600.0), 1e-3);
  }
}

TEST(EstimateFrfs, TurnsSignsOfHitsAndSensorsAgainstTheirAxes) {
  const std::vector<Hit> straight = brief_hits();
  const FrfResult want = estimate_frfs(straight, up_to(600.0));
  std::vector<Hit> turned = straight;
  turned[0].against_axis = true;
  turned[0].responses[0].samples *= -1.0;
  turned[1].responses[0].against_axis = true;
  turned[1].responses[0].samples *= -1.0;
  const FrfResult got = estimate_frfs(turned, up_to(600.0));
  EXPECT_TRUE((got.set.frfs[0].receptance.array() == want.set.frfs[0].receptance.array()).all());
}

// |H1| = γ² |H2| and Hv² = H1 H2 hold on every line, by definition.
TEST(EstimateFrfs, EstimatorsKeepTheirIdentities) {
  Hammer hammer = brief();
  hammer.force_noise_n = 2.0;
  hammer.response_noise = 2.0;
  const std::vector<Hit> hits = brief_hits(hammer, 5);
  HitOptions options = up_to(600.0);
  options.exponential_window = ExponentialWindow::off;
  const Frf h1 = estimate_frfs(hits, options).set.frfs[0];
  options.estimator = Estimator::h2;
  const Frf h2 = estimate_frfs(hits, options).set.frfs[0];
  options.estimator = Estimator::hv;
  const Frf hv = estimate_frfs(hits, options).set.frfs[0];
  for (Index i = 0; i < h1.receptance.size(); ++i) {
    EXPECT_LT(std::abs(h1.receptance(i) - h1.coherence(i) * h2.receptance(i)), 1e-10 * std::abs(h2.receptance(i)));
    const Complex product = h1.receptance(i) * h2.receptance(i);
    EXPECT_LT(std::abs(hv.receptance(i) * hv.receptance(i) - product), 1e-10 * std::abs(product));
    EXPECT_GE(h1.coherence(i), 0.0);
    EXPECT_LE(h1.coherence(i), 1.0);
  }
}

// Mean of Re(H/H_true) over 300 to 600 Hz, where this mass answers evenly, from many hits.
double mean_ratio(const Hammer& hammer, Estimator estimator) {
  const ModalModel model = one_mass(100.0, 0.05);
  HitOptions options = up_to(600.0);
  options.estimator = estimator;
  options.exponential_window = ExponentialWindow::off;
  options.force_window = false;  // it would take the force's noise away
  options.double_hit_limit = 1.0;
  const FrfResult result = estimate_frfs(brief_hits(hammer, 200, 7), options);
  const FrfSet exact = synthesize(model, result.set.frequency_hz);
  double sum = 0.0;
  double count = 0.0;
  for (Index i = 0; i < result.set.frequency_hz.size(); ++i) {
    if (result.set.frequency_hz(i) < 300.0) continue;
    sum += (result.set.frfs[0].receptance(i) / exact.frfs[0].receptance(i)).real();
    count += 1.0;
  }
  return sum / count;
}

// Noise on the response leaves H1 alone and raises H2, noise on the force lowers H1 and leaves H2 alone; Hv lies
// between.
TEST(EstimateFrfs, EstimatorsHaveTheBiasTheyAreKnownFor) {
  Hammer loud_response = brief();
  loud_response.response_noise = 1.0;
  EXPECT_NEAR(mean_ratio(loud_response, Estimator::h1), 1.0, 0.01);
  EXPECT_GT(mean_ratio(loud_response, Estimator::h2), 1.05);
  Hammer loud_force = brief();
  loud_force.force_noise_n = 2.0;
  EXPECT_LT(mean_ratio(loud_force, Estimator::h1), 0.95);
  EXPECT_NEAR(mean_ratio(loud_force, Estimator::h2), 1.0, 0.01);
  const double between = mean_ratio(loud_force, Estimator::hv);
  EXPECT_GT(between, mean_ratio(loud_force, Estimator::h1));
  EXPECT_LT(between, mean_ratio(loud_force, Estimator::h2));
}

TEST(EstimateFrfs, OneHitHasNoCoherenceAndSaysSo) {
  const FrfResult result = estimate_frfs(brief_hits(brief(), 1), up_to(600.0));
  EXPECT_EQ(result.set.frfs[0].coherence.size(), 0);
  EXPECT_EQ(result.set.frfs[0].deviation.size(), 0);
  EXPECT_TRUE(std::isnan(result.grades[0].mean_coherence));
  bool said = false;
  for (const std::string& note : result.notes) said = said || note.find("no coherence") != std::string::npos;
  EXPECT_TRUE(said);
  EXPECT_LT(error(result, one_mass(100.0, 0.05), 10.0, 600.0), 1e-3);
}

// Records of 1 s of a robot whose mode 1 needs 5: a quarter of it still rings at the end.
TEST(EstimateFrfs, TakesOutTheDampingOfTheExponentialWindow) {
  const ModalModel model = data::robot_modes();
  Hammer hammer = quiet();
  hammer.record_s = 1.0;
  const std::vector<Hit> hits = examples::simulate_hits(model, 2, 0.05, hammer, 1);
  HitOptions options = up_to(1000.0);
  const FrfResult automatic = estimate_frfs(hits, options);
  EXPECT_TRUE(automatic.added_decay_removed);
  EXPECT_NEAR(automatic.added_decay_per_s, 4.0, 1.0);
  options.exponential_window = ExponentialWindow::off;
  const FrfResult without = estimate_frfs(hits, options);
  EXPECT_EQ(without.added_decay_per_s, 0.0);
  for (const char* name : {"xx", "yy"}) {
    const FrfName frf = parse_frf_name(name);
    EXPECT_LT(error(automatic.set, model, frf, 5.0, 1000.0), 0.01) << name;
    EXPECT_LT(error(automatic.set, model, frf, 15.0, 25.0), 0.02) << name;
  }
  EXPECT_GT(error(without.set, model, parse_frf_name("yy"), 15.0, 25.0), 0.1);
}

// H(iω + σ) has the poles λ - σ.
TEST(EstimateFrfs, LeavesTheAddedDampingInWhenAsked) {
  const ModalModel model = data::robot_modes();
  Hammer hammer = quiet();
  hammer.record_s = 2.0;
  HitOptions options = up_to(1000.0);
  options.exponential_window = ExponentialWindow::on;
  options.exponential_time_constant_s = 0.4;
  options.remove_added_damping = false;
  const FrfResult result = estimate_frfs(examples::simulate_hits(model, 2, 0.05, hammer, 1), options);
  EXPECT_FALSE(result.added_decay_removed);
  EXPECT_NEAR(result.added_decay_per_s, 2.5, 1e-12);
  ModalModel damped = model;
  for (Mode& mode : damped.modes) {
    const Complex moved = pole(mode) - 2.5;
    mode.frequency_hz = std::abs(moved) / (2.0 * std::numbers::pi);
    mode.damping_ratio = -moved.real() / std::abs(moved);
  }
  for (const char* name : {"xx", "yy"}) {
    EXPECT_LT(error(result.set, damped, parse_frf_name(name), 5.0, 1000.0), 2e-3) << name;
  }
}

TEST(EstimateFrfs, RejectsADoubleHitAndSaysWhy) {
  std::vector<Hit> hits = brief_hits();
  // The same pulse again at 5 % of its height, 60 ms later, with its response.
  for (Eigen::VectorXd* channel : {&hits[1].force_n, &hits[1].responses[0].samples}) {
    const Eigen::VectorXd first = *channel;
    channel->tail(first.size() - 123) += 0.05 * first.head(first.size() - 123);
  }
  const FrfResult result = estimate_frfs(hits, up_to(600.0));
  EXPECT_TRUE(result.hits[0].accepted);
  EXPECT_FALSE(result.hits[1].accepted);
  EXPECT_TRUE(result.hits[2].accepted);
  ASSERT_EQ(result.hits[1].reasons.size(), 1u);
  EXPECT_NE(result.hits[1].reasons[0].find("double hit"), std::string::npos);
  EXPECT_NEAR(result.hits[1].second_pulse_ratio, 0.05, 0.005);
  EXPECT_EQ(result.hits[1].file, "hit_x_2.csv");
  EXPECT_EQ(result.grades[0].hits, 2);
  expect_rejection({hits[1]}, up_to(600.0), "hit_x_2.csv: double hit");
}

TEST(EstimateFrfs, CountsOneRecordOnce) {
  std::vector<Hit> hits = brief_hits();
  hits.push_back(hits[1]);
  hits.back().file = "hit_x_2_copy.csv";
  FrfResult result = estimate_frfs(hits, up_to(600.0));
  ASSERT_EQ(result.hits[3].reasons.size(), 1u);
  EXPECT_EQ(result.hits[3].reasons[0], "is the hit of hit_x_2.csv again, sample for sample: a hit counts once");
  EXPECT_EQ(result.grades[0].hits, 3);
  hits.back().excitation.axis = hits.back().responses[0].dof.axis = Axis::y;
  result = estimate_frfs(hits, up_to(600.0));
  ASSERT_EQ(result.hits[3].reasons.size(), 1u);
  EXPECT_NE(result.hits[3].reasons[0].find("which was in x: a hit has one direction"), std::string::npos);
  // Two sensors of one hit are two columns of one record.
  hits.back().excitation.axis = Axis::x;
  hits.back().responses[0].samples *= 0.5;
  EXPECT_TRUE(estimate_frfs(hits, up_to(600.0)).hits[3].accepted);
}

// A time in ms under a name in s, and a rate in kHz or in MHz, are pulses of no hammer.
TEST(EstimateFrfs, RejectsPulsesThatNoHammerMakes) {
  for (const double slip : {1e-3, 1e6}) {
    std::vector<Hit> hits = brief_hits();
    for (Hit& hit : hits) hit.sample_rate_hz *= slip;
    const std::string message = test::rejection([&] { static_cast<void>(estimate_frfs(hits, {})); });
    EXPECT_NE(message.find("is the time in s and the sample rate in Hz?"), std::string::npos) << message;
  }
}

TEST(EstimateFrfs, RejectsOverloads) {
  std::vector<Hit> hits = brief_hits();
  const double peak_n = hits[0].force_n.maxCoeff();
  hits[0].force_n = hits[0].force_n.cwiseMin(0.4 * peak_n);
  hits[1].responses[0].samples = hits[1].responses[0].samples.cwiseMax(0.6 * hits[1].responses[0].samples.minCoeff());
  FrfResult result = estimate_frfs(hits, up_to(600.0));
  EXPECT_FALSE(result.hits[0].accepted);
  EXPECT_NE(result.hits[0].reasons[0].find("the force is clipped"), std::string::npos);
  EXPECT_FALSE(result.hits[1].accepted);
  EXPECT_NE(result.hits[1].reasons[0].find("the response in x is clipped"), std::string::npos);
  EXPECT_TRUE(result.hits[2].accepted);

  HitOptions options = up_to(600.0);
  options.force_overload_n = 100.0;
  expect_rejection(brief_hits(), options, "overload: the force reaches");
  options.force_overload_n = 0.0;
  options.response_overload = 1.0;
  expect_rejection(brief_hits(), options, "overload: the response in x reaches");
}

TEST(EstimateFrfs, RejectsWhatIsNoHit) {
  std::vector<Hit> hits = brief_hits();
  hits[0].force_n *= -1.0;
  const FrfResult result = estimate_frfs(hits, up_to(600.0));
  EXPECT_NE(result.hits[0].reasons[0].find("only pushes"), std::string::npos);

  hits = brief_hits(brief(), 1);
  Random random(1);
  for (Index j = 0; j < hits[0].force_n.size(); ++j) hits[0].force_n(j) = random.normal();
  expect_rejection(hits, up_to(600.0), "no hit stands out of the noise");

  hits = brief_hits(brief(), 1);
  hits[0].responses[0].samples.setZero();
  expect_rejection(hits, up_to(600.0), "was its sensor connected");

  hits = brief_hits(brief(), 1);
  hits[0].force_n = hits[0].force_n.tail(960).eval();
  hits[0].responses[0].samples = hits[0].responses[0].samples.tail(960).eval();
  expect_rejection(hits, up_to(600.0), "begins inside the pulse");

  Hammer late = brief();
  late.pretrigger_s = 0.45;
  expect_rejection(brief_hits(late, 1), up_to(600.0), "so late");
}

// 60 g on 2 kg: 1.5 % of frequency, far more than the tolerance.
TEST(EstimateFrfs, TakesOutTheAccelerometersMass) {
  const double sensor_kg = 0.06;
  const ModalModel free = one_mass(100.0, 0.05);
  const double total_kg = 2.0 + sensor_kg;
  const double loaded_hz = 100.0 * std::sqrt(2.0 / total_kg);
  const ModalModel loaded = one_mass(loaded_hz, 0.05 * std::sqrt(2.0 / total_kg), total_kg);
  const std::vector<Hit> hits = examples::simulate_hits(loaded, 3, 0.05, brief(), 1);
  HitOptions options = up_to(600.0);
  EXPECT_GT(error(estimate_frfs(hits, options), free, 10.0, 600.0), 0.1);
  options.accelerometer_mass_kg = sensor_kg;
  EXPECT_LT(error(estimate_frfs(hits, options), free, 10.0, 600.0), 2e-3);
}

TEST(EstimateFrfs, SaysWhichMassItCannotTakeOut) {
  std::vector<Hit> hits = brief_hits();
  for (Hit& hit : hits) hit.excitation.axis = Axis::y;
  HitOptions options = up_to(600.0);
  options.accelerometer_mass_kg = 0.01;
  const FrfResult result = estimate_frfs(hits, options);
  bool said = false;
  for (const std::string& note : result.notes) said = said || note.find("mass stays") != std::string::npos;
  EXPECT_TRUE(said);
}

// White noise of the accelerometer over ω²: with the mean of five spectra it comes to σ sqrt(n/5) / sample rate /
// impulse / ω².
TEST(EstimateFrfs, StatesTheLowestTrustworthyFrequency) {
  Hammer hammer;
  hammer.force_noise_n = 0.0;
  hammer.response_noise = 0.3;
  const ModalModel model = one_mass(150.0, 0.02);
  const FrfResult result = estimate_frfs(examples::simulate_hits(model, 5, 0.05, hammer, 5), up_to(1000.0));
  const double impulse_n_s = 2.0 / std::numbers::pi * 200.0 * 1.2e-3;
  const double noise_per_kg = 0.3 * std::sqrt(4.0 * 4096.0 / 5.0) / 4096.0 / impulse_n_s;
  const FrfSet exact = synthesize(model, result.set.frequency_hz);
  double expected_hz = 0.0;
  for (Index i = exact.frequency_hz.size() - 1; i >= 0; --i) {
    const double omega = 2.0 * std::numbers::pi * exact.frequency_hz(i);
    const double noise = noise_per_kg / (omega * omega);
    if (exact.frequency_hz(i) < 150.0 && noise > 0.1 * std::abs(exact.frfs[0].receptance(i))) {
      expected_hz = exact.frequency_hz(i);
      break;
    }
  }
  EXPECT_GT(expected_hz, 50.0);
  EXPECT_NEAR(result.lowest_trustworthy_frequency_hz, expected_hz, 0.1 * expected_hz);
  EXPECT_LT(error(result, model, result.lowest_trustworthy_frequency_hz, 120.0), 0.1);
}

// One mode has its peak at f √(1 - 2ζ²), 1 / (2 k ζ √(1 - ζ²)) high; lines lie 2 Hz apart.
TEST(EstimateFrfs, NamesTheHighestPeaks) {
  const FrfGrade grade = estimate_frfs(brief_hits(), {}).grades.at(0);
  ASSERT_EQ(grade.peaks.size(), 1U);
  const double zeta = 0.05;
  const double stiffness = 2.0 * std::pow(2.0 * std::numbers::pi * 100.0, 2);
  EXPECT_NEAR(grade.peaks[0].frequency_hz, 100.0 * std::sqrt(1.0 - 2.0 * zeta * zeta), 2.0);
  const double highest = 1.0 / (2.0 * stiffness * zeta * std::sqrt(1.0 - zeta * zeta));
  EXPECT_NEAR(grade.peaks[0].receptance_m_per_n, highest, 0.02 * highest);
}

TEST(EstimateFrfs, KeepsToTheFrequenciesAskedFor) {
  HitOptions options = up_to(400.0);
  options.min_frequency_hz = 20.0;
  options.frequency_resolution_hz = 1.0;
  const FrfResult fine = estimate_frfs(brief_hits(), options);
  EXPECT_NEAR(fine.set.frequency_hz(0), 20.0, 1e-12);
  EXPECT_NEAR(fine.set.frequency_hz(1), 21.0, 1e-12);
  EXPECT_EQ(fine.set.frequency_hz.size(), 381);
  EXPECT_LT(error(fine, one_mass(100.0, 0.05), 20.0, 400.0), 1e-3);
  options.frequency_resolution_hz = 4.0;
  const FrfResult coarse = estimate_frfs(brief_hits(), options);
  EXPECT_EQ(coarse.set.frequency_hz.size(), 96);
  EXPECT_LT(error(coarse, one_mass(100.0, 0.05), 20.0, 400.0), 5e-3);
}

TEST(EstimateFrfs, IsTheSameOnAnyNumberOfThreads) {
  Hammer hammer;
  hammer.record_s = 1.0;
  const std::vector<Hit> hits = examples::simulate_hits(data::robot_modes(), 2, 0.05, hammer, 1);
  set_thread_count(1);
  const FrfResult one = estimate_frfs(hits, up_to(1000.0));
  set_thread_count(3);
  const FrfResult three = estimate_frfs(hits, up_to(1000.0));
  set_thread_count(0);
  for (std::size_t f = 0; f < 4; ++f) {
    EXPECT_TRUE((one.set.frfs[f].receptance.array() == three.set.frfs[f].receptance.array()).all());
  }
}

TEST(EstimateFrfs, RejectsUnsoundRecords) {
  const std::vector<Hit> good = brief_hits();
  const HitOptions options = up_to(600.0);
  expect_rejection({}, options, "hits: are none");
  std::vector<Hit> hits = good;
  hits[1].sample_rate_hz = 1024.0;
  expect_rejection(hits, options, "hit_x_2.csv: sample_rate_hz: is 1024 Hz, but 2048 Hz in hit_x_1.csv");
  hits = good;
  hits[0].sample_rate_hz = 0.0;
  expect_rejection(hits, options, "must be > 0");
  hits = good;
  hits[2].force_n(7) = std::numeric_limits<double>::quiet_NaN();
  expect_rejection(hits, options, "hit_x_3.csv: force_n: sample 8 is not a finite number");
  hits = good;
  hits[2].responses[0].samples(9) = std::numeric_limits<double>::infinity();
  expect_rejection(hits, options, "responses.x: sample 10");
  hits = good;
  hits[0].force_n.setZero();
  expect_rejection(hits, options, "is the same throughout");
  hits = good;
  hits[0].force_n = hits[0].force_n.head(100).eval();
  expect_rejection(hits, options, "a hit needs at least");
  hits = good;
  hits[0].responses[0].samples = hits[0].responses[0].samples.head(1000).eval();
  expect_rejection(hits, options, "has 1000 samples, the force 1024");
  hits = good;
  hits[0].responses.clear();
  expect_rejection(hits, options, "responses: are none");
  hits = good;
  hits[0].responses.push_back(hits[0].responses[0]);
  expect_rejection(hits, options, "comes twice");
  hits[0].responses[1].dof.axis = Axis::y;
  expect_rejection(hits, options, "differ from those of hit_x_1.csv");
  hits = good;
  hits[0].excitation.axis = Axis::rx;
  expect_rejection(hits, options, "must be x, y or z");
}

TEST(EstimateFrfs, RejectsUnsoundOptions) {
  const std::vector<Hit> hits = brief_hits();
  const auto rejects = [&](const char* part, const std::function<void(HitOptions&)>& spoil) {
    HitOptions options;
    spoil(options);
    expect_rejection(hits, options, part);
  };
  rejects("is the value in kg?", [](HitOptions& o) { o.accelerometer_mass_kg = 5.0; });
  rejects("accelerometer_mass_kg", [](HitOptions& o) { o.accelerometer_mass_kg = -1.0; });
  rejects("max_frequency_hz", [](HitOptions& o) { o.min_frequency_hz = 50.0, o.max_frequency_hz = 20.0; });
  rejects("double_hit_limit", [](HitOptions& o) { o.double_hit_limit = 3.0; });
  rejects("at least 17 lines", [](HitOptions& o) { o.min_frequency_hz = 5000.0; });
  rejects("frequency_resolution_hz", [](HitOptions& o) { o.frequency_resolution_hz = 1e-9; });
  rejects("exponential_time_constant_s", [](HitOptions& o) { o.exponential_time_constant_s = -1.0; });
  rejects("force_window_s", [](HitOptions& o) { o.force_window_s = std::numeric_limits<double>::infinity(); });
}

TEST(EstimateFrfs, StopsWhenAsked) {
  const std::atomic<bool> stop = true;
  Progress progress({}, &stop);
  EXPECT_THROW(static_cast<void>(estimate_frfs(brief_hits(), up_to(600.0), progress)), Interrupted);
}

}  // namespace hits_test
}  // namespace robomill::modal
