#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <string>

#include "robomill/base/parallel.hpp"
#include "robomill/coupling/assembly.hpp"
#include "robomill/coupling/base.hpp"
#include "robomill/coupling/beam_element.hpp"
#include "testing/coupling/beams.hpp"
#include "testing/coupling/free_beam.hpp"
#include "testing/support.hpp"

namespace robomill::coupling {
namespace tip_test {

using modal::FrfSet;
using testing::bar;
using testing::bending_stiffness;
using testing::free_frfs;
using testing::hertz;
using testing::mass_per_length;
using testing::peak_hz;
using testing::published_pair;
using testing::receptance;
using testing::resonance_hz;

Eigen::VectorXcd tip_xx(const Assembly& assembly, const Eigen::VectorXd& f) {
  return receptance(tip_frfs(assembly, f).frfs, "xx");
}

double relative(const Eigen::VectorXcd& a, const Eigen::VectorXcd& b) {
  return ((a - b).cwiseAbs().array() / b.cwiseAbs().array()).maxCoeff();
}

Assembly clamped(const Segment& segment) {
  return {.tool = {segment}, .joint = {}, .holder = {}};
}

Segment undamped_bar(double length_m) {
  Segment segment = bar(length_m);
  segment.loss_factor = 1e-7;
  return segment;
}

TEST(Tip, PublishedBarHasItsFrequencies) {
  // Source: [JointIdentification], whose caption gives 3,821 Hz to the wrong beam: docs/errata.md. A mode of a beam
  // that hangs free stands on its mass line, so that Im H peaks at it and |H| does not.
  const Eigen::VectorXd f = Eigen::VectorXd::LinSpaced(49991, 1.0, 5000.0);
  EXPECT_NEAR(resonance_hz(f, tip_xx(clamped(bar(0.05090)), f)), 3281.0, 0.5);
  EXPECT_NEAR(resonance_hz(f, tip_xx(clamped(bar(0.16982)), f)), 294.7, 0.11);
  const Eigen::VectorXd above = Eigen::VectorXd::LinSpaced(30001, 2000.0, 5000.0);
  EXPECT_NEAR(resonance_hz(above, receptance(free_frfs({bar(0.11892)}, above), "1x:1x")), 3825.0, 0.5);
}

TEST(Tip, RigidPairIsTheWholeBeam) {
  const Eigen::VectorXd f = hertz(5000);
  EXPECT_LT(relative(tip_xx(published_pair(), f), tip_xx(clamped(bar(0.16982)), f)), 2e-10);  // asked for: 1e-8
}

TEST(Tip, BarOnARigidWallHasItsPeaks) {
  // d = 10 mm, L = 125 mm, η = 0.01, Euler–Bernoulli, on lines of 0.1 Hz: 453.4 Hz with 6.436716e-4 m/N, 2,841.4 Hz
  // with 1.639169e-5.
  Segment s = bar(0.125);
  s.diameter_m = 0.010;
  s.loss_factor = 0.01;
  const Eigen::VectorXd first = Eigen::VectorXd::LinSpaced(201, 440.0, 460.0);
  const Eigen::VectorXd second = Eigen::VectorXd::LinSpaced(501, 2820.0, 2870.0);
  const auto greatest = [](const Eigen::VectorXcd& h) { return h.cwiseAbs().maxCoeff(); };
  const Eigen::VectorXcd h1 = tip_xx(clamped(s), first);
  EXPECT_NEAR(peak_hz(first, h1), 453.4, 1e-6);
  EXPECT_NEAR(greatest(h1), 6.436716e-4, 5e-11);
  const Eigen::VectorXcd h2 = tip_xx(clamped(s), second);
  EXPECT_NEAR(peak_hz(second, h2), 2841.4, 1e-6);
  EXPECT_NEAR(greatest(h2), 1.639169e-5, 5e-12);
  // Timoshenko with ν = 0.29: 451.80 Hz, 6.455e-4 with the loss factor on both moduli.
  s.beam = Beam::timoshenko;
  s.poissons_ratio = 0.29;
  const Eigen::VectorXcd h3 = tip_xx(clamped(s), first);
  EXPECT_NEAR(peak_hz(first, h3), 451.80, 1e-6);
  EXPECT_NEAR(greatest(h3), 6.455e-4, 5e-8);
}

TEST(Tip, IsTheCouplingFormula) {
  // G11 = R11 - R12 (R22a + R22b + Kc⁻¹)⁻¹ R21, [SchmitzDonaldson2000], from free receptances.
  Assembly assembly = published_pair();
  assembly.tool = {bar(0.05, Beam::timoshenko), bar(0.06)};
  assembly.joint = Joint{.translational_stiffness_n_per_m = 2e7,
                         .translational_damping_n_s_per_m = 40.0,
                         .rotational_stiffness_n_m_per_rad = 5e4,
                         .rotational_damping_n_m_s_per_rad = 0.5,
                         .cross_stiffness_n_per_rad = 3e5};
  const Eigen::VectorXd f = hertz(6000, 50);
  const FrfSet tip = tip_frfs(assembly, f, {.rotations = true}).frfs;
  const FrfSet free = free_frfs(assembly.tool, f);
  const FrfSet holder = tip_frfs(clamped(bar(0.05090)), f, {.rotations = true}).frfs;
  const auto block = [&](const FrfSet& set, const std::string& row, const std::string& column, Eigen::Index i) {
    Eigen::Matrix2cd out;
    for (int r = 0; r < 2; ++r) {
      for (int c = 0; c < 2; ++c) {
        const std::string name = row + (r == 0 ? "x" : "ry") + ":" + column + (c == 0 ? "x" : "my");
        out(r, c) = receptance(set, name.c_str())(i);
      }
    }
    return out;
  };
  for (Eigen::Index i = 0; i < f.size(); ++i) {
    const Eigen::Matrix2cd sum =
        block(free, "2", "2", i) + block(holder, "", "", i) + detail::flexibility(*assembly.joint, f(i));
    const Eigen::Matrix2cd expected =
        block(free, "1", "1", i) - block(free, "1", "2", i) * sum.inverse() * block(free, "2", "1", i);
    EXPECT_LT((block(tip, "", "", i) - expected).norm(), 1e-9 * expected.norm()) << f(i);
  }
}

TEST(Tip, AStiffJointIsRigidWithoutDividingByInfinity) {
  const Eigen::VectorXd f = hertz(5000);
  const Eigen::VectorXcd rigid = tip_xx(published_pair(), f);
  Assembly stiff = published_pair();
  stiff.joint = Joint{.translational_stiffness_n_per_m = 1e16, .rotational_stiffness_n_m_per_rad = 1e14};
  EXPECT_LT(relative(tip_xx(stiff, f), rigid), 1e-6);
  // The difference falls with the stiffness.
  stiff.joint = Joint{.translational_stiffness_n_per_m = 1e18, .rotational_stiffness_n_m_per_rad = 1e16};
  EXPECT_LT(relative(tip_xx(stiff, f), rigid), 1e-8);
}

TEST(Tip, OfARoundToolIsTheSameInBothPlanesWithTheSignsOfTheFrame) {
  const FrfSet tip = tip_frfs(published_pair(), hertz(20), {.rotations = true}).frfs;
  EXPECT_EQ(receptance(tip, "xx"), receptance(tip, "yy"));
  EXPECT_EQ(receptance(tip, "ry:x"), Eigen::VectorXcd(-receptance(tip, "rx:y")));
  EXPECT_EQ(receptance(tip, "x:my"), Eigen::VectorXcd(-receptance(tip, "y:mx")));
  EXPECT_EQ(receptance(tip, "ry:my"), receptance(tip, "rx:mx"));
  // A push at the tip turns the tip back: θ = ∂u/∂z < 0, z towards the spindle.
  EXPECT_LT(receptance(tip, "ry:x")(0).real(), 0.0);
  EXPECT_EQ(tip.find(modal::parse_frf_name("xy")), nullptr);
}

/// A holder of its own in each of two directions, turned by an angle about z: sixteen FRFs.
FrfSet turned_holder(double angle, const Eigen::VectorXd& f) {
  const std::vector<detail::BeamElement> soft = detail::beam_elements({bar(0.3)}, f);
  const std::vector<detail::BeamElement> stiff = detail::beam_elements({bar(0.05)}, f);
  Eigen::Matrix4d turn = Eigen::Matrix4d::Zero();  // (u_x, θ_x, u_y, θ_y): slopes turn as displacements do
  turn.topLeftCorner<2, 2>() = turn.bottomRightCorner<2, 2>() = std::cos(angle) * Eigen::Matrix2d::Identity();
  turn.topRightCorner<2, 2>() = -std::sin(angle) * Eigen::Matrix2d::Identity();
  turn.bottomLeftCorner<2, 2>() = std::sin(angle) * Eigen::Matrix2d::Identity();
  FrfSet set{.frequency_hz = f, .frfs = {}};
  const std::array<modal::Axis, 2> planes = {modal::Axis::x, modal::Axis::y};
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      const modal::Axis plane = planes.at(static_cast<std::size_t>(row / 2));
      const modal::Axis load = planes.at(static_cast<std::size_t>(column / 2));
      modal::Frf frf;
      frf.name = detail::element_name(plane, row % 2, load, column % 2);
      frf.receptance.resize(f.size());
      for (Eigen::Index i = 0; i < f.size(); ++i) {
        Eigen::Matrix4cd b = Eigen::Matrix4cd::Zero();
        b.topLeftCorner<2, 2>() = soft[static_cast<std::size_t>(i)].clamped;
        b.bottomRightCorner<2, 2>() = stiff[static_cast<std::size_t>(i)].clamped;
        const Eigen::Matrix4cd seen = turn * b * turn.transpose();
        frf.receptance(i) = detail::element_sign(plane, row % 2, load, column % 2) * seen(row, column);
      }
      set.frfs.push_back(frf);
    }
  }
  return set;
}

TEST(Tip, OfAHolderThatDiffersByDirectionTurnsWithIt) {
  const Eigen::VectorXd f = hertz(3000, 100);
  Assembly assembly = published_pair();
  assembly.joint = Joint{.translational_stiffness_n_per_m = 2e7, .rotational_stiffness_n_m_per_rad = 5e4};
  assembly.holder = {.segments = {}, .receptances = turned_holder(0.0, f)};
  const FrfSet straight = tip_frfs(assembly, f).frfs;
  const double angle = 0.4;
  assembly.holder.receptances = turned_holder(angle, f);
  const FrfSet turned = tip_frfs(assembly, f).frfs;
  const double c = std::cos(angle), s = std::sin(angle);
  const Eigen::VectorXcd& a = receptance(straight, "xx");
  const Eigen::VectorXcd& b = receptance(straight, "yy");
  EXPECT_LT((receptance(turned, "xx") - (c * c * a + s * s * b)).norm(), 1e-10 * a.norm());
  EXPECT_LT((receptance(turned, "xy") - c * s * (a - b)).norm(), 1e-10 * a.norm());
  EXPECT_LT((receptance(turned, "xy") - receptance(turned, "yx")).norm(), 1e-10 * a.norm());
  EXPECT_LT((receptance(straight, "xy")).norm(), 1e-12 * a.norm());
  // The soft direction alone is the plane's own coupling.
  Assembly soft = assembly;
  soft.holder = {.segments = {bar(0.3)}, .receptances = {}};
  EXPECT_LT((a - tip_xx(soft, f)).norm(), 1e-10 * a.norm());
}

TEST(Tip, OfAMeasuredHolderIsThatOfItsSegments) {
  const Eigen::VectorXd f = hertz(5000);
  Assembly assembly = published_pair();
  const Eigen::VectorXcd expected = tip_xx(assembly, f);
  FrfSet measured = tip_frfs(clamped(bar(0.05090)), f, {.rotations = true}).frfs;
  assembly.holder = {.segments = {}, .receptances = measured};
  EXPECT_LT(relative(tip_xx(assembly, f), expected), 1e-10);
  // One plane is enough, and of x:my and ry:x one.
  std::erase_if(measured.frfs, [](const modal::Frf& frf) {
    const std::string name = modal::to_string(frf.name);
    return name.find('y') == 0 || name.find("rx") == 0 || name == "x:my";
  });
  EXPECT_EQ(measured.frfs.size(), 3U);
  assembly.holder.receptances = measured;
  EXPECT_LT(relative(tip_xx(assembly, f), expected), 1e-10);
  // A part of its lines will do.
  const Eigen::VectorXd part = Eigen::VectorXd::LinSpaced(50, 100.0, 590.0);
  EXPECT_LT(relative(tip_xx(assembly, part), tip_xx(published_pair(), part)), 1e-10);
}

TEST(Tip, ADistributedJointOfTwoPointsIsTheirCoupling) {
  // A shank on two springs to a rigid holder, put together by hand.
  const Eigen::VectorXd f = hertz(3000, 10);
  Assembly assembly = clamped(bar(0.1));
  assembly.joint = Joint{.translational_stiffness_n_per_m = 3e7,
                         .translational_damping_n_s_per_m = 10.0,
                         .rotational_stiffness_n_m_per_rad = 2e4,
                         .points = 2,
                         .insertion_length_m = 0.03,
                         .shank = {bar(0.03)}};
  const Eigen::VectorXcd found = tip_xx(assembly, f);
  const std::vector<detail::BeamElement> tool = detail::beam_elements(assembly.tool, f);
  const std::vector<detail::BeamElement> shank = detail::beam_elements({bar(0.03)}, f);
  for (Eigen::Index i = 0; i < f.size(); ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    const Eigen::Matrix2cd point = 2.0 * detail::flexibility(*assembly.joint, f(i));
    const Eigen::Matrix2cd deep = detail::on_base<2>(shank[k], point);
    const Eigen::Matrix2cd mouth = (deep.inverse() + point.inverse()).inverse();
    const std::complex<double> expected = detail::on_base<2>(tool[k], mouth)(0, 0);
    EXPECT_LT(std::abs(found(i) - expected), 1e-9 * std::abs(expected)) << f(i);
  }
}

TEST(Tip, AShankGluedIntoItsHolderIsOneBeamOfBoth) {
  // Beams of one wave number, joined rigidly along their length, are one with the sum of EI and ρA.
  const Eigen::VectorXd f = hertz(4000, 10);
  Assembly assembly = clamped(bar(0.08));
  assembly.joint = Joint{.translational_stiffness_n_per_m = 1e17,
                         .rotational_stiffness_n_m_per_rad = 1e15,
                         .points = 5,
                         .insertion_length_m = 0.04,
                         .shank = {bar(0.04)}};
  assembly.holder = {.segments = {bar(0.025), bar(0.05)}, .receptances = {}};
  Segment both = bar(0.04);
  both.youngs_modulus_pa *= 2.0;
  both.density_kg_per_m3 *= 2.0;
  const Assembly whole{.tool = {bar(0.08), both, bar(0.035)}, .joint = {}, .holder = {}};
  EXPECT_LT(relative(tip_xx(assembly, f), tip_xx(whole, f)), 1e-6);
}

TEST(Tip, ADistributedJointConvergesWithItsPoints) {
  Segment holder = bar(0.05, Beam::timoshenko);
  holder.diameter_m = 0.040;
  Assembly assembly = clamped(bar(0.1, Beam::timoshenko));
  assembly.holder.segments = {holder};
  const Eigen::VectorXd f = Eigen::VectorXd::LinSpaced(101, 4150.0, 4250.0);
  const auto with_points = [&](int points) {
    assembly.joint = Joint{.translational_stiffness_n_per_m = 2e7,
                           .rotational_stiffness_n_m_per_rad = 5e4,
                           .points = points,
                           .insertion_length_m = 0.03,
                           .shank = {bar(0.03, Beam::timoshenko)}};
    return tip_xx(assembly, f);
  };
  const Eigen::VectorXcd most = with_points(100);
  // A row of springs comes to a bed of them with the first power of the spacing.
  const double coarse = relative(with_points(13), most);
  const double fine = relative(with_points(25), most);
  EXPECT_LT(fine, 0.65 * coarse);
  EXPECT_LT(fine, 0.01);
  // And is as smooth as the curve itself.
  double scatter = 0.0;
  for (Eigen::Index i = 1; i + 1 < f.size(); ++i) {
    scatter = std::max(scatter, std::abs(most(i) - 0.5 * (most(i - 1) + most(i + 1))) / std::abs(most(i)));
  }
  EXPECT_LT(scatter, 1e-6);
}

TEST(Tip, ADistributedJointInAMeasuredHolderMovesWithItsMouth) {
  const Eigen::VectorXd f = hertz(2000, 10);
  Assembly assembly = clamped(bar(0.08));
  assembly.joint = Joint{.translational_stiffness_n_per_m = 1e17,
                         .rotational_stiffness_n_m_per_rad = 1e15,
                         .points = 4,
                         .insertion_length_m = 0.03,
                         .shank = {bar(0.03)}};
  // A shank of hardly any mass, glued rigidly into a rigid sleeve, changes nothing.
  assembly.joint->shank[0].density_kg_per_m3 = 1e-6;
  const FrfSet mouth = tip_frfs(clamped(bar(0.05)), f, {.rotations = true}).frfs;
  assembly.holder.receptances = mouth;
  Assembly plain = assembly;
  plain.joint.reset();
  EXPECT_LT(relative(tip_xx(assembly, f), tip_xx(plain, f)), 1e-6);
}

/// The first root of 1 + cos x cosh x + μ x (cos x sinh x - sin x cosh x): a clamped beam with μ of its mass at its
/// end.
double clamped_root(double mass_ratio) {
  const auto f = [mass_ratio](double x) {
    return 1.0 + std::cos(x) * std::cosh(x) +
           mass_ratio * x * (std::cos(x) * std::sinh(x) - std::sin(x) * std::cosh(x));
  };
  double low = 1.0;
  double high = 2.2;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (f(low) * f(middle) <= 0.0 ? high : low) = middle;
  }
  return low;
}

TEST(Tip, OfABarWithAnAccelerometerHasTheFrequencyOfItsEquation) {
  const Segment s = undamped_bar(0.16982);
  for (const double mass_kg : {0.0, 0.001, 0.0031, 0.0056, 0.15}) {
    const double x = clamped_root(mass_kg / (mass_per_length(s) * s.length_m));
    const double expected_hz = x * x * std::sqrt(bending_stiffness(s) / mass_per_length(s)) /
                               (2.0 * std::numbers::pi * s.length_m * s.length_m);
    Assembly assembly = clamped(s);
    assembly.accelerometer.mass_kg = mass_kg;
    const Eigen::VectorXd f = expected_hz + Eigen::ArrayXd::LinSpaced(2001, -0.01, 0.01);
    EXPECT_NEAR(resonance_hz(f, tip_xx(assembly, f)), expected_hz, 2e-5) << mass_kg;
  }
}

// A point mass beyond the tip is a short massless rigid bar with a heavy end.
TEST(Tip, AnAccelerometersOffsetIsALeverAtTheTip) {
  const Eigen::VectorXd f = hertz(3000, 10);
  Assembly offset = published_pair();
  offset.accelerometer = {.mass_kg = 0.0056, .offset_m = 0.004};
  Assembly lever = published_pair();
  Segment link = bar(0.004);
  link.youngs_modulus_pa = 1e18;
  link.density_kg_per_m3 = 1e-6;
  link.loss_factor = 0.0;
  lever.tool.insert(lever.tool.begin(), link);
  lever.accelerometer = {.mass_kg = 0.0056};
  const FrfSet at_end = tip_frfs(lever, f, {.rotations = true}).frfs;
  const FrfSet at_tip = tip_frfs(offset, f, {.rotations = true}).frfs;
  // The tip moves by u + e θ of the lever's end, for a force there as for f and e f of moment at its end.
  const double e = 0.004;
  const Eigen::VectorXcd moved = receptance(at_end, "xx") +
                                 e * (receptance(at_end, "x:my") + receptance(at_end, "ry:x")) +
                                 e * e * receptance(at_end, "ry:my");
  EXPECT_LT(relative(moved, receptance(at_tip, "xx")), 2e-6);
  EXPECT_LT(relative(receptance(at_end, "ry:my"), receptance(at_tip, "ry:my")), 2e-6);
}

// Source: [BishopJohnson1960], the free-free beam: u_1/f_1 = -c1 / (λ³ EI (cos cosh - 1)).
TEST(Tip, OfAFreeToolIsTheClosedFormOfAFreeBeam) {
  using Complex = std::complex<double>;
  const Segment s = bar(0.16982);
  Assembly assembly = clamped(s);
  assembly.holder.free = true;
  const Eigen::VectorXd f = hertz(20000, 50);
  const FrfSet tip = tip_frfs(assembly, f, {.rotations = true}).frfs;
  const Complex stiffness = bending_stiffness(s) * Complex(1.0, s.loss_factor);
  for (Eigen::Index i = 0; i < f.size(); i += 7) {
    const double omega = 2.0 * std::numbers::pi * f(i);
    const Complex wave = std::pow(omega * omega * mass_per_length(s) / stiffness, 0.25);
    const Complex x = wave * s.length_m;
    const Complex c1 = std::cos(x) * std::sinh(x) - std::sin(x) * std::cosh(x);
    const Complex c2 = std::sin(x) * std::sinh(x);
    const Complex c5 = std::cos(x) * std::sinh(x) + std::sin(x) * std::cosh(x);
    const Complex c7 = stiffness * (std::cos(x) * std::cosh(x) - 1.0);
    const Complex h = -c1 / (wave * wave * wave * c7);
    // The closed form loses (λL)⁻⁴ of its digits for long waves.
    const double digits = 2e-11 * (1.0 + std::pow(std::abs(x), -4.0));
    EXPECT_LT(std::abs(receptance(tip, "xx")(i) - h), digits * std::abs(h)) << f(i);
    const Complex n = c2 / (wave * wave * c7);
    EXPECT_LT(std::abs(std::abs(receptance(tip, "ry:x")(i)) - std::abs(n)), digits * std::abs(n)) << f(i);
    const Complex p = c5 / (wave * c7);
    EXPECT_LT(std::abs(receptance(tip, "ry:my")(i) - p), digits * std::abs(p)) << f(i);
  }
  EXPECT_EQ(receptance(tip, "xx"), receptance(tip, "yy"));
}

// Far below the first mode a free tool is a rigid body: u_1/f_1 = -4 / (m ω²), and with a mass on the tip Newton's.
TEST(Tip, OfAFreeToolIsARigidBodyAtLowFrequencies) {
  const Segment s = bar(0.16982);
  Assembly assembly = clamped(s);
  assembly.holder.free = true;
  const Eigen::VectorXd f = Eigen::VectorXd::Constant(1, 1e-3);
  const double omega2 = std::pow(2.0 * std::numbers::pi * f(0), 2);
  const double mass_kg = mass_per_length(s) * s.length_m;
  EXPECT_NEAR(tip_xx(assembly, f)(0).real(), -4.0 / (mass_kg * omega2), 1e-9 / (mass_kg * omega2));
  assembly.accelerometer.mass_kg = 0.02;
  EXPECT_NEAR(tip_xx(assembly, f)(0).real(), -1.0 / ((0.25 * mass_kg + 0.02) * omega2), 1e-9 / (mass_kg * omega2));
}

// The limit of ever softer joints, without singular numbers.
TEST(Tip, OfAFreeToolIsThatOfASoftJoint) {
  const Eigen::VectorXd f = hertz(5000, 100);
  Assembly assembly = clamped(bar(0.11892));
  assembly.joint = Joint{.translational_stiffness_n_per_m = 1e-3, .rotational_stiffness_n_m_per_rad = 1e-6};
  const Eigen::VectorXcd soft = tip_xx(assembly, f);
  assembly.joint.reset();
  assembly.holder.free = true;
  EXPECT_LT(relative(soft, tip_xx(assembly, f)), 1e-7);
}

TEST(Tip, DoesNotDependOnTheNumberOfThreads) {
  Assembly assembly = published_pair();
  assembly.tool = {bar(0.05, Beam::timoshenko), bar(0.06)};
  const Eigen::VectorXd f = hertz(3001);
  set_thread_count(1);
  const Eigen::VectorXcd one = tip_xx(assembly, f);
  for (const int threads : {2, 8}) {
    set_thread_count(threads);
    EXPECT_EQ(tip_xx(assembly, f), one);
  }
  set_thread_count(0);
}

TEST(Tip, SuspectsReceptancesThatCreateEnergy) {
  const Eigen::VectorXd f = hertz(1000, 10);
  FrfSet measured = tip_frfs(clamped(bar(0.05090)), f, {.rotations = true}).frfs;
  Assembly assembly = published_pair();
  for (modal::Frf& frf : measured.frfs) {
    if (modal::to_string(frf.name) != "xx") continue;
    frf.receptance(300) = std::conj(frf.receptance(300));
    frf.deviation = Eigen::VectorXd::Constant(f.size(), 1e-3 * std::abs(frf.receptance(300).imag()));
  }
  assembly.holder = {.segments = {}, .receptances = measured};
  const TipResult result = tip_frfs(assembly, f);
  ASSERT_EQ(result.suspect_hz.size(), 1U);
  EXPECT_EQ(result.suspect_hz[0], f(300));
  EXPECT_EQ(result.notes.size(), 1U);
  for (modal::Frf& frf : assembly.holder.receptances.frfs) frf.receptance = -frf.receptance;
  EXPECT_NE(robomill::test::rejection([&] { static_cast<void>(tip_frfs(assembly, f)); }).find("create energy"),
            std::string::npos);
}

TEST(Tip, RejectsWhatItCannotCouple) {
  using robomill::test::rejection;
  const Eigen::VectorXd f = hertz(100);
  const auto message = [&](const Assembly& assembly, const Eigen::VectorXd& lines) {
    return rejection([&] { static_cast<void>(tip_frfs(assembly, lines)); });
  };
  Assembly assembly = published_pair();
  assembly.tool.push_back(bar(-0.1));
  EXPECT_NE(message(assembly, f).find("tool[2].length_m = -0.1 m; must be > 0"), std::string::npos);
  assembly = published_pair();
  assembly.tool.clear();
  EXPECT_NE(message(assembly, f).find("tool"), std::string::npos);
  assembly = published_pair();
  assembly.holder.free = true;
  EXPECT_NE(message(assembly, f).find("holder.free: must not be true beside segments"), std::string::npos)
      << message(assembly, f);
  assembly.holder.segments.clear();
  assembly.joint = Joint{.translational_stiffness_n_per_m = 1.0, .rotational_stiffness_n_m_per_rad = 1.0};
  EXPECT_NE(message(assembly, f).find("holder.free: must not be true beside a joint"), std::string::npos);
  assembly = published_pair();
  assembly.accelerometer.mass_kg = -1.0;
  EXPECT_NE(message(assembly, f).find("accelerometer.mass_kg = -1 kg; must be >= 0"), std::string::npos);
  assembly.accelerometer.mass_kg = std::numeric_limits<double>::infinity();
  EXPECT_NE(message(assembly, f).find("accelerometer.mass_kg"), std::string::npos);
  assembly.accelerometer.mass_kg = 3.1;
  EXPECT_NE(message(assembly, f).find("accelerometer.mass_kg = 3.1 kg; must be <= 1"), std::string::npos)
      << message(assembly, f);
  assembly = published_pair();
  assembly.joint = Joint{.translational_stiffness_n_per_m = -1.0, .rotational_stiffness_n_m_per_rad = 1.0};
  EXPECT_NE(message(assembly, f).find("joint.translational_stiffness_n_per_m = -1"), std::string::npos);
  assembly.joint = Joint{.translational_stiffness_n_per_m = 1.0,
                         .rotational_stiffness_n_m_per_rad = 1.0,
                         .cross_stiffness_n_per_rad = 2.0};
  EXPECT_NE(message(assembly, f).find("joint.cross_stiffness_n_per_rad"), std::string::npos);
  EXPECT_NE(message(published_pair(), Eigen::VectorXd::LinSpaced(3, 0.0, 2.0)).find("frequency_hz = 0 Hz"),
            std::string::npos);
  // Of measured holders.
  FrfSet measured = tip_frfs(clamped(bar(0.05090)), hertz(200, 2), {.rotations = true}).frfs;
  assembly = published_pair();
  assembly.holder = {.segments = {}, .receptances = measured};
  EXPECT_NE(message(assembly, f).find("must lie in the range of the measured holder, 2 to 200 Hz"), std::string::npos);
  EXPECT_NE(message(assembly, Eigen::VectorXd::LinSpaced(3, 5.0, 6.0)).find("its step is 1 Hz, the step asked for 0.5"),
            std::string::npos);
  std::erase_if(assembly.holder.receptances.frfs,
                [](const modal::Frf& frf) { return static_cast<int>(frf.name.response.axis) > 3; });
  std::erase_if(assembly.holder.receptances.frfs,
                [](const modal::Frf& frf) { return static_cast<int>(frf.name.excitation.axis) > 3; });
  EXPECT_NE(message(assembly, hertz(50, 10)).find("lack x:my, ry:x, ry:my"), std::string::npos);
  assembly = published_pair();
  assembly.holder.receptances = measured;
  EXPECT_NE(message(assembly, hertz(50, 10)).find("not both"), std::string::npos);
}

}  // namespace tip_test
}  // namespace robomill::coupling
