#pragma once
#include <span>
#include <vector>

#include "robomill/stability/collocation/collocation_case.hpp"
#include "robomill/stability/collocation/collocation_kernels.hpp"
#include "robomill/stability/eigen/period_map.hpp"

namespace robomill::stability::detail {

/// Collocation's map over one period for eight points of one topology.
class CollocationMap final : public PeriodMap {
 public:
  struct Point {
    const CollocationCase* at = nullptr;
    double factor = 0.0;  ///< what its stiffness is multiplied by
  };
  /// Takes one to eight points of one topology; lanes left over repeat the last.
  void prepare(std::size_t modes, std::span<const Point> points);

  [[nodiscard]] std::size_t size() const override { return layout_.size(); }
  [[nodiscard]] std::size_t modal_size() const override { return layout_.modal; }
  void apply(const Lanes* in, Lanes* out) override;

 private:
  void lay_out(const MeshTopology& topology);
  void fill(std::span<const Point> points);
  void fill_looks(const CollocationCase& at, std::size_t piece, std::size_t lane);
  void factor();

  NodeLayout layout_;
  MeshTopology topology_;
  std::vector<NodePiece> pieces_;
  std::vector<NodeLook> looks_;
  // What the points say; matrices of the pieces one after the other.
  Lanes factor_ = {};
  std::vector<Lanes> coupling_, observation_, influence_, displacement_, node_response_, factors_, weights_, matrices_;
  std::vector<Lanes> factored_, memory_, state_;
  std::vector<NodeBlock> blocks_;
};

}  // namespace robomill::stability::detail
