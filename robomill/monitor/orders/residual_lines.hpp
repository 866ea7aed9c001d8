#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "robomill/monitor/orders/spectra.hpp"

namespace robomill::monitor {

/// What a window holds beside the multiples of rotation. Energies are sums of squared amplitudes [input's unit²].
struct ResidualFamily {
  double whole = 0.0;         ///< of everything
  double synchronous = 0.0;   ///< of the multiples of rotation
  double teeth = 0.0;         ///< of the multiples of tooth passing; where the teeth are unknown, of rotation
  double family = 0.0;        ///< of the strongest family of lines {±f_c + k f}, above the floor
  double frequency_hz = 0.0;  ///< of the family's strongest line; 0: none
};

/// Takes the multiples k f of rotation off the spectra of a window, and finds among what they leave the strongest
/// family of lines {±f_c + k f}: what regeneration modulates with the spindle.
///
/// With T the window's length and a_k = X(k f), what is left at ν is R = X - Σ a_k h((ν - k f) T). A line's energy
/// counts as far as it exceeds the skirt of the orders beside it, Σ 0.5 |a_k|²/d², d = |ν - k f| T, and not at all
/// within 0.75/T of an order or 2/T of a multiple of the teeth: there an order of unsteady speed or amplitude is no
/// line of its own. Lines are added up by the fraction of an order, φ = |ν/f - round(ν/f)|, over 2.5/T, less the median
/// of all φ, which is the floor.
class ResidualLines {
 public:
  /// @param spectrum  one that all are like;  @param highest_hz  of the lines that count
  ResidualLines(const Spectrum& spectrum, double highest_hz);
  /// @param teeth  0: unknown
  /// @param sure   rotation_hz is the rotation, and no multiple of it: otherwise what stands at simple fractions, up to
  ///               sixths, is taken for a multiple of the rotation
  void begin(double rotation_hz, int teeth, bool sure) noexcept;
  /// A channel's spectrum.
  void add(const Spectrum& spectrum) noexcept;
  [[nodiscard]] ResidualFamily finish() noexcept;
  /// Adds to `cells`, `cell_hz` wide each, the energy that stands beside the orders …
  void share_out(double cell_hz, std::span<double> cells) const noexcept;
  /// … and that of the orders between the multiples of the teeth.
  void share_out_between(double cell_hz, std::span<double> cells) const noexcept;

 private:
  struct Lines {
    std::size_t from = 0, to = 0;
  };
  [[nodiscard]] double median_line(std::size_t count) const noexcept;

  Spectrum like_;  // without lines
  double seconds_, step_hz_, share_;
  std::size_t first_, lines_, order_lines_;  // that count, from first_ on; to each side of an order that are taken off
  double rotation_hz_ = 0.0;
  int teeth_ = 0;
  std::size_t orders_ = 0, folds_ = 0;
  std::vector<float> kernel_;          // h at the lines about an order; a row for each place of it between two lines
  std::vector<Lines> between_orders_;  // that count, from each order to the next
  // Of each of these: the energy it stands for, the skirts there of the orders below and above, the place of φ.
  std::vector<float> share_of_, skirt_below_, skirt_above_;
  std::vector<std::int32_t> fold_of_;
  std::vector<float> re_, im_;                // what is left of a channel
  std::vector<float> order_energy_;           // of a channel
  std::vector<float> left_;                   // of all channels
  std::vector<float> between_;                // energy of each order that is no multiple of the teeth, of all channels
  std::vector<double> fold_, room_, sorted_;  // energy by fraction of an order; lines there that count
  std::vector<std::size_t> strongest_;        // line there
  double whole_ = 0.0, synchronous_ = 0.0;
};

}  // namespace robomill::monitor
