#include "robomill/process/files/decide_toml.hpp"

#include <string>

#include "robomill/base/error.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/process/files/decide_schema.hpp"

namespace robomill::process {
namespace {

/// A plan without a program recommends speed and depth by removal rate: what says something else would have no effect.
void check_without_program(const io::TomlFile& file, const DecideOptions& options) {
  constexpr const char* needed = "A decision needs job.program with job.forces and job.cell";
  if (file.has("decide.goal") && options.goal != Goal::removal_rate) {
    throw file.reject("decide.goal", "must be \"removal_rate\" in a job without a program", needed);
  }
  const bool speed_and_depth =
      options.free.size() == 2 && options.is_free(Free::spindle_speed) && options.is_free(Free::axial_depth);
  if (file.has("decide.free") && !speed_and_depth) {
    throw file.reject("decide.free", "must be [\"spindle_speed\", \"axial_depth\"] in a job without a program", needed);
  }
  for (const io::Key& key : decide_table().info().keys) {
    const std::string path = "decide." + key.name;
    if (key.name == "goal" || key.name == "free" || !file.has(path)) continue;
    throw file.reject(path, "has no effect in a job without a program", needed);
  }
}

}  // namespace

DecideOptions read_decide(io::TomlFile& file, bool along_program) {
  DecideOptions out;
  decide_table().read(file, "decide", out);
  if (!along_program) {
    check_without_program(file, out);
    return out;
  }
  out.speed_changes_given = file.has("decide.speed_changes");
  try {
    file.locate([&] { out.validate(); });
  } catch (const InvalidInput& error) {
    if (error.parts().field != "free") throw;
    throw file.reject("decide.free", error.parts().rule, error.parts().hint);
  }
  return out;
}

}  // namespace robomill::process
