#pragma once
#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "robomill/stability/collocation/collocation_model.hpp"
#include "robomill/stability/collocation/mesh/edge_contacts.hpp"

namespace robomill::stability::detail {

/// Any cutter in three directions.
class SpatialModel final : public CollocationModel {
 public:
  /// What cuts at a depth (or whatever a chart varies in its place), with so many rings in each smooth stretch of the
  /// cutter.
  using Engage = std::function<cutting::Engagement(double depth, int rings)>;
  struct Parts {
    cutting::Cutter cutter;
    cutting::MillingCoefficients coefficients;
    double feed_per_tooth_m = 0.0;
    modal::TipModes structure = {};  ///< of the tool against the workpiece
    bool turns_with_tool = false;    ///< the structure's axes are those of T; else those of F
    Engage engage = {};
  };
  explicit SpatialModel(Parts parts);

  [[nodiscard]] std::size_t modes() const override { return static_cast<std::size_t>(tip_.pole.size()); }
  [[nodiscard]] bool depends_on_depth() const override { return true; }
  [[nodiscard]] double factor(const OperatingPoint& point) const override { return point.gain; }
  void expect(std::span<const double> depths_m, bool picture) override;
  [[nodiscard]] int first_level(const OperatingPoint& point, double tolerance) const override;
  [[nodiscard]] int rough_level(int first) const override { return std::max(first - 1, 1); }
  [[nodiscard]] std::size_t at_a_time() const override { return 3; }
  /// With several delays a piece has a matrix for each other one that it looks back to.
  [[nodiscard]] std::size_t largest_state() const override { return equal_teeth_ ? 4000 : 1500; }
  [[nodiscard]] double reported_rad() const override { return period_rad_; }
  [[nodiscard]] double whole_rad() const override { return period_rad_; }
  [[nodiscard]] Motion motion(const CollocationCase& at, double factor, std::complex<double> multiplier,
                              const Eigen::VectorXcd& vector) const override;

 private:
  struct Looked {
    EdgeContacts contacts;
    Eigen::Matrix3d feed_from_tool;
  };
  [[nodiscard]] std::shared_ptr<const Looked> look(double depth, int rings) const;
  void mesh(const OperatingPoint& point, const MeshLevel& level, CollocationCase& out) const;
  void make(const OperatingPoint& point, const MeshLevel& level, const CollocationCase* beside,
            CollocationCase& out) const override;
  void plan(double length_rad, int nodes, const CollocationCase* beside, CollocationCase& out) const;

  Parts parts_;
  std::vector<double> expected_;  ///< depths whose engagements are kept, increasing
  mutable std::mutex kept_mutex_;
  bool picture_ = false;
  mutable std::map<std::pair<double, int>, std::shared_ptr<const Looked>> kept_;  ///< by depth and rings
  /// Of a picture: mesh and stiffness by depth, level and how fast the modes are beside the cutter.
  mutable std::map<std::array<double, 4>, std::shared_ptr<const CollocationCase>> meshes_;
  TipDynamicsIn<3> tip_;
  double fastest_rad_per_s_ = 0.0;
  bool equal_teeth_ = true;
  double period_rad_ = 0.0;
};

/// Of a problem in three directions; a chart varies `sweep`.
SpatialModel::Parts spatial_parts(const LobesProblem& problem, SweptParameter sweep);

}  // namespace robomill::stability::detail
