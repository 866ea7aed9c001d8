#include "robomill/jobs/files/schemas.hpp"

#include <algorithm>
#include <deque>
#include <iterator>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/cell/files/cell_tables.hpp"
#include "robomill/cell/files/check_json.hpp"
#include "robomill/cell/files/posture_json.hpp"
#include "robomill/coupling/files/assembly_schema.hpp"
#include "robomill/coupling/files/joint_json.hpp"
#include "robomill/cutting/files/coefficients_schema.hpp"
#include "robomill/cutting/files/cut_schema.hpp"
#include "robomill/cutting/files/cutter_schema.hpp"
#include "robomill/cutting/files/materials_schema.hpp"
#include "robomill/cutting/files/slots_schema.hpp"
#include "robomill/decision/files/limits_schema.hpp"
#include "robomill/decision/files/tools_files.hpp"
#include "robomill/io/schema.hpp"
#include "robomill/io/table.hpp"
#include "robomill/jobs/files/job_schema.hpp"
#include "robomill/jobs/files/lobes_schema.hpp"
#include "robomill/jobs/files/plan_json.hpp"
#include "robomill/jobs/files/postures_json.hpp"
#include "robomill/jobs/files/signal_json.hpp"
#include "robomill/jobs/files/slurm_jobs.hpp"
#include "robomill/jobs/files/statistics_json.hpp"
#include "robomill/jobs/files/study_points_json.hpp"
#include "robomill/jobs/files/study_schema.hpp"
#include "robomill/jobs/files/sweep_folder.hpp"
#include "robomill/live/files/recorded_run_json.hpp"
#include "robomill/modal/files/frf_schema.hpp"
#include "robomill/modal/files/hits_schema.hpp"
#include "robomill/monitor/files/calibration_json.hpp"
#include "robomill/monitor/files/machine_schema.hpp"
#include "robomill/monitor/files/monitor_tables.hpp"
#include "robomill/path/files/motion_json.hpp"
#include "robomill/path/files/smooth_object.hpp"
#include "robomill/path/files/smoothing_schema.hpp"
#include "robomill/path/files/stream_object.hpp"
#include "robomill/process/files/blocks_json.hpp"
#include "robomill/process/files/decide_schema.hpp"
#include "robomill/process/files/forces_schema.hpp"
#include "robomill/process/files/structure_schema.hpp"
#include "robomill/robot/files/geometry_toml.hpp"
#include "robomill/robot/files/stiffness_files.hpp"
#include "robomill/simulation/files/simulation_files.hpp"
#include "robomill/simulation/files/vibration_json.hpp"
#include "robomill/stability/files/chart_schema.hpp"
#include "robomill/stability/files/lobes_schema.hpp"
#include "robomill/stability/files/peak_classification_json.hpp"

namespace robomill::jobs {
namespace {

using io::Holds;
using io::Key;
using io::TableInfo;

/// Keeps what the keys of documents point to.
const TableInfo* kept(TableInfo info) {
  static std::deque<TableInfo> all;
  return &all.emplace_back(std::move(info));
}

/// A table of a TOML document. @param lists  1: [[hits]]
template <class T>
Key table(const std::string& name, const io::Schema<T>& rows, int lists = 0) {
  return {.name = name, .holds = Holds::table, .lists = lists, .table = &rows.info(), .meaning = rows.info().meaning};
}

/// Tables in their order. Those of one name are one, of which each reader knows a part.
std::vector<Key> joined(const std::vector<Key>& tables) {
  std::vector<Key> out;
  for (const Key& one : tables) {
    const auto same = std::ranges::find(out, one.name, &Key::name);
    if (same == out.end()) {
      out.push_back(one);
      continue;
    }
    TableInfo whole = *same->table;
    std::ranges::copy_if(one.table->keys, std::back_inserter(whole.keys), [&](const Key& key) {
      return std::ranges::find(whole.keys, key.name, &Key::name) == whole.keys.end();
    });
    same->table = kept(std::move(whole));
  }
  return out;
}

/// The tables that any of the documents of a job may hold or include.
const std::vector<Key>& shared_tables() {
  static const std::vector<Key> all = [] {
    Key coefficients = table("coefficients", cutting::coefficients_table());
    coefficients.also = {Holds::text};
    const TableInfo& geometry = robot::geometry_table();
    const std::vector<Key> tables = {
        table("job", job_table()),
        table("tool", cutting::cutter_table()),
        table("tool", decision::edges_table()),
        table("tool", cell::mounted_tool_table()),
        table("cut", cutting::cut_table()),
        std::move(coefficients),
        table("process_damping", cutting::process_damping_table()),
        table("speed_variation", cutting::speed_variation_table()),
        table("dynamics", process::dynamics_table()),
        table("workpiece_dynamics", process::workpiece_dynamics_table()),
        table("lobes", stability::chart_options_table()),
        table("uncertainty", stability::uncertainty_options_table()),
        table("surface_error", stability::surface_error_table()),
        table("stock", cutting::stock_table()),
        table("forces", process::forces_options_table()),
        Key{.name = "force_on", .holds = Holds::word, .words = {"tool", "workpiece"}, .meaning = "as cut.force_on"},
        table("robot", cell::robot_table()),
        table("robot", process::robot_of_cut_table()),
        table("workpiece", cell::workpiece_table()),
        Key{.name = "geometry", .holds = Holds::table, .table = &geometry, .meaning = geometry.meaning},
        table("smoothing", path::smoothing_table()),
        table("program", cell::program_words_table()),
        table("postures", cell::measured_posture_table(), 1),
        table("spindle", decision::spindle_table()),
        table("spindle", cell::spindle_outputs_table()),
        table("safety", decision::safety_table()),
        table("finishing", decision::finishing_table()),
        table("decide", process::decide_table()),
        table("cuts", decision::test_cut_table(), 1),
        table("acquisition", modal::acquisition_table()),
        table("hits", modal::hit_table(), 1),
        table("signal", monitor::signal_table()),
        table("process", monitor::process_table()),
        table("detector", monitor::detector_table()),
        table("act", monitor::act_table()),
        table("mqtt", monitor::mqtt_table()),
        table("metrics", monitor::metrics_table()),
        table("recording", monitor::recording_table())};
    return joined(tables);
  }();
  return all;
}

const std::vector<Key>& assembly_tables() {
  static const std::vector<Key> all = {
      table("frequency", coupling::frequency_table()),         table("tool", coupling::segment_options_table(), 1),
      table("joint", coupling::joint_options_table()),         table("holder", coupling::holder_table()),
      table("accelerometer", coupling::accelerometer_table()), table("search", coupling::search_table())};
  return all;
}

/// Those of the monitor that are calibrated, and the recordings.
std::vector<Key> recordings_tables() {
  std::vector<Key> out;
  std::ranges::copy_if(shared_tables(), std::back_inserter(out), [](const Key& key) {
    return key.name == "signal" || key.name == "process" || key.name == "detector";
  });
  out.push_back(table("calibration", monitor::calibration_options_table()));
  out.push_back(table("recordings", monitor::labelled_recording_table(), 1));
  return out;
}

/// A document of these tables, each of which may be in a file that it includes.
TableInfo toml_document(const std::string& name, const std::string& meaning, const std::vector<Key>& tables) {
  TableInfo out{.name = name, .meaning = meaning, .several_files = true};
  out.keys = {{.name = "include",
               .holds = Holds::path,
               .lists = 1,
               .or_one = true,
               .meaning = "files whose tables are read with those of this one"}};
  std::ranges::copy(tables, std::back_inserter(out.keys));
  return out;
}

const std::vector<TableInfo>& toml_documents() {
  static const std::vector<TableInfo> all = {
      toml_document("lobes.toml", "a cut and the range of its stability chart", shared_tables()),
      toml_document("job.toml", "a whole job: from hammer hits and a cut to spindle speed and depth", shared_tables()),
      toml_document("forces.toml", "a cutter in its cut, or along a program", shared_tables()),
      toml_document("cell.toml", "a robot with its tool before a workpiece", shared_tables()),
      toml_document("hits.toml", "the records of a tap test", shared_tables()),
      toml_document("monitor.toml", "a running accelerometer, the cut and the detector", shared_tables()),
      toml_document("assembly.toml", "a tool in a holder", assembly_tables()),
      toml_document("recordings.toml", "labelled recordings of cuts", recordings_tables()),
      toml_document("study.toml", "a job done for many values of its document's keys",
                    {table("study", study_table()), table("vary", vary_table(), 1),
                     table("boundary", boundary_task_table()), table("sensitivity", sensitivity_task_table()),
                     table("probability", probability_task_table()), table("slurm", slurm_table())}),
      toml_document("materials.toml", "force coefficients of workpiece materials",
                    {{.name = "materials",
                      .holds = Holds::table,
                      .named = true,
                      .table = &cutting::material_table().info(),
                      .meaning = "by their names"}})};
  return all;
}

struct Entry {
  std::string name;
  const TableInfo& table;
};

const std::vector<Entry>& documents() {
  static const std::vector<Entry> all = [] {
    std::vector<Entry> out;
    for (const TableInfo& table : toml_documents()) out.push_back({table.name, table});
    for (const TableInfo* table : {&plan_table(),
                                   &recordings_table().info(),
                                   &assembly_table().info(),
                                   &monitor::calibration_table().info(),
                                   &monitor::machine_table().info(),
                                   &coupling::joint_table().info(),
                                   &robot::stiffness_table().info(),
                                   &modal::frf_table().info(),
                                   &process::blocks_table().info(),
                                   &process::forces_table().info(),
                                   &cell::modes_document_table().info(),
                                   &lobes_json_table().info(),
                                   &stability::sweep_table().info(),
                                   &stability::comparison_table().info(),
                                   &postures_table().info(),
                                   &stability::explain_table().info(),
                                   &path::smooth_table().info(),
                                   &path::stream_table().info(),
                                   &path::motion_table().info(),
                                   &simulation::simulation_table().info(),
                                   &simulation::vibration_table().info(),
                                   &cell::check_table().info(),
                                   &decision::tools_table().info(),
                                   &cutting::coefficients_document(),
                                   &signal_coefficients_document(),
                                   &live::recorded_run_table().info(),
                                   &sweep_plan_table().info(),
                                   &statistics_table().info(),
                                   &study_points_table().info(),
                                   &slurm_jobs_table().info()})
      out.push_back({table->name + ".json", *table});
    return out;
  }();
  return all;
}

const TableInfo& info_of(std::string_view document) {
  const auto found = std::ranges::find(documents(), document, &Entry::name);
  if (found != documents().end()) return found->table;
  std::string known;
  for (const std::string& name : schema_names()) known += (known.empty() ? "" : ", ") + name;
  throw InvalidInput("schema", "\"" + std::string(document) + "\" is no document that has one", "These have: " + known);
}

}  // namespace

const std::vector<std::string>& schema_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> out;
    for (const Entry& one : documents()) out.push_back(one.name);
    return out;
  }();
  return names;
}

std::string schema_text(std::string_view document) {
  return io::dump(io::json_schema(info_of(document)));
}

std::string schema_table(std::string_view document) {
  const std::vector<std::string> words = io::split_texts(document, ' ');
  const TableInfo& whole = info_of(words.front());
  if (words.size() == 1) return io::markdown_table(whole);
  TableInfo some{.name = whole.name, .use = whole.use};
  std::ranges::copy_if(whole.keys, std::back_inserter(some.keys),
                       [&](const Key& key) { return std::ranges::find(words, key.name) != words.end(); });
  return io::markdown_table(some);
}

}  // namespace robomill::jobs
