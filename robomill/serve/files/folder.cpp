#include "robomill/serve/files/folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <system_error>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/printable.hpp"
#include "robomill/io/confinement.hpp"
#include "robomill/io/file.hpp"

namespace robomill::serve {
namespace {

namespace fs = std::filesystem;

constexpr int deepest = 6;
constexpr std::size_t peeked_bytes = 1 << 16;

bool hidden(const fs::path& name) {
  return name.string().starts_with('.');
}

/// The beginning of a file; empty where it cannot be read.
std::string peek(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::string text(peeked_bytes, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  return text;
}

bool has_line(std::string_view text, std::string_view begins) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string_view line = text.substr(at, end - at);
    while (!line.empty() && (line.front() == ' ' || line.front() == '\t')) line.remove_prefix(1);
    if (line.starts_with(begins)) return true;
    at = end + 1;
  }
  return false;
}

constexpr std::array<std::pair<std::string_view, std::string_view>, 17> kinds_by_ending = {{{".ngc", "program"},
                                                                                            {".nc", "program"},
                                                                                            {".gcode", "program"},
                                                                                            {".tap", "program"},
                                                                                            {".apt", "program"},
                                                                                            {".cls", "program"},
                                                                                            {".uff", "frf"},
                                                                                            {".unv", "frf"},
                                                                                            {".uf", "frf"},
                                                                                            {".wav", "record"},
                                                                                            {".mat", "record"},
                                                                                            {".csv", "record"},
                                                                                            {".txt", "record"},
                                                                                            {".dat", "record"},
                                                                                            {".asc", "record"},
                                                                                            {".html", "report"},
                                                                                            {".jsonl", "record"}}};

}  // namespace

std::string kind_of_toml(std::string_view text) {
  // The first that fits: a job names the others, lobes and forces share tables.
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 12> tables = {
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
       {"[cut]", "forces"}}};
  for (const auto& [table, kind] : tables) {
    if (has_line(text, table)) return std::string(kind);
  }
  return "other";
}

std::string kind_of_file(const fs::path& path) {
  const std::string ending = path.extension().string();
  if (ending == ".toml") return kind_of_toml(peek(path));
  if (ending == ".json") {
    const std::string text = peek(path);
    if (text.find("\"receptance_m_per_n\"") != std::string::npos) return "frf";
    if (text.find("\"modes\"") != std::string::npos && text.find("\"right\"") != std::string::npos) return "modes";
    return "other";
  }
  if (ending == ".csv" && peek(path).starts_with("frequency_hz")) return "frf";
  for (const auto& [known, kind] : kinds_by_ending) {
    if (ending == known) return std::string(kind);
  }
  return "other";
}

Folder::Folder(const fs::path& root) {
  std::error_code error;
  root_ = fs::canonical(root, error);
  if (error || !fs::is_directory(root_, error)) {
    throw InvalidInput(root.string(), "there is no such folder", "robomill serve FOLDER; the present one without");
  }
}

fs::path Folder::resolve(std::string_view relative) const {
  const auto reject = [&](const char* rule) {
    return InvalidInput("path", printable(std::string(relative)) + " " + rule);
  };
  if (relative.empty() || relative.size() > 1024) throw reject("must be a path of up to 1,024 bytes");
  for (const char letter : relative) {
    if (static_cast<unsigned char>(letter) < 0x20 || letter == '\\')
      throw reject("must not hold control characters or \\");
  }
  const fs::path path{relative};
  if (path.is_absolute()) throw reject("must be relative to the folder that is served");
  for (const fs::path& part : path) {
    if (part == "..") throw reject("must not lead upwards");
    if (part.empty() || hidden(part)) throw reject("must not have empty or hidden parts");
  }
  io::require_inside(root_ / path);
  return root_ / path;
}

std::vector<FolderFile> Folder::list(std::size_t& left_out, std::size_t most) {
  left_out = 0;
  std::vector<FolderFile> out;
  std::error_code error;
  fs::recursive_directory_iterator it(root_, fs::directory_options::skip_permission_denied, error);
  for (; !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
    std::error_code ignored;
    if (hidden(it->path().filename()) || it.depth() >= deepest) {
      it.disable_recursion_pending();
      if (hidden(it->path().filename())) continue;
    }
    if (it->is_symlink(ignored) || !it->is_regular_file(ignored)) continue;
    if (out.size() >= most) {
      if (++left_out > 100 * most) break;  // a folder like / : enough is enough
      continue;
    }
    FolderFile file;
    file.path = it->path().lexically_relative(root_).generic_string();
    file.bytes = it->file_size(ignored);
    file.modified_s = std::chrono::duration_cast<std::chrono::seconds>(
                          fs::file_time_type::clock::to_sys(it->last_write_time(ignored)).time_since_epoch())
                          .count();
    const auto known = known_.find(file.path);
    const bool same =
        known != known_.end() && known->second.bytes == file.bytes && known->second.modified_s == file.modified_s;
    file.kind = same ? known->second.kind : kind_of_file(it->path());
    out.push_back(std::move(file));
  }
  std::ranges::sort(out, {}, &FolderFile::path);
  known_.clear();
  for (const FolderFile& file : out) known_.emplace(file.path, file);
  return out;
}

std::string Folder::read(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_regular_file(path, ignored) && fs::file_size(path, ignored) == 0) return {};
  return io::read_file(path, most_text_bytes);
}

void Folder::write(const fs::path& path, std::string_view content) {
  io::make_folder(path.parent_path());
  io::write_file(path, content);
}

std::string Folder::tag_of(std::string_view content) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;  // FNV-1a: tells versions apart, guards nothing
  for (const char letter : content) hash = (hash ^ static_cast<unsigned char>(letter)) * 0x100000001b3ULL;
  return fmt::format("\"{:016x}-{}\"", hash, content.size());
}

}  // namespace robomill::serve
