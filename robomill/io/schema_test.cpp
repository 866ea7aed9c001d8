#include "robomill/io/schema.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <string>

#include "robomill/base/units.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace schema_test {

using robomill::test::rejection;

enum class Kind { flat, ball };
constexpr Name<Kind> kinds[] = {{"flat-end", Kind::flat}, {"ball-end", Kind::ball}};

struct Mode {
  double frequency_hz = 0.0, damping_ratio = 0.02;
};
struct Tool {
  int teeth = 2;
  double diameter_m = 0.01;
  Kind kind = Kind::flat;
  std::vector<double> pitch_rad = {};
  std::optional<double> mass_kg = {};
  std::array<double, 2> spindle_speed_rad_per_s = {};
  std::vector<Mode> modes = {};
  bool worn = false;
  std::string name = {};
};

const Schema<Mode>& mode_table() {
  static const Schema<Mode> table(
      "mode", "a mode of the tip",
      {key("frequency_hz", &Mode::frequency_hz, "natural frequency").above(0.0).required("From a tap test"),
       key("damping_ratio", &Mode::damping_ratio, "share of critical").above(0.0).below(1.0)});
  return table;
}

const Schema<Tool>& tool_table() {
  static const Schema<Tool> table(
      "tool", "the cutter",
      {key("teeth", &Tool::teeth, "cutting edges").at_least(1.0).required(),
       key("diameter_mm", &Tool::diameter_m, "over the edges").above(0.0).required("On its drawing"),
       key("kind", &Tool::kind, kinds, "shape of its end"), key("pitch_deg", &Tool::pitch_rad, "from tooth to tooth"),
       key("mass_kg", &Tool::mass_kg, "of the tool").above(0.0).optional(),
       key("spindle_speed_rpm", &Tool::spindle_speed_rad_per_s, "from, to").entries(2),
       key("modes", &Tool::modes, mode_table(), "of its tip"), key("worn", &Tool::worn, "edges are worn"),
       key("name", &Tool::name, "as the shop calls it").optional()});
  return table;
}

Tool read(const std::string& text) {
  TomlFile file(TomlSource("tool.toml", text));
  Tool out;
  tool_table().read(file, "tool", out, "");
  static_cast<void>(file.done());
  return out;
}

constexpr const char* whole = R"([tool]
teeth = 3
diameter_mm = 12
kind = "ball-end"
pitch_deg = [120, 100, 140]
mass_kg = 0.4
spindle_speed_rpm = [6000, 12000]
modes = [{ frequency_hz = 620 }, { frequency_hz = 900, damping_ratio = 0.03 }]
worn = true
name = "EM12"
)";

TEST(Schema, ReadsInSiWhatTheRowsSay) {
  const Tool tool = read(whole);
  EXPECT_EQ(tool.teeth, 3);
  EXPECT_EQ(tool.diameter_m, 12.0 * units::mm);
  EXPECT_EQ(tool.kind, Kind::ball);
  ASSERT_EQ(tool.pitch_rad.size(), 3U);
  EXPECT_EQ(tool.pitch_rad[1], 100.0 * units::deg);
  EXPECT_EQ(tool.mass_kg, 0.4);
  EXPECT_EQ(tool.spindle_speed_rad_per_s[1], 12000.0 * units::rpm);
  ASSERT_EQ(tool.modes.size(), 2U);
  EXPECT_EQ(tool.modes[0].damping_ratio, 0.02) << "the struct's own default";
  EXPECT_EQ(tool.modes[1].damping_ratio, 0.03);
  EXPECT_TRUE(tool.worn);
}

TEST(Schema, WritesWhatItReads) {
  const Json json = tool_table().write(read(whole));
  EXPECT_EQ(json.dump(),
            "{\"teeth\":3,\"diameter_mm\":12.0,\"kind\":\"ball-end\",\"pitch_deg\":[120.0,100.0,140.0],\"mass_kg\":0.4,"
            "\"spindle_speed_rpm\":[6000.0,12000.0],\"modes\":[{\"frequency_hz\":620.0,\"damping_ratio\":0.02},"
            "{\"frequency_hz\":900.0,\"damping_ratio\":0.03}],\"worn\":true,\"name\":\"EM12\"}");
  const Json fresh = tool_table().write(Tool{});
  EXPECT_FALSE(fresh.contains("mass_kg"));
}

struct Holder {
  std::optional<Kind> kind = {};
  std::optional<std::array<double, 2>> range_m = {};
};

TEST(Schema, ReadsWhatMayBeAbsent) {
  const Schema<Holder> table("holder", "what holds it",
                             {key("kind", &Holder::kind, kinds, "of its end"),
                              key("range_mm", &Holder::range_m, "from, to").slider(0.0, 10.0, 0.5)});
  const auto read_holder = [&](const std::string& text) {
    TomlFile file(TomlSource("holder.toml", "[holder]\n" + text));
    Holder out;
    table.read(file, "holder", out);
    return out;
  };
  EXPECT_FALSE(read_holder("").kind || read_holder("").range_m);
  EXPECT_EQ(read_holder("kind = \"ball-end\"\n").kind, Kind::ball);
  EXPECT_EQ(read_holder("range_mm = [1, 2]\n").range_m.value()[1], 2e-3);
  EXPECT_NE(test::rejection([&] { read_holder("kind = \"ball\"\n"); }).find("must be one of \"flat-end\""),
            std::string::npos);
  EXPECT_TRUE(table.write(Holder{})["kind"].is_null());
  EXPECT_EQ(table.write({.kind = Kind::flat})["kind"], "flat-end");
  EXPECT_EQ(table.info().keys[1].slider.value().step, 0.5);
}

TEST(Schema, RejectsByLineKeyValueAndRule) {
  const auto rejected = [](const std::string& from, const std::string& to) {
    std::string text = whole;
    text.replace(text.find(from), from.size(), to);
    return rejection([&] { static_cast<void>(read(text)); });
  };
  EXPECT_EQ(rejected("diameter_mm = 12", "diameter_mm = 0"), "tool.toml:3: tool.diameter_mm = 0 mm; must be > 0");
  EXPECT_NE(rejected("teeth = 3", "teeth = 0").find("tool.toml:2: tool.teeth = 0; must be >= 1"), std::string::npos);
  EXPECT_NE(rejected("damping_ratio = 0.03", "damping_ratio = 3").find("must lie between 0 and 1"), std::string::npos);
  EXPECT_NE(rejected("diameter_mm = 12\n", "").find("tool.diameter_mm: is missing. On its drawing"), std::string::npos)
      << rejected("diameter_mm = 12\n", "");
  EXPECT_NE(rejected("\"ball-end\"", "\"ball\"").find("must be one of \"flat-end\", \"ball-end\""), std::string::npos);
  EXPECT_NE(rejected("[6000, 12000]", "[6000]").find("must hold 2"), std::string::npos);
  EXPECT_NE(rejected("worn", "wron").find("Did you mean tool.worn?"), std::string::npos) << rejected("worn", "wron");
}

/// What is written from the whole object; a document of its own.
const Schema<Tool>& summary_table() {
  static const Schema<Tool> table(
      "summary", "a cutter in short",
      {key(
           "radius_mm", [](const Tool& tool) { return 0.5 * tool.diameter_m; }, "of the edges"),
       key(
           "title", [](const Tool& tool) { return tool.name; }, "as it is called")
           .nullable(),
       key(
           "state", [](const Tool& tool) { return tool.worn ? "worn" : "new"; }, "of its edges")
           .words({"worn", "new"}),
       key(
           "softest", [](const Tool& tool) { return tool.modes.empty() ? nullptr : &tool.modes.front(); }, mode_table(),
           "its first mode")
           .nullable(),
       key(
           "stiff", [](const Tool& tool) { return std::vector<Mode>(tool.modes.size()); }, mode_table(), "the others")},
      Use::written, 2);
  return table;
}

TEST(Schema, WritesWhatAFunctionOfTheObjectGives) {
  const Json fresh = summary_table().write(Tool{});
  EXPECT_EQ(
      fresh.dump(),
      "{\"document\":\"summary/2\",\"radius_mm\":5.0,\"title\":null,\"state\":\"new\",\"softest\":null,\"stiff\":[]}");
  const Json whole_tool = summary_table().write(read(whole));
  EXPECT_EQ(whole_tool["title"], "EM12");
  EXPECT_EQ(whole_tool["softest"]["frequency_hz"], 620.0);
  EXPECT_EQ(whole_tool["stiff"].size(), 2U);
}

TEST(Schema, NamesADocumentAndTheTablesThatItHolds) {
  const Json schema = json_schema(summary_table().info());
  EXPECT_EQ(schema["properties"]["document"]["const"], "summary/2");
  EXPECT_EQ(schema["required"][0], "document");
  EXPECT_EQ(schema["properties"]["softest"]["anyOf"], Json({{{"$ref", "#/$defs/mode"}}, {{"type", "null"}}}));
  EXPECT_EQ(schema["properties"]["stiff"]["items"], Json({{"$ref", "#/$defs/mode"}}));
  EXPECT_EQ(schema["$defs"].size(), 1U);
  EXPECT_EQ(schema["properties"]["title"]["type"], Json({"string", "null"}));
}

TEST(Schema, IsAJsonSchemaOfWhatItWrites) {
  const Json schema = json_schema(tool_table().info());
  EXPECT_EQ(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
  EXPECT_EQ(schema["additionalProperties"], false);
  EXPECT_EQ(schema["required"], Json({"teeth", "diameter_mm"}));
  const Json& keys = schema["properties"];
  EXPECT_EQ(keys["diameter_mm"],
            Json({{"type", "number"}, {"exclusiveMinimum", 0.0}, {"description", "over the edges [mm]"}}));
  EXPECT_EQ(keys["kind"]["enum"], Json({"flat-end", "ball-end"}));
  EXPECT_EQ(keys["kind"]["default"], "flat-end");
  EXPECT_EQ(keys["spindle_speed_rpm"]["minItems"], 2);
  EXPECT_EQ(schema["$defs"]["mode"]["properties"]["damping_ratio"]["default"], 0.02);
}

// What a list of lists holds at its ends is said once, and refers to itself.
TEST(Schema, OfNestedListsSaysWhatTheyHold) {
  TableInfo table{.name = "steps"};
  for (const char* name : {"values", "others"})
    table.keys.push_back({.name = name, .holds = Holds::number, .lists = 1, .also = {Holds::list}});
  const Json schema = json_schema(table);
  const Json self = {{"$ref", "#/$defs/nested_list"}}, number = {{"type", "number"}};
  const Json one = {{"anyOf", Json::array({number, self})}};
  for (const char* name : {"values", "others"})
    EXPECT_EQ(schema["properties"][name]["items"], one) << schema["properties"][name].dump();
  const Json plain = Json::array({number, {{"type", "string"}}, {{"type", "boolean"}}, self});
  EXPECT_EQ(schema["$defs"]["nested_list"], Json({{"type", "array"}, {"items", {{"anyOf", plain}}}}));
  EXPECT_EQ(schema["$defs"].size(), 1U);
}

struct Sensor {
  int port = 0;
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  std::vector<std::string> columns = {};
};

/// Columns by their names or by their numbers.
const Schema<Sensor>& sensor_table() {
  static const Schema<Sensor> table(
      "sensor", "where it stands, and its columns",
      {key("port", &Sensor::port, "none: any").at_least(1.0),
       key("origin_mm", &Sensor::origin_m, "in the flange's frame").entries(3, "[x, y, z]"),
       declared<Sensor>("columns", Holds::text, "names, or numbers from 1", 1)
           .or_one()
           .or_also(Holds::integer)
           .read_by([](TomlFile& file, const std::string& path, Sensor& out) {
             int number = 0;
             if (file.is_number(path)) file.integer(path, "columns", number);
             out.columns = {std::to_string(number)};
           })});
  return table;
}

TEST(Schema, ReadsAPlaceAndByCodeWhatHoldsMoreThanOneKind) {
  const auto sensor = [](const std::string& text) {
    TomlFile file(TomlSource("s.toml", text));
    Sensor out;
    sensor_table().read(file, "sensor", out);
    static_cast<void>(file.done());
    return out;
  };
  const Sensor read = sensor("[sensor]\norigin_mm = [1, 2, 3]\ncolumns = 4\n");
  EXPECT_EQ(read.origin_m, Eigen::Vector3d(1e-3, 2.0 * units::mm, 3.0 * units::mm));
  EXPECT_EQ(read.columns, std::vector<std::string>{"4"});
  EXPECT_EQ(rejection([&] { static_cast<void>(sensor("[sensor]\norigin_mm = [1, 2]\n")); }),
            "s.toml:2: sensor.origin_mm: must hold 3 entries; it holds 2. [x, y, z]");
  const Json keys = json_schema(sensor_table().info())["properties"], &columns = keys["columns"];
  const Json one = {{"anyOf", Json::array({{{"type", "string"}}, {{"type", "integer"}}})}};
  EXPECT_EQ(columns["anyOf"], Json::array({one, {{"type", "array"}, {"items", one}}}));
  EXPECT_FALSE(columns.contains("default"));
  EXPECT_FALSE(keys["port"].contains("default")) << "a value that the rule rejects is no default";
}

TEST(Schema, IsATableOfTheDocuments) {
  EXPECT_NE(markdown_table(tool_table().info()).find("| `diameter_mm` | mm, > 0 | required | over the edges |\n"),
            std::string::npos);
  EXPECT_NE(markdown_table(tool_table().info())
                .find("| `modes[].damping_ratio` | between 0 and 1 | 0.02 | share of critical |\n"),
            std::string::npos)
      << markdown_table(tool_table().info());
}

}  // namespace schema_test
}  // namespace robomill::io
