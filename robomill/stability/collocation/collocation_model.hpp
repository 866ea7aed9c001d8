#pragma once
#include <Eigen/Core>
#include <complex>
#include <cstddef>
#include <memory>
#include <span>

#include "robomill/base/lanes.hpp"
#include "robomill/stability/collocation/collocation_case.hpp"
#include "robomill/stability/lobes.hpp"
#include "robomill/stability/vibration/motion.hpp"

namespace robomill::stability::detail {

/// A cut and its structure: what no point of the chart changes. Shared by threads.
class CollocationModel {
 public:
  virtual ~CollocationModel() = default;
  /// n
  [[nodiscard]] virtual std::size_t modes() const = 0;
  /// Whether the case of a point depends on its depth, not on its speed alone.
  [[nodiscard]] virtual bool depends_on_depth() const = 0;
  /// What the stiffness of a case is multiplied by at a point, gain included.
  [[nodiscard]] virtual double factor(const OperatingPoint& point) const = 0;
  /// Depths that will be asked for often, as of Scheme.
  virtual void expect(std::span<const double> depths_m, bool picture) {
    static_cast<void>(depths_m);
    static_cast<void>(picture);
  }
  /// By several threads at once.
  /// @param beside  another case of this model, whose plans are taken where pieces are alike
  void prepare(const OperatingPoint& point, const MeshLevel& level, CollocationCase& out,
               const CollocationCase* beside = nullptr) const {
    make(point, level, beside, out);
  }
  /// Where the search for an accuracy starts.
  [[nodiscard]] virtual int first_level(const OperatingPoint& point, double tolerance) const = 0;
  /// In its place where a search looks once more.
  [[nodiscard]] virtual int rough_level(int first) const { return first; }
  /// As of PointEvaluator.
  [[nodiscard]] virtual std::size_t at_a_time() const { return lane_count; }
  /// Length of the state beyond which no finer level is taken.
  [[nodiscard]] virtual std::size_t largest_state() const = 0;
  /// Rotation over which the spectral radius is reported, and that of the whole period.
  [[nodiscard]] virtual double reported_rad() const = 0;
  [[nodiscard]] virtual double whole_rad() const = 0;
  /// How the motion of a multiplier looks.
  /// @param vector  eigenvector of the period's map
  [[nodiscard]] virtual Motion motion(const CollocationCase& at, double factor, std::complex<double> multiplier,
                                      const Eigen::VectorXcd& vector) const = 0;

 private:
  virtual void make(const OperatingPoint& point, const MeshLevel& level, const CollocationCase* beside,
                    CollocationCase& out) const = 0;
};

/// Of a problem; in three directions its depth is the axial one.
std::unique_ptr<CollocationModel> collocation_model(const LobesProblem& problem);

/// Ever finer meshes: 4, 6, … 16 nodes in a piece, then 14 in halves, quarters, … of it.
MeshLevel mesh_level(int number);
inline constexpr int last_level = 11;
/// For pieces of so many radians of the fastest mode, which the cut quickens.
int level_for(double radians, double quicker, double tolerance);

}  // namespace robomill::stability::detail
