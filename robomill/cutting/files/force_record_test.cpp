#include "robomill/cutting/files/force_record.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "robomill/base/cost.hpp"
#include "robomill/io/sample_source.hpp"
#include "testing/support.hpp"

namespace robomill::cutting {
namespace force_record_test {

using Channels = std::array<std::string, 3>;
using robomill::test::Folder;
using robomill::test::rejection;

const std::string rows = "0,1,-2,3\n0.0001,4,5,6\n0.0002,7,8,9\n";

TEST(ForceRecord, FindsComponentsByName) {
  const Folder folder;
  for (const char* head : {"time_s,fx_n,fy_n,fz_n\n", "Time [s],Fx [N],Fy [N],Fz [N]\n", "t,Force X,Force Y,Force Z\n",
                           "time_s,x,y,z\n"}) {
    const ForceRecordFile file = read_force_record(folder.file("a.csv", head + rows));
    EXPECT_EQ(file.record.force_n.col(0), Eigen::Vector3d(1.0, -2.0, 3.0)) << head;
    EXPECT_NEAR(file.record.sample_rate_hz, 10000.0, 1e-6);
    ASSERT_FALSE(file.assumed.empty());
    EXPECT_EQ(file.assumed[0].key, "--channels");
  }
}

// As a dynamometer's software exports it: lines of settings, names, a row of units.
TEST(ForceRecord, TakesTheRowOfUnits) {
  const Folder folder;
  const std::string text = "DynoWare,Version 2.5\nSampling rate [Hz]:,10000\nTime,Fx,Fy,Fz\ns,kN,kN,kN\n" + rows;
  const ForceRecordFile file = read_force_record(folder.file("a.csv", text));
  EXPECT_LT((file.record.force_n.col(1) - Eigen::Vector3d(4000.0, 5000.0, 6000.0)).norm(), 1e-9);
  EXPECT_EQ(file.assumed.size(), 1U);
}

TEST(ForceRecord, TakesChannelsThatAreGiven) {
  const Folder folder;
  const auto path = folder.file("a.csv", "time_s,Fx,Fy,Fz\n" + rows);
  const ForceRecordFile file = read_force_record(path, {.channels = {"-Fy", "2", "none"}});
  EXPECT_EQ(file.channels, (Channels{"-Fy", "2", "none"}));
  EXPECT_EQ(file.record.force_n(0, 0), 2.0);
  EXPECT_EQ(file.record.force_n(1, 0), 1.0);
  EXPECT_TRUE(std::isnan(file.record.force_n(2, 0)));
  ASSERT_EQ(file.assumed.size(), 1U);  // the unit
  EXPECT_EQ(file.assumed[0].taken, "N");
}

TEST(ForceRecord, ScalesSound) {
  const Folder folder;
  const auto path = folder.at("a.wav");
  io::write_wav(path, {0.5F, -0.25F, 0.125F, 0.0F, 0.0F, 0.0F}, 3, 10000.0);
  EXPECT_NE(rejection([&] { (void)read_force_record(path); }).find("full_scale_n"), std::string::npos);
  const ForceRecordFile file = read_force_record(path, {.channels = {"1", "2", "-3"}, .full_scale_n = 1000.0});
  EXPECT_EQ(file.record.force_n.col(0), Eigen::Vector3d(500.0, -250.0, -125.0));
  EXPECT_TRUE(file.assumed.empty());
}

TEST(ForceRecord, RejectsWhatIsNoForce) {
  const Folder folder;
  const auto says = [&](const std::string& text, const ForceRecordOptions& options = {}) {
    const auto path = folder.file("a.csv", text);
    return rejection([&] { (void)read_force_record(path, options); });
  };
  EXPECT_NE(says("time_s,Fx [V],Fy [V],Fz [V]\n" + rows).find("is in V, which is no unit of force"), std::string::npos);
  EXPECT_NE(says("time_s,a,b,c\n" + rows).find("4 columns: time_s, a, b, c"), std::string::npos);
  EXPECT_NE(says("time_s,Fx,Force x,Fz\n" + rows).find("Fx and Force x may be"), std::string::npos);
  EXPECT_NE(says("Fx,Fy,Fz\n1,2,3\n4,5,6\n").find("sample_rate_hz"), std::string::npos);
  EXPECT_NE(says("time_s,Fx,Fy,Fz\n" + rows, {.channels = {"Fx", "Fy"}}).find("must be three"), std::string::npos);
  EXPECT_NE(says("time_s,Fx,Fy,Fz\n" + rows, {.channels = {"Fx", "Fy", "Mz"}}).find("has no column Mz"),
            std::string::npos);
  EXPECT_NE(says("time_s,Fx,Fy,Fz\n" + rows, {.channels = {"none", "none", "none"}}).find("no component is left"),
            std::string::npos);
  const std::string twice = says("time_s,Fx,Fy,Fz\n" + rows, {.channels = {"Fx", "-2", "Fz"}});
  EXPECT_NE(twice.find("2 of a.csv is two components"), std::string::npos) << twice;
  EXPECT_NE(says("time_s,Fx,Fy,Fz\n" + rows, {.full_scale_n = 100.0}).find("a.csv has forces in a unit"),
            std::string::npos);
}

// What a file would take is known from its size, before it is read.
TEST(ForceRecord, IsBoundedInSize) {
  const Folder folder;
  const auto path = folder.file("large.csv", "time_s,Fx,Fy,Fz\n" + rows);
  const CostLimit before = cost_limit();
  set_cost_limit({.bytes = 100.0});
  const std::string text = rejection([&] { (void)read_force_record(path); });
  set_cost_limit(before);
  EXPECT_NE(text.find("size of large.csv"), std::string::npos) << text;
}

}  // namespace force_record_test
}  // namespace robomill::cutting
