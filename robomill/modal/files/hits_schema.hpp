#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "robomill/io/schema.hpp"
#include "robomill/modal/files/hits_toml.hpp"
#include "robomill/modal/fit.hpp"
#include "robomill/modal/impact/hit_split.hpp"

namespace robomill::modal {

/// [acquisition]
struct Acquisition {
  HitOptions options = {};
  double sample_rate_hz = 0.0;  ///< 0: not said
  std::optional<double> force_mv_per_n = {};
  std::optional<double> response_mv_per_g = {}, response_mv_per_m_per_s2 = {}, response_mv_per_m_per_s = {},
                        response_mv_per_m = {};
  double record_mv = 1e3;           ///< what a 1 of the record is
  double response_record_mv = 0.0;  ///< the same of the responses; 0: as of the force
  std::optional<double> scale = {};
  double hit_spacing_s = usual_hit_spacing_s;  ///< of hits in one record
};
[[nodiscard]] const io::Schema<Acquisition>& acquisition_table();

/// [[hits]]
struct HitTable {
  HitRow row = {};
  std::vector<std::filesystem::path> files = {};  ///< one, or force and responses apart
  std::string time = {};                          ///< column; empty: found
  bool split = true;                              ///< several hits in one record are cut apart
  std::vector<int> leave_out = {};                ///< of these, from 1
};
[[nodiscard]] const io::Schema<HitTable>& hit_table();

/// [fit] of modes.toml.
[[nodiscard]] const io::Schema<FitOptions>& fit_options_table();

}  // namespace robomill::modal
