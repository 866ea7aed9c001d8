#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

namespace robomill::cutting::detail {

inline constexpr double full_turn = 2.0 * std::numbers::pi;

/// What ends an arc.
enum class Bound : std::uint8_t { none, surface, feed, neighbour };

struct BoundedArc {
  double entry = 0.0;  ///< in [0, 2π)
  double exit = 0.0;   ///< in (entry, entry + 2π]
  Bound at_entry = Bound::none, at_exit = Bound::none;
};

/// Disjoint arcs of a circle, without memory of their own.
class ArcList {
 public:
  static constexpr std::size_t most = 16;
  [[nodiscard]] static ArcList whole() {
    ArcList list;
    list.add({.entry = 0.0, .exit = full_turn});
    return list;
  }
  /// Brings the entry into [0, 2π); an arc without length, or one too many, is left out.
  void add(BoundedArc arc) {
    if (!(arc.exit > arc.entry) || count_ == most) return;
    const double turn = full_turn * std::floor(arc.entry / full_turn);
    arc.entry = std::max(arc.entry - turn, 0.0);
    arc.exit = std::min(arc.exit - turn, arc.entry + full_turn);
    arcs_[count_++] = arc;
  }
  [[nodiscard]] bool is_whole() const {
    return count_ == 1 && arcs_[0].exit - arcs_[0].entry >= full_turn * (1.0 - 1e-15);
  }
  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] const BoundedArc* begin() const { return arcs_.data(); }
  [[nodiscard]] const BoundedArc* end() const { return arcs_.data() + count_; }
  [[nodiscard]] const BoundedArc& operator[](std::size_t i) const { return arcs_[i]; }
  [[nodiscard]] BoundedArc& operator[](std::size_t i) { return arcs_[i]; }
  void shorten(std::size_t count) { count_ = count; }
  /// Sum of lengths [rad].
  [[nodiscard]] double length() const;
  /// Equal for lists with as many arcs that end at the same bounds in the same order; 0 where empty.
  [[nodiscard]] std::uint64_t signature() const;

 private:
  std::array<BoundedArc, most> arcs_ = {};
  std::size_t count_ = 0;
};

/// Where sine sin φ + cosine cos φ + constant > 0.
[[nodiscard]] ArcList where_positive(double sine, double cosine, double constant, Bound bound);
[[nodiscard]] ArcList intersection(const ArcList& a, const ArcList& b);
/// Arcs that may overlap, as disjoint ones.
[[nodiscard]] ArcList merged(const ArcList& list);

/// The root of f between two angles at which its signs differ: the Illinois rule, every fourth step halving
/// [DowellJarratt1971].
template <class F>
double root_between(const F& f, double from, double to, double at_from, double at_to) {
  constexpr double tolerance = 1e-15 * full_turn;
  double last = from;
  int kept = 0;  // which end stayed in the last step: -1 the first, 1 the second
  for (int i = 1; i < 200 && to - from > tolerance; ++i) {
    const bool halve = i % 4 == 0;
    double next = halve ? 0.5 * (from + to) : (from * at_to - to * at_from) / (at_to - at_from);
    if (!(next > from && next < to)) next = 0.5 * (from + to);
    const double value = f(next);
    if (value == 0.0 || (!halve && std::abs(next - last) < tolerance)) return next;
    last = next;
    if ((value > 0.0) == (at_to > 0.0)) {
      to = next;
      at_to = value;
      if (kept == -1 && !halve) at_from *= 0.5;
      kept = -1;
    } else {
      from = next;
      at_from = value;
      if (kept == 1 && !halve) at_to *= 0.5;
      kept = 1;
    }
  }
  return 0.5 * (from + to);
}

/// The highest value of f in [from, to] if it has one maximum there, by golden sections: where it is.
template <class F>
double highest_between(const F& f, double from, double to, int sections = 44) {
  constexpr double golden = 0.61803398874989485;
  double left = to - golden * (to - from);
  double right = from + golden * (to - from);
  double at_left = f(left);
  double at_right = f(right);
  for (int i = 0; i < sections; ++i) {
    if (at_left >= at_right) {
      to = right;
      right = left;
      at_right = at_left;
      left = to - golden * (to - from);
      at_left = f(left);
    } else {
      from = left;
      left = right;
      at_left = at_right;
      right = from + golden * (to - from);
      at_right = f(right);
    }
  }
  return at_left >= at_right ? left : right;
}

/// The part of `within` where f > 0, f continuous: looked at in `samples` places an arc, and between three of one sign
/// whose middle is nearest to 0.
template <class F>
ArcList where_positive(const F& f, const ArcList& within, Bound bound, int samples) {
  ArcList found;
  for (const BoundedArc& arc : within) {
    BoundedArc open = arc;
    double angle[3] = {arc.entry, arc.entry, arc.entry};
    double value[3] = {f(arc.entry), 0.0, 0.0};
    value[1] = value[2] = value[0];
    const auto cross = [&](double from, double to, double at_from, double at_to) {
      const double root = root_between(f, from, to, at_from, at_to);
      if (at_to > 0.0) {
        open.entry = root;
        open.at_entry = bound;
      } else {
        found.add({.entry = open.entry, .exit = root, .at_entry = open.at_entry, .at_exit = bound});
      }
    };
    for (int i = 1; i <= samples; ++i) {
      for (int k = 0; k < 2; ++k) {
        angle[k] = angle[k + 1];
        value[k] = value[k + 1];
      }
      angle[2] = arc.entry + (arc.exit - arc.entry) * i / samples;
      value[2] = f(angle[2]);
      const bool above = value[1] > 0.0;
      const double side = above ? -1.0 : 1.0;
      const bool nearest =
          i > 1 && std::abs(value[1]) <= std::abs(value[0]) && std::abs(value[1]) <= std::abs(value[2]);
      if (nearest && (value[0] > 0.0) == above && (value[2] > 0.0) == above) {
        const double at = highest_between([&](double x) { return side * f(x); }, angle[0], angle[2], 24);
        const double there = f(at);
        if ((there > 0.0) != above) {
          cross(angle[0], at, value[0], there);
          cross(at, angle[2], there, value[2]);
        }
      }
      if ((value[2] > 0.0) != above) cross(angle[1], angle[2], value[1], value[2]);
    }
    if (value[2] > 0.0)
      found.add({.entry = open.entry, .exit = arc.exit, .at_entry = open.at_entry, .at_exit = arc.at_exit});
  }
  return merged(found);
}

}  // namespace robomill::cutting::detail
