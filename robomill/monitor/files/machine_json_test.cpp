#include "robomill/monitor/files/machine_json.hpp"

#include <gtest/gtest.h>

#include "robomill/io/json.hpp"
#include "testing/support.hpp"

namespace robomill::monitor {
namespace machine_json_test {

Machine some_machine() {
  return {.sample_rate_hz = 8192.0,
          .channels = 2,
          .seconds = 12.5,
          .quietest_energy = 1.234e-7,
          .air = {.hops = 100, .all = {0.0, 1.5e-9, 3e-5}},
          .rows = {{.rotation_hz = 49.98, .hops = 200, .beside = {0.0, 1e-6, 2e-6}, .all = {1e-7, 3e-2, 4e-2}}},
          .tones = {{.frequency_hz = 733.1, .level = 0.14, .share = 0.98}},
          .knocks = {.per_minute = 12.0, .strongest = 1.1, .frequency_hz = 900.0, .decay_per_s = 41.5}};
}

TEST(MachineJson, ComesBack) {
  const test::Folder folder;
  const std::string text = machine_json(some_machine());
  folder.file("machine.json", text);
  EXPECT_EQ(io::parsed(text)["document"], "machine/1");
  const Machine back = read_machine(folder.at("machine.json"));
  EXPECT_EQ(machine_json(back), text);
  EXPECT_EQ(back.rows.at(0).beside, some_machine().rows[0].beside);
  EXPECT_EQ(back.air.all, some_machine().air.all);
  EXPECT_EQ(back.tones.at(0).frequency_hz, 733.1);
  EXPECT_EQ(back.knocks.decay_per_s, 41.5);
  EXPECT_EQ(back.channels, 2);
}

TEST(MachineJson, HasOneMapASensor) {
  const test::Folder folder;
  Machine machine = some_machine();
  machine.others = {some_machine()};
  machine.others.front().channels = 1;
  machine.others.front().tones.clear();
  const std::string text = machine_json(machine);
  folder.file("machine.json", text);
  const Machine back = read_machine(folder.at("machine.json"));
  EXPECT_EQ(machine_json(back), text);
  EXPECT_EQ(back.of_sensor(1).channels, 1);
  EXPECT_NE(machine_text(back).find("sensor 2: "), std::string::npos);
  // Those of one sensor were written without it.
  io::Json one = io::parsed(machine_json(some_machine()));
  one.erase("others");
  folder.file("one.json", io::plain_text(one));
  EXPECT_EQ(read_machine(folder.at("one.json")).sensors(), 1U);
  machine.others.front().others = {some_machine()};
  EXPECT_EQ(test::field_of([&] { machine.validate(); }), "others[1].others");
  machine.others.front().others.clear();
  machine.others.front().rows.front().hops = 0;
  machine.others.front().rows.front().beside.clear();
  EXPECT_EQ(test::field_of([&] { machine.validate(); }), "others[1].rows[1].beside");
}

TEST(MachineJson, SaysWhatIsWrong) {
  const test::Folder folder;
  const auto error_of = [&](auto change) {
    io::Json json = io::parsed(machine_json(some_machine()));
    change(json);
    folder.file("machine.json", io::plain_text(json));
    return test::rejection([&] { (void)read_machine(folder.at("machine.json")); });
  };
  const auto names = [&](const char* what, auto change) {
    const std::string error = error_of(change);
    EXPECT_NE(error.find(what), std::string::npos) << what << ": " << error;
    EXPECT_NE(error.find("machine.json"), std::string::npos) << error;
  };
  names("document", [](io::Json& json) { json["document"] = "lobes/1"; });
  names("cell_hz", [](io::Json& json) { json["cell_hz"] = 5.0; });
  names("channels", [](io::Json& json) { json["channels"] = 0; });
  names("rows[1].all", [](io::Json& json) { json["rows"][0]["all"].erase(0); });
  names("rows[1].beside", [](io::Json& json) { json["rows"][0]["beside"] = io::Json::array(); });
  names("air.all", [](io::Json& json) { json["air"]["all"][1] = -1.0; });
  names("hops", [](io::Json& json) { json["air"]["hops"] = 1.5; });
  names("rows", [](io::Json& json) {
    json["air"]["hops"] = 0;
    json["rows"] = io::Json::array();
  });
  EXPECT_NE(test::rejection([&] { (void)read_machine(folder.at("none.json")); }), "");
}

TEST(MachineJson, IsNamedByMonitorToml) {
  const test::Folder folder;
  folder.file("machine.json", machine_json(some_machine()));
  folder.file("monitor.toml",
              "[signal]\nsample_rate_hz = 8192\nchannels = [1, 2]\n[process]\nmachine = \"machine.json\"\n");
  MonitorFile file = read_monitor(folder.at("monitor.toml"));
  EXPECT_EQ(file.machine, folder.at("machine.json"));
  EXPECT_FALSE(file.options.machine);
  load_machine(file);
  ASSERT_TRUE(file.options.machine);
  EXPECT_NO_THROW(validate(file));
  file.options.channels = 3;
  EXPECT_EQ(test::field_of([&] { validate(file); }), "process.machine");
}

TEST(MachineJson, TextSaysWhatWasLearnt) {
  const std::string text = machine_text(some_machine());
  for (const char* part : {"733.1 Hz", "12 a minute", "1 speed", "2999 rpm", "and air"})
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
}

}  // namespace machine_json_test
}  // namespace robomill::monitor
