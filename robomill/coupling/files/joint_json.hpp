#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "robomill/coupling/joint_fit.hpp"
#include "robomill/io/schema.hpp"

namespace robomill::coupling {

/// joint.json as text: the joint in the keys of assembly.toml, how well it fits and what the FRF shows of it. A
/// deviation that is infinite is null.
[[nodiscard]] const io::Schema<JointFitResult>& joint_table();
[[nodiscard]] std::string joint_json(const JointFitResult& result);

/// A row for each of the four: value, standard deviation (empty where it is infinite), whether it is identifiable.
[[nodiscard]] std::string joint_csv(const JointFitResult& result);

/// What joint.json says of a joint.
struct JointFile {
  Joint joint = {};                        ///< the four values and the number of points; no cross stiffness, no shank
  std::vector<std::string> notes = {};     ///< sentences for the user
  std::vector<std::string> warnings = {};  ///< which values its FRF did not show, and a search that did not converge
};

/// Reads "joint" of joint.json, and of "identifiable" and "convergence", where they are there, what is to be warned of.
/// All else in it is left alone.
/// @throws InvalidInput with the file and "joint.rotational_stiffness_n_m_per_rad" if a value is missing, no finite
///     number or out of its range
[[nodiscard]] JointFile read_joint_json(const std::filesystem::path& path);

}  // namespace robomill::coupling
