#include "robomill/coupling/base.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "robomill/base/error.hpp"
#include "robomill/coupling/beam_element.hpp"

namespace robomill::coupling::detail {
namespace {

using Eigen::Index;
using modal::Axis;

/// Two axes are one where no line differs by more.
constexpr double same_line = 1e-5;

Axis axis_of(Axis plane, int row) {
  if (row == 0) return plane;
  return plane == Axis::x ? Axis::ry : Axis::rx;
}

/// The number that all points of a holder's FRFs carry.
int point_of(const modal::FrfSet& set) {
  const int point = set.frfs.front().name.response.point;
  for (const modal::Frf& frf : set.frfs) {
    if (frf.name.response.point == point && frf.name.excitation.point == point) continue;
    throw InvalidInput("receptances", "hold more points than the holder's mouth",
                       "For translations at several points say where they stand: points_mm");
  }
  return point;
}

/// Reads one plane's 2 x 2, or one plane's for loads in the other.
class Block {
 public:
  Block(const modal::FrfSet& set, Axis plane, Axis load_plane) {
    const int point = point_of(set);
    for (int row = 0; row < 2; ++row) {
      for (int column = 0; column < 2; ++column) {
        const modal::FrfName name = element_name(plane, row, load_plane, column, point, point);
        const modal::Frf* frf = set.find(name);
        if (frf == nullptr) frf = set.find({.response = name.excitation, .excitation = name.response});
        const std::size_t at = static_cast<std::size_t>(2 * row + column);
        frfs_.at(at) = frf;
        sign_.at(at) = element_sign(plane, row, load_plane, column);
        (frf == nullptr ? missing_ : found_).push_back(modal::to_string(name));
      }
    }
  }

  [[nodiscard]] bool whole() const { return missing_.empty(); }
  [[nodiscard]] bool empty() const { return found_.empty(); }
  [[nodiscard]] const std::vector<std::string>& missing() const { return missing_; }
  [[nodiscard]] const modal::Frf& diagonal(std::size_t i) const { return *frfs_.at(3 * i); }
  [[nodiscard]] std::vector<Eigen::Matrix2cd> read(const std::vector<Index>& lines) const {
    std::vector<Eigen::Matrix2cd> out(lines.size());
    for (std::size_t i = 0; i < lines.size(); ++i) {
      for (std::size_t k = 0; k < 4; ++k) {
        out[i](static_cast<Index>(k / 2), static_cast<Index>(k % 2)) = sign_[k] * frfs_[k]->receptance(lines[i]);
      }
    }
    return out;
  }

 private:
  std::array<const modal::Frf*, 4> frfs_ = {};
  std::array<double, 4> sign_ = {};
  std::vector<std::string> missing_, found_;
};

void require_whole(const Block& block) {
  if (block.whole()) return;
  throw InvalidInput("receptances", fmt::format("lack {}", fmt::join(block.missing(), ", ")),
                     "A holder has translation and rotation: xx, x:my, ry:x, ry:my. From translations alone, measured "
                     "at two or three points, say where they stand: points_mm");
}

void read_measured(const modal::FrfSet& set, const Eigen::VectorXd& frequency_hz, Base& base) {
  const std::vector<Index> lines = lines_in(set.frequency_hz, frequency_hz, "the measured holder");
  const Block x(set, Axis::x, Axis::x);
  const Block y(set, Axis::y, Axis::y);
  if (!x.empty() || y.empty()) require_whole(x);
  if (!y.empty()) require_whole(y);
  base.x = (x.empty() ? y : x).read(lines);
  base.y = (y.empty() ? x : y).read(lines);
  const Block xy(set, Axis::x, Axis::y);
  if (xy.whole()) {
    base.xy = xy.read(lines);
    base.yx = Block(set, Axis::y, Axis::x).read(lines);
  } else if (!xy.empty()) {
    base.notes.push_back(
        fmt::format("The holder's FRFs between x and y are left out: {} missing.", fmt::join(xy.missing(), ", ")));
  }
  std::set<double> suspect;
  for (const Block* block : {&x, &y}) {
    for (std::size_t i = 0; i < 2 && !block->empty(); ++i) {
      const std::vector<double> found = suspect_lines(block->diagonal(i), set.frequency_hz);
      if (2 * found.size() > static_cast<std::size_t>(set.frequency_hz.size())) {
        throw InvalidInput(
            "receptances",
            fmt::format("{} has a positive imaginary part at {} of {} lines: it would create energy",
                        modal::to_string(block->diagonal(i).name), found.size(), set.frequency_hz.size()),
            "Is the sign of a sensor wrong, or the time axis turned round?");
      }
      suspect.insert(found.begin(), found.end());
    }
  }
  for (const double f : suspect) {
    if (f >= frequency_hz(0) * (1.0 - same_line) && f <= frequency_hz(frequency_hz.size() - 1) * (1.0 + same_line)) {
      base.suspect_hz.push_back(f);
    }
  }
}

double step_near(const Eigen::VectorXd& axis_hz, Index i) {
  if (axis_hz.size() < 2) return 0.0;
  const Index from = std::clamp<Index>(i, 1, axis_hz.size() - 1);
  return axis_hz(from) - axis_hz(from - 1);
}

}  // namespace

modal::FrfName element_name(Axis plane, int row, Axis load_plane, int column, int point, int load_point) {
  return {.response = {.point = point, .axis = axis_of(plane, row)},
          .excitation = {.point = load_point, .axis = axis_of(load_plane, column)}};
}

double element_sign(Axis plane, int row, Axis load_plane, int column) {
  const bool turned = plane == Axis::y && row == 1;
  const bool load_turned = load_plane == Axis::y && column == 1;
  return turned == load_turned ? 1.0 : -1.0;
}

std::vector<Index> lines_in(const Eigen::VectorXd& axis_hz, const Eigen::VectorXd& wanted_hz,
                            const std::string& whose) {
  std::vector<Index> out;
  out.reserve(static_cast<std::size_t>(wanted_hz.size()));
  const double low = axis_hz(0);
  const double high = axis_hz(axis_hz.size() - 1);
  Index at = 0;
  for (Index i = 0; i < wanted_hz.size(); ++i) {
    const double f = wanted_hz(i);
    if (f < low * (1.0 - same_line) || f > high * (1.0 + same_line)) {
      throw InvalidInput("frequency_hz", f, "Hz",
                         fmt::format("must lie in the range of {}, {:.6g} to {:.6g} Hz", whose, low, high));
    }
    while (at + 1 < axis_hz.size() && std::abs(axis_hz(at + 1) - f) <= std::abs(axis_hz(at) - f)) ++at;
    if (std::abs(axis_hz(at) - f) > same_line * f) {
      throw InvalidInput("frequency_hz", f, "Hz",
                         fmt::format("is no line of {}: its step is {:.6g} Hz, the step asked for {:.6g} Hz", whose,
                                     step_near(axis_hz, at), step_near(wanted_hz, i)),
                         "Both must have the same lines");
    }
    out.push_back(at);
  }
  return out;
}

std::vector<double> suspect_lines(const modal::Frf& frf, const Eigen::VectorXd& frequency_hz) {
  constexpr Index neighbours = 4;
  const Eigen::VectorXcd& h = frf.receptance;
  const Index n = h.size();
  // What a line misses the mean of its neighbours by has 3/2 of the variance of one line.
  Eigen::VectorXd scatter = Eigen::VectorXd::Zero(n);
  for (Index i = 1; i + 1 < n; ++i) scatter(i) = std::abs(h(i) - 0.5 * (h(i - 1) + h(i + 1))) * std::sqrt(2.0 / 3.0);
  std::vector<double> out;
  for (Index i = 0; i < n; ++i) {
    double noise = 0.0;
    if (frf.deviation.size() > 0) {
      noise = frf.deviation(i);
    } else if (n > 2) {
      const Index from = std::clamp<Index>(i - neighbours, 1, n - 2);
      const Index to = std::clamp<Index>(i + neighbours, 1, n - 2);
      noise = std::sqrt(scatter.segment(from, to - from + 1).squaredNorm() / static_cast<double>(to - from + 1));
    }
    if (h(i).imag() > 3.0 * noise + 1e-9 * std::abs(h(i))) out.push_back(frequency_hz(i));
  }
  return out;
}

Base base_receptances(const Holder& holder, const Eigen::VectorXd& frequency_hz) {
  Base base;
  if (!holder.receptances.frfs.empty()) {
    base.measured = true;
    read_measured(holder.receptances, frequency_hz, base);
    return base;
  }
  if (holder.segments.empty()) {
    base.x.assign(static_cast<std::size_t>(frequency_hz.size()), Eigen::Matrix2cd::Zero());
  } else {
    for (const BeamElement& element : beam_elements(holder.segments, frequency_hz)) base.x.push_back(element.clamped);
  }
  base.y = base.x;
  return base;
}

}  // namespace robomill::coupling::detail
