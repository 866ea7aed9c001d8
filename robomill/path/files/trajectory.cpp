#include "robomill/path/files/trajectory.hpp"

#include <algorithm>
#include <string>
#include <system_error>

#include "robomill/base/error.hpp"
#include "robomill/io/text.hpp"
#include "robomill/path/files/robot_programs/joint_programs.hpp"
#include "robomill/path/files/trajectory_parts.hpp"

namespace robomill::path {
namespace {

constexpr std::size_t large = std::size_t{1} << 20;

}  // namespace

void TrajectoryInfo::validate() const {
  if (joints < 1 || joints > 6) throw InvalidInput("joints", joints, "", "must be 1 to 6");
  require_positive("sample_period_s", sample_period_s, "s");
  require_non_negative("program_period_s", program_period_s, "s");
}

void RunDistances::include(const RunDistances& other) {
  joint_deviation_rad = std::max(joint_deviation_rad, other.joint_deviation_rad);
  tip_deviation_m = std::max(tip_deviation_m, other.tip_deviation_m);
  axis_deviation_rad = std::max(axis_deviation_rad, other.axis_deviation_rad);
  tip_error_m = std::max(tip_error_m, other.tip_error_m);
  axis_error_rad = std::max(axis_error_rad, other.axis_error_rad);
}

bool ProgramRun::keeps_tolerances() const {
  const auto within = [](double value, double tolerance) { return value <= tolerance * (1.0 + 1e-6); };
  return within(distances.tip_deviation_m, tip_tolerance_m) && within(distances.tip_error_m, tip_tolerance_m) &&
         within(distances.axis_deviation_rad, axis_tolerance_rad) &&
         within(distances.axis_error_rad, axis_tolerance_rad);
}

std::optional<ProgramRun> SampleFile::verify(program::Source& /*program*/, const robot::Kinematics& /*machine*/,
                                             const SmoothingOptions& /*options*/, bool /*refine*/,
                                             const Progress& /*progress*/) {
  return std::nullopt;
}

void SampleFile::state_collisions(const std::string& /*found*/) {}

void SampleFile::commit() {
  finish().commit();
}

PendingText::PendingText(const std::filesystem::path& path) : pending_(path) {}

void PendingText::restart() {
  buffer_.clear();
  pending_.resize(0);
}

void PendingText::flush() {
  pending_.write({buffer_.data(), buffer_.size()});
  buffer_.clear();
}

void PendingText::drain() {
  if (buffer_.size() >= large) flush();
}

io::PendingFile& PendingText::finish() {
  flush();
  pending_.prepare();
  return pending_;
}

std::unique_ptr<SampleFile> open_sample_file(const std::filesystem::path& path, const TrajectoryInfo& info) {
  info.validate();
  const std::string ending = io::lowered(path.extension().string());
  const bool csv = ending == ".csv";
  if (csv || ending == ".h5" || ending == ".hdf5") {
    if (info.program_period_s > 0.0) {
      throw InvalidInput("program_period_s", info.program_period_s, "s", "is of joint programs, not of trajectories");
    }
    return csv ? open_trajectory_csv(path, info) : open_trajectory_hdf5(path, info);
  }
  if (ending == ".src") return open_joint_program(path, info, JointLanguage::krl);
  if (ending == ".mod") return open_joint_program(path, info, JointLanguage::rapid);
  if (ending == ".script") return open_joint_program(path, info, JointLanguage::urscript);
  if (ending == ".servoj") return open_joint_program(path, info, JointLanguage::servoj);
  throw InvalidInput(path.string(),
                     "a trajectory is written as .csv or .h5, a joint program as .src (KUKA), .mod (ABB), .script or "
                     ".servoj (Universal Robots)");
}

}  // namespace robomill::path
