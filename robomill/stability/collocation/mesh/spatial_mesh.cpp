#include "robomill/stability/collocation/mesh/spatial_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "robomill/base/units.hpp"
#include "robomill/stability/collocation/mesh/contacts.hpp"
#include "robomill/stability/collocation/stiffness_moments.hpp"

namespace robomill::stability::detail {
namespace {

constexpr double narrow_share = 1e-6;  // of the period: a gap that is none
constexpr double step_share = 0.1;     // of a tooth's stiffness, that comes or goes within
constexpr double step_width = 0.25;    // of a piece

using Form = MeshTopology::Form;

/// A stretch of rotation with or without contact.
struct Run {
  double from_rad = 0.0, length_rad = 0.0;
  bool cuts = false;
};

double strength(const RingStiffness& ring) {
  return std::hypot(ring.tangential, ring.outward, ring.upward);
}

/// Where much of the stiffness comes or goes within a small part of a piece: the ends of such stretches, in [0,
/// period).
std::vector<double> find_steps(const EdgeContacts& c, double reach_rad) {
  struct End {
    double angle_rad = 0.0, strength = 0.0;
  };
  std::vector<End> ends;
  double whole = 0.0;
  for (const EdgeContact& contact : c.contacts) {
    const double size = strength(c.rings[contact.ring]);
    if (contact.to_rad - contact.from_rad >= units::revolution * (1.0 - narrow_share)) continue;
    whole += 2.0 * size;
    for (const double angle : {contact.from_rad, contact.to_rad}) ends.push_back({wrap(angle, c.period_rad), size});
  }
  std::ranges::sort(ends, {}, &End::angle_rad);
  const double window = std::min(step_width * reach_rad, 0.25 * c.period_rad);
  std::vector<double> borders;
  std::size_t known = 0;  // ends below it belong to a step that has its borders
  for (std::size_t i = 0, last = 0; i < ends.size(); ++i) {
    last = std::max(last, i);
    double sum = 0.0;
    for (std::size_t k = i; k <= last; ++k) sum += ends[k].strength;
    while (last + 1 < ends.size() && ends[last + 1].angle_rad - ends[i].angle_rad < window) {
      sum += ends[++last].strength;
    }
    if (last == i || sum * c.teeth < step_share * whole) continue;
    if (i < known) {
      borders.back() = ends[last].angle_rad;
    } else {
      borders.insert(borders.end(), {ends[i].angle_rad, ends[last].angle_rad});
    }
    known = last + 1;
  }
  const auto twin = [](double x, double y) { return y - x < 1e-8; };
  borders.erase(std::unique(borders.begin(), borders.end(), twin), borders.end());
  if (borders.size() > 1 && borders.front() + c.period_rad - borders.back() < 1e-8) borders.pop_back();
  return borders;
}

/// The period as runs, from the start of one that cuts.
std::vector<Run> find_runs(const EdgeContacts& c) {
  struct Range {
    double from_rad = 0.0, to_rad = 0.0;
  };
  std::vector<Range> ranges;
  bool all = false;
  for (const EdgeContact& contact : c.contacts) {
    const double length = contact.to_rad - contact.from_rad;
    if (length >= c.period_rad * (1.0 - narrow_share)) {
      all = true;
      break;
    }
    const double from = wrap(contact.from_rad, c.period_rad);
    ranges.push_back({from, std::min(from + length, c.period_rad)});
    if (from + length > c.period_rad) ranges.push_back({0.0, from + length - c.period_rad});
  }
  if (all) return {{0.0, c.period_rad, true}};
  if (ranges.empty()) return {{0.0, c.period_rad, false}};
  std::ranges::sort(ranges, {}, &Range::from_rad);
  std::vector<Range> joined;
  for (const Range& range : ranges) {
    if (!joined.empty() && range.from_rad <= joined.back().to_rad + narrow_share * c.period_rad) {
      joined.back().to_rad = std::max(joined.back().to_rad, range.to_rad);
    } else {
      joined.push_back(range);
    }
  }
  // A run across the period's end.
  if (joined.front().from_rad + c.period_rad <= joined.back().to_rad + narrow_share * c.period_rad) {
    if (joined.size() == 1) return {{0.0, c.period_rad, true}};
    joined.back().to_rad = joined.front().to_rad + c.period_rad;
    joined.erase(joined.begin());
  }
  std::vector<Run> runs;
  for (std::size_t i = 0; i < joined.size(); ++i) {
    const double next = i + 1 < joined.size() ? joined[i + 1].from_rad : joined.front().from_rad + c.period_rad;
    runs.push_back({joined[i].from_rad, joined[i].to_rad - joined[i].from_rad, true});
    runs.push_back({joined[i].to_rad, next - joined[i].to_rad, false});
  }
  return runs;
}

/// Those that cut, divided at the borders.
std::vector<Run> divided(const std::vector<Run>& runs, const std::vector<double>& steps, double period_rad) {
  std::vector<Run> parts;
  const bool whole = runs.size() == 1 && runs.front().cuts;
  const double start = whole && !steps.empty() ? steps.front() : runs.front().from_rad;
  for (Run run : runs) {
    if (whole) run.from_rad = start;
    std::vector<double> borders;
    for (const double step : steps) {
      const double inside = wrap(step - run.from_rad, period_rad);
      if (run.cuts && inside > 1e-8 && inside < run.length_rad - 1e-8) borders.push_back(inside);
    }
    std::ranges::sort(borders);
    borders.push_back(run.length_rad);
    double from = 0.0;
    for (const double border : borders) {
      parts.push_back({run.from_rad + from, border - from, run.cuts});
      from = border;
    }
  }
  return parts;
}

class SpatialBuilder {
 public:
  SpatialBuilder(const EdgeContacts& contacts, const Eigen::Matrix3d& axes_from_tool, const MeshLevel& level,
                 CollocationCase& out)
      : contacts_(contacts), turn_(axes_from_tool), table_(node_table(level.nodes)), level_(level), out_(out) {}

  void build(double fastest_per_rad) {
    lay_out(fastest_per_rad);
    answer_now();
    if (contacts_.equal_teeth) {
      look_back_a_period();
    } else {
      look_back();
    }
  }

 private:
  void lay_out(double fastest_per_rad) {
    double reach_rad = longest_piece_rad / fastest_per_rad;
    for (const EdgeContact& contact : contacts_.contacts) reach_rad = std::min(reach_rad, contact.delay_rad);
    const std::vector<Run> runs = divided(find_runs(contacts_), find_steps(contacts_, reach_rad), contacts_.period_rad);
    CutMesh& mesh = out_.mesh;
    mesh.period_rad = contacts_.period_rad;
    mesh.pieces.clear();
    mesh.topology = {
        .nodes = level_.nodes, .form = contacts_.equal_teeth ? Form::whole : Form::blocks, .directions = 3};
    for (const Run& run : runs) {
      if (run.length_rad <= 0.0) continue;
      const bool seen = run.cuts || is_looked_back_to(run);
      const int needed = std::max(1, static_cast<int>(std::ceil(run.length_rad / reach_rad - 1e-9)));
      const int parts = seen ? needed * level_.splits : 1;
      for (int i = 0; i < parts; ++i) {
        CutMesh::Piece& piece = mesh.pieces.emplace_back();
        piece.length_rad = run.length_rad / parts;
        piece.from_rad = run.from_rad + i * piece.length_rad;
        mesh.topology.pieces.emplace_back().records = seen;
      }
    }
    out_.pieces.assign(mesh.pieces.size(), {});
  }

  /// Free flight that somebody looks back to; with equal teeth it was free flight then too.
  [[nodiscard]] bool is_looked_back_to(const Run& run) const {
    if (contacts_.equal_teeth) return false;
    return std::ranges::any_of(contacts_.contacts, [&](const EdgeContact& c) {
      const double from = wrap(c.from_rad - c.delay_rad - run.from_rad, contacts_.period_rad);
      return from < run.length_rad - same_angle || from + (c.to_rad - c.from_rad) > contacts_.period_rad + same_angle;
    });
  }

  /// Calls visit(piece, low, high, from) for every part [low, high] of a piece that a contact covers; `from` is where
  /// the piece starts, in the contact's own count of revolutions.
  template <class Visit>
  void for_parts(const EdgeContact& contact, const Visit& visit) const {
    const std::vector<CutMesh::Piece>& pieces = out_.mesh.pieces;
    const double start = pieces.front().from_rad;
    double periods = std::floor((contact.from_rad - start) / contacts_.period_rad) * contacts_.period_rad;
    const double inside = contact.from_rad - periods;
    const auto after =
        std::ranges::upper_bound(pieces, inside, {}, [](const CutMesh::Piece& piece) { return piece.from_rad; });
    std::size_t at = after == pieces.begin() ? 0 : static_cast<std::size_t>(after - pieces.begin()) - 1;
    while (pieces[at].from_rad + periods < contact.to_rad) {
      const double from = pieces[at].from_rad + periods;
      const double low = std::max((contact.from_rad - from) / pieces[at].length_rad, 0.0);
      const double high = std::min((contact.to_rad - from) / pieces[at].length_rad, 1.0);
      if (high > low && out_.mesh.topology.pieces[at].records) visit(at, low, high, from);
      if (++at < pieces.size()) continue;
      at = 0;
      periods += contacts_.period_rad;
    }
  }

  void answer_now() {
    const std::vector<CutMesh::Piece>& pieces = out_.mesh.pieces;
    std::vector<Moments> moments;
    moments.reserve(pieces.size());
    for (const CutMesh::Piece& piece : pieces) moments.emplace_back(table_.moments, piece.length_rad);
    std::vector<Harmonics> all_along(pieces.size());  // at the middle, of edges that cut over the whole piece
    for (const EdgeContact& contact : contacts_.contacts) {
      for_parts(contact, [&](std::size_t at, double low, double high, double from) {
        const auto ring_at = [&](double share) {
          return Harmonics(contacts_.rings[contact.ring], contact.turn_rad + from + share * pieces[at].length_rad);
        };
        if (low > 1e-13 || high < 1.0 - 1e-13) {
          moments[at].add(ring_at, low, high);
        } else {
          all_along[at].add(ring_at(0.5));
        }
      });
    }
    for (std::size_t e = 0; e < pieces.size(); ++e) {
      if (!out_.mesh.topology.pieces[e].records) continue;
      const auto together_at = [&](double share) { return all_along[e].turned((share - 0.5) * pieces[e].length_rad); };
      moments[e].add(together_at, 0.0, 1.0);
      moments[e].flush();
      moments[e].matrix(table_, turn_, out_.pieces[e].stiffness);
    }
  }

  void look_back_a_period() {
    for (std::size_t e = 0; e < out_.mesh.pieces.size(); ++e) {
      MeshTopology::Piece& piece = out_.mesh.topology.pieces[e];
      if (!piece.records) continue;
      piece.groups = 1;
      piece.sources.assign(table_.nodes, {.piece = static_cast<int>(e), .before = true, .exact = true});
    }
  }

  /// The matrix of a piece for what another one holds.
  Eigen::MatrixXd& delayed(std::size_t e, const Source& source) {
    std::vector<Source>& sources = out_.mesh.topology.pieces[e].sources;
    const auto known = std::ranges::find(sources, source);
    if (known != sources.end()) return out_.pieces[e].delayed[static_cast<std::size_t>(known - sources.begin())];
    const Eigen::Index size = 3 * static_cast<Eigen::Index>(table_.nodes);
    sources.push_back(source);
    return out_.pieces[e].delayed.emplace_back(Eigen::MatrixXd::Zero(size, size));
  }

  /// Delays that differ: where a point of a piece looks, what is remembered is the polynomial of the piece it falls in.
  void look_back() {
    const std::vector<CutMesh::Piece>& pieces = out_.mesh.pieces;
    for (const EdgeContact& contact : contacts_.contacts) {
      for_parts(contact, [&](std::size_t at, double low, double high, double from) {
        const Harmonics k(contacts_.rings[contact.ring], contact.turn_rad + from);  // at the start of the piece
        // Parts that look into one piece each.
        double done = low;
        while (done < high) {
          const double here = pieces[at].from_rad + done * pieces[at].length_rad;
          Source source;
          double left_rad = 0.0;
          const double origin = locate(here - contact.delay_rad, source, left_rad);
          const double next = std::min(high, done + std::max(left_rad, same_angle) / pieces[at].length_rad);
          add_delayed(k, at, contact.delay_rad, done, next, origin, source);
          done = next;
        }
      });
    }
  }

  /// The piece that holds a rotation of this period or the one before: where it starts, and how far it still reaches.
  double locate(double rotation_rad, Source& source, double& left_rad) const {
    const std::vector<CutMesh::Piece>& pieces = out_.mesh.pieces;
    const double start = pieces.front().from_rad;
    source.before = rotation_rad < start - same_angle;
    const double shift = source.before ? contacts_.period_rad : 0.0;
    const double within = rotation_rad + shift + same_angle;
    const auto after =
        std::ranges::upper_bound(pieces, within, {}, [](const CutMesh::Piece& piece) { return piece.from_rad; });
    const std::size_t at = after == pieces.begin() ? 0 : static_cast<std::size_t>(after - pieces.begin()) - 1;
    source.piece = static_cast<int>(at);
    left_rad = pieces[at].from_rad + pieces[at].length_rad - within;
    return pieces[at].from_rad - shift;
  }

  void add_delayed(const Harmonics& k, std::size_t at, double delay_rad, double low, double high, double origin_rad,
                   const Source& source) {
    const CutMesh::Piece& piece = out_.mesh.pieces[at];
    const double source_length = out_.mesh.pieces[static_cast<std::size_t>(source.piece)].length_rad;
    if (!out_.mesh.topology.pieces[static_cast<std::size_t>(source.piece)].records) return;
    Eigen::MatrixXd& to = delayed(at, source);
    const int points = level_.nodes + 3 + static_cast<int>(std::ceil(piece.length_rad * (high - low)));
    const GaussRule& rule = gauss_rule(std::min(points, most_gauss_points));
    std::array<double, most_nodes> now = {}, then = {};
    for (std::size_t q = 0; q < rule.node.size(); ++q) {
      const double x = low + (high - low) * rule.node[q];
      const double rotation = piece.from_rad + x * piece.length_rad;
      const Eigen::Matrix3d weighted =
          (high - low) * rule.weight[q] * (turn_ * k.at(x * piece.length_rad) * turn_.transpose());
      const double seen = (rotation - delay_rad - origin_rad) / source_length;
      for (std::size_t i = 0; i < table_.nodes; ++i) {
        now[i] = lagrange(table_.rule->node, i, x) / table_.rule->weight[i];
        then[i] = lagrange(table_.rule->node, i, seen);
      }
      for (std::size_t i = 0; i < table_.nodes; ++i) {
        for (std::size_t l = 0; l < table_.nodes; ++l) {
          to.block<3, 3>(3 * static_cast<Eigen::Index>(i), 3 * static_cast<Eigen::Index>(l)) +=
              (now[i] * then[l]) * weighted;
        }
      }
    }
  }

  const EdgeContacts& contacts_;
  const Eigen::Matrix3d& turn_;
  const NodeTable& table_;
  MeshLevel level_;
  CollocationCase& out_;
};

}  // namespace

void build_spatial_mesh(const EdgeContacts& contacts, double fastest_per_rad, const Eigen::Matrix3d& axes_from_tool,
                        const MeshLevel& level, CollocationCase& out) {
  SpatialBuilder(contacts, axes_from_tool, level, out).build(fastest_per_rad);
}

}  // namespace robomill::stability::detail
