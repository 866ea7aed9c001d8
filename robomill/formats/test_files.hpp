#pragma once
#include "robomill/base/test_support.hpp"

namespace robomill::formats::testing {

using test::Folder;
using test::refusal;
using test::seeds;

}  // namespace robomill::formats::testing
