#include "robomill/stability/eigen/hessenberg_lanes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "robomill/stability/eigen/kernel_parts.hpp"

namespace robomill::stability::detail {
namespace {

constexpr double rounding = std::numeric_limits<double>::epsilon();
constexpr int most_iterations = 60;  // for an eigenvalue

CORE void magnitude(const V& x, V& out) {
  out = x < 0.0 ? -x : x;
}

/// Rows that any of the lanes at hand works on; none where first = last.
template <class V>
struct Reach {
  std::size_t first = 0, last = 0;
};
CORE Reach<V> reach_of(const HessenbergArguments& a, std::size_t lane) {
  Reach<V> reach{a.size, 0};
  for (std::size_t i = lane; i < lane + sizeof(V) / sizeof(double); ++i) {
    if (a.low.v[i] == a.high.v[i]) continue;
    reach.first = std::min(reach.first, static_cast<std::size_t>(a.low.v[i]));
    reach.last = std::max(reach.last, static_cast<std::size_t>(a.high.v[i]));
  }
  if (reach.last == 0) reach.first = 0;
  return reach;
}

CORE void find_windows_core(HessenbergArguments& a, std::size_t lane) {
  std::size_t last = 0;
  for (std::size_t i = lane; i < lane + sizeof(V) / sizeof(double); ++i) {
    last = std::max(last, static_cast<std::size_t>(a.high.v[i]));
  }
  const V high = L(a.high);
  const V nothing = {};
  V low = nothing;
  V open = nothing + 1.0;  // 1 until the start of the window is found
  for (std::size_t k = last; k > 0; --k) {
    Lanes* const here = a.matrix + k * a.stride + k;
    V below, left, right;
    magnitude<V>(L(here[-1]), below);
    magnitude<V>(L(here[0]), right);
    magnitude<V>(L(*(here - a.stride - 1)), left);
    const V around = right + left;
    const V place = nothing + static_cast<double>(k);
    V ends = below <= rounding * around ? open : nothing;
    ends = below < std::numeric_limits<double>::min() ? open : ends;
    ends = place <= high ? ends : nothing;
    low = ends > nothing ? place : low;
    L(here[-1]) = ends > nothing ? nothing : L(here[-1]);
    open = ends > nothing ? nothing : open;
  }
  L(a.low) = low;
}

/// I - w v^T with v = (1, v1, v2), which turns (x, y, z) into (-length, 0, 0); nothing in lanes that rest.
template <class V>
struct LaneReflector {
  V length, v1, v2, w0, w1, w2;
};

CORE void set_reflector(const V& x, const V& y, const V& z, const V& square, const V& works, LaneReflector<V>& out) {
  const V nothing = {};
  const V one = nothing + 1.0;
  V root = works > nothing ? square : one;
  for (std::size_t i = 0; i < sizeof(V) / sizeof(double); ++i) root[i] = std::sqrt(root[i]);
  out.length = x < 0.0 ? -root : root;
  const V first = works > nothing ? x + out.length : one;
  const V by_first = 1.0 / first;
  const V by_length = 1.0 / out.length;
  out.v1 = works > nothing ? y * by_first : nothing;
  out.v2 = works > nothing ? z * by_first : nothing;
  out.w0 = works > nothing ? first * by_length : nothing;
  out.w1 = works > nothing ? y * by_length : nothing;
  out.w2 = works > nothing ? z * by_length : nothing;
}

/// From the left on rows k, k + 1 and, but at the end, k + 2.
CORE void on_rows(const LaneReflector<V>& r, HessenbergArguments& a, std::size_t k, std::size_t last,
                  std::size_t lane) {
  Lanes* row0 = a.matrix + k * a.stride + k;
  Lanes* row1 = row0 + a.stride;
  Lanes* row2 = row1 + a.stride;
  const std::size_t count = last + 1 - k;
  if (k + 2 > last) {
    for (std::size_t c = 0; c < count; ++c) {
      const V t = L(row0[c]) + r.v1 * L(row1[c]);
      L(row0[c]) -= r.w0 * t;
      L(row1[c]) -= r.w1 * t;
    }
    return;
  }
  for (std::size_t c = 0; c < count; ++c) {
    const V second = L(row1[c]);
    const V third = L(row2[c]);
    const V t = L(row0[c]) + r.v1 * second + r.v2 * third;
    L(row0[c]) -= r.w0 * t;
    L(row1[c]) = second - r.w1 * t;
    L(row2[c]) = third - r.w2 * t;
  }
}

/// From the right on columns k, k + 1 and, but at the end, k + 2.
CORE void on_columns(const LaneReflector<V>& r, HessenbergArguments& a, std::size_t k, const Reach<V>& reach,
                     std::size_t lane) {
  const std::size_t below = std::min(k + 3, reach.last) + 1;
  Lanes* entry = a.matrix + reach.first * a.stride + k;
  const bool three = k + 2 <= reach.last;
  for (std::size_t i = reach.first; i < below; ++i, entry += a.stride) {
    const V first = L(entry[0]);
    const V second = L(entry[1]);
    V t = r.w0 * first + r.w1 * second;
    if (three) {
      const V third = L(entry[2]);
      t += r.w2 * third;
      L(entry[2]) = third - t * r.v2;
    }
    L(entry[0]) = first - t;
    L(entry[1]) = second - t * r.v1;
  }
}

CORE void sweep_windows_core(HessenbergArguments& a, std::size_t lane) {
  const Reach<V> reach = reach_of<V>(a, lane);
  const V nothing = {};
  const V one = nothing + 1.0;
  const V low = L(a.low);
  const V high = L(a.high);
  V x = L(a.x);
  V y = L(a.y);
  V z = L(a.z);
  for (std::size_t k = reach.first; k < reach.last; ++k) {
    const V place = nothing + static_cast<double>(k);
    const V square = x * x + y * y + z * z;
    V works = place >= low ? one : nothing;
    works = place < high ? works : nothing;
    works = square > 1e-280 ? works : nothing;  // scaled to about 1: what would underflow here is nothing beside it
    LaneReflector<V> reflector = {};
    set_reflector<V>(x, y, z, square, works, reflector);
    if (k > reach.first) {
      const V moves = place > low ? works : nothing;
      Lanes* before = a.matrix + k * a.stride + k - 1;
      L(*before) = moves > nothing ? -reflector.length : L(*before);
      before += a.stride;
      L(*before) = moves > nothing ? nothing : L(*before);
      if (k + 2 <= reach.last) {
        before += a.stride;
        const V three = place + 1.0 < high ? moves : nothing;
        L(*before) = three > nothing ? nothing : L(*before);
      }
    }
    on_rows<V>(reflector, a, k, reach.last, lane);
    on_columns<V>(reflector, a, k, reach, lane);
    if (k + 1 >= reach.last) return;
    const Lanes* next = a.matrix + (k + 1) * a.stride + k;
    const V after = place + 1.0;
    const V begins = after == low ? one : nothing;
    const V third =
        after + 1.0 < high && k + 3 <= reach.last ? L(next[k + 3 <= reach.last ? 2 * a.stride : 0]) : nothing;
    x = begins > nothing ? L(a.x) : L(next[0]);
    y = begins > nothing ? L(a.y) : L(next[a.stride]);
    z = begins > nothing ? L(a.z) : third;
  }
}

}  // namespace

ROBOMILL_KERNEL(find_windows, HessenbergArguments)
ROBOMILL_KERNEL(sweep_windows, HessenbergArguments)

void HessenbergLanes::resize(std::size_t size) {
  size_ = size;
  stride_ = size | 1;  // rows do not fall on the same lines of the cache
  matrix_.assign(size_ * stride_, Lanes{});
}

/// By a power of two, so that scaling changes no digit: the norm before it. One that is not finite is set to zero.
double HessenbergLanes::scale(std::size_t lane) {
  double square = 0.0;
  for (std::size_t r = 0; r < size_; ++r) {
    for (std::size_t c = r == 0 ? 0 : r - 1; c < size_; ++c) {
      const double entry = (*this)(r, c).v[lane];
      square += entry * entry;
    }
  }
  const double size = std::sqrt(square);
  if (!std::isfinite(size)) {
    for (Lanes& entry : matrix_) entry.v[lane] = 0.0;
  }
  if (!std::isfinite(size) || size == 0.0) return size;
  lanes_[lane].unit = std::ldexp(1.0, std::ilogb(size));
  const double inverse = 1.0 / lanes_[lane].unit;
  for (Lanes& entry : matrix_) entry.v[lane] *= inverse;
  return size;
}

/// Takes the last one or two eigenvalues of a lane where its window is that small.
bool HessenbergLanes::deflate(std::size_t lane, std::complex<double>& value) {
  Lane& here = lanes_[lane];
  const std::size_t high = here.end - 1;
  const std::size_t low = static_cast<std::size_t>(arguments_.low.v[lane]);
  if (low + 1 < high) return false;
  const auto consider = [&](double real, double imaginary) {
    const double square = real * real + imaginary * imaginary;
    if (square > here.largest) {
      here.largest = square;
      value = {real, imaginary};
    }
  };
  const auto entry = [&](std::size_t r, std::size_t c) { return (*this)(r, c).v[lane]; };
  here.iteration = 0;
  if (low == high) {
    consider(entry(high, high), 0.0);
    here.end -= 1;
    return true;
  }
  const double b = entry(low, high), c = entry(high, low), d = entry(high, high);
  const double half = 0.5 * (entry(low, low) - d);
  const double square = half * half + b * c;
  const double root = std::sqrt(std::abs(square));
  if (square < 0.0) {
    consider(d + half, root);
  } else {  // the larger of the two without cancellation, the other from the product
    const double away = half + std::copysign(root, half);
    consider(d + away, 0.0);
    consider(away != 0.0 ? d - b * c / away : d, 0.0);
  }
  here.end -= 2;
  return true;
}

/// As find_windows does, of one lane.
void HessenbergLanes::find_window(std::size_t lane) {
  std::size_t low = lanes_[lane].end > 0 ? lanes_[lane].end - 1 : 0;
  arguments_.high.v[lane] = static_cast<double>(low);
  for (; low > 0; --low) {
    double& entry = (*this)(low, low - 1).v[lane];
    const double below = std::abs(entry);
    const double around = std::abs((*this)(low, low).v[lane]) + std::abs((*this)(low - 1, low - 1).v[lane]);
    if (below <= rounding * around || below < std::numeric_limits<double>::min()) {
      entry = 0.0;
      break;
    }
  }
  arguments_.low.v[lane] = static_cast<double>(low);
}

void HessenbergLanes::shift(std::size_t lane) {
  Lane& here = lanes_[lane];
  const std::size_t high = here.end - 1;
  const std::size_t low = static_cast<std::size_t>(arguments_.low.v[lane]);
  const auto at = [&](std::size_t r, std::size_t c) { return (*this)(r, c).v[lane]; };
  double sum = at(high - 1, high - 1) + at(high, high);
  double product = at(high - 1, high - 1) * at(high, high) - at(high - 1, high) * at(high, high - 1);
  if (here.iteration % 10 == 0) {  // an exceptional shift breaks cycles
    const double size = std::abs(at(high, high - 1)) + std::abs(at(high - 1, high - 2));
    sum = 1.5 * size;
    product = size * size;
  }
  arguments_.x.v[lane] =
      at(low, low) * at(low, low) + at(low, low + 1) * at(low + 1, low) - sum * at(low, low) + product;
  arguments_.y.v[lane] = at(low + 1, low) * (at(low, low) + at(low + 1, low + 1) - sum);
  arguments_.z.v[lane] = at(low + 1, low) * at(low + 2, low + 1);
}

std::array<bool, lane_count> HessenbergLanes::dominant(const std::array<bool, lane_count>& wanted,
                                                       std::array<std::complex<double>, lane_count>& value) {
  std::array<bool, lane_count> found = {};
  arguments_ = {};
  arguments_.size = size_;
  arguments_.stride = stride_;
  arguments_.matrix = matrix_.data();
  for (std::size_t lane = 0; lane < lane_count; ++lane) {
    lanes_[lane] = {};
    if (!wanted[lane]) continue;
    value[lane] = 0.0;
    const double size = scale(lane);
    found[lane] = size == 0.0;
    lanes_[lane].works = std::isfinite(size) && size > 0.0;
    if (lanes_[lane].works) lanes_[lane].end = size_;
  }
  const auto works = [](const Lane& lane) { return lane.works; };
  while (std::ranges::any_of(lanes_, works)) {
    for (std::size_t lane = 0; lane < lane_count; ++lane) {
      const Lane& here = lanes_[lane];
      arguments_.high.v[lane] = here.works ? static_cast<double>(here.end - 1) : 0.0;
    }
    find_windows(arguments_);
    for (std::size_t lane = 0; lane < lane_count; ++lane) {
      Lane& here = lanes_[lane];
      while (here.works && deflate(lane, value[lane])) {
        here.works = here.end > 0;
        found[lane] = !here.works;
        find_window(lane);
      }
      if (found[lane]) value[lane] *= here.unit;
      here.works = here.works && ++here.iteration <= most_iterations;
      if (here.works) shift(lane);
      if (!here.works) arguments_.low.v[lane] = arguments_.high.v[lane] = 0.0;
      if (found[lane]) here.unit = 1.0;
    }
    sweep_windows(arguments_);
  }
  return found;
}

}  // namespace robomill::stability::detail
