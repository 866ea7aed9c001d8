#include "robomill/cell/dynamics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "robomill/base/error.hpp"
#include "robomill/cell/arm_modes.hpp"
#include "robomill/cell/files/calibration_document.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/io/usual_ranges.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/modal/files/modes_files.hpp"
#include "robomill/modal/fit.hpp"
#include "robomill/modal/tip.hpp"
#include "robomill/robot/usual_arm.hpp"

namespace robomill::cell {
namespace {

/// Of the flange before any mount, in base axes.
Eigen::Matrix3d flange_axes(const Cell& cell, const Eigen::VectorXd& joints) {
  return robot::forward(cell.robot.arm, joints).linear() * cell.mount().linear().transpose();
}

Eigen::VectorXd to_vector(const std::vector<double>& joints) {
  return Eigen::Map<const Eigen::VectorXd>(joints.data(), static_cast<Eigen::Index>(joints.size()));
}

/// Modes that know x, y and z at the tip, in other axes.
modal::ModalModel turned(const modal::ModalModel& model, const Eigen::Matrix3d& turn, const std::string& name) {
  if (model.excitations != modal::tip_axes() || model.responses != modal::tip_axes()) {
    throw InvalidInput(name, "must know x, y and z of the tip to be turned from the flange's axes",
                       "Give them in base axes");
  }
  return modal::turned(model, turn);
}

/// The same of FRFs, all nine of them.
modal::FrfSet turned(const modal::FrfSet& set, const Eigen::Matrix3d& turn, const std::string& name) {
  const std::vector<modal::Dof>& axes = modal::tip_axes();
  modal::FrfSet out{.frequency_hz = set.frequency_hz, .frfs = {}};
  for (std::size_t j = 0; j < 3; ++j) {
    for (std::size_t i = 0; i < 3; ++i) {
      modal::Frf sum{.name = {axes[i], axes[j]}, .receptance = Eigen::VectorXcd::Zero(set.frequency_hz.size())};
      for (std::size_t l = 0; l < 3; ++l) {
        for (std::size_t k = 0; k < 3; ++k) {
          const modal::Frf* frf = set.find({axes[k], axes[l]});
          if (frf == nullptr) {
            throw InvalidInput(name, "must hold all nine FRFs of the tip to be turned from the flange's axes",
                               "Give them in base axes, where the force columns x and y will do");
          }
          const auto index = [](std::size_t axis) { return static_cast<Eigen::Index>(axis); };
          sum.receptance += turn(index(i), index(k)) * turn(index(j), index(l)) * frf->receptance;
        }
      }
      out.frfs.push_back(std::move(sum));
    }
  }
  return out;
}

modal::MeasuredPosture measured(const Cell& cell, std::size_t index, CellDynamics& told) {
  const PostureEntry& entry = cell.postures[index];
  modal::MeasuredPosture out;
  out.joints = to_vector(entry.joints);
  const std::filesystem::path& path = entry.frf.empty() ? entry.modes : entry.frf;
  out.name = fmt::format("{}: posture {} ({})", cell.path.string(), index + 1, path.filename().string());
  const Eigen::Matrix3d turn = flange_axes(cell, out.joints);
  if (!entry.modes.empty()) {
    out.modes = modal::read_modes(entry.modes, told.notes);
    if (entry.flange_axes) out.modes = turned(*out.modes, turn, out.name);
    return out;
  }
  modal::FrfFile file = modal::read_frfs({entry.frf});
  std::ranges::move(io::take_warnings(file.notes), std::back_inserter(told.warnings));
  for (const std::string& note : file.notes) told.notes.push_back(fmt::format("Posture {}: {}", index + 1, note));
  add_assumed(told.assumed, file.assumed);
  if (file.added_decay_per_s > 0.0) {
    throw InvalidInput(path.string(), "still holds the damping of an exponential window",
                       "Estimate the FRFs with remove_added_damping");
  }
  out.frfs = entry.flange_axes ? turned(file.set, turn, out.name) : std::move(file.set);
  return out;
}

std::vector<modal::MeasuredPosture> all_measured(const Cell& cell, CellDynamics& told) {
  std::vector<modal::MeasuredPosture> out;
  for (std::size_t i = 0; i < cell.postures.size(); ++i) out.push_back(measured(cell, i, told));
  return out;
}

CalibrationDocument document_of(const Cell& cell, const std::vector<modal::MeasuredPosture>& postures,
                                const modal::PostureModelOptions& options) {
  return {cell.path, modal::calibration_fingerprint(cell.robot, payload_of(cell), postures, options)};
}

/// Before the long work starts.
void require_posture(const robot::Arm& arm, const std::vector<double>& joints) {
  if (joints.size() != arm.joints.size()) {
    throw InvalidInput("joints",
                       fmt::format("must hold one value a joint, {}; it holds {}", arm.joints.size(), joints.size()));
  }
  for (std::size_t k = 0; k < joints.size(); ++k) {
    const robot::Joint& joint = arm.joints[k];
    if (std::isfinite(joints[k]) && joints[k] >= joint.min_position && joints[k] <= joint.max_position) continue;
    throw InvalidInput(fmt::format("joints[{}]", k + 1), joints[k], joint.prismatic ? "m" : "rad",
                       "must lie within the joint's limits, robot.joint_min_position_deg and joint_max_position_deg");
  }
}

/// One file for two postures is a slip of the pen.
void require_different_files(const Cell& cell) {
  const auto file_of = [](const PostureEntry& entry) { return entry.frf.empty() ? entry.modes : entry.frf; };
  for (std::size_t i = 0; i < cell.postures.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (file_of(cell.postures[i]) != file_of(cell.postures[j])) continue;
      throw InvalidInput(fmt::format("{}: posture {}", cell.path.string(), i + 1),
                         fmt::format("names {}, as posture {} does", file_of(cell.postures[i]).string(), j + 1),
                         "Each posture has a measurement of its own");
    }
  }
}

/// What a posture was measured to be; modes as the receptances that they make, a line a hertz.
modal::FrfSet measured_frfs(const modal::MeasuredPosture& posture, const modal::PostureModelOptions& options) {
  if (!posture.modes) return posture.frfs;
  const double low_hz = std::max(1.0, options.band_low_hz);
  const auto lines = static_cast<Eigen::Index>(options.band_high_hz - low_hz) + 1;
  return modal::synthesize(*posture.modes, Eigen::VectorXd::LinSpaced(lines, low_hz, options.band_high_hz));
}

/// ‖H_fit − H‖ / ‖H‖ of a posture, over all its receptances: the mean over the lines within the band.
double misfit(const modal::PostureModel& model, const modal::MeasuredPosture& posture,
              const modal::PostureModelOptions& options) {
  const modal::FrfSet set = measured_frfs(posture, options);
  const modal::FrfSet fitted = modal::synthesize(model.at(posture.joints).modes, set.frequency_hz);
  double sum = 0.0;
  std::size_t lines = 0;
  for (Eigen::Index line = 0; line < set.frequency_hz.size(); ++line) {
    const double at_hz = set.frequency_hz(line);
    if (at_hz < options.band_low_hz || at_hz > options.band_high_hz) continue;
    double error = 0.0, size = 0.0;
    for (const modal::Frf& frf : set.frfs) {
      const modal::Frf* const other = fitted.find(frf.name);
      if (other == nullptr) continue;
      error += std::norm(other->receptance(line) - frf.receptance(line));
      size += std::norm(frf.receptance(line));
    }
    if (!(size > 0.0)) continue;
    sum += std::sqrt(error / size);
    ++lines;
  }
  return lines > 0 ? sum / static_cast<double>(lines) : 0.0;
}

/// "4.5 %", "110 %"
std::string percent(double share) {
  return share < 0.995 ? fmt::format("{:.2g} %", 100.0 * share) : fmt::format("{:.0f} %", 100.0 * share);
}

/// A model that misses what was measured, and a posture that does not belong to the others.
void warn_of_misfits(const modal::PostureModel& model, const std::vector<modal::MeasuredPosture>& postures,
                     const modal::PostureModelOptions& options, std::vector<std::string>& warnings) {
  if (model.report().error >= modal::unusable_fit_error) {
    warnings.push_back(
        fmt::format("The arm's model misses the measured receptances by {}: do not use what follows from it. Are "
                    "units, axes and joints_deg of [[postures]] right?",
                    percent(model.report().error)));
  }
  // Simulated arms: within 1.1 of the median with each measurement in its place, 2.1 and more where two are swapped.
  constexpr double outlier = 1.75, noticed = 0.15;
  std::vector<double> missed;
  missed.reserve(postures.size());
  for (const modal::MeasuredPosture& posture : postures) missed.push_back(misfit(model, posture, options));
  std::vector<double> sorted = missed;
  std::ranges::sort(sorted);
  const double median = sorted[sorted.size() / 2];
  for (std::size_t p = 0; p < missed.size() && missed.size() > 2; ++p) {
    if (missed[p] < noticed || missed[p] < outlier * median) continue;
    warnings.push_back(
        fmt::format("{} does not belong to the others: the arm's model misses its receptances {:.2g} times as far as "
                    "theirs (median). Are its joints_deg, axes, unit and file right?",
                    postures[p].name, missed[p] / median));
  }
}

/// Joints whose damping the cell does not give.
std::vector<Assumption> assumed_damping(const Cell& cell, const modal::PostureReport& report) {
  if (report.source == modal::PostureReport::Source::interpolated) return {};
  std::string joints;
  for (std::size_t k = 0; k < cell.robot.arm.joints.size(); ++k) {
    if (cell.robot.arm.joints[k].damping > 0.0) continue;
    joints += fmt::format("{}{}", joints.empty() ? "" : ", ", k + 1);
  }
  if (joints.empty()) return {};
  return {
      {.what = "Damping of joints " + joints,
       .taken = report.postures > 0 ? "2 % of critical, where the calibration starts from" : "2 % of critical of each",
       .key = "robot.joint_damping_n_m_s_per_rad",
       .file = cell.path.filename().string()}};
}

/// "xx by 4.1 %, yy by 5 %; zz, along which nobody hit, follows from the other columns": a sentence. How far that is
/// off differs from posture to posture: unmeasured_axes_text says it.
std::string direct_text(const modal::PostureReport& report) {
  std::string measured, others;
  for (std::size_t axis = 0; axis < report.direct.size(); ++axis) {
    const std::string name(2, "xyz"[axis]);
    const modal::PostureReport::Direct& direct = report.direct[axis];
    if (direct.measured) {
      const double error = std::isfinite(direct.left_out_error) ? direct.left_out_error : direct.error;
      measured += fmt::format("{}{} by {}", measured.empty() ? "" : ", ", name, percent(error));
    } else {
      others += fmt::format("; {}, along which nobody hit, follows from the other columns", name);
    }
  }
  return measured.empty() ? std::string() : fmt::format(" It misses {}{}.", measured, others);
}

std::string description(const modal::PostureReport& report) {
  std::string text = fmt::format(
      "The arm's model is calibrated over {} posture{}: compliant joints{}{}{}. It misses their "
      "receptances by {}",
      report.postures, report.postures == 1 ? "" : "s", report.bearings ? ", bearings" : "",
      report.bracket ? ", the spindle's bracket" : "",
      report.tool_modes > 0
          ? fmt::format(", spindle and tool as {} mass{}", report.tool_modes, report.tool_modes == 1 ? "" : "es")
          : "",
      percent(report.error));
  if (std::isfinite(report.left_out_error)) {
    text += fmt::format(", those of a posture left out by {}", percent(report.left_out_error));
  }
  return text + "." + direct_text(report);
}

/// The mean over the measured postures.
Eigen::Vector3d mean_deviation(const modal::PostureModel& model, const std::vector<modal::MeasuredPosture>& postures) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const modal::MeasuredPosture& posture : postures) sum += model.direct_deviation(posture.joints);
  return sum / static_cast<double>(postures.size());
}

std::string kept_text(const CalibrationDocument& document) {
  return fmt::format("The calibration is kept in {} until its inputs change.", document.name());
}

/// The arm's model; calibrated as an earlier run did where the cell's calibration document is of these inputs, which is
/// else replaced.
/// @param notes  of the document
std::shared_ptr<const modal::PostureModel> model_of(const Cell& cell,
                                                    const std::vector<modal::MeasuredPosture>& postures,
                                                    const modal::PostureModelOptions& options,
                                                    std::vector<std::string>& notes, Progress& progress) {
  const std::optional<robot::Link> payload = payload_of(cell);
  if (postures.empty()) return std::make_shared<modal::PostureModel>(cell.robot, payload, postures, options, progress);
  const CalibrationDocument document = document_of(cell, postures, options);
  const std::optional<modal::PostureCalibration> kept = document.read(notes);
  auto model =
      std::make_shared<modal::PostureModel>(cell.robot, payload, postures, options, progress, kept ? &*kept : nullptr);
  bool in_place = kept && !model->searched();
  if (model->searched()) {
    if (kept) {
      notes.push_back(
          fmt::format("The calibration is made anew: {} does not have the error that it states.", document.name()));
    }
    in_place = document.write(*model->calibration(), notes);
  }
  if (in_place) notes.push_back(kept_text(document));
  return model;
}

}  // namespace

CellDynamics cell_dynamics(const Cell& cell, Progress& progress) {
  CellDynamics out;
  require_different_files(cell);
  const std::vector<modal::MeasuredPosture> postures = all_measured(cell, out);
  const modal::PostureModelOptions options;
  std::vector<std::string> of_document;
  try {
    out.model = model_of(cell, postures, options, of_document, progress);
  } catch (const InvalidInput& error) {
    InvalidInput::Parts parts = error.parts();
    if (parts.field == "cell") parts.field = cell.path.string();
    throw InvalidInput(parts);
  }
  const modal::PostureReport& report = out.model->report();
  if (report.source == modal::PostureReport::Source::calibrated) {
    warn_of_misfits(*out.model, postures, options, out.warnings);
  }
  if (report.source == modal::PostureReport::Source::interpolated) {
    for (const modal::MeasuredPosture& posture : postures) {
      out.modes_of[posture.name] = out.model->at(posture.joints).modes.modes.size();
    }
  }
  if (report.source == modal::PostureReport::Source::calibrated) {
    out.direct_deviation = mean_deviation(*out.model, postures);
    out.notes.push_back(description(report));
    std::ranges::move(of_document, std::back_inserter(out.notes));
  }
  out.notes.insert(out.notes.end(), report.notes.begin(), report.notes.end());
  add_assumed(out.assumed, assumed_damping(cell, report));
  return out;
}

std::vector<std::string> calibration_notes(const Cell& cell) {
  std::vector<std::string> notes;
  if (cell.postures.empty()) return notes;
  try {
    CellDynamics read;
    const CalibrationDocument document = document_of(cell, all_measured(cell, read), {});
    if (document.read(notes)) {
      notes.push_back(kept_text(document));
    } else {
      notes.push_back(
          fmt::format("The postures are not calibrated yet: the next run that needs their dynamics does it, "
                      "and keeps it in {}.",
                      document.name()));
    }
  } catch (const InvalidInput& error) {
    notes.push_back(fmt::format("The postures cannot be calibrated: {}", error.what()));
  }
  return notes;
}

modal::PosturePrediction CellDynamics::at(const Eigen::VectorXd& joints) const {
  modal::PosturePrediction out = model->at(joints);
  if (!out.modes.modes.empty()) return out;
  throw InvalidInput(modes_of.empty() ? "modes" : "[[postures]]",
                     modes_of.empty()
                         ? "has no mode within the band"
                         : "the modes of the measured postures cannot be matched with each other here; the "
                           "nearest is " +
                               out.nearest,
                     "Give the cell robot.links and robot.joint_stiffness_n_m_per_rad, or measure a posture nearby");
}

std::size_t CellDynamics::unmatched(const modal::PosturePrediction& prediction) const {
  const auto nearest = modes_of.find(prediction.nearest);
  if (nearest == modes_of.end()) return 0;
  return nearest->second - std::min(nearest->second, prediction.modes.modes.size());
}

namespace {

/// Arms of 1.5 m reach and more have their first mode at 5 to 25 Hz.
void warn_of_lowest(const Cell& cell, ModesOfPosture& out) {
  if (out.report.source != modal::PostureReport::Source::cell || out.prediction.modes.modes.empty()) return;
  if (robot::stretched_reach_m(cell.robot.arm) < 1.5) return;
  double lowest_hz = std::numeric_limits<double>::infinity();
  for (const modal::Mode& mode : out.prediction.modes.modes) lowest_hz = std::min(lowest_hz, mode.frequency_hz);
  if (lowest_hz >= 2.5 && lowest_hz <= 28.0) return;
  out.warnings.push_back(fmt::format(
      "{}: the arm's first natural frequency would be {:.3g} Hz; 5 to 25 Hz is usual of an arm of this reach. Check "
      "robot.joint_stiffness_n_m_per_rad and the masses of the links.",
      cell.path.string(), lowest_hz));
}

ModesOfPosture modes_at(const CellFile& cell, const CellDynamics& dynamics, const std::vector<double>& joints_given,
                        PostureAxes axes) {
  ModesOfPosture out;
  out.joints = joints_given;
  const Eigen::VectorXd joints = to_vector(out.joints);
  try {
    out.prediction = dynamics.at(joints);
  } catch (const InvalidInput& error) {
    throw within(cell.path.string() + ": ", error);
  }
  out.unmatched = dynamics.unmatched(out.prediction);
  out.report = dynamics.model->report();
  out.direct_deviation = dynamics.model->direct_deviation(joints);
  out.warnings = dynamics.warnings;
  out.notes = dynamics.notes;
  std::vector<std::string> of_cell = cell.notes;
  std::ranges::move(io::take_warnings(of_cell), std::back_inserter(out.warnings));
  warn_of_lowest(cell, out);
  out.assumed = dynamics.assumed;
  const double along = robot::forward(cell.robot.arm, joints).linear()(2, 2);
  out.axis_off_z_rad = std::acos(std::clamp(std::abs(along), 0.0, 1.0));
  if (axes == PostureAxes::flange) {
    out.prediction.modes = turned(out.prediction.modes, flange_axes(cell, joints).transpose(), "joints");
  }
  return out;
}

}  // namespace

ModesOfPosture posture_modes(const std::filesystem::path& path, const std::vector<double>& joints, PostureAxes axes,
                             Progress& progress) {
  const CellFile cell = read_cell(path);
  require_posture(cell.robot.arm, joints);
  return modes_at(cell, cell_dynamics(cell, progress), joints, axes);
}

std::vector<ModesOfPosture> modes_of_postures(const std::filesystem::path& path, PostureAxes axes, Progress& progress) {
  const CellFile cell = read_cell(path);
  if (cell.postures.empty()) {
    throw InvalidInput(path.string(), "has no [[postures]]", "Give joints_deg and frf or modes of each");
  }
  for (const PostureEntry& entry : cell.postures) require_posture(cell.robot.arm, entry.joints);
  const CellDynamics dynamics = cell_dynamics(cell, progress);
  std::vector<ModesOfPosture> out;
  out.reserve(cell.postures.size());
  for (const PostureEntry& entry : cell.postures) out.push_back(modes_at(cell, dynamics, entry.joints, axes));
  return out;
}

}  // namespace robomill::cell
