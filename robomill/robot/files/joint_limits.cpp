#include "robomill/robot/files/joint_limits.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/io/key_unit.hpp"
#include "robomill/io/text.hpp"

namespace robomill::robot {
namespace {

/// One way to write a limit.
struct Key {
  std::string key;
  double factor = 1.0;
  bool for_revolute = true, for_prismatic = true;  ///< which joints it is for
  [[nodiscard]] bool takes(bool prismatic) const { return prismatic ? for_prismatic : for_revolute; }
  [[nodiscard]] bool bare() const { return for_revolute && for_prismatic; }
};

std::array<Key, 4> keys_of(const JointLimit& limit) {
  constexpr std::array<const char*, 4> per = {"", "_per_s", "_per_s2", "_per_s3"};
  const char* const time = per[static_cast<std::size_t>(limit.derivatives)];
  const std::string name = fmt::format("robot.joint_{}", limit.name);
  return {{{.key = name},
           {.key = fmt::format("{}_deg{}", name, time), .factor = units::deg, .for_prismatic = false},
           {.key = fmt::format("{}_rad{}", name, time), .for_prismatic = false},
           {.key = fmt::format("{}_mm{}", name, time), .factor = units::mm, .for_revolute = false}}};
}

std::vector<std::size_t> joints_of(const Key& key, const std::vector<bool>& prismatic) {
  std::vector<std::size_t> joints;
  for (std::size_t i = 0; i < prismatic.size(); ++i) {
    if (key.takes(prismatic[i])) joints.push_back(i);
  }
  return joints;
}

void require_length(const io::TomlFile& file, const Key& key, std::size_t wanted, std::size_t held) {
  if (wanted == held) return;
  const char* const kind = key.bare()         ? "a joint"
                           : key.for_revolute ? "for each revolute joint"
                                              : "for each prismatic joint";
  throw file.reject(key.key, fmt::format("must hold one number {}, {}; it holds {}", kind, wanted, held));
}

/// More than three turns, or three turns a second, or as many metres: degrees or millimetres, most likely.
void doubt_unit(const Key& key, const JointLimit& limit, const std::vector<bool>& prismatic,
                const std::vector<double>& values, std::vector<std::string>& notes) {
  constexpr double likely = 20.0;
  if (!key.bare() || limit.derivatives > 1) return;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(std::abs(values[i]) > likely)) continue;
    const char* const time = limit.derivatives == 0 ? "" : "/s";
    notes.push_back(fmt::format("{} holds {:.6g} {}{} for joint {}: if it is in {}{}, write {}", key.key, values[i],
                                prismatic[i] ? "m" : "rad", time, i + 1, prismatic[i] ? "mm" : "°", time,
                                keys_of(limit)[prismatic[i] ? 3 : 1].key));
    return;
  }
}

}  // namespace

std::vector<JointLimitKey> joint_limit_keys() {
  std::vector<JointLimitKey> out;
  for (const JointLimit& limit : joint_limits) {
    for (const Key& key : keys_of(limit)) {
      out.push_back({key.key.substr(key.key.find('.') + 1),
                     key.bare()
                         ? "one number for each joint, in rad or m (/s …); takes precedence over those of a URDF. "
                           "Not given: without limit"
                     : key.for_revolute ? "the same, one for each revolute joint"
                                        : "the same, one for each prismatic joint"});
    }
  }
  return out;
}

std::vector<std::optional<double>> read_joint_limit(io::TomlFile& file, const JointLimit& limit,
                                                    const std::vector<bool>& prismatic,
                                                    std::vector<std::string>& notes) {
  std::vector<std::optional<double>> out(prismatic.size());
  std::vector<std::string> from(prismatic.size());
  for (const Key& key : keys_of(limit)) {
    std::vector<double> values;
    if (!file.numbers(key.key, limit.name, key.factor, values)) continue;
    const std::vector<std::size_t> joints = joints_of(key, prismatic);
    require_length(file, key, joints.size(), values.size());
    for (std::size_t k = 0; k < joints.size(); ++k) {
      if (out[joints[k]]) throw file.reject(key.key, "must not stand beside " + from[joints[k]]);
      out[joints[k]] = values[k];
      from[joints[k]] = key.key;
    }
    doubt_unit(key, limit, prismatic, values, notes);
  }
  return out;
}

InvalidInput located_limit(const io::TomlFile& file, const JointLimit& limit, const std::vector<bool>& prismatic,
                           std::size_t joint, const InvalidInput& error) {
  for (const Key& key : keys_of(limit)) {
    if (!key.takes(prismatic[joint]) || !file.has(key.key)) continue;
    std::size_t place = 1;
    for (std::size_t i = 0; i < joint; ++i) place += key.takes(prismatic[i]) ? 1U : 0U;
    InvalidInput::Parts reported = file.reject(key.key, error.parts().rule, error.parts().hint).parts();
    reported.field += fmt::format("[{}]", place);
    reported.number = error.parts().number;
    if (reported.number) reported.number = io::round_15(*reported.number / key.factor);
    reported.unit = key.bare() ? error.parts().unit : io::unit_of_key(key.key);
    reported.value.clear();
    return InvalidInput(std::move(reported));
  }
  return file.located(error);
}

}  // namespace robomill::robot
