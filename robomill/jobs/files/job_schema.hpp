#pragma once
#include "robomill/io/schema.hpp"
#include "robomill/jobs/files/job_toml.hpp"

namespace robomill::jobs {

/// [job]
[[nodiscard]] const io::Schema<Job>& job_table();

}  // namespace robomill::jobs
