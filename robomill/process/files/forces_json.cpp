#include <string>

#include "robomill/base/units.hpp"
#include "robomill/io/system/append.hpp"
#include "robomill/process/files/forces_schema.hpp"

namespace robomill::process {
namespace {

std::string revolution_csv(const RevolutionForces& revolution, double sign) {
  const cutting::CuttingForce& force = revolution.deflected.force;
  const bool vibrating = revolution.vibrating_force_n.cols() > 0;
  std::string text = "rotation_deg,fx_n,fy_n,fz_n,torque_n_m";
  text += vibrating ? ",vibrating_fx_n,vibrating_fy_n,vibrating_fz_n\n" : "\n";
  for (Eigen::Index i = 0; i < force.rotation_rad.size(); ++i) {
    const Eigen::Vector3d f = sign * force.force_n.col(i);
    io::append(text, "{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}", force.rotation_rad(i) / units::deg, f.x(), f.y(), f.z(),
               force.torque_n_m(i));
    if (vibrating) {
      const Eigen::Vector3d v = sign * revolution.vibrating_force_n.col(i);
      io::append(text, ",{:.9g},{:.9g},{:.9g}", v.x(), v.y(), v.z());
    }
    text += '\n';
  }
  return text;
}

}  // namespace

std::string forces_csv(const ForcesResult& result) {
  if (result.program) return forces_columns().csv(lines_of(result));
  return revolution_csv(*result.revolution, result.cut.on_workpiece ? -1.0 : 1.0);
}

std::string forces_json(const ForcesResult& result) {
  return io::dump(forces_table().write(result));
}

}  // namespace robomill::process
