#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <initializer_list>
#include <string_view>
#include <vector>

#include "robomill/io/shop_units.hpp"
#include "robomill/jobs/init.hpp"

namespace robomill::jobs {

using Quantity = io::ShopQuantity;

/// Where an answer goes.
struct Target {
  Template document = Template::job;
  const char* key = nullptr;
};

/// Several of them.
class Targets {
 public:
  constexpr Targets() = default;
  constexpr Targets(std::initializer_list<Target> targets) : count_(targets.size()) {
    std::ranges::copy(targets, targets_.begin());
  }
  [[nodiscard]] constexpr const Target* begin() const { return targets_.data(); }
  [[nodiscard]] constexpr const Target* end() const { return targets_.data() + count_; }
  [[nodiscard]] constexpr bool empty() const { return count_ == 0; }

 private:
  std::array<Target, 4> targets_ = {};
  std::size_t count_ = 0;
};

/// What an answer is.
enum class Answer { length_unit, quantity, count, material, direction, robot, voltage, unmeasured };

struct Question {
  std::string_view id, text;
  Answer kind = Answer::quantity;
  Quantity quantity = Quantity::number;  ///< of Answer::quantity
  double low = 0.0, high = 0.0;          ///< what is allowed, in the unit of the keys
  Targets targets = {};                  ///< those of documents that are not written are left out
  std::string_view otherwise = {};       ///< the default where the documents have none; empty: may be left open
};

/// Those of a document, in their order; of a job also those of the documents that it brings along.
[[nodiscard]] std::vector<Question> questions_of(Template kind);

}  // namespace robomill::jobs
