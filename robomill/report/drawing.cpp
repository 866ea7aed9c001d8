#include "robomill/report/drawing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "robomill/report/html.hpp"

namespace robomill::report {
namespace {

using Json = nlohmann::ordered_json;

// Units of the drawing's view box; its width is fixed, its height follows.
constexpr double view_width = 900.0;
constexpr double margin = 24.0;
constexpr double tallest = 250.0;          ///< the thickest part at most
constexpr double font = 15.0;              ///< as in page.css
constexpr double character = 0.58 * font;  ///< of a text's mean width, wide enough for any system font
constexpr double label_gap = 10.0;
constexpr double joint_gap = 64.0;  ///< between tool and holder, for the springs: not to scale
constexpr double wall_width = 22.0;
constexpr double box_width = 120.0;  ///< of a measured holder

/// A piece as it is drawn: from x, w wide, h high about the axis.
struct Piece {
  double x, width, height, bore;
  bool fluted, inside;  ///< inside: the shank in the holder
  std::string part, length_text, diameter_text;
};

struct Layout {
  double scale = 1.0;  ///< units a millimetre
  std::vector<Piece> pieces;
  double tool_x = 0.0, joint_x = 0.0, holder_x = 0.0;  ///< the tip, the tool's end, the holder's mouth
  double end_x = 0.0;                                  ///< the end of the last piece, where a wall begins
  double highest = 0.0;                                ///< of all pieces and symbols
};

double text_width(const std::string& text) {
  // A byte that continues a UTF-8 character takes no room of its own.
  const auto letters =
      std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; });
  return character * static_cast<double>(letters);
}

double total_mm(const Json& segments) {
  double sum = 0.0;
  for (const Json& segment : segments) sum += segment["length_mm"].get<double>();
  return sum;
}

double thickest_mm(const Json& segments) {
  double most = 0.0;
  for (const Json& segment : segments) most = std::max(most, segment["diameter_mm"].get<double>());
  return most;
}

Piece piece_of(const Json& segment, double x, double scale, bool inside) {
  const double bore = segment["inner_diameter_mm"].is_number() ? segment["inner_diameter_mm"].get<double>() : 0.0;
  Piece piece{.x = x,
              .width = scale * segment["length_mm"].get<double>(),
              .height = scale * segment["diameter_mm"].get<double>(),
              .bore = scale * bore,
              .fluted = segment["flutes"].get<int>() > 0,
              .inside = inside,
              .part = segment["part"].get<std::string>(),
              .length_text = fmt::format("{:.6g}", segment["length_mm"].get<double>()),
              .diameter_text = fmt::format("⌀\u202f{:.6g}", segment["diameter_mm"].get<double>())};
  if (bore > 0.0) piece.diameter_text += fmt::format("/{:.6g}", bore);
  return piece;
}

bool distributed(const Json& assembly) {
  return assembly["joint"].is_object() && assembly["joint"]["points"].get<int>() > 1;
}

Layout arrange(const Json& assembly) {
  const Json& tool = assembly["tool"];
  const Json& holder = assembly["holder"];
  const bool measured = holder["kind"] == "measured";
  const bool many_points = distributed(assembly);
  const bool gap = assembly["joint"].is_object() && !many_points;
  const Json shank = many_points ? assembly["joint"]["shank"] : Json::array();
  const double behind_mm = std::max(total_mm(holder["segments"]), total_mm(shank));
  const double room = view_width - 2.0 * margin - (gap ? joint_gap : 0.0) - (measured ? box_width : wall_width);
  Layout out;
  const double thickest = std::max({thickest_mm(tool), thickest_mm(holder["segments"]), thickest_mm(shank)});
  out.scale = std::min(room / (total_mm(tool) + behind_mm), tallest / thickest);
  double x = margin + 0.5 * (room - out.scale * (total_mm(tool) + behind_mm));
  out.tool_x = x;
  for (const Json& segment : tool) {
    out.pieces.push_back(piece_of(segment, x, out.scale, false));
    x += out.pieces.back().width;
  }
  out.joint_x = x;
  out.holder_x = x + (gap ? joint_gap : 0.0);
  x = out.holder_x;
  for (const Json& segment : holder["segments"]) {
    out.pieces.push_back(piece_of(segment, x, out.scale, false));
    x += out.pieces.back().width;
  }
  out.end_x = std::max(x, out.holder_x);
  x = out.holder_x;
  for (const Json& segment : shank) {
    out.pieces.push_back(piece_of(segment, x, out.scale, true));
    x += out.pieces.back().width;
  }
  out.end_x = std::max(x, out.end_x);
  out.highest = out.scale * thickest;
  if (gap || measured) out.highest = std::max(out.highest, 110.0);
  return out;
}

std::string line(const char* kind, double x1, double y1, double x2, double y2) {
  return fmt::format("<line class=\"{}\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>\n", kind, x1, y1, x2,
                     y2);
}

std::string box(const char* kind, double x, double y, double width, double height) {
  return fmt::format("<rect class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>\n", kind, x, y,
                     width, height);
}

std::string label(double x, double y, const std::string& text, const char* anchor = "middle") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor, escape(text));
}

std::string draw_piece(const Piece& piece, double axis) {
  const double top = axis - 0.5 * piece.height;
  const char* kind = piece.part == "holder" ? "holder" : piece.inside ? "tool shank" : "tool";
  std::string out = box(kind, piece.x, top, piece.width, piece.height);
  if (piece.fluted) out += box("flutes", piece.x, top, piece.width, piece.height);
  for (const double side : {-0.5, 0.5}) {
    if (piece.bore <= 0.0) break;
    const double y = axis + side * piece.bore;
    out += line("bore", piece.x, y, piece.x + piece.width, y);
  }
  return out;
}

/// Of the tool's last piece, which meets the joint.
double joint_height(const Layout& layout) {
  double height = 0.0;
  for (const Piece& piece : layout.pieces) {
    if (piece.part == "tool") height = piece.height;
  }
  return height;
}

/// A zigzag of a spring along the vertical from y1 to y2.
std::string zigzag(double x, double y1, double y2, double half_width, int turns) {
  std::string points = fmt::format("{:.1f},{:.1f}", x, y1);
  const double step = (y2 - y1) / (2.0 * turns);
  for (int i = 0; i < 2 * turns; ++i) {
    const double side = i % 2 == 0 ? half_width : -half_width;
    points += fmt::format(" {:.1f},{:.1f}", x + side, y1 + (i + 0.5) * step);
  }
  points += fmt::format(" {:.1f},{:.1f}", x, y2);
  return fmt::format("<polyline class=\"spring\" points=\"{}\"/>\n", points);
}

/// The joint at one point, above the axis the spring between the shifts, below it the one between the rotations.
std::string draw_joint(const Layout& layout, double axis) {
  const double left = layout.joint_x;
  const double right = layout.holder_x;
  const double middle = 0.5 * (left + right);
  std::string out = line("plate", left, axis - 50.0, left, axis + 50.0);
  out += line("plate", right, axis - 50.0, right, axis + 50.0);
  out += line("spring", left, axis - 46.0, middle, axis - 46.0) + zigzag(middle, axis - 46.0, axis - 8.0, 8.0, 4);
  out += line("spring", middle, axis - 8.0, right, axis - 8.0);
  // A spiral of two turns from its centre, which turns with the tool, to the holder.
  const double centre = axis + 28.0;
  std::string points;
  constexpr int steps = 40;
  for (int i = 0; i <= steps; ++i) {
    const double turn = static_cast<double>(i) / steps;
    const double angle = 4.0 * std::numbers::pi * turn;
    points += fmt::format("{}{:.1f},{:.1f}", i == 0 ? "" : " ", middle + 17.0 * turn * std::cos(angle),
                          centre + 17.0 * turn * std::sin(angle));
  }
  out += fmt::format("<polyline class=\"spring\" points=\"{}\"/>\n", points);
  out += line("spring", left, centre, middle, centre) + line("spring", middle + 17.0, centre, right, centre);
  return out;
}

/// The points of a distributed joint, evenly from the deep end to the mouth, on both sides of the shank.
std::string draw_points(const Layout& layout, const Json& joint, double axis) {
  const int points = joint["points"].get<int>();
  const double length = layout.scale * joint["insertion_length_mm"].get<double>();
  std::string out;
  for (int i = 0; i < points; ++i) {
    const double x = layout.holder_x + length * i / (points - 1);
    double half = 0.0;
    for (const Piece& piece : layout.pieces) {
      const bool here = x >= piece.x - 0.05 && x <= piece.x + piece.width + 0.05;
      if (piece.inside && here) half = std::max(half, 0.5 * piece.height);
    }
    for (const double side : {-1.0, 1.0}) {
      out += zigzag(x, axis + side * half, axis + side * (half + 14.0), 3.0, 2);
      out += fmt::format("<circle class=\"point\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\"/>\n", x, axis + side * half);
    }
  }
  return out;
}

/// What stands behind the last piece; a shank stands in it where it is not built of segments.
std::string draw_base(const Layout& layout, const Json& assembly, double axis) {
  const double half = 0.5 * layout.highest + 8.0;
  if (assembly["holder"]["kind"] == "measured") {
    return box("measured", layout.holder_x, axis - half, layout.end_x - layout.holder_x + box_width, 2.0 * half) +
           label(layout.end_x + 0.5 * box_width, axis - 3.0, "measured") +
           label(layout.end_x + 0.5 * box_width, axis + 15.0, "holder");
  }
  const double mouth = assembly["holder"]["kind"] == "wall" ? layout.holder_x : layout.end_x;
  return box("wall", mouth, axis - half, layout.end_x - mouth + wall_width, 2.0 * half) +
         line("plate", mouth, axis - half, mouth, axis + half);
}

struct Label {
  double place = 0.0;  ///< what it belongs to
  std::string text;
  double from_y = 0.0;  ///< where its place ends, towards the label
  bool passes = false;  ///< no text: keeps room for a line to a label further on
};

/// Labels side by side. Each is tied to its place by a line, straight until all pieces are passed (clear_y), then
/// aslant: in the order of their places no line crosses another.
/// @return the centres
std::vector<double> draw_labels(std::string& out, const std::vector<Label>& labels, double y, double clear_y) {
  std::vector<double> places;
  std::vector<double> widths;
  for (const Label& one : labels) {
    places.push_back(one.place);
    widths.push_back((one.passes ? 0.0 : text_width(one.text)) + label_gap);
  }
  std::vector<double> centres = side_by_side(places, widths, 0.0, view_width);
  const double near = y > clear_y ? y - font : y + 5.0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const Label& one = labels[i];
    const double end = one.passes ? y - font - 2.0 : near;
    const bool aslant = std::abs(centres[i] - one.place) > 0.5;
    if (one.passes || aslant || std::abs(clear_y - one.from_y) > 1.0) {
      out += fmt::format(
          "<polyline class=\"leader\" points=\"{:.1f},{:.1f} {:.1f},{:.1f} {:.1f},{:.1f} {:.1f},{:.1f}\"/>\n",
          one.place, one.from_y, one.place, clear_y, centres[i], near, centres[i], end);
    }
    if (!one.passes) out += label(centres[i], y, one.text);
  }
  return centres;
}

bool fit(const std::vector<Label>& labels) {
  double sum = 0.0;
  for (const Label& one : labels) sum += text_width(one.text) + label_gap;
  return sum <= view_width;
}

void sort(std::vector<Label>& labels) {
  std::ranges::stable_sort(labels, {}, &Label::place);
}

std::string dimension(double from, double to, double y) {
  return line("dimension", from, y, to, y) + line("dimension", from, y - 4.0, from, y + 4.0) +
         line("dimension", to, y - 4.0, to, y + 4.0);
}

/// A dimension line below every piece, the shank's below the holder's.
/// @return where the next row may begin
double draw_lengths(std::string& out, const Layout& layout, double y) {
  const bool shank = std::ranges::any_of(layout.pieces, &Piece::inside);
  std::vector<Label> labels;
  for (const Piece& piece : layout.pieces) {
    const double at = piece.inside ? y + 10.0 : y;
    out += dimension(piece.x, piece.x + piece.width, at);
    labels.push_back({piece.x + 0.5 * piece.width, piece.length_text, at});
  }
  sort(labels);
  const double clear = shank ? y + 14.0 : y;
  if (!fit(labels)) return clear + 10.0;
  draw_labels(out, labels, clear + 32.0, clear);
  return clear + 50.0;
}

/// Tool and holder as wholes.
void draw_wholes(std::string& out, const Layout& layout, const Json& assembly, double y) {
  std::vector<Label> labels;
  const auto whole = [&](const std::string& name, const Json& segments, double from, double to) {
    if (segments.empty()) return;
    out += dimension(from, to, y);
    labels.push_back({0.5 * (from + to), fmt::format("{} {:.6g} mm", name, total_mm(segments)), y});
  };
  whole("tool", assembly["tool"], layout.tool_x, layout.joint_x);
  const Json& segments = assembly["holder"]["segments"];
  whole("holder", segments, layout.holder_x, layout.holder_x + layout.scale * total_mm(segments));
  draw_labels(out, labels, y + 24.0, y);
}

/// A bar of 1, 2 or 5 times a power of ten, about a seventh of the picture at most.
std::string scale_bar(const Layout& layout, double y) {
  const double most = 0.15 * view_width / layout.scale;
  double bar = std::pow(10.0, std::floor(std::log10(most)));
  for (const double head : {5.0, 2.0}) {
    if (head * bar <= most) {
      bar *= head;
      break;
    }
  }
  const double width = bar * layout.scale;
  return fmt::format("<rect class=\"scale\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"5\"/>\n", margin,
                     y - 5.0, width) +
         label(margin + width + 8.0, y, fmt::format("{:.6g} mm", bar), "start");
}

/// What the symbol of the joint says.
std::vector<std::string> joint_texts(const Json& assembly) {
  const Json& joint = assembly["joint"];
  if (!joint.is_object()) return {"rigid joint"};
  return {fmt::format("Shift: k {} N/m, c {} N·s/m", with_power(joint["translational_stiffness_n_per_m"]),
                      with_power(joint["translational_damping_n_s_per_m"])),
          fmt::format("Rotation: k {} N·m/rad, c {} N·m·s/rad", with_power(joint["rotational_stiffness_n_m_per_rad"]),
                      with_power(joint["rotational_damping_n_m_s_per_rad"]))};
}

/// The joint's texts on top, the diameters below them.
std::string draw_diameters(const Layout& layout, const Json& assembly, double top, double axis, double clear_y) {
  const std::vector<std::string> joint = joint_texts(assembly);
  const double row = top + 20.0 * static_cast<double>(joint.size()) + 18.0;
  const bool one_point = assembly["joint"].is_object() && !distributed(assembly);
  const double joint_place = 0.5 * (layout.joint_x + layout.holder_x);
  const double joint_y = one_point ? axis - 50.0 : axis - 0.5 * joint_height(layout);
  std::vector<Label> labels;
  for (const Piece& piece : layout.pieces) {
    labels.push_back({piece.x + 0.5 * piece.width, piece.diameter_text, axis - 0.5 * piece.height});
  }
  if (!fit(labels)) labels.clear();
  labels.push_back({joint_place, {}, joint_y, true});
  sort(labels);
  std::string out;
  const std::vector<double> centres = draw_labels(out, labels, row, clear_y);
  const auto at = std::ranges::find(labels, true, &Label::passes) - labels.begin();
  double widest = 0.0;
  for (const std::string& text : joint) widest = std::max(widest, text_width(text));
  const double centre = std::clamp(centres[static_cast<std::size_t>(at)], 0.5 * widest, view_width - 0.5 * widest);
  for (std::size_t i = 0; i < joint.size(); ++i)
    out += label(centre, top + 16.0 + 20.0 * static_cast<double>(i), joint[i]);
  return out;
}

constexpr const char* patterns =
    "<defs><pattern id=\"flutes\" width=\"9\" height=\"9\" patternUnits=\"userSpaceOnUse\" "
    "patternTransform=\"rotate(-60)\"><line class=\"flute\" x1=\"0\" y1=\"0\" x2=\"0\" y2=\"9\"/></pattern>"
    "<pattern id=\"wall\" width=\"7\" height=\"7\" patternUnits=\"userSpaceOnUse\" "
    "patternTransform=\"rotate(45)\"><line class=\"hatch\" x1=\"0\" y1=\"0\" x2=\"0\" y2=\"7\"/></pattern></defs>\n";

/// The drawing in words, for who cannot see it.
std::string in_words(const Json& assembly) {
  const Json& tool = assembly["tool"];
  const Json& holder = assembly["holder"];
  std::string out =
      fmt::format("Tool of {:.6g} mm in {} segment{}, ", total_mm(tool), tool.size(), tool.size() == 1 ? "" : "s");
  out += !assembly["joint"].is_object() ? "joined rigidly to "
         : distributed(assembly)
             ? fmt::format("in an elastic joint of {} points on ", assembly["joint"]["points"].get<int>())
             : "on an elastic joint to ";
  if (holder["kind"] == "measured") return out + "a measured holder";
  if (holder["kind"] == "wall") return out + "a rigid wall";
  return out + fmt::format("a holder of {:.6g} mm in {} segment{} on a rigid wall", total_mm(holder["segments"]),
                           holder["segments"].size(), holder["segments"].size() == 1 ? "" : "s");
}

}  // namespace

std::vector<double> side_by_side(const std::vector<double>& targets, const std::vector<double>& widths, double low,
                                 double high) {
  // Measured from where each would stand if all were packed to the left, the centres only must not decrease: isotonic
  // regression, by pooling neighbours that do, then held within what is left of the room.
  struct Pool {
    double sum;
    std::size_t count;
  };
  std::vector<double> packed;
  std::vector<Pool> pools;
  double edge = low;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    packed.push_back(edge + 0.5 * widths[i]);
    edge += widths[i];
    pools.push_back({targets[i] - packed.back(), 1});
    while (pools.size() > 1) {
      const Pool last = pools.back();
      Pool& before = pools[pools.size() - 2];
      if (before.sum * static_cast<double>(last.count) <= last.sum * static_cast<double>(before.count)) break;
      before = {before.sum + last.sum, before.count + last.count};
      pools.pop_back();
    }
  }
  std::vector<double> centres;
  for (const Pool& pool : pools) {
    const double shift = std::clamp(pool.sum / static_cast<double>(pool.count), 0.0, std::max(0.0, high - edge));
    for (std::size_t k = 0; k < pool.count; ++k) centres.push_back(packed[centres.size()] + shift);
  }
  return centres;
}

std::string assembly_drawing(const Json& assembly) {
  const Layout layout = arrange(assembly);
  const double top = 4.0;
  const double clear = top + 20.0 * static_cast<double>(joint_texts(assembly).size()) + 44.0;
  const double axis = clear + 10.0 + 0.5 * layout.highest;
  std::string body = draw_base(layout, assembly, axis);
  for (const Piece& piece : layout.pieces) body += draw_piece(piece, axis);
  const bool gap = assembly["joint"].is_object() && !distributed(assembly);
  if (gap) body += draw_joint(layout, axis);
  if (distributed(assembly)) body += draw_points(layout, assembly["joint"], axis);
  body += line("axis", layout.tool_x - 12.0, axis, layout.end_x + 6.0, axis);
  body += draw_diameters(layout, assembly, top, axis, clear);
  double y = axis + 0.5 * layout.highest + 26.0;
  y = draw_lengths(body, layout, y);
  draw_wholes(body, layout, assembly, y);
  body += scale_bar(layout, y + 60.0);
  return fmt::format(
      "<figure><div class=\"drawing\"><svg class=\"assembly\" viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" "
      "aria-label=\"{}\">\n{}{}</svg></div>\n<figcaption>To scale, but for the joint's symbol; lengths and diameters "
      "in mm. Hatched: flutes, at their nominal diameter. Dashed: bores (outer/inner "
      "diameter).</figcaption></figure>\n",
      view_width, y + 72.0, escape(in_words(assembly)), patterns, body);
}

}  // namespace robomill::report
