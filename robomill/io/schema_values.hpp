#pragma once
// How members of each kind are read and written; for schema.hpp alone.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <complex>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "robomill/io/json.hpp"
#include "robomill/io/table_info.hpp"
#include "robomill/io/toml/file.hpp"

namespace robomill::io {

namespace detail {

template <class M>
struct Holding;  // what a member of type M is in a file
template <>
struct Holding<double> {
  static constexpr Holds holds = Holds::number;
  static constexpr int lists = 0;
};
template <class M>
requires std::is_integral_v<M>
struct Holding<M> {
  static constexpr Holds holds = std::is_same_v<M, bool> ? Holds::boolean : Holds::integer;
  static constexpr int lists = 0;
};
template <>
struct Holding<std::string> {
  static constexpr Holds holds = Holds::text;
  static constexpr int lists = 0;
};
template <>
struct Holding<std::string_view> : Holding<std::string> {};
template <>
struct Holding<const char*> : Holding<std::string> {};
template <>
struct Holding<std::filesystem::path> {
  static constexpr Holds holds = Holds::path;
  static constexpr int lists = 0;
};
template <>
struct Holding<std::complex<double>> {
  static constexpr Holds holds = Holds::complex;
  static constexpr int lists = 0;
};
template <class M>
struct Holding<std::optional<M>> : Holding<M> {};
template <class M>
struct Holding<std::vector<M>> {
  static constexpr Holds holds = Holding<M>::holds;
  static constexpr int lists = Holding<M>::lists + 1;
};
template <class M>
struct Holding<std::vector<std::pair<std::string, M>>> : Holding<M> {};
template <class M, std::size_t n>
struct Holding<std::array<M, n>> : Holding<std::vector<M>> {};
template <int n>
struct Holding<Eigen::Matrix<double, n, 1>> : Holding<std::vector<double>> {};
template <>
struct Holding<Eigen::MatrixXd> : Holding<std::vector<std::vector<double>>> {};

/// Whether values stand by names that differ from document to document.
template <class M>
inline constexpr bool is_named = false;
template <class M>
inline constexpr bool is_named<std::vector<std::pair<std::string, M>>> = true;

/// What a function of an object takes and gives.
template <class F>
struct Getter : Getter<decltype(&F::operator())> {};
template <class F, class R, class T>
struct Getter<R (F::*)(T) const> {
  using Object = std::remove_cvref_t<T>;
  using Value = std::remove_cvref_t<R>;
};

/// Of each kind of member how it is read and written.
/// @throws InvalidInput by TomlFile::reject where a value breaks the rule
bool read_value(TomlFile& file, const std::string& path, const std::string& member, double factor, const Key& key,
                double& out);
bool read_value(TomlFile& file, const std::string& path, const std::string& member, double factor, const Key& key,
                int& out);
bool read_value(TomlFile& file, const std::string& path, const std::string& member, double factor, const Key& key,
                bool& out);
bool read_value(TomlFile& file, const std::string& path, const std::string& member, double factor, const Key& key,
                std::string& out);
bool read_value(TomlFile& file, const std::string& path, const std::string& member, double factor, const Key& key,
                std::filesystem::path& out);
bool read_value(TomlFile& file, const std::string& path, const std::string& member, double factor, const Key& key,
                std::vector<double>& out);
bool read_value(TomlFile& file, const std::string& path, const std::string& member, double factor, const Key& key,
                std::vector<int>& out);
bool read_value(TomlFile& file, const std::string& path, const std::string& member, double factor, const Key& key,
                std::vector<std::string>& out);
bool read_value(TomlFile& file, const std::string& path, const std::string& member, double factor, const Key& key,
                std::vector<std::filesystem::path>& out);
template <class M, std::size_t n>
bool read_value(TomlFile& file, const std::string& path, const std::string& member, double factor, const Key& key,
                std::array<M, n>& out) {
  std::vector<M> values;
  if (!read_value(file, path, member, factor, key, values)) return false;
  if (values.size() != n) throw file.reject(path, "must hold " + std::to_string(n) + " numbers");
  std::copy(values.begin(), values.end(), out.begin());
  return true;
}
template <int n>
requires(n > 0) bool read_value(TomlFile& file, const std::string& path, const std::string& member, double factor,
                                const Key& key, Eigen::Matrix<double, n, 1>& out) {
  std::array<double, n> values = {};
  if (!read_value(file, path, member, factor, key, values)) return false;
  out = Eigen::Map<const Eigen::Matrix<double, n, 1>>(values.data());
  return true;
}
template <class M>
bool read_value(TomlFile& file, const std::string& path, const std::string& member, double factor, const Key& key,
                std::optional<M>& out) {
  M value{};
  if (!read_value(file, path, member, factor, key, value)) return false;
  out = std::move(value);
  return true;
}

/// How numbers are shown.
struct Shown {
  double factor = 1.0;
  bool exact = false;
};
Json write_value(double value, const Shown& shown);
Json write_value(const std::complex<double>& value, const Shown& shown);
Json write_value(const std::filesystem::path& value, const Shown& shown);
/// A row of the matrix a list.
Json write_value(const Eigen::MatrixXd& values, const Shown& shown);
template <class M>
requires std::is_integral_v<M> Json write_value(M value, const Shown& /*shown*/) {
  return value;
}
inline Json write_value(const std::string& value, const Shown& /*shown*/) {
  return value;
}
inline Json write_value(std::string_view value, const Shown& /*shown*/) {
  return value;
}
inline Json write_value(const char* value, const Shown& /*shown*/) {
  return value;
}
template <class M>
Json write_value(const std::optional<M>& value, const Shown& shown) {
  return value ? write_value(*value, shown) : Json();
}
/// An object of values by their names.
template <class M>
Json write_value(const std::vector<std::pair<std::string, M>>& named, const Shown& shown) {
  Json out = Json::object();
  for (const auto& [name, value] : named) out[name] = write_value(value, shown);
  return out;
}
template <class List>
requires requires(const List& list) {
  list.begin();
} &&(!std::is_convertible_v<List, std::string_view>)Json write_value(const List& list, const Shown& shown) {
  Json out = Json::array();
  for (const auto& value : list) out.push_back(write_value(value, shown));
  return out;
}

}  // namespace detail

}  // namespace robomill::io
