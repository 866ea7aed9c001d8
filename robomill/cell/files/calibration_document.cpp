#include "robomill/cell/files/calibration_document.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string_view>
#include <system_error>
#include <utility>

#include "robomill/base/digest.hpp"
#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/json.hpp"
#include "robomill/io/system/output_places.hpp"

namespace robomill::cell {
namespace {

namespace fs = std::filesystem;
using modal::PostureCalibration;

constexpr std::string_view document_kind = "posture-calibration/1";
/// How each of these documents begins, whatever its version.
constexpr std::string_view beginning = "{\n  \"document\": \"posture-calibration/";
constexpr std::uintmax_t most_bytes = 1 << 20;
constexpr std::size_t most_tools = 2;

io::Json axes_json(const Eigen::Vector3d& of_axes) {
  return {{"x", of_axes.x()}, {"y", of_axes.y()}, {"z", of_axes.z()}};
}

/// All digits, so that each number is read as it was.
io::Json found_json(const PostureCalibration& calibration) {
  const auto& [structure, tools, common, differing, noise, error, left_out, held_out_error, unmeasured_scale,
               band_scale] = calibration;
  io::Json tool_list = io::Json::array(), columns = io::Json::array();
  for (const auto& [frequency_hz, mass_kg] : tools) {
    tool_list.push_back({{"frequency_hz", frequency_hz}, {"mass_kg", mass_kg}});
  }
  for (Eigen::Index k = 0; k < differing.cols(); ++k) columns.push_back(io::numbers(differing.col(k)));
  return {{"bearings", structure.bearings},
          {"bracket", structure.bracket},
          {"load", structure.load},
          {"inner_share", structure.inner_share},
          {"tool", tool_list},
          {"parameters", io::numbers(common)},
          {"posture_parameters", columns},
          {"noise", noise},
          {"error", error},
          {"left_out",
           {{"error", left_out.error},
            {"direct", axes_json(left_out.direct)},
            {"predicted", axes_json(left_out.predicted)},
            {"frequency_scale", left_out.frequency_scale},
            {"damping_scale", left_out.damping_scale},
            {"residue_scale", left_out.residue_scale}}},
          {"held_out_error", axes_json(held_out_error)},
          {"unmeasured_scale", unmeasured_scale},
          {"band_scale", band_scale}};
}

/// Numbers of a document that is not trusted.
class Reading {
 public:
  explicit Reading(const io::JsonNode& found) : found_(found) {}

  [[nodiscard]] PostureCalibration calibration() const {
    PostureCalibration out;
    out.structure.bearings = flag("bearings");
    out.structure.bracket = flag("bracket");
    out.structure.load = flag("load");
    out.structure.inner_share = within(found_.at("inner_share"), 0.0, 1.0);
    const io::JsonNode tools = found_.at("tool");
    if (tools.size() > most_tools) throw tools.reject(fmt::format("must hold at most {} masses", most_tools));
    for (std::size_t t = 0; t < tools.size(); ++t) {
      out.tools.push_back({.frequency_hz = within(tools.at(t).at("frequency_hz"), least, most),
                           .mass_kg = within(tools.at(t).at("mass_kg"), least, most)});
    }
    out.common = found_.at("parameters").numbers();
    const io::JsonNode columns = found_.at("posture_parameters");
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const Eigen::VectorXd column = columns.at(k).numbers();
      if (k == 0) out.differing.resize(column.size(), static_cast<Eigen::Index>(columns.size()));
      if (column.size() != out.differing.rows()) throw columns.reject("must hold lists of one length");
      out.differing.col(static_cast<Eigen::Index>(k)) = column;
    }
    out.noise = within(found_.at("noise"), least, most);
    out.error = within(found_.at("error"), 0.0, most);
    out.left_out = left_out();
    out.held_out_error = axes(found_.at("held_out_error"));
    out.unmeasured_scale = within(found_.at("unmeasured_scale"), 1.0, largest_scale);
    out.band_scale = within(found_.at("band_scale"), 1.0, largest_scale);
    return out;
  }

 private:
  static constexpr double least = 1e-30, most = 1e30, largest_scale = 10.0;

  [[nodiscard]] bool flag(const char* key) const {
    const io::JsonNode node = found_.at(key);
    if (!node.json().is_boolean()) throw node.reject("must be true or false");
    return node.json().get<bool>();
  }
  static double within(const io::JsonNode& node, double low, double high) {
    const double value = node.number();
    if (!(value >= low && value <= high)) throw node.reject(fmt::format("must lie between {} and {}", low, high));
    return value;
  }
  /// Null: not known.
  static double known(const io::JsonNode& node) {
    return node.json().is_null() ? std::nan("") : within(node, 0.0, most);
  }
  static Eigen::Vector3d axes(const io::JsonNode& node) {
    return {known(node.at("x")), known(node.at("y")), known(node.at("z"))};
  }
  [[nodiscard]] modal::detail::LeftOutPostures left_out() const {
    const io::JsonNode node = found_.at("left_out");
    return {.error = known(node.at("error")),
            .direct = axes(node.at("direct")),
            .predicted = axes(node.at("predicted")),
            .frequency_scale = within(node.at("frequency_scale"), least, largest_scale),
            .damping_scale = within(node.at("damping_scale"), least, largest_scale),
            .residue_scale = within(node.at("residue_scale"), least, largest_scale)};
  }

  io::JsonNode found_;
};

/// Its text; nothing where there is no such file. @throws InvalidInput where it is none of these documents
std::optional<std::string> content(const fs::path& path) {
  std::error_code ignored;
  if (!fs::exists(fs::symlink_status(path, ignored))) return std::nullopt;
  if (fs::is_regular_file(path, ignored)) {
    std::string text = io::read_file(path, most_bytes);
    if (text.starts_with(beginning)) return text;
  }
  throw InvalidInput(path.filename().string(), "is no calibration, and is not replaced", "Give it another name");
}

}  // namespace

CalibrationDocument::CalibrationDocument(const fs::path& cell, std::string fingerprint)
    : fingerprint_(std::move(fingerprint)) {
  std::error_code ignored;
  if (!fs::is_regular_file(cell, ignored)) return;
  path_ = fs::path(cell).replace_extension(".calibration.json");
  io::require_no_output(path_);
}

std::optional<PostureCalibration> CalibrationDocument::read(std::vector<std::string>& notes) const {
  if (path_.empty()) return std::nullopt;
  try {
    const std::optional<std::string> text = content(path_);
    if (!text) return std::nullopt;
    const std::string name = path_.filename().string();
    const io::Json json = io::parse_json(*text, name);
    const io::JsonNode root(json, name);
    if (root.at("document").text() != document_kind) {
      throw root.at("document").reject(fmt::format("must be {}", document_kind));
    }
    if (root.at("inputs_sha256").text() != fingerprint_) return std::nullopt;
    const io::JsonNode found = root.at("found");
    if (root.at("found_sha256").text() != digest_of(io::plain_text(found.json()))) {
      throw found.reject("does not have the digest found_sha256", "It was changed by hand or damaged");
    }
    return Reading(found).calibration();
  } catch (const InvalidInput& error) {
    notes.push_back(fmt::format("The calibration is made anew: {}.", error.what()));
    return std::nullopt;
  }
}

bool CalibrationDocument::write(const PostureCalibration& calibration, std::vector<std::string>& notes) const {
  if (path_.empty()) return false;
  try {
    static_cast<void>(content(path_));
    const io::Json found = found_json(calibration);
    io::write_file(path_, io::dump({{"document", document_kind},
                                    {"inputs_sha256", fingerprint_},
                                    {"found_sha256", digest_of(io::plain_text(found))},
                                    {"found", found}}));
    return true;
  } catch (const InvalidInput& error) {
    notes.push_back(fmt::format("The calibration could not be kept and is made anew each time: {}.", error.what()));
    return false;
  }
}

}  // namespace robomill::cell
