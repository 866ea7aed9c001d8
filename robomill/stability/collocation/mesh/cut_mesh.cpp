#include "robomill/stability/collocation/mesh/cut_mesh.hpp"

#include <algorithm>
#include <cmath>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/stability/gauss.hpp"

namespace robomill::stability::detail {
namespace {

/// Rotation over which some of a contact's edge is in the cut.
struct Span {
  double from_rad = 0.0, to_rad = 0.0;
};

class Builder {
 public:
  Builder(const CutterContacts& contacts, int repeats, double fastest, double axial_depth_m, const MeshLevel& level)
      : source_(contacts),
        milling_(contacts.milling()),
        part_(contacts.milling()),
        base_rad_(contacts.period_rad()),
        repeats_(repeats),
        fastest_(fastest),
        depth_m_(axial_depth_m),
        level_(level) {
    contacts.at_depth(axial_depth_m, contacts_);
    for (const Contact& c : contacts_) {
      const double lag = milling_.tool.lag_rad_per_m(c.tooth);
      const double standing = milling_.tool.standing_angle(c.tooth);
      const double low = lag * c.low_m;
      const double high = lag * c.high_m;
      standing_.push_back(standing);
      lag_.push_back(lag);
      spans_.push_back({c.immersion.entry_rad + std::min(low, high) - standing,
                        c.immersion.exit_rad + std::max(low, high) - standing});
      for (const double height : {c.low_m, c.high_m}) {
        shortest_delay_rad_ = std::min(shortest_delay_rad_, c.delay_rad + c.delay_rad_per_m * height);
      }
    }
  }

  void build(MeshTopology::Form least, const Rotation& turning, CutMesh& out) {
    std::vector<double> borders = find_borders();
    find_raw_pieces(borders);
    split(out);
    choose_form(least, out);
    for (std::size_t e = 0; e < out.pieces.size(); ++e) fill_piece(e, turning, out);
  }

 private:
  /// In one period of the cutter, from the first on.
  std::vector<double> find_borders() const {
    std::vector<double> borders;
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      const Contact& c = contacts_[i];
      for (const double angle : {c.immersion.entry_rad, c.immersion.exit_rad}) {
        for (const double height : {c.low_m, c.high_m}) {
          borders.push_back(wrap(angle + lag_[i] * height - standing_[i], base_rad_));
        }
      }
    }
    if (borders.empty()) borders.push_back(0.0);  // nobody cuts
    std::ranges::sort(borders);
    std::vector<double> distinct;
    for (const double border : borders) {
      const bool known = !distinct.empty() &&
                         (border - distinct.back() < same_angle || distinct.front() + base_rad_ - border < same_angle);
      if (!known) distinct.push_back(border);
    }
    return distinct;
  }

  /// All contacts that have some edge in the cut at a rotation.
  void active_at(double rotation_rad, std::vector<std::size_t>& out) const {
    out.clear();
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      const Span& span = spans_[i];
      const double past = wrap(rotation_rad - span.from_rad, units::revolution);
      if (past < span.to_rad - span.from_rad) out.push_back(i);
    }
  }

  struct Raw {
    double from_rad = 0.0, length_rad = 0.0;
    std::vector<std::size_t> active;
    bool records = false;
  };

  void find_raw_pieces(const std::vector<double>& borders) {
    raw_.clear();
    for (std::size_t i = 0; i < borders.size(); ++i) {
      Raw piece;
      piece.from_rad = borders[i];
      piece.length_rad = (i + 1 < borders.size() ? borders[i + 1] : borders.front() + base_rad_) - borders[i];
      active_at(piece.from_rad + 0.5 * piece.length_rad, piece.active);
      piece.records = !piece.active.empty();
      raw_.push_back(piece);
    }
    // Free flight that somebody looks back to.
    for (const Raw& looker : raw_) {
      for (const std::size_t i : looker.active) {
        const Contact& c = contacts_[i];
        const double at_low = c.delay_rad + c.delay_rad_per_m * c.low_m;
        const double at_high = c.delay_rad + c.delay_rad_per_m * c.high_m;
        const double from = looker.from_rad - std::max(at_low, at_high);
        const double to = looker.from_rad + looker.length_rad - std::min(at_low, at_high);
        for (Raw& seen : raw_) {
          if (seen.records) continue;
          const double ahead = wrap(seen.from_rad - from, base_rad_);  // from `from` to the piece's start
          const bool starts_inside = ahead < to - from - same_angle;
          const bool holds_start = ahead + seen.length_rad > base_rad_ + same_angle;
          seen.records = starts_inside || holds_start;
        }
      }
    }
  }

  /// Cuts the pieces to a length that the nodes can follow and that no delay falls short of.
  void split(CutMesh& out) {
    out.pieces.clear();
    out.topology.pieces.clear();
    active_.clear();
    out.period_rad = base_rad_ * repeats_;
    const double reach_rad = std::min(longest_piece_rad / fastest_, shortest_delay_rad_);
    for (int r = 0; r < repeats_; ++r) {
      for (const Raw& raw : raw_) {
        const int needed = std::max(1, static_cast<int>(std::ceil(raw.length_rad / reach_rad - 1e-9)));
        const int parts = raw.records ? needed * level_.splits : 1;
        for (int i = 0; i < parts; ++i) {
          CutMesh::Piece piece;
          piece.length_rad = raw.length_rad / parts;
          piece.from_rad = raw.from_rad + r * base_rad_ + i * piece.length_rad;
          out.pieces.push_back(piece);
          MeshTopology::Piece topology;
          topology.records = raw.records;
          out.topology.pieces.push_back(topology);
          active_.push_back(raw.active);
        }
      }
    }
  }

  void choose_form(MeshTopology::Form least, CutMesh& out) const {
    using Form = MeshTopology::Form;
    const bool damped = milling_.process_damping.active();
    bool chip = least == Form::chip && !damped && !source_.depends_on_depth();
    bool whole = least != Form::several && !damped;
    for (const Raw& raw : raw_) {
      chip = chip && raw.active.size() <= 1 && (raw.records == !raw.active.empty());
      for (const std::size_t i : raw.active) {
        const Contact& first = contacts_[raw.active.front()];
        whole = whole && contacts_[i].delay_rad_per_m == 0.0 && contacts_[i].delay_rad == first.delay_rad;
      }
    }
    out.topology.nodes = level_.nodes;
    out.topology.form = chip ? Form::chip : whole ? Form::whole : Form::several;
  }

  /// What looks back by one delay: contacts of the same constant delay together, or one height of one contact.
  struct Group {
    std::vector<std::size_t> contacts;
    int height = -1;
  };

  [[nodiscard]] std::vector<Group> groups_of(const std::vector<std::size_t>& active) const {
    std::vector<Group> groups;
    for (const std::size_t i : active) {
      if (contacts_[i].delay_rad_per_m != 0.0) {
        for (int h = 0; h < level_.heights; ++h) groups.push_back({{i}, h});
        continue;
      }
      const auto same = std::ranges::find_if(groups, [&](const Group& group) {
        return group.height < 0 &&
               std::abs(contacts_[group.contacts.front()].delay_rad - contacts_[i].delay_rad) < same_angle;
      });
      if (same == groups.end()) {
        groups.push_back({{i}, -1});
      } else {
        same->contacts.push_back(i);
      }
    }
    return groups;
  }

  /// What looks back by one delay at one node, per axial depth.
  struct Term {
    double delay_rad = 0.0;
    Eigen::Matrix2d stiffness = Eigen::Matrix2d::Zero();
  };

  [[nodiscard]] Term term_of(const Group& group, double rotation_rad) {
    Term term;
    if (group.height < 0) {
      for (const std::size_t i : group.contacts) {
        const Contact& c = contacts_[i];
        term.delay_rad = c.delay_rad;
        term.stiffness += cutting::cutting_stiffness(part_of(c), c.tooth, rotation_rad, c.low_m, c.high_m) / depth_m_;
      }
      return term;
    }
    const std::size_t i = group.contacts.front();
    const Contact& c = contacts_[i];
    const HeightsInCut in = heights_in_cut(c, lag_[i], rotation_rad + standing_[i]);
    const GaussRule& rule = gauss_rule(level_.heights);
    const std::size_t h = static_cast<std::size_t>(group.height);
    const double height = in.low_m + in.length_m * rule.node[h];
    term.delay_rad = c.delay_rad + c.delay_rad_per_m * height;
    term.stiffness = cutting::directional_coefficients(milling_.coefficients, in.turned_rad - lag_[i] * height) *
                     (in.length_m * rule.weight[h] / depth_m_);
    return term;
  }

  /// The cut with one contact's angles.
  const cutting::Milling& part_of(const Contact& c) {
    part_.immersion = c.immersion;
    return part_;
  }

  /// The piece that holds a rotation of this period or the one before.
  void locate(double rotation_rad, const CutMesh& mesh, Source& source, double& inside) const {
    const double start = mesh.pieces.front().from_rad;
    source.before = rotation_rad < start - same_angle;
    const double within = source.before ? rotation_rad + mesh.period_rad : rotation_rad;
    const auto after = std::ranges::upper_bound(mesh.pieces, within + same_angle, {},
                                                [](const CutMesh::Piece& piece) { return piece.from_rad; });
    std::size_t at = after == mesh.pieces.begin() ? 0 : static_cast<std::size_t>(after - mesh.pieces.begin()) - 1;
    double position = within;
    // A border's width beside what is remembered: that is meant.
    if (!mesh.topology.pieces[at].records) {
      const bool early = position - mesh.pieces[at].from_rad < 0.5 * mesh.pieces[at].length_rad;
      if (early && at > 0) {
        --at;
      } else if (early && !source.before) {
        at = mesh.pieces.size() - 1;
        source.before = true;
        position += mesh.period_rad;
      } else if (!early && at + 1 < mesh.pieces.size()) {
        ++at;
      } else if (!early && source.before) {
        at = 0;
        source.before = false;
        position -= mesh.period_rad;
      }
    }
    if (!mesh.topology.pieces[at].records) {
      throw InvalidInput("runout_m", milling_.tool.runout_m, "m", "leaves stretches of the cut too short to resolve");
    }
    source.piece = static_cast<int>(at);
    inside = (position - mesh.pieces[at].from_rad) / mesh.pieces[at].length_rad;
  }

  /// Fills the sources and weights of one delay at one node.
  void look_back(std::size_t e, std::size_t node, double delay_rad, CutMesh& mesh) const {
    const std::vector<double>& nodes = gauss_rule(level_.nodes).node;
    const CutMesh::Piece& piece = mesh.pieces[e];
    Source source;
    double inside = 0.0;
    locate(piece.from_rad + nodes[node] * piece.length_rad - delay_rad, mesh, source, inside);
    const double here = mesh.pieces[static_cast<std::size_t>(source.piece)].length_rad;
    source.exact = std::abs(inside - nodes[node]) * here < same_angle && std::abs(here - piece.length_rad) < same_angle;
    mesh.topology.pieces[e].sources.push_back(source);
    std::vector<double>& weights = mesh.pieces[e].weights;
    for (std::size_t l = 0; l < nodes.size(); ++l) {
      weights.push_back(source.exact ? (l == node ? 1.0 : 0.0) : lagrange(nodes, l, inside));
    }
  }

  void fill_piece(std::size_t e, const Rotation& turning, CutMesh& mesh) {
    CutMesh::Piece& piece = mesh.pieces[e];
    MeshTopology::Piece& topology = mesh.topology.pieces[e];
    if (!topology.records) return;
    const std::vector<double>& nodes = gauss_rule(level_.nodes).node;
    const MeshTopology::Form form = mesh.topology.form;
    const bool damped = milling_.process_damping.active();
    const std::vector<Group> groups = groups_of(active_[e]);
    topology.groups = static_cast<int>(groups.size());
    piece.stiffness.assign(form == MeshTopology::Form::chip ? 0 : nodes.size(), Eigen::Matrix2d::Zero());
    // Contacts were found in the cutter's first period.
    const double first_rad = mesh.pieces.front().from_rad;
    const double geometry_rad =
        piece.from_rad - base_rad_ * std::floor((piece.from_rad - first_rad) / base_rad_ + 1e-9);
    for (const Group& group : groups) {
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        const double rotation = geometry_rad + nodes[i] * piece.length_rad;
        if (form == MeshTopology::Form::chip) {
          chip_at(rotation, active_[e].front(), piece);
          look_back(e, i, contacts_[active_[e].front()].delay_rad, mesh);
          continue;
        }
        const Term term = term_of(group, rotation);
        piece.stiffness[i] += term.stiffness;
        if (form == MeshTopology::Form::several) piece.delayed_stiffness.push_back(term.stiffness);
        look_back(e, i, term.delay_rad, mesh);
      }
    }
    for (std::size_t i = 0; damped && i < nodes.size(); ++i) {
      const double rotation = geometry_rad + nodes[i] * piece.length_rad;
      const double speed = turning.speed_rad_per_s(piece.from_rad + nodes[i] * piece.length_rad);
      Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
      for (const std::size_t c : active_[e]) {
        sum += cutting::cutting_damping(part_of(contacts_[c]), contacts_[c].tooth, rotation, contacts_[c].low_m,
                                        contacts_[c].high_m, speed);
      }
      piece.damping.push_back(sum / depth_m_);
    }
  }

  void chip_at(double rotation_rad, std::size_t contact, CutMesh::Piece& piece) const {
    const double angle = rotation_rad + standing_[contact];
    const double s = std::sin(angle);
    const double c = std::cos(angle);
    const cutting::ForceCoefficients& k = milling_.coefficients;
    piece.chip.emplace_back(s, c);
    piece.push.emplace_back(-(k.tangential_n_per_m2 * c + k.radial_n_per_m2 * s),
                            k.tangential_n_per_m2 * s - k.radial_n_per_m2 * c);
  }

  const CutterContacts& source_;
  const cutting::Milling& milling_;
  cutting::Milling part_;
  double base_rad_;
  int repeats_;
  double fastest_, depth_m_;
  MeshLevel level_;
  std::vector<Contact> contacts_;
  std::vector<double> standing_, lag_;
  std::vector<Span> spans_;
  double shortest_delay_rad_ = units::revolution;
  std::vector<Raw> raw_;
  std::vector<std::vector<std::size_t>> active_;  ///< [piece]
};

}  // namespace

void build_mesh(const CutterContacts& contacts, int repeats, double fastest_rad_per_s, const Rotation& turning,
                double axial_depth_m, const MeshLevel& level, MeshTopology::Form least, CutMesh& out) {
  Builder(contacts, repeats, fastest_rad_per_s / turning.mean_rad_per_s(), axial_depth_m, level)
      .build(least, turning, out);
}

}  // namespace robomill::stability::detail
