#include "robomill/monitor/files/machine_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/json.hpp"
#include "robomill/monitor/files/machine_schema.hpp"

namespace robomill::monitor {
namespace {

using io::key;
using io::Row;
using io::Schema;
using io::Use;

const Schema<LearntRow>& learnt_row_table() {
  static const Schema<LearntRow> table(
      "learnt_row", "what is there at a speed, in cells from 0 Hz on: the energy that one hop in a hundred exceeds",
      {key("rotation_hz", &LearntRow::rotation_hz, "of the spindle, the mean; 0: not known"),
       key("hops", &LearntRow::hops, "that it was learnt from"),
       key("beside", &LearntRow::beside, "beside the multiples of rotation [unit²]; empty: the speed is not known"),
       key("all", &LearntRow::all, "of everything [unit²]")},
      Use::written);
  return table;
}

const Schema<LearntTone>& learnt_tone_table() {
  static const Schema<LearntTone> table("learnt_tone", "a tone of the machine, of its drives or of the room",
                                        {key("frequency_hz", &LearntTone::frequency_hz, "the mean"),
                                         key("level", &LearntTone::level, "rms where it stands, all channels [unit]"),
                                         key("share", &LearntTone::share, "of the hops, in which it stands")},
                                        Use::written);
  return table;
}

const Schema<LearntKnocks>& learnt_knocks_table() {
  static const Schema<LearntKnocks> table(
      "learnt_knocks", "impulses",
      {key("per_minute", &LearntKnocks::per_minute, "how often").in_unit(),
       key("strongest", &LearntKnocks::strongest, "rms of a hop, all channels [unit]"),
       key("frequency_hz", &LearntKnocks::frequency_hz, "of what rings, median; 0: none"),
       key("decay_per_s", &LearntKnocks::decay_per_s, "of its amplitude, median; 0: not known").in_unit()},
      Use::written);
  return table;
}

constexpr int version = 1;

int whole(const io::JsonNode& node) {
  const double value = node.number();
  if (!(value >= 0.0 && value <= 2e9 && value == std::floor(value))) throw node.reject("must be a whole number >= 0");
  return static_cast<int>(value);
}

std::vector<double> energies(const io::JsonNode& node) {
  const Eigen::VectorXd all = node.numbers();
  return {all.begin(), all.end()};
}

LearntRow read_row(const io::JsonNode& node) {
  return {.rotation_hz = node.at("rotation_hz").number(),
          .hops = whole(node.at("hops")),
          .beside = energies(node.at("beside")),
          .all = energies(node.at("all"))};
}

/// What one sensor shows.
std::vector<Row<Machine>> sensor_keys() {
  return {key("sample_rate_hz", &Machine::sample_rate_hz, "of the recordings; streams must have it to 1 %"),
          key("channels", &Machine::channels, "of vibration; streams must have as many"),
          key("seconds", &Machine::seconds, "that were learnt"),
          key(
              "cell_hz", [](const Machine&) { return Machine::cell_hz; }, "width of the cells"),
          key("quietest_energy", &Machine::quietest_energy, "the least of all energy in 0.3 s [unit²]"),
          key("air", &Machine::air, learnt_row_table(), "where no speed was known, as in air"),
          key("rows", &Machine::rows, learnt_row_table(), "by rotation, rising"),
          key("tones", &Machine::tones, learnt_tone_table(), "the loudest first; for people to read"),
          key("knocks", &Machine::knocks, learnt_knocks_table(), "for people to read")};
}

const Schema<Machine>& other_sensor_table() {
  static const Schema<Machine> table("learnt_sensor", "what a further sensor shows without chatter", sensor_keys(),
                                     Use::written);
  return table;
}

Machine read_sensor(const io::JsonNode& node) {
  if (node.at("cell_hz").number() != Machine::cell_hz) {
    throw node.at("cell_hz").reject(fmt::format("must be {}", Machine::cell_hz), "Learn the machine anew");
  }
  const io::JsonNode knocks = node.at("knocks");
  Machine out{.sample_rate_hz = node.at("sample_rate_hz").number(),
              .channels = whole(node.at("channels")),
              .seconds = node.at("seconds").number(),
              .quietest_energy = node.at("quietest_energy").number(),
              .air = read_row(node.at("air")),
              .knocks = {.per_minute = knocks.at("per_minute").number(),
                         .strongest = knocks.at("strongest").number(),
                         .frequency_hz = knocks.at("frequency_hz").number(),
                         .decay_per_s = knocks.at("decay_per_s").number()}};
  const io::JsonNode rows = node.at("rows"), tones = node.at("tones");
  for (std::size_t i = 0; i < rows.size(); ++i) out.rows.push_back(read_row(rows.at(i)));
  for (std::size_t i = 0; i < tones.size(); ++i) {
    const io::JsonNode tone = tones.at(i);
    out.tones.push_back({.frequency_hz = tone.at("frequency_hz").number(),
                         .level = tone.at("level").number(),
                         .share = tone.at("share").number()});
  }
  return out;
}

std::string sensor_text(const Machine& machine) {
  std::string out = fmt::format("{:.3g} s learnt at {:.6g} Hz, {} channel{}: ", machine.seconds, machine.sample_rate_hz,
                                machine.channels, machine.channels == 1 ? "" : "s");
  if (machine.rows.empty()) {
    out += "no speed was known, as in air\n";
  } else {
    const auto rpm = [](const LearntRow& row) { return row.rotation_hz * units::revolution / units::rpm; };
    out += fmt::format("{} speed{} from {:.4g} to {:.4g} rpm{}\n", machine.rows.size(),
                       machine.rows.size() == 1 ? "" : "s", rpm(machine.rows.front()), rpm(machine.rows.back()),
                       machine.air.hops > 0 ? ", and air" : "");
  }
  constexpr std::size_t most_shown = 5;
  std::string tones;
  for (std::size_t i = 0; i < std::min(most_shown, machine.tones.size()); ++i) {
    const LearntTone& tone = machine.tones[i];
    tones += fmt::format("{}{:.4g} Hz (level {:.2g}, {:.0f} % of the time)", i > 0 ? ", " : "", tone.frequency_hz,
                         tone.level, 100.0 * tone.share);
  }
  if (machine.tones.size() > most_shown) tones += fmt::format(" and {} more", machine.tones.size() - most_shown);
  out += "tones: " + (tones.empty() ? "none" : tones) + "\n";
  const LearntKnocks& knocks = machine.knocks;
  if (knocks.per_minute <= 0.0) return out + "knocks: none\n";
  out += fmt::format("knocks: {:.2g} a minute, level up to {:.2g}, ringing at {:.4g} Hz", knocks.per_minute,
                     knocks.strongest, knocks.frequency_hz);
  return out + (knocks.decay_per_s > 0.0 ? fmt::format(" for {:.0f} ms\n", 1e3 / knocks.decay_per_s) : "\n");
}

}  // namespace

const Schema<Machine>& machine_table() {
  static const Schema<Machine> table(
      "machine", "what a machine shows without chatter, as robomill monitor --learn finds it",
      [] {
        std::vector<Row<Machine>> rows = sensor_keys();
        rows.push_back(key("others", &Machine::others, other_sensor_table(),
                           "what further sensors show, in the order of signal.sensors"));
        return rows;
      }(),
      Use::written, version);
  return table;
}

std::string machine_json(const Machine& machine) {
  machine.validate();
  return io::dump(machine_table().write(machine));
}

Machine read_machine(const std::filesystem::path& path) {
  const io::Json json = io::read_json(path);
  const io::JsonNode root(json, path.string());
  if (root.at("document").text() != machine_table().info().document()) {
    throw root.at("document")
        .reject(fmt::format("must be \"{}\"", machine_table().info().document()),
                "robomill monitor monitor.toml --learn air.wav,stable.wav -o machine.json writes it");
  }
  Machine out = read_sensor(root);
  if (root.has("others")) {
    const io::JsonNode others = root.at("others");
    for (std::size_t i = 0; i < others.size(); ++i) out.others.push_back(read_sensor(others.at(i)));
  }
  try {
    out.validate();
  } catch (const InvalidInput& error) {
    InvalidInput::Parts parts = error.parts();
    parts.where = path.string();
    throw InvalidInput(std::move(parts));
  }
  return out;
}

void load_machine(MonitorFile& file) {
  if (!file.machine.empty()) file.options.machine = std::make_shared<const Machine>(read_machine(file.machine));
}

std::string machine_text(const Machine& machine) {
  if (machine.sensors() == 1) return sensor_text(machine);
  std::string out;
  for (std::size_t s = 0; s < machine.sensors(); ++s) {
    out += fmt::format("sensor {}: {}", s + 1, sensor_text(machine.of_sensor(s)));
  }
  return out;
}

}  // namespace robomill::monitor
