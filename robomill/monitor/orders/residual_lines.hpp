#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "robomill/monitor/orders/spectra.hpp"

namespace robomill::monitor {

/// What a window holds beside the multiples of rotation. Energies are sums of squared amplitudes [input's unit²].
struct ResidualFamily {
  double whole = 0.0;         ///< W, of everything
  double synchronous = 0.0;   ///< S, of the multiples of rotation
  double teeth = 0.0;         ///< of the multiples of tooth passing; where the teeth are unknown, of rotation
  double family = 0.0;        ///< L, of the strongest family of lines {±f_c + k f}, above the floor
  double frequency_hz = 0.0;  ///< of the family's strongest line; 0: none
  int lines = 0;              ///< of the family, 10 dB above the noise beside them; one in each half of an order
};

/// Finds beside the multiples k f of rotation the strongest family of lines {±f_c + k f}: what regeneration modulates
/// with the spindle.
///
/// With T the window's length and P = Σ|X|² over the channels, an order has the energy P(k f). A line counts as far as
/// it exceeds the skirt of the orders beside it, Σ P(k f)/(2 d²), d = |ν - k f| T, and not at all where d < 2, which is
/// the main lobe, nor at an order that is folded about a multiple of the sample rate. Lines are added up by the
/// fraction of an order, φ = |ν/f - round(ν/f)|, over 2.5/T, less the median of all φ, which is the floor.
class ResidualLines {
 public:
  static constexpr double main_lobe = 2.0;  ///< 1/T, to each side of an order, where no line counts

  struct Setup {
    double highest_hz = 0.0;      ///< of the lines that count
    double sample_rate_hz = 0.0;  ///< of the converter
  };
  /// What the lines are measured against.
  struct Orders {
    double rotation_hz = 0.0;
    int teeth = 0;  ///< 0: unknown
    /// It is the rotation, and no multiple of it: otherwise what stands at simple fractions, up to sixths, is taken for
    /// a multiple of the rotation.
    bool sure = true;
  };
  /// @param spectrum  one that all are like
  ResidualLines(const Spectrum& spectrum, const Setup& setup);
  /// @param power  |X|² of all channels, line by line; @param floor  the noise's; empty: no lines are counted
  [[nodiscard]] ResidualFamily find(std::span<const float> power, std::span<const float> floor,
                                    const Orders& orders) noexcept;
  /// Of the window that find() saw last, adds to `cells`, `cell_hz` wide each, the energy that stands beside the
  /// orders …
  void share_out(double cell_hz, std::span<double> cells) const noexcept;
  /// … and that of the orders between the multiples of the teeth.
  void share_out_between(double cell_hz, std::span<double> cells) const noexcept;
  /// The same, of all lines from one frequency to another.
  [[nodiscard]] double between(double from_hz, double to_hz) const noexcept;

 private:
  struct Family {
    std::size_t first_fold = 0, folds = 0;
    double energy = 0.0;
  };
  void measure_orders(std::span<const float> power, ResidualFamily& out) noexcept;
  void keep_lines(std::span<const float> power) noexcept;
  void leave_out_fractions() noexcept;
  void leave_out_folded() noexcept;
  [[nodiscard]] Family strongest_family() noexcept;
  void describe(const Family& family, std::span<const float> power, std::span<const float> floor,
                ResidualFamily& out) const noexcept;

  Setup setup_;
  Spectrum like_;  // without lines
  double bin_;     // a line's width in 1/T
  std::size_t first_, lines_;
  Orders orders_ = {};
  double order_step_ = 1.0;          // lines
  std::vector<float> order_energy_;  // from 0 on; one more than there are
  std::vector<float> to_order_;      // of each line, to the nearest order [1/T]; < 0: it does not count
  std::vector<float> left_;          // of each line, energy above the orders' skirts
  std::vector<std::int32_t> fold_of_;
  std::size_t count_ = 0, folds_ = 0;         // orders; places of φ
  std::vector<double> fold_, room_, sorted_;  // energy by fraction of an order; lines there that count
};

}  // namespace robomill::monitor
