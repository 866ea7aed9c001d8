// Records that hits.toml names as the recorder does: no name says a direction, or what is within.
#include "robomill/jobs/frf.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "testing/serve/hammer.hpp"
#include "testing/support.hpp"

namespace robomill::jobs {
namespace frf_test {

using test::HammerRecord;

constexpr const char* acquisition = "[acquisition]\nmax_frequency_hz = 1000\n";

/// Columns of one file, each with its name.
struct NamedColumn {
  std::string name;
  const std::vector<double>* values;
};

std::string text_of(const std::vector<NamedColumn>& columns) {
  std::string text = "time_s";
  for (const NamedColumn& column : columns) text += "," + column.name;
  text += "\n";
  for (std::size_t i = 0; i < columns.front().values->size(); ++i) {
    text += std::to_string(static_cast<double>(i) / HammerRecord::rate_hz);
    for (const NamedColumn& column : columns) text += "," + std::to_string((*column.values)[i]);
    text += "\n";
  }
  return text;
}

std::string row(const std::string& file, const std::string& direction, const std::string& columns) {
  return "[[hits]]\nfile = " + file + "\nforce_direction = \"" + direction + "\"\n" + columns;
}

class FrfJob : public ::testing::Test {
 protected:
  /// Force and responses of a hit apart and together.
  void put(const std::string& force, const std::string& response, const std::string& whole, std::uint64_t seed,
           double second_n = 0.0) {
    std::vector<test::Push> pushes = {{.at_s = 0.1, .peak_n = 90.0}};
    if (second_n > 0.0) pushes.push_back({.at_s = 0.14, .peak_n = second_n});
    const HammerRecord record(8192, pushes, seed);
    const NamedColumn load = {"load", &record.force_n}, tip = {"tip", &record.ax_m_per_s2},
                      side = {"side", &record.ay_m_per_s2};
    place_.file(force, text_of({load}));
    place_.file(response, text_of({tip, side}));
    place_.file(whole, text_of({load, tip, side}));
  }
  FrfJobResult run(const std::string& rows) { return run_frf({place_.file("hits.toml", acquisition + rows)}); }

  test::Folder place_;
  const std::string columns_ = "force = \"load\"\nresponses = { x = \"tip\", y = \"side\" }\n";
};

TEST_F(FrfJob, FilesNamedFreelyAreReadByTheirRows) {
  put("Ch1_0007.csv", "Ch2_0007.csv", "Record A.csv", 1);
  put("b.csv", "a.csv", "2024-05-01.csv", 2);
  put("y.csv", "z.csv", "x.csv", 3);  // names that say another direction than their rows do
  const FrfJobResult apart =
      run(row("[\"Ch1_0007.csv\", \"Ch2_0007.csv\"]", "x", columns_) + row("[\"b.csv\", \"a.csv\"]", "-y", columns_) +
          row("[\"y.csv\", \"z.csv\"]", "x", columns_));
  ASSERT_EQ(apart.file.hits.size(), 3U);
  EXPECT_EQ(apart.file.hits[1].file, place_.at("b.csv").string() + " + " + place_.at("a.csv").string());
  EXPECT_EQ(apart.file.hits[0].excitation.axis, modal::Axis::x);
  EXPECT_EQ(apart.file.hits[1].excitation.axis, modal::Axis::y);
  EXPECT_TRUE(apart.file.hits[1].against_axis);
  EXPECT_EQ(apart.file.hits[2].excitation.axis, modal::Axis::x);
  EXPECT_EQ(apart.frfs.set.frfs.size(), 4U);
  // As one file each, and with columns that are named with their files or counted.
  const std::string numbers = "force = 2\nresponses = { x = 2, y = 3 }\ntime = 1\n";
  const std::string whole = row("\"Record A.csv\"", "x", columns_) + row("\"2024-05-01.csv\"", "-y", columns_) +
                            row("\"x.csv\"", "x", columns_);
  const std::string counted = row("[\"Ch1_0007.csv\", \"Ch2_0007.csv\"]", "x", numbers) +
                              row("[\"b.csv\", \"a.csv\"]", "-y", numbers) +
                              row("[\"y.csv\", \"z.csv\"]", "x", numbers);
  for (const std::string& rows : {whole, counted}) {
    const FrfJobResult other = run(rows);
    ASSERT_EQ(other.file.hits.size(), 3U);
    for (const modal::Frf& frf : apart.frfs.set.frfs) {
      const modal::Frf* const same = other.frfs.set.find(frf.name);
      ASSERT_NE(same, nullptr);
      EXPECT_LT((frf.receptance - same->receptance).norm(), 1e-12 * frf.receptance.norm());
    }
  }
}

TEST_F(FrfJob, MessagesNameTheFilesOfTheirRow) {
  put("p.csv", "q.csv", "r.csv", 1);
  put("s.csv", "t.csv", "u.csv", 2, 45.0);
  const std::string good = row("[\"p.csv\", \"q.csv\"]", "x", columns_);
  const FrfJobResult both = run(good + row("[\"s.csv\", \"t.csv\"]", "x", columns_));
  ASSERT_EQ(both.frfs.hits.size(), 2U);
  EXPECT_TRUE(both.frfs.hits[0].accepted);
  EXPECT_FALSE(both.frfs.hits[1].accepted);
  EXPECT_NE(both.frfs.hits[1].file.find("s.csv + "), std::string::npos) << both.frfs.hits[1].file;
  const auto says = [&](const std::string& files) {
    return test::rejection([&] { static_cast<void>(run(good + row(files, "x", columns_))); });
  };
  EXPECT_NE(says("[\"s.csv\", \"none.csv\"]").find("none.csv"), std::string::npos);
  EXPECT_NE(says("[\"s.csv\", \"p.csv\"]").find("tip"), std::string::npos) << "no such column in either";
}

}  // namespace frf_test
}  // namespace robomill::jobs
