#include <fmt/format.h>

#include "robomill/io/json.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/modal/files/frf_parts.hpp"
#include "robomill/modal/files/frf_schema.hpp"

namespace robomill::modal {
namespace {

std::string text_of(const FrfView& view) {
  view.set->validate();
  return io::dump(frf_table().write(view));
}

/// root[key][name], where there is one.
Eigen::VectorXd optional_numbers(const io::JsonNode& root, const char* key, const std::string& name) {
  if (!root.has(key) || !root.at(key).has(name.c_str())) return {};
  const io::JsonNode node = root.at(key).at(name);
  return node.json().is_null() ? Eigen::VectorXd() : node.numbers();
}

}  // namespace

FrfParts read_frf_json(const std::filesystem::path& path) {
  const io::Json json = io::read_json(path);
  FrfParts out{.file = path};
  const io::JsonNode root(json, path.string(), out.notes);
  out.frequency_hz = root.at("frequency_hz").numbers();
  const io::JsonNode receptances = root.at("receptance_m_per_n");
  receptances.require_object();
  for (const auto& item : receptances.json().items()) {
    const io::JsonNode node = receptances.at(item.key());
    const Eigen::VectorXd re = node.at("re").numbers();
    const Eigen::VectorXd im = node.at("im").numbers();
    if (re.size() != im.size()) throw node.reject("must have as many real as imaginary parts");
    FrfPart part{.name = frf_name_at(fmt::format("{}: {}", path.string(), node.path()), item.key()),
                 .values = re.cast<std::complex<double>>()};
    part.values.imag() = im;
    part.coherence = optional_numbers(root, "coherence", item.key());
    part.deviation = optional_numbers(root, "deviation_m_per_n", item.key());
    out.frfs.push_back(std::move(part));
  }
  if (root.has("added_decay_per_s") && !root.at("added_decay_per_s").json().is_null()) {
    out.added_decay_per_s = root.at("added_decay_per_s").number();
    if (out.added_decay_per_s < 0.0) throw root.at("added_decay_per_s").reject("must be >= 0");
  }
  return out;
}

std::string frf_json(const FrfSet& set) {
  return text_of({.set = &set});
}

std::string frf_json(const FrfResult& result) {
  return text_of({.set = &result.set, .hits = &result});
}

std::string frf_json(const FrfSet& set, const FrfDoubts& doubts) {
  return text_of({.set = &set, .doubts = &doubts});
}

}  // namespace robomill::modal
