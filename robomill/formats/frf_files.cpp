#include "robomill/formats/frf_files.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "robomill/base/error.hpp"
#include "robomill/formats/file.hpp"
#include "robomill/formats/frf_parts.hpp"
#include "robomill/formats/json.hpp"
#include "robomill/formats/mat.hpp"

namespace robomill::formats {
namespace {

constexpr double same_frequency = 1e-5;

FrfParts read_parts(const std::filesystem::path& path) {
  switch (format_of(path)) {
    case Format::uff:
      return read_frf_uff(path);
    case Format::csv:
    case Format::text:
      return read_frf_table(path);
    case Format::mat:
      return read_frf_mat(path);
    case Format::json:
      return read_frf_json(path);
    default:
      break;
  }
  throw InvalidInput(path.string(), "must end in .uff, .csv, .txt, .mat or .json to hold FRFs");
}

void drop_first_line(FrfParts& parts) {
  const Eigen::Index n = parts.frequency_hz.size() - 1;
  const auto tail = [n](auto& values) {
    if (values.size() > 0) values = values.tail(n).eval();
  };
  tail(parts.frequency_hz);
  for (FrfPart& frf : parts.frfs) {
    tail(frf.receptance);
    tail(frf.coherence);
    tail(frf.deviation);
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
  const auto refuse = [&](const std::string& what) {
    return InvalidInput(other.file.string(), "has other frequencies than " + first.file.string() + ": " + what,
                        "FRFs that go together need one axis");
  };
  if (a.size() != b.size()) throw refuse(std::to_string(b.size()) + " lines, not " + std::to_string(a.size()));
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    if (std::abs(a(i) - b(i)) > same_frequency * std::abs(a(i))) {
      throw refuse("line " + std::to_string(i + 1) + " stands at " + std::to_string(b(i)) + " Hz, not " +
                   std::to_string(a(i)));
    }
  }
}

/// `as` names all FRFs, or those without a name; one alone is xx.
void give_names(std::vector<FrfPart*>& frfs, const std::vector<std::string>& as) {
  std::vector<FrfPart*> unnamed;
  std::copy_if(frfs.begin(), frfs.end(), std::back_inserter(unnamed), [](const FrfPart* f) { return !f->name; });
  if (as.empty()) {
    if (unnamed.size() == 1 && frfs.size() == 1)
      unnamed.front()->name = modal::parse_frf_name("xx");
    else if (!unnamed.empty()) {
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
  for (std::size_t i = 0; i < as.size(); ++i) named[i]->name = modal::parse_frf_name(as[i]);
}

/// FRFs that all stand at one numbered point are those of the tip.
void number_less(std::vector<FrfPart*>& frfs, std::vector<std::string>& notes) {
  std::set<int> points;
  for (const FrfPart* frf : frfs) points.insert({frf->name->response.point, frf->name->excitation.point});
  if (points.size() != 1 || *points.begin() == 0) return;
  notes.push_back("All FRFs stand at point " + std::to_string(*points.begin()) + ": taken as the tip");
  for (FrfPart* frf : frfs) frf->name->response.point = frf->name->excitation.point = 0;
}

Json set_json(const modal::FrfSet& set) {
  set.validate();
  Json json;
  json["frequency_hz"] = numbers(set.frequency_hz);
  json["receptance_m_per_n"] = Json::object();
  json["coherence"] = Json::object();
  json["deviation_m_per_n"] = Json::object();
  for (const modal::Frf& frf : set.frfs) {
    const std::string name = modal::to_string(frf.name);
    json["receptance_m_per_n"][name] = complex_numbers(frf.receptance);
    if (frf.coherence.size() > 0) json["coherence"][name] = numbers(frf.coherence);
    if (frf.deviation.size() > 0) json["deviation_m_per_n"][name] = numbers(frf.deviation);
  }
  return json;
}

Json grade_json(const modal::FrfGrade& grade) {
  return {{"grade", modal::to_string(grade.grade)},
          {"hits", grade.hits},
          {"mean_coherence", number(grade.mean_coherence)},
          {"relative_noise", number(grade.relative_noise)},
          {"reciprocity_error", number(grade.reciprocity_error)},
          {"excited_band_hz", Json::array({number(grade.excited_low_hz), number(grade.excited_high_hz)})},
          {"lowest_trustworthy_frequency_hz", number(grade.lowest_trustworthy_frequency_hz)},
          {"faults", grade.faults},
          {"remedies", grade.remedies}};
}

void add_hits(Json& json, const modal::FrfResult& result) {
  json["hits"] = Json::array();
  for (const modal::HitVerdict& hit : result.hits) {
    json["hits"].push_back({{"file", hit.file},
                            {"accepted", hit.accepted},
                            {"reasons", hit.reasons},
                            {"peak_force_n", number(hit.peak_force_n)},
                            {"pulse_width_s", number(hit.pulse_width_s)},
                            {"second_pulse_ratio", number(hit.second_pulse_ratio)}});
  }
  json["grades"] = Json::object();
  for (const modal::FrfGrade& grade : result.grades) json["grades"][modal::to_string(grade.name)] = grade_json(grade);
  json["lowest_trustworthy_frequency_hz"] = number(result.lowest_trustworthy_frequency_hz);
  json["added_decay_per_s"] = number(result.added_decay_removed ? 0.0 : result.added_decay_per_s);
  json["notes"] = result.notes;
}

/// "H_1x_3x" of 1x:3x with letter H.
std::string mat_name(char letter, const modal::FrfName& name) {
  std::string text = modal::to_string(name);
  std::replace(text.begin(), text.end(), ':', '_');
  return std::string(1, letter) + "_" + text;
}

Eigen::VectorXd to_vector(const Eigen::MatrixXd& matrix, const std::string& where) {
  if (matrix.rows() != 1 && matrix.cols() != 1) throw InvalidInput(where, "must be a vector");
  return matrix.reshaped();
}

const MatVariable* find(const std::vector<MatVariable>& variables, const std::string& name) {
  const auto found =
      std::find_if(variables.begin(), variables.end(), [&](const MatVariable& v) { return v.name == name; });
  return found == variables.end() ? nullptr : &*found;
}

void write_as(const std::filesystem::path& path, const modal::FrfSet& set, const FrfWriteOptions& options,
              const std::string& json) {
  set.validate();
  switch (format_of(path)) {
    case Format::uff:
      return write_file(path, frf_uff(set, options.binary_uff));
    case Format::csv:
      return write_file(path, frf_table(set, ','));
    case Format::text:
      return write_file(path, frf_table(set, '\t'));
    case Format::mat:
      return write_frf_mat(path, set);
    case Format::json:
      return write_file(path, json);
    default:
      break;
  }
  throw InvalidInput(path.string(), "must end in .uff, .csv, .txt, .mat or .json to hold FRFs");
}

}  // namespace

FrfParts read_frf_json(const std::filesystem::path& path) {
  const Json json = read_json(path);
  const JsonNode root(json, path.string());
  FrfParts out{.file = path, .frequency_hz = root.at("frequency_hz").numbers()};
  const JsonNode receptances = root.at("receptance_m_per_n");
  receptances.require_object();
  const auto extra = [&root](const char* key, const std::string& name) {
    const bool there = root.has(key) && root.at(key).has(name.c_str());
    return there ? root.at(key).at(name).numbers() : Eigen::VectorXd();
  };
  for (const auto& item : receptances.json().items()) {
    const JsonNode node = receptances.at(item.key());
    const Eigen::VectorXd re = node.at("re").numbers();
    const Eigen::VectorXd im = node.at("im").numbers();
    if (re.size() != im.size()) throw node.refuse("must have as many real as imaginary parts");
    FrfPart part{.name = modal::parse_frf_name(item.key()),
                 .receptance = re.cast<std::complex<double>>() + std::complex<double>(0.0, 1.0) * im,
                 .coherence = extra("coherence", item.key()),
                 .deviation = extra("deviation_m_per_n", item.key())};
    out.frfs.push_back(std::move(part));
  }
  if (root.has("added_decay_per_s") && !root.at("added_decay_per_s").json().is_null()) {
    out.added_decay_per_s = root.at("added_decay_per_s").number();
  }
  return out;
}

FrfParts read_frf_mat(const std::filesystem::path& path) {
  const std::vector<MatVariable> variables = read_mat(path);
  const MatVariable* frequency = find(variables, "frequency_hz");
  if (frequency == nullptr) throw InvalidInput(path.string(), "has no variable frequency_hz");
  FrfParts out{.file = path, .frequency_hz = to_vector(frequency->re, path.string() + ": frequency_hz")};
  for (const MatVariable& variable : variables) {
    if (!variable.name.starts_with("H_")) continue;
    std::string text = variable.name.substr(2);
    std::replace(text.begin(), text.end(), '_', ':');
    const std::string where = path.string() + ": " + variable.name;
    const Eigen::VectorXd re = to_vector(variable.re, where);
    FrfPart part{.name = modal::parse_frf_name(text), .receptance = re.cast<std::complex<double>>()};
    if (variable.im.size() > 0) part.receptance.imag() = to_vector(variable.im, where);
    if (const MatVariable* other = find(variables, mat_name('C', *part.name)))
      part.coherence = to_vector(other->re, where);
    if (const MatVariable* other = find(variables, mat_name('S', *part.name)))
      part.deviation = to_vector(other->re, where);
    out.frfs.push_back(std::move(part));
  }
  if (out.frfs.empty()) throw InvalidInput(path.string(), "has no variable such as H_xx");
  return out;
}

void write_frf_mat(const std::filesystem::path& path, const modal::FrfSet& set) {
  std::vector<MatVariable> variables = {{.name = "frequency_hz", .re = set.frequency_hz}};
  for (const modal::Frf& frf : set.frfs) {
    variables.push_back({.name = mat_name('H', frf.name), .re = frf.receptance.real(), .im = frf.receptance.imag()});
    if (frf.coherence.size() > 0) variables.push_back({.name = mat_name('C', frf.name), .re = frf.coherence});
    if (frf.deviation.size() > 0) variables.push_back({.name = mat_name('S', frf.name), .re = frf.deviation});
  }
  write_mat(path, variables);
}

FrfFile read_frfs(const std::vector<std::filesystem::path>& paths, const std::vector<std::string>& as) {
  if (paths.empty()) throw InvalidInput("FRF files", "none is given");
  std::vector<FrfParts> all;
  for (const std::filesystem::path& path : paths) {
    all.push_back(read_parts(path));
    if (all.back().frequency_hz.size() == 0) throw InvalidInput(path.string(), "holds no line");
  }
  agree_on_zero(all);
  FrfFile out;
  std::vector<FrfPart*> frfs;
  for (FrfParts& parts : all) {
    require_same_axis(all.front(), parts);
    for (FrfPart& frf : parts.frfs) frfs.push_back(&frf);
    out.notes.insert(out.notes.end(), parts.notes.begin(), parts.notes.end());
    out.added_decay_per_s = std::max(out.added_decay_per_s, parts.added_decay_per_s);
  }
  give_names(frfs, as);
  number_less(frfs, out.notes);
  out.set.frequency_hz = all.front().frequency_hz;
  for (FrfPart* frf : frfs) {
    out.set.frfs.push_back({.name = *frf->name,
                            .receptance = std::move(frf->receptance),
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

std::string frf_json(const modal::FrfSet& set) {
  return dump(set_json(set));
}

std::string frf_json(const modal::FrfResult& result) {
  Json json = set_json(result.set);
  add_hits(json, result);
  return dump(json);
}

std::string hits_json(const modal::FrfResult& result) {
  Json json = Json::object();
  add_hits(json, result);
  return dump(json);
}

void write_frfs(const std::filesystem::path& path, const modal::FrfSet& set, const FrfWriteOptions& options) {
  write_as(path, set, options, format_of(path) == Format::json ? frf_json(set) : "");
}

void write_frfs(const std::filesystem::path& path, const modal::FrfResult& result, const FrfWriteOptions& options) {
  write_as(path, result.set, options, format_of(path) == Format::json ? frf_json(result) : "");
}

}  // namespace robomill::formats
