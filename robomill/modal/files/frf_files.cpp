#include "robomill/modal/files/frf_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>
#include <numbers>
#include <set>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/modal/files/frf_check.hpp"
#include "robomill/modal/files/frf_parts.hpp"

namespace robomill::modal {
namespace {

constexpr double same_frequency = 1e-5;

FrfParts read_parts(const std::filesystem::path& path) {
  switch (io::format_of(path)) {
    case io::Format::uff:
      return read_frf_uff(path);
    case io::Format::csv:
    case io::Format::text:
      return read_frf_table(path);
    case io::Format::mat:
      return read_frf_mat(path);
    case io::Format::json:
      return read_frf_json(path);
    default:
      break;
  }
  throw InvalidInput(path.string(), "must end in .uff, .csv, .txt, .mat or .json to hold FRFs");
}

void drop_first_line(FrfParts& parts) {
  const Eigen::Index lines = parts.frequency_hz.size();
  const auto tail = [lines](auto& values) {
    if (values.size() == lines) values = values.tail(lines - 1).eval();
  };
  tail(parts.frequency_hz);
  for (FrfPart& frf : parts.frfs) {
    tail(frf.values);
    tail(frf.coherence);
    tail(frf.deviation);
  }
}

/// A / (iω)² and V / iω; at 0 Hz there is none.
void integrate(FrfParts& parts) {
  const auto derived = [](const FrfPart& frf) { return frf.derivatives > 0; };
  if (std::none_of(parts.frfs.begin(), parts.frfs.end(), derived)) return;
  if (parts.frequency_hz(0) == 0.0) {
    drop_first_line(parts);
    parts.notes.push_back(parts.file.string() + ": the line at 0 Hz has no displacement and is left out");
  }
  const Eigen::VectorXd omega = 2.0 * std::numbers::pi * parts.frequency_hz;
  for (FrfPart& frf : parts.frfs) {
    if (!derived(frf) || frf.values.size() != omega.size()) continue;
    const std::string name = frf.name ? " (" + to_string(*frf.name) + ")" : "";
    parts.notes.push_back(parts.file.string() + name +
                          (frf.derivatives == 2 ? ": accelerance, divided by (iω)²" : ": mobility, divided by iω"));
    for (int i = 0; i < frf.derivatives; ++i) {
      frf.values = (frf.values.array() / (std::complex<double>(0.0, 1.0) * omega.array())).matrix().eval();
      if (frf.deviation.size() == omega.size()) frf.deviation = (frf.deviation.array() / omega.array()).matrix().eval();
    }
  }
}

/// A file that had to leave out 0 Hz rules the others.
void agree_on_zero(std::vector<FrfParts>& all) {
  const auto starts_at_zero = [](const FrfParts& p) { return p.frequency_hz.size() > 1 && p.frequency_hz(0) == 0.0; };
  if (std::all_of(all.begin(), all.end(), starts_at_zero)) return;
  for (FrfParts& parts : all) {
    if (starts_at_zero(parts)) drop_first_line(parts);
  }
}

void require_same_axis(const FrfParts& first, const FrfParts& other) {
  const Eigen::VectorXd& a = first.frequency_hz;
  const Eigen::VectorXd& b = other.frequency_hz;
  const auto reject = [&](const std::string& what) {
    return InvalidInput(other.file.string(), "has other frequencies than " + first.file.string() + ": " + what,
                        "FRFs that go together need one axis");
  };
  if (a.size() != b.size()) throw reject(std::to_string(b.size()) + " lines, not " + std::to_string(a.size()));
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    if (std::abs(a(i) - b(i)) > same_frequency * std::abs(a(i))) {
      throw reject("line " + std::to_string(i + 1) + " stands at " + std::to_string(b(i)) + " Hz, not " +
                   std::to_string(a(i)));
    }
  }
}

/// `as` names all FRFs, or those without a name; one alone is xx.
void give_names(std::vector<FrfPart*>& frfs, const std::vector<std::string>& as, std::vector<Assumption>& assumed) {
  std::vector<FrfPart*> unnamed;
  std::copy_if(frfs.begin(), frfs.end(), std::back_inserter(unnamed), [](const FrfPart* f) { return !f->name; });
  if (as.empty()) {
    if (unnamed.size() == 1 && frfs.size() == 1) {
      unnamed.front()->name = parse_frf_name("xx");
      assumed.push_back({.what = "Directions of the FRF without a name", .taken = "xx", .key = "--as"});
    } else if (!unnamed.empty()) {
      throw InvalidInput("--as",
                         "must name the FRFs that the files leave unnamed (" + std::to_string(unnamed.size()) + ")",
                         "For example --as xx,yy");
    }
    return;
  }
  std::vector<FrfPart*>& named = as.size() == frfs.size() ? frfs : unnamed;
  if (as.size() != named.size()) {
    throw InvalidInput("--as", static_cast<double>(as.size()), "names",
                       "must be one for each FRF (" + std::to_string(frfs.size()) + ") or for each unnamed one (" +
                           std::to_string(unnamed.size()) + ")");
  }
  for (std::size_t i = 0; i < as.size(); ++i) named[i]->name = parse_frf_name(as[i]);
}

/// FRFs that all stand at one numbered point are those of the tip.
void number_less(std::vector<FrfPart*>& frfs, std::vector<Assumption>& assumed) {
  std::set<int> points;
  for (const FrfPart* frf : frfs) points.insert({frf->name->response.point, frf->name->excitation.point});
  if (points.size() != 1 || *points.begin() == 0) return;
  assumed.push_back({.what = fmt::format("Point {}, where all FRFs stand", *points.begin()),
                     .taken = std::string(taken_as_tip),
                     .key = "names of the FRFs"});
  for (FrfPart* frf : frfs) frf->name->response.point = frf->name->excitation.point = 0;
}

void write_as(const std::filesystem::path& path, const FrfSet& set, const FrfWriteOptions& options,
              const std::string& json) {
  set.validate();
  switch (io::format_of(path)) {
    case io::Format::uff:
      return io::write_file(path, frf_uff(set, options.binary_uff));
    case io::Format::csv:
      return io::write_file(path, frf_table(set, ','));
    case io::Format::text:
      return io::write_file(path, frf_table(set, '\t'));
    case io::Format::mat:
      return write_frf_mat(path, set);
    case io::Format::json:
      return io::write_file(path, json);
    default:
      break;
  }
  throw InvalidInput(path.string(), "must end in .uff, .csv, .txt, .mat or .json to hold FRFs");
}

}  // namespace

FrfName frf_name_at(const std::string& where, std::string_view text) {
  try {
    return parse_frf_name(text);
  } catch (const InvalidInput& error) {
    InvalidInput::Parts parts = error.parts();
    parts.where = where;
    parts.value = "\"" + std::string(text) + "\"";
    throw InvalidInput(parts);
  }
}

FrfFile read_frfs(const std::vector<std::filesystem::path>& paths, const std::vector<std::string>& as) {
  if (paths.empty()) throw InvalidInput("FRF files", "none is given");
  std::vector<FrfParts> all;
  for (const std::filesystem::path& path : paths) {
    all.push_back(read_parts(path));
    if (all.back().frequency_hz.size() == 0) throw InvalidInput(path.string(), "holds no line");
    require_frequencies(all.back().frequency_hz, path.string());
    integrate(all.back());
    check_content(all.back());
  }
  agree_on_zero(all);
  FrfFile out;
  std::vector<FrfPart*> frfs;
  for (FrfParts& parts : all) {
    require_same_axis(all.front(), parts);
    for (FrfPart& frf : parts.frfs) frfs.push_back(&frf);
    out.notes.insert(out.notes.end(), parts.notes.begin(), parts.notes.end());
    add_assumed(out.assumed, parts.assumed);
    out.added_decay_per_s = std::max(out.added_decay_per_s, parts.added_decay_per_s);
  }
  give_names(frfs, as, out.assumed);
  number_less(frfs, out.assumed);
  out.set.frequency_hz = all.front().frequency_hz;
  for (FrfPart* frf : frfs) {
    out.set.frfs.push_back({.name = *frf->name,
                            .receptance = std::move(frf->values),
                            .coherence = std::move(frf->coherence),
                            .deviation = std::move(frf->deviation)});
  }
  try {
    out.set.validate();
  } catch (const InvalidInput& error) {
    InvalidInput::Parts parts = error.parts();
    parts.where = paths.size() == 1 ? paths.front().string() : paths.front().string() + " and others";
    throw InvalidInput(parts);
  }
  return out;
}

void write_frfs(const std::filesystem::path& path, const FrfSet& set, const FrfWriteOptions& options) {
  write_as(path, set, options, io::format_of(path) == io::Format::json ? frf_json(set) : "");
}

void write_frfs(const std::filesystem::path& path, const FrfResult& result, const FrfWriteOptions& options) {
  write_as(path, result.set, options, io::format_of(path) == io::Format::json ? frf_json(result) : "");
}

}  // namespace robomill::modal
