#pragma once
#include <span>
#include <vector>

#include "robomill/stability/collocation/collocation_case.hpp"
#include "robomill/stability/collocation/collocation_kernels.hpp"
#include "robomill/stability/eigen/period_map.hpp"

namespace robomill::stability::detail {

/// Lanes of one point.
struct LaneRange {
  std::size_t first = 0, end = 0;
};

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
  [[nodiscard]] double work() const override;

  /// A state of this mesh from one of a coarser mesh of the same cut, with other nodes in the same pieces or in the
  /// same parts of them; where the pieces do not fit, of the modes alone. @param nodes  of the other mesh
  void take_over(const Eigen::VectorXd& coarse, int nodes, std::size_t lane, std::span<Lanes> out) const;

 private:
  /// Matrices of the pieces one after the other.
  template <class Entry>
  struct Matrices {
    std::vector<Entry> observation, influence, displacement, node_response;
    std::vector<NodeBlock<Entry>> blocks;
    void resize(std::size_t contacts, std::size_t m, std::size_t modal, bool remembers_motion);
    void fill(std::size_t contact, LaneRange lanes, std::size_t m, const CollocationCase::Piece& piece);
    void set_blocks(const Lanes* factored, std::size_t m, std::size_t modal);
  };

  [[nodiscard]] bool remembers_motion() const {
    return topology_.form == MeshTopology::Form::several || topology_.form == MeshTopology::Form::blocks;
  }
  void lay_out(const MeshTopology& topology);
  void fill(std::span<const Point> points);
  void fill(const Point& point, LaneRange lanes);
  void fill_looks(const CollocationCase& at, std::size_t piece, LaneRange lanes);
  void factor();

  NodeLayout layout_;
  MeshTopology topology_;
  std::vector<NodePiece> pieces_;
  std::vector<NodeLook> looks_;
  std::size_t contacts_ = 0;
  // What the points say; one case may be that of all of them.
  bool shared_ = false;
  Lanes factor_ = {};
  Matrices<Lanes> own_;
  Matrices<double> common_;
  std::vector<Lanes> coupling_, factors_, weights_, matrices_;
  std::vector<Lanes> factored_, memory_, state_;
};

}  // namespace robomill::stability::detail
