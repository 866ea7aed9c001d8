#pragma once
#include <string>

#include "robomill/io/schema.hpp"
#include "robomill/jobs/postures.hpp"

namespace robomill::jobs {

/// postures.json
[[nodiscard]] const io::Schema<PosturesResult>& postures_table();
/// A row a speed, a column a posture: its limit, empty where no depth is unstable.
[[nodiscard]] std::string postures_csv(const PosturesResult& result);

}  // namespace robomill::jobs
