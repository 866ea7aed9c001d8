#include "robomill/stability/files/peak_classification_json.hpp"

#include <utility>
#include <vector>

#include "robomill/io/csv.hpp"
#include "robomill/modal/files/mode_schema.hpp"

namespace robomill::stability {
namespace {

using io::add_rows;
using io::key;
using io::keys_of;
using io::Row;
using io::Schema;
using io::Use;

/// The keys of a reading, in their order; `kind` stands before them.
std::vector<Row<Explanation>> place_keys() {
  return {key("rotations", &Explanation::harmonic, "n of f = |f_k + n f_rotation|"),
          key("mirrored", &Explanation::mirrored, "f_k + n f_rotation is negative"),
          key("of_tooth_passing", &Explanation::of_tooth_passing, "n is a multiple of the teeth")};
}
std::vector<Row<Explanation>> distance_keys() {
  return {where([](const Explanation& e) { return e.mode.known(); },
                key("mode_frequency_hz", &Explanation::mode_frequency_hz, "natural frequency of that mode")),
          key("expected_hz", &Explanation::expected_hz, "what n, the speed and the mode give"),
          key("difference_hz", &Explanation::difference_hz, "peak less that"),
          key("tolerance_hz", &Explanation::tolerance_hz, "that was allowed"),
          key("likelihood_per_hz", &Explanation::likelihood_per_hz, "density of a peak that scatters by half of it")};
}

const Schema<Explanation>& reading_table() {
  static const Schema<Explanation> table(
      "reading", "one way to read a peak",
      [] {
        std::vector<Row<Explanation>> rows = {key("kind", &Explanation::kind, explanation_names, "what the peak is")};
        add_rows(rows, place_keys());
        add_rows(rows, modal::mode_keys<Explanation>("that vibrates"));
        add_rows(rows, distance_keys());
        return rows;
      }(),
      Use::written);
  return table;
}

const Schema<ExplainedPeak>& peak_table() {
  static const Schema<ExplainedPeak> table(
      "peak", "a peak; that of which no reading is named has its kind alone",
      [] {
        const auto named = [](const ExplainedPeak& peak) { return peak.state == ExplainedPeak::State::named; };
        const auto best = [](const ExplainedPeak& peak) -> const Explanation& { return peak.best; };
        std::vector<Row<ExplainedPeak>> rows = {
            key("frequency_hz", &ExplainedPeak::frequency_hz, "of the peak"),
            key("state", &ExplainedPeak::state, peak_state_names, "whether one meaning is clearly the likeliest"),
            key(
                "kind", [](const ExplainedPeak& peak) { return peak.best.kind; }, explanation_names, "what it is")};
        const auto add_named = [&](const std::vector<Row<Explanation>>& keys) {
          for (Row<ExplainedPeak>& row : keys_of<ExplainedPeak>(keys, best))
            rows.push_back(where(named, std::move(row)));
        };
        add_named(place_keys());
        add_rows(rows, keys_of<ExplainedPeak>(
                           modal::mode_keys<Explanation>("that vibrates"),
                           [named](const ExplainedPeak& peak) { return named(peak) ? peak.best : Explanation(); }));
        add_named(distance_keys());
        rows.push_back(key("chatter_frequency_hz", &ExplainedPeak::chatter_frequency_hz,
                           "of the vibration itself: the peak less its multiple of rotation")
                           .nullable());
        rows.push_back(key("others", &ExplainedPeak::others, reading_table(), "the likeliest first"));
        return rows;
      }(),
      Use::written);
  return table;
}

const Schema<ChatterMechanism>& mechanism_table() {
  static const Schema<ChatterMechanism> table(
      "mechanism", "whether chatter needs the wave of the tooth before",
      [] {
        std::vector<Row<ChatterMechanism>> rows = {
            key("kind", &ChatterMechanism::kind, mechanism_names, "of the chatter"),
            key("spectral_radius", &ChatterMechanism::spectral_radius, "of one period").nullable(),
            key("spectral_radius_without_delay", &ChatterMechanism::without_delay, "the same without the wave")
                .nullable(),
            key("chatter_frequency_hz", &ChatterMechanism::chatter_frequency_hz, "of the cut with the wave")
                .nullable()};
        add_rows(rows, modal::mode_keys<ChatterMechanism>("that moves most"));
        return rows;
      }(),
      Use::written);
  return table;
}

}  // namespace

const Schema<PeaksView>& explain_table() {
  static const Schema<PeaksView> table(
      "explain", "what the peaks of a cut are",
      [] {
        std::vector<Row<PeakClassification>> rows = {
            key("spindle_speed_rpm", &PeakClassification::spindle_speed_rad_per_s, "that the peaks agree on"),
            key("speed_from_peaks", &PeakClassification::speed_from_peaks, "not the commanded speed"),
            key("peaks", &PeakClassification::peaks, peak_table(), "each with its reading"),
            key("state", &PeakClassification::state, classification_names, "whether the mode that chatters is named")};
        add_rows(rows, modal::mode_keys<PeakClassification>("that chatters"));
        rows.push_back(
            key("chatter_frequency_hz", &PeakClassification::chatter_frequency_hz, "mean of the peaks that name it")
                .nullable());
        std::vector<Row<PeaksView>> all =
            keys_of<PeaksView>(rows, [](const PeaksView& view) -> const PeakClassification& { return *view.peaks; });
        all.push_back(
            key("chatter", &PeaksView::mechanism, mechanism_table(), "of the cut, where one was given").nullable());
        return all;
      }(),
      Use::written, 1);
  return table;
}

std::string peak_classification_json(const PeakClassification& classification, const ChatterMechanism* mechanism) {
  return io::dump(explain_table().write({.peaks = &classification, .mechanism = mechanism}));
}

std::string peaks_csv(const PeakClassification& classification) {
  using io::csv_number;
  std::string out =
      "frequency_hz,state,kind,rotations,mirrored,of_tooth_passing,mode,mode_of,mode_frequency_hz,expected_hz,"
      "difference_hz,tolerance_hz,chatter_frequency_hz,other_readings\n";
  for (const ExplainedPeak& peak : classification.peaks) {
    const Explanation& e = peak.best;
    const bool named = peak.state == ExplainedPeak::State::named;
    const bool moded = named && e.mode.known();
    const auto where_named = [named](std::string cell) { return named ? std::move(cell) : std::string(); };
    io::add_csv_row(out,
                    {csv_number(peak.frequency_hz), std::string(to_string(peak.state)), std::string(to_string(e.kind)),
                     where_named(std::to_string(e.harmonic)), where_named(e.mirrored ? "true" : "false"),
                     where_named(e.of_tooth_passing ? "true" : "false"), moded ? std::to_string(e.mode.number) : "",
                     moded ? std::string(to_string(e.mode.of)) : "", moded ? csv_number(e.mode_frequency_hz) : "",
                     where_named(csv_number(e.expected_hz)), where_named(csv_number(e.difference_hz)),
                     where_named(csv_number(e.tolerance_hz)), csv_number(peak.chatter_frequency_hz),
                     std::to_string(peak.others.size())});
  }
  return out;
}

}  // namespace robomill::stability
