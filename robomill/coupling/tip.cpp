#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/coupling/assembly.hpp"
#include "robomill/coupling/base.hpp"
#include "robomill/coupling/beam_element.hpp"
#include "robomill/coupling/distributed.hpp"
#include "robomill/coupling/section.hpp"

namespace robomill::coupling {
namespace {

using detail::Base;
using detail::BeamElement;
using Eigen::Index;
using modal::Axis;

constexpr std::size_t lines_per_task = 128;

void require_frequencies(const Eigen::VectorXd& frequency_hz) {
  if (frequency_hz.size() == 0) throw InvalidInput("frequency_hz", "is empty");
  for (Index i = 0; i < frequency_hz.size(); ++i) {
    require_positive("frequency_hz", frequency_hz(i), "Hz", "A structure that hangs free has no receptance at 0 Hz");
    if (i > 0 && frequency_hz(i) <= frequency_hz(i - 1)) {
      throw InvalidInput("frequency_hz", frequency_hz(i), "Hz", "must be above the frequency before it");
    }
  }
}

/// What the tool stands on, through the joint: the base of one plane, or of both where N is 4.
template <int N>
std::vector<detail::Square<N>> under_tool(const Assembly& assembly, const std::vector<detail::Square<N>>& base,
                                          const Eigen::VectorXd& frequency_hz) {
  if (!assembly.joint) return base;
  if (assembly.joint->points > 1) {
    return detail::distributed<N>(*assembly.joint, assembly.holder, base, frequency_hz);
  }
  std::vector<detail::Square<N>> out = base;
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] += detail::planes<N>(detail::flexibility(*assembly.joint, frequency_hz(static_cast<Index>(i))));
  }
  return out;
}

template <class Matrix>
void require_finite_lines(const std::vector<Matrix>& receptance, const Eigen::VectorXd& frequency_hz) {
  for (std::size_t i = 0; i < receptance.size(); ++i) {
    if (receptance[i].allFinite()) continue;
    throw InvalidInput("frequency_hz", frequency_hz(static_cast<Index>(i)), "Hz",
                       "has no receptance: it is a resonance without damping, or beyond what can be computed",
                       "Give the segments a loss factor (steel has 0.001 to 0.02), and frequencies of a machine");
  }
}

template <int N>
std::vector<detail::Square<N>> tips(const Assembly& assembly, const std::vector<BeamElement>& tool,
                                    const std::vector<detail::Square<N>>& base, const Eigen::VectorXd& frequency_hz) {
  const std::vector<detail::Square<N>> under = under_tool<N>(assembly, base, frequency_hz);
  std::vector<detail::Square<N>> out(under.size());
  parallel_for(under.size(), lines_per_task, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) out[i] = detail::on_base<N>(tool[i], under[i]);
  });
  require_finite_lines(out, frequency_hz);
  return out;
}

/// R11 of the tool that nothing holds: g + t k⁻¹ tᵀ.
std::vector<Eigen::Matrix2cd> free_tips(const std::vector<BeamElement>& tool, const Eigen::VectorXd& frequency_hz) {
  std::vector<Eigen::Matrix2cd> out;
  out.reserve(tool.size());
  for (const BeamElement& element : tool) {
    out.emplace_back(element.clamped + element.carry * element.stiffness.inverse() * element.carry.transpose());
  }
  require_finite_lines(out, frequency_hz);
  return out;
}

/// Adds elements (rows x columns) of the matrices as FRFs of a plane for loads in a plane.
template <class Matrices>
void add_frfs(const Matrices& matrices, Axis plane, Axis load_plane, Index row0, Index column0, bool rotations,
              modal::FrfSet& set) {
  const int size = rotations ? 2 : 1;
  for (int column = 0; column < size; ++column) {
    for (int row = 0; row < size; ++row) {
      modal::Frf frf;
      frf.name = detail::element_name(plane, row, load_plane, column);
      const double sign = detail::element_sign(plane, row, load_plane, column);
      frf.receptance.resize(static_cast<Index>(matrices.size()));
      for (std::size_t i = 0; i < matrices.size(); ++i) {
        frf.receptance(static_cast<Index>(i)) = sign * matrices[i](row0 + row, column0 + column);
      }
      set.frfs.push_back(std::move(frf));
    }
  }
}

std::vector<Eigen::Matrix4cd> both_planes(const Base& base) {
  std::vector<Eigen::Matrix4cd> out(base.x.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] << base.x[i], base.xy[i], base.yx[i], base.y[i];
  return out;
}

}  // namespace

TipResult tip_frfs(const Assembly& assembly, const Eigen::VectorXd& frequency_hz, const TipOptions& options) {
  assembly.validate();
  require_frequencies(frequency_hz);
  Base base = detail::base_receptances(assembly.holder, frequency_hz);
  const std::vector<BeamElement> tool = detail::tool_elements(assembly, frequency_hz);
  TipResult result;
  result.frfs.frequency_hz = frequency_hz;
  const bool rotations = options.rotations;
  if (!base.xy.empty()) {
    const auto both = tips<4>(assembly, tool, both_planes(base), frequency_hz);
    add_frfs(both, Axis::x, Axis::x, 0, 0, rotations, result.frfs);
    add_frfs(both, Axis::y, Axis::x, 2, 0, rotations, result.frfs);
    add_frfs(both, Axis::x, Axis::y, 0, 2, rotations, result.frfs);
    add_frfs(both, Axis::y, Axis::y, 2, 2, rotations, result.frfs);
  } else {
    const auto x = assembly.holder.free ? free_tips(tool, frequency_hz) : tips<2>(assembly, tool, base.x, frequency_hz);
    add_frfs(x, Axis::x, Axis::x, 0, 0, rotations, result.frfs);
    // A round assembly is the same in both planes.
    const auto y = base.measured ? tips<2>(assembly, tool, base.y, frequency_hz) : x;
    add_frfs(y, Axis::y, Axis::y, 0, 0, rotations, result.frfs);
  }
  result.suspect_hz = std::move(base.suspect_hz);
  result.notes = std::move(base.notes);
  if (!result.suspect_hz.empty()) {
    result.notes.push_back(
        fmt::format("At {} lines, the first at {:.6g} Hz, the measured holder would create energy (Im H > 0 beyond its "
                    "noise): do not trust the tip there.",
                    result.suspect_hz.size(), result.suspect_hz.front()));
  }
  return result;
}

}  // namespace robomill::coupling
