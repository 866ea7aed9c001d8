#include "robomill/io/json.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/json_text.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace json_test {

using test::Folder;
using test::rejection;

TEST(JsonText, WritesForPeopleToo) {
  Json json;
  json["speed_rpm"] = number(4000.0 * units::rpm / units::rpm);
  json["none"] = number(std::numeric_limits<double>::quiet_NaN());
  json["list"] = numbers(Eigen::Vector3d(1.0, 0.1, std::numeric_limits<double>::infinity()));
  json["pairs"] = Json::array({complex_number({1.0, -2.0}), complex_number({3.0, 4.0})});
  json["h"] = complex_numbers(Eigen::Vector2cd(std::complex<double>(1.0, 2.0), 3.0));
  json["rows"] = Json::array({Json{{"a", 1}}, Json{{"a", 2}}});
  json["empty"] = Json::array();
  json["text"] = "a \"b\"\n\xFF";
  EXPECT_EQ(dump(json),
            "{\n  \"speed_rpm\": 4000.0,\n  \"none\": null,\n  \"list\": [1.0, 0.1, null],\n"
            "  \"pairs\": [[1.0, -2.0], [3.0, 4.0]],\n"
            "  \"h\": {\n    \"re\": [1.0, 3.0],\n    \"im\": [2.0, 0.0]\n  },\n"
            "  \"rows\": [\n    {\n      \"a\": 1\n    },\n    {\n      \"a\": 2\n    }\n  ],\n"
            "  \"empty\": [],\n  \"text\": \"a \\\"b\\\"\\n\xEF\xBF\xBD\"\n}\n");
}

TEST(JsonText, IsTheSameKeyByKeyAndEntryByEntry) {
  for (const std::size_t entries : {0U, 1U, 3U}) {
    Json json = {{"before", numbers(Eigen::Vector2d(1.0, 2.0))}, {"rows", Json::array()}, {"after", Json::object()}};
    for (std::size_t i = 0; i < entries; ++i) json["rows"].push_back({{"a", i}, {"b", Json::array({1, 2})}});
    std::string text;
    JsonText pieces([&](std::string_view piece) { text += piece; });
    pieces.add("before", json["before"]);
    pieces.begin_list("rows");
    for (const Json& row : json["rows"]) pieces.add_entry(row);
    pieces.end_list();
    pieces.add("after", json["after"]);
    pieces.end();
    EXPECT_EQ(text, dump(json));
  }
  std::string text;
  JsonText([&](std::string_view piece) { text += piece; }).end();
  EXPECT_EQ(text, dump(Json::object()));
}

TEST(JsonText, GivesBackEveryBit) {
  Random random(5);
  Eigen::VectorXd values(1000);
  for (double& value : values) value = random.normal() * std::pow(10.0, random.uniform(-300.0, 300.0));
  const Json read = Json::parse(dump({{"values", numbers(values)}}));
  EXPECT_EQ(JsonNode(read, "f.json").at("values").numbers(), values);
}

TEST(AssumedJson, HasNullWhereThereIsNoKey) {
  const Json list = assumed_json({{.what = "Stock", .taken = "a box", .key = "stock.kind", .file = "forces.toml"},
                                  {.what = "Unit", .taken = "m/N"}});
  EXPECT_EQ(list[0], Json::parse(R"({"what":"Stock","taken":"a box","key":"stock.kind","file":"forces.toml"})"));
  EXPECT_EQ(list[1], Json::parse(R"({"what":"Unit","taken":"m/N","key":null,"file":null})"));
}

TEST(JsonNode, ReportsErrorsWithTheirPath) {
  const Json json = Json::parse(R"({"modes": [{"f": 1}, {"f": "two", "left": {"x": [1, null]}}], "n": 5})");
  const JsonNode root(json, "f.json");
  EXPECT_EQ(root.at("modes").at(0).at("f").number(), 1.0);
  EXPECT_EQ(rejection([&] { (void)root.at("modes").at(1).at("f").number(); }),
            "f.json: modes[2].f = \"two\"; must be a finite number");
  EXPECT_EQ(rejection([&] { (void)root.at("modes").at(1).at("left").at("x").complex_number(); }),
            "f.json: modes[2].left.x[2] = null; must be a finite number");
  EXPECT_EQ(rejection([&] { (void)root.at("modes").at(0).at("g"); }), "f.json: modes[1].g: is missing");
  EXPECT_EQ(rejection([&] { (void)root.at("n").at("g"); }), "f.json: n = 5; must be an object {…}");
  EXPECT_EQ(rejection([&] { (void)root.at("n").size(); }), "f.json: n = 5; must be a list […]");
  EXPECT_EQ(rejection([&] { (void)root.at("modes").numbers(); }), "f.json: modes[1]: must be a finite number");
  EXPECT_EQ(rejection([&] { (void)root.at("n").text(); }), "f.json: n = 5; must be text");
  EXPECT_FALSE(root.at("n").has("g"));
}

TEST(JsonFile, SaysWhereItIsBroken) {
  const Folder folder;
  EXPECT_EQ(rejection([&] {
              (void)read_json(folder.file("a.json", "{\n\"a\": 1,\n}"));
            }).find(folder.at("a.json").string() + ":3: is no JSON: "),
            0u);
  EXPECT_NE(rejection([&] { (void)read_json(folder.file("b.json", "{\"a\": 1e999}")); }).find("is no JSON"),
            std::string::npos);
  EXPECT_NE(rejection([&] { (void)read_json(folder.file("c.json", "")); }).find("is empty"), std::string::npos);
  // Depth alone must not end the program, well-formed or not.
  const auto nested = [](const std::string& open, int depth, const std::string& close) {
    std::string text;
    for (int i = 0; i < depth; ++i) text += open;
    text += "1";
    for (int i = 0; i < depth; ++i) text += close;
    return text;
  };
  for (const auto& brackets : {std::pair{"[", "]"}, {"{\"a\":", "}"}, {"[{\"a\\\"\":", "}]"}}) {
    EXPECT_NE(rejection([&] {
                (void)read_json(folder.file("d.json", "\n" + nested(brackets.first, 1000000, brackets.second)));
              }).find("d.json:2: is no JSON that is read here: it nests its values more than 256 deep"),
              std::string::npos);
  }
  EXPECT_TRUE(read_json(folder.file("d.json", nested("[", 256, "]"))).is_array());
  EXPECT_TRUE(read_json(folder.file("d.json", "\"" + nested("[", 1000, "]") + "\"")).is_string());
  EXPECT_NE(rejection([&] { (void)read_json(folder.file("d.json", std::string(1000000, '['))); }).find("is no JSON"),
            std::string::npos);
}

}  // namespace json_test
}  // namespace robomill::io
