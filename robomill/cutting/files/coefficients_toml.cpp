#include "robomill/cutting/files/coefficients_toml.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cutting/files/coefficients_schema.hpp"
#include "robomill/cutting/files/cutter_schema.hpp"
#include "robomill/cutting/files/materials_toml.hpp"
#include "robomill/io/toml/file.hpp"

namespace robomill::cutting {
namespace {

/// The helix that inclines the edge: the table's own, else the tool's; a tool without one has straight edges.
double helix_of(io::TomlFile& file, const CoefficientKeys& given) {
  if (given.helix_rad) return *given.helix_rad;
  double helix_rad = 0.0;
  const std::string key = fmt::format("tool.{}", helix_key), own_key = fmt::format("coefficients.{}", helix_key);
  if (file.has(key) && !file.is_number(key)) {
    throw file.reject(key, "must be one angle where a material is named", "Give " + own_key);
  }
  if (!file.number(key, "helix_rad", units::deg, helix_rad) && !file.has("tool")) {
    file.require(own_key, "The cutter's, which inclines its edges");
  }
  return helix_rad;
}

/// @throws InvalidInput at the first of the keys of [coefficients] that is given
void reject_any(const io::TomlFile& file, std::initializer_list<const char*> keys, const char* rule) {
  for (const char* name : keys) {
    const std::string key = std::string("coefficients.") + name;
    if (file.has(key)) throw file.reject(key, rule);
  }
}

const Material& find_material(const io::TomlFile& file, const std::string& key, const std::string& name) {
  try {
    return material(name);
  } catch (const InvalidInput& error) {
    throw file.reject(key, error.parts().rule, error.parts().hint);
  }
}

MillingCoefficients from_orthogonal_tests(io::TomlFile& file, const Material& known, const CoefficientKeys& given) {
  file.require("coefficients.chip_thickness_mm", "The mean of the cut; in a slot 0.64 of the feed per tooth");
  reject_any(file, {"set", "radial_ratio"}, "has no part in orthogonal tests");
  if (!known.orthogonal) {
    throw file.reject("coefficients.rake_deg",
                      fmt::format("is for orthogonal tests, and of {} none are known", known.name),
                      "Leave it out: the material's published coefficients are taken then");
  }
  const double helix_rad = helix_of(file, given);
  try {
    return milling_coefficients(*known.orthogonal, *given.rake_rad, helix_rad, *given.chip_thickness_m);
  } catch (const InvalidInput& error) {
    const InvalidInput reported = file.located(error);
    if (!reported.parts().where.empty()) throw reported;
    throw file.reject("coefficients.rake_deg", error.parts().rule, error.parts().hint);
  }
}

/// One of the material's sets: coefficients.set, counted from 1, else the best for the cutter.
std::size_t chosen_set(const io::TomlFile& file, const std::string& key, const Material& known,
                       const std::optional<int>& set, CutterKind kind) {
  const std::optional<std::size_t> best = best_set(known, kind);
  if (!best) {
    throw file.reject(key, "is a material of which no force coefficients are known here",
                      "Only speeds and feeds; give its coefficients as numbers");
  }
  if (!set) return *best;
  const std::size_t sets = known.coefficients.size();
  if (static_cast<std::size_t>(*set) > sets) {
    throw file.reject("coefficients.set", fmt::format("must lie between 1 and {}, the sets of {}", sets, known.name));
  }
  return static_cast<std::size_t>(*set) - 1;
}

/// At which chip thickness a power law is taken as a straight line.
double chip_of(const io::TomlFile& file, const PublishedCoefficients& set, const CoefficientKeys& given,
               const CutAtHand& cut) {
  const char* const key = "coefficients.chip_thickness_mm";
  if (!set.is_power() && given.chip_thickness_m) {
    throw file.reject(key, "has no part in coefficients of a straight line over the chip",
                      "Beside coefficients.rake_deg it takes those of orthogonal tests");
  }
  const double chip_thickness_m = given.chip_thickness_m.value_or(cut.mean_chip_thickness_m);
  if (set.is_power() && !(chip_thickness_m > 0.0)) {
    file.require(key,
                 "The force is a power of the chip: give its mean here, or cut.feed_per_tooth_mm where depth and "
                 "direction tell it");
  }
  return chip_thickness_m;
}

/// Kr over Kt for a set that has no radial coefficient.
std::optional<double> radial_ratio_of(const io::TomlFile& file, const std::string& key, const Material& known,
                                      const PublishedCoefficients& set, const std::optional<double>& ratio) {
  if (set.has_radial() && ratio) {
    throw file.reject("coefficients.radial_ratio", "has no part: the set has a radial coefficient of its own");
  }
  if (!set.has_radial() && !ratio) {
    throw file.reject(
        key, fmt::format("has no radial coefficient: [{}] states the tangential one alone", set.source),
        fmt::format("Write [coefficients] with material = \"{}\" and radial_ratio, Kr over Kt: 0.16 to 0.6 "
                    "where the sources here state both",
                    known.name));
  }
  return ratio;
}

std::vector<double> times(std::vector<double> values, double factor) {
  for (double& value : values) value *= factor;
  return values;
}

std::string in_n_per_mm2(double value_n_per_m2) {
  return fmt::format("{:.4g}", value_n_per_m2 / units::n_per_mm2);
}

/// Which set was taken, and how far tests and sets lie apart.
/// @param alike  sets that serve the cutter as well, where nobody chose one; 0: coefficients.set says which
std::vector<std::string> notes_of(const Material& known, std::size_t index, const SetSpread& spread,
                                  std::size_t alike) {
  const PublishedCoefficients& set = known.coefficients[index];
  std::string taken = fmt::format("The coefficients are those of {}, set {} of {}: {} [{}]", known.name, index + 1,
                                  known.coefficients.size(), set.cutter, set.source);
  if (alike > 0 && known.coefficients.size() > 1) {
    taken += alike > 1 ? fmt::format(", of the {} that serve the cutter the one with the largest force", alike)
                       : std::string(", the one that serves the cutter best");
    taken += "; coefficients.set chooses another";
  }
  std::vector<std::string> notes = {taken + "."};
  if (set.tangential_range_n_per_m2) {
    notes.push_back(fmt::format("Over its tests the tangential one reaches from {} to {} N/mm^2.",
                                in_n_per_mm2((*set.tangential_range_n_per_m2)[0]),
                                in_n_per_mm2((*set.tangential_range_n_per_m2)[1])));
  }
  if (spread.sets > 1) {
    notes.push_back(fmt::format(
        "The {} sets of {} reach from {} to {} N/mm^2 tangentially: measure yours where it counts.", spread.sets,
        known.name, in_n_per_mm2(spread.tangential_n_per_m2[0]), in_n_per_mm2(spread.tangential_n_per_m2[1])));
  }
  return notes;
}

CoefficientTable from_published(const io::TomlFile& file, const std::string& key, const Material& known,
                                const CoefficientKeys& given, const CutAtHand& cut) {
  reject_any(file, {helix_key}, "goes with rake_deg, of orthogonal tests");
  const std::size_t index = chosen_set(file, key, known, given.set, cut.kind);
  const PublishedCoefficients& set = known.coefficients[index];
  CoefficientTable out;
  MillingCoefficients& k = out.coefficients;
  const std::optional<double> ratio = radial_ratio_of(file, key, known, set, given.radial_ratio);
  k = set.at(chip_of(file, set, given, cut));
  if (ratio) {
    k.radial_n_per_m2 = times(k.tangential_n_per_m2, *ratio);
    k.radial_edge_n_per_m = times(k.tangential_edge_n_per_m, *ratio);
  }
  const SetSpread spread = spread_of_sets(known);
  if (!set.is_power()) {
    const bool tests = set.tangential_std_n_per_m2 > 0.0;
    out.std_ratio = tests ? set.tangential_std_n_per_m2 / set.line.tangential_n_per_m2.front() : spread.std_ratio;
    out.std_of = tests ? "the tests of its source" : "the sets of its material";
  }
  out.notes = notes_of(known, index, spread, given.set ? 0 : sets_alike(known, cut.kind));
  if (set.kind && *set.kind != cut.kind) out.notes.emplace_back("Its tests had another kind of cutter than tool.kind.");
  out.published = set;
  return out;
}

/// @param key  that names it
CoefficientTable from_material(io::TomlFile& file, const std::string& key, const CoefficientKeys& given,
                               const CutAtHand& cut) {
  const Material& known = find_material(file, key, given.material);
  CoefficientTable out;
  if (given.rake_rad) {
    out.coefficients = from_orthogonal_tests(file, known, given);
    out.notes.push_back(fmt::format("The coefficients are those of {} by orthogonal tests [{}].", known.name,
                                    known.orthogonal->source));
  } else {
    out = from_published(file, key, known, given, cut);
  }
  out.material = known.name;
  out.conditions = known.conditions;
  return out;
}

std::string words_of(const FromTo& range, double factor) {
  return range[0] == range[1] ? fmt::format("{:.3g}", range[0] / factor)
                              : fmt::format("{:.3g} to {:.3g}", range[0] / factor, range[1] / factor);
}

/// A material's coefficients with those of the edge that the table gives in place of its own.
MillingCoefficients with_own_edge(MillingCoefficients material, const MillingCoefficients& own) {
  for (const ForceCoefficient& one : force_coefficients) {
    if (!(own.*one.values).empty()) material.*one.values = own.*one.values;
  }
  if (own.edge_measure != EdgeMeasure::by_kind) material.edge_measure = own.edge_measure;
  return material;
}

/// The table [coefficients].
CoefficientTable read_unscaled(io::TomlFile& file, const CoefficientKeys& given, const CutAtHand& cut) {
  const char* cutting = nullptr;  // a coefficient that the table itself gives
  const char* edge = nullptr;
  for (const ForceCoefficient& one : force_coefficients) {
    if (!(given.own.*one.values).empty()) (one.edge ? edge : cutting) = one.key;
  }
  if (!given.material.empty()) {
    if (cutting != nullptr) {
      throw file.reject("coefficients.material", fmt::format("must not stand beside {}", cutting),
                        "Edge coefficients may; they replace the material's");
    }
    if (!given.file.empty()) throw file.reject("coefficients.material", "must not stand beside a file");
    CoefficientTable out = from_material(file, "coefficients.material", given, cut);
    out.coefficients = with_own_edge(out.coefficients, given.own);
    return out;
  }
  reject_any(file, {"set", "radial_ratio", "chip_thickness_mm", "rake_deg", helix_key}, "goes with a material");
  CoefficientTable out{.coefficients = given.own};
  if (given.file.empty()) {
    file.require(
        "coefficients.tangential_n_per_mm2",
        "A number (aluminium is near 700), or a polynomial in the axial position angle (rad); or name a file or a "
        "material");
    return out;
  }
  if (cutting != nullptr || edge != nullptr || given.own.edge_measure != EdgeMeasure::by_kind) {
    throw file.reject("coefficients.file", "must not stand beside coefficients of its own");
  }
  out.coefficients = read_coefficients(given.file, out.notes);
  return out;
}

/// Harder or softer than the material or the file says.
void take_scale(const io::TomlFile& file, const CoefficientKeys& given, CoefficientTable& out) {
  const char* const key = "coefficients.scale";
  if (file.has(key) && given.material.empty() && given.file.empty()) {
    throw file.reject(key, "must stand beside a material or a file", "Numbers of one's own are given as they are");
  }
  if (given.scale == 1.0) return;
  for (const ForceCoefficient& one : force_coefficients) {
    for (double& value : out.coefficients.*one.values) value *= given.scale;
  }
  out.notes.push_back(fmt::format("All coefficients are taken times {:.4g}.", given.scale));
}

}  // namespace

bool names_a_material(const io::TomlFile& file) {
  // Of tables no value is shown.
  return file.has("coefficients") && !file.reject("coefficients", "").parts().value.empty();
}

std::vector<std::string> CoefficientTable::outside(const CutAtHand& cut) const {
  std::vector<std::string> out;
  if (!published) return out;
  const auto look = [&](const char* what, const char* unit, double factor, const std::optional<FromTo>& tested,
                        const FromTo& asked) {
    constexpr double rounding = 1e-3;
    if (!tested || !(asked[1] > 0.0)) return;
    if (asked[0] >= (1.0 - rounding) * (*tested)[0] && asked[1] <= (1.0 + rounding) * (*tested)[1]) return;
    out.push_back(
        fmt::format("{} of {} {} lies outside the tests of [{}], {} {}: the coefficients are taken to hold there "
                    "too.",
                    what, words_of(asked, factor), unit, published->source, words_of(*tested, factor), unit));
  };
  look("A cutting speed", "m/min", 1.0 / units::minute, published->tested_speed_m_per_s, cut.cutting_speed_m_per_s);
  look("A feed per tooth", "mm", units::mm, published->tested_feed_per_tooth_m,
       {cut.feed_per_tooth_m, cut.feed_per_tooth_m});
  look("A mean chip thickness", "mm", units::mm, published->tested_chip_m,
       {cut.mean_chip_thickness_m, cut.mean_chip_thickness_m});
  return out;
}

std::vector<std::string> CoefficientTable::unlike_recommended(const CutAtHand& cut) const {
  constexpr double m_per_min = 1.0 / units::minute;
  constexpr double far_off = 2.0;  // a source states one feed for roughing, of which a finish takes less
  std::vector<std::string> out;
  std::string speeds, feeds;
  double least_m = HUGE_VAL, most_m = 0.0;
  bool fast_or_slow = cut.cutting_speed_m_per_s[1] > 0.0;
  const auto add = [](std::string& list, const std::string& what, const std::string& source) {
    list += fmt::format("{}{} [{}]", list.empty() ? "" : ", ", what, source);
  };
  for (const CuttingConditions& entry : conditions) {
    if (entry.cutting_speed_m_per_s) {
      const FromTo& range = *entry.cutting_speed_m_per_s;
      add(speeds, words_of(range, m_per_min), entry.source);
      fast_or_slow =
          fast_or_slow && (cut.cutting_speed_m_per_s[1] < range[0] || cut.cutting_speed_m_per_s[0] > range[1]);
    }
    if (const std::optional<double> feed_m = entry.feed_at(cut.diameter_m)) {
      add(feeds, words_of({*feed_m, *feed_m}, units::mm), entry.source);
      least_m = std::min(least_m, *feed_m);
      most_m = std::max(most_m, *feed_m);
    }
  }
  if (!speeds.empty() && fast_or_slow) {
    out.push_back(fmt::format("A cutting speed of {} m/min is none that is recommended for {}: {} m/min.",
                              words_of(cut.cutting_speed_m_per_s, m_per_min), material, speeds));
  }
  const double feed_m = cut.feed_per_tooth_m;
  if (!feeds.empty() && feed_m > 0.0 && cut.diameter_m > 0.0 &&
      (feed_m < least_m / far_off || feed_m > most_m * far_off)) {
    out.push_back(fmt::format("A feed per tooth of {:.3g} mm is {} of what is recommended for {} at {:.3g} mm: {} mm.",
                              feed_m / units::mm, feed_m < least_m ? "less than half" : "more than twice", material,
                              cut.diameter_m / units::mm, feeds));
  }
  return out;
}

CoefficientTable read_coefficient_table(io::TomlFile& file, const CutAtHand& cut) {
  CoefficientKeys given;
  if (names_a_material(file) && file.text("coefficients", given.material)) {
    return from_material(file, "coefficients", given, cut);
  }
  coefficients_table().read(file, "coefficients", given);
  CoefficientTable out = read_unscaled(file, given, cut);
  take_scale(file, given, out);
  return out;
}

MillingCoefficients read_coefficients(const io::TomlSource& source, std::vector<std::string>& notes) {
  io::TomlFile file(source);
  if (file.has("coefficients.file")) throw file.reject("coefficients.file", "must not name a further file");
  CoefficientTable out = read_coefficient_table(file);
  for (const char* reported : {"identification", "source"}) file.skip(reported);
  std::ranges::move(out.notes, std::back_inserter(notes));
  std::ranges::move(file.done(), std::back_inserter(notes));
  return out.coefficients;
}

std::string coefficients_toml(const MillingCoefficients& coefficients) {
  std::string text = "[coefficients]\n";
  for (const ForceCoefficient& one : force_coefficients) {
    std::vector<double> values = coefficients.*one.values;
    if (values.empty()) continue;
    for (double& value : values) value /= io::key_unit(one.key).factor;
    text += values.size() == 1 ? fmt::format("{} = {:.10g}\n", one.key, values.front())
                               : fmt::format("{} = [{:.10g}]\n", one.key, fmt::join(values, ", "));
  }
  if (coefficients.edge_measure == EdgeMeasure::width) text += "edge_per = \"width\"\n";
  if (coefficients.edge_measure == EdgeMeasure::edge_length) text += "edge_per = \"edge-length\"\n";
  return text;
}

}  // namespace robomill::cutting
