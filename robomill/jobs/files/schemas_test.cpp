#include "robomill/jobs/files/schemas.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "robomill/io/file.hpp"
#include "robomill/io/json.hpp"
#include "testing/support.hpp"

namespace robomill::jobs {
namespace schemas_test {

const std::filesystem::path docs = std::filesystem::path(ROBOMILL_SOURCE_DIR) / "docs";

/// Compares a committed file with what it is made from. ROBOMILL_UPDATE=1 writes it anew.
void expect_current(const std::filesystem::path& file, const std::string& text) {
  if (std::getenv("ROBOMILL_UPDATE") != nullptr) std::ofstream(file, std::ios::binary) << text;
  ASSERT_TRUE(std::filesystem::exists(file)) << file << " is missing; ROBOMILL_UPDATE=1 writes it";
  EXPECT_EQ(io::read_file(file), text) << file << " is stale; ROBOMILL_UPDATE=1 writes it anew";
}

TEST(Schemas, AreThoseOfTheDocs) {
  std::size_t files = 0;
  for (const std::string& name : schema_names())
    expect_current(docs / "schema" / (name + ".schema.json"), schema_text(name));
  for (const auto& entry : std::filesystem::directory_iterator(docs / "schema"))
    files += entry.is_regular_file() ? 1 : 0;
  EXPECT_EQ(files, schema_names().size()) << "docs/schema has a file of no document";
}

// Between "<!-- schema: NAME -->" and "<!-- end -->".
TEST(Schemas, TablesOfTheDocsAreTheirs) {
  const std::string text = io::read_file(docs / "formats.md");
  const std::string opening = "<!-- schema: ", closing = "<!-- end -->";
  std::string current;
  std::size_t from = 0, tables = 0;
  for (std::size_t at = 0; (at = text.find(opening, from)) != std::string::npos; ++tables) {
    const std::size_t line = text.find('\n', at), end = text.find(closing, line);
    ASSERT_NE(end, std::string::npos);
    const std::size_t name = at + opening.size();
    current += text.substr(from, line + 1 - from) + schema_table(text.substr(name, text.find(" -->", name) - name));
    from = end;
  }
  expect_current(docs / "formats.md", current + text.substr(from));
  EXPECT_GE(tables, 3U);
}

TEST(Schemas, OfAnUnknownDocumentNamesTheKnownOnes) {
  EXPECT_NE(test::rejection([] { static_cast<void>(schema_text("lobe.json")); }).find("lobes.json"), std::string::npos);
}

// One table of a document, whichever of them; several readers know a part of [tool].
TEST(Schemas, OfTomlDocumentsHaveTheTablesOfTheirReaders) {
  const std::string table = schema_table("job.toml spindle tool");
  for (const char* key :
       {"`spindle.curve[].power_kw` | kW, >= 0 | required", "`tool.teeth`", "`tool.max_axial_depth_mm`"})
    EXPECT_NE(table.find(key), std::string::npos) << key << table;
  EXPECT_EQ(table.find("safety"), std::string::npos);
  EXPECT_EQ(schema_table("plan.json decision").find("required"), std::string::npos) << "nobody writes it";
  for (const char* name : {"lobes.toml", "job.toml", "forces.toml", "cell.toml", "hits.toml", "monitor.toml"}) {
    const io::Json keys = io::Json::parse(schema_text(name))["properties"];
    for (const char* key : {"include", "tool", "lobes", "job", "robot", "hits", "signal"})
      EXPECT_TRUE(keys.contains(key)) << name << key;
    EXPECT_FALSE(keys.contains("document")) << name;
  }
}

}  // namespace schemas_test
}  // namespace robomill::jobs
