#include "robomill/io/records/tree/tree_words.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <iterator>
#include <utility>

#include "robomill/io/si.hpp"

namespace robomill::io {
namespace {

constexpr std::string_view rate_words[] = {"fs",
                                           "rate",
                                           "samplerate",
                                           "samplingrate",
                                           "samplefrequency",
                                           "samplingfrequency",
                                           "samplefreq",
                                           "samplingfreq",
                                           "srate",
                                           "sfreq",
                                           "fsample",
                                           "fsampling",
                                           "abtastrate",
                                           "abtastfrequenz",
                                           "samplespersecond",
                                           "sps"};
constexpr std::string_view step_words[] = {
    "dt",         "deltat",         "deltax",           "ts",           "xincrement",     "increment", "wfincrement",
    "sampletime", "sampleinterval", "samplinginterval", "sampleperiod", "samplingperiod", "timestep",  "timeinterval"};
constexpr std::string_view time_words[] = {"time", "t", "zeit", "times", "timestamp", "timestamps", "timevector"};
constexpr std::string_view values_words[] = {"values", "value", "data", "y", "ydata", "yvalues", "signal", "samples"};
constexpr std::string_view unit_text_words[] = {"unit", "units", "unitstring", "yunit", "yunits", "einheit"};
constexpr std::string_view names_words[] = {"names",   "channels",    "channelnames", "labels",
                                            "columns", "columnnames", "channellabels"};
constexpr std::string_view label_words[] = {"label", "name", "title", "longname", "channelname", "signalname"};
constexpr std::string_view scale_words[] = {"sensitivity", "calibration", "calibrationfactor", "scale", "scalefactor",
                                            "gain",        "offset"};

template <std::size_t n>
bool is_one_of(const std::string_view (&words)[n], std::string_view word) {
  return std::ranges::find(words, word) != std::end(words);
}

template <std::size_t n>
bool is_word_of(const std::string_view (&words)[n], std::string_view key) {
  return is_one_of(words, plain_word(key));
}

}  // namespace

std::string plain_word(std::string_view key) {
  std::string out;
  for (const char letter : key) {
    const auto byte = static_cast<unsigned char>(letter);
    if (std::isalnum(byte) != 0) out += static_cast<char>(std::tolower(byte));
  }
  return out;
}

RateWord rate_word(std::string_view key) {
  const std::string word = plain_word(key);
  constexpr std::array<std::pair<std::string_view, double>, 3> of_rates = {{{"", 1.0}, {"khz", 1e3}, {"hz", 1.0}}};
  for (const auto& [unit, factor] : of_rates) {
    const bool ends = word.size() > unit.size() && word.ends_with(unit);
    if (ends && is_one_of(rate_words, std::string_view(word).substr(0, word.size() - unit.size()))) {
      return {.kind = RateWord::Kind::rate, .factor = factor};
    }
  }
  constexpr std::array<std::pair<std::string_view, double>, 4> of_steps = {
      {{"", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"s", 1.0}}};
  for (const auto& [unit, factor] : of_steps) {
    const bool ends = word.size() > unit.size() && word.ends_with(unit);
    if (ends && is_one_of(step_words, std::string_view(word).substr(0, word.size() - unit.size()))) {
      return {.kind = RateWord::Kind::step, .factor = factor};
    }
  }
  return {};
}

double time_word(std::string_view key) {
  const std::string word = plain_word(key);
  if (is_one_of(time_words, word)) return 1.0;
  const std::string unit = unit_of_column(key);
  const double s = unit.empty() ? 0.0 : seconds_in(unit);
  const std::string of_unit = plain_word(unit);
  if (s == 0.0 || !word.ends_with(of_unit) || word.size() == of_unit.size()) return 0.0;
  return is_one_of(time_words, std::string_view(word).substr(0, word.size() - of_unit.size())) ? s : 0.0;
}

bool is_values_word(std::string_view key) {
  return is_word_of(values_words, key);
}

bool is_unit_word(std::string_view key) {
  return is_word_of(unit_text_words, key);
}

bool is_names_word(std::string_view key) {
  return is_word_of(names_words, key);
}

bool is_label_word(std::string_view key) {
  return is_word_of(label_words, key);
}

bool is_scale_word(std::string_view key) {
  return is_word_of(scale_words, key);
}

}  // namespace robomill::io
