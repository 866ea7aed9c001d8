#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "robomill/io/schema.hpp"
#include "robomill/io/toml/file.hpp"

/// The limits of a cell's joints, as cell.toml gives them: robot.joint_max_velocity in rad/s or m/s, by joint, with a
/// number for every joint; or with the unit in the key, _deg_per_s, _rad_per_s and _mm_per_s, with a number for every
/// joint of that kind, in their order. A machine with both kinds has two such lists.
namespace robomill::robot {

struct JointLimit {
  const char* name;  ///< of the SI member; behind "robot.joint_" the key
  int derivatives;   ///< 0 position … 3 jerk
};
inline constexpr std::array<JointLimit, 5> joint_limits = {
    {{"min_position", 0}, {"max_position", 0}, {"max_velocity", 1}, {"max_acceleration", 2}, {"max_jerk", 3}}};

/// A key of [robot] for a limit, and its meaning.
struct JointLimitKey {
  std::string name, meaning;
};
[[nodiscard]] std::vector<JointLimitKey> joint_limit_keys();

/// Their rows in a table. read_joint_limit reads them.
template <class T>
void add_joint_limits(std::vector<io::Row<T>>& rows) {
  for (const JointLimitKey& key : joint_limit_keys()) {
    rows.push_back(io::declared<T>(key.name, io::Holds::number, key.meaning, 1).or_one());
  }
}

/// @param prismatic  for every joint whether it is prismatic
/// @param notes   gets a sentence where a number without unit is not likely to be in rad or m
/// @return of every joint its value in SI, none where the file gives none
/// @throws InvalidInput if a list has another length, or two give the same joint's limit
[[nodiscard]] std::vector<std::optional<double>> read_joint_limit(io::TomlFile& file, const JointLimit& limit,
                                                                  const std::vector<bool>& prismatic,
                                                                  std::vector<std::string>& notes);

/// An error about one joint's limit, with the key, the place in its list and the number as the file has them.
/// @param joint  from 0
[[nodiscard]] InvalidInput located_limit(const io::TomlFile& file, const JointLimit& limit,
                                         const std::vector<bool>& prismatic, std::size_t joint,
                                         const InvalidInput& error);

}  // namespace robomill::robot
