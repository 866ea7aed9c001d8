#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/progress.hpp"
#include "robomill/io/toml_source.hpp"
#include "robomill/jobs/dynamics_cache.hpp"
#include "robomill/serve/client_order.hpp"
#include "robomill/stability/lobes.hpp"

// Method: robomill/serve/README.md, "Live lobes"

namespace robomill::serve {

/// What is asked of a lobes.toml while somebody moves its sliders.
struct LiveLobesRequest {
  std::filesystem::path file = {};             ///< lobes.toml
  std::vector<io::TomlSetting> settings = {};  ///< keys of it that are set to other values
  bool chart = false;                          ///< boundary and band; else the limits at 100 speeds
  /// Evaluated beside them. Of a sweep as jobs::LobesJob::points.
  std::vector<stability::OperatingPoint> points = {};
  ClientOrder order = {};
};

/// The body of POST /api/lobes; `file` is as it stands there.
/// @throws InvalidInput naming the member
[[nodiscard]] LiveLobesRequest read_live_lobes_request(std::string_view body);

/// Answers while the hand still moves: to less than a pixel of a picture, not to the file's tolerance.
class LiveLobes {
 public:
  /// {"sequence", "lobes": lobes.json, "modes": […], "fields": {…}, "notes": […], "milliseconds"}. One call at a time.
  /// @throws InvalidInput as jobs::run_lobes, or naming a key that cannot be set; Interrupted
  [[nodiscard]] std::string answer(const LiveLobesRequest& request, Progress& progress = Progress::none());

  [[nodiscard]] const jobs::DynamicsCache& dynamics() const { return dynamics_; }

 private:
  jobs::DynamicsCache dynamics_;
};

}  // namespace robomill::serve
