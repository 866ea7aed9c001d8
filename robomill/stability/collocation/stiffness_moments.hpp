#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <vector>

#include "robomill/stability/collocation/mesh/edge_contacts.hpp"
#include "robomill/stability/collocation/moment_kernels.hpp"
#include "robomill/stability/gauss.hpp"

// Derived in docs/theory/three-directions.md
namespace robomill::stability::detail {

/// What the number of a piece's nodes alone decides.
struct NodeTable {
  std::size_t nodes = 0, moments = 0;
  const GaussRule* rule = nullptr;  ///< of the nodes
  std::vector<double> product;      ///< [pair i <= l of nodes][moment]: ℓ_i ℓ_l = Σ_m product P_m
};
/// Made once and kept.
const NodeTable& node_table(int nodes);

/// f nᵀ of edges by its harmonics at an angle, from which it turns on.
struct Harmonics {
  std::complex<double> mean, second;  ///< g s and g s e^{2iφ}, g = outward - i tangential, s = sin κ
  std::complex<double> column, row;   ///< -g cos κ e^{iφ}; upward s e^{iφ}
  double axial = 0.0;                 ///< -upward cos κ

  Harmonics() = default;
  Harmonics(const RingStiffness& ring, double angle_rad) {
    const std::complex<double> g(ring.outward, -ring.tangential);
    const std::complex<double> turn = std::polar(1.0, angle_rad);
    mean = g * ring.sine;
    second = mean * turn * turn;
    column = -g * ring.cosine * turn;
    row = ring.upward * ring.sine * turn;
    axial = -ring.upward * ring.cosine;
  }
  void add(const Harmonics& other) {
    mean += other.mean;
    second += other.second;
    column += other.column;
    row += other.row;
    axial += other.axial;
  }
  [[nodiscard]] Harmonics turned(double further_rad) const {
    const std::complex<double> e = std::polar(1.0, further_rad);
    Harmonics other = *this;
    other.second *= e * e;
    other.column *= e;
    other.row *= e;
    return other;
  }
  /// K in T after a further turn.
  [[nodiscard]] Eigen::Matrix3d at(double further_rad) const {
    const std::complex<double> e = std::polar(1.0, further_rad);
    const std::complex<double> twice = second * e * e;
    const std::complex<double> c = column * e;
    const std::complex<double> r = row * e;
    Eigen::Matrix3d k;
    k << 0.5 * (mean.real() - twice.real()), 0.5 * (twice.imag() + mean.imag()), c.imag(),  //
        0.5 * (twice.imag() - mean.imag()), 0.5 * (mean.real() + twice.real()), c.real(),   //
        r.imag(), r.real(), axial;
    return k;
  }
};

/// ∫ K P_m dx of a piece, x its share, gathered eight edges at a time.
class Moments {
 public:
  Moments(std::size_t count, double length_rad)
      : count_(count), length_rad_(length_rad), sum_(spatial_entries * count, Lanes{}) {}

  /// Adds what cuts over the part [low, high] of the piece. @param ring_at  harmonics at a share of the piece
  template <class At>
  void add(const At& ring_at, double low, double high) {
    const int parts = static_cast<int>(std::ceil((high - low) * length_rad_ / std::numbers::pi));
    for (int i = 0; i < parts; ++i) {
      const double half = 0.5 * (high - low) / parts;
      const double middle = low + (2 * i + 1) * half;
      const Harmonics k = ring_at(middle);
      batch_.middle.v[filled_] = middle;
      batch_.half.v[filled_] = half;
      batch_.half_rad.v[filled_] = half * length_rad_;
      const auto put = [&](Lanes* to, const std::complex<double>& value) {
        to[0].v[filled_] = value.real();
        to[1].v[filled_] = value.imag();
      };
      put(batch_.mean, k.mean);
      put(batch_.second, k.second);
      put(batch_.column, k.column);
      put(batch_.row, k.row);
      batch_.axial.v[filled_] = k.axial;
      if (++filled_ == lane_count) flush();
    }
  }

  /// Before matrix().
  void flush();
  /// M_il = ∫ ℓ_i ℓ_l K dx / w_i in axes turned by R.
  void matrix(const NodeTable& t, const Eigen::Matrix3d& turn, Eigen::MatrixXd& out) const;

 private:
  std::size_t count_;
  double length_rad_;
  std::vector<Lanes> sum_;
  MomentArguments batch_;
  std::size_t filled_ = 0;
};

}  // namespace robomill::stability::detail
