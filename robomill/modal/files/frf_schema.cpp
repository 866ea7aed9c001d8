#include "robomill/modal/files/frf_schema.hpp"

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace robomill::modal {
namespace {

using io::add_rows;
using io::key;
using io::keys_of;
using io::Row;
using io::Schema;
using io::Use;

template <class Value>
using ByFrf = std::vector<std::pair<std::string, Value>>;

const Schema<Eigen::VectorXcd>& parts_table() {
  static const Schema<Eigen::VectorXcd> table(
      "complex_numbers", "complex numbers, one a line",
      {key(
           "re", [](const Eigen::VectorXcd& values) { return Eigen::VectorXd(values.real()); }, "real parts")
           .exact(),
       key(
           "im", [](const Eigen::VectorXcd& values) { return Eigen::VectorXd(values.imag()); }, "imaginary parts")
           .exact()},
      Use::written);
  return table;
}

const Schema<FrfPeak>& frf_peak_table() {
  static const Schema<FrfPeak> table("frf_peak", "a resonance in the magnitude of an FRF",
                                     {key("frequency_hz", &FrfPeak::frequency_hz, "where"),
                                      key("receptance_m_per_n", &FrfPeak::receptance_m_per_n, "magnitude")},
                                     Use::written);
  return table;
}

const Schema<FrfGrade>& grade_table() {
  static const Schema<FrfGrade> table(
      "frf_grade", "how far an FRF is to be trusted",
      {key(
           "grade", [](const FrfGrade& grade) { return to_string(grade.grade); }, "by the worst of its faults")
           .words({"good", "usable", "poor"}),
       key("hits", &FrfGrade::hits, "averaged"),
       key("mean_coherence", &FrfGrade::mean_coherence, "over the band; none: of one hit").nullable(),
       key("relative_noise", &FrfGrade::relative_noise, "median of deviation / |H| over the band").nullable(),
       key("reciprocity_error", &FrfGrade::reciprocity_error, "‖H_xy − H_yx‖ over their mean norm").nullable(),
       key(
           "excited_band_hz",
           [](const FrfGrade& grade) {
             return std::array{grade.excited_low_hz, grade.excited_high_hz};
           },
           "that the hammer excites: force within 20 dB of its highest")
           .nullable()
           .entries(2),
       key("lowest_trustworthy_frequency_hz", &FrfGrade::lowest_trustworthy_frequency_hz, "below it noise rules")
           .nullable(),
       key("peaks", &FrfGrade::peaks, frf_peak_table(), "the six highest in the trustworthy band"),
       key("faults", &FrfGrade::faults, "sentences for the user"), key("remedies", &FrfGrade::remedies, "one a fault")},
      Use::written);
  return table;
}

const Schema<HitVerdict>& judged_hit_table() {
  static const Schema<HitVerdict> table(
      "hit", "a hit of the hammer",
      {key("file", &HitVerdict::file, "of its record"), key("accepted", &HitVerdict::accepted, "it counts"),
       key("reasons", &HitVerdict::reasons, "why it was rejected"),
       key("peak_force_n", &HitVerdict::peak_force_n, "of the pulse").nullable(),
       key("pulse_width_s", &HitVerdict::pulse_width_s, "at half its peak").nullable(),
       key("second_pulse_ratio", &HitVerdict::second_pulse_ratio, "highest further pulse over the first").nullable()},
      Use::written);
  return table;
}

std::vector<Row<FrfResult>> hits_keys() {
  return {key("hits", &FrfResult::hits, judged_hit_table(), "each with its verdict"),
          key(
              "grades",
              [](const FrfResult& result) {
                ByFrf<FrfGrade> out;
                for (const FrfGrade& grade : result.grades) out.emplace_back(to_string(grade.name), grade);
                return out;
              },
              grade_table(), "by the FRF's name"),
          key("lowest_trustworthy_frequency_hz", &FrfResult::lowest_trustworthy_frequency_hz,
              "above it every FRF is ruled by the structure")
              .nullable(),
          key(
              "added_decay_per_s",
              [](const FrfResult& result) { return result.added_decay_removed ? 0.0 : result.added_decay_per_s; },
              "by the exponential window, which the FRFs still have")};
}

/// A list of each FRF that has one.
Row<FrfView> known_of(const std::string& name, Eigen::VectorXd Frf::*member, const std::string& meaning) {
  return key(
             name,
             [member](const FrfView& view) {
               ByFrf<Eigen::VectorXd> out;
               for (const Frf& frf : view.set->frfs) {
                 if ((frf.*member).size() > 0) out.emplace_back(to_string(frf.name), frf.*member);
               }
               return out;
             },
             meaning)
      .exact()
      .nullable();
}

/// What is known of predicted FRFs alone.
template <class M>
Row<FrfView> doubt(const std::string& name, M FrfDoubts::*member, const std::string& meaning) {
  return where([](const FrfView& view) { return view.doubts != nullptr; },
               key(
                   name, [member](const FrfView& view) { return view.doubts->*member; }, meaning)
                   .exact());
}

}  // namespace

const Schema<FrfResult>& hits_table() {
  static const Schema<FrfResult> table(
      "hits", "the hits that FRFs were averaged from",
      [] {
        std::vector<Row<FrfResult>> rows = hits_keys();
        rows.push_back(key("notes", &FrfResult::notes, "sentences for the user"));
        return rows;
      }(),
      Use::written);
  return table;
}

const Schema<FrfView>& frf_table() {
  static const Schema<FrfView> table(
      "frf", "frequency response functions",
      [] {
        std::vector<Row<FrfView>> rows = {
            key(
                "frequency_hz", [](const FrfView& view) { return view.set->frequency_hz; }, "of the lines")
                .exact(),
            key(
                "receptance_m_per_n",
                [](const FrfView& view) {
                  ByFrf<Eigen::VectorXcd> out;
                  for (const Frf& frf : view.set->frfs) out.emplace_back(to_string(frf.name), frf.receptance);
                  return out;
                },
                parts_table(), "by the FRF's name, response then force"),
            known_of("coherence", &Frf::coherence, "of each FRF, where known"),
            known_of("deviation_m_per_n", &Frf::deviation, "standard deviation of each FRF, where known")};
        for (Row<FrfView>& row :
             keys_of<FrfView>(hits_keys(), [](const FrfView& view) -> const FrfResult& { return *view.hits; })) {
          rows.push_back(where([](const FrfView& view) { return view.hits != nullptr; }, std::move(row)));
        }
        add_rows(
            rows,
            {doubt("suspect_hz", &FrfDoubts::suspect_hz, "lines where the measured holder would create energy"),
             doubt("unreliable_hz", &FrfDoubts::unreliable_hz,
                   "lines where an error of the holder's measurement becomes a large one"),
             where([](const FrfView& view) { return view.hits != nullptr || view.doubts != nullptr; },
                   key(
                       "notes",
                       [](const FrfView& view) { return view.hits != nullptr ? view.hits->notes : view.doubts->notes; },
                       "sentences for the user")),
             where([](const FrfView& view) { return view.doubts != nullptr; },
                   key(
                       "assumed", [](const FrfView& view) { return view.doubts->assumed; }, io::assumption_table(),
                       "what the input did not give"))});
        return rows;
      }(),
      Use::written, 1);
  return table;
}

}  // namespace robomill::modal
