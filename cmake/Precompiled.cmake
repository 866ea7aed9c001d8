# Headers that most sources read, parsed once: half of a small source's compile time is Eigen's. One set for library objects, one
# for those that are compiled quickly, one for the tests' programs, whose code is compiled for another place (-fPIE). Public headers
# are compiled without, to show that each stands alone; the clang build goes without, too.
set(headers <Eigen/Dense> <fmt/format.h> <nlohmann/json.hpp> <algorithm> <array> <atomic> <charconv> <chrono> <cmath> <complex>
  <filesystem> <fstream> <functional> <limits> <map> <memory> <mutex> <numbers> <numeric> <optional> <set> <span> <sstream> <string>
  <string_view> <thread> <vector>)
file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/precompiled.cpp CONTENT "int main() {}\n")
foreach(kind IN ITEMS "" _cold)
  add_library(robomill_precompiled${kind} OBJECT ${CMAKE_BINARY_DIR}/precompiled.cpp)
  target_link_libraries(robomill_precompiled${kind} PRIVATE robomill${kind}_flags Eigen3::Eigen)
  target_precompile_headers(robomill_precompiled${kind} PRIVATE ${headers})
endforeach()
add_custom_target(precompiled DEPENDS robomill_precompiled robomill_precompiled_cold)
if(ROBOMILL_TESTS)
  add_executable(robomill_precompiled_test ${CMAKE_BINARY_DIR}/precompiled.cpp)
  target_link_libraries(robomill_precompiled_test PRIVATE robomill_test_flags Eigen3::Eigen GTest::gtest)
  target_precompile_headers(robomill_precompiled_test PRIVATE ${headers} <gtest/gtest.h>)
  add_dependencies(precompiled robomill_precompiled_test)
endif()
