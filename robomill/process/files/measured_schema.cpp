#include "robomill/process/files/measured_schema.hpp"

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

namespace robomill::process {
namespace {

using cutting::ForceHarmonic;
using cutting::MeasuredForce;
using io::key;
using io::Row;
using io::Schema;
using io::Use;

/// x, y and z; null for one that was not measured.
Row<MeasuredRevolution> by_axis(const char* name, Eigen::Vector3d MeasuredForce::*value, const char* meaning) {
  return key(
             name, [value](const MeasuredRevolution& at) { return at.force.*value; }, meaning)
      .entries(3)
      .nullable();
}

template <class Value>
Row<MeasuredRevolution> of_force(const char* name, Value MeasuredForce::*value, const char* meaning) {
  return key(
      name, [value](const MeasuredRevolution& at) { return at.force.*value; }, meaning);
}

std::vector<Row<MeasuredRevolution>> courses() {
  std::vector<Row<MeasuredRevolution>> rows;
  const auto add = [&rows](const char* ending, Eigen::Matrix3Xd MeasuredForce::*course, const char* meaning) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const auto value = [axis, course](const MeasuredRevolution& at) {
        return Eigen::VectorXd((at.force.*course).row(axis).transpose());
      };
      rows.push_back(key(fmt::format("f{}_{}", "xyz"[axis], ending), value, meaning).nullable());
    }
  };
  add("n", &MeasuredForce::force_n, "mean revolution at the steps of rotation_deg");
  add("std_n", &MeasuredForce::deviation_n, "standard deviation of single revolutions about it");
  return rows;
}

const Schema<ForceHarmonic>& harmonic_table() {
  static const Schema<ForceHarmonic> table(
      "force_harmonic", "amplitudes at a multiple of the rotation",
      {key("multiple", &ForceHarmonic::multiple, "of the spindle speed"),
       key("frequency_hz", &ForceHarmonic::frequency_hz, "at the record's speed"),
       key("measured_n", &ForceHarmonic::measured_n, "amplitude in x, y, z").entries(3).nullable(),
       key("predicted_n", &ForceHarmonic::predicted_n, "the same of the prediction").entries(3).nullable()},
      Use::written);
  return table;
}

}  // namespace

const Schema<MeasuredRevolution>& measured_table() {
  static const Schema<MeasuredRevolution> table(
      "measured_forces", "a force record beside the prediction; components that were not measured are null",
      [] {
        std::vector<Row<MeasuredRevolution>> rows = {
            key(
                "file", [](const MeasuredRevolution& at) { return at.path.filename().string(); }, "the record"),
            key(
                "channels",
                [](const MeasuredRevolution& at) {
                  return std::vector<std::string>(at.channels.begin(), at.channels.end());
                },
                "its columns for x, y, z: - before one that is turned, \"none\""),
            of_force("sample_rate_hz", &MeasuredForce::sample_rate_hz, "of the record"),
            of_force("from_s", &MeasuredForce::from_s,
                     "where the revolutions begin that count; tooth 0 is at rotation 0"),
            of_force("to_s", &MeasuredForce::to_s, "where they end"),
            of_force("revolutions", &MeasuredForce::revolutions, "that count"),
            of_force("revolutions_in_record", &MeasuredForce::revolutions_in_record,
                     "whole ones at the speed of the cut"),
            of_force("spindle_speed_rpm", &MeasuredForce::spindle_speed_rad_per_s, "of the record"),
            of_force("spindle_speed_std_rpm", &MeasuredForce::spindle_speed_deviation_rad_per_s, "standard deviation"),
            of_force("wander_deg", &MeasuredForce::wander_rad, "standard deviation of a revolution's angle"),
            of_force("offset_std_deg", &MeasuredForce::offset_deviation_rad, "of the mean revolution's angle"),
            of_force("air_revolutions", &MeasuredForce::air_revolutions,
                     "whose mean was taken off; 0: forces are as recorded"),
            by_axis("zero_n", &MeasuredForce::zero_n,
                    "that mean; of air before and after the cut on a straight line at its middle"),
            by_axis("drift_n", &MeasuredForce::drift_n, "of the means over the stretch, taken out about its middle"),
            by_axis("mean_n", &MeasuredForce::mean_n, "measured, x, y, z"),
            by_axis("mean_std_n", &MeasuredForce::mean_deviation_n, "standard deviation of single revolutions"),
            by_axis("predicted_mean_n", &MeasuredForce::predicted_mean_n, "of what it is compared with"),
            by_axis("peak_n", &MeasuredForce::peak_n, "largest of the mean revolution, with its sign"),
            by_axis("peak_std_n", &MeasuredForce::peak_deviation_n, "standard deviation of single revolutions"),
            by_axis("predicted_peak_n", &MeasuredForce::predicted_peak_n, "largest, with its sign"),
            by_axis("rms_n", &MeasuredForce::rms_n, "root mean square of the mean revolution"),
            by_axis("predicted_rms_n", &MeasuredForce::predicted_rms_n, "root mean square"),
            by_axis("scatter_n", &MeasuredForce::scatter_n, "root mean square of single revolutions about their mean"),
            by_axis("between_teeth_n", &MeasuredForce::between_teeth_n,
                    "root mean square of what differs from tooth to tooth, noise included"),
            by_axis(
                "error_n", &MeasuredForce::error_n,
                "root mean square of predicted less measured, at the angle where they fit best; the noise of the mean "
                "revolution, scatter_n over the root of revolutions, is in it"),
            by_axis("error_ratio", &MeasuredForce::error_ratio, "over rms_n"),
            by_axis("shape_error_n", &MeasuredForce::shape_error_n, "the same without the means"),
            by_axis("shape_error_ratio", &MeasuredForce::shape_error_ratio,
                    "over the measured root mean square without its mean"),
            of_force("error_ratio_of_all", &MeasuredForce::error_ratio_of_all, "of all components together")};
        io::add_rows(rows, courses());
        rows.push_back(key(
            "harmonics", [](const MeasuredRevolution& at) { return at.force.harmonics; }, harmonic_table(),
            "of the rotation"));
        return rows;
      }(),
      Use::written);
  return table;
}

}  // namespace robomill::process
