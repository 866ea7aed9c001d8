#pragma once
// For .cpp files inside the library: public headers stay free of nlohmann/json.
#include <Eigen/Core>
#include <complex>
#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/base/error.hpp"

namespace robomill::io {

using Json = nlohmann::ordered_json;

/// A number of 15 significant digits; null where it is not finite.
[[nodiscard]] Json number(double value);
/// In a unit; null where it is not > 0: unknown, none.
[[nodiscard]] Json positive(double value, double unit = 1.0);
/// [re, im]
[[nodiscard]] Json complex_number(const std::complex<double>& value);
/// A list of all digits of each.
[[nodiscard]] Json numbers(const Eigen::Ref<const Eigen::VectorXd>& values);
/// A list of each in a unit, of 15 significant digits.
[[nodiscard]] Json numbers_in(double unit, const Eigen::Ref<const Eigen::VectorXd>& values);
/// {"re": […], "im": […]}
[[nodiscard]] Json complex_numbers(const Eigen::Ref<const Eigen::VectorXcd>& values);

/// [{"what", "taken", "key", "file"}, …]; key and file null where there is none.
[[nodiscard]] Json assumed_json(const std::vector<Assumption>& assumed);

/// Null where it is empty.
[[nodiscard]] Json text_or_null(std::string_view text);
/// JSON text on one line; text that is not UTF-8 (file names may be anything) has its wrong bytes replaced.
[[nodiscard]] std::string plain_text(const Json& json);
/// JSON text for people too: objects over lines, lists of plain values on one; null for what is not finite; a line's
/// end last.
[[nodiscard]] std::string dump(const Json& json);

/// JSON that a program of ours wrote; the parser is compiled once, here. What others wrote: parse_json.
/// @throws nlohmann::json::exception
[[nodiscard]] Json parsed(std::string_view text);
/// The same; what is no JSON comes back discarded (is_discarded).
[[nodiscard]] Json parsed_or_discarded(std::string_view text);

/// A place in a JSON file while it is read; errors name the file and the path, "tip.json: modes[2].damping_ratio",
/// lists counted from 1. Of a document every number that is read is compared with what is usual of its key
/// (io/usual_ranges.hpp), of a list the largest.
class JsonNode {
 public:
  /// The root of a document. @param warnings  of numbers that are unusual; outlives this and what is below it
  JsonNode(const Json& json, std::string file, std::vector<std::string>& warnings);
  /// A place in what a program sent, whose numbers are not compared.
  JsonNode(const Json& json, std::string file, std::string path = {});

  [[nodiscard]] const Json& json() const { return *json_; }
  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] bool has(const char* key) const;
  /// @throws InvalidInput if there is no such member
  [[nodiscard]] JsonNode at(const std::string& key) const;
  /// @throws InvalidInput if this is no list
  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] JsonNode at(std::size_t index) const;
  /// @throws InvalidInput if this is no object
  void require_object() const;
  [[nodiscard]] double number() const;
  [[nodiscard]] std::complex<double> complex_number() const;
  [[nodiscard]] Eigen::VectorXd numbers() const;
  [[nodiscard]] std::string text() const;
  [[nodiscard]] InvalidInput reject(std::string rule, std::string hint = {}) const;

 private:
  JsonNode(const Json& json, std::string file, std::string path, std::vector<std::string>* warnings);
  void compare(double largest) const;

  const Json* json_;
  std::string file_, path_;
  std::vector<std::string>* warnings_;  ///< null: not compared
};

/// @throws InvalidInput with file and line if the file is missing, empty or no JSON
[[nodiscard]] Json read_json(const std::filesystem::path& path);
/// @param name  of the text, in errors
/// @throws InvalidInput with name and line if it is no JSON, or nests deeply
[[nodiscard]] Json parse_json(std::string_view content, const std::string& name);

}  // namespace robomill::io
