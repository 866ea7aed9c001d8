#include "robomill/modal/impact/hits_mass.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <complex>
#include <vector>

#include "robomill/base/random.hpp"

namespace robomill::modal {
namespace hits_mass_test {

using Complex = std::complex<double>;
using Eigen::Index;

const Dof x{.point = 0, .axis = Axis::x};
const Dof y{.point = 0, .axis = Axis::y};
const Dof far_x{.point = 3, .axis = Axis::x};

Eigen::MatrixXcd random_matrix(Index rows, Index columns, Random& random) {
  Eigen::MatrixXcd m(rows, columns);
  for (Index i = 0; i < m.size(); ++i) m(i) = {random.normal(), random.normal()};
  return m;
}

std::vector<Frf> frfs_of(const Eigen::MatrixXcd& g, const std::vector<Dof>& sensors, const std::vector<Dof>& forces) {
  std::vector<Frf> frfs;
  for (std::size_t j = 0; j < forces.size(); ++j) {
    for (std::size_t i = 0; i < sensors.size(); ++i) {
      Frf frf;
      frf.name = {.response = sensors[i], .excitation = forces[j]};
      frf.receptance = Eigen::VectorXcd::Constant(1, g(static_cast<Index>(i), static_cast<Index>(j)));
      frfs.push_back(frf);
    }
  }
  return frfs;
}

// One degree of freedom: 1/(k + s c + s² (M + m)) becomes 1/(k + s c + s² M).
TEST(RemoveMass, FreesOneDegreeOfFreedom) {
  const double k = 2e6;
  const double c = 30.0;
  const double mass_kg = 0.5;
  const double sensor_kg = 0.02;
  const Complex s(0.0, 1900.0);
  const Complex loaded = 1.0 / (k + s * c + s * s * (mass_kg + sensor_kg));
  std::vector<Frf> frfs = frfs_of(Eigen::MatrixXcd::Constant(1, 1, loaded), {x}, {x});
  EXPECT_TRUE(remove_mass(frfs, {x}, Eigen::VectorXcd::Constant(1, s), sensor_kg).empty());
  const Complex free = 1.0 / (k + s * c + s * s * mass_kg);
  EXPECT_LT(std::abs(frfs[0].receptance(0) - free), 1e-12 * std::abs(free));
}

// G_m = (I + m s² G_DD)^-1 G_D: with all sensors hit, and a force elsewhere too: everything comes back, crosses
// included.
TEST(RemoveMass, FreesEveryFrfWhereAllSensorsWereHit) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    Random random(21, seed);
    const Eigen::MatrixXcd g = random_matrix(2, 3, random);
    const Complex s(random.uniform(0.0, 0.2), random.uniform(0.5, 2.0));
    const double mass_kg = random.uniform(0.01, 0.3);
    const Eigen::MatrixXcd loading = Eigen::MatrixXcd::Identity(2, 2) + mass_kg * s * s * g.leftCols(2);
    const Eigen::MatrixXcd measured = loading.inverse() * g;
    std::vector<Frf> frfs = frfs_of(measured, {x, y}, {x, y, far_x});
    EXPECT_TRUE(remove_mass(frfs, {x, y}, Eigen::VectorXcd::Constant(1, s), mass_kg).empty());
    for (std::size_t f = 0; f < frfs.size(); ++f) {
      EXPECT_LT(std::abs(frfs[f].receptance(0) - g(static_cast<Index>(f))), 1e-10 * g.norm());
    }
  }
}

// Only x was hit: what the sensor's motion in y does is unknown, which is reported. Without coupling nothing remains.
TEST(RemoveMass, ReportsWhichLoadingRemains) {
  const Complex s(0.0, 1.3);
  const double mass_kg = 0.2;
  const Complex gxx(0.7, -0.2);
  const Complex gyx(0.3, 0.4);
  const Complex loading = 1.0 + mass_kg * s * s * gxx;
  std::vector<Frf> frfs = frfs_of(Eigen::Vector2cd(gxx / loading, gyx / loading), {x, y}, {x});
  const std::vector<Dof> left = remove_mass(frfs, {x, y}, Eigen::VectorXcd::Constant(1, s), mass_kg);
  ASSERT_EQ(left.size(), 1u);
  EXPECT_EQ(left[0], y);
  EXPECT_LT(std::abs(frfs[0].receptance(0) - gxx), 1e-14);
  EXPECT_LT(std::abs(frfs[1].receptance(0) - gyx), 1e-14);
}

TEST(RemoveMass, LeavesAloneWhatItCannotFree) {
  std::vector<Frf> frfs = frfs_of(Eigen::MatrixXcd::Constant(1, 1, Complex(1.0, 2.0)), {x}, {far_x});
  EXPECT_EQ(remove_mass(frfs, {x}, Eigen::VectorXcd::Constant(1, Complex(0.0, 1.0)), 0.1).size(), 1u);
  EXPECT_EQ(frfs[0].receptance(0), Complex(1.0, 2.0));
}

// The deviation goes through the same map: against differences of the map itself, by 20,000 random errors.
TEST(RemoveMass, CarriesTheDeviation) {
  Random random(22);
  const Eigen::MatrixXcd measured = random_matrix(2, 2, random);
  const Complex s(0.0, 1.1);
  const double mass_kg = 0.2;
  const Eigen::Vector4d deviation(1e-4, 3e-4, 2e-4, 1e-4);
  std::vector<Frf> frfs = frfs_of(measured, {x, y}, {x, y});
  for (std::size_t f = 0; f < 4; ++f)
    frfs[f].deviation = Eigen::VectorXd::Constant(1, deviation(static_cast<Index>(f)));
  const std::vector<Frf> before = frfs;
  remove_mass(frfs, {x, y}, Eigen::VectorXcd::Constant(1, s), mass_kg);
  Eigen::Vector4d power = Eigen::Vector4d::Zero();
  constexpr int trials = 20000;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<Frf> noisy = before;
    for (std::size_t f = 0; f < 4; ++f) {
      const double scale = deviation(static_cast<Index>(f)) / std::sqrt(2.0);
      noisy[f].receptance(0) += Complex(scale * random.normal(), scale * random.normal());
    }
    remove_mass(noisy, {x, y}, Eigen::VectorXcd::Constant(1, s), mass_kg);
    for (std::size_t f = 0; f < 4; ++f) {
      power(static_cast<Index>(f)) += std::norm(noisy[f].receptance(0) - frfs[f].receptance(0)) / trials;
    }
  }
  for (std::size_t f = 0; f < 4; ++f) {
    EXPECT_NEAR(std::sqrt(power(static_cast<Index>(f))), frfs[f].deviation(0), 0.05 * frfs[f].deviation(0));
  }
}

}  // namespace hits_mass_test
}  // namespace robomill::modal
