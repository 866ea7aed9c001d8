#include <cmath>

#include "robomill/base/units.hpp"
#include "robomill/report/json.hpp"

namespace robomill::report {
namespace {

using Json = nlohmann::ordered_json;

Json segment_json(const coupling::Segment& segment, const char* part, std::size_t count) {
  const bool fluted = segment.flutes > 0;
  const bool weighed = segment.mass_kg > 0.0;
  return {{"part", part},
          {"count", count},
          {"length_mm", number(segment.length_m, units::mm)},
          {"diameter_mm", number(segment.diameter_m, units::mm)},
          {"inner_diameter_mm", segment.inner_diameter_m > 0.0 ? number(segment.inner_diameter_m, units::mm) : Json()},
          {"flutes", segment.flutes},
          {"equivalent_diameter_mm",
           fluted ? number(segment.flute_diameter_ratio * segment.diameter_m, units::mm) : Json()},
          {"youngs_modulus_gpa", number(segment.youngs_modulus_pa, units::gpa)},
          {"density_kg_per_m3", weighed ? Json() : number(segment.density_kg_per_m3)},
          {"mass_kg", weighed ? number(segment.mass_kg) : Json()},
          {"loss_factor", number(segment.loss_factor)},
          {"beam", segment.beam == coupling::Beam::timoshenko ? "Timoshenko" : "Euler–Bernoulli"}};
}

Json segments_json(const std::vector<coupling::Segment>& segments, const char* part) {
  Json list = Json::array();
  for (const coupling::Segment& segment : segments) list.push_back(segment_json(segment, part, list.size() + 1));
  return list;
}

Json joint_json(const coupling::Joint& joint) {
  return {{"translational_stiffness_n_per_m", number(joint.translational_stiffness_n_per_m)},
          {"translational_damping_n_s_per_m", number(joint.translational_damping_n_s_per_m)},
          {"rotational_stiffness_n_m_per_rad", number(joint.rotational_stiffness_n_m_per_rad)},
          {"rotational_damping_n_m_s_per_rad", number(joint.rotational_damping_n_m_s_per_rad)},
          {"cross_stiffness_n_per_rad", number(joint.cross_stiffness_n_per_rad)},
          {"points", joint.points},
          {"insertion_length_mm", joint.points > 1 ? number(joint.insertion_length_m, units::mm) : Json()},
          {"shank", segments_json(joint.points > 1 ? joint.shank : std::vector<coupling::Segment>{}, "shank")}};
}

/// What the joint stands on, in a word that the drawing and the tables share.
const char* holder_kind(const coupling::Holder& holder) {
  if (!holder.receptances.frfs.empty()) return "measured";
  return holder.segments.empty() ? "wall" : "segments";
}

}  // namespace

Json assembly_json(const Prediction& prediction) {
  const coupling::Assembly& assembly = prediction.assembly;
  Json peaks = Json::array();
  for (const TipPeak& peak : prediction.peaks) {
    peaks.push_back({{"name", modal::to_string(peak.name)},
                     {"frequency_hz", number(peak.frequency_hz)},
                     {"receptance_um_per_n", number(peak.receptance_m_per_n, units::um)},
                     {"measured_frequency_hz", number(peak.measured_frequency_hz)}});
  }
  return {{"tool", segments_json(assembly.tool, "tool")},
          {"joint", assembly.joint ? joint_json(*assembly.joint) : Json()},
          {"holder",
           {{"kind", holder_kind(assembly.holder)},
            {"segments", segments_json(assembly.holder.segments, "holder")},
            {"file", text(prediction.holder_file)}}},
          {"peaks", std::move(peaks)},
          {"suspect_lines", prediction.suspect_hz.size()},
          {"unreliable_lines", prediction.unreliable_hz.size()},
          {"notes", texts(prediction.notes)}};
}

Json bands_json(const Eigen::VectorXd& axis_hz, const std::vector<double>& lines_hz) {
  Json bands = Json::array();
  const Eigen::Index n = axis_hz.size();
  std::size_t next = 0;
  double from = missing;
  for (Eigen::Index i = 0; i < n; ++i) {
    // Axes that differ by less than this are the same, as for files.
    const double slack = 1e-5 * std::abs(axis_hz[i]);
    while (next < lines_hz.size() && lines_hz[next] < axis_hz[i] - slack) ++next;
    const bool marked = next < lines_hz.size() && lines_hz[next] <= axis_hz[i] + slack;
    const double low = i > 0 ? 0.5 * (axis_hz[i - 1] + axis_hz[i]) : axis_hz[i];
    if (marked && std::isnan(from)) from = low;
    if (!marked && !std::isnan(from)) {
      bands.push_back({number(from), number(low)});
      from = missing;
    }
  }
  if (!std::isnan(from)) bands.push_back({number(from), number(axis_hz[n - 1])});
  return bands;
}

}  // namespace robomill::report
