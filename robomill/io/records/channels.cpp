#include "robomill/io/records/channels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "robomill/base/error.hpp"
#include "robomill/io/usual_ranges.hpp"

namespace robomill::io {
namespace {

constexpr double same_rate = 1e-6;
constexpr double length_tolerance = 0.1;

bool is_usable(const FileChannel& channel) {
  return channel.fault.empty() && channel.samples > 0;
}

bool starts_with_it(const FileChannel& one, const FileChannel& other) {
  if (!one.start.is_known || !other.start.is_known) return true;
  return std::abs(other.start.after(one.start)) * one.sample_rate_hz <= 0.5;
}

/// Whether a channel can stand beside the one that a record is built around.
bool fits(const FileChannel& one, const FileChannel& other, ChannelLengths lengths) {
  if (!is_usable(other)) return false;
  const bool any = lengths == ChannelLengths::any;
  if (one.sample_rate_hz <= 0.0 || other.sample_rate_hz <= 0.0) {
    const bool neither = one.sample_rate_hz <= 0.0 && other.sample_rate_hz <= 0.0;
    return other.sample_rate_hz <= 0.0 && (other.samples == one.samples || (any && neither));
  }
  const double rates = std::abs(other.sample_rate_hz / one.sample_rate_hz - 1.0);
  const auto length = static_cast<double>(one.samples);
  return rates <= std::max(same_rate, one.rate_error + other.rate_error) && starts_with_it(one, other) &&
         (any || std::abs(static_cast<double>(other.samples) - length) < length_tolerance * length);
}

std::string reason(const FileChannel& channel, const FileChannel& rated) {
  std::string out = channel.name.empty() ? "a channel without a name (" : channel.name + " (";
  if (!channel.fault.empty()) return out + channel.fault + ")";
  if (channel.samples == 0) return out + "no samples)";
  if (channel.sample_rate_hz > 0.0) out += fmt::format("{:.6g} Hz, ", channel.sample_rate_hz);
  out += fmt::format("{} samples", channel.samples);
  if (channel.start.is_known && rated.start.is_known && !starts_with_it(rated, channel)) {
    const double later_s = channel.start.after(rated.start);
    out += fmt::format(", starts {:.6g} s {}", std::abs(later_s), later_s > 0.0 ? "later" : "earlier");
  }
  return out + ")";
}

}  // namespace

double ChannelStart::after(const ChannelStart& other) const {
  constexpr double day_s = 86400.0;
  return day_s * static_cast<double>(day - other.day) + (s - other.s);
}

ChannelsTogether channels_together(const std::vector<FileChannel>& channels, const std::string& file,
                                   ChannelLengths lengths) {
  if (channels.size() > most_channels) {
    throw InvalidInput(file, fmt::format("holds {} channels, and at most {} are read", channels.size(), most_channels));
  }
  ChannelsTogether out;
  double most = 0.0;
  // Where lengths say nothing, a channel without a rate is none to build on beside one that has it.
  const bool any_rated =
      lengths == ChannelLengths::any && std::ranges::any_of(channels, [](const FileChannel& channel) {
        return is_usable(channel) && channel.sample_rate_hz > 0.0;
      });
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (!is_usable(channels[i]) || (any_rated && channels[i].sample_rate_hz <= 0.0)) continue;
    double held = 0.0;
    for (const FileChannel& other : channels) {
      if (fits(channels[i], other, lengths)) held += static_cast<double>(other.samples);
    }
    if (held <= most) continue;
    most = held;
    out.rated = i;
  }
  const FileChannel none;
  const FileChannel& rated = channels.empty() ? none : channels[out.rated];
  out.samples = rated.samples;
  for (std::size_t i = 0; most > 0.0 && i < channels.size(); ++i) {
    const bool follows = channels[i].sample_rate_hz <= 0.0 && channels[i].samples == rated.samples;
    if (!is_usable(channels[i]) || (!follows && !fits(rated, channels[i], lengths))) continue;
    out.places.push_back(i);
    out.samples = lengths == ChannelLengths::any ? std::max(out.samples, channels[i].samples)
                                                 : std::min(out.samples, channels[i].samples);
  }
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (!std::ranges::binary_search(out.places, i)) out.left_out.push_back(reason(channels[i], rated));
  }
  if (!out.places.empty()) return out;
  if (channels.empty()) throw InvalidInput(file, "holds no channel");
  throw InvalidInput(file, "holds no channel that can be read as a record: " + first_of(out.left_out, "; "),
                     "A record is numbers at a constant rate: export one");
}

void take_channels(Record& record, const std::vector<FileChannel>& channels, const ChannelsTogether& taken) {
  const FileChannel& rated = channels[taken.rated];
  record.sample_rate_hz = rated.sample_rate_hz;
  record.rate_error = rated.rate_error;
  std::uint64_t longest = 0;
  for (const std::size_t place : taken.places) {
    record.names.push_back(channels[place].name);
    record.units.push_back(channels[place].unit);
    longest = std::max(longest, channels[place].samples);
  }
  const std::string file = record.file.string();
  if (longest > taken.samples) {
    record.notes.push_back(fmt::format("{}{}: the channels have {} to {} samples: cut to the first {} of all",
                                       warning_label, file, taken.samples, longest, taken.samples));
  }
  record.left_out = taken.left_out;
  if (taken.left_out.empty()) return;
  const std::string rate =
      rated.sample_rate_hz > 0.0 ? fmt::format(" at {:.6g} Hz", rated.sample_rate_hz) : std::string();
  record.notes.push_back(fmt::format("{}: {} of its {} channels are read{}; left out: {}", file, taken.places.size(),
                                     channels.size(), rate, first_of(taken.left_out, ", ")));
}

std::string first_of(const std::vector<std::string>& texts, std::string_view separator) {
  constexpr std::size_t most = 6;
  std::string out = fmt::format(
      "{}",
      fmt::join(texts.begin(), texts.begin() + static_cast<std::ptrdiff_t>(std::min(most, texts.size())), separator));
  return texts.size() > most ? out + fmt::format(" and {} more", texts.size() - most) : out;
}

}  // namespace robomill::io
