#include "robomill/stability/collocation/spatial_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <mutex>

#include "robomill/base/units.hpp"
#include "robomill/stability/collocation/contacts.hpp"
#include "robomill/stability/gauss.hpp"

namespace robomill::stability::detail {
namespace {

constexpr double longest_piece_rad = 8.0;  // of the fastest mode
constexpr double same_angle = 1e-10;
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

/// Where much of the stiffness comes or goes within a small part of a piece: the ends of such stretches, in [0, period).
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

/// P_m(2x - 1), m = 0 … count - 1.
void legendre(double x, std::size_t count, double* out) {
  const double t = 2.0 * x - 1.0;
  out[0] = 1.0;
  if (count > 1) out[1] = t;
  for (std::size_t m = 2; m < count; ++m) {
    const double k = static_cast<double>(m);
    out[m] = ((2.0 * k - 1.0) * t * out[m - 1] - (k - 1.0) * out[m - 2]) / k;
  }
}

constexpr std::size_t most_moments = 2 * most_nodes - 1;
constexpr std::size_t entries = 9;  // of a 3 x 3 matrix, row by row

/// What the number of nodes alone decides.
struct NodeTable {
  std::size_t nodes = 0, moments = 0;
  const GaussRule* rule = nullptr;     ///< of the nodes
  const GaussRule* product = nullptr;  ///< exact for the product of four of the nodes' polynomials
  std::vector<double> from_moments;    ///< [point of product][moment]: (2m + 1) P_m
  std::vector<double> value;           ///< [point of product][node]: ℓ_i
};

NodeTable make_table(int nodes) {
  NodeTable t;
  t.nodes = static_cast<std::size_t>(nodes);
  t.moments = 2 * t.nodes - 1;
  t.rule = &gauss_rule(nodes);
  t.product = &gauss_rule(2 * nodes - 1);
  std::array<double, most_moments> p = {};
  for (const double x : t.product->node) {
    legendre(x, t.moments, p.data());
    for (std::size_t m = 0; m < t.moments; ++m) t.from_moments.push_back(static_cast<double>(2 * m + 1) * p[m]);
    for (std::size_t i = 0; i < t.nodes; ++i) t.value.push_back(lagrange(t.rule->node, i, x));
  }
  return t;
}

const NodeTable& node_table(int nodes) {
  struct Slot {
    std::once_flag made;
    NodeTable table;
  };
  static std::array<Slot, most_nodes + 1> slots;
  Slot& slot = slots[static_cast<std::size_t>(nodes)];
  std::call_once(slot.made, [&] { slot.table = make_table(nodes); });
  return slot.table;
}

/// K of edges at φ = rotation + turn, as functions of the rotation: Σ over edges of what the harmonics of f nᵀ need.
struct Harmonics {
  std::complex<double> mean, second;  ///< g s and g s e^{2i turn}, g = outward - i tangential, s = sin κ
  std::complex<double> column, row;   ///< -g cos κ e^{i turn}; upward s e^{i turn}
  double axial = 0.0;                 ///< -upward cos κ

  void add(const RingStiffness& ring, double turn_rad) {
    const std::complex<double> g(ring.outward, -ring.tangential);
    const std::complex<double> turn = std::polar(1.0, turn_rad);
    mean += g * ring.sine;
    second += g * ring.sine * turn * turn;
    column -= g * ring.cosine * turn;
    row += ring.upward * ring.sine * turn;
    axial -= ring.upward * ring.cosine;
  }
  /// K in T, row by row.
  [[nodiscard]] std::array<double, entries> at(double rotation_rad) const {
    const std::complex<double> e = std::polar(1.0, rotation_rad);
    const std::complex<double> twice = second * e * e;
    const std::complex<double> c = column * e;
    const std::complex<double> r = row * e;
    return {0.5 * (mean.real() - twice.real()), 0.5 * (twice.imag() + mean.imag()), c.imag(),
            0.5 * (twice.imag() - mean.imag()), 0.5 * (mean.real() + twice.real()), c.real(),
            r.imag(),                           r.real(),                           axial};
  }
};

/// ∫ K P_m dx of a piece, x its share: [entry][moment].
class Moments {
 public:
  explicit Moments(std::size_t count) : count_(count), sum_(entries * count, 0.0) {}

  /// Adds what cuts over the part [low, high] of the piece.
  void add(const Harmonics& k, double piece_from_rad, double piece_length_rad, double low, double high) {
    const double length = high - low;
    const int points = static_cast<int>(count_) / 2 + 3 + static_cast<int>(std::ceil(piece_length_rad * length));
    const GaussRule& rule = gauss_rule(std::min(points, most_gauss_points));
    std::array<double, most_moments> p = {};
    for (std::size_t q = 0; q < rule.node.size(); ++q) {
      const double x = low + length * rule.node[q];
      const std::array<double, entries> value = k.at(piece_from_rad + x * piece_length_rad);
      legendre(x, count_, p.data());
      for (std::size_t e = 0; e < entries; ++e) {
        const double weighted = value[e] * (length * rule.weight[q]);
        double* to = sum_.data() + e * count_;
        for (std::size_t m = 0; m < count_; ++m) to[m] += weighted * p[m];
      }
    }
  }

  /// M_il = ∫ ℓ_i ℓ_l K dx / w_i in axes turned by R.
  void matrix(const NodeTable& t, const Eigen::Matrix3d& turn, Eigen::MatrixXd& out) const {
    const Eigen::Index size = 3 * static_cast<Eigen::Index>(t.nodes);
    out.setZero(size, size);
    for (std::size_t q = 0; q < t.product->node.size(); ++q) {
      Eigen::Matrix3d k;
      for (std::size_t e = 0; e < entries; ++e) {
        double sum = 0.0;
        for (std::size_t m = 0; m < count_; ++m) sum += t.from_moments[q * count_ + m] * sum_[e * count_ + m];
        k(static_cast<Eigen::Index>(e / 3), static_cast<Eigen::Index>(e % 3)) = sum;
      }
      k = (turn * k * turn.transpose()).eval();
      const double* value = t.value.data() + q * t.nodes;
      for (std::size_t i = 0; i < t.nodes; ++i) {
        const double share = t.product->weight[q] * value[i] / t.rule->weight[i];
        for (std::size_t l = 0; l < t.nodes; ++l) {
          out.block<3, 3>(3 * static_cast<Eigen::Index>(i), 3 * static_cast<Eigen::Index>(l)) += (share * value[l]) * k;
        }
      }
    }
  }

 private:
  std::size_t count_;
  std::vector<double> sum_;
};

class Builder {
 public:
  Builder(const EdgeContacts& contacts, const Eigen::Matrix3d& axes_from_tool, const MeshLevel& level,
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
    const std::vector<Run> runs =
        divided(find_runs(contacts_), find_steps(contacts_, reach_rad), contacts_.period_rad);
    CutMesh& mesh = out_.mesh;
    mesh.period_rad = contacts_.period_rad;
    mesh.pieces.clear();
    mesh.topology = {.nodes = level_.nodes,
                     .form = contacts_.equal_teeth ? Form::whole : Form::blocks,
                     .directions = 3};
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
      return from < run.length_rad - same_angle ||
             from + (c.to_rad - c.from_rad) > contacts_.period_rad + same_angle;
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
    std::vector<Moments> moments(pieces.size(), Moments(table_.moments));
    std::vector<Harmonics> all_along(pieces.size());  // of edges that cut over the whole piece
    for (const EdgeContact& contact : contacts_.contacts) {
      for_parts(contact, [&](std::size_t at, double low, double high, double from) {
        Harmonics k;
        k.add(contacts_.rings[contact.ring], contact.turn_rad + from - pieces[at].from_rad);
        if (low > 1e-13 || high < 1.0 - 1e-13) {
          moments[at].add(k, pieces[at].from_rad, pieces[at].length_rad, low, high);
        } else {
          all_along[at].mean += k.mean;
          all_along[at].second += k.second;
          all_along[at].column += k.column;
          all_along[at].row += k.row;
          all_along[at].axial += k.axial;
        }
      });
    }
    for (std::size_t e = 0; e < pieces.size(); ++e) {
      if (!out_.mesh.topology.pieces[e].records) continue;
      moments[e].add(all_along[e], pieces[e].from_rad, pieces[e].length_rad, 0.0, 1.0);
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
        Harmonics k;
        k.add(contacts_.rings[contact.ring], contact.turn_rad + from - pieces[at].from_rad);
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
      const std::array<double, entries> value = k.at(rotation);
      const Eigen::Matrix3d in_tool = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(value.data());
      const Eigen::Matrix3d weighted = (high - low) * rule.weight[q] * (turn_ * in_tool * turn_.transpose());
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
  Builder(contacts, axes_from_tool, level, out).build(fastest_per_rad);
}

}  // namespace robomill::stability::detail
