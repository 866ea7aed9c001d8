#include "robomill/coupling/beam_element.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/MatrixFunctions>

#include "robomill/base/lanes.hpp"
#include "robomill/base/random.hpp"
#include "robomill/coupling/section.hpp"
#include "testing/coupling/beams.hpp"
#include "testing/support.hpp"

namespace robomill::coupling {
namespace beam_element_test {

using detail::BeamElement;
using testing::bar;
using LongComplex = std::complex<long double>;

/// Bishop's functions of x = λL; power series where the closed forms cancel. cosh 100 is far within a long double.
struct BeamFunctions {
  LongComplex f1, f3, f4, f5, f6, f7, f8, f10;
};

LongComplex power_sum(LongComplex x, int first, long double base) {
  LongComplex sum = 0.0L;
  LongComplex term = 1.0L;
  for (int i = 1; i <= first; ++i) term *= x / static_cast<long double>(i);
  for (int k = 0; k < 40; ++k) {
    sum += term;
    for (int i = 1; i <= 4; ++i) term *= x / static_cast<long double>(first + 4 * k + i);
    term *= base;
  }
  return sum;
}

BeamFunctions beam_functions(LongComplex x) {
  const LongComplex s = std::sin(x), c = std::cos(x), sh = std::sinh(x), ch = std::cosh(x);
  if (std::abs(x) > 3.0L) {
    return {s * sh, c * ch - 1.0L, c * ch + 1.0L, c * sh - s * ch, c * sh + s * ch, s + sh, s - sh, c - ch};
  }
  return {2.0L * power_sum(x, 2, -4.0L),  power_sum(x, 4, -4.0L) * -4.0L, c * ch + 1.0L,
          -4.0L * power_sum(x, 3, -4.0L), 2.0L * power_sum(x, 1, -4.0L),  2.0L * power_sum(x, 1, 1.0L),
          -2.0L * power_sum(x, 3, 1.0L),  -2.0L * power_sum(x, 2, 1.0L)};
}

Eigen::MatrixXcd to_double(const Eigen::Matrix<LongComplex, -1, -1>& a) {
  Eigen::MatrixXcd out(a.rows(), a.cols());
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    out(i) = {static_cast<double>(a(i).real()), static_cast<double>(a(i).imag())};
  }
  return out;
}

/// A free beam's 4 x 4 in the order u_1, θ_1, u_2, θ_2. Source: [BishopJohnson1960].
Eigen::MatrixXcd free_beam(LongComplex x, double length, std::complex<double> stiffness) {
  const BeamFunctions f = beam_functions(x);
  const LongComplex ei = {static_cast<long double>(stiffness.real()), static_cast<long double>(stiffness.imag())};
  const LongComplex lambda = x / static_cast<long double>(length);
  const LongComplex d3 = ei * lambda * lambda * lambda * f.f3;
  const LongComplex d2 = ei * lambda * lambda * f.f3;
  const LongComplex d1 = ei * lambda * f.f3;
  Eigen::Matrix<LongComplex, -1, -1> r(4, 4);
  r << -f.f5 / d3, -f.f1 / d2, f.f8 / d3, f.f10 / d2,  //
      -f.f1 / d2, f.f6 / d1, -f.f10 / d2, f.f7 / d1,   //
      f.f8 / d3, -f.f10 / d2, -f.f5 / d3, f.f1 / d2,   //
      f.f10 / d2, f.f7 / d1, f.f1 / d2, f.f6 / d1;
  return to_double(r);
}

/// Frequency at which λL is x for a bar without loss.
double frequency_at(double x, const Segment& segment) {
  const detail::Section s = detail::section(segment);
  return std::sqrt(std::pow(x / 2.0, 4) / s.bending) / (2.0 * std::numbers::pi);
}

LongComplex lossy(double x, const Segment& segment) {
  const LongComplex loss = {1.0L, static_cast<long double>(segment.loss_factor)};
  return static_cast<long double>(x) / std::pow(loss, 0.25L);
}

Eigen::Matrix4cd free_matrix(const BeamElement& element) {
  const Eigen::Matrix2cd r22 = element.stiffness.inverse();
  const Eigen::Matrix2cd r12 = element.carry * r22;
  Eigen::Matrix4cd out;
  out << element.clamped + r12 * element.carry.transpose(), r12, r12.transpose(), r22;
  return out;
}

/// The largest difference, each entry against the unit that u and θ, f and m give it: L for an angle.
double misfit(const Eigen::MatrixXcd& a, const Eigen::MatrixXcd& b, double length) {
  Eigen::VectorXd unit = Eigen::VectorXd::Ones(a.rows());
  for (Eigen::Index i = 1; i < unit.size(); i += 2) unit(i) = length;
  const Eigen::MatrixXcd difference = unit.asDiagonal() * (a - b) * unit.asDiagonal();
  return (difference).cwiseAbs().maxCoeff() / (unit.asDiagonal() * b * unit.asDiagonal()).cwiseAbs().maxCoeff();
}

TEST(BeamElement, FreeBeamIsBishopsFromLambdaL1em3To100) {
  const Segment segment = bar(0.11892);
  const detail::Section s = detail::section(segment);
  for (double x = 1e-3; x < 100.5; x *= 1.07) {
    const BeamElement element =
        detail::beam_elements({segment}, Eigen::VectorXd::Constant(1, frequency_at(x, segment))).front();
    const Eigen::MatrixXcd expected = free_beam(lossy(x, segment), segment.length_m, s.bending_stiffness_n_m2 * s.loss);
    // At a resonance of the free beam the stiffness is all but singular, and its inverse loses as many digits.
    EXPECT_LT(misfit(free_matrix(element), expected, segment.length_m), 1e-12 * std::max(1.0, x)) << x;
  }
}

TEST(BeamElement, ClampedBeamIsBishopsFromLambdaL1em3To100) {
  const Segment segment = bar(0.11892);
  const detail::Section s = detail::section(segment);
  for (double x = 1e-3; x < 100.5; x *= 1.07) {
    const BeamElement element =
        detail::beam_elements({segment}, Eigen::VectorXd::Constant(1, frequency_at(x, segment))).front();
    const LongComplex z = lossy(x, segment);
    const BeamFunctions f = beam_functions(z);
    const LongComplex ei = {static_cast<long double>(s.bending_stiffness_n_m2),
                            static_cast<long double>(s.bending_stiffness_n_m2 * segment.loss_factor)};
    const LongComplex lambda = z / static_cast<long double>(segment.length_m);
    Eigen::Matrix<LongComplex, -1, -1> expected(2, 2);
    const LongComplex l = -f.f1 / (ei * lambda * lambda * f.f4);
    expected << -f.f5 / (ei * lambda * lambda * lambda * f.f4), l, l, f.f6 / (ei * lambda * f.f4);
    EXPECT_LT(misfit(element.clamped, to_double(expected), segment.length_m), 2e-13 * std::max(1.0, x)) << x;
  }
}

/// The functions of [JointIdentification] with the right names: c1, c2, c5 of the text's own length, c3, c4, c6 of the
/// tool's; c7 and c8 carry the complex E I.
struct PublishedFunctions {
  std::complex<double> c1, c2, c3, c4, c5, c6, c7, c8;
};
PublishedFunctions published(std::complex<double> x, std::complex<double> ei) {
  const std::complex<double> s = std::sin(x), c = std::cos(x), sh = std::sinh(x), ch = std::cosh(x);
  return {c * sh - s * ch, s * sh, s - sh, c - ch, c * sh + s * ch, s + sh, ei * (c * ch - 1.0), ei * (c * ch + 1.0)};
}

// Its slopes count from the spindle to the tip: they and the moments turn their signs. As printed equation 8 has c1 for
// c2, the text gives c5 as c3, c8 as c4, c3 with the holder's length, and c4 = cos cosh for cos - cosh.
TEST(BeamElement, PublishedClosedFormsHoldWithTheirFunctionsPutRight) {
  const Segment tool = bar(0.11892), holder = bar(0.05090);
  const detail::Section section = detail::section(tool);
  const std::complex<double> ei = section.bending_stiffness_n_m2 * section.loss;
  const Eigen::Vector4d turned(1.0, -1.0, 1.0, -1.0);
  for (const double frequency_hz : {1000.0, 2000.0, 3281.0, 3825.0, 5000.0}) {
    const Eigen::VectorXd line = Eigen::VectorXd::Constant(1, frequency_hz);
    const double lossless = 2.0 * std::pow(section.bending * std::pow(2.0 * std::numbers::pi * frequency_hz, 2), 0.25);
    const std::complex<double> lambda = lossless / std::pow(section.loss, 0.25) / tool.length_m;
    const std::complex<double> l2 = lambda * lambda, l3 = l2 * lambda;

    const PublishedFunctions a = published(lambda * tool.length_m, ei);
    const auto table = [&](std::complex<double> c3, std::complex<double> c4) {
      Eigen::Matrix4cd r;
      r << -a.c1 / l3, a.c2 / l2, c3 / l3, -c4 / l2,         //
          a.c2 / l2, a.c5 / lambda, c4 / l2, a.c6 / lambda,  //
          c3 / l3, c4 / l2, -a.c1 / l3, -a.c2 / l2,          //
          -c4 / l2, a.c6 / lambda, -a.c2 / l2, a.c5 / lambda;
      return Eigen::Matrix4cd(turned.asDiagonal() * (r / a.c7) * turned.asDiagonal());
    };
    const Eigen::Matrix4cd free = free_matrix(detail::beam_elements({tool}, line).front());
    EXPECT_LT(misfit(table(a.c3, a.c4), free, tool.length_m), 1e-9) << frequency_hz;
    const std::complex<double> printed_c4 = std::cos(lambda * tool.length_m) * std::cosh(lambda * tool.length_m);
    EXPECT_GT(misfit(table(a.c3, printed_c4), free, tool.length_m), 0.01) << frequency_hz;
    EXPECT_GT(misfit(table(published(lambda * holder.length_m, ei).c3, a.c4), free, tool.length_m), 0.01);

    const PublishedFunctions b = published(lambda * holder.length_m, ei);
    const auto tip = [&](std::complex<double> coupling, std::complex<double> rotation) {
      Eigen::Matrix2cd r;
      r << -b.c1 / l3, -coupling / l2, -coupling / l2, rotation / lambda;
      return Eigen::Matrix2cd(r / b.c8);
    };
    const Eigen::Matrix2cd clamped = detail::beam_elements({holder}, line).front().clamped;
    EXPECT_LT(misfit(tip(b.c2, b.c5), clamped, holder.length_m), 1e-9) << frequency_hz;
    EXPECT_GT(misfit(tip(b.c1, b.c5), clamped, holder.length_m), 0.01) << frequency_hz;
  }
}

TEST(BeamElement, NothingOverflowsFarBeyondCosh) {
  for (const Beam beam : {Beam::euler_bernoulli, Beam::timoshenko}) {
    const Segment wire{.length_m = 3.0,
                       .diameter_m = 0.001,
                       .youngs_modulus_pa = 200e9,
                       .density_kg_per_m3 = 7800.0,
                       .loss_factor = 0.02,
                       .beam = beam};
    const BeamElement element =
        detail::beam_elements({wire}, Eigen::VectorXd::Constant(1, 50e3)).front();  // λL near 1500
    EXPECT_TRUE(element.clamped.allFinite() && element.carry.allFinite() && element.stiffness.allFinite());
    EXPECT_LT(element.clamped(0, 0).imag(), 0.0);
  }
}

/// u' = θ + V / κGA, θ' = M / EI, V' = -ρA ω² u, M' = -V - ρI ω² θ, by a matrix exponential.
Eigen::Matrix4cd transfer(const Segment& segment, double frequency_hz) {
  using std::numbers::pi;
  const double outer = segment.diameter_m, inner = segment.inner_diameter_m, nu = segment.poissons_ratio;
  const double area = pi / 4.0 * (outer * outer - inner * inner);
  const double second_moment = pi / 64.0 * (std::pow(outer, 4) - std::pow(inner, 4));
  const std::complex<double> e = segment.youngs_modulus_pa * std::complex<double>(1.0, segment.loss_factor);
  const std::complex<double> shear = detail::shear_coefficient(nu, inner / outer) * e / (2.0 * (1.0 + nu)) * area;
  const double omega2 = std::pow(2.0 * pi * frequency_hz, 2) * segment.density_kg_per_m3;
  // Lengths in L, forces in EI / L², so that the exponential is of numbers near 1.
  const double length = segment.length_m;
  const std::complex<double> ei = e * second_moment;
  Eigen::Matrix4cd a = Eigen::Matrix4cd::Zero();
  a(0, 1) = 1.0;
  a(0, 2) = ei / (shear * length * length);
  a(1, 3) = 1.0;
  a(2, 0) = -omega2 * area * std::pow(length, 4) / ei;
  a(3, 2) = -1.0;
  a(3, 1) = -omega2 * second_moment * length * length / ei;
  const Eigen::Matrix4cd grown = a.exp();
  Eigen::Vector4cd unit(length, 1.0, ei / (length * length), ei / length);
  return unit.asDiagonal() * grown * unit.cwiseInverse().asDiagonal();
}

/// x_1, f_1 = -(V, M)(0) and x_2, f_2 = (V, M)(L) from the transfer matrix.
BeamElement element_of(const Eigen::Matrix4cd& t) {
  const Eigen::Matrix2cd xx = t.topLeftCorner<2, 2>(), xf = t.topRightCorner<2, 2>();
  const Eigen::Matrix2cd fx = t.bottomLeftCorner<2, 2>(), ff = t.bottomRightCorner<2, 2>();
  BeamElement out;
  out.clamped = xx.inverse() * xf;    // 0 = xx x_1 - xf f_1
  out.carry = xx.inverse();           // x_2 = xx x_1
  out.stiffness = fx * xx.inverse();  // f_2 = fx x_1
  EXPECT_LT((ff - fx * xx.inverse() * xf - xx.inverse().transpose()).norm(), 1e-6 * ff.norm());
  return out;
}

TEST(BeamElement, TimoshenkoIsTheMatrixExponentialOfItsEquations) {
  Random random(3);
  for (int i = 0; i < 300; ++i) {
    Segment s = bar(random.uniform(0.002, 0.2), Beam::timoshenko);
    s.diameter_m = random.uniform(0.004, 0.1);
    if (i % 2 == 0) s.inner_diameter_m = s.diameter_m * random.uniform(0.0, 0.95);
    s.loss_factor = random.uniform(0.001, 0.3);
    s.poissons_ratio = random.uniform(0.0, 0.5);
    // Beyond the cut-on of the second wave too, which for 100 mm lies near 20 kHz.
    const double f = std::pow(10.0, random.uniform(1.0, 4.8));
    const detail::Section section = detail::section(s);
    const double waves = section.bending * std::pow(2.0 * std::numbers::pi * f, 2);
    if (waves > 300.0) continue;  // the transfer matrix itself loses its digits
    const BeamElement element = detail::beam_elements({s}, Eigen::VectorXd::Constant(1, f)).front();
    const BeamElement expected = element_of(transfer(s, f));
    EXPECT_LT(misfit(element.clamped, expected.clamped, s.length_m), 1e-9) << i;
    EXPECT_LT((element.carry - expected.carry).norm(), 1e-9 * expected.carry.norm()) << i;
    EXPECT_LT(misfit(element.stiffness, expected.stiffness, 1.0 / s.length_m), 1e-9) << i;
  }
}

TEST(BeamElement, PassesTheCutOnOfTheSecondWave) {
  // κGA = ρI ω²: one wave number is zero, and the same on both sides of it.
  Segment s = bar(0.05, Beam::timoshenko);
  s.diameter_m = 0.2;
  s.loss_factor = 0.0;
  const detail::Section section = detail::section(s);
  const double cut_on = std::sqrt(section.bending / (section.rotary * section.shear)) / (2.0 * std::numbers::pi);
  const Eigen::VectorXd f = cut_on * (Eigen::VectorXd(3) << 1.0 - 1e-9, 1.0, 1.0 + 1e-9).finished();
  const std::vector<BeamElement> around = detail::beam_elements({s}, f);
  for (const BeamElement& element : around) EXPECT_LT(misfit(element.clamped, around[0].clamped, s.length_m), 1e-6);
  EXPECT_LT(misfit(around[1].clamped, element_of(transfer(s, cut_on)).clamped, s.length_m), 1e-9);
}

TEST(BeamElement, IsTheSameHoweverItIsCut) {
  for (const Beam beam : {Beam::euler_bernoulli, Beam::timoshenko}) {
    const Eigen::VectorXd f = Eigen::VectorXd::LinSpaced(57, 0.5, 20e3);
    const std::vector<BeamElement> whole = detail::beam_elements({bar(0.15, beam)}, f);
    const std::vector<BeamElement> pieces =
        detail::beam_elements({bar(0.07, beam), bar(0.001, beam), bar(0.029, beam), bar(0.05, beam)}, f);
    for (std::size_t i = 0; i < whole.size(); ++i) {
      EXPECT_LT(misfit(pieces[i].clamped, whole[i].clamped, 0.15), 1e-10) << i;
      EXPECT_LT((pieces[i].carry - whole[i].carry).norm(), 1e-10 * whole[i].carry.norm()) << i;
      EXPECT_LT(misfit(pieces[i].stiffness, whole[i].stiffness, 1.0 / 0.15), 1e-10) << i;
    }
  }
}

TEST(BeamElement, OfAFreeBodyIsRigidAtLowFrequency) {
  const Segment s = bar(0.11892, Beam::timoshenko);
  const double f = 0.01;
  const BeamElement element = detail::beam_elements({s, s}, Eigen::VectorXd::Constant(1, f)).front();
  const double omega2 = std::pow(2.0 * std::numbers::pi * f, 2);
  const double length = 2.0 * s.length_m;
  const double mass = s.density_kg_per_m3 * std::numbers::pi / 4.0 * 0.012 * 0.012 * length;
  const double about_middle = mass * (length * length / 12.0 + 0.012 * 0.012 / 16.0);
  Eigen::Matrix2d inertia;  // about end 2, which moves by u and turns by θ: the middle moves by u - θ L / 2
  inertia << mass, -mass * length / 2.0, -mass * length / 2.0, about_middle + mass * length * length / 4.0;
  EXPECT_LT(misfit(element.stiffness / -omega2, inertia.cast<std::complex<double>>(), 1.0 / length), 1e-8);
}

TEST(BeamElement, IsPassive) {
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    Segment a = bar(random.uniform(0.01, 0.2), i % 2 == 0 ? Beam::timoshenko : Beam::euler_bernoulli);
    a.diameter_m = random.uniform(0.004, 0.06);
    a.loss_factor = random.uniform(1e-4, 0.1);
    Segment b = a;
    b.diameter_m = random.uniform(0.004, 0.06);
    const Eigen::VectorXd f = Eigen::VectorXd::Constant(1, std::pow(10.0, random.uniform(0.0, 4.3)));
    const Eigen::Matrix4cd r = free_matrix(detail::beam_elements({a, b}, f).front());
    const double reciprocity = (r - r.transpose()).norm();
    EXPECT_LT(reciprocity, 1e-9 * r.norm());
    Eigen::Vector4d unit(1.0, a.length_m, 1.0, a.length_m);
    const Eigen::Matrix4d loss = -(unit.asDiagonal() * r.imag() * unit.asDiagonal());
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> eigen(0.5 * (loss + loss.transpose()));
    EXPECT_GT(eigen.eigenvalues()(0), -1e-9 * (unit.asDiagonal() * r * unit.asDiagonal()).norm()) << i;
  }
}

TEST(BeamElement, HasTheSameBitsFromEveryKernel) {
  const Eigen::VectorXd f = Eigen::VectorXd::LinSpaced(61, 10.0, 15e3);
  const std::vector<Segment> segments = {bar(0.03, Beam::timoshenko), bar(0.3), bar(0.004)};
  const Kernels best = best_kernels();
  const std::vector<BeamElement> expected = detail::beam_elements(segments, f);
  for (const Kernels variant : {Kernels::baseline, Kernels::avx2, Kernels::avx512}) {
    if (variant > best) continue;
    kernels() = variant;
    const std::vector<BeamElement> found = detail::beam_elements(segments, f);
    kernels() = best;
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_TRUE(found[i].clamped == expected[i].clamped && found[i].carry == expected[i].carry &&
                  found[i].stiffness == expected[i].stiffness);
    }
  }
}

TEST(Section, ShearCoefficientIsHutchinsons) {
  // Solid: 6 (1 + ν)² / (7 + 12 ν + 4 ν²); a thin tube: (1 + ν) / (2 + ν). Source: [Hutchinson2001].
  EXPECT_NEAR(detail::shear_coefficient(0.3, 0.0), 6.0 * 1.69 / (7.0 + 3.6 + 0.36), 1e-15);
  EXPECT_NEAR(detail::shear_coefficient(0.3, 1.0), 1.3 / 2.3, 1e-15);
}

TEST(Section, TakesFlutesAsAThinnerRoundAndAWeightAsGiven) {
  Segment fluted = bar(0.05);
  fluted.flutes = 4;
  Segment thin = bar(0.05);
  thin.diameter_m *= 0.8;
  EXPECT_EQ(detail::section(fluted).bending_stiffness_n_m2, detail::section(thin).bending_stiffness_n_m2);
  EXPECT_EQ(detail::section(fluted).bending, detail::section(thin).bending);
  Segment weighed = bar(0.05);
  weighed.mass_kg = 2.0 * weighed.density_kg_per_m3 * std::numbers::pi / 4.0 * 0.012 * 0.012 * 0.05;
  EXPECT_NEAR(detail::section(weighed).bending, 2.0 * detail::section(bar(0.05)).bending, 1e-12);
}

TEST(Section, RejectsWhatIsNoBeam) {
  using robomill::test::field_of;
  const auto rejected = [](auto&& change) {
    Segment s = bar(0.1);
    change(s);
    return field_of([&] { s.validate(); });
  };
  EXPECT_EQ(rejected([](Segment& s) { s.length_m = 0.0; }), "length_m");
  EXPECT_EQ(rejected([](Segment& s) { s.length_m = -0.1; }), "length_m");
  EXPECT_EQ(rejected([](Segment& s) { s.diameter_m = std::nan(""); }), "diameter_m");
  EXPECT_EQ(rejected([](Segment& s) { s.inner_diameter_m = 0.012; }), "inner_diameter_m");
  EXPECT_EQ(rejected([](Segment& s) { s.youngs_modulus_pa = 0.0; }), "youngs_modulus_pa");
  EXPECT_EQ(rejected([](Segment& s) { s.density_kg_per_m3 = 0.0; }), "density_kg_per_m3");
  EXPECT_EQ(rejected([](Segment& s) { s.poissons_ratio = 0.6; }), "poissons_ratio");
  EXPECT_EQ(rejected([](Segment& s) { s.loss_factor = 2.0; }), "loss_factor");
  EXPECT_EQ(rejected([](Segment& s) { s.flutes = -1; }), "flutes");
}

}  // namespace beam_element_test
}  // namespace robomill::coupling
