#include "robomill/decision/program/stretch_row.hpp"

#include <algorithm>
#include <cmath>

namespace robomill::decision {

ProgramStretch StretchRow::made(std::size_t way) const {
  ProgramStretch out = stretch_;
  out.others.clear();
  if (way == 0) return out;
  out.begin = stretch_.others[way - 1];
  out.end = out.begin + stretch_.end - stretch_.begin;
  return out;
}

void StretchRow::add(const StretchCost& cost, std::size_t candidate) {
  Node node;
  for (std::size_t way = 0; way <= stretch_.others.size(); ++way) {
    const StretchTime bound = cost.bound(made(way), candidate);
    node.ways.push_back({.at = {.time = bound}, .bound = bound, .exact = !std::isfinite(bound.time_s)});
  }
  node.best = *best_of(node, false);
  nodes_.push_back(std::move(node));
}

bool StretchRow::look(StretchCost& cost, std::size_t candidate) {
  Node& node = nodes_[candidate];
  Way& way = node.ways[node.best];
  way.at = cost.exact(made(node.best), candidate);
  way.exact = true;
  node.best = *best_of(node, false);
  return std::isfinite(way.at.time.time_s);
}

double StretchRow::weighted_s(const Node& node, std::size_t way) const {
  return node.ways[way].at.time.time_s * (way == 0 ? 1.0 : weight_);
}

std::optional<std::size_t> StretchRow::best_of(const Node& node, bool only_exact) const {
  std::optional<std::size_t> best;
  for (std::size_t way = 0; way < node.ways.size(); ++way) {
    if (only_exact && !node.ways[way].exact) continue;
    if (!best) {
      best = way;
      continue;
    }
    const double time = weighted_s(node, way);
    const double least = weighted_s(node, *best);
    const bool nearer = !std::isfinite(least) && node.ways[way].at.time.missed < node.ways[*best].at.time.missed;
    if (time < least || (time == least && nearer)) best = way;
  }
  return best;
}

double StretchRow::time_s(std::size_t candidate) const {
  const Node& node = nodes_[candidate];
  return node.ways.empty() ? no_time : weighted_s(node, node.best);
}

bool StretchRow::exact(std::size_t candidate) const {
  const Node& node = nodes_[candidate];
  return node.ways.empty() || node.ways[node.best].exact;
}

const StretchAt& StretchRow::best(std::size_t candidate) const {
  return nodes_[candidate].ways[nodes_[candidate].best].at;
}

std::optional<StretchTime> StretchRow::seen(std::size_t candidate) const {
  const Node& node = nodes_[candidate];
  const bool looked =
      std::ranges::any_of(node.ways, [](const Way& way) { return way.exact && std::isfinite(way.bound.time_s); });
  const bool open = std::ranges::any_of(node.ways, [](const Way& way) { return !way.exact; });
  if (open && !looked) return std::nullopt;
  const std::optional<std::size_t> way = best_of(node, true);
  if (!way) return std::nullopt;
  return node.ways[*way].at.time;
}

StretchTime StretchRow::bound(std::size_t candidate) const {
  StretchTime least;
  for (const Way& way : nodes_[candidate].ways) {
    if (way.bound.time_s < least.time_s) least = way.bound;
  }
  return least;
}

}  // namespace robomill::decision
