#include "robomill/stability/eigen/hessenberg_lanes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "robomill/base/linear_algebra.hpp"
#include "robomill/base/random.hpp"
#include "robomill/stability/eigen/hessenberg.hpp"
#include "testing/support.hpp"

namespace robomill::stability::detail {
namespace hessenberg_lanes_test {

using Wanted = std::array<bool, lane_count>;
using Values = std::array<std::complex<double>, lane_count>;

/// Upper Hessenberg, entries of any size.
Eigen::MatrixXd random_matrix(Random& random, std::size_t size) {
  const Eigen::Index n = static_cast<Eigen::Index>(size);
  const double spread = random.index(3) == 0 ? 3.0 : 0.0;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index r = 0; r < n; ++r) {
    for (Eigen::Index c = std::max<Eigen::Index>(r - 1, 0); c < n; ++c) {
      matrix(r, c) = random.normal() * std::exp(spread * random.normal());
    }
  }
  return matrix;
}

void put(const Eigen::MatrixXd& matrix, std::size_t lane, HessenbergLanes& out) {
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) {
      out(static_cast<std::size_t>(r), static_cast<std::size_t>(c)).v[lane] = matrix(r, c);
    }
  }
}

TEST(HessenbergLanes, HaveTheEigenvaluesThatEigenFinds) {
  HessenbergLanes lanes;
  for (int seed = 0; seed < test::seeds(1000); ++seed) {
    Random random(17, static_cast<std::uint64_t>(seed));
    const std::size_t size = 1 + random.index(40);
    lanes.resize(size);
    std::array<Eigen::MatrixXd, lane_count> matrices;
    Wanted wanted;
    for (std::size_t lane = 0; lane < lane_count; ++lane) {
      matrices[lane] = random_matrix(random, size);
      put(matrices[lane], lane, lanes);
      wanted[lane] = random.index(5) != 0;
    }
    Values values;
    values.fill(7.0);
    const Wanted found = lanes.dominant(wanted, values);
    EXPECT_EQ(found, wanted) << seed;
    for (std::size_t lane = 0; lane < lane_count; ++lane) {
      const double expected = linear_algebra::eigenvalues(matrices[lane]).cwiseAbs().maxCoeff();
      EXPECT_NEAR(std::abs(values[lane]), wanted[lane] ? expected : 7.0, 1e-9 * (1.0 + matrices[lane].norm())) << seed;
      EXPECT_GE(values[lane].imag(), 0.0);
    }
  }
}

// What a lane finds depends neither on the others nor on the machine.
TEST(HessenbergLanes, DoNotMeet) {
  const Kernels best = best_kernels();
  Random random(3);
  std::array<Eigen::MatrixXd, lane_count> matrices;
  for (Eigen::MatrixXd& matrix : matrices) matrix = random_matrix(random, 19);
  HessenbergLanes lanes;
  const auto together = [&](Kernels which) {
    kernels() = which;
    lanes.resize(19);
    for (std::size_t lane = 0; lane < lane_count; ++lane) put(matrices[lane], lane, lanes);
    Values values = {};
    Wanted all;
    all.fill(true);
    lanes.dominant(all, values);
    return values;
  };
  const Values reference = together(Kernels::baseline);
  for (const Kernels which : {Kernels::avx2, Kernels::avx512}) {
    if (static_cast<int>(which) > static_cast<int>(best)) continue;
    EXPECT_EQ(together(which), reference);
  }
  kernels() = best;
  for (std::size_t lane = 0; lane < lane_count; ++lane) {
    lanes.resize(19);
    put(matrices[lane], lane, lanes);
    Values values = {};
    Wanted one = {};
    one[lane] = true;
    EXPECT_EQ(lanes.dominant(one, values), one);
    EXPECT_EQ(values[lane], reference[lane]) << lane;
  }
}

// A lane may be solved by itself in the place of eight at once.
TEST(HessenbergLanes, HaveTheDigitsOfOneAlone) {
  for (int seed = 0; seed < test::seeds(1000); ++seed) {
    Random random(29, static_cast<std::uint64_t>(seed));
    const std::size_t size = 1 + random.index(40);
    HessenbergLanes lanes;
    lanes.resize(size);
    Wanted all;
    all.fill(true);
    std::array<Eigen::MatrixXd, lane_count> matrices;
    for (std::size_t lane = 0; lane < lane_count; ++lane) {
      matrices[lane] = random_matrix(random, size);
      put(matrices[lane], lane, lanes);
    }
    Values values = {};
    lanes.dominant(all, values);
    for (std::size_t lane = 0; lane < lane_count; ++lane) {
      Hessenberg alone;
      alone.resize(size);
      for (std::size_t i = 0; i < size * size; ++i) {
        alone(i / size, i % size) =
            matrices[lane](static_cast<Eigen::Index>(i / size), static_cast<Eigen::Index>(i % size));
      }
      std::complex<double> value;
      ASSERT_TRUE(alone.dominant(value));
      EXPECT_EQ(values[lane], value) << seed;
    }
  }
}

TEST(HessenbergLanes, SolveTheAwkwardOnes) {
  HessenbergLanes lanes;
  lanes.resize(3);
  for (std::size_t i = 0; i < 3; ++i) lanes((i + 1) % 3, i).v[1] = 1.0;  // a cycle, on which plain shifts stand still
  lanes(1, 1).v[2] = std::nan("");
  lanes(0, 0).v[3] = lanes(1, 1).v[3] = 3.0;
  lanes(0, 1).v[3] = 1.0;  // one vector for two eigenvalues
  Values values = {};
  Wanted all;
  all.fill(true);
  const Wanted found = lanes.dominant(all, values);
  EXPECT_TRUE(found[0]);
  EXPECT_EQ(values[0], 0.0);  // all zero
  EXPECT_NEAR(std::abs(values[1]), 1.0, 1e-12);
  EXPECT_FALSE(found[2]);
  EXPECT_NEAR(values[3].real(), 3.0, 1e-12);
}

}  // namespace hessenberg_lanes_test
}  // namespace robomill::stability::detail
