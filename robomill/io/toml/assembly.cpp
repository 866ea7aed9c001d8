#include "robomill/io/toml/assembly.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <system_error>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"

namespace robomill::io {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_files = 32;
constexpr std::uintmax_t most_bytes = std::uintmax_t{64} << 20;
constexpr std::string_view include_key = "include";
constexpr std::array<std::string_view, 3> includes_by_name = {"job.lobes", "job.forces", "job.cell"};

std::string place_of(const toml::node& node) {
  const toml::source_region& region = node.source();
  return fmt::format("{}:{}", region.path ? *region.path : std::string(), region.begin.line);
}

/// Whether two values are one: whole numbers and others are compared as numbers.
bool same(const toml::node& a, const toml::node& b) {
  if (a.is_number() && b.is_number()) return a.value<double>() == b.value<double>();
  const toml::array *list = a.as_array(), *other = b.as_array();
  if (list != nullptr && other != nullptr) {
    return std::equal(list->begin(), list->end(), other->begin(), other->end(),
                      [](const toml::node& x, const toml::node& y) { return same(x, y); });
  }
  const toml::table *table = a.as_table(), *second = b.as_table();
  if (table != nullptr && second != nullptr) {
    return table->size() == second->size() && std::ranges::all_of(*table, [&](const auto& entry) {
             const toml::node* found = second->get(entry.first.str());
             return found != nullptr && same(entry.second, *found);
           });
  }
  if (a.is_string() && b.is_string()) return a.value<std::string>() == b.value<std::string>();
  return a.is_boolean() && b.is_boolean() && a.value<bool>() == b.value<bool>();
}

/// Moves the keys of one table to another.
void merge(toml::table& into, toml::table& from, const std::string& before) {
  for (auto& [name, value] : from) {
    toml::node* known = into.get(name.str());
    const std::string key = before + std::string(name.str());
    if (known == nullptr) {
      into.insert(name, std::move(value));
    } else if (known->is_table() && value.is_table()) {
      merge(*known->as_table(), *value.as_table(), key + ".");
    } else if (!same(*known, value)) {
      throw InvalidInput(
          InvalidInput::Parts{.where = place_of(value),
                              .field = key,
                              .value = value_text(value),
                              .rule = fmt::format("must have one value in what is read together; {} "
                                                  "has {}",
                                                  place_of(*known), known->is_value() ? value_text(*known) : "another"),
                              .hint = "Correct the one that is wrong, or take one of them away"});
    }
  }
}

class Assembly {
 public:
  TomlAssembly out;

  void add(const fs::path& path, std::string content) {
    bytes_ += content.size();
    toml::table own = parse_toml(content, path.string());
    files_.push_back(fs::weakly_canonical(path, ignored_));
    out.texts.push_back({path, std::move(content)});
    const std::vector<fs::path> includes = includes_of(own, path);
    own.erase(include_key);
    if (out.texts.size() == 1) {
      out.root = std::move(own);
    } else {
      merge(out.root, own, "");
    }
    for (const fs::path& next : includes) include(next);
  }

 private:
  void include(const fs::path& path) {
    const fs::path whole = fs::weakly_canonical(path, ignored_);
    if (std::ranges::find(files_, whole) != files_.end()) return;
    if (files_.size() == most_files) {
      throw InvalidInput(out.texts.front().path.string(), fmt::format("includes more than {} files", most_files));
    }
    std::string content = read_file(path, most_bytes - std::min(bytes_, most_bytes - 1));
    add(path, std::move(content));
  }

  /// The files that a document includes, in its order. @throws InvalidInput with the line of what names no file
  std::vector<fs::path> includes_of(const toml::table& document, const fs::path& path) {
    std::vector<fs::path> found;
    const auto add_file = [&](const toml::node& node, std::string_view key, bool must_be_there) {
      const auto reject = [&](std::string rule, std::string hint = {}) {
        return InvalidInput(InvalidInput::Parts{.where = place_of(node),
                                                .field = std::string(key),
                                                .value = value_text(node),
                                                .rule = std::move(rule),
                                                .hint = std::move(hint)});
      };
      const auto* name = node.as_string();
      if (name == nullptr && !must_be_there) return;  // its reader rejects it
      if (name == nullptr || name->get().empty()) throw reject("must be a list of names of files");
      fs::path file = path.parent_path() / name->get();
      if (fs::is_regular_file(file, ignored_)) return found.push_back(std::move(file));
      if (must_be_there) throw reject("names no file that is there", "Paths are relative to the file that names them");
    };
    if (const toml::node* list = document.get(include_key)) {
      if (const toml::array* names = list->as_array()) {
        for (const toml::node& name : *names) add_file(name, include_key, true);
      } else {
        add_file(*list, include_key, true);
      }
    }
    for (const std::string_view key : includes_by_name) {
      if (const toml::node* node = find_node(document, key)) add_file(*node, key, false);
    }
    return found;
  }

  std::vector<fs::path> files_;  ///< canonical, of those read
  std::uintmax_t bytes_ = 0;
  std::error_code ignored_;
};

}  // namespace

TomlAssembly assemble(const TomlSource& source) {
  Assembly assembly;
  assembly.add(source.path, source.text ? *source.text : read_file(source.path, most_bytes));
  return std::move(assembly.out);
}

}  // namespace robomill::io
