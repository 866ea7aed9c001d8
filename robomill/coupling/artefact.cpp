#include "robomill/coupling/artefact.hpp"

#include <Eigen/LU>

#include "robomill/coupling/beam_element.hpp"
#include "robomill/coupling/section.hpp"

namespace robomill::coupling::detail {
namespace {

using Eigen::Index;

/// Of no length: its ends move as one.
const BeamElement& no_element() {
  static const BeamElement none{.clamped = Eigen::Matrix2cd::Zero(),
                                .carry = Eigen::Matrix2cd::Identity(),
                                .stiffness = Eigen::Matrix2cd::Zero()};
  return none;
}

/// From the free end to the held one: pieces[k] lies before point k, the last one before the held end.
ArtefactPoints at_points(const std::vector<const BeamElement*>& pieces) {
  const Index points = static_cast<Index>(pieces.size()) - 1;
  ArtefactPoints out;
  out.receptance = Eigen::MatrixXcd::Zero(2 * points, 2 * points);
  out.carry = Eigen::MatrixXcd::Zero(2 * points, 2);
  Eigen::Matrix2cd hanging = pieces.front()->stiffness;  // of what lies before the point
  for (Index k = 0; k < points; ++k) {
    const BeamElement& next = *pieces[static_cast<std::size_t>(k + 1)];
    const Eigen::Matrix2cd share = (Eigen::Matrix2cd::Identity() + next.clamped * hanging).inverse();
    const Eigen::Matrix2cd local = share * next.clamped;
    const Eigen::Matrix2cd carry = share * next.carry;
    // Points so far hang on this one, which now moves against the next station.
    const Index size = 2 * (k + 1);
    out.carry.block(2 * k, 0, 2, 2) = Eigen::Matrix2cd::Identity();
    const Eigen::MatrixXcd along = out.carry.topRows(size);
    out.receptance.topLeftCorner(size, size) += along * local * along.transpose();
    out.carry.topRows(size) = along * carry;
    hanging = next.stiffness + next.carry.transpose() * hanging * carry;
  }
  out.stiffness = hanging;
  return out;
}

}  // namespace

std::vector<ArtefactPoints> artefact_points(const std::vector<Segment>& artefact, const std::vector<double>& position_m,
                                            const Eigen::VectorXd& frequency_hz) {
  const double length = total_length(artefact);
  std::vector<std::vector<BeamElement>> pieces;
  double from = 0.0;
  for (std::size_t k = 0; k <= position_m.size(); ++k) {
    const double to = k < position_m.size() ? position_m[k] : length;
    const std::vector<Segment> between = piece(artefact, from, to);
    pieces.push_back(between.empty() ? std::vector<BeamElement>() : beam_elements(between, frequency_hz));
    from = to;
  }
  std::vector<ArtefactPoints> out;
  out.reserve(static_cast<std::size_t>(frequency_hz.size()));
  for (std::size_t i = 0; i < static_cast<std::size_t>(frequency_hz.size()); ++i) {
    std::vector<const BeamElement*> at;
    at.reserve(pieces.size());
    for (const std::vector<BeamElement>& p : pieces) at.push_back(p.empty() ? &no_element() : &p[i]);
    out.push_back(at_points(at));
  }
  return out;
}

}  // namespace robomill::coupling::detail
