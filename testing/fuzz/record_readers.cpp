#include <array>
#include <memory>
#include <string>
#include <vector>

#include "robomill/coupling/assembly.hpp"
#include "robomill/coupling/files/tools_csv.hpp"
#include "robomill/cutting/files/force_record.hpp"
#include "robomill/cutting/files/slots_csv.hpp"
#include "robomill/io/records/records.hpp"
#include "robomill/io/sample_source.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/modal/files/hit_files/bare_hits.hpp"
#include "robomill/serve/files/inspect.hpp"
#include "testing/fuzz/input.hpp"
#include "testing/fuzz/reader.hpp"

namespace robomill::fuzz {
namespace {

void read_record(const std::filesystem::path& file) {
  accept_or_reject([&] {
    const io::Record record = io::read_record(file);
    require(!record.columns.empty() && record.names.size() == record.columns.size(), "a record has named columns");
    require(record.units.empty() || record.units.size() == record.names.size(), "a unit a column, or none");
    for (const Eigen::VectorXd& column : record.columns) require(column.allFinite(), "samples are finite");
    require(record.sample_rate_hz >= 0.0, "a rate is known or 0");
  });
}

void read_frfs(const std::filesystem::path& file) {
  accept_or_reject([&] {
    const modal::FrfFile frfs = modal::read_frfs({file}, {});
    frfs.set.validate();
    static_cast<void>(modal::frf_json(frfs.set));
  });
}

void read_samples(const std::filesystem::path& file, io::RawFormat format = io::RawFormat::automatic) {
  accept_or_reject([&] {
    const std::unique_ptr<io::SampleSource> source = io::open_samples(file, {.channels = {"1", "2"}}, format);
    io::SampleBlock block;
    while (source->next(256, block)) require(block.samples.size() <= 512, "a block is as long as asked for");
  });
}

/// As the jobs read a record of any kind.
void read_any_record(const std::filesystem::path& file) {
  read_record(file);
  read_samples(file);
  accept_or_reject([&] { static_cast<void>(cutting::read_force_record(file)); });
  accept_or_reject([&] { static_cast<void>(modal::read_bare_hits({file})); });
  accept_or_reject([&] { static_cast<void>(serve::inspect(file)); });
}

void read_columns(std::string_view bytes) {
  const std::filesystem::path& file = file_of(bytes, ".csv");
  read_any_record(file);
  read_frfs(file);
  accept_or_reject([&] { static_cast<void>(cutting::read_slots(file)); });
  accept_or_reject([&] {
    std::vector<std::string> notes;
    static_cast<void>(coupling::read_tools(file, {}, notes));
  });
}

void read_uff(std::string_view bytes) {
  const std::filesystem::path& file = file_of(bytes, ".uff");
  read_any_record(file);
  read_frfs(file);
}

void read_mat(std::string_view bytes) {
  const std::filesystem::path& file = file_of(bytes, ".mat");
  read_any_record(file);
  read_frfs(file);
}

void read_raw(std::string_view bytes) {
  const std::filesystem::path& file = file_of(bytes, ".bin");
  read_samples(file, io::RawFormat::float32);
  read_samples(file, io::RawFormat::int16);
}

constexpr std::array<Reader, 10> all = {{
    {"columns", read_columns},
    {"maker_text", [](std::string_view bytes) { read_any_record(file_of(bytes, ".txt")); }},
    {"uff", read_uff},
    {"lvm", [](std::string_view bytes) { read_any_record(file_of(bytes, ".lvm")); }},
    {"tdms", [](std::string_view bytes) { read_any_record(file_of(bytes, ".tdms")); }},
    {"mat", read_mat},
    {"hdf5", [](std::string_view bytes) { read_any_record(file_of(bytes, ".h5")); }},
    {"numpy",
     [](std::string_view bytes) { read_any_record(file_of(bytes, bytes.starts_with("PK") ? ".npz" : ".npy")); }},
    {"wav", [](std::string_view bytes) { read_any_record(file_of(bytes, ".wav")); }},
    {"raw", read_raw},
}};

}  // namespace

std::span<const Reader> record_readers() {
  return all;
}

}  // namespace robomill::fuzz
