#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "robomill/modal/impact/hits_pulse.hpp"
#include "robomill/page/thin.hpp"
#include "robomill/serve/tap/hits.hpp"

namespace robomill::serve {
namespace {

using Eigen::Index;

constexpr Index most_points = 400;
/// In widths of the pulse: drawn as finely as can be, and about as far as bounces come.
constexpr double near_before = 4.0, near_after = 8.0, far_before = 16.0, far_after = 200.0;

/// To draw: six digits.
io::Json short_numbers(const Eigen::VectorXd& values) {
  io::Json out = io::Json::array();
  for (const double value : values)
    out.push_back(io::number(std::strtod(fmt::format("{:.6g}", value).c_str(), nullptr)));
  return out;
}

/// The stretches of a curve between limits, each thinned by itself.
std::vector<Index> thin_stretches(const Eigen::VectorXd& values, const std::vector<Index>& limits, Index most) {
  std::vector<Index> keep;
  const Index share = most / static_cast<Index>(limits.size() - 1);
  for (std::size_t i = 0; i + 1 < limits.size(); ++i) {
    const Index count = limits[i + 1] - limits[i];
    if (count <= 0) continue;
    for (const Index at : page::thin(values.segment(limits[i], count), share)) keep.push_back(limits[i] + at);
  }
  return keep;
}

io::Json curve(const Eigen::VectorXd& values, const std::vector<Index>& limits, const modal::Pulse& pulse,
               double sample_rate_hz) {
  const std::vector<Index> keep = thin_stretches(values, limits, most_points);
  Eigen::VectorXd time_s(static_cast<Index>(keep.size()));
  for (std::size_t i = 0; i < keep.size(); ++i) {
    time_s(static_cast<Index>(i)) = static_cast<double>(keep[i] - pulse.peak) / sample_rate_hz;
  }
  return {{"time_s", short_numbers(time_s)}, {"values", short_numbers(values(keep))}};
}

io::Json magnitudes(const modal::FrfSet& set) {
  std::vector<Eigen::VectorXd> curves;
  for (const modal::Frf& frf : set.frfs) curves.emplace_back(frf.receptance.cwiseAbs());
  const std::vector<Index> keep = page::thin_together(curves, most_points);
  io::Json sizes = io::Json::object();
  for (std::size_t i = 0; i < curves.size(); ++i) sizes[to_string(set.frfs[i].name)] = short_numbers(curves[i](keep));
  return {{"frequency_hz", short_numbers(set.frequency_hz(keep))}, {"magnitude_m_per_n", std::move(sizes)}};
}

}  // namespace

io::Json hit_curves(const modal::Hit& hit, const std::optional<modal::FrfResult>& alone) {
  const modal::Pulse pulse = modal::find_pulse(hit.force_n);
  const Index count = hit.force_n.size();
  const auto at = [&](double widths) {
    return std::clamp<Index>(pulse.peak + static_cast<Index>(std::lround(widths * std::max(1.0, pulse.width))), 0,
                             count);
  };
  const std::vector<Index> about = {at(-far_before), at(-near_before), at(near_after), at(far_after)};
  const Eigen::VectorXd force_n = hit.force_n.array() - pulse.offset_n;
  io::Json responses = io::Json::object();
  for (const modal::HitChannel& channel : hit.responses) {
    responses[(channel.against_axis ? "-" : "") + to_string(channel.dof)] =
        curve(channel.samples, {at(-far_before), at(far_after), count}, pulse, hit.sample_rate_hz);
  }
  return {{"force", curve(force_n, about, pulse, hit.sample_rate_hz)},
          {"responses", std::move(responses)},
          {"frf", alone ? magnitudes(alone->set) : io::Json(nullptr)}};
}

}  // namespace robomill::serve
