// No document takes an implausible number in silence, whichever it is.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/coupling/files/assembly_toml.hpp"
#include "robomill/coupling/files/joint_json.hpp"
#include "robomill/coupling/files/tools_csv.hpp"
#include "robomill/cutting/files/coefficients_toml.hpp"
#include "robomill/cutting/files/materials_toml.hpp"
#include "robomill/cutting/files/slots_csv.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/records/records.hpp"
#include "robomill/io/text.hpp"
#include "robomill/io/toml/lines.hpp"
#include "robomill/io/usual_ranges.hpp"
#include "robomill/jobs/files/job_toml.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"
#include "robomill/modal/files/fit_toml.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/modal/files/hits_toml.hpp"
#include "robomill/modal/files/modes_files.hpp"
#include "robomill/monitor/files/monitor_toml.hpp"
#include "robomill/monitor/files/recordings_toml.hpp"
#include "robomill/process/files/forces_toml.hpp"
#include "robomill/robot/files/loads_csv.hpp"
#include "testing/support.hpp"
#include "testing/text.hpp"

namespace robomill::jobs {
namespace unusual_documents_test {

namespace fs = std::filesystem;
using Notes = std::vector<std::string>;

const fs::path source = ROBOMILL_SOURCE_DIR;

/// A TOML document and what its reader has to say of it.
struct Kind {
  const char* name;
  fs::path example = {};       ///< of the source, …
  const char* text = nullptr;  ///< … or a text
  std::size_t least_keys = 1;  ///< of the document that leave their range
  std::function<Notes(const io::TomlSource&)> read = {};
};

std::vector<Kind> kinds() {
  return {
      {.name = "job.toml",
       .text =
           "[job]\nlobes = \"lobes.toml\"\nmodes = \"modes.json\"\n[spindle]\nmin_speed_rpm = 3000\nmax_speed_rpm = "
           "18000\n[tool]\nmax_axial_depth_mm = 5\n[[cuts]]\nspindle_speed_rpm = 9000\naxial_depth_mm = 1\n"
           "result = \"stable\"\n",
       .least_keys = 3,
       .read = [](const io::TomlSource& s) { return read_job(s).notes; }},
      {.name = "hits.toml",
       .text = "[acquisition]\nresponse = \"acceleration\"\nforce_mv_per_n = 2.2\nresponse_mv_per_g = 1000\n"
               "accelerometer_mass_kg = 0.005\nmax_frequency_hz = 500\n[[hits]]\nfile = \"hit.csv\"\nforce = \"f\"\n"
               "force_direction = \"x\"\nresponses = { x = \"a\" }\n",
       .least_keys = 3,
       .read = [](const io::TomlSource& s) { return modal::read_hits(s).notes; }},
      {.name = "hits.toml of a tap test",
       .text =
           "[acquisition]\nresponse = \"acceleration\"\nsample_rate_hz = 51200\nforce_mv_per_n = 2.2\n"
           "response_mv_per_g = 1000\n[[hits]]\nforce = \"f\"\nforce_direction = \"x\"\nresponses = { x = \"a\" }\n",
       .least_keys = 2,
       .read = [](const io::TomlSource& s) { return modal::read_hit_rows(s).notes; }},
      {.name = "lobes.toml",
       .example = "examples/first-lobes/lobes.toml",
       .least_keys = 4,
       .read = [](const io::TomlSource& s) { return read_lobes(s).notes; }},
      {.name = "forces.toml",
       .example = "examples/force-along-program/forces.toml",
       .least_keys = 3,
       .read = [](const io::TomlSource& s) { return process::read_forces(s, process::ForcesJob::program).notes; }},
      {.name = "cell.toml",
       .example = "data/cells/kuka-kr210-r2700.toml",
       .least_keys = 3,
       .read = [](const io::TomlSource& s) { return cell::read_cell(s, cell::Robots::any).notes; }},
      {.name = "assembly.toml",
       .example = "examples/joint-bar/rigid.toml",
       .least_keys = 4,
       .read = [](const io::TomlSource& s) { return coupling::read_assembly(s).notes; }},
      {.name = "coefficients.toml",
       .text = "[coefficients]\ntangential_n_per_mm2 = 700\nradial_n_per_mm2 = 280\ntangential_edge_n_per_mm = 13\n",
       .least_keys = 3,
       .read =
           [](const io::TomlSource& s) {
             Notes notes;
             static_cast<void>(cutting::read_coefficients(s, notes));
             return notes;
           }},
      {.name = "materials.toml",
       .example = "data/materials.toml",
       .least_keys = 20,
       .read =
           [](const io::TomlSource& s) {
             Notes notes;
             static_cast<void>(cutting::read_materials(s, notes));
             return notes;
           }},
      {.name = "modes.toml",
       .example = "data/robot-modes.toml",
       .least_keys = 5,
       .read =
           [](const io::TomlSource& s) {
             Notes notes;
             static_cast<void>(modal::read_modes(s, notes));
             return notes;
           }},
      {.name = "options of the fit",
       .text = "[fit]\nband_hz = [50, 2000]\n",
       .read =
           [](const io::TomlSource& s) {
             Notes notes;
             static_cast<void>(modal::read_fit_options(s, notes));
             return notes;
           }},
      {.name = "monitor.toml",
       .text = "[signal]\nsample_rate_hz = 25600\nchannels = [\"ax\"]\ntimeout_s = 2\n[process]\n"
               "spindle_speed_rpm = 9000\nteeth = 2\n[detector]\nfalse_alarms_per_hour = 1\n[act]\nrule = \"reduce\"\n"
               "calm_s = 5\nsettle_s = 2\n",
       .least_keys = 4,
       .read = [](const io::TomlSource& s) { return monitor::read_monitor(s).notes; }},
      {.name = "recordings.toml",
       .text = "[signal]\nsample_rate_hz = 25600\nchannels = [\"ax\"]\n[process]\nspindle_speed_rpm = 9000\nteeth = 2\n"
               "[[recordings]]\nfile = \"a.wav\"\nlabel = \"stable\"\nspindle_speed_rpm = 8000\n[[recordings]]\n"
               "file = \"b.wav\"\nlabel = \"stable\"\n[[recordings]]\nfile = \"c.wav\"\nlabel = \"chatter\"\n"
               "[[recordings]]\nfile = \"d.wav\"\nlabel = \"chatter\"\n",
       .least_keys = 2,
       .read = [](const io::TomlSource& s) { return monitor::read_recordings(s).monitor.notes; }},
  };
}

std::string joined(const Notes& notes) {
  std::string all;
  for (const std::string& note : notes) all += note + "\n";
  return all;
}

/// The numbers of a value times 1000; none where it is something else than numbers.
std::vector<double> thousandfold(std::string_view value) {
  std::vector<double> out;
  value = io::trimmed(value.substr(0, value.find('#')));
  if (value.starts_with('[') && value.ends_with(']')) value = value.substr(1, value.size() - 2);
  while (!value.empty()) {
    const std::size_t end = std::min(value.find(','), value.size());
    const std::optional<double> number = io::parse_number(io::trimmed(value.substr(0, end)));
    if (!number) return {};
    out.push_back(1000.0 * *number);
    value.remove_prefix(std::min(end + 1, value.size()));
  }
  return out;
}

void write_hit(const test::Folder& folder) {
  std::string record = "time_s,f,a\n";
  for (int i = 0; i < 400; ++i) {
    record += fmt::format("{:.4f},{},{}\n", i * 1e-3, i == 20 ? 0.5 : 0.0, i > 20 ? 0.01 * (i % 7) : 0.0);
  }
  folder.file("hit.csv", record);
}

// One number of a document a thousandfold at a time: whoever reads it warns of it by its key, or rejects it.
TEST(UnusualDocuments, AreWarnedOfByEveryReader) {
  test::Folder folder;
  write_hit(folder);
  for (const Kind& kind : kinds()) {
    const std::string text = kind.text != nullptr ? kind.text : io::read_file(source / kind.example);
    const fs::path path = kind.text != nullptr ? folder.at("document.toml") : source / kind.example;
    ASSERT_EQ(joined(kind.read(io::TomlSource(path, text))).find("is unusual"), std::string::npos) << kind.name;
    std::size_t keys = 0;
    for (const io::TomlLine& line : io::toml_lines(text)) {
      if (line.is_comment) continue;
      const std::vector<double> wrong = thousandfold(line.text.substr(line.text.find('=') + 1));
      if (wrong.empty() || !io::unusual_value(line.key, wrong)) continue;
      ++keys;
      const std::string value =
          wrong.size() == 1 ? fmt::format("{}", wrong[0]) : fmt::format("[{}]", fmt::join(wrong, ", "));
      try {
        const std::string said = joined(kind.read(io::TomlSource(path, text, {{line.key, value}})));
        EXPECT_NE(said.find(line.key.substr(line.key.rfind('.') + 1)), std::string::npos)
            << kind.name << ": " << line.key << " = " << value << " says: " << said;
      } catch (const InvalidInput&) {
        // It contradicts another key, which is no silence either.
      }
    }
    EXPECT_GE(keys, kind.least_keys) << kind.name;
  }
}

TEST(UnusualDocuments, AreWarnedOfInJson) {
  test::Folder folder;
  Notes notes;
  static_cast<void>(
      modal::read_modes(folder.file("modes.json", R"({"modes": [{"frequency_hz": 720000, "damping_ratio": 0.03,
        "left": {"x": [1, 0]}, "right": {"x": [1, 0]}, "std": {"frequency_hz": 0.1, "damping_ratio": 1e-5}}]})"),
                        notes));
  ASSERT_EQ(notes.size(), 1U) << joined(notes);
  EXPECT_NE(notes[0].find("modes.json: modes[1].frequency_hz = 720000 Hz; is unusual"), std::string::npos) << notes[0];

  const coupling::JointFile joint = coupling::read_joint_json(folder.file(
      "joint.json", R"({"joint": {"translational_stiffness_n_per_m": 4e13, "translational_damping_n_s_per_m": 20,
        "rotational_stiffness_n_m_per_rad": 2e4, "rotational_damping_n_m_s_per_rad": 0.5}})"));
  EXPECT_NE(joined(joint.warnings).find("joint.translational_stiffness_n_per_m = 4"), std::string::npos)
      << joined(joint.warnings);

  const Notes tip = modal::read_frfs({folder.file("tip.json", R"({"frequency_hz": [1e5, 2e5, 3e5],
        "receptance_m_per_n": {"xx": {"re": [1e-8, 1e-8, 1e-8], "im": [-1e-9, -1e-9, -1e-9]}}})")})
                        .notes;
  EXPECT_NE(joined(tip).find("frequency_hz = 300000 Hz; is unusual"), std::string::npos) << joined(tip);
}

TEST(UnusualDocuments, AreWarnedOfInTables) {
  test::Folder folder;
  const cutting::SlotsFile slots = cutting::read_slots(
      folder.file("slots.csv", "feed_per_tooth_mm,axial_depth_mm,fx_n,fy_n,fz_n\n0.1,2,100,90,20\n100,2,200,150,30\n"));
  EXPECT_NE(joined(slots.notes).find("slots.csv:3: feed_per_tooth_mm = 100 mm; is unusual"), std::string::npos)
      << joined(slots.notes);

  Notes notes;
  static_cast<void>(coupling::read_tools(folder.file("tools.csv", "tool,length_mm,diameter_mm\na,60,12\nb,60000,12\n"),
                                         coupling::Segment{.youngs_modulus_pa = 6e11, .density_kg_per_m3 = 14'400},
                                         notes));
  EXPECT_NE(joined(notes).find("tools.csv:3: length_mm = 60000 mm; is unusual"), std::string::npos) << joined(notes);

  const robot::Arm arm = cell::read_cell(source / "data/cells/kuka-kr210-r2700.toml", cell::Robots::any).robot.arm;
  const std::string head = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,fx_n,fy_n,fz_n,dx_mm,dy_mm,dz_mm\n";
  const robot::LoadsFile loads =
      robot::read_loads(folder.file("loads.csv", head + "0.312,-0.871,1.934,0.208,0.777,0.05,300,0,0,150,0,0\n"), arm);
  EXPECT_NE(joined(loads.notes).find("joints_deg"), std::string::npos) << joined(loads.notes);
  EXPECT_NE(joined(loads.notes).find("dx_mm = 150 mm; is unusual"), std::string::npos) << joined(loads.notes);

  const io::Record record =
      io::read_record(folder.file("hit.csv", "time_s,force_n,ax_g\n0,0,0\n0.001,0.025,3\n0.002,0,1\n"));
  EXPECT_NE(joined(record.notes).find("force_n = 0.025 N; is unusual"), std::string::npos) << joined(record.notes);
}

}  // namespace unusual_documents_test
}  // namespace robomill::jobs
