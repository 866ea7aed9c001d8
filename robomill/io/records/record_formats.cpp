#include "robomill/io/records/record_formats.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/io/records/records.hpp"
#include "robomill/io/text.hpp"

namespace robomill::io {
namespace {

struct RecordEnding {
  std::string_view ending;
  RecordFormat format;
};
constexpr RecordEnding record_ending_list[] = {
    {".csv", RecordFormat::text},  {".txt", RecordFormat::text}, {".dat", RecordFormat::text},
    {".asc", RecordFormat::text},  {".uff", RecordFormat::uff},  {".unv", RecordFormat::uff},
    {".uf", RecordFormat::uff},    {".mat", RecordFormat::mat},  {".h5", RecordFormat::hdf5},
    {".hdf5", RecordFormat::hdf5}, {".hdf", RecordFormat::hdf5}, {".npy", RecordFormat::numpy},
    {".npz", RecordFormat::numpy}, {".lvm", RecordFormat::lvm},  {".tdms", RecordFormat::tdms},
    {".wav", RecordFormat::wav}};

constexpr std::string_view as_csv =
    "Export it as CSV with a column of time in s, or as a universal file (.uff); in N and m/s^2 where it can be chosen";
constexpr std::string_view save_as_csv =
    "Open it and save the sheet as CSV, with one line of names above the numbers and nothing below them";
constexpr std::string_view as_wav = "Convert it to WAV; a lossy one has lost what was measured: record it as WAV";

struct UnreadEnding {
  std::string_view ending, what, remedy;
};
constexpr UnreadEnding unread_endings[] = {
    {".tdm", "a LabVIEW TDM file", as_csv},      {".mf4", "an ASAM MDF file", as_csv},
    {".mdf", "an ASAM MDF file", as_csv},        {".dxd", "a Dewesoft file", as_csv},
    {".d7d", "a Dewesoft file", as_csv},         {".dwd", "a DynoWare file", as_csv},
    {".xls", "a spreadsheet", save_as_csv},      {".xlsx", "a spreadsheet", save_as_csv},
    {".ods", "a spreadsheet", save_as_csv},      {".flac", "a compressed sound file", as_wav},
    {".mp3", "a compressed sound file", as_wav}, {".m4a", "a compressed sound file", as_wav},
    {".ogg", "a compressed sound file", as_wav}};

}  // namespace

RecordFormat record_format_of(const std::filesystem::path& path) {
  const std::string ending = lowered(path.extension().string());
  const auto* const found = std::ranges::find(record_ending_list, ending, &RecordEnding::ending);
  return found == std::end(record_ending_list) ? RecordFormat::none : found->format;
}

bool is_read_as_record(const std::filesystem::path& path) {
  return record_format_of(path) != RecordFormat::none;
}

std::vector<std::string_view> record_endings() {
  std::vector<std::string_view> endings;
  for (const RecordEnding& each : record_ending_list) endings.push_back(each.ending);
  return endings;
}

std::string record_endings_text() {
  std::vector<std::string_view> endings = record_endings();
  const std::string_view last = endings.back();
  endings.pop_back();
  return fmt::format("{} and {}", fmt::join(endings, ", "), last);
}

UnreadRecord unread_record(const std::filesystem::path& path) {
  const std::string ending = lowered(path.extension().string());
  const auto* const found = std::ranges::find(unread_endings, ending, &UnreadEnding::ending);
  if (found == std::end(unread_endings)) return {};
  return {.what = fmt::format("{}, which is not read yet", found->what), .remedy = std::string(found->remedy)};
}

}  // namespace robomill::io
