#include "robomill/coupling/distributed.hpp"

#include <Eigen/LU>
#include <utility>

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

std::vector<JointGap> gaps_of(const Joint& joint, const Holder& holder, const Eigen::VectorXd& frequency_hz) {
  std::vector<JointGap> gaps;
  const double width = joint.insertion_length_m / (joint.points - 1);
  for (int i = 0; i + 1 < joint.points; ++i) {
    JointGap gap;
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

/// Both beams' elements of a gap, the shank's planes first; of S = N the shank's alone.
template <int N, int S>
Square<S> both(const Eigen::Matrix2cd& shank, const Eigen::Matrix2cd& holder) {
  Square<S> out = Square<S>::Zero();
  out.template topLeftCorner<N, N>() = planes<N>(shank);
  if constexpr (S > N) out.template bottomRightCorner<N, N>() = planes<N>(holder);
  return out;
}

/// From the shank's deep end to the mouth: b of both beams, or of the shank on the ground where S = N, and what b gains
/// by each of the joint's two stiffnesses.
/// @param each  flexibility of a point and its slopes, which are followed where `derivatives`
template <int N, int S, bool derivatives>
Along<N> climb(const std::vector<JointGap>& gaps, std::size_t line, const Square<N>& deep, const Along<N>& each) {
  using State = Square<S>;
  Along<S> b;
  b.value.setZero();
  if constexpr (S > N) b.value << deep, deep, deep, deep;
  b.value.template topLeftCorner<N, N>() += each.value;
  for (std::size_t j = 0; j < 2; ++j) {
    b.slope[j].setZero();
    b.slope[j].template topLeftCorner<N, N>() = each.slope[j];
  }
  Eigen::Matrix<std::complex<double>, S, N> apart;  // displacement of the shank against the holder
  apart.setZero();
  apart.template topRows<N>().setIdentity();
  if constexpr (S > N) apart.template bottomRows<N>() = -Square<N>::Identity();
  for (std::size_t i = gaps.size(); i-- > 0;) {
    const BeamElement& shank = gaps[i].shank[line];
    const BeamElement& holder = gaps[i].holder[line];
    const State carry = both<N, S>(shank.carry, holder.carry);
    const State stiffness = both<N, S>(shank.stiffness, holder.stiffness);
    if constexpr (derivatives) {
      // d (b⁻¹ + k)⁻¹ = E db Eᵀ, E = (1 + b k)⁻¹
      const State moved = State::Identity() + b.value * stiffness;
      const State up = carry * moved.partialPivLu().inverse();
      for (State& slope : b.slope) slope = (up * slope * up.transpose()).eval();
    }
    b.value = on_base<State>(both<N, S>(shank.clamped, holder.clamped), carry, stiffness, b.value);
    const Eigen::Matrix<std::complex<double>, S, N> pulled = b.value * apart;
    const Square<N> gap_stiffness = (apart.transpose() * pulled + each.value).inverse();
    const Eigen::Matrix<std::complex<double>, S, N> held = pulled * gap_stiffness;
    if constexpr (derivatives) {
      const State left = State::Identity() - held * apart.transpose();
      for (std::size_t j = 0; j < 2; ++j) {
        b.slope[j] = (left * b.slope[j] * left.transpose() + held * each.slope[j] * held.transpose()).eval();
      }
    }
    b.value -= (held * pulled.transpose()).eval();
    // Rounding leaves b a little unsymmetric, which would grow from point to point.
    b.value = (0.5 * (b.value + b.value.transpose())).eval();
  }
  Along<N> out;
  out.value = b.value.template topLeftCorner<N, N>();
  for (std::size_t j = 0; j < 2; ++j) out.slope[j] = b.slope[j].template topLeftCorner<N, N>();
  return out;
}

/// Of each of so many points, an equal share of Kc.
Along<2> point_flexibility(const Eigen::Matrix2cd& stiffness, double points) {
  const Eigen::Matrix2cd whole = stiffness.inverse();
  Along<2> out;
  out.value = points * whole;
  for (Eigen::Index j = 0; j < 2; ++j) {
    out.slope[static_cast<std::size_t>(j)] = -points * whole.col(j) * whole.row(j);
  }
  return out;
}

}  // namespace

template <int N>
std::vector<Square<N>> distributed(const Joint& joint, const Holder& holder, const std::vector<Square<N>>& base,
                                   const Eigen::VectorXd& frequency_hz) {
  const std::vector<JointGap> gaps = gaps_of(joint, holder, frequency_hz);
  const std::vector<Square<N>> deep = deep_base<N>(joint, holder, base, frequency_hz);
  std::vector<Square<N>> out(deep.size());
  parallel_for(out.size(), lines_per_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Along<N> each;
      each.value = joint.points * planes<N>(flexibility(joint, frequency_hz(static_cast<Eigen::Index>(i))));
      each.slope.fill(Square<N>::Zero());
      out[i] = climb<N, 2 * N, false>(gaps, i, deep[i], each).value;
    }
  });
  return out;
}

template std::vector<Square<2>> distributed<2>(const Joint&, const Holder&, const std::vector<Square<2>>&,
                                               const Eigen::VectorXd&);
template std::vector<Square<4>> distributed<4>(const Joint&, const Holder&, const std::vector<Square<4>>&,
                                               const Eigen::VectorXd&);

DistributedTip::DistributedTip(std::vector<BeamElement> tool, const Joint& joint, const Holder& holder,
                               const std::vector<Eigen::Matrix2cd>& base, const Eigen::VectorXd& frequency_hz)
    : tool_(std::move(tool)),
      gaps_(gaps_of(joint, holder, frequency_hz)),
      deep_(deep_base<2>(joint, holder, base, frequency_hz)),
      holder_moves_(!holder.segments.empty() || !holder.receptances.frfs.empty()) {}

DistributedTip::Response DistributedTip::at(std::size_t line, const Eigen::Matrix2cd& stiffness,
                                            bool derivatives) const {
  const Along<2> each = point_flexibility(stiffness, static_cast<double>(gaps_.size() + 1));
  const auto from_deep = [&]() -> Along<2> {
    if (holder_moves_) {
      return derivatives ? climb<2, 4, true>(gaps_, line, deep_[line], each)
                         : climb<2, 4, false>(gaps_, line, deep_[line], each);
    }
    return derivatives ? climb<2, 2, true>(gaps_, line, deep_[line], each)
                       : climb<2, 2, false>(gaps_, line, deep_[line], each);
  };
  const Along<2> mouth = from_deep();
  const BeamElement& tool = tool_[line];
  const Eigen::RowVector2cd carry = tool.carry.row(0);
  const Eigen::RowVector2cd left = carry * (Eigen::Matrix2cd::Identity() + mouth.value * tool.stiffness).inverse();
  Response out;
  out.receptance = tool.clamped(0, 0) + (left * mouth.value * carry.transpose()).value();
  for (std::size_t j = 0; j < 2; ++j) out.slope[j] = (left * mouth.slope[j] * left.transpose()).value();
  return out;
}

}  // namespace robomill::coupling::detail
