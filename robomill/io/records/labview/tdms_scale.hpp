#pragma once
// Of the reader of TDMS.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robomill/io/records/labview/tdms_format.hpp"

namespace robomill::io {

/// A number as it stands in the file, and the scale of DAQmx that takes it.
struct TdmsRaw {
  double value = 0.0;
  std::uint32_t scale = 0;
};

/// What makes physical values of the raw numbers of a channel: scales, each of which takes raw numbers or what those
/// before it give. The last one gives the values.
class TdmsScale {
 public:
  /// The numbers are the values.
  TdmsScale() = default;
  /// By the properties NI_Scale[i]_… of a channel, its group or its file: Linear, Polynomial, Add and Subtract (right
  /// less left).
  /// @throws InvalidInput without a place, if one is of another kind or incomplete
  explicit TdmsScale(const TdmsProperties& properties);

  [[nodiscard]] bool is_none() const { return steps_.empty(); }
  /// The scales that raw numbers of DAQmx must come for.
  [[nodiscard]] std::vector<std::uint32_t> scalers() const;
  /// @param raw  at least one; of them the first where a scale does not say which
  [[nodiscard]] double operator()(std::span<const TdmsRaw> raw);

 private:
  enum class Kind { scaler, polynomial, add, subtract };
  struct Step {
    Kind kind = Kind::scaler;
    std::size_t left = 0, right = 0;        ///< the steps taken; raw_number: the raw number
    std::vector<double> coefficients = {};  ///< from the constant on
  };
  [[nodiscard]] static Step step(const TdmsProperties& properties, std::size_t index);
  [[nodiscard]] double input(std::size_t step, std::span<const TdmsRaw> raw) const;

  std::vector<Step> steps_;
  std::vector<double> values_;  ///< of the steps
};

}  // namespace robomill::io
