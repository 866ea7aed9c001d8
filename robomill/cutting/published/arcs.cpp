#include "robomill/cutting/published/arcs.hpp"

namespace robomill::cutting::detail {

double ArcList::length() const {
  double sum = 0.0;
  for (const BoundedArc& arc : *this) sum += arc.exit - arc.entry;
  return sum;
}

std::uint64_t ArcList::signature() const {
  std::uint64_t signature = 0;
  for (const BoundedArc& arc : *this) {
    signature =
        (signature << 5U) | 16U | (static_cast<unsigned>(arc.at_entry) << 2U) | static_cast<unsigned>(arc.at_exit);
  }
  return signature;
}

ArcList where_positive(double sine, double cosine, double constant, Bound bound) {
  const double amplitude = std::hypot(sine, cosine);
  if (constant >= amplitude) return constant > 0.0 ? ArcList::whole() : ArcList();
  ArcList list;
  if (constant <= -amplitude) return list;
  const double middle = std::atan2(sine, cosine);
  const double half = std::acos(-constant / amplitude);
  list.add({.entry = middle - half, .exit = middle + half, .at_entry = bound, .at_exit = bound});
  return list;
}

ArcList intersection(const ArcList& a, const ArcList& b) {
  if (a.is_whole()) return b;
  if (b.is_whole()) return a;
  ArcList common;
  for (const BoundedArc& p : a) {
    for (const BoundedArc& q : b) {
      for (const double turn : {-full_turn, 0.0, full_turn}) {
        BoundedArc arc = p;
        if (q.entry + turn > p.entry) {
          arc.entry = q.entry + turn;
          arc.at_entry = q.at_entry;
        }
        if (q.exit + turn < p.exit) {
          arc.exit = q.exit + turn;
          arc.at_exit = q.at_exit;
        }
        common.add(arc);
      }
    }
  }
  return common;
}

ArcList merged(const ArcList& list) {
  ArcList result = list;
  for (bool again = true; again && result.size() > 1;) {
    again = false;
    for (std::size_t i = 0; i < result.size() && !again; ++i) {
      for (std::size_t j = 0; j < result.size() && !again; ++j) {
        BoundedArc other = result[j];
        if (i == j) continue;
        BoundedArc& arc = result[i];
        if (other.entry < arc.entry) {
          other.entry += full_turn;
          other.exit += full_turn;
        }
        if (other.entry > arc.exit) continue;
        if (other.exit > arc.exit) {
          arc.exit = std::min(other.exit, arc.entry + full_turn);
          arc.at_exit = other.at_exit;
        }
        result[j] = result[result.size() - 1];
        result.shorten(result.size() - 1);
        again = true;
      }
    }
  }
  if (result.is_whole()) return ArcList::whole();
  return result;
}

}  // namespace robomill::cutting::detail
