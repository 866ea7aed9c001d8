#include "robomill/jobs/init.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/cell/files/known_arms.hpp"
#include "robomill/coupling/files/assembly_toml.hpp"
#include "robomill/io/sample_source.hpp"
#include "robomill/io/toml/edit.hpp"
#include "robomill/io/toml/samples.hpp"
#include "robomill/jobs/files/job_toml.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"
#include "robomill/jobs/forces.hpp"
#include "robomill/jobs/predict.hpp"
#include "robomill/jobs/smooth.hpp"
#include "robomill/modal/files/hits_toml.hpp"
#include "robomill/modal/fit.hpp"
#include "robomill/monitor/files/monitor_toml.hpp"
#include "robomill/process/files/forces_toml.hpp"
#include "testing/samples.hpp"
#include "testing/support.hpp"
#include "testing/text.hpp"

namespace robomill::jobs {
namespace init_test {

constexpr Template every[] = {Template::job,      Template::hits,   Template::lobes,  Template::cell,
                              Template::assembly, Template::forces, Template::monitor};

std::string slurp(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// A program that stays near the part's zero.
constexpr const char* program = "G21 G90 G94\nG0 X0 Y0 Z20\nG1 Z0 F600\nG1 X30 F1200\nG1 Y20\nG1 X0\nG0 Z20\n";

/// Reads a document as its verb does.
void read(Template kind, const io::TomlSource& source) {
  switch (kind) {
    case Template::job:
      static_cast<void>(read_job(source));
      break;
    case Template::hits:
      static_cast<void>(modal::read_hits(source));
      break;
    case Template::lobes: {
      LobesFile file = read_lobes(source);
      load_dynamics(file);
      file.validate();
      break;
    }
    case Template::cell:
      static_cast<void>(cell::read_cell(source));
      break;
    case Template::assembly:
      static_cast<void>(coupling::read_assembly(source));
      break;
    case Template::forces:
      static_cast<void>(process::read_forces(source));
      break;
    case Template::monitor:
      static_cast<void>(monitor::read_monitor(source));
      break;
  }
}

class Init : public ::testing::Test {
 protected:
  InitFiles made(InitOptions options) {
    options.file = folder_.at("begin") / (std::string(name_in(template_names, options.kind)) + ".toml");
    std::filesystem::create_directories(options.file.parent_path());
    InitFiles files = init_files(options);
    write_init(files);
    return files;
  }
  [[nodiscard]] std::filesystem::path at(const std::string& name) const { return folder_.at("begin") / name; }
  /// As the calibration sheets would say them.
  void give_sensitivities() const {
    std::string text = slurp(at("hits.toml"));
    for (const auto& [key, value] : {std::pair{"force_mv_per_n", "2.25"}, {"response_mv_per_g", "100"}}) {
      text = io::with_setting(text, {std::string("acquisition.") + key, value});
    }
    put("hits.toml", text);
  }
  void put(const std::string& name, const std::string& content) const {
    std::filesystem::create_directories(folder_.at("begin"));
    folder_.file("begin/" + name, content);
  }

  test::Folder folder_;
};

TEST_F(Init, EveryExampleIsReadByItsVerb) {
  for (const Template kind : every) {
    const InitFiles files = made({.kind = kind, .example = true});
    EXPECT_NO_THROW(read(kind, files.files.front().path)) << name_in(template_names, kind);
    EXPECT_EQ(slurp(files.files.front().path), files.files.front().text);
    std::filesystem::remove_all(folder_.at("begin"));
  }
}

/// What a template says that is no comment.
std::string said(const std::string& document) {
  std::string out;
  std::istringstream rows(document);
  for (std::string row; std::getline(rows, row);) {
    if (!row.empty() && !row.starts_with('#')) out += row.substr(0, row.find(" #")) + "\n";
  }
  return out;
}

// What nobody has said is no fact: each verb names the first key that it lacks, at the line that shows it.
TEST_F(Init, WithoutAnExampleWhatNobodySaidIsAsked) {
  const std::pair<Template, const char*> asks[] = {{Template::hits, "hits[1].file: is missing"},
                                                   {Template::lobes, "tool.teeth: is missing"},
                                                   {Template::cell, "robot.model: is missing"},
                                                   {Template::assembly, "tool[1].length_mm: is missing"},
                                                   {Template::forces, "tool.kind: is missing"}};
  for (const auto& ask : asks) {
    const InitFiles files = made({.kind = ask.first});
    const std::string rejected = test::rejection([&] { read(ask.first, files.files.front().path); });
    EXPECT_NE(rejected.find(ask.second), std::string::npos) << name_in(template_names, ask.first) << ": " << rejected;
    EXPECT_NE(rejected.find(".toml:"), std::string::npos) << rejected;
    EXPECT_NE(rejected.find("This line is a comment: write your own value"), std::string::npos) << rejected;
    EXPECT_FALSE(std::filesystem::exists(at("example_hit_x.csv")));
    std::filesystem::remove_all(folder_.at("begin"));
  }
}

// Of every template what is said without an example is said with one too, and nothing of what is marked needed.
TEST_F(Init, ABlankTemplateHasNoSampleButChoicesThatAreMarked) {
  for (const Template kind : every) {
    const std::string blank = template_text(kind, false), example = template_text(kind, true);
    const io::TomlSource source("t.toml", blank);
    for (const Assumption& one : test_support::all_samples(source)) {
      EXPECT_TRUE(one.key.starts_with("smoothing.") || one.key == "lobes.axial_depth_mm") << one.key;
    }
    EXPECT_GE(test_support::all_samples(io::TomlSource("t.toml", example)).size(), 2U) << name_in(template_names, kind);
    EXPECT_LT(said(blank).size(), said(example).size()) << name_in(template_names, kind);
    EXPECT_EQ(blank.find("#!"), std::string::npos);
    EXPECT_EQ(example.find("#!"), std::string::npos);
    EXPECT_NE(blank.find("needed"), std::string::npos) << name_in(template_names, kind);
    for (const char* fact :
         {"frequency_hz = 6", "modal_mass_kg", "material =", "origin_mm =", "stiffness_n", "teeth ="}) {
      EXPECT_EQ(said(blank).find(fact), std::string::npos) << name_in(template_names, kind) << fact;
    }
  }
}

// What an example says is listed as assumed by the verb that reads it, until it is changed.
TEST_F(Init, ASampleValueIsAssumedUntilItIsChanged) {
  static_cast<void>(made({.kind = Template::lobes, .example = true}));
  const auto samples = [&] {
    std::vector<std::string> out;
    for (const Assumption& one : read_lobes(at("lobes.toml")).assumed) {
      if (one.what == io::sample_left) out.push_back(one.key);
    }
    return out;
  };
  EXPECT_EQ(std::ranges::count(samples(), "dynamics.x"), 1);
  const std::size_t all = samples().size();
  EXPECT_GE(all, 9U);
  put("lobes.toml", test_support::replaced(slurp(at("lobes.toml")), "teeth = 3 ", "teeth = 4 "));
  EXPECT_EQ(samples().size(), all - 1);
  EXPECT_EQ(std::ranges::count(samples(), "tool.teeth"), 0);
}

TEST_F(Init, TheMadeUpHitHasItsMode) {
  static_cast<void>(made({.kind = Template::hits, .example = true}));
  const modal::HitsFile hits = modal::read_hits(at("hits.toml"));
  const modal::FrfResult frfs = modal::estimate_frfs(hits.hits, hits.options);
  EXPECT_TRUE(frfs.hits.at(0).accepted);
  modal::FitOptions options;
  options.modes = 1;
  options.band_low_hz = 200.0;
  options.band_high_hz = 1200.0;
  const modal::FitResult fit = modal::fit_modes(frfs.set, options);
  ASSERT_EQ(fit.model.modes.size(), 1U);
  EXPECT_NEAR(fit.model.modes[0].frequency_hz, 620.0, 2.0);
  EXPECT_NEAR(fit.model.modes[0].damping_ratio, 0.03, 0.002);
}

TEST_F(Init, ForcesAssemblyAndCellRun) {
  static_cast<void>(made({.kind = Template::forces, .example = true}));
  EXPECT_TRUE(run_forces(at("forces.toml"), {}, {}, Progress::none()).revolution.has_value());
  static_cast<void>(made({.kind = Template::assembly, .example = true}));
  EXPECT_FALSE(predict_tip(at("assembly.toml")).peaks.empty());
  static_cast<void>(made({.kind = Template::cell, .example = true}));
  const process::SmoothResult smoothed =
      run_smooth({.program = folder_.file("part.ngc", program), .cell = at("cell.toml")});
  EXPECT_TRUE(smoothed.holds());
}

TEST_F(Init, MonitorTakesARecording) {
  static_cast<void>(made({.kind = Template::monitor}));
  const monitor::MonitorFile file = monitor::read_monitor(at("monitor.toml"));
  std::string record = "time_s,ax_m_per_s2\n";
  for (int i = 0; i < 2000; ++i) record += std::to_string(i * 1e-4) + "," + std::to_string(std::sin(0.3 * i)) + "\n";
  const auto source = io::open_samples(folder_.file("cut.csv", record), file.columns);
  EXPECT_NEAR(source->sample_rate_hz(), 1e4, 1.0);
  io::SampleBlock block;
  EXPECT_TRUE(source->next(100, block));
}

/// The keys of a template, those commented out too, with their values: "tool.teeth", "3".
std::vector<io::TomlSetting> keys_of(Template kind, bool commented) {
  std::vector<io::TomlSetting> keys;
  std::istringstream rows{template_text(kind, true)};
  std::string table;
  std::map<std::string, int> entries;
  for (std::string row; std::getline(rows, row);) {
    const bool comment = row.starts_with("# ");
    if (comment) row.erase(0, 2);
    const std::size_t equals = row.find(" = ");
    if (row.starts_with("[[")) {
      table = row.substr(2, row.find(']') - 2);
      table += "[" + std::to_string(comment ? 0 : entries[table]++) + "]";
    } else if (row.starts_with("[")) {
      table = row.substr(1, row.find(']') - 1);
    } else if (equals != std::string::npos &&
               row.find_first_not_of("abcdefghijklmnopqrstuvwxyz_0123456789") == equals) {
      if (comment != commented) continue;
      const std::string key = row.substr(0, equals);
      // Values that go over several lines are looked at by the readers alone.
      if (row.ends_with("= [")) continue;
      const auto value = io::setting_of(row, key);
      if (value) keys.push_back({.key = table.empty() ? key : table + "." + key, .value = *value});
    }
  }
  return keys;
}

/// A template with a key taken out of its comment; of a table that is commented out as a whole with those before it.
std::string with_key(Template kind, const std::vector<io::TomlSetting>& commented, const io::TomlSetting& key) {
  std::string text = template_text(kind, true);
  const auto table_of = [](const std::string& name) { return name.substr(0, name.rfind('.')); };
  const std::string table = table_of(key.key);
  const bool takes_effect = text.find("\n[" + table + "]") != std::string::npos;
  for (const io::TomlSetting& other : commented) {
    if (other.key == key.key) break;
    if (!takes_effect && table_of(other.key) == table) text = io::with_setting(text, other);
  }
  return io::with_setting(text, key);
}

/// Whether docs/formats.md has a key; units of joints' limits stand there apart from it.
bool documented(const std::string& key) {
  static const std::string docs = slurp(std::filesystem::path(ROBOMILL_SOURCE_DIR) / "docs" / "formats.md");
  const std::string last = key.substr(key.rfind('.') + 1);
  return docs.find(last.starts_with("joint_max") ? last.substr(0, last.find("_deg")) : last) != std::string::npos;
}

// A line taken out of its comment may ask for a file, or go without what stands beside it, but the key is known.
TEST_F(Init, NoTemplateHasAKeyThatIsNotKnown) {
  for (const Template kind : every) {
    const InitFiles files = made({.kind = kind, .example = true});
    const std::filesystem::path path = files.files.front().path;
    const std::vector<io::TomlSetting> commented = keys_of(kind, true);
    EXPECT_GE(commented.size(), 3U) << path;
    for (const io::TomlSetting& key : commented) {
      try {
        read(kind, io::TomlSource(path, with_key(kind, commented, key)));
      } catch (const InvalidInput& error) {
        EXPECT_EQ(std::string(error.what()).find("is not known here"), std::string::npos) << error.what();
      }
      EXPECT_TRUE(documented(key.key)) << key.key;
    }
    for (const io::TomlSetting& key : keys_of(kind, false)) EXPECT_TRUE(documented(key.key)) << key.key;
    std::filesystem::remove_all(folder_.at("begin"));
  }
}

/// Tables of a document, each with a key that it must have by docs/formats.md; not those of tables within tables.
std::set<std::pair<std::string, std::string>> required_in_docs(Template kind) {
  const std::string docs = slurp(std::filesystem::path(ROBOMILL_SOURCE_DIR) / "docs" / "formats.md");
  const std::string heading = "<!-- schema: " + std::string(name_in(template_names, kind)) + ".toml";
  std::set<std::pair<std::string, std::string>> keys;
  for (std::size_t at = docs.find(heading); at != std::string::npos; at = docs.find(heading, at + 1)) {
    std::istringstream rows(docs.substr(at, docs.find("<!-- end -->", at) - at));
    for (std::string row; std::getline(rows, row);) {
      if (!row.starts_with("| `") || row.find(" | required | ") == std::string::npos) continue;
      std::string path = row.substr(3, row.find('`', 3) - 3);
      std::erase_if(path, [](char c) { return c == '[' || c == ']'; });
      const std::size_t dot = path.find('.');
      if (dot != std::string::npos && dot == path.rfind('.')) keys.emplace(path.substr(0, dot), path.substr(dot + 1));
    }
  }
  return keys;
}

TEST_F(Init, EveryKeyThatIsRequiredStandsInTheTemplate) {
  std::size_t all = 0;
  for (const Template kind : every) {
    for (const auto& [table, key] : required_in_docs(kind)) {
      const std::string text = template_text(kind, false);
      if (text.find("[" + table + "]") == std::string::npos) continue;
      EXPECT_NE(text.find(key + " = "), std::string::npos) << key;
      ++all;
    }
  }
  EXPECT_GE(all, 3U);
}

TEST_F(Init, OverwritesNothing) {
  put("lobes.toml", "mine");
  EXPECT_EQ(test::rejection([&] { (void)made({.kind = Template::lobes}); }),
            at("lobes.toml").string() + ": exists, and is not overwritten. Name another file by -o, or move it");
  EXPECT_EQ(slurp(at("lobes.toml")), "mine");
  std::filesystem::create_symlink("nowhere", at("cell.toml"));
  EXPECT_THROW((void)made({.kind = Template::cell}), InvalidInput);
  EXPECT_THROW((void)init_files({.kind = Template::lobes, .file = "lobes.txt"}), InvalidInput);
}

TEST_F(Init, AJobBringsWhatItNames) {
  const InitFiles files = made({.kind = Template::job, .example = true});
  for (const char* name : {"job.toml", "hits.toml", "example_hit_x.csv"}) {
    EXPECT_TRUE(std::filesystem::exists(at(name))) << name;
  }
  EXPECT_EQ(files.files.size(), 3U);
  EXPECT_EQ(files.next, "plan " + at("job.toml").string() + " -o out/");
  const Job job = read_job(at("job.toml"));
  EXPECT_EQ(job.hits, at("hits.toml"));
  EXPECT_EQ(job.lobes, at("job.toml")) << "the job contains the cut";
  EXPECT_EQ(read_lobes(at("job.toml")).problem.milling.tool.teeth, 3);
  EXPECT_TRUE(job.directions.equal);
}

TEST_F(Init, AJobKeepsWhatIsThere) {
  static_cast<void>(made({.kind = Template::hits}));
  static_cast<void>(made({.kind = Template::lobes}));
  const InitFiles files = made({.kind = Template::job});
  EXPECT_EQ(files.files.size(), 1U);
  EXPECT_EQ(files.kept, (std::vector<std::filesystem::path>{at("hits.toml"), at("lobes.toml")}));
  EXPECT_EQ(read_job(at("job.toml")).lobes, at("lobes.toml"));
  EXPECT_EQ(slurp(at("job.toml")).find("[cut]"), std::string::npos);
}

/// A record of a hit in some columns.
std::string record(const std::string& names, double scale = 1.0, double period_s = 1e-4) {
  std::string text = names + "\n";
  for (int i = 0; i < 400; ++i) {
    const double force = i >= 150 && i < 160 ? 100.0 * std::sin(std::numbers::pi * (i - 150) / 10.0) : 0.0;
    const double response = i < 150 ? 0.0 : std::exp(-0.02 * (i - 150)) * std::sin(0.4 * (i - 150));
    text += std::to_string(i * period_s) + "," + std::to_string(scale * force) + "," +
            std::to_string(scale * response) + "," + std::to_string(0.5 * scale * response) + "\n";
  }
  return text;
}

TEST_F(Init, HitsNameTheRecordsOfTheFolder) {
  const std::string names = "time_s,force_n,ax_m_per_s2,ay_m_per_s2";
  for (const char* name : {"hit_x_10.csv", "hit_x_2.csv", "hit_y_1.csv"}) put(name, record(names));
  put("frf.csv", "frequency_hz,xx_re_m_per_n,xx_im_m_per_n\n1,2,3\n2,3,4\n");
  put("notes.txt", "no numbers\n");
  const InitFiles files = made({.kind = Template::hits});
  EXPECT_EQ(files.files.size(), 1U);
  EXPECT_FALSE(std::filesystem::exists(at("example_hit_x.csv")));
  const std::string text = slurp(at("hits.toml"));
  EXPECT_NE(text.find("force = \"force_n\"                   # guessed from its name: check\n"), std::string::npos)
      << text;
  EXPECT_NE(text.find("force_direction = \"y\"               # guessed from the file's name: check\n"),
            std::string::npos);
  const modal::HitsFile hits = modal::read_hits(at("hits.toml"));
  ASSERT_EQ(hits.hits.size(), 3U);
  EXPECT_EQ(hits.hits[0].file, at("hit_x_2.csv").string());
  EXPECT_EQ(hits.hits[1].file, at("hit_x_10.csv").string());
  EXPECT_EQ(hits.hits[2].excitation.axis, modal::Axis::y);
  EXPECT_EQ(hits.hits[2].responses.size(), 2U);
  EXPECT_EQ(files.notes.size(), 3U) << "found, and two left out";
  // Both directions are known then.
  static_cast<void>(made({.kind = Template::job}));
  EXPECT_FALSE(read_job(at("job.toml")).directions.equal);
}

TEST_F(Init, HitsInOtherUnitsAreConverted) {
  std::filesystem::create_directories(folder_.at("records"));
  folder_.file("records/tap1.csv", record("Time (s),Hammer (mV),acc x (mV),acc y (mV)"));
  static_cast<void>(made({.kind = Template::hits, .data = folder_.at("records")}));
  const std::string text = slurp(at("hits.toml"));
  for (const char* line : {"\nvoltage_unit = \"mV\" ", "\n# force_mv_per_n = 2.25 ", "\n# response_mv_per_g = 100 ",
                           "\nfile = \"../records/tap1.csv\"\n"}) {
    EXPECT_NE(text.find(line), std::string::npos) << line << text;
  }
  const std::string lacks = test::rejection([&] { (void)modal::read_hits(at("hits.toml")); });
  EXPECT_NE(lacks.find("acquisition.force_mv_per_n: is missing"), std::string::npos) << lacks;
  give_sensitivities();
  const modal::Hit in_mv = modal::read_hits(at("hits.toml")).hits.at(0);
  EXPECT_NEAR(in_mv.force_n(155), 100.0 / 2.25, 1e-3);
  std::filesystem::remove(at("hits.toml"));
  folder_.file("records/tap1.csv", record("Time (ms),Hammer (kN),acc x (g),acc y (g)"));
  static_cast<void>(made({.kind = Template::hits, .data = folder_.at("records")}));
  const modal::Hit in_g = modal::read_hits(at("hits.toml")).hits.at(0);
  EXPECT_NEAR(in_g.sample_rate_hz, 1e7, 1.0);
  EXPECT_NEAR(in_g.force_n(155), 1e5, 1.0);
  EXPECT_NEAR(in_g.responses[0].samples(160) / in_g.responses[1].samples(160), 2.0, 1e-3);
  EXPECT_NEAR(in_g.responses[0].samples(154), 9.80665 * std::exp(-0.08) * std::sin(1.6), 1e-3);
}

// Nothing that is assumed stays silent.
TEST_F(Init, UnitsThatNoRecordStatesAreListed) {
  put("hit_x_1.csv", record("time_s,force,ax,ay"));
  EXPECT_EQ(
      made({.kind = Template::hits}).notes,
      (std::vector<std::string>{
          "1 record of hits was found in " + at("").parent_path().string() + ": what is guessed is marked, check it.",
          "Assumed: Forces in records without a unit: N (acquisition.force_mv_per_n of hits.toml)",
          "Assumed: Responses in records without a unit: m/s² (acquisition.response_mv_per_m_per_s2 of "
          "hits.toml)"}));
  std::filesystem::remove(at("hits.toml"));
  put("hit_x_1.csv", record("time_s,force_n,ax_g,ay_g"));
  EXPECT_EQ(made({.kind = Template::hits}).notes.size(), 1U);
}

// 2.25 mV/N and 100 mV/g of each column in its own unit.
TEST_F(Init, HitsMayHaveTwoVoltageUnits) {
  for (const auto& [names, force_per_v, response_per_v] :
       {std::tuple{"t (s),Hammer (V),acc x (mV),acc y (mV)", 1.0, 1e-3},
        {"t (s),Hammer (mV),acc x (V),acc y (V)", 1e-3, 1.0}}) {
    put("tap.csv", record(names));
    static_cast<void>(made({.kind = Template::hits}));
    give_sensitivities();
    const modal::Hit hit = modal::read_hits(at("hits.toml")).hits.at(0);
    const double swing = std::exp(-0.08) * std::sin(1.6);
    EXPECT_NEAR(hit.force_n(155), force_per_v * 100.0 * 1000.0 / 2.25, 1e-3) << names;
    EXPECT_NEAR(hit.responses[0].samples(154) / (response_per_v * swing * 1000.0 / 100.0 * 9.80665), 1.0, 1e-4)
        << names;
    std::filesystem::remove(at("hits.toml"));
  }
}

TEST_F(Init, HitsInOtherUnitsThanTheFirstAreLeftOut) {
  put("hit_x_1.csv", record("t (s),Hammer (N),acc x (g),acc y (g)"));
  put("hit_x_2.csv", record("t (s),Hammer (N),acc x (m/s2),acc y (m/s2)"));
  put("hit_x_3.csv", record("t (s),Hammer (V),acc x (g),acc y (g)"));
  put("hit_x_4.csv", record("t (s),force_n,x_g,y_g"));
  put("hit_x_5.csv", record("t (s),Hammer (N),acc x (g),acc y (m/s2)"));
  const InitFiles files = made({.kind = Template::hits});
  const modal::HitsFile hits = modal::read_hits(at("hits.toml"));
  ASSERT_EQ(hits.hits.size(), 3U);
  EXPECT_EQ(hits.hits[1].file, at("hit_x_4.csv").string());
  EXPECT_EQ(hits.hits[2].responses.size(), 1U) << "a sensor in another unit has no part";
  ASSERT_EQ(files.notes.size(), 3U);
  EXPECT_EQ(
      files.notes[1],
      "Left out: hit_x_2.csv: its response is in m/s2, that of hit_x_1.csv in g, and hits.toml has one unit for all.");
  EXPECT_EQ(files.notes[2],
            "Left out: hit_x_3.csv: its force is in V, that of hit_x_1.csv in N, and hits.toml has one unit for all.");
}

// What most have is kept, whichever comes first.
TEST_F(Init, HitsAtOtherSampleRatesAreLeftOut) {
  const std::string names = "time_s,force_n,ax_m_per_s2,ay_m_per_s2";
  put("a_cut.csv", record(names, 1.0, 2e-4));
  for (const char* name : {"hit_x_1.csv", "hit_x_2.csv"}) put(name, record(names));
  const InitFiles files = made({.kind = Template::hits});
  EXPECT_EQ(modal::read_hits(at("hits.toml")).hits.size(), 2U);
  ASSERT_EQ(files.notes.size(), 2U);
  EXPECT_EQ(
      files.notes[1],
      "Left out: a_cut.csv: its sample rate is 5000 Hz, that of hit_x_1.csv 10000 Hz, and all hits must have one.");
}

TEST_F(Init, HitsTakeSoundWithoutNames) {
  std::vector<float> samples;
  for (int i = 0; i < 1000; ++i) {
    samples.push_back(i >= 300 && i < 310 ? 0.8F : 0.001F * static_cast<float>(i % 3));
    samples.push_back(i < 300 ? 0.0F : 0.2F * std::sin(0.3F * static_cast<float>(i)));
  }
  std::filesystem::create_directories(folder_.at("begin"));
  io::write_wav(at("hit_y.wav"), samples, 2, 10240.0);
  static_cast<void>(made({.kind = Template::hits}));
  EXPECT_NE(test::rejection([&] { (void)modal::read_hits(at("hits.toml")); }).find("acquisition."), std::string::npos);
  give_sensitivities();
  put("hits.toml", io::with_setting(slurp(at("hits.toml")), {"acquisition.scale", "1"}));
  const modal::Hit hit = modal::read_hits(at("hits.toml")).hits.at(0);
  EXPECT_EQ(hit.excitation.axis, modal::Axis::y);
  EXPECT_NEAR(hit.force_n(305), 0.8 * 1000.0 / 2.25, 0.1);
  EXPECT_EQ(hit.responses.at(0).dof.axis, modal::Axis::y);
}

TEST_F(Init, EveryKnownArmMakesACell) {
  for (const cell::KnownArm& arm : cell::known_arms()) {
    const InitFiles files = made({.kind = Template::cell, .robot = arm.name, .example = true});
    EXPECT_NO_THROW((void)run_smooth({.program = folder_.file("part.ngc", program), .cell = at("cell.toml")}))
        << arm.name;
    // The lists that stand behind a # are the arm's own, and exceed no limit where they are taken.
    std::string text = files.files.front().text;
    const cell::CellFile own = cell::read_cell(io::TomlSource("cell.toml", text));
    for (const char* key : {"joint_max_velocity_deg_per_s", "joint_max_acceleration_deg_per_s2",
                            "joint_max_jerk_deg_per_s3", "joint_stiffness_n_m_per_rad"}) {
      text = test_support::replaced(text, fmt::format("\n# {} = [", key), fmt::format("\n{} = [", key));
    }
    const cell::CellFile taken = cell::read_cell(io::TomlSource("cell.toml", text));
    for (std::size_t k = 0; k < 6; ++k) {
      const robot::Joint &ours = taken.robot.arm.joints[k], &theirs = own.robot.arm.joints[k];
      for (const auto value : {&robot::Joint::max_velocity, &robot::Joint::max_acceleration, &robot::Joint::max_jerk,
                               &robot::Joint::stiffness}) {
        EXPECT_LE(ours.*value, theirs.*value * (1.0 + 1e-8)) << arm.name << k;
        EXPECT_GT(ours.*value, theirs.*value * (1.0 - 1e-3)) << arm.name << k;
      }
    }
    std::filesystem::remove(at("cell.toml"));
  }
  const std::string said = test::rejection([&] { (void)made({.kind = Template::cell, .robot = "robbie"}); });
  EXPECT_NE(said.find("\"robbie\": is no robot that is known here. There are "), std::string::npos) << said;
  EXPECT_THROW((void)init_files({.kind = Template::lobes, .robot = "ur-5e"}), InvalidInput);
  EXPECT_THROW((void)init_files({.kind = Template::lobes, .data = "."}), InvalidInput);
  EXPECT_THROW((void)init_files({.kind = Template::hits, .file = "h.toml", .data = folder_.at("none")}), InvalidInput);
}

// A placement and a length of data/cells are shown, and not taken.
TEST_F(Init, ACellOfAKnownArmAsksWhereItStands) {
  static_cast<void>(made({.kind = Template::cell, .robot = "ur-5e"}));
  EXPECT_NE(test::rejection([&] { (void)cell::read_cell(at("cell.toml")); }).find("workpiece.origin_mm: is missing"),
            std::string::npos);
  std::string text = io::with_setting(slurp(at("cell.toml")), {"workpiece.origin_mm", "[-500, -133, 0]"});
  const std::string length = test::rejection([&] { (void)cell::read_cell(io::TomlSource("cell.toml", text)); });
  EXPECT_NE(length.find("tool.length_mm: is missing"), std::string::npos) << length;
  text = io::with_setting(text, {"tool.length_mm", "150"});
  EXPECT_EQ(cell::read_cell(io::TomlSource("cell.toml", text)).model, "ur-5e");
}

// Which hits were made is known; what the other direction is like is not.
TEST_F(Init, AJobAsksWhatADirectionIsLikeThatWasNotHit) {
  put("hit_x_1.csv", record("time_s,force_n,ax_m_per_s2,unused"));
  static_cast<void>(made({.kind = Template::job}));
  const std::string text = slurp(at("job.toml"));
  EXPECT_NE(text.find("\n# equal_directions = true           # needed: only x was hit: is y like it?"),
            std::string::npos)
      << text;
  EXPECT_FALSE(read_job(at("job.toml")).directions.equal);
}

// Formats that are not read are named with what to do, and no example stands in their place.
TEST_F(Init, RecordsThatAreNotReadAreNamed) {
  put("hit_x_1.tdm", "<usi:tdm>\n");
  put("hit_x_2.mf4", "MDF");
  const InitFiles files = made({.kind = Template::hits});
  EXPECT_EQ(files.files.size(), 1U);
  EXPECT_EQ(slurp(at("hits.toml")).find("\nfile ="), std::string::npos);
  ASSERT_EQ(files.notes.size(), 3U);
  EXPECT_NE(files.notes[0].find("No records of hits were found"), std::string::npos);
  for (const std::size_t i : {1U, 2U}) {
    EXPECT_NE(files.notes[i].find("which is not read yet"), std::string::npos) << files.notes[i];
    EXPECT_NE(files.notes[i].find("Export it as CSV"), std::string::npos) << files.notes[i];
  }
}

// Rate and units are in the file, and are no settings.
TEST_F(Init, HitsOfLabviewAreRead) {
  std::string text =
      "LabVIEW Measurement\t\nSeparator\tTab\nDecimal_Separator\t,\nX_Columns\tNo\n***End_of_Header***\t\n\t\n"
      "Channels\t2\t\t\nY_Unit_Label\tNewtons\tg\t\nX_Dimension\tTime\tTime\t\nDelta_X\t3,906250E-5\t3,906250E-5\t\n"
      "***End_of_Header***\t\t\t\nX_Value\tHammer\tAcc\tComment\n";
  for (int i = 0; i < 2000; ++i) {
    const double response = i < 150 ? 0.0 : std::exp(-0.01 * (i - 150)) * std::sin(0.4 * (i - 150));
    std::string row = fmt::format("\t{}\t{:.6f}\n", i == 150 ? 100 : 0, response);
    std::ranges::replace(row, '.', ',');
    text += row;
  }
  put("hit_x_1.lvm", text);
  static_cast<void>(made({.kind = Template::hits}));
  EXPECT_EQ(slurp(at("hits.toml")).find("\nsample_rate_hz"), std::string::npos);
  const modal::Hit hit = modal::read_hits(at("hits.toml")).hits.at(0);
  EXPECT_NEAR(hit.sample_rate_hz, 25600.0, 1e-6);
  EXPECT_EQ(hit.force_n(150), 100.0);
  EXPECT_NEAR(hit.responses.at(0).samples(154), 9.80665 * std::exp(-0.04) * std::sin(1.6), 1e-5);
}

// Several hits of a record, and force and responses in files of their own.
TEST_F(Init, HitsInOneRecordAndInSeveralFilesAreFound) {
  const auto text = [](const std::string& header, bool force, bool response) {
    std::string out = header;
    for (int i = 0; i < 30'000; ++i) {
      const int since = i % 10'000 - 150;
      const double pushed = since >= 0 && since < 10 ? 100.0 * std::sin(std::numbers::pi * since / 10.0) : 0.0;
      const double moved = since < 0 ? 0.0 : std::exp(-0.01 * since) * std::sin(0.4 * since);
      out += fmt::format("{:.4f}", i * 1e-4);
      if (force) out += fmt::format(",{:.6f}", pushed);
      if (response) out += fmt::format(",{:.6f}", moved);
      out += "\n";
    }
    return out;
  };
  put("hit_x_1.csv", text("time_s,force_n,ax_m_per_s2\n", true, true));
  put("force_x_2.csv", text("time_s,force_n\n", true, false));
  put("acc_x_2.csv", text("time_s,ax_m_per_s2\n", false, true));
  const InitFiles files = made({.kind = Template::hits});
  EXPECT_EQ(files.notes.size(), 1U);
  const std::string document = slurp(at("hits.toml"));
  EXPECT_NE(document.find("\nfile = \"hit_x_1.csv\"                # 3 hits, which are cut apart\n"), std::string::npos)
      << document;
  EXPECT_NE(document.find("\nfile = [\"force_x_2.csv\", \"acc_x_2.csv\"] # 3 hits, which are cut apart\n"),
            std::string::npos)
      << document;
  EXPECT_EQ(modal::read_hits(at("hits.toml")).hits.size(), 6U);
}

// A time with three digits is no response; its rate is that of the whole column.
TEST_F(Init, ARoundedTimeIsTheTime) {
  std::string text = "X,force_n,acc x\n";
  for (int i = 0; i < 2000; ++i) {
    const double response = i < 150 ? 0.0 : std::exp(-0.01 * (i - 150)) * std::sin(0.4 * (i - 150));
    text += fmt::format("{:.2e},{},{:.6f}\n", i / 4000.0, i == 150 ? 100 : 0, response);
  }
  put("hit_x_1.csv", text);
  static_cast<void>(made({.kind = Template::hits}));
  const modal::Hit hit = modal::read_hits(at("hits.toml")).hits.at(0);
  EXPECT_NEAR(hit.sample_rate_hz, 4000.0, 1.0);
  ASSERT_EQ(hit.responses.size(), 1U);
  EXPECT_NEAR(hit.responses[0].samples(154), std::exp(-0.04) * std::sin(1.6), 1e-5);
}

}  // namespace init_test
}  // namespace robomill::jobs
