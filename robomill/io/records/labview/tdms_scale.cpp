#include "robomill/io/records/labview/tdms_scale.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "robomill/base/error.hpp"
#include "robomill/io/text.hpp"

namespace robomill::io {
namespace {

constexpr std::size_t raw_number = std::numeric_limits<std::size_t>::max();
constexpr double raw_input = 4294967295.0;  ///< in the place of a scale's number
constexpr std::size_t most_scales = 64, most_coefficients = 64;

/// How many scales there are by the names of properties.
std::size_t count_by_names(const TdmsProperties& properties) {
  constexpr std::string_view prefix = "NI_Scale[";
  std::size_t out = 0;
  for (auto at = properties.lower_bound(prefix); at != properties.end() && at->first.starts_with(prefix); ++at) {
    std::size_t index = 0;
    const std::string& name = at->first;
    std::from_chars(name.data() + prefix.size(), name.data() + name.size(), index);
    out = std::max(out, std::min(index, most_scales) + 1);
  }
  return out;
}

double finite_number(const TdmsProperties& properties, const std::string& name) {
  const double out = number_of(properties, name);
  if (!std::isfinite(out)) throw InvalidInput("", fmt::format("its scale lacks {}", name));
  return out;
}

/// What a scale takes. @param required  else it takes the raw number where nothing says what
std::size_t source(const TdmsProperties& properties, const std::string& name, std::size_t index, bool required) {
  if (!required && !std::isfinite(number_of(properties, name))) return raw_number;
  const double number = finite_number(properties, name);
  if (number == raw_input || number == -1.0) return raw_number;
  if (!(number >= 0.0 && number < static_cast<double>(index)) || number != std::floor(number)) {
    throw InvalidInput("", fmt::format("its scale {} takes scale {}, which is not before it", index, number));
  }
  return static_cast<std::size_t>(number);
}

}  // namespace

TdmsScale::TdmsScale(const TdmsProperties& properties) {
  if (lowered(text_of(properties, "NI_Scaling_Status")) == "scaled") return;
  const double stated = number_of(properties, "NI_Number_Of_Scales");
  const double count = std::isfinite(stated) ? stated : static_cast<double>(count_by_names(properties));
  if (!(count >= 0.0 && count <= static_cast<double>(most_scales))) {
    throw InvalidInput("", fmt::format("it has {} scales, and at most {} are read", count, most_scales));
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) steps_.push_back(step(properties, i));
  values_.resize(steps_.size());
}

TdmsScale::Step TdmsScale::step(const TdmsProperties& properties, std::size_t index) {
  const std::string begin = fmt::format("NI_Scale[{}]_", index);
  const std::string kind = text_of(properties, begin + "Scale_Type");
  if (kind.empty()) return {};
  if (kind == "Linear") {
    return {.kind = Kind::polynomial,
            .left = source(properties, begin + "Linear_Input_Source", index, false),
            .coefficients = {finite_number(properties, begin + "Linear_Y_Intercept"),
                             finite_number(properties, begin + "Linear_Slope")}};
  }
  if (kind == "Polynomial") {
    Step out{.kind = Kind::polynomial, .left = source(properties, begin + "Polynomial_Input_Source", index, false)};
    const double stated = number_of(properties, begin + "Polynomial_Coefficients_Size");
    const double size = std::isfinite(stated) ? stated : 4.0;
    if (!(size >= 1.0 && size <= static_cast<double>(most_coefficients))) {
      throw InvalidInput("", fmt::format("its scale {} has {} coefficients", index, size));
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(size); ++i) {
      out.coefficients.push_back(finite_number(properties, fmt::format("{}Polynomial_Coefficients[{}]", begin, i)));
    }
    return out;
  }
  if (kind == "Add" || kind == "Subtract") {
    return {.kind = kind == "Add" ? Kind::add : Kind::subtract,
            .left = source(properties, begin + kind + "_Left_Operand_Input_Source", index, true),
            .right = source(properties, begin + kind + "_Right_Operand_Input_Source", index, true)};
  }
  throw InvalidInput("", fmt::format("its scale {} is a {}, which is not read", index, kind));
}

std::vector<std::uint32_t> TdmsScale::scalers() const {
  std::vector<std::uint32_t> out;
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    if (steps_[i].kind == Kind::scaler) out.push_back(static_cast<std::uint32_t>(i));
  }
  return out;
}

double TdmsScale::input(std::size_t step, std::span<const TdmsRaw> raw) const {
  return step == raw_number ? raw.front().value : values_[step];
}

double TdmsScale::operator()(std::span<const TdmsRaw> raw) {
  if (steps_.empty()) return raw.front().value;
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const Step& step = steps_[i];
    double& value = values_[i];
    switch (step.kind) {
      case Kind::scaler: {
        const auto found = std::ranges::find(raw, static_cast<std::uint32_t>(i), &TdmsRaw::scale);
        value = found == raw.end() ? std::numeric_limits<double>::quiet_NaN() : found->value;
        break;
      }
      case Kind::polynomial: {
        const double x = input(step.left, raw);
        value = 0.0;
        for (std::size_t k = step.coefficients.size(); k-- > 0;) value = value * x + step.coefficients[k];
        break;
      }
      case Kind::add:
        value = input(step.right, raw) + input(step.left, raw);
        break;
      case Kind::subtract:
        value = input(step.right, raw) - input(step.left, raw);
        break;
    }
  }
  return values_.back();
}

}  // namespace robomill::io
