#include "testing/modal/simulated_arm.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <string>

#include "robomill/base/linear_algebra.hpp"
#include "robomill/base/random.hpp"
#include "robomill/robot/stiffness.hpp"
#include "testing/modal/structure.hpp"
#include "testing/robot/arms.hpp"

namespace robomill::modal::testing {

using std::numbers::pi;
constexpr double gravity_m_per_s2 = 9.81;
constexpr double degree = pi / 180.0;
constexpr Eigen::Index joint_coordinates = 18;

/// What the arm is made with.
class ArmDice {
 public:
  explicit ArmDice(std::uint64_t seed, std::uint64_t stream) : random_(seed, stream) {}
  double operator()(double low, double high) { return random_.uniform(low, high); }
  /// A factor in [1 - most, 1 + most].
  double off(double most) { return random_.uniform(1.0 - most, 1.0 + most); }
  Eigen::Vector3d vector(double most) {
    const double x = random_.uniform(-most, most), y = random_.uniform(-most, most);
    return {x, y, random_.uniform(-most, most)};
  }

 private:
  Random random_;
};

namespace {

/// A link of UR10's size, from its data sheets.
robot::Arm ur10() {
  return robot::arm_from_dh({{.alpha_rad = pi / 2, .d_m = 0.1273},
                             {.a_m = -0.612},
                             {.a_m = -0.5723},
                             {.alpha_rad = pi / 2, .d_m = 0.163941},
                             {.alpha_rad = -pi / 2, .d_m = 0.1157},
                             {.d_m = 0.0922}});
}

/// A rod from the frame's origin to `end_m` with a thickness, its centre in between.
robot::Link rod(double mass_kg, const Eigen::Vector3d& end_m, double radius_m, ArmDice& dice) {
  robot::Link out;
  out.mass_kg = mass_kg;
  out.center_m = dice(0.3, 0.6) * end_m + dice.vector(0.4 * radius_m);
  const Eigen::Matrix3d slender = end_m.squaredNorm() * Eigen::Matrix3d::Identity() - end_m * end_m.transpose();
  out.inertia_kg_m2 = mass_kg * (slender / 12.0 + 0.4 * radius_m * radius_m * Eigen::Matrix3d::Identity());
  const Eigen::Vector3d uneven = dice.vector(0.3 * radius_m);
  out.inertia_kg_m2 += mass_kg * uneven * uneven.transpose();
  return out;
}

robot::Link moved(const Eigen::Isometry3d& frame, const robot::Link& link) {
  robot::Link out = link;
  out.center_m = frame * link.center_m;
  out.inertia_kg_m2 = frame.linear() * link.inertia_kg_m2 * frame.linear().transpose();
  return out;
}

/// Two bodies as one.
robot::Link joined(const robot::Link& a, const robot::Link& b) {
  robot::Link out;
  out.mass_kg = a.mass_kg + b.mass_kg;
  out.center_m = (a.mass_kg * a.center_m + b.mass_kg * b.center_m) / out.mass_kg;
  out.inertia_kg_m2 = Eigen::Matrix3d::Zero();
  for (const robot::Link* link : {&a, &b}) {
    const Eigen::Vector3d arm = link->center_m - out.center_m;
    out.inertia_kg_m2 +=
        link->inertia_kg_m2 + link->mass_kg * (arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose());
  }
  out.inertia_kg_m2 = (0.5 * (out.inertia_kg_m2 + out.inertia_kg_m2.transpose())).eval();
  return out;
}

std::vector<Dof> tip_dofs() {
  return {{.point = 0, .axis = Axis::x}, {.point = 0, .axis = Axis::y}, {.point = 0, .axis = Axis::z}};
}

}  // namespace

/// Where everything stands at a posture, in the base axes. Body k < 6 is a link, moved by joints 0 to k; body 6 the
/// spindle, moved by the bracket too.
struct SimulatedArm::Pose {
  Eigen::Matrix3Xd axis, origin_m;  // 3 x m, of the coordinates that turn something
  std::vector<int> first_body;      // of each, the first body that it moves
  std::array<Eigen::Matrix3d, 7> turn = {};
  std::array<Eigen::Vector3d, 7> center_m = {};
  Eigen::Vector3d tip_m = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, 3, 2> bending = Eigen::Matrix<double, 3, 2>::Zero();  // directions of the tool's modes

  /// Velocities of a point of a body, 3 x n of the whole arm's coordinates.
  [[nodiscard]] Eigen::Matrix3Xd of_point(int body, const Eigen::Vector3d& at_m, Eigen::Index n) const {
    Eigen::Matrix3Xd out = Eigen::Matrix3Xd::Zero(3, n);
    for (Eigen::Index i = 0; i < axis.cols(); ++i) {
      if (first_body[static_cast<std::size_t>(i)] > body) continue;
      const Eigen::Vector3d about = axis.col(i), lever = at_m - origin_m.col(i);
      out.col(i) = about.cross(lever);
    }
    return out;
  }
  [[nodiscard]] Eigen::Matrix3Xd of_turn(int body, Eigen::Index n) const {
    Eigen::Matrix3Xd out = Eigen::Matrix3Xd::Zero(3, n);
    for (Eigen::Index i = 0; i < axis.cols(); ++i) {
      if (first_body[static_cast<std::size_t>(i)] <= body) out.col(i) = axis.col(i);
    }
    return out;
  }
};

SimulatedArm::SimulatedArm(std::uint64_t seed) {
  heavy_ = seed % 2 == 0;
  spindle_across_ = (seed / 4) % 2 == 1;
  ArmDice dice(seed, 1), errors(seed, 2);
  if ((seed / 2) % 2 == 1) bracket_axes_ = dice(0.0, 1.0) < 0.5 ? 2 : 3;
  exact_.arm = heavy_ ? robot::testing::kr210() : ur10();
  home_.resize(6);
  if (heavy_) {
    home_ << 0.0, 15.0, 15.0, 0.0, 60.0, 0.0;
  } else {
    home_ << 180.0, -60.0, 90.0, -120.0, -90.0, 0.0;
  }
  home_ *= degree;
  if (spindle_across_) {
    mount_.translate(Eigen::Vector3d(0.0, 0.0, heavy_ ? 0.12 : 0.05));
    mount_.rotate(Eigen::AngleAxisd(dice(70.0, 100.0) * degree, Eigen::Vector3d::UnitX()));
  }
  exact_.arm.flange = exact_.arm.flange * mount_;
  exact_.tool_length_m = heavy_ ? dice(0.22, 0.38) : dice(0.12, 0.2);
  const std::array<double, 6> half = heavy_ ? std::array{185.0, 120.0, 150.0, 350.0, 125.0, 350.0}
                                            : std::array{360.0, 360.0, 360.0, 360.0, 360.0, 360.0};
  for (std::size_t i = 0; i < 6; ++i) {
    exact_.arm.joints[i].min_position = -half[i] * degree;
    exact_.arm.joints[i].max_position = half[i] * degree;
  }
  make_links(dice);
  make_springs(dice);
  make_damping(dice);
  tell(errors);
  Random postures(seed, 3);
  choose_postures(postures);
}

void SimulatedArm::make_links(ArmDice& dice) {
  const std::array<double, 6> mass_kg =
      heavy_ ? std::array{370.0, 300.0, 230.0, 120.0, 60.0, 20.0} : std::array{7.1, 12.7, 4.3, 2.0, 2.0, 0.7};
  const std::array<double, 6> radius_m =
      heavy_ ? std::array{0.35, 0.22, 0.25, 0.16, 0.14, 0.1} : std::array{0.08, 0.08, 0.07, 0.05, 0.05, 0.04};
  const std::array<double, 6> rotor =
      heavy_ ? std::array{120.0, 140.0, 90.0, 18.0, 14.0, 6.0} : std::array{1.2, 1.2, 0.6, 0.15, 0.15, 0.12};
  for (std::size_t i = 0; i < 6; ++i) {
    robot::Joint& joint = exact_.arm.joints[i];
    // The next joint, or the flange, as seen from this one.
    const Eigen::Vector3d end_m =
        i < 5 ? exact_.arm.joints[i + 1].before.translation() : Eigen::Vector3d(0.0, 0.0, heavy_ ? -0.2 : 0.05);
    links_[i] = rod(mass_kg[i] * dice.off(0.15), end_m, radius_m[i], dice);
    joint.rotor_inertia = rotor[i] * dice.off(0.3);
  }
  const double spindle_kg = heavy_ ? dice(15.0, 40.0) : dice(2.0, 4.0), length_m = 0.8 * exact_.tool_length_m;
  const double thick_m = heavy_ ? 0.07 : 0.035;
  spindle_ = rod(spindle_kg, Eigen::Vector3d(0.0, 0.0, length_m), thick_m, dice);
  shaft_kg_ = heavy_ ? dice(0.6, 1.4) : dice(0.08, 0.16);
  tool_kg_ = heavy_ ? dice(0.15, 0.35) : dice(0.03, 0.06);
  tool_turn_rad_ = dice(0.0, pi);

  const robot::Link at_tip{.mass_kg = shaft_kg_ + tool_kg_,
                           .center_m = Eigen::Vector3d(0.0, 0.0, exact_.tool_length_m),
                           .inertia_kg_m2 = Eigen::Matrix3d::Zero()};
  for (std::size_t i = 0; i < 6; ++i) exact_.arm.joints[i].link = links_[i];
  exact_.arm.joints[5].link = joined(links_[5], moved(exact_.arm.flange, joined(spindle_, at_tip)));
}

void SimulatedArm::make_springs(ArmDice& dice) {
  const std::array<double, 6> light{5.5e4, 6.0e4, 4.0e4, 9e3, 9e3, 8e3};
  spring_.resize(size());
  for (std::size_t i = 0; i < 6; ++i) {
    const auto row = static_cast<Eigen::Index>(3 * i);
    robot::Joint& joint = exact_.arm.joints[i];
    if (!heavy_) joint.stiffness = light[i];
    joint.stiffness *= dice(0.75, 1.3);
    spring_(row) = joint.stiffness;
    spring_(row + 1) = joint.stiffness * std::exp(dice(std::log(2.0), std::log(12.0)));
    spring_(row + 2) = joint.stiffness * std::exp(dice(std::log(2.0), std::log(12.0)));
    load_gain_[i] = dice(0.0, 0.15);
    slack_[i] = dice(0.0, 0.1);
  }
  for (Eigen::Index k = 0; k < bracket_axes_; ++k) {
    spring_(joint_coordinates + k) = heavy_ ? dice(0.5e6, 2.0e6) : dice(0.8e4, 3.0e4);
  }
  // The shaft with the tool on it, and the tool on the shaft; two directions that are nearly alike.
  const double shaft_hz = heavy_ ? dice(360.0, 560.0) : dice(400.0, 600.0), tool_hz = dice(800.0, 1100.0);
  for (Eigen::Index k = 0; k < 2; ++k) {
    const double shaft_rate = 2.0 * pi * shaft_hz * dice.off(0.05), tool_rate = 2.0 * pi * tool_hz * dice.off(0.05);
    spring_(size() - 4 + k) = (shaft_kg_ + tool_kg_) * shaft_rate * shaft_rate;
    spring_(size() - 2 + k) = tool_kg_ * tool_rate * tool_rate;
  }
  // What gravity asks of a joint at most: everything beyond it hangs a full reach away.
  const double reach_m = heavy_ ? 1.5 : 0.8;
  double beyond_kg = spindle_.mass_kg + shaft_kg_ + tool_kg_;
  for (std::size_t i = 6; i-- > 0;) {
    beyond_kg += links_[i].mass_kg;
    load_reference_n_m_[i] = gravity_m_per_s2 * beyond_kg * (i < 3 ? 0.5 * reach_m : 0.2 * reach_m);
  }
}

/// c = 2 ζ k / ω of each coordinate, with ω the frequency at which it is strained at home, the mean of the modes'
/// frequencies by their share of the coordinate's compliance.
void SimulatedArm::make_damping(ArmDice& dice) {
  const Pose at = pose(home_);
  const Eigen::LLT<Eigen::MatrixXd> factor(mass(at));
  const Eigen::MatrixXd half = factor.matrixL().solve(Eigen::MatrixXd(spring_.asDiagonal()));
  const Eigen::MatrixXd normal = factor.matrixL().solve(half.transpose());
  const linear_algebra::SymmetricEigenPairs pairs = linear_algebra::symmetric_eigen_pairs(normal);
  const Eigen::MatrixXd shapes = factor.matrixU().solve(pairs.vectors);
  dashpot_.resize(size());
  for (Eigen::Index i = 0; i < size(); ++i) {
    double mean_rate = 0.0;
    for (Eigen::Index k = 0; k < size(); ++k) {
      const double share = spring_(i) * shapes(i, k) * shapes(i, k) / pairs.values(k);
      mean_rate += share * std::sqrt(pairs.values(k));
    }
    double ratio = dice(0.012, 0.035);
    if (i < 9) ratio = dice(0.025, 0.055);            // joints 1 to 3
    if (i >= size() - 4) ratio = dice(0.012, 0.025);  // the tool
    dashpot_(i) = 2.0 * ratio * spring_(i) / mean_rate;
  }
  for (std::size_t i = 0; i < 6; ++i) exact_.arm.joints[i].damping = dashpot_(static_cast<Eigen::Index>(3 * i));
}

void SimulatedArm::tell(ArmDice& dice) {
  told_ = exact_;
  for (robot::Joint& joint : told_.arm.joints) {
    joint.stiffness *= dice.off(0.2);
    joint.damping *= dice.off(0.2);
    joint.rotor_inertia *= dice.off(0.2);
    joint.link.mass_kg *= dice.off(0.2);
    joint.link.inertia_kg_m2 *= dice.off(0.2);
    for (double& entry : joint.link.center_m) entry *= dice.off(0.2);
  }
}

/// Postures around home with the tip in a box and the arm far from singular; of 80 the 12 that lie farthest apart are
/// measured, the last 8 are held out.
void SimulatedArm::choose_postures(Random& random) {
  Eigen::VectorXd range(6);
  if (heavy_) {
    range << 25.0, 20.0, 20.0, 50.0, 30.0, 60.0;
  } else {
    range << 30.0, 20.0, 20.0, 30.0, 30.0, 60.0;
  }
  range *= degree;
  const Eigen::Vector3d box_m = heavy_ ? Eigen::Vector3d(0.45, 0.5, 0.35) : Eigen::Vector3d(0.25, 0.25, 0.2);
  const Eigen::Vector3d tip(0.0, 0.0, exact_.tool_length_m);
  const Eigen::Vector3d middle = robot::forward(exact_.arm, home_) * tip;
  std::vector<Eigen::VectorXd> found;
  while (found.size() < 88) {
    Eigen::VectorXd joints(6);
    for (Eigen::Index i = 0; i < 6; ++i) joints(i) = home_(i) + range(i) * random.uniform(-1.0, 1.0);
    const Eigen::Vector3d at = robot::forward(exact_.arm, joints) * tip - middle;
    if ((at.cwiseAbs() - box_m).maxCoeff() > 0.0) continue;
    const Eigen::Matrix<double, 6, Eigen::Dynamic> wrist = robot::jacobian(exact_.arm, joints, Eigen::Vector3d::Zero());
    if (robot::condition_number(wrist, heavy_ ? 1.0 : 0.4) > 25.0) continue;
    found.push_back(joints);
  }
  held_out_.assign(found.end() - 8, found.end());
  found.resize(80);
  measured_ = {found.front()};
  while (measured_.size() < 12) {
    const auto distance = [&](const Eigen::VectorXd& joints) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const Eigen::VectorXd& taken : measured_) nearest = std::min(nearest, (joints - taken).norm());
      return nearest;
    };
    measured_.push_back(*std::max_element(found.begin(), found.end(),
                                          [&](const auto& a, const auto& b) { return distance(a) < distance(b); }));
  }
}

SimulatedArm::Pose SimulatedArm::pose(const Eigen::VectorXd& joints) const {
  Pose out;
  const Eigen::Index turning = joint_coordinates + bracket_axes_;
  out.axis.resize(3, turning);
  out.origin_m.resize(3, turning);
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < 6; ++i) {
    const robot::Joint& joint = exact_.arm.joints[i];
    const auto column = static_cast<Eigen::Index>(3 * i);
    frame = frame * joint.before;
    out.axis.col(column) = frame.linear() * joint.axis;
    out.axis.col(column + 1) = frame.linear().col(0);
    out.axis.col(column + 2) = frame.linear().col(1);
    for (Eigen::Index k = 0; k < 3; ++k) {
      out.origin_m.col(column + k) = frame.translation();
      out.first_body.push_back(static_cast<int>(i));
    }
    frame = frame * Eigen::AngleAxisd(joints(static_cast<Eigen::Index>(i)), joint.axis);
    out.turn[i] = frame.linear();
    out.center_m[i] = frame * links_[i].center_m;
  }
  const Eigen::Isometry3d spindle = frame * exact_.arm.flange, flange = spindle * mount_.inverse();
  for (Eigen::Index k = 0; k < bracket_axes_; ++k) {
    out.axis.col(joint_coordinates + k) = flange.linear().col(k);
    out.origin_m.col(joint_coordinates + k) = flange.translation();
    out.first_body.push_back(6);
  }
  out.turn[6] = spindle.linear();
  out.center_m[6] = spindle * spindle_.center_m;
  out.tip_m = spindle * Eigen::Vector3d(0.0, 0.0, exact_.tool_length_m);
  out.bending = spindle.linear() * Eigen::AngleAxisd(tool_turn_rad_, Eigen::Vector3d::UnitZ()).matrix().leftCols<2>();
  return out;
}

Eigen::MatrixXd SimulatedArm::mass(const Pose& pose) const {
  const Eigen::Index n = size();
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(n, n);
  for (int body = 0; body < 7; ++body) {
    const auto b = static_cast<std::size_t>(body);
    const robot::Link& link = body < 6 ? links_[b] : spindle_;
    const Eigen::Matrix3Xd moves = pose.of_point(body, pose.center_m[b], n), turns = pose.of_turn(body, n);
    const Eigen::Matrix3d inertia = pose.turn[b] * link.inertia_kg_m2 * pose.turn[b].transpose();
    out += link.mass_kg * moves.transpose() * moves + turns.transpose() * inertia * turns;
  }
  Eigen::Matrix3Xd shaft = pose.of_point(6, pose.tip_m, n);
  shaft.middleCols(n - 4, 2) = pose.bending;
  Eigen::Matrix3Xd tool = shaft;
  tool.rightCols(2) = pose.bending;
  out += shaft_kg_ * shaft.transpose() * shaft + tool_kg_ * tool.transpose() * tool;
  for (std::size_t i = 0; i < 6; ++i) {
    const auto row = static_cast<Eigen::Index>(3 * i);
    out(row, row) += exact_.arm.joints[i].rotor_inertia;
  }
  return 0.5 * (out + out.transpose());
}

Eigen::VectorXd SimulatedArm::stiffness(const Pose& pose) const {
  const Eigen::Index n = size();
  Eigen::RowVectorXd load = Eigen::RowVectorXd::Zero(n);  // what gravity asks of each coordinate
  for (int body = 0; body < 7; ++body) {
    const auto b = static_cast<std::size_t>(body);
    const double weight_n = gravity_m_per_s2 * (body < 6 ? links_[b] : spindle_).mass_kg;
    load += weight_n * pose.of_point(body, pose.center_m[b], n).row(2);
  }
  const Eigen::Matrix3Xd tip = pose.of_point(6, pose.tip_m, n);
  load += gravity_m_per_s2 * (shaft_kg_ + tool_kg_) * tip.row(2);
  Eigen::VectorXd out = spring_;
  for (std::size_t i = 0; i < 6; ++i) {
    const auto row = static_cast<Eigen::Index>(3 * i);
    const double torque = std::abs(load(row)), hit = (heavy_ ? 200.0 : 20.0) * (0.05 + tip.col(row).norm());
    const double share = torque / hit;
    out(row) *= (1.0 + load_gain_[i] * torque / load_reference_n_m_[i]) * (1.0 - slack_[i] * std::exp(-share * share));
  }
  return out;
}

SimulatedArm::Matrices SimulatedArm::matrices(const Eigen::VectorXd& joints) const {
  const Pose at = pose(joints);
  Matrices out{.mass = mass(at),
               .damping = dashpot_.asDiagonal(),
               .stiffness = stiffness(at).asDiagonal(),
               .tip = at.of_point(6, at.tip_m, size())};
  out.tip.middleCols(size() - 4, 2) = at.bending;
  out.tip.rightCols(2) = at.bending;
  return out;
}

ModalModel SimulatedArm::modes(const Eigen::VectorXd& joints, double up_to_hz) const {
  const Matrices at = matrices(joints);
  Structure structure;
  for (int k = 0; k < static_cast<int>(size()); ++k) structure.dofs.push_back({.point = k + 1, .axis = Axis::x});
  structure.mass_kg = at.mass;
  structure.damping_n_s_per_m = at.damping;
  structure.stiffness_n_per_m = at.stiffness;
  ModalModel out;
  out.excitations = out.responses = tip_dofs();
  Eigen::Matrix3d rest = Eigen::Matrix3d::Zero();
  for (Mode mode : modes_of(structure).modes) {
    mode.right = (at.tip * mode.right).eval();
    mode.left = (at.tip * mode.left).eval();
    if (mode.frequency_hz > up_to_hz) {
      rest -= 2.0 * (mode.right * mode.left.transpose() / pole(mode)).real();
      continue;
    }
    normalise(mode);
    out.modes.push_back(mode);
  }
  for (Eigen::Index j = 0; j < 3; ++j) {
    for (Eigen::Index i = 0; i < 3; ++i) {
      out.residuals.push_back({.name = {.response = out.responses[static_cast<std::size_t>(i)],
                                        .excitation = out.excitations[static_cast<std::size_t>(j)]},
                               .mass = 0.0,
                               .stiffness = rest(i, j)});
    }
  }
  return out;
}

FrfSet SimulatedArm::receptance(const Eigen::VectorXd& joints, const Eigen::VectorXd& frequency_hz) const {
  const Matrices at = matrices(joints);
  FrfSet out;
  out.frequency_hz = frequency_hz;
  for (const Dof& excitation : tip_dofs()) {
    for (const Dof& response : tip_dofs()) {
      out.frfs.push_back({.name = {.response = response, .excitation = excitation},
                          .receptance = Eigen::VectorXcd::Zero(frequency_hz.size())});
    }
  }
  for (Eigen::Index line = 0; line < frequency_hz.size(); ++line) {
    const double rate = 2.0 * pi * frequency_hz(line);
    Eigen::MatrixXcd dynamic(size(), size());
    dynamic.real() = at.stiffness - rate * rate * at.mass;
    dynamic.imag() = rate * at.damping;
    const Eigen::MatrixXcd force = at.tip.transpose().cast<std::complex<double>>();
    const Eigen::Matrix3cd h = at.tip.cast<std::complex<double>>() * dynamic.partialPivLu().solve(force);
    for (Eigen::Index k = 0; k < 9; ++k) out.frfs[static_cast<std::size_t>(k)].receptance(line) = h(k % 3, k / 3);
  }
  return out;
}

FrfSet SimulatedArm::measure(const Eigen::VectorXd& joints, std::uint64_t seed, const Hammering& hammering) const {
  const auto lines = static_cast<Eigen::Index>(std::floor(
                         (hammering.last_line_hz - hammering.first_line_hz) / hammering.line_spacing_hz + 1e-9)) +
                     1;
  const Eigen::VectorXd frequency_hz =
      Eigen::VectorXd::LinSpaced(lines, hammering.first_line_hz,
                                 hammering.first_line_hz + hammering.line_spacing_hz * static_cast<double>(lines - 1));
  FrfSet out = receptance(joints, frequency_hz);
  if (!hammering.force_in_z) out.frfs.resize(6);
  Random random(seed, 4);
  for (Frf& frf : out.frfs) {
    frf.deviation.resize(lines);
    for (Eigen::Index line = 0; line < lines; ++line) {
      const double deviation = hammering.noise_ratio * std::abs(frf.receptance(line));
      const double re = random.normal(), im = random.normal();
      frf.receptance(line) += deviation / std::numbers::sqrt2 * std::complex<double>(re, im);
      frf.deviation(line) = hammering.noise_ratio * std::abs(frf.receptance(line));
    }
  }
  return out;
}

}  // namespace robomill::modal::testing
