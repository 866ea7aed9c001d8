#include "robomill/process/measured.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/usual_ranges.hpp"
#include "robomill/process/forces.hpp"

namespace robomill::process {
namespace {

cutting::PredictedRevolution prediction_of(const ForcesResult& result) {
  const RevolutionForces& revolution = *result.revolution;
  const cutting::FlatEndMill& mill = result.cut.cutter.mill;
  const bool vibrating = revolution.vibrating_force_n.cols() > 0;
  const Eigen::Matrix3Xd& force_n = vibrating ? revolution.vibrating_force_n : revolution.deflected.force.force_n;
  return {.rotation_rad = revolution.deflected.force.rotation_rad,
          .force_n = (result.cut.on_workpiece ? -1.0 : 1.0) * force_n,
          .teeth = mill.teeth,
          .teeth_alike = !vibrating && mill.has_equal_teeth()};
}

/// The error where it belongs: the record's file, or the file of the cut.
InvalidInput with_file(const InvalidInput& error, const ForcesResult& result, const cutting::ForceRecordFile& record) {
  InvalidInput::Parts parts = error.parts();
  if (!parts.where.empty() || (parts.field != "record" && parts.field != "predicted")) return error;
  parts.where = (parts.field == "record" ? record.path : result.cut.path).string();
  parts.field = parts.field == "record" ? "" : "the predicted force";
  return InvalidInput(std::move(parts));
}

/// "-Fy" of a column and a sign.
std::string signed_channel(const std::string& channel, bool turned) {
  if (!turned) return channel;
  return channel.starts_with('-') ? channel.substr(1) : "-" + channel;
}

std::string channels_text(const cutting::SignedAxes& axes, const cutting::ForceRecordFile& record, bool opposite) {
  std::string out;
  for (const int axis : axes) {
    const std::string& channel = record.channels[static_cast<std::size_t>(std::abs(axis)) - 1];
    out += (out.empty() ? "" : ",") + signed_channel(channel, (axis < 0) != opposite);
  }
  return out;
}

/// A dynamometer's axes are right-handed. Those that come out left-handed are right-handed with every sign turned,
/// which is what the force on the other body has.
bool left_handed(const cutting::SignedAxes& axes) {
  Eigen::Matrix3d turned = Eigen::Matrix3d::Zero();
  for (Eigen::Index i = 0; i < 3; ++i) {
    const int axis = axes[static_cast<std::size_t>(i)];
    turned(i, std::abs(axis) - 1) = axis < 0 ? -1.0 : 1.0;
  }
  return turned.col(0).cross(turned.col(1)).dot(turned.col(2)) < 0.0;
}

std::string better_axes_text(const cutting::ForceRecordFile& record, const cutting::MeasuredForce& found,
                             bool on_workpiece) {
  const cutting::SignedAxes& axes = *found.better_axes;
  const std::string errors = fmt::format("an error of {:.3g} % of all components in place of {:.3g} %",
                                         100.0 * found.better_axes_error_ratio, 100.0 * found.error_ratio_of_all);
  if (left_handed(axes)) {
    const std::string channels = channels_text(axes, record, true);
    const bool as_given = axes == cutting::SignedAxes{-1, -2, -3};
    return fmt::format(
        "{}the record fits the prediction better with every sign turned: {} with force_on = \"{}\" in the cut's "
        "file{}. "
        "Which body does the measured force act on?",
        io::warning_label, errors, on_workpiece ? "tool" : "workpiece", as_given ? "" : " and --channels=" + channels);
  }
  return fmt::format(
      "{}the record fits the prediction better with other axes: {} with --channels={}. Do the axes of the dynamometer "
      "run as assumed?",
      io::warning_label, errors, channels_text(axes, record, false));
}

}  // namespace

void compare_with_record(ForcesResult& result, const cutting::ForceRecordFile& record, const RecordStretch& stretch) {
  if (!result.revolution) {
    throw InvalidInput("measured", "goes with the forces of one revolution", "Leave the program out");
  }
  MeasuredRevolution out{.path = record.path, .channels = record.channels, .force = {}};
  try {
    out.force = cutting::compare_forces(record.record, prediction_of(result),
                                        {.spindle_speed_rad_per_s = result.cut.motion.spindle_speed_rad_per_s,
                                         .speed_tolerance = stretch.speed_tolerance,
                                         .from_s = stretch.from_s,
                                         .to_s = stretch.to_s});
  } catch (const InvalidInput& error) {
    throw with_file(error, result, record);
  }
  std::vector<std::string> notes = record.notes;
  notes.insert(notes.end(), out.force.notes.begin(), out.force.notes.end());
  if (out.force.air_revolutions > 0) {
    notes.push_back(
        fmt::format("The mean of {} revolutions in air was taken off the measured force.", out.force.air_revolutions));
  } else {
    notes.emplace_back(
        "Measured forces are as recorded: the record has no five revolutions in air, so that an offset of the "
        "amplifier would be in the means.");
  }
  notes.emplace_back(
      "The angle between record and prediction is the one that fits best: errors are lower for it, and a phase that "
      "the "
      "prediction has wrong is not in them.");
  if (out.force.better_axes) notes.push_back(better_axes_text(record, out.force, result.cut.on_workpiece));
  const std::vector<std::string> warnings = io::take_warnings(notes);
  result.warnings.insert(result.warnings.end(), warnings.begin(), warnings.end());
  result.notes.insert(result.notes.end(), notes.begin(), notes.end());
  add_assumed(result.assumed, record.assumed);
  result.measured = std::move(out);
}

}  // namespace robomill::process
