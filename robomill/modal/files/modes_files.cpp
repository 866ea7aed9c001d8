#include "robomill/modal/files/modes_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <optional>
#include <set>

#include "robomill/base/error.hpp"
#include "robomill/io/csv.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/json.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/modal/files/modes_schema.hpp"
#include "robomill/modal/weak_modes.hpp"

namespace robomill::modal {
namespace {

/// A mode as a file holds it: entries by the name of their degree of freedom.
struct NamedMode {
  Mode mode;
  std::vector<std::pair<Dof, std::complex<double>>> left, right;
  std::optional<bool> weak = {};  ///< what the file says
};

std::vector<Dof> all_dofs(const std::vector<NamedMode>& modes,
                          std::vector<std::pair<Dof, std::complex<double>>> NamedMode::*vector) {
  std::set<Dof> dofs;
  for (const NamedMode& mode : modes) {
    for (const auto& [dof, value] : mode.*vector) dofs.insert(dof);
  }
  return {dofs.begin(), dofs.end()};
}

Eigen::VectorXcd to_vector(const std::vector<std::pair<Dof, std::complex<double>>>& named,
                           const std::vector<Dof>& dofs) {
  Eigen::VectorXcd out = Eigen::VectorXcd::Zero(static_cast<Eigen::Index>(dofs.size()));
  for (const auto& [dof, value] : named) out(std::find(dofs.begin(), dofs.end(), dof) - dofs.begin()) = value;
  return out;
}

ModalModel to_model(const std::vector<NamedMode>& named) {
  ModalModel model;
  model.excitations = all_dofs(named, &NamedMode::left);
  model.responses = all_dofs(named, &NamedMode::right);
  for (const NamedMode& entry : named) {
    Mode mode = entry.mode;
    mode.left = to_vector(entry.left, model.excitations);
    mode.right = to_vector(entry.right, model.responses);
    model.modes.push_back(mode);
  }
  return model;
}

/// Marks as the file says; where it says nothing, by the deviations.
void mark_weak(ModalModel& model, const std::vector<NamedMode>& named) {
  mark_weak_modes(model);
  for (std::size_t k = 0; k < named.size(); ++k) model.modes[k].weak = named[k].weak.value_or(model.modes[k].weak);
}

/// Reports an error of the model with the file's name in front.
void validate(const ModalModel& model, const std::string& file) {
  try {
    model.validate();
  } catch (const InvalidInput& error) {
    InvalidInput::Parts parts = error.parts();
    parts.where = file;
    throw InvalidInput(parts);
  }
}

std::vector<std::pair<Dof, std::complex<double>>> read_vector(const io::JsonNode& node) {
  node.require_object();
  std::vector<std::pair<Dof, std::complex<double>>> out;
  for (const auto& item : node.json().items()) {
    const io::JsonNode entry = node.at(item.key());
    try {
      out.emplace_back(parse_dof(item.key()), entry.complex_number());
    } catch (const InvalidInput& error) {
      if (!error.parts().where.empty()) throw;
      throw entry.reject("must be named by a direction", "x, y, z, 1x, ry");
    }
  }
  return out;
}

double number_or_nan(const io::JsonNode& node, const char* key) {
  if (!node.has(key) || node.at(key).json().is_null()) return std::numeric_limits<double>::quiet_NaN();
  return node.at(key).number();
}

bool boolean(const io::JsonNode& node) {
  if (!node.json().is_boolean()) throw node.reject("must be true or false");
  return node.json().get<bool>();
}

/// modes.json is written of a bad fit too, as its report; its modes are for nobody who has not accepted them.
void require_usable(const io::JsonNode& root) {
  if (!root.has("fit") || !root.at("fit").has("usable")) return;
  const io::JsonNode fit = root.at("fit");
  if (fit.at("usable").json() != false) return;
  throw fit.at("relative_error")
      .reject(fmt::format("must be below {}: these modes do not describe the FRFs that they were fitted to",
                          unusable_fit_error),
              "Fit them better, or take them as they are with robomill modes --accept-fit");
}

/// Of JSON nothing is set.
ModalModel read_modes_json(const io::TomlSource& source, std::vector<std::string>& notes) {
  const std::string name = source.path.string();
  const io::Json json = source.text ? io::parse_json(*source.text, name) : io::read_json(source.path);
  const io::JsonNode root(json, name, notes);
  require_usable(root);
  const io::JsonNode list = root.at("modes");
  std::vector<NamedMode> named(list.size());
  for (std::size_t k = 0; k < named.size(); ++k) {
    const io::JsonNode node = list.at(k);
    named[k].mode.frequency_hz = node.at("frequency_hz").number();
    named[k].mode.damping_ratio = node.at("damping_ratio").number();
    named[k].left = read_vector(node.at("left"));
    named[k].right = read_vector(node.at("right"));
    if (node.has("std") && node.at("std").json().is_object()) {
      named[k].mode.frequency_std_hz = number_or_nan(node.at("std"), "frequency_hz");
      named[k].mode.damping_ratio_std = number_or_nan(node.at("std"), "damping_ratio");
      named[k].mode.residue_std_ratio = number_or_nan(node.at("std"), "residue");
    }
    if (node.has("weak")) named[k].weak = boolean(node.at("weak"));
  }
  ModalModel model = to_model(named);
  if (root.has("residuals") && !root.at("residuals").json().is_null()) {
    const io::JsonNode residuals = root.at("residuals");
    residuals.require_object();
    for (const auto& item : residuals.json().items()) {
      const io::JsonNode entry = residuals.at(item.key());
      try {
        model.residuals.push_back({.name = parse_frf_name(item.key()),
                                   .mass = entry.at("mass").complex_number(),
                                   .stiffness = entry.at("stiffness").complex_number()});
      } catch (const InvalidInput& error) {
        if (!error.parts().where.empty()) throw;
        throw entry.reject("must be named by an FRF", "xx, xy, 1x:3x");
      }
    }
  }
  validate(model, name);
  mark_weak(model, named);
  return model;
}

std::vector<std::pair<Dof, std::complex<double>>> read_vector(io::TomlFile& file, const std::string& key) {
  file.require(key);
  std::vector<std::pair<Dof, std::complex<double>>> out;
  for (const std::string& name : file.keys(key)) {
    std::vector<double> parts;
    file.numbers(key + "." + name, name, 1.0, parts);
    if (parts.size() != 2) throw file.reject(key + "." + name, "must be [re, im]");
    try {
      out.emplace_back(parse_dof(name), std::complex<double>(parts[0], parts[1]));
    } catch (const InvalidInput&) {
      throw file.reject(key + "." + name, "must be named by a direction", "x, y, z, 1x, ry");
    }
  }
  return out;
}

ModalModel read_modes_toml(const io::TomlSource& source, std::vector<std::string>& notes) {
  io::TomlFile file(source);
  if (file.tables("modes") == 0) file.require("modes", "Write [[modes]] above each");
  std::vector<NamedMode> named(file.tables("modes"));
  for (std::size_t k = 0; k < named.size(); ++k) {
    const std::string row = "modes[" + std::to_string(k) + "].";
    const std::string member = "modes[" + std::to_string(k + 1) + "].";
    file.require(row + "frequency_hz");
    file.require(row + "damping_ratio");
    file.number(row + "frequency_hz", member + "frequency_hz", 1.0, named[k].mode.frequency_hz);
    file.number(row + "damping_ratio", member + "damping_ratio", 1.0, named[k].mode.damping_ratio);
    named[k].left = read_vector(file, row + "left");
    named[k].right = read_vector(file, row + "right");
    if (bool weak = false; file.boolean(row + "weak", weak)) named[k].weak = weak;
  }
  std::ranges::move(file.done(), std::back_inserter(notes));
  ModalModel model = to_model(named);
  file.locate([&] { model.validate(); });
  mark_weak(model, named);
  return model;
}

}  // namespace

ModalModel read_modes(const io::TomlSource& source, std::vector<std::string>& notes) {
  switch (io::format_of(source.path)) {
    case io::Format::json:
      return read_modes_json(source, notes);
    case io::Format::toml:
      return read_modes_toml(source, notes);
    default:
      break;
  }
  throw InvalidInput(source.path.string(), "must end in .json or .toml to hold modes",
                     "FRFs become modes with robomill modes FILE -o modes.json");
}

std::string modes_json(const ModalModel& model) {
  model.validate();
  return io::dump(modes_table().write({.model = &model, .fit = nullptr}));
}

std::string modes_json(const FitResult& fit) {
  fit.model.validate();
  return io::dump(modes_table().write({.model = &fit.model, .fit = &fit}));
}

std::string modes_csv(const ModalModel& model) {
  model.validate();
  std::string out = "mode,frequency_hz,frequency_std_hz,damping_ratio,damping_ratio_std,residue_std_ratio";
  const auto add_names = [&out](const char* side, const std::vector<Dof>& dofs, bool as_excitation) {
    for (const Dof& dof : dofs) {
      const std::string name = to_string(dof, as_excitation);
      out += fmt::format(",{}_{}_re,{}_{}_im", side, name, side, name);
    }
  };
  add_names("left", model.excitations, true);
  add_names("right", model.responses, false);
  out += ",weak\n";
  for (std::size_t k = 0; k < model.modes.size(); ++k) {
    const Mode& mode = model.modes[k];
    std::string vectors;
    for (const Eigen::VectorXcd* vector : {&mode.left, &mode.right}) {
      for (const std::complex<double>& entry : *vector) {
        vectors += "," + io::csv_number(entry.real()) + "," + io::csv_number(entry.imag());
      }
    }
    io::add_csv_row(out,
                    {std::to_string(k + 1), io::csv_number(mode.frequency_hz), io::csv_number(mode.frequency_std_hz),
                     io::csv_number(mode.damping_ratio), io::csv_number(mode.damping_ratio_std),
                     io::csv_number(mode.residue_std_ratio) + vectors, mode.weak ? "1" : "0"});
  }
  return out;
}

}  // namespace robomill::modal
