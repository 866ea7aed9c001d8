#include "robomill/modal/files/hit_guess.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "testing/support.hpp"

namespace robomill::modal {
namespace hit_guess_test {

using Role = ColumnGuess::Role;

/// "time:time_s force:force_n x:ax": the role, of a response its axis, and the name of each column that has one.
std::string roles(const HitGuess& guess) {
  std::string out;
  for (const ColumnGuess& column : guess.columns) {
    if (column.role == Role::unknown) continue;
    out += out.empty() ? "" : " ";
    out += column.role == Role::time ? "time" : column.role == Role::force ? "force" : std::string(1, column.axis);
    out += ":" + column.name;
  }
  return out;
}

class HitGuessTest : public ::testing::Test {
 protected:
  HitGuess guess(const std::string& name, const std::string& content) {
    return guess_hit(io::read_record(folder_.file(name, content)));
  }
  test::Folder folder_;
};

/// Four columns of 40 lines: a time, a hit of one line, and what swings.
const std::string rows = [] {
  std::string text = "\n";
  for (int i = 0; i < 40; ++i) {
    text += fmt::format("{:.1f},{},{:.3f},{:.3f}\n", 0.1 * i, i == 5 ? 9.0 : 0.1, 0.3 * std::sin(i), 0.2 * std::cos(i));
  }
  return text;
}();

/// A record of a force and an acceleration, over time.
io::Record record_of(double seconds, const std::function<double(double)>& force_n) {
  constexpr double rate_hz = 25'600.0;
  const auto count = static_cast<Eigen::Index>(seconds * rate_hz);
  Eigen::VectorXd time(count), force(count), response(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    time(i) = static_cast<double>(i) / rate_hz;
    force(i) = force_n(time(i));
    response(i) = std::sin(3e3 * time(i));
  }
  io::Record record;
  record.names = {"time_s", "fx_n", "ax_m_per_s2"};
  record.columns = {time, force, response};
  return record;
}

/// Half a sine, as a hammer pushes.
double half_sine(double at_s, double width_s) {
  return at_s < 0.0 || at_s > width_s ? 0.0 : std::sin(std::numbers::pi * at_s / width_s);
}

TEST_F(HitGuessTest, KnowsColumnsByNameAndUnit) {
  EXPECT_EQ(roles(guess("hit_x_1.csv", "time_s,force_n,ax_m_per_s2,ay_m_per_s2" + rows)),
            "time:time_s force:force_n x:ax_m_per_s2 y:ay_m_per_s2");
  EXPECT_EQ(roles(guess("a.csv", "t (s),Hammer (N),acc y [m/s²],temperature" + rows)),
            "time:t (s) force:Hammer (N) y:acc y [m/s²]");
  EXPECT_EQ(roles(guess("a.csv", "Zeit,Kraft,Beschleunigung Z,ch4" + rows)),
            "time:Zeit force:Kraft z:Beschleunigung Z");
  EXPECT_EQ(roles(guess("a.csv", "t,FX,AX,AZ" + rows)), "time:t force:FX x:AX z:AZ");
}

TEST_F(HitGuessTest, ReadsUnits) {
  const HitGuess guessed = guess("a.csv", "Time (ms),Force (mV),acc x (g),acc y (g)" + rows);
  EXPECT_EQ(roles(guessed), "time:Time (ms) force:Force (mV) x:acc x (g) y:acc y (g)");
  EXPECT_DOUBLE_EQ(guessed.columns[0].si_per_unit, 1e-3);
  EXPECT_DOUBLE_EQ(guessed.columns[1].volts, 1e-3);
  EXPECT_DOUBLE_EQ(guessed.columns[2].si_per_unit, 9.80665);
  EXPECT_EQ(guessed.columns[2].volts, 0.0);
  const HitGuess velocity = guess("b.csv", "t,force_kn,vel_mm_per_s,x_um" + rows);
  EXPECT_DOUBLE_EQ(velocity.columns[1].si_per_unit, 1e3);
  EXPECT_EQ(velocity.columns[2].kind, ResponseKind::velocity);
  EXPECT_EQ(velocity.columns[3].role, Role::unknown) << "of another kind";
}

TEST_F(HitGuessTest, TakesTheDirectionFromColumnOrFile) {
  const auto direction = [&](const char* file, const char* names) {
    const HitGuess guessed = guess(file, names + rows);
    return guessed.force_direction + " " + guessed.direction_from;
  };
  EXPECT_EQ(direction("hit_y_2.csv", "t,force,a,b"), "y the file's name");
  EXPECT_EQ(direction("tapz3.csv", "t,force,a,b"), "z the file's name");
  EXPECT_EQ(direction("Y1.csv", "t,force,a,b"), "y the file's name");
  EXPECT_EQ(direction("hit_y.csv", "t,fx_n,ax,ay"), "x the column's name");
  EXPECT_EQ(direction("max_force.csv", "t,force,a,b"), "x ");
  EXPECT_EQ(roles(guess("hit_y.csv", "t,force,acc1,acc2" + rows)), "time:t force:force y:acc1 x:acc2");
}

TEST_F(HitGuessTest, LooksAtTheSignalWhereNamesSayNothing) {
  const HitGuess guessed = guess("hit_y_1.txt", rows.substr(1));
  EXPECT_EQ(roles(guessed), "time:1 force:2 y:3 x:4");
  EXPECT_EQ(guessed.columns[0].from, "its even rise");
  EXPECT_EQ(guessed.columns[1].from, "its sharp peak");
  EXPECT_EQ(roles(guess("a.csv", "t,ch1,ch2,ch3" + rows)), "time:t force:ch1 x:ch2 y:ch3");
}

/// A hit whose first column has few digits.
std::string few_digits(const std::string& names, const char* format, double step) {
  std::string text = names;
  for (int i = 0; i < 600; ++i) {
    text += fmt::format(fmt::runtime(format), step * i) +
            fmt::format(" {} {:.4f}\n", i == 50 ? 9.0 : 0.0, 0.3 * std::sin(i));
  }
  return text;
}

// What only rises is no response and no force, rounded or not and whatever its name says.
TEST_F(HitGuessTest, AColumnThatOnlyRisesIsTheTime) {
  for (const char* names : {"", "X_Value Hammer acc_x\n", "x f ay\n", "Seconds force_n resp\n", "sensor f ax\n"}) {
    for (const auto& [format, step] : {std::pair{"{:.2e}", 2.5e-4}, {"{:.3f}", 2.5e-4}, {"{:.6f}", 2.5e-4}}) {
      const HitGuess found = guess("tap.txt", few_digits(names, format, step));
      EXPECT_EQ(found.columns[0].role, Role::time) << names << format;
      EXPECT_EQ(found.columns[1].role, Role::force) << names << format;
      EXPECT_EQ(found.columns[2].role, Role::response) << names << format;
    }
  }
  // A column that counts is neither; force and response alone, in two files, are no hit.
  const HitGuess counted = guess("tap.txt", few_digits("", "{:.0f}", 1.0));
  EXPECT_EQ(counted.columns[0].role, Role::other);
  EXPECT_TRUE(counted.is_hit());
  std::string force;
  for (int i = 0; i < 600; ++i) force += fmt::format("{:.2e} {}\n", 2.5e-4 * i, i == 50 ? 9 : 0);
  EXPECT_FALSE(guess("impact.txt", force).is_hit());
}

TEST_F(HitGuessTest, FindsNoHitInOtherRecords) {
  EXPECT_FALSE(guess("frf.csv", "frequency_hz,xx_re_m_per_n,xx_im_m_per_n,xx_coherence" + rows).is_hit());
  EXPECT_FALSE(guess("frf2.csv", "Hz,Real,Imag,Coherence" + rows).is_hit());
  EXPECT_FALSE(guess("trajectory.csv", "time_s,q1,q2,x_mm" + rows).is_hit());
  EXPECT_FALSE(guess("program.csv", "x_mm,y_mm,z_mm,i" + rows).is_hit());
  EXPECT_FALSE(guess("cut.csv", "time_s,ax_m_per_s2,ay_m_per_s2,az_m_per_s2" + rows).is_hit());
  EXPECT_TRUE(guess("hit.csv", "time_s,force_n,ax_m_per_s2,ay_m_per_s2" + rows).is_hit());
}

// Hard and soft tips, long and short records, a bounce, a hammer that is wired the other way round, an offset.
TEST_F(HitGuessTest, AHitIsOnePulse) {
  for (const double seconds : {0.05, 0.1, 1.0}) {
    for (const double width_s : {0.3e-3, 1e-3, 4e-3}) {
      const auto one = [&](double t) { return 400.0 * half_sine(t - 0.01, width_s); };
      EXPECT_TRUE(guess_hit(record_of(seconds, one)).is_hit()) << seconds << " " << width_s;
      EXPECT_TRUE(guess_hit(record_of(seconds, [&](double t) { return 3.0 - one(t); })).is_hit());
      EXPECT_TRUE(guess_hit(record_of(seconds, [&](double t) { return one(t) + 0.7 * one(t - 0.02); })).is_hit());
    }
  }
}

// A cut at 6000 rpm with two teeth: in a slot, and at small immersion, where the teeth push for 4 % of the time.
TEST_F(HitGuessTest, ACutIsNoHit) {
  for (const double width_s : {5e-3, 2e-3, 0.2e-3}) {
    for (const double seconds : {0.05, 0.3, 2.0}) {
      const auto cut = [&](double t) { return 200.0 * half_sine(std::fmod(t, 5e-3), width_s); };
      EXPECT_FALSE(guess_hit(record_of(seconds, cut)).is_hit()) << seconds << " " << width_s;
    }
  }
  EXPECT_FALSE(guess_hit(record_of(0.5, [](double) { return 0.0; })).is_hit());
  EXPECT_FALSE(guess_hit(record_of(0.5, [](double t) { return t > 0.2 ? 50.0 : 0.0; })).is_hit()) << "a load";
}

TEST_F(HitGuessTest, NamesColumnsOfOneNameByNumber) {
  EXPECT_EQ(roles(guess("a.csv", "t,force,ch,ch" + rows)), "time:t force:force x:3 y:4");
}

}  // namespace hit_guess_test
}  // namespace robomill::modal
