#include "robomill/serve/files/kind.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <complex>
#include <fstream>
#include <optional>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/json.hpp"
#include "robomill/io/records/mat.hpp"
#include "robomill/io/records/records.hpp"
#include "robomill/io/table.hpp"
#include "robomill/io/text.hpp"
#include "robomill/jobs/files/schemas.hpp"
#include "robomill/modal/files/frf_check.hpp"
#include "robomill/stability/files/chart_schema.hpp"

namespace robomill::serve {
namespace {

constexpr std::size_t peeked_bytes = 1 << 16;
constexpr std::size_t fewest_rows = 3;  // of numbers, that a text is a table and not prose with a number in it

/// The beginning of a file; empty where it cannot be read.
struct Beginning {
  std::string text;
  bool whole = true;
};

Beginning peek(const std::filesystem::path& path) {
  Beginning out;
  std::ifstream in;
  try {
    in = io::open_file(path);
  } catch (const InvalidInput&) {
    return out;
  }
  out.text.resize(peeked_bytes);
  in.read(out.text.data(), static_cast<std::streamsize>(out.text.size()));
  out.text.resize(static_cast<std::size_t>(in.gcount()));
  out.whole = out.text.size() < peeked_bytes;
  return out;
}

bool has_line(std::string_view text, std::string_view begins) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    if (io::trimmed(text.substr(at, end - at)).starts_with(begins)) return true;
    at = end + 1;
  }
  return false;
}

/// A document by names that stand in it, near its beginning: keys of a JSON file, columns of a table. The first that
/// fits counts.
struct Signature {
  std::vector<std::string_view> names;
  std::string_view kind, document = {};
};

FileKind kind_by(const std::vector<Signature>& signatures, const std::vector<std::string>& names) {
  const auto is_there = [&names](std::string_view name) { return std::ranges::find(names, name) != names.end(); };
  for (const Signature& one : signatures) {
    if (std::ranges::all_of(one.names, is_there)) return {std::string(one.kind), std::string(one.document)};
  }
  return {};
}

/// Collects the keys of the outermost object, as far as the text goes, and what it says that it is.
class Keys final : public nlohmann::json_sax<io::Json> {
 public:
  std::vector<std::string> names = {};
  std::string document = {};  ///< "lobes/1"

  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t& text) override {
    if (depth_ == 1 && names.back() == "document") document = text;
    return true;
  }
  bool binary(binary_t&) override { return true; }
  bool start_object(std::size_t) override { return open(); }
  bool end_object() override { return close(); }
  bool start_array(std::size_t) override { return open(); }
  bool end_array() override { return close(); }
  bool key(string_t& name) override {
    if (depth_ == 1) names.push_back(name);
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override { return false; }

 private:
  bool open() {
    ++depth_;
    return true;
  }
  bool close() {
    --depth_;
    return true;
  }
  int depth_ = 0;
};

/// By the name that a document has: "lobes/1". A sweep and a comparison of methods are shown as lobes are.
FileKind kind_of_document(std::string_view document) {
  const std::string name(document.substr(0, document.find('/')));
  const std::vector<std::string>& known = jobs::schema_names();
  if (std::ranges::find(known, name + ".json") == known.end()) return {};
  if (name == "frf" || name == "modes") return {.kind = name};
  return {.kind = "result", .document = name == "sweep" || name == "comparison" ? "lobes" : name};
}

FileKind kind_of_json(const std::string& text) {
  static const std::vector<Signature> documents = {{{"title", "created"}, "report"},
                                                   {{"coefficients", "identification"}, "result", "coefficients"},
                                                   {{"postures", "placement"}, "result", "check"},
                                                   {{"tools"}, "result", "tools"}};
  Keys keys;
  io::Json::sax_parse(text, &keys, nlohmann::json::input_format_t::json, false);
  if (!keys.document.empty()) return kind_of_document(keys.document);
  FileKind known = kind_by(documents, keys.names);
  if (known.kind != "other" || keys.names.empty()) return known;
  // FRFs and modes may be written by others, who do not name the document.
  const std::string& first = keys.names.front();
  if (first == "frequency_hz" || first == "receptance_m_per_n") return {.kind = "frf"};
  if (first == "modes" && text.find("\"right\"") != std::string::npos) return {.kind = "modes"};
  return known;
}

/// The names of the columns, of the first line that is no comment.
std::vector<std::string> header_of(std::string_view text) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (io::is_table_comment(line)) continue;
    std::vector<std::string> names = io::split_texts(line, io::separator_of(line));
    for (std::string& name : names) name = io::lowered(io::trimmed(name));
    return names;
  }
  return {};
}

/// Whether columns without names are a frequency, then pairs of real and imaginary parts: what the reader of FRFs
/// would take them for. A record's pulse is larger, its time steps are smaller.
bool holds_frfs(const io::Table& table) {
  constexpr std::size_t fewest_lines = 16;  // that say something
  constexpr double largest_m_per_n = 1e-2;
  const std::vector<std::vector<double>>& columns = table.columns;
  const bool unnamed = std::ranges::all_of(table.names, [](const std::string& name) { return name.empty(); });
  if (!unnamed || columns.size() < 3 || columns.size() % 2 == 0 || columns[0].size() < fewest_lines) return false;
  const auto vector = [&](std::size_t i) {
    return Eigen::VectorXd(
        Eigen::Map<const Eigen::VectorXd>(columns[i].data(), static_cast<Eigen::Index>(columns[i].size())));
  };
  modal::FrfParts parts{.file = {}, .frequency_hz = vector(0)};
  const Eigen::VectorXd even =
      Eigen::VectorXd::LinSpaced(parts.frequency_hz.size(), columns[0].front(), columns[0].back());
  const double step_hz = even(1) - even(0);
  const bool steady = step_hz > 0.0 && (parts.frequency_hz - even).cwiseAbs().maxCoeff() < 0.5 * step_hz;
  if (columns[0].front() < 0.0 || !steady) return false;
  for (std::size_t i = 1; i < columns.size(); i += 2) {
    modal::FrfPart frf{.values = vector(i).cast<std::complex<double>>(), .stated = false};
    frf.values.imag() = vector(i + 1);
    if (!(frf.values.cwiseAbs().maxCoeff() < largest_m_per_n)) return false;
    parts.frfs.push_back(std::move(frf));
  }
  modal::require_frequencies(parts.frequency_hz, {});
  modal::check_content(parts);
  return true;
}

/// Numbers in columns, as the readers of records and FRFs take them.
std::string kind_of_table(const Beginning& file) {
  std::string_view text = file.text;
  if (!file.whole) text = text.substr(0, text.find_last_of("\r\n") + 1);  // the last line may be a part of one
  std::optional<io::Table> table;
  std::vector<std::string> unread;
  try {
    table = io::parse_table(text, {}, unread);
    if (table->columns.front().size() < fewest_rows) return "other";
    return holds_frfs(*table) ? "frf" : "record";
  } catch (const InvalidInput&) {
    return table ? "record" : "other";
  }
}

/// FRFs have a name of their own there. A long file is a record: to look at it would take longer than a list may, as
/// would the libraries of a damaged one.
std::string kind_of_mat(const std::filesystem::path& path) {
  constexpr std::size_t longest_bytes = std::size_t{1} << 20;
  return io::mat_seems_to_have(path, "frequency_hz", longest_bytes) ? "frf" : "record";
}

FileKind kind_of_text(const Beginning& file) {
  using stability::SweptParameter;
  static const std::array<std::string, 3> ranges = {"from_" + stability::swept_key(SweptParameter::radial_depth),
                                                    "from_" + stability::swept_key(SweptParameter::lead),
                                                    "from_" + stability::swept_key(SweptParameter::tilt)};
  static const std::vector<Signature> tables = {
      {{"block", "line", "spectral_radius"}, "result", "blocks"},
      {{"block", "line", "mean_fx_n"}, "result", "forces"},
      {{"rotation_deg", "fx_n", "torque_n_m"}, "result", "forces"},
      {{"time_s", "q1", "block"}, "result", "trajectory"},
      {{"time_s", "x_m", "ax_m_per_s2", "fx_n"}, "result", "vibration"},
      {{"frequency_hz", "state", "kind"}, "result", "explain"},
      {{"mode", "frequency_hz", "damping_ratio"}, "result", "modes"},
      {{"parameter", "value", "identifiable"}, "result", "joint"},
      {{"spindle_speed_rpm", "coefficient", "value"}, "result", "coefficients"},
      {{"joint", "stiffness", "identifiable"}, "result", "stiffness"},
      {{"tool", "overhang_mm", "peak_hz"}, "result", "tools"},
      {{"method", "lowest_limit_mm"}, "result", "lobes"},
      {{"spindle_speed_rpm", "chatter_frequency_hz"}, "result", "lobes"},
      {{"spindle_speed_rpm", "dominant_frequency_hz"}, "result", "lobes"},
      {{"spindle_speed_rpm", ranges[0]}, "result", "lobes"},
      {{"spindle_speed_rpm", ranges[1]}, "result", "lobes"},
      {{"spindle_speed_rpm", ranges[2]}, "result", "lobes"},
      {{"tool", "length_mm", "diameter_mm"}, "tools"},
      {{"feed_per_tooth_mm", "axial_depth_mm", "fx_n"}, "slots"},
      {{"dx_mm", "dy_mm", "dz_mm", "fx_n"}, "loads"},
      {{"x_mm", "y_mm", "z_mm", "feed_mm_per_min"}, "program"},
      {{"frequency_hz"}, "frf"}};
  FileKind known = kind_by(tables, header_of(file.text));
  if (known.kind == "other") known.kind = kind_of_table(file);
  return known;
}

/// A trajectory of robomill states its period near its beginning.
FileKind kind_of_hdf5(const Beginning& file) {
  if (file.text.find("sample_period_s") == std::string::npos) return {.kind = "record"};
  return {.kind = "result", .document = "trajectory"};
}

using Known = std::pair<std::string_view, std::string_view>;
constexpr Known kinds_by_ending[] = {
    {".ngc", "program"}, {".nc", "program"},    {".gcode", "program"}, {".tap", "program"},       {".apt", "program"},
    {".cls", "program"}, {".cl", "program"},    {".ncl", "program"},   {".aptsource", "program"}, {".uff", "frf"},
    {".unv", "frf"},     {".uf", "frf"},        {".html", "report"},   {".jsonl", "record"},      {".src", "result"},
    {".mod", "result"},  {".script", "result"}, {".servoj", "result"}};

}  // namespace

std::string kind_of_toml(std::string_view text) {
  // The first that fits: a job names the others, lobes and forces share tables.
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 14> tables = {
      {{"[job]", "job"},
       {"[[hits]]", "hits"},
       {"[acquisition]", "hits"},
       {"[lobes]", "lobes"},
       {"[robot]", "cell"},
       {"[[tool]]", "assembly"},
       {"[detector]", "monitor"},
       {"[signal]", "monitor"},
       {"[[recordings]]", "recordings"},
       {"[[modes]]", "modes"},
       {"[study]", "study"},
       {"[fit]", "fit"},
       {"[identification]", "result"},
       {"[cut]", "forces"}}};
  for (const auto& [table, kind] : tables) {
    if (has_line(text, table)) return std::string(kind);
  }
  return "other";
}

FileKind kind_of_file(const std::filesystem::path& path) {
  const std::string ending = io::lowered(path.extension().string());
  if (ending == ".toml") {
    FileKind out{.kind = kind_of_toml(peek(path).text)};
    if (out.kind == "result") out.document = "coefficients";
    return out;
  }
  if (ending == ".mat") return {.kind = kind_of_mat(path)};
  if (ending == ".h5" || ending == ".hdf5") return kind_of_hdf5(peek(path));
  if (ending == ".json") return kind_of_json(peek(path).text);
  for (const char* text : {".csv", ".txt", ".dat", ".asc"}) {
    if (ending == text) return kind_of_text(peek(path));
  }
  for (const auto& [known, kind] : kinds_by_ending) {
    if (ending == known) return {.kind = std::string(kind), .document = kind == "result" ? "trajectory" : ""};
  }
  if (io::is_read_as_record(path)) return {.kind = "record"};
  return {};
}

}  // namespace robomill::serve
