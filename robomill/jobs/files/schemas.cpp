#include "robomill/jobs/files/schemas.hpp"

#include <algorithm>

#include "robomill/base/error.hpp"
#include "robomill/cell/files/check_json.hpp"
#include "robomill/cell/files/posture_json.hpp"
#include "robomill/coupling/files/joint_json.hpp"
#include "robomill/cutting/files/slots_schema.hpp"
#include "robomill/io/schema.hpp"
#include "robomill/jobs/files/lobes_schema.hpp"
#include "robomill/jobs/files/plan_json.hpp"
#include "robomill/jobs/files/tools_files.hpp"
#include "robomill/live/files/recorded_run_json.hpp"
#include "robomill/modal/files/frf_schema.hpp"
#include "robomill/monitor/files/calibration_json.hpp"
#include "robomill/path/files/smooth_object.hpp"
#include "robomill/process/files/blocks_json.hpp"
#include "robomill/process/files/forces_schema.hpp"
#include "robomill/robot/files/stiffness_files.hpp"
#include "robomill/simulation/files/simulation_files.hpp"
#include "robomill/stability/files/lobes_schema.hpp"
#include "robomill/stability/files/peak_classification_json.hpp"

namespace robomill::jobs {
namespace {

struct Entry {
  std::string name;
  const io::TableInfo& table;
};

const std::vector<Entry>& documents() {
  static const std::vector<Entry> all = [] {
    std::vector<Entry> out;
    for (const io::TableInfo* table :
         {&plan_table(), &assembly_table().info(), &monitor::calibration_table().info(),
          &coupling::joint_table().info(), &robot::stiffness_table().info(), &modal::frf_table().info(),
          &process::blocks_table().info(), &process::forces_table().info(), &cell::modes_document_table().info(),
          &lobes_json_table().info(), &stability::sweep_table().info(), &stability::comparison_table().info(),
          &stability::explain_table().info(), &path::smooth_table().info(), &simulation::simulation_table().info(),
          &cell::check_table().info(), &tools_table().info(), &cutting::coefficients_document(),
          &live::recorded_run_table().info()})
      out.push_back({table->name + ".json", *table});
    return out;
  }();
  return all;
}

const io::TableInfo& table_of(std::string_view document) {
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
  return io::dump(io::json_schema(table_of(document)));
}

std::string schema_table(std::string_view document) {
  return io::markdown_table(table_of(document));
}

}  // namespace robomill::jobs
