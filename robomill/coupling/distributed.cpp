#include "robomill/coupling/distributed.hpp"

#include <Eigen/LU>

#include "robomill/base/parallel.hpp"
#include "robomill/coupling/beam_element.hpp"
#include "robomill/coupling/section.hpp"

namespace robomill::coupling::detail {
namespace {

constexpr std::size_t lines_per_block = 64;

/// A rigid body without mass; the mouth's side is end 1.
BeamElement rigid_link(double length_m) {
  BeamElement link{.clamped = Eigen::Matrix2cd::Zero(), .carry = {}, .stiffness = Eigen::Matrix2cd::Zero()};
  link.carry << 1.0, -length_m, 0.0, 1.0;
  return link;
}

/// One gap between neighbouring points, from the mouth inwards.
struct Gap {
  std::vector<BeamElement> shank, holder;  // one a frequency
};

std::vector<Gap> gaps_of(const Joint& joint, const Holder& holder, const Eigen::VectorXd& frequency_hz) {
  std::vector<Gap> gaps;
  const double width = joint.insertion_length_m / (joint.points - 1);
  for (int i = 0; i + 1 < joint.points; ++i) {
    Gap gap;
    gap.shank = beam_elements(piece(joint.shank, i * width, (i + 1) * width), frequency_hz);
    if (!holder.segments.empty()) {
      gap.holder = beam_elements(piece(holder.segments, i * width, (i + 1) * width), frequency_hz);
    } else {
      gap.holder.assign(gap.shank.size(), rigid_link(width));
    }
    gaps.push_back(std::move(gap));
  }
  return gaps;
}

/// Receptance of the holder at the shank's deep end.
template <int N>
std::vector<Square<N>> deep_base(const Joint& joint, const Holder& holder, const std::vector<Square<N>>& mouth,
                                 const Eigen::VectorXd& frequency_hz) {
  std::vector<Square<N>> out = mouth;
  if (holder.segments.empty()) {
    const Square<N> carry = planes<N>(rigid_link(-joint.insertion_length_m).carry);
    for (Square<N>& base : out) base = carry * base * carry.transpose();
    return out;
  }
  const std::vector<Segment> rest = piece(holder.segments, joint.insertion_length_m, total_length(holder.segments));
  const std::vector<BeamElement> deep = rest.empty() ? std::vector<BeamElement>() : beam_elements(rest, frequency_hz);
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = rest.empty() ? Square<N>(Square<N>::Zero()) : planes<N>(deep[i].clamped);
  }
  return out;
}

/// Both beams' elements of a gap, the shank's planes first.
template <int N>
Square<2 * N> both(const Eigen::Matrix2cd& shank, const Eigen::Matrix2cd& holder) {
  Square<2 * N> out = Square<2 * N>::Zero();
  out.template topLeftCorner<N, N>() = planes<N>(shank);
  out.template bottomRightCorner<N, N>() = planes<N>(holder);
  return out;
}

template <int N>
Square<N> climb(const std::vector<Gap>& gaps, std::size_t line, const Square<N>& deep, const Square<N>& flexibility) {
  using Both = Square<2 * N>;
  Both b;
  b << deep + flexibility, deep, deep, deep;
  Eigen::Matrix<std::complex<double>, 2 * N, N> apart;  // displacement of the shank against the holder
  apart << Square<N>::Identity(), -Square<N>::Identity();
  for (std::size_t i = gaps.size(); i-- > 0;) {
    const BeamElement& shank = gaps[i].shank[line];
    const BeamElement& holder = gaps[i].holder[line];
    b = on_base<Both>(both<N>(shank.clamped, holder.clamped), both<N>(shank.carry, holder.carry),
                      both<N>(shank.stiffness, holder.stiffness), b);
    const Eigen::Matrix<std::complex<double>, 2 * N, N> pulled = b * apart;
    const Square<N> gap_flexibility = apart.transpose() * pulled + flexibility;
    b -= (pulled * gap_flexibility.inverse() * pulled.transpose()).eval();
    // Rounding leaves b a little unsymmetric, which would grow from point to point.
    b = (0.5 * (b + b.transpose())).eval();
  }
  return b.template topLeftCorner<N, N>();
}

}  // namespace

template <int N>
std::vector<Square<N>> distributed(const Joint& joint, const Holder& holder, const std::vector<Square<N>>& base,
                                   const Eigen::VectorXd& frequency_hz) {
  const std::vector<Gap> gaps = gaps_of(joint, holder, frequency_hz);
  const std::vector<Square<N>> deep = deep_base<N>(joint, holder, base, frequency_hz);
  std::vector<Square<N>> out(deep.size());
  parallel_for(out.size(), lines_per_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Square<N> share = joint.points * planes<N>(flexibility(joint, frequency_hz(static_cast<Eigen::Index>(i))));
      out[i] = climb<N>(gaps, i, deep[i], share);
    }
  });
  return out;
}

template std::vector<Square<2>> distributed<2>(const Joint&, const Holder&, const std::vector<Square<2>>&,
                                               const Eigen::VectorXd&);
template std::vector<Square<4>> distributed<4>(const Joint&, const Holder&, const std::vector<Square<4>>&,
                                               const Eigen::VectorXd&);

}  // namespace robomill::coupling::detail
