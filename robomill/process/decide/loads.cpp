#include "robomill/process/decide/loads.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "robomill/base/parallel.hpp"
#include "robomill/robot/pose.hpp"
#include "robomill/robot/stiffness.hpp"

namespace robomill::process {
namespace {

/// Of the range of feeds, and the longest that the force kernel takes.
constexpr double longest_feed_m = 0.0099;

struct Sample {
  double force_n = 0.0, torque_n_m = 0.0, deflection_m = 0.0;
};

/// One block at several feeds, scaled so that at the programmed one it bears what was found along the whole block.
class LoadSampler {
 public:
  explicit LoadSampler(const ForcesResult& forces)
      : forces_(forces), kernel_(forces.cut.cutter, forces.cut.coefficients, {.steps = 180}) {}

  BlockLoad at(std::size_t block, const std::array<double, 2>& chip_m) {
    const cutting::PoseEngagement& cut = forces_.program->cuts[block];
    const BlockResult& row = forces_.program->blocks[block];
    BlockLoad out;
    out.chip_share = cutting::greatest_chip_share(cut.engagement);
    if (!(out.chip_share > 0.0)) return out;
    const Eigen::Matrix3d compliance = compliance_of(row.joints);
    const auto sample = [&](double feed_m) {
      const cutting::ForceSummary force = kernel_.summary(
          cut.engagement, {.feed_per_tooth_m = feed_m, .spindle_speed_rad_per_s = row.force.spindle_speed_rad_per_s});
      return Sample{.force_n = force.peak_force_n,
                    .torque_n_m = force.mean_torque_n_m,
                    .deflection_m = (compliance * (cut.work_from_feed * force.mean_n)).norm()};
    };
    const Sample programmed = sample(std::min(row.force.feed_per_tooth_m, longest_feed_m));
    const auto scale = [](double found, double sampled) {
      return sampled > 0.0 ? std::max(1.0, found / sampled) : 1.0;
    };
    const double force_scale = scale(row.force.peak_force_n, programmed.force_n);
    const double torque_scale = scale(row.force.revolution_torque_n_m, programmed.torque_n_m);
    const double deflection_scale = scale(row.peak_deflection_m.norm(), programmed.deflection_m);
    const double low = std::min(chip_m[0] / out.chip_share, longest_feed_m);
    const double high = std::min(chip_m[1] / out.chip_share, longest_feed_m);
    out.feed_per_tooth_m = {low, 0.5 * (low + high), high};
    for (std::size_t k = 0; k < 3; ++k) {
      const Sample found = sample(out.feed_per_tooth_m.at(k));
      out.force_n.at(k) = force_scale * found.force_n;
      out.torque_n_m.at(k) = torque_scale * found.torque_n_m;
      out.deflection_m.at(k) = deflection_scale * found.deflection_m;
    }
    return out;
  }

 private:
  [[nodiscard]] Eigen::Matrix3d compliance_of(const Eigen::VectorXd& joints) const {
    const robot::Cell& cell = forces_.cell->robot;
    const robot::Stiffness stiffness = robot::stiffness(cell.arm, joints, robot::tip_point(cell));
    const Eigen::Matrix3d base_from_work = cell.workpiece.linear();
    return base_from_work.transpose() * stiffness.compliance.topLeftCorner<3, 3>() * base_from_work;
  }
  const ForcesResult& forces_;
  cutting::ForceKernel kernel_;
};

}  // namespace

double engaged_radius_m(const cutting::Engagement& engagement) {
  double radius = 0.0;
  for (std::size_t i = 0; i < engagement.slices.size(); ++i) {
    if (!engagement.of(i).empty()) radius = std::max(radius, engagement.slices[i].radius_m);
  }
  return radius;
}

double most_feed_per_tooth_m(const BlockLoad& load, const LoadSamples& samples, double allowed) {
  const std::array<double, 3>& feed = load.feed_per_tooth_m;
  if (samples[0] > allowed) return 0.0;
  for (std::size_t k = 1; k < 3; ++k) {
    if (samples.at(k) <= allowed) continue;
    const double share = (allowed - samples.at(k - 1)) / (samples.at(k) - samples.at(k - 1));
    return std::lerp(feed.at(k - 1), feed.at(k), share);
  }
  return feed[2];
}

double load_at(const BlockLoad& load, const LoadSamples& samples, double feed_per_tooth_m) {
  const std::array<double, 3>& feed = load.feed_per_tooth_m;
  const std::size_t k = feed_per_tooth_m < feed[1] ? 0 : 1;
  const double span = feed.at(k + 1) - feed.at(k);
  if (!(span > 0.0)) return samples.at(k);
  return std::lerp(samples.at(k), samples.at(k + 1), (feed_per_tooth_m - feed.at(k)) / span);
}

std::array<double, 2> programmed_chips_m(const ForcesResult& forces, const std::vector<LineUnit>& lines) {
  std::array<double, 2> out = {std::numeric_limits<double>::infinity(), 0.0};
  for (const LineUnit& line : lines) {
    for (const std::size_t block : line.cutting) {
      const double chip_m = forces.program->blocks[block].force.feed_per_tooth_m *
                            cutting::greatest_chip_share(forces.program->cuts[block].engagement);
      if (!(chip_m > 0.0)) continue;
      out[0] = std::min(out[0], chip_m);
      out[1] = std::max(out[1], chip_m);
    }
  }
  return out;
}

std::vector<BlockLoad> block_loads(const ForcesResult& forces, const std::vector<LineUnit>& lines,
                                   const std::array<double, 2>& chip_m) {
  std::vector<BlockLoad> out(forces.program->blocks.size());
  std::vector<std::size_t> cutting;
  for (const LineUnit& line : lines) cutting.insert(cutting.end(), line.cutting.begin(), line.cutting.end());
  parallel_for(cutting.size(), 64, [&](std::size_t begin, std::size_t end) {
    LoadSampler sampler(forces);
    for (std::size_t i = begin; i < end; ++i) out[cutting[i]] = sampler.at(cutting[i], chip_m);
  });
  return out;
}

}  // namespace robomill::process
