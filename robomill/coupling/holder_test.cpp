#include "robomill/coupling/holder.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>

#include "robomill/base/random.hpp"
#include "robomill/coupling/base.hpp"
#include "robomill/coupling/beam_element.hpp"
#include "robomill/coupling/section.hpp"
#include "testing/coupling/beams.hpp"
#include "testing/support.hpp"

namespace robomill::coupling {
namespace holder_test {

using modal::FrfSet;
using robomill::test::rejection;
using testing::bar;
using testing::hertz;
using testing::receptance;

/// A holder with a nose: 40 mm for 30 mm, then 63 mm for 80 mm, on a wall.
std::vector<Segment> nose(Beam beam = Beam::timoshenko) {
  Segment front = bar(0.03, beam);
  front.diameter_m = 0.040;
  Segment back = bar(0.08, beam);
  back.diameter_m = 0.063;
  return {front, back};
}

/// Translations at the free end and at a distance from it of segments that stand on a base, by the beam element of each
/// part.
FrfSet two_points(const std::vector<Segment>& front, const std::vector<Segment>& back,
                  const std::vector<Eigen::Matrix2cd>& base, const Eigen::VectorXd& f) {
  const std::vector<detail::BeamElement> a = detail::beam_elements(front, f);
  const std::vector<detail::BeamElement> b = detail::beam_elements(back, f);
  FrfSet set{.frequency_hz = f, .frfs = {}};
  for (const char* name : {"1x:1x", "2x:1x", "2x:2x"}) {
    set.frfs.push_back({.name = modal::parse_frf_name(name), .receptance = Eigen::VectorXcd(f.size())});
  }
  for (Eigen::Index i = 0; i < f.size(); ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    const Eigen::Matrix2cd under = detail::on_base<2>(b[k], base[k]);
    const Eigen::Matrix2cd at2 = (under.inverse() + a[k].stiffness).inverse();
    const Eigen::Matrix2cd at1 = detail::on_base<2>(a[k], under);
    set.frfs[0].receptance(i) = at1(0, 0);
    set.frfs[1].receptance(i) = (a[k].carry * at2)(0, 0);
    set.frfs[2].receptance(i) = at2(0, 0);
  }
  return set;
}

Joint collet() {
  return {.translational_stiffness_n_per_m = 5e7,
          .translational_damping_n_s_per_m = 60.0,
          .rotational_stiffness_n_m_per_rad = 8e4,
          .rotational_damping_n_m_s_per_rad = 1.0};
}

/// What tools stand on: the nose through the collet.
std::vector<Eigen::Matrix2cd> true_base(const Eigen::VectorXd& f) {
  std::vector<Eigen::Matrix2cd> base = detail::base_receptances({.segments = nose(), .receptances = {}}, f).x;
  for (Eigen::Index i = 0; i < f.size(); ++i) base[static_cast<std::size_t>(i)] += detail::flexibility(collet(), f(i));
  return base;
}

Eigen::VectorXcd entry(const std::vector<Eigen::Matrix2cd>& base, int row, int column_) {
  Eigen::VectorXcd out(static_cast<Eigen::Index>(base.size()));
  for (std::size_t i = 0; i < base.size(); ++i) out(static_cast<Eigen::Index>(i)) = base[i](row, column_);
  return out;
}

double relative(const Eigen::VectorXcd& a, const Eigen::VectorXcd& b) {
  return (a - b).norm() / b.norm();
}

TEST(RemoveArtefact, GivesBackWhatItStoodOn) {
  const Eigen::VectorXd f = hertz(5000, 20);
  const std::vector<Eigen::Matrix2cd> base = true_base(f);
  const FrfSet measured = two_points({bar(0.03)}, {bar(0.05)}, base, f);
  const HolderResult found = remove_artefact(measured, {0.0, 0.03}, {bar(0.08)}, {.regularisation = 0.0});
  EXPECT_LT(relative(receptance(found.receptances, "xx"), entry(base, 0, 0)), 1e-9);
  EXPECT_LT(relative(receptance(found.receptances, "x:my"), entry(base, 0, 1)), 1e-9);
  EXPECT_LT(relative(receptance(found.receptances, "ry:x"), entry(base, 1, 0)), 1e-9);
  EXPECT_LT(relative(receptance(found.receptances, "ry:my"), entry(base, 1, 1)), 1e-9);
  // Another tool on it is as if coupled to the true holder.
  Segment cutter = bar(0.09, Beam::timoshenko);
  cutter.diameter_m = 0.016;
  const Assembly direct{.tool = {cutter}, .joint = collet(), .holder = {.segments = nose(), .receptances = {}}};
  const Assembly through{.tool = {cutter}, .joint = {}, .holder = {.segments = {}, .receptances = found.receptances}};
  EXPECT_LT(relative(receptance(tip_frfs(through, f).frfs, "xx"), receptance(tip_frfs(direct, f).frfs, "xx")), 1e-9);
}

TEST(RemoveArtefact, TakesRotationsInPlaceOfASecondPoint) {
  const Eigen::VectorXd f = hertz(3000, 20);
  const Assembly assembly{.tool = {bar(0.08)}, .joint = collet(), .holder = {.segments = nose(), .receptances = {}}};
  FrfSet measured = tip_frfs(assembly, f, {.rotations = true}).frfs;
  for (modal::Frf& frf : measured.frfs) frf.name.response.point = frf.name.excitation.point = 1;
  const HolderResult found = remove_artefact(measured, {0.0}, {bar(0.08)}, {.regularisation = 0.0});
  const std::vector<Eigen::Matrix2cd> base = true_base(f);
  for (const char* name : {"xx", "yy"}) {
    EXPECT_LT(relative(receptance(found.receptances, name), entry(base, 0, 0)), 1e-8);
  }
  EXPECT_LT(relative(receptance(found.receptances, "y:mx"), -entry(base, 0, 1)), 1e-8);
  EXPECT_LT(relative(receptance(found.receptances, "rx:mx"), entry(base, 1, 1)), 1e-8);
}

/// A plain cylinder as stout as what it stands on.
Segment stout(double length_m) {
  Segment out = bar(length_m, Beam::timoshenko);
  out.diameter_m = 0.030;
  return out;
}

TEST(RemoveArtefact, SaysHowMuchOfTheNoiseComesThrough) {
  // The scatter of many noisy measurements is the amplification times their noise.
  const Eigen::VectorXd f = Eigen::VectorXd::LinSpaced(40, 100.0, 4000.0);
  const std::vector<Eigen::Matrix2cd> base = true_base(f);
  const FrfSet clean = two_points({stout(0.03)}, {stout(0.03)}, base, f);
  constexpr double noise = 1e-5;
  constexpr int samples = 200;
  Eigen::VectorXd power = Eigen::VectorXd::Zero(f.size());
  Eigen::VectorXd amplification;
  for (int s = 0; s < samples; ++s) {
    Random random(7, static_cast<std::uint64_t>(s));
    FrfSet noisy = clean;
    for (modal::Frf& frf : noisy.frfs) {
      for (std::complex<double>& h : frf.receptance) {
        h += noise * std::abs(h) * std::sqrt(0.5) * std::complex<double>(random.normal(), random.normal());
      }
    }
    const HolderResult found = remove_artefact(noisy, {0.0, 0.03}, {stout(0.06)}, {.regularisation = 0.0});
    amplification = found.amplification;
    constexpr double length = 0.06;
    const Eigen::VectorXcd h = receptance(found.receptances, "xx") - entry(base, 0, 0);
    const Eigen::VectorXcd l = (receptance(found.receptances, "x:my") - entry(base, 0, 1)) * length;
    const Eigen::VectorXcd p = (receptance(found.receptances, "ry:my") - entry(base, 1, 1)) * length * length;
    for (Eigen::Index i = 0; i < f.size(); ++i) {
      Eigen::Matrix2cd size = base[static_cast<std::size_t>(i)];
      size.row(1) *= length;
      size.col(1) *= length;
      power(i) += (std::norm(h(i)) + 2.0 * std::norm(l(i)) + std::norm(p(i))) / size.squaredNorm() / samples;
    }
  }
  for (Eigen::Index i = 0; i < f.size(); ++i) {
    EXPECT_NEAR(std::sqrt(power(i)) / noise, amplification(i), 0.25 * amplification(i)) << f(i);
  }
}

TEST(RemoveArtefact, MarksWhereItCannotBeReliedOn) {
  const Eigen::VectorXd f = hertz(5000, 20);
  const FrfSet measured = two_points({stout(0.03)}, {stout(0.03)}, true_base(f), f);
  const HolderResult strict = remove_artefact(measured, {0.0, 0.03}, {stout(0.06)}, {.max_amplification = 20.0});
  const HolderResult loose = remove_artefact(measured, {0.0, 0.03}, {stout(0.06)}, {.max_amplification = 1e6});
  EXPECT_GT(strict.unreliable_hz.size(), 0U);
  EXPECT_LT(strict.unreliable_hz.size(), static_cast<std::size_t>(f.size()));
  EXPECT_EQ(strict.notes.size(), 1U);
  EXPECT_TRUE(loose.unreliable_hz.empty() && loose.notes.empty());
}

TEST(RemoveArtefact, IsOnlyAsBiasedAsItsRegularisation) {
  const Eigen::VectorXd f = hertz(4000, 100);
  const std::vector<Eigen::Matrix2cd> base = true_base(f);
  const FrfSet measured = two_points({stout(0.03)}, {stout(0.03)}, base, f);
  const HolderResult found = remove_artefact(measured, {0.0, 0.03}, {stout(0.06)});
  EXPECT_LT(relative(receptance(found.receptances, "xx"), entry(base, 0, 0)), 2e-5);
  EXPECT_LT(relative(receptance(found.receptances, "ry:my"), entry(base, 1, 1)), 2e-5);
}

/// Translations at the mouth of the nose and 15 and 30 mm above it.
FrfSet nose_translations(const Eigen::VectorXd& f, double spacing_m, Beam beam = Beam::euler_bernoulli) {
  const std::vector<Eigen::Matrix2cd> wall(static_cast<std::size_t>(f.size()), Eigen::Matrix2cd::Zero());
  const auto cut = [&](double from) {
    std::vector<Segment> front = {nose(beam)[0]}, back = nose(beam);
    front[0].length_m = from;
    back[0].length_m -= from;
    if (back[0].length_m < 1e-9) back.erase(back.begin());
    return two_points(front, back, wall, f);
  };
  FrfSet set = cut(spacing_m);
  FrfSet far = cut(2.0 * spacing_m);
  far.frfs[1].name = modal::parse_frf_name("3x:1x");
  far.frfs[2].name = modal::parse_frf_name("3x:3x");
  set.frfs.push_back(far.frfs[1]);
  set.frfs.push_back(far.frfs[2]);
  // 3x:2x: the piece between carries point 3's motion to point 2.
  Segment first = nose(beam)[0], second = nose(beam)[0];
  first.length_m = second.length_m = spacing_m;
  const std::vector<detail::BeamElement> hanging = detail::beam_elements({first}, f);
  const std::vector<detail::BeamElement> between = detail::beam_elements({second}, f);
  std::vector<Segment> rest = nose(beam);
  rest[0].length_m -= 2.0 * spacing_m;
  if (rest[0].length_m < 1e-9) rest.erase(rest.begin());
  const std::vector<detail::BeamElement> under = detail::beam_elements(rest, f);
  const std::vector<detail::BeamElement> whole = detail::beam_elements({first, second}, f);
  modal::Frf frf{.name = modal::parse_frf_name("3x:2x"), .receptance = Eigen::VectorXcd(f.size())};
  for (Eigen::Index i = 0; i < f.size(); ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    const Eigen::Matrix2cd at3 = (under[k].clamped.inverse() + whole[k].stiffness).inverse();
    const Eigen::Matrix2cd carry =
        (Eigen::Matrix2cd::Identity() + between[k].clamped * hanging[k].stiffness).inverse() * between[k].carry;
    frf.receptance(i) = (carry * at3)(0, 0);
  }
  set.frfs.push_back(frf);
  return set;
}

TEST(CompleteRotations, HasTheErrorOfItsOrder) {
  const Eigen::VectorXd f = hertz(3000, 50);
  const std::vector<Eigen::Matrix2cd> base =
      detail::base_receptances({.segments = nose(Beam::euler_bernoulli), .receptances = {}}, f).x;
  const auto error = [&](double spacing, bool three, const char* name, int row, int column_) {
    FrfSet measured = nose_translations(f, spacing);
    std::vector<double> positions = {0.0, spacing, 2.0 * spacing};
    if (!three) {
      positions.pop_back();
      std::erase_if(measured.frfs, [](const modal::Frf& frf) { return frf.name.response.point == 3; });
    }
    const HolderResult found = complete_rotations(measured, positions);
    return relative(receptance(found.receptances, name), entry(base, row, column_));
  };
  EXPECT_LT(error(0.005, false, "xx", 0, 0), 1e-12);
  // A force at a free end bends it nowhere near, so that even two points have an error of second order; a moment is
  // made of forces at the points themselves, whose own dents leave first order even to three.
  EXPECT_NEAR(error(0.004, false, "ry:x", 1, 0) / error(0.002, false, "ry:x", 1, 0), 4.0, 0.2);
  EXPECT_NEAR(error(0.004, true, "ry:x", 1, 0) / error(0.002, true, "ry:x", 1, 0), 4.0, 0.2);
  EXPECT_NEAR(error(0.004, false, "ry:my", 1, 1) / error(0.002, false, "ry:my", 1, 1), 2.0, 0.1);
  EXPECT_NEAR(error(0.004, true, "ry:my", 1, 1) / error(0.002, true, "ry:my", 1, 1), 2.0, 0.1);
  EXPECT_NEAR(error(0.01, true, "ry:my", 1, 1), 0.5 * error(0.01, false, "ry:my", 1, 1), 0.01);
}

TEST(CompleteRotations, SeesTheSlopeAndNotTheTurnOfASection) {
  // At the end that a force pushes, u' - θ = -f / κGA*: a sixth of the turn of this stout nose. No spacing corrects it,
  // an artefact's model does.
  const Eigen::VectorXd f = hertz(3000, 50);
  const std::vector<Eigen::Matrix2cd> base = detail::base_receptances({.segments = nose(), .receptances = {}}, f).x;
  const HolderResult found = complete_rotations(nose_translations(f, 1e-4, Beam::timoshenko), {0.0, 1e-4, 2e-4});
  const Segment front = nose()[0];
  const std::complex<double> shear_stiffness = detail::shear_coefficient(0.3, 0.0) * 200e9 / 2.6 *
                                               std::complex<double>(1.0, front.loss_factor) * std::numbers::pi / 4.0 *
                                               front.diameter_m * front.diameter_m;
  const Eigen::VectorXcd difference = receptance(found.receptances, "ry:x") - entry(base, 1, 0);
  const Eigen::VectorXcd expected = Eigen::VectorXcd::Constant(f.size(), -1.0 / shear_stiffness);
  EXPECT_LT(relative(difference, expected), 0.01);
  EXPECT_NEAR(relative(receptance(found.receptances, "ry:x"), entry(base, 1, 0)), 0.17, 0.01);
}

TEST(CompleteRotations, StatesItsTruncationFromThreePoints) {
  const Eigen::VectorXd f = hertz(3000, 50);
  const HolderResult found = complete_rotations(nose_translations(f, 0.01), {0.0, 0.01, 0.02});
  const std::vector<Eigen::Matrix2cd> base =
      detail::base_receptances({.segments = nose(Beam::euler_bernoulli), .receptances = {}}, f).x;
  const double error = relative(receptance(found.receptances, "ry:x"), entry(base, 1, 0));
  EXPECT_GT(found.truncation_error, error);
  EXPECT_FALSE(found.notes.empty());
}

TEST(CompleteRotations, TakesHitsAtTheMouthAlone) {
  const Eigen::VectorXd f = hertz(3000, 50);
  const FrfSet all = nose_translations(f, 0.01);
  FrfSet hits = all;
  std::erase_if(hits.frfs, [](const modal::Frf& frf) { return frf.name.excitation.point != 1; });
  const HolderResult found = complete_rotations(hits, {0.0, 0.01, 0.02});
  const HolderResult whole = complete_rotations(all, {0.0, 0.01, 0.02});
  EXPECT_LT(relative(receptance(found.receptances, "ry:x"), receptance(whole.receptances, "ry:x")), 1e-12);
  const Eigen::VectorXcd& l = receptance(found.receptances, "ry:x");
  const Eigen::VectorXcd rank_one = l.cwiseProduct(l).cwiseQuotient(receptance(found.receptances, "xx"));
  EXPECT_LT(relative(receptance(found.receptances, "ry:my"), rank_one), 1e-12);
  EXPECT_NE(found.notes.front().find("l n / h"), std::string::npos);
  EXPECT_NE(rejection([&] {
              static_cast<void>(complete_rotations(hits, {0.005, 0.015, 0.025}));
            }).find("lack 2x:2x"),
            std::string::npos);
}

TEST(Holder, MarksLinesThatAreZero) {
  const Eigen::VectorXd f = hertz(300, 50);
  FrfSet measured = two_points({stout(0.03)}, {stout(0.03)}, true_base(f), f);
  measured.frfs[0].receptance.segment(10, 3).setZero();
  measured.frfs[1].receptance.segment(20, 2).setZero();
  for (const HolderResult& found : {remove_artefact(measured, {0.0, 0.03}, {stout(0.06)}),
                                    remove_artefact(measured, {0.0, 0.03}, {stout(0.06)}, {.regularisation = 0.0})}) {
    for (const Eigen::Index line : {10, 11, 12, 20, 21}) EXPECT_TRUE(std::isinf(found.amplification(line))) << line;
    EXPECT_GE(found.unreliable_hz.size(), 5U);
    EXPECT_NO_THROW(found.receptances.validate());
  }
  for (modal::Frf& frf : measured.frfs) frf.receptance.segment(30, 2).setZero();
  const HolderResult slopes = complete_rotations(measured, {0.0, 0.03});
  for (const Eigen::Index line : {30, 31}) EXPECT_TRUE(std::isinf(slopes.amplification(line))) << line;
  EXPECT_NO_THROW(slopes.receptances.validate());
  measured.frfs.pop_back();
  const HolderResult column = complete_rotations(measured, {0.0, 0.03});
  for (const Eigen::Index line : {10, 30}) EXPECT_TRUE(std::isinf(column.amplification(line))) << line;
  EXPECT_NO_THROW(column.receptances.validate());
  measured.frfs[0].receptance.setZero();
  EXPECT_NE(rejection([&] {
              static_cast<void>(complete_rotations(measured, {0.0, 0.03}));
            }).find("1x:1x is zero"),
            std::string::npos);
}

TEST(Holder, RejectsWhatItCannotRead) {
  const Eigen::VectorXd f = hertz(100, 50);
  const FrfSet measured = two_points({bar(0.03)}, {bar(0.05)}, true_base(f), f);
  const auto removed = [&](const FrfSet& set, const std::vector<double>& positions) {
    return rejection([&] { static_cast<void>(remove_artefact(set, positions, {bar(0.08)})); });
  };
  EXPECT_NE(removed(measured, {0.0, 0.09}).find("must lie on the artefact"), std::string::npos);
  EXPECT_NE(removed(measured, {0.0, 0.0}).find("must not be given twice"), std::string::npos);
  EXPECT_NE(removed(measured, {0.0}).find("there is an FRF 2x:1x"), std::string::npos);
  FrfSet few = measured;
  few.frfs.pop_back();
  EXPECT_NE(removed(few, {0.0, 0.03}).find("must be at least three a plane"), std::string::npos);
  FrfSet none = measured;
  for (modal::Frf& frf : none.frfs) frf.name.response.axis = frf.name.excitation.axis = modal::Axis::z;
  EXPECT_NE(removed(none, {0.0, 0.03}).find("no translation in x or y"), std::string::npos);
  EXPECT_NE(rejection([&] {
              static_cast<void>(complete_rotations(measured, {0.0}));
            }).find("has 1 positions; must be two or three"),
            std::string::npos);
}

}  // namespace holder_test
}  // namespace robomill::coupling
