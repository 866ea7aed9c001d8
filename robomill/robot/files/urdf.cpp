#include "robomill/robot/files/urdf.hpp"

#include <console_bridge/console.h>
#include <fmt/format.h>
#include <tinyxml.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cstdint>
#include <exception>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/text.hpp"

namespace robomill::robot {
namespace {

constexpr std::uintmax_t most_bytes = std::uintmax_t{16} << 20;
constexpr int deepest_nesting = 256;
constexpr std::size_t most_joints = 2000;  // a chain of them is walked, and taken apart, by recursion

/// Keeps what urdfdom says in place of writing it to standard error. The place for it is one for the whole process.
class Listener final : public console_bridge::OutputHandler {
 public:
  Listener() : lock_(one_at_a_time()) { console_bridge::useOutputHandler(this); }
  ~Listener() override { console_bridge::restorePreviousOutputHandler(); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && said_.empty()) said_ = text;
  }
  [[nodiscard]] const std::string& said() const { return said_; }

 private:
  static std::mutex& one_at_a_time() {
    static std::mutex mutex;
    return mutex;
  }
  std::lock_guard<std::mutex> lock_;
  std::string said_;
};

/// Where the markup that begins at `at` ends, and by how much it nests what follows.
struct Markup {
  std::size_t end = 0;
  int deeper = 0;
};

Markup markup_at(std::string_view content, std::size_t at) {
  const std::string_view here = content.substr(at);
  const auto after = [&](std::string_view closing, int deeper) -> Markup {
    const std::size_t found = content.find(closing, at);
    return {found == std::string_view::npos ? content.size() : found + closing.size(), deeper};
  };
  if (here.starts_with("<!--")) return after("-->", 0);
  if (here.starts_with("<![CDATA[")) return after("]]>", 0);
  if (here.starts_with("<?") || here.starts_with("<!")) return after(">", 0);
  if (here.starts_with("</")) return after(">", -1);
  char quote = '\0';
  for (std::size_t i = at + 1; i < content.size(); ++i) {
    const char letter = content[i];
    if (quote != '\0') {
      quote = letter == quote ? '\0' : quote;
    } else if (letter == '"' || letter == '\'') {
      quote = letter;
    } else if (letter == '>') {
      return {i + 1, content[i - 1] == '/' ? 0 : 1};
    }
  }
  return {content.size(), 1};
}

/// tinyxml calls itself once a level: text made to nest without end would take the stack.
void require_shallow(std::string_view content, const std::string& where) {
  int depth = 0;
  for (std::size_t at = content.find('<'); at < content.size(); at = content.find('<', at)) {
    const Markup markup = markup_at(content, at);
    depth = std::max(0, depth + markup.deeper);
    if (depth > deepest_nesting) throw InvalidInput(where, "nests its elements too deeply for a URDF");
    at = markup.end;
  }
}

std::string attribute(const TiXmlElement& element, const char* name) {
  const char* value = element.Attribute(name);
  return value != nullptr ? value : "";
}

/// The joint that carries each link: its name and the link that it stands on.
struct Carrier {
  std::string joint, parent;
};
using Carriers = std::map<std::string, Carrier, std::less<>>;

Carriers carriers_of(const TiXmlElement& robot, const std::string& where) {
  Carriers carriers;
  for (const TiXmlElement* joint = robot.FirstChildElement("joint"); joint != nullptr;
       joint = joint->NextSiblingElement("joint")) {
    const TiXmlElement *parent = joint->FirstChildElement("parent"), *child = joint->FirstChildElement("child");
    if (parent == nullptr || child == nullptr) continue;  // urdfdom says so
    const auto [at, first] =
        carriers.try_emplace(attribute(*child, "link"), Carrier{attribute(*joint, "name"), attribute(*parent, "link")});
    if (!first) {
      throw InvalidInput(where,
                         fmt::format("lets two joints carry link \"{}\": \"{}\" and \"{}\"", at->first,
                                     at->second.joint, attribute(*joint, "name")),
                         "The links of a URDF are a tree; leave out the joint that closes a linkage");
    }
    if (carriers.size() > most_joints) {
      throw InvalidInput(where, fmt::format("has more than {} joints", most_joints));
    }
  }
  return carriers;
}

/// urdfdom takes links that form a ring, and a walk along it would not end.
void require_tree(const std::string& content, const std::string& where) {
  TiXmlDocument document;
  document.Parse(content.c_str());
  const TiXmlElement* robot = document.FirstChildElement("robot");
  if (robot == nullptr) return;  // urdfdom says so
  const Carriers carriers = carriers_of(*robot, where);
  std::set<std::string, std::less<>> rooted;  // links known to lead down to a root
  for (const auto& [start, unused] : carriers) {
    std::vector<std::string_view> way;
    for (auto at = carriers.find(start); at != carriers.end() && !rooted.contains(at->first);
         at = carriers.find(at->second.parent)) {
      way.push_back(at->first);
      if (way.size() > carriers.size()) {
        throw InvalidInput(
            where,
            fmt::format("has links that form a ring, through joint \"{}\" of link \"{}\"", at->second.joint, at->first),
            "The links of a URDF are a tree; leave out the joint that closes a linkage");
      }
    }
    rooted.insert(way.begin(), way.end());
  }
}

/// The text with comments as blanks, line for line.
std::string without_comments(std::string_view content) {
  std::string out(content);
  for (std::size_t at = out.find("<!--"); at != std::string::npos; at = out.find("<!--", at)) {
    const std::size_t end = std::min(out.find("-->", at), out.size());
    for (; at < end; ++at) {
      if (out[at] != '\n') out[at] = ' ';
    }
  }
  return out;
}

/// What is taken for a URDF and is none. A URDF that xacro wrote may still declare its namespace and hold lines of it
/// in comments; a URDF for MuJoCo has an element of its name.
void require_no_other_description(std::string_view whole, const std::string& where) {
  const std::string content = without_comments(whole);
  constexpr const char* as_urdf = "Write it as URDF";
  const std::size_t xacro = content.find("<xacro:"), value = content.find("${");
  if (xacro != std::string::npos || value != std::string::npos) {
    const auto line = 1 + std::ranges::count(content.substr(0, std::min(xacro, value)), '\n');
    throw InvalidInput(
        fmt::format("{}:{}", where, line), "is xacro, from which a URDF is made, and no URDF yet",
        "Write it out with the tool of ROS: xacro FILE.xacro > FILE.urdf, of a macro the file that uses it");
  }
  for (const auto& [begin, name] : {std::pair{"<sdf", "SDF (Gazebo)"}, {"<mujoco", "MJCF (MuJoCo)"}}) {
    const std::size_t robot = content.find("<robot");
    if (content.find(begin) < robot) {
      throw InvalidInput(where, fmt::format("is {}, which is not read", name), as_urdf);
    }
  }
}

urdf::ModelInterfaceSharedPtr parse(std::string_view content, const std::string& where) {
  require_no_other_description(content, where);
  require_shallow(content, where);
  // tinyxml takes the bytes of a letter together: of a text that ends within one it would read on behind its end.
  const std::string ended = std::string(content) + std::string(4, '\0');
  require_tree(ended, where);
  const Listener listener;
  std::string said;
  try {
    urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(ended);
    if (model && listener.said().empty()) return model;
    said = listener.said();
  } catch (const std::exception& error) {
    said = error.what();
  }
  throw InvalidInput(where, "is no URDF that can be read" + (said.empty() ? said : ": " + said),
                     "A revolute or prismatic joint needs <limit>; write <robot name=...> around everything");
}

Eigen::Isometry3d pose_of(const urdf::Pose& pose) {
  const Eigen::Quaterniond rotation(pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z);
  return Eigen::Translation3d(pose.position.x, pose.position.y, pose.position.z) * rotation.normalized();
}

/// Adds a rigid body, both in one frame.
void add(Link& sum, const Link& body) {
  const double mass_kg = sum.mass_kg + body.mass_kg;
  if (mass_kg > 0.0) {
    const Eigen::Vector3d center_m = (sum.mass_kg * sum.center_m + body.mass_kg * body.center_m) / mass_kg;
    for (const Link* part : {&std::as_const(sum), &body}) {
      const Eigen::Vector3d arm_m = part->center_m - center_m;
      const Eigen::Matrix3d about =
          part->mass_kg * (arm_m.squaredNorm() * Eigen::Matrix3d::Identity() - arm_m * arm_m.transpose());
      if (part == &body) {
        sum.inertia_kg_m2 += body.inertia_kg_m2 + about;
      } else {
        sum.inertia_kg_m2 += about;
      }
    }
    sum.center_m = center_m;
  }
  sum.mass_kg = mass_kg;
}

Link body_of(const urdf::Link& link, const Eigen::Isometry3d& frame) {
  Link out;
  if (!link.inertial) return out;
  const urdf::Inertial& inertial = *link.inertial;
  const Eigen::Isometry3d at = frame * pose_of(inertial.origin);
  out.mass_kg = inertial.mass;
  out.center_m = at.translation();
  Eigen::Matrix3d own;
  own << inertial.ixx, inertial.ixy, inertial.ixz, inertial.ixy, inertial.iyy, inertial.iyz, inertial.ixz, inertial.iyz,
      inertial.izz;
  out.inertia_kg_m2 = at.linear() * own * at.linear().transpose();
  return out;
}

/// The walk from base to tip.
class Chain {
 public:
  Chain(const urdf::ModelInterface& model, std::string where, const UrdfReading& reading)
      : model_(model), where_(std::move(where)), reading_(reading) {}

  UrdfArm read() {
    const std::vector<urdf::JointSharedPtr> way = way_to_tip();
    std::string base = way.empty() ? reading_.tip : way.front()->parent_link_name;
    collect(*link(base), Eigen::Isometry3d::Identity(), way.empty() ? nullptr : way.front().get());
    for (std::size_t i = 0; i < way.size(); ++i) {
      step(*way[i]);
      collect(*link(way[i]->child_link_name), since_, i + 1 < way.size() ? way[i + 1].get() : nullptr);
    }
    if (out_.arm.joints.empty()) {
      throw reject(fmt::format("has no moving joint between {} and {}", base, reading_.tip));
    }
    out_.arm.flange = since_;
    try {
      out_.arm.validate();
    } catch (const InvalidInput& error) {
      throw named(error);
    }
    return std::move(out_);
  }

 private:
  [[nodiscard]] InvalidInput reject(const std::string& rule, const std::string& hint = {}) const {
    return {where_, rule, hint};
  }

  /// "joints[2].axis" as the file's own name: joint "elbow".axis
  [[nodiscard]] InvalidInput named(const InvalidInput& error) const {
    InvalidInput::Parts parts = error.parts();
    parts.where = where_;
    for (std::size_t i = 0; i < out_.arm.joints.size(); ++i) {
      const std::string prefix = fmt::format("joints[{}].", i + 1);
      if (!parts.field.starts_with(prefix)) continue;
      parts.field = fmt::format("joint \"{}\" {}", out_.arm.joints[i].name, parts.field.substr(prefix.size()));
      break;
    }
    return InvalidInput(std::move(parts));
  }

  [[nodiscard]] urdf::LinkConstSharedPtr link(const std::string& name) const {
    urdf::LinkConstSharedPtr found = model_.getLink(name);
    if (found) return found;
    std::vector<std::string> names;
    names.reserve(model_.links_.size());
    for (const auto& entry : model_.links_) names.push_back(entry.first);
    const std::string near = io::nearest_word(name, names);
    throw reject(fmt::format("has no link \"{}\"", name), near.empty() ? "" : fmt::format("Did you mean {}?", near));
  }

  [[nodiscard]] std::vector<urdf::JointSharedPtr> way_to_tip() const {
    if (reading_.tip.empty()) throw reject("needs the link of the flange", "urdf_tip = \"tool0\", say");
    if (!reading_.base.empty()) (void)link(reading_.base);
    std::vector<urdf::JointSharedPtr> way;
    urdf::LinkConstSharedPtr at = link(reading_.tip);
    while (at->name != reading_.base && at->parent_joint) {
      way.push_back(at->parent_joint);
      at = link(at->parent_joint->parent_link_name);
    }
    if (!reading_.base.empty() && at->name != reading_.base) {
      throw reject(fmt::format("does not lead from {} to {}: the way up from there ends at {}", reading_.base,
                               reading_.tip, at->name),
                   "They stand on different branches, or are exchanged");
    }
    std::reverse(way.begin(), way.end());
    return way;
  }

  /// Takes the frame over one joint, which may become a joint of the arm.
  void step(const urdf::Joint& joint) {
    const Eigen::Isometry3d origin = pose_of(joint.parent_to_joint_origin_transform);
    if (joint.type == urdf::Joint::FIXED) {
      since_ = since_ * origin;
      return;
    }
    const bool prismatic = joint.type == urdf::Joint::PRISMATIC, continuous = joint.type == urdf::Joint::CONTINUOUS;
    if (!prismatic && !continuous && joint.type != urdf::Joint::REVOLUTE) {
      throw reject(fmt::format("joint \"{}\" must be revolute, continuous, prismatic or fixed", joint.name));
    }
    if (joint.mimic) {
      throw reject(fmt::format("joint \"{}\" mimics {}: such arms are not read", joint.name, joint.mimic->joint_name),
                   "Linkages that keep axes parallel are left out of a serial arm's URDF");
    }
    Joint next{.name = joint.name, .prismatic = prismatic};
    next.before = since_ * origin;
    const Eigen::Vector3d axis(joint.axis.x, joint.axis.y, joint.axis.z);
    if (!(axis.norm() > 0.0)) throw reject(fmt::format("joint \"{}\" must have an axis", joint.name));
    next.axis = axis.normalized();
    if (joint.limits) {
      if (!continuous) {
        next.min_position = joint.limits->lower;
        next.max_position = joint.limits->upper;
      }
      next.max_velocity = joint.limits->velocity;
    }
    if (joint.dynamics) next.damping = joint.dynamics->damping;
    out_.arm.joints.push_back(std::move(next));
    since_.setIdentity();
  }

  /// Adds a link, and what hangs on it by fixed joints beside the chain, to what the last joint moves.
  void collect(const urdf::Link& here, const Eigen::Isometry3d& frame, const urdf::Joint* onwards) {
    // What stands on the base moves with no joint.
    if (!out_.arm.joints.empty()) add(out_.arm.joints.back().link, body_of(here, frame));
    for (const urdf::JointSharedPtr& joint : here.child_joints) {
      if (joint.get() == onwards) continue;
      if (joint->type == urdf::Joint::FIXED) {
        collect(*link(joint->child_link_name), frame * pose_of(joint->parent_to_joint_origin_transform), nullptr);
      } else {
        out_.notes.push_back(fmt::format("Joint {} of {} is not on the way to {}: it and what it moves are left out",
                                         joint->name, where_, reading_.tip));
      }
    }
  }

  const urdf::ModelInterface& model_;
  const std::string where_;
  const UrdfReading& reading_;
  UrdfArm out_ = {};
  Eigen::Isometry3d since_ = Eigen::Isometry3d::Identity();  // from the frame after the last joint
};

}  // namespace

UrdfArm parse_urdf(std::string_view content, const std::string& where, const UrdfReading& reading) {
  const urdf::ModelInterfaceSharedPtr model = parse(content, where);
  UrdfArm out = Chain(*model, where, reading).read();
  out.name = model->getName();
  return out;
}

UrdfArm read_urdf(const std::filesystem::path& path, const UrdfReading& reading) {
  return parse_urdf(io::read_file(path, most_bytes), path.string(), reading);
}

}  // namespace robomill::robot
