#include "robomill/coupling/joint_model.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstring>
#include <numbers>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/lanes.hpp"
#include "robomill/base/parallel.hpp"

namespace robomill::coupling::detail {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

constexpr std::size_t lanes = 4;

[[noreturn]] void reject_line(double line_hz) {
  throw InvalidInput("frequency_hz", line_hz, "Hz",
                     "has no receptance: it is a resonance without damping, or beyond what can be computed",
                     "Give the segments a loss factor (steel has 0.001 to 0.02), and frequencies of a machine");
}

// Four doubles that the compiler maps to what the processor has; arithmetic lane by lane rounds the same on all.
using Four __attribute__((vector_size(lanes * sizeof(double)))) = double;

/// Complex numbers of four lines: std::complex looks for infinities in every product. They go by reference, since a
/// vector by value has another calling convention with AVX than without.
struct Numbers {
  Four re = {}, im = {};
};

inline __attribute__((always_inline)) void load(Numbers& to, const double* re, const double* im) {
  std::memcpy(&to.re, re, sizeof(Four));  // unaligned loads
  std::memcpy(&to.im, im, sizeof(Four));
}

inline __attribute__((always_inline)) void store(double* re, double* im, const Numbers& from) {
  std::memcpy(re, &from.re, sizeof(Four));
  std::memcpy(im, &from.im, sizeof(Four));
}

inline __attribute__((always_inline)) void multiply(Numbers& to, const Numbers& a, const Numbers& b) {
  const Four re = a.re * b.re - a.im * b.im;
  to.im = a.re * b.im + a.im * b.re;
  to.re = re;
}

/// to = a b - c d
inline __attribute__((always_inline)) void cross(Numbers& to, const Numbers& a, const Numbers& b, const Numbers& c,
                                                 const Numbers& d) {
  to.re = (a.re * b.re - a.im * b.im) - (c.re * d.re - c.im * d.im);
  to.im = (a.re * b.im + a.im * b.re) - (c.re * d.im + c.im * d.re);
}

struct Input {
  const double* omega;
  const double *rigid[2], *v_u[2], *v_theta[2], *w_u[2], *w_theta[2];
  const double *z_u[2], *z_theta[2], *z_cross[2], *z_cross_back[2], *z_product[2];
};
struct Output {
  double* receptance[2];
  double* along[2][2];
};

template <bool derivatives>
inline __attribute__((always_inline)) void respond(const Input& in, const JointValues& joint, std::size_t count,
                                                   const Output& out) {
  for (std::size_t i = 0; i < count; i += lanes) {
    const auto get = [i](Numbers & to, const double* const(&from)[2]) __attribute__((always_inline)) {
      load(to, from[0] + i, from[1] + i);
    };
    Four omega;
    std::memcpy(&omega, in.omega + i, sizeof(Four));
    Numbers v_u, v_theta, w_u, w_theta, z_cross, z_cross_back, z_product, h;
    Numbers at_u, at_theta;  // the diagonal of Z + Kc
    get(v_u, in.v_u), get(v_theta, in.v_theta), get(w_u, in.w_u), get(w_theta, in.w_theta);
    get(z_cross, in.z_cross), get(z_cross_back, in.z_cross_back), get(z_product, in.z_product), get(h, in.rigid);
    get(at_u, in.z_u), get(at_theta, in.z_theta);
    at_u.re += joint[0];
    at_u.im += omega * joint[1];
    at_theta.re += joint[2];
    at_theta.im += omega * joint[3];
    Numbers determinant, inverse;
    multiply(determinant, at_u, at_theta);
    determinant.re -= z_product.re;
    determinant.im -= z_product.im;
    const Four scale = 1.0 / (determinant.re * determinant.re + determinant.im * determinant.im);
    inverse.re = determinant.re * scale;
    inverse.im = -determinant.im * scale;
    Numbers right_u, right_theta;  // (Z + Kc)⁻¹ w
    cross(right_u, at_theta, w_u, z_cross, w_theta);
    cross(right_theta, at_u, w_theta, z_cross_back, w_u);
    multiply(right_u, right_u, inverse);
    multiply(right_theta, right_theta, inverse);
    Numbers part;
    multiply(part, v_u, right_u);
    h.re += part.re;
    h.im += part.im;
    multiply(part, v_theta, right_theta);
    h.re += part.re;
    h.im += part.im;
    store(out.receptance[0] + i, out.receptance[1] + i, h);
    if constexpr (derivatives) {
      Numbers left_u, left_theta;  // vᵀ (Z + Kc)⁻¹
      cross(left_u, at_theta, v_u, z_cross_back, v_theta);
      cross(left_theta, at_u, v_theta, z_cross, v_u);
      multiply(left_u, left_u, inverse);
      multiply(left_theta, left_theta, inverse);
      multiply(part, left_u, right_u);
      store(out.along[0][0] + i, out.along[0][1] + i, part);
      multiply(part, left_theta, right_theta);
      store(out.along[1][0] + i, out.along[1][1] + i, part);
    }
  }
}

template <bool derivatives>
void respond_baseline(const Input& in, const JointValues& joint, std::size_t count, const Output& out) {
  respond<derivatives>(in, joint, count, out);
}

#if defined(__x86_64__)
template <bool derivatives>
__attribute__((target("avx2"))) void respond_avx2(const Input& in, const JointValues& joint, std::size_t count,
                                                  const Output& out) {
  respond<derivatives>(in, joint, count, out);
}
#endif

std::size_t whole_vectors(Index lines) {
  return (static_cast<std::size_t>(lines) + lanes - 1) / lanes * lanes;
}

}  // namespace

void JointModel::Response::resize(Index padded, bool derivatives) {
  real.resize(padded);
  imag.resize(padded);
  for (std::size_t j = 0; derivatives && j < 2; ++j) {
    along_real[j].resize(padded);
    along_imag[j].resize(padded);
  }
}

void JointModel::resize(Index lines) {
  lines_ = lines;
  const std::size_t padded = whole_vectors(lines);
  omega_.assign(padded, 0.0);
  for (std::vector<double>& values : real_) values.assign(padded, 0.0);
  for (std::vector<double>& values : imag_) values.assign(padded, 0.0);
}

JointModel::JointModel(const std::vector<BeamElement>& tool, const std::vector<Eigen::Matrix2cd>& base,
                       const Eigen::VectorXd& frequency_hz, double cross_stiffness_n_per_rad)
    : cross_(cross_stiffness_n_per_rad) {
  resize(frequency_hz.size());
  for (std::size_t i = 0; i < tool.size(); ++i) {
    const double line_hz = frequency_hz(static_cast<Index>(i));
    omega_[i] = 2.0 * std::numbers::pi * line_hz;
    const BeamElement& element = tool[i];
    const Eigen::Matrix2cd one = Eigen::Matrix2cd::Identity();
    const Eigen::Matrix2cd held = (one + base[i] * element.stiffness).inverse();
    const Eigen::Matrix2cd z = element.stiffness * held;
    const Eigen::RowVector2cd carry = element.carry.row(0);
    const Eigen::RowVector2cd v = carry * held;
    const Eigen::Vector2cd w = (one + element.stiffness * base[i]).inverse() * carry.transpose();
    const Complex h = element.clamped(0, 0) + (v * base[i] * carry.transpose()).value();
    if (!std::isfinite(std::abs(h)) || !v.allFinite() || !w.allFinite() || !z.allFinite()) {
      reject_line(line_hz);
    }
    const auto set = [&](Constant constant, Complex value) {
      real_[constant][i] = value.real();
      imag_[constant][i] = value.imag();
    };
    set(rigid, h);
    set(v_u, v(0)), set(v_theta, v(1)), set(w_u, w(0)), set(w_theta, w(1));
    set(z_u, z(0, 0)), set(z_theta, z(1, 1));
    set(z_cross, z(0, 1) + cross_), set(z_cross_back, z(1, 0) + cross_);
    set(z_product, (z(0, 1) + cross_) * (z(1, 0) + cross_));
  }
}

JointModel::JointModel(std::shared_ptr<const DistributedTip> tip, const Eigen::VectorXd& frequency_hz,
                       double cross_stiffness_n_per_rad)
    : cross_(cross_stiffness_n_per_rad), distributed_(std::move(tip)) {
  resize(frequency_hz.size());
  for (Index i = 0; i < lines_; ++i) {
    omega_[static_cast<std::size_t>(i)] = 2.0 * std::numbers::pi * frequency_hz(i);
    line_of_.push_back(static_cast<std::size_t>(i));
  }
  // What the elements of a line have not, it has under no joint; this one stands for any.
  constexpr double stiff = 1e8;
  Response response;
  const double at_least = std::max(stiff, 2.0 * std::abs(cross_));
  evaluate_distributed({at_least, 0.0, at_least, 0.0}, response, true);
  for (Index i = 0; i < lines_; ++i) {
    bool finite = std::isfinite(response.real(i)) && std::isfinite(response.imag(i));
    for (std::size_t j = 0; j < 2; ++j) {
      finite = finite && std::isfinite(response.along_real[j](i)) && std::isfinite(response.along_imag[j](i));
    }
    if (!finite) reject_line(frequency_hz(i));
  }
}

JointModel JointModel::part(const std::vector<Index>& lines) const {
  JointModel part;
  part.cross_ = cross_;
  part.distributed_ = distributed_;
  part.resize(static_cast<Index>(lines.size()));
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::size_t from = static_cast<std::size_t>(lines[i]);
    part.omega_[i] = omega_[from];
    if (distributed_) part.line_of_.push_back(line_of_[from]);
    for (std::size_t c = 0; c < constants; ++c) {
      part.real_[c][i] = real_[c][from];
      part.imag_[c][i] = imag_[c][from];
    }
  }
  return part;
}

void JointModel::evaluate_distributed(const JointValues& joint, Response& response, bool derivatives) const {
  response.resize(static_cast<Index>(omega_.size()), derivatives);
  constexpr std::size_t lines_per_task = 32;
  parallel_for(line_of_.size(), lines_per_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Index at = static_cast<Index>(i);
      Eigen::Matrix2cd stiffness;
      stiffness << Complex(joint[0], omega_[i] * joint[1]), cross_, cross_, Complex(joint[2], omega_[i] * joint[3]);
      const DistributedTip::Response line = distributed_->at(line_of_[i], stiffness, derivatives);
      response.real(at) = line.receptance.real();
      response.imag(at) = line.receptance.imag();
      for (std::size_t j = 0; derivatives && j < 2; ++j) {
        response.along_real[j](at) = -line.slope[j].real();
        response.along_imag[j](at) = -line.slope[j].imag();
      }
    }
  });
}

template <bool derivatives>
void JointModel::evaluate(const JointValues& joint, Response& response) const {
  const auto pair = [&](const double*(&to)[2], Constant constant) {
    to[0] = real_[constant].data();
    to[1] = imag_[constant].data();
  };
  Input in{};
  in.omega = omega_.data();
  pair(in.rigid, rigid), pair(in.v_u, v_u), pair(in.v_theta, v_theta), pair(in.w_u, w_u), pair(in.w_theta, w_theta);
  pair(in.z_u, z_u), pair(in.z_theta, z_theta), pair(in.z_cross, z_cross), pair(in.z_cross_back, z_cross_back);
  pair(in.z_product, z_product);
  const Index padded = static_cast<Index>(omega_.size());
  if (distributed_) return evaluate_distributed(joint, response, derivatives);
  response.resize(padded, derivatives);
  Output out{.receptance = {response.real.data(), response.imag.data()}, .along = {}};
  if constexpr (derivatives) {
    for (std::size_t j = 0; j < 2; ++j) {
      out.along[j][0] = response.along_real[j].data();
      out.along[j][1] = response.along_imag[j].data();
    }
  }
#if defined(__x86_64__)
  if (kernels() != Kernels::baseline) return respond_avx2<derivatives>(in, joint, omega_.size(), out);
#endif
  respond_baseline<derivatives>(in, joint, omega_.size(), out);
}

void JointModel::receptance(const JointValues& joint, Response& response) const {
  evaluate<false>(joint, response);
}

void JointModel::sensitivity(const JointValues& joint, Response& response) const {
  evaluate<true>(joint, response);
}

}  // namespace robomill::coupling::detail
