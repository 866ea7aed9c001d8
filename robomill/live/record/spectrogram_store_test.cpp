#include "robomill/live/record/spectrogram_store.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "robomill/base/random.hpp"

namespace robomill::live {
namespace spectrogram_store_test {

constexpr double rate_hz = 51'200.0;

SpectrogramStore heard(double frequency_hz, double seconds, double noise = 0.0, double other_hz = 0.0,
                       double other = 0.0) {
  SpectrogramStore store(rate_hz, 5120);
  Random random(3);
  for (int i = 0; i < static_cast<int>(seconds * rate_hz); ++i) {
    const double turn = 2.0 * std::numbers::pi * i / rate_hz;
    store.add(std::sin(frequency_hz * turn) + other * std::sin(other_hz * turn) + noise * random.normal());
  }
  return store;
}

// A tone is in the row that covers it, whatever part is drawn, and rows are no wider than a 128th of the part or a
// line.
TEST(SpectrogramStore, DrawsAnyPartInFineRows) {
  for (const double tone_hz : {333.0, 4321.0, 17'000.0}) {
    const SpectrogramStore store = heard(tone_hz, 0.5);
    for (const double top_hz : {1.1 * tone_hz, 3.0 * tone_hz, 25'600.0}) {
      const Spectrogram part = store.part(top_hz);
      ASSERT_LE(part.frequency_hz.size(), 257);
      Eigen::Index row = 0, column = 0;
      part.level_db.maxCoeff(&row, &column);
      const double width_hz = std::max(10.0, part.max_frequency_hz / 100.0);
      EXPECT_NEAR(part.frequency_hz[row], tone_hz, 0.5 * width_hz + 1e-6);
      for (Eigen::Index i = 1; i < part.frequency_hz.size(); ++i) {
        EXPECT_GT(part.frequency_hz[i], part.frequency_hz[i - 1]);
        EXPECT_LE(part.frequency_hz[i] - part.frequency_hz[i - 1], width_hz + 1e-6);
      }
      EXPECT_NEAR(part.frequency_hz[part.frequency_hz.size() - 1], part.max_frequency_hz, width_hz);
    }
  }
}

TEST(SpectrogramStore, TheLimitIsWhereWhatStandsOutOfTheNoiseEnds) {
  EXPECT_NEAR(heard(700.0, 2.0).energy_limit_hz(), 700.0, 30.0);
  EXPECT_NEAR(heard(700.0, 2.0, 0.2).energy_limit_hz(), 700.0, 30.0);
  // A second tone counts where its share of the power is above a thousandth.
  EXPECT_NEAR(heard(700.0, 2.0, 0.01, 9000.0, 0.05).energy_limit_hz(), 9000.0, 200.0);
  EXPECT_NEAR(heard(700.0, 2.0, 0.01, 9000.0, 0.02).energy_limit_hz(), 700.0, 30.0);
  EXPECT_EQ(SpectrogramStore(rate_hz, 5120).energy_limit_hz(), 25'600.0);
}

TEST(SpectrogramStore, HasNoLevelsWithoutASignal) {
  EXPECT_EQ(SpectrogramStore(rate_hz, 5120).part(1000.0).level_db.size(), 0);
  SpectrogramStore store(rate_hz, 5120);
  store.skip(100'000'000);
  EXPECT_EQ(store.part(1000.0).level_db.size(), 0);
}

TEST(SpectrogramStore, AnAbsentSampleIsNoStep) {
  SpectrogramStore whole(rate_hz, 5120), torn(rate_hz, 5120);
  for (int i = 0; i < 51'200; ++i) {
    whole.add(9.81 + 1e-3 * std::sin(2.0 * std::numbers::pi * 1000.0 * i / rate_hz));
    torn.add(i > 25'000 && i < 25'600 ? NAN : 9.81 + 1e-3 * std::sin(2.0 * std::numbers::pi * 1000.0 * i / rate_hz));
  }
  EXPECT_NEAR(torn.energy_limit_hz(), whole.energy_limit_hz(), 100.0);
}

}  // namespace spectrogram_store_test
}  // namespace robomill::live
