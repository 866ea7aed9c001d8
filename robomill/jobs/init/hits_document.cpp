#include "robomill/jobs/init/hits_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/cell/files/known_arms.hpp"
#include "robomill/io/text.hpp"
#include "robomill/io/toml/edit.hpp"
#include "robomill/jobs/init.hpp"
#include "robomill/jobs/init/template_lines.hpp"
#include "robomill/modal/files/hit_files/hit_settings.hpp"

namespace robomill::jobs {
namespace {

using modal::FoundHit;
using modal::FoundHits;
using modal::MeasuredAxes;

/// What only its reader can give stands behind a #.
std::string_view mark_of(const modal::HitSetting& setting) {
  return setting.missing.empty() ? "#" : "#!";
}

/// With the keys of [acquisition] that records say, or lack.
std::string with_acquisition(std::string text, const FoundHit& hit) {
  for (const modal::HitSetting& setting : modal::acquisition_settings(hit)) {
    text = with_remark(text, "acquisition." + setting.key, setting.value, setting.remark, mark_of(setting));
  }
  return text;
}

std::string hit_table(const FoundHit& hit) {
  std::string text = "[[hits]]\n";
  for (const modal::HitSetting& setting : modal::row_settings(hit)) {
    text += template_line(setting.key, setting.value, setting.remark, mark_of(setting));
  }
  return text;
}

/// A list with one value a joint that the template shows behind a #.
struct ShownList {
  const char* key;
  double unit;  ///< in SI
  double robot::Joint::*value;
};
constexpr ShownList shown_lists[] = {
    {"robot.joint_max_velocity_deg_per_s", units::deg, &robot::Joint::max_velocity},
    {"robot.joint_max_acceleration_deg_per_s2", units::deg, &robot::Joint::max_acceleration},
    {"robot.joint_max_jerk_deg_per_s3", units::deg, &robot::Joint::max_jerk},
    {"robot.joint_stiffness_n_m_per_rad", 1.0, &robot::Joint::stiffness},
};

/// "[123, 115]": rounded down to hundredths, so that no limit grows.
std::string values_of(const robot::Arm& arm, const ShownList& list) {
  std::vector<std::string> values;
  for (const robot::Joint& joint : arm.joints) {
    constexpr double rounding = 1e-9;
    values.push_back(fmt::format("{}", std::floor((joint.*list.value) / list.unit * 100.0 * (1.0 + rounding)) / 100.0));
  }
  return fmt::format("[{}]", fmt::join(values, ", "));
}

}  // namespace

std::string hits_document(const FoundHits& found, bool example) {
  std::string text(raw_template(Template::hits));
  if (found.hits.empty()) return rendered(text, example);
  text.resize(text.find("\n[[hits]]\n") + 1);
  text = with_acquisition(std::move(text), found.hits.front());
  for (std::size_t i = 0; i < found.hits.size(); ++i) text += (i == 0 ? "" : "\n") + hit_table(found.hits[i]);
  return rendered(text, example);
}

namespace {

bool is_known(const MeasuredAxes& measured, char axis) {
  return measured.excitations.contains(axis) && measured.responses.contains(axis);
}

}  // namespace

char unmeasured_axis(const MeasuredAxes& measured) {
  if (is_known(measured, 'x') == is_known(measured, 'y')) return 0;
  return is_known(measured, 'x') ? 'y' : 'x';
}

std::string job_document(const MeasuredAxes& measured, bool cut_beside, bool example) {
  const std::string_view raw = raw_template(Template::job);
  const std::string text =
      cut_beside ? with_remark(without_tables(raw), "job.lobes", "\"lobes.toml\"", "the cut, which was there before")
                 : with_tables(raw, raw_template(Template::lobes));
  const char other = unmeasured_axis(measured);
  if (other == 0) return rendered(commented_out(text, "job.equal_directions"), example);
  const char axis = other == 'y' ? 'x' : 'y';
  if (measured.excitations == measured.responses && measured.excitations == std::set<char>{axis}) {
    return rendered(
        with_remark(text, "job.equal_directions", "true",
                    fmt::format("only {} was hit: is {} like it? Else take rigid_directions", axis, other), "#!"),
        example);
  }
  return rendered(with_remark(commented_out(text, "job.equal_directions"), "job.rigid_directions",
                              fmt::format("[\"{}\"]", other), fmt::format("{} was not hit: is it rigid?", other), "#!"),
                  example);
}

std::string cell_document(const std::string& robot, bool example) {
  std::string text(raw_template(Template::cell));
  if (robot.empty()) return rendered(text, example);
  const std::string_view cell = cell::known_arm_cell(robot);
  if (cell.empty()) {
    std::string names;
    for (const cell::KnownArm& arm : cell::known_arms()) names += (names.empty() ? "" : ", ") + arm.name;
    throw InvalidInput(fmt::format("\"{}\"", robot), "is no robot that is known here", "There are " + names);
  }
  text = with_remark(text, "robot.model", io::toml_quoted(robot),
                     "an arm of data/cells with its kinematics and limits; keys below stand before its own");
  const auto take = [&](const std::string& key) {
    const std::optional<std::string> value = io::setting_of(cell, key);
    if (value) text = io::with_setting(text, {.key = key, .value = *value});
  };
  for (const char* key : {"workpiece.origin_mm", "tool.length_mm"}) take(key);
  // What the arm has anyway stands there to be changed.
  const robot::Arm arm = cell::read_cell(io::TomlSource(robot + ".toml", std::string(cell))).robot.arm;
  for (const ShownList& list : shown_lists) {
    text = io::with_setting(text, {.key = list.key, .value = values_of(arm, list)});
    text = commented_out(std::move(text), list.key);
  }
  return rendered(text, example);
}

}  // namespace robomill::jobs
