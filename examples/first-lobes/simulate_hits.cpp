// simulate_hits DIRECTORY [MODES] [SEED]: ten hammer hits on the robot of data/robot-modes.toml, five in x and five in
// y, as CSV files with the hits.toml that `robomill frf` and `robomill plan` read.
#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "examples/first-lobes/hammer.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/system/append.hpp"
#include "robomill/modal/files/modes_files.hpp"

namespace {

using namespace robomill;

std::string column_of(const modal::HitChannel& channel) {
  return fmt::format("a{}_m_per_s2", modal::to_string(channel.dof));
}

std::string csv_of(const modal::Hit& hit) {
  fmt::memory_buffer text;
  io::append(text, "time_s,force_n");
  for (const modal::HitChannel& channel : hit.responses) {
    io::append(text, ",{}", column_of(channel));
  }
  text.push_back('\n');
  for (Eigen::Index j = 0; j < hit.force_n.size(); ++j) {
    io::append(text, "{:.9g},{:.4f}", static_cast<double>(j) / hit.sample_rate_hz, hit.force_n(j));
    for (const modal::HitChannel& channel : hit.responses) {
      io::append(text, ",{:.5f}", channel.samples(j));
    }
    text.push_back('\n');
  }
  return fmt::to_string(text);
}

std::string toml_of(const std::vector<modal::Hit>& hits, std::uint64_t seed) {
  std::string text = fmt::format(
      "# Hammer hits simulated by simulate_hits, seed {}.\n"
      "[acquisition]\n"
      "response = \"acceleration\"\n"
      "estimator = \"H1\"\n"
      "min_frequency_hz = 5\n"
      "max_frequency_hz = 1000\n",
      seed);
  for (const modal::Hit& hit : hits) {
    std::string responses;
    for (const modal::HitChannel& channel : hit.responses) {
      responses += fmt::format("{}{} = \"{}\"", responses.empty() ? "" : ", ", modal::to_string(channel.dof),
                               column_of(channel));
    }
    text += fmt::format(
        "\n[[hits]]\nfile = \"{}\"\ntime = \"time_s\"\nforce = \"force_n\"\nforce_direction = \"{}\"\n"
        "responses = {{ {} }}\n",
        hit.file, modal::to_string(hit.excitation), responses);
  }
  return text;
}

void run(const std::filesystem::path& directory, const std::filesystem::path& modes, std::uint64_t seed) {
  std::vector<std::string> notes;
  const modal::ModalModel model = modal::read_modes(modes, notes);
  for (const std::string& note : notes) fmt::print("{}\n", note);
  const std::vector<modal::Hit> hits = examples::simulate_hits(model, 5, 0.05, examples::Hammer{}, seed);
  std::filesystem::create_directories(directory);
  for (const modal::Hit& hit : hits) io::write_file(directory / hit.file, csv_of(hit));
  io::write_file(directory / "hits.toml", toml_of(hits, seed));
  fmt::print("{} hits in {}\n", hits.size(), directory.string());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || argc > 4) {
    std::fputs("usage: simulate_hits DIRECTORY [MODES] [SEED]\n", stderr);
    return 2;
  }
  try {
    std::uint64_t seed = 1;
    if (argc == 4) {
      const std::string_view text = argv[3];
      const std::from_chars_result number = std::from_chars(text.data(), text.data() + text.size(), seed);
      if (number.ec != std::errc() || number.ptr != text.data() + text.size()) {
        throw std::runtime_error(fmt::format("seed = {}; must be a whole number >= 0", text));
      }
    }
    run(argv[1], argc > 2 ? argv[2] : ROBOMILL_SOURCE_DIR "/data/robot-modes.toml", seed);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
