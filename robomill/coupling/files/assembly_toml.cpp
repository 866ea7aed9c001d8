#include "robomill/coupling/files/assembly_toml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "robomill/base/cost.hpp"
#include "robomill/base/error.hpp"
#include "robomill/coupling/files/assembly_schema.hpp"
#include "robomill/coupling/files/joint_json.hpp"
#include "robomill/coupling/files/segment_fields.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/io/toml/samples.hpp"
#include "robomill/modal/files/frf_files.hpp"

namespace robomill::coupling {
namespace {

/// @param member  of the list: "tool"
void check_segments(const io::TomlFile& file, const char* member, const std::vector<Segment>& segments) {
  for (std::size_t i = 0; i < segments.size(); ++i) {
    try {
      segments[i].validate();
    } catch (const InvalidInput& error) {
      throw file.located(within(fmt::format("{}[{}].", member, i + 1), error));
    }
  }
}

/// [[tool]]
std::vector<Segment> read_tool(io::TomlFile& file) {
  std::vector<Segment> out(file.tables("tool"));
  for (std::size_t i = 0; i < out.size(); ++i) {
    segment_options_table().read(file, fmt::format("tool[{}]", i), out[i], fmt::format("tool[{}].", i + 1));
  }
  check_segments(file, "tool", out);
  return out;
}

void read_joint(io::TomlFile& file, const AssemblyReading& reading, const std::optional<JointFile>& found,
                std::optional<Joint>& out) {
  if (!file.has("joint")) {
    if (found && found->joint.points > 1) {
      throw file.reject("joint",
                        fmt::format("must say where the {} points of {} stand", found->joint.points,
                                    reading.joint.filename().string()),
                        "Write [joint] with points, insertion_length_mm and shank");
    }
    if (found) out = found->joint;
    return;
  }
  Joint joint;
  joint_options_table().read(file, "joint", joint, "joint.");
  if (reading.joint_sought) {
    // The search uses none of the four; what stands for them must only be valid.
    joint.translational_stiffness_n_per_m = joint.rotational_stiffness_n_m_per_rad =
        std::max(1e6, 2.0 * std::abs(joint.cross_stiffness_n_per_rad));
    joint.translational_damping_n_s_per_m = joint.rotational_damping_n_m_s_per_rad = 0.0;
  } else if (found) {
    for (const io::Field<Joint>& field : joint_fields) joint.*field.value = found->joint.*field.value;
  }
  if (found && joint.points != found->joint.points) {
    throw file.reject(
        file.has("joint.points") ? "joint.points" : "joint",
        fmt::format("must be {} where the joint is that of {}",
                    file.has("joint.points") ? std::to_string(found->joint.points)
                                             : fmt::format("of {} points", found->joint.points),
                    reading.joint.filename().string()),
        "A joint holds where it was found: at the mouth of the holder, or at so many points of the shank");
  }
  check_segments(file, "joint.shank", joint.shank);
  try {
    joint.validate();
  } catch (const InvalidInput& error) {
    throw file.located(within("joint.", error));
  }
  out = joint;
}

FrequencyTable read_frequency(io::TomlFile& file, AssemblyFile& out) {
  FrequencyTable given;
  if (!file.has("frequency")) return given;
  frequency_table().read(file, "frequency", given);
  out.low_hz = given.range_hz[0];
  out.high_hz = given.range_hz[1];
  if (!(out.high_hz > out.low_hz)) {
    throw file.reject("frequency.range_hz", "must be [from, to] with from below to");
  }
  return given;
}

/// Of the receptances of tool, holder and assembly, and of the FRFs as numbers of a document.
/// @param points  of the joint that they are coupled through; 0: at the mouth
void require_affordable_lines(double lines, double step_hz, double high_hz, double points) {
  constexpr double operations_of_line = 3e3, bytes_of_line = 600.0, usual_step_hz = 1.0, usual_high_hz = 8000.0;
  constexpr double operations_of_point = 2e3, bytes_of_point = 500.0, usual_points = 5.0;
  require_affordable(
      {.operations = (operations_of_line + operations_of_point * points) * lines,
       .bytes = (bytes_of_line + bytes_of_point * points) * lines,
       .dominant = dominant_of(
           {{.field = "step_hz", .value = step_hz, .unit = "Hz", .times_usual = usual_step_hz / step_hz},
            {.field = "range_hz", .value = high_hz, .unit = "Hz", .times_usual = high_hz / usual_high_hz},
            {.field = "joint.points", .value = points, .unit = "points", .times_usual = points / usual_points}})});
}

/// Evenly from low to high, without 0 Hz; empty where no step is given.
Eigen::VectorXd lines_of(const io::TomlFile& file, const FrequencyTable& given, const AssemblyReading& reading,
                         const AssemblyFile& out) {
  if (!given.step_hz) return {};
  const std::optional<Joint>& joint = out.assembly.joint;
  const bool spread = joint && joint->points > 1 && !reading.joint_sought;
  const double step_hz = *given.step_hz;
  // A step such as 0.1 must not lose the last line to rounding.
  const double steps = std::floor((out.high_hz - out.low_hz) / step_hz * (1.0 + 1e-12) + 1e-9);
  file.locate([&] { require_affordable_lines(steps, step_hz, out.high_hz, spread ? joint->points : 0.0); });
  // A structure has no receptance where it would fly away: a range from 0 begins with its first step.
  const double first = out.low_hz > 0.0 ? 0.0 : 1.0;
  const auto count = static_cast<Eigen::Index>(steps - first) + 1;
  if (count < 1) throw file.reject("frequency.step_hz", "must not be longer than the range");
  return out.low_hz + step_hz * Eigen::ArrayXd::LinSpaced(count, first, steps);
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    text += (i == 0 ? "" : i + 1 == words.size() ? " and " : ", ") + words[i];
  }
  return text;
}

/// What one plane of a 2 x 2 receptance lacks; nothing where it is whole.
std::vector<std::string> lacking(const modal::FrfSet& set, const char* driving, const char* force_to_angle,
                                 const char* moment_to_shift, const char* angle) {
  const auto has = [&](const char* name) { return set.find(modal::parse_frf_name(name)) != nullptr; };
  std::vector<std::string> out;
  if (!has(driving)) out.emplace_back(driving);
  if (!has(force_to_angle) && !has(moment_to_shift)) {
    out.push_back(fmt::format("{} (or {})", force_to_angle, moment_to_shift));
  }
  if (!has(angle)) out.emplace_back(angle);
  return out;
}

void require_rotations(const modal::FrfSet& set, const std::filesystem::path& path) {
  const std::vector<std::string> x = lacking(set, "xx", "ry:x", "x:my", "ry:my");
  const std::vector<std::string> y = lacking(set, "yy", "rx:y", "y:mx", "rx:mx");
  if (x.empty() || y.empty()) return;
  const std::vector<std::string>& less = y.size() < x.size() ? y : x;
  throw InvalidInput(path.string(),
                     fmt::format("lacks {}: a tool couples to rotations too, so the holder's 2 x 2 receptance must be "
                                 "whole in a plane",
                                 joined(less)),
                     "Where only translations were measured, hit two or three points (1x:1x, 2x:1x, 2x:2x, …) and say "
                     "where they lie: holder.points_mm = [0, 15, 30]");
}

/// Errors about the receptances name their file, the others the line of assembly.toml.
template <class F>
auto about(const io::TomlFile& file, const std::filesystem::path& receptances, F&& f) {
  try {
    return f();
  } catch (const InvalidInput& error) {
    InvalidInput located = file.located(error);
    if (!located.parts().where.empty()) throw located;
    InvalidInput::Parts parts = error.parts();
    parts.where = receptances.string();
    throw InvalidInput(std::move(parts));
  }
}

/// A file whose FRFs all stand at one point was taken as one of the tip; on an artefact that point has its position.
void number_one_point(modal::FrfFile& measured) {
  for (modal::Frf& frf : measured.set.frfs) {
    for (modal::Dof* dof : {&frf.name.response, &frf.name.excitation}) dof->point = std::max(dof->point, 1);
  }
  std::erase_if(measured.assumed, [](const Assumption& one) { return one.taken == modal::taken_as_tip; });
}

void read_measured(const io::TomlFile& file, const HolderTable& given, AssemblyFile& out) {
  const bool points = file.has("holder.points_mm");
  if (!points) {
    for (const char* key : {"holder.artefact", "holder.regularisation", "holder.max_amplification"}) {
      if (file.has(key)) file.require("holder.points_mm", fmt::format("{} needs to know where was measured", key));
    }
  }
  if (file.has("holder.artefact") && given.artefact.empty()) {
    throw file.reject("holder.artefact", "must have at least one segment");
  }
  modal::FrfFile measured = modal::read_frfs({out.receptances});
  if (measured.added_decay_per_s > 0.0) {
    throw InvalidInput(out.receptances.string(), "still holds the damping of an exponential window",
                       "Estimate the FRFs with remove_added_damping");
  }
  if (points && given.position_m.size() == 1 && !given.artefact.empty()) number_one_point(measured);
  out.notes.insert(out.notes.end(), measured.notes.begin(), measured.notes.end());
  add_assumed(out.assumed, measured.assumed);
  Holder& holder = out.assembly.holder;
  if (!points) {
    require_rotations(measured.set, out.receptances);
    holder.receptances = std::move(measured.set);
    return;
  }
  out.holder = about(file, out.receptances, [&] {
    return given.artefact.empty() ? complete_rotations(measured.set, given.position_m, given.options)
                                  : remove_artefact(measured.set, given.position_m, given.artefact, given.options);
  });
  holder.receptances = out.holder->receptances;
}

void hang_free(const io::TomlFile& file, const AssemblyReading& reading, AssemblyFile& out) {
  if (reading.cuts) {
    throw file.reject(
        "holder.free", "must not be true where the tool is to cut",
        "Describe its holder, or leave [holder] out for a rigid wall. robomill couple predicts a tool that "
        "hangs free");
  }
  if (reading.joint_sought || !reading.joint.empty()) {
    throw file.reject("holder.free", "must not be true where a joint is looked for or given",
                      "A tool that hangs free is joined to nothing");
  }
  for (const char* key : {"holder.segments", "holder.receptances", "holder.points_mm", "holder.artefact",
                          "holder.regularisation", "holder.max_amplification", "joint"}) {
    if (file.has(key)) throw file.reject(key, "must not stand beside holder.free = true", "Nothing holds the tool");
  }
  out.assembly.holder.free = true;
  out.notes.emplace_back("The tool hangs free: nothing holds it.");
}

void read_accelerometer(io::TomlFile& file, const AssemblyReading& reading, AssemblyFile& out) {
  Accelerometer& given = out.assembly.accelerometer;
  accelerometer_table().read(file, "accelerometer", given, "accelerometer.");
  if (given.mass_kg == 0.0) {
    if (file.has("accelerometer.offset_mm")) file.require("accelerometer.mass_kg", "An offset of no mass says nothing");
    return;
  }
  if (reading.cuts) {
    out.cutting_note = fmt::format(
        "The accelerometer of {:.4g} kg ([accelerometer]) is taken off: a tool that cuts carries none.", given.mass_kg);
    out.removed_accelerometer = std::exchange(given, {});
  } else if (reading.joint_sought) {
    out.notes.push_back(
        fmt::format("The measured FRFs are taken to hold the accelerometer's {:.4g} kg. Those of hits with "
                    "acquisition.accelerometer_mass_kg do not: leave [accelerometer] out for them.",
                    given.mass_kg));
  } else {
    out.notes.push_back(fmt::format(
        "The FRFs are those of the tip with an accelerometer of {:.4g} kg on it: without [accelerometer] they "
        "are the tool's own.",
        given.mass_kg));
  }
}

void read_holder(io::TomlFile& file, const AssemblyReading& reading, AssemblyFile& out) {
  if (!file.has("holder")) return;
  HolderTable given;
  holder_table().read(file, "holder", given);
  check_segments(file, "holder.segments", given.segments);
  check_segments(file, "holder.artefact", given.artefact);
  if (given.free) return hang_free(file, reading, out);
  out.receptances = given.receptances;
  if (!given.receptances.empty()) {
    if (file.has("holder.segments")) {
      throw file.reject("holder.receptances", "must not stand beside segments", "Measured or built of beams, not both");
    }
    read_measured(file, given, out);
    return;
  }
  for (const char* key : {"holder.points_mm", "holder.artefact", "holder.regularisation", "holder.max_amplification"}) {
    if (file.has(key)) throw file.reject(key, "goes with holder.receptances");
  }
  if (!file.has("holder.segments")) {
    throw file.reject("holder", "must give segments or receptances", "For a rigid wall leave [holder] out");
  }
  out.assembly.holder.segments = std::move(given.segments);
  if (out.assembly.holder.segments.empty()) out.notes.emplace_back("No segments: the tool stands on a rigid wall");
}

/// A number of segments that some of a table leave to its default.
/// @param counts  whether it counts for a segment
template <class Counts>
void add_default(const io::TomlFile& file, const char* table, const std::vector<Segment>& segments, const char* key,
                 const std::string& what, const std::string& taken, Counts counts, AssemblyFile& out) {
  std::size_t without = 0;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    if (counts(segments[i]) && !file.has(fmt::format("{}[{}].{}", table, i, key))) ++without;
  }
  if (without == 0) return;
  out.assumed.push_back({.what = fmt::format("{}, {} of {} segments of [[{}]]", what, without, segments.size(), table),
                         .taken = taken,
                         .key = fmt::format("{}.{}", table, key),
                         .file = out.path.filename().string()});
}

/// What the file leaves to the usual case.
void add_defaults(const io::TomlFile& file, const AssemblyReading& reading, AssemblyFile& out) {
  const auto add = [&](const char* what, const char* taken, const char* key) {
    out.assumed.push_back({.what = what, .taken = taken, .key = key, .file = out.path.filename().string()});
  };
  const std::optional<Joint>& joint = out.assembly.joint;
  const bool sought = reading.joint_sought || !reading.joint.empty();
  const bool damped =
      file.has("joint.translational_damping_n_s_per_m") || file.has("joint.rotational_damping_n_m_s_per_rad");
  if (!joint && !sought && !out.assembly.holder.free) add("Joint between tool and holder", "rigid", "joint");
  if (joint && !sought && !damped) add("Damping of the joint", "none", "joint.translational_damping_n_s_per_m");
  if (!file.has("holder")) add("Holder", "none, the tool stands on a rigid wall", "holder");
  const auto segments = [&](const char* table, const std::vector<Segment>& of) {
    add_default(
        file, table, of, "loss_factor", "Loss factor", "0, the material does not damp",
        [](const Segment&) { return true; }, out);
    add_default(
        file, table, of, "poissons_ratio", "Poisson's ratio", "0.3",
        [](const Segment& segment) { return segment.beam == Beam::timoshenko; }, out);
    add_default(
        file, table, of, "flute_diameter_ratio", "Diameter that flutes count with", "0.8 of the cutter's",
        [](const Segment& segment) { return segment.flutes > 0; }, out);
  };
  segments("tool", out.assembly.tool);
  if (joint) segments("joint.shank", joint->shank);
  segments("holder.segments", out.assembly.holder.segments);
}

/// Where the file gives no lines of its own, the measured holder's within the range.
void choose_lines(const io::TomlFile& file, const Eigen::VectorXd& own, AssemblyFile& out) {
  const modal::FrfSet& measured = out.assembly.holder.receptances;
  if (own.size() > 0) {
    out.frequency_hz = own;
  } else if (!measured.frfs.empty()) {
    try {
      out.frequency_hz = lines_between(measured, out.low_hz, out.high_hz).frequency_hz;
    } catch (const InvalidInput&) {
      throw file.reject("frequency.range_hz",
                        fmt::format("holds none of the measured holder's lines, {:.6g} to {:.6g} Hz",
                                    measured.frequency_hz(0), measured.frequency_hz(measured.frequency_hz.size() - 1)));
    }
  } else if (file.has("frequency")) {
    file.require("frequency.step_hz", "A holder that was not measured has no lines of its own");
  } else {
    file.require("frequency", "Write [frequency] with range_hz = [1, 5000] and step_hz = 1");
  }
}

}  // namespace

AssemblyFile read_assembly(const io::TomlSource& source, const AssemblyReading& reading) {
  io::TomlFile file(source);
  AssemblyFile out{.path = source.path};
  const FrequencyTable frequency = read_frequency(file, out);
  file.require("tool", "Write [[tool]] above each segment, from the tip to the joint");
  out.assembly.tool = read_tool(file);
  if (out.assembly.tool.empty()) throw file.reject("tool", "must have at least one segment");
  std::optional<JointFile> found;
  if (!reading.joint.empty()) {
    found = read_joint_json(reading.joint);
    out.joint_notes = found->notes;
    out.joint_warnings = found->warnings;
  }
  read_joint(file, reading, found, out.assembly.joint);
  const Eigen::VectorXd lines = lines_of(file, frequency, reading, out);
  read_holder(file, reading, out);
  read_accelerometer(file, reading, out);
  search_table().read(file, "search", out.search);
  file.locate([&] { out.search.validate(); });
  add_defaults(file, reading, out);
  std::ranges::move(file.done(), std::back_inserter(out.notes));
  add_assumed(out.assumed, io::sample_values(file));
  if (!reading.joint_sought) choose_lines(file, lines, out);
  about(file, out.receptances.empty() ? source.path : out.receptances, [&] { out.assembly.validate(); });
  return out;
}

modal::FrfSet lines_between(const modal::FrfSet& set, double low_hz, double high_hz) {
  std::vector<Eigen::Index> lines;
  for (Eigen::Index i = 0; i < set.frequency_hz.size(); ++i) {
    const double f = set.frequency_hz(i);
    if (f > 0.0 && f >= low_hz * (1.0 - 1e-9) && f <= high_hz * (1.0 + 1e-9)) lines.push_back(i);
  }
  if (lines.empty()) {
    throw InvalidInput("frequency_hz", fmt::format("has no line from {:.6g} to {:.6g} Hz", low_hz, high_hz));
  }
  modal::FrfSet out{.frequency_hz = set.frequency_hz(lines), .frfs = {}};
  for (const modal::Frf& frf : set.frfs) {
    modal::Frf part{.name = frf.name, .receptance = frf.receptance(lines)};
    if (frf.coherence.size() > 0) part.coherence = frf.coherence(lines);
    if (frf.deviation.size() > 0) part.deviation = frf.deviation(lines);
    out.frfs.push_back(std::move(part));
  }
  return out;
}

}  // namespace robomill::coupling
